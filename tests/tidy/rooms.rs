//! Check that every drive family has the same rooms, so that who knows one finds the way in all of them.

use crate::manifest::Manifest;
use crate::tree::{Offence, Tree, join};
use std::collections::BTreeSet;
use std::io;

/// The rooms of a family.
const ROOMS: [&str; 6] = ["assumptions", "client", "drive", "emulator", "prediction", "protocol"];
/// Modules next to them: the root, the file that joins the rooms for the list of families, tests and examples.
const OTHERS: [&str; 4] = ["examples", "family", "lib", "tests"];

/// Rooms that a family lacks, and modules that are not a room.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let (_, members) = Manifest::workspace(tree)?;
    let families = members.iter().filter(|member| {
        let folder = member.folder.strip_prefix("drives/");
        folder.is_some_and(|folder| folder != "tests")
    });
    let mut offences = Vec::new();
    for family in families {
        let inside = join(&family.folder, "");
        let modules: BTreeSet<_> = tree
            .with_extension("rs")
            .filter_map(|file| file.strip_prefix(&inside)?.strip_prefix('/'))
            .filter_map(|file| file.split(['/', '.']).next())
            .collect();
        let missing = ROOMS.iter().filter(|room| !modules.contains(*room));
        offences.extend(
            missing.map(|room| {
                Offence::new(&family.file, 1, format!("the family has no room `{room}`"))
            }),
        );
        let strange = modules.iter().filter(|one| !ROOMS.contains(one) && !OTHERS.contains(one));
        offences.extend(strange.map(|one| {
            Offence::new(&family.file, 1, format!("`{one}` is not one of the rooms of a family"))
        }));
    }
    Ok(offences)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn families_have_the_same_rooms() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn a_missing_room_and_a_strange_one_are_found() {
        let package = "[package]\nname = \"a\"\n";
        let mut files = vec![
            ("Cargo.toml", "[workspace]\nmembers = [\"drives/a\", \"drives/tests\"]\n"),
            ("drives/a/Cargo.toml", package),
            ("drives/tests/Cargo.toml", package),
            ("drives/tests/main.rs", ""),
            ("drives/a/lib.rs", ""),
            ("drives/a/tests/mod.rs", ""),
            ("drives/a/driver.rs", ""),
        ];
        let rooms = ROOMS.iter().filter(|room| **room != "client");
        let rooms: Vec<_> = rooms.map(|room| format!("drives/a/{room}/mod.rs")).collect();
        files.extend(rooms.iter().map(|file| (file.as_str(), "")));
        let (_folder, tree) = fake::tree(&files);
        let found: Vec<_> = check(&tree).unwrap().iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "drives/a/Cargo.toml:1: the family has no room `client`",
                "drives/a/Cargo.toml:1: `driver` is not one of the rooms of a family",
            ]
        );
    }
}
