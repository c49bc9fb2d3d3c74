//! Round trips: paths exported and imported again.

use super::*;
use crate::Place;
use crate::{Arc, Cubic, Ellipse, Plane, ProbeOutcome, Probing};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn element(kind: ElementKind, shape: Shape) -> PathElement {
    PathElement::new(Place::default(), kind, shape)
}

fn drawn(path: &[PathElement]) -> String {
    let mut writer = DxfWriter::new(Vec::new()).unwrap();
    for element in path {
        writer.write(element).unwrap();
    }
    String::from_utf8(writer.finish().unwrap()).unwrap()
}

/// A piece from `start`, by a few numbers: line, arc, ellipse or parabola.
fn piece(start: Point3<f64>, kind: u8, by: [f64; 3]) -> Shape {
    let [a, b, c] = by;
    let step = Vector2::new(a, b);
    let end = |at: Vector2<f64>| Point3::new(at.x, at.y, start.z);
    match kind % 4 {
        0 => Shape::Line { start, end: end(start.coords.xy() + step) },
        1 => {
            let center = start.coords.xy() - step;
            let sweep = c * 50.0;
            let to = center + nalgebra::Rotation2::new(sweep) * step;
            Shape::Arc(Arc::new(start, end(to), end(center), sweep))
        }
        2 => {
            // From the end of the main axis to any place on it.
            let center = start.coords.xy() - step;
            let (minor, sweep) = (step.norm() * 0.4, c * 50.0);
            let side = Vector2::new(-step.y, step.x).normalize() * minor;
            let to = center + step * sweep.cos() + side * sweep.sin();
            let center = Point2::from(center);
            Shape::Ellipse(Box::new(Ellipse::new(start, end(to), center, step, minor, sweep)))
        }
        _ => {
            let control = Point2::new(start.x + c, start.y + a);
            Shape::Cubic(Box::new(Cubic::parabola(start, control, end(start.coords.xy() + step))))
        }
    }
}

fn paths() -> impl Strategy<Value = Vec<PathElement>> {
    let coordinate = || prop_oneof![0.01..0.1, -0.1..-0.01];
    prop::collection::vec((any::<u8>(), [coordinate(), coordinate(), coordinate()]), 1..12)
        .prop_map(|pieces| {
            let mut at = Point3::origin();
            let mut path = Vec::new();
            for (index, (kind, by)) in pieces.into_iter().enumerate() {
                // The first is a line, so that the direction of all is known.
                let shape = piece(at, if index == 0 { 0 } else { kind }, by);
                at = shape.end();
                path.push(element(ElementKind::Cut, shape));
            }
            path
        })
}

proptest! {
    #[test]
    fn drawn_and_imported(path in paths()) {
        let import = imported(&drawn(&path));
        prop_assert_eq!(&import.notes, &[]);
        prop_assert!(import.unit_known && (import.unit - 1e-3).abs() < 1e-18);
        let back = cuts(&import);
        prop_assert_eq!(back.len(), path.len());
        for (element, again) in path.iter().zip(&back) {
            for part in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let [p, q] = [element, again].map(|e| e.at(e.length() * part).position);
                prop_assert!((p - q).norm() < 1e-9, "{element:?} {again:?}");
            }
        }
    }
}

#[test]
fn layers_and_what_leaves_no_trace() {
    let at = |x: f64| Point3::new(x, 0.0, 0.0);
    let line = |from, to| Shape::Line { start: at(from), end: at(to) };
    let probe = ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };
    let path = [
        element(ElementKind::Rapid, line(0.0, 0.1)),
        element(ElementKind::Cut, line(0.1, 0.2)),
        element(ElementKind::MFunction { number: 3 }, line(0.2, 0.2)),
        element(ElementKind::Dwell { time_ns: 1 }, line(0.2, 0.2)),
        element(ElementKind::Jump, line(0.2, 0.5)),
        element(probe, line(0.5, 0.6)),
        element(ElementKind::Cut, line(0.5, 0.5)),
    ];
    let options = ImportOptions { split: Split::Layers, ..ImportOptions::default() };
    let import = import(drawn(&path).as_bytes(), &options).unwrap();
    let names: Vec<_> = import.programs.iter().map(|program| program.name.as_str()).collect();
    assert_eq!((names, cuts(&import).len()), (vec!["RAPID", "CUT", "PROBE"], 3));
}

/// Circles, whole ellipses, upright arcs, and helices.
#[test]
fn other_curves() {
    let at = Point3::<f64>::new;
    let circle = Arc::new(at(1.0, 0.0, 0.2), at(1.0, 0.0, 0.2), at(0.0, 0.0, 0.0), -TAU);
    let upright =
        Arc::in_plane(Plane::Yz, at(0.0, 1.0, 0.0), at(0.0, -1.0, 0.0), Point3::origin(), PI);
    let helix = Arc::new(at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.5), at(0.0, 0.0, 0.0), FRAC_PI_2);
    let tall = Ellipse::new(
        at(1.0, 0.0, 0.0),
        at(0.0, 3.0, 0.0),
        Point2::origin(),
        Vector2::new(1.0, 0.0),
        3.0,
        FRAC_PI_2,
    );
    let import = imported(&drawn(&[element(ElementKind::Cut, Shape::Arc(circle))]));
    assert!((cuts(&import)[0].length() - TAU).abs() < 1e-12);
    let text = drawn(&[element(ElementKind::Cut, Shape::Arc(upright))]);
    assert_eq!(notes(&imported(&text)), [("ELLIPSE", Reason::Tilted, 1)]);
    let import =
        imported(&drawn(&[element(ElementKind::Cut, Shape::Ellipse(Box::new(tall.clone())))]));
    let ends = cuts(&import).into_iter().map(|cut| [cut.start(), cut.end()]).next().unwrap();
    assert!((ends[0] - tall.start()).norm() < 1e-9 && (ends[1] - tall.end()).norm() < 1e-9);
    assert!((cuts(&import)[0].length() - tall.length()).abs() < 1e-9);
    let lines = cuts(&imported(&drawn(&[element(ElementKind::Cut, Shape::Arc(helix.clone()))])));
    assert!(lines.len() > 100);
    let length: f64 = lines.iter().map(PathElement::length).sum();
    assert!((length / helix.length() - 1.0).abs() < 1e-4);
}

#[test]
fn the_same_path_gives_the_same_file() {
    assert_eq!(drawn(&[]), drawn(&[]));
}
