//! Headings, links, file names and words of a Markdown page.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// Source folders: inline `code` that begins with one of them and `/` names a file.
const SOURCES: [&str; 13] = [
    ".ci", ".github", "boards", "control", "docs", "drivers", "hil", "research", "sim", "src", "tasks",
    "tests", "tools",
];

#[derive(Debug, Default)]
pub struct Page {
    /// Anchors of its headings.
    pub anchors: BTreeSet<String>,
    /// Links, images too.
    pub links: Vec<String>,
    /// Inline code.
    pub code: Vec<String>,
    /// Words, tables and code blocks included.
    pub words: usize,
}

impl Page {
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

    /// Adds a heading's anchor by the rule of GitHub and mdBook; a repeated one gets a number.
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

/// Faulty links and file names of `pages`, a line each; `exists` takes paths from the root.
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

/// The file that inline `code` names, if it does: no blanks, no placeholders.
fn named(code: &str) -> Option<&str> {
    let plain = !code.contains([' ', '*', '<', '{', '…', ':']) && !code.contains("...");
    let folder = code.split_once('/')?.0;
    let placeholder = code.contains("YOURS") || code.contains("BOARD");
    (plain && !placeholder && SOURCES.contains(&folder)).then_some(code)
}

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
