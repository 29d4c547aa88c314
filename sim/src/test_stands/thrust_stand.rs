//! Test stand of the rotors: the vehicle is tied down on a scale, and its rotors run one after another or together, as the
//! stack's static thrust test runs them. Rotors, battery, arms and scale are the plant's, with their effects and errors.

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};

use super::scale::Scale;
use crate::normal::StandardNormal;
use crate::plant::battery::Battery;
use crate::plant::hinged::link::ArmSpec;
use crate::plant::rotor::Rotor;
use crate::scenario::Scenario;
use crate::streams::Streams;

/// Step, s: a quarter of the fastest rotor's time constant; what is read is steady.
const STEP: f64 = 0.01;
/// RMS of what a person reads at the scale above the steady thrust, share: prop wash and a display that jumps (assumed).
const FLUCTUATION: f64 = 0.01;
/// RMS error of the board's voltage after its calibration, share: a meter of 0.5 % is common to all readings.
const VOLTAGE_ERROR: f64 = 0.002;
/// RMS error of an arm's tilt by its sensor, rad (1 degree).
const TILT_ERROR: f64 = 0.017;

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Battery voltage by the board, V.
    pub voltage: f64,
    /// At the scale, g.
    pub grams: f64,
    /// Tilt of each arm by its sensor, rad.
    pub tilt: PerArm<f64>,
}

/// A vehicle on the stand.
#[derive(Clone, Debug)]
pub struct ThrustStand {
    rotors: PerArm<Rotor>,
    arms: PerArm<ArmSpec>,
    battery: Battery,
    /// Share of the thrust that the arms take.
    loss: f64,
    scale: Scale,
    rng: Pcg64Mcg,
}

impl ThrustStand {
    /// The vehicle of `scenario` in its air, cold, with its battery, on a scale with the errors of `streams`.
    #[must_use]
    pub fn new(scenario: &Scenario, streams: Streams) -> Self {
        let v = &scenario.vehicle;
        let density = scenario.world.air.density;
        let rotor = |i: usize| Rotor::new(i, 1.0, v.rotor).in_air(v.rotor_thrust[i], density);
        Self {
            rotors: core::array::from_fn(rotor),
            arms: core::array::from_fn(|arm| scenario.arm_spec(arm)),
            battery: charged(scenario, v.battery_charge),
            loss: v.air.wash.loss,
            scale: Scale::new(streams),
            rng: streams.of("thrust stand"),
        }
    }

    /// Another battery of the same make with `charge`, 0 to 1.
    pub fn change_battery(&mut self, scenario: &Scenario, charge: f64) {
        self.battery = charged(scenario, charge);
    }

    /// Rests for `seconds`.
    pub fn rest(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP) as u32 {
            self.step([0.0; 4]);
        }
    }

    /// Runs `rotors` at `drive` and reads scale and board at the end.
    pub fn run(&mut self, rotors: Rotors, drive: f64) -> Reading {
        let test = StaticThrustTest::steady(rotors, drive as f32);
        for i in 0..(f64::from(test.longest()) / STEP) as u32 {
            let commands = test.at(i as f32 * STEP as f32).commands(0.0);
            self.step(commands.map(f64::from));
        }
        let tilt = self.tilt();
        let mut normal = || -> f64 { StandardNormal.sample(&mut self.rng) };
        let voltage = self.battery.voltage() * (1.0 + VOLTAGE_ERROR * normal());
        let tilt_read = tilt.map(|tilt| tilt + TILT_ERROR * normal());
        let lift = self.lift();
        Reading {
            voltage,
            grams: self.scale.read(lift, FLUCTUATION),
            tilt: tilt_read,
        }
    }

    /// The same, and the thrust of each rotor that its arm carried then, N.
    pub fn run_of_arms(&mut self, rotors: Rotors, drive: f64) -> (PerArm<f64>, Reading) {
        let read = self.run(rotors, drive);
        (self.thrust(), read)
    }

    fn step(&mut self, commands: PerArm<f64>) {
        let voltage = self.battery.voltage();
        for (rotor, command) in self.rotors.iter_mut().zip(commands) {
            rotor.step(STEP, command, voltage);
        }
        let current = self.rotors.iter().map(|rotor| rotor.current(voltage)).sum();
        self.battery.step(STEP, current);
    }

    fn thrust(&self) -> PerArm<f64> {
        self.rotors.map(|rotor| rotor.thrust() * (1.0 - self.loss))
    }

    fn tilt(&self) -> PerArm<f64> {
        let thrust = self.thrust();
        core::array::from_fn(|arm| self.arms[arm].static_tilt(thrust[arm]))
    }

    /// Force on the scale, N.
    fn lift(&self) -> f64 {
        let arms = self.thrust().into_iter().zip(self.tilt());
        arms.map(|(thrust, tilt)| thrust * libm::cos(tilt)).sum()
    }
}

fn charged(scenario: &Scenario, charge: f64) -> Battery {
    let v = &scenario.vehicle;
    Battery::new(charge).aged(v.battery_age, v.battery_sag)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{Actuators, Plant};

    #[test]
    fn the_nominal_vehicle_shows_its_rotors_thrust_at_the_voltage_under_load() {
        let scenario = Scenario::default_mission();
        let mut stand = ThrustStand::new(&scenario, Streams::new(1));
        let one = stand.run(Rotors::One(2), 0.6);
        let expected = scenario.vehicle.rotor.steady_thrust(0.6, one.voltage);
        let tilt = scenario.arm_spec(2).static_tilt(expected);
        let share = one.grams * 9.806_65e-3 / (expected * libm::cos(tilt));
        assert!((share - 1.0).abs() < 0.04, "{share}");
        let before = stand.battery.voltage();
        let all = stand.run(Rotors::All, 0.6);
        assert!(
            (all.grams / one.grams - 4.0).abs() < 0.25,
            "{} {}",
            all.grams,
            one.grams
        );
        assert!(all.voltage < before - 0.2, "{} {before}", all.voltage);
        stand.rest(10.0);
        assert!(stand.thrust().iter().all(|thrust| *thrust < 1e-3));
    }

    #[test]
    fn the_whole_plant_on_a_stand_shows_its_static_thrust_and_tilt_and_takes_a_used_battery() {
        let scenario = Scenario::default_mission();
        let mut plant = scenario.plant();
        let actuators = Actuators {
            motors: [0.8; 4],
            ..Actuators::default()
        };
        plant.stand(true);
        let run = |plant: &mut Plant| {
            (0..4000).for_each(|_| plant.step(&actuators));
            let expected = scenario.vehicle.rotor.steady_thrust(0.8, plant.battery_voltage());
            let lift: f64 = plant.tilt().map(|tilt| expected * libm::cos(tilt)).iter().sum();
            assert!(
                (plant.lift() / lift - 1.0).abs() < 0.005,
                "{} {lift}",
                plant.lift()
            );
            assert!((plant.pose().position.z + 1.0).abs() < 1e-9);
            // A body that is let rise takes its arms along: they would bend by a third less.
            for (arm, (tilt, thrust)) in plant.tilt().into_iter().zip(plant.thrust()).enumerate() {
                let wanted = scenario.arm_spec(arm).static_tilt(thrust);
                assert!(
                    (tilt - wanted).abs() < 0.3f64.to_radians(),
                    "{arm}: {tilt} {wanted}"
                );
            }
            plant.battery_voltage()
        };
        let fresh = run(&mut plant);
        plant.change_battery(0.35);
        let used = run(&mut plant);
        assert!(used < fresh - 0.5, "{used} {fresh}");
    }
}
