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
pub mod raw_forces;
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
use sophie_control::calibration::procedure::Readings;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{Attitude, Demand, ImuSample, MixOutput};
use sophie_control::gripper::clamp_command::ClampCommand;
use sophie_control::gripper::grip::GripState;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::navigation::estimate::Estimate;
use sophie_control::navigation::flow_range_sample::GroundView;
use sophie_control::navigation::position_estimator::Fault;
use sophie_control::params::Params;
use sophie_control::pilot::actuator_test::{ActuatorTestAnswer, ActuatorTestRequest, ActuatorTestView};
use sophie_control::pilot::remote::{RemoteAnswer, RemoteRequest};
use sophie_control::position_hold::gains::HoldGains;
use sophie_control::thrust_factor::ThrustFactor;
use sophie_control::vibration::Vibration;
use sophie_ports::external_pose::ExternalPose;
use sophie_ports::receiver::RcState;
use sophie_ports::retained::StartCause;
use sophie_ports::sensors::AnalogFrame;

use self::last_value::Raw;
use self::link::Link;
use self::mavlink_line::LineState;
use self::messages::{ArmAngles, Contact, Status};
use self::raw_forces::RawForces;
use self::tendon_order::TendonOrder;
use self::timing_records::TimingRecords;
use crate::schedule::TaskId;
use crate::start::Start;

/// Declaration of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Declared {
    /// Name of its field in [`Links`].
    pub name: &'static str,
    /// The message's type.
    pub message: &'static str,
    /// The task that sends it; each run does, unless `meaning` says otherwise.
    pub from: TaskId,
    /// Who reads it: tasks by their names, the console or the log.
    pub to: &'static str,
    /// Age beyond which a reader must not use it.
    pub stale_after: Duration,
    /// Description, and reaction of its readers to a stale message.
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
            /// Gains of HOLD for these parameters, solved before the tasks run: the commander's first step would be
            /// late with them.
            pub hold_gains: HoldGains,
            /// Cause of the start and retained state of the previous run, fixed. start-up -> every task that resumes
            /// from it.
            pub start: Start,
            $(
                $(#[doc = $meaning])+
                #[doc = concat!("\n\nFrom [`TaskId::", stringify!($from), "`] to ", $to, ", stale after ", $stale, " ms.")]
                pub $name: Link<$message>,
            )*
            /// Timing of every task. every task -> console, log, supervisor, commander.
            pub timing: TimingRecords,
            /// The newest raw readings of the accelerometer. imu -> commander.
            pub raw_forces: RawForces,
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
            pub fn starting(params: Params, start: Start) -> Self {
                Self {
                    hold_gains: HoldGains::of(&params),
                    params,
                    start,
                    $($name: Link::new(Duration::from_millis($stale)),)*
                    timing: TimingRecords::new(),
                    raw_forces: RawForces::new(),
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
    /// Attitude estimate.
    attitude: Attitude, Estimator to "control, commander, position, arms, telemetry, supervisor, console, mavlink", stale after 5 ms;
    /// Setpoint of the controllers; without it the rotors stop.
    setpoint: Setpoint, Commander to "control", stale after 50 ms;
    /// The vehicle has swung by itself: roll and pitch slower; the loops keep the last one.
    gentle: bool, Commander to "control", stale after 200 ms;
    /// Thrust and torque demand of the controllers.
    demand: Demand, Control to "mixer", stale after 5 ms;
    /// Target direction of down in body axes, and heading error.
    target: Target, Control to "log", stale after 50 ms;
    /// Rotor thrusts and motor commands, and for `control` the share of the demand that was met; without it the motors stop.
    mix: MixOutput, Mixer to "motors, control, clamp, commander, position, supervisor, mavlink", stale after 10 ms;
    /// Contact pressures; without them closed arms keep their force and are faulty.
    contact: Contact, Analog to "clamp, commander, console", stale after 20 ms;
    /// The flight battery, with each fifth conversion; the mixer keeps the last one.
    battery: Battery, Analog to "mixer, commander, telemetry, console, mavlink", stale after 500 ms;
    /// The servo battery, if one is measured, with each fifth conversion; without it no perch begins.
    servo_battery: ServoBattery, Analog to "commander, console, mavlink", stale after 500 ms;
    /// Raw counts of the converter, with each fifth conversion.
    counts: AnalogFrame, Analog to "console", stale after 100 ms;
    /// Tilt of the arms, each with its own time; without one its servo stays.
    arms: ArmAngles, Arms to "mixer, clamp, servos, console, mavlink", stale after 100 ms;
    /// Command to the tendons; without it the clamp makes no step and sends nothing.
    clamp_command: ClampCommand, Commander to "clamp", stale after 200 ms;
    /// Demanded tendon forces, stamped with the time of their input; if stale, the servos hold; before the first there are no pulses.
    tendons: TendonOrder, Clamp to "servos, supervisor", stale after 200 ms;
    /// Estimated tendon tension, N, stamped with the oldest tilt used; if stale, no arm is proven free.
    tension: PerArm<f32>, Servos to "clamp, console", stale after 200 ms;
    /// Commanded angle of each servo, rad from release.
    reel_angle: PerArm<f32>, Servos to "supervisor, console, mavlink", stale after 200 ms;
    /// The grip that must outlive a reset.
    grip_memory: GripMemory, Commander to "supervisor", stale after 200 ms;
    /// Assessment of the grip, stamped with its pressures; without fresh pressure with the command, and closed arms are faulty then.
    grip: GripState, Clamp to "commander, supervisor, mavlink", stale after 100 ms;
    /// The pilot's sticks and switches, with each receiver frame; without them failsafe.
    rc: RcState, Rc to "commander, console, mavlink", stale after 500 ms;
    /// State reported by the commander.
    status: Status, Commander to "telemetry, console, mavlink, log", stale after 200 ms;
    /// Thrust learnt in flight over that of the parameters; the mixer keeps the last one.
    thrust_factor: ThrustFactor, Commander to "mixer, supervisor, console, log", stale after 200 ms;
    /// Vibration of each second at the inertial sensor.
    vibration: Vibration, Commander to "console, mavlink", stale after 2500 ms;
    /// Test of one actuator, by console or MAVLink, renewed while it lasts; without it motors stop and servos go to release.
    actuator_test: ActuatorTestRequest, Console to "commander", stale after 150 ms;
    /// Reply to the last actuator test.
    actuator_test_answer: ActuatorTestAnswer, Commander to "console, mavlink", stale after 200 ms;
    /// Vehicle pose measured externally, with each message.
    external_pose: ExternalPose, Mavlink to "position, console", stale after 200 ms;
    /// Flow and range below the vehicle, from the module's line or by MAVLink, stamped with the newest arrival; each has its own time.
    ground: GroundView, Ground to "position, console", stale after 200 ms;
    /// Air pressure of the board's barometer; without it the fallback height is inertial.
    air_pressure: AirPressure, Barometer to "position, console", stale after 200 ms;
    /// Position estimate, with the start of dead reckoning if it has no other source; without it no position is held.
    position: Estimate, Position to "commander, console, log", stale after 50 ms;
    /// Pipe position from a companion computer, with each message; autonomous perching needs it or a range.
    pipe_target: PipeTarget, Mavlink to "commander", stale after 1500 ms;
    /// Fault of pose, flow, range or air pressure, while that input is rejected.
    position_fault: Fault, Position to "commander, console", stale after 50 ms;
    /// State of the MAVLink lines.
    mavlink: LineState, Mavlink to "console", stale after 200 ms;
    /// Remote command of a ground station, renewed until it is answered; executed once.
    remote: RemoteRequest, Mavlink to "commander", stale after 100 ms;
    /// Reply to the last remote command.
    remote_answer: RemoteAnswer, Commander to "mavlink", stale after 200 ms;
}

impl Links {
    /// Links without messages, after power-on.
    pub fn new(params: Params) -> Self {
        Self::starting(params, Start::COLD)
    }

    /// Hardware reasons that inhibit arming. drivers' tasks, start-up, console -> commander.
    pub fn hardware(&self) -> ArmingInhibits {
        self.hardware.lock(Cell::get)
    }

    /// Sets or clears the arming inhibit `reason`.
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

    /// True if the unused part of the stack is below its reserve. log -> commander.
    pub fn stack_is_scarce(&self) -> bool {
        self.stack_scarce.load(Ordering::Relaxed)
    }

    /// Sets [`Self::stack_is_scarce`] until the restart, as the greatest depth does not decrease.
    pub fn report_scarce_stack(&self) {
        self.stack_scarce.store(true, Ordering::Relaxed);
    }

    /// State of the actuator tests for a sender of orders.
    pub fn actuator_test_view(&self) -> ActuatorTestView {
        ActuatorTestView {
            newest: self.actuator_test.look(|m| m.value.number).unwrap_or(0),
            renewed: self.actuator_test.fresh().is_some(),
            answer: self.actuator_test_answer.fresh().unwrap_or_default(),
        }
    }

    /// Present state of the servo battery.
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

    /// What the sensors show, as calibrations take it.
    pub fn readings(&self) -> Readings {
        Readings {
            attitude: (self.attitude.latest())
                .filter(|_| self.attitude.fresh().is_some())
                .map(|m| (m.at.as_micros(), m.value)),
            battery: self.battery.fresh().map(|battery| battery.voltage),
            pressures: (self.contact.fresh()).map_or([None; 4], |contact| contact.arms.map(Result::ok)),
            tilts: self.tilts().values(),
            ground: self.ground.fresh().unwrap_or_default(),
        }
    }

    /// Tilt of each arm that was measured within the link's limit, with the time of each.
    pub fn tilts(&self) -> ArmAngles {
        let newest = self.arms.latest().map(|m| m.value).unwrap_or_default();
        newest.within(self.arms.stale_after)
    }
}
