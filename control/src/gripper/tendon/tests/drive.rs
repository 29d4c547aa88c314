//! The tendon drive: its speed, its observer, a missing tilt.

use proptest::prelude::*;

use super::*;

#[test]
fn the_drive_settles_on_the_force_within_the_servo_s_speed() {
    let reel = Reel::from_params(&params(), 0);
    let mut drive = TendonDrive::new();
    let mut last = drive.hold(&reel).pulse_us;
    let per_rad = (2450.0 - 550.0) / 4.71;
    let mut output = Drive::default();
    for _ in 0..100 {
        output = drive.step(&reel, 60.0, Some(-0.8), 0.02);
        assert!((output.pulse_us - last).abs() <= 6.16 * 0.02 * per_rad + 1e-2);
        last = output.pulse_us;
    }
    assert!(close(output.tension, 60.0, 0.1) && !output.held);
    // 25 mm·1.2 + 7.5 mm = 37.5 mm: 2.5 rad.
    assert!(close(output.pulse_us, 550.0 + 2.5 * per_rad, 0.1));
}

#[test]
fn the_observer_sees_through_the_lag_of_a_moving_arm() {
    let reel = Reel::from_params(&params(), 0);
    let mut drive = TendonDrive::new();
    let mut output = Drive::default();
    for i in 0..100 {
        // The arm falls at 0.5 rad/s; the sensor shows where it was 45 ms before.
        let now = -0.2 - 0.5 * 0.02 * i as f32;
        output = drive.step(&reel, 60.0, Some(now + 0.5 * 0.045), 0.02);
    }
    // Lag 2/25 s and age 0.045 s at 0.5 rad/s on 8000 N/m · 0.025 m hide 12.5 N.
    assert!(close(output.tension, 47.5, 0.5), "{}", output.tension);
}

#[test]
fn the_observer_sees_through_the_lag_at_every_frame_rate() {
    for rate in [50.0, 100.0, 333.0] {
        let reel = Reel::from_params(
            &Params {
                servo_frame_rate: rate,
                ..params()
            },
            0,
        );
        let mut drive = TendonDrive::new();
        let (dt, mut output) = (1.0 / rate, Drive::default());
        // 25 ms in sensor and transit, and a frame.
        let age = 0.025 + dt;
        for i in 0..(2.0 * rate) as usize {
            let now = -0.2 - 0.5 * dt * i as f32;
            output = drive.step(&reel, 60.0, Some(now + 0.5 * age), dt);
        }
        // Hidden by filter lag and age: a fall at 0.5 rad/s on 8000 N/m · 0.025 m.
        let hidden = 100.0 * (2.0 / TILT_CUTOFF + age);
        assert!(
            close(output.tension, 60.0 - hidden, 0.5),
            "{rate} Hz: {}",
            output.tension
        );
    }
}

#[test]
fn a_drive_resumes_where_it_was_and_a_wound_one_is_seeded_taut() {
    let reel = Reel::from_params(&params(), 0);
    let mut drive = TendonDrive::new();
    for _ in 0..100 {
        drive.step(&reel, 60.0, Some(-0.8), 0.02);
    }
    let before = drive.hold(&reel).pulse_us;
    let mut again = TendonDrive::new().resume(drive.angle());
    assert!(close(again.hold(&reel).pulse_us, before, 1e-3));
    // Without a tilt, then with one off by 0.02 rad, the servo stays.
    let mut tension = 0.0;
    for tilt in [None, None, Some(-0.78), Some(-0.78)] {
        let output = again.hold_position(&reel, tilt, 0.02);
        assert!(output.held && close(output.pulse_us, before, 1e-3));
        tension = output.tension;
    }
    assert!(close(tension, 64.0, 0.1), "{tension}");
    for _ in 0..50 {
        let pulse = again.step(&reel, tension, Some(-0.78), 0.02).pulse_us;
        assert!(close(pulse, before, 0.1), "{pulse} {before}");
    }
    assert!(TendonDrive::new().resume(f32::NAN).angle() == 0.0);
    assert!(TendonDrive::new().resume(1e9).angle() <= ANGLE_MAX);

    // 25 mm·1.2 on 15 mm: 2 rad; paid out in 0.67 s.
    let mut wound = TendonDrive::new();
    wound.seed_from_tilt(&reel, Some(-0.8));
    assert!(close(wound.angle(), 2.0, 1e-3));
    let frames = (1..100).find(|_| wound.step(&reel, 0.0, Some(-0.8), 0.02).tension <= 0.0);
    assert!(frames.is_some_and(|n| (32..36).contains(&n)), "{frames:?}");
    for tilt in [None, Some(f32::NAN), Some(9.0)] {
        wound.seed_from_tilt(&reel, tilt);
        assert!(wound.angle() == 0.0);
    }
}

#[test]
fn on_the_bench_a_servo_goes_to_any_pulse_slowly_and_back_without_a_jump() {
    // Trimmed, and mirrored, to both ends of servo pulses.
    let mirrored = Params {
        servo_release_2: 2000.0,
        servo_full_2: 700.0,
        servo_trim_2: -20.0,
        ..params()
    };
    for (reel, range) in [
        (Reel::from_params(&params(), 0), 1900.0),
        (Reel::from_params(&mirrored, 1), 1300.0),
    ] {
        let (release, dt) = (reel.pulse(0.0), 0.02);
        // BENCH_SPEED out, pay-out speed back, µs a step.
        let [slow, fast] = [1.0, 3.0].map(|speed| speed * dt * range / 4.71 + 1e-2);
        for goal in [500.0, 1500.0, 2500.0, 9000.0] {
            let mut drive = TendonDrive::new();
            let mut last = release;
            for _ in 0..500 {
                let output = drive.place(&reel, goal, None, dt);
                assert!((output.pulse_us - last).abs() <= slow, "{last} {output:?}");
                assert!(!output.held);
                last = output.pulse_us;
            }
            assert!(close(last, goal.min(2500.0), 0.1), "{goal}: {last}");
            for _ in 0..250 {
                let output = drive.step(&reel, 0.0, None, dt);
                assert!((output.pulse_us - last).abs() <= fast, "{last} {output:?}");
                last = output.pulse_us;
            }
            assert!(close(last, release, 1e-3), "{goal}: {last}");
            assert_eq!(drive, TendonDrive::new());
        }
    }
}

#[test]
fn a_missing_tilt_holds_and_paying_out_needs_none() {
    let reel = Reel::from_params(&params(), 0);
    let mut drive = TendonDrive::new();
    for _ in 0..100 {
        drive.step(&reel, 60.0, Some(-0.8), 0.02);
    }
    let before = drive.hold(&reel).pulse_us;
    let output = drive.step(&reel, 90.0, None, 0.02);
    assert!(output.held && close(output.pulse_us, before, 1e-6));
    let mut time = 0.0;
    let mut output = drive.step(&reel, 0.0, None, 0.02);
    while output.tension > 0.0 {
        assert!(time < 5.0);
        time += 0.02;
        output = drive.step(&reel, 0.0, None, 0.02);
    }
    // 2.5 rad at 3 rad/s.
    assert!(close(time, 0.83, 0.04) && close(output.pulse_us, 550.0, 1.0) && !output.held);
}

proptest! {
    #[test]
    fn no_input_makes_the_output_bad(
        inputs in proptest::collection::vec(
            (proptest::num::f32::ANY, proptest::option::of(proptest::num::f32::ANY), proptest::num::f32::ANY),
            1..40,
        ),
    ) {
        let reel = Reel::from_params(&params(), 0);
        let mut drive = TendonDrive::new();
        for (force, tilt, dt) in inputs {
            let output = drive.step(&reel, force, tilt, dt);
            prop_assert!(output.pulse_us >= 550.0 && output.pulse_us <= 2450.0);
            prop_assert!(output.tension >= 0.0 && output.tension.is_finite());
        }
    }
}
