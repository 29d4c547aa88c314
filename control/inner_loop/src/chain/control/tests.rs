use super::*;
use crate::chain::spin::Spin;
use crate::chain::static_thrust::{Rotors, StaticThrust};

const THRUST: f32 = 10.0;
const GIVEN: Feedback = Feedback {
    roll_pitch: 1.0,
    yaw: 1.0,
    yaw_gated: false,
};

/// The loops at a given attitude: level, at rest.
struct Bench {
    control: Control,
    attitude: Attitude,
    feedback: Feedback,
    gentle: bool,
}

impl Bench {
    fn new() -> Self {
        Self {
            control: Control::new(&Params::default()),
            attitude: Attitude {
                calibrated: true,
                dt: 1e-3,
                ..Attitude::default()
            },
            feedback: GIVEN,
            gentle: false,
        }
    }

    fn run(&mut self, steps: usize, setpoint: Setpoint, at_us: u64) -> Demand {
        let command = Command {
            setpoint,
            at_us,
            gentle: self.gentle,
        };
        let mut demand = Demand::Stop;
        for _ in 0..steps {
            demand = self.control.step(&self.attitude, &command, &self.feedback);
        }
        demand
    }
}

fn roll_to(roll: f32) -> Setpoint {
    Setpoint::Angle {
        roll,
        pitch: 0.0,
        yaw_rate: 0.0,
        thrust: THRUST,
    }
}

fn escape_to(roll: f32) -> Setpoint {
    Setpoint::Escape {
        roll,
        pitch: 0.0,
        yaw_rate: 0.0,
        thrust: THRUST,
    }
}

fn resting(thrust: f32) -> Setpoint {
    Setpoint::Resting {
        roll: 0.3,
        pitch: -0.3,
        thrust,
    }
}

const ROLLING: Setpoint = Setpoint::Rate {
    rate: Vec3::new(0.5, 0.0, 0.0),
    thrust: THRUST,
};

#[test]
fn a_direction_is_aimed_at_once_for_each_time_it_was_given() {
    let mut bench = Bench::new();
    bench.run(2000, roll_to(0.2), 1000);
    let aimed = bench.control.target().down.y;
    assert!((aimed - 0.198_67).abs() < 1e-4, "{aimed}");
    // A direction is taken once for each time.
    bench.run(2000, roll_to(-0.2), 1000);
    assert!((bench.control.target().down.y - aimed).abs() < 1e-6);
    bench.run(2000, roll_to(-0.2), 2000);
    assert!((bench.control.target().down.y + aimed).abs() < 1e-4);
}

#[test]
fn the_attitude_loop_starts_from_the_present_attitude_and_aims_anew() {
    let mut bench = Bench::new();
    bench.run(2000, roll_to(0.2), 1000);
    // Turned by hand to 0.4 rad while idle: the filtered direction is gone, though the time is the same.
    bench.run(1, Setpoint::Idle, 2000);
    bench.attitude.q = crate::maths::vector::Quat::from_euler(0.4, 0.0, 0.0);
    bench.run(1, roll_to(0.2), 1000);
    let started = bench.control.target().down.y;
    assert!((started - 0.389_42).abs() < 3e-3, "{started}");
    bench.run(2000, roll_to(0.2), 1000);
    let aimed = bench.control.target().down.y;
    assert!((aimed - 0.198_67).abs() < 2e-3, "{aimed}");
}

#[test]
fn what_was_wound_up_goes_with_every_change_but_one_between_rate_and_angle() {
    let (stop, idle) = (Setpoint::Stop, Setpoint::Idle);
    let direct = Setpoint::Direct {
        wrench: Wrench::default(),
    };
    let spin = Spin::at(0, 0.08);
    let tried = Bench::new().run(1, Setpoint::Spin(spin), 0);
    assert_eq!(tried, Demand::Spin(spin));
    let thrust = StaticThrust {
        rotors: Rotors::All,
        drive: 0.5,
    };
    let tried = Bench::new().run(1, Setpoint::StaticThrust(thrust), 0);
    assert_eq!(tried, Demand::StaticThrust(thrust));
    for (between, then, kept) in [
        (Setpoint::StaticThrust(thrust), ROLLING, false),
        (Setpoint::Spin(spin), ROLLING, false),
        (ROLLING, roll_to(0.0), true),
        (roll_to(0.0), ROLLING, true),
        (resting(5.0), roll_to(0.0), true),
        (stop, ROLLING, false),
        (idle, roll_to(0.0), false),
        (direct, ROLLING, false),
        (escape_to(0.0), roll_to(0.0), false),
    ] {
        let mut bench = Bench::new();
        bench.run(1000, ROLLING, 0);
        let wound = bench.control.rate.integral().x;
        assert!((wound - 15.0).abs() < 0.01, "{wound}");
        bench.run(1, between, 0);
        bench.run(1, then, 0);
        let left = bench.control.rate.integral().x;
        assert!(left.abs() > 14.9 || !kept, "{between:?}, {then:?}: {left}");
        assert!(left.abs() < 0.1 || kept, "{between:?}, {then:?}: {left}");
    }
}

#[test]
fn an_escape_forgets_what_was_wound_up_when_it_begins_and_not_while_it_lasts() {
    let mut bench = Bench::new();
    bench.attitude.rate = Vec3::new(0.1, 0.0, 0.0);
    bench.run(500, roll_to(0.0), 0);
    let wound = bench.control.rate.integral().x;
    bench.run(1, escape_to(0.0), 0);
    assert!(wound < -0.3 && bench.control.rate.integral().x > -0.01, "{wound}");
    bench.run(499, escape_to(0.0), 0);
    let lasting = bench.control.rate.integral().x;
    assert!((lasting - wound).abs() < 0.02, "{lasting}, {wound}");
    // A second escape is an activation.
    bench.run(1, roll_to(0.0), 0);
    bench.run(1, escape_to(0.0), 0);
    assert!(bench.control.rate.integral().x > -0.01);
}

#[test]
fn on_the_pipe_each_moment_keeps_within_its_own_lever() {
    let p = Params::default();
    let mut bench = Bench::new();
    for thrust in [2.0, 1.0, 0.0] {
        let Demand::Resting(wrench) = bench.run(500, resting(thrust), 0) else {
            panic!("not at rest")
        };
        assert!((wrench.roll - 0.6 * thrust * p.arm_d).abs() < 1e-6, "{wrench:?}");
        assert!((wrench.pitch + 0.4 * thrust * p.arm_b).abs() < 1e-6, "{wrench:?}");
        assert!(wrench.yaw == 0.0 && wrench.thrust == thrust);
    }
    assert!(bench.control.rate.integral() == Vec3::ZERO);
}

#[test]
fn on_the_pipe_a_lean_meets_the_moment_of_the_air() {
    // Little enough for no limit: 1 mrad.
    let (roll, pitch, yaw_rate, thrust) = (1e-3, 1e-3, 0.0, 8.0);
    let angle = Setpoint::Angle {
        roll,
        pitch,
        yaw_rate,
        thrust,
    };
    let Demand::Wrench(air) = Bench::new().run(1, angle, 0) else {
        panic!("not in the air")
    };
    let Demand::Resting(pipe) = Bench::new().run(1, Setpoint::Resting { roll, pitch, thrust }, 0) else {
        panic!("not at rest")
    };
    assert!(
        air.roll > 0.0 && (pipe.roll / air.roll - 1.0).abs() < 0.01,
        "{pipe:?} {air:?}"
    );
    assert!((pipe.pitch / air.pitch - 1.0).abs() < 0.01, "{pipe:?} {air:?}");
}

#[test]
fn a_gated_yaw_takes_the_heading_along() {
    let turned = crate::maths::vector::Quat::from_euler(0.0, 0.0, 0.2);
    for (yaw_gated, ahead) in [(true, 0.0), (false, -0.2)] {
        let mut bench = Bench::new();
        bench.run(1, roll_to(0.0), 0);
        bench.feedback.yaw_gated = yaw_gated;
        bench.attitude.q = turned;
        bench.run(1, roll_to(0.0), 0);
        let is = bench.control.target().ahead;
        assert!((is - ahead).abs() < 5e-3, "{yaw_gated}: {is}");
    }
}

#[test]
fn gentle_loops_ask_for_less_and_go_back() {
    let mut bench = Bench::new();
    let tilted = Setpoint::Rate {
        rate: Vec3::new(0.5, 0.5, 0.5),
        thrust: 18.0,
    };
    let mut moments = |gentle: bool| {
        bench.control.rate.reset();
        bench.gentle = gentle;
        let Demand::Wrench(w) = bench.run(1, tilted, 0) else {
            panic!("a wrench");
        };
        [w.roll, w.pitch, w.yaw]
    };
    let (usual, gentle, again) = (moments(false), moments(true), moments(false));
    for (axis, slower) in [(0, 0.08 / 0.13), (1, 0.08 / 0.13), (2, 1.0)] {
        assert!(
            (gentle[axis] / usual[axis] - slower).abs() < 1e-3,
            "{usual:?} {gentle:?}"
        );
    }
    assert_eq!(usual, again);
}
