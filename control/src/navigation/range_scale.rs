//! Monitor of the range's scale: compares its changes with the vertical motion by the inertial sensor.
//!
//! A Kalman filter of height over the surface, its rate and the bias of the measured acceleration runs twice with the
//! same gains: one run takes the range alone, the other the inertial sensor alone. Both are linear, so that a range s
//! times too long leaves the innovation of the first minus s times that of the second, and s is their regression.
//! docs/design/flow-and-range.md has limits and times.

#[cfg(test)]
mod tests;

use super::inertial::STEP_MAX;
use crate::maths::elapsed::seconds;
use crate::maths::scalar;
use crate::navigation::vertical_speed::VerticalState;

/// Noise of the acceleration, m/s²/√Hz, and walk of its bias, m/s²/√s (assumed: ten times that of a quiet sensor).
/// Larger noise shows in the innovations, and divides the evidence.
const ACCEL_NOISE: f32 = 0.015;
const BIAS_WALK: f32 = 0.005;
/// Deviations on a new surface: of the rate, m/s, since an edge disturbs it, and of a learnt bias, m/s².
const START_RATE: f32 = 1.0;
const KEPT_BIAS: f32 = 0.1;
/// Deviation of a range over a plain floor, and over what may be narrow and round, m: 3 cm of a back on which the vehicle
/// drifts for half a second weigh as much, at 50 Hz, as white noise of that size.
const PLAIN: f32 = 0.025;
const NARROW: f32 = 0.14;
/// Acceleration beyond which it is a shock and the filter restarts, m/s².
const SHOCK: f32 = 4.0;
/// Time without a range after which the filter restarts, s.
const GAP: f32 = 0.5;
/// Least height that is used, m: below it the vehicle may stand.
const NEAREST: f32 = 0.1;
/// Innovation that is a step of the surface while the range is rejected, m: no other monitor looks for steps then.
const STEP: f32 = 0.25;
/// Fading window of the regression, s, and the least number of ranges in it.
const WINDOW: f32 = 10.0;
const RANGES_MIN: f32 = 25.0;
/// Square of the deviations by which the scale must differ from one: 3.5.
const DIFFERS: f32 = 12.0;
/// Accepted scales, and the largest that is judged as one: a larger change comes from the ground.
const BORNE: (f32, f32) = (0.8, 1.25);
const MOST: f32 = 4.0;
/// Bounds of the variances, in the square of their units, and the least normalised sum of squared inertial innovations
/// for a verdict.
const LEAST: f32 = 1e-9;
const MOST_VARIANCE: f32 = 1e3;
const INERTIAL_MIN: f32 = 20.0;
/// Scales at which a rejected range is used again, and the least inverse variance of the scale for that: a deviation
/// of 0.15.
const REGAINED: (f32, f32) = (0.85, 1.18);
const SURE: f32 = 44.0;

/// Surface that a range has met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Below {
    /// The same surface as before, a floor.
    Plain,
    /// The same surface as before, which may be narrow and round.
    Narrow,
    /// Another surface, known from before.
    Known,
    /// A new surface.
    New,
}

/// State of one run: height over the surface, m, its rate, m/s, and the bias of the measured downward acceleration,
/// m/s².
type Run = [f32; 3];

/// Climb rate with its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climb {
    /// m/s up.
    pub rate: f32,
    /// Bias of the measured downward acceleration, m/s².
    pub bias: f32,
    /// Variance of the rate, its covariance with the bias, variance of the bias.
    variances: [f32; 3],
}

impl Climb {
    /// Variance of the inertial displacement, m², after `t` s.
    pub fn displacement_variance(&self, t: f32) -> f32 {
        let [rr, rb, bb] = self.variances;
        t * t * (rr + t * (rb + ACCEL_NOISE * ACCEL_NOISE * (1.0 / 3.0) + t * 0.25 * bb))
    }
}

/// The regression, and the filter behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeScale {
    /// Height, climb and bias by the ranges, and by the inertial sensor.
    ranged: Run,
    inertial: Run,
    /// Covariances of the height with height, rate and bias; variance of the rate, its covariance with the bias,
    /// variance of the bias.
    with_height: [f32; 3],
    rest: [f32; 3],
    /// Time of the last step, µs, and age of the covariance, s: it is propagated at ranges only.
    at_us: u64,
    since: f32,
    /// A range was taken since the restart, and one on the present surface.
    begun: bool,
    anchored: bool,
    /// Fading sums of inertial², range × inertial and range² innovations over their variance, and their number.
    sums: [f32; 4],
    wrong: bool,
    /// Known speed and bias before the first range.
    stood: VerticalState,
}

impl RangeScale {
    /// The range is wrongly scaled.
    pub fn wrong(&self) -> bool {
        self.wrong
    }

    /// A range was taken in this flight, and lately.
    pub fn begun(&self) -> bool {
        self.begun
    }

    /// Climb by range and inertial sensor; `None` without a range on the present surface, or while the range is
    /// rejected.
    pub fn climb(&self) -> Option<Climb> {
        let ([_, ranged, ranged_bias], [_, inertial, inertial_bias]) = (self.ranged, self.inertial);
        (self.anchored && !self.wrong).then_some(Climb {
            rate: ranged + inertial,
            bias: ranged_bias + inertial_bias,
            variances: self.rest,
        })
    }

    /// Predicts both runs to `at_us` µs with the measured acceleration `down`, m/s², gravity removed. `None`, while
    /// the vehicle does not fly, restarts the filter, with the speed since it `stood` at the first range.
    pub fn predict(&mut self, at_us: u64, down: Option<f32>, stood: &VerticalState) {
        self.stood = *stood;
        let dt = seconds(self.at_us, at_us);
        self.since += dt;
        let down = down.filter(|a| a.abs() <= SHOCK && dt <= STEP_MAX && self.since <= GAP);
        let Some(down) = down else {
            *self = Self {
                wrong: self.wrong,
                at_us,
                stood: *stood,
                ..Self::default()
            };
            return;
        };
        self.at_us = at_us;
        for (run, down) in [(&mut self.ranged, 0.0), (&mut self.inertial, down)] {
            let [height, rate, bias] = run;
            let up = *bias - down;
            *height += (*rate + 0.5 * up * dt) * dt;
            *rate += up * dt;
        }
    }

    /// Fuses a range by which the centre of mass was `height` m over the surface, `lag` s ago. A height that is not
    /// finite is ignored.
    pub fn update(&mut self, height: f32, lag: f32, below: Below) {
        if !(height + lag).is_finite() {
            return;
        }
        if height < NEAREST {
            self.anchored = false;
            return;
        }
        let dt = core::mem::take(&mut self.since);
        self.carry(dt);
        let then = |[height, rate, _]: Run| height - rate * lag;
        let ranged = height - then(self.ranged);
        let inertial = then(self.inertial);
        // While the range is rejected no other monitor looks for steps.
        let stepped = self.wrong && (ranged - inertial).abs() > STEP;
        if !self.anchored || stepped || matches!(below, Below::Known | Below::New) {
            if stepped || below == Below::New {
                self.sums = [0.0; 4];
            }
            self.anchor(ranged, inertial, below);
            return;
        }
        let noise = deviation(below);
        let [hh, hr, hb] = self.with_height;
        let [rr, rb, bb] = self.rest;
        // Covariances with the height `lag` s ago.
        let gains = [hh - lag * hr, hr - lag * rr, hb - lag * rb];
        let [own, slope, _] = gains;
        let variance = own - lag * slope + noise * noise;
        let per = 1.0 / variance;
        let [h, r, b] = gains;
        self.with_height = [
            scalar::clamp(hh - h * h * per, LEAST, MOST_VARIANCE),
            hr - h * r * per,
            hb - h * b * per,
        ];
        self.rest = [
            scalar::clamp(rr - r * r * per, LEAST, MOST_VARIANCE),
            rb - r * b * per,
            scalar::clamp(bb - b * b * per, LEAST, MOST_VARIANCE),
        ];
        for (run, off) in [(&mut self.ranged, ranged), (&mut self.inertial, -inertial)] {
            for (value, gain) in run.iter_mut().zip(gains) {
                *value += gain * per * off;
            }
        }
        self.judge(
            [
                inertial * inertial * per,
                ranged * inertial * per,
                ranged * ranged * per,
            ],
            dt,
        );
    }

    /// Propagates the covariance by `dt` s.
    fn carry(&mut self, dt: f32) {
        let [hh, hr, hb] = self.with_height;
        let [rr, rb, bb] = self.rest;
        let half = 0.5 * dt * dt;
        let (hr1, rr1) = (hr + rr * dt + rb * half, rr + rb * dt);
        let (hb1, rb1) = (hb + rb * dt + bb * half, rb + bb * dt);
        let hh1 = hh + hr * dt + hb * half + hr1 * dt + hb1 * half;
        self.with_height = [scalar::clamp(hh1, LEAST, MOST_VARIANCE), hr1 + hb1 * dt, hb1];
        self.rest = [
            scalar::clamp(
                rr1 + rb1 * dt + ACCEL_NOISE * ACCEL_NOISE * dt,
                LEAST,
                MOST_VARIANCE,
            ),
            rb1,
            scalar::clamp(bb + BIAS_WALK * BIAS_WALK * dt, LEAST, MOST_VARIANCE),
        ];
    }

    /// Restarts on another surface: the height is that of the range, the rate is unknown, the bias is kept.
    fn anchor(&mut self, ranged: f32, inertial: f32, below: Below) {
        let [_, _, bb] = self.rest;
        let (rate, bias) = if self.begun {
            (START_RATE * START_RATE, bb.max(KEPT_BIAS * KEPT_BIAS))
        } else {
            // The first rate comes from the inertial sensor, not from the range.
            let VerticalState {
                speed,
                speed_deviation,
                bias,
                bias_deviation,
            } = self.stood;
            self.inertial = [0.0, -speed, bias];
            (speed_deviation * speed_deviation, bias_deviation * bias_deviation)
        };
        let noise = deviation(below);
        self.with_height = [noise * noise, 0.0, 0.0];
        self.rest = [rate, 0.0, bias];
        let ([ranged_height, ..], [inertial_height, ..]) = (&mut self.ranged, &mut self.inertial);
        *ranged_height += ranged;
        *inertial_height = if self.begun {
            *inertial_height - inertial
        } else {
            0.0
        };
        (self.begun, self.anchored) = (true, true);
    }

    /// Adds the squares and the product of two innovations over their variance, `dt` s after the last, and judges the
    /// scale.
    fn judge(&mut self, news: [f32; 3], dt: f32) {
        let keep = WINDOW / (WINDOW + dt);
        for (sum, new) in self.sums.iter_mut().zip(news.into_iter().chain([1.0])) {
            *sum = *sum * keep + new;
        }
        let [inertial, both, ranged, count] = self.sums;
        if count < RANGES_MIN || inertial < INERTIAL_MIN {
            return;
        }
        let scale = both / inertial;
        let rough = ((ranged - both * scale) / count).max(1.0);
        // Inverse variance of the scale.
        let known = inertial / rough;
        if self.wrong {
            let (least, most) = REGAINED;
            self.wrong = known < SURE || !(least..=most).contains(&scale);
        } else {
            let (least, most) = BORNE;
            let off = (scale - 1.0) * (scale - 1.0) * known > DIFFERS;
            self.wrong = off && !(least..=most).contains(&scale) && (0.0..=MOST).contains(&scale);
        }
    }
}

/// Deviation of a range, m.
fn deviation(below: Below) -> f32 {
    match below {
        Below::Narrow => NARROW,
        _ => PLAIN,
    }
}
