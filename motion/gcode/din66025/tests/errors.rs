//! Tests of every diagnostic, with the bytes it points at.

use super::*;
use crate::decode::{Rule, TextError};
use crate::din66025::MAX_LINE_BYTES;
use std::ops::Range;
use twin_path::Place;

/// `block` is the third line of a program, after a first motion; `pointed` is the text pointed at.
#[track_caller]
fn assert_error(block: &str, pointed: &str, error: &str, rule: Rule) {
    let decoded = decode(&format!("N10 G1 X1 F10\n{block}\nN30 G1 X50"));
    let found = diagnostics(&decoded);
    let [diagnostic] = found.as_slice() else { panic!("{block:?}: {found:#?}") };
    assert_eq!(format!("{:?}", diagnostic.error), error, "{block:?}");
    assert_eq!(diagnostic.error.rule(), rule);
    assert_eq!(diagnostic.place.line, 3);
    let columns = diagnostic.columns.clone().unwrap();
    assert_eq!(&block[columns], pointed, "{block:?}");
    // The block gives nothing, and the path goes on as if it were not there.
    let elements = remaining(&decoded);
    assert_eq!(ends_mm(&elements)[1], [[1.0, 0.0, 0.0], [50.0, 0.0, 0.0]], "{block:?}");
    assert_eq!(elements.len(), 2);
}

/// Block, text pointed at and error as it is printed for debugging.
#[test]
fn syntax() {
    let rows: Vec<[String; 3]> = serde_json::from_str(include_str!("errors.json")).unwrap();
    for [block, pointed, error] in &rows {
        assert_error(block, pointed, error, Rule::Syntax);
    }
    let decoded = decode(&format!("X{} F1", "9".repeat(400)));
    let error = &diagnostics(&decoded)[0].error;
    assert!(matches!(error, DecodeError::OutOfRange { value: f64::INFINITY, .. }), "{error}");
}

/// Relative targets may lead out of range though each number is within.
#[test]
fn out_of_range_in_steps() {
    let decoded = decode("G91\nN10 G1 Z900000 F10\nN20 Z900000 X1\nN30 X1");
    let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
    assert!(matches!(
        diagnostic.error,
        DecodeError::OutOfRange { letter: 'Z', value: 1_800_000.0, .. }
    ));
    assert_eq!(diagnostic.columns, Some(4..11));
    assert_eq!(ends_mm(&remaining(&decoded))[1], [[0.0, 0.0, 900_000.0], [1.0, 0.0, 900_000.0]]);
}

#[test]
fn unknown_letters() {
    for letter in "ABCT".chars() {
        let word = format!("{}1", letter.to_ascii_lowercase());
        assert!(DecodeError::UnknownLetter(letter).to_string().contains("unknown"));
        let error = format!("UnknownLetter({letter:?})");
        assert_error(&format!("N20 G1 X2 {word} Y3"), &word, &error, Rule::UnsupportedWord);
    }
}

#[test]
fn unknown_commands() {
    for number in [-1.0, 4.0, 7.0, 17.0, 21.0, 28.0, 43.0, 54.0, 94.0, 100.0, 1e20] {
        assert!(DecodeError::UnknownCommand(number).to_string().contains("unknown"));
        let (word, error) = (format!("G{number}"), format!("UnknownCommand({number:?})"));
        assert_error(&format!("N20 {word} X2"), &word, &error, Rule::UnsupportedWord);
    }
}

#[test]
fn arcs_that_are_not_said() {
    use DecodeError as E;
    for (block, pointed, error) in [
        ("N20 G2 X5 Y5", "N20 G2 X5 Y5", E::ArcWithoutCenter),
        ("N20 G3 X5 R5 Y5 I1", "R5 Y5 I1", E::RadiusAndCenter),
    ] {
        // What follows is an arc too, without centre: check the first only.
        let found = diagnostics(&decode(&format!("N10 G1 X1 F10\n{block}")));
        assert_eq!(found.len(), 1);
        assert_eq!((&found[0].error, found[0].error.rule()), (&error, Rule::ArcGeometry));
        assert_eq!(&block[found[0].columns.clone().unwrap()], pointed);
    }
    for (word, missing) in [("I5", 'J'), ("J5", 'I')] {
        let found = diagnostics(&decode(&format!("G98\nG2 X5 F10 {word}")));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].error, E::IncompleteCenter(missing));
        assert_eq!(found[0].columns, Some(10..12));
    }
}

/// All errors of a block are reported, from left to right, up to the first text that is not a word.
#[test]
fn several_in_a_block() {
    let decoded = decode("N10 G7 X1 T3 F0 Y1,5 G1 # M30");
    let found: Vec<(Range<usize>, DecodeError)> = diagnostics(&decoded)
        .into_iter()
        .map(|found| (found.columns.unwrap(), found.error))
        .collect();
    let expected = [
        (4..6, DecodeError::UnknownCommand(7.0)),
        (10..12, DecodeError::UnknownLetter('T')),
        (13..15, DecodeError::NonPositiveFeed(0.0)),
        (16..20, DecodeError::DecimalComma('Y')),
        (21..23, DecodeError::SecondG { first: 7.0, second: 1.0 }),
        (24..25, DecodeError::UnexpectedCharacter('#')),
    ];
    assert_eq!(found, expected);
}

/// Manual 6.1, error 1001. Once per program, at the first motion; the position is followed meanwhile.
#[test]
fn missing_feed() {
    let decoded = decode("N10 G92 X5\nN20 G0 X10\nN30 G1 Y10\nN40 X20 F10\n");
    let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
    assert_eq!(diagnostic.error, DecodeError::MissingFeed);
    assert!(diagnostic.to_string().contains("1001"), "{diagnostic}");
    assert_eq!(
        (diagnostic.place, diagnostic.columns.clone()),
        (Place { block: Some(20), ..Place::at(3) }, Some(4..6))
    );
    assert_eq!(ways(&remaining(&decoded)), "10 10 0 > 20 10 0");
}

/// What had no feed leaves a gap in a path that has begun: a jump, so that elements join.
#[test]
fn missing_feed_after_elements() {
    let decoded = decode("N10 G1 X0\nN20 G1 X10\nN30 G1 X20 F5");
    let elements = remaining(&decoded);
    assert_eq!(kinds(&elements), [ElementKind::Cut, ElementKind::Jump, ElementKind::Cut]);
    assert_eq!(diagnostics(&decoded).len(), 1);
}

/// An F that could not be read is one error, not two.
#[test]
fn missing_feed_is_no_consequence() {
    for block in ["N10 G1 X1 F0", "N10 G1 X1 FF10", "N10 G1 # F10", "N10 G1 X1 F1,5"] {
        assert_eq!(diagnostics(&decode(&format!("{block}\nN20 X2"))).len(), 1, "{block}");
    }
    assert_eq!(diagnostics(&decode("N10 (F) T3\nN20 X2")).len(), 2);
    assert_eq!(diagnostics(&decode("N10 T3 F5\nN20 X2")).len(), 1);
}

/// Feed, acceleration and modes of an erroneous block hold.
#[test]
fn modes_of_an_erroneous_block_hold() {
    let decoded = decode("N10 G91 T1\nN20 F5 E7 T3\nN30 X1\nN40 X1");
    let elements = remaining(&decoded);
    assert_eq!(ends_mm(&elements)[1][1], [2.0, 0.0, 0.0]);
    assert_close(elements[0].feed, 0.005);
    assert_close(elements[0].acceleration, 0.007);
}

#[test]
fn missing_percent() {
    for (program, count) in [("N10 G1 X1 F1\nG1 X2", 2), ("\n(plate)\nN10 G1 X1 F1", 1)] {
        let decoded = decode_from([0.0; 3], program.as_bytes());
        let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
        assert_eq!(diagnostic.error, DecodeError::MissingPercent);
        assert_eq!(remaining(&decoded).len(), count);
    }
}

#[test]
fn long_lines() {
    let fits = format!("G1 X1 F1{}\n", " ".repeat(MAX_LINE_BYTES - 9));
    assert_eq!(fits.len(), MAX_LINE_BYTES);
    assert_eq!(elements(&fits).len(), 1);
    for extra in [1, 2, 10, 3 * MAX_LINE_BYTES] {
        let long = format!("N10 G1 X1 F1{}", " ".repeat(MAX_LINE_BYTES - 12 + extra - 1));
        let decoded = decode(&format!("{long}\nN20 G1 X2 F1\n"));
        let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
        assert_eq!(diagnostic.error, DecodeError::LineTooLong(MAX_LINE_BYTES));
        assert_eq!((diagnostic.place.line, &diagnostic.columns), (2, &None));
        let elements = remaining(&decoded);
        assert_eq!((elements.len(), elements[0].place.line), (1, 3));
        assert_eq!(decode(&long).len(), 1, "without a line end");
    }
}

#[test]
fn bytes_that_are_no_text() {
    let decoded = decode_from([0.0; 3], b"%\nN10 G1 X1 \xFF F1\nN20 G1 X2 F1");
    let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
    assert_eq!(diagnostic.error, DecodeError::UnexpectedByte(0xFF));
    assert_eq!(diagnostic.columns, Some(10..11));
    // A character cut off by the end of the line.
    let decoded = decode_from([0.0; 3], b"%\nN10 G1 \xE2\x80");
    assert_eq!(diagnostics(&decoded)[0].error, DecodeError::UnexpectedByte(0xE2));
}

/// Columns count from the beginning of the line as it is in the file.
#[test]
fn columns_after_a_byte_order_mark() {
    let decoded = decode_from([0.0; 3], "\u{feff} X1 F1 #".as_bytes());
    let columns: Vec<_> =
        diagnostics(&decoded).into_iter().map(|found| found.columns.unwrap()).collect();
    assert_eq!(columns, [4..11, 10..11]);
}
