//! From rotors to motor outputs: the one place where the order of the wires counts.

use crate::allocation::wrench::PerArm;
use crate::params::MotorMap;

impl MotorMap {
    /// The rotor at each output, 0 to 3.
    pub const fn rotors(self) -> PerArm<usize> {
        let digits = self.number() as usize;
        [
            digits / 1000 - 1,
            digits / 100 % 10 - 1,
            digits / 10 % 10 - 1,
            digits % 10 - 1,
        ]
    }

    /// The map with these rotors (0 to 3) at the outputs; `None` where one is missing or named twice.
    pub fn of(rotors: PerArm<usize>) -> Option<Self> {
        Self::ALL.iter().copied().find(|map| map.rotors() == rotors)
    }
}

/// What each output gets, of what each rotor gets.
pub fn at_outputs(rotors: &PerArm<usize>, commands: &PerArm<f32>) -> PerArm<f32> {
    rotors.map(|rotor| commands.get(rotor).copied().unwrap_or(0.0))
}

/// What each rotor gets, of what each output gives: how a vehicle is wired.
pub fn at_rotors(rotors: &PerArm<usize>, outputs: &PerArm<f64>) -> PerArm<f64> {
    let mut drives = [0.0; 4];
    for (rotor, output) in rotors.iter().zip(outputs) {
        if let Some(drive) = drives.get_mut(*rotor) {
            *drive = *output;
        }
    }
    drives
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_map_is_a_permutation_read_back_from_its_rotors() {
        assert_eq!(MotorMap::ALL.len(), 24);
        for map in MotorMap::ALL.iter().copied() {
            let rotors = map.rotors();
            assert!((0..4).all(|rotor| rotors.contains(&rotor)), "{map:?}");
            assert_eq!(MotorMap::of(rotors), Some(map));
            let commands = [0.1, 0.2, 0.3, 0.4];
            let outputs = at_outputs(&rotors, &commands).map(f64::from);
            assert_eq!(at_rotors(&rotors, &outputs), commands.map(f64::from));
        }
        assert_eq!(MotorMap::of([0, 1, 2, 2]), None);
        assert_eq!(MotorMap::of([0, 1, 2, 4]), None);
    }

    #[test]
    fn an_output_gets_what_its_rotor_gets() {
        let commands = [0.1, 0.2, 0.3, 0.4];
        assert_eq!(at_outputs(&MotorMap::STRAIGHT.rotors(), &commands), commands);
        let map = MotorMap::of([1, 2, 0, 3]).unwrap();
        assert_eq!(map.number(), 2314.0);
        assert_eq!(at_outputs(&map.rotors(), &commands), [0.2, 0.3, 0.1, 0.4]);
    }
}
