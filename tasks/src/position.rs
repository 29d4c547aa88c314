//! The position estimate, 200 Hz: the inertial sensor, and the poses that others send.
//!
//! A miss makes the estimate later: its readers have a limit of ten periods. A stale attitude ends it for as long; without
//! poses there is none, and nothing is sent.

use embassy_time::Instant;
use sophie_control::position::{Fix, PositionEstimator};

use crate::deadline::{FixedRate, TaskId};
use crate::links::{Attitude, ExternalPose, Links, Stamped};

/// Estimates the position; never returns.
pub async fn run(links: &Links) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Position);
    let mut estimator = PositionEstimator::new(&links.params);
    loop {
        rate.next().await;
        let fresh = |m: &Stamped<Attitude>| m.is_fresh(Instant::now(), links.attitude.stale_after);
        let Some(attitude) = links.attitude.latest().filter(fresh) else {
            continue;
        };
        // Of a heading that is not sent the position cannot be held.
        let fix = links.external_pose.latest().and_then(|pose| fix(&pose.value));
        let lift = links.mix.fresh().map_or(0.0, |mix| mix.lift());
        let at_us = attitude.at.as_micros();
        if let Some(estimate) = estimator.step(at_us, &attitude.value, lift, fix.as_ref()) {
            links.position.send(attitude.at, estimate);
        }
    }
}

/// The pose as the estimator takes it; `None` without a heading.
fn fix(pose: &ExternalPose) -> Option<Fix> {
    let ExternalPose {
        pose, measured_at, ..
    } = pose;
    Some(Fix {
        at_us: *measured_at,
        position: pose.position,
        heading: pose.attitude?.to_euler().2,
        variance: pose.position_variance,
        resets: pose.resets,
    })
}
