//! Tasks analog, clamp and servos on four simple arms with faults: reactions, and no force beyond the limit.

use super::links::links_with;
use embassy_time::Instant;
use sophie_control::allocation::arm_deflection::ArmModel;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::gripper::clamp_command::ClampCommand;
use sophie_control::gripper::grip::{ArmState, GripState};
use sophie_control::gripper::grip_fault::GripFault;
use sophie_control::gripper::tendon::{ForceLimit, REFERENCE_TILT, Reel};
use sophie_control::params::Params;
use sophie_control::pilot::rc::ArmChoice;
use sophie_fakes::{Answer, FakeAnalog, FakeServos};
use sophie_sim::clock::VirtualTime;
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::ArmAngles;
use sophie_tasks::links::tendon_order::{TendonForce, TendonForces, TendonOrder};
use sophie_tasks::schedule::timing::Quantity;

/// Tilt without tendon force, and at the touch, rad.
const FREE_TILT: f32 = -0.2;
const TOUCH_TILT: f32 = -0.8;
/// Compliance on the pipe over that in the air.
const PRESSED: f32 = 0.2;
/// s.
const ARM_TIME: f32 = 0.03;
/// A pin shorted to the supply, counts.
const SHORTED: u16 = 4095;
/// µs.
const RELEASE_US: f32 = 550.0;
const CLOSE: ClampCommand = ClampCommand::Close { arms: ArmChoice::All };

/// Quasi-static arm on its tendon: a spring in the air, stiffer on the pipe.
#[derive(Clone, Copy)]
struct Arm {
    tilt: f32,
    /// Pressure per tendon force after the touch, Pa/N.
    stiffness: f32,
    /// Saturation of the skin, Pa.
    most: f32,
    pressure: f32,
    /// Pin counts instead of the pressure.
    pin: Option<u16>,
    tilt_alive: bool,
}

impl Arm {
    fn step(&mut self, pulse: f32, reel: &Reel, p: &Params, dt: f32) {
        let angle = if pulse > 0.0 {
            reel.angle_of(pulse).max(0.0)
        } else {
            0.0
        };
        let bend = ArmModel::from_params(p).slope(0.0) * p.tendon_bend * p.tendon_lever / p.arm_d;
        let force = |tilt: f32| {
            let stretch = p.reel_radius * angle - p.tendon_lever * (REFERENCE_TILT - tilt);
            (p.tendon_stiffness * stretch).max(0.0)
        };
        // Equilibrium of spring and tendon by bisection: the force grows with tilt.
        let (mut low, mut high) = (-2.5f32, FREE_TILT);
        let at_touch = (FREE_TILT - TOUCH_TILT) / bend;
        for _ in 0..30 {
            let tilt = 0.5 * (low + high);
            let held_by = if tilt > TOUCH_TILT {
                (FREE_TILT - tilt) / bend
            } else {
                at_touch + (TOUCH_TILT - tilt) / (PRESSED * bend)
            };
            if force(tilt) > held_by {
                high = tilt;
            } else {
                low = tilt;
            }
        }
        self.tilt += (low - self.tilt) * dt / (dt + ARM_TIME);
        let beyond = (TOUCH_TILT - self.tilt) / (PRESSED * bend);
        self.pressure = (self.stiffness * beyond).clamp(0.0, self.most);
    }

    fn counts(&self, p: &Params) -> u16 {
        let conductance = self.pressure * p.fsr_gain * p.fsr_area;
        let x = conductance * p.fsr_divider / (1.0 + conductance * p.fsr_divider);
        self.pin.unwrap_or((4095.0 * x) as u16)
    }
}

struct Bench {
    time: VirtualTime,
    links: &'static Links,
    converter: FakeAnalog,
    servos: FakeServos,
    arms: [Arm; 4],
    /// `None`: silent.
    command: Option<ClampCommand>,
    ms: u64,
    largest_force: f32,
}

impl Bench {
    fn new() -> Self {
        Self::with(Params::default())
    }

    fn with(params: Params) -> Self {
        let (time, links) = (VirtualTime::new(), links_with(params));
        let (converter, servos) = (FakeAnalog::default(), FakeServos::default());
        time.spawn(sophie_tasks::perching::analog::run(links, converter.clone()));
        time.spawn(sophie_tasks::perching::clamp::run(links));
        time.spawn(sophie_tasks::perching::servos::run(links, servos.clone()));
        let arm = Arm {
            tilt: FREE_TILT,
            stiffness: 40.0,
            most: f32::INFINITY,
            pressure: 0.0,
            pin: None,
            tilt_alive: true,
        };
        Self {
            time,
            links,
            converter,
            servos,
            arms: [arm; 4],
            command: None,
            ms: 0,
            largest_force: 0.0,
        }
    }

    fn holding() -> Self {
        Self::holding_with(Params::default())
    }

    fn holding_with(params: Params) -> Self {
        let mut bench = Self::with(params);
        bench.command = Some(CLOSE);
        bench.run(6.0);
        assert!(bench.grip().proven, "{:?}", bench.grip());
        bench
    }

    fn run(&mut self, seconds: f32) {
        let p = &self.links.params;
        let reels = Reel::all(p);
        for _ in 0..(seconds * 1e3) as u32 {
            self.ms += 1;
            let mut frame = self.converter.frame.get();
            let pulses = self.servos.now().into_iter().zip(&reels);
            for ((arm, (pulse, reel)), counts) in self.arms.iter_mut().zip(pulses).zip(&mut frame.fsr) {
                arm.step(pulse, reel, p, 1e-3);
                *counts = arm.counts(p);
            }
            self.converter.frame.set(frame);
            self.time.run_until(self.ms * 1000);
            if self.ms.is_multiple_of(10) {
                let now = Instant::now();
                let tilt = self.arms.map(|a| a.tilt_alive.then_some(a.tilt));
                self.links.arms.send(now, ArmAngles::at(now, tilt));
                if let Some(command) = self.command {
                    self.links.clamp_command.send(now, command);
                }
            }
            for force in self.forces() {
                assert!(force.is_finite() && force >= 0.0, "{force}");
                self.largest_force = self.largest_force.max(force);
            }
        }
        let limit = ForceLimit::from_params(p).asked;
        assert!(self.largest_force <= limit, "{} N", self.largest_force);
    }

    fn forces(&self) -> PerArm<f32> {
        self.links
            .tendons
            .latest()
            .map_or([0.0; 4], |t| t.value.forces().arms.map(|arm| arm.force))
    }

    fn grip(&self) -> GripState {
        self.links.grip.latest().map(|g| g.value).unwrap_or_default()
    }

    fn state(&self, arm: usize) -> ArmState {
        self.grip().arms[arm].state
    }
}

#[test]
fn four_sound_arms_close_hold_and_let_go() {
    let mut b = Bench::holding();
    for (arm, force) in b.arms.iter().zip(b.forces()) {
        assert!((arm.pressure - 950.0).abs() < 50.0, "{}", arm.pressure);
        assert!((20.0..100.0).contains(&force), "{force}");
    }
    b.command = Some(ClampCommand::Release);
    b.run(3.0);
    assert!(b.grip().released && !b.grip().proven);
    assert_eq!((b.forces(), b.servos.now()), ([0.0; 4], [RELEASE_US; 4]));
}

/// Servos: default, mirrored, trimmed, short of travel, slow.
fn mixed_servos() -> Params {
    Params {
        servo_release_2: 2450.0,
        servo_full_2: 550.0,
        servo_trim_3: -40.0,
        servo_release_3: 900.0,
        servo_full_3: 2100.0,
        servo_slew_4: 3.0,
        ..Params::default()
    }
}

#[test]
fn four_different_servos_close_hold_and_let_go_at_every_frame_rate() {
    for rate in [50.0, 100.0, 333.0] {
        let params = Params {
            servo_frame_rate: rate,
            ..mixed_servos()
        };
        let mut b = Bench::holding_with(params);
        for (arm, force) in b.arms.iter().zip(b.forces()) {
            assert!((arm.pressure - 950.0).abs() < 50.0, "{rate} Hz: {}", arm.pressure);
            assert!((20.0..100.0).contains(&force), "{rate} Hz: {force}");
        }
        let frames = b.servos.pulses.borrow().len() as f32;
        let expected = rate * b.ms as f32 * 1e-3;
        assert!(
            (frames / expected - 1.0).abs() < 0.01,
            "{rate} Hz: {frames} frames, {expected}"
        );
        b.command = Some(ClampCommand::Release);
        b.run(3.0);
        assert!(b.grip().released && !b.grip().proven, "{rate} Hz");
        assert_eq!(b.servos.now(), [550.0, 2450.0, 860.0, 550.0]);
    }
}

#[test]
fn no_servo_pulse_precedes_the_clamp_loop_and_none_pulls_before_its_order() {
    let (time, links, servos) = (
        VirtualTime::new(),
        links_with(Params::default()),
        FakeServos::default(),
    );
    time.spawn(sophie_tasks::perching::servos::run(links, servos.clone()));
    time.run_until(1_000_000);
    let silent = servos.pulses.borrow().len();
    assert!(silent >= 50 && servos.pulses.borrow().iter().all(|p| *p == [0.0; 4]));
    assert!(
        links.tension.latest().is_none(),
        "nothing is known of servos without a pulse"
    );

    // Without commander the clamp loop is silent too: arms may be on a pipe.
    time.spawn(sophie_tasks::perching::clamp::run(links));
    time.run_until(2_000_000);
    assert!(servos.pulses.borrow().iter().all(|p| *p == [0.0; 4]) && links.tendons.latest().is_none());
    links.clamp_command.send(Instant::now(), ClampCommand::Keep);
    time.run_until(2_150_000);
    assert!(servos.pulses.borrow().iter().all(|p| *p == [0.0; 4]) && links.tendons.latest().is_none());

    let silent = servos.pulses.borrow().len();
    links.clamp_command.send(Instant::now(), ClampCommand::Release);
    time.run_until(2_300_000);
    let pulses = servos.pulses.borrow();
    assert!(pulses.iter().skip(silent + 1).all(|p| *p == [RELEASE_US; 4]));
    let forces = links.tendons.fresh().map(|order| *order.forces());
    let forces = forces.unwrap();
    assert!(
        forces
            .arms
            .iter()
            .all(|arm| arm.force == 0.0 && !arm.hold_position)
    );
}

#[test]
fn an_open_sensor_is_found_out_by_the_arm_that_does_not_bend_on() {
    let mut b = Bench::new();
    b.command = Some(CLOSE);
    b.arms[1].pin = Some(0);
    b.run(8.0);
    assert_eq!(b.state(1), ArmState::Faulty, "{:?}", b.grip());
    assert!(!b.grip().proven);
    for arm in [0, 2, 3] {
        assert_eq!(b.state(arm), ArmState::Holding, "{arm}");
    }
    // Touch at 30 N, grip at 54 N: detected before the arm is pressed harder than the others.
    assert!((30.0..60.0).contains(&b.forces()[1]), "{:?}", b.forces());
    b.command = Some(ClampCommand::Release);
    b.run(3.0);
    assert!(b.grip().released, "what is open can still be let go");
}

#[test]
fn a_shorted_sensor_freezes_its_arm_and_no_other() {
    let mut b = Bench::holding();
    let before = b.forces()[2];
    b.arms[2].pin = Some(SHORTED);
    b.run(0.004);
    let contact = b.links.contact.fresh().unwrap();
    let faulty = contact.arms.map(|arm| arm.is_err());
    assert_eq!(faulty, [false, false, true, false]);
    b.run(0.03);
    assert_eq!(b.state(2), ArmState::Faulty);
    b.run(3.0);
    assert!((b.forces()[2] - before).abs() < 1.0, "{before} {:?}", b.forces());
    assert!(!b.grip().proven && b.state(0) == ArmState::Holding);
    b.arms[2].pin = None;
    b.run(1.0);
    assert_eq!(b.state(2), ArmState::Faulty);
    b.command = Some(ClampCommand::Release);
    b.run(3.0);
    assert!(b.grip().released);
    b.command = Some(CLOSE);
    b.run(6.0);
    assert!(b.grip().proven);
}

#[test]
fn a_converter_that_fails_or_hangs_holds_every_force() {
    for answer in [Answer::Fails, Answer::Refuses, Answer::Hangs] {
        let mut b = Bench::holding();
        b.converter.part.answer.set(answer);
        b.run(0.05);
        assert!(b.links.contact.fresh().is_none());
        assert!((0..4).all(|arm| b.state(arm) == ArmState::Faulty), "{answer:?}");
        let (forces, pulses) = (b.forces(), b.servos.now());
        b.run(2.0);
        assert_eq!(b.forces(), forces, "{answer:?}");
        assert!(!b.grip().proven);
        for (now, before) in b.servos.now().iter().zip(pulses) {
            assert!((now - before).abs() < 15.0, "{now} µs, {before} µs before");
        }
        assert!(!b.converter.part.spun.get());
        if answer != Answer::Hangs {
            b.converter.part.answer.set(Answer::Sound);
            b.run(2.0);
            assert!(b.grip().proven, "{answer:?}: {:?}", b.grip());
        }
    }
}

#[test]
fn an_arm_without_its_tilt_stands_still_and_can_still_be_let_go() {
    let mut b = Bench::new();
    b.command = Some(CLOSE);
    b.run(1.0);
    b.arms[3].tilt_alive = false;
    b.run(0.05);
    let (pulse, force) = (b.servos.now()[3], b.forces()[3]);
    assert!(pulse > RELEASE_US + 50.0, "it was on its way");
    b.run(0.4);
    assert_ne!(b.state(3), ArmState::Faulty, "a hiccup is no fault");
    b.run(5.0);
    assert_eq!(b.state(3), ArmState::Faulty);
    assert_eq!((b.servos.now()[3], b.forces()[3]), (pulse, force));
    assert!(b.state(0) == ArmState::Holding && !b.grip().proven);
    b.command = Some(ClampCommand::Release);
    b.run(3.0);
    assert_eq!(b.servos.now(), [RELEASE_US; 4]);
    assert!(b.grip().released);
}

#[test]
fn all_tilts_stale_stop_all_servos_within_a_tenth_of_a_second() {
    let mut b = Bench::new();
    b.command = Some(CLOSE);
    b.run(1.0);
    let frozen = b.ms;
    let (time, servos, links) = (&b.time, &b.servos, b.links);
    for ms in frozen..frozen + 2000 {
        time.run_until(ms * 1000);
        if ms % 10 == 0 {
            links.clamp_command.send(Instant::now(), CLOSE);
        }
    }
    let pulses = servos.pulses.borrow();
    let since: Vec<_> = pulses.iter().rev().take(90).collect();
    assert!(since.iter().all(|p| **p == *since[0]), "1.8 s without a motion");
    let grip = links.grip.fresh().unwrap();
    assert!(grip.arms.iter().all(|a| a.state == ArmState::Faulty));
}

#[test]
fn an_arm_whose_pressure_stops_rising_stops_with_a_reason() {
    let mut b = Bench::new();
    b.arms[0].most = 600.0;
    b.command = Some(CLOSE);
    b.run(12.0);
    let grip = b.grip();
    assert_eq!(b.state(0), ArmState::Faulty, "{grip:?}");
    assert_eq!(grip.arms[0].fault, Some(GripFault::Ceiling));
    assert!(grip.arms[0].force < grip.arms[1].force + 30.0, "{grip:?}");
    assert!((1..4).all(|arm| b.state(arm) == ArmState::Holding) && !grip.proven);
}

#[test]
fn an_arm_that_cannot_reach_the_pressure_stops_at_the_limit() {
    // 46 N at 15 mm; these arms need 54 N.
    let mut b = Bench::with(Params {
        servo_torque_max: 0.7,
        ..Params::default()
    });
    b.command = Some(CLOSE);
    b.run(12.0);
    let limit = ForceLimit::from_params(&b.links.params).asked;
    assert_eq!(b.state(0), ArmState::ForceLimited, "{:?}", b.grip());
    assert!(b.largest_force > 0.9 * limit && b.largest_force <= limit);
    assert!(!b.grip().proven);
}

#[test]
fn a_commander_that_falls_silent_leaves_the_grip_as_it_is() {
    let mut b = Bench::holding();
    b.command = None;
    b.run(0.25);
    let forces = b.forces();
    b.run(3.0);
    assert_eq!(b.forces(), forces);
    assert!(b.arms.iter().all(|a| (a.pressure - 950.0).abs() < 100.0));
    b.command = Some(ClampCommand::Release);
    b.run(3.0);
    assert!(b.grip().released);
}

#[test]
fn a_clamp_loop_that_falls_silent_leaves_the_servos_where_they_are() {
    let (time, links, servos) = (
        VirtualTime::new(),
        links_with(Params::default()),
        FakeServos::default(),
    );
    time.spawn(sophie_tasks::perching::servos::run(links, servos.clone()));
    let step = |ms: u64, force: Option<f32>| {
        time.run_until(ms * 1000);
        let (now, tilt) = (Instant::now(), [Some(-0.8); 4]);
        links.arms.send(now, ArmAngles::at(now, tilt));
        if let Some(force) = force {
            links.tendons.send(
                now,
                TendonOrder::Measured(TendonForces {
                    arms: [TendonForce {
                        force,
                        stiffness: 1.0,
                        hold_position: false,
                    }; 4],
                    wound_at_power_on: false,
                }),
            );
        }
    };
    (1..300).for_each(|i| step(10 * i, Some(60.0)));
    let held = servos.now();
    assert!(held[0] > RELEASE_US + 500.0);
    (300..800).for_each(|i| step(10 * i, None));
    assert_eq!(servos.now(), held);
    (800..1100).for_each(|i| step(10 * i, Some(f32::NAN)));
    assert_eq!(servos.now(), [RELEASE_US; 4]);
}

#[test]
fn a_slow_converter_shows_in_the_time_from_pressure_to_pulse() {
    let quickest = |delay_us: u64, in_time: bool| {
        let mut b = Bench::new();
        b.converter.delay_us.set(delay_us);
        b.command = Some(CLOSE);
        b.run(1.0);
        let timing = b.links.timing.contact();
        let missed = if in_time { 0 } else { timing.runs };
        assert!(timing.runs >= 45 && timing.overruns == missed, "{timing:?}");
        let us = b.links.timing.take_contact_histogram(Quantity::Response).min();
        assert!(u64::from(us) >= delay_us, "{us}");
        us
    };
    // The clamp steps 0.6 ms after a conversion, the servos 0.3 ms after the clamp. A conversion of 5 ms delays the
    // next to 6 ms: the clamp's are 5 to 11 ms old, beyond the deadline.
    let (quick, slow) = (quickest(0, true), quickest(5000, false));
    assert!((900..1000).contains(&quick), "{quick}");
    assert!((3000..12_000).contains(&(slow - quick)), "{quick} {slow}");
}
