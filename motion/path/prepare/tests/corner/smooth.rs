//! Tests of corner smoothing, [`SmoothPath`]; the tests of [`crate::prepare::RoundPath`] cover the common part.

use super::{marked, with_radius};
use crate::prepare::tests::{
    Error, VECTOR_TOLERANCE, arc, assert_continuous, close, cut, element, polyline,
};
use crate::prepare::{Notices, SmoothPath, Smoothing};
use crate::{Cubic, Ellipse, ExtraAxes, Marks, PathElement, Shape};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::{FRAC_PI_2, PI};

fn smooth(elements: Vec<PathElement>, edge_distance: f64) -> Vec<PathElement> {
    let items = marked(elements, Marks::SMOOTHING).into_iter().map(Ok::<_, Error>);
    let style = Smoothing { edge_distance, angle_tolerance: 0.01 };
    let path: Vec<_> =
        SmoothPath::new(items, style, Notices::default()).map(Result::unwrap).collect();
    assert_continuous(&path);
    path
}

fn assert_tangent(path: &[PathElement]) {
    for pair in path.windows(2) {
        let kink = (pair[0].end_tangent() - pair[1].start_tangent()).norm();
        assert!(kink < 1e-9, "kink of {kink} between {:?} and {:?}", pair[0], pair[1]);
    }
}

const CORNER: [[f64; 2]; 3] = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]];

/// Vector `prep-smooth-90`: 20 from the corner 100/0 of a right angle.
#[test]
fn prep_smooth_90() {
    // The adapter's distance and D add up.
    for (edge_distance, programmed) in [(0.02, 0.0), (0.0, 0.02), (0.005, 0.015)] {
        let path = smooth(with_radius(polyline(&CORNER), programmed), edge_distance);
        assert_eq!(path.len(), 3);
        assert!(close(path[0].end(), [80.0, 0.0, 0.0]));
        assert!(close(path[1].end(), [100.0, 20.0, 0.0]));
        let Shape::Cubic(cubic) = &path[1].shape else { panic!("{:?}", path[1]) };
        let expected = [
            ([80.0, 28.284_271_247, 3.431_457_505, -11.715_728_753], cubic.x()),
            ([0.0, 0.0, 31.715_728_753, -11.715_728_753], cubic.y()),
        ];
        for (expected, found) in expected {
            for (expected, found) in expected.iter().zip(found) {
                // One digit of the file is rounded.
                assert!((found * 1e3 - expected).abs() <= 1e-8, "{found} for {expected}");
            }
        }
        // Symmetric: the middle is half way along.
        let middle = path[1].at(path[1].length() / 2.0).position;
        assert!((middle - Point3::new(0.093_535_533_906, 0.006_464_466_094, 0.0)).norm() <= 2e-11);
        assert!((path[1].length() - 0.030_744_715_941).abs() <= VECTOR_TOLERANCE);
        assert_tangent(&path);
        assert!(path.iter().all(|element| element.marks == Marks::default()));
    }
}

/// A circle about the corner cuts the arc: 20 mm as the crow flies, not along it.
#[test]
fn arcs_are_cut_by_a_circle_about_the_corner() {
    // Up to 0/0 along +X, then clockwise from 0/0 about 0/−50 reversed: counter-clockwise starting towards −X… at 90°.
    let line = cut([-0.1, 0.0, 0.0], [0.0; 3], 0.05);
    // About 50/0, from 180°, clockwise: leaves 0/0 along +Y.
    let bend = arc([0.05, 0.0, 0.0], 0.05, PI, -FRAC_PI_2, 0.05);
    let path = smooth(vec![line, bend], 0.02);
    assert_eq!(path.len(), 3);
    assert!(close(path[0].end(), [-20.0, 0.0, 0.0]));
    let cut = path[1].end();
    assert!((cut.coords.norm() - 0.02).abs() < 1e-12);
    assert!(((cut - Point3::new(0.05, 0.0, 0.0)).norm() - 0.05).abs() < 1e-12);
    assert_tangent(&path);
}

/// All shapes with each other.
#[test]
fn every_shape_can_be_joined() {
    let ellipse = || {
        let start = Point3::new(0.0, 0.0, 0.0);
        let ellipse = Ellipse::new(
            start,
            Point3::new(0.08, 0.0, 0.01),
            Point2::new(0.04, 0.0),
            Vector2::new(0.04, 0.0),
            0.02,
            -PI,
        );
        element(crate::ElementKind::Cut, Shape::Ellipse(Box::new(ellipse)), 0.05)
    };
    let parabola = || {
        let parabola = Cubic::parabola(
            Point3::new(0.08, 0.0, 0.01),
            Point2::new(0.12, -0.03),
            Point3::new(0.16, 0.03, 0.0),
        );
        element(crate::ElementKind::Cut, Shape::Cubic(Box::new(parabola)), 0.05)
    };
    let bend = || arc([0.16, -0.01, 0.0], 0.04, FRAC_PI_2, -PI, 0.05);
    let path = smooth(vec![ellipse(), parabola(), bend()], 0.01);
    // The ellipse ends downwards, the parabola begins at an angle to that; it ends upwards, the arc begins to the right.
    assert_eq!(path.len(), 5);
    assert_tangent_in_plane(&path);
}

/// Heights go on linearly along each piece, so that only X and Y are without a kink.
fn assert_tangent_in_plane(path: &[PathElement]) {
    for pair in path.windows(2) {
        let [a, b] = [pair[0].end_tangent(), pair[1].start_tangent()]
            .map(|tangent| tangent.xy().normalize());
        assert!((a - b).norm() < 1e-9, "{a} and {b}");
    }
}

#[test]
fn half_of_the_shorter_element_is_the_most() {
    let path = smooth(polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 30.0], [0.0, 30.0]]), 0.02);
    assert_eq!(path.len(), 4);
    assert!(close(path[1].end(), [100.0, 15.0, 0.0]));
}

/// Only rounding's marks are rounding's.
#[test]
fn other_marks_are_left_alone() {
    let path = marked(polyline(&CORNER), Marks::ROUNDING);
    let items = path.clone().into_iter().map(Ok::<_, Error>);
    let style = Smoothing { edge_distance: 0.02, angle_tolerance: 0.0 };
    let smoothed: Vec<_> =
        SmoothPath::new(items, style, Notices::default()).map(Result::unwrap).collect();
    assert_eq!(smoothed, path);
}

/// An additional axis that is first named in the middle goes on without a jump.
#[test]
fn axes_named_later_do_not_jump() {
    let mut path = polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]);
    path[1].details.get_or_insert_default().extra =
        Some(ExtraAxes { start: [0.0; 5], end: [5.0, 0.0, 0.0, 0.0, 0.0] });
    let path = marked(path, Marks::SMOOTHING).into_iter().map(Ok::<_, Error>);
    let style = Smoothing { edge_distance: 0.03, angle_tolerance: 0.0 };
    let smooth: Vec<_> =
        SmoothPath::new(path, style, Notices::default()).map(Result::unwrap).collect();
    assert_eq!(smooth.len(), 3);
    assert_continuous(&smooth);
    assert_eq!(smooth[2].extra().unwrap().start[0], 1.5);
}

/// Halves that meet in the middle of an element leave nothing of it at which the path would stop.
#[test]
fn nothing_of_no_length_is_left() {
    let path = polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 20.0]]);
    let path = marked(path, Marks::SMOOTHING).into_iter().map(Ok::<_, Error>);
    let style = Smoothing { edge_distance: 0.02, angle_tolerance: 0.0 };
    let smooth: Vec<_> =
        SmoothPath::new(path, style, Notices::default()).map(Result::unwrap).collect();
    assert_continuous(&smooth);
    // Two halves of lines with three splines between.
    assert_eq!(smooth.len(), 5);
    assert!(smooth.iter().all(|element| element.length() > 1e-3));
}
