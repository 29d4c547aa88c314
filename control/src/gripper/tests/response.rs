//! The bending of the arm in hand, learnt while it is free: arms half to twice as soft as the parameters say, on tendons
//! down to a quarter of their stiffness.

use super::*;

/// Tilt without load, and where the pipe begins, rad.
const REST: f32 = -0.15;
const PIPE: f32 = -1.0;
/// Pressure per bending on the skin: 94 Pa/N at 0.4 of 0.0242 rad/N.
const SKIN: f32 = 9700.0;

#[derive(Debug)]
struct Trial {
    /// Bending over the parameters', and on the pipe over the free arm's.
    response: f32,
    share: f32,
    /// Stiffness of the tendon over the parameters'.
    tendon: f32,
    open: bool,
    /// Thrust over time, N.
    thrust: fn(f32) -> f32,
}

#[derive(Debug)]
struct Outcome {
    grip: ArmGrip,
    response: f32,
    /// Largest true force, and that of the touch, N.
    most: f32,
    touch: f32,
    /// Largest speed of bending, rad/s, before the touch and after a second.
    speed: f32,
}

impl Trial {
    fn run(&self) -> Outcome {
        let cfg = config();
        let mut arm = ArmGripper::default();
        let bend = self.response * cfg.bend_per_force;
        let mut result = Outcome {
            grip: ArmGrip::default(),
            response: 0.0,
            most: 0.0,
            touch: 0.0,
            speed: 0.0,
        };
        let (mut last, mut turning) = (REST, (self.thrust)(0.0));
        for step in 0..1200u32 {
            let t = step as f32 * DT;
            let thrust = (self.thrust)(t);
            // Motors take 50 ms.
            turning += (thrust - turning) * DT / 0.05;
            // The reel stands for the force by the stiffness that was learnt.
            let force = arm.force * self.tendon / arm.response.tendon();
            let free = REST + bend * (turning / cfg.thrust_per_force - force);
            let tilt = if free < PIPE {
                PIPE + self.share * (free - PIPE)
            } else {
                free
            };
            // 4 mrad, without trend.
            let noise = 0.004 * (((step * step * 17) % 101) as f32 / 50.0 - 1.0);
            let pressure = scalar::clamp(SKIN * (PIPE - tilt), 0.0, 1e5);
            let input = ArmInput {
                close: true,
                pressure: Pressure::Known(if self.open { 0.0 } else { pressure }),
                turn_on: 0.0,
                thrust,
                tension: Some(arm.force),
                tilt: Some(tilt + noise),
            };
            if tilt > PIPE {
                result.touch = force;
                if t > 1.0 && (last - tilt) / DT > result.speed {
                    result.speed = (last - tilt) / DT;
                }
            }
            last = tilt;
            result.grip = arm.step(&cfg, &input, DT);
            if force > result.most {
                result.most = force;
            }
        }
        result.response = arm.response.known().unwrap();
        result
    }
}

fn trials(open: bool) -> impl Iterator<Item = Trial> {
    let thrusts: [fn(f32) -> f32; 3] = [|_| 0.0, |_| 2.5, |t| if t < 0.5 { 3.5 } else { 2.3 }];
    let stiff = [0.5, 0.7, 1.0, 1.4, 2.0].map(|response| (response, 1.0));
    let soft = [(0.7, 0.25), (1.0, 0.25), (1.4, 0.25), (1.0, 0.5), (1.4, 0.5)];
    [stiff, soft]
        .concat()
        .into_iter()
        .flat_map(|part| [0.2, 0.4].map(|share| (part, share)))
        .flat_map(move |((response, tendon), share)| {
            thrusts.map(|thrust| Trial {
                response,
                share,
                tendon,
                open,
                thrust,
            })
        })
}

#[test]
fn the_closing_learns_the_arm_and_a_sound_sensor_trips_nothing() {
    for trial in trials(false) {
        let r = trial.run();
        assert!(r.grip.state == ArmState::Holding, "{trial:?} {r:?}");
        let response = trial.response * trial.tendon;
        assert!((r.response / response - 1.0).abs() < 0.15, "{trial:?} {r:?}");
        // 0.7 rad/s once it is learnt, whatever the arm.
        assert!(r.speed < 0.85, "{trial:?} {r:?}");
    }
}

#[test]
fn an_open_sensor_is_found_whatever_the_arm() {
    for trial in trials(true) {
        let r = trial.run();
        assert!(r.grip.fault == Some(GripFault::Unfelt), "{trial:?} {r:?}");
        // Two windows of 0.15 rad, 6.2 N each at the parameters' response, and the force's lead of the filters.
        assert!(r.most < r.touch + 15.0 / trial.response, "{trial:?} {r:?}");
    }
}

#[test]
fn what_was_learnt_is_forgotten_with_the_arm_let_go_and_kept_while_it_is_not() {
    let cfg = config();
    let mut arm = ArmGripper::default();
    let step = |arm: &mut ArmGripper, close: bool| {
        let i = ArmInput {
            close,
            tilt: Some(REST - 1.6 * cfg.bend_per_force * arm.force),
            ..input(&cfg, arm, 0.0)
        };
        arm.step(&cfg, &i, DT)
    };
    for _ in 0..120 {
        step(&mut arm, true);
    }
    assert!(close(arm.response.arm(), 1.6, 0.1), "{:?}", arm.response);
    step(&mut arm, false);
    step(&mut arm, true);
    assert!(close(arm.response.arm(), 1.6, 0.1));
    for _ in 0..200 {
        step(&mut arm, false);
    }
    assert!(!arm.response.is_known() && arm.phase == Phase::Free);
}

#[test]
fn what_was_learnt_is_used_again_after_a_restart() {
    let cfg = config();
    let closes = |arm: &mut ArmGripper, steps: u32| {
        let mut grip = ArmGrip::default();
        for _ in 0..steps {
            let i = ArmInput {
                tilt: Some(REST - 1.6 * cfg.bend_per_force * arm.force),
                ..input(&cfg, arm, 0.0)
            };
            grip = arm.step(&cfg, &i, DT);
        }
        grip
    };
    let mut arm = ArmGripper::default();
    assert_eq!(closes(&mut arm, 5).response, None);
    let grip = closes(&mut arm, 115);
    assert!(grip.response.is_some_and(|r| close(r, 1.6, 0.1)), "{grip:?}");
    let rate = |response| {
        let mut arm = ArmGripper::resume(grip.force, None, response);
        closes(&mut arm, 25);
        let before = arm.force;
        (closes(&mut arm, 10).force - before, arm.response.arm())
    };
    let (again, response) = rate(grip.response);
    let (assumed, _) = rate(None);
    assert!(
        close(response, 1.6, 0.1) && close(assumed / again, 1.6, 0.1),
        "{assumed} {again}"
    );
    // Out of range is unknown: the parameters are assumed.
    let mut arm = ArmGripper::resume(grip.force, None, Some(f32::NAN));
    assert_eq!(closes(&mut arm, 22).response, Some(1.0));
}

#[test]
fn no_reading_makes_a_response_beyond_its_bounds() {
    let cfg = config();
    for wild in [-3.0f32, -0.9, 0.9, 3.0, f32::NAN, f32::INFINITY] {
        let mut arm = ArmGripper::default();
        for step in 0..300u32 {
            let i = ArmInput {
                tilt: Some(if step % 7 == 0 { wild } else { -0.01 * step as f32 }),
                tension: Some(if step % 5 == 0 { f32::NAN } else { 300.0 * wild }),
                ..input(&cfg, &arm, 0.0)
            };
            arm.step(&cfg, &i, DT);
            let response = arm.response.known().unwrap_or(1.0);
            assert!((0.13..=2.5).contains(&response), "{wild}: {response}");
            assert!(arm.force >= 0.0 && arm.force <= cfg.limit);
        }
    }
}
