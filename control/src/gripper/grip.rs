//! Grip and release detector, 100 Hz: whether an arm holds the pipe or is free of it.
//!
//! Stepped by the [gripper](crate::gripper), pressures in Pa, forces along the tendon in N. A late step delays a proof,
//! and with it the rotors' stop.

use crate::allocation::wrench::PerArm;
use crate::gripper::grip_fault::GripFault;
use crate::gripper::grip_geometry::Misfit;
use crate::maths::filter::CascadedLowPass;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar;
use crate::params::Params;

/// State of the grip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GripState {
    /// All chosen arms hold, once settled together for the dwell time, and are bent as round a pipe.
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
    /// Time from closing until the mean pressure came within the tolerance for good, s; `None` without proof.
    pub closure: Option<f32>,
    /// Cause of [`ArmState::Faulty`].
    pub fault: Option<GripFault>,
    /// Bending by the reel's way relative to the parameters, learnt in this closing.
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
    /// Was settled at the grip pressure for the dwell time, and presses with [`HELD_SHARE`] of it at least.
    Holding,
    /// Force limit reached before the pressure.
    ForceLimited,
    /// Its sensor or IMU failed: the force is held.
    Faulty,
    /// Tendon paying out.
    Releasing,
}

/// Share of the grip pressure above which an arm holds: as the rotors stop the load moves onto the arms, and pushes
/// change every pressure. Grips of 0.3 still held twice the mission's push (docs/design/contact.md); a sensor may read
/// a fifth too much.
pub const HELD_SHARE: f32 = 0.6;
/// Averaging of a pressure, rad/s: a pipe that vibrates, 5 Hz and faster, moves the mean by an eighth of what it moves
/// the pressure.
const MEAN_CUTOFF: f32 = 4.0;
/// Largest rate of a settled pressure, share of the grip pressure per second: from the low end of the tolerance,
/// 0.85, it does not reach [`HELD_SHARE`] in the 3 s in which the rotors stop.
const SETTLED_RATE: f32 = 0.08;
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
    /// Largest error of the mean pressure at the proof, Pa.
    pub tolerance: f32,
    /// Largest rate of the mean pressure at the proof, Pa/s.
    pub rate: f32,
    /// Pressure above which a proven arm holds, Pa.
    pub held: f32,
    /// Time for which the pressure must be settled, and after which a lower one counts as lost, s.
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
            rate: SETTLED_RATE * p.grip_pressure,
            held: HELD_SHARE * p.grip_pressure,
            dwell: p.grip_dwell,
            force: FORCE_SHARE_MAX * limit,
            release_pressure: p.release_pressure,
        }
    }
}

/// Proof that one arm holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GripProof {
    elapsed: f32,
    mean: Option<CascadedLowPass>,
    within: HoldTimer,
    settled: HoldTimer,
    /// The pressure says otherwise than [`Self::holds`].
    contrary: HoldTimer,
    /// Closure time of the first proof, s.
    closure: Option<f32>,
    holds: bool,
}

impl GripProof {
    /// Adds `dt` s at `pressure` (Pa; `None`: unknown) and `force` (N); returns whether the arm holds. It is proven by
    /// a mean pressure that stays within the tolerance and hardly changes for the dwell time, below the largest force; a
    /// pressure below that of a hold, or unknown, for the dwell time revokes the proof, and one above it gives it back.
    pub fn step(&mut self, demand: &GripDemand, pressure: Option<f32>, force: f32, dt: f32) -> bool {
        self.elapsed = scalar::clamp(self.elapsed + dt, 0.0, 1e6);
        let pressure = pressure.filter(|p| p.is_finite());
        let mean = pressure.map(|p| {
            let mean = self.mean.get_or_insert(CascadedLowPass::at(p));
            mean.step(p, MEAN_CUTOFF, dt);
            *mean
        });
        // The first low pass, of which the second shows the rate.
        let within = mean.is_some_and(|m| (m.value() + m.lead() - demand.pressure).abs() <= demand.tolerance);
        let slow = mean.is_some_and(|m| (m.lead() * MEAN_CUTOFF).abs() <= demand.rate);
        self.within.step(within, dt);
        self.settled.step(within && slow && force < demand.force, dt);
        let firm = mean.is_some_and(|m| m.value() + m.lead() >= demand.held);
        if self.closure.is_none() && self.settled(demand) {
            self.closure = Some(self.elapsed - self.within.time());
            self.holds = true;
        }
        if self.closure.is_some() && self.contrary.step(firm != self.holds, dt) > demand.dwell {
            self.holds = firm;
        }
        self.holds
    }

    /// The pressure is settled at present, and has been for the dwell time.
    pub fn settled(&self, demand: &GripDemand) -> bool {
        self.settled.time() >= demand.dwell
    }

    /// Closure time, s; `None` without proof.
    pub fn closure(&self) -> Option<f32> {
        self.closure.filter(|_| self.holds)
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
        tolerance: 142.0,
        rate: 76.0,
        held: 570.0,
        dwell: 0.5,
        force: 160.0,
        release_pressure: 80.0,
    };
    const DT: f32 = 0.01;

    /// Runs `seconds` at the pressure of each time.
    fn along(proof: &mut GripProof, pressure: impl Fn(f32) -> f32, seconds: f32) -> bool {
        let mut holds = false;
        for step in 0..(seconds / DT + 0.5) as u32 {
            holds = proof.step(&DEMAND, Some(pressure(step as f32 * DT)), 60.0, DT);
        }
        holds
    }

    fn run(proof: &mut GripProof, pressure: Option<f32>, force: f32, seconds: f32) -> bool {
        let mut holds = false;
        for _ in 0..(seconds / DT + 0.5) as u32 {
            holds = proof.step(&DEMAND, pressure, force, DT);
        }
        holds
    }

    /// From 500 Pa the first low pass is within 142 Pa of 950 after 0.25 s ln(450/142) = 0.29 s; t after the step it
    /// changes by 450 · 16 t exp(-4 t) Pa/s, less than 76 from 1.18 s on.
    #[test]
    fn a_grip_is_proven_once_settled_and_closure_is_when_it_came_in_for_good() {
        let mut proof = GripProof::default();
        assert!(!run(&mut proof, Some(500.0), 60.0, 2.0));
        assert!(!run(&mut proof, Some(950.0), 60.0, 0.5));
        // The first visit does not count.
        assert!(!run(&mut proof, Some(500.0), 60.0, 2.0));
        assert!(!run(&mut proof, Some(950.0), 60.0, 1.6));
        assert!(proof.closure().is_none());
        assert!(run(&mut proof, Some(950.0), 60.0, 0.2));
        let closure = proof.closure().unwrap();
        assert!((closure - 4.8).abs() < 0.03, "{closure}");
    }

    /// A pipe that vibrates by 0.1 mm moves the simulated pressure by 50 Pa where the body follows it, by 110 Pa at 17 Hz.
    #[test]
    fn a_pipe_that_vibrates_delays_no_proof() {
        for (hz, by) in [(5.0, 100.0), (8.0, 150.0), (17.0, 200.0), (25.0, 200.0)] {
            for middle in [860.0, 950.0, 1040.0] {
                let shaken = |t: f32| middle + by * (core::f32::consts::TAU * hz * t).sin();
                assert!(
                    along(&mut GripProof::default(), shaken, 1.5),
                    "{hz} Hz, {middle} Pa"
                );
            }
        }
    }

    #[test]
    fn a_pressure_that_passes_through_proves_nothing() {
        for rate in [-400.0, -100.0, 100.0, 400.0] {
            let passing = |t: f32| 950.0 + rate * (t - 2.0);
            let proof = &mut GripProof::default();
            for end in [1.0, 2.0, 3.0, 4.0] {
                assert!(!along(proof, |t| passing(t + end - 1.0), 1.0), "{rate} Pa/s");
            }
        }
        for (middle, proven) in [(790.0, false), (830.0, true), (1070.0, true), (1110.0, false)] {
            assert!(run(&mut GripProof::default(), Some(middle), 60.0, 2.0) == proven);
        }
    }

    #[test]
    fn a_force_at_its_limit_proves_nothing() {
        assert!(!run(&mut GripProof::default(), Some(950.0), 161.0, 5.0));
        assert!(!run(&mut GripProof::default(), Some(f32::NAN), 60.0, 5.0));
    }

    /// As the rotors stop, a tendon that rubs in its channel leaves half as much again for seconds.
    #[test]
    fn more_pressure_is_no_doubt_and_less_is_forgiven_once_it_is_back() {
        let mut proof = GripProof::default();
        assert!(run(&mut proof, Some(950.0), 60.0, 2.0));
        assert!(run(&mut proof, Some(1500.0), 60.0, 5.0));
        assert!(run(&mut proof, Some(650.0), 60.0, 5.0));
        assert!(run(&mut proof, Some(100.0), 60.0, 0.3));
        assert!(run(&mut proof, Some(950.0), 60.0, 0.4));
        assert!(!run(&mut proof, Some(300.0), 60.0, 1.5));
        assert!(run(&mut proof, Some(650.0), 60.0, 2.0));
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
