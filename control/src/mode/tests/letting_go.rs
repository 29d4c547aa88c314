//! Arms that a person opens on a vehicle at rest: no rotor starts before all are proven free.

use super::rig::Rig;
use crate::arming::ArmingInhibit;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::*;
use crate::pilot::rc::ArmChoice;

#[test]
fn rotors_do_not_start_on_a_vehicle_that_is_letting_go() {
    // The switch opens the arms before, with or after the arming gesture.
    for (grip_memory, steps) in [
        GripMemory::Controlled(ArmChoice::All),
        GripMemory::HeldByGears(ArmChoice::All),
    ]
    .into_iter()
    .flat_map(|memory| (-20..=20).map(move |steps| (memory, steps)))
    {
        let mut r = Rig::restarted(grip_memory);
        r.calibrated();
        r.grip(true, false, ArmState::Holding, 950.0);
        r.sticks().arm_switch = false;
        r.run(0.3);
        r.sticks().perch_switch = false;
        r.run(0.3);
        r.sticks().perch_switch = true;
        r.sticks().arm_switch = true;
        r.run(0.3);
        r.sticks().yaw = 1.0;
        for step in 0..150 {
            // The hundredth step completes the gesture.
            r.sticks().perch_switch = step - 99 < steps;
            r.step();
            assert!(!r.out.rotors.spin(), "{grip_memory:?}, {steps}: step {step}");
        }
        if r.out.mode == Mode::Perched {
            // Armed on the pipe first.
            assert!(steps > 0, "{grip_memory:?}, {steps}");
            continue;
        }
        assert_eq!(
            (r.out.mode, r.out.tendons),
            (Mode::Disarmed, ClampCommand::Release)
        );
        assert_eq!(r.out.inhibits.first(), Some(ArmingInhibit::ArmsClosed));
        // Proven free: a new gesture arms.
        r.grip(false, true, ArmState::Free, 0.0);
        r.arm();
        assert_eq!(r.out.mode, Mode::Armed);
    }
}
