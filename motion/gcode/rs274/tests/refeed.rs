//! Tests of feed reduction: only the F words that must change do.

use super::corpus;
use super::random::{programs, scraps};
use super::*;
use crate::refeed::tests::{
    Dialect, Table, check_bytes, check_examples, check_path, check_program, shapes, tables, written,
};
use crate::refeed::{LineLimit, Reason, Refed, RefeedError};
use crate::rs274::{refeed, refeed_repeated};
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
    let (mut lines, mut changed, mut repeated, mut rewritten) = (0, 0, Vec::new(), 0);
    for (name, ..) in corpus::programs("within") {
        let program = fs::read(folder.join(name)).unwrap();
        let options = DecoderOptions::default();
        let whole = refeed(&program[..], &options, [], std::io::sink());
        if let Err(RefeedError::Repeated(line)) = whole {
            repeated.push((name, line));
        }
        let before = Rs274::path(&program);
        let mut table = Table::new();
        for element in before.iter().filter(|element| Rs274::is_governed(element)) {
            if element.place.line.is_multiple_of(3) {
                let limit = table.entry((element.place.line, false)).or_insert(f64::INFINITY);
                *limit = limit.min(element.feed / 2.0);
            }
        }
        if repeated.last().is_some_and(|(last, _)| *last == name) {
            rewritten += u32::from(check_repeated(name, &program, &before, &table));
            continue;
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
    println!("{changed} of {lines} lines changed; {rewritten} of {} with loops", repeated.len());
    assert!(changed > 50_000, "{changed} of {lines}");
    assert!(rewritten >= 7, "{rewritten}");
    assert!(repeated.contains(&("linuxcnc_debian/flowsnake.ngc", 5)), "{repeated:?}");
}

/// Checks a program with loops: the same path, and no cut above its limit. False if a feed must stay as it is.
fn check_repeated(name: &str, program: &[u8], before: &[PathElement], table: &Table) -> bool {
    let limits = table.iter().map(|(&(line, rapid), &feed)| Ok(LineLimit { line, rapid, feed }));
    let mut text = Vec::new();
    let refed = match refeed_repeated(program, &DecoderOptions::default(), limits, &mut text) {
        Err(RefeedError::Fixed(place, reason)) => {
            println!("{name}: {place}: {reason}");
            return false;
        }
        other => other.unwrap(),
    };
    assert!(refed.unrepaired.iter().all(|one| one.reason == Reason::Thread), "{name}: {refed:?}");
    let after = Rs274::path(&text);
    assert!(shapes(before) == shapes(&after), "{name}");
    for element in after.iter().filter(|element| Rs274::is_governed(element)) {
        let limit = Rs274::limit_of(table, element);
        let threads = refed.unrepaired.iter().any(|one| one.place == element.place);
        assert!(threads || element.feed <= limit * (1.0 + 1e-9), "{name}: {element:?}");
    }
    true
}

#[test]
fn late_limits_are_errors() {
    let program = "G1 X1 F1\n".repeat(600);
    let limits = [500, 1].map(|line| Ok(LineLimit { line, rapid: false, feed: 1.0 }));
    let failed = refeed(program.as_bytes(), &DecoderOptions::default(), limits, Vec::new());
    assert!(matches!(failed, Err(RefeedError::Late(1))), "{failed:?}");
}

/// A program with loops, with limits by line, mm per minute.
fn repeated(program: &str, limits: &[(u32, f64)]) -> Result<(String, Refed), RefeedError> {
    let limits =
        limits.iter().map(|(line, feed)| LineLimit { line: *line, rapid: false, feed: feed / 6e4 });
    let (options, mut text) = (DecoderOptions::default(), Vec::new());
    let once = refeed(program.as_bytes(), &options, [], io::sink());
    assert!(matches!(once, Err(RefeedError::Repeated(_))), "{once:?}");
    let refed = refeed_repeated(program.as_bytes(), &options, limits.map(Ok), &mut text)?;
    Ok((String::from_utf8(text).unwrap(), refed))
}

/// A line needs an F of its own if one of the lines before it, in any of its executions, has another F than programmed.
#[test]
fn lines_that_are_executed_again() {
    for (program, limits, expected, changed) in [
        // The next line gets its feed back, and the line behind the loop has it from there.
        (
            "F600\no1 repeat [3]\nG1 X1\nX2\no1 endrepeat\nX3\nM2",
            &[(3, 300.0)][..],
            "F600\no1 repeat [3]\nG1 X1 F300\nX2 F600\no1 endrepeat\nX3\nM2",
            2,
        ),
        // The first line of a loop follows its last line.
        (
            "F600\no1 repeat [3]\nG1 X1\nX2\no1 endrepeat\nX3\nM2",
            &[(4, 300.0)],
            "F600\no1 repeat [3]\nG1 X1 F600\nX2 F300\no1 endrepeat\nX3 F600\nM2",
            3,
        ),
        // One of two branches is too fast.
        (
            "F600\n#1=0\no1 while [#1 LT 4]\no2 if [#1 MOD 2]\nG1 X1\no2 else\nG1 X2\no2 endif\nY#1\n#1=[#1+1]\no1 endwhile\nM2",
            &[(5, 300.0)],
            "F600\n#1=0\no1 while [#1 LT 4]\no2 if [#1 MOD 2]\nG1 X1 F300\no2 else\nG1 X2\no2 endif\nY#1 F600\n#1=[#1+1]\no1 endwhile\nM2",
            2,
        ),
        // A subroutine that is called with two feeds goes with the lower one where F is written.
        (
            "o1 sub\nG1 X1\nX0\no1 endsub\nF600\no1 call\nF200\no1 call\nG1 Y1\nM2",
            &[(2, 300.0)],
            "o1 sub\nG1 X1 F200\nX0 F200\no1 endsub\nF600\no1 call\nF200\no1 call\nG1 Y1\nM2",
            2,
        ),
        // Feeds that no line changes may be expressions, and differ.
        (
            "o1 sub\nG1 X1 F[#1]\nX0\no1 endsub\no1 call [500]\no1 call [200]\nG1 Y1\nY2\nM2",
            &[(7, 100.0)],
            "o1 sub\nG1 X1 F[#1]\nX0\no1 endsub\no1 call [500]\no1 call [200]\nG1 Y1 F100\nY2 F200\nM2",
            2,
        ),
    ] {
        let (text, refed) = repeated(program, limits).unwrap();
        assert_eq!((text.as_str(), refed.changed), (expected, changed));
        let (again, second) = repeated(expected, limits).unwrap();
        assert_eq!((again.as_str(), second.changed, second.lowered), (expected, 0, 0));
        assert_eq!(repeated(program, &[]).unwrap().0, program);
    }
}

#[test]
fn feeds_of_repeated_lines_that_must_stay() {
    for (program, place, reason) in [
        ("o1 repeat [2]\nG1 X1 F[500]\nX0\no1 endrepeat\nM2", 2, "not a number"),
        ("o1 repeat [2]\nG93 G1 X1 F9\nX0 F9\no1 endrepeat\nM2", 2, "G94"),
        ("F9 o1\no1 repeat [2]\n/G1 X1 F90\nX0\no1 endrepeat\nM2", 3, "leave out"),
        ("F900\nM70\no1 repeat [2]\nG1 X1\no1 endrepeat\nM72\nM2", 2, "M70"),
        ("#1=0\nF600\no1 repeat [2]\nG[20+#1] G1 X0\nG1 X1\n#1=1\no1 endrepeat\nM2", 4, "G20"),
        // What the program computes from its feed would be something else.
        ("F600\no1 repeat [2]\nG1 X1\nX[#<_feed>/100]\no1 endrepeat\nM2", 4, "reads its feed"),
    ] {
        let all: Vec<_> = (1..9).map(|line| (line, 1.0)).collect();
        match repeated(program, &all) {
            Err(RefeedError::Fixed(at, why)) => {
                assert_eq!(at.line, place, "{program}: {why}");
                assert!(why.contains(reason), "{program}: {why}");
            }
            other => panic!("{program}: {other:?}"),
        }
        // Without a limit nothing has to change.
        assert_eq!(repeated(program, &[]).unwrap().0, program);
    }
}

/// A block of the random programs below: moves, with or without F, within loops, conditions and calls.
fn blocks() -> impl Strategy<Value = String> {
    let part = prop_oneof![
        3 => (0..9_u32).prop_map(|x| format!("G1 X{x} Y#9\n")),
        2 => (0..9_u32, 1..9_u32).prop_map(|(x, f)| format!("G1 X{x} F{f}00\n")),
        1 => (1..9_u32).prop_map(|f| format!("F{f}00\n")),
        1 => (0..9_u32).prop_map(|x| format!("G0 X{x}\n")),
        2 => Just("o9 call\n".to_owned()),
        1 => Just("#9=[#9+1]\n".to_owned()),
    ];
    let leaf = prop::collection::vec(part, 0..5).prop_map(|parts| parts.concat());
    leaf.prop_recursive(3, 8, 3, |inner| {
        (0..3_u8, prop::collection::vec(inner, 1..3)).prop_map(|(kind, blocks)| {
            let text = blocks.concat();
            match kind {
                0 => format!("oLABEL repeat [2]\n{text}oLABEL endrepeat\n"),
                1 => format!("oLABEL if [#9 MOD 2]\n{text}oLABEL else\nG1 X7\noLABEL endif\n"),
                _ => text,
            }
        })
    })
}

/// Gives every loop and condition a label of its own.
fn labelled(text: &str) -> String {
    let (mut open, mut next, mut all) = (Vec::new(), 10, String::new());
    for line in text.lines() {
        if line.contains(" repeat") || line.contains(" if") {
            next += 1;
            open.push(next);
        }
        let label = open.last().copied().unwrap_or_default();
        all += &line.replace("LABEL", &label.to_string());
        all.push('\n');
        if line.contains(" endrepeat") || line.contains(" endif") {
            open.pop();
        }
    }
    all
}

proptest! {
    #[test]
    fn repeated_lines_go_with_the_least_feed(
        (sub, main) in (prop::collection::vec((0..9_u32, prop::option::of(1..9_u32)), 0..4), blocks()),
        limits in prop::collection::btree_map(1..40_u32, 50.0..900.0_f64, 1..9),
    ) {
        let feed = |feed: Option<u32>| feed.map(|feed| format!(" F{feed}00")).unwrap_or_default();
        let sub: Vec<_> = sub.into_iter().map(|(x, f)| format!("G1 X{x}{}\n", feed(f))).collect();
        let sub = sub.concat();
        let program = format!("#9=0\nF550\no9 sub\n{sub}o9 endsub\n{}M2\n", labelled(&main));
        let limits: Vec<_> = limits.into_iter().collect();
        let limit_of = |line: u32| {
            limits.iter().find(|(limited, _)| *limited == line).map_or(f64::INFINITY, |(_, feed)| feed / 6e4)
        };
        let (text, _) = repeated(&program, &limits).unwrap();
        let (before, after) = (elements(&program), elements(&text));
        prop_assert_eq!(shapes(&before), shapes(&after));
        for (old, new) in before.iter().zip(&after).filter(|(old, _)| Rs274::is_governed(old)) {
            let line = old.place.line;
            let executions = before.iter().filter(|one| one.place.line == line && Rs274::is_governed(one));
            let least = executions.fold(f64::INFINITY, |least, one| least.min(one.feed));
            let least = least.min(limit_of(line));
            // At most the limit, never more than programmed, and no less than the least execution needs.
            prop_assert!(new.feed <= limit_of(line) * (1.0 + 1e-11), "{line}: {text}");
            prop_assert!(new.feed <= old.feed * (1.0 + 1e-9), "{line}: {text}");
            prop_assert!(new.feed >= least * (1.0 - 1.001e-3), "{line}: {text}");
        }
        // Lines that did not have to change have their feeds.
        for (line, (old, new)) in (1_u32..).zip(program.lines().zip(text.lines())) {
            if old == new {
                let feeds = |path: &[PathElement]| -> Vec<_> {
                    let own = path.iter().filter(|one| one.place.line == line);
                    own.map(|one| one.feed.to_bits()).collect()
                };
                prop_assert_eq!(feeds(&before), feeds(&after), "{}: {}", line, text);
            }
        }
        prop_assert_eq!(&repeated(&text, &limits).unwrap().0, &text);
    }
}
