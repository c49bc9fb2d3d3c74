//! Tests of contours that are too narrow for the tool.

use super::{LEFT, RIGHT, contour, correct, correct_with, gouges};
use crate::Place;
use crate::prepare::tests::{
    Error, assert_path, cut, element, length, numbered, path, stairs, switched, switches, through,
    with_many, words,
};
use crate::prepare::{AvoidLoops, Notice, Notices, ToolRadius, ToolRadiusOptions};
use crate::{Cubic, ElementKind, Ellipse, Marks, PathElement, Shape};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::TAU;

fn with_notices(elements: Vec<PathElement>) -> (Vec<PathElement>, Vec<Notice>) {
    let (path, notices) = correct(elements);
    (without_ramps(&path), notices)
}

fn without_ramps(path: &[PathElement]) -> Vec<PathElement> {
    path[1..path.len() - 1].to_vec()
}

/// What is left of either corner below.
const OFFSET: &str = "0,10 90,10 90,100";

/// Lines 1 and 3 with a fillet of 5 mm in the corner between them.
const FILLETED: &str = "0,0 95,0 o95,5:90 100,100";

/// The tool touches both lines and leaves the fillet to a smaller one: a notice, but not a gouge.
#[test]
fn an_arc_smaller_than_the_tool_vanishes() {
    let (path, notices) = with_notices(contour(path(FILLETED), LEFT, 10.0));
    assert_path(&path, OFFSET);
    let [Notice::TooNarrow { place, radius: Some(radius), tool_radius }] = notices[..] else {
        panic!("{notices:?}");
    };
    assert_eq!(place.line, 2);
    assert!((radius - 0.005).abs() < 1e-12 && (tool_radius - 0.01).abs() < 1e-12);
    let said =
        "line 2: an arc of radius 5.000000 mm is too narrow for a tool of radius 10.000000 mm";
    assert_eq!(notices[0].to_string(), said);
    // On the outside it becomes larger.
    let (path, notices) = with_notices(contour(self::path(FILLETED), RIGHT, 10.0));
    assert_eq!((path.len(), notices.len()), (3, 0));
}

/// A chamfer of 7.07 mm: each of its corners takes 10·tan(22.5°) = 4.14 mm of it.
const CHAMFERED: &str = "0,0 95,0 100,5 100,100";

#[test]
fn an_element_between_inner_corners_reverses() {
    let (path, notices) = with_notices(contour(path(CHAMFERED), LEFT, 10.0));
    assert_path(&path, OFFSET);
    let place = Place::at(2);
    assert_eq!(notices, [Notice::TooNarrow { place, radius: None, tool_radius: 0.01 }]);
    assert_eq!(notices[0].rule(), "compensation-gouge");
    // A smaller tool fits.
    let (path, notices) = with_notices(contour(self::path(CHAMFERED), LEFT, 8.0));
    assert_eq!((path.len(), notices.len()), (3, 0));
}

#[test]
fn the_path_is_found_again_behind_several_elements() {
    let points = words((0..=6).map(|step| {
        let (sin, cos) = (f64::from(step) * 15_f64.to_radians()).sin_cos();
        [97.0 + 3.0 * sin, 3.0 - 3.0 * cos]
    }));
    let elements = path(&format!("0,0 {points} 100,100"));
    let (path, notices) = with_notices(contour(elements, LEFT, 10.0));
    assert_path(&path, OFFSET);
    let lines: Vec<_> = notices.iter().map(|notice| notice.place().line).collect();
    assert_eq!(lines, [2, 3, 4, 5, 6, 7]);
}

/// What the dropped element carried is done where it would have been.
#[test]
fn nothing_but_the_path_is_dropped() {
    let mut elements = path("D10 0,0 G41 95,0 m G61 100,5 m 100,100 G40");
    elements[2] = switched(elements[2].clone(), &[(7, 0.5)]);
    let (path, _) = with_notices(elements);
    assert_path(&path, "0,10 90,10 m90,10 m90,10 90,100");
    assert_eq!((path[3].marks, switches(&path[3])), (Marks::LOOPS, vec![(7, 0.0)]));
}

/// Down a slot of 10 mm with a tool of 20 mm: it cannot but cut into the other wall.
#[test]
fn a_slot_narrower_than_the_tool_is_gouged() {
    let slot = path("0,100 0,0 10,0 10,100");
    let (path, notices) = with_notices(contour(slot, LEFT, 10.0));
    assert!(path.len() >= 3);
    // At the offset from one wall the centre is inside the other.
    for lines in [[1, 3], [3, 1]] {
        let gouge = gouges(&notices).into_iter().find(|(found, _)| *found == lines);
        assert!(gouge.is_some_and(|(_, depth)| (depth - 0.01).abs() < 1e-12), "{notices:?}");
    }
    let text = notices.iter().map(ToString::to_string).find(|text| text.contains("line 3"));
    assert!(text.is_some_and(|text| text.ends_with("mm into the contour of line 3")));
}

/// A contour that closes at an inner corner, whose first and last element do not know of each other.
#[test]
fn inner_corner_where_a_contour_closes() {
    // Long enough to leave the window.
    let side = words((0..200).map(|step| [100.0 - f64::from(step) * 0.5, 100.0]));
    let square = path(&format!("0,0 100,0 {side} 0,100 0,0"));
    let last = u32::try_from(square.len()).unwrap();
    let (_, notices) = with_notices(contour(square, LEFT, 10.0));
    let pairs: Vec<_> = gouges(&notices).into_iter().map(|(lines, _)| lines).collect();
    assert!(pairs.contains(&[1, last]) && pairs.contains(&[last, 1]), "{pairs:?}");
}

#[test]
fn a_hole_smaller_than_the_tool() {
    let (_, notices) = with_notices(path("D10 5,0 G41 o0,0:360 G40"));
    assert!(notices.iter().any(|notice| matches!(notice, Notice::TooNarrow { .. })));
    assert!(!gouges(&notices).is_empty());
}

/// Without look-ahead the offset crosses itself, as in the manual; loop avoidance after it finds the same path.
#[test]
fn loop_avoidance_does_it_too() {
    for elements in [FILLETED, CHAMFERED] {
        let mut elements = contour(path(elements), LEFT, 10.0);
        elements[0].marks = elements[0].marks.with(Marks::LOOPS);
        elements[2].marks = elements[2].marks.with(Marks::LOOPS_END);
        let options = ToolRadiusOptions { look_ahead: 0, ..ToolRadiusOptions::default() };
        let (path, notices) = through(elements, |items, notices| {
            AvoidLoops::new(ToolRadius::new(items, options, notices.clone()), notices)
        });
        assert_path(&without_ramps(&path), OFFSET);
        let cut = |notice: &Notice| matches!(notice, Notice::LoopCut { .. });
        assert!(notices.iter().any(cut), "{notices:?}");
    }
}

/// Ellipses and splines: the tool stays its radius away from them, to the tolerance; their offset has no kinks.
#[test]
fn curves_are_offset_to_the_tolerance() {
    let start = Point3::new(0.08, 0.0, 0.0);
    let ellipse = Ellipse::new(start, start, Point2::origin(), Vector2::new(0.08, 0.0), 0.05, TAU);
    let (end, direction) = (Point3::new(0.2, 0.05, 0.03), Vector2::new(0.2, 0.1));
    let bend = Cubic::hermite(Point3::origin(), end, direction, direction);
    for shape in [Shape::Ellipse(Box::new(ellipse)), Shape::Cubic(Box::new(bend))] {
        for (side, tolerance) in [(LEFT, 1e-6), (RIGHT, 1e-6), (LEFT, 1e-4)] {
            let curve = switched(element(ElementKind::Cut, shape.clone(), 0.05), &[(7, 0.5)]);
            let options = ToolRadiusOptions { tolerance, ..ToolRadiusOptions::default() };
            let (path, notices) = correct_with(contour(vec![curve], side, 5.0), options);
            assert_eq!(notices, []);
            let path = without_ramps(&path);
            let point = |n: i32| shape.at(shape.length() * f64::from(n) / 4000.0).position.xy();
            let points: Vec<_> = (0..=4000).map(point).collect();
            for element in &path {
                for part in [0.0, 0.3, 0.7] {
                    let at = element.at(part * element.length()).position.xy();
                    let away = points.iter().map(|p| (p - at).norm()).fold(f64::INFINITY, f64::min);
                    assert!((away - 0.005).abs() < tolerance + 1e-6, "{away}");
                }
            }
            for pair in path.windows(2) {
                let turn = pair[0].end_tangent().xy().normalize()
                    - pair[1].start_tangent().xy().normalize();
                assert!(turn.norm() < 1e-7);
            }
            let heights = (path[0].start().z, path[path.len() - 1].end().z);
            assert_eq!(heights, (shape.start().z, shape.end().z));
            let switches: Vec<_> = path.iter().flat_map(PathElement::switches).collect();
            assert_eq!(switches.len(), 1);
        }
    }
}

#[test]
fn the_window_is_bounded() {
    let pulled = std::cell::Cell::new(0);
    let stairs = contour(stairs(5000), LEFT, 10.0).into_iter().map(Ok::<_, Error>);
    let stairs = stairs.inspect(|_| pulled.set(pulled.get() + 1));
    let options = ToolRadiusOptions::default();
    let mut path = ToolRadius::new(stairs, options, Notices::default());
    while let Some(Ok(element)) = path.next() {
        assert!(pulled.get() <= element.place.line + 130, "{} at {}", pulled.get(), element.place);
    }
    assert_eq!(pulled.get(), 5000);
    let many = with_many(contour(self::path(super::CORNER), LEFT, 10.0), 10_000);
    let (path, _) = correct_with(many, options);
    assert_eq!(path.iter().filter(|element| !element.kind.is_motion()).count(), 10_000);
}

/// A semicircle of exactly the tool's radius shrinks to a point.
#[test]
fn an_arc_of_the_tools_radius() {
    let (path, _) = with_notices(path("D10 0,0 G41 100,0 o100,10:180 0,20 G40"));
    assert!((length(&path) - 0.2).abs() < 1e-9, "{path:?}");
}

/// A circle in segments of 0.1 mm, its numbers in micrometres: corners of both kinds, none of which is one.
#[test]
fn fine_segments() {
    let rounded = |x: f64| (x * 1e6).round() * 1e-6;
    let at = |step: u32| {
        let angle = f64::from(step) * 0.005;
        [rounded(0.02 * angle.cos()), rounded(0.02 * angle.sin()), 0.0]
    };
    for (side, radius) in [(LEFT, 0.015), (RIGHT, 0.025)] {
        let path = numbered((0..1200).map(|step| cut(at(step), at(step + 1), 0.05)).collect());
        let (after, notices) = with_notices(contour(path, side, 5.0));
        assert_eq!(notices, []);
        for element in after {
            let found = element.at(element.length() / 2.0).position.coords.norm();
            assert!((found - radius).abs() < 1e-6, "{found} on {element:?}");
        }
    }
}
