//! One axis: position, velocity and the bias of the acceleration, as a Kalman filter.

use crate::maths::scalar;

/// Noise of the acceleration, m/s²/√Hz: vibration and what the gusts' moments add.
const ACCEL_NOISE: f32 = 0.06;
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

    /// Predicts by `dt` s with the measured `acceleration` in m/s², its bias included.
    pub fn predict(&mut self, acceleration: f32, dt: f32) {
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
            scalar::clamp(vv1 - vb1 * dt + ACCEL_NOISE * ACCEL_NOISE * dt, low, high),
            vb1,
            scalar::clamp(bb + BIAS_WALK * BIAS_WALK * dt, low, BIAS_MAX * BIAS_MAX),
        ];
    }

    /// True if the `innovation` (m/s) of a velocity with `variance` ((m/s)²) passes the gate.
    pub fn accepts_speed(&self, innovation: f32, variance: f32) -> bool {
        let [vv, ..] = self.rest;
        innovation.abs() <= (GATE * scalar::sqrt(vv + variance)).max(GATE_SPEED)
    }

    /// Fuses a velocity that was measured `lag` s ago: `innovation` in m/s, `variance` in (m/s)², > 0.
    pub fn correct_speed(&mut self, innovation: f32, variance: f32, lag: f32) -> Change {
        let [pp, pv, pb] = self.with_position;
        let [vv, vb, bb] = self.rest;
        let per = 1.0 / (vv + variance);
        let (low, high) = VARIANCE;
        let left = variance * per;
        self.with_position = [
            scalar::clamp(pp - pv * pv * per, low, high),
            pv * left,
            pb - pv * vb * per,
        ];
        self.rest = [
            scalar::clamp(vv * left, low, high),
            vb * left,
            scalar::clamp(bb - vb * vb * per, low, high),
        ];
        self.change(
            Change {
                position: pv * per * innovation,
                velocity: vv * per * innovation,
                bias: vb * per * innovation,
            },
            lag,
        )
    }

    /// Resets the velocity to `velocity` m/s, with the variance that it has at the first fix.
    pub fn set_speed(&mut self, velocity: f32) {
        let [_, v, _] = START;
        self.velocity = velocity;
        let [_, _, bb] = self.rest;
        let [pp, ..] = self.with_position;
        self.with_position = [pp, 0.0, 0.0];
        self.rest = [v * v, 0.0, bb];
    }

    /// Resets the bias to zero; velocity and bias get the variances of the first fix.
    pub fn forget_bias(&mut self) {
        let [_, v, b] = START;
        self.bias = 0.0;
        self.rest = [v * v, 0.0, b * b];
        let [pp, ..] = self.with_position;
        self.with_position = [pp, 0.0, 0.0];
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
        let [pp, pv, pb] = self.with_position;
        let [vv, vb, bb] = self.rest;
        let per = 1.0 / (pp + variance);
        let change = Change {
            position: pp * per * innovation,
            velocity: pv * per * innovation,
            bias: pb * per * innovation,
        };
        let (low, high) = VARIANCE;
        let left = variance * per;
        self.with_position = [scalar::clamp(pp * left, low, high), pv * left, pb * left];
        self.rest = [
            scalar::clamp(vv - pv * pv * per, low, high),
            vb - pv * pb * per,
            scalar::clamp(bb - pb * pb * per, low, high),
        ];
        self.change(change, lag)
    }

    fn change(&mut self, change: Change, lag: f32) -> Change {
        self.position += change.position_after(lag);
        let velocity = self.velocity + change.velocity - change.bias * lag;
        self.velocity = scalar::clamp_abs(velocity, SPEED_MAX);
        self.bias = scalar::clamp_abs(self.bias + change.bias, BIAS_MAX);
        change
    }

    /// Resets position, velocity and bias after a jump of the sender's origin or a turn of its axes.
    pub fn jump(&mut self, position: f32, velocity: f32, bias: f32) {
        (self.position, self.velocity, self.bias) = (position, velocity, bias);
        self.with_position = [JUMPED * JUMPED, 0.0, 0.0];
    }
}
