//! Check for dead source files: `mod` reaches every file from something that cargo builds.

use crate::manifest::Manifest;
use crate::tree::{Offence, Tree, join, parent};
use std::collections::BTreeSet;
use std::io;
use syn::{Attribute, Expr, Item, Lit, Meta};

/// Files that no `mod` reaches, and `mod`s that reach no file.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let mut search = Search { tree, reached: BTreeSet::new(), offences: Vec::new() };
    let (root, members) = Manifest::workspace(tree)?;
    for member in members.into_iter().chain(root.excluded(tree)?) {
        for root in member.target_roots(tree) {
            search.file(&root, Place::Folder)?;
        }
    }
    let Search { reached, mut offences, .. } = search;
    let dead = tree.with_extension("rs").filter(|file| !reached.contains(*file));
    offences.extend(
        dead.map(|file| Offence::new(file, 1, "no `mod` names this file, so it is never compiled")),
    );
    Ok(offences)
}

/// Location of the modules declared in a file.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// Beside the file: roots, `mod.rs` and what `#[path]` names.
    Folder,
    /// In a folder named after the file.
    Below,
}

struct Search<'a> {
    tree: &'a Tree,
    reached: BTreeSet<String>,
    offences: Vec<Offence>,
}

impl Search<'_> {
    fn file(&mut self, file: &str, place: Place) -> io::Result<()> {
        if self.reached.contains(file) {
            return Ok(());
        }
        let text = self.tree.read(file)?;
        let parsed =
            syn::parse_file(&text).map_err(|error| io::Error::other(format!("{file}: {error}")))?;
        let folder = match place {
            Place::Folder => parent(file).to_owned(),
            Place::Below => file.trim_end_matches(".rs").to_owned(),
        };
        self.reached.insert(file.to_owned());
        self.items(file, &text, &parsed.items, &folder, parent(file))
    }

    /// `folder` holds the modules of these items, `path_folder` is where a `#[path]` counts from.
    fn items(
        &mut self,
        file: &str,
        text: &str,
        items: &[Item],
        folder: &str,
        path_folder: &str,
    ) -> io::Result<()> {
        for item in items {
            let Item::Mod(module) = item else { continue };
            let name = module.ident.to_string();
            let name = name.trim_start_matches("r#");
            let given = path_attribute(&module.attrs);
            if let Some((_, inner)) = &module.content {
                let folder =
                    given.map_or_else(|| join(folder, name), |path| join(path_folder, &path));
                self.items(file, text, inner, &folder, &folder)?;
            } else if let Some((file, place)) = self.find(name, given, folder, path_folder) {
                self.file(&file, place)?;
            } else {
                let line = text.lines().position(|line| line.contains(&format!("mod {name};")));
                let what = format!("`mod {name};` has no file");
                self.offences.push(Offence::new(file, line.map_or(1, |index| index + 1), what));
            }
        }
        Ok(())
    }

    fn find(
        &self,
        name: &str,
        given: Option<String>,
        folder: &str,
        path_folder: &str,
    ) -> Option<(String, Place)> {
        let candidates = match given {
            Some(path) => vec![(join(path_folder, &path), Place::Folder)],
            None => vec![
                (join(folder, &format!("{name}.rs")), Place::Below),
                (join(folder, &format!("{name}/mod.rs")), Place::Folder),
            ],
        };
        candidates.into_iter().find(|(file, _)| self.tree.is_file(file))
    }
}

/// The text of `#[path = "…"]`.
fn path_attribute(attributes: &[Attribute]) -> Option<String> {
    attributes.iter().find_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("path") => match &pair.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn every_source_file_is_compiled() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    const ROOT: (&str, &str) = ("Cargo.toml", "[workspace]\nmembers = [\"a\"]\n");
    const CRATE: (&str, &str) =
        ("a/Cargo.toml", "[package]\nname = \"a\"\nautotests = false\n[lib]\npath = \"lib.rs\"\n");

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let (_folder, tree) = fake::tree(&[&[ROOT, CRATE], files].concat());
        check(&tree).unwrap().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn modules_are_followed_wherever_they_may_be() {
        let files = [
            (
                "a/lib.rs",
                "mod one; mod two; mod inner { mod three; } #[path = \"odd/name.rs\"] mod four; mod r#type;",
            ),
            ("a/one.rs", "mod child;"),
            ("a/one/child.rs", ""),
            ("a/two/mod.rs", "#[cfg(test)] mod tests;"),
            ("a/two/tests.rs", "const TEXT: &str = \"mod nothing;\"; // mod nothing;"),
            ("a/inner/three.rs", ""),
            ("a/odd/name.rs", "mod beside;"),
            ("a/odd/beside.rs", ""),
            ("a/type.rs", ""),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn a_file_that_no_mod_names_is_found() {
        let files = [
            ("a/lib.rs", "mod one; // mod dead;"),
            ("a/one.rs", "const TEXT: &str = \"mod dead;\";"),
            ("a/dead.rs", "mod deeper;"),
            ("a/dead/deeper.rs", ""),
            ("a/tests/run.rs", ""),
        ];
        let what = "no `mod` names this file, so it is never compiled";
        let dead = ["a/dead.rs", "a/dead/deeper.rs", "a/tests/run.rs"];
        assert_eq!(found(&files), dead.map(|file| format!("{file}:1: {what}")));
    }

    #[test]
    fn a_mod_without_a_file_is_found() {
        let files = [("a/lib.rs", "\n#[cfg(feature = \"x\")]\nmod gone;\n")];
        assert_eq!(found(&files), ["a/lib.rs:3: `mod gone;` has no file"]);
    }
}
