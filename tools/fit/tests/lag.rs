//! The lag of motors as builders have them, by the sound of a train of steps.

use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_fit::motor_lag::{self, MotorLag};
use sophie_fit::rotor_sound::{self, Sound};
use sophie_sim::scenario::draw::{self, Value};
use sophie_sim::scenario::{Scenario, keys};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::phone;

const VEHICLES: u64 = 12;

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
    let phone = phone::beside(scenario, &test, 1.7, 15.0, Streams::new(seed));
    let track = rotor_sound::follow(&Sound::of_wav(&phone.wav())?)?;
    motor_lag::fit(&track, f64::from(test.plateau))
}

/// Errors of the rise over the truth: RMS below that of an even spread of 13 %; 95 % intervals hold the truth in nine of
/// ten, and so do those of the fall where the controller brakes and the truth is a time constant.
#[test]
fn the_lag_is_found() {
    let (mut rise, mut within, mut intervals) = (Vec::new(), 0, 0);
    for seed in 1..=VEHICLES {
        let scenario = vehicle(seed);
        let spin = scenario.vehicle.rotor.spin;
        let found = heard(&scenario, seed).unwrap_or_else(|why| panic!("{seed}: {why}"));
        let mut checks = vec![(found.up, spin.up)];
        if spin.brakes {
            checks.push((found.down, spin.down.unwrap_or(spin.up)));
        }
        for (lag, truth) in checks {
            intervals += 1;
            within += u32::from((lag.tau - truth).abs() <= lag.half);
        }
        println!(
            "{seed}: {:.4} {:.4?} {:.4?} brakes {}",
            spin.up, found.up, found.down, spin.brakes
        );
        rise.push(found.up.tau / spin.up - 1.0);
    }
    let rms = (rise.iter().map(|e| e * e).sum::<f64>() / rise.len() as f64).sqrt();
    println!("RMS {rms:.3}, {within} of {intervals}");
    assert!(rms < 0.13 / 3f64.sqrt(), "{rms}");
    assert!(within * 10 >= intervals * 9, "{within} of {intervals}");
}

/// A recording without the train, of the room alone, or of something else.
#[test]
fn another_sound_is_refused() {
    let mut phone = phone::Phone::new(Streams::new(1));
    phone.hear(0.0, 700.0, 15.0);
    let fit = |phone: &phone::Phone| {
        let sound = Sound::of_wav(&phone.wav()).unwrap();
        motor_lag::fit(&rotor_sound::follow(&sound).unwrap(), 1.0)
    };
    assert!(fit(&phone).is_err());
    let mut phone = phone::Phone::new(Streams::new(2));
    phone.hear(300.0, 700.0, 15.0);
    assert!(fit(&phone).unwrap_err().contains("differ by"));
    let mut phone = phone::Phone::new(Streams::new(3));
    phone.hear(300.0, 700.0, 4.0);
    assert!(fit(&phone).unwrap_err().contains("allowed is a whole train"));
    for bytes in [&b"RIFF"[..], b"no sound", b""] {
        assert!(Sound::of_wav(bytes).unwrap_err().contains("is no WAV file"));
    }
}
