//! The barometer's rate, its age, and what is no pressure.

use embassy_time::Instant;
use sophie_tasks::navigation::barometer;
use sophie_tasks::schedule::TaskId;

use crate::rig::Rig;
use sophie_fakes::{Answer, FakeBarometer};

fn started() -> (Rig, FakeBarometer) {
    let (rig, port) = (Rig::new(), FakeBarometer::default());
    port.1.set(101_325.0);
    rig.time.spawn(barometer::run(rig.links, port.clone()));
    (rig, port)
}

#[test]
fn pressures_come_at_25_hz_with_the_time_of_their_middle() {
    let (rig, _port) = started();
    rig.time.run_until(1_000_000);
    // The last one began at 965 ms and ended at 980 ms.
    let air = rig.links.air_pressure.latest().unwrap();
    assert_eq!((air.at.as_micros(), air.value.at_us), (972_500, 972_500));
    assert_eq!(air.value.pascal, 101_325.0);
    let timing = rig.links.timing.task(TaskId::Barometer);
    assert!(
        (24..=26).contains(&timing.runs) && timing.overruns == 0,
        "{timing:?}"
    );
}

#[test]
fn a_part_that_hangs_or_fails_turns_stale_and_comes_back_without_a_spin() {
    for answer in [Answer::Fails, Answer::Refuses, Answer::Hangs] {
        let (rig, port) = started();
        rig.time.run_until(1_000_000);
        port.0.answer.set(answer);
        rig.time.run_until(2_000_000);
        assert!(
            rig.links.air_pressure.fresh().is_none() && !port.0.spun.get(),
            "{answer:?}"
        );
        assert_eq!(rig.links.timing.task(TaskId::Barometer).overruns, 0, "{answer:?}");
        port.0.answer.set(Answer::Sound);
        rig.time.run_until(2_200_000);
        assert!(rig.links.air_pressure.fresh().is_some(), "{answer:?}");
    }
}

#[test]
fn what_is_no_pressure_is_not_sent() {
    let (rig, port) = started();
    for wrong in [f32::NAN, f32::INFINITY, 0.0, 29_000.0, 121_000.0] {
        port.1.set(wrong);
        rig.time.run_until(Instant::now().as_micros() + 200_000);
        assert!(rig.links.air_pressure.latest().is_none(), "{wrong}");
    }
}
