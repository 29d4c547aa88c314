//! A builder's hands and eyes at a vehicle on the table: how it is turned, what is bent and pressed, which wires are
//! where, and what turns.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{DQuat, DVec3};
use sophie_control::calibration::Face;
use sophie_control::motor_map::at_rotors;
use sophie_control::params::MotorMap;
use sophie_control::rc::Sticks;
use sophie_control::wrench::PerArm;
use sophie_sim::crsf;
use sophie_sim::plant::Plant;

use crate::wires::Pins;

/// How fast hands turn a vehicle, rad/s: a quarter turn in half a second.
const TURN: f64 = 3.0;
/// Time of a step, s, and between two frames of the transmitter, ms.
const STEP: f64 = 1e-3;
const FRAME_MS: u64 = 20;
/// Slowest rotor that is seen to turn, rad/s.
const TURNS: f64 = 20.0;

/// What hands do.
#[derive(Clone, Debug)]
pub struct Held {
    /// The side that lies below; the vehicle is turned there.
    pub below: Face,
    /// On each pad, Pa.
    pub pressed: PerArm<f64>,
    /// Each arm's tip up, beyond where it hangs, rad.
    pub bent: PerArm<f64>,
    /// Above the table, m.
    pub height: f64,
    /// Of a transmitter on CRSF; `None`: it is off.
    pub sticks: Option<Sticks>,
    /// The rotors that the outputs' wires lead to.
    pub wiring: MotorMap,
}

/// What eyes see, and a multimeter.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Time since power-on, ms.
    pub ms: u64,
    /// The rotor that turned last, 0 to 3.
    pub turned: Option<usize>,
    /// Rotors, rad/s.
    pub rotors: PerArm<f64>,
    /// At the battery's plug, V.
    pub volts: f64,
    /// Servo pulses, µs.
    pub servos: PerArm<f64>,
}

struct Table {
    held: Held,
    seen: Seen,
}

/// Shared by the builder and the board.
#[derive(Clone)]
pub struct Hands {
    table: Arc<Mutex<Table>>,
    attitude: DQuat,
}

impl Default for Hands {
    fn default() -> Self {
        let held = Held {
            below: Face::Belly,
            pressed: [0.0; 4],
            bent: [0.0; 4],
            height: 0.0,
            sticks: None,
            wiring: MotorMap::STRAIGHT,
        };
        let seen = Seen::default();
        Self {
            table: Arc::new(Mutex::new(Table { held, seen })),
            attitude: DQuat::IDENTITY,
        }
    }
}

impl Hands {
    fn table(&self) -> MutexGuard<'_, Table> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does something else from now on.
    pub fn change(&self, change: impl FnOnce(&mut Held)) {
        change(&mut self.table().held);
    }

    /// What is seen now.
    #[must_use]
    pub fn look(&self) -> Seen {
        self.table().seen.clone()
    }

    /// The drive of each rotor, of that of each output.
    #[must_use]
    pub(crate) fn wired(&self, outputs: &PerArm<f64>) -> PerArm<f64> {
        at_rotors(&self.table().held.wiring.rotors(), outputs)
    }

    /// A millisecond of hands; notes what is seen.
    pub(crate) fn step(&mut self, pins: &Pins, plant: &Plant) -> InHands {
        let mut table = self.table.lock().unwrap_or_else(PoisonError::into_inner);
        let rotors = plant.rotor_speed();
        let fastest = (0..4).max_by(|a, b| rotors[*a].total_cmp(&rotors[*b]));
        table.seen = Seen {
            ms: pins.ms,
            turned: fastest
                .filter(|rotor| rotors[*rotor] > TURNS)
                .or(table.seen.turned),
            rotors,
            volts: plant.battery_voltage(),
            servos: pins.servos,
        };
        let held = table.held.clone();
        drop(table);
        let wanted = lying(held.below);
        let before = self.attitude;
        self.attitude = before.rotate_towards(wanted, TURN * STEP).normalize();
        let turn = before.conjugate() * self.attitude;
        InHands {
            attitude: self.attitude,
            rate: turn.to_scaled_axis() / STEP,
            pressed: held.pressed,
            bent: held.bent,
            height: held.height,
            sticks: held.sticks,
        }
    }
}

/// The attitude with `side` below.
fn lying(side: Face) -> DQuat {
    let up = DVec3::from_array(side.force().to_array().map(f64::from)).normalize();
    match side {
        Face::Back => DQuat::from_rotation_x(std::f64::consts::PI),
        _ => DQuat::from_rotation_arc(up, DVec3::NEG_Z),
    }
}

/// A vehicle in hands in this millisecond.
pub struct InHands {
    /// Body to world.
    pub attitude: DQuat,
    /// rad/s, body.
    pub rate: DVec3,
    /// On the pads, Pa.
    pub pressed: PerArm<f64>,
    /// Tips up, rad.
    pub bent: PerArm<f64>,
    /// Above the table, m.
    pub height: f64,
    sticks: Option<Sticks>,
}

impl InHands {
    /// Specific force, m/s², body.
    #[must_use]
    pub fn force(&self) -> DVec3 {
        self.attitude.conjugate() * DVec3::new(0.0, 0.0, -9.806_65)
    }

    /// The transmitter's frame that is due at `ms`.
    #[must_use]
    pub(crate) fn frame(&self, ms: u64) -> Option<Vec<u8>> {
        let sticks = self.sticks.filter(|_| ms.is_multiple_of(FRAME_MS))?;
        Some(crsf::rc_frame(&sticks).to_vec())
    }
}

#[cfg(test)]
mod tests {
    use sophie_control::vector::Vec3;

    use super::*;

    #[test]
    fn the_sides_lie_as_the_calibration_has_them() {
        for side in Face::ALL {
            let force = lying(side).conjugate() * DVec3::new(0.0, 0.0, -9.806_65);
            let [x, y, z] = force.to_array().map(|v| v as f32);
            assert!((Vec3::new(x, y, z) - side.force()).norm() < 1e-4, "{side:?}");
        }
    }
}
