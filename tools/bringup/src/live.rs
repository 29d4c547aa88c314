//! Steps that watch measured values while the builder moves the measured part.

use std::time::{Duration, Instant};

use super::walk::{Stop, Verdict, Walk, understood};
use super::{Judged, Step};
use mavlink_core::MessageData;
use sophie_board_link::Failure;
use sophie_control::arming::ArmingInhibit;
use sophie_dialect::{ATTITUDE_DATA, MavMessage, RC_CHANNELS_DATA, SCALED_IMU_DATA, SOPHIE_ARMS_DATA};

/// Rows before a reply counts: one second.
const ROWS: usize = 5;
/// Time for the board to notice that the transmitter was switched off or on.
const NOTICED: Duration = Duration::from_secs(10);

/// Time between two rows, and least age of a number that counts as missing.
const ROW: Duration = Duration::from_millis(200);
const FRESH: Duration = Duration::from_secs(3);
/// Period of the messages that are watched, µs.
const PERIOD_US: f32 = 100_000.0;
/// Width of a column.
const WIDTH: usize = 8;
/// Longest wait for one message.
const MESSAGE: Duration = Duration::from_secs(5);

/// Numbers that are watched together.
struct Group {
    /// Description of the numbers.
    what: &'static str,
    columns: &'static [&'static str],
    /// Numbers of the messages that have them.
    messages: &'static [u32],
    /// Columns and numbers of a message.
    read: fn(&MavMessage) -> Vec<(usize, f32)>,
    /// Decimal places.
    places: i32,
}

const IMU_GROUP: Group = Group {
    what: "attitude in deg, body rates in deg/s, specific force in m/s2",
    columns: &["roll", "pitch", "yaw", "p", "q", "r", "ax", "ay", "az"],
    messages: &[ATTITUDE_DATA::ID, SCALED_IMU_DATA::ID],
    read: |message| match message {
        MavMessage::ATTITUDE(a) => {
            let all = [a.roll, a.pitch, a.yaw, a.rollspeed, a.pitchspeed, a.yawspeed];
            all.map(f32::to_degrees).into_iter().enumerate().collect()
        }
        MavMessage::SCALED_IMU(imu) => {
            let force = [imu.xacc, imu.yacc, imu.zacc].map(|milli_g| f32::from(milli_g) * 9.806_65e-3);
            (6..).zip(force).collect()
        }
        _ => Vec::new(),
    },
    places: 2,
};
const ARMS_GROUP: Group = Group {
    what: "tilt of each arm, tip up, and angle of each servo, deg",
    columns: &[
        "tilt1", "tilt2", "tilt3", "tilt4", "servo1", "servo2", "servo3", "servo4",
    ],
    messages: &[SOPHIE_ARMS_DATA::ID],
    read: |message| match message {
        MavMessage::SOPHIE_ARMS(arms) => {
            let angles = arms.tilt.iter().chain(&arms.reel);
            angles.map(|angle| angle.to_degrees()).enumerate().collect()
        }
        _ => Vec::new(),
    },
    places: 1,
};
const GRIP_GROUP: Group = Group {
    what: "contact pressures, Pa",
    columns: &["press1", "press2", "press3", "press4"],
    messages: &[SOPHIE_ARMS_DATA::ID],
    read: |message| match message {
        MavMessage::SOPHIE_ARMS(arms) => arms.pressure.into_iter().enumerate().collect(),
        _ => Vec::new(),
    },
    places: 0,
};
const STICKS_GROUP: Group = Group {
    what: "sticks -1 to 1, throttle 0 to 1, switches by their position",
    columns: &["roll", "pitch", "yaw", "thrott", "arm", "perch", "mode", "arms"],
    messages: &[RC_CHANNELS_DATA::ID],
    read: |message| match message {
        MavMessage::RC_CHANNELS(rc) if rc.chancount > 0 => {
            let share = |pulse: u16| (f32::from(pulse) - 1500.0) / 500.0;
            let positions = |pulse: u16, most: f32| ((share(pulse) + 1.0) * 0.5 * most).round();
            let all = [
                share(rc.chan1_raw),
                -share(rc.chan2_raw),
                share(rc.chan4_raw),
                (share(rc.chan3_raw) + 1.0) * 0.5,
                positions(rc.chan5_raw, 1.0),
                positions(rc.chan7_raw, 1.0),
                positions(rc.chan6_raw, 2.0),
                positions(rc.chan8_raw, 2.0),
            ];
            all.into_iter().enumerate().collect()
        }
        _ => Vec::new(),
    },
    places: 2,
};

/// A column, and the range that the builder must move it through.
struct Moved {
    name: &'static str,
    /// The span or the two ends that it must reach.
    reach: Reach,
}

#[derive(Clone, Copy)]
enum Reach {
    /// Least distance between the extremes.
    Span(f32),
    /// Largest minimum and least maximum.
    Ends(f32, f32),
}

/// The extremes of a column.
#[derive(Clone, Debug)]
struct Seen {
    name: String,
    least: f32,
    most: f32,
    /// The newest number, and when it came.
    last: Option<(f32, Instant)>,
    /// Age up to which it counts as fresh.
    fresh: Duration,
}

/// Rolled and pitched by hand, deg.
const IMU: [Moved; 2] = [
    Moved {
        name: "roll",
        reach: Reach::Span(10.0),
    },
    Moved {
        name: "pitch",
        reach: Reach::Span(10.0),
    },
];
/// Tips bent up by hand, deg.
const ARMS: [Moved; 4] = [
    Moved {
        name: "tilt1",
        reach: Reach::Span(3.0),
    },
    Moved {
        name: "tilt2",
        reach: Reach::Span(3.0),
    },
    Moved {
        name: "tilt3",
        reach: Reach::Span(3.0),
    },
    Moved {
        name: "tilt4",
        reach: Reach::Span(3.0),
    },
];
/// Pads pressed by a thumb, Pa.
const GRIP: [Moved; 4] = [
    Moved {
        name: "press1",
        reach: Reach::Span(100.0),
    },
    Moved {
        name: "press2",
        reach: Reach::Span(100.0),
    },
    Moved {
        name: "press3",
        reach: Reach::Span(100.0),
    },
    Moved {
        name: "press4",
        reach: Reach::Span(100.0),
    },
];
/// Sticks to their ends, switches to theirs.
const STICKS: [Moved; 8] = [
    Moved {
        name: "roll",
        reach: Reach::Ends(-0.95, 0.95),
    },
    Moved {
        name: "pitch",
        reach: Reach::Ends(-0.95, 0.95),
    },
    Moved {
        name: "yaw",
        reach: Reach::Ends(-0.95, 0.95),
    },
    Moved {
        name: "thrott",
        reach: Reach::Ends(0.02, 0.95),
    },
    Moved {
        name: "arm",
        reach: Reach::Ends(0.0, 1.0),
    },
    Moved {
        name: "perch",
        reach: Reach::Ends(0.0, 1.0),
    },
    Moved {
        name: "mode",
        reach: Reach::Ends(0.0, 2.0),
    },
    Moved {
        name: "arms",
        reach: Reach::Ends(0.0, 2.0),
    },
];

impl Seen {
    fn new(name: &str, fresh: Duration) -> Self {
        Self {
            name: name.to_owned(),
            least: f32::INFINITY,
            most: f32::NEG_INFINITY,
            last: None,
            fresh,
        }
    }

    /// Takes a number, rounded to `places`; one that is not finite stands for a silent part.
    fn see(&mut self, number: f32, places: i32) {
        if !number.is_finite() {
            self.last = None;
            return;
        }
        let scale = 10f32.powi(places);
        // Without the sign of a zero.
        let number = (number * scale).round() / scale + 0.0;
        self.last = Some((number, Instant::now()));
        self.least = self.least.min(number);
        self.most = self.most.max(number);
    }

    fn is_fresh(&self) -> bool {
        self.last.is_some_and(|(_, at)| at.elapsed() < self.fresh)
    }

    /// The newest number as a column.
    fn shown(&self, places: i32) -> String {
        match self.last {
            Some((number, _)) if self.is_fresh() => {
                format!("{number:WIDTH$.places$}", places = places as usize)
            }
            _ => format!("{:>WIDTH$}", "-"),
        }
    }

    /// The figure, with the missing part of `reach`; true if it was reached.
    fn judged(&self, reach: Option<Reach>) -> (bool, String) {
        let Self {
            name, least, most, ..
        } = self;
        if !self.is_fresh() || least > most {
            return (false, format!("{name} silent"));
        }
        let figure = format!("{name} {least} to {most}");
        match reach {
            None => (true, figure),
            Some(Reach::Span(span)) if most - least >= span => (true, figure),
            Some(Reach::Span(span)) => (false, format!("{figure}; to be moved by {span} at least")),
            Some(Reach::Ends(low, high)) if *least <= low && *most >= high => (true, figure),
            Some(Reach::Ends(low, high)) => (false, format!("{figure}; {low} to {high} at least")),
        }
    }
}

pub(super) fn imu(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    watched(walk, &IMU_GROUP, &IMU)
}

pub(super) fn arms(walk: &mut Walk<'_>, _: &Step) -> Judged {
    watched(walk, &ARMS_GROUP, &ARMS)
}

pub(super) fn grip(walk: &mut Walk<'_>, _: &Step) -> Judged {
    watched(walk, &GRIP_GROUP, &GRIP)
}

fn watched(walk: &mut Walk<'_>, group: &Group, moved: &[Moved]) -> Judged {
    let seen = watch(walk, group)?;
    let judged = seen.iter().map(|seen| {
        let moved = moved.iter().find(|moved| moved.name == seen.name);
        seen.judged(moved.map(|moved| moved.reach))
    });
    let (right, figures): (Vec<bool>, Vec<String>) = judged.unzip();
    let passed = seen.len() >= moved.len() && right.into_iter().all(|right| right);
    Ok(Verdict::of(passed, figures))
}

/// Shows the group until the builder replies.
fn watch(walk: &mut Walk<'_>, group: &Group) -> Result<Vec<Seen>, Stop> {
    // Before the builder is asked: an earlier movement would not be seen.
    walk.vehicle.stream(group.messages, PERIOD_US)?;
    walk.say("  Enter once they have followed, s skips, q stops:");
    walk.say(group.what);
    let names: String = group
        .columns
        .iter()
        .map(|name| format!("{name:>WIDTH$}"))
        .collect();
    walk.say(&names);
    let fresh = walk.vehicle.silence(FRESH);
    let mut seen: Vec<Seen> = group.columns.iter().map(|name| Seen::new(name, fresh)).collect();
    let mut rows = 0;
    let ended = loop {
        let row = walk.vehicle.wait(ROW, |message| {
            for (column, number) in (group.read)(message) {
                if let Some(seen) = seen.get_mut(column) {
                    seen.see(number, group.places);
                }
            }
            None::<()>
        });
        if let Err(failure) = row {
            break Err(Stop::Failed(failure));
        }
        rows += 1;
        let row: String = seen.iter().map(|seen| seen.shown(group.places)).collect();
        walk.user.live(&row);
        if rows >= ROWS
            && let Some(reply) = walk.user.answered()
        {
            break understood(reply);
        }
    };
    match ended {
        Err(lost @ Stop::Failed(Failure::Board(_))) => Err(lost),
        ended => {
            walk.vehicle.stream(group.messages, 0.0)?;
            ended.map(|_| seen)
        }
    }
}

/// Voltage of the flight battery, V; `None` if it is not measured.
pub(super) fn battery(walk: &mut Walk<'_>) -> Result<Option<f32>, Stop> {
    walk.vehicle.catch_up()?;
    let silence = walk.vehicle.silence(MESSAGE);
    let volts = walk.vehicle.wait(silence, |message| match message {
        MavMessage::BATTERY_STATUS(battery) if battery.id == 0 => Some(battery.voltages[0]),
        _ => None,
    })?;
    Ok(volts
        .filter(|volts| *volts < u16::MAX)
        .map(|volts| f32::from(volts) * 1e-3))
}

pub(super) fn radio(walk: &mut Walk<'_>, _: &Step) -> Judged {
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    walk.say(
        "  Each stick to its ends, each switch through its positions. Throttle up before the arm switch",
    );
    walk.say("  goes on, and off before the throttle comes down: so nothing arms.");
    let mut verdict = watched(walk, &STICKS_GROUP, &STICKS)?;
    if !verdict.passed {
        return Ok(verdict);
    }
    walk.ask("Now switch the transmitter off, then Enter:")?;
    let gone = receiver(walk, false)?;
    walk.ask("And on again, arm switch off, throttle low, then Enter:")?;
    let back = receiver(walk, true)?;
    for (what, noticed, state) in [("off", gone, "radio lost"), ("on", back, "frames come")] {
        verdict.passed &= noticed;
        let not = if noticed { "" } else { "not noticed: " };
        verdict.figures.push(format!("transmitter {what}: {not}{state}"));
    }
    Ok(verdict)
}

/// Waits until the receiver gives frames, or none; false if it does not come to that.
fn receiver(walk: &mut Walk<'_>, there: bool) -> Result<bool, Stop> {
    let (begun, noticed) = (Instant::now(), walk.vehicle.silence(NOTICED));
    loop {
        let failing = walk.vehicle.arming()?;
        if failing.contains(&ArmingInhibit::RcLost) != there {
            return Ok(true);
        }
        if begun.elapsed() > noticed {
            return Ok(false);
        }
        walk.vehicle.wait(ROW, |_| None::<()>)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_judged_by_what_it_has_shown() {
        let seen = |numbers: &[f32]| {
            let mut seen = Seen::new("roll", FRESH);
            numbers.iter().for_each(|number| seen.see(*number, 2));
            seen
        };
        let ends = Some(Reach::Ends(-0.95, 0.95));
        for (numbers, reach, wanted) in [
            (&[-1.0, 1.0][..], ends, (true, "roll -1 to 1")),
            (
                &[-1.0, 0.9],
                ends,
                (false, "roll -1 to 0.9; -0.95 to 0.95 at least"),
            ),
            (&[1.0, f32::NAN], ends, (false, "roll silent")),
            (&[f32::NAN, 1.0], None, (true, "roll 1 to 1")),
            (&[], None, (false, "roll silent")),
            (
                &[-0.001, 9.9],
                Some(Reach::Span(10.0)),
                (false, "roll 0 to 9.9; to be moved by 10 at least"),
            ),
            (&[-5.0, 5.0], Some(Reach::Span(10.0)), (true, "roll -5 to 5")),
        ] {
            let (passed, text) = seen(numbers).judged(reach);
            assert_eq!((passed, &*text), wanted, "{numbers:?}");
        }
    }

    #[test]
    fn sticks_are_read_from_the_channels() {
        let rc = RC_CHANNELS_DATA {
            chancount: 8,
            chan1_raw: 1000,
            chan2_raw: 2000,
            chan3_raw: 1000,
            chan4_raw: 1500,
            chan5_raw: 2000,
            chan6_raw: 1500,
            chan7_raw: 1000,
            chan8_raw: 2000,
            ..RC_CHANNELS_DATA::DEFAULT
        };
        let read: Vec<f32> = (STICKS_GROUP.read)(&MavMessage::RC_CHANNELS(rc.clone()))
            .into_iter()
            .map(|(_, number)| number)
            .collect();
        assert_eq!(read, [-1.0, -1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 2.0]);
        let silent = RC_CHANNELS_DATA { chancount: 0, ..rc };
        assert!((STICKS_GROUP.read)(&MavMessage::RC_CHANNELS(silent)).is_empty());
    }
}
