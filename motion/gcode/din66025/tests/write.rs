//! Tests of programs written from paths.

use super::random::programs;
use super::*;
use crate::din66025::{ProgramWriter, WriteError};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use twin_path::Place;
use twin_path::{Arc, Cubic, Details, Ellipse, MParameters, Marks, Plane, ProbeOutcome, Probing};

fn written(elements: &[PathElement]) -> Result<String, WriteError> {
    let mut writer = ProgramWriter::new(Vec::new(), Some("path"))?;
    for element in elements {
        writer.write(element)?;
    }
    Ok(String::from_utf8(writer.finish()?).unwrap())
}

/// The blocks of the program that `blocks` come back as.
fn rewritten(blocks: &str) -> String {
    let text = written(&elements(blocks)).unwrap();
    text.strip_prefix("% path\n").unwrap().to_owned()
}

/// The first difference between two paths, of numbers by more than half a nanometre.
fn difference(a: &[PathElement], b: &[PathElement]) -> Option<String> {
    if a.len() != b.len() {
        return Some(format!("{} and {} elements", a.len(), b.len()));
    }
    let numbers = |e: &PathElement| {
        let places = [0.0, 0.1, 0.3, 0.5, 0.8, 1.0].map(|part| {
            let position = e.at(part * e.shape.length()).position;
            let extra = e.extra_at(part * e.length()).map(|extra| extra.position);
            (position.coords, extra.unwrap_or_default())
        });
        let limits = [e.feed, e.acceleration, e.deceleration, e.tool_radius];
        let places = places.iter().flat_map(|(place, extra)| place.iter().chain(extra));
        places.copied().chain(limits).collect::<Vec<f64>>()
    };
    let words = |e: &PathElement| {
        let parameters = e.details.as_ref().map(|details| details.parameters).unwrap_or_default();
        (e.kind, e.marks, e.switches().to_vec(), parameters, e.extra().is_some())
    };
    a.iter().zip(b).find_map(|(a, b)| {
        let mut pairs = numbers(a).into_iter().zip(numbers(b));
        let differs = words(a) != words(b) || pairs.any(|(a, b)| (a - b).abs() > 0.5e-9);
        differs.then(|| format!("{a:?}\n{b:?}"))
    })
}

/// The program of the manual (3.2), with its G words and blocks, comes back as it is but for its numbering and for
/// words that say nothing new.
#[test]
fn everyday_blocks() {
    let program = "\
        N10 G0 X100 Y100 F100 E100 E-200\n\
        N20 G1 X100 Y200 Z-5\n\
        N30 G2 X200 R50\n\
        N40 G3 X100 I-50 J0\n\
        N50 G6 X0 I-50 J40\n\
        N60 M8 K1.5\n\
        N70 G92 X0 Y0\n\
        N80 G1 X10 D5 H2 O0.25\n";
    let expected = "\
        N10 G0 X100 Y100 F100 E-200\n\
        N20 G1 Y200 Z-5\n\
        N30 G2 X200 I50 J0\n\
        N40 G3 X100 I-50 J0\n\
        N50 G6 X0 I-50 J40\n\
        N60 M8 K1.5\n\
        N70 G92 Y0\n\
        N80 G1 X10 D5 H2 O0.25\n";
    assert_eq!(rewritten(program), expected);
}

#[test]
fn preparation_and_profiles() {
    let program = "\
        N10 G41 D3\n\
        N20 G1 X10 P0 F5 S3 S7\n\
        N30 G61\n\
        N40 G1 X20 P5 Z1 S-3\n\
        N50 G40\n\
        N60 G60\n\
        N70 G52 D4\n\
        N80 G1 X30 S3\n\
        N90 G1 X40\n\
        N100 G50\n";
    let back = rewritten(program);
    assert_eq!(difference(&elements(program), &elements(&back)), None);
    for block in ["G41 D3", "G61", "G40", "G60", "G52 D4", "G50", "S-3"] {
        assert!(back.contains(block), "{block} in {back}");
    }
}

#[test]
fn splines_come_back_as_splines() {
    // Vector `cnc-spline-stairs`, between a line and an arc.
    let program = "\
        N10 G1 X-10 F100\nN20 G1 X0\n\
        N30 G5 X20 Y0\nN40 G5 X20 Y20\nN50 G5 X40 Y20\nN60 G5 X40 Y40\n\
        N70 G2 X60 Y60 I20 J0\nN80 G5 X70\nN90 M3\nN100 G5 X80 Y70\n";
    let back = rewritten(program);
    // Straight pieces next to an arc and an M function are parabolas as well.
    assert_eq!((back.matches("G5").count(), back.matches("G6").count()), (4, 2), "{back}");
    assert_eq!(difference(&elements(program), &elements(&back)), None);
}

#[test]
fn a_start_elsewhere_is_set_first() {
    let path = elements_of(&decode_from([10.0, 20.0, 0.0], b"%\nG1 X11 F1"));
    assert_eq!(written(&path).unwrap(), "% path\nN10 G92 X10 Y20\nN20 G1 X11 F1\n");
}

#[test]
fn names_have_one_line() {
    let empty = |name| {
        let program = ProgramWriter::new(Vec::new(), name).unwrap().finish().unwrap();
        String::from_utf8(program).unwrap()
    };
    assert_eq!(empty(None), "%\n");
    assert_eq!(empty(Some("a\nG0 X1\r\u{7}")), "% aG0 X1\n");
}

fn cut(shape: Shape) -> PathElement {
    PathElement {
        feed: 0.1,
        acceleration: 0.1,
        deceleration: 0.1,
        ..PathElement::new(Place::at(7), ElementKind::Cut, shape)
    }
}

/// Everything the language has no words for.
#[test]
fn what_cannot_be_said() {
    let at = |x: f64, y: f64, z: f64| Point3::new(x, y, z) / 1e3;
    let origin = Point3::origin();
    let line = || Shape::Line { start: origin, end: at(1.0, 0.0, 0.0) };
    let upright = Arc::in_plane(Plane::Zx, origin, at(2.0, 0.0, 0.0), at(1.0, 0.0, 0.0), PI);
    let twice = Arc::new(origin, origin, at(1.0, 0.0, 0.0), 2.0 * TAU);
    let cubic = Cubic::new([0.0, 1e-3, 5e-3, -1e-3], [0.0, 2e-3, -9e-3, 4e-3], 0.0, 0.0);
    let long = Ellipse::new(
        origin,
        at(2.0, 3.0, 0.0),
        Point2::new(1e-3, 1e-3),
        Vector2::new(5e-3, 0.0),
        1e-3,
        PI,
    );
    let details = |details| Some(Box::new(details));
    let parameters = MParameters { o: Some([0.0; 8]), ..MParameters::default() };
    let motionless = Shape::Line { start: origin, end: origin };
    let m3 = ElementKind::MFunction { number: 3 };
    let probe = ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };
    let (none, left) = (Marks::default(), Marks::CORRECTION_LEFT);
    let both = Marks::SMOOTHING.with(Marks::ROUNDING);
    let marked = |kind, marks, shape| PathElement { kind, marks, ..cut(shape) };
    let with_parameters = details(Details { parameters, ..Details::default() });
    for (element, expected) in [
        (PathElement { kind: probe, ..cut(line()) }, "no probing (G38.2 of RS274)"),
        (cut(Shape::Arc(upright)), "arcs in X and Y only"),
        (cut(Shape::Arc(twice)), "this curve to within 1 nm"),
        (cut(Shape::Ellipse(Box::new(long))), "this curve to within 1 nm"),
        (cut(Shape::Cubic(Box::new(cubic.clone()))), "neither a parabola nor a spline piece"),
        (marked(ElementKind::Rapid, none, Shape::Cubic(Box::new(cubic))), "a rapid along a curve"),
        (marked(ElementKind::Dwell { time_ns: 1 }, none, motionless.clone()), "has no dwell"),
        (PathElement { feed: 0.0, ..cut(line()) }, "F cannot be 0"),
        (PathElement { feed: f64::INFINITY, ..cut(line()) }, "F cannot be inf"),
        (PathElement { acceleration: 0.0, ..cut(line()) }, "E cannot be 0"),
        (cut(Shape::Line { start: origin, end: at(2e6, 0.0, 0.0) }), "X cannot be 2000000"),
        (marked(ElementKind::Cut, both, line()), "cannot begin with these marks"),
        (marked(m3, Marks::LOOPS, motionless.clone()), "cannot begin with these marks"),
        (
            PathElement { kind: m3, details: with_parameters, ..cut(motionless) },
            "M3 takes its parameters O",
        ),
        (
            PathElement { tool_radius: -1.0, ..marked(ElementKind::Cut, left, line()) },
            "D cannot be -1000",
        ),
    ] {
        let error = written(std::slice::from_ref(&element)).unwrap_err().to_string();
        assert!(error.contains(expected), "{element:?}: {error}");
        assert!(error.starts_with("line 7"), "{error}");
    }
    let gap = [cut(line()), cut(Shape::Line { start: at(1.5, 0.0, 0.0), end: origin })];
    assert!(
        matches!(written(&gap), Err(WriteError::Gap { gap_mm, .. }) if (gap_mm - 0.5).abs() < 1e-9)
    );
}

proptest! {
    /// Reading what was written from what was read gives the same.
    #[test]
    fn read_written_read(lines in programs()) {
        let path = remaining(&decode_from([0.0; 3], lines.join("\n").as_bytes()));
        let program = match written(&path) {
            // Ellipses whose axes hang on the last digits of their ends.
            Err(WriteError::Curve(place)) => {
                let bad = path.iter().find(|element| element.place == place).unwrap();
                prop_assert!(matches!(bad.shape, Shape::Ellipse(_)), "{bad:?}");
                return Ok(());
            }
            other => other.unwrap(),
        };
        let back = decode_from([0.0; 3], program.as_bytes());
        prop_assert!(diagnostics(&back).is_empty(), "{:?}\n{program}", diagnostics(&back));
        let back = remaining(&back);
        prop_assert_eq!(difference(&path, &back), None, "\n{}", program);
    }
}
