//! Allocations for study that no scenario selects.

use sophie_control::allocation::arm_deflection::{Algorithm1, ArmModel};
use sophie_control::allocation::desaturation::Patterns;
use sophie_control::allocation::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use sophie_control::allocation::mixer::{Split, moment_patterns};
use sophie_control::allocation::wrench::{Configuration, PerArm, Wrench, YAW};
use sophie_control::params::Params;
use sophie_sim::mixers::{Law, Situation, WithLimits};

/// An allocation for study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Studied {
    /// Algorithm 1 with sideways thrust in its yaw row: inverse effectiveness at α of the last step's thrust.
    Verbatim,
    /// Quasi-static Jacobian with either sign of its yaw row, as configuration A needs; gives up yaw only at small
    /// authority.
    SignAware,
}

impl Studied {
    /// The allocation for the mixer task, rotors idle.
    pub fn allocation(self, configuration: Configuration, p: &Params) -> WithLimits<StudiedLaw> {
        WithLimits::new(StudiedLaw::new(self, configuration, p), p)
    }
}

/// Yaw authority over k_q at which [`Studied::SignAware`] has none and all: in A it crosses zero during spool-up.
const FADE: (f32, f32) = (0.5, 1.2);

/// The law of a [`Studied`] allocation.
#[derive(Clone, Copy, Debug)]
pub struct StudiedLaw {
    kind: Studied,
    geometry: Geometry,
    algorithm_1: Algorithm1,
    last: PerArm<f32>,
}

impl StudiedLaw {
    fn new(kind: Studied, configuration: Configuration, p: &Params) -> Self {
        Self {
            kind,
            geometry: Geometry::from_params(p, configuration),
            algorithm_1: Algorithm1::new(ArmModel::from_params(p), p.power_exponent),
            last: [p.thrust_idle; 4],
        }
    }

    /// Inverse at Algorithm 1's α; memoryless collective.
    fn verbatim(&self, w: Wrench) -> Split {
        let tilt = self.last.map(|t| self.algorithm_1.angle(t, 1.0));
        let Some(inverse) = Inverse::new(&Effectiveness::frozen(&self.geometry, &tilt)) else {
            return without_moments(w);
        };
        let rest = Wrench {
            thrust: w.thrust,
            ..Wrench::default()
        };
        let patterns = Patterns {
            collective: inverse.solve(Load::of(&self.geometry, rest)),
            ..moment_patterns(&self.geometry, &inverse, w)
        };
        Split { patterns, fade: 1.0 }
    }

    /// Inverse of the Jacobian about the low-passed thrusts, from which the collective continues.
    fn sign_aware(&self, w: Wrench, s: &Situation<'_>) -> Split {
        let (thrusts, tilt) = (s.tilt.thrusts(), s.tilt.tilt());
        let mut e = Effectiveness::quasi_static(&self.geometry, &tilt, &s.tilt.follow());
        let k_q = self.geometry.drag.abs();
        let mean = 0.25 * e.yaw.iter().sum::<f32>();
        let authority = ((mean.abs() / k_q - FADE.0) / (FADE.1 - FADE.0)).clamp(0.0, 1.0);
        let fade = if s.yaw { authority } else { 0.0 };
        let sign = mean.signum();
        for y in &mut e.yaw {
            *y = sign * (sign * *y).max(FADE.0 * k_q);
        }
        let Some(inverse) = Inverse::new(&e) else {
            return without_moments(w);
        };
        let now = self.geometry.wrench(&thrusts, &tilt);
        let rest = Wrench {
            thrust: w.thrust - now.thrust,
            roll: -now.roll,
            pitch: -now.pitch,
            yaw: -now.yaw * authority,
        };
        let mut collective = inverse.solve(Load::of(&self.geometry, rest));
        for (c, thrust) in collective.iter_mut().zip(&thrusts) {
            *c += thrust;
        }
        // Without yaw nothing else corrects the last thrusts' yaw pattern.
        let left = 0.25 * collective.iter().zip(&YAW).map(|(t, y)| t * y).sum::<f32>();
        for (c, y) in collective.iter_mut().zip(&YAW) {
            *c -= (1.0 - fade) * left * y;
        }
        let patterns = Patterns {
            collective,
            ..moment_patterns(&self.geometry, &inverse, w)
        };
        Split { patterns, fade }
    }
}

/// Collective only: the effectiveness is singular.
fn without_moments(w: Wrench) -> Split {
    let patterns = Patterns {
        collective: [0.25 * w.thrust; 4],
        shift: [0.25; 4],
        ..Patterns::default()
    };
    Split { patterns, fade: 0.0 }
}

impl Law for StudiedLaw {
    fn split(&self, w: Wrench, s: &Situation<'_>) -> Split {
        match self.kind {
            Studied::Verbatim => self.verbatim(w),
            Studied::SignAware => self.sign_aware(w, s),
        }
    }

    fn follow(&mut self, thrusts: &PerArm<f32>, _: f32) {
        self.last = *thrusts;
    }
}
