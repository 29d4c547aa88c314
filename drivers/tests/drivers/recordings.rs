//! Bytes that real receivers sent, through the decoder that flies. The recordings are not of this tree
//! (docs/tests.md): `SOPHIE_RECORDINGS` names their folder.

use std::path::PathBuf;

use embassy_time::{Duration, Instant};
use sophie_drivers::sbus;
use sophie_ports::receiver::RcDecoder;

/// The bytes of a recording with their times: a line each, `time_us byte`. `None` without the folder.
fn recording(name: &str) -> Option<Vec<(Instant, u8)>> {
    let Some(folder) = std::env::var_os("SOPHIE_RECORDINGS") else {
        println!("skipped: SOPHIE_RECORDINGS, the folder of {name}, is not set");
        return None;
    };
    let path = PathBuf::from(folder).join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let line = |line: &str| {
        let (us, byte) = line.split_once(' ')?;
        Some((Instant::from_micros(us.parse().ok()?), byte.parse().ok()?))
    };
    let bytes: Vec<_> = text
        .lines()
        .map(|text| line(text).unwrap_or_else(|| panic!("{}: {text}", path.display())))
        .collect();
    assert!(!bytes.is_empty(), "{}: empty", path.display());
    Some(bytes)
}

/// An R7008SB of Futaba with telemetry: 32 whole frames, 15 ms apart, its voltage in a slot after each fourth; one frame
/// more lacks a byte.
#[test]
fn a_receiver_with_telemetry_is_heard() {
    let Some(bytes) = recording("sbus2-r7008sb.txt") else {
        return;
    };
    let mut decoder = sbus::Decoder::new();
    let (mut published, mut longest, mut last) = (0, Duration::MIN, None);
    for (at, byte) in bytes {
        if decoder.take(&[byte], at).is_some() {
            published += 1;
            longest = longest.max(last.map_or(Duration::MIN, |last| at - last));
            last = Some(at);
        }
    }
    println!(
        "{published} frames published, {} ms apart at most",
        longest.as_millis()
    );
    assert!(published >= 28 && longest.as_millis() <= 60);
}
