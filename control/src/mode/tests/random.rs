//! Random pilots, sensors and grips against invariants.

extern crate std;
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::{ArmGrip, GripState};
use crate::gripper::grip_geometry::Misfit;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::vector::{Quat, Vec3};
use crate::pilot::rc::{ArmChoice, Sticks};
use crate::pilot::remote::RemoteRequest;
use std::vec::Vec;

use proptest::prelude::*;

use super::rig::Rig;
use crate::gripper::grip::ArmState;
use crate::mode::*;
use crate::navigation::estimate::{Estimate, SurfaceLevels};
use crate::navigation::range_hit::RangeHit;
use crate::pilot::rc::StickMode;
use crate::pilot::release_throttle::RELEASE_THROTTLE_MIN;
use crate::pilot::remote::RemoteOrder;

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![8 => -1.0f32..1.0, 1 => Just(f32::NAN), 1 => Just(f32::INFINITY)]
}

fn sticks() -> impl Strategy<Value = Option<Sticks>> {
    let throttle = prop_oneof![Just(0.0f32), Just(0.3), Just(0.55), 0.0f32..1.0];
    let mode = prop_oneof![
        Just(StickMode::Angle),
        Just(StickMode::Rate),
        Just(StickMode::Direct)
    ];
    let arms = prop_oneof![
        Just(ArmChoice::All),
        Just(ArmChoice::Front),
        Just(ArmChoice::Rear)
    ];
    let yaw = prop_oneof![Just(1.0f32), Just(-1.0), number()];
    let values = (
        number(),
        number(),
        yaw,
        throttle,
        mode,
        arms,
        prop::bool::weighted(0.9),
        any::<bool>(),
        any::<bool>(),
    );
    let some = values.prop_map(
        |(roll, pitch, yaw, throttle, stick_mode, arms, arm_switch, perch_switch, hold_switch)| {
            Some(Sticks {
                roll,
                pitch,
                yaw,
                throttle,
                arm_switch,
                perch_switch,
                hold_switch,
                stick_mode,
                arms,
            })
        },
    );
    prop_oneof![9 => some, 1 => Just(None)]
}

fn grip() -> impl Strategy<Value = Option<GripState>> {
    let state = prop_oneof![
        Just(ArmState::Free),
        Just(ArmState::Touching),
        Just(ArmState::Holding),
        Just(ArmState::ForceLimited),
        Just(ArmState::Faulty),
    ];
    let some = (
        prop::bool::weighted(0.7),
        any::<bool>(),
        state,
        0.0f32..1000.0,
        prop::bool::weighted(0.1),
    )
        .prop_map(|(proven, released, state, pressure, misfit)| {
            let arm = ArmGrip {
                state,
                pressure,
                ..Default::default()
            };
            Some(GripState {
                proven,
                misfit: (misfit && !proven).then_some(Misfit::Oblique),
                released,
                arms: [arm; 4],
            })
        });
    prop_oneof![9 => some, 1 => Just(None)]
}

fn position() -> impl Strategy<Value = Option<Estimate>> {
    let age = prop_oneof![Just(0.02f32), 0.0f32..10.0];
    let vector = |size: f32| [-size..size, -size..size, -size..size].prop_map(Vec3::from);
    let reset_count = prop_oneof![9 => Just(0u8), 1 => any::<u8>()];
    let point = prop_oneof![3 => vector(20.0).prop_map(Some), 1 => Just(None)];
    let beam = [-0.5f32..0.5, -0.5f32..0.5, 0.5f32..1.0].prop_map(Vec3::from);
    let hit_age = prop_oneof![3 => Just(0.02f32), 1 => number()];
    let range_hit = (point, vector(20.0), beam, any::<u8>(), hit_age).prop_map(
        |(surface_point, lens, beam, count, age)| RangeHit {
            surface_point,
            lens,
            beam,
            count,
            age,
        },
    );
    let height_age = prop_oneof![Just(0.02f32), 0.0f32..10.0];
    let age = (age, height_age, any::<bool>());
    let raised = prop_oneof![3 => (-20.0f32..20.0).prop_map(Some), 1 => Just(None)];
    let levels = (-20.0f32..20.0, raised).prop_map(|(ground, raised)| SurfaceLevels { ground, raised });
    let some = (
        vector(20.0),
        vector(5.0),
        vector(8.0),
        number(),
        age,
        reset_count,
        (range_hit, levels),
    )
        .prop_map(
            |(
                position,
                velocity,
                disturbance,
                yaw_offset,
                (age, height_age, by_pressure),
                reset_count,
                (range_hit, levels),
            )| {
                Some(Estimate {
                    position,
                    velocity,
                    disturbance,
                    yaw_offset,
                    age,
                    height_age,
                    levels,
                    by_pressure,
                    reset_count,
                    range_hit,
                })
            },
        );
    prop_oneof![2 => some, 1 => Just(None)]
}

fn order() -> impl Strategy<Value = Option<RemoteOrder>> {
    use RemoteOrder::{Arm, Disarm, Grab, Kill, Release};
    let some =
        prop_oneof![4 => Just(Arm), 1 => Just(Disarm), 1 => Just(Kill), 4 => Just(Grab), 4 => Just(Release)];
    prop_oneof![1 => some.prop_map(Some), 1 => Just(None)]
}

/// Conditions for a while: (steps, sticks, grip, roll, carried, battery, motion known, order given once, position).
type Spell = (
    u32,
    Option<Sticks>,
    Option<GripState>,
    f32,
    bool,
    Option<f32>,
    bool,
    Option<RemoteOrder>,
    Option<Estimate>,
);

fn spells() -> impl Strategy<Value = Vec<Spell>> {
    let roll = prop_oneof![9 => -0.3f32..0.3, 1 => -3.1f32..3.1, 1 => Just(f32::NAN)];
    let battery = prop_oneof![8 => Just(Some(16.0f32)), 1 => Just(Some(12.0)), 1 => Just(None)];
    let spell = (
        1u32..250,
        sticks(),
        grip(),
        roll,
        any::<bool>(),
        battery,
        prop::bool::weighted(0.95),
        order(),
        position(),
    );
    prop::collection::vec(spell, 1..40)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..Default::default() })]
    #[test]
    fn whatever_happens(spells in spells(), start in 0u8..7) {
        let mut r = match start {
            0 => Rig::new(),
            1 => Rig::armed(),
            2 => Rig::flying(),
            3 => Rig::perched(),
            _ => {
                let mut r = Rig::new();
                let grasps = [GripMemory::Controlled(ArmChoice::All), GripMemory::HeldByGears(ArmChoice::Front), GripMemory::Open];
                let grip_memory = grasps.into_iter().nth(usize::from(start) - 4).unwrap_or_default();
                r.restart(grip_memory);
                r
            }
        };
        // The perch switch by an order that was obeyed.
        let mut let_go = false;
        for (number, (steps, sticks, grip, roll, carried, battery, there, order, position)) in (1..).zip(spells) {
            r.inputs.remote = order.map(|order| RemoteRequest { number, order });
            r.inputs.sticks = sticks;
            r.inputs.grip = grip;
            r.inputs.battery = battery;
            r.carried = carried;
            r.inputs.position = position;
            let q = Quat::from_euler(roll, 0.0, 0.0);
            r.inputs.motion = there.then_some(Motion { q, calibrated: true, ..Default::default() });
            for _ in 0..steps {
                let (before, grip_memory, answered) = (r.out.mode, r.out.grip_memory, r.out.remote.number);
                r.step();
                if r.out.remote.number != answered && r.out.remote.refusal.is_none() {
                    let_go = match order {
                        Some(RemoteOrder::Release) => true,
                        Some(RemoteOrder::Grab) => false,
                        _ => let_go,
                    };
                    prop_assert!(order != Some(RemoteOrder::Kill) || !r.out.rotors.spin());
                }
                let Outputs { mode, rotors, tendons, reason, .. } = r.out;
                let still = mode.rotors_stand();
                prop_assert!(!(still && rotors.spin()), "{mode:?} {rotors:?}");
                prop_assert!(mode != Mode::Perched || tendons != ClampCommand::Release);
                prop_assert!(mode != Mode::Clamping || tendons != ClampCommand::Release);
                prop_assert!(rotors != Setpoint::Stop || still || mode == Mode::Clamping, "{before:?} -> {mode:?}");
                prop_assert!(rotors.numbers().iter().all(|n| n.is_finite()), "{rotors:?}");
                prop_assert!((0.0..=4.0 * r.params.thrust_max * r.out.thrust_factor.value).contains(&rotors.thrust()));
                prop_assert!(sticks.is_none_or(|s| s.arm_switch) || !rotors.spin());
                prop_assert!(reason.is_none_or(|r| r.text().len() <= 40));
                // Arms open only by the switch, turned off, or with carrying rotors.
                if grip_memory.arms().is_some() && tendons == ClampCommand::Release {
                    prop_assert!([Mode::Releasing, Mode::Escaping].contains(&mode) || before == Mode::Escaping || let_go || sticks.is_some_and(|s| !s.perch_switch)
                        || r.inputs.grip.is_some_and(|g| g.released), "{before:?} -> {mode:?}");
                }
                // Rotors start from rest only when the pilot asks in that step.
                if [Mode::Disarmed, Mode::Perched].contains(&before) && rotors.spin() {
                    prop_assert!(sticks.is_some_and(|s| s.arm_switch));
                    // A grip that has slipped is left without a slow spool-up, on the same wish.
                    let wishes = sticks.is_some_and(|s| (let_go || !s.perch_switch) && s.throttle >= RELEASE_THROTTLE_MIN);
                    let leaves = mode == Mode::Releasing || before == Mode::Perched && mode == Mode::Escaping && wishes;
                    prop_assert!(mode == Mode::Armed || leaves, "{before:?} -> {mode:?}");
                    let free = r.inputs.grip.is_some_and(|g| g.released);
                    prop_assert!(leaves || free, "started while arms were not free");
                }
            }
        }
    }
}
