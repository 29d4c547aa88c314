//! Orders of a remote link: they do what the pilot's gesture or switch would, where it would, and never against him.

use super::rig::{DT, Rig};
use crate::arming::{ArmingInhibit, GESTURE_TIME};
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::mode::inputs::remote::GRAB_WAIT;
use crate::mode::*;
use crate::pilot::actuator_test::{
    ActuatorTest, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState, SPIN_DRIVE, Spin,
};
use crate::pilot::rc::ArmChoice;
use crate::pilot::remote::RemoteOrder::{self, Arm, Disarm, Grab, Kill, Release};
use crate::pilot::remote::{RemoteRefusal, RemoteRequest};

impl Rig {
    /// Gives `order` under a new number, renewed for some steps; what it was answered with after the first.
    pub fn remote(&mut self, order: RemoteOrder) -> Option<RemoteRefusal> {
        let number = self.out.remote.number + 1;
        self.inputs.remote = Some(RemoteRequest { number, order });
        self.step();
        assert_eq!(self.out.remote.number, number);
        let refusal = self.out.remote.refusal;
        for _ in 0..3 {
            self.step();
        }
        assert_eq!(
            (self.out.remote.number, self.out.remote.refusal),
            (number, refusal)
        );
        self.inputs.remote = None;
        refusal
    }

    /// The pilot's perch switch is off.
    fn perched_by_order() -> Self {
        let mut r = Self::flying();
        r.sticks().throttle = 0.3;
        assert_eq!((r.remote(Grab), r.out.mode), (None, Mode::Flight));
        r.expect(0.5, Mode::Flight);
        r.carried = true;
        r.expect(0.17, Mode::Contact);
        r.grip(false, false, ArmState::Closing, 0.0);
        r.expect(3.5, Mode::Clamping);
        r.grip(true, false, ArmState::Holding, 950.0);
        r.expect(4.0, Mode::Perched);
        r
    }

    fn disarmed() -> Self {
        let mut r = Self::new();
        r.inputs.motion = Some(Motion {
            calibrated: true,
            ..Default::default()
        });
        r.expect(1.0, Mode::Disarmed);
        r
    }
}

#[test]
fn arming_takes_the_switch_and_every_check_and_no_stick() {
    let mut r = Rig::disarmed();
    assert_eq!(r.remote(Arm), Some(RemoteRefusal::ArmSwitchOff));
    r.expect(1.0, Mode::Disarmed);
    r.sticks().arm_switch = true;
    r.sticks().throttle = 0.2;
    assert_eq!(r.remote(Arm), Some(RemoteRefusal::Checks));
    assert!(r.out.inhibits.iter().eq([ArmingInhibit::ThrottleNotLow]));
    r.sticks().throttle = 0.0;
    let sticks = r.inputs.sticks.take();
    assert_eq!(r.remote(Arm), Some(RemoteRefusal::Checks), "no radio");
    assert!(r.out.inhibits.contains(ArmingInhibit::RcLost));
    r.inputs.sticks = sticks;
    assert_eq!(r.out.mode, Mode::Disarmed);
    assert_eq!(r.remote(Arm), None);
    assert_eq!((r.out.mode, r.out.rotors), (Mode::Armed, Setpoint::Idle));
    // Once more changes nothing.
    assert_eq!((r.remote(Arm), r.out.mode), (None, Mode::Armed));
    // The pilot's switch stops it as ever.
    r.sticks().arm_switch = false;
    r.expect(DT, Mode::Disarmed);
}

#[test]
fn it_is_not_armed_before_calibration_has_ended() {
    let mut r = Rig::new();
    r.sticks().arm_switch = false;
    r.expect(0.1, Mode::Calibrating);
    r.sticks().arm_switch = true;
    assert_eq!(r.remote(Arm), Some(RemoteRefusal::Checks));
    assert_eq!(r.out.mode, Mode::Calibrating);
}

#[test]
fn an_order_is_obeyed_once_and_an_old_one_never() {
    let mut r = Rig::disarmed();
    r.sticks().arm_switch = true;
    r.inputs.remote = Some(RemoteRequest {
        number: 7,
        order: Arm,
    });
    r.expect(DT, Mode::Armed);
    // Still renewed when the pilot disarms.
    r.sticks().yaw = -1.0;
    r.expect(GESTURE_TIME + 0.1, Mode::Disarmed);
    r.sticks().yaw = 0.0;
    r.expect(1.0, Mode::Disarmed);
    for number in [6, 7, 0] {
        r.inputs.remote = Some(RemoteRequest { number, order: Arm });
        r.expect(0.1, Mode::Disarmed);
    }
}

#[test]
fn disarming_is_for_the_ground_and_forced_is_the_switch() {
    let mut r = Rig::armed();
    assert_eq!((r.remote(Disarm), r.out.mode), (None, Mode::Disarmed));
    // On the ground nothing happens twice.
    assert_eq!((r.remote(Disarm), r.out.mode), (None, Mode::Disarmed));
    for mut r in [Rig::flying(), Rig::touched(), Rig::clamping(), Rig::releasing()] {
        let before = r.out.mode;
        assert_eq!(r.remote(Disarm), Some(RemoteRefusal::Flying), "{before:?}");
        assert_ne!(r.out.mode, Mode::Disarmed);
        assert_eq!((r.remote(Kill), r.out.rotors.spin()), (None, false), "{before:?}");
        assert!(r.out.mode.rotors_stand());
        // Not for a moment: it stays so though the pilot's switch is on.
        r.run(2.0);
        assert!(r.out.mode.rotors_stand() && !r.out.rotors.spin(), "{before:?}");
    }
    // Without a radio as well.
    let mut r = Rig::flying();
    r.inputs.sticks = None;
    r.expect(0.5, Mode::Failsafe);
    assert_eq!((r.remote(Kill), r.out.mode), (None, Mode::Disarmed));
}

#[test]
fn a_kill_on_the_pipe_keeps_the_arms_closed() {
    let mut r = Rig::clamping();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.expect(0.1, Mode::Clamping);
    assert_eq!((r.remote(Kill), r.out.mode), (None, Mode::Perched));
    r.expect(2.0, Mode::Perched);
    // From there the gesture takes the arm switch, and force does not.
    assert_eq!(r.remote(Disarm), Some(RemoteRefusal::ArmSwitchOn));
    r.expect(0.1, Mode::Perched);
    assert_eq!((r.remote(Kill), r.out.mode), (None, Mode::Disarmed));
    assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    r.expect(2.0, Mode::Disarmed);
    assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    let mut r = Rig::perched();
    r.sticks().arm_switch = false;
    r.run(0.1);
    assert_eq!((r.remote(Disarm), r.out.mode), (None, Mode::Disarmed));
}

#[test]
fn disarming_ends_an_actuator_test() {
    for order in [Disarm, Kill] {
        let mut r = Rig::disarmed();
        let spin = ActuatorTest::Spin(Spin::at(0, SPIN_DRIVE));
        for (number, order) in (1..).zip([ActuatorTest::PropellersOff, spin]) {
            r.inputs.actuator_test = Some(ActuatorTestRequest { number, order });
            r.step();
        }
        assert_eq!(r.out.actuator_test.state, ActuatorTestState::Running);
        assert_eq!(r.remote(order), None);
        assert_eq!(
            r.out.actuator_test.state,
            ActuatorTestState::Ended(ActuatorTestRefusal::Disarm)
        );
        assert_eq!(r.out.rotors, Setpoint::Stop);
    }
}

#[test]
fn a_grab_closes_at_the_touch_and_holds_with_the_pilots_switch_off() {
    let mut r = Rig::perched_by_order();
    // His switch is off all the time, and his radio may come and go.
    assert!(!r.sticks().perch_switch);
    let sticks = r.inputs.sticks.take();
    r.expect(2.0, Mode::Perched);
    r.inputs.sticks = sticks;
    r.expect(GRAB_WAIT + 1.0, Mode::Perched);
    // He takes over with a turn of it: on is no change, off lets go.
    r.sticks().perch_switch = true;
    r.expect(0.5, Mode::Perched);
    r.sticks().perch_switch = false;
    r.expect(0.1, Mode::Releasing);
}

#[test]
fn a_remote_release_has_the_switchs_conditions_and_does_not_outlast_its_refusal() {
    let mut r = Rig::perched();
    assert_eq!(r.remote(Release), Some(RemoteRefusal::Throttle));
    r.sticks().throttle = 0.3;
    r.expect(1.0, Mode::Perched);
    r.sticks().arm_switch = false;
    assert_eq!(r.remote(Release), Some(RemoteRefusal::ArmSwitchOff));
    r.sticks().arm_switch = true;
    r.inputs.hardware = r.inputs.hardware.with(ArmingInhibit::ImuLineSilent);
    assert_eq!(r.remote(Release), Some(RemoteRefusal::MustStay));
    r.inputs.hardware = Default::default();
    r.expect(1.0, Mode::Perched);
    let sticks = r.inputs.sticks.take();
    assert_eq!(r.remote(Release), Some(RemoteRefusal::RadioLost));
    r.inputs.sticks = sticks;
    r.expect(0.5, Mode::Perched);
    assert_eq!(r.remote(Release), None);
    assert_eq!(r.out.mode, Mode::Releasing);
    // Called back by the same link, and let go again.
    assert_eq!(r.remote(Grab), None);
    assert_eq!(r.out.mode, Mode::Clamping);
}

#[test]
fn after_a_release_the_pilots_switch_that_stayed_on_is_no_wish() {
    let mut r = Rig::perched();
    r.sticks().throttle = 0.3;
    assert_eq!(r.remote(Release), None);
    r.expect(1.0, Mode::Releasing);
    r.grip(false, true, ArmState::Free, 0.0);
    r.expect(1.0, Mode::Flight);
    r.carried = false;
    r.sticks().throttle = 0.5;
    r.expect(1.0, Mode::Flight);
    // Down on the ground, up, and down again: his switch is on and was not turned.
    r.sticks().throttle = 0.0;
    r.carried = true;
    r.expect(1.0, Mode::Landed);
    r.sticks().throttle = 0.5;
    r.carried = false;
    r.expect(1.0, Mode::Flight);
    r.sticks().throttle = 0.3;
    r.carried = true;
    r.expect(1.0, Mode::Flight);
    assert_eq!(r.out.reason, Some(Reason::PerchSwitchNotOff));
    assert_eq!(r.remote(Grab), Some(RemoteRefusal::SwitchNotOff));
}

#[test]
fn a_grab_waits_half_a_minute_for_the_touch() {
    let mut r = Rig::flying();
    assert_eq!(r.remote(Grab), None);
    r.expect(GRAB_WAIT + 0.1, Mode::Flight);
    r.sticks().throttle = 0.3;
    r.carried = true;
    r.run(0.5);
    assert_ne!(r.out.mode, Mode::Contact);
    // A release before takes it back too, and so does the pilot by moving his.
    for back in 0..2 {
        let mut r = Rig::flying();
        assert_eq!(r.remote(Grab), None);
        if back == 0 {
            assert_eq!(r.remote(Release), None);
        } else {
            r.sticks().perch_switch = true;
            r.step();
            r.sticks().perch_switch = false;
            r.step();
        }
        r.sticks().throttle = 0.3;
        r.carried = true;
        r.run(0.5);
        assert_ne!(r.out.mode, Mode::Contact);
    }
}

#[test]
fn elsewhere_the_gripper_stays() {
    for order in [Grab, Release] {
        let mut r = Rig::new();
        r.expect(0.2, Mode::Calibrating);
        assert_eq!(r.remote(order), Some(RemoteRefusal::NotHere));
        let mut r = Rig::disarmed();
        assert_eq!(r.remote(order), Some(RemoteRefusal::NotHere));
        assert_eq!(r.out.tendons, ClampCommand::Release);
        // Nothing is left of it at the next arming.
        assert!(!r.out.inhibits.contains(ArmingInhibit::PerchSwitchOn));
        let mut r = Rig::armed();
        assert_eq!(r.remote(order), Some(RemoteRefusal::NotHere));
        let mut r = Rig::flying();
        r.inputs.sticks = None;
        r.expect(0.5, Mode::Failsafe);
        assert_eq!(r.remote(order), Some(RemoteRefusal::RadioLost));
    }
}

#[test]
fn at_rest_closed_arms_open_by_a_grab_and_a_release_as_by_the_switch() {
    let mut r = Rig::perched_by_order();
    assert_eq!((r.remote(Kill), r.out.mode), (None, Mode::Disarmed));
    r.run(0.5);
    let closed = ClampCommand::Close { arms: ArmChoice::All };
    assert_eq!(r.out.tendons, closed);
    assert_eq!(r.remote(Release), Some(RemoteRefusal::SwitchNotOn));
    assert_eq!((r.remote(Grab), r.out.tendons), (None, closed));
    r.expect(1.0, Mode::Disarmed);
    assert_eq!(r.out.tendons, closed);
    assert_eq!((r.remote(Release), r.out.tendons), (None, ClampCommand::Release));
    assert_eq!(r.remote(Grab), Some(RemoteRefusal::NotHere));
}

#[test]
fn every_refusal_has_a_short_text_of_its_own() {
    for (i, a) in RemoteRefusal::ALL.into_iter().enumerate() {
        assert!(!a.text().is_empty() && a.text().len() <= 40, "{a:?}");
        assert!(
            RemoteRefusal::ALL
                .into_iter()
                .skip(i + 1)
                .all(|b| a.text() != b.text())
        );
    }
}
