//! Tests of the notation of words: blanks, comments, `%`, numbers of blocks and programs; arcs, feeds, path modes.

use super::*;
use crate::rs274::{MAX_CYCLE_MOVES, PathMode};
use ElementKind::{Cut, Dwell, Rapid};
use std::f64::consts::PI;

/// As harmless as I0: the centre is in the plane.
#[test]
fn center_words_of_zero_along_the_normal() {
    for (with, without) in [
        ("G2 X10 I5 K0 F100", "G2 X10 I5 F100"),
        ("G18 G3 X10 I5 J0 F100", "G18 G3 X10 I5 F100"),
        ("G19 G2 Y10 J5 I0 F100", "G19 G2 Y10 J5 F100"),
    ] {
        assert_eq!(elements(&format!("{with}\nM2")), elements(&format!("{without}\nM2")), "{with}");
    }
}

#[test]
fn ways_to_write_a_line() {
    let expected = ends_mm(&elements("G0 X1.5 Y-2 Z0.25\nM2"));
    for line in [
        "G0X1.5Y-2Z0.25",
        "g00x1.5y-2z.25",
        "  G 0 X 1 . 5 Y - 2 Z 0.2 5 ",
        "Z.25 Y-2. X+1.5 G0.0",
        "N10 G0 X1.5 Y-2 Z0.25 ; comment (with G1 X9",
        "n10.5G0X1.5Y-2Z.25",
        "/G0 X1.5 Y-2 Z0.25",
        "  / N5 G0 X1.5 Y-2 Z0.25",
        "(a) G0 (b) X1.5 (X9 ; c) Y-2 Z0.25 (d)",
        "G0\tX1.5\tY-2\tZ0.25\r",
        "\u{feff}G0 X1.5 Y-2 Z0.25",
        "(é \u{1f600}) G0 X001.50 Y-002 Z000.2500",
    ] {
        let found = elements(&format!("{line}\nM2"));
        assert_eq!(ends_mm(&found), expected, "{line:?}");
    }
}

#[test]
fn places() {
    let found = elements("%\nO7 (plate)\n\nN10 G0 X1\nN4294967295 X2\nN4294967296 X3\nX4\n%\nX5 #");
    let places: Vec<_> = found.iter().map(|element| element.place.to_string()).collect();
    assert_eq!(places, ["line 4 (N10)", "line 5 (N4294967295)", "line 6", "line 7"]);
}

#[test]
fn program_numbers() {
    for (program, number) in [
        ("O7\nG0 X1\nM2", Some(7)),
        ("%\no0012 (name)\nG0 X1\n%", Some(12)),
        ("(head)\n\nO1 ; name\nM2", Some(1)),
        ("N1 O5\nM2", Some(5)),
        ("O99999999999\nM2", None),
        ("G0 X1\nM2", None),
    ] {
        let mut decoder = Decoder::new(program.as_bytes(), DecoderOptions::default());
        assert!(decoder.by_ref().all(|item| item.is_ok()), "{program}");
        assert_eq!(decoder.program_number(), number, "{program}");
    }
}

/// Behind M2, M30 and the second `%` nothing is looked at.
#[test]
fn ends_of_programs() {
    for end in ["M2", "M30", "X1 M2", "N9 M02 (end)"] {
        let decoded = decode(&format!("G0 X1\n{end}\nX3 #"));
        assert!(decoded.errors.is_empty() && decoded.warnings.is_empty(), "{end}");
    }
    assert_eq!(elements("%\nG0 X1\n  %  \nX2 #").len(), 1);
    assert_eq!(elements("G0 X1\n%\nX2 #").len(), 1);
}

#[test]
fn suppressed_blocks() {
    let program = "G0 X1\n/X2\n  /N3 X3 #\nX4\nM2";
    let options = DecoderOptions { skip_suppressed_blocks: true, ..DecoderOptions::default() };
    assert_eq!(ends_mm(&elements_with(options, program)), [[1.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
    assert_eq!(decode(program).errors.len(), 1);
    // The path goes on at X3.
    let decoded = decode(program);
    assert_eq!(ends(&decoded.elements), "1 0 0 | 2 0 0 | 3 0 0 | 4 0 0");
    assert_eq!(decoded.elements[2].kind, ElementKind::Jump);
}

#[test]
fn modal_lines() {
    let found = elements("F60 G1 X1\nY2\nG91\nX1\nG90 G0\nX1\nG4 P.5\nX2\nM2");
    // A G word of a motion without axes moves nothing, but is a move in LinuxCNC.
    assert_eq!(kinds(&found), [Cut, Cut, Cut, Rapid, Rapid, Dwell { time_ns: 500_000_000 }, Rapid]);
    assert_eq!(ends(&found), "1 0 0 | 1 2 0 | 2 2 0 | 2 2 0 | 1 2 0 | 1 2 0 | 2 2 0");
    let options = DecoderOptions { keep_empty_moves: false, ..DecoderOptions::default() };
    assert_eq!(elements_with(options, "G0 X1\nX1\nG0\nX2\nM2").len(), 2);
}

#[test]
fn velocities() {
    let options = DecoderOptions {
        rapid_velocity: 0.5,
        acceleration: 2.0,
        deceleration: 3.0,
        ..DecoderOptions::default()
    };
    // 10 mm in half a minute, then in a third of one; without memory for the next block.
    let program = "G0 X10\nG1 X20 F120\nG93 X30 F2\nX40 F3\nG0 X50\nG94 G1 X60 F600\nX70\nM2";
    let found = elements_with(options, program);
    let feeds: Vec<f64> = found.iter().map(|e| (e.feed * 1e12).round() / 1e12).collect();
    assert_eq!(feeds, [0.5, 0.002, 0.000_333_333_333, 0.0005, 0.5, 0.01, 0.01]);
    for element in &found {
        assert_eq!((element.acceleration, element.deceleration), (2.0, 3.0));
        assert!(element.end_velocity.is_infinite());
    }
    // An arc in inverse time: half the circle of radius 5 mm in a second.
    let found = elements("G93 G2 X10 I5 F60\nM2");
    assert!((found[0].feed - PI * 0.005).abs() < 1e-15);
    // However short the move is: 12 s each. Where only A turns, the feed is its velocity.
    let found = elements("G20 G93 G1 Z-0.00001 A178 F5\nA180 F5\nM2");
    assert!((found[0].feed - 2.54e-7 / 12.0).abs() < 1e-20);
    assert!((found[1].feed - 2e-3 / 12.0).abs() < 1e-15);
}

/// One block gives at most [`MAX_CYCLE_MOVES`] moves, and a canned cycle with that many is decoded.
#[test]
fn most_moves_of_a_cycle() {
    let count =
        |repeats: usize| decode(&format!("F60 G91 G81 X.001 Z-1 R1 L{repeats}\nM2")).elements.len();
    let most = MAX_CYCLE_MOVES / 5;
    // Up to R once; then for each hole above it, down to the bottom and up to R.
    assert_eq!(count(most), 1 + 3 * most);
    assert_eq!(count(most + 1), 0);
}

#[test]
fn modes_to_read() {
    let mut decoder = Decoder::new(
        &b"G61 S100 T4\nG0 X1\nG64\nX2\nG64 P.05\nX3\nG20 G64 P1 Q2 S200\nX4 M6\nM2"[..],
        DecoderOptions::default(),
    );
    assert_eq!((decoder.path_mode(), decoder.spindle_speed()), (PathMode::Continuous, None));
    let mut modes = Vec::new();
    while decoder.next().is_some() {
        modes.push((decoder.lines(), decoder.path_mode(), decoder.spindle_speed(), decoder.tool()));
    }
    let tolerance = |path, naive_cam| PathMode::Tolerance { path, naive_cam };
    assert_eq!(
        modes,
        [
            (2, PathMode::ExactPath, Some(100.0), 0),
            (4, PathMode::Continuous, Some(100.0), 0),
            (6, tolerance(0.05 / 1e3, None), Some(100.0), 0),
            (8, tolerance(0.0254, Some(0.0508)), Some(200.0), 4),
            (8, tolerance(0.0254, Some(0.0508)), Some(200.0), 4),
        ]
    );
    assert_eq!(decoder.lines(), 9);
    assert_eq!(decoder.position(), at([4.0 * 0.0254, 0.0, 0.0]));
}
