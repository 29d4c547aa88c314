//! Arming: the gesture of the pilot, and everything that forbids it.

mod gesture;

pub use self::gesture::{GESTURE_TIME, Gesture, GestureWatch};
use crate::math::cos;
use crate::params::Params;
use crate::rc::Sticks;
use crate::wrench::PerArm;

/// Largest tilt at which the rotors may start, rad (25°).
pub const TILT_MAX: f32 = crate::math::deg(25.0);

/// A reason why arming is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// The gyro has not been calibrated at rest.
    NotCalibrated,
    /// No fresh attitude.
    ImuStale,
    /// No fresh frame from the receiver.
    RcLost,
    /// The throttle stick is not at its low end.
    ThrottleNotLow,
    /// The vehicle leans by more than [`TILT_MAX`].
    TiltTooLarge,
    /// The battery is below the warning voltage, or not measured.
    BatteryLow,
    /// The perch switch is on.
    PerchSwitchOn,
    /// A pressure sensor of a chosen arm is faulty or silent.
    FsrFault,
    /// The arm switch has been on since power-up.
    SwitchOnAtPowerUp,
    /// The flight level misses its deadlines.
    Overruns,
    /// The tendons are still closed.
    ArmsClosed,
    /// The vehicle's inertial sensor does not answer.
    ImuAbsent,
    /// Another chip answers in place of the vehicle's inertial sensor.
    ImuWrongPart,
    /// The vehicle's inertial sensor gives what it cannot have measured.
    ImuCorrupt,
    /// The vehicle's inertial sensor has failed its self-test.
    ImuSelfTest,
    /// The sensor on arm 1 gives nothing.
    ArmSensor1,
    /// The sensor on arm 2 gives nothing.
    ArmSensor2,
    /// The sensor on arm 3 gives nothing.
    ArmSensor3,
    /// The sensor on arm 4 gives nothing.
    ArmSensor4,
    /// The analog inputs give nothing.
    AnalogSilent,
    /// The stored parameters cannot be read: the defaults are in force.
    StorageUnreadable,
    /// The parameters do not fit into their storage.
    StorageFull,
    /// Parameters are being stored.
    Storing,
    /// The supply broke down and the board restarted.
    BrownOut,
    /// What the pressure sensor of arm 1 can read ends too near the grip pressure.
    FsrRange1,
    /// What the pressure sensor of arm 2 can read ends too near the grip pressure.
    FsrRange2,
    /// What the pressure sensor of arm 3 can read ends too near the grip pressure.
    FsrRange3,
    /// What the pressure sensor of arm 4 can read ends too near the grip pressure.
    FsrRange4,
    /// The chip would go on executing, and executing garbage, when its supply breaks down.
    BrownOutLevel,
    /// The start-up found something in the chip that the firmware is not made for.
    Silicon,
    /// The memory for parameters holds another firmware's data: the defaults are in force.
    StorageForeign,
    /// The data-ready line of the vehicle's inertial sensor is silent; the part is read by the clock.
    ImuLineSilent,
}

impl Refusal {
    /// Every reason, the most basic first.
    pub const ALL: [Self; 32] = [
        Self::BrownOut,
        Self::BrownOutLevel,
        Self::Silicon,
        Self::Storing,
        Self::StorageForeign,
        Self::StorageUnreadable,
        Self::StorageFull,
        Self::ImuAbsent,
        Self::ImuWrongPart,
        Self::ImuSelfTest,
        Self::ImuCorrupt,
        Self::ImuLineSilent,
        Self::RcLost,
        Self::ImuStale,
        Self::NotCalibrated,
        Self::SwitchOnAtPowerUp,
        Self::ThrottleNotLow,
        Self::PerchSwitchOn,
        Self::ArmsClosed,
        Self::TiltTooLarge,
        Self::BatteryLow,
        Self::AnalogSilent,
        Self::FsrFault,
        Self::FsrRange1,
        Self::FsrRange2,
        Self::FsrRange3,
        Self::FsrRange4,
        Self::ArmSensor1,
        Self::ArmSensor2,
        Self::ArmSensor3,
        Self::ArmSensor4,
        Self::Overruns,
    ];

    /// The pressure sensors' ranges, arm by arm.
    pub const FSR_RANGE: PerArm<Self> = [Self::FsrRange1, Self::FsrRange2, Self::FsrRange3, Self::FsrRange4];

    /// For the pilot's display.
    pub const fn text(self) -> &'static str {
        match self {
            Self::NotCalibrated => "not calibrated",
            Self::ImuStale => "inertial sensor silent",
            Self::RcLost => "radio lost",
            Self::ThrottleNotLow => "throttle not low",
            Self::TiltTooLarge => "tilt too large",
            Self::BatteryLow => "battery low",
            Self::PerchSwitchOn => "perch switch on",
            Self::FsrFault => "pressure sensor fault",
            Self::SwitchOnAtPowerUp => "arm switch on at power-up",
            Self::Overruns => "deadlines missed",
            Self::ArmsClosed => "arms closed",
            Self::ImuAbsent => "inertial sensor absent",
            Self::ImuWrongPart => "inertial sensor: wrong chip",
            Self::ImuCorrupt => "inertial sensor garbled",
            Self::ImuLineSilent => "inertial sensor: data-ready line silent",
            Self::ImuSelfTest => "inertial sensor: self-test failed",
            Self::ArmSensor1 => "arm sensor 1 silent",
            Self::ArmSensor2 => "arm sensor 2 silent",
            Self::ArmSensor3 => "arm sensor 3 silent",
            Self::ArmSensor4 => "arm sensor 4 silent",
            Self::AnalogSilent => "analog inputs silent",
            Self::StorageUnreadable => "stored parameters unreadable",
            Self::StorageFull => "parameter storage full",
            Self::Storing => "storing parameters",
            Self::BrownOut => "supply broke down",
            Self::FsrRange1 => "pressure sensor 1: range too small",
            Self::FsrRange2 => "pressure sensor 2: range too small",
            Self::FsrRange3 => "pressure sensor 3: range too small",
            Self::FsrRange4 => "pressure sensor 4: range too small",
            Self::BrownOutLevel => "brown-out level not set",
            Self::Silicon => "chip not as expected",
            Self::StorageForeign => "storage holds another firmware's data",
        }
    }

    const fn bit(self) -> u64 {
        1 << self as u8
    }
}

/// The reasons that hold now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals(u64);

impl Refusals {
    /// No reason.
    pub const NONE: Self = Self(0);

    /// No reason: arming is free.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// These and `reason`.
    pub const fn with(self, reason: Refusal) -> Self {
        Self(self.0 | reason.bit())
    }

    /// These without `reason`.
    pub const fn without(self, reason: Refusal) -> Self {
        Self(self.0 & !reason.bit())
    }

    /// These and `others`.
    pub const fn and(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// True when `reason` holds.
    pub const fn contains(self, reason: Refusal) -> bool {
        self.0 & reason.bit() != 0
    }

    /// The most basic reason.
    pub fn first(self) -> Option<Refusal> {
        self.iter().next()
    }

    /// Every reason that holds, the most basic first.
    pub fn iter(self) -> impl Iterator<Item = Refusal> {
        Refusal::ALL.into_iter().filter(move |&r| self.contains(r))
    }
}

impl FromIterator<Refusal> for Refusals {
    fn from_iter<I: IntoIterator<Item = Refusal>>(reasons: I) -> Self {
        Self(reasons.into_iter().fold(0, |bits, r| bits | r.bit()))
    }
}

/// What the arming checks look at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checks {
    /// Calibration at rest has ended.
    pub calibrated: bool,
    /// Cosine of the tilt; `None` without a fresh attitude.
    pub cos_tilt: Option<f32>,
    /// The pilot's wishes; `None` when the radio is lost.
    pub sticks: Option<Sticks>,
    /// The arm switch has been off since power-up.
    pub switch_seen_off: bool,
    /// Battery voltage, V; `None` when not measured.
    pub battery: Option<f32>,
    /// A pressure sensor of a chosen arm is faulty or silent.
    pub fsr_fault: bool,
    /// The flight level misses its deadlines.
    pub late: bool,
    /// The tendons are closed.
    pub arms_closed: bool,
    /// What the drivers, the storage and the start report.
    pub hardware: Refusals,
}

impl Checks {
    /// Every reason against arming now.
    pub fn refusals(&self, params: &Params) -> Refusals {
        let sticks = self.sticks.unwrap_or_default();
        // Written as "not good", so that a NaN refuses.
        let upright = self.cos_tilt.is_none_or(|c| c >= cos(TILT_MAX));
        let charged = self.battery.is_some_and(|v| v >= params.battery_warning);
        let reasons = [
            (Refusal::RcLost, self.sticks.is_none()),
            (Refusal::ImuStale, self.cos_tilt.is_none()),
            (Refusal::NotCalibrated, !self.calibrated),
            (
                Refusal::SwitchOnAtPowerUp,
                self.sticks.is_some() && !self.switch_seen_off,
            ),
            (Refusal::ThrottleNotLow, sticks.throttle > params.throttle_low),
            (Refusal::PerchSwitchOn, sticks.perch_switch),
            (Refusal::ArmsClosed, self.arms_closed),
            (Refusal::TiltTooLarge, !upright),
            (Refusal::BatteryLow, !charged),
            (Refusal::FsrFault, self.fsr_fault),
            (Refusal::Overruns, self.late),
        ];
        reasons
            .into_iter()
            .filter(|&(_, holds)| holds)
            .map(|(r, _)| r)
            .collect::<Refusals>()
            .and(self.hardware)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::deg;

    fn good() -> Checks {
        Checks {
            calibrated: true,
            cos_tilt: Some(1.0),
            sticks: Some(Sticks {
                arm_switch: true,
                ..Default::default()
            }),
            switch_seen_off: true,
            battery: Some(16.0),
            ..Default::default()
        }
    }

    #[test]
    fn every_reason_has_a_bit_and_a_short_text_of_its_own() {
        for (i, a) in Refusal::ALL.into_iter().enumerate() {
            assert!(Refusals::NONE.with(a).iter().eq([a]), "{a:?}");
            assert!(!a.text().is_empty() && a.text().len() <= 40, "{a:?}");
            for b in Refusal::ALL.into_iter().skip(i + 1) {
                assert!(a != b && a.text() != b.text(), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn each_check_refuses_for_its_own_reason_alone() {
        let p = Params::default();
        assert!(good().refusals(&p).is_empty());
        let stick = |s| {
            Some(Sticks {
                arm_switch: true,
                ..s
            })
        };
        let cases = [
            (
                Checks {
                    calibrated: false,
                    ..good()
                },
                Refusal::NotCalibrated,
            ),
            (
                Checks {
                    cos_tilt: None,
                    ..good()
                },
                Refusal::ImuStale,
            ),
            (
                Checks {
                    sticks: None,
                    ..good()
                },
                Refusal::RcLost,
            ),
            (
                Checks {
                    sticks: stick(Sticks {
                        throttle: 0.06,
                        ..Default::default()
                    }),
                    ..good()
                },
                Refusal::ThrottleNotLow,
            ),
            (
                Checks {
                    cos_tilt: Some(f32::cos(deg(26.0))),
                    ..good()
                },
                Refusal::TiltTooLarge,
            ),
            (
                Checks {
                    cos_tilt: Some(f32::NAN),
                    ..good()
                },
                Refusal::TiltTooLarge,
            ),
            (
                Checks {
                    battery: Some(13.5),
                    ..good()
                },
                Refusal::BatteryLow,
            ),
            (
                Checks {
                    battery: None,
                    ..good()
                },
                Refusal::BatteryLow,
            ),
            (
                Checks {
                    sticks: stick(Sticks {
                        perch_switch: true,
                        ..Default::default()
                    }),
                    ..good()
                },
                Refusal::PerchSwitchOn,
            ),
            (
                Checks {
                    fsr_fault: true,
                    ..good()
                },
                Refusal::FsrFault,
            ),
            (
                Checks {
                    switch_seen_off: false,
                    ..good()
                },
                Refusal::SwitchOnAtPowerUp,
            ),
            (Checks { late: true, ..good() }, Refusal::Overruns),
            (
                Checks {
                    arms_closed: true,
                    ..good()
                },
                Refusal::ArmsClosed,
            ),
        ];
        for (checks, reason) in cases {
            let refusals = checks.refusals(&p);
            assert!(refusals.iter().eq([reason]), "{checks:?}");
            assert!(!reason.text().is_empty() && reason.text().len() <= 30);
        }
    }
}
