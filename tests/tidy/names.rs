//! Check of manual names: every `MC_` and `SMC_` name in `docs/coverage.md` has a type or a `#[doc(alias)]`. It covers
//! the cams, axes and their files that the page reports as working, so that the documentation search finds them.

use crate::markdown;
use crate::tree::{Offence, Tree};
use std::collections::BTreeSet;
use std::io;

const PAGE: &str = "docs/coverage.md";
/// The sections whose names are blocks, structures and enumerations that somebody may look for.
const SECTIONS: [&str; 4] =
    ["CAM (manual 4)", "SM_DriveBasic.lib", "SM_PLCopen.lib", "SM_FileFBs.lib"];
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
    let page = tree.read(PAGE)?;
    let mut offences = Vec::new();
    let mut inside = false;
    for (index, line) in page.lines().enumerate() {
        if let Some(heading) = line.strip_prefix("### ").or_else(|| line.strip_prefix("## ")) {
            inside = SECTIONS.iter().any(|section| heading.starts_with(section));
        }
        let Some(cells) = markdown::cells(line).filter(|_| inside) else { continue };
        let (Some(item), Some(state)) = (cells.first(), cells.last()) else { continue };
        if !state.starts_with("works") {
            continue;
        }
        for name in names(item).filter(|name| !name.starts_with(OF_FILES) && !known.contains(*name))
        {
            let what = format!(
                "`{name}` works, and nothing of motion, drives or twin has its name or `#[doc(alias = \"{name}\")]`"
            );
            offences.push(Offence::new(PAGE, index + 1, what));
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
fn a_name_without_an_alias_is_told() {
    let row = |item: &str, state: &str| format!("| {item} | 5.3 | | | {state} |\n");
    let page = format!(
        "## SoftMotion\n### SM_PLCopen.lib (manual 5)\n{}{}{}{}### CNC\n{}",
        row("`MC_Halt` brakes", "works"),
        row("`MC_Stop` and `SMC_Table_<T>`", "works"),
        row("`MC_Home`", "left out: none"),
        row("`SMC_Own`", "works"),
        row("`SMC_Elsewhere`", "works")
    );
    let source = "#[doc(alias = \"MC_Halt\")]\npub struct Halt;\npub struct SMC_Own;\n#[doc(alias = \"SMC_Table\")]\n";
    let (_folder, tree) = crate::tree::fake::tree(&[(PAGE, &page), ("motion/halt.rs", source)]);
    let told: Vec<_> =
        check(&tree).expect("readable").into_iter().map(|one| (one.line, one.what)).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0 == 4 && told[0].1.starts_with("`MC_Stop` works"), "{told:?}");
}
