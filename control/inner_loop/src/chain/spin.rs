//! Test of one motor.

use crate::allocation::wrench::PerArm;

/// Longest spin of a motor, s: enough to see which one turns and in which direction.
pub const SPIN_TIME: f32 = 2.0;
/// Largest drive of a motor under test, share of full drive: 0.34 N of the 8.3 N that a rotor has at most, a fiftieth
/// of the lift-off thrust, should a propeller still be on.
pub const SPIN_DRIVE_MAX: f32 = 0.12;
/// Smallest drive, share of full drive: controllers do not start a motor below it.
pub const SPIN_DRIVE_MIN: f32 = 0.02;
/// Default drive, share of full drive: about that of an idling rotor when armed.
pub const SPIN_DRIVE: f32 = 0.08;
/// One motor at a low drive, the others stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// Index of the rotor, 0 to 3.
    pub rotor: usize,
    /// Share of full drive, at most [`SPIN_DRIVE_MAX`]; raised to the least drive that turns a rotor.
    pub drive: f32,
    /// Search for the least drive that turns the rotor: `drive` is not raised.
    pub probes: bool,
}

impl Spin {
    /// Turns `rotor` at `drive`, or at its controller's least speed if that is faster.
    pub const fn at(rotor: usize, drive: f32) -> Self {
        Self {
            rotor,
            drive,
            probes: false,
        }
    }

    /// Resulting drive if rotors turn from the command `least` on; 0 beyond the limit.
    pub fn drive(&self, least: f32) -> f32 {
        match self.drive {
            drive if drive <= SPIN_DRIVE_MAX && (self.probes || drive > least) => drive,
            drive if drive <= SPIN_DRIVE_MAX => least,
            _ => 0.0,
        }
    }

    /// Motor commands, never beyond the limit, if rotors turn from the command `least` on; all 0 for an invalid rotor
    /// index.
    pub fn commands(&self, least: f32) -> PerArm<f32> {
        let mut commands = [0.0; 4];
        if let Some(command) = commands.get_mut(self.rotor) {
            *command = self.drive(least);
        }
        commands
    }

    /// Its numbers are within their limits.
    pub fn is_allowed(&self) -> bool {
        self.rotor < 4 && (SPIN_DRIVE_MIN..=SPIN_DRIVE_MAX).contains(&self.drive)
    }
}
