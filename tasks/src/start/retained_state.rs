//! State retained over a reset: the grip on the pipe, the gyro bias, which could otherwise only be measured at rest, and
//! the thrust factor, which takes a flight.
//!
//! A reset (watchdog, fault, command, pin) preserves memory that start-up does not initialise. Two copies are written
//! alternately, with sequence number and checksum: a reset during a write leaves the other copy valid. After power-on
//! the memory's random content fails the checksum.

use sophie_control::allocation::wrench::PerArm;
use sophie_control::gripper::RESPONSE_RANGE;
use sophie_control::gripper::grip_fault::GripFault;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::maths::scalar;
use sophie_control::maths::vector::Vec3;
use sophie_control::pilot::rc::ArmChoice;
use sophie_control::thrust_factor::BOUNDS as FACTOR_RANGE;
use sophie_ports::retained::Words;

/// Marks a copy ("WARM") and its layout's number.
const MAGIC: u32 = 0x5741_524D + 4;
const FAULT_BITS: u32 = 4;
/// Beyond any servo's travel, rad.
const ANGLE_MAX: f32 = 6.5;
/// Beyond any parameters' limit, N.
const FORCE_MAX: f32 = 2000.0;
/// Identified responses and the thrust factor are stored as bytes, in hundredths; 0: none.
const HUNDRED: f32 = 100.0;
/// The estimator's own bound, rad/s.
const BIAS_MAX: f32 = 0.1;

/// State retained for the next run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RetainedState {
    /// The grip; never [`GripMemory::Unknown`] in memory.
    pub grip_memory: GripMemory,
    /// Commanded angle of each servo, rad from release, 0 to 6.5.
    pub angle: PerArm<f32>,
    /// Force of each tendon, less its share against the rotor's thrust, N, 0 to 2000.
    pub force: PerArm<f32>,
    /// Latched fault of each closed arm.
    pub fault: PerArm<Option<GripFault>>,
    /// Ratio of each closed arm's bending to the parameters', identified while closing, 0.4 to 2.5 in hundredths.
    pub response: PerArm<Option<f32>>,
    /// Gyro bias, rad/s, within ±0.1; `None` before calibration.
    pub gyro_bias: Option<Vec3>,
    /// [Thrust factor](sophie_control::thrust_factor), within its bounds in hundredths; `None` before a commander's step.
    pub thrust_factor: Option<f32>,
}

impl RetainedState {
    /// Words of one copy; `None` with an unchecked grip or an invalid value.
    pub fn to_words(&self, sequence: u32) -> Option<Words> {
        let (grip_memory, arms) = match self.grip_memory {
            GripMemory::Unknown => return None,
            GripMemory::Open => (1, 0),
            GripMemory::Controlled(arms) => (2, arm_code(arms)),
            GripMemory::HeldByGears(arms) => (3, arm_code(arms)),
        };
        let faults = self
            .fault
            .iter()
            .fold(0, |word, &fault| word << FAULT_BITS | fault_code(fault));
        let responses = self.response.iter().fold(0, |word, &response| {
            word << 8 | hundredths(response, RESPONSE_RANGE)
        });
        let bias = self.gyro_bias.unwrap_or_default();
        let [angle_1, angle_2, angle_3, angle_4] = self.angle.map(f32::to_bits);
        let [force_1, force_2, force_3, force_4] = self.force.map(f32::to_bits);
        let [bias_x, bias_y, bias_z] = bias.to_array().map(f32::to_bits);
        let mut words = [
            MAGIC,
            sequence,
            grip_memory
                | arms << 8
                | u32::from(self.gyro_bias.is_some()) << 16
                | hundredths(self.thrust_factor, FACTOR_RANGE) << 24,
            faults,
            angle_1,
            angle_2,
            angle_3,
            angle_4,
            force_1,
            force_2,
            force_3,
            force_4,
            bias_x,
            bias_y,
            bias_z,
            responses,
            0,
        ];
        let sum = checksum(&words);
        if let Some(last) = words.last_mut() {
            *last = sum;
        }
        // Never overwrites a valid record with one that fails validation.
        Self::from_words(&words).map(|_| words)
    }

    /// A copy and its sequence number; `None` if a bit or a value is wrong.
    pub fn from_words(words: &Words) -> Option<(Self, u32)> {
        let [
            magic,
            sequence,
            state,
            faults,
            angle_1,
            angle_2,
            angle_3,
            angle_4,
            force_1,
            force_2,
            force_3,
            force_4,
            bias_x,
            bias_y,
            bias_z,
            responses,
            sum,
        ] = *words;
        if magic != MAGIC
            || sum != checksum(words)
            || state >> 17 & 0x7F != 0
            || faults >> (4 * FAULT_BITS) != 0
        {
            return None;
        }
        let arms = arm_choice(state >> 8 & 0xFF)?;
        let grip_memory = match state & 0xFF {
            1 => GripMemory::Open,
            2 => GripMemory::Controlled(arms),
            3 => GripMemory::HeldByGears(arms),
            _ => return None,
        };
        let mut fault = [None; 4];
        for (slot, arm) in fault.iter_mut().rev().zip(0..) {
            *slot = fault_of(faults >> (arm * FAULT_BITS) & ((1 << FAULT_BITS) - 1))?;
        }
        let mut response = [None; 4];
        for (slot, code) in response.iter_mut().zip(responses.to_be_bytes()) {
            *slot = of_hundredths(code.into(), RESPONSE_RANGE)?;
        }
        let retained = Self {
            grip_memory,
            angle: [angle_1, angle_2, angle_3, angle_4].map(f32::from_bits),
            force: [force_1, force_2, force_3, force_4].map(f32::from_bits),
            fault,
            response,
            gyro_bias: (state >> 16 & 1 != 0)
                .then_some(Vec3::from([bias_x, bias_y, bias_z].map(f32::from_bits))),
            thrust_factor: of_hundredths(state >> 24, FACTOR_RANGE)?,
        };
        retained.is_sane().then_some((retained, sequence))
    }

    /// Newest valid copy and its sequence number.
    pub fn newest(copies: &[Words; 2]) -> Option<(Self, u32)> {
        let [a, b] = copies.each_ref().map(Self::from_words);
        match (a, b) {
            // Sequence numbers wrap.
            (Some(a), Some(b)) => Some(if a.1.wrapping_sub(b.1) < 1 << 31 { a } else { b }),
            (a, b) => a.or(b),
        }
    }

    fn is_sane(&self) -> bool {
        let within = |values: &[f32], low: f32, high: f32| values.iter().all(|v| (low..=high).contains(v));
        let bias = self.gyro_bias.unwrap_or_default().to_array();
        within(&self.angle, 0.0, ANGLE_MAX)
            && within(&self.force, 0.0, FORCE_MAX)
            && within(&bias, -BIAS_MAX, BIAS_MAX)
    }

    /// Servo angles and forces limited to what validation accepts.
    pub fn bounded(self) -> Self {
        Self {
            angle: self.angle.map(|a| scalar::clamp(a, 0.0, ANGLE_MAX)),
            force: self.force.map(|f| scalar::clamp(f, 0.0, FORCE_MAX)),
            response: self
                .response
                .map(|r| of_hundredths(hundredths(r, RESPONSE_RANGE), RESPONSE_RANGE).flatten()),
            gyro_bias: self
                .gyro_bias
                .filter(|b| b.is_finite())
                .map(|b| b.map(|x| scalar::clamp_abs(x, BIAS_MAX))),
            thrust_factor: of_hundredths(hundredths(self.thrust_factor, FACTOR_RANGE), FACTOR_RANGE)
                .flatten(),
            ..self
        }
    }
}

fn arm_code(arms: ArmChoice) -> u32 {
    match arms {
        ArmChoice::All => 0,
        ArmChoice::Front => 1,
        ArmChoice::Rear => 2,
    }
}

fn arm_choice(code: u32) -> Option<ArmChoice> {
    [ArmChoice::All, ArmChoice::Front, ArmChoice::Rear]
        .into_iter()
        .find(|&arms| arm_code(arms) == code)
}

/// Code of `value` in hundredths; NaN and values out of `range` are stored as 0, none.
fn hundredths(value: Option<f32>, (least, most): (f32, f32)) -> u32 {
    value
        .filter(|v| (least..=most).contains(v))
        .map_or(0, |v| (v * HUNDRED + 0.5) as u32)
}

/// Outer `None`: out of `range`.
fn of_hundredths(code: u32, (least, most): (f32, f32)) -> Option<Option<f32>> {
    if code == 0 {
        return Some(None);
    }
    let value = code as f32 / HUNDRED;
    (least..=most).contains(&value).then_some(Some(value))
}

/// Code of a latched fault; other faults are detected again after the restart.
fn fault_code(fault: Option<GripFault>) -> u32 {
    match fault {
        Some(GripFault::Sensor) => 1,
        Some(GripFault::Unfelt) => 2,
        Some(GripFault::Ceiling) => 3,
        _ => 0,
    }
}

/// Outer `None`: unknown code.
fn fault_of(code: u32) -> Option<Option<GripFault>> {
    match code {
        0 => Some(None),
        1 => Some(Some(GripFault::Sensor)),
        2 => Some(Some(GripFault::Unfelt)),
        3 => Some(Some(GripFault::Ceiling)),
        _ => None,
    }
}

/// CRC-32 (IEEE 802.3, bitwise: a few thousand cycles) of all words but the last.
fn checksum(words: &Words) -> u32 {
    let (_, head) = words.split_last().unwrap_or((&0, &[]));
    let mut crc = u32::MAX;
    for word in head {
        crc ^= word;
        for _ in 0..32 {
            crc = crc >> 1 ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    !crc
}

#[cfg(test)]
mod tests;
