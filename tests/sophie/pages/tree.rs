//! The files of the project, by path from its root.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Debug, Default)]
pub struct Tree {
    pub files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
}

impl Tree {
    /// All below `root`, without what `.gitignore` names there, Git's own and Cargo's output anywhere.
    pub fn read(root: &Path) -> Self {
        let ignored = fs::read_to_string(root.join(".gitignore")).unwrap_or_default();
        let ignored: Vec<&str> = ignored
            .lines()
            .filter_map(|line| line.strip_prefix('/'))
            .collect();
        let mut files = Vec::new();
        let mut open = vec![PathBuf::new()];
        while let Some(folder) = open.pop() {
            for entry in fs::read_dir(root.join(&folder)).unwrap() {
                let entry = entry.unwrap();
                let name = entry.file_name();
                let path = folder.join(&name);
                let skipped =
                    name == ".git" || name == "target" || ignored.iter().any(|i| Path::new(i) == path);
                match entry.file_type().unwrap().is_dir() {
                    _ if skipped => {}
                    true => open.push(path),
                    false => files.push(path),
                }
            }
        }
        Self::of(files)
    }

    pub fn of(files: impl IntoIterator<Item = PathBuf>) -> Self {
        let mut tree = Self::default();
        for file in files {
            let parents = file.ancestors().skip(1).map(Path::to_owned);
            tree.folders.extend(parents.filter(|p| p != Path::new("")));
            tree.files.insert(file);
        }
        tree
    }

    /// A file or a folder.
    pub fn has(&self, path: &Path) -> bool {
        let path: PathBuf = path.components().collect();
        self.files.contains(&path) || self.folders.contains(&path)
    }

    /// A folder at the top.
    pub fn folder(&self, name: &str) -> bool {
        self.folders.contains(Path::new(name))
    }

    /// Whether a file's path ends so.
    pub fn ends(&self, path: &Path) -> bool {
        self.files.iter().any(|file| file.ends_with(path))
    }
}
