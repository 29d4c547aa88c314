//! Measured arm tilt against the mixer's static model.

use sophie_control::allocation::arm_tilt::TiltModel;
use sophie_control::allocation::wrench::{PerArm, SIDE};
use sophie_control::params::Params;

/// Difference of measurement and model over all arms.
#[derive(Clone, Copy, Debug, Default)]
pub struct TiltError {
    sum: f64,
    count: u64,
    /// Largest difference, rad.
    pub worst: f64,
}

impl TiltError {
    /// Mean magnitude, rad; `None` without flight.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    fn add(&mut self, measured: PerArm<f64>, model: PerArm<f64>) {
        for (measured, model) in measured.into_iter().zip(model) {
            let error = (measured - model).abs();
            self.sum += error;
            self.count += 1;
            self.worst = self.worst.max(error);
        }
    }
}

/// Both tilts, rad, tip up positive, and their difference in flight.
#[derive(Clone, Debug)]
pub struct Tilts {
    model: TiltModel,
    /// Measured tilt.
    pub measured: PerArm<f64>,
    /// Difference.
    pub error: TiltError,
}

impl Tilts {
    /// Arms at rest under `params`.
    #[must_use]
    pub fn new(params: &Params) -> Self {
        Self {
            model: TiltModel::new(params),
            measured: [0.0; 4],
            error: TiltError::default(),
        }
    }

    /// Modelled tilt.
    #[must_use]
    pub fn modelled(&self) -> PerArm<f64> {
        self.model.tilt().map(f64::from)
    }

    /// Adds a millisecond: commanded thrusts (N), gravity at the arms' sensors (arm axes), body roll (rad); `flies`:
    /// arms hang free.
    pub fn step(&mut self, thrusts: &PerArm<f32>, arms: &PerArm<[f64; 3]>, body_roll: f64, flies: bool) {
        self.model.step(thrusts, 1e-3);
        for ((measured, [_, y, z]), side) in self.measured.iter_mut().zip(arms).zip(SIDE) {
            *measured = f64::from(side) * (y.atan2(*z) - body_roll);
        }
        if flies {
            self.error.add(self.measured, self.modelled());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_raised_arm_on_a_rolled_body_is_measured_against_the_model() {
        let params = Params::default();
        let mut tilts = Tilts::new(&params);
        let hover = [4.4_f32; 4];
        for _ in 0..2000 {
            tilts.step(&hover, &[[0.0, 0.0, 9.8]; 4], 0.0, false);
        }
        assert_eq!(tilts.error.mean(), None);
        let model = tilts.modelled()[0];
        let at = |angle: f64| [0.0, 9.8 * angle.sin(), 9.8 * angle.cos()];
        let arms = SIDE.map(|side| {
            let above = if side > 0.0 { 0.1 } else { 0.0 };
            at(0.2 + f64::from(side) * (model + above))
        });
        tilts.step(&hover, &arms, 0.2, true);
        assert!((tilts.measured[0] - model - 0.1).abs() < 1e-3);
        let error = tilts.error;
        assert!((error.worst - 0.1).abs() < 1e-3 && (error.mean().unwrap() - 0.05).abs() < 1e-3);
    }
}
