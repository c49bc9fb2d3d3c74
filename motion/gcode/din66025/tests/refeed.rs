//! Tests of feed reduction: only the F words that must change do.

use super::random::programs;
use super::*;
use crate::din66025::{Variables, refeed};
use crate::refeed::tests::{Table, check_path, check_text, stream, tables};
use crate::refeed::{LineLimit, Reason, Refed, RefeedError};
use proptest::prelude::*;
use std::io::BufReader;

fn options() -> DecoderOptions {
    let mut options = DecoderOptions { jumps: 20, ..DecoderOptions::default() };
    options.variables.set("f", 80.0);
    options
}

/// `program` with limits in mm/s by line, and what became of it.
fn limited(program: &[u8], limits_mm: &[(u32, f64)]) -> (Vec<u8>, Refed) {
    let limits = limits_mm
        .iter()
        .map(|(line, mm)| Ok(LineLimit { line: *line, rapid: false, feed: mm / 1e3 }));
    let mut out = Vec::new();
    let refed = refeed(Cursor::new(program), &options(), limits, &mut out).unwrap();
    (out, refed)
}

/// Program and limits by line, mm/s; what becomes of it, and how many lines are lowered. A second time nothing changes:
/// feasible feeds stay.
#[test]
fn feeds_are_lowered_where_they_must() {
    let loops = "%\nN1 G36 D-2\nN10 G1 X1 F100\nN20 X2\nN30 X0 F50\nN40 G37 D1\nN50 G20 L20\n";
    for (program, limits, expected, lowered) in [
        // A line gets less, and the next the programmed feed back.
        (
            "% part\nN10 G1 X10 F100\nN20 X20 (corner)\nN30 X30\r\nN40 X40\n",
            &[(2, 200.0), (3, 12.3456), (4, 12.3456), (5, 500.0)][..],
            "% part\nN10 G1 X10 F100\nN20 X20 F12.34 (corner)\nN30 X30\r\nN40 X40 F100\n",
            2,
        ),
        // An own word is replaced in place. A feed of three digits is lowered to the limit itself.
        (
            "%\nN10 G1 F100 X10\nN20 G1f080.50X20\nN30 X30\n",
            &[(2, 50.0), (3, 60.0)],
            "%\nN10 G1 F50 X10\nN20 G1f60X20\nN30 X30 F80.5\n",
            2,
        ),
        // Blocks are written as their neighbours.
        (
            "%\nG1X1F9\nX2Y2\n x3\nX$f$\t(F)\nX5H2O.5;",
            &[(3, 1.0), (4, 2.0), (5, 3.0)],
            "%\nG1X1F9\nX2Y2F1\n x3 f2\nX$f$ F3\t(F)\nX5H2O.5;",
            3,
        ),
        // Words that set the feed alone stay.
        (
            "%\nF100\nX10\nN50 G1 F200\nM3\nX20\nX30",
            &[(3, 50.0), (7, 150.0)],
            "%\nF100\nX10 F50\nN50 G1 F200\nM3\nX20\nX30 F150",
            2,
        ),
        // Variables become numbers only where they must.
        (
            "%\nG1 X1 F$f$\nX2 F$F$\nX3\nX4 F$f$",
            &[(3, 10.0)],
            "%\nG1 X1 F$f$\nX2 F10\nX3 F80\nX4 F$f$",
            1,
        ),
        // Of two words the left one counts.
        ("%\nG1 F90 X1 F100", &[(2, 10.0)], "%\nG1 F10 X1 F100", 1),
        // The machine may leave out what begins with `/`; no line relies on a feed that is written there.
        (
            "%\nX1 F100\n/X2\nX3\nX4\n/ X5 F60\nX6",
            &[(2, 50.0), (3, 20.0), (4, 20.0), (5, 20.0), (6, 20.0), (7, 20.0)],
            "%\nX1 F50\n/X2 F20\nX3 F20\nX4\n/ X5 F20\nX6 F20",
            6,
        ),
        // A limit that is below by rounding alone, or above, changes nothing.
        (
            "%\nG1 X1 F100 (ä\u{fffd})\nX2",
            &[(2, 100.0 * (1.0 - 1e-12)), (3, 1e9)],
            "%\nG1 X1 F100 (ä\u{fffd})\nX2",
            0,
        ),
        // N30 is passed with F100 and with F60, N20 with limits of its own and, the second time, behind a slower line. The
        // implicit variable is −1 at first; with −3 the jump is taken twice.
        (
            "%\nN5 G36 D-3\nN10 G1 X1 F100\nN20 X2\nN30 X0\nN40 G37 D1\nN50 G20 L20\nN60 X9\n",
            &[(5, 40.0), (4, 200.0), (8, 90.0), (4, 30.0)],
            "%\nN5 G36 D-3\nN10 G1 X1 F100\nN20 X2 F30\nN30 X0 F40\nN40 G37 D1\nN50 G20 L20\nN60 X9 F90\n",
            3,
        ),
        // Jumps that are not taken, or not there, cost no more.
        (
            "%\nN10 G1 X1 F100\nN20 G20 L10 K0\nN30 X2\n",
            &[(2, 10.0)],
            "%\nN10 G1 X1 F10\nN20 G20 L10 K0\nN30 X2 F100\n",
            1,
        ),
        // A line that comes with two feeds, neither of which is too high, stays as it is. But if the feed before it
        // changes, it needs one of its own: the smaller.
        (loops, &[(4, 100.0), (5, 50.0)], loops, 0),
        (
            loops,
            &[(3, 70.0)],
            "%\nN1 G36 D-2\nN10 G1 X1 F70\nN20 X2 F50\nN30 X0 F50\nN40 G37 D1\nN50 G20 L20\n",
            1,
        ),
    ] {
        let (text, refed) = limited(program.as_bytes(), limits);
        assert_eq!(String::from_utf8_lossy(&text), expected);
        assert_eq!((refed.lowered, refed.unrepaired.len()), (lowered, 0), "{program}");
        let (again, second) = limited(&text, limits);
        assert_eq!(String::from_utf8_lossy(&again), expected, "a second time");
        assert_eq!((second.changed, second.lowered), (0, 0));
    }
}

/// Rapids of this dialect go with F, as the decoder has it.
#[test]
fn rapids_are_governed() {
    let limits = [Ok(LineLimit { line: 2, rapid: true, feed: 0.03 })];
    let mut out = Vec::new();
    let refed =
        refeed(Cursor::new("%\nG0 X10 F100\nG1 X20"), &options(), limits, &mut out).unwrap();
    assert_eq!(String::from_utf8(out).unwrap(), "%\nG0 X10 F30\nG1 X20 F100");
    assert_eq!(refed.unrepaired, []);
}

#[test]
fn unrepaired_lines_are_reported() {
    let (text, refed) = limited(b"%\nG1 X1 F100\nX2\n", &[(2, 0.0), (3, f64::NAN)]);
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
    let (text, refed) = limited(program.as_bytes(), &[(2, 50.0), (4, 20.0), (5, 20.0)]);
    let expected = format!("%\nG1 X1 F50\n{long}\n{nearly}\nX5 F20");
    assert!(text == expected.as_bytes());
    assert_eq!(refed.unrepaired.len(), 1);
    assert_eq!((refed.unrepaired[0].place.line, refed.unrepaired[0].reason), (4, Reason::LongLine));
}

#[test]
fn failures_are_returned() {
    let limits = || [Err(std::io::Error::other("gone"))];
    let failed = refeed(Cursor::new("%\nX1 F1"), &options(), limits(), Vec::new());
    assert!(matches!(failed, Err(RefeedError::Limits(_))), "{failed:?}");
    let failed = refeed(Cursor::new("%\nX1 F1\nG20 L1"), &options(), limits(), Vec::new());
    assert!(matches!(failed, Err(RefeedError::Limits(_))), "{failed:?}");
    let full: &mut [u8] = &mut [0; 3];
    let failed = refeed(Cursor::new("%\nX1 F1"), &options(), [], full);
    assert!(matches!(failed, Err(RefeedError::Write(_))), "{failed:?}");
}

fn written(program: &[u8], table: &Table) -> (Vec<u8>, Refed) {
    let mut out = Vec::new();
    let refed = refeed(Cursor::new(program), &options(), stream(table), &mut out).unwrap();
    (out, refed)
}

fn path(program: &[u8]) -> Vec<PathElement> {
    remaining(&decode_with(options(), program))
}

fn limit_of(table: &Table, element: &PathElement) -> f64 {
    let of = |rapid| table.get(&(element.place.line, rapid)).copied().unwrap_or(f64::INFINITY);
    of(false).min(of(true))
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
    ) {
        let mut lines = lines;
        for (line, feed) in feeds {
            if let Some(line) = lines.get_mut(line).filter(|line| !line.contains(['F', '(', '%'])) {
                *line = format!("{line} F{}", f64::from(feed) / 100.0);
            }
        }
        let program = lines.join("\n");
        let (text, refed) = written(program.as_bytes(), &table);
        let text = String::from_utf8(text).unwrap();
        let (before, after) = (path(program.as_bytes()), path(text.as_bytes()));
        check_path(&before, &after, &table, |e| e.kind.is_motion(), |e| limit_of(&table, e))?;
        prop_assert_eq!(refed.unrepaired.len(), 0);
        check_text(&program, &text, &refed, path, |text| written(text, &table))?;
    }

    /// Whatever the bytes, nothing panics, without limits they come back as they are, and how they arrive does not
    /// matter.
    #[test]
    fn any_bytes_come_back(program in super::random::scraps(), table in tables(20), capacity in 1..40_usize) {
        let (same, refed) = written(&program, &Table::new());
        prop_assert_eq!(&same, &program);
        prop_assert_eq!(refed.changed, 0);
        let (text, refed) = written(&program, &table);
        let reader = BufReader::with_capacity(capacity, Cursor::new(&program));
        let mut other = Vec::new();
        prop_assert_eq!(&refeed(reader, &options(), stream(&table), &mut other).unwrap(), &refed);
        prop_assert_eq!(&text, &other);
        let (before, after) = (path(&program), path(&text));
        let (before, after) = (shapes(&before), shapes(&after));
        prop_assert_eq!(before, after);
        for element in path(&text).iter().filter(|element| element.kind.is_motion()) {
            let limit = limit_of(&table, element);
            let is_reported = refed.unrepaired.iter().any(|one| one.place.line == element.place.line);
            prop_assert!(element.feed <= limit * (1.0 + 1.1e-9) || is_reported, "{element:?} {limit}");
        }
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
        let (text, refed) = written(program.as_bytes(), &table);
        let (before, after) = (path(program.as_bytes()), path(&text));
        prop_assert_eq!(shapes(&before), shapes(&after));
        prop_assert!(refed.unrepaired.is_empty());
        for (before, after) in before.iter().zip(&after).filter(|(one, _)| one.kind.is_motion()) {
            let allowed = limit_of(&table, before).min(before.feed);
            prop_assert!(after.feed <= allowed * (1.0 + 1.1e-9), "{before:?} {after:?} {allowed}\n{}", String::from_utf8_lossy(&text));
        }
        prop_assert_eq!(written(&text, &table).0, text);
    }
}

fn shapes(path: &[PathElement]) -> Vec<PathElement> {
    path.iter().map(crate::refeed::tests::without_feed).collect()
}

/// A loop that changes variables the text never sees in that order.
#[test]
fn variables_that_loops_change() {
    let mut options = options();
    options.variables = Variables::default();
    options.variables.set("v", 0.0);
    let program = "%\nN10 G20 L40\nN20 G1 X1 F$v$\nN30 G20 L60 K1\nN40 G36 O$v$ D90\nN50 G20 L20 K1\nN60 X2\n";
    let limits = || [Ok(LineLimit { line: 3, rapid: false, feed: 0.05 })];
    let mut out = Vec::new();
    refeed(Cursor::new(program), &options, limits(), &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert_eq!(text, program.replace("F$v$", "F50").replace("X2", "X2 F90"));
}
