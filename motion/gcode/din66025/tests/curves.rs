//! Tests of splines, parabolas and ellipses. Numbers in mm and degrees, to 1e-8.

use super::*;
use crate::decode::{Rule, TextError};
use twin_path::{Cubic, Ellipse, EllipseError};

#[track_caller]
fn cubic(element: &PathElement) -> &Cubic {
    let Shape::Cubic(cubic) = &element.shape else { panic!("{element:?}") };
    cubic
}

#[track_caller]
fn ellipse(element: &PathElement) -> &Ellipse {
    let Shape::Ellipse(ellipse) = &element.shape else { panic!("{element:?}") };
    ellipse
}

/// Coefficients in mm.
#[track_caller]
fn assert_coefficients(found: [f64; 4], expected: [f64; 4]) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert_close(found * 1e3, expected);
    }
}

/// Without a kink at the joints with its neighbours and between its parts.
#[test]
fn spline_between_lines() {
    let elements = elements("G1 X5 Y0 F10\nG5 X20 Y0\nG5 X20 Y20\nG1 X20 Y30");
    for pair in elements.windows(2) {
        assert!((pair[0].end_tangent() - pair[1].start_tangent()).norm() < 1e-9);
    }
}

/// At an M function, a jump, or the same point again a spline ends, and the next begins, along its chord.
#[test]
fn what_ends_a_spline() {
    for between in ["M5", "G92 X20 Y0\nG5", "G5 X20 Y0"] {
        let elements = elements(&format!("G5 X20 Y0 F10\n{between}\nG5 X20 Y20"));
        let (first, last) = (&elements[0], elements.last().unwrap());
        assert_coefficients(cubic(first).y(), [0.0; 4]);
        assert_coefficients(cubic(last).x(), [20.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn curves_that_cannot_be() {
    for (block, error) in [
        ("N10 G8 X20 Y0 I10 F10", DecodeError::NoEllipse(EllipseError::RatioNeeded)),
        ("N10 G8 X20 Y5 I-30 R0.5 F10", DecodeError::NoEllipse(EllipseError::NoEllipse)),
    ] {
        let decoded = decode(block);
        let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
        assert_eq!((&diagnostic.error, diagnostic.error.rule()), (&error, Rule::ArcGeometry));
        assert!(matches!(remaining(&decoded)[0].shape, Shape::Line { .. }));
    }
    for (block, number) in [("G6 X10 F1", 6), ("G8 X10 F1", 8), ("G9 X10 R0.5 F1", 9)] {
        let decoded = decode(block);
        let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
        assert_eq!(diagnostic.error, DecodeError::CurveWithoutPoint(number));
        assert!(remaining(&decoded).is_empty());
    }
}

/// Tangents in one line: the parabola is that line, or runs beyond its ends and back, which nobody means.
#[test]
fn straight_parabolas() {
    let between = &elements("G6 X100 I30 J0 F10")[0];
    assert!(matches!(between.shape, Shape::Line { .. }));
    for block in ["G6 X100 I150 J0 F10", "G6 X100 I-1 J0 F10", "G6 X0 I10 J10 F10"] {
        let decoded = decode(block);
        let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
        assert_eq!(diagnostic.error, DecodeError::StraightParabola);
        assert!(matches!(remaining(&decoded)[0].shape, Shape::Line { .. }));
    }
}

/// R is not needed here, and wrong.
#[test]
fn a_ratio_that_start_and_end_contradict() {
    let decoded = decode("G92 X20 F10\nG98\nG9 X0 Y10 I0 J0 K0 R0.4");
    let DecodeError::OtherRatio { given, ratio } = diagnostics(&decoded)[0].error else {
        panic!("{decoded:?}")
    };
    assert_close(given, 0.4);
    assert_close(ratio, 0.5);
    assert_close(ellipse(&remaining(&decoded)[0]).minor() * 1e3, 10.0);
}
