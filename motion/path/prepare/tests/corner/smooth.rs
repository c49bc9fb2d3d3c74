//! Tests of corner smoothing, [`SmoothPath`]; the tests of [`crate::prepare::RoundPath`] cover the common part.

use super::{CORNER, assert_tangent, assert_tangent_in_plane, marked, smoothed};
use crate::prepare::Smoothing;
use crate::prepare::tests::{arc, assert_path, close, element, extras, path, with_extra};
use crate::{Cubic, ElementKind, Ellipse, Marks, PathElement, Shape};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) fn smooth(elements: Vec<PathElement>, edge_distance: f64) -> Vec<PathElement> {
    let style = Smoothing { edge_distance, angle_tolerance: 0.01 };
    smoothed(marked(elements, Marks::SMOOTHING), style).0
}

/// The adapter's distance and D add up; the marks are obeyed and gone.
#[test]
fn distance_and_radius_add_up() {
    for (edge_distance, radius) in [(0.02, 0), (0.0, 20), (0.005, 15)] {
        let path = smooth(path(&format!("D{radius} {CORNER}")), edge_distance);
        assert_path(&path, "0,0 80,0 100,20 100,100");
        assert_tangent(&path);
        assert!(path.iter().all(|element| element.marks == Marks::default()));
    }
}

/// A circle about the corner cuts the arc: 20 mm as the crow flies, not along it.
#[test]
fn arcs_are_cut_by_a_circle_about_the_corner() {
    // Up to 0/0 along +X, then about 50/0, from 180°, clockwise: leaves 0/0 along +Y.
    let path = smooth(path("-100,0 0,0 o50,0:-90"), 0.02);
    assert_eq!(path.len(), 3);
    assert!(close(path[0].end(), [-20.0, 0.0, 0.0]));
    let cut = path[1].end();
    assert!((cut.coords.norm() - 0.02).abs() < 1e-12);
    assert!(((cut - Point3::new(0.05, 0.0, 0.0)).norm() - 0.05).abs() < 1e-12);
    assert_tangent(&path);
}

#[test]
fn every_shape_can_be_joined() {
    let (joint, half) = (Point3::new(0.08, 0.0, 0.01), Vector2::new(0.04, 0.0));
    let ellipse = Ellipse::new(Point3::origin(), joint, half.into(), half, 0.02, -PI);
    let parabola = Cubic::parabola(joint, Point2::new(0.12, -0.03), Point3::new(0.16, 0.03, 0.0));
    let cut = |shape| element(ElementKind::Cut, shape, 0.05);
    let path = smooth(
        vec![
            cut(Shape::Ellipse(Box::new(ellipse))),
            cut(Shape::Cubic(Box::new(parabola))),
            arc([0.16, -0.01, 0.0], 0.04, FRAC_PI_2, -PI, 0.05),
        ],
        0.01,
    );
    // The ellipse ends downwards, the parabola begins at an angle to that; it ends upwards, the arc begins to the right.
    assert_eq!(path.len(), 5);
    assert_tangent_in_plane(&path);
}

#[test]
fn other_marks_are_left_alone() {
    let path = marked(path(CORNER), Marks::ROUNDING);
    let style = Smoothing { edge_distance: 0.02, angle_tolerance: 0.0 };
    assert_eq!(smoothed(path.clone(), style).0, path);
}

/// An additional axis that is first named in the middle goes on without a jump.
#[test]
fn axes_named_later_do_not_jump() {
    let mut path = path(CORNER);
    path[1] = with_extra(path[1].clone(), (0.0, 5.0));
    let smooth = smooth(path, 0.03);
    assert_eq!(smooth.len(), 3);
    assert_eq!(extras(&smooth)[2], Some((1.5, 5.0)));
}

/// Halves that meet in the middle of an element leave nothing of it at which the path would stop.
#[test]
fn nothing_of_no_length_is_left() {
    let smooth = smooth(path("0,0 10,0 10,10 0,10 0,20"), 0.02);
    // Two halves of lines with three splines between.
    assert_eq!(smooth.len(), 5);
    assert!(smooth.iter().all(|element| element.length() > 1e-3));
}
