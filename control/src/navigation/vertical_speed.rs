//! Vertical speed by the inertial sensor since the vehicle stood: an estimate that begins in the air starts with it.

/// Acceleration below which a vehicle that its rotors do not carry rests on something, m/s², and for how long, s: in the air it
/// would fall with at least half of gravity.
const STILL: f32 = 1.0;
const STILL_TIME: f32 = 0.3;
/// Time constant of the bias at rest, s.
const LEARN: f32 = 1.0;
/// Time constant with which it follows an estimate by poses, s.
const FOLLOW: f32 = 4.0;
/// Deviation of the speed at the end of a rest, m/s, and its growth by the bias that turning rotors add, m/s².
const STOOD: f32 = 0.05;
const SHIFTED: f32 = 0.15;
/// Deviation from which on the speed is unknown, m/s: 6 s after a rest.
const UNKNOWN: f32 = 1.0;
/// Deviation of the bias without a rest, m/s² (assumed).
const UNRESTED: f32 = 0.3;

/// Speed down, m/s, and bias of the acceleration down, m/s², with their deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerticalState {
    /// m/s down.
    pub speed: f32,
    /// m/s.
    pub speed_deviation: f32,
    /// m/s².
    pub bias: f32,
    /// m/s².
    pub bias_deviation: f32,
}

impl Default for VerticalState {
    /// Of a vehicle of which nothing is known.
    fn default() -> Self {
        Self {
            speed: 0.0,
            speed_deviation: UNKNOWN,
            bias: 0.0,
            bias_deviation: UNRESTED,
        }
    }
}

/// The speed since the last rest, and the bias at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VerticalSpeed {
    /// Bias of the acceleration down at rest, m/s²; `None` before the first rest.
    bias: Option<f32>,
    /// m/s down.
    speed: f32,
    /// Time for which it has been still, and since it rested, s.
    still: f32,
    moved: f32,
}

impl VerticalSpeed {
    /// One step of `dt` s with the measured acceleration `down`, m/s², gravity removed; the rotors carry a vehicle that
    /// `flies`.
    pub fn step(&mut self, down: f32, flies: bool, dt: f32) {
        let still = !flies && down.abs() < STILL;
        self.still = if still { self.still + dt } else { 0.0 };
        if self.rests() {
            let bias = self.bias.unwrap_or(down);
            self.bias = Some(bias + (down - bias) * dt / (dt + LEARN));
            (self.speed, self.moved) = (0.0, 0.0);
        } else {
            self.speed += (down - self.bias.unwrap_or_default()) * dt;
            self.moved += dt;
        }
    }

    /// Follows the speed of an estimate by poses, m/s, slowly: poses that bend it are found within a second or two.
    pub fn follow(&mut self, speed: f32, dt: f32) {
        self.speed += (speed - self.speed) * dt / (dt + FOLLOW);
    }

    /// Speed down by the inertial sensor, m/s, that has followed the poses with [`FOLLOW`].
    pub fn inertial(&self) -> f32 {
        if self.speed.is_finite() { self.speed } else { 0.0 }
    }

    /// Something carries the vehicle, its rotors do not.
    pub fn rests(&self) -> bool {
        self.still >= STILL_TIME
    }

    /// The present state; without a rest lately the speed may be anything near zero.
    pub fn state(&self) -> VerticalState {
        let unknown = VerticalState::default();
        let Some(bias) = self.bias.filter(|bias| bias.is_finite()) else {
            return unknown;
        };
        let rested = VerticalState {
            bias,
            bias_deviation: SHIFTED,
            ..unknown
        };
        let known_to = STOOD + SHIFTED * self.moved;
        if known_to < UNKNOWN && self.speed.is_finite() {
            VerticalState {
                speed: self.speed,
                speed_deviation: known_to,
                ..rested
            }
        } else {
            rested
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(steps: &[(f32, bool, f32)]) -> VerticalSpeed {
        let mut speed = VerticalSpeed::default();
        for (down, flies, seconds) in steps {
            for _ in 0..(seconds / 0.005) as u32 {
                speed.step(*down, *flies, 0.005);
            }
        }
        speed
    }

    #[test]
    fn it_is_that_since_the_vehicle_stood() {
        // A sensor that shows 0.1 m/s² at rest, and a climb of 0.5 m/s.
        let VerticalState {
            speed,
            speed_deviation,
            ..
        } = after(&[(0.1, false, 3.0), (-0.4, true, 1.0)]).state();
        assert!(
            (speed + 0.5).abs() < 0.02 && speed_deviation < 0.25,
            "{speed} {speed_deviation}"
        );
        // Half a minute later it says nothing, but for the bias.
        let late = after(&[(0.1, false, 3.0), (0.3, true, 30.0)]).state();
        assert!(late.speed == 0.0 && late.speed_deviation >= UNKNOWN);
        assert!((late.bias - 0.1).abs() < 0.01 && late.bias_deviation < UNRESTED);
    }

    #[test]
    fn poses_that_bend_their_speed_for_a_second_bend_it_by_a_quarter() {
        let mut speed = after(&[(0.0, false, 1.0), (0.0, true, 1.0)]);
        (0..200).for_each(|_| speed.follow(1.0, 0.005));
        let bent = speed.inertial();
        assert!((0.15..0.25).contains(&bent), "{bent}");
    }

    #[test]
    fn a_throttle_that_is_closed_in_the_air_is_no_rest() {
        assert!(!after(&[(0.0, false, 1.0), (0.0, true, 2.0), (9.0, false, 1.0)]).rests());
        assert!(after(&[(0.0, false, 1.0)]).rests() && !after(&[(0.0, false, 0.1)]).rests());
        assert_eq!(after(&[(9.0, false, 1.0)]).state(), VerticalState::default());
    }
}
