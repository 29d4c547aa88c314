//! Defaults of a scenario file: the paper's vehicle in light air before its pipe.

use sophie_control::allocation::wrench::Configuration;
use sophie_control::params::Params;
use sophie_control::pilot::rc::ArmChoice;
use sophie_mixers::Variant;

use super::{
    Assist, Assumed, Expect, Faults, Known, Measured, Overrides, Pilot, ROOM, Rule, Scenario, Sensors,
    Servos, Tendons, Vehicle, World,
};
use crate::plant::air::wind::WindSpec;
use crate::plant::air::{AirSpec, AirframeSpec};
use crate::plant::beam::material::MaterialSpec;
use crate::plant::body::BodySpec;
use crate::plant::contact::PipeShape;
use crate::plant::contact::pipe::Flange;
use crate::plant::esc::EscSpec;
use crate::plant::flexible::ArmBending;
use crate::plant::hinged::link::TABLE_1;
use crate::plant::rotor::{RotorSpec, STANDARD_DENSITY};
use crate::plant::servo_power::CAPACITY;
use crate::plant::tendon::ServoProfile;
use crate::sensors::flow::Optics;
use crate::sensors::imu::VibrationSpec;

/// The default mission, every key at its default.
pub const MISSION: &str = include_str!("../../../tests/scenarios/mission.toml");

impl Default for Vehicle {
    fn default() -> Self {
        Self {
            infill: 6.9,
            gain_k: 7.75,
            configuration: Configuration::B,
            arm_coefficients: TABLE_1,
            arm_bending: ArmBending::Beam,
            arm_taper: 1.0,
            arm_level_share: 0.5,
            arm_level: None,
            arm_gain: [1.0; 4],
            arm_offset: [0.0; 4],
            coupled_arms: true,
            arm_damping: 0.15,
            arm_torsion: 1.0,
            arm_warming: 0.0,
            arm_material: MaterialSpec::default(),
            arm_in_plane: None,
            arm_in_plane_damping: 0.1,
            battery_charge: 1.0,
            battery_age: 1.0,
            battery_sag: 0.0,
            servo_capacity: CAPACITY,
            servo_charge: 1.0,
            servo: ServoProfile::Paper,
            servo_release: [550.0; 4],
            servo_full: [2450.0; 4],
            servos: Servos::default(),
            tendons: Tendons::default(),
            body: BodySpec::default(),
            rotor: RotorSpec::default(),
            rotor_thrust: [1.0; 4],
            vibration: VibrationSpec::default(),
            air: AirframeSpec::default(),
            esc: EscSpec::default(),
            pad_restitution: 0.0,
        }
    }
}

impl Default for World {
    fn default() -> Self {
        Self {
            gust_force: 0.10,
            gust_moment: 0.004,
            air: AirSpec {
                density: STANDARD_DENSITY,
                wind: WindSpec::default(),
                ground_effect: 0.0,
                pipe_ground_effect: 0.0,
            },
            steady_wind: 0.0,
            steady_wind_from: None,
            pipe_diameter: 0.30,
            pipe_position: [3.0, 0.0],
            pipe_top: 1.5,
            pipe_length: 2.0,
            pipe_friction: 0.6,
            pipe_shape: PipeShape {
                flange: Flange {
                    height: 0.068,
                    ..Flange::NONE
                },
                ..PipeShape::STRAIGHT
            },
            pipe_vibration: 0.0,
            pipe_vibration_rate: 10.0,
            optics: Optics::default(),
            temperature: ROOM,
        }
    }
}

impl Default for Pilot {
    fn default() -> Self {
        Self {
            delay: 0.25,
            bandwidth: 2.0,
            eye_noise: 0.01,
            assist: Assist::None,
            touch_within: None,
            touch_drift: 0.08,
            assumed: Assumed::default(),
        }
    }
}

impl Default for Expect {
    fn default() -> Self {
        Self {
            accomplished: true,
            reason: None,
            says: None,
        }
    }
}

impl Scenario {
    /// Arm, take off, roll, perch, hold, release, land, disarm.
    pub fn default_mission() -> Self {
        Self::default_mission_with(&Overrides::default())
    }

    /// The default mission with some settings changed.
    pub fn default_mission_with(overrides: &Overrides) -> Self {
        match Self::parse(MISSION, "mission.toml", overrides) {
            Ok(scenario) => scenario,
            // A test parses the embedded text, and overrides cannot fail.
            Err(error) => unreachable!("{error}"),
        }
    }

    pub(super) fn empty() -> Self {
        Self {
            name: String::new(),
            seed: 1,
            time_limit: 480.0,
            vehicle: Vehicle::default(),
            known: Known::default(),
            params: Params::default(),
            measured: Measured::default(),
            mixer: Variant::Flexible,
            arms: ArmChoice::All,
            judge: Rule::default(),
            world: World::default(),
            sensors: Sensors::default(),
            faults: Faults::default(),
            pilot: Pilot::default(),
            steps: Vec::new(),
            expect: Expect::default(),
        }
    }
}
