//! The lag of motors as builders have them, by the sound of a train of steps.

use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_fit::motor_lag::{self, MotorLag};
use sophie_fit::rotor_sound::{self, Sound};
use sophie_sim::scenario::draw::{self, Value};
use sophie_sim::scenario::{Scenario, keys};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::phone;

const VEHICLES: u64 = 24;

fn vehicle(seed: u64) -> Scenario {
    let mut scenario = Scenario::default_mission();
    for drawn in draw::draw(Streams::new(seed)) {
        if drawn.key.starts_with("vehicle.") {
            if let Value::Numbers(numbers) = &drawn.value {
                assert!(keys::set(&mut scenario, drawn.key, numbers), "{}", drawn.key);
            } else if drawn.key == "vehicle.esc_brakes" {
                scenario.vehicle.rotor.spin.brakes = drawn.value == Value::Flag(true);
            }
        }
    }
    scenario
}

fn heard(scenario: &Scenario, seed: u64) -> Result<MotorLag, String> {
    let test = StaticThrustTest::train(Rotors::One(0), 0.3, 0.6);
    let samples = phone::record(scenario, &test, 1.7, 15.0, Streams::new(seed));
    let track = rotor_sound::follow(&Sound {
        rate: phone::RATE,
        samples,
    })?;
    motor_lag::fit(&track, f64::from(test.hold))
}

#[test]
fn the_lag_is_found() {
    for seed in 1..=VEHICLES {
        let scenario = vehicle(seed);
        let spin = scenario.vehicle.rotor.spin;
        match heard(&scenario, seed) {
            Ok(lag) => println!(
                "{seed}: up {:.4} is {:.4} ± {:.4} ({:+.1} %), down {:.4} is {:.4} ± {:.4} ({:+.1} %) brakes {} ratio {:.3} misfit {:.3}",
                spin.up,
                lag.up.tau,
                lag.up.half,
                100.0 * (lag.up.tau / spin.up - 1.0),
                spin.down.unwrap_or(spin.up),
                lag.down.tau,
                lag.down.half,
                100.0 * (lag.down.tau / spin.down.unwrap_or(spin.up) - 1.0),
                spin.brakes,
                lag.ratio,
                lag.misfit
            ),
            Err(why) => println!("{seed}: {why}"),
        }
    }
}
