//! Path preparation (manual 3.2, 6.2.3 to 6.2.8).

use super::program::{Fault, at, corners, elements, length, lines, move_type, stream, xy};
use super::vector::{Vector, check};
use twin_path::prepare::{
    CheckVelocities, CheckedElement, CircularLimits, Notice, Notices, Preparation, Rounding,
};
use twin_path::{ElementKind, Marks, PathElement, Shape};

/// The path of `elements` after what `preparation` says, and what the stages noticed.
fn prepared(
    preparation: &Preparation,
    elements: Vec<PathElement>,
) -> (Vec<PathElement>, Vec<Notice>) {
    let notices = Notices::default();
    let path = preparation.apply(stream(elements), &notices);
    let path: Result<Vec<_>, Fault> = path.collect();
    (path.expect("a path"), std::iter::from_fn(|| notices.take()).collect())
}

/// The same with the stages that the program asks for.
fn as_asked(elements: Vec<PathElement>) -> (Vec<PathElement>, Vec<Notice>) {
    let marks = elements.iter().fold(Marks::default(), |all, element| all.with(element.marks));
    prepared(&Preparation::for_marks(marks), elements)
}

fn checked(elements: Vec<PathElement>, angle_tolerance: f64) -> Vec<CheckedElement> {
    let path: Result<Vec<_>, Fault> =
        CheckVelocities::new(stream(elements), angle_tolerance).collect();
    path.expect("limits that can be planned with")
}

#[test]
pub(crate) fn transition() {
    check("cnc-transition", |vector| {
        let (points, feeds) = (vector.points("pts"), vector.numbers("F"));
        let blocks: Vec<_> = points[1..]
            .iter()
            .zip(&feeds)
            .map(|([x, y], feed)| format!("G1 X{x} Y{y} F{feed}"))
            .collect();
        let elements = elements(&points[0], &blocks.join("\n"));
        let kink = elements[0].end_tangent().angle(&elements[1].start_tangent());
        vector.expect("kink_deg", [kink.to_degrees()]);
        let velocity = |tolerance: f64| {
            checked(elements.clone(), tolerance.to_radians())[0].end_velocity * 1e3
        };
        vector.expect("v_transition", vector.numbers("tol").into_iter().map(velocity));
    });
}

/// The corrected contour, without the positionings to it and from it.
fn compensated(vector: &Vector) -> Vec<PathElement> {
    let side = if vector.word("side") == "left" { "G41" } else { "G42" };
    let (points, radius) = (vector.points("pts"), vector.number("radius"));
    let blocks = format!("{side} D{radius}\n{}\nG40", lines(&points));
    let (path, notices) = as_asked(elements(&points[0], &blocks));
    assert_eq!(notices, []);
    let [first, contour @ .., last] = &path[..] else { panic!("{path:?}") };
    assert_eq!((first.kind, last.kind), (ElementKind::Rapid, ElementKind::Rapid));
    contour.to_vec()
}

#[test]
pub(crate) fn inner_corner() {
    check("prep-toolcorr-inner", |vector| {
        let path = compensated(vector);
        assert!(path.iter().all(|element| matches!(element.shape, Shape::Line { .. })));
        vector.expect("offset", corners(&path));
    });
}

#[test]
pub(crate) fn outer_corner() {
    check("prep-toolcorr-outer", |vector| {
        let path = compensated(vector);
        let [before, corner, after] = &path[..] else { panic!("{path:?}") };
        let Shape::Arc(arc) = &corner.shape else { panic!("no arc: {corner:?}") };
        vector.expect("line1", corners(std::slice::from_ref(before)));
        vector.expect("arc/center", xy(arc.center()));
        vector.expect("arc/r", [arc.radius() * 1e3]);
        vector.expect("arc/start", xy(corner.start()));
        vector.expect("arc/end", xy(corner.end()));
        vector.expect("arc/move_type", move_type(corner));
        vector.expect("arc/length", length(corner));
        vector.expect("line2", corners(std::slice::from_ref(after)));
    });
}

#[test]
pub(crate) fn rounded_corner() {
    check("prep-round-60", |vector| {
        let points = vector.points("pts");
        let rounding = Rounding { distance: vector.number("dRadius") * 1e-3, angle_tolerance: 0.0 };
        let preparation = Preparation { rounding: Some(rounding), ..Preparation::default() };
        let blocks = format!("G52\n{}\nG50", lines(&points));
        let (path, notices) = prepared(&preparation, elements(&points[0], &blocks));
        assert_eq!(notices, []);
        let [before, corner, after] = &path[..] else { panic!("{path:?}") };
        let Shape::Arc(arc) = &corner.shape else { panic!("no arc: {corner:?}") };
        vector.expect("cut1", xy(before.end()));
        vector.expect("cut2", xy(after.start()));
        vector.expect("center", xy(arc.center()));
        vector.expect("arc_radius", [arc.radius() * 1e3]);
        vector.expect("length", length(corner));
        vector.expect("move_type", move_type(corner));
    });
}

#[test]
pub(crate) fn smoothed_corner() {
    check("prep-smooth-90", |vector| {
        let (points, distance) = (vector.points("pts"), vector.number("dist"));
        let blocks = format!("G51 D{distance}\n{}\nG50", lines(&points));
        let (path, notices) = as_asked(elements(&points[0], &blocks));
        assert_eq!(notices, []);
        let [before, corner, after] = &path[..] else { panic!("{path:?}") };
        let Shape::Cubic(cubic) = &corner.shape else { panic!("no spline: {corner:?}") };
        vector.expect("cut1", xy(before.end()));
        vector.expect("cut2", xy(after.start()));
        vector.expect("P1_4", cubic.x().map(|value| value * 1e3));
        vector.expect("P5_8", cubic.y().map(|value| value * 1e3));
        // Symmetric: half way in the parameter is half way along.
        vector.expect("mid", at(corner, 0.5));
        vector.expect("length", length(corner));
    });
}

#[test]
pub(crate) fn avoided_loop() {
    check("prep-avoidloop", |vector| {
        let points = vector.points("pts");
        let blocks = format!("G61\n{}\nG60", lines(&points));
        let (path, notices) = as_asked(elements(&points[0], &blocks));
        assert!(matches!(notices[..], [Notice::LoopCut { .. }]), "{notices:?}");
        vector.expect("result", corners(&path));
    });
}

/// A line, a quarter of a circle of radius 50, a quarter of one of radius 25 that turns on or back.
#[test]
pub(crate) fn circular_limits() {
    check("prep-limitcirc", |vector| {
        let [acceleration, acceleration_jump] =
            ["dMaxAcc", "dMaxAccJump"].map(|name| vector.number(name) * 1e-3);
        let circular = Some(CircularLimits { acceleration, acceleration_jump });
        let limited = |last: &str| {
            let blocks = format!("G1 X100 F1000\nG3 X150 Y50 J50\n{last}");
            let (path, _) = prepared(
                &Preparation { circular, ..Preparation::default() },
                elements(&[], &blocks),
            );
            // What the path is planned with, with corners out of the way.
            let path = checked(path, 1e-6);
            assert_eq!(path.len(), 3);
            vector.expect("v_arc", [path[1].feed * 1e3]);
            vector.expect("line_arc", [path[0].end_velocity * 1e3]);
            path[1].end_velocity * 1e3
        };
        vector.expect("same_sense", [limited("G3 X125 Y75 I-25 J0")]);
        vector.expect("opposite", [limited("G2 X175 Y75 I25 J0")]);
    });
}
