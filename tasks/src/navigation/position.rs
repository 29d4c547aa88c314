//! Position estimator, 200 Hz: fuses inertial data with external poses or with flow and range; without these, the
//! height uses barometric pressure.
//!
//! A missed deadline delays the estimate; its readers accept an age of ten periods. Nothing is sent while the attitude
//! is stale or the estimator has no valid estimate.

use sophie_control::chain;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::fix::Fix;
use sophie_control::navigation::inertial::Inertial;
use sophie_control::navigation::position_estimator::PositionEstimator;

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::schedule::TaskId;
use sophie_ports::external_pose::ExternalPose;

/// Estimates the position; never returns.
pub async fn run(links: &Links) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Position);
    let mut estimator = PositionEstimator::new(&links.params);
    loop {
        let now = rate.next().await.started;
        // The link's lock masks interrupts: copies the needed fields only and computes after it.
        let attitude = &links.attitude;
        let inertial = attitude.look(|m| {
            let fresh = m.is_fresh(now, attitude.stale_after);
            fresh.then_some((m.at, m.value.q, m.value.accel))
        });
        let Some((at, q, accel)) = inertial.flatten() else {
            continue;
        };
        let seen = links.external_pose.look(|m| Seen::of(&m.value));
        // Without a heading the pose cannot be used for position.
        let fix = seen.and_then(Seen::fix);
        let view = links.ground.look(|m| m.value);
        let pushed = links
            .mix
            .fresh_to(now, |mix| mix.running.then_some((mix.thrusts, mix.tilt)));
        let lift = pushed
            .flatten()
            .map_or(0.0, |(thrusts, tilt)| chain::lift(&thrusts, &tilt));
        if let Some(air) = links.air_pressure.look(|m| m.value) {
            estimator.hear(&air);
        }
        let at_us = at.as_micros();
        if let Some(estimate) =
            estimator.step(&Inertial { at_us, q, accel }, lift, fix.as_ref(), view.as_ref())
        {
            links.position.send(at, estimate);
        }
        if let Some(fault) = estimator.fault() {
            links.position_fault.send(at, fault);
        }
    }
}

/// Fields of a pose that the estimator uses.
struct Seen {
    at_us: u64,
    position: Vec3,
    attitude: Option<Quat>,
    variance: Option<Vec3>,
    resets: u8,
}

impl Seen {
    const fn of(m: &ExternalPose) -> Self {
        Self {
            at_us: m.measured_at,
            position: m.pose.position,
            attitude: m.pose.attitude,
            variance: m.pose.position_variance,
            resets: m.pose.resets,
        }
    }

    /// Input of the estimator; `None` without a heading.
    fn fix(self) -> Option<Fix> {
        Some(Fix {
            at_us: self.at_us,
            position: self.position,
            heading: self.attitude?.to_euler().2,
            variance: self.variance,
            resets: self.resets,
        })
    }
}
