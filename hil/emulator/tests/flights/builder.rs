//! The scripted builder whom `sophie bringup` leads: replies, and the handling of the vehicle before each.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use sophie_bringup::{Reply, User};
use sophie_control::calibration::Face;
use sophie_control::params::Params;
use sophie_control::pilot::rc::{ArmChoice, StickMode, Sticks};
use sophie_emulator::bench_operator::{BenchOperator, Handling};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::scale::Scale;
use sophie_sim::test_stands::twist_stand::TwistStand;

use super::scenario;

/// Time of the board until a change of handling has passed turn and filters, ms.
const SETTLED: u64 = 800;
/// Wall time after which the board counts as stopped.
const STILL: Duration = Duration::from_secs(300);
/// Bend of an arm in its cradle, rad, as on the pipe.
const CRADLE: f64 = 1.19;
/// Sliding friction of the builder's pipe.
pub(super) const FRICTION: f64 = 0.42;
/// A tip bent up, rad.
const BENT: f64 = 0.3;
/// Weight on a tip, N, as the walk proposes it, and the time to hang it on, ms.
const TIP_WEIGHT: f64 = 3.0;
const HANGS: u64 = 2000;
/// On a pad under a thumb, Pa.
const THUMB: f64 = 900.0;

/// Charge of the used battery, share.
const USED: f64 = 0.35;
/// RMS of what a person reads at a scale under rotors, share, and looks at it that count.
const FLUCTUATION: f64 = 0.01;
const SHOWN: usize = 5;

/// A change of handling and its duration, ms of the board's time.
struct Move {
    ms: u64,
    operator: fn(&mut Handling),
}

pub(super) struct Builder {
    operator: BenchOperator,
    /// Stops at this step.
    until: Option<&'static str>,
    said: String,
    /// Present step, and its last printed line.
    step: String,
    last: String,
    /// Remaining moves of a live step, and the board's time at which the present one ends.
    moves: Option<VecDeque<Move>>,
    over: u64,
    /// Weight that is asked for on the tip, N.
    asked_weight: Option<f64>,
    /// Moves of the servos.
    marks: VecDeque<&'static str>,
    servo_marks: Vec<f64>,
    turned: Vec<Option<usize>>,
    /// Arm 1 with a rod across its tip.
    torsion: TwistStand,
    /// Skips every other step.
    only: Option<&'static str>,
    /// The kitchen scale, and what it has shown while rotors ran, N.
    scale: Scale,
    lifts: Vec<f64>,
    recording: Option<Recording>,
}

/// The phone's file, which ends with the walk.
struct Recording(PathBuf);

impl Drop for Recording {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

impl Builder {
    pub(super) fn new(operator: BenchOperator, until: Option<&'static str>) -> Self {
        Self {
            operator,
            until,
            said: String::new(),
            step: String::new(),
            last: String::new(),
            moves: None,
            over: 0,
            asked_weight: None,
            marks: VecDeque::new(),
            servo_marks: Vec::new(),
            turned: Vec::new(),
            torsion: TwistStand::new(&scenario("hover.toml"), 0, Streams::new(1)),
            only: None,
            scale: Scale::new(Streams::new(1)),
            lifts: Vec::new(),
            recording: None,
        }
    }

    /// Skips every other step than `only`.
    pub(super) fn at(operator: BenchOperator, only: &'static str) -> Self {
        Self {
            only: Some(only),
            ..Self::new(operator, None)
        }
    }

    /// Transcript of prompts and replies.
    pub(super) fn said(&self) -> &str {
        &self.said
    }

    /// The rotor that turned with each output, at `rotors`.
    pub(super) fn turned(&self) -> &[Option<usize>] {
        &self.turned
    }

    /// The pulses at which the marks were taken, µs.
    pub(super) fn servo_marks(&self) -> &[f64] {
        &self.servo_marks
    }

    fn notes(&mut self, text: &str) {
        print!("{text}");
        self.said += text;
    }

    /// Number of the arm, sensor or servo of the step.
    fn number(&self) -> usize {
        let number = self
            .step
            .rsplit('-')
            .next()
            .and_then(|number| number.parse::<usize>().ok());
        number.unwrap_or(1) - 1
    }

    /// Changes the handling and waits until it has passed the filters; an unchanged handling takes no time.
    fn does(&self, change: impl FnOnce(&mut Handling)) {
        let mut changed = false;
        self.operator.change(|held| {
            let before = held.clone();
            change(held);
            changed = before.below != held.below
                || before.pressed != held.pressed
                || before.bent != held.bent
                || before.on_box != held.on_box
                || before.height != held.height
                || before.sticks != held.sticks;
        });
        if changed {
            self.settles();
        }
    }

    /// Holds arm `number`, 0 to 3, alone at the `tilt`, rad.
    fn bends(&self, number: usize, tilt: f64) {
        let rest = self.operator.observe().tilts;
        self.does(|held| {
            held.bent = [0.0; 4];
            held.bent[number] = tilt - rest[number];
        });
    }

    fn settles(&self) {
        let (begun, from) = (Instant::now(), self.operator.observe().ms);
        while self.operator.observe().ms < from + SETTLED {
            assert!(begun.elapsed() < STILL, "the board stands still:\n{}", self.said);
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Rotors of the tied vehicle run in the present step: hands are off.
    fn runs_rotors(&self) -> bool {
        matches!(&*self.step, "thrust" | "lag" | "arm-table" | "vibration")
    }

    /// The load that the last line asks for, g.
    fn load(&self) -> Option<f64> {
        let (begin, _) = self.last.split_once(" g, the segment counted")?;
        begin.rsplit(' ').next()?.parse().ok()
    }

    /// Handling at one rest of the calibration.
    fn rest(&mut self) {
        let number = self.number();
        let side = Face::ALL.into_iter().find(|side| self.last.contains(side.text()));
        if let Some(side) = side {
            self.does(|held| held.below = side);
        } else if self.last.contains("Hold the arm straight") {
            self.bends(number, 0.0);
        } else if self.last.contains("Bend its tip up") {
            self.bends(number, BENT);
        } else if self.last.contains("Arm in its cradle") {
            self.does(|held| held.bent[number] = CRADLE);
        } else if let Some(grams) = self.load() {
            let pascal = 1e-3 * grams * 9.806_65 / f64::from(Params::DEFAULT.fsr_area);
            self.does(|held| held.pressed[number] = pascal);
        } else {
            self.does(|held| {
                held.below = Face::Belly;
                held.pressed = [0.0; 4];
            });
        }
    }

    /// Begins the step: keeps the vehicle as the last step left it, then follows the first lines.
    fn begins(&mut self) -> &'static str {
        if self.until == Some(&*self.step) {
            return "q";
        }
        // One tendon stands for four.
        let tendon = self.step.starts_with("tendon-");
        let other = self.only.is_some_and(|only| only != self.step);
        if other || (tendon && self.step != "tendon-1") {
            return "s";
        }
        self.moves = None;
        self.marks = ["-92", "", "+185", ""].into();
        let on = matches!(&*self.step, "radio" | "final");
        self.does(|held| {
            held.below = Face::Belly;
            held.bent = [0.0; 4];
            held.on_box = tendon;
            held.sticks = on.then(Sticks::default);
            held.tied = false;
        });
        ""
    }

    /// Hangs the weight that is asked for, and replies once it hangs.
    fn hangs(&mut self, now: u64) -> Option<Reply> {
        if let Some(weight) = self.asked_weight.take() {
            let arm = self.number();
            self.operator.change(|held| held.hung[arm] = weight);
            self.over = now + HANGS;
        }
        (now >= self.over).then(|| Reply::Line(String::new()))
    }

    /// The next move of a servo; a mark records its pulse.
    fn moves_servo(&mut self) -> &'static str {
        let reply = self.marks.pop_front().unwrap_or_default();
        if reply.is_empty() {
            self.servo_marks.push(self.standing_pulse());
        }
        reply
    }

    /// The present pulse of the servo, µs; it moves no faster than the reel turns.
    fn standing_pulse(&self) -> f64 {
        let seen = || self.operator.observe().servos[self.number()].round();
        let mut pulse = seen();
        loop {
            self.settles();
            let before = std::mem::replace(&mut pulse, seen());
            if pulse == before {
                return pulse;
            }
        }
    }

    /// Twist by the phone, deg, with the weight that `question` names.
    fn twist(&mut self, question: &str) -> String {
        let grams = question
            .trim()
            .split(' ')
            .next()
            .and_then(|grams| grams.parse().ok());
        let side = if question.contains("left") { -1e-3 } else { 1e-3 };
        let (_, twist) = self.torsion.read(side * grams.unwrap_or(0.0), 0.1);
        format!("{:.1}", twist.to_degrees())
    }

    /// What the scale showed at the end of a run, g.
    fn weighs(&mut self) -> String {
        // The last half second before the rotors stop.
        let from = self.lifts.len().saturating_sub(SHOWN);
        let last = self.lifts.split_off(from);
        self.lifts.clear();
        let lift = last.iter().sum::<f64>() / last.len().max(1) as f64;
        format!("{:.0}", self.scale.read(lift, FLUCTUATION))
    }

    /// File of the phone's recording.
    fn stops_recording(&mut self) -> String {
        self.settles();
        self.operator.change(|held| held.records = false);
        let file = std::env::temp_dir().join(format!("sophie-{}-steps.wav", std::process::id()));
        std::fs::write(&file, self.operator.recording().unwrap()).unwrap();
        let name = file.to_str().unwrap().to_owned();
        self.recording = Some(Recording(file));
        name
    }

    fn which_turned(&mut self) -> String {
        // The order is acknowledged before the motor has speed.
        self.settles();
        let turned = self.operator.observe().turned;
        self.turned.push(turned);
        turned.map_or(0, |rotor| rotor + 1).to_string()
    }

    fn reply(&mut self, question: &str) -> String {
        let begins = |text: &str| question.trim_start().starts_with(text);
        if begins("Enter begins") {
            self.begins().to_owned()
        } else if begins("Enter keeps battery_capacity") {
            "5400".to_owned()
        } else if begins("Enter when it is so") {
            self.rest();
            String::new()
        } else if begins("+ or - moves it") {
            self.moves_servo().to_owned()
        } else if begins("Take the arm out of its cradle") {
            self.does(|held| held.bent = [0.0; 4]);
            String::new()
        } else if let Some((grams, _)) = question.split_once(" g: kg that start it") {
            // A luggage scale to 10 g that shows 1 % too much.
            let kg = 1e-3 * grams.trim().parse::<f64>().unwrap();
            let shown = 1.01 * FRICTION * kg;
            format!("{:.2} {shown:.2}", 1.3 * shown)
        } else if begins("The same on the wet pipe") {
            "n".to_owned()
        } else if begins("Lift it by 1 m") {
            self.does(|held| held.height = 1.0);
            String::new()
        } else if begins("And down again") {
            self.does(|held| held.height = 0.0);
            String::new()
        } else if begins("Type tied") {
            self.operator.change(|held| held.tied = true);
            "tied".to_owned()
        } else if begins("Does the phone record") {
            self.operator.change(|held| held.records = true);
            self.settles();
            String::new()
        } else if begins("Stop the recording") {
            self.stops_recording()
        } else if begins("A used battery") {
            self.operator.change(|held| held.battery = Some(USED));
            self.settles();
            "u".to_owned()
        } else if begins("What the scale showed") {
            self.weighs()
        } else if begins("Type off") {
            "off".to_owned()
        } else if begins("Volts") {
            format!("{:.2}", self.operator.observe().volts)
        } else if begins("Did it turn") {
            self.settles();
            if self.operator.observe().turned.is_some() {
                "y"
            } else {
                "n"
            }
            .to_owned()
        } else if begins("Which rotor") {
            self.which_turned()
        } else if begins("From above") {
            // 1 and 4 turn anticlockwise.
            let rotor = self.turned.last().copied().flatten();
            if matches!(rotor, Some(0 | 3)) { "a" } else { "c" }.to_owned()
        } else if question.contains("Twist, deg") {
            self.twist(question)
        } else if begins("Now switch the transmitter off") {
            self.does(|held| held.sticks = None);
            String::new()
        } else if begins("And on again") {
            self.does(|held| held.sticks = Some(Sticks::default()));
            String::new()
        } else if begins("Enter tries it again") {
            // A walk that fails here must end the run.
            "q".to_owned()
        } else {
            String::new()
        }
    }
}

/// Sticks and switches at one of their ends, throttle up: the board does not arm.
fn ends(sign: f32, on: bool) -> Sticks {
    Sticks {
        roll: sign,
        pitch: sign,
        yaw: sign,
        throttle: 1.0,
        arm_switch: on,
        perch_switch: on,
        stick_mode: if on { StickMode::Direct } else { StickMode::Angle },
        hold_switch: on,
        arms: if on { ArmChoice::Rear } else { ArmChoice::All },
    }
}

/// Moves of the operator in the live step `id`.
fn live(id: &str) -> VecDeque<Move> {
    let all: &[fn(&mut Handling)] = match id {
        "live-imu" => &[
            |held| held.below = Face::Right,
            |held| held.below = Face::Nose,
            |held| held.below = Face::Belly,
        ],
        "live-arms" => &[|held| held.bent = [BENT; 4], |held| held.bent = [0.0; 4]],
        "live-grip" => &[|held| held.pressed = [THUMB; 4], |held| held.pressed = [0.0; 4]],
        _ => &[
            |held| held.sticks = Some(ends(1.0, true)),
            |held| held.sticks = Some(ends(-1.0, false)),
            |held| held.sticks = Some(Sticks::default()),
        ],
    };
    let moves = all.iter().map(|operator| Move {
        ms: SETTLED,
        operator: *operator,
    });
    moves.collect()
}

impl User for Builder {
    fn say(&mut self, line: &str) {
        self.notes(&format!("{line}\n"));
        if line.starts_with('[')
            && let Some((_, id)) = line.rsplit_once('(')
        {
            self.step = id.trim_end_matches(')').to_owned();
        }
        if line.contains("Hang the weight on the tip") {
            self.asked_weight = Some(TIP_WEIGHT);
        } else if line.contains("Take the weight off, slowly") {
            self.asked_weight = Some(0.0);
        }
        self.last = line.to_owned();
    }

    fn live(&mut self, line: &str) {
        if self.runs_rotors() {
            self.lifts.push(self.operator.observe().lift);
            return;
        }
        self.notes(&format!("{line}\n"));
    }

    fn ask(&mut self, question: &str) -> Reply {
        self.notes(question);
        let reply = self.reply(question);
        self.notes(&format!("{reply}\n"));
        Reply::Line(reply)
    }

    fn answered(&mut self) -> Option<Reply> {
        if self.runs_rotors() {
            return None;
        }
        let now = self.operator.observe().ms;
        let id = self.step.clone();
        if id.starts_with("tendon-") {
            return self.hangs(now);
        }
        let moves = self.moves.get_or_insert_with(|| live(&id));
        if now < self.over {
            return None;
        }
        match moves.pop_front() {
            Some(next) => {
                self.operator.change(next.operator);
                self.over = now + next.ms;
                None
            }
            None => Some(Reply::Line(String::new())),
        }
    }
}
