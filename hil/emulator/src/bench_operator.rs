//! A person who handles the vehicle on the bench: turns it, bends arms, presses pads, swaps motor wires, moves the
//! sticks, and observes rotors, servos and battery voltage.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{DQuat, DVec3};
use sophie_control::allocation::motor_map::at_rotors;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::calibration::Face;
use sophie_control::params::MotorMap;
use sophie_control::pilot::rc::Sticks;
use sophie_sim::devices::crsf;
use sophie_sim::plant::Plant;
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::phone::Phone;

use crate::wires::Pins;

/// Rate at which the operator turns the vehicle, rad/s: a quarter turn in half a second.
const TURN: f64 = 3.0;
/// Length of a step, s; interval of the transmitter's frames, ms.
const STEP: f64 = 1e-3;
const FRAME_MS: u64 = 20;
/// Weight that the operator hangs on or takes off in a step, N: 3 N in a second.
const HANG: f64 = 3e-3;
/// Rotor speed at which the phone records its loudest tones, rad/s: full drive of the default rotor.
const LOUDEST: f64 = 740.0;
/// Lowest rotor speed that the operator notices, rad/s.
const TURNS: f64 = 20.0;

/// State in which the operator holds the vehicle and the transmitter.
#[derive(Clone, Debug)]
pub struct Handling {
    /// Side that points down. After a change the vehicle turns there at a limited rate.
    pub below: Face,
    /// Pressure on each pad, Pa.
    pub pressed: PerArm<f64>,
    /// Tilt of each arm, tip up, added to its tilt at rest, rad.
    pub bent: PerArm<f64>,
    /// The body stands on a box: arms hang free, and the servos wind them.
    pub on_box: bool,
    /// Weight on each arm's tip, N; hung on and taken off slowly.
    pub hung: PerArm<f64>,
    /// Height above the table, m.
    pub height: f64,
    /// Sticks of a CRSF transmitter; `None`: the transmitter is off.
    pub sticks: Option<Sticks>,
    /// Rotor that each motor output is wired to.
    pub wiring: MotorMap,
    /// The body is tied down on a stand with a scale; arms hang free.
    pub tied: bool,
    /// Charge of a battery that he puts in, 0 to 1; `None`: the one that is in.
    pub battery: Option<f64>,
    /// A phone beside rotor 1 records; a new recording begins where it was off.
    pub records: bool,
}

/// What the operator observes: time, rotors, servo pulses, arms, and the battery voltage by multimeter.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// Time since power-on, ms.
    pub ms: u64,
    /// The rotor that turned last, 0 to 3; `None` before any turns.
    pub turned: Option<usize>,
    /// Rotor speeds, rad/s.
    pub rotors: PerArm<f64>,
    /// Voltage at the battery's plug, V.
    pub volts: f64,
    /// Servo pulses, µs.
    pub servos: PerArm<f64>,
    /// What the scale under the tied vehicle loses, N.
    pub lift: f64,
    /// Tilt of each arm without his hands, tip up, rad.
    pub tilts: PerArm<f64>,
}

struct Table {
    held: Handling,
    seen: Observation,
    /// The last recording.
    phone: Option<Phone>,
    recorded: bool,
}

/// The operator, shared by the test that directs him and the board that he handles.
#[derive(Clone)]
pub struct BenchOperator {
    table: Arc<Mutex<Table>>,
    attitude: DQuat,
    /// Present weight on each tip, N.
    hung: PerArm<f64>,
}

impl Default for BenchOperator {
    fn default() -> Self {
        let held = Handling {
            below: Face::Belly,
            pressed: [0.0; 4],
            bent: [0.0; 4],
            on_box: false,
            hung: [0.0; 4],
            height: 0.0,
            sticks: None,
            wiring: MotorMap::STRAIGHT,
            tied: false,
            battery: None,
            records: false,
        };
        let seen = Observation::default();
        Self {
            table: Arc::new(Mutex::new(Table {
                held,
                seen,
                phone: None,
                recorded: false,
            })),
            attitude: DQuat::IDENTITY,
            hung: [0.0; 4],
        }
    }
}

impl Table {
    /// Passes the sound of the rotor at `speed`, rad/s, to the phone for a step.
    fn records(&mut self, speed: f64) {
        let began = self.held.records && !self.recorded;
        self.recorded = self.held.records;
        if began {
            self.phone = Some(Phone::new(Streams::new(1)));
        }
        if let Some(phone) = self.phone.as_mut().filter(|_| self.recorded) {
            phone.hear(speed, LOUDEST, STEP);
        }
    }
}

impl BenchOperator {
    fn table(&self) -> MutexGuard<'_, Table> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the handling from the next millisecond on.
    pub fn change(&self, change: impl FnOnce(&mut Handling)) {
        change(&mut self.table().held);
    }

    /// The latest observation.
    #[must_use]
    pub fn observe(&self) -> Observation {
        self.table().seen.clone()
    }

    /// The last recording as a WAV file.
    #[must_use]
    pub fn recording(&self) -> Option<Vec<u8>> {
        self.table().phone.as_ref().map(Phone::wav)
    }

    /// Commands in rotor order, from commands in output order.
    #[must_use]
    pub(crate) fn wired(&self, outputs: &PerArm<f64>) -> PerArm<f64> {
        at_rotors(&self.table().held.wiring.rotors(), outputs)
    }

    /// Advances by a millisecond and records an observation.
    pub(crate) fn step(&mut self, pins: &Pins, plant: &mut Plant) -> HandledVehicle {
        let mut table = self.table.lock().unwrap_or_else(PoisonError::into_inner);
        let rotors = plant.rotor_speed();
        let fastest = (0..4).max_by(|a, b| rotors[*a].total_cmp(&rotors[*b]));
        table.seen = Observation {
            ms: pins.ms,
            turned: fastest
                .filter(|rotor| rotors[*rotor] > TURNS)
                .or(table.seen.turned),
            rotors,
            volts: plant.battery_voltage(),
            servos: pins.servos,
            lift: plant.lift(),
            tilts: plant.tilt(),
        };
        let held = table.held.clone();
        table.held.battery = None;
        table.records(rotors[0]);
        drop(table);
        let fixed = held.on_box || held.tied;
        if plant.stands() != fixed {
            plant.stand(fixed);
        }
        for (arm, (now, to)) in self.hung.iter_mut().zip(held.hung).enumerate() {
            *now += (to - *now).clamp(-HANG, HANG);
            plant.hang(arm, *now);
        }
        let wanted = lying(held.below);
        let before = self.attitude;
        self.attitude = before.rotate_towards(wanted, TURN * STEP).normalize();
        let turn = before.conjugate() * self.attitude;
        HandledVehicle {
            attitude: self.attitude,
            rate: turn.to_scaled_axis() / STEP,
            pressed: held.pressed,
            bent: held.bent,
            height: held.height,
            sticks: held.sticks,
            battery: held.battery,
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

/// The handled vehicle in one millisecond.
pub struct HandledVehicle {
    /// Body to world.
    pub attitude: DQuat,
    /// Angular rate, rad/s, body axes.
    pub rate: DVec3,
    /// Pressure on the pads, Pa.
    pub pressed: PerArm<f64>,
    /// Added tilt of the arms, tip up, rad.
    pub bent: PerArm<f64>,
    /// Height above the table, m.
    pub height: f64,
    sticks: Option<Sticks>,
    /// Charge of a battery that he puts in now.
    pub(crate) battery: Option<f64>,
}

impl HandledVehicle {
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
    use sophie_control::maths::vector::Vec3;

    use sophie_sim::plant::Actuators;
    use sophie_sim::scenario::Scenario;

    use super::*;

    #[test]
    fn on_the_box_a_servo_winds_its_arm_and_a_weight_bends_it() {
        let (mut operator, pins) = (BenchOperator::default(), Pins::default());
        let mut plant = Scenario::default_mission().plant();
        operator.change(|held| held.on_box = true);
        let mut rest = |servo: f64, weight: f64| {
            operator.change(|held| held.hung[0] = weight);
            for _ in 0..4000 {
                operator.step(&pins, &mut plant);
                let servos = [servo, 0.0, 0.0, 0.0];
                (0..2).for_each(|_| {
                    plant.step(&Actuators {
                        motors: [0.0; 4],
                        servos,
                    });
                });
            }
            plant.tilt().map(f64::to_degrees)
        };
        let [free, hung, wound, both] = [(550.0, 0.0), (550.0, 3.0), (1200.0, 0.0), (1200.0, 3.0)]
            .map(|(servo, weight)| rest(servo, weight));
        // 8.2 °/N of a straight arm; a tendon of 8 kN/m lets the wound arm give a quarter of that.
        assert!((15.0..25.0).contains(&(free[0] - hung[0])), "{free:?} {hung:?}");
        assert!(free[0] - wound[0] > 10.0, "{wound:?}");
        assert!((2.0..8.0).contains(&(wound[0] - both[0])), "{both:?}");
        assert!((free[1] - both[1]).abs() < 0.1);
    }

    #[test]
    fn the_sides_lie_as_the_calibration_has_them() {
        for side in Face::ALL {
            let force = lying(side).conjugate() * DVec3::new(0.0, 0.0, -9.806_65);
            let [x, y, z] = force.to_array().map(|v| v as f32);
            assert!((Vec3::new(x, y, z) - side.force()).norm() < 1e-4, "{side:?}");
        }
    }
}
