//! The whole stack on parts that fail: what a silent sensor, a hung task or a dead radio does in flight.

mod fakes;

use embassy_time::Instant;
use fakes::{
    Answer, FakeAnalog, FakeArms, FakeImu, FakeMemory, FakeMotors, FakeServos, FakeWatchdog, VOLTS_PER_COUNT,
    links,
};
use sophie_control::mixer::Variant;
use sophie_control::mode::Mode;
use sophie_control::rc::Sticks;
use sophie_control::wrench::Configuration;
use sophie_hil::clock::VirtualTime;
use sophie_tasks::links::{Links, RcState, Setpoint};
use sophie_tasks::ports::AnalogFrame;

/// Period of the channel frames, ms.
const FRAME_MS: u64 = 10;

struct Vehicle {
    time: VirtualTime,
    links: &'static Links,
    imu: FakeImu,
    arms: FakeArms,
    converter: FakeAnalog,
    motors: FakeMotors,
    servos: FakeServos,
    watchdog: FakeWatchdog,
    sticks: Option<Sticks>,
    ms: u64,
}

impl Vehicle {
    fn new() -> Self {
        let (time, links) = (VirtualTime::new(), links());
        let converter = FakeAnalog::default();
        converter.frame.set(AnalogFrame {
            battery_voltage: (16.0 / VOLTS_PER_COUNT) as u16,
            ..AnalogFrame::default()
        });
        let v = Self {
            time,
            links,
            imu: FakeImu::default(),
            arms: FakeArms::default(),
            converter,
            motors: FakeMotors::default(),
            servos: FakeServos::default(),
            watchdog: FakeWatchdog::default(),
            sticks: Some(Sticks::default()),
            ms: 0,
        };
        v.time.spawn(sophie_tasks::imu::run(links, v.imu.clone()));
        v.time.spawn(sophie_tasks::estimator::run(links));
        v.time.spawn(sophie_tasks::control::run(links));
        let (mixer, b) = (Variant::Flexible, Configuration::B);
        v.time.spawn(sophie_tasks::mixer::run(links, mixer, b));
        v.time.spawn(sophie_tasks::motors::run(links, v.motors.clone()));
        v.time
            .spawn(sophie_tasks::analog::run(links, v.converter.clone()));
        v.time.spawn(sophie_tasks::clamp::run(links));
        v.time.spawn(sophie_tasks::servos::run(links, v.servos.clone()));
        v.time.spawn(sophie_tasks::commander::run(links));
        v.time.spawn(sophie_tasks::supervisor::run(
            links,
            v.watchdog.clone(),
            FakeMemory::default(),
        ));
        v.time.spawn(sophie_tasks::arms::run(links, v.arms.clone()));
        v
    }

    /// Armed by switch and gesture, throttle at hover.
    fn flying() -> Self {
        let mut v = Self::new();
        v.run(4000);
        assert_eq!(v.mode(), Mode::Disarmed);
        let sticks = Sticks {
            arm_switch: true,
            ..Sticks::default()
        };
        v.sticks = Some(Sticks { yaw: 1.0, ..sticks });
        v.run(1200);
        assert_eq!(v.mode(), Mode::Armed, "{}", v.reason());
        v.sticks = Some(Sticks {
            throttle: 0.5,
            ..sticks
        });
        v.run(1000);
        assert_eq!(v.mode(), Mode::Flight, "{}", v.reason());
        assert!(v.motors_run() && v.fed_over(200) >= 19);
        v
    }

    fn run(&mut self, ms: u64) {
        for _ in 0..ms {
            self.ms += 1;
            self.time.run_until(self.ms * 1000);
            if let Some(sticks) = self.sticks
                && self.ms.is_multiple_of(FRAME_MS)
            {
                let state = RcState {
                    sticks,
                    ..RcState::default()
                };
                self.links.rc.send(Instant::now(), state);
            }
        }
    }

    /// Milliseconds until `holds`, at most `limit`.
    fn until(&mut self, limit: u64, holds: impl Fn(&Self) -> bool) -> u64 {
        (0..=limit)
            .find(|i| {
                if *i > 0 {
                    self.run(1);
                }
                holds(self)
            })
            .unwrap_or_else(|| panic!("not within {limit} ms: {:?} {}", self.mode(), self.reason()))
    }

    fn mode(&self) -> Mode {
        self.links
            .status
            .latest()
            .map_or(Mode::Calibrating, |s| s.value.mode)
    }

    fn reason(&self) -> &'static str {
        self.links.status.latest().map_or("", |s| s.value.reason)
    }

    fn motors_run(&self) -> bool {
        self.motors.commands.get().iter().all(|c| *c > 0.0)
    }

    fn motors_stand(&self) -> bool {
        self.motors.commands.get() == [0.0; 4]
    }

    /// Feeds of the watchdog over the last `ms`.
    fn fed_over(&self, ms: u64) -> usize {
        self.watchdog.fed_since((self.ms - ms) * 1000 + 1)
    }
}

/// A silent inertial sensor stops the motors within the mix's own limit, for good, and the board is reset.
fn a_lost_sensor_stops_the_motors(answer: Answer) {
    let mut v = Vehicle::flying();
    v.imu.0.answer.set(answer);
    // The sample under way still comes; 10 ms after it the motors stop by themselves.
    let stopped = v.until(30, Vehicle::motors_stand);
    assert!((5..=12).contains(&stopped), "{answer:?}: {stopped} ms");
    assert!(v.links.attitude.fresh().is_none());
    v.until(80, |v| v.mode() == Mode::Disarmed);
    assert_eq!(v.links.setpoint.fresh(), Some(Setpoint::Stop));
    assert_eq!(v.reason(), "inertial sensor silent");
    assert!(!v.imu.0.spun.get(), "asked a thousand times without waiting");
    v.run(400);
    assert_eq!(v.fed_over(200), 0, "the watchdog would have reset the board");

    // Back again: alive, but nothing turns before a new arming.
    v.imu.0.answer.set(Answer::Sound);
    v.run(500);
    assert!(v.motors_stand() && v.mode() == Mode::Disarmed);
    assert!(v.links.attitude.fresh().is_some() && v.fed_over(200) >= 19);
}

#[test]
fn a_sensor_that_never_answers_stops_the_motors() {
    a_lost_sensor_stops_the_motors(Answer::Hangs);
}

#[test]
fn a_sensor_that_only_gives_errors_stops_the_motors() {
    a_lost_sensor_stops_the_motors(Answer::Fails);
}

#[test]
fn a_sensor_that_refuses_at_once_stops_the_motors_and_starves_nobody() {
    a_lost_sensor_stops_the_motors(Answer::Refuses);
}

#[test]
fn a_gap_in_the_samples_shorter_than_the_limit_is_flown_through() {
    let mut v = Vehicle::flying();
    for _ in 0..20 {
        v.imu.0.answer.set(Answer::Fails);
        v.run(4);
        v.imu.0.answer.set(Answer::Sound);
        v.run(50);
        assert!(v.motors_run());
    }
    assert_eq!((v.mode(), v.reason()), (Mode::Flight, ""));
}

#[test]
fn a_setpoint_that_is_not_renewed_stops_the_rotors() {
    // Everything but the commander: it has died after its last word.
    let (time, links, motors) = (VirtualTime::new(), links(), FakeMotors::default());
    time.spawn(sophie_tasks::imu::run(links, FakeImu::default()));
    time.spawn(sophie_tasks::estimator::run(links));
    time.spawn(sophie_tasks::control::run(links));
    let (mixer, b) = (Variant::Flexible, Configuration::B);
    time.spawn(sophie_tasks::mixer::run(links, mixer, b));
    time.spawn(sophie_tasks::motors::run(links, motors.clone()));
    let setpoint = Setpoint::Angle {
        roll: 0.0,
        pitch: 0.0,
        yaw_rate: 0.0,
        thrust: 17.0,
    };
    for ms in 1..=4000 {
        time.run_until(ms * 1000);
        links.setpoint.send(Instant::now(), setpoint);
    }
    time.run_until(4_049_000);
    assert!(motors.commands.get().iter().all(|c| *c > 0.0));
    time.run_until(4_053_000);
    assert_eq!(motors.commands.get(), [0.0; 4]);
}

#[test]
fn a_hung_port_of_any_watched_task_leaves_the_watchdog_unfed() {
    type Break = fn(&Vehicle);
    let cases: [(&str, Break); 3] = [
        ("motors", |v| v.motors.part.answer.set(Answer::Hangs)),
        ("analog", |v| v.converter.part.answer.set(Answer::Hangs)),
        ("servos", |v| v.servos.part.answer.set(Answer::Hangs)),
    ];
    for (name, hang) in cases {
        let mut v = Vehicle::flying();
        hang(&v);
        v.run(200);
        // Two windows: the one that it hung in may have had enough runs already.
        v.run(1000);
        assert_eq!(v.fed_over(1000), 0, "{name}");
    }
}

#[test]
fn a_hung_arm_sensor_or_a_lost_radio_does_not_reset_the_board() {
    let mut v = Vehicle::flying();
    v.arms.0.answer.set(Answer::Hangs);
    v.run(1000);
    assert!(v.links.arms.fresh().is_none());
    assert!(v.fed_over(900) >= 89 && v.motors_run());
    v.sticks = None;
    v.run(1000);
    assert_eq!((v.mode(), v.reason()), (Mode::Failsafe, "radio lost"));
    assert!(v.fed_over(900) >= 89);
}

#[test]
fn a_board_whose_sensor_never_came_up_is_fed_but_never_arms() {
    // A reset would not mend it, and the pilot can read why.
    let mut v = Vehicle::new();
    v.imu.0.answer.set(Answer::Hangs);
    v.sticks = Some(Sticks::default());
    v.run(3500);
    v.sticks = Some(Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Sticks::default()
    });
    v.run(3000);
    assert_eq!(
        (v.mode(), v.reason()),
        (Mode::Calibrating, "inertial sensor silent")
    );
    assert!(v.motors_stand() && v.fed_over(1000) >= 99);
}
