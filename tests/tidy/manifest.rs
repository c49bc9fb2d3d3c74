//! Reader of Cargo manifests.

use crate::tree::{Tree, join};
use std::io;
use toml::{Table, Value};

/// One `Cargo.toml`.
#[derive(Debug)]
pub(crate) struct Manifest {
    /// The folder it is in, the empty string for the root.
    pub(crate) folder: String,
    /// Its path.
    pub(crate) file: String,
    table: Table,
    text: String,
}

/// A dependency as a manifest names it.
#[derive(Debug)]
pub(crate) struct Dependency {
    /// The name in the registry or of the member, behind any renaming.
    pub(crate) package: String,
    /// True if only tests, benches and examples see it.
    pub(crate) dev: bool,
    /// The line that names it.
    pub(crate) line: usize,
}

impl Manifest {
    /// The manifest in `folder`.
    pub(crate) fn read(tree: &Tree, folder: &str) -> io::Result<Self> {
        let file = join(folder, "Cargo.toml");
        let text = tree.read(&file)?;
        let table = text.parse().map_err(|error| io::Error::other(format!("{file}: {error}")))?;
        Ok(Self { folder: folder.to_owned(), file, table, text })
    }

    /// The manifests of the workspace: the root's, and those of its members.
    pub(crate) fn workspace(tree: &Tree) -> io::Result<(Self, Vec<Self>)> {
        let root = Self::read(tree, "")?;
        let members = root.get(&["workspace", "members"]).and_then(Value::as_array);
        let folders = members.into_iter().flatten().filter_map(Value::as_str);
        let members = folders.map(|folder| Self::read(tree, folder)).collect::<io::Result<_>>()?;
        Ok((root, members))
    }

    /// The manifests of the packages that this workspace excludes: they are built apart from it.
    pub(crate) fn excluded(&self, tree: &Tree) -> io::Result<Vec<Self>> {
        let folders = self.get(&["workspace", "exclude"]).and_then(Value::as_array);
        let folders = folders.into_iter().flatten().filter_map(Value::as_str);
        folders.map(|folder| Self::read(tree, folder)).collect()
    }

    /// The value at a path of keys.
    pub(crate) fn get(&self, keys: &[&str]) -> Option<&Value> {
        let (first, rest) = keys.split_first()?;
        rest.iter().try_fold(self.table.get(*first)?, |value, key| value.get(*key))
    }

    /// The name of the package.
    pub(crate) fn package(&self) -> &str {
        self.get(&["package", "name"]).and_then(Value::as_str).unwrap_or_default()
    }

    /// Everything the package depends on. `root` knows what `workspace = true` stands for.
    pub(crate) fn dependencies(&self, root: &Self) -> Vec<Dependency> {
        let mut found = Vec::new();
        let targets = self.get(&["target"]).and_then(Value::as_table);
        let tables = std::iter::once(&self.table).chain(
            targets
                .into_iter()
                .flat_map(|targets| targets.iter().filter_map(|(_, target)| target.as_table())),
        );
        for table in tables {
            for kind in ["dependencies", "build-dependencies", "dev-dependencies"] {
                for (key, value) in table.get(kind).and_then(Value::as_table).into_iter().flatten()
                {
                    let renamed = value
                        .get("package")
                        .or_else(|| root.get(&["workspace", "dependencies", key, "package"]));
                    let package = renamed.and_then(Value::as_str).unwrap_or(key).to_owned();
                    found.push(Dependency {
                        package,
                        dev: kind == "dev-dependencies",
                        line: self.line_of(kind, key),
                    });
                }
            }
        }
        found
    }

    /// The source files cargo starts from when it builds this package: the paths the manifest gives, and where it
    /// looks when the manifest gives none.
    pub(crate) fn target_roots(&self, tree: &Tree) -> Vec<String> {
        let mut candidates: Vec<String> =
            ["src/lib.rs", "src/main.rs", "build.rs"].map(|file| join(&self.folder, file)).into();
        for path in [self.get(&["lib", "path"]), self.get(&["package", "build"])] {
            candidates.extend(path.and_then(Value::as_str).map(|path| join(&self.folder, path)));
        }
        for (kind, folder, automatic) in [
            ("bin", "src/bin", "autobins"),
            ("test", "tests", "autotests"),
            ("bench", "benches", "autobenches"),
            ("example", "examples", "autoexamples"),
        ] {
            for target in self.get(&[kind]).and_then(Value::as_array).into_iter().flatten() {
                if let Some(path) = target.get("path").and_then(Value::as_str) {
                    candidates.push(join(&self.folder, path));
                } else if let Some(name) = target.get("name").and_then(Value::as_str) {
                    candidates.push(join(&self.folder, &format!("{folder}/{name}.rs")));
                    candidates.push(join(&self.folder, &format!("{folder}/{name}/main.rs")));
                }
            }
            if self.get(&["package", automatic]).and_then(Value::as_bool).unwrap_or(true) {
                let folder = join(&self.folder, folder);
                candidates.extend(
                    tree.with_extension("rs")
                        .filter(|file| is_found_in(file, &folder))
                        .map(str::to_owned),
                );
            }
        }
        candidates.retain(|file| tree.is_file(file));
        candidates
    }

    /// The line on which `key` stands in the table `[section]`, 1 if there is none.
    pub(crate) fn line_of(&self, section: &str, key: &str) -> usize {
        let mut inside = false;
        for (index, line) in self.text.lines().enumerate() {
            let line = line.trim();
            if let Some(header) = line.strip_prefix('[') {
                let header = header.trim_end_matches(']');
                inside = header == section || header.ends_with(&format!(".{section}"));
            } else if inside
                && line.strip_prefix(key).is_some_and(|rest| rest.starts_with(['.', ' ', '=']))
            {
                return index + 1;
            }
        }
        1
    }
}

/// True if cargo finds a target in `file` by looking into `folder`: `folder/x.rs` and `folder/x/main.rs`.
fn is_found_in(file: &str, folder: &str) -> bool {
    let Some(rest) = file.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/')) else {
        return false;
    };
    match rest.split_once('/') {
        None => true,
        Some((_, inner)) => inner == "main.rs",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::fake;

    const ROOT: &str =
        "[workspace]\nmembers = [\"a\"]\n[workspace.dependencies]\nm = { package = \"maths\" }\n";

    #[test]
    fn dependencies_are_known_by_their_real_name_and_line() {
        let a = "[package]\nname = \"twin-a\"\n\n[dependencies]\nm.workspace = true\n\n[dev-dependencies]\n\
                 tool = { package = \"real-tool\" }\n\n[target.'cfg(unix)'.dependencies]\nlibc = \"1\"\n";
        let (_folder, tree) = fake::tree(&[("Cargo.toml", ROOT), ("a/Cargo.toml", a)]);
        let (root, members) = Manifest::workspace(&tree).unwrap();
        let [member] = members.as_slice() else { panic!("one member") };
        assert_eq!(member.package(), "twin-a");
        let found: Vec<_> =
            member.dependencies(&root).into_iter().map(|d| (d.package, d.dev, d.line)).collect();
        assert_eq!(
            found,
            [
                ("maths".to_owned(), false, 5),
                ("real-tool".to_owned(), true, 8),
                ("libc".to_owned(), false, 11)
            ]
        );
    }

    #[test]
    fn targets_are_found_where_cargo_finds_them() {
        let files = [
            "a/lib.rs",
            "a/run.rs",
            "a/tests/x.rs",
            "a/tests/y/main.rs",
            "a/tests/y/part.rs",
            "a/b/z.rs",
        ];
        let explicit = "[package]\nname = \"a\"\n[lib]\npath = \"lib.rs\"\n[[bin]]\nname = \"run\"\npath = \"run.rs\"\n";
        for (auto, expected) in [
            ("", vec!["a/lib.rs", "a/run.rs", "a/tests/x.rs", "a/tests/y/main.rs"]),
            ("autotests = false\n", vec!["a/lib.rs", "a/run.rs"]),
        ] {
            let manifest = explicit.replace("[lib]", &format!("{auto}[lib]"));
            let mut tree: Vec<_> = files.iter().map(|file| (*file, "")).collect();
            tree.extend([("Cargo.toml", ROOT), ("a/Cargo.toml", &manifest)]);
            let (_folder, tree) = fake::tree(&tree);
            assert_eq!(Manifest::read(&tree, "a").unwrap().target_roots(&tree), expected);
        }
    }
}
