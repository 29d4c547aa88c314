//! Why configuration A is lost, and how it can fly.

use crate::study::allocation::Studied;
use crate::study::rig::{Flown, fly};
use sophie_control::allocation::wrench::Configuration;
use sophie_control::params::Params;
use sophie_sim::mixers::Variant;
use sophie_sim::parallel;

use super::super::flights::{curve, in_gusts, named, vehicle};
use super::super::printed::Printed;
use super::super::statics::AtThrust;
use super::programme;
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle};

struct Job {
    name: &'static str,
    studied: Option<Studied>,
    infill: f64,
}

/// Flies A and explains its loss.
pub fn explain(s: &mut Section, p: &Printed, k: f64) {
    let infill = p.text.infill_percent;
    let job = |name, studied, infill| Job {
        name,
        studied,
        infill,
    };
    let aware = Some(Studied::SignAware);
    let jobs = [
        job("flexible", None, infill),
        job("sign-aware", aware, infill),
        job("sign-aware, ρ 10 %", aware, 10.0),
        job("sign-aware, ρ 4 %", aware, 4.0),
    ];
    let flights = parallel::each(&jobs, |job| {
        let scenario = in_gusts(vehicle(Configuration::A, k, job.infill, Variant::Flexible));
        fly(&scenario, job.studied, 24.0, programme)
    });
    headings(s, &jobs, &flights, k);
    mechanism(s, p, k);
}

fn headings(s: &mut Section, jobs: &[Job], flights: &[Flown], k: f64) {
    let heading = |f: &Flown| curve(f, 20, |m| m.attitude[2].to_degrees());
    let series = jobs
        .iter()
        .zip(flights)
        .enumerate()
        .map(|(i, (job, f))| Series::new(named(job.name, f), i, SeriesStyle::Line, heading(f)))
        .collect();
    s.figure(
        "Configuration A through the programme (turn of 30° at 10 s). The flexible mixer, whose yaw works the wrong way round \
         here, has turned beyond the drawing before the programme begins; the sign-aware flights lie on each other.",
        vec![Chart {
            title: format!("Heading in configuration A, K {k}"),
            x: Axis::between("time (s)", 0.0, 20.0),
            y: Axis::between("heading (°)", -20.0, 50.0),
            series,
            ..Chart::default()
        }],
    );
}

fn mechanism(s: &mut Section, p: &Printed, k: f64) {
    let hover = p.mass() * sophie_sim::plant::GRAVITY / 4.0;
    let at = AtThrust::new(p.text.infill_percent, k, hover);
    let (frozen, slow) = (at.frozen(-1.0), at.quasi_static(-1.0));
    // k_f (s² + 2ζωs + ω²) + (k_s - k_f) ω² = 0: zeros of yaw moment over thrust.
    let omega = core::f64::consts::TAU * f64::from(Params::default().notch_hz);
    let zeta = 0.15;
    let inner = (zeta * zeta - slow / frozen) * omega * omega;
    s.text(format!(
        "The mechanism in A: a rotor that speeds up first drags the vehicle round by its torque ({frozen:+.2} k_q at the frozen \
         tilt), then, when its arm has followed, pushes it the other way three times harder ({slow:+.2} k_q). That is a zero \
         in the right half plane at {:.0} rad/s: fast against the yaw loop's 3 rad/s, so that a loop which allocates by the \
         slow sign is stable. It has to cross no authority at all while spooling up, which costs heading on take-off, and it \
         lives on the model: B needs none of this and stays the right choice.",
        -zeta * omega + inner.max(0.0).sqrt()
    ));
}
