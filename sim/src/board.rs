//! The simulated board: the tasks' ports, connected to the plant through sensor models. Each millisecond the plant
//! steps first, then the tasks run; their outputs act on the next step of the plant.

use std::cell::{Cell, RefCell};

use embassy_sync::pipe::Pipe;
use embassy_sync::signal::Signal;
use embassy_time::{Instant, Timer};
use heapless::Vec;
use sophie_control::allocation::motor_map::at_rotors;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::params::{MotorMap, Params};
use sophie_drivers::esc_protocol::EscProtocol;
use sophie_drivers::esc_pwm::PulseRate;
use sophie_ports::error::PortError;
use sophie_ports::retained::{self, WORDS, Words};
use sophie_ports::sensors::{self, AnalogFrame, IMU_BATCH};
use sophie_ports::{actuators, chip, serial};
use sophie_tasks::links::last_value::Raw;

use crate::plant::esc::{EscSpec, ONESHOT125};
use crate::plant::{Actuators, Plant, STEP};
use crate::scenario::{Faults, Scenario};
use crate::sensors::analog::{BatteryInputs, PIN_VOLTS_PER_COUNT};
use crate::sensors::arm_imu::{self, ArmImu, TiltBreak};
use crate::sensors::barometer::{Barometer, MEASUREMENT_US};
use crate::sensors::fsr::FsrSensor;
use crate::sensors::imu::{Imu, Misfit};
use crate::streams::Streams;

/// Bytes of the receiver's buffer: half a hardware ring of 512.
const LINE_BYTES: usize = 256;
/// Time to convert all analog inputs, µs.
const CONVERSION_US: u64 = 30;
/// Time to read one sensor over I2C at 400 kHz, µs.
const ARM_READ_US: u64 = 400;

const STEPS_PER_MS: u32 = (1e-3 / STEP) as u32;

/// The board's state, shared by ports and world.
pub struct Board {
    imu_ready: Signal<Raw, Vec<ImuReading, IMU_BATCH>>,
    actuators: Cell<Actuators>,
    rc: Pipe<Raw, LINE_BYTES>,
    telemetry: Pipe<Raw, LINE_BYTES>,
    sensors: RefCell<Sensors>,
    truth: Cell<AnalogTruth>,
    /// `None`: no answer.
    arm_gravity: Cell<PerArm<Option<Vec3>>>,
    /// Sample rate of the inertial sensor, Hz.
    imu_rate: f64,
    /// Memory that outlives a reset.
    pub memory: Cell<[Words; 2]>,
    /// Accelerometer bias as measured on a level bench, m/s².
    pub accel_bias: [f32; 3],
    /// Wiring from motor outputs to rotors.
    wiring: Cell<MotorMap>,
    /// Motor controllers as built, and the protocol sent to them.
    esc: EscSpec,
    protocol: Cell<EscProtocol>,
    /// Earliest start of the next pulse, µs.
    next_pulse: Cell<u64>,
}

#[derive(Clone, Copy, Default)]
struct AnalogTruth {
    pressure: PerArm<f64>,
    tilt: PerArm<f64>,
    voltage: f64,
    current: f64,
    servo_voltage: f64,
    /// Time since the last conversion, s.
    elapsed: f64,
}

struct Sensors {
    imu: Imu,
    arms: PerArm<ArmImu>,
    fsr: PerArm<FsrSensor>,
    battery: BatteryInputs,
    arm_clock: f64,
    /// `None` on a board without one.
    barometer: Option<Barometer>,
}

impl Board {
    /// A board with default parameters and the sensor errors of `streams`.
    #[must_use]
    pub fn new(streams: Streams) -> Self {
        Self::with(&Params::default(), streams, &Faults::default())
    }

    /// The board of `scenario`, with its motors wired as its parameters state.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let mut board = Self::with(&scenario.params, scenario.streams(), &scenario.faults);
        board.esc = scenario.vehicle.esc;
        board.sensors.get_mut().imu.mount(scenario.vehicle.vibration);
        {
            let Sensors { arms, fsr, .. } = &mut *board.sensors.borrow_mut();
            for (arm, sensor) in fsr.iter_mut().enumerate() {
                *sensor = sensor.clone().with_errors(scenario.fsr_on(arm));
            }
            for sensor in arms {
                *sensor = sensor.clone().with_errors(scenario.sensors.tilt);
            }
        }
        if scenario.sensors.barometer {
            board.sensors.borrow_mut().barometer = Some(scenario.barometer());
        }
        board
    }

    fn with(params: &Params, streams: Streams, faults: &Faults) -> Self {
        let imu = Imu::new(params, streams);
        let accel_bias = imu.bench_bias().as_vec3().to_array();
        let arms = std::array::from_fn(|arm| {
            let (offset, fault) = faults.tilt(arm);
            ArmImu::new(arm, streams).with_fault(offset, fault)
        });
        let fsr = std::array::from_fn(|arm| {
            let (gain, fault) = faults.pressure(arm);
            FsrSensor::new(arm, streams).with_fault(gain, fault)
        });
        Self {
            imu_ready: Signal::new(),
            actuators: Cell::default(),
            rc: Pipe::new(),
            telemetry: Pipe::new(),
            sensors: RefCell::new(Sensors {
                imu,
                arms,
                fsr,
                battery: BatteryInputs::new(streams),
                arm_clock: 0.0,
                barometer: None,
            }),
            truth: Cell::default(),
            arm_gravity: Cell::new([Some(Vec3::default()); 4]),
            memory: Cell::new([[0; WORDS]; 2]),
            accel_bias,
            wiring: Cell::new(params.motor_map),
            esc: EscSpec::default(),
            protocol: Cell::new(EscProtocol::from_params(params)),
            next_pulse: Cell::new(0),
            imu_rate: f64::from(params.imu_rate.number()),
        }
    }

    /// Mounts the inertial sensor with the errors of `misfit`.
    pub fn misfit(&self, misfit: Misfit) {
        self.sensors.borrow_mut().imu.misfit = Some(misfit);
    }

    /// Wires the motors by `map`, independent of the parameters.
    pub fn wire(&self, map: MotorMap) {
        self.wiring.set(map);
    }

    /// Applies the motor protocol of `params`, as a start of the board does.
    pub fn configure_motors(&self, params: &Params) {
        self.protocol.set(EscProtocol::from_params(params));
        self.next_pulse.set(0);
    }

    /// Rotor drives from motor commands, 0..1: equal to the commands with digital frames, rescaled by the controller's
    /// own ends with pulses. `None` while the last pulse's period lasts: no new pulse starts.
    fn drives(&self, commands: PerArm<f32>) -> Option<PerArm<f64>> {
        let EscProtocol::Pulse(pulse) = self.protocol.get() else {
            return Some(commands.map(f64::from));
        };
        let (now, period) = (Instant::now().as_micros(), u64::from(pulse.rate().period_us()));
        if now < self.next_pulse.get() {
            return None;
        }
        self.next_pulse.set(now + period);
        let standard = match pulse.rate() {
            PulseRate::Standard => 1.0,
            PulseRate::OneShot125 => ONESHOT125,
        };
        Some(commands.map(|command| self.esc.drive(standard * f64::from(pulse.pulse_us(command)))))
    }

    /// Steps the plant by 1 ms under the last outputs and samples the sensors.
    pub fn step_world(&self, plant: &mut Plant) {
        let actuators = self.actuators.get();
        let mut sensors = self.sensors.borrow_mut();
        let mut batch = Vec::new();
        for step in 0..STEPS_PER_MS {
            let (rate, force) = (plant.pose().omega, plant.specific_force());
            plant.step(&actuators);
            let (rate_step, force_step) = (plant.pose().omega - rate, plant.specific_force() - force);
            // A sensor at 1 kHz samples at the end of every other step, a faster one also between steps.
            let samples = (self.imu_rate * STEP * f64::from(step + 1)) as u32
                - (self.imu_rate * STEP * f64::from(step)) as u32;
            for k in 1..=samples {
                let share = f64::from(k) / f64::from(samples);
                let rotors = plant.rotor_speed();
                let reading =
                    sensors
                        .imu
                        .sample(rate + rate_step * share, force + force_step * share, &rotors);
                // The queue holds more than 1 ms of samples.
                let _ = batch.push(reading);
            }
        }
        sensors.arm_clock += 1e-3 * arm_imu::RATE_HZ;
        if sensors.arm_clock >= 1.0 {
            sensors.arm_clock -= 1.0;
            let (attitude, force, tilt) = (plant.pose().attitude, plant.specific_force(), plant.tilt());
            let mut gravity = self.arm_gravity.get();
            let tips = tilt.into_iter().zip(plant.rotor_speed());
            for ((g, arm), (tilt, rotor)) in gravity.iter_mut().zip(&mut sensors.arms).zip(tips) {
                let sent = arm.sample(attitude, tilt, force, rotor);
                *g = (arm.broken() != Some(TiltBreak::Silent)).then_some(sent);
            }
            self.arm_gravity.set(gravity);
        }
        if let Some(barometer) = &mut sensors.barometer {
            barometer.step(-plant.pose().position.z, plant.thrust().iter().sum());
        }
        self.truth.set(AnalogTruth {
            pressure: plant.pressure(),
            tilt: plant.tilt(),
            voltage: plant.battery_voltage(),
            current: plant.battery_current(),
            servo_voltage: plant.servo_voltage(),
            elapsed: self.truth.get().elapsed + plant.lapse() * 1e-3,
        });
        self.imu_ready.signal(batch);
    }

    /// Reset: no motor frame or servo pulse, empty line buffers. Sensors and memory stay.
    pub fn reset(&self) {
        self.actuators.set(Actuators::default());
        self.imu_ready.reset();
        self.rc.clear();
        self.telemetry.clear();
    }

    /// Puts bytes on the receiver's line; the excess is lost.
    pub fn receive(&self, bytes: &[u8]) {
        let mut rest = bytes;
        while !rest.is_empty()
            && let Ok(taken) = self.rc.try_write(rest)
        {
            rest = rest.get(taken..).unwrap_or_default();
        }
    }

    /// Takes the telemetry sent since the last call.
    pub fn take_telemetry(&self, buffer: &mut [u8]) -> usize {
        self.telemetry.try_read(buffer).unwrap_or(0)
    }

    /// Unread readings of the inertial sensor.
    #[must_use]
    pub fn imu_batch(&self) -> Vec<ImuReading, IMU_BATCH> {
        let batch = self.imu_ready.try_take();
        if let Some(batch) = &batch {
            self.imu_ready.signal(batch.clone());
        }
        batch.unwrap_or_default()
    }

    /// Last outputs of the tasks.
    #[must_use]
    pub fn actuators(&self) -> Actuators {
        self.actuators.get()
    }
}

/// A port; one type for all.
#[derive(Clone, Copy)]
pub struct Port(pub &'static Board);

impl sensors::Imu for Port {
    type Batch = Vec<ImuReading, IMU_BATCH>;

    fn rate_hz(&self) -> f32 {
        self.0.imu_rate as f32
    }

    async fn read(&mut self) -> Result<Self::Batch, PortError> {
        Ok(self.0.imu_ready.wait().await)
    }

    // No bus: ready at once.
    fn ready_at(&self) -> Instant {
        Instant::now()
    }
}

impl sensors::ArmImus for Port {
    async fn gravity(&mut self, arm: usize) -> Result<Vec3, PortError> {
        Timer::after_micros(ARM_READ_US).await;
        self.0
            .arm_gravity
            .get()
            .get(arm)
            .copied()
            .flatten()
            .ok_or(PortError::Absent)
    }
}

impl sensors::Barometer for Port {
    const FITTED: bool = true;

    async fn read(&mut self) -> Result<AirPressure, PortError> {
        Timer::after_micros(MEASUREMENT_US).await;
        let mut sensors = self.0.sensors.borrow_mut();
        let barometer = sensors.barometer.as_mut().ok_or(PortError::Absent)?;
        barometer
            .measure(Instant::now().as_micros())
            .ok_or(PortError::Timeout)
    }
}

impl sensors::Analog for Port {
    fn volts_per_count(&self) -> f32 {
        PIN_VOLTS_PER_COUNT as f32
    }

    async fn read(&mut self) -> Result<AnalogFrame, PortError> {
        Timer::after_micros(CONVERSION_US).await;
        let truth = self.0.truth.get();
        self.0.truth.set(AnalogTruth {
            elapsed: 0.0,
            ..truth
        });
        let Sensors { fsr, battery, .. } = &mut *self.0.sensors.borrow_mut();
        let mut frame = AnalogFrame {
            fsr: [0; 4],
            battery_voltage: battery.voltage(truth.voltage),
            battery_current: battery.current(truth.current),
            servo_battery: battery.servo_voltage(truth.servo_voltage),
        };
        let arms = truth.pressure.into_iter().zip(truth.tilt);
        for ((counts, sensor), (pressure, tilt)) in frame.fsr.iter_mut().zip(fsr).zip(arms) {
            sensor.bend(tilt);
            *counts = sensor.sample(pressure, truth.elapsed);
        }
        Ok(frame)
    }
}

impl actuators::Motors for Port {
    async fn write(&mut self, commands: PerArm<f32>) -> Instant {
        if let Some(drives) = self.0.drives(commands) {
            self.0.actuators.set(Actuators {
                motors: at_rotors(&self.0.wiring.get().rotors(), &drives),
                ..self.0.actuators.get()
            });
        }
        Instant::now()
    }
}

impl actuators::Servos for Port {
    /// The servo follows the newest width at once, without a frame.
    async fn write(&mut self, pulses_us: PerArm<f32>) -> Instant {
        let actuators = self.0.actuators.get();
        self.0.actuators.set(Actuators {
            servos: pulses_us.map(f64::from),
            ..actuators
        });
        Instant::now()
    }
}

impl serial::SerialInput for Port {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        Ok(self.0.rc.read(buffer).await)
    }
}

impl serial::SerialOutput for Port {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let written = self.0.telemetry.write(rest).await;
            rest = rest.get(written..).unwrap_or_default();
        }
        Ok(())
    }
}

impl retained::Retain for Port {
    fn keep(&mut self, second: bool, words: &Words) {
        let [first_copy, second_copy] = self.0.memory.get();
        self.0.memory.set(if second {
            [first_copy, *words]
        } else {
            [*words, second_copy]
        });
    }
}

impl chip::Watchdog for Port {
    /// No watchdog: the supervisor's tests cover withheld feeds.
    fn feed(&mut self) {}
}
