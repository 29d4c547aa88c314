//! Every mixer over infill, gain and configuration.

use crate::study::allocation::Studied;
use crate::study::rig::{Flown, fly};
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::parallel;

use super::super::flights::{BOTH, error, in_gusts, or_lost, vehicle};
use super::super::statics::AtThrust;
use super::{mismatch, programme};
use crate::results::model::{Axis, Chart, Section, Table, Tile, num};

struct Compared {
    name: &'static str,
    mixer: Variant,
    studied: Option<Studied>,
}

const fn compared(name: &'static str, mixer: Variant, studied: Option<Studied>) -> Compared {
    Compared { name, mixer, studied }
}

const MIXERS: [Compared; 5] = [
    compared("rigid", Variant::Rigid, None),
    compared("paper", Variant::Paper, None),
    compared("rigid, same true yaw gain", Variant::Rigid, None),
    compared("flexible", Variant::Flexible, None),
    compared("sign-aware", Variant::Flexible, Some(Studied::SignAware)),
];
/// Places in [`MIXERS`].
pub const RIGID: usize = 0;
pub const PAPER: usize = 1;
/// Rigid mixer, yaw gain over 1 - C_ψ: as fast as the flexible one.
pub const FAIR: usize = 2;
pub const FLEXIBLE: usize = 3;
pub const SIGN_AWARE: usize = 4;

const INFILLS: [f64; 6] = [4.0, 5.0, 6.0, 6.9, 8.0, 10.0];
const GAINS: [f64; 5] = [1.0, 2.0, 3.5, 5.03, 7.75];
/// Yaw error at which a map's shade is bad, ° RMS.
const POOR: f64 = 6.0;

const fn flown_in(configuration: Configuration) -> &'static [usize] {
    match configuration {
        Configuration::A => &[RIGID, PAPER, FLEXIBLE, SIGN_AWARE],
        Configuration::B => &[RIGID, PAPER, FAIR, FLEXIBLE],
    }
}

/// A vehicle and its mixer.
#[derive(Clone, Copy, PartialEq)]
pub struct Job {
    pub configuration: Configuration,
    pub infill: f64,
    pub gain_k: f64,
    /// Place in [`MIXERS`].
    pub mixer: usize,
    /// Arms off the model, as of a real set.
    pub mismatched: bool,
}

impl Job {
    fn fly(&self) -> Flown {
        let Compared { mixer, studied, .. } = MIXERS[self.mixer];
        let mut s = in_gusts(vehicle(self.configuration, self.gain_k, self.infill, mixer));
        if self.mismatched {
            mismatch(&mut s);
        }
        if self.mixer == FAIR {
            let hover = s.vehicle.body.mass * sophie_sim::plant::GRAVITY / 4.0;
            let at = AtThrust::new(self.infill, self.gain_k, hover);
            let c = at.yaw_derivative(f64::from(self.configuration.chi()));
            let slower = (1.0 / (1.0 - c)) as f32;
            s.params.rate_yaw_p *= slower;
            s.params.rate_yaw_i *= slower;
        }
        fly(&s, studied, 20.0, programme)
    }
}

/// RMS errors of a flight, degrees; `None` if lost.
pub struct Outcome {
    pub roll: Option<f64>,
    pub yaw: Option<f64>,
    lost: bool,
}

/// Mismatched arms at all gains, modelled ones at the stack's.
pub struct Grid {
    jobs: Vec<Job>,
    outcomes: Vec<Outcome>,
}

impl Grid {
    /// Flies it; `k` is the stack's gain.
    pub fn fly(k: f64) -> Self {
        let mut jobs = vec![];
        for configuration in BOTH {
            for mixer in flown_in(configuration).iter().copied() {
                for infill in INFILLS {
                    let job = |gain_k, mismatched| Job {
                        configuration,
                        infill,
                        gain_k,
                        mixer,
                        mismatched,
                    };
                    jobs.extend(GAINS.map(|gain_k| job(gain_k, true)));
                    jobs.push(job(k, false));
                }
            }
        }
        let outcomes = parallel::each(&jobs, |job| {
            let f = job.fly();
            Outcome {
                roll: error(&f, 0),
                yaw: error(&f, 2),
                lost: f.lost.is_some(),
            }
        });
        Self { jobs, outcomes }
    }

    /// Outcome of a job.
    pub fn of(&self, job: Job) -> Option<&Outcome> {
        let at = self.jobs.iter().position(|j| *j == job);
        at.and_then(|i| self.outcomes.get(i))
    }

    /// Flights that a mixer survives, in words.
    pub fn kept(&self, configuration: Configuration, mixer: usize) -> String {
        let of = |j: &Job| j.configuration == configuration && j.mixer == mixer && j.mismatched;
        let flights = || self.jobs.iter().zip(&self.outcomes).filter(|(j, _)| of(j));
        let kept = flights().filter(|(_, f)| !f.lost).count();
        format!("{kept} of {}", flights().count())
    }

    /// Tracking and disturbance rejection at the stack's gain `k`.
    pub fn tracking(&self, k: f64) -> Table {
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
                for infill in INFILLS {
                    let job = |mismatched| Job {
                        configuration,
                        infill,
                        gain_k: k,
                        mixer,
                        mismatched,
                    };
                    let (Some(a), Some(b)) = (self.of(job(false)), self.of(job(true))) else {
                        continue;
                    };
                    t.row([
                        format!("{configuration:?}").into(),
                        MIXERS[mixer].name.into(),
                        num(infill, 1),
                        or_lost(a.roll, 2),
                        or_lost(a.yaw, 2),
                        or_lost(b.roll, 2),
                        or_lost(b.yaw, 2),
                    ]);
                }
            }
        }
        t
    }

    /// Flyable regions, B before A.
    pub fn maps(&self, s: &mut Section) {
        let maps = BOTH.into_iter().rev().flat_map(|c| {
            let of_mixer = move |m: &usize| self.map(c, *m);
            flown_in(c).iter().map(of_mixer)
        });
        s.figure(
            "The flyable region with mismatched arms (15 % and 3° off the model): yaw error RMS in degrees, red where the vehicle \
             is lost.",
            maps.collect(),
        );
    }

    fn map(&self, configuration: Configuration, mixer: usize) -> Chart {
        let mut tiles = vec![];
        for (column, infill) in INFILLS.into_iter().enumerate() {
            for (row, gain_k) in GAINS.into_iter().enumerate() {
                let job = Job {
                    configuration,
                    infill,
                    gain_k,
                    mixer,
                    mismatched: true,
                };
                let yaw = self.of(job).and_then(|f| f.yaw);
                tiles.push(Tile {
                    at: (column as f64, row as f64),
                    size: (1.0, 1.0),
                    shade: yaw.map_or(-1.0, |y| (1.0 - y / POOR).max(0.0)),
                    text: yaw.map_or("lost".to_owned(), |y| format!("{y:.1}")),
                });
            }
        }
        Chart {
            title: format!("{configuration:?}, {}", MIXERS[mixer].name),
            x: Axis::of_cells("infill ρ (%)", INFILLS.iter().map(f64::to_string).collect()),
            y: Axis::of_cells("gain K", GAINS.iter().map(f64::to_string).collect()),
            tiles,
            ..Chart::default()
        }
    }
}
