//! The commander's links: late deadlines, the rotors' lift, warnings.

use embassy_time::{Duration, Instant};
use sophie_control::arming::ArmingInhibit;
use sophie_control::battery::Battery;
use sophie_control::chain::{Attitude, MixOutput};
use sophie_control::gripper::grip::GripState;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_control::pilot::rc::Sticks;
use sophie_ports::receiver::RcState;
use sophie_ports::retained::StartCause;
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::Contact;
use sophie_tasks::pilot::commander;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::schedule::timing::Run;
use sophie_tasks::start::Start;

use crate::rig::Rig;

/// A vehicle at 1 g, hovering or standing.
#[derive(Clone, Copy)]
struct World {
    sticks: Sticks,
    mix: MixOutput,
}

impl World {
    fn speak(&self, links: &Links, at: Instant) {
        let attitude = Attitude {
            accel: Vec3::new(0.0, 0.0, -GRAVITY),
            calibrated: true,
            ..Attitude::default()
        };
        links.attitude.send(at, attitude);
        let (sticks, mut state) = (self.sticks, RcState::default());
        state.sticks = sticks;
        links.rc.send(at, state);
        links.mix.send(at, self.mix);
        links.contact.send(at, Contact::default());
        let grip = GripState {
            released: true,
            ..GripState::default()
        };
        links.grip.send(at, grip);
        let battery = Battery {
            voltage: 16.0,
            ratio: 1.0,
            ..Battery::default()
        };
        links.battery.send(at, battery);
    }
}

struct Bench {
    rig: Rig,
    world: World,
}

fn running(thrust: f32, tilt: f32) -> MixOutput {
    MixOutput {
        running: true,
        thrusts: [thrust; 4],
        tilt: [tilt; 4],
        ..MixOutput::default()
    }
}

impl Bench {
    /// On the ground, without inhibits.
    fn starting(params: Params, cause: StartCause) -> Self {
        let start = Start { cause, ..Start::COLD };
        let rig = Rig::starting(params, start);
        rig.time.spawn(commander::run(rig.links));
        let world = World {
            sticks: Sticks::default(),
            mix: MixOutput::default(),
        };
        let mut bench = Self { rig, world };
        bench.run(1500);
        assert_eq!((bench.mode(), bench.inhibits()), (Mode::Disarmed, vec![]));
        bench
    }

    fn new() -> Self {
        Self::starting(Params::default(), StartCause::PowerOn)
    }

    fn run(&mut self, ms: u64) {
        let world = self.world;
        self.rig.run_with(ms, |links, at| world.speak(links, at));
    }

    fn mode(&self) -> Mode {
        self.rig.links.status.fresh().unwrap().mode
    }

    fn inhibits(&self) -> Vec<ArmingInhibit> {
        self.rig.links.status.fresh().unwrap().inhibits.iter().collect()
    }

    fn warning(&self) -> &'static str {
        self.rig.links.status.fresh().unwrap().warning
    }

    fn arms(&mut self) -> bool {
        self.world.sticks.arm_switch = true;
        self.world.sticks.yaw = 1.0;
        self.run(1200);
        self.world.sticks.yaw = 0.0;
        self.mode() == Mode::Armed
    }

    fn flying() -> Self {
        let mut bench = Self::new();
        assert!(bench.arms());
        // A quarter of 17.7 N on each rotor.
        bench.world.mix = running(4.425, 0.0);
        bench.world.sticks.throttle = 0.53;
        bench.run(1500);
        assert_eq!(bench.mode(), Mode::Flight);
        bench
    }

    fn late(&self, task: TaskId, misses: u32) {
        let now = Instant::now();
        let run = Run {
            released: now,
            started: now,
            ended: now,
            deadline: Duration::from_micros(500),
            skipped: misses,
        };
        self.rig.links.timing.record(task, &run);
    }
}

#[test]
fn a_flight_level_that_misses_more_than_ten_deadlines_in_a_second_refuses_arming() {
    for task in [
        TaskId::Imu,
        TaskId::Estimator,
        TaskId::Control,
        TaskId::Mixer,
        TaskId::Motors,
    ] {
        let mut bench = Bench::new();
        bench.late(task, 11);
        bench.run(20);
        assert_eq!(bench.inhibits(), [ArmingInhibit::Overruns], "{task:?}");
        assert!(!bench.arms(), "{task:?}");
        assert_eq!(bench.mode(), Mode::Disarmed);
        // A clean window of 1 s permits arming.
        bench.world.sticks = Sticks::default();
        bench.run(1000);
        assert_eq!(bench.inhibits(), []);
        assert!(bench.arms(), "{task:?}");
    }
}

#[test]
fn ten_misses_in_a_second_and_any_number_below_the_flight_level_refuse_nothing() {
    let mut bench = Bench::new();
    for _ in 0..5 {
        bench.late(TaskId::Motors, 5);
        bench.late(TaskId::Imu, 5);
        for task in [
            TaskId::Analog,
            TaskId::Clamp,
            TaskId::Servos,
            TaskId::Rc,
            TaskId::Arms,
        ] {
            bench.late(task, 100);
        }
        for _ in 0..100 {
            bench.run(10);
            assert_eq!(bench.inhibits(), []);
        }
    }
    assert!(bench.arms());
}

#[test]
fn a_flight_level_that_stays_late_stays_refused() {
    let mut bench = Bench::new();
    // 20 a second, evenly.
    for i in 0..100 {
        bench.late(TaskId::Control, 1);
        bench.run(50);
        if i > 40 {
            assert_eq!(bench.inhibits(), [ArmingInhibit::Overruns], "{} ms", 50 * i);
        }
    }
    let mut bench = Bench::flying();
    bench.late(TaskId::Control, 1000);
    bench.run(2000);
    assert_eq!(bench.mode(), Mode::Flight);
}

#[test]
fn what_the_rotors_lift_is_their_thrust_along_the_body_axis() {
    // At 1 g the vehicle feels 17.7 N; more than 3 N not lifted by the rotors mean the pipe.
    for (name, mix, touched) in [
        ("4·4.425 N on level arms", running(4.425, 0.0), false),
        (
            "4·5.109 N·cos 30° = 17.7 N",
            running(5.109, 30f32.to_radians()),
            false,
        ),
        ("4·4 N·cos 60° = 8 N", running(4.0, 60f32.to_radians()), true),
        ("the same, tips down", running(4.0, -60f32.to_radians()), true),
        ("4·2.5 N", running(2.5, 0.0), true),
        (
            "rotors that stand",
            MixOutput {
                running: false,
                ..running(4.425, 0.0)
            },
            true,
        ),
    ] {
        let mut bench = Bench::flying();
        bench.world.sticks.throttle = 0.3;
        bench.world.sticks.perch_switch = true;
        bench.run(500);
        assert_eq!(bench.mode(), Mode::Flight, "{name}");
        bench.world.mix = mix;
        bench.run(1000);
        assert_eq!(
            bench.mode() != Mode::Flight,
            touched,
            "{name}: {:?}",
            bench.mode()
        );
    }
}

#[test]
fn what_must_be_known_is_said_where_it_matters() {
    let weak = Params {
        servo_stall: 2.0,
        ..Params::default()
    };
    let infill = |infill| Params {
        infill,
        ..Params::default()
    };
    for (params, cause, warning) in [
        (Params::default(), StartCause::PowerOn, ""),
        (Params::default(), StartCause::Software, ""),
        (
            Params::default(),
            StartCause::Watchdog,
            "restarted by the watchdog",
        ),
        // 85 % of 2.0 N m are less than the wanted 2.452.
        (weak, StartCause::PowerOn, "servo weaker than the force limit"),
        (infill(5.9), StartCause::PowerOn, "infill below what was flown"),
        (infill(6.0), StartCause::PowerOn, ""),
        // The restart has priority.
        (infill(5.9), StartCause::Fault, "restarted after a fault"),
    ] {
        let mut bench = Bench::starting(params, cause);
        assert_eq!(bench.warning(), warning);
        // Not shown in the air.
        assert!(bench.arms());
        assert_eq!(bench.warning(), "");
    }
    let mut bench = Bench::flying();
    for (running, tilt_fault, warning) in [
        (true, false, ""),
        (true, true, "arm tilt beyond its model"),
        (false, true, ""),
    ] {
        bench.world.mix.running = running;
        bench.world.mix.tilt_fault = tilt_fault;
        bench.run(20);
        assert_eq!(bench.warning(), warning, "{running} {tilt_fault}");
    }
    // Above all others: an overflow stops the motors.
    bench.world.mix.running = true;
    bench.rig.links.report_scarce_stack();
    bench.run(20);
    assert_eq!(bench.warning(), "stack nearly full");
}

#[test]
fn a_silent_link_counts_as_absent() {
    let mut bench = Bench::new();
    bench.rig.run(1000);
    assert_eq!(
        bench.inhibits(),
        [
            ArmingInhibit::RcLost,
            ArmingInhibit::ImuStale,
            ArmingInhibit::NotCalibrated,
            ArmingInhibit::ArmsClosed,
            ArmingInhibit::BatterySilent,
            ArmingInhibit::FsrFault
        ]
    );
}

#[test]
fn pressures_that_are_held_are_a_fault_of_every_sensor() {
    let mut bench = Bench::new();
    let last = bench.rig.links.contact.latest().unwrap();
    // All else is sent.
    let world = bench.world;
    // 11 ms old at the next step.
    bench.rig.run_with(10, |links, at| {
        world.speak(links, at);
        links.contact.send(last.at, last.value);
    });
    assert_eq!(bench.inhibits(), []);
    bench.rig.run_with(20, |links, at| {
        world.speak(links, at);
        links.contact.send(last.at, last.value);
    });
    assert_eq!(bench.inhibits(), [ArmingInhibit::FsrFault]);
    bench.run(20);
    assert_eq!(bench.inhibits(), []);
}

impl Bench {
    /// For `ms` with a vertical force of `size` m/s² at 86 Hz.
    fn shakes(&mut self, ms: u64, size: f32) {
        let world = self.world;
        self.rig.run_with(ms, |links, at| {
            let turn = core::f64::consts::TAU * 86e-6 * at.as_micros() as f64;
            let force = size * f64::sin(turn) as f32 - GRAVITY;
            links.raw_forces.push(Vec3::new(0.0, 0.0, force));
            world.speak(links, at);
        });
    }
}

#[test]
fn vibration_is_measured_each_second_and_warned_of_in_flight_and_after() {
    let text = "vibration: balance the propellers";
    let mut bench = Bench::new();
    assert!(bench.rig.links.vibration.fresh().is_none(), "no reading has come");
    // On the ground hands shake it.
    bench.shakes(20_000, 30.0);
    let found = bench.rig.links.vibration.fresh().unwrap();
    assert!(
        (found.rms.z - 21.2).abs() < 0.5 && found.rms.x == 0.0,
        "{found:?}"
    );
    assert_ne!(bench.warning(), text);
    let mut bench = Bench::flying();
    bench.shakes(20_000, 8.0);
    assert_ne!(bench.warning(), text, "5.7 m/s2");
    bench.shakes(12_000, 14.0);
    assert_eq!(bench.warning(), text, "9.9 m/s2");
    assert_eq!(bench.mode(), Mode::Flight, "nothing else happens");
    bench.world.mix = MixOutput::default();
    bench.shakes(5000, 0.0);
    assert_eq!(bench.warning(), text, "the rotors stand");
}
