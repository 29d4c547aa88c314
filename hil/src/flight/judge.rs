//! Judges by the truth what neither the stack nor the pilot can be trusted to say of themselves.

use glam::DVec3;
use sophie_control::mode::Mode;
use sophie_control::wrench::PerArm;

use super::stack::Stack;
use crate::plant::Plant;
use crate::plant::contact::BELLY_Z;
use crate::scenario::{Scenario, Step};

/// Farthest that a gripped vehicle may slip while it is pushed, m.
const SLIP: f64 = 0.03;
/// Largest true pressure on an arm, Pa: the tendons' and the skin's sake.
const PRESSURE_MAX: f64 = 1500.0;
/// Error of the pressure sensor beyond the grip's own tolerance that the truth is granted, Pa (paper).
const SENSOR_ERROR: f64 = 75.0;
/// Time after the rotors stopped in which the pressure may settle, s.
const SETTLE: f64 = 3.0;
/// Rotor thrust that counts as stopped, N.
const STOPPED: f64 = 0.05;
/// Speed at which touching the ground is a crash, m/s.
const CRASH_SPEED: f64 = 2.0;

/// The judge's memory.
pub struct Judge {
    chosen: PerArm<bool>,
    target: f64,
    tolerance: f64,
    hold_start: Option<(f64, DVec3)>,
    last_step: Option<usize>,
}

impl Judge {
    /// A judge of `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            chosen: scenario.arms.mask(),
            target: f64::from(scenario.params.grip_pressure),
            tolerance: f64::from(scenario.params.grip_tolerance),
            hold_start: None,
            last_step: None,
        }
    }

    /// Looks at the truth at `t` s while the pilot is at `step`; gives the reason when the mission failed.
    pub fn step(
        &mut self,
        t: f64,
        step: Option<(usize, &Step)>,
        plant: &Plant,
        stack: &Stack,
    ) -> Option<String> {
        let pose = plant.pose();
        if !pose.position.is_finite() || !pose.omega.is_finite() {
            return Some("the simulation diverged".to_owned());
        }
        if pose.position.z > -BELLY_Z && pose.velocity.z > CRASH_SPEED {
            return Some(format!("crashed into the ground at {:.1} m/s", pose.velocity.z));
        }
        if let Some((arm, pressure)) = worst(plant.pressure()).filter(|(_, p)| *p > PRESSURE_MAX) {
            return Some(format!(
                "pressure on arm {arm} reached {pressure:.0} N/m2, allowed {PRESSURE_MAX:.0}"
            ));
        }

        let index = step.map(|(i, _)| i);
        if index != self.last_step {
            self.last_step = index;
            self.hold_start = None;
        }
        // Without the radio a perched vehicle must hold as well as with it.
        let holds = match step {
            Some((_, Step::Hold { .. })) => true,
            Some((_, Step::RadioOff { .. })) => self.hold_start.is_some() || stack.mode() == Mode::Perched,
            _ => false,
        };
        if !holds {
            return None;
        }
        let (start, place) = *self.hold_start.get_or_insert((t, pose.position));
        if stack.mode() != Mode::Perched {
            return Some(format!(
                "left the perch during the hold: mode {}",
                stack.mode().name()
            ));
        }
        if plant.thrust().iter().any(|thrust| *thrust > STOPPED) && t - start > SETTLE {
            return Some("a rotor turned during the hold".to_owned());
        }
        let slip = (pose.position - place).length();
        if slip > SLIP {
            return Some(format!(
                "slipped {:.0} mm on the pipe, allowed {:.0}",
                slip * 1e3,
                SLIP * 1e3
            ));
        }
        if t - start > SETTLE && plant.push == DVec3::ZERO {
            let allowed = self.tolerance + SENSOR_ERROR;
            for (arm, (pressure, chosen)) in plant.pressure().iter().zip(self.chosen).enumerate() {
                if chosen && (pressure - self.target).abs() > 2.0 * allowed {
                    return Some(format!(
                        "arm {} holds {pressure:.0} N/m2, wanted {:.0} within {:.0}",
                        arm + 1,
                        self.target,
                        2.0 * allowed
                    ));
                }
            }
        }
        None
    }
}

/// The largest of four values with its arm, 1 to 4.
fn worst(values: PerArm<f64>) -> Option<(usize, f64)> {
    values
        .into_iter()
        .enumerate()
        .map(|(i, v)| (i + 1, v))
        .max_by(|a, b| a.1.total_cmp(&b.1))
}
