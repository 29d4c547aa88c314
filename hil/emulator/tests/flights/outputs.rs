//! Outputs of a board during a reset.

use sophie_emulator::wires::{BoardFault, Output};

use super::*;

fn restarted(fly: impl Fn(&Scenario, &[(f64, Trouble)]) -> Flight) -> Flight {
    let flight = fly(&hover(2.2), &[(1.0, Trouble::Board(BoardFault::ResetPin))]);
    for output in &flight.board.run.outputs {
        // For docs/boards.md.
        println!("{output:?}");
        let after = &output.after_us;
        assert!(
            after.len() == 2 && after.iter().all(Option::is_some),
            "{output:?}"
        );
    }
    assert!(
        logged_at(&flight, 1.0, "start after Pin").is_some(),
        "{}",
        log(&flight)
    );
    flight
}

fn longest_us(outputs: &[Output], what: &str) -> f64 {
    let these = outputs.iter().filter(|output| output.what.starts_with(what));
    let times = these.flat_map(|output| output.after_us.iter().flatten());
    times.fold(0.0, |longest: f64, us| longest.max(*us))
}

/// The first levels are some forty instructions; clearing the memory would be 100,000 and more.
const LIMIT_US: f64 = 1.0;

/// Requires that the chip pulls up only the named outputs, and all but the lights are driven before the memory is cleared.
fn in_order(flight: &Flight, pulled_up: &[&str]) {
    let outputs = &flight.board.run.outputs;
    assert_eq!(outputs.len(), 12);
    for output in outputs {
        assert_eq!(
            output.pulled_up,
            pulled_up.contains(&output.what.as_str()),
            "{output:?}"
        );
    }
    for what in ["motor", "servo", "buzzer", "select"] {
        let longest = longest_us(outputs, what);
        assert!(
            longest > 0.0 && longest <= LIMIT_US,
            "{what}: {longest} us, at most {LIMIT_US}"
        );
    }
    assert!(
        flight.board.run.servos.iter().all(|us| *us > 0.0),
        "{:?}",
        flight.board.run.servos
    );
}

#[test]
fn no_output_of_the_matek_but_its_buzzer_is_pulled_up_at_a_reset() {
    let flight = restarted(|scenario, troubles| fly(scenario, 1.0, troubles));
    in_order(&flight, &["buzzer"]);
}

#[test]
fn no_output_of_the_small_board_is_pulled_up_at_a_reset() {
    let flight = restarted(fly_small);
    in_order(&flight, &[]);
}
