//! The four arms together, and bounds for any input.

use proptest::prelude::*;

use super::*;

#[test]
fn every_chosen_arm_must_hold_and_every_arm_be_free() {
    let cfg = config();
    let mut gripper = Gripper::default();
    let front = [true, false, true, false];
    let mut out = GripperOutput::default();
    let drive = |gripper: &mut Gripper, close: PerArm<bool>, pressure: PerArm<f32>, seconds: f32| {
        let mut out = GripperOutput::default();
        for _ in 0..(seconds / DT) as u32 {
            let mut inputs = [ArmInput::default(); 4];
            for ((i, arm), (close, p)) in inputs
                .iter_mut()
                .zip(&gripper.arms)
                .zip(close.into_iter().zip(pressure))
            {
                *i = ArmInput {
                    close,
                    ..input(&cfg, arm, p)
                };
            }
            out = gripper.step(&cfg, &inputs, DT);
        }
        out
    };
    for (pressures, proven) in [
        ([0.0; 4], false),
        ([950.0, 0.0, 780.0, 0.0], false),
        ([950.0, 0.0, 950.0, 0.0], true),
    ] {
        out = drive(&mut gripper, front, pressures, 1.5);
        assert!(out.proven == proven && !out.released, "{out:?}");
    }
    assert!(
        out.arms.map(|arm| arm.grip.state)
            == [
                ArmState::Holding,
                ArmState::Free,
                ArmState::Holding,
                ArmState::Free
            ]
    );
    out = drive(&mut gripper, [false; 4], [0.0, 0.0, 300.0, 0.0], 5.0);
    assert!(!out.released && !out.proven);
    // Both must be settled at once, not in turn.
    let mut gripper = Gripper::default();
    for (pressures, proven) in [
        ([0.0; 4], false),
        ([950.0, 0.0, 780.0, 0.0], false),
        ([1120.0, 0.0, 950.0, 0.0], false),
        ([960.0, 0.0, 950.0, 0.0], true),
        ([1420.0, 0.0, 650.0, 0.0], true),
    ] {
        out = drive(&mut gripper, front, pressures, 1.5);
        assert!(out.proven == proven, "{pressures:?} {out:?}");
    }
    out = drive(&mut gripper, [false; 4], [0.0, 0.0, 300.0, 0.0], 5.0);
    assert!(!out.released && !out.proven);
    out = drive(&mut gripper, [false; 4], [0.0; 4], 1.0);
    assert!(out.released && !out.proven);
}

/// One that holds longer than the others turns the body.
#[test]
fn tendons_go_slack_together_however_tight_each_was() {
    let cfg = config();
    let mut gripper = Gripper::default();
    let tight = [22.0, 33.0, 31.0, 107.0];
    for (arm, force) in gripper.arms.iter_mut().zip(tight) {
        *arm = ArmGripper::resume(force, None, None);
    }
    let mut time = 0.0;
    while gripper.arms.iter().any(|arm| arm.force > 0.5) {
        let inputs = gripper.arms.map(|arm| released(input(&cfg, &arm, 300.0)));
        gripper.step(&cfg, &inputs, DT);
        time += DT;
        let share = gripper.arms[3].force / tight[3];
        for (arm, force) in gripper.arms.iter().zip(tight) {
            assert!(
                close(arm.force, share * force, 0.01),
                "{time}: {share} {}",
                arm.force
            );
        }
    }
    assert!(close(time, 107.0 / cfg.release_rate, 0.03), "{time}");
}

#[test]
fn arms_round_no_pipe_are_no_proof_until_they_lie_round_one() {
    let cfg = config();
    let mut gripper = Gripper::default();
    let mut drive = |tilts: PerArm<f32>, pressure: f32, seconds: f32| {
        let mut out = GripperOutput::default();
        for _ in 0..(seconds / DT) as u32 {
            let mut inputs = [ArmInput::default(); 4];
            for ((i, arm), tilt) in inputs.iter_mut().zip(&gripper.arms).zip(tilts) {
                *i = ArmInput {
                    tilt: Some(-scalar::deg(tilt)),
                    ..input(&cfg, arm, pressure)
                };
            }
            out = gripper.step(&cfg, &inputs, DT);
        }
        (out.proven, out.misfit)
    };
    let round = [75.0, 67.0, 66.0, 75.0];
    assert_eq!(drive(round, 500.0, 0.1), (false, None));
    assert_eq!(
        drive([30.0, 110.0, 110.0, 30.0], 950.0, 2.0),
        (false, Some(Misfit::Oblique))
    );
    assert_eq!(
        drive([75.0, 67.0, 20.0, 75.0], 950.0, 0.1),
        (false, Some(Misfit::Uneven))
    );
    assert_eq!(drive(round, 950.0, 0.1), (true, None));
    // Proven, a knock of one sensor does not take it back: the pressure does.
    assert_eq!(drive([75.0, 67.0, 20.0, 75.0], 950.0, 1.0), (true, None));
    assert_eq!(drive(round, 200.0, 1.0), (false, None));
}

fn any_pressure() -> impl Strategy<Value = Pressure> {
    prop_oneof![
        proptest::num::f32::ANY.prop_map(Pressure::Known),
        (0.0f32..2000.0).prop_map(Pressure::Known),
        Just(Pressure::Stale),
        Just(Pressure::Faulty),
    ]
}

proptest! {
    #[test]
    fn the_force_stays_within_its_bounds(
        steps in proptest::collection::vec(
            (
                any::<bool>(), any_pressure(), proptest::num::f32::ANY, proptest::num::f32::ANY,
                proptest::option::of(proptest::num::f32::ANY),
                proptest::option::of(prop_oneof![proptest::num::f32::ANY, -2.0f32..0.5]),
                prop_oneof![proptest::num::f32::ANY, 0.005f32..0.02],
            ),
            1..200,
        ),
    ) {
        let cfg = config();
        let mut arm = ArmGripper::default();
        for (close, pressure, turn_on, thrust, tension, tilt, dt) in steps {
            let grip = arm.step(&cfg, &ArmInput { close, pressure, turn_on, thrust, tension, tilt }, dt);
            prop_assert!(grip.force >= 0.0 && grip.force <= cfg.limit(), "{grip:?}");
            prop_assert!(grip.pressure.is_finite());
            prop_assert!(grip.closure.is_none_or(f32::is_finite));
        }
    }
}

#[test]
fn one_arm_that_presses_before_the_first_pulse_means_wound_tendons() {
    let cfg = config();
    // Above 80 Pa.
    for (pressure, wound) in [
        ([0.0; 4], false),
        ([0.0, 0.0, 300.0, 0.0], true),
        ([70.0; 4], false),
    ] {
        let mut gripper = Gripper::default();
        let inputs = pressure.map(|pressure| ArmInput {
            pressure: Pressure::Known(pressure),
            ..ArmInput::default()
        });
        for _ in 0..30 {
            gripper.step_without_pulses(&cfg, &inputs, DT);
        }
        let light = [ArmInput::default(); 4];
        let out = gripper.step(&cfg, &light, DT);
        assert_eq!(out.wound_at_power_on, wound, "{pressure:?}");
    }
}
