//! Check for import circles between the rooms of a crate: a room must not import, directly or indirectly, a room that
//! imports it.
//!
//! A room is a folder or a file directly under the root of a crate; between crates cargo itself allows no circle.
//! Imports are `use` items and paths in code that begin with `crate`, `super` or `self`; tests may import anything.

use crate::manifest::Manifest;
use crate::tree::{Offence, Tree, join};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use syn::visit::{self, Visit};
use syn::{Attribute, Ident, Item, ItemMod, ItemUse, Macro, Path, UseTree, Visibility};

/// Imports between rooms: from, to, and the file of one such import.
type Arrows = BTreeMap<String, BTreeMap<String, String>>;

/// Every circle of every crate, reported at one import of each of its rooms.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let (_, members) = Manifest::workspace(tree)?;
    let mut offences = Vec::new();
    for member in members {
        let root = join(&member.folder, "lib.rs");
        if tree.is_file(&root) {
            offences.extend(circles(&arrows(tree, &member.folder)?));
        }
    }
    Ok(offences)
}

/// Rooms that reach themselves.
fn circles(arrows: &Arrows) -> Vec<Offence> {
    let mut offences = Vec::new();
    for (room, imports) in arrows {
        for (other, file) in imports {
            if reaches(arrows, other, room) {
                let what = format!("`{room}` imports `{other}`, which imports `{room}`");
                offences.push(Offence::new(file, 1, what));
            }
        }
    }
    offences
}

/// True if imports lead from one room to another.
fn reaches(arrows: &Arrows, from: &str, to: &str) -> bool {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(room) = open.pop() {
        if room == to {
            return true;
        }
        if seen.insert(room) {
            open.extend(arrows.get(room).into_iter().flatten().map(|(next, _)| next.as_str()));
        }
    }
    false
}

/// The imports between the rooms of the crate in `folder`.
fn arrows(tree: &Tree, folder: &str) -> io::Result<Arrows> {
    let mut reader = Reader {
        tree,
        arrows: Arrows::new(),
        handed_on: BTreeMap::new(),
        file: String::new(),
        module: Vec::new(),
    };
    reader.read(&join(folder, "lib.rs"), folder, &[])?;
    let Reader { arrows, handed_on, .. } = reader;
    // What the root hands on belongs to the room that it comes from.
    let mut between = Arrows::new();
    for (from, imports) in &arrows {
        for (to, file) in imports {
            let to = handed_on.get(to).unwrap_or(to);
            if arrows.contains_key(to) && to != from {
                between.entry(from.clone()).or_default().insert(to.clone(), file.clone());
            }
        }
    }
    Ok(between)
}

struct Reader<'a> {
    tree: &'a Tree,
    arrows: Arrows,
    /// Names that the root re-exports, and the rooms that define them.
    handed_on: BTreeMap<String, String>,
    file: String,
    /// The module of the code being read, from the root of the crate.
    module: Vec<String>,
}

impl Reader<'_> {
    /// Reads a file and the files of its modules, which are in `folder`.
    fn read(&mut self, file: &str, folder: &str, module: &[String]) -> io::Result<()> {
        let text = self.tree.read(file)?;
        let parsed =
            syn::parse_file(&text).map_err(|error| io::Error::other(format!("{file}: {error}")))?;
        (self.file, self.module) = (file.to_owned(), module.to_owned());
        if let Some(room) = module.first() {
            self.arrows.entry(room.clone()).or_default();
        }
        self.visit_file(&parsed);
        for item in &parsed.items {
            let Item::Mod(inner) = item else { continue };
            if inner.content.is_some() || is_test(&inner.attrs) {
                continue;
            }
            let name = inner.ident.to_string();
            let name = name.trim_start_matches("r#");
            let below = [module, &[name.to_owned()]].concat();
            let (flat, nested) = (join(folder, &format!("{name}.rs")), join(folder, name));
            let found = if self.tree.is_file(&flat) { flat } else { join(&nested, "mod.rs") };
            self.read(&found, &nested, &below)?;
        }
        Ok(())
    }

    /// Notes what a path leads to.
    fn path(&mut self, segments: &[String]) {
        let mut place = self.module.clone();
        let mut rest = segments;
        match segments.first().map(String::as_str) {
            Some("crate") => place.clear(),
            Some("self" | "super") => {}
            _ => return,
        }
        while let Some((first, more)) = rest.split_first() {
            match first.as_str() {
                "crate" | "self" => {}
                "super" => drop(place.pop()),
                _ => break,
            }
            rest = more;
        }
        place.extend(rest.iter().cloned());
        if let (Some(from), Some(to)) = (self.module.first(), place.first())
            && from != to
        {
            let imports = self.arrows.entry(from.clone()).or_default();
            imports.entry(to.clone()).or_insert_with(|| self.file.clone());
        }
    }

    /// Notes every name of a `use` item.
    fn tree(&mut self, tree: &UseTree, before: &[String]) {
        let with = |name: &Ident| [before, &[name.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.tree(&path.tree, &with(&path.ident)),
            UseTree::Name(name) => self.path(&with(&name.ident)),
            UseTree::Rename(name) => self.path(&with(&name.ident)),
            UseTree::Glob(_) => self.path(before),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.tree(tree, before)),
        }
    }

    /// Notes the names that the root of the crate re-exports.
    fn hand_on(&mut self, tree: &UseTree, room: Option<&str>) {
        match (tree, room) {
            (UseTree::Path(path), None) => self.hand_on(&path.tree, Some(&path.ident.to_string())),
            (UseTree::Path(path), Some(_)) => self.hand_on(&path.tree, room),
            (UseTree::Group(group), _) => {
                group.items.iter().for_each(|tree| self.hand_on(tree, room));
            }
            (UseTree::Name(name), Some(room)) => {
                self.handed_on.insert(name.ident.to_string(), room.to_owned());
            }
            (UseTree::Rename(name), Some(room)) => {
                self.handed_on.insert(name.rename.to_string(), room.to_owned());
            }
            _ => {}
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let attributes = match item {
            Item::Fn(item) => &item.attrs,
            Item::Impl(item) => &item.attrs,
            Item::Use(item) => &item.attrs,
            Item::Const(item) => &item.attrs,
            Item::Struct(item) => &item.attrs,
            _ => return visit::visit_item(self, item),
        };
        if !is_test(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if module.content.is_some() && !is_test(&module.attrs) {
            self.module.push(module.ident.to_string());
            visit::visit_item_mod(self, module);
            self.module.pop();
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if self.module.is_empty() && !matches!(item.vis, Visibility::Inherited) {
            self.hand_on(&item.tree, None);
        }
        self.tree(&item.tree, &[]);
    }

    fn visit_path(&mut self, path: &'ast Path) {
        let segments: Vec<_> = path.segments.iter().map(|one| one.ident.to_string()).collect();
        self.path(&segments);
        visit::visit_path(self, path);
    }

    /// Arguments of macros are tokens: paths in them are found as text.
    fn visit_macro(&mut self, invoked: &'ast Macro) {
        visit::visit_macro(self, invoked);
        let text = invoked.tokens.to_string().replace(' ', "");
        for (place, _) in text.match_indices("crate::") {
            let path =
                text[place..].split(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | ':')));
            let segments = path.take(1).flat_map(|path| path.split("::"));
            let segments: Vec<_> = segments.map(str::to_owned).collect();
            self.path(&segments);
        }
    }
}

/// True if an item is compiled for tests only.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let is_cfg = attribute.path().is_ident("cfg");
        attribute.path().is_ident("test")
            || is_cfg && attribute.parse_args::<Ident>().is_ok_and(|what| what == "test")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn no_room_imports_what_imports_it() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    const ROOT: (&str, &str) = ("Cargo.toml", "[workspace]\nmembers = [\"a\"]\n");
    const CRATE: (&str, &str) = ("a/Cargo.toml", "[package]\nname = \"a\"\n");

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let (_folder, tree) = fake::tree(&[&[ROOT, CRATE], files].concat());
        check(&tree).unwrap().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn imports_down_and_within_a_room_are_fine() {
        let files = [
            ("a/lib.rs", "mod high; mod low; pub use low::Thing;"),
            ("a/high/mod.rs", "mod inner; use crate::low::Thing; use self::inner::One;"),
            ("a/high/inner.rs", "use super::Two; use crate::Thing; fn f() { crate::low::g(); }"),
            ("a/low.rs", "#[cfg(test)] mod tests { use crate::high::Two; }"),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn a_circle_is_found_however_it_is_imported() {
        for import in [
            "use crate::{high::Two, Other};",
            "use super::high::Two;",
            "fn f() { crate::high::g() }",
            "fn f(two: crate::Two) {}",
            "fn f() { println!(\"{}\", crate::high::g()) }",
            "mod inner { use super::super::high::Two; }",
        ] {
            let files = [
                ("a/lib.rs", "mod high; mod middle; mod low; pub use high::Two;"),
                ("a/high.rs", "use crate::middle;"),
                ("a/middle.rs", "use super::low::Thing;"),
                ("a/low.rs", import),
            ];
            let found = found(&files);
            assert_eq!(found.len(), 3, "{import}: {found:?}");
            assert_eq!(found[1], "a/low.rs:1: `low` imports `high`, which imports `low`");
        }
    }
}
