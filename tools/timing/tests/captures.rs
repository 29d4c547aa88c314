//! Captures of docs/timing, from file to tables.

use std::path::{Path, PathBuf};

use sophie_timing::analyse::analyse;
use sophie_timing::capture::Capture;
use sophie_timing::replay::Replay;
use sophie_timing::{csv, page, table};

fn capture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../docs/timing")
        .join(name)
}

fn file(name: &str, content: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("sophie-timing-{}-{name}", std::process::id()));
    std::fs::write(&path, content).unwrap();
    path
}

#[test]
fn a_flight_keeps_every_deadline() {
    let capture = Capture::read(&capture("perch-short.txt"), None).unwrap();
    assert_eq!(capture.board.as_deref(), Some("matek-h743"));
    assert!(capture.incomplete.is_none());
    assert_eq!(capture.tasks.len(), 13);
    assert!(capture.tasks.iter().all(|t| t.missed() == 0));
    let mixer = capture.tasks.iter().find(|t| t.name == "mixer").unwrap();
    assert!((mixer.rate() - 1000.0).abs() < 1.0, "{}", mixer.rate());
    assert!(
        capture
            .chain
            .iter()
            .all(|c| (10..=20).contains(&c.min) && c.times.max <= 20)
    );
    let text = analyse(&capture, &Replay::default());
    assert!(text.contains("servos (each 20000 us) is above arms"), "{text}");
}

#[test]
fn a_trace_becomes_tables_a_timeline_and_a_sheet() {
    let capture = Capture::read(&capture("trace.txt"), None).unwrap();
    let replay = Replay::of(&capture.trace);
    assert_eq!((capture.trace.lost, replay.tasks.len()), (0, 17));
    let of = |name: &str| replay.tasks.iter().find(|t| t.name == name).unwrap();
    let period = |name| of(name).periods().mean().unwrap();
    assert!((period("imu") - 250.0).abs() < 1.0 && (period("mixer") - 1000.0).abs() < 1.0);
    assert!(replay.idle as f64 > 0.7 * replay.covered as f64);
    // Only more urgent levels preempt.
    for (victim, by) in replay.preemptions.keys() {
        assert!(replay.tasks[*by].level < replay.tasks[*victim].level);
    }
    let tables = table::tables(&capture, &replay) + &analyse(&capture, &replay);
    assert!(tables.contains("executors idle") && tables.contains("f405"));
    let html = page::html(&capture, &replay, &tables);
    assert!(html.contains("<canvas") && !html.contains("http"));
    let sheet = csv::csv(&capture, &replay);
    let runs: usize = replay.tasks.iter().map(|t| t.runs.len()).sum();
    assert_eq!(sheet.lines().count(), 1 + runs);
    assert!(sheet.lines().all(|l| l.split(',').count() == 8));
}

/// Cells without ticks.
fn rows(lines: &[&str]) -> Vec<Vec<String>> {
    let cell = |c: &str| c.trim().replace(['`', ','], "");
    lines
        .iter()
        .map(|l| l.trim_matches('|').split('|').map(cell).collect())
        .collect()
}

#[test]
fn the_page_s_bounds_are_those_of_the_traces_beside_it() {
    let page = std::fs::read_to_string(capture("../timing.md")).unwrap();
    let (_, section) = page.split_once("## Would every deadline hold?").unwrap();
    let table: Vec<&str> = section
        .lines()
        .skip_while(|l| !l.starts_with("| task"))
        .take_while(|l| l.starts_with('|'))
        .collect();
    let table = rows(&table);
    let (head, body) = (&table[0], &table[2..]);
    assert_eq!(head[..2], ["task", "deadline us"]);
    assert!(head.len() > 2 && body.len() > 5);
    for (column, title) in head.iter().enumerate().skip(2) {
        // `f405` of `trace-f405.txt`.
        let (board, trace) = title
            .split_once(" of ")
            .unwrap_or_else(|| panic!("of which trace is {title}?"));
        let log = Capture::read(&capture(trace), None).unwrap();
        let message = analyse(&log, &Replay::of(&log.trace));
        let boards = message.lines().find(|l| l.starts_with("task ")).unwrap();
        // A column ends with its title, to which "scaled" belongs.
        let boards = boards.replace(", scaled", "--scaled");
        let titles: Vec<&str> = boards.split_whitespace().skip(5).collect();
        let at = titles
            .iter()
            .position(|t| t.trim_end_matches("--scaled") == board.trim_end_matches(" scaled"))
            .unwrap();
        assert_eq!(
            titles[at].ends_with("--scaled"),
            board.ends_with(" scaled"),
            "{title}"
        );
        for row in body {
            let line = message
                .lines()
                .find(|l| l.split_whitespace().next() == Some(&*row[0]))
                .unwrap();
            assert_eq!(line.split_whitespace().nth(4), Some(&*row[1]), "{line}");
            // Bounds behind the five columns: `226 (-13 %)` or `none`.
            let bounds: Vec<&str> = line
                .split("  ")
                .map(str::trim)
                .filter(|c| !c.is_empty())
                .collect();
            let bound = bounds[bounds.len() - titles.len() + at].replace('+', "");
            assert_eq!(row[column].replace('\u{2212}', "-"), bound, "{title}, {}", row[0]);
        }
    }
}

#[test]
fn a_capture_that_is_cut_off_is_read_as_far_as_it_goes() {
    for name in ["perch-short.txt", "trace.txt"] {
        let whole = std::fs::read(capture(name)).unwrap();
        for share in 1..20 {
            let end = whole.len() * share / 20;
            let path = file(name, &whole[..end]);
            match Capture::read(&path, None) {
                Ok(capture) => {
                    let cut = whole[end - 1] != b'\n';
                    assert_eq!(capture.incomplete.is_some(), cut);
                    let message = capture.incomplete.unwrap_or_default();
                    assert!(!message.contains('\n'), "{message}");
                }
                Err(line) => assert!(!line.contains('\n'), "{line}"),
            }
            std::fs::remove_file(path).unwrap();
        }
    }
}

#[test]
fn lines_that_were_lost_are_told() {
    let whole = std::fs::read_to_string(capture("trace.txt")).unwrap();
    let kept = whole.lines().enumerate().filter(|(n, _)| *n != 400);
    let text: String = kept.map(|(_, line)| format!("{line}\n")).collect();
    let path = file("lost.txt", text.as_bytes());
    let capture = Capture::read(&path, None).unwrap();
    std::fs::remove_file(path).unwrap();
    assert_eq!(capture.trace.lost, 6);
    assert!(
        capture
            .incomplete
            .unwrap()
            .contains("6 events of the trace are lost")
    );
}

#[test]
fn what_is_no_capture_is_refused_in_one_line() {
    let image = file("no-elf", b"no image");
    for (content, message) in [
        (&b""[..], "is empty"),
        (b"0.1 INFO DISARMED\n", "none of a task's timing"),
        (&[0, 1, 2, 0xff], "is no text"),
    ] {
        let path = file("bad", content);
        let line = Capture::read(&path, None).unwrap_err();
        assert!(line.contains(message) && !line.contains('\n'), "{line}");
        std::fs::remove_file(path).unwrap();
    }
    let bytes = file("raw", &[0, 1, 2, 0xff]);
    assert!(Capture::read(&bytes, Some(&image)).is_err());
    assert!(Capture::read(Path::new("/nowhere"), None).is_err());
    std::fs::remove_file(bytes).unwrap();
    std::fs::remove_file(image).unwrap();
}

#[test]
fn a_log_of_two_starts_loses_nothing() {
    let once = std::fs::read(capture("trace.txt")).unwrap();
    let path = file("twice.txt", &[once.clone(), once].concat());
    let capture = Capture::read(&path, None).unwrap();
    std::fs::remove_file(path).unwrap();
    assert_eq!((capture.trace.lost, capture.trace.starts), (0, 2));
    assert!(capture.incomplete.is_none());
    assert!(
        capture.notes[0].contains("2 starts of the board"),
        "{}",
        capture.notes[0]
    );
    // As one start alone, twice.
    let half = capture.trace.events.len() / 2;
    let (first, second) = (&capture.trace.events[0], &capture.trace.events[half]);
    assert!((1..60_000_000).contains(&(second.at - first.at)), "{}", second.at);
    let replay = Replay::of(&capture.trace);
    assert!(replay.idle as f64 > 0.7 * replay.covered as f64);
}

#[test]
fn line_noise_costs_its_lines_alone() {
    let mut log = std::fs::read(capture("trace.txt")).unwrap();
    log.splice(90_000..90_000, *b"\xff\xfe\0");
    let path = file("noise.txt", &log);
    let capture = Capture::read(&path, None).unwrap();
    std::fs::remove_file(path).unwrap();
    let incomplete = capture.incomplete.unwrap();
    assert!(
        incomplete.contains("a line with unreadable bytes is left out"),
        "{incomplete}"
    );
    assert!(capture.trace.lost < 20, "{incomplete}");
}

#[test]
fn a_log_that_powershell_wrote_is_read() {
    let log = std::fs::read_to_string(capture("perch-short.txt")).unwrap();
    let words = std::iter::once(0xfeff).chain(log.encode_utf16());
    let bytes: Vec<u8> = words.flat_map(u16::to_le_bytes).collect();
    let path = file("utf16.txt", &bytes);
    let capture = Capture::read(&path, None).unwrap();
    std::fs::remove_file(path).unwrap();
    assert_eq!((capture.tasks.len(), capture.incomplete), (13, None));
    assert!(capture.notes[0].contains("UTF-16"), "{}", capture.notes[0]);
}
