//! The emulated board as the aircraft of a flight.

use std::collections::{BTreeMap, VecDeque};
use std::iter;

use sophie_control::allocation::motor_map::at_rotors;
use sophie_control::allocation::thrust_curve::ThrustCurve;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::gripper::contact_pressure::FsrScale;
use sophie_control::gripper::grip::{ArmGrip, ArmState, GripState};
use sophie_control::gripper::tendon::Reel;
use sophie_control::mode::Mode;
use sophie_control::params::{FlowPort, Params, RcProtocol};
use sophie_control::pilot::rc::Sticks;
use sophie_drivers::sbus;
use sophie_ports::retained::StartCause;
use sophie_sim::devices::crsf::Telemetry;
use sophie_sim::devices::flow_module::FlowSender;
use sophie_sim::flight::aircraft::{Aircraft, ReportedStatus, Reset, StackEstimate};
use sophie_sim::plant::{Actuators, Plant};
use sophie_sim::scenario::Scenario;
use sophie_tasks::pilot::telemetry::parse_mode_text;
use uf_crsf::{CrsfParser, Packet};

use crate::bench_operator::BenchOperator;
use crate::elf::Firmware;
use crate::emulator::{Emulator, Settings};
use crate::esc::SILENCE;
use crate::log::{Line, Log};
use crate::plan::Plan;
use crate::sensors::Sensors;
use crate::terminal::Sockets;
use crate::tilt::{TiltError, Tilts};
use crate::wires::{BoardFault, Digest, FarEnd, Pins, Run, Wires};

/// Arms hang free from this height on, m.
const AIRBORNE: f64 = 0.3;

/// A vehicle with the emulated board.
pub struct ClosedLoop<'a> {
    /// `None` before power-on.
    emulator: Option<Emulator>,
    firmware: &'a Firmware,
    settings: Settings,
    sensors: Sensors,
    flow_module: Option<FlowSender>,
    /// `None`: the vehicle stands alone.
    operator: Option<BenchOperator>,
    plan: Plan,
    wires: Wires,
    pins: Pins,
    log: Log<'a>,
    sockets: Sockets,
    mavlink_received: u64,
    on_line: Box<dyn FnMut(&Line) + 'a>,
    telemetry: VecDeque<u8>,
    display: Telemetry,
    status: Option<Status>,
    grip: PerArm<ArmGrip>,
    proven: bool,
    setpoint: [f64; 3],
    /// Last reset of the mission, number of resets, whether the board is down.
    reset: Option<Reset>,
    cuts: u32,
    dead: bool,
    overruns: BTreeMap<String, u32>,
    log_digest: Digest,
    params: Params,
    protocol: RcProtocol,
    watched: Watched,
    tilts: Tilts,
    /// Log lines.
    pub lines: Vec<Line>,
    raw: Vec<u8>,
    /// Time (ms since power-on) and cause.
    pub resets: Vec<(f64, String)>,
}

struct Status {
    mode: Mode,
    reason: String,
    warning: String,
}

#[derive(Default)]
struct Watched {
    tilt: PerArm<f64>,
    voltage: f64,
}

/// Results of a run.
pub struct Finished {
    /// The emulator's record.
    pub run: Run,
    /// By task, as last logged.
    pub overruns: BTreeMap<String, u32>,
    /// Digest of all log lines with their times.
    pub log_digest: u64,
    /// Arm tilt in flight, measured less modelled.
    pub tilt_error: TiltError,
    /// Log lines.
    pub lines: Vec<Line>,
    /// The log as written by the firmware.
    pub log: Vec<u8>,
    /// Time (ms since power-on) and cause.
    pub resets: Vec<(f64, String)>,
    /// Parts that could not be decoded.
    pub malformed: u32,
    /// Bytes that MAVLink clients sent to the board.
    pub mavlink_received: u64,
}

/// Settings of a run.
pub struct Setup {
    /// Instructions per core cycle.
    pub speed: f64,
    /// Planned troubles.
    pub plan: Plan,
    /// Serial lines on sockets.
    pub sockets: Sockets,
}

impl<'a> ClosedLoop<'a> {
    /// Runs `firmware` as in `setup` with the parameters of `scenario` and a calibrated accelerometer; `logged` receives
    /// log lines.
    pub fn new(
        firmware: &'a Firmware,
        scenario: &Scenario,
        setup: Setup,
        logged: impl FnMut(&Line) + 'a,
    ) -> Self {
        let Setup { speed, plan, sockets } = setup;
        let sensors = Sensors::new(scenario);
        let [accel_bias_x, accel_bias_y, accel_bias_z] = sensors.calibration;
        let flow_module = FlowSender::of(scenario);
        let params = Params {
            accel_bias_x,
            accel_bias_y,
            accel_bias_z,
            // The simulated board reads its module whatever the port.
            flow_port: flow_module
                .as_ref()
                .map_or(scenario.params.flow_port, |_| FlowPort::Msp),
            ..scenario.params
        };
        Self {
            emulator: None,
            firmware,
            settings: Settings {
                speed,
                params,
                esc: scenario.vehicle.esc,
            },
            sensors,
            flow_module,
            operator: None,
            plan,
            wires: Wires::default(),
            pins: Pins::default(),
            log: Log::new(&firmware.table),
            sockets,
            mavlink_received: 0,
            on_line: Box::new(logged),
            telemetry: VecDeque::new(),
            display: Telemetry::default(),
            status: None,
            grip: [ArmGrip::default(); 4],
            proven: false,
            setpoint: [f64::NAN; 3],
            reset: None,
            cuts: 0,
            dead: false,
            overruns: BTreeMap::new(),
            log_digest: Digest::default(),
            params,
            protocol: params.rc_protocol,
            watched: Watched::default(),
            tilts: Tilts::new(&params),
            lines: Vec::new(),
            raw: Vec::new(),
            resets: Vec::new(),
        }
    }

    /// The same vehicle, uncalibrated, with a bench operator.
    #[must_use]
    pub fn with_operator(mut self, operator: BenchOperator) -> Self {
        let Params {
            accel_bias_x,
            accel_bias_y,
            accel_bias_z,
            ..
        } = Params::DEFAULT;
        self.settings.params = Params {
            accel_bias_x,
            accel_bias_y,
            accel_bias_z,
            ..self.settings.params
        };
        self.operator = Some(operator);
        self
    }

    /// Ends the run.
    ///
    /// # Errors
    /// One line: why the emulator failed.
    pub fn finish(mut self) -> Result<Finished, String> {
        let emulator = self.emulator.as_mut().ok_or("the board was never powered")?;
        Ok(Finished {
            run: emulator.finish()?,
            overruns: self.overruns,
            log_digest: self.log_digest.0,
            tilt_error: self.tilts.error,
            lines: self.lines,
            log: self.raw,
            resets: self.resets,
            malformed: self.log.malformed,
            mavlink_received: self.mavlink_received,
        })
    }

    /// Present state of the pins.
    #[must_use]
    pub fn pins(&self) -> &Pins {
        &self.pins
    }

    fn hear(&mut self, line: Line) {
        (self.on_line)(&line);
        self.log_digest.word(line.ms);
        line.text.bytes().for_each(|byte| self.log_digest.byte(byte));
        if let Some((mode, reason)) = parse_mode_text(&line.text) {
            self.proven &= !matches!(mode, Mode::Releasing | Mode::Flight | Mode::Disarmed);
            let warning = self.status.take().map_or(String::new(), |s| s.warning);
            self.status = Some(Status {
                mode,
                reason: reason.to_owned(),
                warning,
            });
        } else if let Some(warning) = line.text.strip_prefix("warning: ")
            && let Some(status) = &mut self.status
        {
            warning.clone_into(&mut status.warning);
        } else if line.text == "grip proven" {
            self.proven = true;
        } else if let Some((arm, grip)) = parse_grip(&line.text) {
            self.grip[arm] = grip;
        } else if let Some((task, count)) = parse_overruns(&line.text) {
            self.overruns.insert(task.to_owned(), count);
        }
        self.lines.push(line);
    }

    fn pressure(&self) -> PerArm<f64> {
        let mut pressure = [0.0; 4];
        let scales = FsrScale::all(&self.params);
        for ((slot, scale), counts) in pressure.iter_mut().zip(scales).zip(self.sensors.pressure_counts) {
            *slot = f64::from(scale.pressure(counts));
        }
        pressure
    }

    fn thrusts(&self) -> PerArm<f32> {
        let curve = ThrustCurve::from_params(&self.params);
        let ratio = self.watched.voltage as f32 / self.params.battery_nominal;
        self.drives().map(|command| curve.thrust(command as f32, ratio))
    }

    /// Commands of the rotors, wired as the parameters have it.
    fn drives(&self) -> PerArm<f64> {
        at_rotors(&self.params.motor_map.rotors(), &self.pins.motors)
    }

    fn tension(&self) -> PerArm<f64> {
        let mut force = [0.0; 4];
        let pins = self.pins.servos.into_iter().zip(self.watched.tilt);
        for ((force, (pulse, tilt)), reel) in force.iter_mut().zip(pins).zip(Reel::all(&self.params)) {
            if pulse > 0.0 {
                *force = f64::from(reel.force(reel.angle_of(pulse as f32), tilt as f32));
            }
        }
        force
    }
}

impl Aircraft for ClosedLoop<'_> {
    fn step_world(&mut self, plant: &mut Plant) {
        self.plan
            .apply(self.pins.ms, &mut self.sensors, &mut self.wires.faults);
        let mut actuators = Actuators {
            motors: self.drives(),
            servos: self.pins.servos,
        };
        let held = self.operator.as_mut().map(|operator| {
            actuators.motors = operator.wired(&self.pins.motors);
            operator.step(&self.pins, plant)
        });
        if let Some(frame) = held.as_ref().and_then(|held| held.frame(self.pins.ms)) {
            let words = frame.iter().map(|byte| on_line(RcProtocol::Crsf, *byte));
            self.plan.radio(words, &mut self.wires.receiver);
        }
        if let Some(charge) = held.as_ref().and_then(|held| held.battery) {
            plant.change_battery(charge);
        }
        self.sensors
            .step(plant, &actuators, held.as_ref(), &mut self.wires);
        if let Some(module) = &mut self.flow_module {
            module.step(plant);
            let frames = iter::from_fn(|| module.take(self.pins.ms * 1000));
            self.wires.ground = frames.flatten().collect();
        }
        self.watched.tilt = plant.tilt();
        self.watched.voltage = plant.battery_voltage();
        let [roll, ..] = plant.euler();
        let thrusts = self.thrusts();
        let flies = self.mode() == Mode::Flight && -plant.pose().position.z > AIRBORNE;
        self.tilts.step(&thrusts, &self.wires.arms, roll, flies);
    }

    fn take_telemetry(&mut self, buffer: &mut [u8]) -> usize {
        let count = self.telemetry.len().min(buffer.len());
        for (slot, byte) in buffer.iter_mut().zip(self.telemetry.drain(..count)) {
            *slot = byte;
        }
        count
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.setpoint = match (self.mode(), sticks(self.protocol, bytes)) {
            (Mode::Flight, Some(sticks)) => {
                let angle = self.params.stick_angle;
                [sticks.roll * angle, sticks.pitch * angle, f32::NAN].map(f64::from)
            }
            // Answers of sensors between frames use the same line.
            (Mode::Flight, None) => self.setpoint,
            _ => [f64::NAN; 3],
        };
        let words = bytes.iter().map(|byte| on_line(self.protocol, *byte));
        self.plan.radio(words, &mut self.wires.receiver);
    }

    fn run_until(&mut self, us: u64) -> Result<(), String> {
        while self.pins.ms * 1000 < us {
            let emulator = match &mut self.emulator {
                Some(emulator) => emulator,
                off => off.insert(Emulator::power_on(self.firmware, self.settings)?),
            };
            self.pins = emulator.advance(std::mem::take(&mut self.wires))?;
            let ms = self.pins.ms;
            if let Some(console) = &mut self.sockets.console {
                self.wires.console = console.exchange(&self.pins.console);
            }
            if let Some(client) = &mut self.sockets.mavlink {
                self.wires.mavlink = client.exchange(&self.pins.mavlink);
                self.mavlink_received += self.wires.mavlink.len() as u64;
            }
            let telemetry = FarEnd {
                heard: std::mem::take(&mut self.pins.telemetry),
                waiting: 0,
            };
            if let Some(listener) = &mut self.sockets.telemetry {
                let _ = listener.exchange(&telemetry);
            }
            let bytes = telemetry.heard;
            self.display.take(&bytes);
            self.telemetry.extend(bytes);
            for (at, why) in std::mem::take(&mut self.pins.resets) {
                self.resets.push((at as f64 * 1e-6, why));
                self.dead = false;
                self.status = None;
            }
            let log = std::mem::take(&mut self.pins.log);
            self.raw.extend(&log);
            for line in self.log.take(ms, &log) {
                self.hear(line);
            }
        }
        Ok(())
    }

    fn status(&self) -> Option<ReportedStatus<'_>> {
        self.status.as_ref().map(|s| ReportedStatus {
            mode: s.mode,
            reason: &s.reason,
            warning: &s.warning,
        })
    }

    fn grip(&self) -> Option<GripState> {
        Some(GripState {
            proven: self.proven,
            arms: self.grip,
            ..GripState::default()
        })
    }

    fn estimate(&self) -> StackEstimate {
        StackEstimate {
            attitude: self.display.attitude.unwrap_or([f64::NAN; 3]),
            setpoint: self.setpoint,
            tilt_measured: self.tilts.measured,
            tilt_model: self.tilts.modelled(),
            thrust_asked: self.thrusts().map(f64::from),
            tension_asked: self.tension(),
            pressure: self.pressure(),
            saturated: false,
            // The frames read here carry no position.
            position: None,
            pose: None,
            range: None,
            flow: None,
        }
    }

    fn motors(&self) -> PerArm<f64> {
        let restarted = self.resets.last().map_or(f64::NEG_INFINITY, |(at, _)| *at);
        // During a reset the controllers keep their last command until they time out; no code asks for it.
        if self.dead || self.pins.ms as f64 - restarted < SILENCE as f64 * 1e-6 {
            return [0.0; 4];
        }
        self.drives()
    }

    // The processor stands still until its watchdog's reset; other causes are refused beforehand.
    fn cut(&mut self, cause: StartCause, step: usize, at: f64) {
        self.wires.faults.push(BoardFault::Hang(true));
        self.reset = Some(Reset { cause, step, at });
        self.cuts += 1;
        self.dead = true;
    }

    fn start(&mut self, _: u64) {}

    fn runs(&self) -> bool {
        !self.dead
    }

    fn reset(&self) -> Option<Reset> {
        self.reset
    }

    fn resets(&self) -> u32 {
        self.cuts
    }

    fn overruns(&self) -> u32 {
        self.overruns.values().sum()
    }
}

/// `None` for frames without sticks.
fn sticks(protocol: RcProtocol, mut frame: &[u8]) -> Option<Sticks> {
    match protocol {
        RcProtocol::Crsf => match CrsfParser::default().next_packet(&mut frame) {
            Some(Ok(Packet::RCChannels(channels))) => Sticks::from_channels(&channels.0).ok(),
            _ => None,
        },
        RcProtocol::Sbus => sbus::Frame::decode(frame.try_into().ok()?)?.sticks().ok(),
    }
}

/// SBUS adds even parity as the top bit.
fn on_line(protocol: RcProtocol, byte: u8) -> u16 {
    let parity = match protocol {
        RcProtocol::Crsf => 0,
        RcProtocol::Sbus => byte.count_ones() as u16 & 1,
    };
    u16::from(byte) | parity << 8
}

/// Parses `grip: arm 1 holds 947 N/m2 with 34 N, closed in 5.6 s`.
fn parse_grip(text: &str) -> Option<(usize, ArmGrip)> {
    let (arm, rest) = text.strip_prefix("grip: arm ")?.split_once(" holds ")?;
    let (pressure, rest) = rest.split_once(" N/m2 with ")?;
    let (force, rest) = rest.split_once(" N, closed in ")?;
    let closure = rest.strip_suffix(" s")?;
    let arm = arm.parse::<usize>().ok()?.checked_sub(1).filter(|arm| *arm < 4)?;
    let grip = ArmGrip {
        state: ArmState::Holding,
        pressure: pressure.parse().ok()?,
        force: force.parse().ok()?,
        closure: Some(closure.parse().ok()?),
        fault: None,
        response: None,
    };
    Some((arm, grip))
}

/// Parses `imu: 3 overruns in 12000 runs; worst: …`.
fn parse_overruns(text: &str) -> Option<(&str, u32)> {
    let (task, rest) = text.split_once(": ")?;
    let (count, _) = rest.split_once(" overruns in ")?;
    Some((task, count.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_is_understood() {
        let (arm, grip) = parse_grip("grip: arm 3 holds 947.25 N/m2 with 33.5 N, closed in 3.65 s").unwrap();
        assert_eq!((arm, grip.closure), (2, Some(3.65)));
        assert!((grip.pressure - 947.25).abs() < 1e-3 && (grip.force - 33.5).abs() < 1e-3);
        assert_eq!(
            parse_grip("grip: arm 5 holds 1 N/m2 with 1 N, closed in 1 s"),
            None
        );
        assert_eq!(
            parse_overruns("imu: 3 overruns in 12000 runs; worst: 1 us late, 2 us response, 3 us execution"),
            Some(("imu", 3))
        );
        assert_eq!(parse_overruns("imu: self-test passed"), None);
    }

    #[test]
    fn an_sbus_word_has_an_even_number_of_ones() {
        assert_eq!(on_line(RcProtocol::Sbus, 0x0F), 0x0F);
        assert_eq!(on_line(RcProtocol::Sbus, 0x07), 0x107);
        assert_eq!(on_line(RcProtocol::Crsf, 0x07), 0x07);
    }

    #[test]
    fn the_sticks_of_a_frame_are_read() {
        let sent = Sticks {
            roll: 0.5,
            ..Sticks::default()
        };
        let read = sticks(RcProtocol::Crsf, &sophie_sim::devices::crsf::rc_frame(&sent)).unwrap();
        assert!((read.roll - 0.5).abs() < 0.02);
        assert!(sticks(RcProtocol::Crsf, &[1, 2, 3]).is_none());
        let frame = sbus::Frame {
            channels: [1500; 16],
            ..sbus::Frame::default()
        };
        let read = sticks(RcProtocol::Sbus, &frame.encode()).unwrap();
        assert!((read.roll - 0.62).abs() < 0.02);
        assert!(sticks(RcProtocol::Sbus, &[1, 2, 3]).is_none());
    }
}
