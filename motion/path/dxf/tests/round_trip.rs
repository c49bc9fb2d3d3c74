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
        kind @ (1 | 2) => {
            // From the end of the main axis to any place on it.
            let (center, sweep) = (start.coords.xy() - step, c * 50.0);
            let ratio = if kind == 1 { 1.0 } else { 0.4 };
            let side = Vector2::new(-step.y, step.x) * ratio;
            let to = end(center + step * sweep.cos() + side * sweep.sin());
            if kind == 1 {
                return Shape::Arc(Arc::new(start, to, end(center), sweep));
            }
            let (center, minor) = (Point2::from(center), step.norm() * ratio);
            Shape::Ellipse(Box::new(Ellipse::new(start, to, center, step, minor, sweep)))
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
        .prop_map(|mut pieces| {
            // The first is a line, so that the direction of all is known.
            pieces[0].0 = 0;
            let mut at = Point3::origin();
            let cut = |(kind, by)| {
                let shape = piece(at, kind, by);
                at = shape.end();
                element(ElementKind::Cut, shape)
            };
            pieces.into_iter().map(cut).collect()
        })
}

proptest! {
    #[test]
    fn drawn_and_imported(path in paths()) {
        let text = drawn(&path);
        prop_assert_eq!(&drawn(&path), &text);
        let import = imported(&text);
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
    assert_eq!((names, cuts(&import).len()), (vec!["CUT", "PROBE"], 2));
    assert_eq!(notes(&import), [("LINE", Reason::Rapid, 1)]);
}

/// Rapids come back as rapids, each at its place and in its direction; cuts begin where the rapid before them ends. Where
/// sections get another order or height, rapids are made anew.
#[test]
fn rapids_come_back() {
    use ElementKind::{Cut, Rapid};
    let at = |x: f64, z: f64| Point3::new(x, 0.0, z);
    let line = |start, end| Shape::Line { start, end };
    // A half circle, clockwise: drawn counter-clockwise, from its end.
    let half = |from: f64, to: f64| {
        Shape::Arc(Arc::new(at(from, 0.0), at(to, 0.0), at(from.midpoint(to), 0.0), -PI))
    };
    let path = [
        element(Rapid, line(at(0.0, 0.0), at(0.01, 0.0))),
        element(Cut, half(0.01, 0.03)),
        element(Cut, line(at(0.03, 0.0), at(0.01, 0.0))),
        element(Rapid, line(at(0.01, 0.0), at(0.01, 0.02))),
        element(Rapid, line(at(0.01, 0.02), at(0.05, 0.02))),
        element(Rapid, line(at(0.05, 0.02), at(0.05, 0.0))),
        element(Cut, half(0.05, 0.07)),
        // Back, and on from where the first cut began.
        element(Rapid, line(at(0.07, 0.0), at(0.01, 0.0))),
        element(Cut, line(at(0.01, 0.0), at(-0.01, 0.0))),
    ];
    let text = drawn(&path);
    let import_with = |options| {
        let mut import = import(text.as_bytes(), &options).unwrap();
        let kinds: Vec<_> =
            import.programs[0].elements.iter().map(|element| element.kind).collect();
        (import.programs.remove(0), import.notes, kinds)
    };
    let (program, notes, kinds) = import_with(ImportOptions::default());
    assert_eq!((program.sections, notes), (3, vec![]));
    assert_eq!(kinds, path.each_ref().map(|element| element.kind));
    for (again, element) in program.elements.iter().zip(&path) {
        let ends = [again.start() - element.start(), again.end() - element.end()];
        assert!(ends.iter().all(|off| off.norm() < 1e-9), "{element:?} {again:?}");
        assert!((again.length() - element.length()).abs() < 1e-9, "{element:?} {again:?}");
    }
    let nearest = ImportOptions { order: Order::Nearest, ..ImportOptions::default() };
    let (_, notes, kinds) = import_with(nearest);
    let note = Note { kind: "LINE".to_owned(), reason: Reason::Rapid, count: 5 };
    assert_eq!(notes, [note]);
    assert_eq!(kinds.iter().filter(|kind| **kind == Rapid).count(), 2);
}

#[test]
fn other_curves() {
    let at = Point3::<f64>::new;
    let circle = Arc::new(at(1.0, 0.0, 0.2), at(1.0, 0.0, 0.2), at(0.0, 0.0, 0.0), -TAU);
    let upright =
        Arc::in_plane(Plane::Yz, at(0.0, 1.0, 0.0), at(0.0, -1.0, 0.0), Point3::origin(), PI);
    let helix = Arc::new(at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.5), at(0.0, 0.0, 0.0), FRAC_PI_2);
    let (start, end) = (at(1.0, 0.0, 0.0), at(0.0, 3.0, 0.0));
    let tall = Ellipse::new(start, end, Point2::origin(), Vector2::x(), 3.0, FRAC_PI_2);
    let back = |shape| imported(&drawn(&[element(ElementKind::Cut, shape)]));
    assert!((cuts(&back(Shape::Arc(circle)))[0].length() - TAU).abs() < 1e-12);
    assert_eq!(notes(&back(Shape::Arc(upright))), [("ELLIPSE", Reason::Tilted, 1)]);
    let found = &cuts(&back(Shape::Ellipse(Box::new(tall.clone()))))[0];
    assert!((found.start() - start).norm() < 1e-9 && (found.end() - end).norm() < 1e-9);
    assert!((found.length() - tall.length()).abs() < 1e-9);
    let lines = cuts(&back(Shape::Arc(helix.clone())));
    assert!(lines.len() > 100);
    let length: f64 = lines.iter().map(PathElement::length).sum();
    assert!((length / helix.length() - 1.0).abs() < 1e-4);
}
