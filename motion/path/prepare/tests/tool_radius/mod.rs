//! Tests of tool radius correction, [`ToolRadius`].

mod marks;
mod narrow;
mod random;

use super::{assert_path, close, cut, element, length, marked, numbered, path, through};
use crate::prepare::{Notice, ToolRadius, ToolRadiusOptions};
use crate::{Cubic, ElementKind, Marks, PathElement, Shape};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

const LEFT: Marks = Marks::CORRECTION_LEFT;
const RIGHT: Marks = Marks::CORRECTION_RIGHT;

/// The elements with D and the marks of one contour.
fn contour(mut elements: Vec<PathElement>, side: Marks, radius_mm: f64) -> Vec<PathElement> {
    for element in &mut elements {
        element.tool_radius = radius_mm * 1e-3;
    }
    marked(elements, side, Marks::CORRECTION_END)
}

fn correct_with(
    elements: Vec<PathElement>,
    options: ToolRadiusOptions,
) -> (Vec<PathElement>, Vec<Notice>) {
    through(elements, |items, notices| ToolRadius::new(items, options, notices))
}

fn correct(elements: Vec<PathElement>) -> (Vec<PathElement>, Vec<Notice>) {
    correct_with(elements, ToolRadiusOptions::default())
}

fn compensated(elements: &str, side: Marks, radius_mm: f64) -> Vec<PathElement> {
    correct_contour(path(elements), side, radius_mm)
}

/// The corrected path of a contour without the positionings at its two ends.
fn correct_contour(elements: Vec<PathElement>, side: Marks, radius_mm: f64) -> Vec<PathElement> {
    let (mut path, notices) = correct(contour(elements, side, radius_mm));
    assert_eq!(notices, []);
    assert!(path.iter().all(|element| element.marks == Marks::default()));
    assert_eq!(path.first().map(|element| element.kind), Some(ElementKind::Rapid));
    assert_eq!(path.pop().map(|element| element.kind), Some(ElementKind::Rapid));
    path.remove(0);
    path
}

/// Lines of the elements on which a gouge is, and into which, with its depth.
fn gouges(notices: &[Notice]) -> Vec<([u32; 2], f64)> {
    let gouge = |notice: &Notice| match notice {
        Notice::Gouge { place, damaged, depth } => Some(([place.line, damaged.line], *depth)),
        _ => None,
    };
    notices.iter().filter_map(gouge).collect()
}

const CORNER: &str = "0,0 100,0 100,100";

#[test]
fn half_of_the_radius_may_come_from_the_options() {
    let options = ToolRadiusOptions { radius: 0.006, ..ToolRadiusOptions::default() };
    let (path, _) = correct_with(contour(path(CORNER), LEFT, 4.0), options);
    assert_path(&path, "0,0 r0,10 90,10 90,100 r100,100");
}

/// A circle's offset is a circle about the same centre, closed like the circle itself.
#[test]
fn circles() {
    for (sweep, side, radius) in
        [(TAU, LEFT, 40.0), (TAU, RIGHT, 60.0), (-TAU, LEFT, 60.0), (-TAU, RIGHT, 40.0)]
    {
        let circle = format!("148,14 o100,0:{}", sweep.to_degrees());
        let path = compensated(&circle, side, 10.0);
        let [PathElement { shape: Shape::Arc(offset), .. }] = &path[..] else { panic!("{path:?}") };
        assert!(close(offset.center(), [100.0, 0.0, 0.0]));
        assert!((offset.radius() * 1e3 - radius).abs() < 1e-9);
        assert!((offset.sweep() - sweep).abs() < 1e-12);
        assert!((offset.start() - offset.end()).norm() < 1e-12);
    }
}

/// A slot's outline with semicircles: tangent corners need neither arc nor cut.
#[test]
fn tangent_corners_stay_tangent() {
    for (side, y, radius) in [(LEFT, 5.0, 15.0), (RIGHT, -5.0, 25.0)] {
        let path = compensated("0,0 100,0 o100,20:180 0,40 o0,20:180", side, 5.0);
        assert_path(&path, &format!("0,{y} 100,{y} 100,{0} 0,{0} 0,{y}", 40.0 - y));
        let Shape::Arc(end) = &path[1].shape else { panic!("{path:?}") };
        assert!((end.radius() * 1e3 - radius).abs() < 1e-9);
        assert!((path[3].end() - path[0].start()).norm() < 1e-12, "closed");
    }
}

#[test]
fn lines_and_arcs_meet() {
    // Along +X to 50/0, then counter-clockwise about 50/50: tangent would be +X, the arc starts at −X−Y instead.
    // From 50/0 about 20/40: r 50, starting towards 80/30 turned by 36.87° to the left.
    let bend = "-100,0 50,0 o20,40:57";
    let inner = compensated(bend, LEFT, 10.0);
    assert_eq!(inner.len(), 2);
    // y = 10 meets the circle r 40 about 20/40 at x = 20 + √(1600 − 900).
    assert!(close(inner[0].end(), [20.0 + 700.0_f64.sqrt(), 10.0, 0.0]));
    let Shape::Arc(arc) = &inner[1].shape else { panic!("{inner:?}") };
    assert!((arc.radius() - 0.04).abs() < 1e-12);
    let outer = compensated(bend, RIGHT, 10.0);
    assert_eq!(outer.len(), 3);
    assert!(close(outer[0].end(), [50.0, -10.0, 0.0]));
    assert!(close(outer[1].end(), [56.0, -8.0, 0.0]));
    let Shape::Arc(arc) = &outer[2].shape else { panic!("{outer:?}") };
    assert!((arc.radius() - 0.06).abs() < 1e-12);
}

#[test]
fn a_reversal_is_an_outer_corner() {
    for (side, y) in [(LEFT, 10.0), (RIGHT, -10.0)] {
        let path = compensated("0,0 100,0 0,0", side, 10.0);
        assert_path(&path, &format!("0,{y} 100,{y} 100,{0} 0,{0}", -y));
        let tip = path[1].at(path[1].length() / 2.0).position;
        assert!(close(tip, [110.0, 0.0, 0.0]));
    }
}

#[test]
fn closed_squares() {
    let path = compensated("0,0 100,0 100,100 0,100 0,0", RIGHT, 10.0);
    assert_path(&path, "0,-10 100,-10 110,0 110,100 100,110 0,110 -10,100 -10,0");
    assert!((length(&path) - (0.4 + 1.5 * PI * 0.01)).abs() < 1e-12);
    let path = compensated("50,0 100,0 100,100 0,100 0,0 50,0", LEFT, 10.0);
    assert_path(&path, "50,10 90,10 90,90 10,90 10,10 50,10");
}

/// Helices keep their Z: the heights of their ends, however their length changes.
#[test]
fn height_stays() {
    let (start, center) = ([0.05, 0.0, 0.0].into(), [0.0; 3].into());
    let helix = crate::Arc::new(start, [-0.05, 0.0, 0.02].into(), center, PI);
    let down = cut(helix.end().into(), [-0.05, -0.1, -0.01], 0.05);
    let helix = element(ElementKind::Cut, Shape::Arc(helix), 0.05);
    for side in [LEFT, RIGHT] {
        let path = correct_contour(vec![helix.clone(), down.clone()], side, 10.0);
        assert_eq!((path[0].start().z, path[0].end().z), (0.0, 0.02));
        assert_eq!((path[1].start().z, path[1].end().z), (0.02, -0.01));
    }
}

/// A spline straight back over the line before it: the tool goes out on one side and comes back on the other.
#[test]
fn splines_that_turn_back() {
    // G1 X87.48 Y51.53, then G5 X0 Y0: the spline leaves in the direction of the line and arrives along its chord.
    let line = path("0,0 87.48,51.53");
    let (start, end) = (line[0].end(), line[0].start());
    let chord = (end - start).xy();
    let spline = Cubic::hermite(start, end, -chord, chord);
    let spline = element(ElementKind::Cut, Shape::Cubic(Box::new(spline)), 0.05);
    let elements = numbered(vec![line[0].clone(), spline]);
    let (path, _) = correct(contour(elements, RIGHT, 27.7));
    let direction = Vector2::new(87.48, 51.53).normalize();
    let mut sides = [0, 0];
    // But for the positionings.
    for element in path.iter().filter(|element| element.kind == ElementKind::Cut) {
        let end = element.end().coords.xy();
        let (along, across) = (direction.dot(&end), direction.perp(&end));
        assert!(element.length().is_finite(), "{element:?}");
        if along < 0.087_48 {
            assert!((across.abs() - 27.7e-3).abs() <= 2e-6, "{element:?}");
        }
        sides[usize::from(across > 0.0)] += 1;
    }
    assert!(sides.iter().all(|count| *count > 0), "{sides:?}");
}
