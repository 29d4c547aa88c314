//! Starts on and off the pipe: nothing opens by itself, nothing turns before arming.

use super::rig::Rig;
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::vector::Quat;
use crate::mode::shared::power_up_grip::AVERAGING_TIME;
use crate::mode::*;
use crate::pilot::rc::{ArmChoice, Sticks};

const ALL: ClampCommand = ClampCommand::Close { arms: ArmChoice::All };

impl Rig {
    /// Restarted with this grip, the switches as on the pipe.
    pub(super) fn restarted(grip_memory: GripMemory) -> Self {
        let mut r = Self::new();
        r.restart(grip_memory);
        *r.sticks() = Sticks {
            arm_switch: true,
            perch_switch: true,
            ..Sticks::default()
        };
        r
    }

    pub(super) fn calibrated(&mut self) {
        self.inputs.motion = Some(Motion {
            calibrated: true,
            ..Motion::default()
        });
    }

    /// Arms, with the perch switch unchanged.
    pub(super) fn arm(&mut self) {
        self.sticks().throttle = 0.0;
        self.sticks().arm_switch = false;
        self.run(0.3);
        self.sticks().arm_switch = true;
        self.sticks().yaw = 1.0;
        self.run(1.2);
        self.sticks().yaw = 0.0;
        self.run(0.1);
    }

    fn stays(&mut self, seconds: f32, tendons: ClampCommand) {
        for _ in 0..(seconds * 100.0) as u32 {
            self.step();
            assert_eq!((self.out.tendons, self.out.rotors), (tendons, Setpoint::Stop));
        }
    }

    fn found(pressure: f32) -> Self {
        let mut r = Self::restarted(GripMemory::Unknown);
        r.grip(false, false, ArmState::Free, pressure);
        r
    }
}

#[test]
fn a_restart_on_the_pipe_never_opens_and_flies_home_once_the_pilot_has_armed() {
    let mut r = Rig::restarted(GripMemory::Controlled(ArmChoice::All));
    r.grip(false, false, ArmState::Closing, 930.0);
    r.stays(0.5, ALL);
    assert_eq!(r.out.mode, Mode::Calibrating);
    r.calibrated();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.stays(30.0, ALL);
    assert_eq!(
        (r.out.mode, r.out.grip_memory),
        (Mode::Disarmed, GripMemory::Controlled(ArmChoice::All))
    );
    // A switch left on does not count.
    assert_eq!(r.out.inhibits.first(), Some(ArmingInhibit::SwitchOnAtPowerUp));
    r.sticks().yaw = 1.0;
    r.stays(3.0, ALL);
    assert_eq!(r.out.mode, Mode::Disarmed);
    r.sticks().yaw = 0.0;
    r.arm();
    assert_eq!((r.out.mode, r.out.rotors), (Mode::Perched, Setpoint::Stop));
    r.stays(5.0, ALL);
    r.sticks().throttle = 0.25;
    r.stays(1.0, ALL);
    r.sticks().perch_switch = false;
    r.expect(0.1, Mode::Releasing);
    r.run(2.0);
    assert_eq!(r.out.tendons, ClampCommand::Release);
    assert_eq!(
        r.out.grip_memory,
        GripMemory::Controlled(ArmChoice::All),
        "not free yet"
    );
    r.grip(false, true, ArmState::Free, 0.0);
    r.expect(1.0, Mode::Flight);
    assert_eq!(r.out.grip_memory, GripMemory::Open);
}

#[test]
fn the_perch_switch_that_was_left_on_opens_nothing_when_it_is_turned_off() {
    for grip_memory in [
        GripMemory::Controlled(ArmChoice::Front),
        GripMemory::HeldByGears(ArmChoice::All),
    ] {
        let mut r = Rig::restarted(grip_memory);
        r.grip(false, false, ArmState::Touching, 950.0);
        for calibrated in [false, true] {
            if calibrated {
                r.calibrated();
            }
            r.run(0.5);
            r.sticks().perch_switch = false;
            r.run(2.0);
            assert!(r.out.tendons != ClampCommand::Release && r.out.grip_memory == grip_memory);
            r.sticks().perch_switch = true;
            if !calibrated {
                // Off and on so far; the next off is a wish.
                r.restart(grip_memory);
            }
        }
        r.sticks().perch_switch = true;
        r.run(0.5);
        assert!(r.out.tendons != ClampCommand::Release);
        r.sticks().perch_switch = false;
        r.run(0.1);
        assert_eq!(
            (r.out.tendons, r.out.grip_memory),
            (ClampCommand::Release, GripMemory::Open),
            "on and off again"
        );
    }
}

#[test]
fn a_person_opens_a_vehicle_that_swings_too_much_to_be_calibrated() {
    let mut r = Rig::found(800.0);
    r.sticks().perch_switch = false;
    r.stays(5.0, ClampCommand::Keep);
    r.sticks().perch_switch = true;
    r.stays(1.0, ClampCommand::Keep);
    r.sticks().perch_switch = false;
    r.run(0.1);
    assert_eq!(
        (r.out.mode, r.out.tendons),
        (Mode::Calibrating, ClampCommand::Release)
    );
}

#[test]
fn arming_with_the_switch_off_takes_a_new_turn_of_it_to_release() {
    let mut r = Rig::restarted(GripMemory::Controlled(ArmChoice::All));
    r.calibrated();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.sticks().perch_switch = false;
    r.run(0.5);
    r.arm();
    assert_eq!(r.out.mode, Mode::Perched);
    r.sticks().throttle = 0.3;
    r.stays(2.0, ALL);
    assert_eq!(r.out.reason, Some(Reason::PerchSwitchNotOn));
    r.sticks().perch_switch = true;
    r.stays(0.5, ALL);
    r.sticks().perch_switch = false;
    r.expect(0.1, Mode::Releasing);
}

#[test]
fn a_grip_that_is_not_held_is_not_armed() {
    for (grip_memory, pressure, state) in [
        (GripMemory::Controlled(ArmChoice::All), 400.0, ArmState::Touching),
        (GripMemory::Controlled(ArmChoice::All), 950.0, ArmState::Faulty),
        (GripMemory::HeldByGears(ArmChoice::All), 60.0, ArmState::Free),
        (GripMemory::Unknown, 0.0, ArmState::Free),
    ] {
        let mut r = Rig::restarted(grip_memory);
        r.calibrated();
        r.grip(false, false, state, pressure);
        if grip_memory == GripMemory::Unknown {
            r.inputs.fsr_fault = [true; 4];
        }
        r.run(1.0);
        r.arm();
        assert_eq!(r.out.mode, Mode::Disarmed, "{grip_memory:?}");
        assert!(
            r.out.inhibits.contains(ArmingInhibit::ArmsClosed),
            "{grip_memory:?}"
        );
    }
}

#[test]
fn every_other_check_still_counts_on_the_pipe() {
    type Edit = fn(&mut Rig);
    let cases: [(Edit, ArmingInhibit); 6] = [
        (|r| r.inputs.battery = Some(13.0), ArmingInhibit::BatteryLow),
        (|r| r.inputs.late = true, ArmingInhibit::Overruns),
        (
            |r| r.inputs.fsr_fault = [false, true, false, false],
            ArmingInhibit::FsrFault,
        ),
        (
            |r| {
                r.inputs.motion = Some(Motion {
                    q: Quat::from_euler(0.5, 0.0, 0.0),
                    calibrated: true,
                    ..Motion::default()
                });
            },
            ArmingInhibit::TiltTooLarge,
        ),
        (
            |r| r.inputs.hardware = ArmingInhibits::NONE.with(ArmingInhibit::ImuSelfTest),
            ArmingInhibit::ImuSelfTest,
        ),
        (
            |r| {
                r.grip(true, false, ArmState::Holding, 950.0);
                if let Some(grip) = &mut r.inputs.grip {
                    grip.arms[1].pressure = 300.0;
                }
            },
            ArmingInhibit::ArmsClosed,
        ),
    ];
    for (edit, why) in cases {
        // The pilot's choice does not count.
        let mut r = Rig::restarted(GripMemory::Controlled(ArmChoice::Rear));
        r.sticks().arms = ArmChoice::Front;
        r.calibrated();
        r.grip(true, false, ArmState::Holding, 950.0);
        r.run(0.5);
        edit(&mut r);
        r.arm();
        assert_eq!(r.out.mode, Mode::Disarmed, "{why:?}");
        assert!(r.out.inhibits.contains(why), "{why:?}: {:?}", r.out.inhibits);
    }
}

#[test]
fn a_broken_supply_forbids_flight_from_the_ground_and_not_from_the_pipe() {
    let hardware = ArmingInhibits::NONE.with(ArmingInhibit::BrownOut);
    for (pressure, mode) in [(0.0, Mode::Disarmed), (900.0, Mode::Perched)] {
        let mut r = Rig::found(pressure);
        r.inputs.hardware = hardware;
        r.sticks().perch_switch = pressure > 0.0;
        r.calibrated();
        r.run(1.0);
        r.arm();
        assert_eq!(r.out.mode, mode, "{pressure}");
        assert_eq!(r.out.inhibits.contains(ArmingInhibit::BrownOut), pressure <= 0.0);
    }
}

#[test]
fn power_comes_on_with_open_arms_as_ever() {
    for pressure in [0.0, 70.0] {
        let mut r = Rig::found(pressure);
        r.sticks().perch_switch = false;
        r.stays(AVERAGING_TIME - 0.02, ClampCommand::Keep);
        assert_eq!(r.out.grip_memory, GripMemory::Unknown);
        r.run(0.05);
        assert_eq!(
            (r.out.tendons, r.out.grip_memory),
            (ClampCommand::Release, GripMemory::Open)
        );
        r.calibrated();
        r.grip(false, true, ArmState::Free, pressure);
        r.run(0.1);
        r.arm();
        assert_eq!(r.out.mode, Mode::Armed);
    }
}

#[test]
fn arms_found_pressed_are_left_to_the_gears_until_they_are_opened_on_purpose() {
    let mut r = Rig::found(700.0);
    r.stays(20.0, ClampCommand::Keep);
    assert_eq!(r.out.grip_memory, GripMemory::HeldByGears(ArmChoice::All));
    r.calibrated();
    r.stays(1.0, ClampCommand::Keep);
    r.arm();
    assert_eq!((r.out.mode, r.out.reason), (Mode::Perched, None));
    r.stays(5.0, ClampCommand::Keep);
    r.sticks().throttle = 0.3;
    r.run(0.5);
    r.sticks().perch_switch = false;
    r.expect(1.0, Mode::Releasing);
    assert!(r.out.rotors.spin() && r.out.tendons == ClampCommand::Keep);
    // Called back before the rotors carry: the gears still hold.
    r.sticks().perch_switch = true;
    r.run(0.1);
    r.sticks().perch_switch = false;
    r.run(0.05);
    r.sticks().perch_switch = true;
    r.expect(0.1, Mode::Perched);
    r.stays(1.0, ClampCommand::Keep);
    r.sticks().perch_switch = false;
    r.expect(1.0, Mode::Releasing);
    r.sticks().arm_switch = false;
    r.expect(0.1, Mode::Perched);
    r.stays(1.0, ClampCommand::Keep);
    r.sticks().arm_switch = true;
    r.sticks().perch_switch = true;
    r.run(0.1);
    r.sticks().perch_switch = false;
    r.expect(2.0, Mode::Releasing);
    assert_eq!(r.out.tendons, ClampCommand::Release);
    assert_eq!(
        r.out.grip_memory,
        GripMemory::Controlled(ArmChoice::All),
        "a reset now would close them again"
    );
    r.grip(false, true, ArmState::Free, 0.0);
    r.expect(0.5, Mode::Flight);
}

#[test]
fn the_pair_that_presses_is_the_one_that_is_kept() {
    for (pressures, grip_memory) in [
        ([90.0, 0.0, 0.0, 0.0], GripMemory::HeldByGears(ArmChoice::Front)),
        ([0.0, 500.0, 0.0, 500.0], GripMemory::HeldByGears(ArmChoice::Rear)),
        ([900.0, 0.0, 0.0, 85.0], GripMemory::HeldByGears(ArmChoice::All)),
        ([f32::NAN, 10.0, 79.0, 0.0], GripMemory::Open),
    ] {
        let mut r = Rig::found(0.0);
        if let Some(grip) = &mut r.inputs.grip {
            for (arm, pressure) in grip.arms.iter_mut().zip(pressures) {
                arm.pressure = pressure;
            }
        }
        r.run(1.0);
        assert_eq!(r.out.grip_memory, grip_memory, "{pressures:?}");
    }
    // A short knock is no grip.
    let mut r = Rig::found(0.0);
    r.run(0.2);
    r.grip(false, false, ArmState::Free, 600.0);
    r.run(0.05);
    r.grip(false, false, ArmState::Free, 0.0);
    r.run(0.5);
    assert_eq!(r.out.grip_memory, GripMemory::Open);
}

#[test]
fn without_a_pressure_sensor_it_stays_undecided_whether_arms_hold() {
    let mut r = Rig::found(700.0);
    r.inputs.fsr_fault = [true; 4];
    r.stays(10.0, ClampCommand::Keep);
    r.calibrated();
    r.stays(10.0, ClampCommand::Keep);
    assert_eq!(
        (r.out.mode, r.out.grip_memory),
        (Mode::Disarmed, GripMemory::Unknown)
    );
    // One sensor of a hanging vehicle is enough.
    r.inputs.fsr_fault = [true, true, true, false];
    r.stays(1.0, ClampCommand::Keep);
    assert_eq!(r.out.grip_memory, GripMemory::HeldByGears(ArmChoice::Rear));
}
