//! Tests that the table of blocks in docs/src/jobs.md lists every block that jobs accept, with every key.

use super::machine;
use crate::job::kind::BLOCKS;
use crate::job::read::{Known, Lines, Reader};
use crate::job::{CamsBefore, block_names};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use twin_machine::axis_kind::AxisKind;
use twin_machine::section::{Section, parse};

/// Keys of every block.
const COMMON: [&str; 6] =
    ["block", "axis", "at_s", "after_s", "with_previous", "at_end_of_profile"];

const BEGIN: &str = "| block | keys | the next block begins |";

/// The keys that the reader asks for, with `…` for the units.
fn asked(name: &str) -> BTreeSet<String> {
    let machine = machine();
    // X is in mm and its master in degrees, so that both units occur.
    let mut axes: Vec<_> = machine.axes.iter().map(Known::of).collect();
    axes.push(Known {
        name: "shaft".to_owned(),
        kind: AxisKind::Rotary,
        max_acceleration: None,
        max_deceleration: None,
    });
    let text = format!("[[blocks]]\nblock = \"{name}\"\naxis = \"X\"\nmaster = \"shaft\"\n");
    let mut keys = BTreeSet::new();
    let (lines, path) = (Lines::of(&text), Path::new("job.toml"));
    let reader = Reader { lines, path, axes, triggers: Vec::new() };
    let _complaints = parse(&text, |root| {
        let sections = root.sections("blocks");
        for section in &sections {
            reader.calls(section, &machine, 0, &mut CamsBefore::default());
            keys = section.asked_for();
        }
        sections.iter().for_each(Section::accept_all);
        Some(())
    });
    let unit = |key: &String| key.replace("_mm", "_…").replace("_deg", "_…");
    keys.iter().map(unit).filter(|key| !COMMON.contains(&key.as_str())).collect()
}

/// The keys between backticks in the row of each block of docs/src/jobs.md.
fn documented() -> BTreeMap<String, BTreeSet<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src/jobs.md");
    let guide = std::fs::read_to_string(path).unwrap();
    let table = guide.split_once(BEGIN).expect("the table").1;
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let quoted = |cell: &str| -> Vec<String> {
        cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
    };
    let mut found = BTreeMap::new();
    for row in rows {
        let cells: Vec<_> = row.split('|').collect();
        for block in quoted(cells[1]) {
            let keys = quoted(cells[2]).into_iter().collect();
            assert!(found.insert(block.clone(), keys).is_none(), "{block} twice");
        }
    }
    found
}

#[test]
fn the_table_of_blocks_is_what_jobs_take() {
    let documented = documented();
    let names: BTreeSet<_> = BLOCKS.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(documented.keys().cloned().collect::<BTreeSet<_>>(), names);
    for (name, keys) in &documented {
        assert_eq!(keys, &asked(name), "{name}");
    }
}

/// `twin explain` and the reference list the block that runs a program like the others.
#[test]
fn the_interpolator_is_a_block_of_jobs() {
    assert_eq!(block_names().filter(|name| *name == "SMC_Interpolator").count(), 1);
}
