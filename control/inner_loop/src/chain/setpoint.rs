//! Setpoint of the rotors, from the mode logic.

use crate::allocation::wrench::Wrench;
use crate::chain::spin::Spin;
use crate::chain::static_thrust::StaticThrust;
use crate::maths::vector::Vec3;

/// Wanted action of the rotors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Setpoint {
    /// Stopped.
    #[default]
    Stop,
    /// Idle, controllers reset.
    Idle,
    /// Test of one motor, the others stopped, controllers reset.
    Spin(Spin),
    /// Test of one rotor or all with propellers on, controllers reset.
    StaticThrust(StaticThrust),
    /// Held roll and pitch, yaw rate, collective thrust.
    Angle {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
        /// Yaw rate, rad/s.
        yaw_rate: f32,
        /// Collective thrust, N.
        thrust: f32,
    },
    /// Body rates with a collective thrust.
    Rate {
        /// Body rates, rad/s.
        rate: Vec3,
        /// Collective thrust, N.
        thrust: f32,
    },
    /// A wrench.
    Direct {
        /// The wrench.
        wrench: Wrench,
    },
    /// Leaving the pipe: [`Setpoint::Angle`] with the loops reset.
    Escape {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
        /// Yaw rate, rad/s.
        yaw_rate: f32,
        /// Collective thrust, N.
        thrust: f32,
    },
    /// On the pipe: held roll and pitch without integral action, no yaw.
    Resting {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
        /// Collective thrust, N.
        thrust: f32,
    },
}

impl Setpoint {
    /// True when the rotors turn.
    pub fn spin(self) -> bool {
        self != Self::Stop
    }

    /// Collective thrust, N; 0 when stopped, idle or in a motor test.
    pub fn thrust(self) -> f32 {
        match self {
            Self::Stop | Self::Idle | Self::Spin(_) | Self::StaticThrust(_) => 0.0,
            Self::Angle { thrust, .. }
            | Self::Escape { thrust, .. }
            | Self::Rate { thrust, .. }
            | Self::Resting { thrust, .. } => thrust,
            Self::Direct { wrench } => wrench.thrust,
        }
    }

    /// True if the sum of all numbers, and so each, is finite.
    pub fn is_finite(self) -> bool {
        let sum = match self {
            Self::Stop | Self::Idle => 0.0,
            Self::Spin(spin) => spin.drive,
            Self::StaticThrust(test) => test.drive,
            Self::Angle {
                roll,
                pitch,
                yaw_rate,
                ..
            }
            | Self::Escape {
                roll,
                pitch,
                yaw_rate,
                ..
            } => roll + pitch + yaw_rate,
            Self::Rate { rate, .. } => rate.x + rate.y + rate.z,
            Self::Direct { wrench } => wrench.roll + wrench.pitch + wrench.yaw,
            Self::Resting { roll, pitch, .. } => roll + pitch,
        };
        sum.is_finite() && self.thrust().is_finite()
    }
}

impl Setpoint {
    /// Its numbers in their order, the thrust last, 0 where missing: for comparisons, independent of [`Self::is_finite`].
    pub fn numbers(self) -> [f32; 4] {
        match self {
            Self::Stop | Self::Idle => [0.0; 4],
            Self::Spin(spin) => [spin.drive, 0.0, 0.0, 0.0],
            Self::StaticThrust(test) => [test.drive, 0.0, 0.0, 0.0],
            Self::Angle {
                roll,
                pitch,
                yaw_rate,
                thrust,
            }
            | Self::Escape {
                roll,
                pitch,
                yaw_rate,
                thrust,
            } => [roll, pitch, yaw_rate, thrust],
            Self::Rate { rate, thrust } => [rate.x, rate.y, rate.z, thrust],
            Self::Direct { wrench } => [wrench.roll, wrench.pitch, wrench.yaw, wrench.thrust],
            Self::Resting { roll, pitch, thrust } => [roll, pitch, 0.0, thrust],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each kind with numbers, and how many of the first three it uses; then the thrust.
    fn kinds([a, b, c, thrust]: [f32; 4]) -> [(Setpoint, usize); 5] {
        let angle = Setpoint::Angle {
            roll: a,
            pitch: b,
            yaw_rate: c,
            thrust,
        };
        let escape = Setpoint::Escape {
            roll: a,
            pitch: b,
            yaw_rate: c,
            thrust,
        };
        let rate = Setpoint::Rate {
            rate: Vec3::new(a, b, c),
            thrust,
        };
        let direct = Setpoint::Direct {
            wrench: Wrench {
                thrust,
                roll: a,
                pitch: b,
                yaw: c,
            },
        };
        let resting = Setpoint::Resting {
            roll: a,
            pitch: b,
            thrust,
        };
        [(angle, 3), (escape, 3), (rate, 3), (direct, 3), (resting, 2)]
    }

    #[test]
    fn one_number_that_is_none_spoils_a_setpoint_wherever_it_stands() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for place in 0..4 {
                let mut numbers = [0.1, -0.2, 0.3, 17.7];
                numbers[place] = bad;
                for (setpoint, used) in kinds(numbers) {
                    let spoilt = place < used || place == 3;
                    assert_eq!(setpoint.is_finite(), !spoilt, "{setpoint:?}");
                }
            }
            for (setpoint, _) in kinds([bad, -bad, 0.0, 17.7]) {
                assert!(!setpoint.is_finite(), "{setpoint:?}");
            }
        }
    }

    #[test]
    fn a_setpoint_of_numbers_is_finite_however_large_small_or_opposed_they_are() {
        for numbers in [
            [0.0; 4],
            [-0.6, 0.6, -3.0, 0.0],
            [1e30, 1e30, 1e30, 1e30],
            [-1e30, 1e30, -1e30, 1e30],
            [1e-30; 4],
        ] {
            for (setpoint, _) in kinds(numbers) {
                assert!(setpoint.is_finite(), "{setpoint:?}");
            }
        }
        assert!(Setpoint::Stop.is_finite() && Setpoint::Idle.is_finite());
    }

    #[test]
    fn a_sum_that_overflows_is_no_number_either() {
        // The largest is 3.4e38: any two of these exceed it.
        const LARGE: f32 = 3e38;
        for numbers in [[LARGE, LARGE, 0.0, 1.0], [LARGE, LARGE, LARGE, 1.0]] {
            for (setpoint, _) in kinds(numbers) {
                assert!(!setpoint.is_finite(), "{setpoint:?}");
            }
        }
        for numbers in [[LARGE, 0.0, LARGE, 1.0], [0.0, LARGE, LARGE, 1.0]] {
            for (setpoint, used) in kinds(numbers) {
                assert_eq!(setpoint.is_finite(), used == 2, "{setpoint:?}");
            }
        }
    }

    #[test]
    fn the_thrust_is_the_one_that_was_put_in_and_only_stopped_rotors_stand() {
        for (setpoint, _) in kinds([1.0, 2.0, 3.0, 4.0]) {
            assert!(setpoint.thrust() == 4.0 && setpoint.spin(), "{setpoint:?}");
        }
        assert!(Setpoint::Stop.thrust() == 0.0 && Setpoint::Idle.thrust() == 0.0);
        assert!(!Setpoint::Stop.spin() && Setpoint::Idle.spin());
    }
}
