//! The roll loop of a vehicle on a pipe, without its integral.
//!
//! In the air P = A/(I s), A motors and arms. Standing, the body rocks on its pads at ±w about the middle between them, h
//! below its centre of mass: P' = P I s² / (J s² + c s + k), J = I + m h², k = Σ k_pad w² - m g h, c = Σ c_pad w². Sliding on
//! both pads it turns about the pipe's axis, H below: P' = P I s² / (J s² - W H), J = I + m H², whatever the thrust, which
//! points through the axis. Without an integral the loop's stiffness is K = p_att p I: a slide grows as long as K < W H, and no
//! faster than the larger root of J s² + p I s + K - W H.

use sophie_control::attitude::gains::Gains;
use sophie_control::chain::CONTROL_RATE_HZ;
use sophie_control::params::Params;

use super::laws::Laws;
use super::margins::Margins;
use super::response::{Complex, quotient};
use super::{Hovering, frequencies};
use crate::plant::GRAVITY;
use crate::plant::contact::{BELLY, BELLY_Z, Belly, rebound};
use crate::scenario::Scenario;

const ROLL: usize = 0;

/// Place of the vehicle while the roll loop brings it to rest on a pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Off the pipe again, after a bounce.
    Air,
    /// On its pads, which friction holds.
    Standing,
}

/// Margins of roll at `place` with the rotors carrying the `share` of the weight, above 0.
#[must_use]
pub fn resting_margins(scenario: &Scenario, place: Place, share: f64) -> Margins {
    let laws = Laws::of(&still(&scenario.params));
    let vehicle = Hovering::carrying(scenario, share).response(ROLL);
    let curve: Vec<_> = frequencies()
        .map(|omega| {
            let angle = omega / f64::from(CONTROL_RATE_HZ);
            // A measurement at the end of a step acts in the next one.
            let delay = Complex::from_angle(-angle);
            let factor = match place {
                Place::Air => Complex::X,
                Place::Standing => standing(scenario, share, omega),
            };
            let loop_gain = vehicle.at(angle).rotate(laws.at(ROLL, angle)).rotate(delay);
            (omega, loop_gain.rotate(factor))
        })
        .collect();
    Margins::of(&curve, super::STEP)
}

/// Growth rate of a slide on a pipe of `diameter` m without friction, 1/s, with the loop and without; 0 if the vehicle
/// returns.
#[must_use]
pub fn slide(scenario: &Scenario, diameter: f64) -> (f64, f64) {
    let (body, p) = (&scenario.vehicle.body, &scenario.params);
    let radius = 0.5 * diameter;
    let lever = (radius * radius - Belly::PADS[0].y * Belly::PADS[0].y)
        .max(0.0)
        .sqrt()
        + BELLY_Z;
    let inertia = body.inertia[ROLL] + body.mass * lever * lever;
    let gains = Gains::of(p);
    let damping = f64::from(gains.rate_p[ROLL] * p.inertia_roll);
    let stiffness = f64::from(gains.attitude_p) * damping - body.mass * GRAVITY * lever;
    let growth = |c: f64, k: f64| {
        let root = (c * c - 4.0 * inertia * k).max(0.0).sqrt();
        ((root - c) / (2.0 * inertia)).max(0.0)
    };
    (
        growth(damping, stiffness),
        growth(0.0, -body.mass * GRAVITY * lever),
    )
}

/// P'/P on the pads, at `omega` rad/s.
fn standing(scenario: &Scenario, share: f64, omega: f64) -> Complex {
    let body = &scenario.vehicle.body;
    let weight = body.mass * GRAVITY;
    let lever = BELLY_Z;
    let across: f64 = Belly::PADS.iter().map(|pad| pad.y * pad.y).sum();
    // Pads that are pressed in by less damp in proportion.
    let depth = (1.0 - share).max(0.0) * weight / (Belly::PADS.len() as f64 * BELLY.stiffness);
    let pad = BELLY.rebounding(rebound(scenario.vehicle.pad_restitution));
    let damping = pad.resting_damping(depth) * across;
    let stiffness = BELLY.stiffness * across - weight * lever;
    let inertia = body.inertia[ROLL] + body.mass * lever * lever;
    let own = -body.inertia[ROLL] * omega * omega;
    quotient(
        Complex::new(own, 0.0),
        Complex::new(stiffness - inertia * omega * omega, damping * omega),
    )
}

/// Integrals stand still on the pipe.
fn still(p: &Params) -> Params {
    Params {
        rate_roll_i: 0.0,
        ..*p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slide_grows_slower_with_the_loop() {
        // On 0.3 m: H 0.187 m, J 0.084 kg m², W H 3.31 N m: 6.3 1/s. With 4.5 · 20 · 0.021 = 1.89 N m/rad and 0.42 N m s:
        // 0.084 s² + 0.42 s - 1.42 = 0 at 2.3 1/s.
        let (with, without) = slide(&Scenario::default_mission(), 0.3);
        assert!(
            (without - 6.3).abs() < 0.1 && (with - 2.3).abs() < 0.1,
            "{with} {without}"
        );
    }

    #[test]
    fn pads_of_no_stiffness_are_the_air_and_hard_ones_hold() {
        let s = Scenario::default_mission();
        // Far above the rocking, J over I is left; far below, the pads.
        let fast = standing(&s, 0.375, 1e4);
        let ratio = 0.021 / (0.021 + 1.805 * 0.04 * 0.04);
        assert!((fast.x - ratio).abs() < 0.01 && fast.y.abs() < 0.02, "{fast}");
        // -I ω²/k: k = 4 · 4000 · 0.03² - 17.7 · 0.04 = 13.7 N m/rad.
        let slow = standing(&s, 0.375, 0.1);
        assert!((slow.x / (-0.021 * 0.01 / 13.7) - 1.0).abs() < 0.01, "{slow}");
    }

    #[test]
    fn roll_keeps_a_margin_on_the_pads_and_between_them() {
        let s = Scenario::default_mission();
        for place in [Place::Air, Place::Standing] {
            for share in [0.375, 0.9] {
                let m = resting_margins(&s, place, share);
                assert!(m.gain > 1.43 && m.disk > 0.3, "{place:?} {share}: {m:?}");
            }
        }
    }
}
