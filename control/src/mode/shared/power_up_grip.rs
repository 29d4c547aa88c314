//! Power-up grip check: whether the arms are closed on something.
//!
//! A power loss erases the retained state, but the servos' gears keep the arms closed, and the first servo pulse would
//! open them: no pulse is sent until the pressure sensors have been read.
//!
//! Pressed arms stay held by their gears ([`GripMemory::HeldByGears`]) until a person opens them or the pilot lets the
//! rotors carry the vehicle. A pulse would need an angle, known only to 0.2 rad or 20 N (1 mm of thread, 0.03 rad of
//! tilt, unknown stiffness of the skin): a wrong one might lose a third of a grip's force.

use crate::allocation::wrench::PerArm;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::inputs::Inputs;
use crate::params::Params;
use crate::pilot::rc::ArmChoice;

/// Averaging time of the pressures, s.
pub const AVERAGING_TIME: f32 = 0.5;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct PressureMean {
    /// Integral, Pa s.
    sum: f32,
    /// Duration, s.
    time: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PowerUpGripCheck {
    time: f32,
    mean: PerArm<PressureMean>,
}

impl PowerUpGripCheck {
    /// Adds `dt` s of each arm's pressure (Pa; `None`: unknown); returns the arms above `least` Pa on average, or
    /// `None` while undecided.
    fn step(&mut self, pressure: PerArm<Option<f32>>, least: f32, dt: f32) -> Option<PerArm<bool>> {
        if pressure.iter().all(Option::is_none) {
            return None;
        }
        self.time += dt;
        for (mean, pressure) in self.mean.iter_mut().zip(pressure) {
            if let Some(pressure) = pressure {
                mean.sum += pressure * dt;
                mean.time += dt;
            }
        }
        (self.time >= AVERAGING_TIME).then(|| self.mean.map(|mean| mean.sum > least * mean.time))
    }
}

fn chosen([front_left, rear_left, front_right, rear_right]: PerArm<bool>) -> Option<ArmChoice> {
    match (front_left || front_right, rear_left || rear_right) {
        (false, false) => None,
        (true, false) => Some(ArmChoice::Front),
        (false, true) => Some(ArmChoice::Rear),
        (true, true) => Some(ArmChoice::All),
    }
}

impl PowerUpGripCheck {
    /// Decides once, at rest.
    pub fn decide(&mut self, grip_memory: GripMemory, i: &Inputs, p: &Params, dt: f32) -> GripMemory {
        let (GripMemory::Unknown, Some(grip)) = (grip_memory, i.grip) else {
            return grip_memory;
        };
        let mut pressure = [None; 4];
        for ((slot, arm), fault) in pressure.iter_mut().zip(grip.arms).zip(i.fsr_fault) {
            *slot = (!fault && arm.pressure.is_finite()).then_some(arm.pressure);
        }
        match self.step(pressure, p.release_pressure, dt) {
            Some(pressed) => chosen(pressed).map_or(GripMemory::Open, GripMemory::HeldByGears),
            None => grip_memory,
        }
    }
}
