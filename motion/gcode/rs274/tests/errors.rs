//! Tests of every error: its message, its line and the bytes it points at. LinuxCNC's rules define the errors
//! (`linuxcnc.rs`); the messages are ours.

use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{MAX_LINE_BYTES, ToolTable};

/// Asserts that `block` as the third line of a program has this one error. `pointed` is the text pointed at; empty for
/// the line as a whole.
#[track_caller]
fn assert_error(block: &str, pointed: &str, message: &str, rule: Rule) {
    let options = DecoderOptions { tools: Some(ToolTable::default()), ..DecoderOptions::default() };
    let program = format!("F100 G1\nX1 Y1\n{block}\nM2\n");
    let decoded = decode_with(options, program.as_bytes());
    let [diagnostic] = &decoded.errors[..] else { panic!("{block:?}: {:#?}", decoded.errors) };
    assert_eq!(diagnostic.error.to_string(), message, "{block:?}");
    assert!(diagnostic.to_string().starts_with("line 3"), "{diagnostic}");
    assert_eq!(diagnostic.place.line, 3, "{block:?}");
    assert_eq!(diagnostic.error.rule(), rule, "{block:?}");
    let found = diagnostic.columns.clone().map(|columns| &block[columns]);
    assert_eq!(found.unwrap_or_default(), pointed, "{block:?}");
}

#[test]
fn no_words() {
    const WORD: &str = "is not part of a word: a block is made of letters followed by numbers";
    for (block, character) in
        [("X2 = Y3", '='), ("X2 é", 'é'), ("/X2 /", '/'), ("X2 % Y3", '%'), ("X2 )", ')')]
    {
        let message = format!("'{character}' {WORD}");
        assert_error(block, &character.to_string(), &message, Rule::Syntax);
    }
    for (block, pointed, message) in [
        ("X2 (deep Y3", "(deep Y3", "the comment is not closed with ) in its line"),
        ("X2 (a (b) c)", "(", "comments cannot be nested"),
        ("X Y3", "X", "a number must follow after X"),
        ("Y3 z", "z", "a number must follow after Z"),
        ("X1.2.3 Y1", "X1.2.3", "what follows X is not a number"),
        ("X. Y1", "X.", "what follows X is not a number"),
        ("Nx X2", "N", "a whole number must follow after N"),
        ("N-1 X2", "N", "a whole number must follow after N"),
        ("X2 N20", "N", "N must be the first word of its block"),
    ] {
        assert_error(block, pointed, message, Rule::Syntax);
    }
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

#[test]
fn numbers_out_of_range() {
    for (block, pointed, message) in [
        ("X2000000", "X2000000", "X is 2000 m, outside -1000 m to 1000 m"),
        ("Y-1000000.5", "Y-1000000.5", "Y is -1000.0005 m, outside -1000 m to 1000 m"),
        ("A2000000000", "A2000000000", "A is 2000000000°, outside -1000000000° to 1000000000°"),
        ("G2 X2 R2000000000", "R2000000000", "R is 2000000 m, outside -1000000 m to 1000000 m"),
        ("G2 X2 I2000000000", "I2000000000", "I is 2000000 m, outside -1000000 m to 1000000 m"),
        (
            "Z2000000000000",
            "Z2000000000000",
            "Z is 2000000000000, outside -1000000000000 to 1000000000000",
        ),
        ("X2 F-5.5", "F-5.5", "F is -5.5, outside 0 to 1000000000"),
        ("X2 F2000000000", "F2000000000", "F is 2000000000, outside 0 to 1000000000"),
        ("S-1", "S-1", "S is -1, outside 0 to 1000000000"),
        ("T-1", "", "T is -1, outside 0 to 1000000"),
        ("T1.5", "", "T takes a whole number, not 1.5"),
        ("T2000000", "", "T is 2000000, outside 0 to 1000000"),
        ("G43 H1.5", "", "H takes a whole number, not 1.5"),
        ("G4 P-1", "", "P is -1 s, outside 0 s to 1000000 s"),
        ("G4 P2000000", "", "P is 2000000 s, outside 0 s to 1000000 s"),
        ("G2 I2 P1.5", "", "P takes a whole number, not 1.5"),
        ("G2 I2 P0", "", "P is 0, outside 1 to 1000000"),
        ("G81 Z-1 R1 L0", "", "L is 0, outside 1 to 1000000"),
        ("G81 Z-1 R1 L1.5", "", "L takes a whole number, not 1.5"),
        ("G82 Z-1 R1 P-1", "", "P is -1 s, outside 0 s to 1000000 s"),
        ("G83 Z-1 R1 Q0", "", "the peck Q of G83 is 0, it must be more than 0"),
        ("G83 Z-1 R1 Q-.5", "", "the peck Q of G83 is -0.5, it must be more than 0"),
    ] {
        assert_error(block, pointed, message, Rule::Syntax);
    }
    let decoded = decode(&format!("G0 X{}\nM2", "9".repeat(400)));
    assert_eq!(
        decoded.errors[0].to_string(),
        "line 1: X is inf, outside -1000000000000 to 1000000000000"
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

#[test]
fn words_that_do_not_go_together() {
    const G: &str = "of this block: they belong to one modal group";
    for (block, pointed, message) in [
        ("X2 Y3 x4", "x4", "a second X word in one block"),
        ("F1 F2", "F2", "a second F word in one block"),
        ("G0 X2 G1", "G1", &*format!("G1 contradicts another G word {G}")),
        ("G90 G91", "G91", &*format!("G91 contradicts another G word {G}")),
        ("G59.3 G54", "G54", &*format!("G54 contradicts another G word {G}")),
        ("G59 G59.3", "G59.3", &*format!("G59.3 contradicts another G word {G}")),
        ("G40 G40", "G40", &*format!("G40 contradicts another G word {G}")),
        ("M3 M5", "M5", &*format!("M5 contradicts another M word {G}")),
        ("M6 T0 M6", "M6", &*format!("M6 contradicts another M word {G}")),
        ("M3 M6 M8 M1 M0", "M0", "a block has at most 4 M words"),
        ("X2 R5", "R5", "R has no effect in this block"),
        ("X2 P5", "P5", "P has no effect in this block"),
        ("G0 X2 I5", "I5", "I has no effect in this block"),
        ("G81 Z-1 R1 Q1", "Q1", "Q has no effect in this block"),
        ("G49 H1", "H1", "H has no effect in this block"),
        ("X2 L5", "L5", "L has no effect in this block"),
        (
            "G80 X2",
            "",
            "axis words without a motion: no G0, G1, G2, G3 or canned cycle is in force",
        ),
        (
            "G0 G28 X2",
            "",
            "G0 and another G word of this block both use its axis words: write them in two blocks",
        ),
        (
            "G2 G92 X2 I1",
            "",
            "G2 and another G word of this block both use its axis words: write them in two blocks",
        ),
        ("G92", "", "G92 needs an axis word"),
        ("G81 R1", "", "G81 needs an axis word"),
        ("G81 X1 R1", "", "G81 needs Z"),
        ("G81 X1 Z-1", "", "G81 needs R"),
        ("G18 G81 X1 R1", "", "G81 needs Y"),
        ("G82 X1 Z-1 R1", "", "G82 needs P"),
        ("G83 X1 Z-1 R1", "", "G83 needs Q"),
        ("G81 Z2.5 R1", "", "the retract plane R at 1 is below the bottom of the hole at 2.5"),
        ("G83 Z-5000 R1 Q.5", "", "this canned cycle has more than 10000 moves"),
        ("G81 Z-1 R1 L1000000", "", "this canned cycle has more than 10000 moves"),
        ("G83 Z-1 R1 Q.000000001", "", "this canned cycle has more than 10000 moves"),
        ("G4", "", "G4 needs the time P in seconds"),
        ("G53 G2 X2 I1", "", "G53 needs G0 or G1"),
        ("G53", "", "G53 needs G0 or G1"),
        ("G91 G53 X2", "", "G53 cannot be used with incremental distances (G91)"),
        ("G93 X2", "", "with inverse time (G93) every block with feed motion needs its F"),
        ("G93 G81 Z-1 R1", "", "canned cycles cannot be used with inverse time (G93)"),
        ("T5", "", "tool 5 is not in the tool table"),
        ("G43 H7", "", "tool 7 is not in the tool table"),
    ] {
        assert_error(block, pointed, message, Rule::Syntax);
    }
}

#[test]
fn arcs() {
    for (block, pointed, message) in [
        ("G2 X5 Y5", "", "an arc needs its radius R or its centre"),
        ("G3 X5 Y5 R5 I1", "", "an arc takes either its radius R or its centre, not both"),
        ("G2 X5 Y5 I1 K1", "K1", "K is not in the plane of the arc"),
        ("G18 G2 X5 Z5 I1 J1", "J1", "J is not in the plane of the arc"),
        (
            "G90.1 G2 X5 I1",
            "",
            "J is missing: with G90.1 the centre of an arc needs both its words",
        ),
        ("G2 Z5 R1", "", "an arc by R needs an axis word of its plane"),
        (
            "G2 X1 R5",
            "",
            "start and end of an arc by R are the same point, so that its centre is undetermined: a full circle needs its centre",
        ),
        ("G2 X11 R4.9", "", "no arc of radius R 4.9 mm joins two points that are 2 × 5 mm apart"),
        (
            "G20 G2 Y.039370078740 X1.039370078740 R.4",
            "",
            "no arc of radius R 10.16 mm joins two points that are 2 × 12.7 mm apart",
        ),
        ("G2 X5 Y1 I4", "", "the radius of the arc is zero: 4 mm at its start, 0 mm at its end"),
        ("G3 X4 Y3 I3", "", "start and end are not on one circle: 3 mm and 2 mm from the centre"),
    ] {
        assert_error(block, pointed, message, Rule::ArcGeometry);
    }
}

/// A missing feed is reported once, until there is one.
#[test]
fn missing_feed() {
    let messages = |program: &str| -> Vec<String> {
        decode(program).errors.iter().map(ToString::to_string).collect()
    };
    let missing = "motion without a feed: F has not been set, or not since G94";
    assert_eq!(messages("G1 X1\nX2\nM2"), [format!("line 1: {missing}")]);
    assert_eq!(
        messages("G1 X1 F5\nG94\nX3\nX4\nF6 X5\nG93 X6 F1\nG94 X7\nM2"),
        [format!("line 3: {missing}"), format!("line 7: {missing}")]
    );
    assert_eq!(messages("G1 X1 F0\nX2\nM2"), ["line 1: motion without a feed: F is 0"]);
    // An F that could not be read is one error, not two.
    for block in ["G1 X1 F", "G1 X1 F1.2.3", "G1 X1 F-1", "G1 [ F10"] {
        assert_eq!(messages(&format!("{block}\nX2\nM2")).len(), 1, "{block}");
    }
    let feed = "line 2: with inverse time (G93) every block with feed motion needs its F";
    assert_eq!(messages("G93 G1 X1 F5\nX2\nX3 F1\nM2"), [feed]);
}

#[test]
fn warnings() {
    let messages = |program: &str| -> Vec<String> {
        let decoded = decode(program);
        assert_eq!(decoded.errors, []);
        decoded.warnings.iter().map(ToString::to_string).collect()
    };
    let end = "the program does not end with M2, M30 or a second %";
    assert_eq!(messages("G0 X1\n\n"), [format!("line 2: {end}")]);
    assert_eq!(messages("%\nG0 X1"), [format!("line 2: {end}")]);
    assert_eq!(messages("%\nG0 X1\n%"), [""; 0]);
    assert_eq!(messages("G0 X1\n%"), [""; 0]);
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
        let decoded = decode(&format!("{long}\nG0 X2\nM2"));
        let [error] = &decoded.errors[..] else { panic!("{:?}", decoded.errors) };
        assert_eq!(error.to_string(), "line 1: the line is longer than 65536 bytes");
        assert_eq!(error.error.rule(), Rule::Syntax);
        assert_eq!(decoded.elements[0].place.line, 2);
        assert_eq!(decode(&format!("{long} ")).errors.len(), 1, "without a line end");
    }
}

/// All well-formed words are checked; nothing is read behind text that is not a word.
#[test]
fn several_in_a_block() {
    let decoded = decode("N10 G7 X1 E3 X2 Y1..5 G1 M98 = M30 U1\nM2");
    let found: Vec<_> = decoded.errors.iter().map(|error| error.columns.clone().unwrap()).collect();
    assert_eq!(found, [4..6, 10..12, 13..15, 16..21, 25..28, 29..30]);
    assert!(decoded.errors.iter().all(|error| error.place.block == Some(10)));
}

/// Feed and modes of an erroneous block hold, and the path goes on from where it was to lead.
#[test]
fn modes_of_an_erroneous_block_hold() {
    let decoded = decode("G0 X1\nG1 G91 F60 M98\nX1\nG3 X1 I9\nG1 X1\nM2");
    assert_eq!(decoded.errors.len(), 2);
    assert_eq!(
        ends_mm(&decoded.elements),
        [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]]
    );
    assert_eq!(decoded.elements[1].feed, 0.001);
    assert_eq!(decoded.elements[2].kind, ElementKind::Jump);
    // M2 ends the program although there is something wrong in its block.
    assert_eq!(decode("G0 X1\nM2 M98\nX2").elements.len(), 1);
}
