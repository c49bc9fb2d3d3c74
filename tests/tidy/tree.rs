//! Files of the workspace, and the offences that the checks report.

use std::env;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The files under a root, by their path from there, with `/` between folders.
#[derive(Debug)]
pub(crate) struct Tree {
    root: PathBuf,
    files: Vec<String>,
}

impl Tree {
    /// The workspace this test belongs to.
    pub(crate) fn workspace() -> io::Result<Self> {
        // Cargo sets it when it runs the test too: a binary built in another clone then looks at this one.
        let package = env::var("CARGO_MANIFEST_DIR")
            .unwrap_or_else(|_| env!("CARGO_MANIFEST_DIR").to_owned());
        let root = Path::new(&package).parent().unwrap_or(Path::new("."));
        match git_files(root) {
            Some(files) => Ok(Self { root: root.to_owned(), files }),
            None => Self::walk(root),
        }
    }

    /// Every file under `root`, but build results and what git keeps for itself.
    pub(crate) fn walk(root: &Path) -> io::Result<Self> {
        let mut files = Vec::new();
        let mut folders = vec![String::new()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(root.join(&folder))? {
                let entry = entry?;
                let name = entry.file_name().to_string_lossy().into_owned();
                let path = join(&folder, &name);
                if !entry.file_type()?.is_dir() {
                    files.push(path);
                } else if name != ".git" && name != "target" {
                    folders.push(path);
                }
            }
        }
        files.sort();
        Ok(Self { root: root.to_owned(), files })
    }

    /// Every file, sorted.
    pub(crate) fn files(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(String::as_str)
    }

    /// The files whose name ends in `.extension`.
    pub(crate) fn with_extension(&self, extension: &str) -> impl Iterator<Item = &str> {
        self.files()
            .filter(move |file| Path::new(file).extension().is_some_and(|found| found == extension))
    }

    /// True if `path` is a file, or a folder that holds one (git keeps no empty folders).
    pub(crate) fn exists(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        self.is_file(path)
            || self
                .files()
                .any(|file| file.strip_prefix(path).is_some_and(|rest| rest.starts_with('/')))
    }

    /// True if `path` is a file.
    pub(crate) fn is_file(&self, path: &str) -> bool {
        self.files.binary_search_by(|file| file.as_str().cmp(path)).is_ok()
    }

    /// The path of a file on this machine.
    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.root.join(file)
    }

    /// The text of a file. The error names the file.
    pub(crate) fn read(&self, file: &str) -> io::Result<String> {
        fs::read_to_string(self.path(file))
            .map_err(|error| io::Error::new(error.kind(), format!("{file}: {error}")))
    }
}

/// Files that git would commit: everything in the index and everything new that is not ignored. `None` outside a clone
/// (the sources may have come as an archive) or without git.
fn git_files(root: &Path) -> Option<Vec<String>> {
    let listing = ["ls-files", "-z", "--cached", "--others", "--exclude-standard"];
    let output = Command::new("git").arg("-C").arg(root).args(listing).output().ok()?;
    let names = output.status.success().then(|| String::from_utf8(output.stdout).ok())??;
    let mut files: Vec<String> =
        names.split('\0').filter(|name| root.join(name).is_file()).map(str::to_owned).collect();
    files.sort();
    files.dedup();
    (!files.is_empty()).then_some(files)
}

/// `name` inside `folder`; the root folder is the empty string. `.` and `..` in `name` are resolved.
pub(crate) fn join(folder: &str, name: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in name.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// The folder a file is in.
pub(crate) fn parent(file: &str) -> &str {
    file.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// One thing that is not tidy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Offence {
    /// The file, from the root.
    pub(crate) file: String,
    /// The line, counted from 1; 1 as well where the whole file is meant.
    pub(crate) line: usize,
    /// The offence.
    pub(crate) what: String,
}

impl Offence {
    pub(crate) fn new(file: &str, line: usize, what: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line, what: what.into() }
    }
}

impl fmt::Display for Offence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.what)
    }
}

/// Fails with the whole list if there is any offence.
pub(crate) fn assert_none(offences: &[Offence]) {
    let list: Vec<String> = offences.iter().map(ToString::to_string).collect();
    assert!(list.is_empty(), "{} not tidy:\n{}", list.len(), list.join("\n"));
}

#[cfg(test)]
pub(crate) mod fake {
    //! Small trees that exist for one test.

    use super::Tree;
    use std::fs;
    use tempfile::TempDir;

    /// A tree of the given files and texts; it lives as long as the folder returned with it.
    pub(crate) fn tree(files: &[(&str, &str)]) -> (TempDir, Tree) {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let tree = Tree::walk(folder.path()).unwrap();
        (folder, tree)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_exists_only_with_a_file_in_it() {
        let (folder, _) =
            fake::tree(&[("a/b.rs", ""), ("ab/c.rs", ""), ("target/d.rs", ""), (".git/e", "")]);
        fs::create_dir(folder.path().join("empty")).unwrap();
        let tree = Tree::walk(folder.path()).unwrap();
        assert_eq!(tree.files().collect::<Vec<_>>(), ["a/b.rs", "ab/c.rs"]);
        assert!(tree.exists("a") && tree.exists("a/") && tree.exists("a/b.rs"));
        assert!(!tree.exists("empty") && !tree.exists("a/b") && !tree.exists("target"));
    }

    #[test]
    fn names_are_joined_and_dots_resolved() {
        assert_eq!(join("", "lib.rs"), "lib.rs");
        assert_eq!(join("a/b", "../c/./d.rs"), "a/c/d.rs");
        assert_eq!(parent("a/b/c.rs"), "a/b");
        assert_eq!(parent("c.rs"), "");
    }
}
