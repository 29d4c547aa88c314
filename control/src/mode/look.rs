//! The first look at the arms after power-on: are they closed on something?
//!
//! Nothing that is remembered outlives a loss of power, but the arms do: the servos' gears hold them without a pulse,
//! and the first pulse would open them. So no pulse goes out before the pressure sensors have been looked at.
//!
//! Arms that press are left to the gears ([`GripMemory::HeldByGears`]) until a person opens them or the pilot has the rotors
//! carry the vehicle. Their servos are not taken up before: a pulse must name an angle, and that is known from tilt
//! and pressure no better than to 0.2 rad or 20 N (1 mm of thread, 0.03 rad of tilt, and a skin of unknown
//! stiffness), a third of a grip's force that might be let go of, where doing nothing loses nothing.

use super::Inputs;
use super::hold::held;
use super::logic::{ModeLogic, State};
use crate::grip_memory::GripMemory;
use crate::rc::ArmChoice;
use crate::wrench::PerArm;

/// Time over which the pressures are averaged, s.
pub const LOOK_TIME: f32 = 0.5;

/// Pressures felt since power-on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    time: f32,
    /// Pressure over time of each arm, Pa s, and for how long it was felt, s.
    felt: PerArm<(f32, f32)>,
}

impl Look {
    /// Adds `dt` s with each arm's pressure (Pa; `None`: unknown); gives the arms that press more than `least` Pa once
    /// enough was felt. While no sensor at all speaks, nothing is decided.
    fn step(&mut self, pressure: PerArm<Option<f32>>, least: f32, dt: f32) -> Option<PerArm<bool>> {
        if pressure.iter().all(Option::is_none) {
            return None;
        }
        self.time += dt;
        for ((sum, time), pressure) in self.felt.iter_mut().zip(pressure) {
            if let Some(pressure) = pressure {
                *sum += pressure * dt;
                *time += dt;
            }
        }
        (self.time >= LOOK_TIME).then(|| self.felt.map(|(sum, time)| sum > least * time))
    }
}

/// The pair that presses, or all when not one pair alone does.
fn chosen([front_left, rear_left, front_right, rear_right]: PerArm<bool>) -> Option<ArmChoice> {
    match (front_left || front_right, rear_left || rear_right) {
        (false, false) => None,
        (true, false) => Some(ArmChoice::Front),
        (false, true) => Some(ArmChoice::Rear),
        (true, true) => Some(ArmChoice::All),
    }
}

impl ModeLogic {
    /// Decides once whether the arms were closed when the power came on.
    pub(super) fn look_for_grasp(&mut self, i: &Inputs, dt: f32) {
        let (State::Calibrating { grip_memory } | State::Disarmed { grip_memory }) = &mut self.state else {
            return;
        };
        let (GripMemory::Unknown, Some(grip)) = (*grip_memory, i.grip) else {
            return;
        };
        let mut pressure = [None; 4];
        for ((slot, arm), fault) in pressure.iter_mut().zip(grip.arms).zip(i.fsr_fault) {
            *slot = (!fault && arm.pressure.is_finite()).then_some(arm.pressure);
        }
        if let Some(pressed) = self.look.step(pressure, self.params.release_pressure, dt) {
            *grip_memory = chosen(pressed).map_or(GripMemory::Open, GripMemory::HeldByGears);
        }
    }

    /// The arms of `grip_memory` hold something. Of arms that the gears alone hold only some pressure is asked: a weak servo
    /// has given way to what its friction carries, and still holds.
    pub(super) fn grasps(&self, i: &Inputs, grip_memory: GripMemory) -> bool {
        match grip_memory {
            GripMemory::Controlled(arms) => held(i.grip, arms, &self.params),
            GripMemory::HeldByGears(arms) => i.grip.is_some_and(|grip| {
                let mut arms = grip.arms.iter().zip(arms.mask());
                arms.any(|(arm, chosen)| chosen && arm.pressure > self.params.release_pressure)
            }),
            GripMemory::Open | GripMemory::Unknown => false,
        }
    }
}
