//! Arming inhibits and the pilot's gesture, evaluated at 100 Hz.

mod gesture;

pub use self::gesture::{GESTURE_TIME, Gesture, GestureWatch};
use crate::allocation::motor_pulses::MotorPulses;
use crate::allocation::wrench::PerArm;
use crate::maths::scalar::cos;
use crate::params::Params;
use crate::pilot::rc::Sticks;

/// Largest tilt at which the rotors may start, rad (25°).
pub const TILT_MAX: f32 = crate::maths::scalar::deg(25.0);

/// Declares the checks by priority: name, text for the pilot's display, what clears it.
macro_rules! arming_checks {
    ($($(#[$doc:meta])+ $name:ident = $text:literal, $cleared:literal;)+) => {
        /// A reason for which arming is refused.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum ArmingInhibit { $($(#[$doc])+ $name,)+ }

        impl ArmingInhibit {
            /// Every reason, by priority.
            pub const ALL: [Self; [$($text),+].len()] = [$(Self::$name),+];

            /// Text for the pilot's display.
            pub const fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }

            /// What clears it, for the docs.
            #[cfg(test)]
            pub(crate) const fn cleared_by(self) -> &'static str {
                match self { $(Self::$name => $cleared,)+ }
            }
        }
    };
}

arming_checks! {
    /// The supply broke down and the board restarted.
    BrownOut = "supply broke down", "a start with a sound supply";
    /// The brown-out level is not set: on a failing supply the chip would keep running and execute garbage.
    BrownOutLevel = "brown-out level not set", "setting the level (`brownout set`), once for each chip";
    /// The start-up checks found a setting of the chip for which the firmware is not built.
    Silicon = "chip not as expected", "a chip and a start as expected";
    /// Parameters are being stored.
    Storing = "storing parameters", "the end of storing";
    /// Stored parameters are not in force yet.
    Stored = "stored parameters: restart first", "a restart, which puts them in force";
    /// The memory for parameters holds another firmware's data: the defaults are in force.
    StorageForeign = "storage holds another firmware's data", "`save` from the console";
    /// The stored parameters cannot be read: the defaults are in force.
    StorageUnreadable = "stored parameters unreadable", "`save` from the console";
    /// The parameters do not fit into their storage.
    StorageFull = "parameter storage full", "`save` that fits";
    /// `motor_pulse_min`, `_idle` and `_max` do not rise, or the dead zone takes too much: no pulses are sent.
    MotorPulses = "motor pulses out of order", "min < idle < max, idle in the lowest 30 %, at the next start";
    /// The vehicle's inertial sensor does not answer.
    ImuAbsent = "inertial sensor absent", "the driver, when the part answers";
    /// Another chip answers in place of the vehicle's inertial sensor.
    ImuWrongPart = "inertial sensor: wrong chip", "the driver, when the right part answers";
    /// The vehicle's inertial sensor has failed its self-test.
    ImuSelfTest = "inertial sensor: self-test failed", "the driver, when a self-test passes";
    /// The vehicle's inertial sensor delivers implausible samples.
    ImuCorrupt = "inertial sensor garbled", "the driver, when samples are sound";
    /// The data-ready line of the vehicle's inertial sensor is silent; the sensor is polled by the clock.
    ImuLineSilent = "inertial sensor: data-ready line silent", "the driver, when edges come again";
    /// No fresh frame from the receiver.
    RcLost = "radio lost", "fresh frames";
    /// No fresh attitude.
    ImuStale = "inertial sensor silent", "fresh attitudes";
    /// The gyro has not been calibrated at rest, or its attitude is not that of gravity.
    NotCalibrated = "not calibrated", "two seconds at rest";
    /// The arm switch has been on since power-up.
    SwitchOnAtPowerUp = "arm switch on at power-up", "the pilot: arm switch off";
    /// The throttle stick is not at its low end.
    ThrottleNotLow = "throttle not low", "the pilot";
    /// The perch switch is on.
    PerchSwitchOn = "perch switch on", "the pilot";
    /// The arms are closed and do not hold, or are not proven free.
    ArmsClosed = "arms closed", "perch switch on and off, until every arm is free; or a grip that holds";
    /// The vehicle leans by more than [`TILT_MAX`].
    TiltTooLarge = "tilt too large", "setting it upright";
    /// No fresh voltage of the flight battery.
    BatterySilent = "battery not measured", "the battery's input, when it reads a voltage";
    /// The battery is below the warning voltage.
    BatteryLow = "battery low", "another battery";
    /// No fresh voltage of the servo battery, which should be measured.
    ServoBatterySilent = "servo battery not measured", "the servo battery's input, when it reads a voltage";
    /// The servo battery is below its low voltage.
    ServoBatteryLow = "servo battery low", "another servo battery";
    /// The analog inputs deliver no conversions.
    AnalogSilent = "analog inputs silent", "the driver, when inputs answer";
    /// A pressure sensor of a chosen arm is faulty or silent.
    FsrFault = "pressure sensor fault", "the sensor, or another choice of arms";
    /// The range of arm 1's pressure sensor ends too near the grip pressure.
    FsrRange1 = "pressure sensor 1: range too small", "a range that reaches the grip, at the next start";
    /// The range of arm 2's pressure sensor ends too near the grip pressure.
    FsrRange2 = "pressure sensor 2: range too small", "a range that reaches the grip, at the next start";
    /// The range of arm 3's pressure sensor ends too near the grip pressure.
    FsrRange3 = "pressure sensor 3: range too small", "a range that reaches the grip, at the next start";
    /// The range of arm 4's pressure sensor ends too near the grip pressure.
    FsrRange4 = "pressure sensor 4: range too small", "a range that reaches the grip, at the next start";
    /// A servo's marks have not been measured: its position and the pull on its arm are unknown.
    ServoUnmarked = "servo not calibrated", "`calibrate servo` for each, at the next start";
    /// The sensor on arm 1 is silent.
    ArmSensor1 = "arm sensor 1 silent", "the task `arms`, when the sensor answers";
    /// The sensor on arm 2 is silent.
    ArmSensor2 = "arm sensor 2 silent", "the task `arms`, when the sensor answers";
    /// The sensor on arm 3 is silent.
    ArmSensor3 = "arm sensor 3 silent", "the task `arms`, when the sensor answers";
    /// The sensor on arm 4 is silent.
    ArmSensor4 = "arm sensor 4 silent", "the task `arms`, when the sensor answers";
    /// The flight level misses its deadlines.
    Overruns = "deadlines missed", "a second without misses";
}

const _: () = assert!(ArmingInhibit::ALL.len() <= u64::BITS as usize);

impl ArmingInhibit {
    /// Range checks of the pressure sensors, by arm.
    pub const FSR_RANGE: PerArm<Self> = [Self::FsrRange1, Self::FsrRange2, Self::FsrRange3, Self::FsrRange4];

    const fn bit(self) -> u64 {
        1 << self as u8
    }
}

/// Set of active reasons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ArmingInhibits(u64);

impl ArmingInhibits {
    /// No reason.
    pub const NONE: Self = Self(0);

    /// True when arming is allowed.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The reasons as bits: bit n is [`ArmingInhibit::ALL`]`[n]`.
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// Adds `reason`.
    pub const fn with(self, reason: ArmingInhibit) -> Self {
        Self(self.0 | reason.bit())
    }

    /// Removes `reason`.
    pub const fn without(self, reason: ArmingInhibit) -> Self {
        Self(self.0 & !reason.bit())
    }

    /// Union with `others`.
    pub const fn and(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// True when `reason` is active.
    pub const fn contains(self, reason: ArmingInhibit) -> bool {
        self.0 & reason.bit() != 0
    }

    /// Highest-priority reason.
    pub fn first(self) -> Option<ArmingInhibit> {
        self.iter().next()
    }

    /// Active reasons by priority.
    pub fn iter(self) -> impl Iterator<Item = ArmingInhibit> {
        ArmingInhibit::ALL.into_iter().filter(move |&r| self.contains(r))
    }
}

impl FromIterator<ArmingInhibit> for ArmingInhibits {
    fn from_iter<I: IntoIterator<Item = ArmingInhibit>>(reasons: I) -> Self {
        Self(reasons.into_iter().fold(0, |bits, r| bits | r.bit()))
    }
}

/// Inputs of the arming checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checks {
    /// Calibration at rest has ended, and the attitude is that of gravity.
    pub calibrated: bool,
    /// Cosine of the tilt; `None` without a fresh attitude.
    pub cos_tilt: Option<f32>,
    /// Sticks; `None` when the radio is lost.
    pub sticks: Option<Sticks>,
    /// The arm switch has been off since power-up.
    pub switch_seen_off: bool,
    /// Battery voltage, V; `None` when not measured.
    pub battery: Option<f32>,
    /// A pressure sensor of a chosen arm is faulty or silent.
    pub fsr_fault: bool,
    /// The flight level misses its deadlines.
    pub late: bool,
    /// The arms are closed and do not hold, or are not proven free.
    pub arms_closed: bool,
    /// Reports of drivers, storage and start.
    pub hardware: ArmingInhibits,
}

impl Checks {
    /// Every active reason.
    pub fn inhibits(&self, params: &Params) -> ArmingInhibits {
        let sticks = self.sticks.unwrap_or_default();
        // Written as "not good", so that a NaN refuses.
        let upright = self.cos_tilt.is_none_or(|c| c >= cos(TILT_MAX));
        let charged = self.battery.is_none_or(|v| v >= params.battery_warning);
        let reasons = [
            (ArmingInhibit::RcLost, self.sticks.is_none()),
            (ArmingInhibit::ImuStale, self.cos_tilt.is_none()),
            (ArmingInhibit::NotCalibrated, !self.calibrated),
            (
                ArmingInhibit::SwitchOnAtPowerUp,
                self.sticks.is_some() && !self.switch_seen_off,
            ),
            (
                ArmingInhibit::ThrottleNotLow,
                sticks.throttle > params.throttle_low,
            ),
            (ArmingInhibit::PerchSwitchOn, sticks.perch_switch),
            (ArmingInhibit::ArmsClosed, self.arms_closed),
            (ArmingInhibit::TiltTooLarge, !upright),
            (ArmingInhibit::BatterySilent, self.battery.is_none()),
            (ArmingInhibit::BatteryLow, !charged),
            (ArmingInhibit::FsrFault, self.fsr_fault),
            (ArmingInhibit::Overruns, self.late),
            (
                ArmingInhibit::MotorPulses,
                MotorPulses::from_params(params).is_none(),
            ),
        ];
        reasons
            .into_iter()
            .filter(|&(_, holds)| holds)
            .map(|(r, _)| r)
            .collect::<ArmingInhibits>()
            .and(self.hardware)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::scalar::deg;

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
        for (i, a) in ArmingInhibit::ALL.into_iter().enumerate() {
            assert!(ArmingInhibits::NONE.with(a).iter().eq([a]), "{a:?}");
            assert!(!a.text().is_empty() && a.text().len() <= 40, "{a:?}");
            for b in ArmingInhibit::ALL.into_iter().skip(i + 1) {
                assert!(a != b && a.text() != b.text(), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn pulses_that_do_not_rise_refuse_whatever_the_protocol() {
        for (idle, refused) in [(1000.0, true), (2000.0, true), (1001.0, false), (1070.0, false)] {
            let p = Params {
                motor_pulse_idle: idle,
                ..Params::default()
            };
            let inhibits = good().inhibits(&p);
            assert_eq!(inhibits.contains(ArmingInhibit::MotorPulses), refused, "{idle}");
            assert_eq!(inhibits.is_empty(), !refused, "{idle}");
        }
    }

    #[test]
    fn each_check_refuses_for_its_own_reason_alone() {
        let p = Params::default();
        assert!(good().inhibits(&p).is_empty());
        type Edit = fn(&mut Checks, &mut Sticks);
        let cases: [(Edit, ArmingInhibit); 12] = [
            (|c, _| c.calibrated = false, ArmingInhibit::NotCalibrated),
            (|c, _| c.cos_tilt = None, ArmingInhibit::ImuStale),
            (|_, s| s.throttle = 0.06, ArmingInhibit::ThrottleNotLow),
            (
                |c, _| c.cos_tilt = Some(f32::cos(deg(26.0))),
                ArmingInhibit::TiltTooLarge,
            ),
            (|c, _| c.cos_tilt = Some(f32::NAN), ArmingInhibit::TiltTooLarge),
            (|c, _| c.battery = Some(13.5), ArmingInhibit::BatteryLow),
            (|c, _| c.battery = None, ArmingInhibit::BatterySilent),
            (|_, s| s.perch_switch = true, ArmingInhibit::PerchSwitchOn),
            (|c, _| c.fsr_fault = true, ArmingInhibit::FsrFault),
            (|c, _| c.switch_seen_off = false, ArmingInhibit::SwitchOnAtPowerUp),
            (|c, _| c.late = true, ArmingInhibit::Overruns),
            (|c, _| c.arms_closed = true, ArmingInhibit::ArmsClosed),
        ];
        let edited = cases.map(|(edit, reason)| {
            let (mut checks, mut sticks) = (good(), good().sticks.unwrap_or_default());
            edit(&mut checks, &mut sticks);
            checks.sticks = Some(sticks);
            (checks, reason)
        });
        let mut silent = good();
        silent.sticks = None;
        for (checks, reason) in edited.into_iter().chain([(silent, ArmingInhibit::RcLost)]) {
            let inhibits = checks.inhibits(&p);
            assert!(inhibits.iter().eq([reason]), "{checks:?}");
            assert!(!reason.text().is_empty() && reason.text().len() <= 30);
        }
    }
}
