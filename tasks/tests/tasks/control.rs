//! The control task's demand for each kind of setpoint.

use embassy_time::Instant;
use sophie_control::allocation::desaturation::Given;
use sophie_control::allocation::wrench::Wrench;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{Attitude, Demand, MixOutput};
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::params::Params;
use sophie_tasks::flight::control;
use sophie_tasks::links::Links;

use crate::rig::Rig;

const LEVEL: Setpoint = Setpoint::Angle {
    roll: 0.0,
    pitch: 0.0,
    yaw_rate: 0.0,
    thrust: 17.7,
};

const ESCAPE: Setpoint = Setpoint::Escape {
    roll: 0.0,
    pitch: 0.0,
    yaw_rate: 0.0,
    thrust: 24.0,
};

/// 0.5 rad/s of roll rate, demanded and absent.
const ROLLING: Setpoint = Setpoint::Rate {
    rate: Vec3::new(0.5, 0.0, 0.0),
    thrust: 10.0,
};

struct Bench {
    rig: Rig,
    q: Quat,
    /// Report of the mixer; `None`: silent.
    mix: Option<MixOutput>,
}

fn all_given() -> MixOutput {
    MixOutput {
        running: true,
        given: Given::ALL,
        ..MixOutput::default()
    }
}

impl Bench {
    fn new() -> Self {
        // Motors that need no lead.
        let rig = Rig::with(Params {
            motor_tau: 0.05,
            ..Params::DEFAULT
        });
        rig.time.spawn(control::run(rig.links));
        Self {
            rig,
            q: Quat::IDENTITY,
            mix: Some(all_given()),
        }
    }

    fn speak(&self, links: &Links, at: Instant) {
        if let Some(mix) = self.mix {
            links.mix.send(at, mix);
        }
        let estimate = Attitude {
            q: self.q,
            calibrated: true,
            dt: 1e-3,
            ..Attitude::default()
        };
        links.attitude.send(at, estimate);
    }

    fn demand(&self) -> Demand {
        self.rig.links.demand.latest().unwrap().value
    }

    fn run(&mut self, ms: u64, setpoint: Setpoint) -> Demand {
        for _ in 0..ms {
            let (links, at) = (self.rig.links, Instant::now());
            links.setpoint.send(at, setpoint);
            self.speak(links, at);
            self.rig.run(1);
        }
        self.demand()
    }

    fn wrench(&mut self, ms: u64, setpoint: Setpoint) -> Wrench {
        match self.run(ms, setpoint) {
            Demand::Wrench(wrench) => wrench,
            other => panic!("{other:?}"),
        }
    }
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() < 2e-3
}

#[test]
fn a_setpoint_silent_for_50_ms_stops_the_rotors() {
    let mut bench = Bench::new();
    bench.run(1, LEVEL);
    for age in 1..60 {
        let (links, at) = (bench.rig.links, Instant::now());
        bench.speak(links, at);
        bench.rig.run(1);
        assert_eq!(bench.demand() == Demand::Stop, age > 50, "{age} ms");
    }
    let mut never = Bench::new();
    never.speak(never.rig.links, Instant::now());
    never.rig.run(1);
    assert_eq!(never.demand(), Demand::Stop);
}

#[test]
fn every_demand_carries_the_time_of_its_sample() {
    let mut bench = Bench::new();
    bench.run(5, LEVEL);
    assert_eq!(bench.rig.links.demand.latest().unwrap().at.as_micros(), 4000);
    assert_eq!(bench.rig.links.target.latest().unwrap().at.as_micros(), 4000);
}

#[test]
fn stop_idle_and_a_wrench_pass_as_they_are() {
    let mut bench = Bench::new();
    assert_eq!(bench.run(1, Setpoint::Stop), Demand::Stop);
    assert_eq!(bench.run(1, Setpoint::Idle), Demand::Idle);
    let wrench = Wrench {
        thrust: 9.0,
        roll: 0.1,
        pitch: -0.2,
        yaw: 0.03,
    };
    assert_eq!(bench.run(1, Setpoint::Direct { wrench }), Demand::Wrench(wrench));
}

#[test]
fn a_rate_that_is_not_there_is_asked_for_and_integrated_only_where_it_is_given() {
    // 20 1/s · 0.5 rad/s · 0.021 kg m² is 0.21 N m; a second of 50 1/s² adds 15 rad/s², the most, 0.315 N m.
    let mut bench = Bench::new();
    assert!(near(bench.wrench(1, ROLLING).roll, 0.21));
    let wrench = bench.wrench(999, ROLLING);
    assert!(
        near(wrench.roll, 0.525) && wrench.pitch == 0.0 && wrench.thrust == 10.0,
        "{wrench:?}"
    );
    // Nothing is given by a mixer that is silent, gave nothing, or is older than 10 ms.
    let nothing = MixOutput {
        given: Given {
            roll_pitch: 0.0,
            thrust_shift: 0.0,
            yaw: 0.0,
        },
        ..all_given()
    };
    for mix in [None, Some(nothing)] {
        let mut bench = Bench::new();
        bench.mix = mix;
        assert!(near(bench.wrench(1000, ROLLING).roll, 0.21), "{mix:?}");
    }
    let mut bench = Bench::new();
    bench.wrench(1, ROLLING);
    bench.mix = None;
    // 50 1/s² · 0.5 rad/s · 11 ms · 0.021 kg m² is 0.006 N m.
    assert!(near(bench.wrench(999, ROLLING).roll, 0.216));
}

#[test]
fn integrals_outlive_a_change_between_rate_and_angle_but_no_stop_or_escape() {
    let idle = Setpoint::Idle;
    let rest = Setpoint::Rate {
        rate: Vec3::ZERO,
        thrust: 10.0,
    };
    for (between, then, left) in [
        (None, LEVEL, 0.315),
        (None, rest, 0.315),
        // A wound-up integral would throw the vehicle to that side.
        (None, ESCAPE, 0.0),
        (Some(ESCAPE), LEVEL, 0.0),
        (Some(idle), rest, 0.0),
        (Some(Setpoint::Stop), LEVEL, 0.0),
        (
            Some(Setpoint::Direct {
                wrench: Wrench::default(),
            }),
            rest,
            0.0,
        ),
    ] {
        let mut bench = Bench::new();
        bench.wrench(1000, ROLLING);
        if let Some(between) = between {
            bench.run(1, between);
        }
        let wrench = bench.wrench(1, then);
        assert!(near(wrench.roll, left), "{between:?} {then:?}: {wrench:?}");
    }
}

#[test]
fn on_the_pipe_moments_fade_with_the_thrust_and_yaw_is_given_up() {
    let mut bench = Bench::new();
    let resting = |thrust| Setpoint::Resting {
        roll: 0.3,
        pitch: -0.3,
        thrust,
    };
    // 0.6 and 0.4 of 2 N at 0.178 m. Unlimited: 4.5 1/s · 0.3 rad · 10 1/s · 0.021 kg m² = 0.28 N m, twice for roll.
    for (thrust, roll, pitch) in [(2.0, 0.2136, 0.1424), (1.0, 0.1068, 0.0712), (0.0, 0.0, 0.0)] {
        let Demand::Resting(wrench) = bench.run(500, resting(thrust)) else {
            panic!("{:?}", bench.demand())
        };
        assert!(
            near(wrench.roll, roll) && near(wrench.pitch, -pitch),
            "{wrench:?}"
        );
        assert!(wrench.thrust == thrust && wrench.yaw == 0.0);
    }
    // Nothing is integrated: twice 4.5·0.05·10·0.021 N m.
    let lean = Setpoint::Resting {
        roll: 0.05,
        pitch: 0.0,
        thrust: 17.7,
    };
    let mut bench = Bench::new();
    let Demand::Resting(wrench) = bench.run(3000, lean) else {
        panic!("{:?}", bench.demand())
    };
    assert!((wrench.roll - 0.0945).abs() < 2e-3, "{wrench:?}");
}

#[test]
fn the_heading_is_let_go_while_yaw_is_gated_and_held_when_it_is_not() {
    for gated in [true, false] {
        let mut bench = Bench::new();
        bench.wrench(500, LEVEL);
        bench.mix = Some(MixOutput {
            yaw_gated: gated,
            ..all_given()
        });
        bench.q = Quat::from_euler(0.0, 0.0, 0.4);
        bench.wrench(10, LEVEL);
        bench.mix = Some(all_given());
        // Turned 0.4 rad right: 1.2 1/s · -0.4 rad · 3 1/s · 0.063 kg m² = -0.09 N m leads back.
        let yaw = bench.wrench(500, LEVEL).yaw;
        assert!(
            if gated { yaw.abs() < 0.005 } else { yaw < -0.03 },
            "{gated}: {yaw}"
        );
    }
}
