//! The position task between the links.

use embassy_time::{Duration, Instant};
use sophie_control::chain::Attitude;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_ports::external_pose::{ExternalPose, Pose};
use sophie_tasks::links::Links;
use sophie_tasks::navigation::position;
use sophie_tasks::schedule::TaskId;

use crate::rig::Rig;

/// A pose 30 ms old, each 20 ms, of a vehicle that rests at `place`, heading as its own attitude.
fn speak(links: &Links, at: Instant, place: Option<Vec3>, attitude: Option<Quat>) {
    let sample = Attitude {
        accel: Vec3::new(0.0, 0.0, -9.806_65),
        calibrated: true,
        ..Attitude::default()
    };
    links.attitude.send(at, sample);
    if let Some(position) = place
        && at.as_millis().is_multiple_of(20)
        && let Some(measured) = at.checked_sub(Duration::from_millis(30))
    {
        let pose = Pose {
            position,
            attitude,
            ..Pose::default()
        };
        let pose = ExternalPose {
            pose,
            measured_at: measured.as_micros(),
            received_at: at.as_micros(),
            ..ExternalPose::default()
        };
        links.external_pose.send(measured, pose);
    }
}

fn rig() -> Rig {
    let rig = Rig::new();
    rig.time.spawn(position::run(rig.links));
    rig
}

const PLACE: Vec3 = Vec3::new(1.0, -2.0, -3.0);

#[test]
fn poses_become_an_estimate_of_the_attitudes_time_within_a_second() {
    let mut rig = rig();
    rig.run_with(1000, |links, at| {
        speak(links, at, Some(PLACE), Some(Quat::IDENTITY))
    });
    let newest = rig.links.position.latest().unwrap();
    assert!((newest.value.position - PLACE).norm() < 0.01, "{newest:?}");
    assert!(newest.value.age < 0.06);
    let age = Instant::now().saturating_duration_since(newest.at);
    assert!(age <= TaskId::Position.period(), "{age:?}");
}

#[test]
fn without_poses_or_their_heading_nothing_is_sent() {
    for (place, attitude) in [(None, None), (Some(PLACE), None)] {
        let mut rig = rig();
        rig.run_with(2000, |links, at| speak(links, at, place, attitude));
        assert!(rig.links.position.latest().is_none(), "{place:?}");
    }
}

#[test]
fn a_source_that_falls_silent_ages_and_a_stale_attitude_ends_the_estimate() {
    let mut rig = rig();
    rig.run_with(1000, |links, at| {
        speak(links, at, Some(PLACE), Some(Quat::IDENTITY))
    });
    rig.run_with(500, |links, at| speak(links, at, None, None));
    let age = rig.links.position.fresh().unwrap().age;
    assert!((0.5..0.56).contains(&age), "{age}");
    rig.run(70);
    assert!(rig.links.position.fresh().is_none());
}
