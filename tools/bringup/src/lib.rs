//! The guided bring-up. Each step asks the builder for an action, gives the vehicle commands over MAVLink, judges
//! the answers by their numbers, and is written into the [`protocol`] before the next one begins.
//!
//! A step that measures also stores: it has passed when the board has restarted with its values in force. However a run
//! ends, the finished steps are kept and not repeated.

mod actuators;
mod air;
mod arm_table;
mod calibrate;
mod checks;
mod date;
mod friction;
mod lag;
mod live;
pub mod protocol;
mod tendon;
mod thrust;
mod tied;
mod twist;
mod vibration;
mod walk;

use std::path::Path;

use sophie_control::params::ServoMarks;

use self::protocol::{Entry, Protocol, Result as Ended};
pub use self::walk::{Reply, User};
use self::walk::{Stop, Verdict, Walk};
use sophie_board_link::Failure;
use sophie_board_link::vehicle::{Values, Vehicle};

/// One step.
pub struct Step {
    /// Its name in the protocol and behind `--again`.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The builder's action.
    hands: &'static str,
    /// Number of the arm, sensor or servo, for a step of one.
    number: usize,
    /// What leaving it out costs; empty for a step that every vehicle needs.
    cost: &'static str,
    run: fn(&mut Walk<'_>, &Step) -> Judged,
}

impl Step {
    /// The same as a step that may be left out, at this `cost`.
    const fn optional(self, cost: &'static str) -> Self {
        Self { cost, ..self }
    }

    const fn is_optional(&self) -> bool {
        !self.cost.is_empty()
    }
}

type Judged = Result<Verdict, Stop>;

/// A step of one arm, sensor or servo.
const fn numbered(
    id: &'static str,
    title: &'static str,
    hands: &'static str,
    number: usize,
    run: fn(&mut Walk<'_>, &Step) -> Judged,
) -> Step {
    Step {
        id,
        title,
        hands,
        number,
        cost: "",
        run,
    }
}

/// A step of the whole vehicle.
const fn step(
    id: &'static str,
    title: &'static str,
    hands: &'static str,
    run: fn(&mut Walk<'_>, &Step) -> Judged,
) -> Step {
    numbered(id, title, hands, 0, run)
}

const ARM: &str =
    "Body level and still. First the arm straight, by a ruler along it, then its tip bent up and held.";
const FSR: &str = "The arm in a printed cradle, bent as on the pipe; three known loads on a pipe segment on its pad, up and down.";
const FSR_COST: &str = "the arm presses by the sensor's turn-on force more than it shows, 70 to 550 Pa, and by its gain, 20 % \
                        more or less.";
const SERVO: &str = "Tendons off, servos on their own battery, hands away: it goes to its middle at once. Find the reel's release mark, then its full mark.";

const TENDON: &str = "Tendon on, servos on their own battery, body level on a box, its arms free to hang 25 cm down. The servo winds the arm; about 300 g hang on its tip by a string and are taken off, four times.";
const UNKNOWN_TENDON: &str =
    "the force is up to four times what the law takes it for; a millimetre of slack is 8 N.";

/// All steps, in their order.
pub const STEPS: &[Step] = &[
    step(
        "chip",
        "Chip and image",
        "Power by USB or a bench supply; hands off. A brown-out level that is missing is set, once for each chip.",
        checks::chip,
    ),
    step(
        "setup",
        "Motor controllers, receiver, battery",
        "Say what is on the vehicle; its makers' papers have the numbers.",
        checks::setup,
    ),
    step(
        "selftest",
        "Self-test of what is wired",
        "Vehicle at rest, arms open. Receiver and flight battery may still be missing.",
        checks::selftest,
    ),
    step(
        "live-air",
        "Barometer, live",
        "Vehicle at rest, out of wind. Then it is lifted by 1 m, and put down again.",
        air::air,
    ),
    step(
        "live-imu",
        "Inertial sensor, live",
        "Roll the vehicle to both sides and pitch it up and down: roll and pitch must follow.",
        live::imu,
    ),
    step(
        "live-arms",
        "Arm sensors, live",
        "Bend each arm's tip up and let go: its tilt must follow.",
        live::arms,
    ),
    step(
        "live-grip",
        "Pressure sensors, live",
        "Press each pad with a thumb: its pressure must follow.",
        live::grip,
    ),
    step(
        "mounting",
        "Mounting of the inertial sensor",
        "Level, then nose down, then right side down, each to within 30 degrees.",
        calibrate::mounting,
    ),
    step(
        "gyro",
        "Gyro at rest",
        "Leave the vehicle at rest.",
        calibrate::gyro,
    ),
    step(
        "level",
        "Accelerometer",
        "The finished vehicle on a level table; or six sides by hand, which needs no table and checks the scale.",
        calibrate::level,
    ),
    numbered("arm-1", "Sensor of arm 1, front-left", ARM, 1, calibrate::arm),
    numbered("arm-2", "Sensor of arm 2, rear-left", ARM, 2, calibrate::arm),
    numbered("arm-3", "Sensor of arm 3, front-right", ARM, 3, calibrate::arm),
    numbered("arm-4", "Sensor of arm 4, rear-right", ARM, 4, calibrate::arm),
    step(
        "twist",
        "Torsion of an arm",
        "A rod, three weights of 30 to 90 g, a kitchen scale, a phone with an inclinometer; 15 minutes. No propellers needed.",
        twist::twist,
    )
    .optional(
        "the design check takes the arms' torsion for the derived one. At half of it HOLD's pitch swings in wind, at 0.4 \
         yaw oscillates.",
    ),
    numbered("fsr-1", "Pressure sensor 1, front-left", FSR, 1, calibrate::fsr).optional(FSR_COST),
    numbered("fsr-2", "Pressure sensor 2, rear-left", FSR, 2, calibrate::fsr).optional(FSR_COST),
    numbered("fsr-3", "Pressure sensor 3, front-right", FSR, 3, calibrate::fsr).optional(FSR_COST),
    numbered("fsr-4", "Pressure sensor 4, rear-right", FSR, 4, calibrate::fsr).optional(FSR_COST),
    numbered("servo-1", "Servo 1, front-left", SERVO, 1, actuators::servo),
    numbered("servo-2", "Servo 2, rear-left", SERVO, 2, actuators::servo),
    numbered("servo-3", "Servo 3, front-right", SERVO, 3, actuators::servo),
    numbered("servo-4", "Servo 4, rear-right", SERVO, 4, actuators::servo),
    numbered("tendon-1", "Tendon 1, front-left", TENDON, 1, tendon::tendon).optional(UNKNOWN_TENDON),
    numbered("tendon-2", "Tendon 2, rear-left", TENDON, 2, tendon::tendon).optional(UNKNOWN_TENDON),
    numbered("tendon-3", "Tendon 3, front-right", TENDON, 3, tendon::tendon).optional(UNKNOWN_TENDON),
    numbered("tendon-4", "Tendon 4, rear-right", TENDON, 4, tendon::tendon).optional(UNKNOWN_TENDON),
    step(
        "flow",
        "Flow and range module",
        "Turned by hand over a floor with a pattern, 0.5 m and 1.5 m high; where its lens is, a ruler shows \
         (flow_x, flow_y, flow_z); a vehicle without one has nothing to do.",
        calibrate::flow,
    )
    .optional("with a module, it neither holds its place nor perches autonomously by it."),
    step(
        "friction",
        "Friction on the pipe",
        "A sled of the belly's pads on a level pipe, three loads on it. Drawn along the pipe, slowly, by a luggage \
         scale, level with the pads.",
        friction::friction,
    )
    .optional("pipe_friction is a guess of 0.6: on a wet pipe of 0.25 it closes and lets go at leans that slide."),
    step(
        "battery",
        "Battery voltage",
        "Propellers off. Connect the flight battery; a multimeter at its plug.",
        calibrate::battery,
    ),
    step(
        "esc",
        "Motor controllers",
        "Propellers off, flight battery connected. Each motor turns for 2 s.",
        actuators::esc,
    ),
    step(
        "rotors",
        "Which rotor is which",
        "Propellers off, flight battery connected. Each output turns for 2 s: say which rotor, and which way.",
        actuators::rotors,
    ),
    step(
        "radio",
        "Radio: sticks, switches, loss",
        "Propellers off. Transmitter on, every switch off, throttle low.",
        live::radio,
    ),
    step(
        "thrust",
        "Static thrust",
        "The last steps without propellers are done: propellers on, fresh flight battery, body tied down on a kitchen \
         scale (docs/calibration.md). 13 runs of 6 s, and 5 with a used battery.",
        thrust::thrust,
    )
    .optional(
        "rotors 14 % off thrust_max look like 2.2 N of the 3 N that prove a touch: it breaks off approaches or notices \
         the pipe late; rotors that differ by 5 % lean it.",
    ),
    step(
        "lag",
        "Lag of the motors",
        "Propellers on, body tied down as before, a phone that records WAV beside rotor 1. One run of 12 s.",
        lag::lag,
    )
    .optional("motors of 0.09 s that count as 0.05 leave 1 of 16 autonomous perches, and loops near their margin."),
    step(
        "arm-table",
        "How the arms bend",
        "Propellers on, fresh flight battery, body tied down, arms free and level. 5 runs of 6 s; best after `thrust`.",
        arm_table::arm_table,
    )
    .optional(
        "arms bend 0.7 to 1.4 times as much as Table I of the paper says: lift and yaw are off by that, and a difference \
         of more than 0.2 rad is a warning in flight.",
    ),
    step(
        "vibration",
        "Vibration",
        "Propellers on, flight battery, body tied down as softly as it holds. One run of 11 s at about hover.",
        vibration::vibration,
    )
    .optional("propellers out of balance show in the first flight only, and may lose a hold by flow."),
    step(
        "final",
        "Everything once more",
        "Vehicle at rest, arms open, transmitter on, arm switch off, throttle low, flight battery connected.",
        checks::everything,
    ),
];

/// The parameter that each servo's step adds its digit to.
const MARKS: &str = "servo_marks";

/// The last step, which checks the results of the others.
const LAST: &str = "final";

/// Walks through the steps that are open, and those of `again`; true when none is left: all have passed or, where that
/// is allowed, are left out.
///
/// # Errors
/// One line: a file that cannot be written or belongs to another board, an unknown step, or a lost line.
pub fn run(
    vehicle: &mut Vehicle,
    user: &mut dyn User,
    protocol: &Path,
    again: &[String],
) -> Result<bool, Failure> {
    for id in again {
        if STEPS.iter().all(|step| step.id != id) {
            let allowed: Vec<&str> = STEPS.iter().map(|step| step.id).collect();
            return Err(Failure::Input(format!(
                "--again {id}: allowed {}",
                allowed.join(", ")
            )));
        }
    }
    let mut protocol = Protocol::open(protocol)?;
    let (board, other_table) = checks::identity(vehicle)?;
    user.say(&format!("{}, chip {}", board.firmware, board.chip));
    user.say(&board.build);
    if let Some(other) = other_table {
        user.say(&other);
    }
    if let Some(other) = protocol.identify(board)? {
        user.say(&other);
    }
    reopen(vehicle, user, &mut protocol)?;
    again.iter().for_each(|id| protocol.drop_entry(id));
    // Written before the first step: a run needs a writable file.
    protocol.write()?;
    user.say(&format!(
        "Protocol {}: {}",
        protocol.path().display(),
        protocol.state()
    ));
    if !protocol.open_steps().is_empty() {
        user.say("Propellers off, flight battery disconnected, until a step asks for it.");
    }
    let mut walk = Walk::new(vehicle, user).with_files_at(protocol.path());
    let done = steps(&mut walk, &mut protocol);
    user.say("");
    match done {
        Ok(()) => user.say(&protocol.state()),
        Err(Stop::Skip | Stop::Quit | Stop::Failed(Failure::Stopped(_))) => {
            // Nothing is left running at the board, whatever comes.
            vehicle.see_it_through();
            vehicle.calm()?;
            user.say(&format!("Stopped. {}", protocol.state()));
        }
        Err(Stop::Failed(failure)) => return Err(failure),
    }
    user.say(&format!("Protocol: {}", protocol.path().display()));
    Ok(protocol.open_steps().is_empty())
}

/// Reopens the steps whose values the board no longer has.
fn reopen(vehicle: &mut Vehicle, user: &mut dyn User, protocol: &mut Protocol) -> Result<(), Failure> {
    if STEPS.iter().all(|step| protocol.entry(step.id).is_none()) {
        return Ok(());
    }
    let values = vehicle.values()?;
    for (index, step) in STEPS.iter().enumerate() {
        if let Some(lost) = lost(index, protocol, &values) {
            user.say(&format!("{} is to be done again: {lost}", step.id));
            protocol.drop_entry(step.id);
        }
    }
    Ok(())
}

/// The first parameter that the step at `index` has stored and whose value on the board differs. The last step that
/// stored a parameter is responsible for its value.
fn lost(index: usize, protocol: &Protocol, values: &Values) -> Option<String> {
    let (step, later) = STEPS.get(index..)?.split_first()?;
    let stored = |step: &Step| {
        let entry = protocol.entry(step.id)?;
        (entry.result == Ended::Passed).then_some(&entry.parameters)
    };
    stored(step)?.iter().find_map(|(name, value)| {
        let now = walk::number(values.get(name)?);
        let has = if name == MARKS {
            marked(step, now)
        } else {
            let answers = |later| stored(later).is_some_and(|all| all.contains_key(name));
            now == *value || later.iter().any(answers)
        };
        (!has).then(|| format!("{name} is {now} at the board, was {value}"))
    })
}

/// The marks `now` have the digit of the step's servo: each step adds its own to one parameter.
fn marked(step: &Step, now: f64) -> bool {
    let Some(servo) = step.number.checked_sub(1) else {
        return false;
    };
    ServoMarks::ALL
        .iter()
        .any(|marks| f64::from(marks.number()) == now && marks.has(servo))
}

fn steps(walk: &mut Walk<'_>, protocol: &mut Protocol) -> Result<(), Stop> {
    let mut redone = false;
    for (index, step) in STEPS.iter().enumerate() {
        let done = protocol.passed(step.id) || protocol.left_out(step.id);
        if done && !(redone && step.id == LAST) {
            continue;
        }
        redone = true;
        walk.say("");
        walk.say(&format!(
            "[{}/{}] {} ({})",
            index + 1,
            STEPS.len(),
            step.title,
            step.id
        ));
        walk.say(&format!("  {}", step.hands));
        if step.is_optional() {
            walk.say(&format!("  Left out: {}", step.cost));
        }
        while !one(walk, protocol, step)? {}
    }
    Ok(())
}

/// One attempt at a step, written into the protocol; false if the builder wants to repeat it.
fn one(walk: &mut Walk<'_>, protocol: &mut Protocol, step: &Step) -> Result<bool, Stop> {
    let begun = walk.ask(if step.is_optional() {
        "Enter begins, s leaves it out, q stops:"
    } else {
        "Enter begins, s skips, q stops:"
    });
    let judged = begun.and_then(|_| {
        walk.passed = protocol.measured();
        let judged = (step.run)(walk, step);
        if matches!(judged, Err(Stop::Skip)) {
            walk.vehicle.calm()?;
        }
        judged
    });
    let (ended, verdict) = match judged {
        Ok(verdict) if verdict.passed => (Ended::Passed, verdict),
        Ok(verdict) => (Ended::Failed, verdict),
        Err(Stop::Skip) if step.is_optional() => (Ended::LeftOut, Verdict::default()),
        Err(Stop::Skip) => (Ended::Skipped, Verdict::default()),
        Err(stop) => return Err(stop),
    };
    for line in &verdict.figures {
        walk.say(&format!("    {line}"));
    }
    // The result is said once the protocol has it.
    protocol.put(Entry {
        id: step.id.to_owned(),
        title: step.title.to_owned(),
        result: ended,
        at: date::now(),
        figures: verdict.figures,
        parameters: verdict.parameters,
        measured: verdict.measured,
        build: protocol.build().to_owned(),
    })?;
    walk.say(match ended {
        Ended::Passed => "  passed",
        Ended::Failed => "  FAILED",
        Ended::Skipped => "  skipped",
        Ended::LeftOut => "  left out",
    });
    if ended != Ended::Failed {
        return Ok(true);
    }
    match walk.ask("Enter tries it again, s leaves it failed, q stops:") {
        Ok(_) => Ok(false),
        Err(Stop::Skip) => Ok(true),
        Err(stop) => Err(stop),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Passed steps with what they stored.
    fn done(steps: &[(&str, &str, f64)]) -> Protocol {
        let folder = std::env::temp_dir().join(format!("sophie-lost-{}", std::process::id()));
        // Nothing is there, and nothing is written.
        let mut protocol = Protocol::open(&folder.join("none.toml")).unwrap();
        for (id, name, value) in steps {
            protocol.note(Entry {
                id: (*id).to_owned(),
                title: String::new(),
                result: Ended::Passed,
                at: String::new(),
                figures: Vec::new(),
                build: String::new(),
                measured: BTreeMap::new(),
                parameters: [((*name).to_owned(), *value)].into(),
            });
        }
        protocol
    }

    /// The steps to be done again where the board has `name` at `now`.
    fn again(protocol: &Protocol, name: &str, now: &str) -> Vec<&'static str> {
        let rows = Values([(name.to_owned(), now.parse().unwrap())].into());
        let open = (0..STEPS.len()).filter(|index| lost(*index, protocol, &rows).is_some());
        open.map(|index| STEPS[index].id).collect()
    }

    #[test]
    fn a_step_that_is_left_out_is_not_open_and_is_named() {
        let mut protocol = Protocol::default();
        for step in STEPS {
            protocol.note(Entry {
                id: step.id.to_owned(),
                title: String::new(),
                result: Ended::Passed,
                at: String::new(),
                figures: Vec::new(),
                build: String::new(),
                measured: BTreeMap::new(),
                parameters: [].into(),
            });
        }
        assert_eq!(protocol.state(), format!("all {} steps passed", STEPS.len()));
        let mut entry = protocol.entry("flow").unwrap().clone();
        entry.result = Ended::LeftOut;
        protocol.note(entry.clone());
        assert!(protocol.open_steps().is_empty());
        assert_eq!(protocol.state(), "all steps passed, left out: flow");
        entry.result = Ended::Skipped;
        protocol.note(entry);
        assert_eq!(protocol.open_steps(), ["flow"]);
        assert_eq!(protocol.state(), "skipped: flow");
    }

    #[test]
    fn a_parameter_of_several_steps_is_missed_by_the_one_that_answers_for_it() {
        let servos = done(&[
            ("servo-1", MARKS, 13.0),
            ("servo-2", MARKS, 123.0),
            ("servo-3", MARKS, 3.0),
        ]);
        for (now, steps) in [
            ("123", &[] as &[&str]),
            ("1234", &[]),
            ("13", &["servo-2"]),
            ("0", &["servo-1", "servo-2", "servo-3"]),
        ] {
            assert_eq!(again(&servos, MARKS, now), steps, "{now}");
        }
        let idle = "motor_pulse_idle";
        let pulses = done(&[("setup", idle, 1150.0), ("esc", idle, 1085.0)]);
        assert!(again(&pulses, idle, "1085").is_empty());
        assert_eq!(again(&pulses, idle, "1150"), ["esc"]);
        assert_eq!(again(&done(&[("setup", idle, 1150.0)]), idle, "1085"), ["setup"]);
    }
}
