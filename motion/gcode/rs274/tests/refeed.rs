//! Tests of feed reduction: only the F words that must change do.

use super::corpus;
use super::random::{programs, scraps};
use super::*;
use crate::refeed::tests::{
    Dialect, Table, check_bytes, check_examples, check_path, check_program, tables, written,
};
use crate::refeed::{LineLimit, Reason, Refed, RefeedError};
use crate::rs274::refeed;
use proptest::prelude::*;
use std::fs;
use std::io::{self, BufReader, Cursor};

struct Rs274;

impl Dialect for Rs274 {
    fn refeed(
        program: BufReader<Cursor<&[u8]>>,
        limits: impl Iterator<Item = io::Result<LineLimit>>,
        out: &mut Vec<u8>,
    ) -> Result<Refed, RefeedError> {
        refeed(program, &DecoderOptions::default(), limits, out)
    }

    fn path(program: &[u8]) -> Vec<PathElement> {
        decode_with(DecoderOptions::default(), program).elements
    }

    fn is_governed(element: &PathElement) -> bool {
        element.kind == ElementKind::Cut
    }

    fn limit_of(table: &Table, element: &PathElement) -> f64 {
        table.get(&(element.place.line, false)).copied().unwrap_or(f64::INFINITY)
    }
}

/// Limits in mm per minute.
#[test]
fn feeds_are_lowered_where_they_must() {
    check_examples::<Rs274>(include_str!("refeed.json"), 1.0 / 6e4);
}

/// F does not reach rapids, also those of canned cycles; the cut of a cycle it does. Threads keep their feed. No F is
/// low enough for 0.
#[test]
fn what_stays_too_fast_is_reported() {
    use Reason::{NoFeed, Rapid, Thread};
    for (program, limits, expected, reported) in [
        (
            "G0 X10\nG81 X1 Z-1 R1 F100\nX5\nG1 X6\nM2",
            &[((1, true), 0.05), ((2, true), 0.01), ((2, false), 50.0 / 6e4), ((3, true), 0.2)][..],
            "G0 X10\nG81 X1 Z-1 R1 F50\nX5 F100\nG1 X6\nM2",
            &[(1, Rapid, 0.05), (2, Rapid, 0.01)][..],
        ),
        ("G1 X1 F10\nM2", &[((1, false), 0.0)], "G1 X1 F10\nM2", &[(1, NoFeed, 0.0)]),
        (
            "G93\nG1 X1 F1\nX2 F1\nM2",
            &[((2, false), 0.05 / 6e4), ((3, false), 0.0)],
            "G93\nG1 X1 F0.05\nX2 F1\nM2",
            &[(3, NoFeed, 0.0)],
        ),
        // Threads and tapping need their feeds.
        (
            "F60 M3 S60 G84 Z-1 R1\nG33 Z5 K2\nG1 X5\nM2",
            &[((1, false), 0.5e-3), ((2, false), 1e-3), ((3, false), 0.5e-3)],
            "F60 M3 S60 G84 Z-1 R1\nG33 Z5 K2\nG1 X5 F30\nM2",
            &[(1, Thread, 0.5e-3), (2, Thread, 1e-3)],
        ),
    ] {
        let (text, refed) = written::<Rs274>(program.as_bytes(), &limits.iter().copied().collect());
        assert_eq!(String::from_utf8_lossy(&text), expected);
        let found = refed.unrepaired.iter().map(|one| (one.place.line, one.reason, one.limit));
        assert_eq!(found.collect::<Vec<_>>(), reported);
    }
}

proptest! {
    #[test]
    fn only_feeds_change(
        (lines, table) in programs().prop_flat_map(|lines| {
            let count = u32::try_from(lines.len()).unwrap();
            (Just(lines), tables(count))
        }),
        feeds in prop::collection::vec((0..40_usize, 1..9_000), 0..6),
        inverse in prop::option::of((0..40_usize, 0..40_usize)),
    ) {
        let mut lines = lines;
        for (line, feed) in feeds {
            if let Some(line) = lines.get_mut(line).filter(|line| !line.contains(['F', '(', ';'])) {
                *line = format!("{line} F{}", f64::from(feed) / 10.0);
            }
        }
        if let Some((from, count)) = inverse {
            let from = from.min(lines.len());
            for line in lines.iter_mut().skip(from).take(count).filter(|line| !line.contains(['F', '(', ';'])) {
                line.push_str(" F3.7");
            }
            lines.insert(from, "G93".to_owned());
            lines.insert((from + count).min(lines.len()), "G94 F50".to_owned());
        }
        let refed = check_program::<Rs274>(&lines.join("\n"), &table)?;
        prop_assert!(refed.unrepaired.iter().all(|one| one.reason == Reason::Rapid));
    }

    #[test]
    fn any_bytes_come_back(program in scraps(), table in tables(20), capacity in 1..40_usize) {
        check_bytes::<Rs274>(&program, &table, capacity)?;
    }
}

/// Half of what is programmed on every third line of other people's programs.
#[test]
fn programs_of_others() {
    let Some(folder) = corpus::corpus() else { return };
    let (mut lines, mut changed, mut repeated) = (0, 0, Vec::new());
    for (name, ..) in corpus::programs("within") {
        let program = fs::read(folder.join(name)).unwrap();
        let options = DecoderOptions::default();
        let whole = refeed(&program[..], &options, [], std::io::sink());
        if let Err(RefeedError::Repeated(line)) = whole {
            // It has loops, and nothing of it is rewritten.
            repeated.push((name, line));
            continue;
        }
        let before = Rs274::path(&program);
        let mut table = Table::new();
        for element in before.iter().filter(|element| Rs274::is_governed(element)) {
            if element.place.line.is_multiple_of(3) {
                let limit = table.entry((element.place.line, false)).or_insert(f64::INFINITY);
                *limit = limit.min(element.feed / 2.0);
            }
        }
        let (text, refed) = written::<Rs274>(&program, &table);
        assert_eq!(refed.unrepaired, [], "{name}");
        check_path::<Rs274>(&before, &Rs274::path(&text), &table, &refed).unwrap();
        let (again, second) = written::<Rs274>(&text, &table);
        assert!(again == text, "{name}");
        assert_eq!(second.changed, 0, "{name}");
        // Lines that do not change do not change at all.
        let same = program.split(|byte| *byte == b'\n').zip(text.split(|byte| *byte == b'\n'));
        let different = same.filter(|(old, new)| old != new).count() as u64;
        assert_eq!(different, refed.changed, "{name}");
        let (same, _) = written::<Rs274>(&program, &Table::new());
        assert!(same == program, "{name}");
        lines += refed.lines;
        changed += refed.changed;
    }
    println!("{changed} of {lines} lines changed");
    assert!(changed > 50_000, "{changed} of {lines}");
    assert!(repeated.contains(&("linuxcnc_debian/flowsnake.ngc", 5)), "{repeated:?}");
}

#[test]
fn late_limits_are_errors() {
    let program = "G1 X1 F1\n".repeat(600);
    let limits = [500, 1].map(|line| Ok(LineLimit { line, rapid: false, feed: 1.0 }));
    let failed = refeed(program.as_bytes(), &DecoderOptions::default(), limits, Vec::new());
    assert!(matches!(failed, Err(RefeedError::Late(1))), "{failed:?}");
}
