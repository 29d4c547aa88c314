//! The `sophie` command: exit status, one line per mistake, nothing half-written.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use sophie_test_support::command::{Temp, command, refused, sophie, text};

fn names(temp: &Temp) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(&temp.0)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

const HOP: &[u8] =
    b"steps = [{ do = 'arm' }, { do = 'take-off', height_m = 1 }, { do = 'land' }, { do = 'disarm' }]\n";

#[test]
fn options_out_of_range_are_refused_in_one_line() {
    let temp = Temp::new("options");
    let line = refused(&temp, &["--infill", "3.5"]);
    assert_eq!(
        line,
        "sophie: invalid value '3.5' for '--rho <PERCENT>': allowed 4 to 10 %"
    );
    for args in [
        &["fly", "--rho", "11"][..],
        &["--gain-k", "0.5"],
        &["--gain-k", "nan"],
        &["--config", "C"],
        &["--mixer", "soft"],
        &["--arms", "3"],
        &["--seed", "-1"],
        &["--seed", "1.5"],
        &["--nonsense"],
        &["--infill"],
        &["one.toml", "two.toml"],
        &["fly", "fly", "fly"],
    ] {
        refused(&temp, args);
    }
}

#[test]
fn bad_files_are_refused_in_one_line_that_names_them() {
    let temp = Temp::new("files");
    for (content, message) in [
        (
            &b"[vehicle]\ninfill = 3.5"[..],
            ":2: vehicle.infill = 3.5: allowed 4 to 10 %",
        ),
        (
            b"[vehicle]\ninfil = 6",
            ":2: vehicle.infil = 6: unknown key: nearest allowed vehicle.infill",
        ),
        (
            b"steps = []",
            ":1: steps = []: allowed at least one step, such as arm",
        ),
        (b"seed = ", ":1: not valid TOML: "),
        (b"\xff\xfe", ":1: not UTF-8 text"),
        (
            b"steps = [{ do = 'perch' }]",
            ":1: steps[0] = perch: allowed only touching the pipe",
        ),
        (
            b"[params]\nrate_pitch_p = 1e9",
            ":2: params.rate_pitch_p = 1e9: allowed 0 to ",
        ),
    ] {
        let file = temp.file("bad.toml", content);
        let line = refused(&temp, &[&file]);
        assert!(line.starts_with(&format!("sophie: {file}{message}")), "{line}");
    }
    let line = refused(&temp, &["missing.toml"]);
    assert!(
        line.starts_with("sophie: missing.toml: cannot be read: No such file"),
        "{line}"
    );
    let line = refused(&temp, &["."]);
    assert!(line.contains(".: cannot be read: it is a directory"), "{line}");
}

#[cfg(target_os = "linux")]
#[test]
fn input_without_an_end_is_refused() {
    let temp = Temp::new("endless");
    let log = temp.file("log.bin", &[0, 1, 2, 0xff]);
    let bench = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/arm-bench.csv");
    for args in [
        &["check", "/dev/zero"][..],
        &["fit-arm", "/dev/zero"],
        &["fit-arm", bench, "--tendon", "/dev/zero"],
        &["timing", "/dev/zero"],
        &["timing", &log, "--elf", "/dev/zero"],
        &["fly", "--live", "--pilot", "none", "--mavlink-key", "/dev/zero"],
    ] {
        let line = refused(&temp, args);
        assert!(
            line.starts_with("sophie: /dev/zero: cannot be read: it is longer than "),
            "{line}"
        );
    }
}

#[test]
fn a_line_without_an_end_is_not_shown_whole() {
    let temp = Temp::new("long-line");
    let bench = temp.file("bench.csv", &[b'x'; 1 << 20]);
    let output = sophie(&temp, &["fit-arm", &bench]);
    let line = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(line.lines().count(), 1);
    assert!(line.starts_with(&format!("sophie: {bench}:1: column 'xxx")) && line.ends_with("…\n"));
    assert!(line.len() < 10_000, "{} bytes", line.len());
}

#[test]
fn an_unwritable_directory_is_told_before_the_flight() {
    let temp = Temp::new("unwritable");
    let file = temp.file("taken", b"");
    for out in [file.clone(), format!("{file}/below")] {
        let line = refused(&temp, &["--out", &out]);
        assert!(
            line.starts_with(&format!("sophie: --out {out}: cannot be written: ")),
            "{line}"
        );
    }
    assert_eq!(names(&temp), ["taken"]);
}

#[test]
fn a_directory_in_a_file_s_place_is_told_before_the_flight() {
    let temp = Temp::new("taken");
    for name in ["report.html", "flight.mcap", "summary.json"] {
        fs::create_dir_all(temp.0.join("kept").join(name)).unwrap();
        let line = refused(&temp, &["--out", "kept"]);
        assert_eq!(
            line,
            format!(
                "sophie: --out kept/{name}: cannot be written: it is a directory: allowed is a file or nothing"
            )
        );
        fs::remove_dir(temp.0.join("kept").join(name)).unwrap();
    }
    assert_eq!(fs::read_dir(temp.0.join("kept")).unwrap().count(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stdout_is_an_error() {
    let temp = Temp::new("full");
    let hop = temp.file("hop.toml", HOP);
    for args in [&[&*hop, "--json"][..], &[&hop], &["--help"]] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command(&temp.0, args).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let printed = text(&output.stderr);
        assert!(
            printed
                .lines()
                .last()
                .unwrap()
                .starts_with("sophie: stdout: cannot be written: "),
            "{args:?}: {printed}"
        );
    }
}

#[test]
fn a_bad_scenario_leaves_an_old_report_alone() {
    let temp = Temp::new("old");
    fs::create_dir(temp.0.join("kept")).unwrap();
    let old = temp.file("kept/report.html", b"old");
    let bad = temp.file("bad.toml", b"seed = -1");
    refused(&temp, &[&bad, "--out", "kept"]);
    assert_eq!(fs::read(old).unwrap(), b"old");
}

#[test]
fn help_and_version_are_on_stdout() {
    let temp = Temp::new("help");
    for args in [&["--help"][..], &["fly", "--help"], &["--version"]] {
        let output = sophie(&temp, args);
        assert!(output.status.success() && output.stderr.is_empty(), "{args:?}");
        assert!(text(&output.stdout).contains("sophie") || text(&output.stdout).contains("--infill"));
    }
}

/// Requires success and empty stderr.
fn shown(temp: &Temp, args: &[&str]) -> String {
    let output = sophie(temp, args);
    let complaints = text(&output.stderr);
    assert!(
        output.status.success() && complaints.is_empty(),
        "{args:?}: {complaints}"
    );
    text(&output.stdout)
}

#[test]
fn help_is_a_word_and_an_option_everywhere() {
    let temp = Temp::new("help-words");
    let whole = shown(&temp, &["--help"]);
    assert_eq!(shown(&temp, &["help"]), whole);
    for (verb, part) in [
        ("fly", "--infill"),
        ("check", "--infill"),
        ("capture", "--touches"),
        ("study", "vehicles"),
        ("paper", "paper.html"),
        ("fit-arm", "tilt_deg"),
        ("timing", "--analyse"),
        ("recording", "--truth"),
    ] {
        assert!(whole.contains(verb), "{verb}: {whole}");
        let long = shown(&temp, &[verb, "--help"]);
        assert!(
            long.contains(part) && long.contains("Exit status: 0"),
            "{verb}: {long}"
        );
        assert_eq!(shown(&temp, &["help", verb]), long);
        assert!(!shown(&temp, &[verb, "-h"]).is_empty());
    }
    for args in [
        &["help", "perch"][..],
        &["help", "fly", "now"],
        &["help", "--rho"],
    ] {
        let line = refused(&temp, args);
        assert!(
            line.starts_with("sophie: ") && line.contains(args.last().unwrap()) && !line.contains("Usage"),
            "{line}"
        );
    }
    assert_eq!(
        refused(&temp, &["help", "perch"]),
        "sophie: no help on 'perch': allowed are fly, check, bringup, params, capture, study, paper, fit-arm, fit-thrust, fit-lag, fit-tendon, timing, recording"
    );
}

/// Recursively.
fn below(path: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(path)
        .into_iter()
        .flatten()
        .map(|e| e.unwrap().path());
    entries
        .flat_map(|p| [vec![p.clone()], below(&p)].concat())
        .collect()
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing_behind() {
    let temp = Temp::new("interrupt");
    // The flight outlasts the signal on a busy machine.
    let long = b"steps = [{ do = 'arm' }, { do = 'take-off' }, { do = 'fly-to-pipe' }, { do = 'touch' }, { do = 'clamp' }, \
                 { do = 'perch' }, { do = 'hold', seconds = 600 }, { do = 'hold', seconds = 600 }, \
                 { do = 'hold', seconds = 600 }, { do = 'hold', seconds = 600 }]\ntime_limit_s = 3000\n";
    let long = temp.file("long.toml", long);
    for args in [
        &["fly", &*long, "--out", "deep/out"][..],
        &["paper", "--out", "deep/out"],
    ] {
        let mut child = command(&temp.0, args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = String::new();
        let mut lines = BufReader::new(child.stdout.take().unwrap());
        while first.trim().is_empty() {
            assert!(lines.read_line(&mut first).unwrap() > 0, "{args:?} said nothing");
        }
        // Background jobs of a script ignore SIGINT.
        let status = Command::new("kill")
            .args(["-TERM", &child.id().to_string()])
            .status()
            .unwrap();
        assert!(status.success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            output.status.code(),
            None,
            "{args:?} was not interrupted: {}",
            text(&output.stderr)
        );
        assert_eq!(below(&temp.0), [PathBuf::from(&long)], "{args:?}");
    }
}

#[test]
fn a_flight_writes_three_files_and_says_where() {
    let temp = Temp::new("hop");
    let hop = temp.file("hop.toml", HOP);
    let output = sophie(&temp, &["fly", &hop, "--seed", "5"]);
    let printed = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{printed}{}", text(&output.stderr));
    assert!(
        output.stderr.is_empty() && !printed.contains('\x1b'),
        "plain lines where no terminal is: {printed}"
    );
    for part in [
        "seed 5",
        "1/4 arm",
        "4/4 disarm",
        "accomplished: ",
        "out/report.html",
    ] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
    let out = temp.0.join("out");
    let mut names: Vec<_> = fs::read_dir(&out)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["flight.mcap", "report.html", "summary.json"]);
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(
        (&summary["accomplished"], &summary["seed"]),
        (&true.into(), &5.into())
    );
    assert_eq!(summary["scenario"], "hop");
}

#[test]
fn json_has_stdout_to_itself() {
    let temp = Temp::new("json");
    let hop = temp.file("hop.toml", HOP);
    let output = sophie(&temp, &[&hop, "--json", "--infill", "8"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["settings"]["infill_percent"], 8.0);
    assert!(text(&output.stderr).contains("1/4 arm"));
    assert_eq!(
        text(&output.stdout),
        fs::read_to_string(temp.0.join("out/summary.json")).unwrap()
    );
}

#[test]
fn without_files_a_flight_prints_the_same_and_leaves_nothing() {
    let temp = Temp::new("no-files");
    let hop = temp.file("hop.toml", HOP);
    let summary = |args: &[&str]| -> serde_json::Value {
        let output = sophie(&temp, &[&[&*hop, "--json"], args].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let mut summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(summary["wall_seconds"].take().is_number());
        summary
    };
    let line = refused(&temp, &[&hop, "--no-files", "--out", "x"]);
    assert!(line.contains("--no-files") && line.contains("--out"), "{line}");
    let bare = summary(&["--no-files"]);
    assert_eq!(below(&temp.0), [PathBuf::from(&hop)]);
    assert_eq!(bare, summary(&[]));
    let printed = shown(&temp, &[&hop, "--no-files"]);
    assert!(
        printed.contains("4/4 disarm") && printed.contains("accomplished: "),
        "{printed}"
    );
    assert!(!printed.contains("written: "), "{printed}");
}

#[test]
fn a_mission_that_fails_ends_with_1_and_the_reason() {
    let temp = Temp::new("fail");
    let late = temp.file("late.toml", &[b"time_limit_s = 3\n", HOP].concat());
    let output = sophie(&temp, &[&late]);
    assert_eq!(output.status.code(), Some(1));
    let printed = text(&output.stderr);
    assert!(
        printed.starts_with("sophie: not accomplished: ") && printed.lines().count() == 1,
        "{printed}"
    );
    assert!(text(&output.stdout).contains("NOT accomplished"));
    let summary = fs::read_to_string(temp.0.join("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["accomplished"], false);
    assert!(printed.contains(summary["reason"].as_str().unwrap()));
}

#[test]
fn a_reader_that_leaves_does_not_stop_the_flight() {
    let temp = Temp::new("pipe");
    let hop = temp.file("hop.toml", HOP);
    let mut child = command(&temp.0, &[&hop])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut first)
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(first.starts_with("hop: "), "{first}");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty() && temp.0.join("out/report.html").exists());
}

/// A log of the emulated board with the executors' trace, for `sophie timing`.
fn board_log() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/timing/trace.txt")
}

#[test]
fn a_board_s_log_becomes_tables_a_page_and_a_sheet() {
    let temp = Temp::new("timing");
    let log = board_log().display().to_string();
    let output = sophie(&temp, &["timing", &log, "--analyse", "--out", "there"]);
    let (printed, complaints) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success() && complaints.is_empty(), "{complaints}");
    for part in [
        "data-ready to motor frame",
        "executors idle",
        "f405",
        "there/timing.csv",
    ] {
        assert!(printed.contains(part), "no {part} in {printed}");
    }
    let page = fs::read_to_string(temp.0.join("there/timing.html")).unwrap();
    assert!(page.contains("mixer") && page.ends_with("</html>\n"));
    let sheet = fs::read_to_string(temp.0.join("there/timing.csv")).unwrap();
    assert!(sheet.lines().count() > 300);
}

#[test]
fn a_board_s_log_that_is_cut_off_is_read_and_the_loss_told() {
    let temp = Temp::new("cut-log");
    let whole = fs::read(board_log()).unwrap();
    let cut = temp.file("cut.txt", &whole[..whole.len() - 5]);
    let output = sophie(&temp, &["timing", &cut]);
    let complaints = text(&output.stderr);
    assert!(
        output.status.success() && complaints.lines().count() == 1,
        "{complaints}"
    );
    assert!(text(&output.stdout).contains("data-ready to motor frame"));
}

#[test]
fn what_is_no_board_s_log_is_refused() {
    let temp = Temp::new("no-log");
    let text = temp.file("notes.txt", b"a line of something else\n");
    let bytes = temp.file("raw.bin", &[0, 1, 2, 0xff]);
    assert!(refused(&temp, &["timing", &text]).contains("notes.txt"));
    assert!(refused(&temp, &["timing", &bytes]).contains("raw.bin"));
    assert!(refused(&temp, &["timing", "nowhere.txt"]).contains("nowhere.txt"));
    assert!(refused(&temp, &["timing", &bytes, "--elf", &text]).contains("notes.txt"));
}
