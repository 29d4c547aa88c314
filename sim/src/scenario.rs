//! A mission: vehicle, world, pilot, steps, seed.
//!
//! Scenarios are TOML files with units in the keys; values here are SI. `tests/scenarios/mission.toml` has every key
//! with its default.

mod arm;
mod defaults;
pub mod draw;
mod error;
pub mod faults;
pub mod keys;
mod known;
mod load;
mod nearest;
mod overrides;
mod parts;
mod plant;
mod read;
mod read_steps;
mod rule;
pub mod settings;
mod source;
mod steps;
#[cfg(test)]
mod tests;
pub mod uncertain;

pub use defaults::MISSION;
pub use error::{Place, ScenarioError};
pub use faults::Faults;
pub use known::{Difference, Known};
pub use overrides::Overrides;
pub use parts::{PressureSensors, ROOM, Servos, Tendons};
pub use rule::Rule;
pub use steps::{LAPSE_TIME, STEPS, StepKind, StepNumber};

use glam::DVec3;
use sophie_control::allocation::wrench::{Configuration, PerArm};
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::params::Params;
use sophie_control::pilot::rc::ArmChoice;
use sophie_ports::retained::StartCause;

use crate::plant::GRAVITY as STANDARD_GRAVITY;
use crate::plant::air::wind::WindSpec;
use crate::plant::air::{AirSpec, AirframeSpec};
use crate::plant::beam::in_plane::InPlaneSpec;
use crate::plant::beam::material::MaterialSpec;
use crate::plant::body::BodySpec;
use crate::plant::contact::PipeShape;
use crate::plant::esc::EscSpec;
use crate::plant::flexible::ArmBending;
use crate::plant::rotor::{RotorSpec, THRUST_COEFFICIENT};
use crate::plant::tendon::ServoProfile;
use crate::sensors::arm_imu::TiltErrors;
use crate::sensors::barometer::{Barometer, BarometerFault};
use crate::sensors::flow::{FlowErrors, FlowFault, Optics};
use crate::sensors::imu::VibrationSpec;
use crate::sensors::pose::{PoseFault, TagSpec};
use crate::streams::Streams;

/// A flight to fly.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name for titles.
    pub name: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Simulated time beyond which the flight fails, s.
    pub time_limit: f64,
    /// The vehicle as built.
    pub vehicle: Vehicle,
    /// How far the parameters follow the vehicle.
    pub known: Known,
    /// Flight stack parameters: the builder's model of the vehicle.
    pub params: Params,
    /// What else the builder has measured: his check takes it, no parameter has it.
    pub measured: Measured,
    /// Allocation used by the stack.
    pub mixer: sophie_mixers::Variant,
    /// Arms that close on the pipe.
    pub arms: ArmChoice,
    /// Rule that decides whether the mission is accomplished.
    pub judge: Rule,
    /// Air and pipe.
    pub world: World,
    /// Sensors beside those of every board.
    pub sensors: Sensors,
    /// Parts that fail or are off.
    pub faults: Faults,
    /// The pilot's limits.
    pub pilot: Pilot,
    /// The pilot's steps, in order.
    pub steps: Vec<Step>,
    /// Expected outcome, for tests.
    pub expect: Expect,
}

/// Measured numbers of the vehicle that no law of the flight takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Torsional stiffness of the arms over the derived one.
    pub arm_torsion: f64,
}

impl Default for Measured {
    fn default() -> Self {
        Self { arm_torsion: 1.0 }
    }
}

impl Scenario {
    /// The vehicle's barometer with its fault, on the ground at power-up.
    #[must_use]
    pub fn barometer(&self) -> Barometer {
        let s = &self.sensors;
        let sound = Barometer::new(self.streams(), f64::from(self.vehicle.body.mass as f32 * GRAVITY));
        sound.failing(s.barometer_fault, s.pose_fails_at, s.pose_fails_for)
    }

    /// The random numbers of its flight.
    #[must_use]
    pub const fn streams(&self) -> Streams {
        Streams::new(self.seed)
    }

    /// The air of its flight.
    #[must_use]
    pub fn air(&self) -> AirSpec {
        let wind = WindSpec {
            from: self.wind_from(),
            ..self.world.air.wind
        };
        AirSpec {
            wind,
            ..self.world.air
        }
    }

    /// Direction that the steady wind comes from, clockwise from north, rad.
    #[must_use]
    pub fn wind_from(&self) -> f64 {
        let sampled = || self.streams().within("wind", 0.0, core::f64::consts::TAU);
        self.world.steady_wind_from.unwrap_or_else(sampled)
    }
}

/// The vehicle as built, for the plant.
#[derive(Clone, Debug)]
pub struct Vehicle {
    /// Arm infill, %.
    pub infill: f64,
    /// Gain K on Eq. 1's elastic term.
    pub gain_k: f64,
    /// Configuration of the rotors' senses.
    pub configuration: Configuration,
    /// A1, A2, B1, B2 of Eq. 1, °/N, °/(N %), °/N², °/(N² %): Table I or a fitted arm.
    pub arm_coefficients: [f64; 4],
    /// Model of the arms' bending; not a key of the file.
    pub arm_bending: ArmBending,
    /// Bending stiffness of a beam's tip over its root's.
    pub arm_taper: f64,
    /// Thrust of a level nominal arm over the largest; sets α0.
    pub arm_level_share: f64,
    /// The same thrust, N, however much the rotors give; `None`: by the share.
    pub arm_level: Option<f64>,
    /// Factor on each arm's elastic tilt; nominal 1.
    pub arm_gain: PerArm<f64>,
    /// Offset of each arm's tilt, rad; nominal 0.
    pub arm_offset: PerArm<f64>,
    /// Arms carry tip masses (true) or follow thrust alone, as in the paper's statics (false).
    pub coupled_arms: bool,
    /// Damping ratio of the bending mode in hover.
    pub arm_damping: f64,
    /// Torsional stiffness over the derived one.
    pub arm_torsion: f64,
    /// Softening with the temperature, 1/K.
    pub arm_warming: f64,
    /// What printed TPU has beside springs and damping.
    pub arm_material: MaterialSpec,
    /// Mode of an arm in the plane of its disc, Hz; `None`: rigid.
    pub arm_in_plane: Option<f64>,
    /// Its damping ratio.
    pub arm_in_plane_damping: f64,
    /// Battery charge at power-up, 0..1.
    pub battery_charge: f64,
    /// Resistance of the battery over that of a new one.
    pub battery_age: f64,
    /// Resistance that the battery's current meets slowly, Ω.
    pub battery_sag: f64,
    /// Capacity of the servo battery, A·s.
    pub servo_capacity: f64,
    /// Charge of the servo battery at power-up, 0..1.
    pub servo_charge: f64,
    /// The tendon servo.
    pub servo: ServoProfile,
    /// Pulse of each servo with its reel at the release mark, µs.
    pub servo_release: PerArm<f64>,
    /// Pulse of each servo after its whole travel, µs; below the release mark's for one that is mounted in reverse.
    pub servo_full: PerArm<f64>,
    /// Errors of its servos. The stack knows their label alone.
    pub servos: Servos,
    /// Its tendons with their reels. The stack knows only its parameters, which may differ.
    pub tendons: Tendons,
    /// Mass and inertia.
    pub body: BodySpec,
    /// Motors and propellers, all alike.
    pub rotor: RotorSpec,
    /// Thrust of each rotor over that of its kind.
    pub rotor_thrust: PerArm<f64>,
    /// Vibration at its inertial sensor.
    pub vibration: VibrationSpec,
    /// Its shape in the air.
    pub air: AirframeSpec,
    /// Motor controllers, all alike. The stack knows only its parameters, which may differ.
    pub esc: EscSpec,
    /// Restitution of belly pads and skin, 0..1; 0: strongly damped.
    pub pad_restitution: f64,
}

impl Vehicle {
    /// Bending of the arms in the plane of their discs.
    #[must_use]
    pub fn in_plane(&self) -> Option<InPlaneSpec> {
        self.arm_in_plane.map(|frequency| InPlaneSpec {
            frequency,
            damping: self.arm_in_plane_damping,
        })
    }

    /// Thrust of a level nominal arm, N.
    #[must_use]
    pub fn arm_level_thrust(&self) -> f64 {
        self.arm_level
            .unwrap_or(self.arm_level_share * self.rotor.thrust_max)
    }

    /// Speed of a rotor that carries a quarter of the weight in the standard's air, rad/s.
    #[must_use]
    pub fn hover_speed(&self) -> f64 {
        (0.25 * self.body.mass * STANDARD_GRAVITY / THRUST_COEFFICIENT).sqrt()
    }
}

/// Air and pipe. Origin: the take-off point, on the ground, nose north.
#[derive(Clone, Debug)]
pub struct World {
    /// RMS per axis, N.
    pub gust_force: f64,
    /// RMS per axis, N·m.
    pub gust_moment: f64,
    /// Air: density, wind as a velocity, ground effect. Its wind's direction is [`Scenario::wind_from`].
    pub air: AirSpec,
    /// Force of the steady wind, N.
    pub steady_wind: f64,
    /// Direction that the wind comes from, clockwise from north, rad; `None`: set by the seed.
    pub steady_wind_from: Option<f64>,
    /// Outer diameter of the pipe, m.
    pub pipe_diameter: f64,
    /// North and east of the perch spot, m; the pipe runs north-south.
    pub pipe_position: [f64; 2],
    /// Height, m.
    pub pipe_top: f64,
    /// Pipe length from end to end, m; the perch spot is in its middle.
    pub pipe_length: f64,
    /// Coefficient of sliding, vehicle on pipe.
    pub pipe_friction: f64,
    /// Departures of the pipe from a straight, level, bare and still cylinder.
    pub pipe_shape: PipeShape,
    /// Amplitude of the pipe's vibration, m.
    pub pipe_vibration: f64,
    /// Frequency of the pipe's vibration, Hz.
    pub pipe_vibration_rate: f64,
    /// Looks of pipe and ground, and the light on them.
    pub optics: Optics,
    /// Temperature of air and parts, °C.
    pub temperature: f64,
}

/// The pilot's limits.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// Reaction delay, s.
    pub delay: f64,
    /// Bandwidth of the sticks, Hz.
    pub bandwidth: f64,
    /// RMS error of the seen position, m.
    pub eye_noise: f64,
    /// Steps that the pilot leaves to a mode of the vehicle.
    pub assist: Assist,
    /// Largest distance beside the crown at the touch, m; `None`: the share of the assumed diameter that the capture
    /// map holds.
    pub touch_within: Option<f64>,
    /// Largest drift across the pipe at the touch, m/s.
    pub touch_drift: f64,
    /// Pipe that the pilot assumes.
    pub assumed: Assumed,
}

/// The pilot's assumptions about the pipe; `None` for each value that is the true one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Assumed {
    /// North of the perch spot, m.
    pub north: Option<f64>,
    /// East of it, m.
    pub east: Option<f64>,
    /// Height of the pipe's top, m.
    pub top: Option<f64>,
    /// Outer diameter, m.
    pub diameter: Option<f64>,
}

/// The assumed pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AssumedPipe {
    /// North and east of the perch spot, m.
    pub position: [f64; 2],
    /// Height of its top, m.
    pub top: f64,
    /// Outer diameter, m.
    pub diameter: f64,
}

impl Assumed {
    /// The pipe of `world` with the assumed values in place of the true ones.
    #[must_use]
    pub fn pipe(&self, world: &World) -> AssumedPipe {
        let [north, east] = world.pipe_position;
        AssumedPipe {
            position: [self.north.unwrap_or(north), self.east.unwrap_or(east)],
            top: self.top.unwrap_or(world.pipe_top),
            diameter: self.diameter.unwrap_or(world.pipe_diameter),
        }
    }
}

/// Steps that the pilot leaves to the vehicle's modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Assist {
    /// No assistance: the pilot flies by hand.
    #[default]
    None,
    /// Hovering and flying to a point in the mode HOLD.
    Hold,
    /// Perching and departure: the pilot holds within a metre of the pipe and turns the perch switch.
    Autonomous,
}

/// Sensors beside those of every board.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// Sensor of the position.
    pub position: PositionSensor,
    /// Begin of the sensor's failure, s after power-up, in addition to its usual gaps.
    pub pose_fails_at: f64,
    /// Duration of the failure, s.
    pub pose_fails_for: f64,
    /// Fault of flow and range.
    pub flow_fault: FlowFault,
    /// Lens of flow and range from the centre of mass, m, body; `None`: as in [`Sensors::lens`].
    pub flow_place: [Option<f64>; 3],
    /// Frames of flow and range a second, Hz; `None`: 50.
    pub flow_rate: Option<f64>,
    /// Resolution of the range, m; `None`: a millimetre.
    pub range_step: Option<f64>,
    /// How far the range reaches indoors over a white surface, m; `None`: [`crate::sensors::flow::REACH`].
    pub range_reach: Option<f64>,
    /// White noise of the flow of a frame, rad; `None`: [`crate::sensors::flow::FLOW_NOISE`].
    pub flow_noise: Option<f64>,
    /// The quality of the flow varies whatever the flow is worth.
    pub flow_quality_varies: bool,
    /// The range is a mean of all that its beam meets.
    pub range_mixed_pixels: bool,
    /// Share of the poses that are lost in bursts, 0..1.
    pub pose_dropout_share: f64,
    /// Edge of the tag at the perch spot that the poses come from, m; `None`: the source's noise is the same everywhere.
    pub pose_tag_size: Option<f64>,
    /// Share of the poses that are turned about the tag, 0..1.
    pub pose_outlier_share: f64,
    /// Fault of the poses.
    pub pose_fault: PoseFault,
    /// The board carries a barometer.
    pub barometer: bool,
    /// Fault of the barometer.
    pub barometer_fault: BarometerFault,
    /// Errors of the arms' pressure sensors.
    pub pressure: PressureSensors,
    /// Errors of the arms' tilt sensors.
    pub tilt: TiltErrors,
    /// Sensors that answer in the slots behind each frame of an SBUS receiver, 0 to [`crate::devices::sbus::SLOTS`]; 0: none has slots.
    pub sbus_slots: f64,
}

impl Sensors {
    /// True position of the lens from the centre of mass, m, body: 2 cm below it unless the file sets it.
    #[must_use]
    pub fn lens(&self) -> DVec3 {
        let [x, y, z] = self.flow_place;
        DVec3::new(x.unwrap_or(0.0), y.unwrap_or(0.0), z.unwrap_or(0.02))
    }

    /// Errors of flow and range.
    #[must_use]
    pub const fn flow_errors(&self) -> FlowErrors {
        FlowErrors {
            noise: self.flow_noise,
            quality_varies: self.flow_quality_varies,
            mixed_pixels: self.range_mixed_pixels,
            reach: self.range_reach,
        }
    }

    /// Losses and outliers of the poses.
    #[must_use]
    pub const fn tag(&self) -> TagSpec {
        TagSpec {
            size: self.pose_tag_size,
            outliers: self.pose_outlier_share,
            dropout: self.pose_dropout_share,
        }
    }
}

/// Sensor of the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PositionSensor {
    /// No position sensor.
    #[default]
    None,
    /// A computer that sends poses over MAVLink, late and with gaps.
    Pose,
    /// A module of optical flow and range below the vehicle, over MSP.
    Flow,
}

/// A step of the mission.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Wait for calibration, arm with switch and stick gesture.
    Arm,
    /// Climb to a height.
    TakeOff {
        /// Height, m.
        height: f64,
    },
    /// Hold the spot.
    Hover {
        /// Duration, s.
        seconds: f64,
    },
    /// The paper's roll manoeuvre: +angle, -angle, level; a side ends once reached.
    Roll {
        /// Angle, rad.
        angle: f64,
        /// Longest time per side, s.
        seconds: f64,
    },
    /// Fly to 1 m over the pipe's top.
    FlyToPipe,
    /// Descend onto the pipe until contact.
    Touch,
    /// Set the throttle and start closing, until the arms close.
    Clamp {
        /// 0..1; about 0.3 in the paper.
        throttle: f64,
    },
    /// Set the throttle, close, wait for the proven grip and stopped motors.
    Perch {
        /// 0..1.
        throttle: f64,
    },
    /// Stay clamped under a push.
    Hold {
        /// Duration, s.
        seconds: f64,
        /// Sideways at the centre of mass in the middle third, N.
        push: f64,
        /// Time on the pipe after it, s: within [`LAPSE_TIME`] creep, heat and drift run as if it passed.
        lapse: f64,
    },
    /// Spool up and turn the perch switch off, until displayed.
    Open,
    /// Spool up, release the tendons, wait for free arms, climb 1 m.
    Release,
    /// Turn the nose and keep it there; later steps keep it too, until the pipe.
    Yaw {
        /// Clockwise from north, rad.
        heading: f64,
        /// Duration after the turn, s.
        seconds: f64,
    },
    /// Fly to a point.
    FlyTo {
        /// North from take-off, m.
        north: f64,
        /// East from take-off, m.
        east: f64,
        /// Height over the ground, m.
        height: f64,
    },
    /// Descend to the ground below.
    Land,
    /// Disarm and wait for stopped motors.
    Disarm,
    /// Transmitter off (no frames, display dark), until the display shows the mode again.
    RadioOff {
        /// Duration, s.
        seconds: f64,
    },
    /// Reset of the board, until displayed as disarmed.
    Reset {
        /// Decides whether retained memory is lost.
        cause: StartCause,
        /// Delay, s.
        after: f64,
        /// Time without power, s.
        off: f64,
        /// Sideways at the centre of mass during the step, N.
        push: f64,
    },
}

/// Expected outcome, for tests.
#[derive(Clone, Debug)]
pub struct Expect {
    /// The mission is accomplished.
    pub accomplished: bool,
    /// Words of the reason if not.
    pub reason: Option<String>,
    /// Words that the pilot reads in flight.
    pub says: Option<String>,
}
