//! Live values, one line each 0.2 s, until a key is pressed.

use core::fmt::Write;

use embassy_time::{Duration, Timer};
use heapless::{String, Vec};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::maths::scalar::to_deg;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::pilot::rc::{ArmChoice, StickMode};

use super::Console;
use crate::links::Links;
use sophie_control::maths::decimal::Decimal;
use sophie_ports::chip::Chip;
use sophie_ports::external_pose::ExternalPose;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Time between two lines: 80 characters take 7 ms at 115,200 baud, and eyes follow no more.
const PERIOD: Duration = Duration::from_millis(200);
/// Most numbers in a line of 80 characters, and the width of each.
const COLUMNS: usize = 9;
const WIDTH: usize = 8;

/// The numbers of a line; `None` where a message is stale or a sensor silent.
type Row = Vec<Option<f32>, COLUMNS>;

/// A group of values that `watch` shows.
struct Group {
    name: &'static str,
    /// Description of the values.
    what: &'static str,
    /// Names of the columns, each [`WIDTH`] wide.
    columns: &'static str,
    places: usize,
    read: fn(&Links) -> Row,
}

const GROUPS: [Group; 12] = [
    Group {
        name: "sticks",
        what: "sticks -1 to 1, throttle 0 to 1, switches by their position",
        columns: "    roll   pitch     yaw  thrott     arm   perch    mode    arms",
        places: 2,
        read: sticks,
    },
    Group {
        name: "imu",
        what: "attitude in deg, body rates in deg/s, specific force in m/s2",
        columns: "    roll   pitch     yaw       p       q       r      ax      ay      az",
        places: 2,
        read: imu,
    },
    Group {
        name: "vibe",
        what: "vibration above 5 Hz, m/s2 RMS, readings at full scale",
        columns: "       x       y       z clipped",
        places: 1,
        read: vibration,
    },
    Group {
        name: "arms",
        what: "tilt of each arm, tip up, and angle of each servo, deg",
        columns: "   tilt1   tilt2   tilt3   tilt4  servo1  servo2  servo3  servo4",
        places: 1,
        read: arms,
    },
    Group {
        name: "grip",
        what: "contact pressure of each arm in Pa, tension of each tendon in N",
        columns: "  press1  press2  press3  press4  tendo1  tendo2  tendo3  tendo4",
        places: 1,
        read: grip,
    },
    Group {
        name: "power",
        what: "battery in V and A, charge used in mAh, servo battery in V",
        columns: "   volts  ampere    used  servos",
        places: 2,
        read: power,
    },
    Group {
        name: "thrust",
        what: "thrust over the parameters', learnt in flight, and its deviation",
        columns: "  factor   sigma",
        places: 3,
        read: thrust,
    },
    Group {
        name: "counts",
        what: "counts of the converter, 0 to 4095: pressures, battery, servos",
        columns: "    fsr1    fsr2    fsr3    fsr4    volt  ampere  servos",
        places: 0,
        read: counts,
    },
    Group {
        name: "pose",
        what: "pose from outside: m, deg, and m/s along the world's axes",
        columns: "       x       y       z    roll   pitch     yaw      vx      vy      vz",
        places: 2,
        read: pose,
    },
    Group {
        name: "flow",
        what: "flow about the body's x and y, deg/s; quality of 255; range, m",
        columns: "       x       y quality   range",
        places: 2,
        read: flow,
    },
    Group {
        name: "pos",
        what: "position m, velocity m/s, wind m/s2, age of the newest source s",
        columns: "       x       y       z      vx      vy      vz      wx      wy     age",
        places: 2,
        read: position,
    },
    Group {
        name: "air",
        what: "pressure of the air in Pa, temperature of the barometer in deg C",
        columns: "      Pa    degC",
        places: 1,
        read: air,
    },
];

fn sticks(links: &Links) -> Row {
    let Some(rc) = links.rc.fresh() else {
        return silent(8);
    };
    let s = rc.sticks;
    let switch = |on: bool| if on { 1.0 } else { 0.0 };
    let mode = match s.stick_mode {
        StickMode::Angle => 0.0,
        StickMode::Rate => 1.0,
        StickMode::Direct => 2.0,
    };
    let arms = match s.arms {
        ArmChoice::All => 0.0,
        ArmChoice::Front => 1.0,
        ArmChoice::Rear => 2.0,
    };
    let switches = [switch(s.arm_switch), switch(s.perch_switch), mode, arms];
    let sticks = [s.roll, s.pitch, s.yaw, s.throttle];
    sticks.into_iter().chain(switches).map(Some).collect()
}

fn imu(links: &Links) -> Row {
    let Some(a) = links.attitude.fresh() else {
        return silent(9);
    };
    let (roll, pitch, yaw) = a.q.to_euler();
    let angles = [roll, pitch, yaw]
        .into_iter()
        .chain(a.rate.to_array())
        .map(to_deg);
    angles.chain(a.accel.to_array()).map(Some).collect()
}

fn vibration(links: &Links) -> Row {
    let Some(vibration) = links.vibration.fresh() else {
        return silent(4);
    };
    let clipped = vibration.clipped as f32;
    vibration
        .rms
        .to_array()
        .into_iter()
        .chain([clipped])
        .map(Some)
        .collect()
}

fn arms(links: &Links) -> Row {
    let tilts = links.tilts().values();
    both(tilts, links.reel_angle.fresh(), to_deg)
}

fn grip(links: &Links) -> Row {
    let contact = links.contact.fresh().map(|contact| contact.arms);
    let pressures = contact.map_or([None; 4], |arms| arms.map(Result::ok));
    both(pressures, links.tension.fresh(), |force| force)
}

/// Four and four, in the unit that `shown` gives.
fn both(first: PerArm<Option<f32>>, second: Option<PerArm<f32>>, shown: fn(f32) -> f32) -> Row {
    let second = second.map_or([None; 4], |second| second.map(Some));
    first
        .into_iter()
        .chain(second)
        .map(|value| value.map(shown))
        .collect()
}

fn power(links: &Links) -> Row {
    let battery = links.battery.fresh();
    let current = battery.and_then(|b| b.current);
    // A·s to mAh.
    let used = battery.and_then(|b| b.used).map(|used| used / 3.6);
    let servos = links.servo_battery.fresh().map(|b| b.voltage);
    [battery.map(|b| b.voltage), current, used, servos]
        .into_iter()
        .collect()
}

fn thrust(links: &Links) -> Row {
    let factor = links.thrust_factor.fresh();
    [factor.map(|f| f.value), factor.map(|f| f.deviation)]
        .into_iter()
        .collect()
}

fn counts(links: &Links) -> Row {
    let Some(frame) = links.counts.fresh() else {
        return silent(7);
    };
    let battery = [frame.battery_voltage, frame.battery_current, frame.servo_battery];
    frame
        .fsr
        .into_iter()
        .chain(battery)
        .map(|counts| Some(f32::from(counts)))
        .collect()
}

fn pose(links: &Links) -> Row {
    let Some(ExternalPose { pose, .. }) = links.external_pose.fresh() else {
        return silent(9);
    };
    let position = pose.position.to_array().map(Some);
    let velocity = pose.velocity.map_or([None; 3], |v| v.to_array().map(Some));
    let angles = euler(pose.attitude);
    position.into_iter().chain(angles).chain(velocity).collect()
}

fn flow(links: &Links) -> Row {
    let Some(view) = links.ground.fresh() else {
        return silent(4);
    };
    let rates = view.flow.map(|f| {
        f.angle
            .map(|angle| to_deg(angle / f.seconds.max(f32::MIN_POSITIVE)))
    });
    let [x, y] = rates.map_or([None; 2], |rates| rates.map(Some));
    let quality = view.flow.map(|f| f32::from(f.quality));
    let range = view.range.and_then(|range| range.distance);
    [x, y, quality, range].into_iter().collect()
}

fn position(links: &Links) -> Row {
    let Some(e) = links.position.fresh() else {
        return silent(9);
    };
    let motion = [e.position, e.velocity].into_iter().flat_map(Vec3::to_array);
    let wind = [e.disturbance.x, e.disturbance.y];
    motion.chain(wind).chain([e.age]).map(Some).collect()
}

fn air(links: &Links) -> Row {
    let Some(air) = links.air_pressure.fresh() else {
        return silent(2);
    };
    [air.pascal, air.celsius].into_iter().map(Some).collect()
}

/// Roll, pitch and yaw, deg.
fn euler(attitude: Option<Quat>) -> [Option<f32>; 3] {
    attitude.map_or([None; 3], |q| {
        let (roll, pitch, yaw) = q.to_euler();
        [roll, pitch, yaw].map(to_deg).map(Some)
    })
}

fn silent(columns: usize) -> Row {
    core::iter::repeat_n(None, columns).collect()
}

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Shows the group called `name` until a key is pressed.
    pub(super) async fn watch(&mut self, name: &str) {
        let Some(group) = GROUPS.iter().find(|group| group.name == name) else {
            for Group { name, what, .. } in &GROUPS {
                self.out.line(format_args!("watch {name:7} {what}")).await;
            }
            return;
        };
        self.out.line(format_args!("{}", group.what)).await;
        self.out.line(format_args!("{}", group.columns)).await;
        while !self.keys.pressed() {
            let mut text = String::<{ COLUMNS * WIDTH }>::new();
            for value in (group.read)(self.links) {
                let places = group.places;
                // Never an error but for a number that is too long, whose end is cut off.
                let _ = match value {
                    Some(value) => write!(text, "{:>WIDTH$.places$}", Decimal(value)),
                    None => write!(text, "{:>WIDTH$}", '-'),
                };
            }
            self.out.resume();
            self.out.line(format_args!("{text}")).await;
            Timer::after(PERIOD).await;
        }
    }
}

#[cfg(test)]
mod tests {
    use sophie_clock as _;
    use sophie_control::params::Params;

    use super::*;

    #[test]
    fn every_line_has_as_many_columns_as_its_head_and_fits_the_screen() {
        let links = Links::new(Params::DEFAULT);
        for group in &GROUPS {
            let names = group.columns.split_ascii_whitespace().count();
            assert_eq!(group.columns.len(), names * WIDTH, "{}", group.name);
            assert_eq!((group.read)(&links).len(), names, "{}", group.name);
            assert!("watch 1234567 ".len() + group.what.len() <= 80, "{}", group.what);
        }
    }
}
