//! `sophie fit-lag`: the lag of a motor from a phone's recording of a train of steps.

use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::phone::{self, Phone};
use sophie_test_support::command::{Temp, refused, sophie, text};

#[test]
fn the_console_s_lines_are_those_of_the_recorded_motor() {
    let scenario = Scenario::parse("[vehicle]\nmotor_tau_s = 0.09\n", "slow", &Overrides::default()).unwrap();
    let test = StaticThrustTest::train(Rotors::One(0), 0.3, 0.6);
    let phone = phone::beside(&scenario, &test, 2.0, 15.5, Streams::new(4));
    let temp = Temp::new("fit-lag");
    std::fs::write(temp.0.join("steps.wav"), phone.wav()).unwrap();
    let output = sophie(&temp, &["fit-lag", "steps.wav"]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let set = said.lines().find_map(|line| line.strip_prefix("set motor_tau "));
    let tau: f64 = set.unwrap().parse().unwrap();
    assert!((tau - 0.09).abs() < 0.009, "{said}");
    assert!(said.ends_with("save\n"), "{said}");
}

#[test]
fn what_is_no_train_of_steps_is_refused_in_one_line() {
    let temp = Temp::new("fit-lag-bad");
    let mut room = Phone::new(Streams::new(1));
    room.hear(0.0, 700.0, 70.0);
    for (name, bytes, why) in [
        ("text.wav", b"1,2,3\n".to_vec(), "is no WAV file that can be read"),
        ("long.wav", room.wav(), "lasts 70 s: allowed are at most 60"),
        (
            "short.wav",
            room.wav()[..100_044].to_vec(),
            "is no WAV file that can be read",
        ),
    ] {
        std::fs::write(temp.0.join(name), bytes).unwrap();
        let line = refused(&temp, &["fit-lag", name]);
        assert!(line.starts_with(&format!("sophie: {name}: {why}")), "{line}");
    }
    let line = refused(&temp, &["fit-lag", "none.wav"]);
    assert!(line.starts_with("sophie: none.wav: cannot be read"), "{line}");
    assert!(refused(&temp, &["fit-lag"]).contains("<SOUND.wav>"));
}
