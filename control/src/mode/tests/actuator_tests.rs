//! Actuator tests: beginning, end, and that nothing turns or moves otherwise.

use proptest::prelude::*;

use super::rig::{DT, Rig};
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::deg;
use crate::maths::vector::Quat;
use crate::mode::inputs::actuator_tests::TURN_MAX;
use crate::mode::*;
use crate::pilot::actuator_test::{
    ActuatorTest, ActuatorTestAnswer, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState, Place,
    SPIN_DRIVE, SPIN_DRIVE_MAX, SPIN_TIME, Spin,
};
use crate::pilot::rc::{ArmChoice, Sticks};
use crate::pilot::static_thrust_test::{PLATEAU, RAMP, Rotors, StaticThrustTest};

const SPIN: ActuatorTest = ActuatorTest::Spin(Spin::at(2, SPIN_DRIVE));
const PLACE: ActuatorTest = ActuatorTest::Place(Place {
    servo: 1,
    pulse_us: 1500.0,
});

/// All four rotors at full drive.
const FULL: ActuatorTest = ActuatorTest::StaticThrust(StaticThrustTest::steady(Rotors::All, 1.0));

impl Rig {
    fn on_the_table() -> Self {
        let mut r = Self::new();
        r.inputs.motion = Some(Motion {
            calibrated: true,
            ..Default::default()
        });
        r.expect(1.0, Mode::Disarmed);
        assert_eq!(r.out.grip_memory, GripMemory::Open);
        r
    }

    fn without_propellers() -> Self {
        let mut r = Self::on_the_table();
        assert_eq!(r.order(ActuatorTest::PropellersOff), ActuatorTestState::Done);
        r
    }

    fn tied_down() -> Self {
        let mut r = Self::on_the_table();
        assert_eq!(r.order(ActuatorTest::TiedDown), ActuatorTestState::Done);
        r
    }

    /// Drive of the rotors in a static thrust test; 0 when they stand.
    fn drive(&self) -> f32 {
        match self.out.rotors {
            Setpoint::StaticThrust(test) => test.drive,
            Setpoint::Stop => 0.0,
            other => panic!("{other:?}"),
        }
    }

    fn turned_by(&mut self, q: Quat) {
        if let Some(motion) = &mut self.inputs.motion {
            motion.q = q;
        }
    }

    /// Gives `order` under a new number; returns the answer after a step.
    fn order(&mut self, order: ActuatorTest) -> ActuatorTestState {
        let number = self.out.actuator_test.number + 1;
        self.inputs.actuator_test = Some(ActuatorTestRequest { number, order });
        self.step();
        assert_eq!(self.out.actuator_test.number, number);
        self.out.actuator_test.state
    }
}

#[test]
fn a_motor_turns_for_two_seconds_and_no_longer_however_often_it_is_renewed() {
    let mut r = Rig::without_propellers();
    assert_eq!(r.order(SPIN), ActuatorTestState::Running);
    let mut turned = 0;
    for _ in 0..1000 {
        match r.out.rotors {
            Setpoint::Spin(spin) => {
                assert_eq!(
                    (spin.rotor, r.out.actuator_test.state),
                    (2, ActuatorTestState::Running)
                );
                assert_eq!(r.out.reason, Some(Reason::ActuatorTest));
                turned += 1;
            }
            Setpoint::Stop => assert_eq!(r.out.actuator_test.state, ActuatorTestState::Done),
            other => panic!("{other:?}"),
        }
        assert_eq!(r.out.tendons, ClampCommand::Release);
        r.step();
    }
    let expected = (SPIN_TIME / DT + 0.5) as i32;
    assert!((turned - expected).abs() <= 1, "{turned} steps");
    assert_eq!(r.order(SPIN), ActuatorTestState::Running);
}

#[test]
fn whatever_speaks_against_it_refuses_an_order_and_ends_one_that_lasts() {
    type Trouble = fn(&mut Rig);
    let spoils: [(ActuatorTestRefusal, Trouble); 3] = [
        (ActuatorTestRefusal::ArmSwitchOn, |r| r.sticks().arm_switch = true),
        (ActuatorTestRefusal::Storing, |r| {
            r.inputs.hardware = r.inputs.hardware.with(ArmingInhibit::Storing);
        }),
        (ActuatorTestRefusal::ImuSilent, |r| r.inputs.motion = None),
    ];
    for (why, spoil) in spoils {
        for order in [SPIN, PLACE] {
            // A servo needs no motion estimate.
            if (why, order) == (ActuatorTestRefusal::ImuSilent, PLACE) {
                continue;
            }
            let mut r = Rig::without_propellers();
            spoil(&mut r);
            assert_eq!(r.order(order), ActuatorTestState::Refused(why));
            let mut r = Rig::without_propellers();
            assert_eq!(r.order(order), ActuatorTestState::Running);
            r.run(0.5);
            spoil(&mut r);
            r.step();
            assert_eq!(
                r.out.actuator_test.state,
                ActuatorTestState::Ended(why),
                "{order:?}"
            );
            assert_eq!(
                (r.out.rotors, r.out.tendons),
                (Setpoint::Stop, ClampCommand::Release)
            );
            // The order does not resume by itself.
            r.sticks().arm_switch = false;
            r.inputs.hardware = ArmingInhibits::NONE;
            r.run(0.5);
            assert_eq!(
                (r.out.rotors, r.out.tendons),
                (Setpoint::Stop, ClampCommand::Release)
            );
        }
    }
}

#[test]
fn propellers_are_confirmed_since_power_up_and_since_the_last_arming() {
    let mut r = Rig::on_the_table();
    assert_eq!(
        r.order(SPIN),
        ActuatorTestState::Refused(ActuatorTestRefusal::PropellersOn)
    );
    // A servo needs no answer about propellers.
    assert_eq!(r.order(PLACE), ActuatorTestState::Running);
    assert_eq!(r.order(ActuatorTest::PropellersOff), ActuatorTestState::Done);
    assert_eq!(
        r.out.tendons,
        ClampCommand::Release,
        "a new order ends the one before"
    );
    assert_eq!(r.order(SPIN), ActuatorTestState::Running);
    r.order(ActuatorTest::End);
    *r.sticks() = Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Default::default()
    };
    r.expect(1.1, Mode::Armed);
    r.sticks().arm_switch = false;
    r.expect(0.1, Mode::Disarmed);
    assert_eq!(
        r.order(SPIN),
        ActuatorTestState::Refused(ActuatorTestRefusal::PropellersOn)
    );
}

#[test]
fn orders_are_for_disarmed_alone_and_not_for_arms_that_hold_or_may() {
    for mut r in [Rig::armed(), Rig::flying(), Rig::perched(), Rig::new()] {
        for order in [ActuatorTest::PropellersOff, SPIN, PLACE] {
            let before = r.out.mode;
            let refused = ActuatorTestState::Refused(ActuatorTestRefusal::NotDisarmed);
            assert_eq!(r.order(order), refused, "{before:?}");
            assert_eq!(r.out.mode, before);
        }
    }
    for (grip_memory, why) in [
        (
            GripMemory::Controlled(ArmChoice::All),
            ActuatorTestRefusal::ArmsClosed,
        ),
        (
            GripMemory::HeldByGears(ArmChoice::Front),
            ActuatorTestRefusal::ArmsClosed,
        ),
        (GripMemory::Unknown, ActuatorTestRefusal::GripUnknown),
    ] {
        let mut r = Rig::on_the_table();
        r.restart(grip_memory);
        r.inputs.grip = None;
        r.expect(0.5, Mode::Disarmed);
        assert_eq!(r.order(ActuatorTest::PropellersOff), ActuatorTestState::Done);
        for order in [SPIN, PLACE] {
            assert_eq!(r.order(order), ActuatorTestState::Refused(why));
            assert_eq!(r.out.tendons, grip_memory.tendons());
        }
    }
}

#[test]
fn silence_of_the_console_ends_an_order_for_good() {
    for order in [SPIN, PLACE] {
        let mut r = Rig::without_propellers();
        r.order(order);
        let request = r.inputs.actuator_test.take();
        r.step();
        assert_eq!(
            r.out.actuator_test.state,
            ActuatorTestState::Ended(ActuatorTestRefusal::NotRenewed)
        );
        assert_eq!(
            (r.out.rotors, r.out.tendons),
            (Setpoint::Stop, ClampCommand::Release)
        );
        r.inputs.actuator_test = request;
        r.run(0.5);
        assert_eq!(
            (r.out.rotors, r.out.tendons),
            (Setpoint::Stop, ClampCommand::Release)
        );
    }
}

#[test]
fn numbers_beyond_the_limits_never_begin() {
    let mut r = Rig::without_propellers();
    for (rotor, drive) in [(4, 0.08), (0, 0.121), (0, 0.0), (0, -0.08), (0, f32::NAN)] {
        let order = ActuatorTest::Spin(Spin::at(rotor, drive));
        assert_eq!(
            r.order(order),
            ActuatorTestState::Refused(ActuatorTestRefusal::OutOfRange),
            "{order:?}"
        );
    }
    for (servo, pulse_us) in [(4, 1500.0), (0, 499.0), (0, 2501.0), (0, f32::INFINITY)] {
        let order = ActuatorTest::Place(Place { servo, pulse_us });
        assert_eq!(
            r.order(order),
            ActuatorTestState::Refused(ActuatorTestRefusal::OutOfRange),
            "{order:?}"
        );
    }
    assert_eq!(
        Rig::on_the_table().out.actuator_test,
        ActuatorTestAnswer::default()
    );
}

#[test]
fn a_static_thrust_test_rises_to_its_drive_holds_it_and_ends() {
    let mut r = Rig::tied_down();
    assert_eq!(r.order(FULL), ActuatorTestState::Running);
    let mut before = r.drive();
    assert!(before < 1e-6, "it begins at rest: {before}");
    let mut held = 0;
    while r.out.actuator_test.state == ActuatorTestState::Running {
        r.step();
        let now = r.drive();
        assert!(now - before <= RAMP * DT + 1e-6, "{before} {now}");
        held += u32::from(now > 0.999);
        before = now;
        assert_eq!(r.out.tendons, ClampCommand::Release);
    }
    assert_eq!(
        (r.out.actuator_test.state, r.out.rotors),
        (ActuatorTestState::Done, Setpoint::Stop)
    );
    assert!((held as f32 * DT - PLATEAU).abs() < 0.05, "{held} steps");
}

#[test]
fn a_train_ends_at_its_time_too() {
    let mut r = Rig::tied_down();
    let train = StaticThrustTest::train(Rotors::One(1), 0.3, 0.6);
    assert_eq!(
        r.order(ActuatorTest::StaticThrust(train)),
        ActuatorTestState::Running
    );
    let (mut steps, mut most) = (0, 0.0f32);
    while r.out.actuator_test.state == ActuatorTestState::Running && steps < 5000 {
        r.step();
        most = most.max(r.drive());
        steps += 1;
    }
    assert!(
        (steps as f32 * DT - train.longest()).abs() < 0.05,
        "{steps} steps"
    );
    assert!((most - 0.6).abs() < 1e-6, "{most}");
}

#[test]
fn propellers_on_and_off_are_confirmed_apart() {
    use ActuatorTestRefusal::{NotTiedDown, PropellersOn};
    let mut r = Rig::on_the_table();
    assert_eq!(r.order(FULL), ActuatorTestState::Refused(NotTiedDown));
    r = Rig::without_propellers();
    assert_eq!(r.order(FULL), ActuatorTestState::Refused(NotTiedDown));
    r = Rig::tied_down();
    assert_eq!(r.order(SPIN), ActuatorTestState::Refused(PropellersOn));
    assert_eq!(r.order(FULL), ActuatorTestState::Running);
    // The other confirmation ends the test and this one's.
    r.run(0.5);
    assert_eq!(r.order(ActuatorTest::PropellersOff), ActuatorTestState::Done);
    assert_eq!(r.out.rotors, Setpoint::Stop);
    assert_eq!(r.order(FULL), ActuatorTestState::Refused(NotTiedDown));
    // Arming forgets it.
    r = Rig::tied_down();
    *r.sticks() = Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Default::default()
    };
    r.expect(1.1, Mode::Armed);
    r.sticks().arm_switch = false;
    r.expect(0.1, Mode::Disarmed);
    assert_eq!(r.order(FULL), ActuatorTestState::Refused(NotTiedDown));
}

#[test]
fn whatever_speaks_against_it_refuses_a_static_thrust_test_and_ends_one_that_lasts() {
    use ActuatorTestRefusal::{ArmSwitchOn, BatteryCritical, ImuSilent, Storing};
    type Trouble = fn(&mut Rig);
    let spoils: [(ActuatorTestRefusal, Trouble); 5] = [
        (ArmSwitchOn, |r| {
            *r.sticks() = Sticks {
                arm_switch: true,
                yaw: 1.0,
                ..Default::default()
            };
        }),
        (Storing, |r| {
            r.inputs.hardware = r.inputs.hardware.with(ArmingInhibit::Storing);
        }),
        (ImuSilent, |r| r.inputs.motion = None),
        (BatteryCritical, |r| r.inputs.battery = None),
        (BatteryCritical, |r| {
            r.inputs.battery = Some(r.params.battery_critical - 0.01);
        }),
    ];
    for (why, spoil) in spoils {
        let mut r = Rig::tied_down();
        spoil(&mut r);
        assert_eq!(r.order(FULL), ActuatorTestState::Refused(why));
        let mut r = Rig::tied_down();
        assert_eq!(r.order(FULL), ActuatorTestState::Running);
        r.run(1.0);
        assert!(r.drive() > 0.4);
        let good = r.inputs;
        spoil(&mut r);
        r.step();
        assert_eq!(
            (r.out.actuator_test.state, r.out.rotors, r.out.mode),
            (ActuatorTestState::Ended(why), Setpoint::Stop, Mode::Disarmed)
        );
        r.inputs = good;
        r.run(0.5);
        assert_eq!(r.out.rotors, Setpoint::Stop, "{why:?}: it does not resume");
    }
}

#[test]
fn a_vehicle_that_turns_is_stopped_and_has_to_be_confirmed_again() {
    let over = TURN_MAX + deg(1.0);
    let under = TURN_MAX - deg(1.0);
    // Upright, on its back and on its side: the turn counts from the attitude at the start.
    for from in [
        Quat::default(),
        Quat::from_euler(3.1, 0.0, 1.0),
        Quat::from_euler(0.0, 1.4, -2.0),
    ] {
        for (roll, pitch, yaw) in [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)] {
            let turn = |by: f32| from * Quat::from_euler(roll * by, pitch * by, yaw * by);
            let mut r = Rig::tied_down();
            r.turned_by(from);
            assert_eq!(r.order(FULL), ActuatorTestState::Running);
            r.run(1.0);
            r.turned_by(turn(under));
            r.step();
            assert_eq!(r.out.actuator_test.state, ActuatorTestState::Running);
            r.turned_by(turn(over));
            r.step();
            let ended = ActuatorTestState::Ended(ActuatorTestRefusal::Turned);
            assert_eq!((r.out.actuator_test.state, r.out.rotors), (ended, Setpoint::Stop));
            let refused = ActuatorTestState::Refused(ActuatorTestRefusal::NotTiedDown);
            assert_eq!(r.order(FULL), refused);
        }
    }
}

#[test]
fn a_static_thrust_test_needs_its_sender_and_disarmed() {
    let mut r = Rig::tied_down();
    r.order(FULL);
    r.run(1.0);
    r.inputs.actuator_test = None;
    r.step();
    assert_eq!(
        (r.out.actuator_test.state, r.out.rotors),
        (
            ActuatorTestState::Ended(ActuatorTestRefusal::NotRenewed),
            Setpoint::Stop
        )
    );
    for mut r in [Rig::armed(), Rig::flying(), Rig::perched(), Rig::new()] {
        for order in [ActuatorTest::TiedDown, FULL] {
            let before = r.out.mode;
            let refused = ActuatorTestState::Refused(ActuatorTestRefusal::NotDisarmed);
            assert_eq!(r.order(order), refused, "{before:?}");
            assert_eq!(r.out.mode, before);
        }
    }
    let mut r = Rig::on_the_table();
    r.restart(GripMemory::Controlled(ArmChoice::All));
    r.inputs.grip = None;
    r.expect(0.5, Mode::Disarmed);
    assert_eq!(r.order(ActuatorTest::TiedDown), ActuatorTestState::Done);
    let refused = ActuatorTestState::Refused(ActuatorTestRefusal::ArmsClosed);
    assert_eq!(r.order(FULL), refused);
}

fn order() -> impl Strategy<Value = ActuatorTest> {
    let spin =
        (0usize..5, -0.1f32..0.3).prop_map(|(rotor, drive)| ActuatorTest::Spin(Spin::at(rotor, drive)));
    let place = (0usize..5, 400.0f32..2600.0)
        .prop_map(|(servo, pulse_us)| ActuatorTest::Place(Place { servo, pulse_us }));
    let tied = (
        0usize..6,
        -0.1f32..1.2,
        prop::option::weighted(0.3, 0.0f32..1.2),
        0.0f32..12.0,
    )
        .prop_map(|(rotor, drive, step_to, plateau)| {
            let rotors = if rotor == 5 {
                Rotors::All
            } else {
                Rotors::One(rotor)
            };
            ActuatorTest::StaticThrust(StaticThrustTest {
                rotors,
                drive,
                step_to,
                plateau,
            })
        });
    let words = prop_oneof![
        1 => Just(ActuatorTest::End),
        4 => Just(ActuatorTest::PropellersOff),
        2 => Just(ActuatorTest::TiedDown),
    ];
    prop_oneof![2 => words, 3 => spin, 1 => place, 2 => tied]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..Default::default() })]
    #[test]
    fn motors_turn_in_disarmed_alone_as_confirmed_and_without_ties_low_and_for_two_seconds_at_most(
        spells in prop::collection::vec(
            (1u32..150, prop::option::weighted(0.8, order()), prop::bool::weighted(0.2),
             prop::bool::weighted(0.9), 0.0f32..0.3),
            1..40,
        )
    ) {
        let mut r = Rig::on_the_table();
        let (mut off, mut tied, mut turning, mut number) = (false, false, 0.0, 0);
        for (steps, order, arm_switch, there, throttle) in spells {
            *r.sticks() = Sticks {
                arm_switch,
                yaw: f32::from(u8::from(arm_switch)),
                throttle: if throttle < 0.1 { 0.0 } else { throttle },
                ..Default::default()
            };
            r.inputs.motion = there.then_some(Motion { calibrated: true, ..Default::default() });
            number += 1;
            r.inputs.actuator_test = order.map(|order| ActuatorTestRequest { number, order });
            off |= order == Some(ActuatorTest::PropellersOff);
            tied |= order == Some(ActuatorTest::TiedDown);
            for i in 0..steps {
                r.step();
                if let (Setpoint::StaticThrust(thrust), Some(ActuatorTest::StaticThrust(test))) = (r.out.rotors, order) {
                    prop_assert!(tied && test.is_allowed() && r.out.mode == Mode::Disarmed && !arm_switch && there);
                    prop_assert!(thrust.drive <= test.drive.max(test.step_to.unwrap_or(0.0)));
                    continue;
                }
                let Setpoint::Spin(spin) = r.out.rotors else {
                    prop_assert!(r.out.rotors == Setpoint::Stop || r.out.mode != Mode::Disarmed);
                    turning = 0.0;
                    continue;
                };
                turning = if i == 0 { DT } else { turning + DT };
                prop_assert!(off && r.out.mode == Mode::Disarmed && !arm_switch && there);
                prop_assert!(spin.rotor < 4 && spin.drive > 0.0 && spin.drive <= SPIN_DRIVE_MAX);
                prop_assert!(order == Some(ActuatorTest::Spin(spin)), "{order:?}");
                prop_assert!(turning <= SPIN_TIME + DT, "{turning} s");
                prop_assert!(spin.commands(0.07).iter().filter(|c| **c > 0.0).count() == 1);
            }
        }
    }
}
