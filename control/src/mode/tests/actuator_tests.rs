//! Actuator tests: beginning, end, and that nothing turns or moves otherwise.

use proptest::prelude::*;

use super::rig::{DT, Rig};
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::*;
use crate::pilot::actuator_test::{
    ActuatorTest, ActuatorTestAnswer, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState, Place,
    SPIN_DRIVE, SPIN_DRIVE_MAX, SPIN_TIME, Spin,
};
use crate::pilot::rc::{ArmChoice, Sticks};

const SPIN: ActuatorTest = ActuatorTest::Spin(Spin::at(2, SPIN_DRIVE));
const PLACE: ActuatorTest = ActuatorTest::Place(Place {
    servo: 1,
    pulse_us: 1500.0,
});

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
        r.logic = ModeLogic::resume(&r.params, grip_memory);
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

fn order() -> impl Strategy<Value = ActuatorTest> {
    let spin =
        (0usize..5, -0.1f32..0.3).prop_map(|(rotor, drive)| ActuatorTest::Spin(Spin::at(rotor, drive)));
    let place = (0usize..5, 400.0f32..2600.0)
        .prop_map(|(servo, pulse_us)| ActuatorTest::Place(Place { servo, pulse_us }));
    let words = prop_oneof![1 => Just(ActuatorTest::End), 4 => Just(ActuatorTest::PropellersOff)];
    prop_oneof![1 => words, 2 => spin, 1 => place]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..Default::default() })]
    #[test]
    fn a_motor_turns_in_disarmed_alone_low_alone_and_for_two_seconds_at_most(
        spells in prop::collection::vec(
            (1u32..150, prop::option::weighted(0.8, order()), prop::bool::weighted(0.2),
             prop::bool::weighted(0.9), 0.0f32..0.3),
            1..40,
        )
    ) {
        let mut r = Rig::on_the_table();
        let (mut confirmed, mut turning, mut number) = (false, 0.0, 0);
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
            confirmed |= order == Some(ActuatorTest::PropellersOff);
            for i in 0..steps {
                r.step();
                let Setpoint::Spin(spin) = r.out.rotors else {
                    turning = 0.0;
                    continue;
                };
                turning = if i == 0 { DT } else { turning + DT };
                prop_assert!(confirmed && r.out.mode == Mode::Disarmed && !arm_switch && there);
                prop_assert!(spin.rotor < 4 && spin.drive > 0.0 && spin.drive <= SPIN_DRIVE_MAX);
                prop_assert!(order == Some(ActuatorTest::Spin(spin)), "{order:?}");
                prop_assert!(turning <= SPIN_TIME + DT, "{turning} s");
                prop_assert!(spin.commands(0.07).iter().filter(|c| **c > 0.0).count() == 1);
            }
        }
    }
}
