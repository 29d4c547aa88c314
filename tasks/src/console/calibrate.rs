//! Calibrations, a verb for each step: it measures, and puts the results into the working copy, as `set` does.
//!
//! The procedure is [`sophie_control::calibration::procedure`], as over MAVLink. `sophie bringup` leads through all of
//! them.

use embassy_time::{Duration, Instant, Timer};
use sophie_control::calibration::Face;
use sophie_control::calibration::procedure::{Finding, MOUNTING_SIDES, Outcome};
use sophie_control::calibration::step::{Calibration, Step};
use sophie_control::maths::decimal::{self, Decimal};
use sophie_control::params::Params;

use super::Console;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Time between two samples.
const SAMPLING: Duration = Duration::from_millis(10);

/// The verbs, with the measured part.
const VERBS: [(&str, &str); 11] = [
    ("gyro", "at rest; measured at each start, nothing to store"),
    ("level", "accelerometer's bias on a table that is level"),
    (
        "accel SIDE",
        "bias and scale: belly, back, nose, tail, right, left",
    ),
    ("mounting SIDE", "of the inertial sensor: belly, nose, right down"),
    ("battery VOLTS", "its divider, by a meter"),
    ("servo N R F", "marks: pulses at release and full, us"),
    ("fsr N empty", "pressure sensor N, pad empty: first and last"),
    ("fsr N NEWTON", "between: three loads up, two down"),
    ("arm N straight", "tilt sensor of arm N, arm held straight"),
    ("arm N up", "and its tip bent up: zero and sign"),
    ("flow near|far", "turned for 8 s, 0.5 m, then 1.5 m over a floor"),
];

/// The step that a verb requests, with the number of the step that comes `next` for a part; `None` for an unknown verb.
fn step(what: &str, arguments: [Option<&str>; 3], next: impl Fn(Calibration, usize) -> u8) -> Option<Step> {
    let either = |names: &[&str]| {
        let [name, None, _] = arguments else {
            return None;
        };
        let place = names.iter().position(|known| Some(*known) == name)?;
        Some(place as u32 + 1)
    };
    let number = |text: Option<&str>| text.and_then(decimal::parse);
    let part = |text: Option<&str>| text?.parse().ok();
    let whole = |calibration, step| Step::new(calibration, 0, step, [0.0; 2]);
    match (what, arguments) {
        ("gyro", [None, ..]) => whole(Calibration::Gyro, 1),
        ("level", [None, ..]) => whole(Calibration::Level, 1),
        ("accel", _) => whole(Calibration::Accel, either(&Face::ALL.map(Face::name))?),
        ("mounting", _) => whole(Calibration::Mounting, either(&MOUNTING_SIDES.map(Face::name))?),
        ("battery", [volts, None, _]) => Step::new(Calibration::Battery, 0, 1, [number(volts)?, 0.0]),
        ("servo", [servo, release, full]) => {
            let pulses = [number(release)?, number(full)?];
            Step::new(Calibration::Servo, part(servo)?, 1, pulses)
        }
        ("fsr", [sensor, load, None]) => {
            let part: u32 = part(sensor)?;
            let next = u32::from(next(Calibration::Fsr, part.checked_sub(1)? as usize));
            let last = u32::from(Calibration::Fsr.steps());
            match load {
                Some("empty") if next == last => Step::new(Calibration::Fsr, part, last, [0.0; 2]),
                Some("empty") => Step::new(Calibration::Fsr, part, 1, [0.0; 2]),
                // After the last load it repeats that one.
                load => Step::new(
                    Calibration::Fsr,
                    part,
                    next.clamp(2, last - 1),
                    [number(load)?, 0.0],
                ),
            }
        }
        ("arm", [arm, Some("straight"), None]) => Step::new(Calibration::Arm, part(arm)?, 1, [0.0; 2]),
        ("arm", [arm, Some("up"), None]) => Step::new(Calibration::Arm, part(arm)?, 2, [0.0; 2]),
        ("flow", _) => whole(Calibration::Flow, either(&["near", "far"])?),
        _ => None,
    }
}

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    pub(super) async fn calibrate(&mut self, what: &str, arguments: [Option<&str>; 3]) {
        if let Err(why) = self.stopped() {
            return self.refuse("not calibrated", why).await;
        }
        let now = Instant::now().as_micros();
        let next = |calibration, part| self.procedure.next(calibration, part, now);
        let Some(step) = step(what, arguments, next) else {
            for (verb, text) in VERBS {
                self.out.line(format_args!("calibrate {verb:14} {text}")).await;
            }
            return;
        };
        if self.procedure.begin(step, now).is_err() {
            let first = "not measured: the step before it first, within ten minutes";
            return self.out.line(format_args!("{first}")).await;
        }
        let seconds = Decimal(step.calibration.time_us() as f32 * 1e-6);
        self.out
            .line(format_args!("measures for {seconds} s; a key ends it"))
            .await;
        loop {
            Timer::after(SAMPLING).await;
            let (now, readings) = (Instant::now().as_micros(), self.links.readings());
            let found = (self.procedure).sample(now, &readings, &self.links.params, &self.params);
            if let Some(finding) = found {
                return self.found(finding).await;
            }
            if self.keys.pressed() {
                self.procedure.cancel();
                return self.out.line(format_args!("ended: nothing is changed")).await;
            }
        }
    }

    /// Prints the outcome of a step, and puts parameters into the working copy.
    async fn found(&mut self, finding: Finding) {
        let [x, y, z, noise] = finding.figures.map(Decimal);
        match (finding.result, finding.step.calibration) {
            (Ok(Outcome::Taken), _) => self.out.line(format_args!("taken: now the next step")).await,
            (Ok(Outcome::Done(_)), Calibration::Gyro) => {
                self.out
                    .line(format_args!(
                        "at rest {x:.2} {y:.2} {z:.2} deg/s, noise {noise:.2}; nothing to store"
                    ))
                    .await;
            }
            (Ok(Outcome::Done(changes)), calibration) => {
                for (name, value) in changes.into_iter().flatten() {
                    if let Some(row) = Params::row(name) {
                        self.put(row, value).await;
                    }
                }
                if calibration == Calibration::Fsr {
                    let grip = Decimal(self.links.params.grip_pressure);
                    self.out
                        .line(format_args!(
                            "within {x:.0} Pa at {grip} Pa; hysteresis {y:.1} %; {z:.0} Pa at the end, empty"
                        ))
                        .await;
                }
            }
            (Err(unfit), _) => self.out.line(format_args!("not taken: {unfit}")).await,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verb_of_the_list_is_a_step_and_others_are_not() {
        let of = |text: &str| {
            let mut words = text.split(' ');
            let what = words.next().unwrap();
            step(what, [words.next(), words.next(), words.next()], |_, part| {
                if part == 3 { 7 } else { part as u8 + 3 }
            })
        };
        for (text, calibration, number) in [
            ("gyro", Calibration::Gyro, 1),
            ("level", Calibration::Level, 1),
            ("accel left", Calibration::Accel, 6),
            ("mounting right", Calibration::Mounting, 3),
            ("battery 15.2", Calibration::Battery, 1),
            ("servo 2 900 2100", Calibration::Servo, 1),
            ("fsr 3 empty", Calibration::Fsr, 1),
            ("fsr 3 1.3", Calibration::Fsr, 5),
            // The last step of sensor 4 is the empty pad: a load is that before.
            ("fsr 4 1.3", Calibration::Fsr, 6),
            ("fsr 4 empty", Calibration::Fsr, 7),
            ("arm 4 straight", Calibration::Arm, 1),
            ("arm 4 up", Calibration::Arm, 2),
            ("flow far", Calibration::Flow, 2),
        ] {
            let step = of(text).unwrap();
            assert_eq!((step.calibration, step.number), (calibration, number), "{text}");
        }
        for text in [
            "gyro 1",
            "accel",
            "accel up",
            "accel nose tail",
            "mounting back",
            "battery",
            "battery full",
            "servo 5 900 2100",
            "servo 1 900",
            "fsr 1",
            "fsr 0 1",
            "fsr 1 -1",
            "arm 1",
            "arm 0 up",
            "flow",
            "esc",
            "flow near far",
        ] {
            assert_eq!(of(text), None, "{text}");
        }
    }
}
