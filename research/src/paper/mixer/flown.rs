//! The mixers flown in gusts.

use crate::study::allocation::Studied;
use crate::study::rig::{Demand, Flown, Moment, fly};
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::parallel;

use super::super::flights::{curve, error, in_gusts, lost_when, named, or_lost, swing, vehicle};
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle, Table, num};

/// Shown time, s.
const WINDOW: f64 = 3.0;

struct Flies {
    name: &'static str,
    mixer: Variant,
    studied: Option<Studied>,
}

const fn flies(name: &'static str, mixer: Variant, studied: Option<Studied>) -> Flies {
    Flies { name, mixer, studied }
}

const FLOWN: [Flies; 5] = [
    flies("rigid", Variant::Rigid, None),
    flies(
        "paper: Algorithm 1 in the printed matrix, yaw row mended",
        Variant::Paper,
        None,
    ),
    flies(
        "Algorithm 1 with the sideways thrust in its yaw row",
        Variant::Flexible,
        Some(Studied::Verbatim),
    ),
    flies("inverse at the frozen arm angle", Variant::Frozen, None),
    flies("flexible (quasi-static), what flies", Variant::Flexible, None),
];
/// Places in [`FLOWN`].
pub const VERBATIM: usize = 2;
pub const FROZEN: usize = 3;
pub const FLEXIBLE: usize = 4;

struct Hover {
    /// Index in [`FLOWN`].
    mixer: usize,
    gain_k: f64,
    flown: Flown,
}

impl Hover {
    fn name(&self) -> &'static str {
        FLOWN[self.mixer].name
    }
}

/// The mixers at K = 1 and at the stack's gain.
pub struct Hovers {
    all: Vec<Hover>,
    gain_k: f64,
}

impl Hovers {
    /// Flies them at an infill of `infill` %.
    pub fn fly(infill: f64, gain_k: f64) -> Self {
        let jobs: Vec<(usize, f64)> = [1.0, gain_k]
            .iter()
            .flat_map(|k| (0..FLOWN.len()).map(move |i| (i, *k)))
            .collect();
        let all = parallel::each(&jobs, |(mixer, gain_k)| {
            let Flies {
                mixer: variant,
                studied,
                ..
            } = FLOWN[*mixer];
            let scenario = in_gusts(vehicle(Configuration::B, *gain_k, infill, variant));
            Hover {
                mixer: *mixer,
                gain_k: *gain_k,
                flown: fly(&scenario, studied, 20.0, |_| Demand::default()),
            }
        });
        Self { all, gain_k }
    }

    fn shown(&self) -> impl Iterator<Item = &Hover> {
        self.all.iter().filter(|h| h.gain_k == self.gain_k)
    }

    /// What each comes to.
    pub fn table(&self) -> Table {
        let mut t = Table::new(
            "The mixers flown: 20 s of hover in gusts of 0.35 N and 0.015 N·m RMS, configuration B",
            &[
                "mixer",
                "K",
                "roll RMS °",
                "pitch RMS °",
                "yaw RMS °",
                "swing of rotor 1 N",
                "lost",
            ],
        );
        for h in &self.all {
            t.row([
                h.name().into(),
                num(h.gain_k, 2),
                or_lost(error(&h.flown, 0), 2),
                or_lost(error(&h.flown, 1), 2),
                or_lost(error(&h.flown, 2), 2),
                or_lost(swing(&h.flown), 2),
                lost_when(&h.flown),
            ]);
        }
        t
    }

    /// Heading and thrust over time; `hover`: thrust per rotor, N.
    pub fn figure(&self, s: &mut Section, hover: f64) {
        s.figure(
            &format!(
                "The flights of the table at K {}; rigid and paper lie on each other. Of the thrust the first {WINDOW} s are \
                 shown: the frozen inverse runs its rotors from limit to limit.",
                self.gain_k
            ),
            vec![
                Chart {
                    title: "Yaw in gusts".to_owned(),
                    x: Axis::between("time (s)", 0.0, 20.0),
                    y: Axis::new("heading (°)"),
                    series: self.traces(|m| m.attitude[2].to_degrees()),
                    ..Chart::default()
                },
                Chart {
                    title: "Thrust asked of rotor 1".to_owned(),
                    x: Axis::between("time (s)", 0.0, WINDOW),
                    y: Axis::new("thrust (N)"),
                    series: self.traces(|m| m.asked[0]),
                    levels: vec![(hover, "hover".to_owned())],
                    ..Chart::default()
                },
            ],
        );
    }

    fn traces(&self, value: impl Fn(&Moment) -> f64) -> Vec<Series> {
        let trace = |h: &Hover| {
            let points = curve(&h.flown, 10, &value);
            Series::new(named(h.name(), &h.flown), h.mixer, SeriesStyle::Line, points)
        };
        self.shown().map(trace).collect()
    }

    /// Result of a mixer at the stack's gain, in words.
    pub fn outcome(&self, mixer: usize) -> String {
        let hover = self.shown().find(|h| h.mixer == mixer);
        hover.map_or("not flown".to_owned(), |h| match error(&h.flown, 2) {
            None => "loses yaw".to_owned(),
            Some(yaw) => format!("holds yaw within {yaw:.1}° RMS"),
        })
    }
}
