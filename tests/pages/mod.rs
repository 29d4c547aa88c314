//! What a page of Markdown has: headings, links, names of files, words.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// Folders of the sources: an inline `code` that begins with one of them and `/` names a file.
const SOURCES: [&str; 13] = [
    ".ci", ".github", "boards", "control", "docs", "drivers", "hil", "paper", "sim", "src", "tasks", "tests",
    "tools",
];

/// One page.
#[derive(Debug, Default)]
pub struct Page {
    /// Where its headings can be linked to.
    pub anchors: BTreeSet<String>,
    /// What it links to, images too.
    pub links: Vec<String>,
    /// What it names in inline code.
    pub code: Vec<String>,
    /// Words of its text, tables and code blocks included.
    pub words: usize,
}

impl Page {
    /// Reads a page.
    pub fn read(text: &str) -> Self {
        let mut page = Self::default();
        let mut heading = None;
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            let said = match event {
                Event::Start(Tag::Heading { .. }) => {
                    heading = Some(String::new());
                    continue;
                }
                Event::End(TagEnd::Heading(_)) => {
                    page.anchor(&heading.take().unwrap_or_default());
                    continue;
                }
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.links.push(dest_url.into_string());
                    continue;
                }
                Event::Code(said) => {
                    page.code.push(said.to_string());
                    said
                }
                Event::Text(said) => said,
                _ => continue,
            };
            page.words += said
                .split_whitespace()
                .filter(|w| w.contains(char::is_alphanumeric))
                .count();
            if let Some(heading) = &mut heading {
                heading.push_str(&said);
            }
        }
        page
    }

    /// The anchor of a heading, by the rule that GitHub and mdBook share; one that is there already gets a number.
    fn anchor(&mut self, heading: &str) {
        let kept = heading.trim().chars().filter_map(|c| match c {
            c if c.is_alphanumeric() || c == '_' || c == '-' => Some(c.to_lowercase().to_string()),
            c if c.is_whitespace() => Some("-".to_owned()),
            _ => None,
        });
        let plain: String = kept.collect();
        let numbered = (1..).map(|n| format!("{plain}-{n}"));
        let mut names = std::iter::once(plain.clone()).chain(numbered);
        if let Some(free) = names.find(|name| !self.anchors.contains(name)) {
            self.anchors.insert(free);
        }
    }
}

/// What is wrong with the links and names of `pages`, a line each; `exists` says whether a path from the root does.
pub fn faults(pages: &BTreeMap<PathBuf, Page>, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for (path, page) in pages {
        let shown = path.display();
        for link in page.links.iter().filter(|link| !link.contains("://")) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                _ => resolved(&path.with_file_name(file)),
            };
            if !(pages.contains_key(&target) || exists(&target)) {
                found.push(format!("{shown}: {link}: no such file"));
            } else if !anchor.is_empty() && !pages.get(&target).is_some_and(|p| p.anchors.contains(anchor)) {
                found.push(format!("{shown}: {link}: no such heading"));
            }
        }
        for code in &page.code {
            if named(code).is_some_and(|file| !exists(Path::new(file))) {
                found.push(format!("{shown}: `{code}`: no such file"));
            }
        }
    }
    found
}

/// The file that an inline `code` names, if it names one: no blanks, no placeholders.
fn named(code: &str) -> Option<&str> {
    let plain = !code.contains([' ', '*', '<', '{', '…', ':']) && !code.contains("...");
    let folder = code.split_once('/')?.0;
    let placeholder = code.contains("YOURS") || code.contains("BOARD");
    (plain && !placeholder && SOURCES.contains(&folder)).then_some(code)
}

/// `path` without `..`.
fn resolved(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}
