//! The server on a TCP port of this machine with a vehicle that stands still in one picture, for clients that others
//! wrote (`.ci/clients`): `cargo run --package sophie-mavlink --example serve`. It prints its port, serves one client and
//! ends with it, or after [`LONGEST`].

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::thread::sleep;
use std::time::{Duration, Instant};

use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::battery::Battery;
use sophie_control::calibration::procedure::Procedure;
use sophie_control::chain::Attitude;
use sophie_control::gripper::grip::{ArmGrip, ArmState, GripState};
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::Params;
use sophie_control::pilot::rc::{ArmChoice, StickMode, Sticks};
use sophie_mavlink::inputs::Inputs;
use sophie_mavlink::{Condition, Order, Server, Signing, Vehicle};
use sophie_ports::signing::Stored;

/// The period of the task that serves a line.
const PERIOD: Duration = Duration::from_millis(20);
/// Time after which it ends whatever happens.
const LONGEST: Duration = Duration::from_secs(60);
/// Bytes each second: 57,600 baud with a fifth to spare.
const BUDGET: u32 = 4608;

/// What `mavlink/tests/clients/pymavlink_client.py` expects, field by field.
fn picture() -> Vehicle {
    let arm = |state, pressure: f32, force: f32| ArmGrip {
        state,
        pressure,
        force,
        closure: (state == ArmState::Holding).then_some(2.5),
        fault: None,
        response: None,
    };
    Vehicle {
        condition: Some(Condition {
            mode: Mode::Disarmed,
            reason: Some(Reason::TippedOver),
            warning: "infill below what was flown",
            inhibits: ArmingInhibits::NONE
                .with(ArmingInhibit::TiltTooLarge)
                .with(ArmingInhibit::BatteryLow),
        }),
        attitude: Some(Attitude {
            q: turned(0.5, -0.25, 2.0),
            rate: Vec3::new(0.125, -0.25, 0.5),
            accel: Vec3::new(4.903_325, -9.80665, 2.451_662_5),
            calibrated: true,
            ..Attitude::default()
        }),
        sticks: Some(Sticks {
            roll: 0.5,
            pitch: -0.5,
            yaw: -1.0,
            throttle: 0.75,
            arm_switch: false,
            perch_switch: true,
            hold_switch: false,
            stick_mode: StickMode::Direct,
            arms: ArmChoice::Front,
        }),
        battery: Some(Battery {
            voltage: 13.25,
            current: Some(2.5),
            used: Some(1620.0),
            ratio: 1.0,
        }),
        capacity: 6480.0,
        motors: Some([0.0, 0.125, 0.5, 1.0]),
        servos: Some([550.0, 1000.0, 1500.0, 2450.0]),
        load: 375,
        tilt: [-0.25, 0.125, f32::NAN, 0.5],
        reel: [0.0, 1.0, 2.0, 4.5],
        grip: Some(GripState {
            proven: true,
            misfit: None,
            released: false,
            arms: [
                arm(ArmState::Holding, 950.0, 64.0),
                arm(ArmState::Closing, 12.5, 8.0),
                arm(ArmState::Faulty, 0.0, 16.0),
                arm(ArmState::Free, 0.0, 0.0),
            ],
        }),
        ..Vehicle::default()
    }
}

/// The quaternion of these angles, rad, by the library's exact sines: the vehicle's own are coarser.
fn turned(roll: f32, pitch: f32, yaw: f32) -> Quat {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| (0.5 * angle).sin_cos());
    Quat {
        w: cr * cp * cy + sr * sp * sy,
        x: sr * cp * cy - cr * sp * sy,
        y: cr * sp * cy + sr * cp * sy,
        z: cr * cp * sy - sr * sp * cy,
    }
}

fn main() -> std::io::Result<()> {
    let listener = TcpListener::bind(("127.0.0.1", 0))?;
    println!("{}", listener.local_addr()?.port());
    let (mut line, _) = listener.accept()?;
    line.set_nonblocking(true)?;
    let vehicle = picture();
    let mut server = Server::new(Params::DEFAULT, BUDGET);
    let mut signing = Signing::new(Stored::None);
    let mut inputs = Inputs::new(&Params::DEFAULT);
    let mut procedure = Procedure::new();
    let start = Instant::now();
    let mut bytes = [0; 512];
    while start.elapsed() < LONGEST {
        let now = u64::try_from(start.elapsed().as_micros()).unwrap_or(u64::MAX);
        match line.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => server.receive(
                bytes.get(..count).unwrap_or_default(),
                now,
                &vehicle,
                &mut signing,
                &mut inputs,
                &mut procedure,
            ),
            Err(error) if error.kind() == ErrorKind::WouldBlock => (),
            Err(_) => break,
        }
        while let Some(frame) = server.send(now, &vehicle, &mut signing, &mut inputs) {
            line.write_all(frame)?;
        }
        match server.order(now, &vehicle, &Params::DEFAULT, &mut procedure) {
            // Nothing is kept here: what matters is that it is asked for.
            Some(Order::Store) => server.stored(Ok(())),
            Some(Order::Restart) => break,
            Some(Order::Row(..)) => server.row(None, 0),
            Some(Order::SetBrownOut) => server.brown_out_done(Err("no chip here")),
            None => (),
        }
        sleep(PERIOD);
    }
    Ok(())
}
