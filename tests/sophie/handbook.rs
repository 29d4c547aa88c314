//! Links and names of sources in the pages exist, the handbook lists every page, short pages are short, and what users read
//! is free of seeds, days and history.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::pages::{Page, Tree, faults};
use sophie_control::params::Params;

/// Words read in ten minutes, at 200 a minute.
const SHORT: usize = 2000;
/// Words of the page that a pilot reads before he turns the hold switch.
const HOLD: usize = 900;
const README_LINES: usize = 90;
/// Columns of an entry of the changelog, its dash included: a line each.
const ENTRY: usize = 120;
/// Where seeds, dates and what was before belong: derivations, and the laboratory's pages by date.
const RECORDS: [&str; 2] = ["docs/design", "docs/lab"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Every page of the project, by path from the root.
fn all(tree: &Tree) -> BTreeMap<PathBuf, Page> {
    let pages = tree
        .files
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == "md"));
    pages
        .map(|path| (path.clone(), Page::read(&text(path))))
        .collect()
}

#[test]
fn every_link_and_every_source_that_a_page_names_exists() {
    let tree = Tree::read(root());
    let found = faults(&all(&tree), &tree);
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn the_pages_that_are_read_are_those_of_the_whole_tree() {
    let tree = Tree::read(root());
    let pages = all(&tree);
    for (folder, least) in [
        ("docs", 25),
        ("docs/design", 5),
        ("docs/lab", 10),
        ("hil", 1),
        ("", 40),
    ] {
        let found = pages.keys().filter(|path| path.starts_with(folder)).count();
        assert!(found >= least, "{folder}: {found} pages");
    }
    for folder in [
        "boards", "control", "docs", "src", "tasks", "tests", "tools", "xtask",
    ] {
        assert!(tree.folder(folder), "{folder}");
    }
    assert!(!tree.folder("target") && !tree.folder(".git"));
}

#[test]
fn every_page_that_a_source_names_exists() {
    let tree = Tree::read(root());
    let mut found = Vec::new();
    let mut named = 0;
    for path in &tree.files {
        let read = path.starts_with(".ci")
            || path
                .extension()
                .is_some_and(|e| ["rs", "toml", "xml", "py", "md", "x"].iter().any(|r| e == *r));
        if !read {
            continue;
        }
        let text = text(path);
        for (at, _) in text.match_indices("docs/") {
            let before = text[..at].chars().next_back().unwrap_or(' ');
            let rest = &text[at..];
            let part = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
            let end = rest.find(|c| !part(c)).unwrap_or(rest.len());
            let name = rest[..end].trim_end_matches('.');
            if part(before) || rest[end..].starts_with(['*', '{', '<']) || !name.contains(".md") {
                continue;
            }
            named += 1;
            if !tree.has(Path::new(name)) {
                found.push(format!("{}: {name}", path.display()));
            }
        }
    }
    // The names of this test's own examples.
    found.retain(|fault| !fault.starts_with("tests/sophie/handbook.rs"));
    assert!(found.is_empty(), "no such page:\n{}", found.join("\n"));
    assert!(named > 80, "{named} names");
}

#[test]
fn a_broken_link_a_broken_anchor_and_a_missing_source_are_named() {
    let one = "# One page\n\n## The *first* `part`, twice\n\n## The first part, twice\n\n\
               [a](lab/two.md) [b](lab/two.md#there) [c](#the-first-part-twice) [d](#the-first-part-twice-1) \
               `src/there.rs` `there.rs` `out/report.html`\n";
    let two = "# Two\n\n## There\n\n[back](../one.md#one-page)\n";
    let pages = |one: &str| {
        BTreeMap::from([
            (PathBuf::from("docs/one.md"), Page::read(one)),
            (PathBuf::from("docs/lab/two.md"), Page::read(two)),
        ])
    };
    let files = ["docs/one.md", "docs/lab/two.md", "src/there.rs"];
    let tree = Tree::of(files.map(PathBuf::from));
    assert_eq!(faults(&pages(one), &tree), [] as [&str; 0]);
    for (broken, fault) in [
        ("[x](three.md)", "docs/one.md: three.md: no such file"),
        ("![x](drawing.svg)", "docs/one.md: drawing.svg: no such file"),
        (
            "[x](lab/two.md#nowhere)",
            "docs/one.md: lab/two.md#nowhere: no such heading",
        ),
        ("[x](#nowhere)", "docs/one.md: #nowhere: no such heading"),
        (
            "[x](#the-first-part-twice-2)",
            "docs/one.md: #the-first-part-twice-2: no such heading",
        ),
        ("`src/gone.rs`", "docs/one.md: `src/gone.rs`: no such file"),
        ("`gone.rs`", "docs/one.md: `gone.rs`: no such file"),
        ("`left/there.rs`", "docs/one.md: `left/there.rs`: no such file"),
        (
            "[x](lab/two.md#There)",
            "docs/one.md: lab/two.md#There: no such heading",
        ),
    ] {
        assert_eq!(faults(&pages(&format!("{one}\n{broken}\n")), &tree), [fault]);
    }
}

/// What a line for users must not have: a seed's number, the day of a measurement, or how it was before.
fn record(line: &str) -> Option<String> {
    const MONTHS: [&str; 12] = [
        "january",
        "february",
        "march",
        "april",
        "may",
        "june",
        "july",
        "august",
        "september",
        "october",
        "november",
        "december",
    ];
    const STORIES: [&str; 9] = [
        "since then",
        "so far",
        "had been",
        "once had",
        "once was",
        "once ended",
        "laws before",
        "did before",
        "as it was",
    ];
    const CELLS: [&str; 4] = ["before", "now", "once", "before, now"];
    let lower = line.to_lowercase();
    let plain = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric()).to_owned();
    let words: Vec<String> = lower.split_whitespace().map(plain).collect();
    let digit = |word: Option<&String>| word.is_some_and(|w| w.starts_with(|c: char| c.is_ascii_digit()));
    for (n, word) in words.iter().enumerate() {
        let next = words.get(n + 1);
        let day = MONTHS.contains(&word.as_str())
            && (digit(n.checked_sub(1).and_then(|n| words.get(n))) && digit(next));
        let date = word.len() == 10 && word.starts_with("20") && word.matches('-').count() == 2;
        if ["seed", "seeds"].contains(&word.as_str()) && digit(next) {
            return Some(format!("{word} {}", next.map_or("", |w| w)));
        }
        if day || date {
            return Some(word.clone());
        }
        let passive = ["is", "are", "be", "get", "being"].map(str::to_owned);
        if word == "used" && next.is_some_and(|w| w == "to") && !(n > 0 && passive.contains(&words[n - 1])) {
            return Some("used to".into());
        }
        // "(0.58 before)"
        if word == "before" && digit(n.checked_sub(1).and_then(|n| words.get(n))) && lower.contains("before)")
        {
            return Some("before)".into());
        }
    }
    if CELLS.contains(&lower.trim()) {
        return Some(lower.trim().to_owned());
    }
    STORIES
        .iter()
        .find(|story| lower.contains(*story))
        .map(|s| (*s).into())
}

#[test]
fn what_users_read_has_no_seed_no_day_and_no_history() {
    let tree = Tree::read(root());
    let mut found = Vec::new();
    for (path, page) in all(&tree) {
        if RECORDS.iter().any(|folder| path.starts_with(folder)) {
            continue;
        }
        for line in &page.prose {
            // A release has its day.
            if path == Path::new("CHANGELOG.md")
                && line.contains(" - 20")
                && line.split_whitespace().count() == 3
            {
                continue;
            }
            if let Some(record) = record(line) {
                found.push(format!("{}: '{record}' in: {line:.100}", path.display()));
            }
        }
    }
    assert!(
        found.is_empty(),
        "belongs into docs/lab, by date, with a link to it:\n{}",
        found.join("\n")
    );
}

#[test]
fn records_are_known_from_rules() {
    for line in [
        "accomplished on seeds 1 to 12",
        "the worst (seed 209) moved",
        "measured on 24 November 2026",
        "flown (2026-11-24) on both",
        "it used to turn to the heading",
        "falls 0.18 m (0.58 before)",
        "now",
        "seven had been lost",
    ] {
        assert!(record(line).is_some(), "{line}");
    }
    for line in [
        "every random number of a seed comes from a stream",
        "the sensor is used to fit it",
        "before every flight: 3 checks",
        "turn it by 90 degrees; it may take 10 s",
        "from then on its position counts; until then the old one does",
    ] {
        assert_eq!(record(line), None, "{line}");
    }
}

#[test]
fn an_entry_of_the_changelog_is_a_line_and_the_newest_release_is_this_one() {
    let text = text(Path::new("CHANGELOG.md"));
    let releases: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let newest = releases.iter().find(|release| **release != "Unreleased").unwrap();
    let version = env!("CARGO_PKG_VERSION");
    assert!(
        newest.starts_with(&format!("{version} - 20")),
        "newest release: {newest}"
    );
    let body = text.split_once("\n## ").unwrap().1;
    let mut entries = BTreeSet::new();
    for line in body
        .lines()
        .filter(|line| !line.is_empty() && !line.contains(" - 20"))
    {
        let heading = line.starts_with('#') || line == "Unreleased";
        assert!(
            heading || line.starts_with("- ") || line.starts_with("The first release"),
            "no entry of its own: {line}"
        );
        assert!(
            line.chars().count() <= ENTRY,
            "{} columns: {line}",
            line.chars().count()
        );
        assert!(heading || entries.insert(line), "twice: {line}");
    }
}

#[test]
fn the_version_that_the_pages_print_is_this_one() {
    let version = env!("CARGO_PKG_VERSION");
    for page in ["docs/first-hour.md", "docs/console.md"] {
        let text = text(Path::new(page));
        for line in text.lines().filter(|line| line.contains("SOPHIE 0.")) {
            assert!(line.contains(&format!("SOPHIE {version} on")), "{page}: {line}");
        }
    }
}

/// The words that are types have them in the glossary's last column.
#[test]
fn every_type_of_the_glossary_is_declared() {
    let tree = Tree::read(root());
    let sources: Vec<String> = (tree.files.iter())
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .map(|path| text(path))
        .collect();
    let page = text(Path::new("docs/architecture.md"));
    let glossary = page.split_once("## Glossary").unwrap().1;
    let glossary = glossary.split_once("\n## ").unwrap().0;
    let mut types = 0;
    for row in glossary.lines().filter(|line| line.starts_with("| ")) {
        let Some(cell) = row.trim_end_matches([' ', '|']).rsplit('|').next() else {
            continue;
        };
        for name in cell.split('`').skip(1).step_by(2) {
            let name = name.rsplit("::").next().unwrap();
            let declared = ["struct", "enum", "trait"].map(|kind| format!("{kind} {name}"));
            let sound = sources.iter().any(|source| {
                declared.iter().any(|d| {
                    source.match_indices(d.as_str()).any(|(at, _)| {
                        !source[at + d.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_')
                    })
                })
            });
            assert!(sound, "docs/architecture.md: no type {name}");
            types += 1;
        }
    }
    assert!(types >= 20, "{types} types");
}

#[test]
fn every_page_of_the_folder_is_in_the_handbook() {
    let pages = all(&Tree::read(root()));
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
    let pages = all(&Tree::read(root()));
    for (name, most) in [
        ("docs/pilot.md", SHORT),
        ("docs/first-hour.md", SHORT),
        ("docs/hold.md", HOLD),
    ] {
        let words = pages[Path::new(name)].words;
        println!("{name}: {words} words");
        assert!(
            (200..=most).contains(&words),
            "{name}: {words} words: allowed are {most}"
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
    // 0.5 kg on a pressure sensor with its divider; 140 g on its area; four cells.
    let conductance = p.fsr_gain * 4.9 * p.fsr_divider;
    let (volts, pascals) = (
        3.3 * conductance / (1.0 + conductance),
        0.14 * 9.806_65 / p.fsr_area,
    );
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
