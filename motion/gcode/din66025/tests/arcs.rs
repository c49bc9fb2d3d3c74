//! Tests of arcs, beyond the worked vectors. Numbers in mm and degrees, to 1e-8.

use super::*;
use std::f64::consts::PI;
use twin_path::Arc;

/// The arc of a program's only element, or of its second after a positioning.
#[track_caller]
fn arc_of(blocks: &str) -> Arc {
    match elements(blocks).pop().unwrap().shape {
        Shape::Arc(arc) => arc,
        other => panic!("{other:?}"),
    }
}

/// Centre, radius, dT1, dT2 (with the manual's sign) and length.
#[track_caller]
fn assert_arc(arc: &Arc, center: [f64; 2], radius: f64, t1: f64, t2: f64, length: f64) {
    let [x, y] = center;
    assert_close(arc.center().x * 1e3, x);
    assert_close(arc.center().y * 1e3, y);
    assert_close(arc.radius() * 1e3, radius);
    assert_close(arc.end_radius() * 1e3, radius);
    assert_close(arc.start_angle().to_degrees(), t1);
    assert_close(-arc.sweep().to_degrees(), t2);
    assert_close(arc.length() * 1e3, length);
}

#[track_caller]
fn assert_passes(arc: &Arc, fraction: f64, point_mm: [f64; 3]) {
    let shape = Shape::Arc(arc.clone());
    let position = shape.at(fraction * shape.length()).position * 1e3;
    assert!((position - Point3::from(point_mm)).norm() < 1e-8, "{position}, expected {point_mm:?}");
}

/// Half the chord is the radius in decimals, but in binary not always: an angle of 180° all the same.
#[test]
fn semicircles_of_rounded_numbers() {
    for (from, to, radius) in
        [("-10.3", "20.1", "15.2"), ("0.1", "0.4", "0.15"), ("7", "7.2", ".1")]
    {
        let arc = arc_of(&format!("G1 X{from} F10\nG3 X{to} R{radius}"));
        assert!((arc.sweep() - PI).abs() < 1e-15, "{}", arc.sweep());
    }
}

/// Manual 3.2.4: the same arc with relative and with absolute centre, and relative by default.
#[test]
fn arc_by_center() {
    for blocks in [
        "N10 G1 X100 Y100 F10\nN15 G99\nN20 G2 X200 Y100 I50 J0",
        "N10 G1 X100 Y100 F10\nN15 G98\nN20 G2 X200 Y100 I150 J100",
        "N10 G1 X100 Y100 F10\nN20 G2 X200 Y100 I50",
    ] {
        let arc = arc_of(blocks);
        assert_arc(&arc, [150.0, 100.0], 50.0, 180.0, 180.0, 157.079_632_679);
        assert_passes(&arc, 0.5, [150.0, 150.0, 0.0]);
    }
}

/// With and without the words of a target that is where the tool is.
#[test]
fn full_circle() {
    for blocks in ["G1 X10 F10\nG2 X10 Y0 I-10 J0", "G1 X10 F10\nG2 I-10"] {
        let arc = arc_of(blocks);
        assert_arc(&arc, [0.0, 0.0], 10.0, 0.0, 360.0, 62.831_853_072);
        assert_passes(&arc, 0.25, [0.0, -10.0, 0.0]);
    }
}

/// Radii 3 and 7 give a straight line, and the warning reports both.
#[test]
fn mismatched_center() {
    let decoded = decode("G2 X10 I3 J0 F10");
    let [Ok(Item::Warning(warning)), Ok(Item::Element(element))] = decoded.as_slice() else {
        panic!("{decoded:?}")
    };
    let DecodeError::CenterMismatch { start_radius_mm, end_radius_mm } = warning.error else {
        panic!("{warning:?}")
    };
    assert_close(start_radius_mm, 3.0);
    assert_close(end_radius_mm, 7.0);
    assert!(matches!(element.shape, Shape::Line { .. }));
    assert_eq!(element.kind, ElementKind::Cut);
    assert_close(element.length() * 1e3, 10.0);
}
