//! Headings, links, file names and words of a Markdown page.

mod tree;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
pub use tree::Tree;

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
    /// Headings, paragraphs, list entries and cells of tables, each a line, without code.
    pub prose: Vec<String>,
}

impl Page {
    pub fn read(text: &str) -> Self {
        let mut page = Self::default();
        let mut heading = None;
        let mut block = false;
        let mut prose = String::new();
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            let said = match event {
                Event::Start(Tag::Heading { .. }) => {
                    heading = Some(String::new());
                    continue;
                }
                Event::Start(Tag::CodeBlock(_)) => {
                    block = true;
                    continue;
                }
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.links.push(dest_url.into_string());
                    continue;
                }
                Event::End(end) => {
                    match end {
                        TagEnd::Heading(_) => page.anchor(&heading.take().unwrap_or_default()),
                        TagEnd::CodeBlock => block = false,
                        TagEnd::Paragraph | TagEnd::Item | TagEnd::TableCell => {}
                        _ => continue,
                    }
                    page.prose
                        .extend(Some(std::mem::take(&mut prose)).filter(|p| !p.is_empty()));
                    continue;
                }
                Event::Code(said) => {
                    prose.push('`');
                    page.code.push(said.to_string());
                    said
                }
                Event::Text(said) => {
                    if !block {
                        prose.push_str(&said);
                    }
                    said
                }
                Event::SoftBreak | Event::HardBreak => {
                    prose.push(' ');
                    continue;
                }
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

/// Faulty links and file names of `pages`, a line each.
pub fn faults(pages: &BTreeMap<PathBuf, Page>, tree: &Tree) -> Vec<String> {
    let mut found = Vec::new();
    for (path, page) in pages {
        let shown = path.display();
        for link in page.links.iter().filter(|link| !link.contains("://")) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                _ => resolved(&path.with_file_name(file)),
            };
            if !tree.has(&target) {
                found.push(format!("{shown}: {link}: no such file"));
            } else if !anchor.is_empty() && !pages.get(&target).is_some_and(|p| p.anchors.contains(anchor)) {
                found.push(format!("{shown}: {link}: no such heading"));
            }
        }
        for code in page.code.iter().filter(|code| !placeholder(code)) {
            let sound = match code.split_once('/') {
                Some((folder, _)) if tree.folder(folder) => tree.has(Path::new(code)),
                // The end of a source's path is enough, whatever folder it has moved to; a whole path is not.
                _ if code.ends_with(".rs") => tree.ends(Path::new(code)),
                _ => true,
            };
            if !sound {
                found.push(format!("{shown}: `{code}`: no such file"));
            }
        }
    }
    found
}

/// Inline `code` that names no one file.
fn placeholder(code: &str) -> bool {
    code.contains([' ', '*', '<', '{', '…', ':'])
        || ["...", "YOURS", "BOARD"].iter().any(|p| code.contains(p))
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
