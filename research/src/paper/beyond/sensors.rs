//! Effect of the arms' own sensors.

use crate::study::rig::fly;
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::parallel;

use super::super::flights::{error, in_gusts, vehicle};
use super::{mismatch, programme};
use crate::results::model::{Section, Table, num};

const INFILLS: [f64; 3] = [5.0, 6.9, 10.0];
const SEEDS: u64 = 4;

struct Job {
    infill: f64,
    sensors: bool,
    seed: u64,
}

fn yaw_error(job: &Job, k: f64) -> Option<f64> {
    let mut v = in_gusts(vehicle(Configuration::B, k, job.infill, Variant::Flexible));
    mismatch(&mut v);
    v.seed = job.seed;
    if !job.sensors {
        v.params.tilt_bias_gain = 0.0;
    }
    error(&fly(&v, None, 20.0, programme), 2)
}

/// Flies mismatched arms with and without their sensors.
pub fn compare(s: &mut Section, k: f64) {
    let cases = INFILLS.map(|infill| [true, false].map(|sensors| (infill, sensors)));
    let mut jobs = vec![];
    for (infill, sensors) in cases.as_flattened() {
        jobs.extend((1..=SEEDS).map(|seed| Job {
            infill: *infill,
            sensors: *sensors,
            seed,
        }));
    }
    let errors = parallel::each(&jobs, |job| yaw_error(job, k));
    let mut t = Table::new(
        "What the arms' own sensors add: flexible mixer, mismatched arms, four seeds",
        &["ρ %", "arm IMUs", "yaw RMS °, mean of those kept", "lost"],
    );
    for ((infill, sensors), of) in cases.as_flattened().iter().zip(errors.chunks(SEEDS as usize)) {
        let kept: Vec<f64> = of.iter().filter_map(|f| *f).collect();
        t.row([
            num(*infill, 1),
            if *sensors { "yes" } else { "no, model alone" }.into(),
            num(kept.iter().sum::<f64>() / kept.len() as f64, 2),
            format!("{} of {}", of.len() - kept.len(), of.len()).into(),
        ]);
    }
    s.table(t);
}
