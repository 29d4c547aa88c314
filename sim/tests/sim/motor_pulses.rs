//! Motor controllers on pulses whose true ends equal, or differ from, those of the parameters.

use sophie_control::params::{MotorProtocol, Params};
use sophie_sim::flight::fly;
use sophie_sim::plant::esc::EscSpec;
use sophie_sim::record::{FlightRecord, Sample, Silent};
use sophie_sim::scenario::{Scenario, Step};

/// A DJI 430 Lite.
const DJI: EscSpec = EscSpec {
    pulse_min: 1120.0,
    pulse_idle: 1180.0,
    pulse_max: 1920.0,
};

/// Samples in which a rotor reaches its command, 0.5 s: ten time constants.
const SETTLED: usize = 50;

/// Up by two metres, and down.
fn flown(esc: EscSpec, change: impl FnOnce(&mut Params)) -> FlightRecord {
    let mut scenario = Scenario::default_mission();
    scenario.steps = vec![
        Step::Arm,
        Step::TakeOff { height: 2.0 },
        Step::Hover { seconds: 5.0 },
        Step::Land,
        Step::Disarm,
    ];
    scenario.vehicle.esc = esc;
    scenario.params.motor_protocol = MotorProtocol::Pwm;
    change(&mut scenario.params);
    fly(&scenario, &mut Silent)
}

fn as_dji(p: &mut Params) {
    p.motor_pulse_min = 1120.0;
    p.motor_pulse_idle = 1190.0;
    p.motor_pulse_max = 1920.0;
}

/// Samples after half a second in which all rotors were to turn.
fn turning(record: &FlightRecord) -> Vec<&Sample> {
    let asked = |s: &Sample| s.thrust_asked.iter().all(|t| *t > 0.0);
    let spells = record.samples.windows(SETTLED);
    let turning: Vec<_> = spells
        .filter(|spell| spell.iter().all(asked))
        .filter_map(|spell| spell.last())
        .collect();
    assert!(turning.len() > 1000, "{}: {:?}", turning.len(), record.outcome);
    turning
}

/// Thrust of the rotor that turns least, N.
fn least(record: &FlightRecord) -> f64 {
    let thrusts = turning(record).into_iter().flat_map(|s| s.thrust);
    thrusts.fold(f64::MAX, f64::min)
}

/// True over asked mean thrust in the air.
fn given(record: &FlightRecord) -> f64 {
    let all = turning(record);
    let high = all.iter().filter(|s| s.position[2] < -1.5);
    let [mut truth, mut asked] = [0.0; 2];
    for s in high {
        truth += s.thrust.iter().sum::<f64>();
        asked += s.thrust_asked.iter().sum::<f64>();
    }
    truth / asked
}

#[test]
fn no_rotor_stands_still_between_arming_and_disarming_by_the_controllers_own_ends() {
    let usual = flown(EscSpec::default(), |_| ());
    let dji = flown(DJI, as_dji);
    for record in [&usual, &dji] {
        assert!(record.outcome.accomplished, "{:?}", record.outcome);
        assert!(least(record) > 0.1, "{} N", least(record));
    }
    // The slope follows from the ends, so the hover thrust equals the command.
    let [usual, dji] = [given(&usual), given(&dji)];
    assert!((dji / usual - 1.0).abs() < 0.01, "{dji} {usual}");
}

#[test]
fn by_the_ends_of_others_rotors_stand_still_while_they_should_idle() {
    let record = flown(DJI, |_| ());
    // An armed vehicle's rotors idle at 1076 to 1094 µs.
    assert!(least(&record) < 1e-3, "{} N", least(&record));
}

#[test]
fn a_dead_zone_above_the_idle_thrust_raises_it() {
    let wide = EscSpec {
        pulse_idle: 1230.0,
        ..DJI
    };
    let raised = flown(wide, |p| {
        as_dji(p);
        p.motor_pulse_idle = 1235.0;
    });
    assert!(raised.outcome.accomplished, "{:?}", raised.outcome);
    assert!(least(&raised) > 0.3, "{} N", least(&raised));
    assert!(least(&flown(wide, as_dji)) < 1e-3);
}

#[test]
fn controllers_with_pulses_of_an_eighth_fly_the_same() {
    let short = flown(DJI, |p| {
        as_dji(p);
        p.motor_protocol = MotorProtocol::Oneshot125;
    });
    assert!(short.outcome.accomplished, "{:?}", short.outcome);
    assert!(least(&short) > 0.1, "{} N", least(&short));
}
