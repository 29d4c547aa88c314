use super::*;

/// Ends armed and off the ground.
fn start(seed: u64) -> Scenario {
    Scenario {
        seed,
        time_limit: 7.0,
        ..scenario("hover.toml")
    }
}

/// Requires equal runs, to the last edge, for equal seeds only.
fn repeats(fly: impl Fn(&Scenario) -> Flight) {
    let [first, second, other] = [1, 1, 2].map(|seed| fly(&start(seed)));
    assert!(logged_at(&first, 0.0, "FLIGHT").is_some(), "{}", log(&first));
    assert_eq!(first.board.lines, second.board.lines);
    assert_eq!(first.board.run.pins_digest, second.board.run.pins_digest);
    assert_eq!(first.digest(), second.digest());
    assert_eq!(first.record.digest, second.record.digest);
    assert_ne!(first.board.run.pins_digest, other.board.run.pins_digest);
}

#[test]
fn one_seed_is_one_run_on_the_small_board() {
    repeats(|scenario| fly_small(scenario, &[]));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn one_seed_is_one_run_on_the_reference_board() {
    repeats(|scenario| fly(scenario, 1.0, &[]));
}
