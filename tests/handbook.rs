//! Links and names of sources in the pages exist, the handbook lists every page, and short pages are short.

mod pages;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pages::{Page, faults};
use sophie_control::params::Params;

/// Pages outside `docs/`.
const OUTSIDE: [&str; 3] = ["README.md", "CONTRIBUTING.md", "hil/README.md"];
/// Words read in ten minutes, at 200 a minute.
const SHORT: usize = 2000;
const README_LINES: usize = 90;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// By path from the root.
fn all() -> BTreeMap<PathBuf, Page> {
    let docs = std::fs::read_dir(root().join("docs")).unwrap();
    let docs = docs.map(|entry| Path::new("docs").join(entry.unwrap().file_name()));
    let pages = docs.filter(|path| path.extension().is_some_and(|e| e == "md"));
    pages
        .chain(OUTSIDE.map(PathBuf::from))
        .map(|path| {
            let text = std::fs::read_to_string(root().join(&path)).unwrap();
            (path, Page::read(&text))
        })
        .collect()
}

#[test]
fn every_link_and_every_source_that_a_page_names_exists() {
    let found = faults(&all(), |path| root().join(path).exists());
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn a_broken_link_a_broken_anchor_and_a_missing_source_are_named() {
    let one = "# One page\n\n## The *first* `part`, twice\n\n## The first part, twice\n\n\
               [a](two.md) [b](two.md#there) [c](#the-first-part-twice) [d](#the-first-part-twice-1) `src/there.rs`\n";
    let two = "# Two\n\n## There\n";
    let pages = |one: &str| {
        BTreeMap::from([
            (PathBuf::from("docs/one.md"), Page::read(one)),
            (PathBuf::from("docs/two.md"), Page::read(two)),
        ])
    };
    let exists = |path: &Path| {
        ["docs/two.md", "src/there.rs"]
            .iter()
            .any(|p| Path::new(p) == path)
    };
    assert_eq!(faults(&pages(one), exists), [] as [&str; 0]);
    for (broken, fault) in [
        ("[x](three.md)", "docs/one.md: three.md: no such file"),
        ("![x](drawing.svg)", "docs/one.md: drawing.svg: no such file"),
        (
            "[x](two.md#nowhere)",
            "docs/one.md: two.md#nowhere: no such heading",
        ),
        ("[x](#nowhere)", "docs/one.md: #nowhere: no such heading"),
        (
            "[x](#the-first-part-twice-2)",
            "docs/one.md: #the-first-part-twice-2: no such heading",
        ),
        ("`src/gone.rs`", "docs/one.md: `src/gone.rs`: no such file"),
        ("[x](two.md#There)", "docs/one.md: two.md#There: no such heading"),
    ] {
        assert_eq!(faults(&pages(&format!("{one}\n{broken}\n")), exists), [fault]);
    }
}

#[test]
fn every_page_of_the_folder_is_in_the_handbook() {
    let pages = all();
    let contents = &pages[Path::new("docs/SUMMARY.md")];
    for path in pages.keys() {
        let Ok(name) = path.strip_prefix("docs") else {
            continue;
        };
        let listed = contents.links.iter().any(|link| Path::new(link) == name);
        assert!(listed || name == "SUMMARY.md", "docs/SUMMARY.md lacks {name:?}");
    }
}

#[test]
fn the_pages_that_are_read_in_one_go_are_short() {
    let pages = all();
    for name in ["docs/pilot.md", "docs/first-hour.md"] {
        let words = pages[Path::new(name)].words;
        println!("{name}: {words} words");
        assert!(
            (200..=SHORT).contains(&words),
            "{name}: {words} words: allowed are {SHORT}"
        );
    }
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let lines = readme.lines().count();
    assert!(
        lines <= README_LINES,
        "README.md: {lines} lines: allowed are {README_LINES}"
    );
}

#[test]
fn the_lights_of_the_pilots_page_are_those_of_the_firmware() {
    let source = std::fs::read_to_string(root().join("src/firmware/lights.rs")).unwrap();
    let page = std::fs::read_to_string(root().join("docs/pilot.md")).unwrap();
    let listed: Vec<&str> = source
        .lines()
        .filter_map(|line| line.strip_prefix("//! "))
        .skip(1)
        .collect();
    assert!(listed.len() >= 8, "{listed:?}");
    for line in listed {
        assert!(
            page.lines().any(|l| l == line),
            "docs/pilot.md has no line '{line}'"
        );
    }
}

#[test]
fn the_numbers_of_calibration_and_safety_follow_from_the_defaults() {
    let p = Params::DEFAULT;
    // 0.5 kg on a pressure sensor with its divider; 132 g on its area; four cells.
    let conductance = p.fsr_gain * 4.9 * p.fsr_divider;
    let (volts, pascals) = (3.3 * conductance / (1.0 + conductance), 1.3 / p.fsr_area);
    let tendon = p.servo_torque_max / p.reel_radius;
    let numbers = [
        ("calibration.md", format!("make {volts:.2} V")),
        ("calibration.md", format!("show {pascals:.0} Pa")),
        (
            "calibration.md",
            format!(
                "{} V and {} V a cell",
                p.battery_warning / 4.0,
                p.battery_critical / 4.0
            ),
        ),
        (
            "calibration.md",
            format!("`tilt_bias_max` ({} rad)", p.tilt_bias_max),
        ),
        ("tuning.md", format!("`notch_hz`, {} Hz", p.notch_hz)),
        ("tuning.md", format!("`rate_d_cutoff` {} Hz", p.rate_d_cutoff)),
        ("safety.md", format!("up to {:.0} N each", p.thrust_max)),
        (
            "safety.md",
            format!("pull with {:.0} N", (tendon / 10.0).floor() * 10.0),
        ),
        ("safety.md", format!("below {} V under load", p.battery_critical)),
    ];
    for (name, number) in numbers {
        let page = std::fs::read_to_string(root().join("docs").join(name)).unwrap();
        let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(page.contains(&number), "docs/{name} does not say '{number}'");
    }
}
