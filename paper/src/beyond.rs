//! Beyond the paper: every mixer over infill, gain and configuration; what arm sensors add; how soft it can be.

use crate::study::allocation::Studied;
use crate::study::rig::{Flown, Wish, fly};
use glam::DVec3;
use sophie_control::params::Params;
use sophie_control::tendon::REFERENCE_TILT;
use sophie_control::wrench::Configuration;
use sophie_sim::mixers::Variant;

use super::flights::{BOTH, curve, error, in_gusts, lost_when, named, or_lost, vehicle};
use super::model::{Axis, Chart, Look, Section, Series, Table, Tile, num};
use super::printed::Printed;
use super::statics::AtThrust;
use sophie_sim::parallel;

/// The mixers that are compared.
const MIXERS: [(&str, Variant, Option<Studied>); 5] = [
    ("rigid", Variant::Rigid, None),
    ("paper", Variant::Paper, None),
    ("rigid, same true yaw gain", Variant::Rigid, None),
    ("flexible", Variant::Flexible, None),
    ("sign-aware", Variant::Flexible, Some(Studied::SignAware)),
];
/// Those that are flown in A and in B.
const IN_A: &[usize] = &[0, 1, 3, 4];
const IN_B: &[usize] = &[0, 1, FAIR, 3];
/// The rigid mixer with its yaw gain divided by 1 - C_ψ, so that the loop is as fast as the flexible mixer's.
const FAIR: usize = 2;

fn flown_in(configuration: Configuration) -> &'static [usize] {
    if configuration == Configuration::A {
        IN_A
    } else {
        IN_B
    }
}
const INFILLS: [f64; 6] = [4.0, 5.0, 6.0, 6.9, 8.0, 10.0];
const GAINS: [f64; 5] = [1.0, 2.0, 3.5, 5.03, 7.75];
/// Arms of a real set: softer and bent against the model.
const MISMATCH: ([f64; 4], [f64; 4]) = ([1.15, 0.85, 0.9, 1.1], [3.0, -3.0, 2.0, -2.0]);
/// Yaw error (° RMS) that shades a map from good to bad.
const POOR: f64 = 6.0;

#[derive(Clone, Copy)]
struct Job {
    configuration: Configuration,
    infill: f64,
    gain_k: f64,
    mixer: usize,
    mismatched: bool,
}

/// Hover in gusts, a roll of 15° to either side, a turn of 30°, a push of 1.5 N, in 20 s.
fn programme(t: f64) -> Wish {
    let mut wish = Wish::default();
    match t {
        t if (4.0..5.5).contains(&t) => wish.roll = 15f64.to_radians(),
        t if (5.5..7.0).contains(&t) => wish.roll = -15f64.to_radians(),
        t if (10.0..11.05).contains(&t) => wish.yaw_rate = 0.5,
        t if (14.0..16.0).contains(&t) => wish.push = DVec3::new(0.0, 1.5, 0.0),
        _ => {}
    }
    wish
}

fn fly_job(job: &Job) -> Flown {
    let (_, mixer, studied) = MIXERS[job.mixer];
    let mut s = in_gusts(vehicle(job.configuration, job.gain_k, job.infill, mixer));
    if job.mismatched {
        (s.vehicle.arm_gain, s.vehicle.arm_offset) = (MISMATCH.0, MISMATCH.1.map(f64::to_radians));
    }
    if job.mixer == FAIR {
        let hover = s.vehicle.body.mass * sophie_sim::plant::GRAVITY / 4.0;
        let c =
            AtThrust::new(job.infill, job.gain_k, hover).yaw_derivative(f64::from(job.configuration.chi()));
        let slower = (1.0 / (1.0 - c)) as f32;
        s.params.rate_yaw_p *= slower;
        s.params.rate_yaw_i *= slower;
    }
    fly(&s, studied, 20.0, programme)
}

/// Beyond the paper.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("beyond", "Beyond the paper: who flies what");
    let k = f64::from(Params::default().gain_k);
    s.text(
        "One programme for all: hover in gusts of 0.35 N and 0.015 N·m RMS, a roll to 15° on either side, a turn of 30°, a \
         sideways push of 1.5 N for 2 s. Gains are those of the stack, the same for every mixer; in B the rigid mixer's yaw \
         commands come out 1 - C times larger, so its tighter yaw is a higher gain, not a better allocation: the third mixer \
         is the rigid one with its yaw gain divided by that. Errors of yaw are against the heading that was asked for, also \
         where a stack has given yaw up.",
    );
    let mut jobs = vec![];
    for configuration in BOTH {
        for mixer in flown_in(configuration).iter().copied() {
            for infill in INFILLS {
                for gain_k in GAINS {
                    jobs.push(Job {
                        configuration,
                        infill,
                        gain_k,
                        mixer,
                        mismatched: true,
                    });
                }
                jobs.push(Job {
                    configuration,
                    infill,
                    gain_k: k,
                    mixer,
                    mismatched: false,
                });
            }
        }
    }
    let flights = parallel::each(&jobs, |job| {
        let f = fly_job(job);
        (error(&f, 0), error(&f, 1), error(&f, 2), f.lost)
    });
    let get = |job: Job| {
        let same = |j: &Job| {
            j.configuration == job.configuration
                && j.mixer == job.mixer
                && j.infill == job.infill
                && j.gain_k == job.gain_k
                && j.mismatched == job.mismatched
        };
        jobs.iter().position(same).and_then(|i| flights.get(i))
    };
    let mut t = Table::new(
        &format!(
            "Tracking and disturbance rejection at K {k}: RMS of target less truth, arms as modelled / mismatched"
        ),
        &[
            "configuration",
            "mixer",
            "ρ %",
            "roll °",
            "yaw °",
            "roll, mismatched °",
            "yaw, mismatched °",
        ],
    );
    for configuration in BOTH {
        for mixer in flown_in(configuration).iter().copied() {
            let name = MIXERS[mixer].0;
            for infill in INFILLS {
                let job = Job {
                    configuration,
                    infill,
                    gain_k: k,
                    mixer,
                    mismatched: false,
                };
                let (Some(a), Some(b)) = (
                    get(job),
                    get(Job {
                        mismatched: true,
                        ..job
                    }),
                ) else {
                    continue;
                };
                t.row([
                    format!("{configuration:?}").into(),
                    name.into(),
                    num(infill, 1),
                    or_lost(a.0, 2),
                    or_lost(a.2, 2),
                    or_lost(b.0, 2),
                    or_lost(b.2, 2),
                ]);
            }
        }
    }
    s.table(t);

    let map = |configuration: Configuration, mixer: usize| {
        let mut tiles = vec![];
        for infill in INFILLS {
            for (row, gain_k) in GAINS.into_iter().enumerate() {
                let job = Job {
                    configuration,
                    infill,
                    gain_k,
                    mixer,
                    mismatched: true,
                };
                let yaw = get(job).and_then(|f| f.2);
                tiles.push(Tile {
                    at: (
                        INFILLS.iter().position(|i| *i == infill).unwrap_or(0) as f64,
                        row as f64,
                    ),
                    size: (1.0, 1.0),
                    shade: yaw.map_or(-1.0, |y| (1.0 - y / POOR).max(0.0)),
                    text: yaw.map_or("lost".to_owned(), |y| format!("{y:.1}")),
                });
            }
        }
        Chart {
            title: format!("{configuration:?}, {}", MIXERS[mixer].0),
            x: Axis::of_cells("infill ρ (%)", list(&INFILLS)),
            y: Axis::of_cells("gain K", list(&GAINS)),
            tiles,
            ..Chart::default()
        }
    };
    s.figure(
        "The flyable region with mismatched arms (15 % and 3° off the model): yaw error RMS in degrees, red where the vehicle \
         is lost.",
        BOTH.into_iter().rev().flat_map(|c| flown_in(c).iter().map(move |m| (c, *m))).map(|(c, m)| map(c, m)).collect(),
    );
    let lost = |configuration: Configuration, mixer: usize| {
        let of = |j: &&Job| j.configuration == configuration && j.mixer == mixer && j.mismatched;
        let n = jobs.iter().filter(of).count();
        let lost = jobs
            .iter()
            .zip(&flights)
            .filter(|(j, f)| of(j) && f.3.is_some())
            .count();
        format!("{} of {n}", n - lost)
    };
    sensors(&mut s, k);
    soft(&mut s, p, k);
    configuration_a(&mut s, p, k);
    let yaw = |mixer: usize, mismatched: bool| {
        let job = Job {
            configuration: Configuration::B,
            infill: p.text.infill_percent,
            gain_k: k,
            mixer,
            mismatched,
        };
        get(job)
            .and_then(|f| f.2)
            .map_or("lost".to_owned(), |e| format!("{e:.1}°"))
    };
    s.finding = format!(
        "In B every mixer flies every infill from 4 % on: {}, {}, {} and {} cases of the map for rigid, paper, rigid at the \
         same true gain, flexible. Mismatched arms take yaw from {} to {} for the rigid mixer at the same true gain and from \
         {} to {} for the flexible one. In A rigid, paper and flexible keep {}, {} and {}; an allocation that knows where yaw \
         authority has turned round keeps {}.",
        lost(Configuration::B, 0),
        lost(Configuration::B, 1),
        lost(Configuration::B, FAIR),
        lost(Configuration::B, 3),
        yaw(FAIR, false),
        yaw(FAIR, true),
        yaw(3, false),
        yaw(3, true),
        lost(Configuration::A, 0),
        lost(Configuration::A, 1),
        lost(Configuration::A, 3),
        lost(Configuration::A, 4)
    );
    s
}

fn list(values: &[f64]) -> Vec<String> {
    values.iter().map(f64::to_string).collect()
}

/// What arm sensors add.
fn sensors(s: &mut Section, k: f64) {
    let infills = [5.0, 6.9, 10.0];
    let jobs: Vec<(f64, bool, u64)> = infills
        .into_iter()
        .flat_map(|i| {
            [true, false]
                .into_iter()
                .flat_map(move |on| (1..=4).map(move |seed| (i, on, seed)))
        })
        .collect();
    let flights = parallel::each(&jobs, |(infill, on, seed)| {
        let mut v = in_gusts(vehicle(Configuration::B, k, *infill, Variant::Flexible));
        (v.vehicle.arm_gain, v.vehicle.arm_offset) = (MISMATCH.0, MISMATCH.1.map(f64::to_radians));
        v.seed = *seed;
        if !on {
            v.params.tilt_bias_gain = 0.0;
        }
        let f = fly(&v, None, 20.0, programme);
        (error(&f, 2), f.lost.is_some())
    });
    let mut t = Table::new(
        "What the arms' own sensors add: flexible mixer, mismatched arms, four seeds",
        &["ρ %", "arm IMUs", "yaw RMS °, mean of those kept", "lost"],
    );
    for infill in infills {
        for on in [true, false] {
            let of: Vec<_> = jobs
                .iter()
                .zip(&flights)
                .filter(|((i, o, _), _)| *i == infill && *o == on)
                .map(|(_, f)| f)
                .collect();
            let kept: Vec<f64> = of.iter().filter_map(|f| f.0).collect();
            t.row([
                num(infill, 1),
                if on { "yes" } else { "no, model alone" }.into(),
                num(kept.iter().sum::<f64>() / kept.len() as f64, 2),
                format!("{} of {}", of.iter().filter(|f| f.1).count(), of.len()).into(),
            ]);
        }
    }
    s.table(t);
}

/// An airframe at the soft end.
#[derive(Clone, Copy)]
struct Soft {
    name: &'static str,
    infill: f64,
    /// Damping ratio of the arms.
    zeta: f64,
    notch: bool,
    /// Yaw rate gain, 1/s.
    yaw_gain: f32,
    /// Thrust at which the arms are level over the largest.
    level_share: f64,
}

/// How soft it can be.
fn soft(s: &mut Section, p: &Printed, k: f64) {
    let default = Params::default();
    let usual = Soft {
        name: "level at half throttle",
        infill: 4.0,
        zeta: 0.15,
        notch: true,
        yaw_gain: default.rate_yaw_p,
        level_share: f64::from(default.arm_level_share),
    };
    let springy = Soft {
        name: "ζ 0.05",
        zeta: 0.05,
        ..usual
    };
    let at = |soft: Soft, infill: f64| Soft { infill, ..soft };
    let printed_level = Soft {
        name: "level without thrust (α0 = 0)",
        level_share: 0.0,
        ..usual
    };
    let fast = Soft {
        name: "ζ 0.05, yaw gain 10",
        yaw_gain: 10.0,
        ..springy
    };
    let fast_bare = Soft {
        name: "ζ 0.05, yaw gain 10, no notch",
        notch: false,
        ..fast
    };
    let cases = [
        at(usual, 6.0),
        at(usual, 5.0),
        usual,
        at(usual, 3.0),
        springy,
        Soft {
            name: "ζ 0.05, no notch",
            notch: false,
            ..springy
        },
        fast,
        fast_bare,
        at(printed_level, 8.0),
        at(printed_level, 6.0),
        at(printed_level, 5.0),
        printed_level,
    ];
    let flights = parallel::each(&cases, |soft| {
        let mut v = in_gusts(vehicle(Configuration::B, k, soft.infill, Variant::Flexible));
        v.vehicle.arm_damping = soft.zeta;
        v.vehicle.arm_level_share = soft.level_share;
        v.params.arm_level_share = soft.level_share as f32;
        v.params.rate_yaw_p = soft.yaw_gain;
        if !soft.notch {
            // Zeros on the poles: the notch passes everything.
            v.params.notch_zeta_zero = v.params.notch_zeta_pole;
        }
        let f = fly(&v, None, 20.0, programme);
        let worst = f
            .moments
            .iter()
            .flat_map(|m| m.tilt)
            .fold(f64::NAN, |w: f64, a| w.max(a.abs()));
        let sink = f.moments.iter().fold(f64::NAN, |w: f64, m| w.max(m.velocity.z));
        (
            error(&f, 0),
            error(&f, 2),
            worst.to_degrees(),
            sink,
            lost_when(&f),
        )
    });
    let mut t = Table::new(
        "How soft it can be: configuration B, flexible mixer, the programme above",
        &[
            "arms",
            "ρ %",
            "roll RMS °",
            "yaw RMS °",
            "largest |α| °",
            "fastest sink m/s",
            "lost",
        ],
    );
    for (soft, (roll, yaw, worst, sink, lost)) in cases.iter().zip(&flights) {
        t.row([
            soft.name.into(),
            num(soft.infill, 0),
            or_lost(*roll, 2),
            or_lost(*yaw, 2),
            num(*worst, 1),
            num(*sink, 2),
            lost.clone(),
        ]);
    }
    s.table(t);
    let bent = |i: usize| flights.get(i).map_or(f64::NAN, |f| f.2);
    // With α0 = 0 lift is what runs out: the largest T cos α over the rotor's range.
    let top = f64::from(Params::default().thrust_max);
    let lift = |infill: f64| {
        let (a, b) = super::arm::literal(&p.table_1, infill);
        let weight = p.mass() * sophie_sim::plant::GRAVITY / 4.0;
        (1..=400)
            .map(|i| top * f64::from(i) / 400.0)
            .map(|t| t * (k * (a + b * t) * t).to_radians().cos() / weight)
            .fold(0.0, f64::max)
    };
    s.text(format!(
        "The paper stops at 6 % and hands everything below 5 % to machine learning. With arms that are level at half throttle \
         nothing in this model stops at 5 or 4 %: an allocation that knows Eq. 1 flies them. The notch at the arms' mode is \
         what lets the gain rise: with a yaw gain of 10 on springy arms (ζ 0.05) they tilt by {:.1}° with it and by {:.1}° \
         without. The limit that does appear is lift, if the arms are level without thrust and all bend up: largest lift \
         over weight {:.2}, {:.2}, {:.2} and {:.2} at ρ 6.9, 6, 5 and 4 %, at tilts beyond the {}° up to which the paper's \
         statics are said to hold. The last rows of the table fly such arms: from {:.0}° on the released tendons are taut and \
         hold them, which saves the lift and the flight but is no part of Eq. 1: the learnt bias goes to its limit. \
         Algorithm 1's own rule, which sets α to 0 beyond 40°, is a jump of 40° in the mixer that a softer arm meets first.",
        bent(6),
        bent(7),
        lift(6.9),
        lift(6.0),
        lift(5.0),
        lift(4.0),
        p.eq_1.valid_tilt_deg,
        f64::from(REFERENCE_TILT).to_degrees()
    ));
}

/// Why A is lost, and how it can be flown.
fn configuration_a(s: &mut Section, p: &Printed, k: f64) {
    let infill = p.text.infill_percent;
    let jobs = [
        ("flexible", Variant::Flexible, None, infill),
        ("sign-aware", Variant::Flexible, Some(Studied::SignAware), infill),
        (
            "sign-aware, ρ 10 %",
            Variant::Flexible,
            Some(Studied::SignAware),
            10.0,
        ),
        (
            "sign-aware, ρ 4 %",
            Variant::Flexible,
            Some(Studied::SignAware),
            4.0,
        ),
    ];
    let flights = parallel::each(&jobs, |(_, mixer, studied, infill)| {
        fly(
            &in_gusts(vehicle(Configuration::A, k, *infill, *mixer)),
            *studied,
            24.0,
            programme,
        )
    });
    let series = jobs
        .iter()
        .zip(&flights)
        .enumerate()
        .map(|(i, ((name, ..), f))| {
            Series::new(
                named(name, f),
                i,
                Look::Line,
                curve(f, 20, |m| m.attitude[2].to_degrees()),
            )
        })
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
    let at = AtThrust::new(infill, k, p.mass() * sophie_sim::plant::GRAVITY / 4.0);
    let (frozen, slow) = (at.frozen(-1.0), at.quasi_static(-1.0));
    // k_f (s² + 2ζωs + ω²) + (k_s - k_f) ω² = 0: the zeros of the yaw moment over thrust.
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
