//! The task of the flow and range module on scripted lines, and flow through to the position.

use embassy_time::{Duration, Instant};
use sophie_control::chain::Attitude;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::flow_range_sample::{Flow, GroundView, Range};
use sophie_fakes::{BrokenLine, FakeLine};
use sophie_ports::sensors::GroundDecoder;
use sophie_tasks::links::Links;
use sophie_tasks::navigation::{flow_range, position};
use sophie_tasks::schedule::TaskId;

use crate::rig::Rig;

/// A protocol of one byte, the distance in decimetres; 0 is no frame.
#[derive(Default)]
struct Decimetres {
    broken: u32,
}

impl GroundDecoder for Decimetres {
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<GroundView> {
        let last = bytes.iter().rfind(|byte| **byte > 0)?;
        let range = Range {
            at_us: at.as_micros(),
            distance: Some(f32::from(*last) * 0.1),
            reach: (0.02, 8.0),
        };
        Some(GroundView {
            flow: None,
            range: Some(range),
        })
    }

    fn broken(&mut self) {
        self.broken += 1;
    }
}

#[test]
fn what_the_module_says_is_published_at_once_and_what_is_no_frame_is_not() {
    let mut rig = Rig::new();
    let line = FakeLine::default();
    rig.time
        .spawn(flow_range::run(rig.links, line.clone(), Decimetres::default()));
    rig.run(10);
    line.put(&[0, 0]);
    rig.run(10);
    assert!(rig.links.ground.latest().is_none());
    line.put(&[12]);
    rig.run(10);
    let seen = rig.links.ground.latest().unwrap();
    let range = seen.value.range.unwrap();
    assert_eq!((range.distance, range.at_us), (Some(1.2), seen.at.as_micros()));
    assert!(rig.links.timing.task(TaskId::Ground).runs >= 2);
    rig.run(250);
    assert!(rig.links.ground.fresh().is_none());
}

#[test]
fn a_dead_line_does_not_take_the_processor() {
    let mut rig = Rig::new();
    let line = BrokenLine::default();
    rig.time
        .spawn(flow_range::run(rig.links, line.clone(), Decimetres::default()));
    rig.run(1000);
    assert_eq!(rig.links.timing.task(TaskId::Ground).runs, 0);
    assert!(rig.links.ground.latest().is_none());
}

/// A level vehicle at rest 1 m over the ground, seen each 20 ms.
fn speak(links: &Links, at: Instant) {
    let sample = Attitude {
        accel: Vec3::new(0.0, 0.0, -9.806_65),
        calibrated: true,
        ..Attitude::default()
    };
    links.attitude.send(at, sample);
    if at.as_millis().is_multiple_of(20)
        && let Some(measured) = at.checked_sub(Duration::from_millis(25))
    {
        // Noise, which a part that stands still would not have.
        let noise = (at.as_millis() / 20 % 5) as f32 * 1e-4;
        let view = GroundView {
            flow: Some(Flow {
                until_us: measured.as_micros(),
                seconds: 0.02,
                angle: [noise, -noise],
                quality: 100,
            }),
            range: Some(Range {
                at_us: measured.as_micros(),
                distance: Some(1.0 + noise * 10.0),
                reach: (0.02, 8.0),
            }),
        };
        links.ground.send(at, view);
    }
}

#[test]
fn flow_and_range_alone_become_an_estimate_within_a_second() {
    let mut rig = Rig::new();
    rig.time.spawn(position::run(rig.links));
    rig.run_with(1000, speak);
    let estimate = rig.links.position.fresh().unwrap();
    assert!(
        (estimate.position.z + 1.0).abs() < 0.02 && estimate.velocity.norm() < 0.03,
        "{estimate:?}"
    );
    assert!(estimate.age < 0.06 && rig.links.position_fault.fresh().is_none());
}
