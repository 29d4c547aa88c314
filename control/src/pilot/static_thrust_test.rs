//! Static thrust test: rotors with propellers on at a commanded drive, the vehicle tied down on a scale. Steady, or a train
//! of steps between two drives, for the motors' lag.

pub use crate::chain::static_thrust::{Rotors, StaticThrust};
use crate::maths::scalar;

/// Rise of the drive at the start, share of full drive a second: hands and scale see what begins.
pub const RAMP: f32 = 0.5;
/// Least drive, share of full drive: less holds no steady speed.
pub const DRIVE_MIN: f32 = 0.05;
/// Largest drive, share of full drive.
pub const DRIVE_MAX: f32 = 1.0;
/// Default time at a steady drive, s: the voltage settles within one, a scale within two.
pub const PLATEAU: f32 = 5.0;
/// Longest time at a steady drive, s: motors at full drive get hot beyond.
pub const PLATEAU_MAX: f32 = 10.0;
/// Default time at each drive of a train, s: ten time constants of a slow rotor.
pub const STEP_PLATEAU: f32 = 1.0;
/// Longest time at each drive of a train, s.
pub const STEP_PLATEAU_MAX: f32 = 2.0;
/// Shortest time at a drive, s.
pub const PLATEAU_MIN: f32 = 0.5;
/// Pairs of steps in a train, up and down.
pub const STEPS: u32 = 5;
/// Largest step, share of full drive: what holds the vehicle takes the jolt.
pub const STEP_MAX: f32 = 0.5;

/// A static thrust test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticThrustTest {
    /// Rotors that turn.
    pub rotors: Rotors,
    /// Drive, share of full drive; of a train the one that it begins and ends with.
    pub drive: f32,
    /// The other drive of a train, share of full drive; `None`: steady.
    pub step_to: Option<f32>,
    /// Time at each drive, s.
    pub plateau: f32,
}

impl StaticThrustTest {
    /// Steady at `drive` for the default time.
    pub const fn steady(rotors: Rotors, drive: f32) -> Self {
        Self {
            rotors,
            drive,
            step_to: None,
            plateau: PLATEAU,
        }
    }

    /// A train of steps between two drives, each for the default time.
    pub const fn train(rotors: Rotors, drive: f32, step_to: f32) -> Self {
        Self {
            rotors,
            drive,
            step_to: Some(step_to),
            plateau: STEP_PLATEAU,
        }
    }

    /// Its numbers are within their limits.
    pub fn is_allowed(&self) -> bool {
        let drives = DRIVE_MIN..=DRIVE_MAX;
        let rotor = !matches!(self.rotors, Rotors::One(rotor) if rotor >= 4);
        let (most, step) = match self.step_to {
            Some(to) => {
                let small = (to - self.drive).abs() <= STEP_MAX + f32::EPSILON;
                (STEP_PLATEAU_MAX, drives.contains(&to) && small)
            }
            None => (PLATEAU_MAX, true),
        };
        rotor && step && drives.contains(&self.drive) && (PLATEAU_MIN..=most).contains(&self.plateau)
    }

    /// Time of the rise to the first drive, s.
    pub fn rise(&self) -> f32 {
        self.drive / RAMP
    }

    /// Its whole time, s.
    pub fn longest(&self) -> f32 {
        let holds = if self.step_to.is_some() { 1 + 2 * STEPS } else { 1 };
        self.rise() + self.plateau * holds as f32
    }

    /// What the rotors do `time` s after the start.
    pub fn at(&self, time: f32) -> StaticThrust {
        let held = time - self.rise();
        let drive = match self.step_to {
            _ if held < 0.0 => RAMP * time,
            Some(to) if (held / self.plateau) as u32 % 2 == 1 => to,
            _ => self.drive,
        };
        StaticThrust {
            rotors: self.rotors,
            drive: scalar::clamp(drive, 0.0, DRIVE_MAX),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_rises_at_its_rate_and_then_stands() {
        let test = StaticThrustTest::steady(Rotors::All, 0.8);
        for (time, drive) in [(0.0, 0.0), (0.4, 0.2), (1.6, 0.8), (6.5, 0.8)] {
            assert!((test.at(time).drive - drive).abs() < 1e-6, "{time}");
        }
        assert!((test.longest() - 6.6).abs() < 1e-6);
    }

    #[test]
    fn a_train_steps_five_times_up_and_down() {
        let test = StaticThrustTest::train(Rotors::All, 0.3, 0.6);
        assert!((test.longest() - 11.6).abs() < 1e-5);
        let (mut up, mut down, mut last) = (0, 0, test.at(0.0).drive);
        for i in 1..1160 {
            let drive = test.at(i as f32 * 0.01).drive;
            if drive - last > 0.1 {
                up += 1;
            }
            if last - drive > 0.1 {
                down += 1;
            }
            last = drive;
        }
        assert_eq!((up, down), (STEPS, STEPS));
        assert!((last - 0.3).abs() < 1e-6, "it ends at its first drive: {last}");
    }

    #[test]
    fn numbers_beyond_the_limits_are_not_allowed() {
        let steady = StaticThrustTest::steady(Rotors::One(3), 1.0);
        let train = StaticThrustTest::train(Rotors::All, 0.3, 0.6);
        assert!(steady.is_allowed() && train.is_allowed());
        for drive in [0.0, 0.04, 1.01, -0.5, f32::NAN, f32::INFINITY] {
            assert!(!StaticThrustTest { drive, ..steady }.is_allowed(), "{drive}");
            let step_to = Some(drive);
            assert!(!StaticThrustTest { step_to, ..train }.is_allowed(), "{drive}");
        }
        for plateau in [0.0, 0.4, 10.1, f32::NAN] {
            assert!(!StaticThrustTest { plateau, ..steady }.is_allowed(), "{plateau}");
        }
        assert!(
            !StaticThrustTest {
                plateau: 2.5,
                ..train
            }
            .is_allowed()
        );
        assert!(!StaticThrustTest::train(Rotors::All, 0.3, 0.9).is_allowed());
        assert!(!StaticThrustTest::steady(Rotors::One(4), 0.5).is_allowed());
    }
}
