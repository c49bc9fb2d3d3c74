//! Tests of feed reduction: only the F words that must change do.

use super::random::programs;
use super::*;
use crate::din66025::{Variables, refeed};
use crate::refeed::tests::{
    Dialect, Table, check_bytes, check_examples, check_program, shapes, tables, written,
};
use crate::refeed::{LineLimit, Reason, Refed, RefeedError};
use proptest::prelude::*;
use std::io::{self, BufReader};

fn options() -> DecoderOptions {
    let mut options = DecoderOptions { jumps: 20, ..DecoderOptions::default() };
    options.variables.set("f", 80.0);
    options
}

struct Din66025;

impl Dialect for Din66025 {
    fn refeed(
        program: BufReader<Cursor<&[u8]>>,
        limits: impl Iterator<Item = io::Result<LineLimit>>,
        out: &mut Vec<u8>,
    ) -> Result<Refed, RefeedError> {
        refeed(program, &options(), limits, out)
    }

    fn path(program: &[u8]) -> Vec<PathElement> {
        remaining(&decode_with(options(), program))
    }

    fn is_governed(element: &PathElement) -> bool {
        element.kind.is_motion()
    }

    fn limit_of(table: &Table, element: &PathElement) -> f64 {
        let of = |rapid| table.get(&(element.place.line, rapid)).copied().unwrap_or(f64::INFINITY);
        of(false).min(of(true))
    }
}

/// Limits in mm/s.
#[test]
fn feeds_are_lowered_where_they_must() {
    check_examples::<Din66025>(include_str!("refeed.json"), 1e-3);
}

/// Rapids of this dialect go with F, as the decoder has it.
#[test]
fn rapids_are_governed() {
    let table = Table::from([((2, true), 0.03)]);
    let (text, refed) = written::<Din66025>(b"%\nG0 X10 F100\nG1 X20", &table);
    assert_eq!(text, b"%\nG0 X10 F30\nG1 X20 F100");
    assert_eq!(refed.unrepaired, []);
}

#[test]
fn unrepaired_lines_are_reported() {
    let table = Table::from([((2, false), 0.0), ((3, false), f64::NAN)]);
    let (text, refed) = written::<Din66025>(b"%\nG1 X1 F100\nX2\n", &table);
    assert_eq!(text, b"%\nG1 X1 F100\nX2\n");
    let reported: Vec<_> =
        refed.unrepaired.iter().map(|one| (one.place.line, one.reason)).collect();
    assert_eq!(reported, [(2, Reason::NoFeed), (3, Reason::NoFeed)]);
    assert!((refed.unrepaired[0].programmed - 0.1).abs() < 1e-15);
}

#[test]
fn long_lines_are_copied() {
    let long = "N30 X3".to_owned() + &"9".repeat(70_000);
    let nearly = "X4 (".to_owned() + &"c".repeat(65_510) + ")";
    let program = format!("%\nG1 X1 F100\n{long}\n{nearly}\nX5");
    let table = Table::from([((2, false), 0.05), ((4, false), 0.02), ((5, false), 0.02)]);
    let (text, refed) = written::<Din66025>(program.as_bytes(), &table);
    let expected = format!("%\nG1 X1 F50\n{long}\n{nearly}\nX5 F20");
    assert!(text == expected.as_bytes());
    assert_eq!(refed.unrepaired.len(), 1);
    assert_eq!((refed.unrepaired[0].place.line, refed.unrepaired[0].reason), (4, Reason::LongLine));
}

#[test]
fn failures_are_returned() {
    for program in ["%\nX1 F1", "%\nX1 F1\nG20 L1"] {
        let limits = [Err(io::Error::other("gone"))];
        let failed = refeed(Cursor::new(program), &options(), limits, Vec::new());
        assert!(matches!(failed, Err(RefeedError::Limits(_))), "{failed:?}");
    }
    let full: &mut [u8] = &mut [0; 3];
    let failed = refeed(Cursor::new("%\nX1 F1"), &options(), [], full);
    assert!(matches!(failed, Err(RefeedError::Write(_))), "{failed:?}");
}

proptest! {
    #[test]
    fn only_feeds_change(
        (lines, table) in programs().prop_flat_map(|lines| {
            let count = u32::try_from(lines.len()).unwrap();
            (Just(lines), tables(count))
        }),
        feeds in prop::collection::vec((0..40_usize, 1..9_000), 0..6),
    ) {
        let mut lines = lines;
        for (line, feed) in feeds {
            if let Some(line) = lines.get_mut(line).filter(|line| !line.contains(['F', '(', '%'])) {
                *line = format!("{line} F{}", f64::from(feed) / 100.0);
            }
        }
        let refed = check_program::<Din66025>(&lines.join("\n"), &table)?;
        prop_assert_eq!(refed.unrepaired.len(), 0);
    }

    #[test]
    fn any_bytes_come_back(program in super::random::scraps(), table in tables(20), capacity in 1..40_usize) {
        check_bytes::<Din66025>(&program, &table, capacity)?;
    }

    /// Loops: no line is ever passed with more than its limit or than is programmed.
    #[test]
    fn loops_are_limited(
        lines in prop::collection::vec(
            prop::sample::select(vec!["X1", "X2 F30", "G0 X3", "G1 X0", "F50", "(c)", "X7 F$f$", "/X8 F70", "/X9"]), 1..12),
        jumps in prop::collection::vec((0..12_usize, 0..12_usize), 0..3),
        table in tables(16),
    ) {
        let mut lines: Vec<_> =
            lines.iter().enumerate().map(|(number, line)| {
                let slash = if line.starts_with('/') { "/" } else { "" };
                format!("{slash}N{number} {}", line.trim_start_matches('/'))
            }).collect();
        for (at, to) in jumps {
            let at = at.min(lines.len());
            // Each jump is taken a few times: the implicit variable counts to 0.
            lines.insert(at, format!("G20 L{to}"));
            lines.insert(at, "G37 D1".to_owned());
        }
        let program = format!("%\nG36 D-3\nF100\n{}", lines.join("\n"));
        let (text, refed) = written::<Din66025>(program.as_bytes(), &table);
        let [before, after] = [program.as_bytes(), &text[..]].map(Din66025::path);
        prop_assert_eq!(shapes(&before), shapes(&after));
        prop_assert!(refed.unrepaired.is_empty());
        for (before, after) in before.iter().zip(&after).filter(|(one, _)| one.kind.is_motion()) {
            let allowed = Din66025::limit_of(&table, before).min(before.feed);
            prop_assert!(after.feed <= allowed * (1.0 + 1.1e-9), "{before:?} {after:?} {allowed}\n{}", String::from_utf8_lossy(&text));
        }
        prop_assert_eq!(written::<Din66025>(&text, &table).0, text);
    }
}

/// A loop that changes variables the text never sees in that order.
#[test]
fn variables_that_loops_change() {
    let mut options = options();
    options.variables = Variables::default();
    options.variables.set("v", 0.0);
    let program = "%\nN10 G20 L40\nN20 G1 X1 F$v$\nN30 G20 L60 K1\nN40 G36 O$v$ D90\nN50 G20 L20 K1\nN60 X2\n";
    let limits = [Ok(LineLimit { line: 3, rapid: false, feed: 0.05 })];
    let mut out = Vec::new();
    refeed(Cursor::new(program), &options, limits, &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert_eq!(text, program.replace("F$v$", "F50").replace("X2", "X2 F90"));
}
