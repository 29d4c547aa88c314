//! Static thrust: one rotor or all four at one drive, propellers on, the vehicle tied down.

use crate::allocation::wrench::PerArm;
use crate::maths::scalar;

/// The rotors that turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotors {
    /// All four.
    All,
    /// One of them, by its index, 0 to 3.
    One(usize),
}

impl Rotors {
    /// The rotor of index `i` turns.
    pub const fn has(self, i: usize) -> bool {
        match self {
            Self::All => i < 4,
            Self::One(rotor) => i == rotor && i < 4,
        }
    }
}

/// Some rotors at one drive, the others stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticThrust {
    /// Those that turn.
    pub rotors: Rotors,
    /// Their drive, share of full drive.
    pub drive: f32,
}

impl StaticThrust {
    /// Motor commands if rotors turn from the command `least` on: the drive, from `least` to 1; all 0 for a drive that is
    /// no number.
    pub fn commands(&self, least: f32) -> PerArm<f32> {
        let command = if self.drive.is_finite() {
            scalar::clamp(self.drive, least, 1.0)
        } else {
            0.0
        };
        core::array::from_fn(|i| if self.rotors.has(i) { command } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chosen_rotors_get_the_drive_from_the_least_to_full() {
        let commands = |rotors, drive| StaticThrust { rotors, drive }.commands(0.07);
        assert_eq!(commands(Rotors::All, 0.6), [0.6; 4]);
        assert_eq!(commands(Rotors::One(2), 0.6), [0.0, 0.0, 0.6, 0.0]);
        assert_eq!(commands(Rotors::One(0), 0.0), [0.07, 0.0, 0.0, 0.0]);
        assert_eq!(commands(Rotors::One(0), 1.7), [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn no_rotor_and_no_number_turn_nothing() {
        let commands = |rotors, drive| StaticThrust { rotors, drive }.commands(0.07);
        assert_eq!(commands(Rotors::One(4), 0.6), [0.0; 4]);
        for drive in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(commands(Rotors::All, drive), [0.0; 4], "{drive}");
        }
    }
}
