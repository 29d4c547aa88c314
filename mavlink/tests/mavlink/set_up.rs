//! What a host that leads through the set-up asks for: calibrations step by step, reports, identity, arming checks.

use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::calibration::Face;
use sophie_control::calibration::step::{Calibration, Step};
use sophie_control::maths::vector::Vec3;
use sophie_control::mode::Mode;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_dialect::*;
use sophie_mavlink::{Order, Report, Row};

use crate::station::{Station, frame, vehicle};

const TAKEN: u8 = SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_TAKEN as u8;
const DONE: u8 = SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_DONE as u8;
const UNFIT: u8 = SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_UNFIT as u8;

fn ask(station: &mut Station, command: MavCmd, params: [f32; 5]) {
    station.say(&frame(&COMMAND_LONG_DATA {
        param1: params[0],
        param2: params[1],
        param3: params[2],
        param4: params[3],
        param5: params[4],
        command: command as u16,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    }));
}

/// As [`calibrate`], by a sender that has had no acknowledgement.
fn repeat(station: &mut Station, calibration: Calibration, params: [f32; 4]) {
    let [part, step, first, second] = params;
    station.say(&frame(&COMMAND_LONG_DATA {
        param1: calibration as u8 as f32,
        param2: part,
        param3: step,
        param4: first,
        param5: second,
        command: MavCmd::MAV_CMD_SOPHIE_CALIBRATE as u16,
        confirmation: 1,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    }));
}

fn calibrate(station: &mut Station, calibration: Calibration, params: [f32; 4]) {
    let [part, step, first, second] = params;
    let numbers = [calibration as u8 as f32, part, step, first, second];
    ask(station, MavCmd::MAV_CMD_SOPHIE_CALIBRATE, numbers);
}

fn acks(station: &Station) -> Vec<(u8, u8)> {
    let acks = station.got::<COMMAND_ACK_DATA>();
    acks.iter().map(|ack| (ack.result, ack.progress)).collect()
}

/// A station whose streams have settled.
fn station() -> Station {
    let mut station = Station::new();
    station.run(100);
    station.sent.clear();
    station
}

#[test]
fn a_step_is_measured_with_its_progress_and_its_result_comes_before_the_acknowledgement() {
    let mut station = station();
    station.vehicle.readings.attitude.as_mut().unwrap().1.accel =
        Face::Belly.force() + Vec3::new(0.25, 0.0, 0.0);
    calibrate(&mut station, Calibration::Level, [0.0, 1.0, 0.0, 0.0]);
    station.run(2700);
    assert_eq!(acks(&station), [(5, 0), (5, 40), (5, 80), (0, 0)]);
    let result = &station.got::<SOPHIE_CALIBRATION_RESULT_DATA>()[0];
    assert_eq!(
        (result.calibration, result.index, result.step, result.outcome),
        (2, 0, 1, DONE)
    );
    assert!(result.value.is_nan() && result.figures.iter().all(|figure| figure.is_nan()));
    let order: Vec<u32> = station.sent.iter().map(|sent| sent.id).collect();
    let at = |id| order.iter().position(|sent| *sent == id).unwrap();
    let last_ack = order.iter().rposition(|sent| *sent == 77).unwrap();
    assert!(at(22) < at(53001) && at(53001) < last_ack, "{order:?}");
    assert!((station.server.params().accel_bias_x - 0.25).abs() < 2e-3);
    station.run(1500);
    assert_eq!(station.orders, [Order::Store]);
}

#[test]
fn steps_of_a_part_follow_each_other_and_what_is_unfit_is_named_with_its_range() {
    let mut station = station();
    calibrate(&mut station, Calibration::Arm, [2.0, 2.0, 0.0, 0.0]);
    station.run(100);
    assert_eq!(acks(&station), [(1, 0)], "the second step first");
    station.sent.clear();
    station.vehicle.readings.tilts = [0.0, 0.02, 0.0, 0.0].map(Some);
    calibrate(&mut station, Calibration::Arm, [2.0, 1.0, 0.0, 0.0]);
    station.run(2700);
    station.vehicle.readings.tilts = [0.0, 0.05, 0.0, 0.0].map(Some);
    calibrate(&mut station, Calibration::Arm, [2.0, 2.0, 0.0, 0.0]);
    station.run(2700);
    station.vehicle.readings.tilts = [0.0, 0.42, 0.0, 0.0].map(Some);
    calibrate(&mut station, Calibration::Arm, [2.0, 2.0, 0.0, 0.0]);
    station.run(2700);
    let results = station.got::<SOPHIE_CALIBRATION_RESULT_DATA>();
    let outcomes: Vec<u8> = results.iter().map(|result| result.outcome).collect();
    assert_eq!(outcomes, [TAKEN, UNFIT, DONE]);
    let unfit = &results[1];
    assert_eq!(unfit.quantity.to_str().unwrap(), "turn of the arm");
    assert_eq!(unfit.unit.to_str().unwrap(), "rad");
    assert!((unfit.value - 0.03).abs() < 1e-6 && (unfit.least, unfit.most) == (0.1, 1.5));
    assert_eq!(results[2].index, 2);
    assert!((station.server.params().arm_zero_2 - 0.02).abs() < 1e-6);
}

#[test]
fn a_repeated_command_whose_acknowledgement_was_lost_is_acknowledged_again_without_a_measurement() {
    let mut station = station();
    for (tilt, number, outcome) in [(0.02, 1.0, TAKEN), (0.42, 2.0, DONE)] {
        station.vehicle.readings.tilts = [0.0, tilt, 0.0, 0.0].map(Some);
        calibrate(&mut station, Calibration::Arm, [2.0, number, 0.0, 0.0]);
        station.run(2700);
        station.sent.clear();
        // The arm is let go meanwhile.
        station.vehicle.readings.tilts = [Some(0.0); 4];
        repeat(&mut station, Calibration::Arm, [2.0, number, 0.0, 0.0]);
        station.run(500);
        assert_eq!(acks(&station), [(0, 0)]);
        assert_eq!(
            station.got::<SOPHIE_CALIBRATION_RESULT_DATA>()[0].outcome,
            outcome
        );
    }
    assert!((station.server.params().arm_zero_2 - 0.02).abs() < 1e-6);
    // Another step is measured, and so is the same one without the mark of a repetition.
    station.sent.clear();
    repeat(&mut station, Calibration::Arm, [1.0, 1.0, 0.0, 0.0]);
    station.run(2700);
    calibrate(&mut station, Calibration::Arm, [1.0, 1.0, 0.0, 0.0]);
    station.run(2700);
    assert_eq!(acks(&station).iter().filter(|ack| **ack == (5, 0)).count(), 2);
}

#[test]
fn a_running_step_ends_by_command_by_arming_and_by_a_kill() {
    let mut station = station();
    let gyro = [0.0, 1.0, 0.0, 0.0];
    calibrate(&mut station, Calibration::Gyro, gyro);
    station.run(500);
    ask(&mut station, MavCmd::MAV_CMD_SOPHIE_CALIBRATE, [0.0; 5]);
    station.run(3000);
    assert_eq!(acks(&station), [(5, 0), (6, 0), (0, 0)]);
    station.sent.clear();
    calibrate(&mut station, Calibration::Gyro, gyro);
    station.run(500);
    station.vehicle.condition = vehicle(Mode::Armed).condition;
    station.run(3000);
    assert_eq!(acks(&station), [(5, 0), (1, 0)]);
    assert!(station.got::<SOPHIE_CALIBRATION_RESULT_DATA>().is_empty());
}

#[test]
fn one_line_calibrates_at_a_time() {
    let mut station = station();
    let step = Step::new(Calibration::Gyro, 0, 1, [0.0; 2]).unwrap();
    // Another line's step is running.
    station.procedure.begin(step, station.now).unwrap();
    calibrate(&mut station, Calibration::Level, [0.0, 1.0, 0.0, 0.0]);
    ask(&mut station, MavCmd::MAV_CMD_SOPHIE_CALIBRATE, [0.0; 5]);
    station.run(200);
    assert_eq!(acks(&station), [(1, 0), (0, 0)]);
    assert!(
        station
            .texts()
            .contains(&"refused: another line calibrates".into())
    );
    assert!(
        station.procedure.running().is_some(),
        "ended by its own line alone"
    );
}

#[test]
fn a_report_comes_row_by_row_each_when_the_board_has_made_it() {
    let mut station = station();
    ask(
        &mut station,
        MavCmd::MAV_CMD_SOPHIE_REPORT,
        [1.0, 0.0, 0.0, 0.0, 0.0],
    );
    station.run(1000);
    assert_eq!(acks(&station), [(5, 0)]);
    // The board still counts: it is asked for the first row all the time.
    assert!(
        station
            .orders
            .iter()
            .all(|order| *order == Order::Row(Report::SelfTest, 0))
    );
    for number in 0..3 {
        let row = Row {
            name: "receiver",
            passed: number != 1,
            inhibits: ArmingInhibits::NONE.with(ArmingInhibit::RcLost),
            found: "silent: 0 frames, 0 errors".try_into().unwrap(),
        };
        station.server.row(Some(row), 3);
        // While it waits for the line, no other is made.
        assert_eq!(
            station.server.order(
                station.now,
                &station.vehicle,
                &sophie_control::params::Params::DEFAULT,
                &mut station.procedure
            ),
            None
        );
        station.run(40);
    }
    station.server.row(None, 3);
    station.run(40);
    let rows = station.got::<SOPHIE_CHECK_DATA>();
    let numbers: Vec<_> = rows.iter().map(|row| (row.row, row.rows, row.passed)).collect();
    assert_eq!(numbers, [(0, 3, 1), (1, 3, 0), (2, 3, 1)]);
    assert_eq!(rows[0].name.to_str().unwrap(), "receiver");
    assert_eq!(rows[0].found.to_str().unwrap(), "silent: 0 frames, 0 errors");
    assert_eq!(rows[0].inhibits, 1 << (ArmingInhibit::RcLost as u8));
    assert_eq!(acks(&station), [(5, 0), (0, 0)]);
}

#[test]
fn identity_arming_checks_and_the_air_are_told_on_request() {
    let mut station = station();
    station.vehicle.board = "matek-h743";
    station.vehicle.build = [0x1234_5678, 0x9ABC_DEF0];
    station.vehicle.air = Some(AirPressure {
        at_us: 1,
        pascal: 98_765.0,
        celsius: 31.5,
    });
    let condition = station.vehicle.condition.as_mut().unwrap();
    condition.inhibits = ArmingInhibits::NONE
        .with(ArmingInhibit::RcLost)
        .with(ArmingInhibit::BatteryLow);
    for id in [148.0, 396.0, 53003.0, 29.0] {
        ask(
            &mut station,
            MavCmd::MAV_CMD_REQUEST_MESSAGE,
            [id, 0.0, 0.0, 0.0, 0.0],
        );
        station.run(40);
    }
    let version = &station.got::<AUTOPILOT_VERSION_DATA>()[0];
    assert_eq!(
        version.flight_custom_version,
        [0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0]
    );
    let component = &station.got::<COMPONENT_INFORMATION_BASIC_DATA>()[0];
    assert_eq!(component.model_name.to_str().unwrap(), "matek-h743");
    assert_eq!(component.vendor_name.to_str().unwrap(), "SOPHIE");
    assert_eq!(
        component.software_version.to_str().unwrap(),
        env!("CARGO_PKG_VERSION")
    );
    assert_eq!(
        station.got::<SOPHIE_ARMING_DATA>()[0].failing,
        1 << (ArmingInhibit::RcLost as u8) | 1 << (ArmingInhibit::BatteryLow as u8)
    );
    let air = &station.got::<SCALED_PRESSURE_DATA>()[0];
    assert!((air.press_abs - 987.65).abs() < 1e-3 && air.temperature == 3150);
    // Without a fresh sample nothing is sent.
    station.vehicle.air = None;
    station.sent.clear();
    ask(
        &mut station,
        MavCmd::MAV_CMD_REQUEST_MESSAGE,
        [29.0, 0.0, 0.0, 0.0, 0.0],
    );
    station.run(40);
    assert!(station.got::<SCALED_PRESSURE_DATA>().is_empty());
}

#[test]
fn the_brown_out_level_is_an_order_to_the_board_at_rest_alone() {
    let mut station = station();
    ask(
        &mut station,
        MavCmd::MAV_CMD_SOPHIE_SET_BROWN_OUT,
        [1.0, 0.0, 0.0, 0.0, 0.0],
    );
    station.run(40);
    assert_eq!(station.orders, [Order::SetBrownOut]);
    assert_eq!(acks(&station), []);
    station.server.brown_out_done(Err("nothing to do"));
    station.run(40);
    assert_eq!(acks(&station), [(4, 0)]);
    assert!(
        station
            .texts()
            .contains(&"brown-out level not set: nothing to do".into())
    );
    station.vehicle.condition = vehicle(Mode::Flight).condition;
    ask(
        &mut station,
        MavCmd::MAV_CMD_SOPHIE_SET_BROWN_OUT,
        [1.0, 0.0, 0.0, 0.0, 0.0],
    );
    station.run(40);
    assert_eq!(station.orders.len(), 1);
    assert_eq!(acks(&station), [(4, 0), (1, 0)]);
}

#[test]
fn a_report_that_lost_its_command_keeps_others_out_until_its_end() {
    let mut station = station();
    let chip = [2.0, 0.0, 0.0, 0.0, 0.0];
    ask(&mut station, MavCmd::MAV_CMD_SOPHIE_REPORT, chip);
    station.run(40);
    // A forced disarming, which waits for no other command; the commander does not answer.
    ask(
        &mut station,
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        [0.0, 21_196.0, 0.0, 0.0, 0.0],
    );
    station.run(1000);
    let _ = station.server.requests(station.now, &station.vehicle);
    station.run(40);
    assert_eq!(acks(&station), [(5, 0), (1, 0), (4, 0)]);
    station.sent.clear();
    ask(&mut station, MavCmd::MAV_CMD_SOPHIE_REPORT, chip);
    station.run(40);
    station.server.row(None, 0);
    ask(&mut station, MavCmd::MAV_CMD_SOPHIE_REPORT, chip);
    station.run(40);
    station.server.row(None, 0);
    station.run(40);
    assert_eq!(acks(&station), [(1, 0), (5, 0), (0, 0)]);
}
