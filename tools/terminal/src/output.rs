//! The output directory: checked before the flight, made at the first write; files appear complete or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::console::one_line;

/// A directory that was writable when checked.
pub struct OutDir {
    path: PathBuf,
}

impl OutDir {
    /// Tests whether files `names` can be made in the directory and leaves it unchanged: an interrupted run leaves no
    /// file.
    ///
    /// # Errors
    /// One line: directory, reason, allowed values.
    pub fn prepare(path: &Path, names: &[&str]) -> Result<Self, String> {
        let out = Self {
            path: path.to_owned(),
        };
        let made: Vec<PathBuf> = path
            .ancestors()
            .take_while(|p| !p.as_os_str().is_empty() && !p.exists())
            .map(Path::to_owned)
            .collect();
        let probe = out.partial("probe");
        let tried = fs::create_dir_all(path)
            .and_then(|()| fs::write(&probe, b""))
            .and_then(|()| fs::remove_file(&probe));
        for directory in &made {
            // Innermost first; a directory filled by someone else meanwhile stays.
            let _ = fs::remove_dir(directory);
        }
        tried.map_err(|error| {
            format!(
                "--out {}: cannot be written: {error}: allowed is a writable directory",
                path.display()
            )
        })?;
        match names.iter().map(|name| path.join(name)).find(|p| p.is_dir()) {
            Some(taken) => Err(format!(
                "--out {}: cannot be written: it is a directory: allowed is a file or nothing",
                taken.display()
            )),
            None => Ok(out),
        }
    }

    /// Makes the directory, writes all files under temporary names, then renames them; returns their paths.
    ///
    /// # Errors
    /// One line: file and reason; the temporary files are removed.
    pub fn write(&self, files: &[(impl AsRef<str>, Vec<u8>)]) -> Result<Vec<String>, String> {
        let result = self.try_write(files);
        if result.is_err() {
            for (name, _) in files {
                let _ = fs::remove_file(self.partial(name.as_ref()));
            }
        }
        result
    }

    fn try_write(&self, files: &[(impl AsRef<str>, Vec<u8>)]) -> Result<Vec<String>, String> {
        let failed = |name: &str, error: io::Error| {
            format!(
                "--out {}: cannot be written: {error}",
                self.path.join(name).display()
            )
        };
        fs::create_dir_all(&self.path).map_err(|error| failed("", error))?;
        for (name, content) in files {
            let name = name.as_ref();
            fs::write(self.partial(name), content).map_err(|error| failed(name, error))?;
        }
        let mut written = Vec::new();
        for (name, _) in files {
            let name = name.as_ref();
            let path = self.path.join(name);
            fs::rename(self.partial(name), &path).map_err(|error| failed(name, error))?;
            written.push(one_line(&path.display().to_string()));
        }
        Ok(written)
    }

    /// Hidden, unique to this process.
    fn partial(&self, name: &str) -> PathBuf {
        self.path.join(format!(".{name}.{}.partial", std::process::id()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn temp(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("sophie-out-{}-{name}", std::process::id()))
    }

    fn names(path: &Path) -> Vec<String> {
        let entries = fs::read_dir(path)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_whole_and_nothing_else_stays() {
        let path = temp("good").join("deep");
        let out = OutDir::prepare(&path, &["a", "b"]).unwrap();
        assert!(
            !temp("good").exists(),
            "nothing is made before there is something to write"
        );
        out.write(&[("a", b"1".to_vec()), ("b", b"2".to_vec())]).unwrap();
        out.write(&[("a", b"3".to_vec())]).unwrap();
        assert_eq!(names(&path), ["a", "b"]);
        assert_eq!(fs::read(path.join("a")).unwrap(), b"3");
        fs::remove_dir_all(temp("good")).unwrap();
    }

    #[test]
    fn a_failure_leaves_no_partial_file() {
        let path = temp("bad");
        fs::create_dir_all(path.join("b")).unwrap();
        // A directory in place of the second file: reported at once, or at the write.
        let line = OutDir::prepare(&path, &["a", "b"]).map(|_| ()).unwrap_err();
        assert!(
            line.contains("/b: cannot be written: it is a directory"),
            "{line}"
        );
        let out = OutDir::prepare(&path, &[]).unwrap();
        assert!(
            out.write(&[("a", vec![]), ("b", vec![])])
                .unwrap_err()
                .contains("/b: cannot be written")
        );
        assert!(names(&path).iter().all(|n| !n.contains("partial")));
        fs::remove_dir_all(path).unwrap();
    }

    #[test]
    fn a_file_is_no_directory() {
        let path = temp("file");
        fs::write(&path, b"").unwrap();
        for bad in [path.clone(), path.join("below")] {
            let line = OutDir::prepare(&bad, &["a"]).map(|_| ()).unwrap_err();
            assert!(
                line.contains(&*bad.to_string_lossy()) && line.contains("allowed is a writable directory")
            );
        }
        fs::remove_file(path).unwrap();
    }
}
