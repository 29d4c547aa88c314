//! Whether a measurement follows what the inertial sensor says: a mirrored, dead or wrongly scaled one does not.

/// Slow changes are left out below this, rad/s: there the measurement itself has made the prediction.
const CUTOFF: f32 = 5.0;
/// Time over which it is judged, s.
const WINDOW: f32 = 3.0;
/// Deviation of the factor with which it is judged, 1.
const SURE: f32 = 0.15;
/// Factors that are tolerated, and the narrower ones within which a measurement is used again.
const BORNE: (f32, f32) = (0.45, 1.7);
const REGAINED: (f32, f32) = (0.6, 1.5);

/// The regression of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Slow parts of measurement and prediction.
    slow: [f32; 2],
    /// Sums of measurement times prediction, and of the prediction's square.
    sums: [f32; 2],
    wrong: bool,
}

impl Agreement {
    /// The same judgement, with nothing behind it: what has followed before a perch may not after it.
    pub fn anew(self) -> Self {
        Self {
            wrong: self.wrong,
            ..Self::default()
        }
    }

    /// Takes a measurement and its prediction, `dt` s after the last; `noise` is the measurement's deviation in the same
    /// unit. One whose prediction is not `sure` says nothing. True while it does not follow.
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
