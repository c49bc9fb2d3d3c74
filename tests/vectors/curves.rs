//! Ellipses, parabolas and splines (manual 3.2, 3.2.5, 3.2.6).

use super::program::{at, element, elements, length, move_type, xy};
use super::vector::{Vector, check};
use nalgebra::Point3;
use twin_path::{Cubic, Ellipse, PathElement, Shape};

fn ellipse(element: &PathElement) -> &Ellipse {
    let Shape::Ellipse(ellipse) = &element.shape else { panic!("no ellipse: {element:?}") };
    ellipse
}

fn cubic(element: &PathElement) -> &Cubic {
    let Shape::Cubic(cubic) = &element.shape else { panic!("no spline: {element:?}") };
    cubic
}

fn mm<const N: usize>(metres: [f64; N]) -> [f64; N] {
    metres.map(|value| value * 1e3)
}

/// The point half way in the curve's own parameter, X and Y in mm, which the path passes.
fn middle(element: &PathElement) -> [f64; 2] {
    let point = match &element.shape {
        Shape::Ellipse(ellipse) => {
            let (sin, cos) = (ellipse.start_angle() + ellipse.sweep() / 2.0).sin_cos();
            let [major, minor] = [ellipse.major(), ellipse.major().normalize() * ellipse.minor()];
            let [x, y] = [major.x * cos - minor.y * sin, major.y * cos + minor.x * sin];
            Point3::new(ellipse.center().x + x, ellipse.center().y + y, 0.0)
        }
        Shape::Cubic(cubic) => {
            let value = |[a, b, c, d]: [f64; 4]| a + b / 2.0 + c / 4.0 + d / 8.0;
            Point3::new(value(cubic.x()), value(cubic.y()), 0.0)
        }
        other => panic!("no curve: {other:?}"),
    };
    let off = |s: f64| (element.at(s).position - point).norm();
    let step = element.length() / 1024.0;
    let nearest = (0..=1024)
        .map(|index| f64::from(index) * step)
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))
        .expect("points");
    let (mut low, mut high) = (nearest - step, nearest + step);
    for _ in 0..100 {
        let third = (high - low) / 3.0;
        if off(low + third) < off(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    assert!(off(low) < 1e-11, "the path passes {} m from {point}", off(low));
    xy(point)
}

/// An ellipse by the words of the vector, centre absolute.
fn by_words(vector: &Vector) -> PathElement {
    let command = if vector.word("cw") == "true" { "G8" } else { "G9" };
    let [i, j, k, r] = ["I_abs", "J_abs", "K", "R"].map(|name| vector.number(name));
    let [[x, y]] = vector.points("end")[..] else { panic!("one end") };
    let block = format!("G98\n{command} X{x} Y{y} I{i} J{j} K{k} R{r} F10");
    element(&vector.numbers("start"), &block)
}

/// Centre, main axis as a vector, both half axes, direction, ratio, angles and length.
fn expect_ellipse(vector: &Vector, element: &PathElement) {
    let found = ellipse(element);
    vector.expect("move_type", move_type(element));
    vector.expect("P1", [found.center().x * 1e3]);
    vector.expect("P2", [found.center().y * 1e3]);
    vector.expect("P3", [found.major().x * 1e3]);
    vector.expect("P4", [found.major().y * 1e3]);
    vector.expect("P5", [found.major().norm() * 1e3]);
    vector.expect("P6", [found.minor() * 1e3]);
    vector.expect("P7", [found.major().y.atan2(found.major().x).to_degrees()]);
    vector.expect("P8", [found.minor() / found.major().norm()]);
    vector.expect("T1", [found.start_angle().to_degrees()]);
    vector.expect("T2", [-found.sweep().to_degrees()]);
    vector.expect("length", length(element));
    vector.expect("mid_param", middle(element));
}

#[test]
pub(crate) fn ellipse_clockwise() {
    check("cnc-ellipse-G8", |vector| expect_ellipse(vector, &by_words(vector)));
}

#[test]
pub(crate) fn ellipse_counter_clockwise() {
    check("cnc-ellipse-G9", |vector| {
        let element = by_words(vector);
        expect_ellipse(vector, &element);
        vector.expect("mid_length", at(&element, 0.5));
    });
}

#[test]
pub(crate) fn parabola() {
    check("cnc-parabola", |vector| {
        let [i, j] = ["I_abs", "J_abs"].map(|name| vector.number(name));
        let [[x, y]] = vector.points("end")[..] else { panic!("one end") };
        let block = format!("G98\nG6 X{x} Y{y} I{i} J{j} F10");
        let element = element(&vector.numbers("start"), &block);
        vector.expect("move_type", move_type(&element));
        vector.expect("P1_4", mm(cubic(&element).x()));
        vector.expect("P5_8", mm(cubic(&element).y()));
        vector.expect("mid", middle(&element));
        vector.expect("length", length(&element));
    });
}

/// Blocks of a spline to each of `points`.
fn spline(points: &[[f64; 2]]) -> String {
    let blocks: Vec<_> = points.iter().map(|[x, y]| format!("G5 X{x} Y{y}")).collect();
    blocks.join("\n")
}

#[test]
pub(crate) fn spline_over_stairs() {
    check("cnc-spline-stairs", |vector| {
        let points = vector.points("points");
        let blocks =
            format!("G0 X{} Y{} F10\n{}", points[0][0], points[0][1], spline(&points[1..]));
        let elements = elements(&[], &blocks);
        assert_eq!(elements.len(), points.len());
        vector.expect("seg1_mid", middle(&elements[1]));
        vector.expect("seg2_P1_4", mm(cubic(&elements[2]).x()));
        vector.expect("seg2_P5_8", mm(cubic(&elements[2]).y()));
        vector.expect("seg2_mid", middle(&elements[2]));
        vector.expect("seg2_length", length(&elements[2]));
        vector.expect("seg4_mid", middle(&elements[4]));
    });
}

#[test]
pub(crate) fn spline_between_lines() {
    check("cnc-spline-between-lines", |vector| {
        let points = vector.points("points");
        let [along, away] = ["start_tangent", "end_tangent"].map(|name| vector.points(name)[0]);
        let ([first, .., last], lead) = (&points[..], 5.0) else { panic!("points") };
        let start = [first[0] - lead * along[0], first[1] - lead * along[1]];
        let end = [last[0] + lead * away[0], last[1] + lead * away[1]];
        let blocks = format!(
            "G1 X{} Y{} F10\n{}\nG1 X{} Y{}",
            first[0],
            first[1],
            spline(&points[1..]),
            end[0],
            end[1]
        );
        let elements = elements(&start, &blocks);
        vector.expect("seg1_mid", middle(&elements[1]));
        vector.expect("seg2_mid", middle(&elements[2]));
        vector.expect("seg1_length", length(&elements[1]));
    });
}
