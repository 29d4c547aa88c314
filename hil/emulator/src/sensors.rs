//! Voltages and samples on the wires, with the simulated board's sensor errors.

use sophie_control::allocation::wrench::PerArm;
use sophie_control::maths::vector::Vec3;
use sophie_sim::plant::{Plant, STEP};
use sophie_sim::scenario::Scenario;
use sophie_sim::sensors::analog::{AMPS_PER_COUNT, BatteryInputs, VOLTS_PER_COUNT};
use sophie_sim::sensors::arm_imu::{self, ArmImu};
use sophie_sim::sensors::barometer::Barometer;
use sophie_sim::sensors::fsr::{FsrBreak, FsrSensor};
use sophie_sim::sensors::imu::Imu;

use crate::bench_operator::HandledVehicle;
use crate::wires::Wires;

/// Converter reference, V, and full scale, counts.
const REFERENCE: f64 = 3.3;
const FULL_SCALE: f64 = 4095.0;
const STEPS_PER_MS: u32 = (1e-3 / STEP) as u32;

/// The vehicle's sensors.
pub struct Sensors {
    imu: Imu,
    /// Inertial samples per plant step.
    samples: u32,
    /// Calibrated accelerometer bias, m/s².
    pub calibration: [f32; 3],
    arms: PerArm<ArmImu>,
    fsr: PerArm<FsrSensor>,
    battery: BatteryInputs,
    barometer: Barometer,
    /// Since power-on, ms.
    ms: u64,
    arm_clock: f64,
    gravity: PerArm<Vec3>,
    /// 12 bits.
    pub pressure_counts: PerArm<u16>,
    /// Factor on the battery voltage; 1: intact.
    pub battery_share: f64,
}

impl Sensors {
    /// Parts of the same names as [`sophie_sim::board::Board`] has: equal seeds, equal vehicles.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let (params, streams) = (&scenario.params, scenario.streams());
        let mut imu = Imu::new(params, streams);
        imu.mount(scenario.vehicle.vibration);
        let calibration = imu.bench_bias().as_vec3().to_array();
        let arms = std::array::from_fn(|arm| ArmImu::new(arm, streams).with_errors(scenario.sensors.tilt));
        let fsr = std::array::from_fn(|arm| {
            let (gain, _) = scenario.faults.pressure(arm);
            let sensor = FsrSensor::new(arm, streams).with_fault(gain, None);
            sensor.with_errors(scenario.fsr_on(arm))
        });
        Self {
            imu,
            samples: ((f64::from(params.imu_rate.number()) * STEP) as u32).max(1),
            calibration,
            arms,
            fsr,
            battery: BatteryInputs::new(streams),
            barometer: scenario.barometer(),
            ms: 0,
            arm_clock: 0.0,
            gravity: [Vec3::new(0.0, 0.0, 9.806_65); 4],
            pressure_counts: [0; 4],
            battery_share: 1.0,
        }
    }

    /// Breaks or mends the lead of a pressure sensor.
    pub fn break_fsr(&mut self, arm: usize, broken: Option<FsrBreak>) {
        if let Some(sensor) = self.fsr.get_mut(arm) {
            sensor.set_broken(broken);
        }
    }

    /// Steps the plant by a millisecond and sets `wires`; of a vehicle in operator the plant's rotors and battery alone count.
    pub fn step(
        &mut self,
        plant: &mut Plant,
        actuators: &sophie_sim::plant::Actuators,
        operator: Option<&HandledVehicle>,
        wires: &mut Wires,
    ) {
        let moved = |plant: &Plant| {
            operator.map_or((plant.pose().omega, plant.specific_force()), |held| {
                (held.rate, held.force())
            })
        };
        for _ in 0..STEPS_PER_MS {
            let (rate, force) = moved(plant);
            plant.step(actuators);
            let (rate_now, force_now) = moved(plant);
            let (rate_step, force_step) = (rate_now - rate, force_now - force);
            for k in 1..=self.samples {
                let share = f64::from(k) / f64::from(self.samples);
                let rotors = plant.rotor_speed();
                let reading = self
                    .imu
                    .sample(rate + rate_step * share, force + force_step * share, &rotors);
                let wide = |v: Vec3| v.to_array().map(f64::from);
                wires.imu.push((wide(reading.gyro), wide(reading.accel)));
            }
        }
        self.arm_clock += 1e-3 * arm_imu::RATE_HZ;
        if self.arm_clock >= 1.0 {
            self.arm_clock -= 1.0;
            let (_, force) = moved(plant);
            let attitude = operator.map_or(plant.pose().attitude, |held| held.attitude);
            let mut tilt = plant.tilt();
            for (tilt, bent) in tilt.iter_mut().zip(operator.map_or([0.0; 4], |held| held.bent)) {
                *tilt += bent;
            }
            let tips = tilt.into_iter().zip(plant.rotor_speed());
            for ((g, arm), (tilt, rotor)) in self.gravity.iter_mut().zip(&mut self.arms).zip(tips) {
                *g = arm.sample(attitude, tilt, force, rotor);
            }
        }
        wires.arms = self.gravity.map(|g| g.to_array().map(f64::from));
        self.ms += 1;
        let height = operator.map_or(-plant.pose().position.z, |held| held.height);
        self.barometer.step(height, plant.thrust().iter().sum());
        let air = self.barometer.measure(self.ms * 1000);
        wires.air = air.map(|air| (f64::from(air.pascal), f64::from(air.celsius)));
        let volts = |counts: u16| f64::from(counts) * REFERENCE / FULL_SCALE;
        let [pressed, bent] = operator.map_or([[0.0; 4]; 2], |held| [held.pressed, held.bent]);
        let pressures = plant.pressure().into_iter().zip(pressed);
        for (sensor, (tilt, bent)) in self.fsr.iter_mut().zip(plant.tilt().into_iter().zip(bent)) {
            sensor.bend(tilt + bent);
        }
        let pressures = self.fsr.iter_mut().zip(pressures);
        for ((counts, (sensor, (pressure, pressed))), volt) in self
            .pressure_counts
            .iter_mut()
            .zip(pressures)
            .zip(&mut wires.analog)
        {
            *counts = sensor.sample(pressure + pressed, 1e-3);
            *volt = volts(*counts);
        }
        let voltage = plant.battery_voltage() * self.battery_share;
        let voltage = f64::from(self.battery.voltage(voltage)) * VOLTS_PER_COUNT;
        let amps = f64::from(self.battery.current(plant.battery_current())) * AMPS_PER_COUNT;
        let servos = f64::from(self.battery.servo_voltage(plant.servo_voltage())) * VOLTS_PER_COUNT;
        let [.., v, i, s] = &mut wires.analog;
        (*v, *i, *s) = (voltage, amps, servos);
    }
}
