//! The emulated board as the aircraft of a flight: what the world sees of it is its pins, its telemetry and its log.

use std::collections::{BTreeMap, VecDeque};

use rand_pcg::Pcg64Mcg;
use sophie_control::fsr::FsrScale;
use sophie_control::grip::{ArmGrip, GripState};
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_control::tendon::{FULL_US, RELEASE_US, Reel};
use sophie_control::thrust_curve::ThrustCurve;
use sophie_control::wrench::PerArm;
use sophie_hil::crsf::Telemetry;
use sophie_hil::flight::aircraft::{Aircraft, Belief, Said};
use sophie_hil::plant::{Actuators, Plant};
use sophie_tasks::telemetry::parse_mode_text;

use crate::emulator::Emulator;
use crate::log::{Line, Log};
use crate::plan::Plan;
use crate::sensors::Sensors;
use crate::wires::{Digest, Pins, Run, Wires};

/// A vehicle with the emulated board in it.
pub struct Bench<'a> {
    emulator: Emulator,
    sensors: Sensors,
    plan: Plan,
    wires: Wires,
    pins: Pins,
    log: Log<'a>,
    told: Box<dyn FnMut(&Line) + 'a>,
    telemetry: VecDeque<u8>,
    display: Telemetry,
    status: Option<(Mode, String)>,
    overruns: BTreeMap<String, u32>,
    log_digest: Digest,
    params: Params,
    watched: Watched,
    /// Every line of the log.
    pub lines: Vec<Line>,
    /// Restarts of the processor: when (ms since power-on) and why.
    pub resets: Vec<(f64, String)>,
}

/// What the bench sees of the plant besides the pins.
#[derive(Default)]
struct Watched {
    tilt: PerArm<f64>,
    voltage: f64,
    /// When the arms began to close, ms.
    closing: Option<u64>,
    /// Since when each arm's pressure is within its tolerance, ms.
    within: PerArm<Option<u64>>,
}

/// What is left of a bench after its run.
pub struct Finished {
    /// What the emulator tells.
    pub run: Run,
    /// Missed deadlines by task, as the log told last.
    pub overruns: BTreeMap<String, u32>,
    /// Digest of every line of the log with its time.
    pub log_digest: u64,
    /// Every line of the log.
    pub lines: Vec<Line>,
    /// Restarts of the processor: when (ms since power-on) and why.
    pub resets: Vec<(f64, String)>,
    /// Stretches of the log that could not be decoded.
    pub malformed: u32,
}

impl<'a> Bench<'a> {
    /// A vehicle around `emulator`, with sensors out of the bag that `rng` holds; each line of the log goes to `told`.
    pub fn new(
        emulator: Emulator,
        log: Log<'a>,
        plan: Plan,
        rng: &mut Pcg64Mcg,
        told: impl FnMut(&Line) + 'a,
    ) -> Self {
        Self {
            emulator,
            sensors: Sensors::new(rng),
            plan,
            wires: Wires::default(),
            pins: Pins::default(),
            log,
            told: Box::new(told),
            telemetry: VecDeque::new(),
            display: Telemetry::default(),
            status: None,
            overruns: BTreeMap::new(),
            log_digest: Digest::default(),
            params: Params::default(),
            watched: Watched::default(),
            lines: Vec::new(),
            resets: Vec::new(),
        }
    }

    /// Ends the run.
    ///
    /// # Errors
    /// One line: why the emulator failed.
    pub fn finish(mut self) -> Result<Finished, String> {
        Ok(Finished {
            run: self.emulator.finish()?,
            overruns: self.overruns,
            log_digest: self.log_digest.0,
            lines: self.lines,
            resets: self.resets,
            malformed: self.log.malformed,
        })
    }

    /// What the pins show now.
    #[must_use]
    pub fn pins(&self) -> &Pins {
        &self.pins
    }

    fn hear(&mut self, line: Line) {
        (self.told)(&line);
        self.log_digest.word(line.ms);
        line.text.bytes().for_each(|byte| self.log_digest.byte(byte));
        if let Some((mode, reason)) = parse_mode_text(&line.text) {
            if mode == Mode::Clamping && self.mode() != Mode::Clamping {
                self.watched.closing = Some(line.ms);
            }
            self.status = Some((mode, reason.to_owned()));
        }
        if let Some((task, rest)) = line.text.split_once(": ")
            && let Some((count, _)) = rest.split_once(" overruns in ")
            && let Ok(count) = count.parse()
        {
            self.overruns.insert(task.to_owned(), count);
        }
        self.lines.push(line);
    }

    fn pressure(&self) -> PerArm<f64> {
        let scale = FsrScale::from_params(&self.params);
        self.sensors
            .pressure_counts
            .map(|counts| f64::from(scale.pressure(counts)))
    }

    /// Keeps since when each arm's pressure is where it should be.
    fn watch_pressure(&mut self, ms: u64) {
        let (target, tolerance) = (self.params.grip_pressure, self.params.grip_tolerance);
        let pressures = self.pressure();
        for (within, pressure) in self.watched.within.iter_mut().zip(pressures) {
            if (pressure - f64::from(target)).abs() > f64::from(tolerance) {
                *within = None;
            } else if within.is_none() {
                *within = Some(ms);
            }
        }
    }

    /// Force of each tendon (N) that its servo's pulse asks for.
    fn tension(&self) -> PerArm<f64> {
        let reel = Reel::from_params(&self.params);
        let mut force = [0.0; 4];
        for ((force, pulse), tilt) in force.iter_mut().zip(self.pins.servos).zip(self.watched.tilt) {
            if pulse > 0.0 {
                let travel = (pulse as f32 - RELEASE_US) / (FULL_US - RELEASE_US);
                *force = f64::from(reel.force(travel * self.params.servo_range, tilt as f32));
            }
        }
        force
    }
}

impl Aircraft for Bench<'_> {
    fn step_world(&mut self, plant: &mut Plant) {
        self.plan
            .apply(self.pins.ms, &mut self.sensors, &mut self.wires.faults);
        let actuators = Actuators {
            motors: self.pins.motors,
            servos: self.pins.servos,
        };
        self.sensors.step(plant, &actuators, &mut self.wires);
        self.watched.tilt = plant.tilt();
        self.watched.voltage = plant.battery_voltage();
    }

    fn take_telemetry(&mut self, buffer: &mut [u8]) -> usize {
        let count = self.telemetry.len().min(buffer.len());
        for (slot, byte) in buffer.iter_mut().zip(self.telemetry.drain(..count)) {
            *slot = byte;
        }
        count
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.plan.radio(self.pins.ms, bytes, &mut self.wires.receiver);
    }

    fn run_until(&mut self, us: u64) -> Result<(), String> {
        while self.pins.ms * 1000 < us {
            self.pins = self.emulator.advance(std::mem::take(&mut self.wires))?;
            let ms = self.pins.ms;
            let bytes = std::mem::take(&mut self.pins.telemetry);
            self.display.take(&bytes);
            self.telemetry.extend(bytes);
            for (at, why) in std::mem::take(&mut self.pins.resets) {
                self.resets.push((at as f64 * 1e-6, why));
            }
            let log = std::mem::take(&mut self.pins.log);
            for line in self.log.take(ms, &log) {
                self.hear(line);
            }
            self.watch_pressure(ms);
        }
        Ok(())
    }

    fn status(&self) -> Option<Said<'_>> {
        self.status.as_ref().map(|(mode, reason)| Said {
            mode: *mode,
            reason,
            warning: "",
        })
    }

    /// The log does not tell of the grip: it is proven when the vehicle says that it is perched. Pressure is that at the
    /// pins, force that of the servos' pulses, closure the time from the log's CLAMPING to the pressure.
    fn grip(&self) -> Option<GripState> {
        let (mode, _) = self.status.as_ref()?;
        let mut grip = GripState {
            proven: *mode == Mode::Perched,
            ..GripState::default()
        };
        let pins = self.pressure().into_iter().zip(self.tension());
        for ((arm, (pressure, force)), within) in grip.arms.iter_mut().zip(pins).zip(self.watched.within) {
            let closure = self
                .watched
                .closing
                .zip(within)
                .map(|(from, to)| to.saturating_sub(from) as f32 * 1e-3);
            *arm = ArmGrip {
                pressure: pressure as f32,
                force: force as f32,
                closure,
                ..ArmGrip::default()
            };
        }
        Some(grip)
    }

    fn belief(&self) -> Belief {
        let unknown = [f64::NAN; 4];
        let curve = ThrustCurve::from_params(&self.params);
        let ratio = self.watched.voltage as f32 / self.params.battery_nominal;
        Belief {
            attitude: self.display.attitude.unwrap_or([f64::NAN; 3]),
            setpoint: [f64::NAN; 3],
            tilt_measured: unknown,
            tilt_model: unknown,
            thrust_asked: self
                .pins
                .motors
                .map(|command| f64::from(curve.thrust(command as f32, ratio))),
            tension_asked: self.tension(),
            pressure: self.pressure(),
            saturated: false,
        }
    }

    fn overruns(&self) -> u32 {
        self.overruns.values().sum()
    }
}
