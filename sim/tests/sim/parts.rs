//! The gripper that flies on an arm whose tendon, servo and pressure sensor are as real ones: what each costs the grip.

use sophie_control::gripper::grip::ArmState;
use sophie_sim::parallel;
use sophie_sim::plant::tendon::{ServoErrors, ServoProfile, ServoSpec, TendonSpec};
use sophie_sim::sensors::fsr::FsrErrors;
use sophie_sim::test_stands::arm_stand::{Closing, StandArm, Tried, try_grip};

/// Longest closing, s: the default `clamp_timeout`.
const LONGEST: f64 = 10.0;

fn arm() -> StandArm {
    StandArm::from(&Closing {
        infill: 6.9,
        diameter: 0.30,
        servo: ServoProfile::Paper.into(),
        thrust: 2.5,
        seconds: LONGEST,
        seed: 1,
    })
}

fn with_tendon(change: impl FnOnce(&mut TendonSpec)) -> StandArm {
    let mut arm = arm();
    change(&mut arm.tendon);
    arm
}

fn with_servo(errors: ServoErrors) -> StandArm {
    StandArm {
        servo: ServoSpec {
            errors,
            ..ServoProfile::Paper.into()
        },
        ..arm()
    }
}

fn with_fsr(change: impl FnOnce(&mut FsrErrors)) -> StandArm {
    let mut arm = arm();
    change(&mut arm.fsr);
    arm
}

/// Names and results, printed.
fn tried(cases: &[(String, StandArm)]) -> Vec<Tried> {
    let tried: Vec<Tried> = parallel::each(cases, |(_, arm)| try_grip(arm, LONGEST));
    for ((name, _), tried) in cases.iter().zip(&tried) {
        let Tried {
            grip,
            asked,
            steady,
            peak,
        } = tried;
        println!(
            "{name:24} {:?} {:?}, closed in {:?} s, asked {asked:.0} N, {steady:.3} N m at rest, peak {peak:.0} Pa",
            grip.state, grip.fault, grip.closure
        );
    }
    tried
}

#[test]
fn friction_overshoots_on_the_way_in_and_holds_the_grip_on_the_way_back() {
    let cases = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0].map(|friction| {
        (
            format!("friction {friction}"),
            with_tendon(|spec| spec.friction = friction),
        )
    });
    let tried = tried(&cases);
    let [smooth, .., worst] = tried.as_slice() else {
        panic!("no cases");
    };
    let rubbing = &tried[2];
    assert!(smooth.grip.state == ArmState::Holding && rubbing.grip.state == ArmState::Holding);
    // The reel pulls more until the arm is there; then it turns back, and the channel still holds.
    assert!(rubbing.asked > 1.05 * smooth.asked && rubbing.peak > 1.2 * smooth.peak);
    assert!(rubbing.steady < smooth.steady);
    // The rougher the channel, the later and the harder: past 1.5 kPa at last, and still a grip.
    let holds = |tried: &Tried| tried.grip.state == ArmState::Holding;
    assert!(tried.iter().all(holds) && tried.is_sorted_by(|a, b| a.peak < b.peak));
    assert!(worst.peak < 1700.0, "{}", worst.peak);
}

#[test]
fn a_soft_thread_is_learnt_and_closes_as_a_stiff_one() {
    let cases = [8000.0, 5000.0, 3000.0, 2000.0, 1500.0].map(|stiffness| {
        (
            format!("stiffness {stiffness}"),
            with_tendon(|spec| spec.stiffness = stiffness),
        )
    });
    let tried = tried(&cases);
    for soft in &tried {
        assert!(soft.grip.state == ArmState::Holding && soft.peak < 1.1 * tried[0].peak);
        let (held, asked) = (soft.steady / tried[0].steady, soft.asked / tried[0].asked);
        assert!(
            (held - 1.0).abs() < 0.1 && (asked - 1.0).abs() < 0.2,
            "{held} {asked}"
        );
    }
}

#[test]
fn servos_and_sensors_as_they_are() {
    let degree = 1.0_f64.to_radians();
    let servo = |change: fn(&mut ServoErrors, f64), by: f64| {
        let mut errors = ServoErrors::default();
        change(&mut errors, by);
        with_servo(errors)
    };
    let cases = [
        ("whole".to_owned(), arm()),
        (
            "stop 0.5 deg".to_owned(),
            servo(|e, by| e.stop = by, 0.5 * degree),
        ),
        ("stop 1 deg".to_owned(), servo(|e, by| e.stop = by, degree)),
        ("stop 2 deg".to_owned(), servo(|e, by| e.stop = by, 2.0 * degree)),
        (
            "backlash 1 deg".to_owned(),
            servo(|e, by| e.backlash = by, degree),
        ),
        (
            "sag 1.5 deg/N m".to_owned(),
            servo(|e, by| e.sag = by, 1.5 * degree),
        ),
        ("turn-on 0.4 N".to_owned(), with_fsr(|e| e.turn_on = 0.4)),
        ("preload 0.15 N".to_owned(), with_fsr(|e| e.preload = 0.15)),
        ("hysteresis 10 %".to_owned(), with_fsr(|e| e.hysteresis = 0.1)),
        ("drift 4 %".to_owned(), with_fsr(|e| e.drift = 0.04)),
    ];
    let tried = tried(&cases);
    // A load that the servo gives way to, and a sensor that reads another pressure, leave a grip that the loop finds.
    for index in [0, 4, 5, 8, 9] {
        assert!(tried[index].grip.state == ArmState::Holding, "{}", cases[index].0);
    }
    // What the sensor leaves out, the grip has too much: 0.4 N of 38 mm square are 277 Pa.
    assert!(tried[6].peak > tried[0].peak + 150.0, "{}", tried[6].peak);
}
