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

pub mod last_value;

use core::cell::{Cell, RefCell};
use core::sync::atomic::{AtomicBool, Ordering};
use sophie_ports::receiver::RcState;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant};
use sophie_control::allocation::wrench::PerArm;
pub use sophie_control::approach::pipe_target::PipeTarget;
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::attitude::attitude_loop::Target;
use sophie_control::battery::ServoSupply;
pub use sophie_control::battery::{Battery, ServoBattery};
pub use sophie_control::chain::setpoint::{ClampCommand, Setpoint};
pub use sophie_control::chain::{Attitude, Demand, ImuSample, MixOutput};
use sophie_control::gripper::contact_pressure::FsrFault;
pub use sophie_control::gripper::grip::GripState;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::mode::{Mode, Reason};
pub use sophie_control::navigation::air_pressure::AirPressure;
pub use sophie_control::navigation::estimate::Estimate;
pub use sophie_control::navigation::flow_range_sample::GroundView;
pub use sophie_control::navigation::position_estimator::Fault;
use sophie_control::params::Params;
use sophie_control::pilot::bench_orders::Place;
pub use sophie_control::pilot::bench_orders::{BenchAnswer, BenchRequest, BenchView};
pub use sophie_control::pilot::remote::{RemoteAnswer, RemoteRequest};
use sophie_mavlink::inputs::Counts;
use sophie_mavlink::wire::signing::{Refused, Signing};
pub use sophie_ports::external_pose::ExternalPose;
use sophie_ports::signing::Stored;

use crate::links::last_value::{LastValue, Receiver};
pub use crate::links::last_value::{RECEIVERS, Raw};
use crate::schedule::histogram::Histogram;
use crate::schedule::timing::{Quantity, Record, Run, Timing};
use crate::schedule::{Level, TaskId};
use crate::start::Start;
use sophie_ports::retained::StartCause;
use sophie_ports::sensors::AnalogFrame;

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

    /// True unless it is older than `limit` at `now`.
    #[inline]
    pub fn is_fresh(&self, now: Instant, limit: Duration) -> bool {
        now.saturating_duration_since(self.at) <= limit
    }
}

/// The newest message of a link as a reader that has a use for old ones sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Newest<T> {
    /// Measured within the link's limit.
    Fresh(Stamped<T>),
    /// Measured longer ago: the last that is known, not what is.
    Held(Stamped<T>),
}

/// A link that keeps the newest message.
pub struct Link<T: Clone> {
    newest: LastValue<Stamped<T>>,
    /// Age beyond which a reader must not use the message.
    pub stale_after: Duration,
}

impl<T: Clone> Link<T> {
    const fn new(stale_after: Duration) -> Self {
        Self {
            newest: LastValue::new(),
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

    /// The newest message, marked as fresh or held.
    pub fn newest(&self) -> Option<Newest<T>> {
        self.latest().map(|m| match m.clone().fresh(self.stale_after) {
            Some(_) => Newest::Fresh(m),
            None => Newest::Held(m),
        })
    }

    /// A receiver that can wait for the next message; `None` when all [`RECEIVERS`] are taken.
    pub fn receiver(&self) -> Option<Receiver<'_, Stamped<T>>> {
        self.newest.receiver()
    }
}

/// Contact pressures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Pressure at each arm's sensor, Pa, or what is wrong with the sensor.
    pub arms: PerArm<Result<f32, FsrFault>>,
}

impl Default for Contact {
    /// Sound sensors that feel nothing.
    fn default() -> Self {
        Self { arms: [Ok(0.0); 4] }
    }
}

/// Tilt of the arms as their own sensors see it; the message's time is that of the oldest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmAngles {
    /// Tilt of each arm, rad, tip up positive, with the time at which its sensor was asked; `None` when it gave nothing.
    pub tilt: PerArm<Option<Stamped<f32>>>,
}

impl ArmAngles {
    /// Angles that were all measured at `at`, rad.
    pub fn at(at: Instant, tilt: PerArm<Option<f32>>) -> Self {
        Self {
            tilt: tilt.map(|tilt| tilt.map(|value| Stamped { at, value })),
        }
    }

    /// When the oldest of them was measured.
    pub fn oldest(&self) -> Option<Instant> {
        self.tilt.iter().flatten().map(|tilt| tilt.at).min()
    }

    /// Those that are not older than `limit` now.
    pub fn within(self, limit: Duration) -> Self {
        Self {
            tilt: self.tilt.map(|tilt| tilt.filter(|t| t.fresh(limit).is_some())),
        }
    }

    /// The angles alone, rad.
    pub fn values(&self) -> PerArm<Option<f32>> {
        self.tilt.map(|tilt| tilt.map(|t| t.value))
    }
}

/// Forces asked of the tendons, by what they follow from. The message's time is that of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TendonOrder {
    /// From the pressures that were converted at the message's time.
    Measured(TendonForces),
    /// From the command of the message's time alone, since no pressure is fresh: closed arms keep their force, those
    /// that are to be released lose it.
    Blind(TendonForces),
    /// From before a restart, sent once at the start: the servos stay where they are until a command comes.
    Resumed(TendonForces),
    /// On the bench: one servo at a pulse, the others by their forces, which are none.
    Placed {
        /// Of each one.
        forces: TendonForces,
        /// The one servo.
        place: Place,
    },
}

impl TendonOrder {
    /// The forces, whatever they follow from.
    pub const fn forces(&self) -> &TendonForces {
        match self {
            Self::Measured(forces)
            | Self::Blind(forces)
            | Self::Resumed(forces)
            | Self::Placed { forces, .. } => forces,
        }
    }
}

/// What is asked of the tendons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TendonForces {
    /// Of each one.
    pub arms: PerArm<TendonForce>,
    /// The tendons were found wound when the power came on: where their servos stand is to be taken from the tilt.
    pub found: bool,
}

/// What is asked of one tendon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TendonForce {
    /// Tension, N; 0 is slack.
    pub force: f32,
    /// The servo is to stay where it is, whatever the force.
    pub stay: bool,
}

/// The commander's view, for telemetry, log and lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// State of the vehicle.
    pub mode: Mode,
    /// Why arming is refused or the failsafe acts; `None` when nothing does.
    pub reason: Option<Reason>,
    /// What does not stop the flight but must be known; empty when there is nothing.
    pub warning: &'static str,
    /// Everything that forbids arming now.
    pub inhibits: ArmingInhibits,
}

/// Whether frames of MAVLink are signed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SigningState {
    /// No key is stored.
    #[default]
    Off,
    /// A key is in force.
    On,
    /// The storage cannot be read: nothing is obeyed.
    Unknown,
    /// It could not be read and was erased: nothing is obeyed until a key is set, or none.
    Lost,
}

/// What the MAVLink line is like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineState {
    /// Whether frames are signed.
    pub signing: SigningState,
    /// Frames that were refused for their signature since the start.
    pub refused: Refused,
    /// Inputs from outside since the start.
    pub inputs: Counts,
}

impl LineState {
    /// As `signing` has it, with what came in.
    pub const fn of(signing: &Signing, inputs: Counts) -> Self {
        Self {
            signing: match signing.stored() {
                Stored::None => SigningState::Off,
                Stored::Key(_) => SigningState::On,
                Stored::Unreadable => SigningState::Unknown,
                Stored::Lost => SigningState::Lost,
            },
            refused: signing.refused(),
            inputs,
        }
    }
}

/// What is declared of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Declared {
    /// Its field of [`Links`].
    pub name: &'static str,
    /// The message's type.
    pub message: &'static str,
    /// The task that sends it; each run does, unless `meaning` says otherwise.
    pub from: TaskId,
    /// Who reads it: tasks by their names, the console or the log.
    pub to: &'static str,
    /// Age beyond which a reader must not use it.
    pub stale_after: Duration,
    /// What it is, and what its readers do without a fresh one.
    pub meaning: &'static str,
}

macro_rules! links {
    ($(
        $(#[doc = $meaning:literal])+
        $name:ident: $message:ty, $from:ident to $to:literal, stale after $stale:literal ms;
    )*) => {
        /// Every link of one vehicle.
        pub struct Links {
            /// Parameters, fixed while armed.
            pub params: Params,
            /// Why the board started and what the run before left, fixed. start-up -> every task that resumes from it.
            pub start: Start,
            $(
                $(#[doc = $meaning])+
                #[doc = concat!("\n\nFrom [`TaskId::", stringify!($from), "`] to ", $to, ", stale after ", $stale, " ms.")]
                pub $name: Link<$message>,
            )*
            /// every task of the flight level -> log. When one misses its deadline.
            pub missed: Signal<Raw, ()>,
            timing: [Mutex<Raw, RefCell<Record>>; TaskId::COUNT],
            contact_chain: Mutex<Raw, RefCell<Record>>,
            hardware: Mutex<Raw, Cell<ArmingInhibits>>,
            stack_scarce: AtomicBool,
        }

        impl Links {
            /// Every link, in the order of the declaration.
            pub const DECLARED: &'static [Declared] = &[$(Declared {
                name: stringify!($name),
                message: stringify!($message),
                from: TaskId::$from,
                to: $to,
                stale_after: Duration::from_millis($stale),
                meaning: concat!($($meaning),+),
            }),*];

            /// Links without messages after this start.
            pub const fn starting(params: Params, start: Start) -> Self {
                Self {
                    params,
                    start,
                    $($name: Link::new(Duration::from_millis($stale)),)*
                    missed: Signal::new(),
                    timing: [const { Mutex::new(RefCell::new(Record::new())) }; TaskId::COUNT],
                    contact_chain: Mutex::new(RefCell::new(Record::new())),
                    hardware: Mutex::new(Cell::new(match start.cause {
                        StartCause::BrownOut => ArmingInhibits::NONE.with(ArmingInhibit::BrownOut),
                        _ => ArmingInhibits::NONE,
                    })),
                    stack_scarce: AtomicBool::new(false),
                }
            }
        }
    };
}

links! {
    /// Filtered inertial samples.
    imu: ImuSample, Imu to "estimator", stale after 5 ms;
    /// The estimate.
    attitude: Attitude, Estimator to "control, commander, position, arms, telemetry, supervisor, console, mavlink", stale after 5 ms;
    /// What the rotors are to do; without it they stop.
    setpoint: Setpoint, Commander to "control", stale after 50 ms;
    /// What the controllers ask of the mixer.
    demand: Demand, Control to "mixer", stale after 5 ms;
    /// Where down is aimed at in body axes, and the wanted heading against the present one.
    target: Target, Control to "log", stale after 50 ms;
    /// What the mixer gave, and to `control` what it could not give; without it the motors stop.
    mix: MixOutput, Mixer to "motors, control, clamp, commander, position, supervisor, mavlink", stale after 10 ms;
    /// Contact pressures; without them closed arms keep their force and are faulty.
    contact: Contact, Analog to "clamp, commander, console", stale after 20 ms;
    /// The flight battery, with each fifth conversion; the mixer keeps the last one.
    battery: Battery, Analog to "mixer, commander, telemetry, console, mavlink", stale after 500 ms;
    /// The servo battery, if one is measured, with each fifth conversion; without it no perch begins.
    servo_battery: ServoBattery, Analog to "commander, console, mavlink", stale after 500 ms;
    /// What the converter gave, with each fifth conversion.
    counts: AnalogFrame, Analog to "console", stale after 100 ms;
    /// Tilt of the arms, each with its own time; without one its servo stays.
    arms: ArmAngles, Arms to "mixer, clamp, servos, console, mavlink", stale after 100 ms;
    /// What the tendons are to do; without it the clamp makes no step and sends nothing.
    clamp_command: ClampCommand, Commander to "clamp", stale after 200 ms;
    /// Forces, with the time of what they follow from; without them the servos stay, before the first there are no pulses.
    tendons: TendonOrder, Clamp to "servos, supervisor", stale after 200 ms;
    /// Tension that the servos can be giving, N, as old as the oldest tilt in it; without it nothing is proven free.
    tension: PerArm<f32>, Servos to "clamp, console", stale after 200 ms;
    /// Angle to which each servo is sent, rad from release.
    reel_angle: PerArm<f32>, Servos to "supervisor, console, mavlink", stale after 200 ms;
    /// The grip that must outlive a reset.
    grip_memory: GripMemory, Commander to "supervisor", stale after 200 ms;
    /// The judgement, of the time of its pressures, or of the command where none is fresh: closed arms are faulty then.
    grip: GripState, Clamp to "commander, supervisor, mavlink", stale after 100 ms;
    /// The pilot's wishes, as frames come; without them failsafe.
    rc: RcState, Rc to "commander, console, mavlink", stale after 500 ms;
    /// The commander's view.
    status: Status, Commander to "telemetry, console, mavlink, log", stale after 200 ms;
    /// What a builder tries on the table, by console or MAVLink, renewed while it lasts; without it motors stop and servos go to release.
    bench: BenchRequest, Console to "commander", stale after 150 ms;
    /// What has become of it.
    bench_answer: BenchAnswer, Commander to "console, mavlink", stale after 200 ms;
    /// Where others see the vehicle, as they send it.
    external_pose: ExternalPose, Mavlink to "position, console", stale after 200 ms;
    /// Flow and range below the vehicle, from the module's line or by MAVLink, of the newest one's arrival; each has its own time.
    ground: GroundView, Ground to "position, console", stale after 200 ms;
    /// Pressure of the air by the board's barometer; without it the height of last resort is the inertial sensor's.
    air_pressure: AirPressure, Barometer to "position, console", stale after 200 ms;
    /// Where the vehicle is; the message says since when only the inertial sensor says it. Without it nothing is held.
    position: Estimate, Position to "commander, console, log", stale after 50 ms;
    /// Where another computer sees the pipe, as it sends it; without it, and without a range, there is no perching by itself.
    pipe_target: PipeTarget, Mavlink to "commander", stale after 1500 ms;
    /// What of pose, flow, range and air pressure is wrong and left out, as long as it is.
    position_fault: Fault, Position to "commander, console", stale after 50 ms;
    /// What the MAVLink line is like.
    mavlink: LineState, Mavlink to "console", stale after 200 ms;
    /// What a ground station orders beside the pilot, renewed until it is answered; an order is obeyed once.
    remote: RemoteRequest, Mavlink to "commander", stale after 100 ms;
    /// What has become of it.
    remote_answer: RemoteAnswer, Commander to "mavlink", stale after 200 ms;
}

impl Links {
    /// Links without messages, after power-on.
    pub const fn new(params: Params) -> Self {
        Self::starting(params, Start::COLD)
    }

    /// What speaks against arming on the hardware's side. drivers' tasks, start-up, console -> commander.
    pub fn hardware(&self) -> ArmingInhibits {
        self.hardware.lock(Cell::get)
    }

    /// Reports that `reason` holds, or holds no longer.
    pub fn report(&self, reason: ArmingInhibit, holds: bool) {
        self.hardware.lock(|cell| {
            let all = cell.get();
            cell.set(if holds {
                all.with(reason)
            } else {
                all.without(reason)
            });
        });
    }

    /// Whether less than its reserve has stayed unused of the stack. log -> commander.
    pub fn stack_is_scarce(&self) -> bool {
        self.stack_scarce.load(Ordering::Relaxed)
    }

    /// Reports it: until the restart, as the greatest depth stays.
    pub fn report_scarce_stack(&self) {
        self.stack_scarce.store(true, Ordering::Relaxed);
    }

    /// The bench as who wants to give an order sees it.
    pub fn bench_view(&self) -> BenchView {
        BenchView {
            newest: self.bench.look(|m| m.value.number).unwrap_or(0),
            renewed: self.bench.fresh().is_some(),
            answer: self.bench_answer.fresh().unwrap_or_default(),
        }
    }

    /// The servo battery as it is now.
    pub fn servo_supply(&self) -> ServoSupply {
        if self.params.servo_batt_div > 0.0 {
            match self.servo_battery.fresh() {
                Some(battery) => battery.supply,
                // The first reading may still come.
                None if Instant::now() < Instant::MIN + self.servo_battery.stale_after => {
                    ServoSupply::NotFitted
                }
                None => ServoSupply::Silent,
            }
        } else {
            ServoSupply::NotFitted
        }
    }

    /// Tilt of each arm that was measured within the link's limit, with the time of each.
    pub fn tilts(&self) -> ArmAngles {
        let newest = self.arms.latest().map(|m| m.value).unwrap_or_default();
        newest.within(self.arms.stale_after)
    }

    /// Records one answer to pressures: released when they were converted, started when the compare values were written,
    /// ended when the pulse of these begins.
    pub fn record_contact(&self, run: &Run) {
        with(&self.contact_chain, |record| record.add(run));
    }

    /// Timing from the conversion of pressures to the servos' pulse, since power-up.
    pub fn contact_timing(&self) -> Timing {
        with(&self.contact_chain, |record| record.totals()).unwrap_or_default()
    }

    /// Histogram of the same since it was taken last.
    pub fn take_contact_histogram(&self, quantity: Quantity) -> Histogram {
        with(&self.contact_chain, |record| record.take(quantity)).unwrap_or(Histogram::EMPTY)
    }

    /// Timing of a task since power-up.
    pub fn timing(&self, task: TaskId) -> Timing {
        self.with_record(task, |record| record.totals())
            .unwrap_or_default()
    }

    /// Longest response of a task that was added, µs, without adding the one that was noted last.
    pub fn worst_response(&self, task: TaskId) -> u32 {
        self.with_record(task, |record| record.worst_response())
            .unwrap_or(0)
    }

    /// Histogram of a task's times since it was taken last.
    pub fn take_histogram(&self, task: TaskId, quantity: Quantity) -> Histogram {
        self.with_record(task, |record| record.take(quantity))
            .unwrap_or(Histogram::EMPTY)
    }

    /// Records one run of a task.
    pub fn record(&self, task: TaskId, run: &Run) {
        let missed = self.with_record(task, |record| record.add(run));
        self.tell_missed(task, missed);
    }

    /// Records one run of a task on the way to the motor frame: noted here, added by [`Self::settle`].
    #[inline]
    pub fn note(&self, task: TaskId, run: &Run) {
        let missed = self.with_record(task, |record| record.note(run));
        self.tell_missed(task, missed);
    }

    /// Adds what the flight level has noted. Called when the motor frame is out; each task has its own lock, so that
    /// interrupts are masked for no longer than one run takes.
    pub fn settle(&self) {
        for task in TaskId::ALL
            .into_iter()
            .filter(|task| task.level() == Level::Flight)
        {
            self.with_record(task, Record::settle);
        }
    }

    #[inline]
    fn tell_missed(&self, task: TaskId, missed: Option<bool>) {
        if missed == Some(true) && task.level() == Level::Flight {
            self.missed.signal(());
        }
    }

    fn with_record<T>(&self, task: TaskId, f: impl FnOnce(&mut Record) -> T) -> Option<T> {
        with(self.timing.get(task as usize)?, f)
    }
}

fn with<T>(slot: &Mutex<Raw, RefCell<Record>>, f: impl FnOnce(&mut Record) -> T) -> Option<T> {
    // Borrowed nowhere else: the lock is held for as long.
    slot.lock(|cell| cell.try_borrow_mut().ok().map(|mut record| f(&mut record)))
}
