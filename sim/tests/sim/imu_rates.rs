//! The closed flight level at each rate and range of the inertial sensor.

use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::test_stands::flight_level::{Maneuver, Rig, vehicle};
use sophie_tasks::schedule::TaskId;

/// 10° to the right for 2 s, and back.
fn lean(t: f64) -> Maneuver {
    Maneuver {
        roll: if (8.0..10.0).contains(&t) { 0.1745 } else { 0.0 },
        yaw_rate: 0.0,
    }
}

#[test]
fn every_rate_flies_alike_and_hands_on_at_1_khz() {
    for (rate, dps, g) in [
        (1000.0, 2000.0, 16.0),
        (2000.0, 1000.0, 8.0),
        (4000.0, 500.0, 4.0),
        (8000.0, 250.0, 4.0),
    ] {
        let mut scenario = vehicle(Configuration::B, 7.75, 6.9, Variant::Flexible);
        scenario.params.set("imu_rate", rate).unwrap();
        scenario.params.set("imu_gyro_range", dps).unwrap();
        scenario.params.set("imu_accel_range", g).unwrap();
        // Uncalibrated, the part's bias leans the vehicle by up to 1.2°, whatever its rate.
        let mut rig = Rig::calibrated(&scenario, |p| Flexible::new(Configuration::B, p));
        let e = rig.fly(16.0, lean);
        println!("{rate} Hz: {e:?}");
        let runs = rig.links.timing.task(TaskId::Imu).runs;
        assert!((19_990..=20_000).contains(&runs), "{rate} Hz: {runs} samples");
        assert!(e.worst_pitch < 1.0 && e.worst_yaw < 3.0, "{rate} Hz: {e:?}");
        // The rates differ by one sample of delay in the part.
        assert!((e.rms_roll - 1.65).abs() < 0.1, "{rate} Hz: {e:?}");
    }
}
