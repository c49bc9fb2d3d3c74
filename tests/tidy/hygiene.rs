//! Hygiene checks: unfinished code, paths of one machine, files that are too long, manifests without required keys.

use crate::manifest::Manifest;
use crate::tree::{Offence, Tree};
use std::io;
use toml::Value;

/// Longer files hold two ideas.
const LONGEST: usize = 700;

/// Marks of unfinished code, cut in two so that this file does not contain them.
const UNFINISHED: [(&str, &str); 4] =
    [("to", "do!"), ("unimplemen", "ted!"), ("#[ig", "nore"), ("FIX", "ME")];

/// Folders in which only somebody's own machine keeps this project.
const MACHINE_FOLDERS: [&str; 3] = ["work", "root", "home"];

/// Sources with something unfinished in them, or too long.
fn check_sources(tree: &Tree) -> io::Result<Vec<Offence>> {
    let mut offences = Vec::new();
    for file in tree.with_extension("rs") {
        let text = tree.read(file)?;
        for (index, line) in text.lines().enumerate() {
            for (head, tail) in UNFINISHED {
                let needle = format!("{head}{tail}");
                if line.contains(&needle) {
                    offences.push(Offence::new(
                        file,
                        index + 1,
                        format!("`{needle}` is not committed"),
                    ));
                }
            }
        }
        let length = text.lines().count();
        if length > LONGEST {
            offences.push(Offence::new(
                file,
                LONGEST + 1,
                format!("{length} lines, more than {LONGEST}"),
            ));
        }
    }
    Ok(offences)
}

/// Text files that name a folder of one machine. The lock file is cargo's.
fn check_machine_paths(tree: &Tree) -> io::Result<Vec<Offence>> {
    let mut offences = Vec::new();
    for file in tree.files().filter(|file| *file != "Cargo.lock") {
        let text = match tree.read(file) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::InvalidData => continue, // no text
            Err(error) => return Err(error),
        };
        for (index, line) in text.lines().enumerate() {
            if let Some(folder) = machine_folder(line) {
                offences.push(Offence::new(
                    file,
                    index + 1,
                    format!("`/{folder}/` is a folder of one machine"),
                ));
            }
        }
    }
    Ok(offences)
}

/// The machine folder that an absolute path in `line` leads to. A slash after a name is the middle of another path.
fn machine_folder(line: &str) -> Option<&'static str> {
    line.match_indices('/').find_map(|(at, _)| {
        let (before, after) = (line.get(..at)?, line.get(at + 1..)?);
        let is_start = before
            .chars()
            .next_back()
            .is_none_or(|c| !c.is_alphanumeric() && !"._-~}*".contains(c));
        MACHINE_FOLDERS.into_iter().find(|folder| {
            is_start && after.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'))
        })
    })
}

/// Manifests without the workspace's lints, a licence or a description.
fn check_manifests(tree: &Tree) -> io::Result<Vec<Offence>> {
    let (root, members) = Manifest::workspace(tree)?;
    let mut offences = Vec::new();
    for member in &members {
        let mut must = |holds: bool, what: &str| {
            if !holds {
                offences.push(Offence::new(&member.file, 1, what));
            }
        };
        must(
            member.get(&["lints", "workspace"]) == Some(&Value::Boolean(true)),
            "no `[lints] workspace = true`",
        );
        must(is_given(member, &root, "license"), "no `license`");
        must(is_given(member, &root, "description"), "no `description`");
    }
    Ok(offences)
}

/// True if the package has a text under `key`, its own or the workspace's.
fn is_given(member: &Manifest, root: &Manifest, key: &str) -> bool {
    let inherited = member.get(&["package", key, "workspace"]) == Some(&Value::Boolean(true));
    let value = if inherited {
        root.get(&["workspace", "package", key])
    } else {
        member.get(&["package", key])
    };
    value.and_then(Value::as_str).is_some_and(|text| !text.trim().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn sources_are_finished_and_short() -> io::Result<()> {
        assert_none(&check_sources(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn no_file_names_a_folder_of_one_machine() -> io::Result<()> {
        assert_none(&check_machine_paths(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn manifests_say_what_they_must() -> io::Result<()> {
        assert_none(&check_manifests(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn unfinished_and_long_sources_are_found() {
        let unfinished = UNFINISHED.map(|(head, tail)| format!("{head}{tail}")).join("\n");
        let long = "\n".repeat(LONGEST + 1);
        let fits = "\n".repeat(LONGEST);
        let (_folder, tree) = fake::tree(&[
            ("a.rs", &unfinished),
            ("b.rs", &long),
            ("c.rs", &fits),
            ("d.md", &unfinished),
        ]);
        let found: Vec<_> =
            check_sources(&tree).unwrap().iter().map(|o| (o.file.clone(), o.line)).collect();
        let expected = [("a.rs", 1), ("a.rs", 2), ("a.rs", 3), ("a.rs", 4), ("b.rs", 701)];
        assert_eq!(found, expected.map(|(file, line)| (file.to_owned(), line)));
    }

    #[test]
    fn machine_folders_are_told_from_the_middle_of_a_path() {
        let path = |before: &str, folder: &str| format!("{before}/{folder}/x");
        for before in ["", "see ", "(", "\"", "a=", "file://", "`"] {
            assert_eq!(machine_folder(&path(before, "home")), Some("home"), "{before}");
        }
        for before in ["docs", "https://host", "..", "${HERE}", "a-b", "~"] {
            assert_eq!(machine_folder(&path(before, "work")), None, "{before}");
        }
        assert_eq!(machine_folder("/workpiece/x /dev/root"), None);
    }

    #[test]
    fn a_file_with_a_machine_folder_is_found_but_not_in_the_lock_or_in_binaries() {
        let path = format!("ok\nlog to /{}/me\n", "home");
        let (folder, _) = fake::tree(&[("a.md", &path), ("Cargo.lock", &path)]);
        std::fs::write(folder.path().join("b.png"), [&[0xff, 0xfe][..], path.as_bytes()].concat())
            .unwrap();
        let tree = Tree::walk(folder.path()).unwrap();
        let found: Vec<_> =
            check_machine_paths(&tree).unwrap().iter().map(|o| (o.file.clone(), o.line)).collect();
        assert_eq!(found, [("a.md".to_owned(), 2)]);
    }

    #[test]
    fn a_bare_manifest_is_found() {
        let root =
            "[workspace]\nmembers = [\"good\", \"bare\"]\n[workspace.package]\nlicense = \"MIT\"\n";
        let good = "[package]\nname = \"good\"\ndescription = \"x\"\nlicense.workspace = true\n[lints]\nworkspace = true\n";
        let bare = "[package]\nname = \"bare\"\ndescription = \" \"\n";
        let (_folder, tree) = fake::tree(&[
            ("Cargo.toml", root),
            ("good/Cargo.toml", good),
            ("bare/Cargo.toml", bare),
        ]);
        let found: Vec<_> =
            check_manifests(&tree).unwrap().iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "bare/Cargo.toml:1: no `[lints] workspace = true`",
                "bare/Cargo.toml:1: no `license`",
                "bare/Cargo.toml:1: no `description`"
            ]
        );
    }
}
