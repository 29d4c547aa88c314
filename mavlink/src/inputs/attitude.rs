//! An attitude that another computer wishes.

use sophie_control::maths::vector::Quat;

use super::{Refusal, rotation};
use crate::dialect::SET_ATTITUDE_TARGET_DATA;

/// Fastest rate that makes sense, rad/s: the gyro's range.
const RATE_MAX: f32 = 35.0;
/// Bits of the mask (ATTITUDE_TARGET_TYPEMASK): roll, pitch and yaw rate are not given.
const NO_RATE: [u8; 3] = [1, 2, 4];
/// The thrust is a vector, which a quadrotor does not give.
const THRUST_VECTOR: u8 = 32;
/// No thrust is given.
const NO_THRUST: u8 = 64;
/// No attitude is given.
const NO_ATTITUDE: u8 = 128;

/// What another computer wishes; `None` where it leaves it open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OffboardAttitude {
    /// From body FRD to NED.
    pub attitude: Option<Quat>,
    /// About the body's axes, rad/s.
    pub rates: [Option<f32>; 3],
    /// Share of full thrust, 0 to 1.
    pub thrust: Option<f32>,
}

impl OffboardAttitude {
    /// What `m` says.
    ///
    /// # Errors
    /// A thrust vector; values that are no numbers or out of bounds, in what is given; nothing given.
    pub fn of(m: &SET_ATTITUDE_TARGET_DATA) -> Result<Self, Refusal> {
        let given = |bit: u8| m.type_mask & bit == 0;
        if !given(THRUST_VECTOR) {
            return Err(Refusal::Frame);
        }
        let attitude = if given(NO_ATTITUDE) {
            Some(rotation(m.q)?.ok_or(Refusal::Value)?)
        } else {
            None
        };
        let mut rates = [m.body_roll_rate, m.body_pitch_rate, m.body_yaw_rate].map(Some);
        for (rate, bit) in rates.iter_mut().zip(NO_RATE) {
            *rate = rate.filter(|_| given(bit));
        }
        let thrust = Some(m.thrust).filter(|_| given(NO_THRUST));
        let sound = rates.iter().flatten().all(|rate| rate.abs() <= RATE_MAX)
            && thrust.is_none_or(|thrust| (0.0..=1.0).contains(&thrust));
        let something = attitude.is_some() || thrust.is_some() || rates.iter().any(Option::is_some);
        let wish = Self {
            attitude,
            rates,
            thrust,
        };
        (sound && something).then_some(wish).ok_or(Refusal::Value)
    }
}
