//! Tests of every error: its message, its line and the bytes it points at. LinuxCNC's rules define the errors
//! (`linuxcnc.rs`); the messages are ours.

use super::{decode_strictly as decode, *};
use crate::decode::{Rule, TextError};
use crate::rs274::{MAX_LINE_BYTES, ToolTable, tests::probe::above};
use std::collections::BTreeMap;

/// Blocks with one thing wrong, by rule: block, text pointed at (empty: the line as a whole), message. Behind text that is not
/// supported there may be more: their messages.
const MESSAGES: &str = include_str!("messages.json");

fn messages(program: &str) -> Vec<String> {
    decode(program).errors.iter().map(ToString::to_string).collect()
}

/// In the third line of a program, with nothing known of tools and everything touched.
#[test]
fn every_message() {
    let rules: BTreeMap<&str, Vec<Vec<&str>>> = serde_json::from_str(MESSAGES).unwrap();
    let rows = rules.iter().flat_map(|(rule, rows)| rows.iter().map(move |row| (*rule, row)));
    for (rule, row) in rows {
        let [block, pointed, messages @ ..] = &row[..] else { panic!("{row:?}") };
        assert!(messages.len() == 1 || rule == "UnsupportedWord", "{row:?}");
        let options =
            DecoderOptions { tools: Some(ToolTable::default()), strict: true, ..above(1e9) };
        let decoded = decode_with(options, format!("F100 G1\nX1 Y1\n{block}\nM2\n").as_bytes());
        let found: Vec<_> = decoded.errors.iter().map(|one| one.error.to_string()).collect();
        assert_eq!(found, *messages, "{block:?}");
        let diagnostic = &decoded.errors[0];
        assert!(diagnostic.to_string().starts_with("line 3"), "{diagnostic}");
        assert_eq!(diagnostic.place.line, 3, "{block:?}");
        assert_eq!(format!("{:?}", diagnostic.error.rule()), rule, "{block:?}");
        let found = diagnostic.columns.clone().map(|columns| &block[columns]);
        assert_eq!(found.unwrap_or_default(), *pointed, "{block:?}");
        if rule == "UnsupportedWord" {
            let before = elements("F100 G1\nX1 Y1\nM2");
            assert_eq!(decoded.elements, before, "{block:?} is executed");
        }
    }
    let decoded = super::decode(&format!("G0 X{}\nM2", "9".repeat(400)));
    assert_eq!(
        decoded.errors[0].to_string(),
        "line 1: X is inf, outside -1000000000000 to 1000000000000"
    );
}

#[test]
fn bytes_that_are_no_text() {
    let decoded = decode_with(DecoderOptions::default(), b"G0 X1\nN7 Y\xFF2\nX2 \xFF\nM2");
    let found: Vec<_> =
        decoded.errors.iter().map(|error| (error.to_string(), error.columns.clone())).collect();
    assert_eq!(
        found,
        [
            ("line 2 (N7): a number must follow after Y".to_owned(), Some(3..4)),
            ("line 3: byte 0xff is neither ASCII nor UTF-8 text".to_owned(), Some(3..4)),
        ]
    );
}

/// Relative targets may lead out of range though each number is within.
#[test]
fn out_of_range_in_steps() {
    let decoded = decode("G91 G0 Z900000\nZ900000\nX1\nM2");
    let [error] = &decoded.errors[..] else { panic!("{:?}", decoded.errors) };
    assert_eq!(error.to_string(), "line 2: Z is 1800 m, outside -1000 m to 1000 m");
    assert_eq!(ends_mm(&decoded.elements), [[0.0, 0.0, 9e5], [1.0, 0.0, 9e5]]);
}

/// A missing feed is reported once, until there is one.
#[test]
fn missing_feed() {
    let missing = "motion without a feed: F has not been set, or not since G94";
    assert_eq!(messages("G1 X1\nX2\nM2"), [format!("line 1: {missing}")]);
    assert_eq!(
        messages("G1 X1 F5\nG94\nX3\nX4\nF6 X5\nG93 X6 F1\nG94 X7\nM2"),
        [format!("line 3: {missing}"), format!("line 7: {missing}")]
    );
    assert_eq!(messages("G38.3 Z-1\nM2"), [format!("line 1: {missing}")]);
    for zero in ["G1 X1 F0\nX2\nM2", "G38.3 Z-1 F0\nM2"] {
        assert_eq!(messages(zero), ["line 1: motion without a feed: F is 0"]);
    }
    // An F that could not be read is one error, not two.
    for block in ["G1 X1 F", "G1 X1 F1.2.3", "G1 X1 F-1", "G1 [ F10"] {
        assert_eq!(messages(&format!("{block}\nX2\nM2")).len(), 1, "{block}");
    }
    let feed = "line 2: with inverse time (G93) every block with feed motion needs its F";
    assert_eq!(messages("G93 G1 X1 F5\nX2\nX3 F1\nM2"), [feed]);
    assert_eq!(messages("F5\nG93 G38.2 Z-15\nM2"), [feed]);
    assert_eq!(messages("G93 G1 X1 F0\nM2"), ["line 1: motion without a feed: F is 0"]);
}

#[test]
fn warnings() {
    let messages = |program: &str| -> Vec<String> {
        let decoded = super::decode(program);
        assert_eq!(decoded.errors, []);
        decoded.warnings.iter().map(ToString::to_string).collect()
    };
    assert_eq!(messages("%\nG0 X1\n%"), [""; 0]);
    assert_eq!(messages("G0 X1 M30"), [""; 0]);
    assert_eq!(
        messages("G43 H3\nM2"),
        ["line 1: without a tool table the length of tool 3 is assumed to be 0"]
    );
    assert_eq!(messages("G43\nM2"), [""; 0], "there is no tool in the spindle");
}

#[test]
fn long_lines() {
    let fits = format!("G0 X1{}\nM2", " ".repeat(MAX_LINE_BYTES - 6));
    assert_eq!(elements(&fits).len(), 1);
    for extra in [1, 2, 10, 3 * MAX_LINE_BYTES] {
        let long = format!("G0 X1{}", " ".repeat(MAX_LINE_BYTES - 6 + extra));
        let decoded = super::decode(&format!("{long}\nG0 X2\nM2"));
        let [error] = &decoded.errors[..] else { panic!("{:?}", decoded.errors) };
        assert_eq!(error.to_string(), "line 1: the line is longer than 65536 bytes");
        assert_eq!(error.error.rule(), Rule::Syntax);
        assert_eq!(decoded.elements[0].place.line, 2);
        assert_eq!(super::decode(&format!("{long} ")).errors.len(), 1, "without a line end");
    }
}

/// All well-formed words are checked; nothing is read behind text that is not a word.
#[test]
fn several_in_a_block() {
    let decoded = decode("N10 G13 X1 G9 X2 Y1..5 G1 M29 = M30 U1\nM2");
    let found: Vec<_> = decoded.errors.iter().map(|error| error.columns.clone().unwrap()).collect();
    assert_eq!(found, [4..7, 11..13, 14..16, 17..22, 26..29, 30..31]);
    assert!(decoded.errors.iter().all(|error| error.place.block == Some(10)));
}

/// Feed and modes of an erroneous block hold, and the path goes on from where it was to lead.
#[test]
fn modes_of_an_erroneous_block_hold() {
    let decoded = decode("G0 X1\nG1 G91 F60 M29\nX1\nG3 X1 I9\nG1 X1\nM2");
    assert_eq!(decoded.errors.len(), 2);
    assert_eq!(
        ends_mm(&decoded.elements),
        [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]]
    );
    assert_eq!(decoded.elements[1].feed, 0.001);
    assert_eq!(decoded.elements[2].kind, ElementKind::Jump);
    // M2 ends the program although there is something wrong in its block.
    assert_eq!(decode("G0 X1\nM2 M29\nX2").elements.len(), 1);
}

/// Behind a block with an error the path goes on where it was meant to end, and nothing else is wrong.
#[test]
fn twenty_faults_are_twenty_errors() {
    let decoded = decode(include_str!("faults.ngc"));
    let lines: Vec<_> = decoded.errors.iter().map(|error| error.place.line).collect();
    let marked = include_str!("faults.ngc").lines().zip(1..);
    let faults: Vec<u32> =
        marked.filter(|(text, _)| text.contains("(fault")).map(|(_, line)| line).collect();
    assert_eq!(faults.len(), 20);
    assert_eq!(lines, faults);
    for pair in decoded.elements.windows(2) {
        assert_eq!(pair[0].end(), pair[1].start());
    }
    // Every move is 10 mm long and goes to the X of its line but for jumps, which make up for faults.
    let moves =
        decoded.elements.iter().filter(|it| it.kind != ElementKind::Jump && it.place.line > 3);
    for element in moves {
        let x = f64::from(element.place.line) * 0.01;
        assert!((element.end().x - x).abs() < 1e-12, "{element:?}");
        assert!((element.start().x - x).abs() < 0.010_001, "{element:?}");
    }
    assert_eq!(ends_mm(&decoded.elements).last(), Some(&[440.0, 0.0, 0.0]));
}

/// Where an arc begins behind a block that could not be read is unknown.
#[test]
fn arcs_behind_a_block_that_cannot_be_read() {
    for fault in ["G1 X20,5 Y10", "X Y20", "G1 X20 X25", "G1 X2O", "G1 X[10+10"] {
        let decoded = decode(&format!("F60 G1 X5 Y5\n{fault}\nG2 X30.5 Y10 I5 J0\nG1 X1\nM2"));
        assert_eq!(decoded.errors.len(), 1, "{fault}: {:?}", decoded.errors);
        // Known again.
        let decoded = decode(&format!("F60 G1\n{fault}\nG1 X0 Y0\nG2 X9 I1\nM2"));
        assert_eq!(decoded.errors.len(), 2, "{fault}: {:?}", decoded.errors);
    }
}

/// A loop or condition that cannot be read is one error; its end is none.
#[test]
fn statements_that_cannot_be_read() {
    for program in [
        "o1 if [#1 FOO 2]\nG0 X1\no1 else\nG0 X2\no1 endif\nM2",
        "o1 while [1 FOO]\nG0 X1\no1 endwhile\nM2",
        "o1 repeat\nG0 X1\no1 endrepeat\nM2",
        "o<s> sub\nG0 X1\no<s> endsub [1/0]\no<s> call\nM2",
    ] {
        assert_eq!(decode(program).errors.len(), 1, "{program}: {:?}", decode(program).errors);
    }
}

/// Radii, polar coordinates and the assumed G0 count behind an error too.
#[test]
fn ends_of_faulty_blocks() {
    for (program, ends_at) in [
        ("G0 X2\nG7 G1 F9 X20 H5\nG8 G0 Y1\nM2", [10.0, 1.0, 0.0]),
        ("G0 X1\n@20 ^90 H1\nG0 Z1\nM2", [0.0, 20.0, 1.0]),
        ("X10 H1\nG0 Z1\nM2", [10.0, 0.0, 1.0]),
    ] {
        let decoded = super::decode(program);
        assert_eq!(decoded.errors.len(), 1, "{program}");
        assert_eq!(ends_mm(&decoded.elements).last(), Some(&ends_at), "{program}");
    }
}
