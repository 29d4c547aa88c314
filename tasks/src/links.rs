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
pub mod link;
pub mod mavlink_line;
pub mod messages;
pub mod tendon_order;
pub mod timing_records;

use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering};

use embassy_sync::blocking_mutex::Mutex;
use embassy_time::{Duration, Instant};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::approach::pipe_target::PipeTarget;
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::attitude::attitude_loop::Target;
use sophie_control::battery::{Battery, ServoBattery, ServoSupply};
use sophie_control::chain::setpoint::{ClampCommand, Setpoint};
use sophie_control::chain::{Attitude, Demand, ImuSample, MixOutput};
use sophie_control::gripper::grip::GripState;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::navigation::estimate::Estimate;
use sophie_control::navigation::flow_range_sample::GroundView;
use sophie_control::navigation::position_estimator::Fault;
use sophie_control::params::Params;
use sophie_control::pilot::bench_orders::{BenchAnswer, BenchRequest, BenchView};
use sophie_control::pilot::remote::{RemoteAnswer, RemoteRequest};
use sophie_ports::external_pose::ExternalPose;
use sophie_ports::receiver::RcState;
use sophie_ports::retained::StartCause;
use sophie_ports::sensors::AnalogFrame;

use self::last_value::Raw;
use self::link::Link;
use self::mavlink_line::LineState;
use self::messages::{ArmAngles, Contact, Status};
use self::tendon_order::TendonOrder;
use self::timing_records::TimingRecords;
use crate::schedule::TaskId;
use crate::start::Start;

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
            /// Timing of every task. every task -> console, log, supervisor, commander.
            pub timing: TimingRecords,
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
                    timing: TimingRecords::new(),
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
}
