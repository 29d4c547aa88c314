//! Comments of product code are plain: a ceiling per folder on turns of phrase that a reader has to decode.
//!
//! The phrases hide who acts and on what ("what is felt", "where nothing tells"). Each folder has a ceiling in
//! `tests/word_ceilings.toml`, phrases per 1,000 words of comment; `WRITE_DOCS=1 cargo test --test sophie words::` lowers those
//! that have become too high, never below 2, and raises none.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Words in sequence, each with its alternatives; `*` is any word.
const PHRASES: [&[&[&str]]; 19] = [
    &[
        &["what"],
        &[
            "is", "was", "has", "have", "it", "they", "other", "others", "nobody",
        ],
    ],
    &[&["where"], &["nothing", "that", "none", "it", "there"]],
    &[&["is"], &["none"]],
    &[&["are"], &["none"]],
    &[&["is"], &["no"], &["*"]],
    &[&["by"], &["itself"]],
    &[&["felt"]],
    &[&["anew"]],
    &[&["aloft"]],
    &[&["wish", "wishes", "wished"]],
    &[&["told"]],
    &[&["tells"]],
    &[&["says"], &["what"]],
    &[&["afresh"]],
    &[&["nobody"]],
    &[&["believed"]],
    &[&["for"], &["ever"]],
    &[&["forever"]],
    &[&["goes"], &["on"]],
];
/// Phrases per 1,000 words that no folder may exceed, whatever its ceiling.
const MOST: f64 = 6.0;
/// No ceiling falls below this: the plainest code bases of the field stand at 2 to 4, and each phrase has its honest use.
const LEAST: f64 = 2.0;
/// Folders whose first level is counted apart.
const BY_ROOM: [&str; 4] = ["control/src", "control/inner_loop/src", "tasks/src", "tools"];
const CEILINGS: &str = "tests/word_ceilings.toml";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[derive(Default)]
struct Count {
    words: usize,
    phrases: usize,
    found: Vec<String>,
}

impl Count {
    fn per_thousand(&self) -> f64 {
        1000.0 * self.phrases as f64 / self.words.max(1) as f64
    }
}

/// Rust files of product code below `folder`: no tests, examples, benchmarks, generated code or build output.
fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for path in entries.map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let is_test = |stem: &str| stem == "tests" || stem.ends_with("_tests") || stem.ends_with("_fuzz");
        if path.is_dir() {
            let left_out = ["target", "generated", "benches", "examples"].contains(&name.as_str());
            if !left_out && !is_test(&name) && !name.starts_with('.') {
                sources(&path, into);
            }
        } else if let Some(stem) = name.strip_suffix(".rs")
            && !is_test(stem)
        {
            into.push(path);
        }
    }
}

/// The comments of a source, one string per run of lines; modules under `#[cfg(test)]` at the end of a file left out.
fn comments(source: &str) -> Vec<String> {
    let mut runs = vec![String::new()];
    let mut lines = source.lines().peekable();
    while let Some(line) = lines.next() {
        let tests = lines
            .peek()
            .is_some_and(|next| next.starts_with("mod ") && next.ends_with('{'));
        if line == "#[cfg(test)]" && tests {
            break;
        }
        let line = line.trim_start();
        let comment = line
            .find("// ")
            .filter(|at| *at == 0 || line[..*at].ends_with(' '))
            .or_else(|| line.find("///"))
            .or_else(|| line.find("//!"));
        match comment {
            Some(at) => {
                let text = line[at..].trim_start_matches(['/', '!']);
                let run = runs.last_mut().unwrap();
                run.push_str(text);
                run.push('\n');
                if at != 0 {
                    runs.push(String::new());
                }
            }
            None => runs.push(String::new()),
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}

fn phrases(comment: &str) -> (usize, Vec<String>) {
    let words: Vec<_> = comment
        .split_whitespace()
        .map(|word| word.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase())
        .filter(|word| word.chars().any(char::is_alphabetic))
        .collect();
    let starts = |at: usize, phrase: &[&[&str]]| {
        words.len() >= at + phrase.len()
            && phrase
                .iter()
                .zip(&words[at..])
                .all(|(any, word)| any == &["*"] || any.contains(&word.as_str()))
    };
    let found = (0..words.len()).flat_map(|at| {
        let phrase = PHRASES.iter().find(|phrase| starts(at, phrase));
        phrase.map(|phrase| words[at..at + phrase.len()].join(" "))
    });
    (words.len(), found.collect())
}

/// The folder by which a source counts: a crate, or a room of those in `BY_ROOM`.
fn folder(path: &Path) -> String {
    let path = path.strip_prefix(root()).unwrap().to_string_lossy().into_owned();
    for parent in BY_ROOM {
        if let Some(inside) = path.strip_prefix(&format!("{parent}/")) {
            let room = inside.split('/').next().unwrap().trim_end_matches(".rs");
            return format!("{parent}/{room}");
        }
    }
    path.split('/').next().unwrap().to_string()
}

fn count() -> BTreeMap<String, Count> {
    let mut files = Vec::new();
    sources(root(), &mut files);
    files.sort();
    let mut counts = BTreeMap::<String, Count>::new();
    for path in files {
        let count = counts.entry(folder(&path)).or_default();
        for comment in comments(&std::fs::read_to_string(&path).unwrap()) {
            let (words, found) = phrases(&comment);
            count.words += words;
            count.phrases += found.len();
            let path = path.strip_prefix(root()).unwrap();
            let line = comment.lines().next().unwrap_or("").trim();
            count.found.extend(
                found
                    .iter()
                    .map(|phrase| format!("{}: \"{phrase}\" in: {line}", path.display())),
            );
        }
    }
    counts
}

fn ceilings() -> BTreeMap<String, f64> {
    let text = std::fs::read_to_string(root().join(CEILINGS)).unwrap_or_default();
    let rows = text
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty());
    rows.map(|row| {
        let (name, figure) = row.split_once(" = ").unwrap();
        (name.trim_matches('"').to_string(), figure.parse().unwrap())
    })
    .collect()
}

/// Rounded up to a tenth, so that a figure is never above its own ceiling.
fn tenth(figure: f64) -> f64 {
    (figure * 10.0).ceil() / 10.0
}

#[test]
fn comments_stay_below_their_folders_ceilings() {
    let counts = count();
    let ceilings = ceilings();
    if std::env::var_os("WRITE_DOCS").is_some() {
        let mut text = String::from(
            "# Phrases that hide who acts, per 1,000 words of product comment (tests/sophie/words.rs). Lowered by\n\
             # `WRITE_DOCS=1 cargo test --test sophie words::`, never raised.\n",
        );
        for (name, count) in &counts {
            let now = tenth(count.per_thousand()).max(LEAST);
            let ceiling = ceilings.get(name).map_or(now, |ceiling| ceiling.min(now));
            text.push_str(&format!("\"{name}\" = {ceiling:.1}\n"));
        }
        std::fs::write(root().join(CEILINGS), text).unwrap();
        return;
    }
    let mut over = Vec::new();
    for (name, count) in &counts {
        let ceiling = ceilings.get(name).copied().unwrap_or(MOST).min(MOST);
        if count.per_thousand() > ceiling {
            over.push(format!(
                "{name}: {} in {} words, {:.1} per 1,000, {ceiling:.1} allowed:\n  {}",
                count.phrases,
                count.words,
                count.per_thousand(),
                count.found.join("\n  ")
            ));
        }
    }
    assert!(over.is_empty(), "\n{}", over.join("\n"));
}

#[test]
fn phrases_are_found_over_line_ends_and_in_any_case() {
    let source = "/// What\n/// is felt.\nfn a() {} // it is no use\n//! There is none: goes on\n\n#[cfg(test)]\nmod tests {\n// told\n";
    let found: Vec<_> = comments(source)
        .iter()
        .flat_map(|comment| phrases(comment).1)
        .collect();
    assert_eq!(found, ["what is", "felt", "is no use", "is none", "goes on"]);
    let code = "let url = \"http://told\";\nlet x = 1; /* told */\n";
    assert!(comments(code).is_empty());
}
