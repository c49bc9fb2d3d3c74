//! Circles and helices (manual 3.2.4).

use super::program::{at, decoded, element, elements, length, move_type};
use super::vector::{Vector, check};
use twin_gcode::din66025::DecodeError;
use twin_path::{PathElement, Shape};

/// The block of the arc with `words` for its centre or radius.
fn block(vector: &Vector, words: &str) -> String {
    let command = if vector.word("cw") == "true" { "G2" } else { "G3" };
    let letters = ["X", "Y", "Z"].iter().zip(vector.numbers("end"));
    let target: Vec<_> = letters.map(|(letter, value)| format!("{letter}{value}")).collect();
    format!("{command} {} {words} F10", target.join(" "))
}

/// The arc by I and J from its start.
fn relative(vector: &Vector) -> PathElement {
    let [i, j] = ["I_rel", "J_rel"].map(|name| vector.number(name));
    element(&vector.numbers("start"), &block(vector, &format!("I{i} J{j}")))
}

/// The arc by R.
fn by_radius(vector: &Vector) -> PathElement {
    let radius = vector.number("R");
    element(&vector.numbers("start"), &block(vector, &format!("R{radius}")))
}

/// Centre, radius, start angle, angle swept (positive clockwise) and length.
fn expect_arc(vector: &Vector, element: &PathElement) {
    let Shape::Arc(arc) = &element.shape else { panic!("no arc: {element:?}") };
    vector.expect("P1", [arc.center().x * 1e3]);
    vector.expect("P2", [arc.center().y * 1e3]);
    vector.expect("P3", [arc.radius() * 1e3]);
    vector.expect("P3", [arc.end_radius() * 1e3]);
    vector.expect("T1", [arc.start_angle().to_degrees()]);
    vector.expect("T2", [-arc.sweep().to_degrees()]);
    vector.expect("length", length(element));
}

#[test]
pub(crate) fn by_radius_semicircle() {
    check("cnc-arc-R-semicircle", |vector| {
        let element = by_radius(vector);
        vector.expect("move_type", move_type(&element));
        expect_arc(vector, &element);
        vector.expect("mid", at(&element, 0.5));
    });
}

#[test]
pub(crate) fn by_center() {
    check("cnc-arc-IJ-same", |vector| {
        let [i, j] = ["I_abs", "J_abs"].map(|name| vector.number(name));
        let blocks = format!("G98\n{}", block(vector, &format!("I{i} J{j}")));
        for element in [relative(vector), element(&vector.numbers("start"), &blocks)] {
            vector.expect("move_type", move_type(&element));
            expect_arc(vector, &element);
            vector.expect("mid", at(&element, 0.5));
        }
    });
}

#[test]
pub(crate) fn by_radius_minor() {
    check("cnc-arc-R-minor", |vector| {
        let element = by_radius(vector);
        vector.expect("move_type", move_type(&element));
        expect_arc(vector, &element);
        vector.expect("mid", at(&element, 0.5));
    });
}

#[test]
pub(crate) fn full_circle() {
    check("cnc-arc-full", |vector| {
        let element = relative(vector);
        vector.expect("move_type", move_type(&element));
        expect_arc(vector, &element);
        vector.expect("quarter", at(&element, 0.25));
    });
}

/// The warning gives the reason why no arc is made.
#[test]
pub(crate) fn mismatched_center() {
    check("cnc-arc-fallback", |vector| {
        let [i, j] = ["I_rel", "J_rel"].map(|name| vector.number(name));
        let blocks = block(vector, &format!("I{i} J{j}"));
        let (elements, warnings) = decoded(&vector.numbers("start"), &blocks);
        assert!(matches!(warnings[..], [ref warning]
            if matches!(warning.error, DecodeError::CenterMismatch { .. })));
        let [element] = &elements[..] else { panic!("{elements:?}") };
        vector.expect("move_type", move_type(element));
        vector.expect("length", length(element));
    });
}

#[test]
pub(crate) fn helix() {
    check("cnc-helix", |vector| {
        let element = relative(vector);
        expect_arc(vector, &element);
        let middle = element.at(element.length() / 2.0).position * 1e3;
        vector.expect("mid", [middle.x, middle.y, middle.z]);
    });
}

/// The same arc as the second element of a program.
#[test]
pub(crate) fn three_quarters() {
    check("cnc-arc-major", |vector| {
        let start = vector.numbers("start");
        let [i, j] = ["I_rel", "J_rel"].map(|name| vector.number(name));
        let arc = block(vector, &format!("I{i} J{j}"));
        let blocks = format!("G1 X{} Y{} F10\n{arc}", start[0], start[1]);
        for element in [relative(vector), elements(&[], &blocks).remove(1)] {
            vector.expect("move_type", move_type(&element));
            expect_arc(vector, &element);
            vector.expect("mid", at(&element, 0.5));
        }
    });
}
