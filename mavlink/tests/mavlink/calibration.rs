//! Calibration by command: what is found is the console's, and what is put is stored.

use sophie_control::calibration::Face;
use sophie_control::maths::vector::Vec3;
use sophie_control::mode::Mode;
use sophie_dialect::*;
use sophie_mavlink::Order;

use crate::station::{Station, frame, vehicle};

fn calibrate(station: &mut Station, params: [f32; 5]) {
    station.run(100);
    station.sent.clear();
    station.say(&frame(&COMMAND_LONG_DATA {
        param1: params[0],
        param2: params[1],
        param3: params[2],
        param4: params[3],
        param5: params[4],
        command: MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION as u16,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    }));
}

const GYRO: [f32; 5] = [1.0, 0.0, 0.0, 0.0, 0.0];
const LEVEL: [f32; 5] = [0.0, 0.0, 0.0, 0.0, 2.0];
const SIX_SIDES: [f32; 5] = [0.0, 0.0, 0.0, 0.0, 1.0];
const NONE: [f32; 5] = [0.0; 5];

/// Results and progress so far.
fn acks(station: &Station) -> Vec<(u8, u8)> {
    let acks = station.got::<COMMAND_ACK_DATA>();
    acks.iter().map(|ack| (ack.result, ack.progress)).collect()
}

fn feels(station: &mut Station, force: Vec3) {
    station.vehicle.readings.attitude.as_mut().unwrap().1.accel = force;
}

#[test]
fn a_level_rest_puts_the_bias_and_has_it_stored() {
    let mut station = Station::new();
    feels(
        &mut station,
        Face::Belly.force() + Vec3::new(0.25, -0.125, 0.0625),
    );
    calibrate(&mut station, LEVEL);
    station.run(1000);
    assert_eq!(acks(&station), [(5, 0)]);
    assert!(
        station
            .texts()
            .contains(&"calibration: put the vehicle on a level table".into())
    );
    station.run(2000);
    assert_eq!(acks(&station), [(5, 0), (0, 0)]);
    let bias = station.server.params();
    let found = [bias.accel_bias_x, bias.accel_bias_y, bias.accel_bias_z];
    for (found, is) in found.into_iter().zip([0.25, -0.125, 0.0625]) {
        assert!((found - is).abs() < 2e-3, "{found} {is}");
    }
    assert_eq!(station.got::<PARAM_VALUE_DATA>().len(), 3);
    station.run(1500);
    assert_eq!(station.orders, [Order::Store]);
}

#[test]
fn a_gyro_at_rest_changes_nothing_and_a_shaken_one_is_not_taken() {
    let mut station = Station::new();
    calibrate(&mut station, GYRO);
    station.run(3000);
    assert_eq!(acks(&station), [(5, 0), (0, 0)]);
    station.run(2000);
    assert!(station.orders.is_empty());
    calibrate(&mut station, GYRO);
    for i in 0..150 {
        let rate = if i % 2 == 0 { 0.25 } else { -0.25 };
        station.vehicle.readings.attitude.as_mut().unwrap().1.rate = Vec3::new(rate, 0.0, 0.0);
        station.run(20);
    }
    assert_eq!(acks(&station), [(5, 0), (4, 0)]);
    let texts = station.texts();
    assert!(
        texts.contains(&"noise 0.25 not in 0.00..0.01 rad/s".into()),
        "{texts:?}"
    );
}

#[test]
fn six_sides_are_asked_for_one_by_one_and_a_wrong_one_is_waited_for() {
    let mut station = Station::new();
    let beyond = Vec3::new(0.25, -0.125, 0.0625);
    feels(&mut station, Face::Left.force());
    calibrate(&mut station, SIX_SIDES);
    for (i, side) in Face::ALL.into_iter().enumerate() {
        // Still as it was.
        station.run(4000);
        let asked = format!("calibration: {}", side.text());
        assert_eq!(station.texts().last(), Some(&asked));
        assert_eq!(acks(&station).len(), i + 1);
        feels(&mut station, side.force() + beyond);
        // The rest that has begun, and a whole one.
        station.run(5100);
    }
    let steps: Vec<_> = acks(&station);
    assert_eq!(
        steps,
        [(5, 0), (5, 16), (5, 33), (5, 50), (5, 66), (5, 83), (0, 0)]
    );
    let p = station.server.params();
    assert!((p.accel_bias_x - 0.25).abs() < 2e-3 && (p.accel_scale_y - 1.0).abs() < 2e-3);
}

#[test]
fn it_ends_by_command_by_time_and_when_the_vehicle_is_armed() {
    let mut station = Station::new();
    calibrate(&mut station, SIX_SIDES);
    station.run(1000);
    calibrate(&mut station, NONE);
    station.run(100);
    assert_eq!(acks(&station), [(6, 0), (0, 0)]);
    // On its back for a minute and more.
    feels(&mut station, Face::Back.force());
    calibrate(&mut station, SIX_SIDES);
    station.run(64_000);
    assert_eq!(acks(&station), [(5, 0), (4, 0)]);
    calibrate(&mut station, LEVEL);
    station.run(1000);
    station.vehicle.condition = vehicle(Mode::Armed).condition;
    station.run(100);
    assert_eq!(acks(&station), [(5, 0), (1, 0)]);
    calibrate(&mut station, LEVEL);
    station.run(200);
    assert_eq!(acks(&station), [(1, 0)]);
    assert!(station.texts().contains(&"refused: disarm first".into()));
    assert!(station.orders.is_empty());
}

#[test]
fn what_there_is_not_is_unsupported() {
    let mut station = Station::new();
    for params in [
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 3.0],
        [1.0, 0.0, 0.0, 0.0, 1.0],
        [f32::INFINITY, 0.0, 0.0, 0.0, 0.0],
        [0.5, 0.0, 0.0, 0.0, 0.0],
    ] {
        calibrate(&mut station, params);
        station.run(100);
        assert_eq!(acks(&station), [(3, 0)], "{params:?}");
    }
}

#[test]
fn what_is_not_given_is_as_zeros_in_every_spelling() {
    const NAN: f32 = f32::NAN;
    for [first, fifth] in [[1.0, NAN], [NAN, 2.0]] {
        let mut station = Station::new();
        calibrate(&mut station, [first, NAN, -NAN, NAN, fifth]);
        station.run(100);
        assert_eq!(acks(&station), [(5, 0)], "{first} {fifth}");
        calibrate(&mut station, [NAN; 5]);
        station.run(100);
        assert_eq!(acks(&station), [(6, 0), (0, 0)]);
    }
    // Its fifth and sixth are whole numbers in the other message.
    for (first, x, y) in [(1.0, i32::MAX, i32::MAX), (NAN, 2, i32::MAX), (NAN, 4, 0)] {
        let mut station = Station::new();
        station.run(100);
        station.sent.clear();
        station.say(&frame(&COMMAND_INT_DATA {
            param1: first,
            param2: NAN,
            param3: NAN,
            param4: NAN,
            x,
            y,
            z: NAN,
            command: MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION as u16,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        }));
        station.run(100);
        assert_eq!(acks(&station), [(5, 0)], "{first} {x} {y}");
    }
}
