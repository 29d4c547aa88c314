//! What became of a flight, by the plant's true state and by who ended it.

use core::f64::consts::PI;

use sophie_control::mode::Mode;
use sophie_sim::plant::contact::BELLY_Z;
use sophie_sim::record::{Ended, FlightRecord, Sample};
use sophie_sim::scenario::{Assist, Step};

/// Sink rate that no mode of the vehicle and no pilot means, m/s: it falls.
const FALLS: f64 = 2.0;
/// Tilt at which it is tipped over, rad.
const TIPPED: f64 = 80.0 * PI / 180.0;
/// Height of the belly below which it lies or stands on the ground, m.
const ON_GROUND: f64 = 0.05;

/// What became of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The grip is proven and holds to the end of the hold.
    Perched,
    /// The design check fails for the vehicle as its builder knows it, the stack does not arm, or on the demand to perch
    /// it stays in free flight.
    Refused,
    /// No perch: in the air, or down and upright. The pilot gave up, the time was over, or the stack left the pipe.
    HandedBack,
    /// On the ground beside the pipe, falling, tipped over or lost.
    Fallen,
    /// The judge refuses the grip: too little or too much pressure or tension, slip, or a perch that ends during the hold.
    NotHolding,
}

impl Class {
    /// Best first.
    pub const ALL: [Self; 5] = [
        Self::Perched,
        Self::Refused,
        Self::HandedBack,
        Self::NotHolding,
        Self::Fallen,
    ];

    /// In files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Perched => "perched",
            Self::Refused => "refused",
            Self::HandedBack => "handed_back",
            Self::Fallen => "fallen",
            Self::NotHolding => "not_holding",
        }
    }

    /// For people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Perched => "perched",
            Self::Refused => "refused",
            Self::HandedBack => "handed back",
            Self::Fallen => "fallen",
            Self::NotHolding => "not holding",
        }
    }

    /// Of its [`Class::word`].
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.word() == word)
    }

    /// The vehicle or its load may be damaged.
    #[must_use]
    pub const fn is_bad(self) -> bool {
        matches!(self, Self::Fallen | Self::NotHolding)
    }

    /// Of a flight: the first that applies of arming refused, fallen, the grip's verdict, perching refused, handed back.
    #[must_use]
    pub fn of(record: &FlightRecord) -> Self {
        if !armed(record) {
            return Self::Refused;
        }
        if fallen(record) {
            return Self::Fallen;
        }
        match grip(record) {
            Grip::Holds => Self::Perched,
            Grip::Fails => Self::NotHolding,
            Grip::Never if demand_refused(record) => Self::Refused,
            Grip::Never => Self::HandedBack,
        }
    }
}

/// The judge's verdict on the grip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grip {
    Never,
    Holds,
    Fails,
}

/// Reads the verdict: the judge ends a flight whose grip it refuses, or whose tendons or skin are overloaded on the way to
/// it. The only place that knows how the judge is recorded.
fn grip(record: &FlightRecord) -> Grip {
    let at_pipe = begun(record).any(is_at_pipe);
    if at_pipe && record.outcome.ended == Ended::Judged {
        return Grip::Fails;
    }
    if record.grip.is_empty() {
        return Grip::Never;
    }
    let steps = record.scenario.steps.iter().zip(&record.phases);
    let held = steps.filter(|(step, _)| matches!(step, Step::Hold { .. }));
    let held_throughout = held.clone().count() > 0 && held.clone().all(|(_, phase)| phase.done);
    // Cut short by the time limit alone.
    let holds_yet = record.outcome.ended == Ended::TimeLimit
        && record
            .samples
            .last()
            .is_some_and(|last| last.mode == Mode::Perched);
    // A proof that the stack takes back while its rotors turn is a grip that it refuses.
    let relied_on = record.samples.iter().any(|sample| sample.mode == Mode::Perched);
    if held_throughout || holds_yet {
        Grip::Holds
    } else if relied_on {
        Grip::Fails
    } else {
        Grip::Never
    }
}

fn armed(record: &FlightRecord) -> bool {
    let steps = record.scenario.steps.iter().zip(&record.phases);
    let mut arming = steps.filter(|(step, _)| matches!(step, Step::Arm));
    arming.next().is_none_or(|(_, phase)| phase.done)
}

fn fallen(record: &FlightRecord) -> bool {
    let Some(last) = record.samples.last() else {
        return false;
    };
    let [roll, pitch, _] = last.attitude;
    let tilt = libm::acos((libm::cos(roll) * libm::cos(pitch)).clamp(-1.0, 1.0));
    let [.., sink] = last.velocity;
    let sound = last.position.iter().all(|place| place.is_finite()) && tilt <= TIPPED && sink <= FALLS;
    // The stack or the pilot may land beside the pipe on purpose.
    let landed = matches!(last.mode, Mode::Failsafe | Mode::Landed | Mode::Disarmed);
    let lies = begun(record).last().is_some_and(is_at_pipe) && belly(last) < ON_GROUND && !landed;
    record.outcome.ended == Ended::Lost || !sound || lies
}

/// Height of the belly over the ground, m.
fn belly(sample: &Sample) -> f64 {
    let [.., down] = sample.position;
    -down - BELLY_Z
}

/// On the demand to perch the stack stays in free flight.
fn demand_refused(record: &FlightRecord) -> bool {
    let alone = record.scenario.pilot.assist == Assist::Autonomous;
    let demanded = begun(record).any(|step| match step {
        // By hand the pilot flies it.
        Step::Touch => alone,
        Step::Clamp { .. } | Step::Perch { .. } => true,
        _ => false,
    });
    let obeyed = |sample: &Sample| {
        matches!(
            sample.mode,
            Mode::Approach
                | Mode::Contact
                | Mode::Clamping
                | Mode::Perched
                | Mode::Releasing
                | Mode::Escaping
        )
    };
    demanded && !record.samples.iter().any(obeyed)
}

/// Steps that were begun, in order.
fn begun(record: &FlightRecord) -> impl Iterator<Item = &Step> {
    record.scenario.steps.iter().take(record.phases.len())
}

fn is_at_pipe(step: &Step) -> bool {
    matches!(
        step,
        Step::Touch
            | Step::Clamp { .. }
            | Step::Perch { .. }
            | Step::Hold { .. }
            | Step::Open
            | Step::Release
    )
}

#[cfg(test)]
mod tests {
    use sophie_sim::record::{Grip as ProvenGrip, Outcome, Phase};
    use sophie_sim::scenario::Scenario;

    use super::*;

    /// A record of the default mission that ends in step `last`, in the air over the pipe.
    fn record(last: &str, ended: Ended, mode: Mode) -> FlightRecord {
        let scenario = Scenario::default_mission();
        let begun = 1 + scenario
            .steps
            .iter()
            .position(|step| step.name() == last)
            .unwrap();
        let phases = scenario
            .steps
            .iter()
            .take(begun)
            .enumerate()
            .map(|(index, step)| Phase {
                name: step.name().to_owned(),
                start: 0.0,
                end: 1.0,
                done: index + 1 < begun || ended == Ended::Done,
                worst_attitude_error: 0.0,
                worst_tilt: 0.0,
                saturation: 0.0,
                battery_voltage: 16.0,
                overruns: 0,
            });
        let sample = Sample {
            mode,
            position: [3.0, 0.0, -1.6],
            ..Sample::default()
        };
        FlightRecord {
            phases: phases.collect(),
            scenario,
            outcome: Outcome {
                accomplished: ended == Ended::Done,
                ended,
                reason: String::new(),
            },
            verdicts: Vec::new(),
            samples: vec![sample],
            events: Vec::new(),
            grip: Vec::new(),
            strikes: Vec::new(),
            sim_seconds: 1.0,
            wall_seconds: 0.0,
            overruns: 0,
            digest: 0,
        }
    }

    fn proven(mut record: FlightRecord) -> FlightRecord {
        record.grip.push(ProvenGrip {
            arm: 1,
            pressure: 950.0,
            pressure_true: 950.0,
            torque: 0.5,
            closure: 2.0,
        });
        record
    }

    fn with(mut record: FlightRecord, change: impl FnOnce(&mut Sample)) -> FlightRecord {
        change(record.samples.last_mut().unwrap());
        record
    }

    #[test]
    fn each_class_is_read_from_the_record() {
        use Class::*;
        use Ended::*;
        let at = record;
        for (what, record, class) in [
            (
                "mission done",
                proven(at("disarm", Done, Mode::Disarmed)),
                Perched,
            ),
            (
                "not let go",
                proven(at("release", GivenUp, Mode::Perched)),
                Perched,
            ),
            (
                "time over while it holds",
                proven(at("hold", TimeLimit, Mode::Perched)),
                Perched,
            ),
            ("not armed", at("arm", GivenUp, Mode::Disarmed), Refused),
            (
                "perch switch without effect",
                at("perch", GivenUp, Mode::Flight),
                Refused,
            ),
            (
                "rolled badly",
                at("fly-to-pipe", Judged, Mode::Flight),
                HandedBack,
            ),
            ("misses the pipe", at("touch", GivenUp, Mode::Flight), HandedBack),
            (
                "leaves the pipe",
                at("perch", GivenUp, Mode::Escaping),
                HandedBack,
            ),
            (
                "time over in the air",
                at("take-off", TimeLimit, Mode::Flight),
                HandedBack,
            ),
            (
                "proven wrongly",
                proven(at("perch", Judged, Mode::Clamping)),
                NotHolding,
            ),
            (
                "overloaded before the proof",
                at("perch", Judged, Mode::Clamping),
                NotHolding,
            ),
            (
                "grip lost",
                proven(at("hold", GivenUp, Mode::Perched)),
                NotHolding,
            ),
            (
                "grip given up before the rotors stop",
                proven(at("perch", GivenUp, Mode::Escaping)),
                HandedBack,
            ),
            ("spins", at("roll", Lost, Mode::Flight), Fallen),
            (
                "spins after a perch",
                proven(at("land", Lost, Mode::Flight)),
                Fallen,
            ),
            (
                "falls, though proven",
                with(proven(at("hold", Judged, Mode::Perched)), |s| {
                    s.velocity = [0.0, 0.0, 2.1]
                }),
                Fallen,
            ),
            (
                "tipped over",
                with(at("perch", GivenUp, Mode::Clamping), |s| {
                    s.attitude = [1.5, 0.0, 0.0]
                }),
                Fallen,
            ),
            (
                "beside the pipe",
                with(at("perch", GivenUp, Mode::Escaping), |s| {
                    s.position = [3.0, 0.2, -0.05]
                }),
                Fallen,
            ),
            (
                "landed by the failsafe",
                with(at("touch", GivenUp, Mode::Landed), |s| {
                    s.position = [3.0, 1.0, -0.05]
                }),
                HandedBack,
            ),
            (
                "diverged",
                with(at("roll", Judged, Mode::Flight), |s| s.position = [f64::NAN; 3]),
                Fallen,
            ),
        ] {
            assert_eq!(Class::of(&record), class, "{what}");
        }
    }

    #[test]
    fn a_stack_that_perches_on_demand_refuses_from_the_touch_on() {
        let mut record = record("touch", Ended::GivenUp, Mode::Hold);
        record.scenario.pilot.assist = Assist::Autonomous;
        assert_eq!(Class::of(&record), Class::Refused);
        record.samples.insert(
            0,
            Sample {
                mode: Mode::Approach,
                ..Sample::default()
            },
        );
        assert_eq!(Class::of(&record), Class::HandedBack);
    }

    #[test]
    fn words_are_read_back() {
        for class in Class::ALL {
            assert_eq!(Class::from_word(class.word()), Some(class));
        }
        assert_eq!(Class::from_word("lost"), None);
    }
}
