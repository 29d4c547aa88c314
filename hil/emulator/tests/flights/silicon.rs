//! Start-up checks of the chip, and failed clocks.

use sophie_emulator::silicon::{self, SiliconCheck};
use sophie_emulator::wires::BoardFault;

use super::*;

/// With the logged state of their caches.
const BOARDS: [(&str, [&str; 2]); 2] = [
    ("matek-h743", ["caches", "I+ D-"]),
    ("f405", ["flash acceleration", "prefetch+ I+ D+"]),
];

/// `seconds` s disarmed on the ground, with `fault` from before the first instruction.
fn on_the_bench(board: &str, seconds: f64, fault: Option<BoardFault>) -> Flight {
    let scenario = Scenario {
        time_limit: seconds,
        ..scenario("hover.toml")
    };
    let silent = (0.0, Trouble::RadioSilent(true));
    let troubles: Vec<_> = fault
        .map(|fault| (0.0, Trouble::Board(fault)))
        .into_iter()
        .chain([silent])
        .collect();
    match board {
        "f405" => fly_small(&scenario, &troubles),
        _ => fly(&scenario, 1.0, &troubles),
    }
}

fn checks(flight: &Flight) -> Vec<SiliconCheck> {
    let lines = flight.board.lines.iter();
    lines.filter_map(|line| silicon::parse(&line.text)).collect()
}

fn check(flight: &Flight, name: &str) -> SiliconCheck {
    let all = checks(flight);
    let found = all.iter().find(|check| check.name == name);
    found
        .unwrap_or_else(|| panic!("no {name}: {}", log(flight)))
        .clone()
}

#[test]
fn every_start_up_check_of_a_sound_chip_passes() {
    for (board, [caches, on]) in BOARDS {
        let flight = on_the_bench(board, 1.5, None);
        let all = checks(&flight);
        assert!(
            all.len() >= 8 && all.iter().all(|check| check.ok),
            "{board}: {all:#?}"
        );
        assert_eq!(check(&flight, caches).read, on, "{board}");
        assert_eq!(check(&flight, "brown-out level").read, "3", "{board}");
        assert_eq!(flight.gaps, [], "{board}");
    }
}

#[test]
fn a_chip_without_a_brown_out_level_does_not_arm() {
    for (board, _) in BOARDS {
        let flight = on_the_bench(board, 1.5, Some(BoardFault::FactoryOptions));
        let level = check(&flight, "brown-out level");
        assert_eq!((level.read.as_str(), level.ok), ("0", false), "{board}");
        assert!(
            logged_at(&flight, 0.0, "arming blocked: brown-out level not set").is_some(),
            "{board}: {}",
            log(&flight)
        );
        assert_eq!(flight.gaps, [], "{board}");
    }
}

#[test]
fn a_first_revision_flies_without_prefetch_or_not_at_all() {
    let flight = on_the_bench("f405", 1.5, Some(BoardFault::FirstRevision));
    let caches = check(&flight, "flash acceleration");
    assert_eq!((caches.read.as_str(), caches.ok), ("prefetch- I+ D+", true));
    assert_eq!(
        logged_at(&flight, 0.0, "chip not as expected"),
        None,
        "{}",
        log(&flight)
    );

    let flight = on_the_bench("matek-h743", 1.5, Some(BoardFault::FirstRevision));
    let revision = check(&flight, "revision");
    assert_eq!((revision.read.as_str(), revision.ok), ("0x450 0x1003", false));
    assert!(
        logged_at(&flight, 0.0, "arming blocked: chip not as expected").is_some(),
        "{}",
        log(&flight)
    );
}

#[test]
fn parameters_of_another_firmware_are_named_with_a_remedy() {
    // The emulated F405's flash cannot be written.
    let flight = on_the_bench("matek-h743", 1.5, Some(BoardFault::ForeignParameters));
    for words in [
        "the storage holds ArduPilot's data; 'save' at the console replaces them",
        "arming blocked: storage holds another firmware's data",
    ] {
        assert!(
            logged_at(&flight, 0.0, words).is_some(),
            "{words}: {}",
            log(&flight)
        );
    }
    assert_eq!(logged_at(&flight, 0.0, "unreadable"), None, "{}", log(&flight));
    assert_eq!(check(&flight, "stored data of").read, "ArduPilot");
}

/// Requires a message and repeated resets, motor pins low.
fn never_starts(board: &str, fault: BoardFault, message: &str, by: &str) {
    let flight = on_the_bench(board, 1.2, Some(fault));
    assert!(
        logged_at(&flight, 0.0, message).is_some(),
        "{board} {fault:?}: {}",
        log(&flight)
    );
    let resets = &flight.board.resets;
    assert!(
        !resets.is_empty() && resets.iter().all(|(_, cause)| cause.contains(by)),
        "{board} {fault:?}: {resets:?}"
    );
    assert_eq!(logged_at(&flight, 0.0, "started in"), None, "{board} {fault:?}");
    assert!(flight.board.run.escs.iter().all(|esc| esc.frames == 0));
    assert_eq!(flight.gaps, [], "{board} {fault:?}");
}

#[test]
fn a_start_by_the_chips_loader_begins_with_one_reset() {
    for (board, _) in BOARDS {
        let flight = on_the_bench(board, 1.5, Some(BoardFault::LoaderClocks(false)));
        let [(ms, cause)] = &flight.board.resets[..] else {
            panic!("{board}: {:?}\n{}", flight.board.resets, log(&flight))
        };
        assert!(*ms < 1.0 && cause == "Core", "{board}: {ms} {cause}");
        assert!(
            logged_at(&flight, 0.0, "start after Software").is_some(),
            "{board}"
        );
        assert!(
            logged_at(&flight, 0.0, "started in").is_some(),
            "{board}: {}",
            log(&flight)
        );
        assert!(checks(&flight).iter().all(|check| check.ok), "{board}");
        // On the H7 a PLL that runs refuses its dividers, which would be listed here.
        assert_eq!(flight.gaps, [], "{board}");
    }
}

#[test]
fn clocks_that_outlive_a_reset_are_reset_once() {
    // The F405 stops its PLL before it sets it, so it flies.
    let flight = on_the_bench("f405", 1.5, Some(BoardFault::LoaderClocks(true)));
    assert_eq!(flight.board.resets.len(), 1, "{:?}", flight.board.resets);
    assert!(
        logged_at(&flight, 0.0, "started in").is_some(),
        "{}",
        log(&flight)
    );
    assert_eq!(flight.gaps, []);
}

#[test]
fn a_crystal_that_does_not_start_is_reported_and_resets_the_board() {
    let message = "previous run ended with: the 8 MHz crystal does not start";
    never_starts("f405", BoardFault::NoCrystal, message, "IWDG");
}

#[test]
fn a_pll_that_never_locks_is_reported_and_ends_by_the_watchdog() {
    let message = "previous run ended with: the clocks did not start: a PLL does not lock";
    never_starts("f405", BoardFault::NoPll, message, "IWDG");
}
