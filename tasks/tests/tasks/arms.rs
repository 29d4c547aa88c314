//! Age of the arms' tilts.

use embassy_time::Instant;
use sophie_control::chain::Attitude;
use sophie_control::params::{ArmSign, Params};
use sophie_tasks::links::Links;
use sophie_tasks::perching::arms;

use crate::rig::Rig;
use sophie_fakes::{Answer, FakeArms};

fn level(links: &Links, at: Instant) {
    let attitude = Attitude {
        calibrated: true,
        ..Attitude::default()
    };
    links.attitude.send(at, attitude);
}

fn ages_us(links: &Links) -> [Option<u64>; 4] {
    let angles = links.arms.latest().unwrap().value;
    let now = Instant::now();
    angles.tilt.map(|tilt| tilt.map(|t| (now - t.at).as_micros()))
}

#[test]
fn each_tilt_carries_the_time_at_which_its_own_sensor_was_asked() {
    let (mut rig, port) = (Rig::new(), FakeArms::default());
    rig.time.spawn(arms::run(rig.links, port.clone()));
    // A reading takes 410 us: the last round began at 100 ms and ended at 101.64 ms.
    rig.run_with(105, level);
    assert_eq!(
        ages_us(rig.links),
        [Some(5000), Some(4590), Some(4180), Some(3770)]
    );
    assert_eq!(rig.links.arms.latest().unwrap().at.as_micros(), 100_000);
    // The second sensor hangs for 20 ms of 21.23 ms: the third and fourth are younger than the first.
    port.1[1].answer.set(Answer::Hangs);
    rig.run_with(27, level);
    assert_eq!(ages_us(rig.links), [Some(22_000), None, Some(1590), Some(1180)]);
    assert_eq!(rig.links.arms.latest().unwrap().at.as_micros(), 110_000);
}

#[test]
fn each_tilt_grows_old_by_itself() {
    let (mut rig, port) = (Rig::new(), FakeArms::default());
    rig.time.spawn(arms::run(rig.links, port.clone()));
    rig.run_with(105, level);
    port.0.answer.set(Answer::Hangs);
    let known = |rig: &Rig| rig.links.tilts().values().map(|tilt| tilt.is_some());
    // Asked at 100.00, 100.41, 100.82 and 101.23 ms.
    rig.time.run_until(200_300);
    assert_eq!(known(&rig), [false, true, true, true]);
    rig.time.run_until(201_000);
    assert_eq!(known(&rig), [false, false, false, true]);
    rig.time.run_until(201_300);
    assert_eq!(known(&rig), [false; 4]);
}

#[test]
fn each_tilt_has_the_zero_and_the_sign_of_its_sensor() {
    let params = Params {
        arm_zero_1: 0.1,
        arm_sign_3: ArmSign::Reversed,
        arm_zero_3: -0.2,
        ..Params::DEFAULT
    };
    let (mut rig, port) = (Rig::with(params), FakeArms::default());
    rig.time.spawn(arms::run(rig.links, port));
    rig.run_with(105, level);
    let [first, second, third, fourth] = rig.links.tilts().values().map(Option::unwrap);
    assert!((first + 0.1).abs() < 1e-6 && second == 0.0 && (third - 0.2).abs() < 1e-6 && fourth == 0.0);
}
