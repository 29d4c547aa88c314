//! One axis: position, velocity and the bias of the acceleration, as a Kalman filter, and down also the level of a surface
//! from which ranges measure the distance.

use crate::maths::scalar;
use crate::navigation::vertical_speed::VerticalState;

/// Noise of the acceleration, m/s²/√Hz: vibration and what the gusts' moments add to the lean.
pub const LEANING: f32 = 0.06;
/// The same down, where a lean changes little, with range alone (assumed).
pub const DOWN: f32 = 0.02;
/// Walk of its bias, m/s²/√s: the error of the attitude, and the accelerometer's own.
const BIAS_WALK: f32 = 0.01;
/// Deviations at the first fix: m, m/s, m/s².
const START: [f32; 3] = [0.02, 0.5, 0.3];
/// Deviation of the position after a jump of the sender's origin, m.
const JUMPED: f32 = 0.05;
/// Deviations beyond which a fix is refused.
const GATE: f32 = 5.0;
/// Least innovation that is refused, m: a fix has outliers, and its errors are not white.
const GATE_MIN: f32 = 0.15;
/// Least innovation of a velocity that is refused, m/s.
const GATE_SPEED: f32 = 0.4;
/// Bounds of the estimated velocity, m/s, and bias, m/s².
const SPEED_MAX: f32 = 20.0;
const BIAS_MAX: f32 = 1.5;
/// Bounds of the variances, in the square of their units: the covariance stays one in single precision.
const VARIANCE: (f32, f32) = (1e-9, 1e3);

/// Kalman correction at the time of the measurement: position, m, velocity, m/s, and bias, m/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    position: f32,
    velocity: f32,
    bias: f32,
}

impl Change {
    /// Correction of the position `lag` s after the measurement, m.
    pub fn position_after(&self, lag: f32) -> f32 {
        self.position + (self.velocity - 0.5 * self.bias * lag) * lag
    }
}

/// Level of a surface that is known by ranges from this axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Landmark {
    level: f32,
    /// Covariances with position, velocity and bias, and the variance.
    with: [f32; 3],
    variance: f32,
}

/// The filter of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    position: f32,
    velocity: f32,
    bias: f32,
    /// Covariances of position, velocity and bias with the position.
    with_position: [f32; 3],
    /// Variance of the velocity, its covariance with the bias, variance of the bias.
    rest: [f32; 3],
    landmark: Option<Landmark>,
}

impl Axis {
    /// At rest at `position`, m.
    pub fn at(position: f32) -> Self {
        let [p, v, b] = START;
        Self {
            position,
            velocity: 0.0,
            bias: 0.0,
            with_position: [p * p, 0.0, 0.0],
            rest: [v * v, 0.0, b * b],
            landmark: None,
        }
    }

    /// The same filter with the bias that `before` had `since` s ago. The bias is the sensor's own and walks: its
    /// deviation is at least `deviation` m/s² plus the walk since then, and at most that of a new filter.
    pub fn biased_as(self, before: &Self, deviation: f32, since: f32) -> Self {
        let ([vv, vb, most], [_, _, bb]) = (self.rest, before.rest);
        let walked = bb.max(deviation * deviation) + BIAS_WALK * BIAS_WALK * since;
        Self {
            bias: before.bias,
            rest: [vv, vb, walked.min(most)],
            ..self
        }
    }

    /// m.
    pub fn position(&self) -> f32 {
        self.position
    }

    /// m/s.
    pub fn velocity(&self) -> f32 {
        self.velocity
    }

    /// m/s².
    pub fn bias(&self) -> f32 {
        self.bias
    }

    /// Variance of the position, m².
    pub fn position_variance(&self) -> f32 {
        let [pp, ..] = self.with_position;
        pp
    }

    /// The velocity's deviation is below `deviation` m/s.
    pub fn speed_within(&self, deviation: f32) -> bool {
        let [vv, ..] = self.rest;
        vv < deviation * deviation
    }

    /// Predicts by `dt` s with the measured `acceleration` in m/s², its bias included, of this `noise`, m/s²/√Hz.
    pub fn predict(&mut self, acceleration: f32, noise: f32, dt: f32) {
        let a = acceleration - self.bias;
        self.position += (self.velocity + 0.5 * a * dt) * dt;
        self.velocity = scalar::clamp_abs(self.velocity + a * dt, SPEED_MAX);
        let [pp, pv, pb] = self.with_position;
        let [vv, vb, bb] = self.rest;
        let half = 0.5 * dt * dt;
        // F P Fᵀ with F = [1 dt -dt²/2; 0 1 -dt; 0 0 1].
        let (pv1, vv1) = (pv + vv * dt - vb * half, vv - vb * dt);
        let (pb1, vb1) = (pb + vb * dt - bb * half, vb - bb * dt);
        let pp1 = pp + pv * dt - pb * half + pv1 * dt - pb1 * half;
        let (low, high) = VARIANCE;
        self.with_position = [scalar::clamp(pp1, low, high), pv1 - pb1 * dt, pb1];
        self.rest = [
            scalar::clamp(vv1 - vb1 * dt + noise * noise * dt, low, high),
            vb1,
            scalar::clamp(bb + BIAS_WALK * BIAS_WALK * dt, low, BIAS_MAX * BIAS_MAX),
        ];
        if let Some(landmark) = &mut self.landmark {
            let [p, v, b] = landmark.with;
            landmark.with = [p + v * dt - b * half, v - b * dt, b];
        }
    }

    /// True if the `innovation` (m/s) of a velocity with `variance` ((m/s)²) passes the gate.
    pub fn accepts_speed(&self, innovation: f32, variance: f32) -> bool {
        let [vv, ..] = self.rest;
        innovation.abs() <= (GATE * scalar::sqrt(vv + variance)).max(GATE_SPEED)
    }

    /// Fuses a velocity that was measured `lag` s ago: `innovation` in m/s, `variance` in (m/s)², > 0.
    pub fn correct_speed(&mut self, innovation: f32, variance: f32, lag: f32) -> Change {
        self.fuse([0.0, 1.0, lag, 0.0], variance, innovation, lag)
    }

    /// Fuses a measurement `lag` s ago with this `variance`, > 0, and `innovation`. `observed` are its derivatives by the present
    /// position, velocity, bias and landmark: what was then follows from what is now by the axis's own motion.
    fn fuse(&mut self, observed: [f32; 4], variance: f32, innovation: f32, lag: f32) -> Change {
        let [of_p, of_v, of_b, of_level] = observed;
        let [pp, pv, pb] = self.with_position;
        let [vv, vb, bb] = self.rest;
        let Landmark {
            with: [lp, lv, lb],
            variance: ll,
            ..
        } = self.landmark.unwrap_or_default();
        let gain = |p: f32, v: f32, b: f32, level: f32| of_p * p + of_v * v + of_b * b + of_level * level;
        let (p, v) = (gain(pp, pv, pb, lp), gain(pv, vv, vb, lv));
        let (b, level) = (gain(pb, vb, bb, lb), gain(lp, lv, lb, ll));
        let (low, high) = VARIANCE;
        let per = 1.0 / (gain(p, v, b, level).max(low) + variance);
        self.with_position = [
            scalar::clamp(pp - p * p * per, low, high),
            pv - p * v * per,
            pb - p * b * per,
        ];
        self.rest = [
            scalar::clamp(vv - v * v * per, low, high),
            vb - v * b * per,
            scalar::clamp(bb - b * b * per, low, high),
        ];
        if let Some(landmark) = &mut self.landmark {
            landmark.with = [lp - p * level * per, lv - v * level * per, lb - b * level * per];
            landmark.variance = scalar::clamp(ll - level * level * per, low, high);
            landmark.level += level * per * innovation;
        }
        let by = per * innovation;
        self.change([p * by, v * by, b * by], lag)
    }

    /// Marks a surface at `level` m as the landmark: its distance from here was measured with this `variance`, m².
    pub fn mark(&mut self, level: f32, variance: f32) {
        let with = self.with_position;
        let [pp, ..] = with;
        self.landmark = Some(Landmark {
            level,
            with,
            variance: pp + variance,
        });
    }

    /// Moves the landmark to `level` m.
    pub fn move_landmark(&mut self, level: f32) {
        if let Some(landmark) = &mut self.landmark {
            landmark.level = level;
        }
    }

    /// Drops the landmark.
    pub fn forget_landmark(&mut self) {
        self.landmark = None;
    }

    /// Level of the landmark, m.
    pub fn landmark(&self) -> Option<f32> {
        self.landmark.map(|landmark| landmark.level)
    }

    /// Variance of the distance to the landmark, m²; without one that of the position.
    pub fn distance_variance(&self) -> f32 {
        let [pp, ..] = self.with_position;
        let beside = |Landmark {
                          with: [with, ..],
                          variance,
                          ..
                      }| pp - 2.0 * with + variance;
        let (low, high) = VARIANCE;
        scalar::clamp(self.landmark.map_or(pp, beside), low, high)
    }

    /// Fuses the distance to the landmark, measured `lag` s ago: `innovation` is the landmark's level less that of the hit, m,
    /// `variance` in m², > 0. Without a landmark it changes nothing.
    pub fn correct_beside(&mut self, innovation: f32, variance: f32, lag: f32) -> Change {
        if self.landmark.is_none() {
            return Change::default();
        }
        self.fuse(position_then(lag, -1.0), variance, innovation, lag)
    }

    /// Resets the velocity to `velocity` m/s, with the variance that it has at the first fix.
    pub fn set_speed(&mut self, velocity: f32) {
        let [_, v, _] = START;
        self.velocity = velocity;
        let [_, _, bb] = self.rest;
        self.rest = [v * v, 0.0, bb];
        self.uncouple();
    }

    /// Resets the bias to zero; velocity and bias get the variances of the first fix.
    pub fn forget_bias(&mut self) {
        let [_, v, b] = START;
        self.bias = 0.0;
        self.rest = [v * v, 0.0, b * b];
        self.uncouple();
    }

    /// Velocity and bias are known apart from the position.
    fn uncouple(&mut self) {
        let [pp, ..] = self.with_position;
        self.with_position = [pp, 0.0, 0.0];
        if let Some(landmark) = &mut self.landmark {
            let [p, ..] = landmark.with;
            landmark.with = [p, 0.0, 0.0];
        }
    }

    /// Restarts at the present position with the known speed and bias.
    pub fn start(&mut self, known: &VerticalState) {
        let [p, most, _] = START;
        (self.velocity, self.bias) = (known.speed, known.bias);
        self.with_position = [p * p, 0.0, 0.0];
        let square = |x: f32| x * x;
        self.rest = [
            square(known.speed_deviation.min(most)),
            0.0,
            square(known.bias_deviation),
        ];
        self.landmark = None;
    }

    /// The `known` speed and bias, with the axis's own bias if that has the smaller deviation.
    pub fn with_own_bias(&self, known: &VerticalState) -> VerticalState {
        let [_, _, bb] = self.rest;
        let deviation = scalar::sqrt(bb);
        if deviation >= known.bias_deviation {
            return *known;
        }
        VerticalState {
            bias: self.bias,
            bias_deviation: deviation,
            ..*known
        }
    }

    /// True if the `innovation` (m) of a fix with `variance` (m²) passes the gate.
    pub fn accepts(&self, innovation: f32, variance: f32) -> bool {
        let [pp, ..] = self.with_position;
        let limit = GATE * scalar::sqrt(pp + variance);
        innovation.abs() <= limit.max(GATE_MIN)
    }

    /// Fuses a position that was measured `lag` s ago: `innovation` in m, `variance` in m², > 0. The correction is
    /// propagated to now by the axis's own motion, which is linear.
    pub fn correct(&mut self, innovation: f32, variance: f32, lag: f32) -> Change {
        self.fuse(position_then(lag, 0.0), variance, innovation, lag)
    }

    /// Changes the present state, and returns the change of the one `lag` s ago.
    fn change(&mut self, [position, velocity, bias]: [f32; 3], lag: f32) -> Change {
        self.position += position;
        self.velocity = scalar::clamp_abs(self.velocity + velocity, SPEED_MAX);
        self.bias = scalar::clamp_abs(self.bias + bias, BIAS_MAX);
        Change {
            position: position - (velocity + 0.5 * bias * lag) * lag,
            velocity: velocity + bias * lag,
            bias,
        }
    }

    /// Resets position, velocity and bias after a jump of the sender's origin or a turn of its axes.
    pub fn jump(&mut self, position: f32, velocity: f32, bias: f32) {
        (self.position, self.velocity, self.bias) = (position, velocity, bias);
        self.with_position = [JUMPED * JUMPED, 0.0, 0.0];
        self.landmark = None;
    }
}

/// Derivatives of the position `lag` s ago, and `landmark` times the landmark, by the present position, velocity, bias and
/// landmark.
fn position_then(lag: f32, landmark: f32) -> [f32; 4] {
    [1.0, -lag, -0.5 * lag * lag, landmark]
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// An axis that has coasted for a second, so that its position is unsure.
    fn coasted(position: f32) -> Axis {
        let mut axis = Axis::at(position);
        coast(&mut axis, 1.0);
        axis
    }

    fn coast(axis: &mut Axis, seconds: f32) {
        for _ in 0..(seconds * 200.0) as u32 {
            axis.predict(0.0, DOWN, 0.005);
        }
    }

    #[test]
    fn a_landmark_moves_with_the_position_that_it_was_marked_from() {
        let mut axis = coasted(-2.0);
        axis.mark(-1.5, 4e-4);
        assert!(axis.position_variance() > 0.1 && axis.distance_variance() < 5e-4);
        // The ground says that the height is 10 cm off: the landmark was seen from there.
        for _ in 0..10 {
            let off = -1.9 - axis.position();
            axis.correct(off, 4e-4, 0.0);
        }
        assert!((axis.position() + 1.9).abs() < 1e-3);
        assert!(
            axis.landmark().is_some_and(|level| (level + 1.4).abs() < 2e-3),
            "{:?}",
            axis.landmark()
        );
    }

    #[test]
    fn a_distance_moves_position_and_landmark_by_what_each_is_unsure() {
        // Position 1 cm², landmark by 3 cm² more, of its own: of 8 cm the landmark takes its share.
        let mut axis = Axis::at(-2.0);
        axis.with_position = [1e-4, 0.0, 0.0];
        axis.mark(-1.5, 3e-4);
        let change = axis.correct_beside(0.08, 1e-6, 0.0);
        assert!(change.position_after(0.0).abs() < 1e-6 && (axis.position() + 2.0).abs() < 1e-6);
        assert!(
            axis.landmark().is_some_and(|level| (level + 1.58).abs() < 1e-3),
            "{:?}",
            axis.landmark()
        );
        // A distance that is known moves the position if that has coasted since.
        coast(&mut axis, 1.0);
        axis.correct_beside(0.08, 1e-6, 0.0);
        assert!((axis.position() + 1.92).abs() < 1e-3, "{}", axis.position());
        assert!(
            axis.landmark().is_some_and(|level| (level + 1.58).abs() < 1e-3),
            "{:?}",
            axis.landmark()
        );
        // Without one it says nothing.
        axis.forget_landmark();
        let before = axis;
        assert_eq!(axis.correct_beside(0.1, 1e-4, 0.0), Change::default());
        assert_eq!(axis, before);
    }

    #[test]
    fn the_distance_is_as_unsure_as_what_has_happened_since_it_was_measured() {
        let mut axis = coasted(-2.0);
        axis.mark(-1.5, 4e-4);
        // While the speed is known the distance is, however unsure the height.
        axis.rest = [1e-6, 0.0, 1e-6];
        axis.uncouple();
        coast(&mut axis, 0.5);
        let distance = axis.distance_variance();
        assert!(axis.position_variance() > 0.1 && distance < 6e-4, "{distance}");
    }

    /// Whatever is fused, and however often, variances stay such.
    #[test]
    fn no_sequence_of_corrections_makes_a_variance_negative() {
        for lag in [0.0, 0.05, 0.2, 0.4] {
            let mut axis = coasted(-2.0);
            axis.mark(-1.5, 1e-6);
            for i in 0..5_000u32 {
                axis.predict(0.3, DOWN, 0.005);
                let off = 0.01 * (i % 7) as f32 - 0.03;
                match i % 5 {
                    0 => axis.correct(off, 1e-6, lag),
                    1 | 2 => axis.correct_beside(off, 1e-6, lag),
                    3 => axis.correct_speed(off, 1e-4, lag),
                    _ => Change::default(),
                };
                if i % 400 == 0 {
                    axis.mark(axis.position() + 0.5, 1e-6);
                }
                let [vv, vb, bb] = axis.rest;
                let [pp, pv, _] = axis.with_position;
                assert!(pp > 0.0 && vv > 0.0 && bb > 0.0 && axis.distance_variance() > 0.0);
                assert!(
                    pv * pv <= 1.01 * pp * vv + 1e-9 && vb * vb <= 1.01 * vv * bb + 1e-9,
                    "{lag} {i}"
                );
                assert!(axis.position().is_finite() && axis.landmark().is_some_and(f32::is_finite));
            }
        }
    }

    /// Speed and bias of a motion are found by positions however late these come: what was between is not taken for known.
    #[test]
    fn late_positions_give_speed_and_bias() {
        for late in [0u32, 5, 40, 80] {
            let lag = 0.005 * late as f32;
            let truth = |i: u32| {
                let t = 0.005 * i as f32;
                0.4 * t
            };
            let mut axis = Axis::at(0.0);
            let mut past = std::vec![];
            for i in 1..=400u32 {
                axis.predict(0.2, DOWN, 0.005);
                past.push(axis.position());
                if i > late && i % 4 == 0 {
                    let then = (i - late) as usize;
                    let off = truth(i - late) - past[then - 1];
                    let change = axis.correct(off, 4e-4, lag);
                    for (later, position) in past[then - 1..].iter_mut().enumerate() {
                        *position += change.position_after(0.005 * later as f32);
                    }
                    assert!((past[past.len() - 1] - axis.position()).abs() < 1e-5);
                }
            }
            let off = [
                axis.velocity() - 0.4,
                axis.bias() - 0.2,
                axis.position() - truth(400),
            ];
            assert!(off.iter().all(|off| off.abs() < 0.05), "{lag}: {off:?}");
        }
    }
}
