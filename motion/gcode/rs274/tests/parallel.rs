//! Tests of U, V and W, of C, which is the same extra axis as U, and of `$`, in closed form; more in `linuxcnc.txt`.

use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::ToolReference;

/// Ends of the extra axes.
fn extra_ends(elements: &[PathElement]) -> Vec<[f64; 5]> {
    elements.iter().map(|element| element.extra().unwrap().end).collect()
}

/// Ends of V, mm, rounded to a nanometre.
fn v_ends(elements: &[PathElement]) -> Vec<f64> {
    extra_ends(elements).iter().map(|extra| (extra[3] * 1e6).round() / 1e6).collect()
}

/// U, V and W are the extra axes of their names in mm.
#[test]
fn extra_axes() {
    let found = elements("G0 X1\nG1 U60 F60\nG20 V1\nA3\nM2");
    assert!(found[0].extra().is_none(), "none has been named yet");
    let u = [0.0, 0.0, 60.0, 0.0, 0.0];
    assert_eq!(extra_ends(&found[1..3]), [u, [0.0, 0.0, 60.0, 25.4, 0.0]]);
    assert_eq!(found[1].extra().unwrap().start, [0.0; 5]);
    assert_eq!((found[1].feed, found[1].length()), (0.001, 0.06));
    // 60 degrees a minute, as a thousandth of m/s.
    assert_eq!(found[3].feed, 0.001);
}

/// F is the velocity of U, V and W where X, Y and Z stay; the path counts angles too.
#[test]
fn feed_with_an_angle() {
    let found = elements("G1 U30 A40 F60\nG93 U60 A80 F2\nG94 F60 X5 U0\nM2");
    // 30 mm in 30 s, and half a minute.
    for (element, seconds) in found[..2].iter().zip([30.0, 30.0]) {
        assert_eq!(element.length(), 0.05);
        assert!((element.length() / element.feed - seconds).abs() < 1e-9);
    }
    assert_eq!(found[2].feed, 0.001);
}

/// Threads follow the spindle along X, Y, Z or U, V, W: 100 revolutions a minute of 3 mm.
#[test]
fn thread() {
    for plane in ["G17", "G17.1"] {
        let found = elements(&format!("{plane} M3 S100\nG33 Z-1 U5 K3 $0\nU9 K3\nM2"));
        let [cut, other] = [&found[1], &found[2]];
        assert!((cut.feed - 0.005).abs() < 1e-15 && cut.feed == other.feed, "{plane}");
        assert_eq!(other.extra().unwrap().end[2], 9.0);
    }
}

/// The first of C and U counts, whatever comes later.
#[test]
fn c_or_u() {
    for (first, second) in [('C', 'U'), ('U', 'C')] {
        let decoded =
            decode(&format!("G0 {first}5\nX1 {second}6\nX2 {first}7\nG10 L2 P1 {second}0\nM2"));
        assert_eq!(extra_ends(&decoded.elements).last(), Some(&[0.0, 0.0, 7.0, 0.0, 0.0]));
        let found: Vec<_> =
            decoded.errors.iter().map(|one| (one.place.line, one.columns.clone())).collect();
        assert_eq!(found, [(2, Some(3..5)), (4, Some(10..12))], "{first}");
        assert_eq!(decoded.errors[0].error.rule(), Rule::UnsupportedWord);
    }
    // The one that is not named may not move either.
    let mut options = DecoderOptions::default();
    options.g28.rotary = [0.0, 0.0, 90.0];
    let decoded = decode_with(options.clone(), b"G0 U5\nG28 U0\nG28\nM2");
    let [error] = &decoded.errors[..] else { panic!("{:?}", decoded.errors) };
    assert_eq!(error.place.line, 3);
    let found = elements_with(options, "G28\nG0 C5\nM2");
    assert_eq!(extra_ends(&found[1..]), [90.0, 5.0].map(|c| [0.0, 0.0, c, 0.0, 0.0]));
}

/// The start of the extra axis is one of the axis that the program moves.
#[test]
fn start() {
    let mut options = DecoderOptions::default();
    (options.start.rotary[2], options.start.parallel[1]) = (30.0, 0.002);
    for (axis, feed) in [("C", 60.0), ("U", 60.0)] {
        let program = format!("G4 P1\nG91 G1 {axis}5 F{feed}\nM2");
        let found = elements_with(options.clone(), &program);
        assert_eq!(found.len(), 2, "no jump");
        assert_eq!(extra_ends(&found), [30.0, 35.0].map(|at| [0.0, 0.0, at, 2.0, 0.0]));
        assert_eq!(found[1].feed, 0.001);
    }
}

/// The controlled point moves by the tool offset, and not with G43 itself.
#[test]
fn tool_offset() {
    let program = "G43.1 V3 Z2\nG0 V1\nG53 G0 V1\nG0 Z0\nM2";
    let found = elements(program);
    assert_eq!(v_ends(&found), [4.0, 1.0, 1.0]);
    let tip = DecoderOptions { reference: ToolReference::Tip, ..DecoderOptions::default() };
    let found = elements_with(tip, program);
    assert_eq!(v_ends(&found), [1.0, -2.0, -2.0]);
}
