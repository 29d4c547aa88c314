//! The clamp task's response to commands and stale inputs.

use embassy_time::Instant;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::chain::MixOutput;
use sophie_control::gripper::clamp_command::ClampCommand;
use sophie_control::gripper::contact_pressure::FsrFault;
use sophie_control::gripper::grip::ArmState;
use sophie_control::gripper::grip_fault::GripFault;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::params::Params;
use sophie_control::pilot::rc::ArmChoice;
use sophie_ports::retained::StartCause;
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::{ArmAngles, Contact};
use sophie_tasks::links::tendon_order::{TendonForce, TendonForces, TendonOrder};
use sophie_tasks::perching::clamp;
use sophie_tasks::start::Start;
use sophie_tasks::start::retained_state::RetainedState;

use crate::rig::Rig;

const CLOSE: ClampCommand = ClampCommand::Close { arms: ArmChoice::All };

#[derive(Clone, Copy)]
struct World {
    command: Option<ClampCommand>,
    pressure: PerArm<f32>,
    fault: PerArm<bool>,
    seen: PerArm<bool>,
    contact: bool,
    mix: MixOutput,
}

impl World {
    fn new(command: ClampCommand, pressure: f32) -> Self {
        Self {
            command: Some(command),
            pressure: [pressure; 4],
            fault: [false; 4],
            seen: [true; 4],
            contact: true,
            mix: MixOutput::default(),
        }
    }

    fn pressed(&self) -> Contact {
        let mut contact = Contact {
            arms: self.pressure.map(Ok),
        };
        for (arm, fault) in contact.arms.iter_mut().zip(self.fault) {
            if fault {
                *arm = Err(FsrFault::Short);
            }
        }
        contact
    }

    /// Arms that bend by 0.024182 rad/N, tension equal to force.
    fn speak(&self, links: &Links, at: Instant) {
        let force = force(links).unwrap_or([0.0; 4]);
        if let Some(command) = self.command {
            links.clamp_command.send(at, command);
        }
        if self.contact {
            links.contact.send(at, self.pressed());
        }
        let mut tilt = [None; 4];
        for ((slot, force), seen) in tilt.iter_mut().zip(force).zip(self.seen) {
            *slot = seen.then_some(-0.2 - 0.024_182 * force);
        }
        links.arms.send(at, ArmAngles::at(at, tilt));
        links.tension.send(at, force);
        links.mix.send(at, self.mix);
    }
}

/// Of the newest order, of any age.
fn force(links: &Links) -> Option<PerArm<f32>> {
    links
        .tendons
        .latest()
        .map(|m| m.value.forces().arms.map(|arm| arm.force))
}

fn fresh(links: &Links) -> Option<TendonForces> {
    links.tendons.fresh().map(|order| *order.forces())
}

struct Bench(Rig);

impl Bench {
    fn new() -> Self {
        let rig = Rig::new();
        rig.time.spawn(clamp::run(rig.links));
        Self(rig)
    }

    fn run(&mut self, ms: u64, world: &World) -> PerArm<f32> {
        self.0.run_with(ms, |links, at| world.speak(links, at));
        force(self.0.links).unwrap_or([-1.0; 4])
    }

    fn states(&self) -> PerArm<ArmState> {
        self.0.links.grip.fresh().unwrap().arms.map(|arm| arm.state)
    }
}

#[test]
fn arms_that_press_before_the_first_pulse_are_reported_as_wound_at_power_on() {
    for (kept, command, wound) in [
        // More than 80 Pa press.
        (&[500.0][..], ClampCommand::Release, true),
        (&[500.0], CLOSE, true),
        (&[85.0], ClampCommand::Release, true),
        (&[75.0], ClampCommand::Release, false),
        // Pulled off by hand.
        (&[500.0, 0.0], ClampCommand::Release, false),
        // Never kept.
        (&[], ClampCommand::Release, false),
    ] {
        let mut bench = Bench::new();
        for pressure in kept {
            bench.run(300, &World::new(ClampCommand::Keep, *pressure));
            assert!(
                bench.0.links.tendons.latest().is_none(),
                "a pulse would open them"
            );
        }
        bench.run(30, &World::new(command, 500.0));
        assert_eq!(
            fresh(bench.0.links).unwrap().wound_at_power_on,
            wound,
            "{kept:?} {command:?}"
        );
    }
    let mut bench = Bench::new();
    let mut world = World::new(ClampCommand::Keep, 0.0);
    world.pressure[2] = 300.0;
    bench.run(300, &world);
    world.command = Some(ClampCommand::Release);
    bench.run(30, &world);
    assert!(fresh(bench.0.links).unwrap().wound_at_power_on);
}

#[test]
fn nothing_is_sent_before_the_first_command_and_forces_are_held_without_one() {
    let mut bench = Bench::new();
    let mut world = World::new(CLOSE, 0.0);
    world.command = None;
    bench.run(500, &world);
    assert!(bench.0.links.tendons.latest().is_none() && bench.0.links.grip.latest().is_none());
    // 28.95 N/s (0.7 rad/s at 0.024182 rad/N) from 1 N: 101 steps in a second.
    world.command = Some(CLOSE);
    let force = bench.run(1000, &world);
    assert!(force.iter().all(|f| (f - 28.95).abs() < 1.5), "{force:?}");
    // Stale after 200 ms; forces and judgement then age: 100 ms after the last judged pressure the grip is unknown,
    // after 200 ms the servos stay.
    world.command = None;
    let held = bench.run(200, &world);
    let stopped = bench.0.links.grip.latest().unwrap().at;
    bench.run(100, &world);
    assert!(bench.0.links.grip.fresh().is_none() && bench.0.links.tendons.fresh().is_some());
    assert_eq!(bench.run(1000, &world), held);
    assert!(bench.0.links.tendons.fresh().is_none() && bench.0.links.grip.fresh().is_none());
    assert_eq!(bench.0.links.grip.latest().unwrap().at, stopped);
    // Released at 500 N/s, in steps of 5 N: 20 N in 0.04 s.
    world.command = Some(ClampCommand::Release);
    let force = bench.run(40, &world);
    assert!((held[0] - force[0] - 20.0).abs() < 5.5, "{held:?} {force:?}");
}

#[test]
fn a_missing_input_of_one_arm_holds_that_arm_alone() {
    let mut bench = Bench::new();
    let mut world = World::new(CLOSE, 0.0);
    let before = bench.run(500, &world);
    world.fault[1] = true;
    world.seen[2] = false;
    let after = bench.run(600, &world);
    let rise = [0, 1, 2, 3].map(|i| after[i] - before[i]);
    // 28.95 N/s for 0.6 s.
    assert!(
        (rise[0] - 17.4).abs() < 1.0 && (rise[3] - 17.4).abs() < 1.0,
        "{rise:?}"
    );
    assert!(rise[1] == 0.0 && rise[2] == 0.0, "{rise:?}");
    let grip = bench.0.links.grip.fresh().unwrap();
    assert_eq!(
        grip.arms.map(|arm| arm.fault),
        [None, Some(GripFault::Sensor), Some(GripFault::Tilt), None]
    );
}

#[test]
fn pressures_older_than_20_ms_are_not_used() {
    let mut bench = Bench::new();
    let mut world = World::new(CLOSE, 0.0);
    bench.run(300, &world);
    world.contact = false;
    let before = bench.run(40, &world);
    assert_eq!(bench.run(200, &world), before);
    assert!(bench.states() == [ArmState::Faulty; 4]);
    world.contact = true;
    let after = bench.run(100, &world);
    assert!(after[0] > before[0] + 2.0 && bench.states() == [ArmState::Closing; 4]);
}

#[test]
fn tendons_compensate_the_thrust_of_running_rotors_alone() {
    let mut bench = Bench::new();
    let mut world = World::new(CLOSE, 0.0);
    world.mix = MixOutput {
        running: true,
        thrusts: [2.5; 4],
        ..MixOutput::default()
    };
    bench.run(2000, &world);
    world.pressure = [950.0; 4];
    let before = bench.run(3000, &world);
    // Standing rotors void the last thrust: 0.55·0.178/0.015·2.5 N less.
    world.mix.running = false;
    let after = bench.run(1000, &world);
    for (before, after) in before.iter().zip(after) {
        assert!((before - after - 16.32).abs() < 0.5, "{before} {after}");
    }
    assert!(bench.states() == [ArmState::Holding; 4]);
}

#[test]
fn after_a_restart_closed_arms_are_sent_their_force_at_once_and_all_others_nothing() {
    for (grip_memory, sent) in [
        (GripMemory::Controlled(ArmChoice::All), true),
        (GripMemory::HeldByGears(ArmChoice::All), false),
        (GripMemory::Open, false),
    ] {
        let retained = RetainedState {
            grip_memory,
            force: [50.0, 51.0, 52.0, 53.0],
            response: [Some(0.3); 4],
            ..RetainedState::default()
        };
        let start = Start {
            cause: StartCause::Watchdog,
            retained: Some(retained),
            sequence: 1,
        };
        let mut rig = Rig::starting(Params::default(), start);
        rig.time.spawn(clamp::run(rig.links));
        rig.run(1);
        let order = rig.links.tendons.fresh();
        assert!(matches!(order, None | Some(TendonOrder::Resumed(_))), "{order:?}");
        let forces = fresh(rig.links);
        assert_eq!(forces.is_some(), sent, "{grip_memory:?}");
        if let Some(forces) = forces {
            let asked = retained.force.map(|force| TendonForce {
                force,
                stiffness: 0.3,
                hold_position: true,
            });
            assert_eq!(forces.arms, asked);
            assert!(!forces.wound_at_power_on);
        }
    }
}

#[test]
fn forces_and_grip_state_carry_the_time_of_their_pressures() {
    let mut bench = Bench::new();
    let mut world = World::new(CLOSE, 500.0);
    world.contact = false;
    // Converted 7.6 ms before each step of the clamp.
    bench.0.run_with(300, |links, at| {
        world.speak(links, at);
        if at.as_millis() % 10 == 3 {
            links.contact.send(at, world.pressed());
        }
    });
    let links = bench.0.links;
    let (tendons, grip) = (links.tendons.latest().unwrap(), links.grip.latest().unwrap());
    // The last step was at 290.6 ms.
    assert_eq!((tendons.at.as_millis(), grip.at.as_millis()), (283, 283));
    assert!(matches!(tendons.value, TendonOrder::Measured(_)), "{tendons:?}");
}

#[test]
fn without_pressures_forces_follow_the_command_and_say_so() {
    let mut bench = Bench::new();
    let mut world = World::new(CLOSE, 500.0);
    let before = bench.run(500, &world);
    world.contact = false;
    // The last pressures, of 499 ms, are fresh to 519 ms.
    bench.run(60, &world);
    let links = bench.0.links;
    let order = links.tendons.latest().unwrap();
    assert!(matches!(order.value, TendonOrder::Blind(_)), "{order:?}");
    // Time of the newest command: the last step was at 550.6 ms.
    assert_eq!(order.at.as_millis(), 550);
    // All are faulty by a fresh judgement.
    assert!(links.grip.fresh().is_some() && bench.states() == [ArmState::Faulty; 4]);
    let held = force(links).unwrap();
    assert!(held[0] >= before[0]);
    // Released blind.
    world.command = Some(ClampCommand::Release);
    let after = bench.run(300, &world);
    assert!(after[0] < held[0], "{held:?} {after:?}");
    assert!(matches!(
        bench.0.links.tendons.fresh(),
        Some(TendonOrder::Blind(_))
    ));
}
