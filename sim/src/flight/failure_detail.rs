//! Detail behind the reason of a failed flight: the samples' values of the quantity that ended it.

use core::f64::consts::PI;
use sophie_control::gripper::tendon::ForceLimit;
use sophie_control::mode::{Mode, Reason};

use crate::check::{Check, needed};
use crate::plant::GRAVITY;
use crate::plant::tendon::TendonSpec;
use crate::record::{SAMPLE_HZ, Sample};
use crate::scenario::{Scenario, Step};

/// Time before the end that is searched for swings, s.
const SWING_TIME: f64 = 2.0;
/// Least swing from one turn to the next, rad (12 deg), and least number of them in a row, that is reported: gusts and
/// the pilot make less, the roll manoeuvre turns twice.
const SWING: f64 = 12.0 * PI / 180.0;
const SWINGS: usize = 4;

/// Text to append to the `reason` of a flight that failed in `step`; empty without a finding.
pub fn detail(scenario: &Scenario, step: Option<&Step>, samples: &[Sample], reason: &str) -> String {
    let mut parts = Vec::new();
    let swings = swings(samples);
    parts.extend(strength(scenario, step, samples, swings.is_some()));
    parts.extend(swings);
    if reason.contains(Reason::ForceLimit.text()) {
        parts.extend(force(scenario, samples));
    }
    parts.extend(
        Check::of(scenario)
            .failing()
            .map(|row| format!("check: {}", row.shortfall())),
    );
    parts.iter().map(|part| format!("; {part}")).collect()
}

/// Thrust to weight of a vehicle that did not reach half its take-off height.
fn strength(scenario: &Scenario, step: Option<&Step>, samples: &[Sample], swings: bool) -> Option<String> {
    let Some(Step::TakeOff { height }) = step else {
        return None;
    };
    let last = samples.last()?;
    let (thrust, weight) = (
        4.0 * scenario.vehicle.rotor.thrust_max,
        scenario.vehicle.body.mass * GRAVITY,
    );
    let ratio = thrust / weight;
    let low = -last.position[2] < 0.5 * height;
    (low && !swings).then(|| {
        format!(
            "throttle {:.2} given, thrust to weight {ratio:.2} ({thrust:.1} N of {weight:.1} N)",
            last.throttle
        )
    })
}

/// Sustained swings of the attitude; `None` without.
fn swings(samples: &[Sample]) -> Option<String> {
    let count = (SWING_TIME * SAMPLE_HZ) as usize;
    let last = samples.get(samples.len().saturating_sub(count)..)?;
    let swings = ["roll", "pitch"]
        .into_iter()
        .enumerate()
        .filter_map(|(axis, name)| {
            let turns = turns(last.iter().map(|s| s.attitude[axis]));
            let sizes: Vec<f64> = turns
                .iter()
                .zip(turns.iter().skip(1))
                .map(|(a, b)| (a - b).abs())
                .collect();
            if sizes.len() < SWINGS {
                return None;
            }
            let rate = last.iter().map(|s| s.rate[axis].abs()).fold(0.0, f64::max);
            Some((name, sizes.into_iter().fold(0.0, f64::max), rate))
        });
    let (name, size, rate) = swings.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "{name} swings by {:.0} deg at up to {:.0} deg/s",
        size.to_degrees(),
        rate.to_degrees()
    ))
}

/// Turning points of an angle, each at least [`SWING`] from the one before.
fn turns(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let (mut turns, mut low, mut high, mut rising) = (Vec::new(), f64::MAX, f64::MIN, None);
    for angle in angles {
        (low, high) = (f64::min(low, angle), f64::max(high, angle));
        if rising != Some(false) && angle < high - SWING {
            turns.push(high);
            (rising, low) = (Some(false), angle);
        } else if rising != Some(true) && angle > low + SWING {
            turns.push(low);
            (rising, high) = (Some(true), angle);
        }
    }
    turns
}

/// Tendon force of the chosen arm with the least pressure, and the force that it would need.
fn force(scenario: &Scenario, samples: &[Sample]) -> Option<String> {
    let p = &scenario.params;
    let (limit, target) = (
        f64::from(ForceLimit::from_params(p).force),
        f64::from(p.grip_pressure),
    );
    let radius = TendonSpec::default().reel_radius;
    let end = samples.iter().rev().find(|s| s.mode == Mode::Clamping)?;
    let chosen = scenario.arms.mask();
    let (arm, pressure) = (0..4)
        .filter(|arm| chosen[*arm])
        .map(|arm| (arm, end.pressure[arm]))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let needed = needed(scenario, arm, end.thrust[arm], target).map_or_else(
        || "no force brings it there".to_owned(),
        |needed| {
            format!(
                "about {needed:.0} N needed under a thrust of {:.1} N ({:.2} N m at the servo)",
                end.thrust[arm],
                needed * radius
            )
        },
    );
    Some(format!(
        "arm {} reached {pressure:.0} of {target:.0} N/m2 with {:.1} N, allowed {limit:.1} N, {needed}",
        arm + 1,
        end.tension[arm]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attitude(angle: impl Fn(f64) -> f64) -> Vec<Sample> {
        (0..400)
            .map(|i| Sample {
                attitude: [0.0, angle(0.01 * f64::from(i)), 0.0],
                ..Sample::default()
            })
            .collect()
    }

    #[test]
    fn swings_are_reported_and_a_manoeuvre_is_not() {
        let swinging = attitude(|t| 0.3 * libm::sin(2.0 * PI * 3.0 * t));
        assert!(swings(&swinging).unwrap().starts_with("pitch swings by 34 deg"));
        assert_eq!(swings(&attitude(|t| 0.08 * libm::sin(2.0 * PI * 3.0 * t))), None);
        assert_eq!(swings(&attitude(|t| 0.45 * libm::sin(2.0 * PI * 0.4 * t))), None);
        assert_eq!(swings(&[]), None);
    }
}
