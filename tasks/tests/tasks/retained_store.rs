//! State retained over a reset.

use embassy_time::Instant;
use sophie_control::chain::{Attitude, MixOutput};
use sophie_control::gripper::grip::{ArmGrip, GripState};
use sophie_control::gripper::grip_fault::GripFault;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::{ImuMounting, Params};
use sophie_control::pilot::rc::ArmChoice;
use sophie_ports::retained::StartCause;
use sophie_tasks::links::Links;
use sophie_tasks::links::tendon_order::{TendonForce, TendonForces, TendonOrder};
use sophie_tasks::start::Start;
use sophie_tasks::start::retained_state::RetainedState;
use sophie_tasks::supervision::retained_store::RetainedStore;

use crate::rig::Rig;
use sophie_fakes::FakeMemory;

const GRIP: GripMemory = GripMemory::Controlled(ArmChoice::All);
const BIAS: Vec3 = Vec3::new(0.01, -0.02, 0.03);

/// A grip of 50 N on each tendon, rotors at 2 N.
fn speak(links: &Links, running: bool, calibrated: bool) {
    let now = Instant::now();
    links.grip_memory.send(now, GRIP);
    links.reel_angle.send(now, [2.0, 2.1, 2.2, 2.3]);
    let forces = TendonForces {
        arms: [50.0, 51.0, 52.0, 5.0].map(|force| TendonForce {
            force,
            stiffness: 1.0,
            hold_position: false,
        }),
        wound_at_power_on: false,
    };
    links.tendons.send(now, TendonOrder::Measured(forces));
    let mut grip = GripState::default();
    for (arm, fault) in grip.arms.iter_mut().zip([
        None,
        Some(GripFault::Sensor),
        Some(GripFault::Stale),
        Some(GripFault::Unfelt),
    ]) {
        *arm = ArmGrip {
            fault,
            ..ArmGrip::default()
        };
    }
    links.grip.send(now, grip);
    let mix = MixOutput {
        running,
        thrusts: [2.0; 4],
        ..MixOutput::default()
    };
    links.mix.send(now, mix);
    let attitude = Attitude {
        gyro_bias: BIAS,
        calibrated,
        ..Attitude::default()
    };
    links.attitude.send(now, attitude);
}

fn found(memory: &FakeMemory) -> Start {
    Start::new(StartCause::Watchdog, &memory.copies())
}

#[test]
fn a_grip_is_kept_without_what_met_the_rotors_and_with_the_faults_that_last() {
    // 2 N of thrust take 0.55·0.178/0.015·2 = 13.05 N of a tendon: 50 N leave 36.95 N, 5 N none.
    for (running, force) in [
        (true, [36.947, 37.947, 38.947, 0.0]),
        (false, [50.0, 51.0, 52.0, 5.0]),
    ] {
        let (rig, memory) = (Rig::new(), FakeMemory::default());
        speak(rig.links, running, true);
        RetainedStore::new(rig.links, memory.clone()).keep(rig.links);
        let retained = found(&memory).retained.unwrap();
        for (kept, expected) in retained.force.iter().zip(force) {
            assert!((kept - expected).abs() < 0.01, "{running}: {:?}", retained.force);
        }
        assert_eq!(
            (retained.grip_memory, retained.angle),
            (GRIP, [2.0, 2.1, 2.2, 2.3])
        );
        assert_eq!(
            retained.fault,
            [None, Some(GripFault::Sensor), None, Some(GripFault::Unfelt)]
        );
        assert_eq!(retained.gyro_bias, Some(BIAS));
    }
}

/// The next start may have another mounting: what is kept is in the part's own axes.
#[test]
fn the_gyros_bias_is_kept_as_the_part_has_it() {
    let params = Params {
        imu_mounting: ImuMounting::ALL[8],
        ..Params::DEFAULT
    };
    let (rig, memory) = (Rig::with(params), FakeMemory::default());
    speak(rig.links, false, true);
    RetainedStore::new(rig.links, memory.clone()).keep(rig.links);
    // The vehicle's nose is at the board's right.
    let own = Vec3::new(-BIAS.y, BIAS.x, BIAS.z);
    assert_eq!(found(&memory).retained.unwrap().gyro_bias, Some(own));
}

#[test]
fn before_calibration_there_is_no_bias() {
    let (rig, memory) = (Rig::new(), FakeMemory::default());
    speak(rig.links, false, false);
    RetainedStore::new(rig.links, memory.clone()).keep(rig.links);
    assert_eq!(found(&memory).retained.unwrap().gyro_bias, None);
}

#[test]
fn copies_are_written_by_turns_and_numbered_on_from_the_run_before() {
    let retained = RetainedState {
        grip_memory: GRIP,
        angle: [1.0; 4],
        ..RetainedState::default()
    };
    let start = Start {
        cause: StartCause::Watchdog,
        retained: Some(retained),
        sequence: 7,
    };
    let (rig, memory) = (Rig::starting(Params::default(), start), FakeMemory::default());
    let mut store = RetainedStore::new(rig.links, memory.clone());
    // Without messages the last run's copies stay, by even and odd numbers.
    for (sequence, writes) in [(8, [1, 0]), (9, [1, 1]), (10, [2, 1]), (11, [2, 2])] {
        store.keep(rig.links);
        assert_eq!(memory.0.get().1, writes);
        assert_eq!(
            (found(&memory).sequence, found(&memory).retained),
            (sequence, Some(retained))
        );
    }
}

#[test]
fn nothing_is_kept_before_the_arms_were_looked_at_and_old_messages_change_nothing() {
    let (mut rig, memory) = (Rig::new(), FakeMemory::default());
    let mut store = RetainedStore::new(rig.links, memory.clone());
    store.keep(rig.links);
    assert!(found(&memory).retained.is_none() && memory.0.get().1 == [0, 0]);
    speak(rig.links, false, true);
    store.keep(rig.links);
    let kept = found(&memory).retained;
    assert!(kept.is_some());
    // An angle that is stale when read.
    rig.links.reel_angle.send(Instant::now(), [6.0; 4]);
    rig.links.grip_memory.send(Instant::now(), GripMemory::Open);
    rig.run(201);
    store.keep(rig.links);
    assert_eq!(found(&memory).retained, kept);
}

#[test]
fn forces_that_are_resumed_or_old_are_not_kept_as_news() {
    let kept = RetainedState {
        grip_memory: GRIP,
        force: [40.0; 4],
        ..RetainedState::default()
    };
    let start = Start {
        cause: StartCause::Watchdog,
        retained: Some(kept),
        sequence: 7,
    };
    let (mut rig, memory) = (Rig::starting(Params::default(), start), FakeMemory::default());
    let mut store = RetainedStore::new(rig.links, memory.clone());
    let forces = TendonForces {
        arms: [TendonForce {
            force: 60.0,
            stiffness: 1.0,
            hold_position: false,
        }; 4],
        wound_at_power_on: false,
    };
    rig.links
        .tendons
        .send(Instant::now(), TendonOrder::Resumed(forces));
    store.keep(rig.links);
    assert_eq!(found(&memory).retained.unwrap().force, [40.0; 4]);
    rig.links.tendons.send(Instant::now(), TendonOrder::Blind(forces));
    rig.run(201);
    store.keep(rig.links);
    assert_eq!(found(&memory).retained.unwrap().force, [40.0; 4]);
    rig.links.tendons.send(Instant::now(), TendonOrder::Blind(forces));
    store.keep(rig.links);
    assert_eq!(found(&memory).retained.unwrap().force, [60.0; 4]);
}
