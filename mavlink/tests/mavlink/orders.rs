//! Orders to the commander, with the mode logic itself behind the server.

use sophie_control::attitude::motion::Motion;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::gripper::grip::GripState;
use sophie_control::mode::{Inputs, Mode, ModeLogic, Outputs};
use sophie_control::params::Params;
use sophie_control::pilot::actuator_test::{
    ActuatorTestAnswer, ActuatorTestRequest, ActuatorTestState, ActuatorTestView, PULSE_MAX_US, SPIN_TIME,
};
use sophie_control::pilot::rc::Sticks;
use sophie_control::pilot::remote::RemoteRequest;
use sophie_control::pilot::static_thrust_test::Rotors;
use sophie_dialect::*;
use sophie_mavlink::{Answers, CommanderRequests, Condition};

use crate::station::{Station, frame, frame_from};

const ACCEPTED: u8 = 0;
const REJECTED: u8 = 1;
const DENIED: u8 = 2;
const FAILED: u8 = 4;
const FORCED: f32 = 21_196.0;

/// A vehicle on the ground, its commander and a ground station.
struct Craft {
    station: Station,
    logic: ModeLogic,
    inputs: Inputs,
    out: Outputs,
    /// The commander takes orders.
    listens: bool,
    actuator_test: Option<ActuatorTestRequest>,
    remote: Option<RemoteRequest>,
    /// Periods in which a motor was driven.
    spun: u32,
}

impl Craft {
    /// Disarmed, radio there, both switches off.
    fn new() -> Self {
        let inputs = Inputs {
            sticks: Some(Sticks::default()),
            motion: Some(Motion {
                accel: sophie_control::maths::vector::Vec3::new(0.0, 0.0, -9.80665),
                calibrated: true,
                ..Motion::default()
            }),
            grip: Some(GripState {
                released: true,
                ..GripState::default()
            }),
            battery: Some(16.0),
            ..Inputs::default()
        };
        let mut craft = Self {
            station: Station::new(),
            logic: ModeLogic::new(&Params::DEFAULT),
            inputs,
            out: Outputs::default(),
            listens: true,
            actuator_test: None,
            remote: None,
            spun: 0,
        };
        craft.run(2000);
        assert_eq!(craft.out.mode, Mode::Disarmed);
        craft
    }

    fn sticks(&mut self) -> &mut Sticks {
        self.inputs.sticks.get_or_insert_default()
    }

    fn run(&mut self, ms: u64) {
        for _ in 0..ms / 20 {
            let CommanderRequests {
                remote,
                actuator_test,
            } = {
                let station = &mut self.station;
                station.server.requests(station.now, &station.vehicle)
            };
            (self.remote, self.actuator_test) =
                (remote.or(self.remote), actuator_test.or(self.actuator_test));
            if self.listens {
                (self.inputs.remote, self.inputs.actuator_test) = (remote, actuator_test);
            }
            for _ in 0..2 {
                self.out = self.logic.step(&self.inputs, 0.01);
            }
            self.spun += u32::from(matches!(
                self.out.rotors,
                Setpoint::Spin(_) | Setpoint::StaticThrust(_)
            ));
            self.station.vehicle.condition = Some(Condition {
                mode: self.out.mode,
                reason: self.out.reason,
                warning: "",
                inhibits: self.out.inhibits,
            });
            self.station.vehicle.answers = Answers {
                actuator_test: ActuatorTestView {
                    newest: self.actuator_test.map_or(0, |b| b.number),
                    renewed: actuator_test.is_some(),
                    answer: self.out.actuator_test,
                },
                newest: self.remote.map_or(0, |r| r.number),
                renewed: remote.is_some(),
                remote: self.out.remote,
            };
            self.station.run(20);
        }
    }

    /// Sends a command and gives the result and the texts of the next half second.
    fn command(&mut self, command: MavCmd, params: &[f32]) -> (Vec<u8>, Vec<String>) {
        self.run(500);
        self.station.sent.clear();
        self.station.say(&long(command, params));
        self.run(700);
        let acks = self.station.got::<COMMAND_ACK_DATA>();
        assert!(acks.iter().all(|ack| ack.command == command as u16));
        (acks.iter().map(|ack| ack.result).collect(), self.station.texts())
    }

    #[track_caller]
    fn refused(&mut self, command: MavCmd, params: &[f32], result: u8, why: &str) {
        let (results, texts) = self.command(command, params);
        assert_eq!(results, [result], "{texts:?}");
        assert!(texts.iter().any(|text| text == why), "{texts:?}");
    }

    #[track_caller]
    fn accepted(&mut self, command: MavCmd, params: &[f32]) {
        let (results, texts) = self.command(command, params);
        assert_eq!(results, [ACCEPTED], "{texts:?}");
    }
}

fn long(command: MavCmd, params: &[f32]) -> Vec<u8> {
    let at = |i: usize| params.get(i).copied().unwrap_or(0.0);
    frame(&COMMAND_LONG_DATA {
        param1: at(0),
        param2: at(1),
        param3: at(2),
        param4: at(3),
        param5: at(4),
        param6: at(5),
        param7: at(6),
        command: command as u16,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    })
}

use MavCmd::{
    MAV_CMD_COMPONENT_ARM_DISARM as ARM, MAV_CMD_DO_GRIPPER as GRIPPER, MAV_CMD_DO_MOTOR_TEST as MOTOR,
    MAV_CMD_DO_SET_SERVO as SERVO, MAV_CMD_SOPHIE_STATIC_THRUST as THRUST, MAV_CMD_USER_1 as PROPELLERS_OFF,
};

#[test]
fn it_arms_as_by_radio_and_names_what_forbids_it() {
    let mut craft = Craft::new();
    craft.refused(ARM, &[1.0], REJECTED, "refused: arm switch off");
    craft.sticks().arm_switch = true;
    craft.sticks().throttle = 0.3;
    craft.inputs.battery = Some(12.0);
    // Each check is named to each who is refused.
    for _ in 0..2 {
        let (results, texts) = craft.command(ARM, &[1.0]);
        assert_eq!(results, [REJECTED]);
        assert_eq!(texts, ["arming: throttle not low", "arming: battery low"]);
    }
    craft.sticks().throttle = 0.0;
    craft.inputs.battery = Some(16.0);
    craft.refused(
        ARM,
        &[1.0, FORCED],
        DENIED,
        "refused: no arming check can be forced",
    );
    assert_eq!(craft.out.mode, Mode::Disarmed);
    let sticks = craft.inputs.sticks.take();
    let (results, texts) = craft.command(ARM, &[1.0]);
    assert_eq!(results, [REJECTED]);
    assert!(texts.contains(&"arming: radio lost".to_string()), "{texts:?}");
    craft.inputs.sticks = sticks;
    craft.accepted(ARM, &[1.0]);
    assert_eq!(craft.out.mode, Mode::Armed);
    for bad in [2.0, 0.5, -1.0, f32::NAN] {
        craft.refused(ARM, &[bad], DENIED, "refused: 0 disarms, 1 arms");
    }
    craft.accepted(ARM, &[0.0]);
    assert_eq!(craft.out.mode, Mode::Disarmed);
}

#[test]
fn in_flight_it_disarms_by_force_alone() {
    let mut craft = Craft::new();
    craft.sticks().arm_switch = true;
    craft.accepted(ARM, &[1.0]);
    craft.sticks().throttle = 0.5;
    craft.refused(ARM, &[0.0], REJECTED, "refused: flying: land first");
    assert_eq!(craft.out.mode, Mode::Flight);
    craft.accepted(ARM, &[0.0, FORCED]);
    assert_eq!(
        (craft.out.mode, craft.out.rotors),
        (Mode::Disarmed, Setpoint::Stop)
    );
}

#[test]
fn force_waits_for_no_other_command_and_the_others_do() {
    let mut craft = Craft::new();
    craft.sticks().arm_switch = true;
    craft.accepted(ARM, &[1.0]);
    craft.listens = false;
    craft.inputs.remote = None;
    craft.station.sent.clear();
    craft.station.say(&long(GRIPPER, &[1.0, 1.0]));
    // Sent again by an impatient client: answered once.
    craft.station.say(&long(GRIPPER, &[1.0, 1.0]));
    craft.station.say(&long(ARM, &[0.0]));
    craft.station.say(&long(ARM, &[0.0, FORCED]));
    craft.listens = true;
    craft.run(200);
    let acks = craft.station.got::<COMMAND_ACK_DATA>();
    let acks: Vec<_> = acks.iter().map(|ack| (ack.command, ack.result)).collect();
    let [arm, gripper] = [ARM, GRIPPER].map(|c| c as u16);
    assert_eq!(acks, [(arm, REJECTED), (gripper, REJECTED), (arm, ACCEPTED)]);
    assert_eq!(craft.out.mode, Mode::Disarmed);
}

#[test]
fn force_is_acknowledged_by_the_commander_alone_whatever_ran_before() {
    let begun = [
        (MavCmd::MAV_CMD_SOPHIE_REPORT, [2.0, 0.0, 0.0]),
        (PROPELLERS_OFF, [1.0, 0.0, 0.0]),
    ];
    for (command, params) in begun {
        let mut craft = Craft::new();
        craft.listens = false;
        (craft.inputs.remote, craft.inputs.actuator_test) = (None, None);
        craft.station.sent.clear();
        craft.station.say(&long(command, &params));
        craft.run(40);
        craft.station.say(&long(ARM, &[0.0, FORCED]));
        craft.run(40);
        // The report ends, and the commander answers the actuator test that it took before; it has not seen the force.
        craft.station.server.row(None, 0);
        craft.station.vehicle.answers.actuator_test.answer = ActuatorTestAnswer {
            number: craft.actuator_test.map_or(0, |test| test.number),
            state: ActuatorTestState::Done,
        };
        let station = &mut craft.station;
        let _ = station.server.requests(station.now, &station.vehicle);
        station.run(40);
        let acks = craft.station.got::<COMMAND_ACK_DATA>();
        let force = |ack: &&COMMAND_ACK_DATA| ack.command == ARM as u16;
        assert_eq!(acks.iter().filter(force).count(), 0, "{command:?}");
        craft.listens = true;
        craft.run(200);
        let acks = craft.station.got::<COMMAND_ACK_DATA>();
        let results: Vec<_> = acks.iter().filter(force).map(|ack| ack.result).collect();
        assert_eq!(results, [ACCEPTED], "{command:?}");
    }
}

#[test]
fn a_running_motor_acknowledges_no_other_command() {
    let mut craft = Craft::new();
    craft.accepted(PROPELLERS_OFF, &[1.0]);
    for _ in 0..2 {
        craft.station.sent.clear();
        craft.station.say(&long(MOTOR, &[1.0, 0.0, 8.0]));
        craft.run(200);
        assert!(matches!(craft.out.rotors, Setpoint::Spin(_)));
        // Lasts longer than the motor turns.
        let gyro = [1.0, 0.0, 1.0];
        craft.station.say(&long(MavCmd::MAV_CMD_SOPHIE_CALIBRATE, &gyro));
        craft.run(2400);
        assert_eq!(craft.out.rotors, Setpoint::Stop);
        craft.run(400);
        let acks = craft.station.got::<COMMAND_ACK_DATA>();
        let of = |command: MavCmd| -> Vec<u8> {
            let acks = acks.iter().filter(|ack| ack.command == command as u16);
            acks.map(|ack| ack.result).collect()
        };
        assert_eq!(of(MOTOR), [ACCEPTED]);
        let calibration = of(MavCmd::MAV_CMD_SOPHIE_CALIBRATE);
        let (end, progress) = calibration.split_last().unwrap();
        assert!(*end == ACCEPTED && progress == [5; 3], "{calibration:?}");
        assert_eq!(craft.station.got::<SOPHIE_CALIBRATION_RESULT_DATA>().len(), 1);
    }
}

#[test]
fn a_silent_commander_fails_the_command() {
    let mut craft = Craft::new();
    craft.listens = false;
    for (command, params) in [(ARM, [1.0, 0.0]), (PROPELLERS_OFF, [1.0, 0.0])] {
        craft.refused(command, &params, FAILED, "refused: the commander is silent");
    }
}

#[test]
fn one_motor_turns_once_propellers_are_said_to_be_off() {
    let mut craft = Craft::new();
    let eight = [2.0, 0.0, 8.0];
    craft.refused(
        MOTOR,
        &eight,
        REJECTED,
        "refused: say 'propellers off' first, once they are",
    );
    craft.refused(
        PROPELLERS_OFF,
        &[0.0],
        DENIED,
        "refused: 1 propellers off, 2 on and tied down",
    );
    craft.accepted(PROPELLERS_OFF, &[1.0]);
    assert_eq!(craft.spun, 0);
    craft.accepted(MOTOR, &eight);
    craft.run(3000);
    let whole = (SPIN_TIME * 50.0) as u32;
    assert!(craft.spun.abs_diff(whole) <= 2, "{}", craft.spun);
    // For half a second; and stopped before its end.
    craft.spun = 0;
    craft.accepted(MOTOR, &[2.0, 0.0, 8.0, 0.5]);
    craft.run(2000);
    assert!(craft.spun.abs_diff(25) <= 4, "{}", craft.spun);
    craft.spun = 0;
    craft.station.say(&long(MOTOR, &eight));
    craft.run(300);
    craft.accepted(MOTOR, &[2.0, 0.0, 0.0]);
    craft.run(2000);
    assert!(
        craft.spun < 50 && craft.out.rotors == Setpoint::Stop,
        "{}",
        craft.spun
    );
    // By a pulse, below the least that turns every motor: it is searched for.
    craft.spun = 0;
    craft.accepted(MOTOR, &[2.0, 1.0, 1030.0]);
    craft.run(3000);
    assert!(craft.spun.abs_diff(whole) <= 2, "{}", craft.spun);
    for pulse in [1010.0, 1130.0, f32::INFINITY] {
        craft.refused(MOTOR, &[1.0, 1.0, pulse], DENIED, "refused: out of range");
    }
    for percent in [13.0, 1.0, f32::INFINITY] {
        craft.refused(MOTOR, &[1.0, 0.0, percent], DENIED, "refused: out of range");
    }
    // Time and number are not given.
    for nan in [f32::NAN, -f32::NAN] {
        craft.spun = 0;
        craft.accepted(MOTOR, &[2.0, 0.0, 8.0, nan, nan, nan, nan]);
        craft.run(3000);
        assert!(craft.spun.abs_diff(whole) <= 2, "{}", craft.spun);
    }
    // Which motor, and its throttle's unit, are never guessed.
    for bad in [
        [0.0, 0.0],
        [5.0, 0.0],
        [1.0, 2.0],
        [f32::NAN, 0.0],
        [1.0, f32::NAN],
    ] {
        craft.refused(
            MOTOR,
            &[bad[0], bad[1], 8.0],
            DENIED,
            "refused: motor 1 to 4, one, in percent or us",
        );
    }
    craft.sticks().arm_switch = true;
    craft.refused(
        MOTOR,
        &eight,
        REJECTED,
        "refused: arm switch on: turn it off first",
    );
    craft.accepted(ARM, &[1.0]);
    craft.refused(MOTOR, &eight, REJECTED, "refused: only while DISARMED");
}

impl Craft {
    /// Renews the run of `params` twice a second for `ms`.
    fn renews(&mut self, params: &[f32], ms: u64) {
        for _ in 0..ms / 500 {
            self.station.say(&long(THRUST, params));
            self.run(500);
        }
    }
}

#[test]
fn rotors_run_as_long_as_the_station_renews_the_run() {
    let mut craft = Craft::new();
    let run = |number: f32| [0.0, 60.0, 0.0, 0.0, number];
    craft.refused(
        THRUST,
        &run(1.0),
        REJECTED,
        "refused: say 'tied down' first, once it is",
    );
    craft.accepted(PROPELLERS_OFF, &[1.0]);
    craft.refused(
        THRUST,
        &run(2.0),
        REJECTED,
        "refused: say 'tied down' first, once it is",
    );
    assert_eq!(craft.spun, 0);
    craft.accepted(PROPELLERS_OFF, &[2.0]);
    craft.refused(
        MOTOR,
        &[2.0, 0.0, 8.0],
        REJECTED,
        "refused: say 'propellers off' first, once they are",
    );
    // 1.2 s to rise, 5 s at 60 %.
    craft.accepted(THRUST, &run(3.0));
    craft.renews(&run(3.0), 8000);
    assert!(craft.spun.abs_diff(310) <= 3, "{}", craft.spun);
    // A run that has ended does not begin again.
    craft.spun = 0;
    craft.refused(THRUST, &run(3.0), REJECTED, "refused: this run has ended");
    assert_eq!(craft.spun, 0);
    // Without its sender it ends.
    craft.accepted(THRUST, &run(4.0));
    craft.run(1500);
    assert_eq!(craft.out.rotors, Setpoint::Stop);
    assert!(craft.spun.abs_diff(75) <= 5, "{}", craft.spun);
    assert!(
        craft
            .station
            .texts()
            .iter()
            .any(|text| text == "refused: run not renewed: it ends")
    );
    craft.refused(THRUST, &run(4.0), REJECTED, "refused: this run has ended");
}

#[test]
fn a_run_ends_by_its_command_and_a_command_that_is_repeated_begins_it_once() {
    let mut craft = Craft::new();
    craft.accepted(PROPELLERS_OFF, &[2.0]);
    craft.station.sent.clear();
    let one = [3.0, 100.0, 0.0, 1.0, 9.0];
    craft.station.say(&long(THRUST, &one));
    craft.station.say(&long(THRUST, &one));
    craft.run(400);
    let acks = craft.station.got::<COMMAND_ACK_DATA>();
    assert_eq!(acks.iter().map(|ack| ack.result).collect::<Vec<_>>(), [ACCEPTED]);
    let Setpoint::StaticThrust(thrust) = craft.out.rotors else {
        panic!("{:?}", craft.out.rotors);
    };
    assert!(
        thrust.rotors == Rotors::One(2) && (thrust.drive - 0.2).abs() < 0.02,
        "{thrust:?}"
    );
    craft.accepted(THRUST, &[0.0, 0.0]);
    assert_eq!(craft.out.rotors, Setpoint::Stop);
    // A train.
    craft.spun = 0;
    let train = [0.0, 30.0, 60.0, 0.5, 10.0];
    craft.accepted(THRUST, &train);
    craft.renews(&train, 8000);
    assert!(craft.spun.abs_diff(305) <= 3, "{}", craft.spun);
}

#[test]
fn a_run_that_is_not_understood_or_beyond_the_limits_never_begins() {
    let mut craft = Craft::new();
    craft.accepted(PROPELLERS_OFF, &[2.0]);
    let range = "refused: out of range";
    for (params, why) in [
        ([5.0, 60.0, 0.0, 0.0, 1.0], "refused: rotor 1 to 4, 0 for all"),
        (
            [f32::NAN, 60.0, 0.0, 0.0, 1.0],
            "refused: rotor 1 to 4, 0 for all",
        ),
        (
            [0.0, 60.0, 0.0, 0.0, 0.0],
            "refused: each run has a number, from 1",
        ),
        (
            [0.0, 60.0, 0.0, 0.0, f32::NAN],
            "refused: each run has a number, from 1",
        ),
        ([0.0, 101.0, 0.0, 0.0, 1.0], range),
        ([0.0, 4.0, 0.0, 0.0, 1.0], range),
        ([0.0, f32::NAN, 0.0, 0.0, 1.0], range),
        ([0.0, 20.0, 80.0, 0.0, 1.0], range),
        ([0.0, 60.0, 0.0, 11.0, 1.0], range),
    ] {
        craft.refused(THRUST, &params, DENIED, why);
    }
    assert_eq!(craft.spun, 0);
    // Time and other drive are not given.
    craft.accepted(THRUST, &[0.0, 60.0, f32::NAN, f32::NAN, 1.0]);
    craft.sticks().arm_switch = true;
    let (results, _) = craft.command(THRUST, &[0.0, 60.0, 0.0, 0.0, 1.0]);
    assert_eq!((results, craft.out.rotors), (vec![REJECTED], Setpoint::Stop));
}

#[test]
fn a_servo_takes_a_pulse_and_gives_it_back() {
    let mut craft = Craft::new();
    craft.accepted(SERVO, &[6.0, 1500.0]);
    assert!(
        matches!(craft.out.tendons, sophie_control::gripper::clamp_command::ClampCommand::Place(p) if p.servo == 1),
        "{:?}",
        craft.out.tendons
    );
    craft.accepted(SERVO, &[6.0, 0.0]);
    assert_eq!(
        craft.out.tendons,
        sophie_control::gripper::clamp_command::ClampCommand::Release
    );
    craft.refused(SERVO, &[5.0, PULSE_MAX_US + 1.0], DENIED, "refused: out of range");
    for output in [1.0, 4.0, 9.0, f32::NAN] {
        craft.refused(
            SERVO,
            &[output, 1500.0],
            DENIED,
            "refused: outputs 5 to 8 are the servos",
        );
    }
}

#[test]
fn the_gripper_stays_where_the_switch_does_nothing() {
    let mut craft = Craft::new();
    for action in [0.0, 1.0] {
        craft.refused(
            GRIPPER,
            &[1.0, action],
            REJECTED,
            "refused: only in flight or on the pipe",
        );
    }
    craft.refused(
        GRIPPER,
        &[1.0, 2.0],
        DENIED,
        "refused: gripper 1: 0 releases, 1 grabs",
    );
    craft.sticks().arm_switch = true;
    craft.accepted(ARM, &[1.0]);
    craft.sticks().throttle = 0.5;
    craft.run(200);
    craft.accepted(GRIPPER, &[1.0, 1.0]);
    craft.accepted(GRIPPER, &[f32::NAN, 1.0, f32::NAN]);
    craft.refused(
        GRIPPER,
        &[1.0, f32::NAN],
        DENIED,
        "refused: gripper 1: 0 releases, 1 grabs",
    );
    craft.inputs.sticks = None;
    craft.run(1000);
    craft.refused(GRIPPER, &[1.0, 1.0], REJECTED, "refused: radio lost");
}

#[test]
fn another_system_orders_as_well_but_not_in_anothers_name() {
    let mut craft = Craft::new();
    craft.station.sent.clear();
    craft.station.say(&frame_from(
        7,
        &COMMAND_LONG_DATA {
            param1: 1.0,
            command: ARM as u16,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        },
    ));
    craft.run(200);
    let ack = &craft.station.got::<COMMAND_ACK_DATA>()[0];
    assert_eq!((ack.result, ack.target_system), (REJECTED, 7));
}
