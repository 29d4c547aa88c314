//! Instructions of the control path on the flashed images (docs/cost.md).

use sophie_emulator::chain::Window;

use super::*;

/// Most instructions of a step, from sensor transfer to motor frame: 4,621, and by the phase of the start the interrupts of
/// one alarm and one serial line, 503.
const MOST: u64 = 5150;
/// The F405's core lacks float minimum and selection.
const MOST_SMALL: u64 = 5250;
/// Most of the step that is the median of 40, into which no other interrupt falls: growth of the laws shows here.
const USUAL: u64 = 4650;
const USUAL_SMALL: u64 = 4980;
const STEPS: usize = 40;

/// Requires at most `most` instructions per step, and `usual` in half of them, from sensor transfer to motor frame, and a function for each.
fn executes(image: &Path, board: &str, (usual, most): (u64, u64)) {
    let mut firmware = Firmware::read(image, board_kind::find(board).unwrap()).unwrap();
    firmware.count = Some(Window {
        from_ms: (AIRBORNE * 1e3) as u64,
        steps: STEPS,
    });
    let flight = fly_image(&firmware, &hover(AIRBORNE + 0.3), 1.0, &[]);
    assert_eq!(flight.gaps, [], "{}", log(&flight));
    let counted = &flight.board.run.counted;
    assert_eq!(counted.steps.len(), STEPS, "{}", log(&flight));
    for step in &counted.steps {
        assert_eq!(step.acting.values().sum::<u64>(), step.passed);
    }
    let mut sums: Vec<u64> = counted
        .steps
        .iter()
        .map(|step| step.acting.values().sum())
        .collect();
    sums.sort_unstable();
    let median = sums[STEPS / 2];
    assert!(
        median <= usual,
        "{board}: {median} in half of the steps, {sums:?}"
    );
    let acting = counted.acting();
    // The laws alone exceed this.
    assert!(acting.mean > 1500.0 && acting.most <= most, "{board}: {acting:?}");
}

#[test]
fn the_control_path_keeps_its_budget() {
    executes(image(), "matek-h743", (USUAL, MOST));
}

#[test]
fn the_control_path_keeps_its_budget_on_the_small_board() {
    executes(small_image(), "f405", (USUAL_SMALL, MOST_SMALL));
}
