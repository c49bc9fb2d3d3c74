//! Check of manual names: every `MC_` and `SMC_` name in `tests/coverage` has a type or a `#[doc(alias)]`. It covers
//! the cams, axes and their files that are there, so that the documentation search finds them.

use crate::coverage::table::{self, State};
use crate::tree::{Offence, Tree};
use std::collections::BTreeSet;
use std::io;

/// The chapters whose names are blocks, structures and enumerations that somebody may look for.
const CHAPTERS: [&str; 4] = ["CAM", "SM_DriveBasic.lib", "SM_PLCopen.lib", "SM_FileFBs.lib"];
/// Names of tables of examples, and types of variables that are said by words in a file.
const OF_FILES: &str = "SMC_TYPE_";
const CRATES: [&str; 3] = ["motion/", "drives/", "twin/"];

/// Names without a place where they are found.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let mut known = BTreeSet::new();
    for file in
        tree.with_extension("rs").filter(|file| CRATES.iter().any(|one| file.starts_with(one)))
    {
        let text = tree.read(file)?;
        known.extend(text.lines().filter_map(declared).map(str::to_owned));
    }
    let (rows, _) = table::read(tree)?;
    let is_there = |state| matches!(state, State::Works | State::Library);
    let searched = |chapter: &str| CHAPTERS.iter().any(|one| chapter.starts_with(one));
    let mut offences = Vec::new();
    for row in rows.iter().filter(|row| is_there(row.state) && searched(&row.chapter)) {
        let unknown = |name: &&str| !name.starts_with(OF_FILES) && !known.contains(*name);
        for name in names(&row.item).filter(unknown) {
            let what = format!(
                "nothing of motion, drives or twin is named `{name}` or has `#[doc(alias = \"{name}\")]`"
            );
            offences.push(row.offence(what));
        }
    }
    Ok(offences)
}

/// The name that a line of source makes known.
fn declared(line: &str) -> Option<&str> {
    let line = line.trim();
    if let Some(alias) = line.strip_prefix("#[doc(alias = \"") {
        return alias.split('"').next();
    }
    let kinds = ["pub struct ", "pub enum ", "pub trait ", "pub type ", "pub fn ", "pub const "];
    let rest = kinds.iter().find_map(|kind| line.strip_prefix(kind))?;
    rest.split(|c: char| !is_of_name(c)).next()
}

fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Names of the manual's blocks in a cell. What ends with a place to be filled in (`SMC_CAMTable_<T>`) counts without it.
fn names(cell: &str) -> impl Iterator<Item = &str> {
    let words = cell.split(|c: char| !is_of_name(c));
    let of_manual = |word: &&str| word.starts_with("MC_") || word.starts_with("SMC_");
    words.filter(of_manual).map(|word| word.trim_end_matches('_'))
}

#[test]
fn names_of_the_manual_are_found() {
    let tree = Tree::workspace().expect("the workspace");
    crate::tree::assert_none(&check(&tree).expect("readable"));
}

#[test]
fn a_name_without_an_alias_is_found() {
    let table = table::fake::table(&[
        "`MC_Halt` brakes,works,MC_Halt,,,",
        "`MC_Stop` and `SMC_Table_<T>`,library,twin_axis::Stop,,,",
        "`MC_Home`,left out,,none,,",
        "`SMC_Own`,works,twin check,,,",
    ]);
    let (ours, other) =
        (table.replace(",C,", ",SM_PLCopen.lib,"), table.replace(",C,", ",SM_CNC.lib,"));
    let source = "#[doc(alias = \"MC_Halt\")]\npub struct Halt;\npub struct SMC_Own;\n#[doc(alias = \"SMC_Table\")]\n";
    let (_folder, tree) = crate::tree::fake::tree(&[
        ("tests/coverage/ours.csv", &ours),
        ("tests/coverage/other.csv", &other),
        ("motion/halt.rs", source),
    ]);
    let found = check(&tree).expect("readable");
    let [only] = found.as_slice() else { panic!("one offence: {found:?}") };
    assert!(only.line == 3 && only.what.contains("is named `MC_Stop`"), "{only}");
}
