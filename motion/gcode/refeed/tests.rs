//! Tests of numbers and limits, and checks that the tests of both dialects share.

use super::edit::rounded_down;
use super::limits::{LATE, Limits};
use super::*;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::io::{BufReader, Cursor};
use twin_path::{ElementKind, PathElement};

/// A reader that fails.
pub(crate) struct Unplugged;

impl io::Read for Unplugged {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(io::Error::other("unplugged"))
    }
}

/// Random limits by line; lines that are not in it have none.
pub(crate) type Table = BTreeMap<(u32, bool), f64>;

/// Limits for some lines of a program, from next to nothing to more than is programmed. m/s.
pub(crate) fn tables(lines: u32) -> impl Strategy<Value = Table> {
    let feed = prop_oneof![
        6 => (-4.0..1.0_f64).prop_map(|exponent| 10_f64.powf(exponent)),
        1 => prop::sample::select(vec![0.02, 0.01, 1e-3, 0.1 / 60.0, 20.0 / 6e4]),
    ];
    prop::collection::btree_map((1..=lines, any::<bool>()), feed, 0..lines as usize)
}

/// A dialect as these checks see it.
pub(crate) trait Dialect {
    /// Writes a program with its feeds lowered to the limits.
    fn refeed(
        program: BufReader<Cursor<&[u8]>>,
        limits: impl Iterator<Item = io::Result<LineLimit>>,
        out: &mut Vec<u8>,
    ) -> Result<Refed, RefeedError>;

    /// The elements of a program with errors or without.
    fn path(program: &[u8]) -> Vec<PathElement>;

    /// F is for this element.
    fn is_governed(element: &PathElement) -> bool;

    /// The limit for the feed of an element, infinite without one.
    fn limit_of(table: &Table, element: &PathElement) -> f64;
}

/// A program that is read in pieces of `capacity` bytes, with limits in this order; and what was done to it.
fn limited<D: Dialect>(program: &[u8], capacity: usize, limits: &[LineLimit]) -> (Vec<u8>, Refed) {
    let reader = BufReader::with_capacity(capacity, Cursor::new(program));
    let mut out = Vec::new();
    let refed = D::refeed(reader, limits.iter().copied().map(Ok), &mut out).unwrap();
    (out, refed)
}

/// The limits of a table as they come from a planner.
fn stream(table: &Table) -> Vec<LineLimit> {
    let limits = table.iter().map(|(&(line, rapid), &feed)| LineLimit { line, rapid, feed });
    limits.collect()
}

/// A program with the limits of a table.
pub(crate) fn written<D: Dialect>(program: &[u8], table: &Table) -> (Vec<u8>, Refed) {
    limited::<D>(program, program.len() + 1, &stream(table))
}

/// Asserts that the programs of a data file become what they are to become with limits for their lines, in `unit` m/s,
/// and that a second time nothing changes: feasible feeds stay.
pub(crate) fn check_examples<D: Dialect>(examples: &str, unit: f64) {
    let examples: Vec<serde_json::Value> = serde_json::from_str(examples).unwrap();
    for example in examples {
        let about = &example["about"];
        let [program, expected] = ["program", "expected"].map(|key| example[key].as_str().unwrap());
        let limits: Vec<(u32, f64)> = serde_json::from_value(example["limits"].clone()).unwrap();
        let limit = |(line, feed)| LineLimit { line, rapid: false, feed: feed * unit };
        let limits: Vec<_> = limits.into_iter().map(limit).collect();
        let (text, refed) = limited::<D>(program.as_bytes(), program.len() + 1, &limits);
        assert_eq!(String::from_utf8_lossy(&text), expected, "{about}");
        assert_eq!(example["lowered"], refed.lowered, "{about}");
        assert_eq!(refed.unrepaired, [], "{about}");
        let (again, second) = limited::<D>(&text, text.len() + 1, &limits);
        assert_eq!(String::from_utf8_lossy(&again), expected, "{about}, a second time");
        assert_eq!((second.changed, second.lowered), (0, 0), "{about}");
    }
}

/// True if a feed is unchanged, or lowered to at most its limit and at most a thousandth less.
fn is_limited(before: f64, after: f64, limit: f64) -> bool {
    if limit >= before * (1.0 - 1e-9) {
        // The same, but for another unit of length in which it has been written.
        (after - before).abs() <= before * 1e-9
    } else {
        after <= limit * (1.0 + 1e-11) && after >= limit * (1.0 - 1.001e-3)
    }
}

/// Everything of a path but its feeds.
pub(crate) fn shapes(path: &[PathElement]) -> Vec<PathElement> {
    path.iter().map(without_feed).collect()
}

/// Everything of an element but its feed.
fn without_feed(element: &PathElement) -> PathElement {
    PathElement { feed: 0.0, ..element.clone() }
}

/// A program without its F words and blanks, line by line; it may have no comments with F in them.
fn without_feeds(program: &str) -> Vec<String> {
    let line = |line: &str| {
        let mut kept = String::new();
        let mut characters = line.chars().filter(|c| *c != ' ').peekable();
        while let Some(character) = characters.next() {
            if !character.eq_ignore_ascii_case(&'f') {
                kept.push(character);
                continue;
            }
            while characters.next_if(|c| c.is_ascii_digit() || *c == '.').is_some() {}
        }
        kept
    };
    program.split('\n').map(line).collect()
}

/// Asserts that a path is `before` with the feeds that `table` allows, except in lines that are reported.
pub(crate) fn check_path<D: Dialect>(
    before: &[PathElement],
    after: &[PathElement],
    table: &Table,
    refed: &Refed,
) -> Result<(), TestCaseError> {
    let slow = refed.unrepaired.iter().filter(|one| one.reason != Reason::Rapid);
    let reported: Vec<u32> = slow.map(|one| one.place.line).collect();
    prop_assert_eq!(before.len(), after.len());
    for (before, after) in before.iter().zip(after) {
        prop_assert_eq!(without_feed(before), without_feed(after));
        if D::is_governed(before) && !reported.contains(&before.place.line) {
            let limit = D::limit_of(table, before);
            prop_assert!(
                is_limited(before.feed, after.feed, limit),
                "{before:?}: {} becomes {}, limit {limit} of {table:?}",
                before.feed,
                after.feed
            );
        } else if before.kind == ElementKind::Rapid {
            prop_assert_eq!(before.feed.to_bits(), after.feed.to_bits());
        }
    }
    Ok(())
}

/// Asserts that with `table` the path of a program is the same, each line goes with the smaller of feed and limit, all
/// but F words stays, a second reduction changes nothing, and every changed line is needed: without it the path has
/// another feed. Returns what was done.
pub(crate) fn check_program<D: Dialect>(
    program: &str,
    table: &Table,
) -> Result<Refed, TestCaseError> {
    let (text, refed) = written::<D>(program.as_bytes(), table);
    let text = String::from_utf8(text).unwrap();
    let after = D::path(text.as_bytes());
    check_path::<D>(&D::path(program.as_bytes()), &after, table, &refed)?;
    prop_assert_eq!(without_feeds(program), without_feeds(&text));
    let (again, second) = written::<D>(text.as_bytes(), table);
    prop_assert_eq!(String::from_utf8(again).unwrap(), text.as_str());
    prop_assert_eq!((second.changed, second.lowered), (0, 0));
    let (old, new): (Vec<_>, Vec<_>) = (program.split('\n').collect(), text.split('\n').collect());
    let changed: Vec<_> = (0..old.len()).filter(|index| old[*index] != new[*index]).collect();
    prop_assert_eq!(changed.len() as u64, refed.changed);
    for index in changed {
        let mut one = new.clone();
        one[index] = old[index];
        let without = D::path(one.join("\n").as_bytes());
        prop_assert_ne!(without, after.clone(), "line {} of {}", index + 1, text);
    }
    Ok(refed)
}

/// Asserts that any bytes come back as they are without limits, keep their path with some, and that how they arrive
/// does not matter.
pub(crate) fn check_bytes<D: Dialect>(
    program: &[u8],
    table: &Table,
    capacity: usize,
) -> Result<(), TestCaseError> {
    let (same, refed) = written::<D>(program, &Table::new());
    prop_assert_eq!(&same, program);
    prop_assert_eq!(refed.changed, 0);
    let (text, refed) = written::<D>(program, table);
    let (other, in_pieces) = limited::<D>(program, capacity, &stream(table));
    prop_assert_eq!(&in_pieces, &refed);
    prop_assert_eq!(&text, &other);
    let (before, after) = (D::path(program), D::path(&text));
    prop_assert_eq!(shapes(&before), shapes(&after));
    for element in after.iter().filter(|element| D::is_governed(element)) {
        let limit = D::limit_of(table, element);
        let is_reported = refed.unrepaired.iter().any(|one| one.place.line == element.place.line);
        prop_assert!(element.feed <= limit * (1.0 + 1.1e-9) || is_reported, "{element:?} {limit}");
    }
    Ok(())
}

#[test]
fn feeds_are_rounded_down_to_four_digits() {
    for (value, text) in [
        (1.0, "1"),
        (0.999_99, "0.9999"),
        (20.0 - 4e-15, "20"),
        (123.456, "123.4"),
        (1_234_567.0, "1234000"),
        (1e6, "1000000"),
        (0.001_239_9, "0.001239"),
        (1e-9, "0.000000001"),
        (59.999_9, "59.99"),
        (0.1 + 0.2, "0.3"),
    ] {
        let (number, written) = rounded_down(value).unwrap();
        assert_eq!(written, text, "{value}");
        assert_eq!(number.to_bits(), text.parse::<f64>().unwrap().to_bits());
    }
    for value in [0.0, -1.0, 1e-10, f64::NAN, f64::INFINITY, 1e13] {
        assert_eq!(rounded_down(value), None, "{value}");
    }
}

proptest! {
    #[test]
    fn a_rounded_feed_is_below_and_near(mantissa in 1.0..10.0_f64, exponent in -9..12_i32) {
        let value = mantissa * 10_f64.powi(exponent);
        prop_assume!((1e-9..=1e12).contains(&value));
        let (number, text) = rounded_down(value).unwrap();
        prop_assert!(number <= value * (1.0 + 1e-11) && number > value * (1.0 - 1.001e-3), "{value} {text}");
        let digits = text.replace('.', "");
        prop_assert!(digits.trim_matches('0').len() <= 4, "{text}");
        prop_assert_eq!(crate::number::parse(text.as_bytes()), Some(number));
    }

    /// However limits are shuffled within the room they have, each line gets the smallest of its own.
    #[test]
    fn limits_may_come_late(order in prop::collection::vec((1..60_u32, any::<bool>(), 0.0..1.0_f64), 0..80)) {
        let mut limits = Limits::new(order.iter().map(|(line, rapid, feed)| {
            Ok(LineLimit { line: *line, rapid: *rapid, feed: *feed })
        }));
        for line in 1..=60 {
            let least = |rapid: bool| {
                let own = order.iter().filter(|one| one.0 == line && one.1 == rapid);
                own.fold(f64::INFINITY, |least, one| least.min(one.2))
            };
            let limit = limits.of(line).unwrap();
            let found = [limit.feed, limit.rapid].map(f64::to_bits);
            prop_assert_eq!(found, [least(false), least(true)].map(f64::to_bits));
        }
    }
}

#[test]
fn a_limit_that_comes_too_late_is_an_error() {
    let limits = [1, 2 + LATE, 3 + LATE, 1].map(|line| LineLimit { line, rapid: false, feed: 0.1 });
    let mut limits = Limits::new(limits.into_iter().map(Ok));
    assert!(limits.of(1).is_ok());
    assert!(limits.of(2).is_ok());
    assert!(matches!(limits.of(3), Err(RefeedError::Late(1))));
}
