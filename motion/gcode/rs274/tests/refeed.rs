//! Tests of feed reduction: only the F words that must change do.

use super::corpus::{WITHIN, corpus};
use super::random::{programs, scraps};
use super::*;
use crate::refeed::tests::{Table, check_path, check_text, stream, tables, without_feed};
use crate::refeed::{LineLimit, Reason, Refed};
use crate::rs274::refeed;
use proptest::prelude::*;
use std::fs;
use std::io::{BufReader, Cursor};

fn written(program: &[u8], table: &Table) -> (Vec<u8>, Refed) {
    let mut out = Vec::new();
    let refed = refeed(program, &DecoderOptions::default(), stream(table), &mut out).unwrap();
    (out, refed)
}

/// Program and limits by line, rapids with a minus, mm per minute; what becomes of it, and how many lines are lowered.
/// A second time nothing changes.
#[test]
fn feeds_are_lowered_where_they_must() {
    for (program, limits, expected, lowered) in [
        // A line gets less, and the next the programmed feed back; nothing is looked at behind the end.
        (
            "%\nN10 G1 X10 F1500. ; first\nN20 X20 (F9)\nG1X30M8\r\nN40 X40\nM2\nX1 F1 what is behind the end",
            &[(3, 1234.56), (4, 1234.56), (5, 9000.0)][..],
            "%\nN10 G1 X10 F1500. ; first\nN20 X20 F1234 (F9)\nG1X30M8\r\nN40 X40 F1500\nM2\nX1 F1 what is behind the end",
            2,
        ),
        // Blanks mean nothing in this language, not even within numbers.
        (
            "g1 f 1 00.5 x1\nx2\ng1x3y4\nM2",
            &[(1, 60.0), (3, 30.0)],
            "g1 f 60 x1\nx2 f100.5\ng1x3y4f30\nM2",
            2,
        ),
        // F is read in the units that were in force before its line: F10 is inches, and so is the F that restores it in
        // line 4. 1 in/min is 25.4 mm/min.
        (
            "G20\nG1 X1 F10\nX2\nG21 X30\nX40\nX50\nM2",
            &[(3, 25.4 * 4.0), (5, 100.0)],
            "G20\nG1 X1 F10\nX2 F4\nG21 X30 F10\nX40 F100\nX50 F254\nM2",
            2,
        ),
        // Where only rotary axes move, F is degrees per minute, whatever the units of length.
        (
            "G20\nG1 X1 F100\nA90\nX2 A0\nM2",
            &[(3, 90.0)],
            "G20\nG1 X1 F100\nA90 F90\nX2 A0 F100\nM2",
            1,
        ),
        // Inverse time: 10 mm at F6 take a sixth of a minute: 60 mm/min. Its F belongs to its line alone.
        (
            "G1 X1 F500\nG93\nX11 F6\nX21 F6\nG94\nX31 F500\nM2",
            &[(3, 40.0), (6, 100.0)],
            "G1 X1 F500\nG93\nX11 F4\nX21 F6\nG94\nX31 F100\nM2",
            2,
        ),
        // No line relies on a feed that is written in a block that may be left out.
        (
            "G1 X1 F100\n/X2\nX3\nX4\n/ X5 F60\nX6\nM2",
            &[(1, 50.0), (2, 20.0), (3, 20.0), (4, 20.0), (5, 20.0), (6, 20.0)],
            "G1 X1 F50\n/X2 F20\nX3 F20\nX4\n/ X5 F20\nX6 F20\nM2",
            6,
        ),
    ] {
        let table: Table = limits.iter().map(|(line, feed)| ((*line, false), feed / 6e4)).collect();
        let (text, refed) = written(program.as_bytes(), &table);
        assert_eq!(String::from_utf8_lossy(&text), expected);
        assert_eq!((refed.lowered, &refed.unrepaired[..]), (lowered, &[][..]), "{program}");
        let (again, second) = written(&text, &table);
        assert_eq!(String::from_utf8_lossy(&again), expected, "a second time");
        assert_eq!((second.changed, second.lowered), (0, 0));
    }
}

/// F does not reach rapids, also those of canned cycles; the cut of a cycle it does. No F is low enough for 0, nor in
/// inverse time for less than a tenth of a millimetre per minute.
#[test]
fn what_stays_too_fast_is_reported() {
    use Reason::{InverseTime, NoFeed, Rapid};
    for (program, limits, expected, reported) in [
        (
            "G0 X10\nG81 X1 Z-1 R1 F100\nX5\nG1 X6\nM2",
            &[((1, true), 0.05), ((2, true), 0.01), ((2, false), 50.0 / 6e4), ((3, true), 0.2)][..],
            "G0 X10\nG81 X1 Z-1 R1 F50\nX5 F100\nG1 X6\nM2",
            &[(1, Rapid, 0.05), (2, Rapid, 0.01)][..],
        ),
        ("G1 X1 F10\nM2", &[((1, false), 0.0)], "G1 X1 F10\nM2", &[(1, NoFeed, 0.0)]),
        (
            "G93\nG1 X1 F1\nM2",
            &[((2, false), 0.05 / 6e4)],
            "G93\nG1 X1 F1\nM2",
            &[(2, InverseTime, 0.05 / 6e4)],
        ),
    ] {
        let (text, refed) = written(program.as_bytes(), &limits.iter().copied().collect());
        assert_eq!(String::from_utf8_lossy(&text), expected);
        let found = refed.unrepaired.iter().map(|one| (one.place.line, one.reason, one.limit));
        assert_eq!(found.collect::<Vec<_>>(), reported);
    }
}

fn limit_of(table: &Table, element: &PathElement) -> f64 {
    table.get(&(element.place.line, false)).copied().unwrap_or(f64::INFINITY)
}

fn path(program: &[u8]) -> Vec<PathElement> {
    decode_with(DecoderOptions::default(), program).elements
}

fn is_cut(element: &PathElement) -> bool {
    element.kind == ElementKind::Cut
}

proptest! {
    /// The path is the same, each line goes with the smaller of feed and limit, all else in the text stays, and a second
    /// time nothing changes.
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
        let program = lines.join("\n");
        let (text, refed) = written(program.as_bytes(), &table);
        let text = String::from_utf8(text).unwrap();
        let (before, after) = (path(program.as_bytes()), path(text.as_bytes()));
        let is_reported = |line| refed.unrepaired.iter().any(|one| one.place.line == line && one.reason != Reason::Rapid);
        check_path(&before, &after, &table, |e| is_cut(e) && !is_reported(e.place.line), |e| limit_of(&table, e))?;
        let slow = refed.unrepaired.iter().filter(|one| one.reason != Reason::Rapid);
        for one in slow {
            prop_assert_eq!(one.reason, Reason::InverseTime);
            // Ten times the slowest inch per minute.
            prop_assert!(one.limit < 25.4e-3 / 60.0);
        }
        check_text(&program, &text, &refed, path, |text| written(text, &table))?;
    }

    /// Whatever the bytes, nothing panics, without limits they come back as they are, and how they arrive does not
    /// matter.
    #[test]
    fn any_bytes_come_back(program in scraps(), table in tables(20), capacity in 1..40_usize) {
        let (same, refed) = written(&program, &Table::new());
        prop_assert_eq!(&same, &program);
        prop_assert_eq!(refed.changed, 0);
        let (text, refed) = written(&program, &table);
        let reader = BufReader::with_capacity(capacity, Cursor::new(&program));
        let mut other = Vec::new();
        let options = DecoderOptions::default();
        prop_assert_eq!(&refeed(reader, &options, stream(&table), &mut other).unwrap(), &refed);
        prop_assert_eq!(&text, &other);
        let shapes = |path: &[PathElement]| path.iter().map(without_feed).collect::<Vec<_>>();
        prop_assert_eq!(shapes(&path(&program)), shapes(&path(&text)));
        for element in path(&text).iter().filter(|element| is_cut(element)) {
            let limit = limit_of(&table, element);
            let is_reported = refed.unrepaired.iter().any(|one| one.place.line == element.place.line);
            prop_assert!(element.feed <= limit * (1.0 + 1.1e-9) || is_reported, "{element:?} {limit}");
        }
    }
}

/// Half of what is programmed on every third line of other people's programs.
#[test]
fn programs_of_others() {
    let Some(corpus) = corpus() else { return };
    let (mut lines, mut changed) = (0, 0);
    for name in WITHIN {
        let program = fs::read(corpus.join(name)).unwrap();
        let before = path(&program);
        let mut table = Table::new();
        for element in before.iter().filter(|element| is_cut(element)) {
            if element.place.line.is_multiple_of(3) {
                let limit = table.entry((element.place.line, false)).or_insert(f64::INFINITY);
                *limit = limit.min(element.feed / 2.0);
            }
        }
        let (text, refed) = written(&program, &table);
        assert_eq!(refed.unrepaired, [], "{name}");
        check_path(&before, &path(&text), &Table::new(), is_cut, |e| limit_of(&table, e)).unwrap();
        let (again, second) = written(&text, &table);
        assert!(again == text, "{name}");
        assert_eq!(second.changed, 0, "{name}");
        // Lines that do not change do not change at all.
        let same = program.split(|byte| *byte == b'\n').zip(text.split(|byte| *byte == b'\n'));
        let different = same.filter(|(old, new)| old != new).count() as u64;
        assert_eq!(different, refed.changed, "{name}");
        let (same, _) = written(&program, &Table::new());
        assert!(same == program, "{name}");
        lines += refed.lines;
        changed += refed.changed;
    }
    println!("{changed} of {lines} lines changed");
    assert!(changed > 50_000, "{changed} of {lines}");
}

#[test]
fn late_limits_are_errors() {
    let program = "G1 X1 F1\n".repeat(600);
    let limits = [500, 1].map(|line| Ok(LineLimit { line, rapid: false, feed: 1.0 }));
    let failed = refeed(program.as_bytes(), &DecoderOptions::default(), limits, Vec::new());
    assert!(matches!(failed, Err(crate::refeed::RefeedError::Late(1))), "{failed:?}");
}
