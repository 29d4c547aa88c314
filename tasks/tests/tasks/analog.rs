//! Counts as pressures, volts and amperes; rates and silence.

use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::battery::ServoSupply;
use sophie_control::gripper::contact_pressure::FsrFault;
use sophie_control::params::Params;
use sophie_ports::sensors::AnalogFrame;
use sophie_tasks::links::messages::Contact;
use sophie_tasks::perching::analog;

use crate::rig::Rig;
use sophie_fakes::{Answer, FakeAnalog};

/// Light sensors, 16 V and 9.09 A: the default scales are 0.01 V and 0.01 A · 40/11 a count.
const FRAME: AnalogFrame = AnalogFrame {
    fsr: [0; 4],
    battery_voltage: 1600,
    battery_current: 250,
    servo_battery: 0,
};

fn started() -> (Rig, FakeAnalog) {
    let (rig, port) = (Rig::new(), FakeAnalog::default());
    port.frame.set(FRAME);
    rig.time.spawn(analog::run(rig.links, port.clone()));
    (rig, port)
}

fn near(contact: Contact, arm: usize, pressure: f32) -> bool {
    contact.arms[arm].is_ok_and(|p| (p - pressure).abs() < 0.1)
}

#[test]
fn pressures_come_at_500_hz_and_the_battery_at_every_fifth_of_them() {
    let (mut rig, _) = started();
    rig.run(1);
    let (mut contacts, mut batteries) = (Vec::new(), Vec::new());
    rig.run_with(1000, |links, _| {
        contacts.extend(links.contact.latest().map(|m| m.at.as_micros()));
        batteries.extend(links.battery.latest().map(|m| m.at.as_micros()));
    });
    contacts.dedup();
    batteries.dedup();
    assert_eq!(contacts, (0..500).map(|i| 2000 * i).collect::<Vec<u64>>());
    assert_eq!(
        batteries,
        (0..100).map(|i| 8000 + 10_000 * i).collect::<Vec<u64>>()
    );
}

#[test]
fn counts_become_volts_amperes_and_charge() {
    let (mut rig, _) = started();
    rig.run(20_000);
    let battery = rig.links.battery.fresh().unwrap();
    assert!(
        (battery.voltage - 16.0).abs() < 1e-3 && battery.current.is_some_and(|i| (i - 9.0909).abs() < 1e-3)
    );
    // 9.09 A for 20 s, less the first reading's 10 ms.
    assert!(
        battery.used.is_some_and(|used| (used - 181.8).abs() < 0.2),
        "{battery:?}"
    );
    // 16 V over 14.8 V.
    assert!((battery.ratio - 1.0811).abs() < 1e-3, "{}", battery.ratio);
}

#[test]
fn a_current_at_the_rail_leaves_the_voltage_and_a_voltage_at_the_rail_leaves_nothing() {
    let (mut rig, port) = started();
    rig.run(1000);
    // The current's lead is off, and the battery goes from 16 to 10 V.
    port.frame.set(AnalogFrame {
        battery_voltage: 1000,
        battery_current: 4095,
        ..FRAME
    });
    rig.run(2000);
    let battery = rig.links.battery.fresh().unwrap();
    assert!((battery.voltage - 10.0).abs() < 0.01, "{battery:?}");
    assert_eq!(battery.current, None);
    // Now the voltage's: no reading is sent with a new time.
    port.frame.set(AnalogFrame {
        battery_voltage: 4095,
        ..FRAME
    });
    let last = rig.links.battery.latest().unwrap();
    rig.run(490);
    assert_eq!(rig.links.battery.latest(), Some(last));
    assert!(rig.links.battery.fresh().is_some());
    rig.run(20);
    assert_eq!(rig.links.battery.fresh(), None);
    port.frame.set(FRAME);
    rig.run(1000);
    assert!(
        rig.links
            .battery
            .fresh()
            .is_some_and(|b| (b.voltage - 16.0).abs() < 0.05)
    );
}

#[test]
fn the_servo_battery_is_measured_where_it_is_fitted_and_said_where_it_cannot_be() {
    let params = Params {
        servo_batt_div: 11.0,
        ..Params::default()
    };
    let (mut rig, port) = (Rig::with(params), FakeAnalog::default());
    rig.run(600);
    assert_eq!(rig.links.servo_supply(), ServoSupply::Silent);
    let volts = |volts: f32| AnalogFrame {
        servo_battery: (100.0 * volts) as u16,
        ..FRAME
    };
    port.frame.set(volts(8.0));
    rig.time.spawn(analog::run(rig.links, port.clone()));
    rig.run(1000);
    let battery = rig.links.servo_battery.fresh().unwrap();
    assert!((battery.voltage - 8.0).abs() < 1e-3, "{battery:?}");
    assert_eq!(rig.links.servo_supply(), ServoSupply::Good);
    for (now, expected) in [
        (7.1, ServoSupply::NearEnd),
        (6.7, ServoSupply::Low),
        (7.6, ServoSupply::Good),
    ] {
        port.frame.set(volts(now));
        rig.run(6000);
        assert_eq!(rig.links.servo_supply(), expected, "{now} V");
    }
    // At the rail, or from a converter that fails.
    port.frame.set(AnalogFrame {
        servo_battery: 4095,
        ..FRAME
    });
    rig.run(600);
    assert_eq!(rig.links.servo_supply(), ServoSupply::Silent);
    // Not fitted: whatever the pad reads is nothing.
    let (mut rig, port) = started();
    port.frame.set(volts(3.0));
    rig.run(1000);
    assert_eq!(rig.links.servo_supply(), ServoSupply::NotFitted);
    assert_eq!(rig.links.servo_battery.latest(), None);
}

#[test]
fn the_batterys_scales_are_the_parameters() {
    // CUAV's power module, instead of 11 and 40.
    let params = Params {
        battery_divider: 18.0,
        battery_a_per_v: 24.0,
        ..Params::default()
    };
    let (mut rig, port) = (Rig::with(params), FakeAnalog::default());
    port.frame.set(FRAME);
    rig.time.spawn(analog::run(rig.links, port.clone()));
    rig.run(2000);
    let battery = rig.links.battery.fresh().unwrap();
    // The pins have 16 V / 11 and 250 / 1600 of it.
    let volts = 16.0 / 11.0;
    assert!(
        (battery.voltage - 18.0 * volts).abs() < 1e-3,
        "{}",
        battery.voltage
    );
    assert!(
        battery
            .current
            .is_some_and(|i| (i - 24.0 * volts * 250.0 / 1600.0).abs() < 1e-3),
        "{battery:?}"
    );
}

#[test]
fn each_sensor_has_its_own_pressure_and_fault_and_is_valid_again_after_a_fifth_of_a_second() {
    let (mut rig, port) = started();
    // x = 1000/4095: x/((1 - x)·10 kΩ) is 32.31 µS, 223.8 Pa at 100 µS/N and 1444 mm². 4050 counts are a short.
    let short = [1000, 4050, 0, 1000];
    port.frame.set(AnalogFrame { fsr: short, ..FRAME });
    rig.run(20);
    let contact = rig.links.contact.fresh().unwrap();
    assert_eq!(contact.arms[1], Err(FsrFault::Short));
    assert!(
        near(contact, 0, 223.8) && near(contact, 2, 0.0) && near(contact, 3, 223.8),
        "{contact:?}"
    );
    let sound = [1000, 1000, 0, 1000];
    port.frame.set(AnalogFrame { fsr: sound, ..FRAME });
    rig.run(195);
    assert!(rig.links.contact.fresh().unwrap().arms[1].is_err());
    rig.run(10);
    let contact = rig.links.contact.fresh().unwrap();
    assert!(near(contact, 1, 223.8), "{contact:?}");
}

#[test]
fn a_converter_silent_for_a_tenth_of_a_second_is_reported_until_it_converts() {
    for answer in [Answer::Fails, Answer::Refuses, Answer::Hangs] {
        let (mut rig, port) = started();
        // The last good conversion begins at 50 ms.
        rig.run(50);
        port.part.answer.set(answer);
        rig.run(99);
        let silent = |rig: &Rig| rig.links.hardware().contains(ArmingInhibit::AnalogSilent);
        assert!(!silent(&rig) && rig.links.contact.fresh().is_none(), "{answer:?}");
        rig.run(2);
        assert!(silent(&rig), "{answer:?}");
        rig.run(1000);
        assert!(silent(&rig), "{answer:?}");
        if answer != Answer::Hangs {
            port.part.answer.set(Answer::Sound);
            rig.run(3);
            assert!(!silent(&rig) && rig.links.contact.fresh().is_some(), "{answer:?}");
        }
    }
}

#[test]
fn a_sensor_whose_range_ends_below_the_grip_is_reported_from_the_start() {
    let params = Params {
        fsr_scale_2: 2.0,
        fsr_scale_3: 0.5,
        ..Params::default()
    };
    let (mut rig, port) = (Rig::with(params), FakeAnalog::default());
    // 1000 counts are 223.8 Pa bare (x = 0.2442), 661.1 Pa behind 1:2 (0.4884), 96.3 Pa with half the range (0.1221).
    port.frame.set(AnalogFrame {
        fsr: [1000; 4],
        ..FRAME
    });
    rig.time.spawn(analog::run(rig.links, port));
    rig.run(20);
    assert_eq!(
        rig.links.hardware(),
        ArmingInhibits::NONE.with(ArmingInhibit::FsrRange3)
    );
    let contact = rig.links.contact.fresh().unwrap();
    for (arm, expected) in [223.8, 661.1, 96.3, 223.8].into_iter().enumerate() {
        assert!(near(contact, arm, expected), "{contact:?}");
    }
}
