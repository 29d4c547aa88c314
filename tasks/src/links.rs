//! The links between the tasks: one struct, each link with its message, rate and staleness limit.
//!
//! ```text
//! imu ──> estimator ──> control ──> mixer ──> motors          flight level, 1 kHz
//!              │           ^ ^        │ ^
//!              │  setpoint │ └─unmet──┘ │ arms, battery
//!              v           │            │
//! rc ──────> commander ────┘          arms      analog ──> contact, battery
//!              │  ^                                            │
//!              v  └─────── grip ──── clamp <───────────────────┘
//!          clamp command ──────────> clamp ──> servos          steady level, 50 to 500 Hz
//!
//! grip_memory, reel angle, tendon forces, gyro bias ──> supervisor ──> memory that outlives a reset ──> start
//! ```

use core::cell::{Cell, RefCell};

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant};
use sophie_control::arming::{Refusal, Refusals};
use sophie_control::attitude::Target;
pub use sophie_control::grip::GripState;
use sophie_control::grip_memory::GripMemory;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_control::rc::Sticks;
pub use sophie_control::setpoint::{ClampCommand, Setpoint};
use sophie_control::vector::{Quat, Vec3};
use sophie_control::wrench::{PerArm, Wrench};

use crate::deadline::{Level, TaskId};
use crate::histogram::Histogram;
use crate::newest::{Newest, Receiver};
use crate::start::{Cause, Start};
use crate::timing::{Quantity, Record, Run, Timing};

/// The mutex of every link: tasks of different priority meet here on the board.
pub type Raw = CriticalSectionRawMutex;

/// Most receivers of one link.
pub const RECEIVERS: usize = 8;

/// A value and the time at which what it describes was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// When it was measured.
    pub at: Instant,
    /// What was measured.
    pub value: T,
}

impl<T> Stamped<T> {
    /// The value, unless it is older than `limit` now.
    pub fn fresh(self, limit: Duration) -> Option<T> {
        self.fresh_at(Instant::now(), limit)
    }

    /// The value, unless it is older than `limit` at `now`.
    #[inline]
    pub fn fresh_at(self, now: Instant, limit: Duration) -> Option<T> {
        self.is_fresh(now, limit).then_some(self.value)
    }

    #[inline]
    fn is_fresh(&self, now: Instant, limit: Duration) -> bool {
        now.saturating_duration_since(self.at) <= limit
    }
}

/// A link that keeps the newest message.
pub struct Link<T: Clone> {
    newest: Newest<Stamped<T>>,
    /// Age beyond which a reader must not use the message.
    pub stale_after: Duration,
}

impl<T: Clone> Link<T> {
    const fn new(stale_after: Duration) -> Self {
        Self {
            newest: Newest::new(),
            stale_after,
        }
    }

    /// Publishes `value`, measured at `at`.
    pub fn send(&self, at: Instant, value: T) {
        self.newest.send(Stamped { at, value });
    }

    /// The newest message, however old.
    pub fn latest(&self) -> Option<Stamped<T>> {
        self.newest.look(Clone::clone)
    }

    /// What `f` makes of the newest message, however old.
    #[inline]
    pub fn look<R>(&self, f: impl FnOnce(&Stamped<T>) -> R) -> Option<R> {
        self.newest.look(f)
    }

    /// The newest message, unless it is stale.
    pub fn fresh(&self) -> Option<T> {
        self.fresh_to(Instant::now(), T::clone)
    }

    /// What `f` makes of the newest message, unless it is stale at `now`.
    #[inline]
    pub fn fresh_to<R>(&self, now: Instant, f: impl FnOnce(&T) -> R) -> Option<R> {
        self.look(|m| m.is_fresh(now, self.stale_after).then(|| f(&m.value)))
            .flatten()
    }

    /// A receiver that can wait for the next message; `None` when all [`RECEIVERS`] are taken.
    pub fn receiver(&self) -> Option<Receiver<'_, Stamped<T>>> {
        self.newest.receiver()
    }
}

/// Filtered inertial sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImuSample {
    /// Angular rate, rad/s, body, low-passed; the estimator takes its bias off.
    pub gyro: Vec3,
    /// Specific force, m/s², body, the newest, low-passed.
    pub accel: Vec3,
    /// Time since the sample before, s, limited to a sane range.
    pub dt: f32,
}

/// Estimated motion of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Body to world.
    pub q: Quat,
    /// Angular rate without bias, rad/s, body.
    pub rate: Vec3,
    /// Specific force, m/s², body.
    pub accel: Vec3,
    /// Estimated gyro bias, rad/s.
    pub gyro_bias: Vec3,
    /// Calibration at rest has ended.
    pub calibrated: bool,
    /// Time since the estimate before, s.
    pub dt: f32,
}

/// What the controllers ask of the mixer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Demand {
    /// Rotors stopped.
    #[default]
    Stop,
    /// Rotors at idle.
    Idle,
    /// This wrench.
    Wrench {
        /// The wrench asked for.
        wrench: Wrench,
        /// Yaw may be used.
        yaw: bool,
    },
}

/// What the mixer gave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MixOutput {
    /// Rotors run.
    pub running: bool,
    /// Thrust asked of each rotor, N.
    pub thrusts: PerArm<f32>,
    /// Motor commands, 0..1, battery compensated.
    pub commands: PerArm<f32>,
    /// Share of the asked yaw, thrust (relative to the range left) and roll/pitch that was given, 0..1.
    pub given: sophie_control::desaturation::Given,
    /// Yaw is being given up because the arms' tilt leaves no authority.
    pub yaw_gated: bool,
    /// Estimated tilt of each arm, rad.
    pub tilt: PerArm<f32>,
    /// Tilt bias of each arm, rad.
    pub tilt_bias: PerArm<f32>,
    /// An arm's model is outside its range of validity.
    pub tilt_fault: bool,
}

/// Contact pressures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Pressure at each arm's sensor, Pa.
    pub pressure: PerArm<f32>,
    /// Sensor open, shorted or out of range.
    pub fault: PerArm<bool>,
}

/// Flight battery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery {
    /// Voltage under load, V, low-passed.
    pub voltage: f32,
    /// Current, A, low-passed.
    pub current: f32,
    /// Charge drawn since power-up, A·s.
    pub used: f32,
    /// Voltage over nominal, limited to a sane range: what the thrust curve is compensated by.
    pub ratio: f32,
}

/// Tilt of the arms as their own sensors see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmAngles {
    /// Tilt of each arm, rad, tip up positive; `None` when that sensor gave nothing fresh.
    pub tilt: PerArm<Option<f32>>,
}

/// Tension asked of each tendon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TendonForces {
    /// Tension, N; 0 is slack.
    pub force: PerArm<f32>,
    /// The tendons were found wound when the power came on: where their servos stand is to be taken from the tilt.
    pub found: bool,
    /// Servos that are to stay where they are, whatever the force.
    pub stay: PerArm<bool>,
}

/// State of the radio link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RcState {
    /// The pilot's wishes.
    pub sticks: Sticks,
    /// Frames decoded since power-up.
    pub frames: u32,
    /// Frames or bytes rejected since power-up.
    pub errors: u32,
}

/// The commander's view, for telemetry, log and lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// State of the vehicle.
    pub mode: Mode,
    /// Why arming is refused or the failsafe acts; empty when nothing does.
    pub reason: &'static str,
    /// What does not stop the flight but must be known; empty when there is nothing.
    pub warning: &'static str,
    /// Everything that forbids arming now.
    pub refusals: Refusals,
}

/// Every link of one vehicle.
pub struct Links {
    /// Parameters, fixed while armed.
    pub params: Params,
    /// Why the board started and what the run before left, fixed. start-up -> every task that resumes from it.
    pub start: Start,
    /// imu -> estimator. 1 kHz, stale after 5 ms.
    pub imu: Link<ImuSample>,
    /// estimator -> control, commander, arms. 1 kHz, stale after 5 ms.
    pub attitude: Link<Attitude>,
    /// commander -> control. 100 Hz, stale after 50 ms: rotors stop then.
    pub setpoint: Link<Setpoint>,
    /// control -> mixer. 1 kHz, stale after 5 ms.
    pub demand: Link<Demand>,
    /// control -> log. 1 kHz, stale after 50 ms: where down is aimed at in body axes, and the wanted heading against the
    /// present one.
    pub target: Link<Target>,
    /// mixer -> motors, control (what it could not give), commander. 1 kHz, stale after 10 ms: motors stop.
    pub mix: Link<MixOutput>,
    /// analog -> clamp, commander. 500 Hz, stale after 20 ms.
    pub contact: Link<Contact>,
    /// analog -> mixer, commander. 100 Hz, stale after 500 ms.
    pub battery: Link<Battery>,
    /// arms -> mixer, servos. 100 Hz, stale after 100 ms.
    pub arms: Link<ArmAngles>,
    /// commander -> clamp. 100 Hz, stale after 200 ms: forces are held then; before the first nothing is sent.
    pub clamp_command: Link<ClampCommand>,
    /// clamp -> servos, supervisor. 100 Hz, stale after 200 ms: servos hold then; before the first no pulses.
    pub tendons: Link<TendonForces>,
    /// servos -> clamp. Each servo frame (50 to 333 Hz), stale after 200 ms: tension that the servos can be giving now, N.
    pub tension: Link<PerArm<f32>>,
    /// servos -> supervisor. 50 Hz, stale after 200 ms: angle to which each servo is sent, rad from release.
    pub reel_angle: Link<PerArm<f32>>,
    /// commander -> supervisor. 100 Hz, stale after 200 ms: the grip that must outlive a reset.
    pub grip_memory: Link<GripMemory>,
    /// clamp -> commander, supervisor. 100 Hz, stale after 100 ms.
    pub grip: Link<GripState>,
    /// rc -> commander. As frames come (50 to 500 Hz), stale after 500 ms: failsafe.
    pub rc: Link<RcState>,
    /// commander -> telemetry, log. 100 Hz, stale after 200 ms.
    pub status: Link<Status>,
    /// every task of the flight level -> log. When one misses its deadline.
    pub missed: Signal<Raw, ()>,
    timing: [Mutex<Raw, RefCell<Record>>; TaskId::COUNT],
    hardware: Mutex<Raw, Cell<Refusals>>,
}

impl Links {
    /// Links without messages, after power-on.
    pub const fn new(params: Params) -> Self {
        Self::starting(params, Start::COLD)
    }

    /// Links without messages after this start.
    pub const fn starting(params: Params, start: Start) -> Self {
        const fn ms(n: u64) -> Duration {
            Duration::from_millis(n)
        }
        Self {
            params,
            start,
            imu: Link::new(ms(5)),
            attitude: Link::new(ms(5)),
            setpoint: Link::new(ms(50)),
            demand: Link::new(ms(5)),
            target: Link::new(ms(50)),
            mix: Link::new(ms(10)),
            contact: Link::new(ms(20)),
            battery: Link::new(ms(500)),
            arms: Link::new(ms(100)),
            clamp_command: Link::new(ms(200)),
            tendons: Link::new(ms(200)),
            tension: Link::new(ms(200)),
            reel_angle: Link::new(ms(200)),
            grip_memory: Link::new(ms(200)),
            grip: Link::new(ms(100)),
            rc: Link::new(ms(500)),
            status: Link::new(ms(200)),
            missed: Signal::new(),
            timing: [const { Mutex::new(RefCell::new(Record::new())) }; TaskId::COUNT],
            hardware: Mutex::new(Cell::new(match start.cause {
                Cause::BrownOut => Refusals::NONE.with(Refusal::BrownOut),
                _ => Refusals::NONE,
            })),
        }
    }

    /// What speaks against arming on the hardware's side. drivers' tasks, start-up, console -> commander.
    pub fn hardware(&self) -> Refusals {
        self.hardware.lock(Cell::get)
    }

    /// Reports that `reason` holds, or holds no longer.
    pub fn report(&self, reason: Refusal, holds: bool) {
        self.hardware.lock(|cell| {
            let all = cell.get();
            cell.set(if holds {
                all.with(reason)
            } else {
                all.without(reason)
            });
        });
    }

    /// Timing of a task since power-up.
    pub fn timing(&self, task: TaskId) -> Timing {
        self.with_record(task, |record| record.totals).unwrap_or_default()
    }

    /// Histogram of a task's times since it was taken last.
    pub fn take_histogram(&self, task: TaskId, quantity: Quantity) -> Histogram {
        self.with_record(task, |record| record.take(quantity))
            .unwrap_or(Histogram::EMPTY)
    }

    /// Records one run of a task.
    pub fn record(&self, task: TaskId, run: &Run) {
        let missed = self.with_record(task, |record| record.add(run));
        if missed == Some(true) && task.level() == Level::Flight {
            self.missed.signal(());
        }
    }

    fn with_record<T>(&self, task: TaskId, f: impl FnOnce(&mut Record) -> T) -> Option<T> {
        let slot = self.timing.get(task as usize)?;
        // Borrowed nowhere else: the lock is held for as long.
        slot.lock(|cell| cell.try_borrow_mut().ok().map(|mut record| f(&mut record)))
    }
}
