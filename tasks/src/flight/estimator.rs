//! Attitude estimation, one step for each inertial sample (1 kHz). The [`DEADLINE`] counts from its data-ready.

use embassy_time::{Duration, Instant};
use sophie_control::attitude::estimator::Estimator;
use sophie_control::attitude::mounting::Mounting;
use sophie_control::chain::Attitude;

use crate::deadline::note_run;
use crate::links::Links;
use crate::schedule::TaskId;

/// Time from data-ready to the estimate.
pub const DEADLINE: Duration = TaskId::Estimator.deadline();

/// Estimates at 1 kHz; returns only if the link has no receiver left.
pub async fn run(links: &Links) {
    let Some(mut imu) = links.imu.receiver() else {
        return;
    };
    let bias = links.start.retained.and_then(|retained| retained.gyro_bias);
    let mounting = Mounting::from(links.params.imu_mounting);
    let mut estimator = match bias {
        Some(bias) => Estimator::resume(&links.params, mounting.to_vehicle(bias)),
        None => Estimator::new(&links.params),
    };
    let mut attitude = Attitude::default();
    loop {
        let sample = imu.changed().await;
        let started = Instant::now();
        estimator.estimate(&sample.value, &mut attitude);
        links.attitude.send(sample.at, attitude);
        note_run(links, TaskId::Estimator, sample.at, started, DEADLINE);
    }
}
