//! The enumerated parameters: their values as types, which cannot hold any other.

use super::Choice;

/// What a field of the parameters holds: a number, or one of a few.
pub(super) trait Value: Sized {
    /// Its number in the table.
    fn to_number(self) -> f32;

    /// The value with this number; `None` where there is none.
    fn from_number(number: f32) -> Option<Self>;
}

impl Value for f32 {
    fn to_number(self) -> f32 {
        self
    }

    fn from_number(number: f32) -> Option<Self> {
        Some(number)
    }
}

const fn least(choices: &[Choice]) -> f32 {
    match choices {
        [first, ..] => first.value,
        [] => 0.0,
    }
}

const fn most(choices: &[Choice]) -> f32 {
    match choices {
        [.., last] => last.value,
        [] => 0.0,
    }
}

/// What every type of a few values has, found by its `ALL` and its `CHOICES`.
macro_rules! one_of_choices {
    ($name:ident) => {
        impl $name {
            pub(super) const MIN: f32 = least(Self::CHOICES);
            pub(super) const MAX: f32 = most(Self::CHOICES);
        }

        impl Value for $name {
            fn to_number(self) -> f32 {
                self.number()
            }

            fn from_number(number: f32) -> Option<Self> {
                let at = Self::CHOICES.iter().position(|choice| choice.is(number))?;
                Self::ALL.get(at).copied()
            }
        }
    };
}

/// Values that code distinguishes: a variant each.
macro_rules! choices {
    ($( $(#[$doc:meta])+ $name:ident { $( $(#[$item_doc:meta])+ $item:ident = $number:literal, $text:literal; )+ } )+) => { $(
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $( $(#[$item_doc])+ $item ),+
        }

        impl $name {
            /// Every one of them, by ascending number.
            pub const ALL: &'static [Self] = &[$( Self::$item ),+];
            pub(super) const CHOICES: &'static [Choice] = &[$( Choice { value: $number, name: $text } ),+];

            /// Its number in the table, in the parameter's unit.
            pub const fn number(self) -> f32 {
                match self { $( Self::$item => $number ),+ }
            }
        }

        one_of_choices!($name);
    )+ };
}

/// Values that code computes with: whole numbers, with names for people or none.
macro_rules! numbers {
    ($( $(#[$doc:meta])+ $name:ident($repr:ident) { $( $number:literal $(= $text:literal)? ),+ $(,)? } )+) => { $(
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $name($repr);

        impl $name {
            /// Every one of them, by ascending number.
            pub const ALL: &'static [Self] = &[$( Self($number) ),+];
            pub(super) const CHOICES: &'static [Choice] =
                &[$( Choice { value: $number as f32, name: concat!($($text)?) } ),+];

            /// Its number in the table, in the parameter's unit.
            pub const fn number(self) -> f32 {
                self.0 as f32
            }
        }

        one_of_choices!($name);
    )+ };
}

choices! {
    /// What the motor controllers understand.
    MotorProtocol {
        /// An eighth of the pulses below, one for each command.
        Oneshot125 = 125.0, "oneshot125";
        /// Digital frames of 150 kbit/s.
        Dshot150 = 150.0, "dshot150";
        /// Digital frames of 300 kbit/s.
        Dshot300 = 300.0, "dshot300";
        /// Pulses of `motor_pulse_min` to `motor_pulse_max`, at most 400 a second.
        Pwm = 400.0, "pwm";
        /// Digital frames of 600 kbit/s.
        Dshot600 = 600.0, "dshot600";
    }

    /// What the receiver speaks.
    RcProtocol {
        /// CRSF: 420 kbaud, 8N1, telemetry back to the pilot on the other line.
        Crsf = 0.0, "crsf";
        /// SBUS: 100 kbaud, 8E2, inverted, no way back.
        Sbus = 1.0, "sbus";
    }

    /// The module of optical flow and range on its line.
    FlowPort {
        /// None: the line stays closed.
        Closed = 0.0, "none";
        /// MSP version 2, 115,200 baud.
        Msp = 1.0, "msp";
    }

    /// Where the x axis of the flow module points, clockwise from above, deg.
    FlowMounting {
        /// Forward.
        Forward = 0.0, "forward";
        /// Right.
        Right = 90.0, "right";
        /// Backward.
        Backward = 180.0, "backward";
        /// Left.
        Left = 270.0, "left";
    }

    /// Clock of the arm sensors' buses, kHz.
    ArmBusSpeed {
        /// 100 kHz.
        Standard = 100.0, "standard";
        /// 400 kHz.
        Fast = 400.0, "fast";
    }

    /// Samples per second of the vehicle's inertial sensor.
    ImuRate {
        /// 1 kHz.
        Hz1000 = 1000.0, "";
        /// 2 kHz.
        Hz2000 = 2000.0, "";
        /// 4 kHz.
        Hz4000 = 4000.0, "";
        /// 8 kHz.
        Hz8000 = 8000.0, "";
    }

    /// Full scale of the gyroscope, deg/s.
    ImuGyroRange {
        /// ±250 deg/s.
        Dps250 = 250.0, "";
        /// ±500 deg/s.
        Dps500 = 500.0, "";
        /// ±1000 deg/s.
        Dps1000 = 1000.0, "";
        /// ±2000 deg/s.
        Dps2000 = 2000.0, "";
    }

    /// How an arm's sensor is mounted.
    ArmSign {
        /// The other way round: its tilt counts the other way.
        Reversed = -1.0, "reversed";
        /// As the drawing has it.
        Along = 1.0, "along";
    }

    /// Servos whose marks have been measured: their digits, ascending.
    ServoMarks {
        /// No servo.
        None = 0.0, "";
        /// Servo 1.
        S1 = 1.0, "";
        /// Servo 2.
        S2 = 2.0, "";
        /// Servo 3.
        S3 = 3.0, "";
        /// Servo 4.
        S4 = 4.0, "";
        /// Servos 1 and 2.
        S12 = 12.0, "";
        /// Servos 1 and 3.
        S13 = 13.0, "";
        /// Servos 1 and 4.
        S14 = 14.0, "";
        /// Servos 2 and 3.
        S23 = 23.0, "";
        /// Servos 2 and 4.
        S24 = 24.0, "";
        /// Servos 3 and 4.
        S34 = 34.0, "";
        /// Servos 1, 2 and 3.
        S123 = 123.0, "";
        /// Servos 1, 2 and 4.
        S124 = 124.0, "";
        /// Servos 1, 3 and 4.
        S134 = 134.0, "";
        /// Servos 2, 3 and 4.
        S234 = 234.0, "";
        /// Servos 1, 2, 3 and 4.
        S1234 = 1234.0, "";
    }

    /// Full scale of the accelerometer, g.
    ImuAccelRange {
        /// ±2 g.
        G2 = 2.0, "";
        /// ±4 g.
        G4 = 4.0, "";
        /// ±8 g.
        G8 = 8.0, "";
        /// ±16 g.
        G16 = 16.0, "";
    }
}

numbers! {
    /// How the vehicle's inertial sensor sits: where the axes of the board's file have the vehicle's nose and belly.
    ImuMounting(u8) {
        0 = "forward_down", 1 = "forward_up", 2 = "forward_right", 3 = "forward_left",
        4 = "back_down", 5 = "back_up", 6 = "back_right", 7 = "back_left",
        8 = "right_down", 9 = "right_up", 10 = "right_forward", 11 = "right_back",
        12 = "left_down", 13 = "left_up", 14 = "left_forward", 15 = "left_back",
        16 = "down_right", 17 = "down_left", 18 = "down_forward", 19 = "down_back",
        20 = "up_right", 21 = "up_left", 22 = "up_forward", 23 = "up_back",
    }

    /// Which rotor hangs at each motor output: the digits, from the left, are the rotors at outputs 1 to 4.
    MotorMap(u16) {
        1234, 1243, 1324, 1342, 1423, 1432,
        2134, 2143, 2314, 2341, 2413, 2431,
        3124, 3142, 3214, 3241, 3412, 3421,
        4123, 4132, 4213, 4231, 4312, 4321,
    }
}

impl ImuMounting {
    /// Nose forward, belly down: as the board's file has them.
    pub const FORWARD_DOWN: Self = Self(0);
}

impl MotorMap {
    /// Rotors 1 to 4 at outputs 1 to 4.
    pub const STRAIGHT: Self = Self(1234);
}

impl ServoMarks {
    /// True where those of `servo` (0 to 3) have been measured.
    // Not inlined: it is asked at the start and at the console alone, and a copy of its divisions is 100 bytes.
    #[inline(never)]
    pub fn has(self, servo: usize) -> bool {
        let mut digits = self.number() as usize;
        while digits > 0 {
            if digits % 10 == servo + 1 {
                return true;
            }
            digits /= 10;
        }
        false
    }

    /// With those of `servo` (0 to 3).
    pub fn with(self, servo: usize) -> Self {
        let has = (0..4).filter(|&other| other == servo || self.has(other));
        let number = has.fold(0, |number, servo| 10 * number + servo + 1);
        Self::from_number(number as f32).unwrap_or(self)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::super::Params;
    use super::*;

    #[test]
    fn choices_ascend_and_each_is_read_back_by_number_and_by_name() {
        let mut enumerated = 0;
        for row in Params::TABLE.iter().filter(|row| !row.choices.is_empty()) {
            enumerated += 1;
            assert!(row.choices.is_sorted_by(|a, b| a.value < b.value), "{}", row.name);
            for choice in row.choices {
                let mut p = Params::default();
                assert!(p.set(row.name, choice.value).is_ok() && p.get(row.name) == Some(choice.value));
                assert_eq!(row.choice(choice.value), Some(choice));
                let named = row.choice_named(choice.name);
                assert_eq!(named, (!choice.name.is_empty()).then_some(choice), "{}", row.name);
                // A name must not be read as a number.
                assert!(choice.name.parse::<f32>().is_err(), "{}", choice.name);
            }
        }
        assert_eq!(enumerated, 15);
    }

    #[test]
    fn a_servos_marks_are_found_in_the_number_and_added_to_it() {
        for &marks in ServoMarks::ALL {
            for servo in 0..4 {
                let digit = char::from_digit(servo as u32 + 1, 10).unwrap();
                let number = std::format!("{}", marks.number());
                assert_eq!(marks.has(servo), number.contains(digit), "{number} {servo}");
                let with = marks.with(servo);
                assert!((0..4).all(|other| with.has(other) == (other == servo || marks.has(other))));
            }
        }
        assert_eq!(ServoMarks::S24.with(0), ServoMarks::S124);
    }

    #[test]
    fn a_number_between_two_choices_is_none() {
        for wrong in [-1.0, 0.4, 0.6, 2.0, f32::NAN, f32::INFINITY] {
            assert_eq!(RcProtocol::from_number(wrong), None, "{wrong}");
        }
        for wrong in [0.0, 124.9, 200.0, 601.0] {
            assert_eq!(MotorProtocol::from_number(wrong), None, "{wrong}");
        }
        assert_eq!(RcProtocol::from_number(-0.0), Some(RcProtocol::Crsf));
        assert_eq!(MotorProtocol::from_number(400.0), Some(MotorProtocol::Pwm));
    }
}
