//! The law on a point mass with the tilt's lag, in wind, against its limits.

extern crate std;
use super::*;
use crate::attitude::gains::Gains as LoopGains;

const DT: f32 = 0.01;
const UNDER: u8 = 10;

/// A vehicle whose tilt follows as the gains' model has it, by Euler at 1 kHz.
struct World {
    law: PositionHold,
    e: Estimate,
    /// What the law knows, and the motors' true lag, s.
    params: Params,
    lag: f32,
    /// Tilt forward and right, its rate and second derivative; the filter's stages.
    tilt: [[f32; 3]; 2],
    stages: [[f32; 2]; 2],
    wind: Vec3,
    command: VelocityCommand,
    known: bool,
    yaw: f32,
    out: Setpoint,
}

impl World {
    fn new(yaw: f32, yaw_offset: f32) -> Self {
        Self::of(&Params::DEFAULT, Params::DEFAULT.motor_tau, yaw, yaw_offset)
    }

    fn of(params: &Params, lag: f32, yaw: f32, yaw_offset: f32) -> Self {
        let e = Estimate {
            yaw_offset,
            ..Estimate::default()
        };
        let motion = BodyMotion {
            q: Quat::from_euler(0.0, 0.0, yaw),
            rate: Vec3::ZERO,
            carried: false,
        };
        Self {
            law: PositionHold::begin(
                params,
                &gains::Gains::of(params),
                4.0 * params.thrust_max,
                &e,
                &motion,
            ),
            e,
            params: *params,
            // The lead is the same with the true motors behind it.
            lag: lag / (1.0 + LoopGains::of(params).lead),
            tilt: [[0.0; 3]; 2],
            stages: [[0.0; 2]; 2],
            wind: Vec3::ZERO,
            command: VelocityCommand::default(),
            known: true,
            yaw,
            out: Setpoint::Stop,
        }
    }

    fn motion(&self) -> BodyMotion {
        let [[f, fr, _], [r, rr, _]] = self.tilt;
        let q = Quat::from_euler(scalar::asin(r / GRAVITY), -scalar::asin(f / GRAVITY), self.yaw);
        BodyMotion {
            q,
            rate: Vec3::new(rr / GRAVITY, -fr / GRAVITY, 0.0),
            carried: false,
        }
    }

    fn step(&mut self) {
        let p = LoopGains::of(&self.params);
        self.out = self
            .law
            .step(&self.e, &self.motion(), &self.command, self.known, DT);
        let Setpoint::Angle {
            roll, pitch, thrust, ..
        } = self.out
        else {
            panic!("{:?}", self.out)
        };
        let aim = [-GRAVITY * pitch.sin(), GRAVITY * roll.sin() * pitch.cos()];
        let lag = p.setpoint_cutoff;
        let dt = DT / f32::from(UNDER);
        for _ in 0..UNDER {
            let [roll_p, pitch_p] = p.rate_p;
            let rate_p = [pitch_p, roll_p];
            for (((t, s), u), rate_p) in self.tilt.iter_mut().zip(&mut self.stages).zip(aim).zip(rate_p) {
                s[0] += lag * (u - s[0]) * dt;
                s[1] += lag * (s[0] - s[1]) * dt;
                let asked = rate_p * (p.attitude_p * (s[1] - t[0]) - t[1]);
                t[2] += (asked - t[2]) / self.lag * dt;
                t[1] += t[2] * dt;
                t[0] += t[1] * dt;
            }
            let [[f, ..], [r, ..]] = self.tilt;
            let up = thrust / self.params.mass - GRAVITY;
            let horizontal = about_down(Vec3::new(f, r, 0.0), self.yaw + self.e.yaw_offset);
            let a = horizontal + self.wind - Vec3::new(0.0, 0.0, up);
            self.e.velocity += a * dt;
            self.e.position += self.e.velocity * dt;
        }
        self.e.disturbance = self.wind;
    }

    fn run(&mut self, seconds: f32) -> &Estimate {
        for _ in 0..(seconds / DT) as u32 {
            self.step();
        }
        &self.e
    }
}

#[test]
fn a_displaced_vehicle_returns_with_little_overshoot_whatever_its_heading() {
    for (yaw, yaw_offset) in [(0.0, 0.0), (1.2, 0.7), (3.0, -1.0)] {
        let mut w = World::new(yaw, yaw_offset);
        w.e.position = Vec3::new(0.3, -0.2, 0.1);
        let start = w.e.position;
        let mut over = 0.0f32;
        for _ in 0..600 {
            w.step();
            over = over.max(-w.e.position.dot(start) / start.norm());
        }
        assert!(
            w.e.position.norm() < 0.01,
            "{yaw} {yaw_offset}: {:?}",
            w.e.position
        );
        assert!(over < 0.05, "{yaw} {yaw_offset}: {over}");
    }
}

#[test]
fn slow_motors_are_held_known_or_not() {
    for (told, lag) in [
        (0.12, 0.12),
        (0.09, 0.09),
        (0.09, 0.12),
        (0.09, 0.06),
        (0.05, 0.09),
        (0.05, 0.03),
    ] {
        let params = Params {
            motor_tau: told,
            ..Params::DEFAULT
        };
        let mut w = World::of(&params, lag, 1.2, 0.7);
        w.e.position = Vec3::new(0.3, -0.2, 0.1);
        let start = w.e.position;
        let mut over = 0.0f32;
        for _ in 0..1500 {
            w.step();
            over = over.max(-w.e.position.dot(start) / start.norm());
        }
        assert!(w.e.position.norm() < 0.02, "{told} {lag}: {:?}", w.e.position);
        assert!(over < 0.1, "{told} {lag}: {over}");
    }
}

#[test]
fn a_steady_wind_leaves_no_error_and_more_than_the_limit_is_not_fought() {
    let mut w = World::new(0.5, 0.0);
    // 1 N and 3 N.
    for wind in [0.55, 1.66] {
        w.wind = Vec3::new(0.6 * wind, -0.8 * wind, 0.3);
        let p = w.run(25.0).position;
        assert!(p.norm() < 0.015, "{wind}: {p:?}");
    }
    w.wind = Vec3::new(10.0, 0.0, 0.0);
    w.run(0.5);
    let [roll, pitch, ..] = w.out.numbers();
    let asked = GRAVITY * (roll.tan().powi(2) + pitch.tan().powi(2)).sqrt();
    assert!(asked < 1.03 * ACCELERATION_MAX, "{asked}");
}

#[test]
fn sticks_ask_for_velocities_along_the_heading_and_centred_they_stop() {
    let mut w = World::new(1.0, 0.5);
    w.command.velocity = Vec3::new(1.0, 0.0, -0.4);
    let v = w.run(6.0).velocity;
    let wanted = about_down(w.command.velocity, 1.5);
    assert!((v - wanted).norm() < 0.03, "{v:?} {wanted:?}");
    w.command = VelocityCommand::default();
    w.run(5.0);
    let held = w.e.position;
    w.run(5.0);
    assert!(w.e.velocity.norm() < 0.01 && (w.e.position - held).norm() < 0.02);
}

/// Back and forth across a pipe, as an approach does: without the course's acceleration the vehicle overtook the held point
/// by 12 cm at each turn.
#[test]
fn at_a_turn_the_vehicle_follows_the_held_point() {
    let mut w = World::new(0.7, 0.0);
    let (mut off, mut led) = (0.0f32, Vec3::ZERO);
    for i in 0..1200u32 {
        // Speeds that change by 0.3 m/s², up to 0.25 m/s.
        let t = i as f32 * DT;
        let phase = (t / 2.0) % 2.0;
        let commanded = (0.6 * (phase - 1.0).abs() - 0.3).clamp(-0.25, 0.25);
        w.command.velocity = Vec3::new(0.0, commanded, 0.0);
        w.step();
        led += about_down(w.command.velocity, 0.7) * DT;
        off = off.max((w.e.position - w.law.anchor).norm());
    }
    assert!(off < 0.04, "{off}");
    // Where the wishes have led it is where it comes to rest.
    assert!((w.law.held() - led).norm() < 0.03, "{:?} {led:?}", w.law.held());
    w.command = VelocityCommand::default();
    let goal = w.law.held();
    w.run(6.0);
    assert!((w.e.position - goal).norm() < 0.04, "{:?} {goal:?}", w.e.position);
}

/// Down onto a gate, as an approach does: without the change of the command it fell behind by 5 cm, and sank at 0.26 m/s
/// instead of 0.2 to catch up, past where it was to stop.
#[test]
fn on_the_way_down_it_follows_the_held_height() {
    let mut w = World::new(0.0, 0.0);
    w.run(1.0);
    let (mut off, mut fastest) = (0.0f32, 0.0f32);
    for i in 0..300 {
        w.command.velocity.z = if i < 150 { 0.2 } else { 0.0 };
        w.step();
        off = off.max((w.e.position.z - w.law.anchor.z).abs());
        fastest = fastest.max(w.e.velocity.z);
    }
    assert!(off < 0.01 && fastest < 0.21, "{off} m, {fastest} m/s");
}

#[test]
fn a_step_of_no_time_asks_for_a_finite_tilt() {
    let mut w = World::new(0.0, 0.0);
    w.command.velocity.y = 0.3;
    for dt in [DT, 0.0, DT] {
        let asked = w.law.step(&w.e, &w.motion(), &w.command, true, dt);
        assert!(asked.is_finite(), "{dt}: {asked:?}");
    }
}

#[test]
fn what_is_touched_is_not_learnt_as_wind() {
    let mut w = World::new(0.0, 0.0);
    w.wind = Vec3::new(0.3, 0.0, 0.0);
    w.run(20.0);
    // Pressed at by 4 N, held where it is; then free again.
    let learnt = w.law.wind;
    w.e.disturbance = Vec3::new(2.5, 0.0, 0.0);
    for _ in 0..200 {
        w.law.step(&w.e, &w.motion(), &w.command, true, DT);
    }
    assert_eq!(w.law.wind, learnt);
    let carried = BodyMotion {
        carried: true,
        ..w.motion()
    };
    w.e.disturbance = Vec3::new(0.6, 0.0, 0.0);
    for _ in 0..200 {
        w.law.step(&w.e, &carried, &w.command, true, DT);
    }
    assert_eq!(w.law.wind, learnt);
}

#[test]
fn a_jump_of_the_origin_moves_the_held_point_and_a_push_leaves_it_in_reach() {
    let mut w = World::new(0.0, 0.0);
    w.run(1.0);
    w.e.position = Vec3::new(50.0, 20.0, -3.0);
    w.e.reset_count = 1;
    w.run(3.0);
    assert!((w.e.position - Vec3::new(50.0, 20.0, -3.0)).norm() < 0.02);
    w.e.position.x += 5.0;
    w.step();
    assert!((w.law.anchor.x - w.e.position.x).abs() < 1.01 * LEASH);
}

#[test]
fn sinking_onto_something_hands_over_the_weight() {
    let mut w = World::new(0.0, 0.0);
    w.command.velocity.z = CLIMB_MAX;
    let carried = BodyMotion {
        carried: true,
        ..w.motion()
    };
    let mut thrust = f32::MAX;
    for _ in 0..300 {
        thrust = w.law.step(&w.e, &carried, &w.command, true, DT).thrust();
    }
    assert!(thrust < 0.5, "{thrust}");
    // Lifted again, it carries at once.
    w.command.velocity.z = 0.0;
    for _ in 0..100 {
        thrust = w.law.step(&w.e, &carried, &w.command, true, DT).thrust();
    }
    assert!(thrust > 0.4 * Params::DEFAULT.mass * GRAVITY, "{thrust}");
}
