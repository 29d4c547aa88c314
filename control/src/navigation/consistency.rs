//! Regression of a measurement on its inertial prediction: rejects one that is mirrored, dead or wrongly scaled.

/// Corner of the high-pass on both, rad/s: at lower frequencies the prediction comes from the measurement itself.
const CUTOFF: f32 = 5.0;
/// Fading window of the regression, s.
const WINDOW: f32 = 3.0;
/// Largest deviation of the scale factor at which it is judged, 1.
const SURE: f32 = 0.15;
/// Accepted scale factors, and the narrower ones at which a rejected measurement is used again.
const BORNE: (f32, f32) = (0.45, 1.7);
const REGAINED: (f32, f32) = (0.6, 1.5);

/// The regression of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Low-passed measurement and prediction.
    slow: [f32; 2],
    /// Sums of measurement times prediction, and of the prediction's square.
    sums: [f32; 2],
    wrong: bool,
}

impl Agreement {
    /// The same verdict with cleared sums: agreement before a perch proves nothing after it.
    pub fn anew(self) -> Self {
        Self {
            wrong: self.wrong,
            ..Self::default()
        }
    }

    /// Takes a measurement and its prediction, `dt` s after the last; `noise` is the measurement's deviation in the
    /// same unit. A pair whose prediction is not `sure` is not judged. True while the measurement disagrees.
    pub fn step(&mut self, measured: f32, predicted: f32, noise: f32, sure: bool, dt: f32) -> bool {
        let [slow_m, slow_p] = &mut self.slow;
        let share = CUTOFF * dt / (1.0 + CUTOFF * dt);
        *slow_m += (measured - *slow_m) * share;
        *slow_p += (predicted - *slow_p) * share;
        if !sure {
            return self.wrong;
        }
        let (m, p) = (measured - *slow_m, predicted - *slow_p);
        let [both, square] = &mut self.sums;
        let keep = 1.0 - dt / (dt + WINDOW);
        *both = *both * keep + m * p;
        *square = *square * keep + p * p;
        // Deviation of the factor: noise over the root of the sum.
        if *square * SURE * SURE >= noise * noise {
            let factor = *both / *square;
            let (least, most) = if self.wrong { REGAINED } else { BORNE };
            self.wrong = !(least..=most).contains(&factor);
        }
        self.wrong
    }
}
