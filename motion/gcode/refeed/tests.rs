//! Tests of numbers and limits, and checks that the tests of both dialects share.

use super::edit::rounded_down;
use super::limits::{LATE, Limits};
use super::*;
use proptest::prelude::*;
use std::collections::BTreeMap;
use twin_path::{ElementKind, PathElement};

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

/// As they come from a planner.
pub(crate) fn stream(table: &Table) -> Vec<io::Result<LineLimit>> {
    table
        .iter()
        .map(|((line, rapid), feed)| Ok(LineLimit { line: *line, rapid: *rapid, feed: *feed }))
        .collect()
}

/// True if a feed is unchanged, or lowered to at most its limit and at most a thousandth less.
pub(crate) fn is_limited(before: f64, after: f64, limit: f64) -> bool {
    if limit >= before * (1.0 - 1e-9) {
        // The same, but for another unit of length in which it has been written.
        (after - before).abs() <= before * 1e-9
    } else {
        after <= limit * (1.0 + 1e-11) && after >= limit * (1.0 - 1.001e-3)
    }
}

/// Everything of an element but its feed.
pub(crate) fn without_feed(element: &PathElement) -> PathElement {
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

/// Asserts that a path is `before` with the feeds that `table` allows, which govern what `is_governed` says.
pub(crate) fn check_path(
    before: &[PathElement],
    after: &[PathElement],
    table: &Table,
    is_governed: impl Fn(&PathElement) -> bool,
    limit_of: impl Fn(&PathElement) -> f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(before.len(), after.len());
    for (before, after) in before.iter().zip(after) {
        prop_assert_eq!(without_feed(before), without_feed(after));
        if is_governed(before) {
            let limit = limit_of(before);
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

/// Asserts that `text` is `program` with other F words, that a second reduction changes nothing, and that every changed
/// line is needed: without it the path has another feed.
pub(crate) fn check_text(
    program: &str,
    text: &str,
    refed: &Refed,
    path: impl Fn(&[u8]) -> Vec<PathElement>,
    written: impl Fn(&[u8]) -> (Vec<u8>, Refed),
) -> Result<(), TestCaseError> {
    prop_assert_eq!(without_feeds(program), without_feeds(text));
    let (again, second) = written(text.as_bytes());
    prop_assert_eq!(String::from_utf8(again).unwrap(), text);
    prop_assert_eq!((second.changed, second.lowered), (0, 0));
    let (old, new): (Vec<_>, Vec<_>) = (program.split('\n').collect(), text.split('\n').collect());
    let changed: Vec<_> = (0..old.len()).filter(|index| old[*index] != new[*index]).collect();
    prop_assert_eq!(changed.len() as u64, refed.changed);
    let after = path(text.as_bytes());
    for index in changed {
        let mut one = new.clone();
        one[index] = old[index];
        let without = path(one.join("\n").as_bytes());
        prop_assert_ne!(without, after.clone(), "line {} of {}", index + 1, text);
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
