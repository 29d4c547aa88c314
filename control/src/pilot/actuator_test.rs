//! Tests of motors and servos on the ground: orders of the console and the replies of the mode logic.
//!
//! An order has a number, and the console renews it under that number while it lasts; without renewal it ends
//! ([`crate::mode::ModeLogic`], in DISARMED alone).

pub use crate::chain::spin::{SPIN_DRIVE, SPIN_DRIVE_MAX, SPIN_DRIVE_MIN, SPIN_TIME, Spin};

use super::static_thrust_test::StaticThrustTest;

/// Longest time for which a servo is held away from its release mark, s: one that pulls at an arm gets hot.
pub const PLACE_TIME: f32 = 30.0;
/// Shortest pulse of a servo, µs, of the usual 500 to 2500.
pub const PULSE_MIN_US: f32 = 500.0;
/// Longest pulse, µs.
pub const PULSE_MAX_US: f32 = 2500.0;

/// One servo at a pulse, the others at their release marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the servo, 0 to 3.
    pub servo: usize,
    /// Pulse width, µs, within [`PULSE_MIN_US`] and [`PULSE_MAX_US`].
    pub pulse_us: f32,
}

impl Place {
    fn is_allowed(&self) -> bool {
        self.servo < 4 && (PULSE_MIN_US..=PULSE_MAX_US).contains(&self.pulse_us)
    }
}

/// A test of one actuator, or an order about the tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ActuatorTest {
    /// Ends the running order.
    End,
    /// The builder confirms that the propellers are off: motors may be tried.
    PropellersOff,
    /// The builder confirms that the vehicle is tied down and its propellers are on: static thrust may be tested.
    TiedDown,
    /// Spins a motor, for [`SPIN_TIME`] at most.
    Spin(Spin),
    /// Places a servo, for [`PLACE_TIME`] at most, then back to the release mark.
    Place(Place),
    /// Rotors with propellers on, for [`StaticThrustTest::longest`].
    StaticThrust(StaticThrustTest),
}

impl ActuatorTest {
    /// Longest duration, s.
    pub fn longest(&self) -> f32 {
        match self {
            Self::End | Self::PropellersOff | Self::TiedDown => 0.0,
            Self::Spin(_) => SPIN_TIME,
            Self::Place(_) => PLACE_TIME,
            Self::StaticThrust(test) => test.longest(),
        }
    }

    /// Its numbers are within their limits.
    pub fn is_allowed(&self) -> bool {
        match self {
            Self::End | Self::PropellersOff | Self::TiedDown => true,
            Self::Spin(spin) => spin.is_allowed(),
            Self::Place(place) => place.is_allowed(),
            Self::StaticThrust(test) => test.is_allowed(),
        }
    }
}

/// An order with its number; the same order under a new number starts again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorTestRequest {
    /// Counts from 1.
    pub number: u32,
    /// The order.
    pub order: ActuatorTest,
}

/// Declares why an order is refused or ended: name and text.
macro_rules! actuator_test_refusals {
    ($($(#[$doc:meta])+ $name:ident = $text:literal;)+) => {
        /// Why an order is refused, or ended before its time.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ActuatorTestRefusal { $($(#[$doc])+ $name,)+ }

        impl ActuatorTestRefusal {
            /// For the console.
            pub const fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }
        }
    };
}

actuator_test_refusals! {
    /// Another mode than DISARMED.
    NotDisarmed = "only while DISARMED";
    /// The pilot may be about to arm.
    ArmSwitchOn = "arm switch on: turn it off first";
    /// The processor may stall.
    Storing = "storing parameters: restart first";
    /// The vehicle may hang on its arms.
    ArmsClosed = "arms closed: perch switch on and off opens them";
    /// It is unknown whether the vehicle hangs on its arms.
    GripUnknown = "pressure sensors silent: whether the arms hold is not known";
    /// The builder has not confirmed that the propellers are off.
    PropellersOn = "say 'propellers off' first, once they are";
    /// The builder has not confirmed that the vehicle is tied down.
    NotTiedDown = "say 'tied down' first, once it is";
    /// The motors' path runs at the sensor's pace.
    ImuSilent = "inertial sensor silent: motors wait for it";
    /// The motor pulses are out of order: no pulse turns a motor safely.
    MotorPulses = "motor pulses out of order";
    /// The battery is below its critical voltage, or that is not known.
    BatteryCritical = "battery critical or not measured";
    /// The vehicle has turned away from its attitude at the start.
    Turned = "vehicle turned: it may have come loose";
    /// A number is beyond its limits.
    OutOfRange = "out of range";
    /// The sender of the order has not renewed it.
    NotRenewed = "console silent";
    /// A command to disarm came.
    Disarm = "disarmed by command";
    /// An order of another line is running.
    InUse = "another link runs an actuator test";
}

/// State of the actuator tests as the sender of an order sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActuatorTestView {
    /// Number of the newest order, from any line.
    pub newest: u32,
    /// The sender still renews that order.
    pub renewed: bool,
    /// Reply to that order.
    pub answer: ActuatorTestAnswer,
}

impl ActuatorTestView {
    /// The number of the next order of a line whose last one was `own`.
    ///
    /// # Errors
    /// An order of another line is running.
    pub fn next(&self, own: u32) -> Result<u32, ActuatorTestRefusal> {
        let lasts = self.answer.number != self.newest || self.answer.state == ActuatorTestState::Running;
        if self.newest != own && self.renewed && lasts {
            return Err(ActuatorTestRefusal::InUse);
        }
        Ok(self.newest.wrapping_add(1).max(1))
    }
}

/// State of the newest order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ActuatorTestState {
    /// No order yet, or the order has ended as intended.
    #[default]
    Done,
    /// The order is running.
    Running,
    /// The order was refused before it began.
    Refused(ActuatorTestRefusal),
    /// The order was ended before its time.
    Ended(ActuatorTestRefusal),
}

/// The reply to the order with this number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActuatorTestAnswer {
    /// Number of the order; 0 before the first.
    pub number: u32,
    /// State of that order.
    pub state: ActuatorTestState,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_beyond_the_limit_or_without_a_rotor_turns_nothing() {
        let spin = Spin::at;
        assert_eq!(
            spin(2, SPIN_DRIVE_MAX).commands(0.07),
            [0.0, 0.0, SPIN_DRIVE_MAX, 0.0]
        );
        for bad in [
            spin(0, 0.1201),
            spin(0, f32::NAN),
            spin(0, f32::INFINITY),
            spin(4, 0.08),
        ] {
            assert_eq!(bad.commands(0.07), [0.0; 4], "{bad:?}");
            assert!(!ActuatorTest::Spin(bad).is_allowed(), "{bad:?}");
        }
        assert!(!ActuatorTest::Spin(spin(0, 0.0)).is_allowed());
        assert!(ActuatorTest::Spin(spin(3, SPIN_DRIVE)).is_allowed());
    }

    #[test]
    fn a_motor_that_is_tried_turns_unless_what_turns_it_is_looked_for() {
        let slow = Spin::at(1, SPIN_DRIVE_MIN);
        assert_eq!(slow.commands(0.14), [0.0, 0.14, 0.0, 0.0]);
        assert_eq!(Spin::at(1, 0.1).commands(0.075), [0.0, 0.1, 0.0, 0.0]);
        let probe = Spin { probes: true, ..slow };
        assert_eq!(probe.commands(0.14), [0.0, SPIN_DRIVE_MIN, 0.0, 0.0]);
    }

    #[test]
    fn a_servo_takes_the_usual_pulses_only() {
        let allowed = |servo, pulse_us| ActuatorTest::Place(Place { servo, pulse_us }).is_allowed();
        assert!(allowed(0, PULSE_MIN_US) && allowed(3, PULSE_MAX_US));
        for bad in [499.9, 2500.1, f32::NAN, f32::INFINITY, -1500.0] {
            assert!(!allowed(0, bad), "{bad}");
        }
        assert!(!allowed(4, 1500.0));
    }
}
