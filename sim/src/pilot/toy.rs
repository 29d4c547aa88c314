//! A simple vehicle for the pilot's tests: a point mass with lags, the real mode logic and a scripted grip.

use glam::{DVec2, DVec3};
use sophie_control::attitude::motion::Motion;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::gripper::clamp_command::ClampCommand;
use sophie_control::gripper::grip::{ArmGrip, ArmState, GripState};
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::mode::{Inputs, ModeLogic, Outputs};
use sophie_control::pilot::rc::Sticks;
use uf_crsf::packets::{FlightMode, PacketAddress};
use uf_crsf::{CrsfParser, Packet, write_packet_to_buffer};

use super::{Pilot, PilotOutput, VisibleState};
use crate::plant::gust::Gust;
use crate::scenario::Scenario;

pub const DT: f64 = 0.002;
/// Height of the centre of mass over the ground or pipe at rest, m.
const BELLY: f64 = 0.04;
/// Time that the arms take to close and to open, s.
const CLOSING: f64 = 3.0;

pub struct Toy {
    pub pilot: Pilot,
    pub seen: VisibleState,
    pub out: Outputs,
    pub sticks: Option<Sticks>,
    /// Steady force of the wind, N.
    pub wind: DVec3,
    /// Acceleration off the crown per distance from it, 0.2 m at most, 1/s², on the pipe; it falls with the height over it, by 0.15 m.
    pub push_off: f64,
    /// Grip pressure that the closing reaches, Pa.
    pub pressure: f32,
    /// Thrust of the real rotors over the nominal ones.
    pub strength: f64,
    /// Voltage of the flight battery, V.
    pub battery: f32,
    /// The receiver hears nothing.
    pub deaf: bool,
    /// Uncommanded yaw rate, rad/s.
    pub spin: f64,
    scenario: Scenario,
    gust: Gust,
    logic: ModeLogic,
    parser: CrsfParser,
    setpoint: DVec2,
    thrust: f64,
    closed: f64,
    steps: u64,
    acceleration: DVec3,
}

impl Toy {
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            pilot: Pilot::new(scenario),
            seen: VisibleState {
                position: DVec3::new(0.0, 0.0, -BELLY),
                ..Default::default()
            },
            out: Outputs::default(),
            sticks: None,
            wind: DVec3::ZERO,
            push_off: 0.0,
            pressure: 950.0,
            strength: 1.0,
            battery: 15.5,
            deaf: false,
            spin: 0.0,
            scenario: scenario.clone(),
            gust: Gust::new(scenario.world.gust_force, 0.0, scenario.streams()),
            logic: ModeLogic::new(&scenario.params),
            parser: CrsfParser::new(),
            setpoint: DVec2::ZERO,
            thrust: 0.0,
            closed: 0.0,
            steps: 0,
            acceleration: DVec3::ZERO,
        }
    }

    /// Flies until the pilot has ended or `seconds` have passed.
    pub fn fly(&mut self, seconds: f64, mut watch: impl FnMut(&Self, &PilotOutput)) {
        for _ in 0..(seconds / DT) as u64 {
            let out = self.step();
            watch(self, &out);
            if out.outcome.is_some() {
                return;
            }
        }
    }

    pub fn step(&mut self) -> PilotOutput {
        self.steps += 1;
        let mut telemetry = [0; 64];
        let mut count = 0;
        if self.steps.is_multiple_of(50) {
            let text = match self.out.reason {
                None => self.out.mode.name().to_owned(),
                Some(why) => format!("{}: {}", self.out.mode.name(), why.text()),
            };
            let packet = FlightMode::new(&text).unwrap();
            count = write_packet_to_buffer(&mut telemetry, PacketAddress::FlightController, &packet).unwrap();
        }
        let out = self.pilot.step(DT, self.seen, &telemetry[..count]);
        if let Some(frame) = &out.rc_bytes {
            let mut bytes = frame.as_slice();
            while let Some(packet) = self.parser.next_packet(&mut bytes) {
                if let Ok(Packet::RCChannels(c)) = packet {
                    self.sticks = Sticks::from_channels(&c.0).ok();
                }
            }
        }
        if self.steps.is_multiple_of(5) {
            self.command();
        }
        self.move_on();
        out
    }

    fn command(&mut self) {
        let dt = 5.0 * DT;
        let close = matches!(self.out.tendons, ClampCommand::Close { .. });
        self.closed = (self.closed + if close { dt } else { -3.0 * dt }).clamp(0.0, CLOSING + 1.0);
        let pressure = self.pressure * (self.closed / CLOSING).min(1.0) as f32;
        let state = if self.closed > 0.0 {
            ArmState::Touching
        } else {
            ArmState::Free
        };
        let proven = self.closed > CLOSING + 0.5 && (pressure - 950.0).abs() < 50.0;
        let s = &self.seen;
        let q = Quat::from_euler(s.roll as f32, s.pitch as f32, s.yaw as f32);
        let [north, east, down] = self.acceleration.to_array().map(|a| a as f32);
        let on_pipe = q.rotate_inverse(Vec3::new(north, east, down - GRAVITY));
        let inputs = Inputs {
            sticks: self.sticks.filter(|_| !self.deaf),
            motion: Some(Motion {
                q,
                accel: on_pipe,
                calibrated: s.t > 2.0,
                ..Default::default()
            }),
            lift: self.out.rotors.thrust(),
            grip: Some(GripState {
                proven,
                misfit: None,
                released: self.closed <= 0.0,
                arms: [ArmGrip {
                    state,
                    pressure,
                    ..Default::default()
                }; 4],
            }),
            battery: Some(self.battery),
            ..Default::default()
        };
        self.out = self.logic.step(&inputs, dt as f32);
    }

    fn move_on(&mut self) {
        let (roll, pitch, yaw_rate, thrust) = match self.out.rotors {
            Setpoint::Stop | Setpoint::Spin(_) | Setpoint::StaticThrust(_) => (0.0, 0.0, 0.0, 0.0),
            Setpoint::Idle => (0.0, 0.0, 0.0, 1.0),
            Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                thrust,
            }
            | Setpoint::Escape {
                roll,
                pitch,
                yaw_rate,
                thrust,
            } => (roll, pitch, yaw_rate, thrust),
            Setpoint::Resting { roll, pitch, thrust } => (roll, pitch, 0.0, thrust),
            // Spooling down in a proven grip: no moments.
            Setpoint::Direct { wrench } => {
                (self.seen.roll as f32, self.seen.pitch as f32, 0.0, wrench.thrust)
            }
            Setpoint::Rate { .. } => panic!("the pilot flies angles"),
        };
        let s = &mut self.seen;
        self.setpoint += (DVec2::new(f64::from(roll), f64::from(pitch)) - self.setpoint) * (10.0 * DT);
        s.roll += (self.setpoint.x - s.roll) * (4.5 * DT);
        s.pitch += (self.setpoint.y - s.pitch) * (4.5 * DT);
        s.yaw += (f64::from(yaw_rate) + self.spin) * DT;
        // The mixer divides by the thrust learnt in flight.
        let thrust = f64::from(thrust / self.out.thrust_factor.value) * self.strength;
        self.thrust += (thrust - self.thrust) * (20.0 * DT);
        self.gust.step(DT);

        let mass = f64::from(self.scenario.params.mass);
        let lean = DVec2::from_angle(s.yaw).rotate(
            DVec2::new(-libm::tan(s.pitch), libm::tan(s.roll)) * (libm::cos(s.roll) * libm::cos(s.pitch)),
        );
        let up = libm::cos(s.roll) * libm::cos(s.pitch);
        let mut force = self.thrust * lean.extend(-up) + self.gust.force() + self.wind;
        force.z += mass * f64::from(GRAVITY);
        let over = -s.position.z - BELLY - self.scenario.world.pipe_top;
        let beside = s.position.y - self.scenario.world.pipe_position[1];
        force.y += mass * self.push_off * beside.clamp(-0.2, 0.2) * libm::exp(-over.max(0.0) / 0.15);
        let depth = floor(&self.scenario, s.position) + BELLY + s.position.z;
        if depth > 0.0 {
            let normal = (4000.0 * depth + 120.0 * s.velocity.z).max(0.0);
            force.z -= normal;
            let slip = (s.velocity.truncate() * 300.0).clamp_length_max(0.6 * normal);
            force -= slip.extend(0.0);
        }
        if self.closed > CLOSING {
            force -= s.velocity * 300.0;
            force.z = force.z.min(0.0);
        }
        let acceleration = force / mass;
        self.acceleration = acceleration;
        s.velocity += acceleration * DT;
        s.position += s.velocity * DT;
        s.t += DT;
    }
}

/// Height of the surface below, m: the upper half of 2 m of pipe, or the ground.
fn floor(scenario: &Scenario, position: DVec3) -> f64 {
    let w = &scenario.world;
    let radius = 0.5 * w.pipe_diameter;
    let [along, beside] = [position.x - w.pipe_position[0], position.y - w.pipe_position[1]];
    if along.abs() < 1.0 && beside.abs() < radius {
        w.pipe_top - radius + (radius * radius - beside * beside).sqrt()
    } else {
        0.0
    }
}
