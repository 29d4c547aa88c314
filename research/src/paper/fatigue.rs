//! Section V-C: an arm loses stiffness, in flight and as measured on board.

use crate::study::rig::{Demand, Flown, Moment, fly};
use sophie_control::allocation::wrench::Configuration;
use sophie_control::params::Params;
use sophie_sim::mixers::Variant;

use super::flights::{error, in_gusts, lost_when, or_lost, vehicle};
use super::printed::Printed;
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle, Table, num};
use sophie_sim::parallel;

/// Compliance of arm 1 over a new arm's.
const WORN: [f64; 6] = [1.0, 1.1, 1.2, 1.3, 1.4, 1.5];
/// Averaging time of the on-board comparison, s.
const WINDOW: f64 = 5.0;
/// s.
const SECONDS: f64 = 25.0;

#[derive(Clone, Copy)]
struct Job {
    infill: f64,
    worn: f64,
    mixer: Variant,
    sensors: bool,
}

fn hover(job: Job) -> Flown {
    let k = f64::from(Params::default().gain_k);
    let mut s = in_gusts(vehicle(Configuration::B, k, job.infill, job.mixer));
    s.vehicle.arm_gain = [job.worn, 1.0, 1.0, 1.0];
    if !job.sensors {
        s.params.tilt_bias_gain = 0.0;
    }
    fly(&s, None, SECONDS, |_| Demand::default())
}

fn mean(moments: &[Moment], f: impl Fn(&Moment) -> f64) -> f64 {
    moments.iter().map(f).sum::<f64>() / moments.len().max(1) as f64
}

fn heading(flown: &Flown) -> f64 {
    mean(&flown.moments, |m| m.attitude[2] - m.target[2]).to_degrees()
}

/// Learnt bias of arm 1 (°): mean over the windows, and spread of their means.
fn seen(flown: &Flown) -> (f64, f64) {
    let settled: Vec<Moment> = flown.moments.iter().filter(|m| m.t > 5.0).copied().collect();
    let windows: Vec<f64> = settled
        .chunks((WINDOW * 1e3) as usize)
        .map(|w| mean(w, |m| m.bias[0]).to_degrees())
        .collect();
    let middle = windows.iter().sum::<f64>() / windows.len().max(1) as f64;
    let spread = windows.iter().map(|w| (w - middle).powi(2)).sum::<f64>() / windows.len().max(1) as f64;
    (middle, spread.sqrt())
}

struct Kind {
    name: &'static str,
    mixer: Variant,
    sensors: bool,
}

const KINDS: [Kind; 3] = [
    Kind {
        name: "flexible with arm IMUs",
        mixer: Variant::Flexible,
        sensors: true,
    },
    Kind {
        name: "flexible, model alone",
        mixer: Variant::Flexible,
        sensors: false,
    },
    Kind {
        name: "rigid",
        mixer: Variant::Rigid,
        sensors: true,
    },
];

struct Flights {
    /// Index in [`KINDS`], and flight.
    jobs: Vec<(usize, Job)>,
    flown: Vec<Flown>,
}

impl Flights {
    fn fly(infill: f64) -> Self {
        let mut jobs: Vec<(usize, Job)> = vec![];
        for (i, kind) in KINDS.iter().enumerate() {
            let job = |worn| Job {
                infill,
                worn,
                mixer: kind.mixer,
                sensors: kind.sensors,
            };
            jobs.extend(WORN.map(|worn| (i, job(worn))));
        }
        let flown = parallel::each(&jobs, |(_, job)| hover(*job));
        Self { jobs, flown }
    }

    fn of(&self, kind: usize, worn: f64) -> Option<&Flown> {
        let at = self.jobs.iter().position(|(i, j)| *i == kind && j.worn == worn);
        at.and_then(|i| self.flown.get(i))
    }

    fn table(&self, infill: f64) -> Table {
        let mut t = Table::new(
            &format!("25 s of hover in gusts, ρ {infill} %, arm 1 softer"),
            &[
                "mixer",
                "compliance of arm 1",
                "yaw RMS °",
                "mean of it °",
                "roll RMS °",
                "spread of mean thrusts N",
                "lost",
            ],
        );
        for ((kind, job), f) in self.jobs.iter().zip(&self.flown) {
            t.row([
                KINDS[*kind].name.into(),
                num(job.worn, 1),
                or_lost(error(f, 2), 2),
                num(heading(f), 2),
                or_lost(error(f, 0), 2),
                num(apart(f), 2),
                lost_when(f),
            ]);
        }
        t
    }
}

fn apart(f: &Flown) -> f64 {
    let thrusts: Vec<f64> = (0..4).map(|i| mean(&f.moments, |m| m.thrust[i])).collect();
    thrusts.iter().copied().fold(f64::MIN, f64::max) - thrusts.iter().copied().fold(f64::MAX, f64::min)
}

struct OnBoard {
    worn: f64,
    /// True tilt less the model's.
    truth: f64,
    learnt: f64,
    /// Spread of the windows' means.
    spread: f64,
}

fn on_board(flights: &Flights, infill: f64) -> Vec<OnBoard> {
    let model = sophie_control::allocation::arm_deflection::ArmModel::from_params(&Params {
        infill: infill as f32,
        ..Params::default()
    });
    let of = |worn: f64| {
        let f = flights.of(0, worn)?;
        let settled: Vec<Moment> = f.moments.iter().filter(|m| m.t > 5.0).copied().collect();
        let off = |m: &Moment| m.tilt[0] - f64::from(model.angle(m.thrust[0] as f32));
        let (learnt, spread) = seen(f);
        Some(OnBoard {
            worn,
            truth: mean(&settled, off).to_degrees(),
            learnt,
            spread,
        })
    };
    WORN.into_iter().filter_map(of).collect()
}

fn on_board_table(seen: &[OnBoard]) -> Table {
    let mut t = Table::new(
        "What the comparison of measured and modelled α sees on board, means over 5 s",
        &[
            "compliance of arm 1",
            "true α1 less model °",
            "learnt bias of arm 1 °",
            "spread of 5 s means °",
        ],
    );
    for at in seen {
        t.row([
            num(at.worn, 1),
            num(at.truth, 2),
            num(at.learnt, 2),
            num(at.spread, 2),
        ]);
    }
    t
}

/// Yaw error per kind, on-board bias and its detection `level` (°).
fn figure(s: &mut Section, flights: &Flights, seen: &[OnBoard], level: f64) {
    let yaw = |kind: usize| {
        let flown = |worn: f64| {
            let yaw = error(flights.of(kind, worn)?, 2);
            Some((worn, yaw.unwrap_or(f64::NAN)))
        };
        WORN.into_iter().filter_map(flown).collect()
    };
    let kinds = KINDS.iter().enumerate();
    s.figure(
        "Left: yaw error as arm 1 softens. Right: what the arm's own sensor tells of it; above the dashed level it is more \
         than three spreads of the new arm's.",
        vec![
            Chart {
                title: "Flight with a worn arm".to_owned(),
                x: Axis::new("compliance of arm 1 over new"),
                y: Axis::new("yaw error RMS (°)").with(&[0.0]),
                series: kinds.map(|(i, k)| Series::new(k.name, i, SeriesStyle::Line, yaw(i))).collect(),
                ..Chart::default()
            },
            Chart {
                title: "Seen on board".to_owned(),
                x: Axis::new("compliance of arm 1 over new"),
                y: Axis::new("α1 above the model (°)").with(&[0.0]),
                series: vec![
                    Series::new("true", 7, SeriesStyle::Dashed, seen.iter().map(|s| (s.worn, s.truth)).collect()),
                    Series::new("learnt by the mixer", 0, SeriesStyle::Dots, seen.iter().map(|s| (s.worn, s.learnt)).collect()),
                ],
                levels: vec![(level, "three spreads above the new arm".to_owned())],
                ..Chart::default()
            },
        ],
    );
}

/// Material degradation.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("fatigue", "Section V-C: an arm that loses stiffness");
    let infill = p.text.infill_percent;
    let flights = Flights::fly(infill);
    s.text(format!(
        "The paper reports fibre ruptures after {:.0} to {:.0} bending cycles and deflections \"above expectations\", without a \
         law or a size. Here arm 1 is made softer by up to half, the other three stay new, and the stack goes on believing \
         in the new arm. Compliance in the place of cycles is our choice.",
        p.text.fatigue_cycles[0], p.text.fatigue_cycles[1]
    ));
    s.table(flights.table(infill));
    s.text(
        "The rigid mixer's smaller yaw error is not a better allocation: in B its yaw commands come out 1 - C times larger, \
         so its loop is that much faster. What the wear does to each is how its own rows grow.",
    );
    let seen = on_board(&flights, infill);
    let (new, noise) = seen
        .first()
        .map_or((0.0, f64::NAN), |s| (s.learnt, 3.0 * s.spread));
    let shows = seen.iter().find(|s| (s.learnt - new).abs() > noise);
    let first = shows.map_or(f64::NAN, |s| s.worn);
    s.table(on_board_table(&seen));
    figure(&mut s, &flights, &seen, new + noise);
    let [with_model, without] = soft_airframes(&mut s, p);
    let off = |kind: usize| {
        let yaw = flights.of(kind, 1.5).and_then(|f| error(f, 2));
        yaw.map_or("lost".to_owned(), |e| format!("{e:.1}°"))
    };
    let apart = flights.of(0, 1.5).map_or(f64::NAN, apart);
    s.finding = format!(
        "The paper's mechanism is there, but mild in this model: one arm half as soft again drives the rotors {apart:.1} N \
         apart in hover, with a yaw error of {} RMS (flexible, arm IMUs), {} (flexible, model alone) and {} (rigid, a faster loop). On board \
         the worn arm shows from a compliance of {first:.1} on; since a new arm's own offset looks the same at one thrust, \
         it is the growth over flights that tells. The learnt bias is limited to {:.1}°. At ρ 4 % the \
         rigid mixer then stands {without:.1}° off its heading, the flexible one {with_model:.1}°.",
        off(0),
        off(1),
        off(2),
        f64::from(Params::default().tilt_bias_max).to_degrees()
    );
    s
}

/// "For ρ < 6 % the autopilot is not able to correct these perturbations in real time."
fn soft_airframes(s: &mut Section, p: &Printed) -> [f64; 2] {
    let infills = [4.0, 5.0, 6.0, 8.0];
    let jobs: Vec<Job> = infills
        .into_iter()
        .flat_map(|infill| {
            [Variant::Flexible, Variant::Rigid]
                .into_iter()
                .map(move |mixer| Job {
                    infill,
                    worn: 1.5,
                    mixer,
                    sensors: true,
                })
        })
        .collect();
    let flights = parallel::each(&jobs, |job| hover(*job));
    let mut t = Table::new(
        "The same with arm 1 half as soft again, over infill",
        &["ρ %", "mixer", "yaw RMS °", "mean of it °", "lost"],
    );
    for (job, f) in jobs.iter().zip(&flights) {
        t.row([
            num(job.infill, 0),
            format!("{:?}", job.mixer).to_lowercase().into(),
            or_lost(error(f, 2), 2),
            num(heading(f), 2),
            lost_when(f),
        ]);
    }
    s.table(t);
    let lost = flights.iter().filter(|f| f.lost.is_some()).count();
    let off = |i: usize| flights.get(i).map_or(f64::NAN, heading);
    s.text(format!(
        "\"For ρ < {:.0} % the autopilot is not able to correct these perturbations in real time\": of these {} flights {lost} \
         are lost, but the tendency is there for an autopilot that takes the arms as stiff, which stands {:.1}° off its \
         heading at 4 % where the flexible mixer stands {:.1}° off. What the model lacks that might make it worse: arm \
         torsion, bending in the plane, and the rotors' wakes on each other's arms.",
        p.text.flyable_infill_percent,
        flights.len(),
        off(1),
        off(0)
    ));
    [off(0), off(1)]
}
