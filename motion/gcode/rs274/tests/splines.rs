//! Splines: points of LinuxCNC's preview lie on the curves, and the closed forms.
//!
//! `splines.txt` is like `linuxcnc.txt`. LinuxCNC's preview divides a curve into lines, 15 for each control point, whose
//! ends are on it; every third of them is in the file, and the last.

use super::linuxcnc::cases;
use super::moves::{Move, as_move, decode_as_linuxcnc};
use super::*;
use crate::rs274::{MAX_CONTROL_POINTS, SPLINE_TOLERANCE};
use nalgebra::{Point2, Point3};
use twin_path::{Cubic, Shape};

fn cubics(elements: &[PathElement]) -> Vec<&Cubic> {
    let cubic = |element| match element {
        &PathElement { shape: Shape::Cubic(ref cubic), .. } => &**cubic,
        other => panic!("{other:?}"),
    };
    elements.iter().map(cubic).collect()
}

/// Distance of `point` from the curve of `elements`, m.
fn distance(elements: &[PathElement], point: Point3<f64>) -> f64 {
    let of = |element: &PathElement, s: f64| (element.at(s).position - point).norm();
    let nearest = |element: &PathElement| {
        let step = element.length() / 100.0;
        let at = (0..=100).map(|n| f64::from(n) * step);
        let near = at.min_by(|a, b| of(element, *a).total_cmp(&of(element, *b))).unwrap();
        let (mut low, mut high) = (near - step, near + step);
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            if of(element, low + third) < of(element, high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        of(element, low.midpoint(high).clamp(0.0, element.length()))
    };
    elements.iter().map(nearest).min_by(f64::total_cmp).unwrap()
}

/// Distance of `point` from the lines between `start` and `ends`, m.
fn distance_from_lines(start: Point3<f64>, ends: &[Point3<f64>], point: Point3<f64>) -> f64 {
    let lines = std::iter::once(&start).chain(ends).zip(ends);
    let distances = lines.map(|(from, to)| {
        let (chord, away) = (to - from, point - from);
        let part = (away.dot(&chord) / chord.norm_squared().max(1e-30)).clamp(0.0, 1.0);
        (away - chord * part).norm()
    });
    distances.min_by(f64::total_cmp).unwrap()
}

/// Asserts that the curve of a block is LinuxCNC's.
#[track_caller]
fn assert_same_curve(name: &str, elements: &[PathElement], expected: &[Move]) {
    let points: Vec<_> = expected
        .iter()
        .map(|one| Point3::new(one.points[0], one.points[1], one.points[2]) / 1e3)
        .collect();
    for (point, expected) in points.iter().zip(expected) {
        let distance = distance(elements, *point);
        assert!(distance < 2e-9, "{name}: {expected:?} is {distance:e} m away");
        let feed = elements[0].feed * 6e4;
        assert!((feed - expected.feed.unwrap()).abs() < 1e-4, "{name}: {feed}, {expected:?}");
    }
    let length: f64 = elements.iter().map(PathElement::length).sum();
    for element in elements {
        assert_eq!(element.feed, elements[0].feed, "{name}");
        let middle = element.at(element.length() / 2.0).position;
        let away = distance_from_lines(elements[0].start(), &points, middle);
        assert!(away <= 0.05 * length, "{name}: {away} m from LinuxCNC's lines");
    }
    let (end, last) = (elements.last().unwrap().end(), points.last().unwrap());
    assert!((end - last).norm() < 1e-9, "{name}: {end}, LinuxCNC {last}");
}

#[test]
fn curves_are_those_of_linuxcnc() {
    let mut curves = 0;
    for case in cases(include_str!("splines.txt")) {
        let (name, decoded) = (&case.name, decode_as_linuxcnc(case.program.as_bytes()));
        assert_eq!(decoded.errors.is_empty(), case.error.is_none(), "{name}: {:?}", decoded.errors);
        let moving =
            |element: &&PathElement| !matches!(element.kind, ElementKind::MFunction { .. });
        let elements: Vec<_> = decoded.elements.iter().filter(moving).cloned().collect();
        let ours = elements.chunk_by(|a, b| {
            a.place.line == b.place.line
                && matches!((&a.shape, &b.shape), (Shape::Cubic(_), Shape::Cubic(_)))
        });
        let mut rest = &case.moves[..];
        for elements in ours {
            let curve = matches!(elements[0].shape, Shape::Cubic(_));
            let line = elements[0].place.line;
            let count = rest.iter().take_while(|one| one.line == line).count();
            let (expected, behind) = rest.split_at(if curve { count } else { 1 });
            if curve {
                assert_same_curve(name, elements, expected);
                curves += 1;
            } else {
                assert_eq!(as_move(&elements[0]).unwrap().difference(&expected[0]), None, "{name}");
            }
            rest = behind;
        }
        assert_eq!(rest, [], "{name}");
    }
    // As many as the programs have.
    assert_eq!(curves, 47);
}

#[test]
fn pieces_join_and_have_the_directions_of_the_curve() {
    for case in cases(include_str!("splines.txt")) {
        let decoded = decode_as_linuxcnc(case.program.as_bytes());
        for pair in decoded.elements.windows(2) {
            assert_eq!(pair[0].end(), pair[1].start(), "{}", case.name);
            let smooth = pair.iter().all(|element| matches!(element.shape, Shape::Cubic(_)))
                && pair[0].place == pair[1].place;
            let turn = (pair[0].shape.end_tangent() - pair[1].shape.start_tangent()).norm();
            assert!(!smooth || turn < 1e-6, "{}: {turn}", case.name);
        }
    }
}

#[test]
fn cubic_and_parabola_are_exact() {
    let elements = elements("F60 G5 X4 Y3 I1 J2 P-1 Q1\nG17 G5.1 X8 I2 J-8\nM2");
    let [cubic, parabola] = cubics(&elements)[..] else { panic!("{elements:?}") };
    // Bézier points (0, 0), (1, 2), (3, 4), (4, 3) mm.
    let expected = [[0.0, 3e-3, 3e-3, -2e-3], [0.0, 6e-3, 0.0, -3e-3]];
    for (found, expected) in [cubic.x(), cubic.y()].into_iter().zip(expected) {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-17, "{:?} {:?}", cubic.x(), cubic.y());
        }
    }
    let control = Point2::new(6e-3, -5e-3);
    let expected = Cubic::parabola(Point3::new(4e-3, 3e-3, 0.0), control, parabola.end());
    assert_eq!(parabola.end(), Point3::new(8e-3, 3e-3, 0.0));
    for s in (0..=100).map(|n| f64::from(n) / 100.0 * parabola.length()) {
        let place = |cubic: &Cubic| Shape::Cubic(Box::new(cubic.clone())).at(s).position;
        assert!((place(parabola) - place(&expected)).norm() < 1e-15);
    }
}

/// Weights 1, √½ and 1 on the corners of a square make a quarter of a circle.
#[test]
fn circles_are_round() {
    let weight = 0.5_f64.sqrt();
    let program = format!("F60 G0 X100\nG5.2 X100 Y100 P{weight:.17}\nX0 Y100 P1\nG5.3\nM2");
    let elements = elements(&program);
    let elements = &elements[1..];
    for element in elements {
        for n in 0..=20 {
            let point = element.at(element.length() * f64::from(n) / 20.0);
            let off = (point.position.coords.norm() - 0.1).abs();
            assert!(off < SPLINE_TOLERANCE, "{off:e}");
            assert!((point.curvature.norm() - 10.0).abs() < 0.02, "{}", point.curvature.norm());
        }
    }
    let length: f64 = elements.iter().map(PathElement::length).sum();
    assert!((length - 0.1 * std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    assert!(elements.len() < 80, "{}", elements.len());
}

#[test]
fn weights_may_differ_by_twelve_orders() {
    let program = "F60 G5.2 P1000000\nX100 Y100 P0.000001\nX200 Y0 P1000000\nX300 Y0 P0.000001\nX300 Y100 P1\nG5.3\nM2";
    let elements = elements(program);
    assert!(elements.len() < 2000, "{}", elements.len());
    let length: f64 = elements.iter().map(PathElement::length).sum();
    assert!((0.2..1.0).contains(&length), "{length}");
    assert_eq!(elements.last().unwrap().end(), Point3::new(0.3, 0.1, 0.0));
}

#[test]
fn inverse_time_is_that_of_the_curve() {
    for program in [
        "G93\nG5 X100 Y10 I20 J30 P-10 Q50 F2\nM2",
        "G93\nG5.1 X100 Y10 I20 J30 F2\nM2",
        "G93\nG5.2 X100 Y10 P2\nX50 Y50 P1\nX0 Y70 P3\nG5.3 F2\nM2",
    ] {
        let elements = elements(program);
        let seconds: f64 = elements.iter().map(|one| one.length() / one.feed).sum();
        assert!((seconds - 30.0).abs() < 1e-6, "{program}: {seconds}");
    }
}

/// Offsets and units move the points that are written behind them, and not those that are there.
#[test]
fn control_points_stay_where_they_are() {
    let end = |program: &str| ends_mm(&elements(program)).pop().unwrap();
    assert_eq!(end("F60 G5.2 X1 Y1 P1\nG92 X5\nX6 Y1 P1\nG5.3\nG1 X7\nM2"), [2.0, 1.0, 0.0]);
    assert_eq!(end("F60 G5.2 X1 Y1 P1\nG20 X1 Y1 P1\nG5.3\nM2"), [25.4, 25.4, 0.0]);
    let found = elements("F60 G5.2 X1 Y1 P1\nG20 X1 Y1 P1\nG5.3\nM2");
    assert_eq!(cubics(&found).len(), 1);
}

#[test]
fn errors_of_curves() {
    let many = "X1 Y1 P1\n".repeat(MAX_CONTROL_POINTS);
    for (program, line, message) in [
        ("G5.2 P1\nG5.2 P2\nM2", 2, "P without X and Y is the weight"),
        ("G5.2 X1 Y1 P1\nX1\nM2", 2, "G5.2 needs both X and Y"),
        ("G5.2 X1 Y1 P1\nX1 Y2\nM2", 2, "each control point of G5.2 needs"),
        ("G5.2 X1 Y1 P1\nX2 Y2 P1 Z1\nM2", 2, "Z has no effect in this block"),
        ("G5.2 X1 Y1 P1\nX2 Y2 P1 A1\nM2", 2, "A has no effect in this block"),
        ("G5.2 X1 Y1 P1\nX2 Y2 P1\nG5.3 X1\nM2", 3, "X has no effect in this block"),
        ("G5.2 X1 Y1 P1\nG5.3\nM2", 2, "a curve of order 3 (L) needs at least 3 control points"),
        ("G5.2 X1 Y1 P1\nX2 Y1 P1\nM2", 3, "the curve of G5.2 must end with G5.3"),
        ("G5.2 X1 Y1 P1\nX2 Y1 P1\nG1 X2\nM2", 3, "the curve of G5.2 must end with G5.3"),
        ("G5.2 X1 Y1 P1\nG5 X2 I1 J1 P1 Q1\nM2", 2, "the curve of G5.2 must end with G5.3"),
        ("G0 X5\nG5.2 X1 Y1 P1\nX2 Y1 P1\nG28\nG5.3\nM2", 5, "the tool has left the start"),
        (&format!("G5.2 P1\n{many}G5.3\nM2"), 1001, "a curve of G5.2 has at most 1000"),
        ("G5.2 X2000000 Y1 P1\nM2", 1, "X is 2000 m, outside -1000 m to 1000 m"),
        ("G5 X1 I2000000 J0 P0 Q0\nM2", 1, "X is 2000 m, outside -1000 m to 1000 m"),
    ] {
        let errors = decode(&format!("F60\n{program}")).errors;
        let first = &errors[0];
        assert_eq!(first.place.line, line + 1, "{program}: {first}");
        assert!(first.error.to_string().starts_with(message), "{program}: {first}");
    }
}
