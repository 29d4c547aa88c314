//! One step of one calibration, as a person or a host requests it.

use super::loads;
use crate::gripper::tendon::SPAN_MIN_US;

/// A calibration; the numbers are those of MAVLink's SOPHIE_CALIBRATION.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Calibration {
    /// Gyro at rest; stores nothing.
    Gyro = 1,
    /// Bias of the accelerometer on a level table.
    Level = 2,
    /// Bias and scale of the accelerometer by six sides.
    Accel = 3,
    /// Mounting of the inertial sensor by three sides.
    Mounting = 4,
    /// Divider of the flight battery's voltage, by a meter.
    Battery = 5,
    /// Marks of one tendon servo.
    Servo = 6,
    /// Line and hysteresis of one pressure sensor, by three loads up and down.
    Fsr = 7,
    /// Zero and sign of one arm's tilt sensor.
    Arm = 8,
    /// Scale and mounting of the flow module, by turning it at two heights.
    Flow = 9,
}

impl Calibration {
    /// All, by number.
    pub const ALL: [Self; 9] = [
        Self::Gyro,
        Self::Level,
        Self::Accel,
        Self::Mounting,
        Self::Battery,
        Self::Servo,
        Self::Fsr,
        Self::Arm,
        Self::Flow,
    ];

    /// Number of steps.
    pub const fn steps(self) -> u8 {
        match self {
            Self::Gyro | Self::Level | Self::Battery | Self::Servo => 1,
            Self::Arm | Self::Flow => 2,
            Self::Mounting => 3,
            Self::Accel => 6,
            Self::Fsr => loads::STEPS as u8,
        }
    }

    /// True if it is done for one of four parts.
    pub const fn is_of_one(self) -> bool {
        matches!(self, Self::Servo | Self::Fsr | Self::Arm)
    }

    /// Time of one step, µs: 2 s at rest, in which a breath of wind is over, and half a second for slow tasks; 8 s of
    /// turning; the marks of a servo need no measurement.
    pub const fn time_us(self) -> u64 {
        match self {
            Self::Servo => 0,
            Self::Flow => 8_000_000,
            _ => 2_500_000,
        }
    }
}

/// One step of a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The calibration.
    pub calibration: Calibration,
    /// Index of the arm, sensor or servo, 0 to 3; 0 for a calibration of the whole vehicle.
    pub part: usize,
    /// Number of the step, from 1.
    pub number: u8,
    /// Values that belong to it. Battery: V by a meter. Servo: pulses at release and at the full mark, µs. Pressure
    /// sensor: load on its pad, N; none in the first and the last step.
    pub values: [f32; 2],
}

impl Step {
    /// Step `number` of `calibration`; `part` is 1 to 4 for a calibration of one part, else 0. `None` for an unknown step
    /// or missing values.
    pub fn new(calibration: Calibration, part: u32, number: u32, values: [f32; 2]) -> Option<Self> {
        let part = match (calibration.is_of_one(), part) {
            (true, 1..=4) => part as usize - 1,
            (false, 0) => 0,
            _ => return None,
        };
        let number = u8::try_from(number).ok()?;
        if !(1..=calibration.steps()).contains(&number) {
            return None;
        }
        let [first, second] = values;
        let given = match (calibration, number) {
            (Calibration::Fsr, number) if loads::is_empty(number) => true,
            (Calibration::Battery | Calibration::Fsr, _) => first > 0.0 && first.is_finite(),
            (Calibration::Servo, _) => {
                (first + second).is_finite() && first >= SPAN_MIN_US && second >= SPAN_MIN_US
            }
            _ => true,
        };
        given.then_some(Self {
            calibration,
            part,
            number,
            values,
        })
    }

    /// Number of the arm, sensor or servo from 1; 0 for the whole vehicle.
    pub const fn part_number(&self) -> u8 {
        if self.calibration.is_of_one() {
            self.part as u8 + 1
        } else {
            0
        }
    }

    /// True for the last step of its calibration.
    pub const fn is_last(&self) -> bool {
        self.number >= self.calibration.steps()
    }
}
