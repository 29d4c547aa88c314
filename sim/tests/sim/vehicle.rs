//! A test's vehicle: the whole stack on fakes.

use super::links::links_with;
use embassy_time::Instant;
use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::Params;
use sophie_control::pilot::rc::Sticks;
use sophie_ports::receiver::RcState;
use sophie_ports::sensors::AnalogFrame;
use sophie_sim::clock::VirtualTime;
use sophie_tasks::links::Links;

use sophie_fakes::{
    FakeAnalog, FakeArms, FakeImu, FakeMemory, FakeMotors, FakeServos, FakeWatchdog, VOLTS_PER_COUNT,
};

/// ms.
const FRAME_MS: u64 = 10;

/// A vehicle with scripted parts.
pub struct Vehicle {
    pub time: VirtualTime,
    pub links: &'static Links,
    pub imu: FakeImu,
    pub arms: FakeArms,
    pub converter: FakeAnalog,
    pub motors: FakeMotors,
    pub servos: FakeServos,
    watchdog: FakeWatchdog,
    pub sticks: Option<Sticks>,
    ms: u64,
}

impl Vehicle {
    pub fn new() -> Self {
        Self::with(Params::default())
    }

    pub fn with(params: Params) -> Self {
        let (time, links) = (VirtualTime::new(), links_with(params));
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
        v.time.spawn(sophie_tasks::flight::imu::run(links, v.imu.clone()));
        v.time.spawn(sophie_tasks::flight::estimator::run(links));
        v.time.spawn(sophie_tasks::flight::control::run(links));
        let mixer = |p: &_| Flexible::new(Configuration::B, p);
        v.time.spawn(sophie_tasks::flight::mixer::run(links, mixer));
        v.time
            .spawn(sophie_tasks::flight::motors::run(links, v.motors.clone()));
        v.time
            .spawn(sophie_tasks::perching::analog::run(links, v.converter.clone()));
        v.time.spawn(sophie_tasks::perching::clamp::run(links));
        v.time
            .spawn(sophie_tasks::perching::servos::run(links, v.servos.clone()));
        v.time.spawn(sophie_tasks::pilot::commander::run(links));
        v.time.spawn(sophie_tasks::supervision::supervisor::run(
            links,
            v.watchdog.clone(),
            FakeMemory::default(),
        ));
        v.time
            .spawn(sophie_tasks::perching::arms::run(links, v.arms.clone()));
        v
    }

    /// Armed by switch and gesture, throttle at hover.
    pub fn flying() -> Self {
        let mut v = Self::new();
        v.run(4000);
        assert_eq!(v.mode(), Mode::Disarmed);
        let sticks = Sticks {
            arm_switch: true,
            ..Sticks::default()
        };
        v.sticks = Some(Sticks { yaw: 1.0, ..sticks });
        v.run(1200);
        assert_eq!(v.mode(), Mode::Armed, "{:?}", v.reason());
        v.sticks = Some(Sticks {
            throttle: 0.5,
            ..sticks
        });
        v.run(1000);
        assert_eq!(v.mode(), Mode::Flight, "{:?}", v.reason());
        assert!(v.motors_run() && v.fed_over(200) >= 19);
        v
    }

    pub fn run(&mut self, ms: u64) {
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
    pub fn until(&mut self, limit: u64, holds: impl Fn(&Self) -> bool) -> u64 {
        (0..=limit)
            .find(|i| {
                if *i > 0 {
                    self.run(1);
                }
                holds(self)
            })
            .unwrap_or_else(|| panic!("not within {limit} ms: {:?} {:?}", self.mode(), self.reason()))
    }

    pub fn mode(&self) -> Mode {
        self.links
            .status
            .latest()
            .map_or(Mode::Calibrating, |s| s.value.mode)
    }

    pub fn reason(&self) -> Option<Reason> {
        self.links.status.latest().and_then(|s| s.value.reason)
    }

    pub fn motors_run(&self) -> bool {
        self.motors.commands.get().iter().all(|c| *c > 0.0)
    }

    pub fn motors_stand(&self) -> bool {
        self.motors.commands.get() == [0.0; 4]
    }

    /// Watchdog feeds over the last `ms`.
    pub fn fed_over(&self, ms: u64) -> usize {
        self.watchdog.fed_since((self.ms - ms) * 1000 + 1)
    }
}
