//! Grip and release detector, 100 Hz: whether an arm holds the pipe or is free of it.
//!
//! Stepped by the [gripper](crate::gripper), pressures in Pa, forces along the tendon in N. A late step delays a proof,
//! and with it the rotors' stop.

use crate::allocation::wrench::PerArm;
use crate::gripper::grip_fault::GripFault;
use crate::gripper::grip_geometry::Misfit;
use crate::maths::scalar;
use crate::params::Params;

/// State of the grip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GripState {
    /// All chosen arms together held the pressure for the dwell time with a force below the limit, and are bent as
    /// round a pipe.
    pub proven: bool,
    /// The arms hold the pressure but not a pipe, or close on a pipe that lies across.
    pub misfit: Option<Misfit>,
    /// Every arm is free: no pressure, tendon slack, servo back at release.
    pub released: bool,
    /// Per arm.
    pub arms: PerArm<ArmGrip>,
}

/// Grip of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmGrip {
    /// State of the arm.
    pub state: ArmState,
    /// Contact pressure, Pa.
    pub pressure: f32,
    /// Tendon force, N.
    pub force: f32,
    /// Time from closing until the pressure stayed within tolerance, s.
    pub closure: Option<f32>,
    /// Cause of [`ArmState::Faulty`].
    pub fault: Option<GripFault>,
    /// Bending relative to the parameters, learnt in this closing less than a minute ago; for the next run.
    pub response: Option<f32>,
}

/// State of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArmState {
    /// Tendon slack, no pressure.
    #[default]
    Free,
    /// Tendon winding, no contact yet.
    Closing,
    /// Pressure rising.
    Touching,
    /// Pressure within tolerance for the dwell time, force below the limit.
    Holding,
    /// Force limit reached before the pressure.
    ForceLimited,
    /// Its sensor or IMU failed: the force is held.
    Faulty,
    /// Tendon paying out.
    Releasing,
}

/// Tolerance factor beyond which a proven grip is doubted: the rotors' stop and pushes disturb the pressure, not the
/// grip.
const DOUBT_FACTOR: f32 = 4.0;
/// Largest share of the force limit for a proof.
const FORCE_SHARE_MAX: f32 = 0.98;
/// Time for which an arm must look free, s.
const FREE_DWELL: f32 = 0.1;
/// The same with a failed sensor, s: the arm needs time to spring back.
const FREE_DWELL_BLIND: f32 = 1.0;

/// Demands of a proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GripDemand {
    /// Pressure, Pa.
    pub pressure: f32,
    /// Its tolerance, Pa.
    pub tolerance: f32,
    /// Time within the tolerance, s.
    pub dwell: f32,
    /// Largest force, N.
    pub force: f32,
    /// Pressure below which an arm is free, Pa.
    pub release_pressure: f32,
}

impl GripDemand {
    /// From the parameters, below the force limit `limit` (N).
    pub fn from_params(p: &Params, limit: f32) -> Self {
        Self {
            pressure: p.grip_pressure,
            tolerance: p.grip_tolerance,
            dwell: p.grip_dwell,
            force: FORCE_SHARE_MAX * limit,
            release_pressure: p.release_pressure,
        }
    }
}

/// Proof that one arm holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoldProof {
    elapsed: f32,
    within: f32,
    doubt: f32,
    entered: f32,
    proven: bool,
}

impl HoldProof {
    /// Adds `dt` s at `pressure` (Pa; `None`: unknown) and `force` (N); returns whether the grip is proven. A pressure
    /// unknown or beyond four tolerances for the dwell time revokes the proof.
    pub fn step(&mut self, demand: &GripDemand, pressure: Option<f32>, force: f32, dt: f32) -> bool {
        self.elapsed = scalar::clamp(self.elapsed + dt, 0.0, 1e6);
        let error = pressure.map_or(f32::INFINITY, |p| (p - demand.pressure).abs());
        let good = error <= demand.tolerance && force < demand.force;
        if self.proven {
            // NaN counts as doubt.
            self.doubt = if error <= DOUBT_FACTOR * demand.tolerance {
                0.0
            } else {
                self.doubt + dt
            };
            if self.doubt > demand.dwell {
                self.proven = false;
                self.within = 0.0;
            }
        } else if good {
            if self.within <= 0.0 {
                self.entered = self.elapsed;
            }
            self.within += dt;
            self.proven = self.within >= demand.dwell;
            self.doubt = 0.0;
        } else {
            self.within = 0.0;
        }
        self.proven
    }

    /// Closure time, s; `None` without proof.
    pub fn closure(&self) -> Option<f32> {
        self.proven.then_some(self.entered)
    }
}

/// Proof that one arm is free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeProof {
    free_for: f32,
}

impl FreeProof {
    /// Adds `dt` s at `pressure` (Pa) and the servo's `tension` (N; 0 only at release), `None` where unknown; returns
    /// whether the arm is free.
    pub fn step(
        &mut self,
        demand: &GripDemand,
        pressure: Option<f32>,
        tension: Option<f32>,
        dt: f32,
    ) -> bool {
        let home = tension.is_some_and(|t| t <= 0.0);
        let light = pressure.is_none_or(|p| p < demand.release_pressure);
        self.free_for = if home && light {
            scalar::clamp(self.free_for + dt, 0.0, 10.0)
        } else {
            0.0
        };
        self.proven(pressure.is_some())
    }

    /// True if the arm was free for its dwell time, longer without a `measured` pressure.
    pub fn proven(&self, measured: bool) -> bool {
        self.free_for >= if measured { FREE_DWELL } else { FREE_DWELL_BLIND }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEMAND: GripDemand = GripDemand {
        pressure: 950.0,
        tolerance: 50.0,
        dwell: 0.5,
        force: 160.0,
        release_pressure: 80.0,
    };
    const DT: f32 = 0.01;

    fn run(proof: &mut HoldProof, pressure: Option<f32>, force: f32, seconds: f32) -> bool {
        let mut proven = false;
        for _ in 0..(seconds / DT + 0.5) as u32 {
            proven = proof.step(&DEMAND, pressure, force, DT);
        }
        proven
    }

    #[test]
    fn a_grip_is_proven_by_dwelling_and_closure_is_when_it_came_in_for_good() {
        let mut proof = HoldProof::default();
        assert!(!run(&mut proof, Some(500.0), 60.0, 2.0));
        assert!(!run(&mut proof, Some(980.0), 60.0, 0.3));
        // The first visit does not count.
        assert!(!run(&mut proof, Some(1010.0), 60.0, 0.2));
        assert!(!run(&mut proof, Some(960.0), 60.0, 0.45));
        assert!(proof.closure().is_none());
        assert!(run(&mut proof, Some(960.0), 60.0, 0.1));
        assert!(proof.closure().is_some_and(|c| (c - 2.51).abs() < 0.015));
    }

    #[test]
    fn a_force_at_its_limit_proves_nothing() {
        assert!(!run(&mut HoldProof::default(), Some(950.0), 161.0, 5.0));
        assert!(!run(&mut HoldProof::default(), Some(f32::NAN), 60.0, 5.0));
    }

    #[test]
    fn a_push_is_forgiven_a_lost_pressure_is_not() {
        let mut proof = HoldProof::default();
        assert!(run(&mut proof, Some(950.0), 60.0, 1.0));
        assert!(run(&mut proof, Some(1100.0), 60.0, 5.0));
        assert!(run(&mut proof, Some(100.0), 60.0, 0.4));
        assert!(run(&mut proof, Some(950.0), 60.0, 0.4));
        assert!(!run(&mut proof, Some(100.0), 60.0, 0.6));
        assert!(run(&mut proof, Some(950.0), 60.0, 0.6));
        assert!(!run(&mut proof, None, 60.0, 0.6));
        assert!(!run(&mut proof, None, 60.0, 5.0));
    }

    #[test]
    fn an_arm_is_free_when_light_and_wound_back() {
        let free = |pressure, tension, seconds: f32| {
            let mut proof = FreeProof::default();
            (0..(seconds / DT + 0.5) as u32).fold(false, |_, _| proof.step(&DEMAND, pressure, tension, DT))
        };
        assert!(free(Some(20.0), Some(0.0), 0.2));
        assert!(!free(Some(90.0), Some(0.0), 5.0));
        assert!(!free(Some(0.0), Some(0.5), 5.0));
        assert!(!free(Some(0.0), None, 5.0));
        assert!(!free(Some(f32::NAN), Some(0.0), 5.0));
        assert!(!free(None, Some(0.0), 0.9) && free(None, Some(0.0), 1.1));
    }
}
