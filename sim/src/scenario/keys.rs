//! Every key of a scenario file: name with unit, kind, range. Only here are units converted to SI.

use core::f64::consts::PI;

use sophie_control::allocation::wrench::{Configuration, PerArm};
use sophie_control::pilot::rc::ArmChoice;
use sophie_mixers::Variant;

use super::faults;
use super::{Assist, Known, PositionSensor, Rule, Scenario};
use crate::devices::sbus;
use crate::plant::rotor::delay;
use crate::plant::tendon::ServoProfile;
use crate::sensors::barometer::BarometerFault;
use crate::sensors::flow::FlowFault;
use crate::sensors::pose::PoseFault;

/// One key.
pub struct Key {
    /// With its table, such as `vehicle.infill`.
    pub name: &'static str,
    /// Type of its value, and the field that it sets.
    pub kind: Kind,
}

/// Type of a key's value, and its place.
pub enum Kind {
    /// A number.
    Number(Range, fn(&mut Scenario) -> &mut f64),
    /// A number; without it another value applies.
    Optional(Range, fn(&mut Scenario) -> &mut Option<f64>),
    /// One number per arm.
    PerArm(Range, fn(&mut Scenario) -> &mut PerArm<f64>),
    /// Roll, pitch and yaw, each with its range.
    PerAxis([Range; 3], fn(&mut Scenario) -> &mut [f64; 3]),
    /// `true` or `false`.
    Flag(fn(&mut Scenario) -> &mut bool),
    /// One of a few words.
    Choice(&'static [&'static str], fn(&mut Scenario, &str)),
    /// One of a few words per arm, set by the arm's index.
    PerArmChoice(&'static [&'static str], fn(&mut Scenario, usize, &str)),
    /// A whole number from 0.
    Seed(fn(&mut Scenario) -> &mut u64),
    /// A line of text.
    Text(fn(&mut Scenario, &str)),
}

/// Sets the numbers of the key `name`, given in its unit, whatever its range. False if no key has numbers under it.
pub fn set(scenario: &mut Scenario, name: &str, numbers: &[f64]) -> bool {
    let Some(Key { kind, .. }) = KEYS.iter().find(|key| key.name == name) else {
        return false;
    };
    let mut si = numbers.iter().copied();
    match kind {
        Kind::Number(range, field) => {
            if let Some(number) = si.next() {
                *field(scenario) = number * range.si;
            }
        }
        Kind::Optional(range, field) => *field(scenario) = si.next().map(|number| number * range.si),
        Kind::PerArm(range, field) => {
            for (slot, number) in field(scenario).iter_mut().zip(si) {
                *slot = number * range.si;
            }
        }
        Kind::PerAxis(ranges, field) => {
            for ((slot, range), number) in field(scenario).iter_mut().zip(ranges).zip(si) {
                *slot = number * range.si;
            }
        }
        _ => return false,
    }
    true
}

/// Allowed range of a number, in the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// For messages; may be empty.
    pub unit: &'static str,
    /// SI value of one unit.
    pub si: f64,
}

impl Range {
    /// A range in an SI unit.
    pub const fn new(min: f64, max: f64, unit: &'static str) -> Self {
        Self {
            min,
            max,
            unit,
            si: 1.0,
        }
    }

    /// The range with its unit in SI.
    pub const fn times(self, si: f64) -> Self {
        Self { si, ..self }
    }

    /// The value in SI, if within the range.
    pub fn to_si(&self, value: f64) -> Option<f64> {
        (value >= self.min && value <= self.max).then_some(value * self.si)
    }

    /// For messages: `4 to 10 %`.
    pub fn allowed(&self) -> String {
        format!("{} to {} {}", self.min, self.max, self.unit)
            .trim_end()
            .to_owned()
    }
}

/// Words for the sense of rotation.
pub const CONFIGURATIONS: &[&str] = &["A", "B"];
/// Words for the allocation.
pub const MIXERS: &[&str] = &["flexible", "rigid", "paper", "frozen"];
/// Words for the arms that close.
pub const ARMS: &[&str] = &["all", "front", "rear"];
/// Words for the servo.
pub const SERVOS: &[&str] = &["paper", "mg996r"];

/// Words for the sensor of the position.
pub const POSITION_SENSORS: &[&str] = &["none", "pose", "flow"];
/// Words for the fault of the flow module.
pub const FLOW_FAULTS: &[&str] = &[
    "silent",
    "dark",
    "mirrored",
    "scaled",
    "frozen",
    "jumps",
    "range-silent",
    "range-frozen",
    "range-jumps",
    "range-long",
    "range-short",
];
/// Words for the fault of the poses.
pub const POSE_FAULTS: &[&str] = &[
    "silent",
    "frozen",
    "jumps",
    "mirrored",
    "scaled",
    "turned",
    "target-silent",
    "target-jumps",
    "target-far",
];
/// Words for the fault of the barometer.
pub const BAROMETER_FAULTS: &[&str] = &["none", "silent", "frozen", "jumps", "drifts"];
/// Words for the assistance.
pub const ASSISTS: &[&str] = &["none", "hold", "self"];

/// Infill that Eq. 1 of the paper covers.
pub const INFILL: Range = Range::new(4.0, 10.0, "%");
/// Gain on Eq. 1's elastic term: 1 is the literal equation, Table III needs 5.0 to 8.4.
pub const GAIN_K: Range = Range::new(1.0, 10.0, "");

/// Mean wind.
pub const WIND: Range = Range::new(0.0, 15.0, "m/s");

/// Whole numbers up to it are exact as TOML floats.
const SEED_MAX: f64 = 9e15;
/// Allowed seeds, for messages.
pub const SEED_ALLOWED: &str = "a whole number from 0 to 9e15";

/// The seed of a number from a file or command line.
pub fn seed(number: f64) -> Option<u64> {
    let whole = number.fract() == 0.0 && (0.0..=SEED_MAX).contains(&number);
    whole.then_some(number as u64)
}

/// Ranges of the pipe: north or east, height of its top, diameter.
const PIPE_PLACE: Range = Range::new(-20.0, 20.0, "m");
const PIPE_TOP: Range = Range::new(0.5, 10.0, "m");
const PIPE_DIAMETER: Range = Range::new(0.15, 0.6, "m");

/// Range of a servo's marks: what servos accept.
const SERVO_PULSE: Range = Range::new(500.0, 2500.0, "us");

/// Range of a share, and of a diffuse reflectivity.
const SHARE: Range = Range::new(0.0, 1.0, "");
const REFLECTIVITY: Range = Range::new(0.02, 1.0, "");

/// Range of the lens position, as that of the parameters.
const LENS: Range = Range::new(-0.3, 0.3, "m");

/// Range of a part's size or strength over the nominal one.
const PART: Range = Range::new(0.8, 1.2, "");

const DEGREE: f64 = PI / 180.0;
const PERCENT: f64 = 0.01;
/// Share of an effect of the literature's size; 0 turns it off.
const EFFECT: Range = Range::new(0.0, 2.0, "");

/// A word from [`CONFIGURATIONS`].
pub fn configuration(word: &str) -> Configuration {
    if word == "A" {
        Configuration::A
    } else {
        Configuration::B
    }
}

/// A word from [`MIXERS`].
pub fn mixer(word: &str) -> Variant {
    match word {
        "rigid" => Variant::Rigid,
        "paper" => Variant::Paper,
        "frozen" => Variant::Frozen,
        _ => Variant::Flexible,
    }
}

/// A word from [`ARMS`].
pub fn arms(word: &str) -> ArmChoice {
    match word {
        "front" => ArmChoice::Front,
        "rear" => ArmChoice::Rear,
        _ => ArmChoice::All,
    }
}

/// A word from [`SERVOS`].
pub fn servo(word: &str) -> ServoProfile {
    if word == "mg996r" {
        ServoProfile::Mg996r
    } else {
        ServoProfile::Paper
    }
}

/// A word from [`POSITION_SENSORS`].
pub fn position_sensor(word: &str) -> PositionSensor {
    match word {
        "pose" => PositionSensor::Pose,
        "flow" => PositionSensor::Flow,
        _ => PositionSensor::None,
    }
}

/// A word from [`FLOW_FAULTS`].
pub fn flow_fault(word: &str) -> FlowFault {
    match word {
        "dark" => FlowFault::Dark,
        "mirrored" => FlowFault::Mirrored,
        "scaled" => FlowFault::Scaled,
        "frozen" => FlowFault::Frozen,
        "jumps" => FlowFault::Jumps,
        "range-silent" => FlowFault::RangeSilent,
        "range-frozen" => FlowFault::RangeFrozen,
        "range-jumps" => FlowFault::RangeJumps,
        "range-long" => FlowFault::RangeLong,
        "range-short" => FlowFault::RangeShort,
        _ => FlowFault::Silent,
    }
}

/// A word from [`POSE_FAULTS`].
pub fn pose_fault(word: &str) -> PoseFault {
    match word {
        "frozen" => PoseFault::Frozen,
        "jumps" => PoseFault::Jumps,
        "mirrored" => PoseFault::Mirrored,
        "scaled" => PoseFault::Scaled,
        "turned" => PoseFault::Turned,
        "target-silent" => PoseFault::TargetSilent,
        "target-jumps" => PoseFault::TargetJumps,
        "target-far" => PoseFault::TargetFar,
        _ => PoseFault::Silent,
    }
}

/// A word from [`BAROMETER_FAULTS`].
pub fn barometer_fault(word: &str) -> BarometerFault {
    match word {
        "silent" => BarometerFault::Silent,
        "frozen" => BarometerFault::Frozen,
        "jumps" => BarometerFault::Jumps,
        "drifts" => BarometerFault::Drifts,
        _ => BarometerFault::None,
    }
}

/// A word from [`ASSISTS`].
pub fn assist(word: &str) -> Assist {
    match word {
        "hold" => Assist::Hold,
        "self" => Assist::Autonomous,
        _ => Assist::None,
    }
}

/// The word of a sense of rotation.
pub const fn configuration_word(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::A => "A",
        Configuration::B => "B",
    }
}

/// The word of an allocation.
pub const fn mixer_word(mixer: Variant) -> &'static str {
    match mixer {
        Variant::Flexible => "flexible",
        Variant::Rigid => "rigid",
        Variant::Paper => "paper",
        Variant::Frozen => "frozen",
    }
}

/// The word of a choice of arms.
pub const fn arms_word(arms: ArmChoice) -> &'static str {
    match arms {
        ArmChoice::All => "all",
        ArmChoice::Front => "front",
        ArmChoice::Rear => "rear",
    }
}

/// The word of a position sensor.
pub const fn position_sensor_word(sensor: PositionSensor) -> &'static str {
    match sensor {
        PositionSensor::None => "none",
        PositionSensor::Pose => "pose",
        PositionSensor::Flow => "flow",
    }
}

/// The word of an assistance.
pub const fn assist_word(assist: Assist) -> &'static str {
    match assist {
        Assist::None => "none",
        Assist::Hold => "hold",
        Assist::Autonomous => "self",
    }
}

/// The word of a servo.
pub const fn servo_word(servo: ServoProfile) -> &'static str {
    match servo {
        ServoProfile::Paper => "paper",
        ServoProfile::Mg996r => "mg996r",
    }
}

macro_rules! number {
    ($name:literal, $range:expr, $($field:tt)+) => {
        Key { name: $name, kind: Kind::Number($range, |s| &mut s.$($field)+) }
    };
}

macro_rules! optional {
    ($name:literal, $range:expr, $($field:tt)+) => {
        Key { name: $name, kind: Kind::Optional($range, |s| &mut s.$($field)+) }
    };
}

macro_rules! per_arm {
    ($name:literal, $range:expr, $($field:tt)+) => {
        Key { name: $name, kind: Kind::PerArm($range, |s| &mut s.$($field)+) }
    };
}

macro_rules! fault {
    ($name:literal, $words:expr, $field:ident, $read:expr) => {
        Key {
            name: $name,
            kind: Kind::PerArmChoice($words, |s, arm, word| {
                if let Some(slot) = s.faults.$field.get_mut(arm) {
                    *slot = $read(word);
                }
            }),
        }
    };
}

/// All keys but those of `steps` and `params`.
pub const KEYS: &[Key] = &[
    Key {
        name: "name",
        kind: Kind::Text(|s, v| s.name = v.to_owned()),
    },
    Key {
        name: "seed",
        kind: Kind::Seed(|s| &mut s.seed),
    },
    number!("time_limit_s", Range::new(1.0, 3600.0, "s"), time_limit),
    Key {
        name: "mixer",
        kind: Kind::Choice(MIXERS, |s, v| s.mixer = mixer(v)),
    },
    Key {
        name: "judge",
        kind: Kind::Choice(Rule::WORDS, |s, v| s.judge = Rule::from_word(v)),
    },
    Key {
        name: "arms",
        kind: Kind::Choice(ARMS, |s, v| s.arms = arms(v)),
    },
    Key {
        name: "vehicle.known",
        kind: Kind::Choice(Known::WORDS, |s, v| s.known = Known::from_word(v)),
    },
    number!("vehicle.infill", INFILL, vehicle.infill),
    number!("vehicle.gain_k", GAIN_K, vehicle.gain_k),
    Key {
        name: "vehicle.configuration",
        kind: Kind::Choice(CONFIGURATIONS, |s, v| s.vehicle.configuration = configuration(v)),
    },
    Key {
        name: "vehicle.arm_coefficients",
        kind: Kind::PerArm(Range::new(-10.0, 30.0, ""), |s| &mut s.vehicle.arm_coefficients),
    },
    // Where two terms hold the ratio of tendon to thrust within 3 %.
    number!("vehicle.arm_taper", Range::new(0.25, 2.0, ""), vehicle.arm_taper),
    number!(
        "vehicle.arm_level_share",
        Range::new(-0.5, 1.0, ""),
        vehicle.arm_level_share
    ),
    optional!(
        "vehicle.arm_level_n",
        Range::new(1.0, 12.0, "N"),
        vehicle.arm_level
    ),
    Key {
        name: "vehicle.arm_gain",
        kind: Kind::PerArm(Range::new(0.5, 1.5, ""), |s| &mut s.vehicle.arm_gain),
    },
    Key {
        name: "vehicle.arm_offset_deg",
        kind: Kind::PerArm(Range::new(-10.0, 10.0, "deg").times(DEGREE), |s| {
            &mut s.vehicle.arm_offset
        }),
    },
    Key {
        name: "vehicle.coupled_arms",
        kind: Kind::Flag(|s| &mut s.vehicle.coupled_arms),
    },
    number!(
        "vehicle.arm_damping",
        Range::new(0.02, 1.0, ""),
        vehicle.arm_damping
    ),
    number!(
        "vehicle.arm_torsion",
        Range::new(0.3, 3.0, ""),
        vehicle.arm_torsion
    ),
    number!(
        "vehicle.arm_temperature_percent_k",
        Range::new(0.0, 3.0, "%/K").times(PERCENT),
        vehicle.arm_warming
    ),
    number!(
        "vehicle.arm_stiffening",
        Range::new(0.0, 2.0, ""),
        vehicle.arm_material.stiffening
    ),
    number!(
        "vehicle.arm_relaxation_percent",
        Range::new(0.0, 15.0, "%").times(PERCENT),
        vehicle.arm_material.relaxation
    ),
    number!(
        "vehicle.arm_first_cycles_percent",
        Range::new(0.0, 50.0, "%").times(PERCENT),
        vehicle.arm_material.first_cycles
    ),
    optional!(
        "vehicle.arm_in_plane_hz",
        Range::new(2.0, 30.0, "Hz"),
        vehicle.arm_in_plane
    ),
    number!(
        "vehicle.arm_in_plane_damping",
        Range::new(0.02, 1.0, ""),
        vehicle.arm_in_plane_damping
    ),
    number!(
        "vehicle.battery_charge_percent",
        Range::new(5.0, 100.0, "%").times(PERCENT),
        vehicle.battery_charge
    ),
    number!(
        "vehicle.vibration_m_s2",
        Range::new(0.0, 60.0, "m/s2"),
        vehicle.vibration.once
    ),
    number!(
        "vehicle.vibration_twice",
        Range::new(0.0, 2.0, ""),
        vehicle.vibration.twice
    ),
    optional!(
        "vehicle.platform_hz",
        Range::new(15.0, 200.0, "Hz"),
        vehicle.vibration.platform
    ),
    number!(
        "vehicle.platform_damping",
        Range::new(0.02, 1.0, ""),
        vehicle.vibration.damping
    ),
    number!(
        "vehicle.battery_age",
        Range::new(0.5, 4.0, ""),
        vehicle.battery_age
    ),
    number!(
        "vehicle.battery_sag_ohm",
        Range::new(0.0, 0.1, "ohm"),
        vehicle.battery_sag
    ),
    number!(
        "vehicle.servo_battery_mah",
        Range::new(200.0, 20_000.0, "mAh").times(3.6),
        vehicle.servo_capacity
    ),
    number!(
        "vehicle.servo_charge_percent",
        Range::new(0.0, 100.0, "%").times(PERCENT),
        vehicle.servo_charge
    ),
    Key {
        name: "vehicle.servo",
        kind: Kind::Choice(SERVOS, |s, v| s.vehicle.servo = servo(v)),
    },
    Key {
        name: "vehicle.servo_release_us",
        kind: Kind::PerArm(SERVO_PULSE, |s| &mut s.vehicle.servo_release),
    },
    Key {
        name: "vehicle.servo_full_us",
        kind: Kind::PerArm(SERVO_PULSE, |s| &mut s.vehicle.servo_full),
    },
    number!(
        "vehicle.servo_stop_deg",
        Range::new(0.0, 3.0, "deg").times(DEGREE),
        vehicle.servos.stop
    ),
    number!(
        "vehicle.servo_backlash_deg",
        Range::new(0.0, 3.0, "deg").times(DEGREE),
        vehicle.servos.backlash
    ),
    number!(
        "vehicle.servo_sag_deg_n_m",
        Range::new(0.0, 5.0, "deg/(N m)").times(DEGREE),
        vehicle.servos.sag
    ),
    per_arm!(
        "vehicle.servo_drift_deg_10k",
        Range::new(-5.0, 5.0, "deg/10 K").times(0.1 * DEGREE),
        vehicle.servos.drift
    ),
    per_arm!(
        "vehicle.servo_stall_share",
        Range::new(0.5, 1.2, ""),
        vehicle.servos.stall
    ),
    number!(
        "vehicle.servo_heat_k",
        Range::new(0.0, 500.0, "K"),
        vehicle.servos.heat
    ),
    per_arm!(
        "vehicle.tendon_stiffness_n_m",
        Range::new(1000.0, 20_000.0, "N/m"),
        vehicle.tendons.stiffness
    ),
    per_arm!(
        "vehicle.tendon_friction",
        Range::new(0.0, 1.0, ""),
        vehicle.tendons.friction
    ),
    number!(
        "vehicle.tendon_creep_percent",
        Range::new(0.0, 10.0, "%").times(PERCENT),
        vehicle.tendons.creep
    ),
    per_arm!("vehicle.tendon_lever_share", PART, vehicle.tendons.lever),
    per_arm!("vehicle.reel_radius_share", PART, vehicle.tendons.reel_radius),
    number!("vehicle.mass_kg", Range::new(1.0, 3.0, "kg"), vehicle.body.mass),
    Key {
        name: "vehicle.inertia_kgm2",
        // Tip masses alone give 0.010, 0.010 and 0.020.
        kind: Kind::PerAxis(
            [
                Range::new(0.012, 0.1, "kg m2"),
                Range::new(0.012, 0.1, "kg m2"),
                Range::new(0.024, 0.2, "kg m2"),
            ],
            |s| &mut s.vehicle.body.inertia,
        ),
    },
    number!(
        "vehicle.torque_ratio_m",
        Range::new(0.005, 0.05, "m"),
        vehicle.rotor.torque_ratio
    ),
    number!(
        "vehicle.motor_tau_s",
        Range::new(0.01, 0.2, "s"),
        vehicle.rotor.spin.up
    ),
    optional!(
        "vehicle.motor_tau_down_s",
        Range::new(0.01, 0.5, "s"),
        vehicle.rotor.spin.down
    ),
    number!(
        "vehicle.motor_delay_s",
        Range::new(0.0, delay::LONGEST, "s"),
        vehicle.rotor.delay
    ),
    Key {
        name: "vehicle.esc_brakes",
        kind: Kind::Flag(|s| &mut s.vehicle.rotor.spin.brakes),
    },
    Key {
        name: "vehicle.rotor_reaction",
        kind: Kind::Flag(|s| &mut s.vehicle.rotor.reaction),
    },
    number!(
        "vehicle.thrust_max_n",
        Range::new(5.0, 20.0, "N"),
        vehicle.rotor.thrust_max
    ),
    Key {
        name: "vehicle.rotor_thrust",
        kind: Kind::PerArm(Range::new(0.5, 1.5, ""), |s| &mut s.vehicle.rotor_thrust),
    },
    optional!(
        "vehicle.thrust_voltage_power",
        Range::new(1.0, 2.5, ""),
        vehicle.rotor.voltage_power
    ),
    number!(
        "vehicle.heat_fade_percent",
        Range::new(0.0, 20.0, "%").times(PERCENT),
        vehicle.rotor.heat_fade
    ),
    number!("vehicle.inflow_share", EFFECT, vehicle.air.inflow),
    number!(
        "vehicle.drag_n_s_m",
        Range::new(0.0, 2.0, "N s/m"),
        vehicle.air.drag.linear
    ),
    Key {
        name: "vehicle.drag_on_rotors",
        kind: Kind::Flag(|s| &mut s.vehicle.air.drag.on_rotors),
    },
    number!(
        "vehicle.drag_area_m2",
        Range::new(0.0, 0.2, "m2"),
        vehicle.air.drag.area
    ),
    number!(
        "vehicle.flapping_deg_s_m",
        Range::new(0.0, 2.0, "deg s/m").times(DEGREE),
        vehicle.air.drag.flapping
    ),
    number!(
        "vehicle.arm_wash_percent",
        Range::new(0.0, 20.0, "%").times(PERCENT),
        vehicle.air.wash.loss
    ),
    number!(
        "vehicle.arm_buffet_percent",
        Range::new(0.0, 10.0, "%").times(PERCENT),
        vehicle.air.wash.buffet
    ),
    number!(
        "vehicle.esc_pulse_min_us",
        Range::new(800.0, 1400.0, "us"),
        vehicle.esc.pulse_min
    ),
    number!(
        "vehicle.esc_pulse_idle_us",
        Range::new(800.0, 1800.0, "us"),
        vehicle.esc.pulse_idle
    ),
    number!(
        "vehicle.esc_pulse_max_us",
        Range::new(1500.0, 2300.0, "us"),
        vehicle.esc.pulse_max
    ),
    number!(
        "vehicle.pad_restitution",
        Range::new(0.0, 0.9, ""),
        vehicle.pad_restitution
    ),
    number!("world.gust_force_n", Range::new(0.0, 3.0, "N"), world.gust_force),
    number!(
        "world.gust_moment_nm",
        Range::new(0.0, 0.1, "N m"),
        world.gust_moment
    ),
    number!(
        "world.steady_wind_n",
        Range::new(0.0, 5.0, "N"),
        world.steady_wind
    ),
    optional!(
        "world.steady_wind_from_deg",
        Range::new(-360.0, 360.0, "deg").times(DEGREE),
        world.steady_wind_from
    ),
    number!("world.wind_m_s", WIND, world.air.wind.speed),
    number!(
        "world.wind_gust_m_s",
        Range::new(0.0, 5.0, "m/s"),
        world.air.wind.gust
    ),
    number!(
        "world.air_density_kg_m3",
        Range::new(0.8, 1.4, "kg/m3"),
        world.air.density
    ),
    number!("world.ground_effect", EFFECT, world.air.ground_effect),
    number!("world.pipe_ground_effect", EFFECT, world.air.pipe_ground_effect),
    number!(
        "world.pipe_shedding",
        Range::new(0.0, 1.0, ""),
        world.air.wind.shedding
    ),
    number!("world.pipe_diameter_m", PIPE_DIAMETER, world.pipe_diameter),
    number!("world.pipe_north_m", PIPE_PLACE, world.pipe_position[0]),
    number!("world.pipe_east_m", PIPE_PLACE, world.pipe_position[1]),
    number!("world.pipe_top_m", PIPE_TOP, world.pipe_top),
    number!(
        "world.pipe_length_m",
        Range::new(0.3, 100.0, "m"),
        world.pipe_length
    ),
    number!(
        "world.pipe_friction",
        Range::new(0.05, 1.5, ""),
        world.pipe_friction
    ),
    number!(
        "world.pipe_friction_static_share",
        Range::new(1.0, 3.0, ""),
        world.pipe_shape.static_share
    ),
    number!(
        "world.pipe_slope_deg",
        Range::new(-10.0, 10.0, "deg").times(DEGREE),
        world.pipe_shape.slope
    ),
    number!(
        "world.pipe_sag_m",
        Range::new(0.0, 0.2, "m"),
        world.pipe_shape.sag
    ),
    number!(
        "world.pipe_vibration_mm",
        Range::new(0.0, 5.0, "mm").times(1e-3),
        world.pipe_vibration
    ),
    number!(
        "world.pipe_vibration_hz",
        Range::new(1.0, 50.0, "Hz"),
        world.pipe_vibration_rate
    ),
    // 0: no flanges.
    number!(
        "world.pipe_flange_spacing_m",
        Range::new(0.0, 20.0, "m"),
        world.pipe_shape.flange.spacing
    ),
    number!("world.pipe_flange_at_m", PIPE_PLACE, world.pipe_shape.flange.at),
    number!(
        "world.pipe_flange_height_m",
        Range::new(0.001, 0.1, "m"),
        world.pipe_shape.flange.height
    ),
    number!(
        "world.pipe_softness_mm_n",
        Range::new(0.0, 0.5, "mm/N").times(1e-3),
        world.pipe_shape.softness
    ),
    number!("world.pipe_contrast", SHARE, world.optics.pipe.contrast),
    number!("world.ground_contrast", SHARE, world.optics.ground.contrast),
    number!(
        "world.pipe_reflectivity",
        REFLECTIVITY,
        world.optics.pipe.reflectivity
    ),
    number!(
        "world.ground_reflectivity",
        REFLECTIVITY,
        world.optics.ground.reflectivity
    ),
    number!("world.pipe_gloss", SHARE, world.optics.pipe.gloss),
    optional!(
        "world.light_klux",
        Range::new(0.0, 130.0, "klux").times(1e3),
        world.optics.light
    ),
    number!(
        "world.temperature_c",
        Range::new(-20.0, 60.0, "deg C"),
        world.temperature
    ),
    Key {
        name: "sensors.position",
        kind: Kind::Choice(POSITION_SENSORS, |s, v| s.sensors.position = position_sensor(v)),
    },
    number!(
        "sensors.pose_fails_at_s",
        Range::new(0.0, 3600.0, "s"),
        sensors.pose_fails_at
    ),
    number!(
        "sensors.pose_fails_for_s",
        Range::new(0.0, 3600.0, "s"),
        sensors.pose_fails_for
    ),
    Key {
        name: "sensors.flow_fault",
        kind: Kind::Choice(FLOW_FAULTS, |s, v| s.sensors.flow_fault = flow_fault(v)),
    },
    optional!("sensors.flow_x_m", LENS, sensors.flow_place[0]),
    optional!("sensors.flow_y_m", LENS, sensors.flow_place[1]),
    optional!("sensors.flow_z_m", LENS, sensors.flow_place[2]),
    optional!(
        "sensors.flow_rate_hz",
        Range::new(10.0, 100.0, "Hz"),
        sensors.flow_rate
    ),
    optional!(
        "sensors.range_step_m",
        Range::new(0.001, 0.05, "m"),
        sensors.range_step
    ),
    optional!(
        "sensors.range_reach_m",
        Range::new(1.0, 8.0, "m"),
        sensors.range_reach
    ),
    optional!(
        "sensors.flow_noise_mrad",
        Range::new(0.0, 20.0, "mrad").times(1e-3),
        sensors.flow_noise
    ),
    Key {
        name: "sensors.flow_quality_varies",
        kind: Kind::Flag(|s| &mut s.sensors.flow_quality_varies),
    },
    Key {
        name: "sensors.range_mixed_pixels",
        kind: Kind::Flag(|s| &mut s.sensors.range_mixed_pixels),
    },
    number!(
        "sensors.pose_dropout_share",
        Range::new(0.0, 0.9, ""),
        sensors.pose_dropout_share
    ),
    optional!(
        "sensors.pose_tag_size_m",
        Range::new(0.02, 1.0, "m"),
        sensors.pose_tag_size
    ),
    number!(
        "sensors.pose_outlier_share",
        Range::new(0.0, 0.3, ""),
        sensors.pose_outlier_share
    ),
    Key {
        name: "sensors.pose_fault",
        kind: Kind::Choice(POSE_FAULTS, |s, v| s.sensors.pose_fault = pose_fault(v)),
    },
    Key {
        name: "sensors.barometer",
        kind: Kind::Flag(|s| &mut s.sensors.barometer),
    },
    Key {
        name: "sensors.barometer_fault",
        kind: Kind::Choice(BAROMETER_FAULTS, |s, v| {
            s.sensors.barometer_fault = barometer_fault(v);
        }),
    },
    per_arm!(
        "sensors.fsr_turn_on_n",
        Range::new(0.0, 2.0, "N"),
        sensors.pressure.turn_on
    ),
    per_arm!(
        "sensors.fsr_preload_n",
        Range::new(0.0, 2.0, "N"),
        sensors.pressure.preload
    ),
    number!(
        "sensors.fsr_hysteresis_percent",
        Range::new(0.0, 20.0, "%").times(PERCENT),
        sensors.pressure.hysteresis
    ),
    number!(
        "sensors.fsr_drift_percent",
        Range::new(0.0, 10.0, "%").times(PERCENT),
        sensors.pressure.drift
    ),
    number!(
        "sensors.fsr_temperature_percent_k",
        Range::new(-1.0, 1.0, "%/K").times(PERCENT),
        sensors.pressure.temperature
    ),
    per_arm!(
        "sensors.fsr_pad_share",
        Range::new(0.2, 2.0, ""),
        sensors.pressure.pad_share
    ),
    number!(
        "sensors.tilt_dead_zone_deg_s",
        Range::new(0.0, 20.0, "deg/s").times(DEGREE),
        sensors.tilt.dead_zone
    ),
    number!(
        "sensors.tilt_step_deg",
        Range::new(0.0, 5.0, "deg").times(DEGREE),
        sensors.tilt.step
    ),
    number!(
        "sensors.tilt_vibration_m_s2",
        Range::new(0.0, 60.0, "m/s2"),
        sensors.tilt.vibration
    ),
    number!(
        "sensors.sbus_slots",
        Range::new(0.0, sbus::SLOTS as f64, "sensors"),
        sensors.sbus_slots
    ),
    number!("pilot.delay_s", Range::new(0.0, 1.0, "s"), pilot.delay),
    number!("pilot.bandwidth_hz", Range::new(0.2, 20.0, "Hz"), pilot.bandwidth),
    number!("pilot.eye_noise_m", Range::new(0.0, 0.5, "m"), pilot.eye_noise),
    Key {
        name: "pilot.assist",
        kind: Kind::Choice(ASSISTS, |s, v| s.pilot.assist = assist(v)),
    },
    optional!(
        "pilot.touch_within_m",
        Range::new(0.005, 0.15, "m"),
        pilot.touch_within
    ),
    number!(
        "pilot.touch_drift_m_s",
        Range::new(0.01, 0.5, "m/s"),
        pilot.touch_drift
    ),
    optional!("pilot.believes_pipe_north_m", PIPE_PLACE, pilot.assumed.north),
    optional!("pilot.believes_pipe_east_m", PIPE_PLACE, pilot.assumed.east),
    optional!("pilot.believes_pipe_top_m", PIPE_TOP, pilot.assumed.top),
    optional!(
        "pilot.believes_pipe_diameter_m",
        PIPE_DIAMETER,
        pilot.assumed.diameter
    ),
    number!("faults.at_s", Range::new(0.0, 3600.0, "s"), faults.at),
    fault!("faults.pressure", faults::PRESSURE, pressure, faults::pressure),
    fault!("faults.tilt", faults::TILT, tilt, faults::tilt),
    fault!("faults.tendon", faults::TENDON, tendon, faults::tendon),
    Key {
        name: "faults.pressure_gain",
        kind: Kind::PerArm(Range::new(0.2, 2.0, ""), |s| &mut s.faults.pressure_gain),
    },
    Key {
        name: "faults.tilt_offset_deg",
        kind: Kind::PerArm(Range::new(-20.0, 20.0, "deg").times(DEGREE), |s| {
            &mut s.faults.tilt_offset
        }),
    },
    Key {
        name: "faults.tendon_slack_mm",
        kind: Kind::PerArm(Range::new(-10.0, 20.0, "mm").times(1e-3), |s| {
            &mut s.faults.tendon_slack
        }),
    },
    optional!("faults.radio_at_s", Range::new(0.0, 3600.0, "s"), faults.radio_at),
    Key {
        name: "expect.accomplished",
        kind: Kind::Flag(|s| &mut s.expect.accomplished),
    },
    Key {
        name: "expect.reason",
        kind: Kind::Text(|s, v| s.expect.reason = Some(v.to_owned())),
    },
    Key {
        name: "expect.says",
        kind: Kind::Text(|s, v| s.expect.says = Some(v.to_owned())),
    },
];

/// Numbers and flags (1 or 0) of `scenario` that are not at their default, by key, in the key's unit.
#[must_use]
pub fn changed(scenario: &Scenario) -> Vec<(&'static str, f64)> {
    let (mut flown, mut usual) = (scenario.clone(), Scenario::empty());
    let number = |key: &Key, s: &mut Scenario| match &key.kind {
        Kind::Number(range, field) => Some(*field(s) / range.si),
        Kind::Optional(range, field) => field(s).map(|value| value / range.si),
        Kind::Flag(field) => Some(f64::from(u8::from(*field(s)))),
        _ => None,
    };
    let mut changed = Vec::new();
    for key in KEYS {
        if let Some(value) = number(key, &mut flown)
            && number(key, &mut usual).map(f64::to_bits) != Some(value.to_bits())
        {
            changed.push((key.name, value));
        }
    }
    changed
}

/// Tables of a file; `steps` is a list.
pub const TABLES: &[&str] = &[
    "vehicle", "world", "sensors", "faults", "pilot", "params", "expect",
];
