//! Jerk limits of some of the axes alone.

use super::machines::Machine;
use super::run::{Report, run_on};
use nalgebra::Point3;
use std::f64::consts::{PI, TAU};
use twin_motion::Place;
use twin_motion::limit::course::CourseOptions;
use twin_motion::limit::{AxisLimits, LimitOptions};
use twin_motion::path::{Arc, ElementKind, PathElement, Plane, Shape};

/// The arm's first joint alone has a jerk limit.
fn limits() -> Vec<AxisLimits> {
    let mut limits = Machine::Scara2.limits(true);
    if std::env::var("ALL").is_ok() {
        return limits;
    }
    for axis in &mut limits[1..] {
        axis.jerk = None;
    }
    limits
}

fn element(index: usize, shape: Shape) -> PathElement {
    let place = Place { line: index as u32 + 1, block: None };
    let made = PathElement::new(place, ElementKind::Cut, shape);
    PathElement { feed: 0.05, acceleration: 1.0, deceleration: 1.0, ..made }
}

/// Once round and on.
fn circle() -> Vec<PathElement> {
    let start = Point3::new(0.38, 0.0, 0.02);
    let centre = Point3::new(0.28, 0.0, 0.02);
    let arc = Arc::in_plane(Plane::Xy, start, start, centre, TAU);
    vec![element(0, Shape::Arc(arc))]
}

/// Short lines along a curve that swings to both sides.
fn lissajous(count: u32) -> Vec<PathElement> {
    let at = |index: u32| {
        let angle = TAU * f64::from(index) / f64::from(count);
        Point3::new(0.28 + 0.08 * (3.0 * angle).cos(), 0.08 * (2.0 * angle).sin(), 0.02)
    };
    (0..count).map(|i| element(i as usize, Shape::Line { start: at(i), end: at(i + 1) })).collect()
}

fn look(name: &str, path: Vec<PathElement>, free: bool) -> Report {
    let axes = [Machine::Scara2.path_within(limits()), Machine::Scara2.path_within(limits())];
    let options = LimitOptions::new(CourseOptions::new(1e-5));
    let options = LimitOptions { feed: !free, path_acceleration: !free, ..options };
    let report = run_on(axes, path.into_iter(), PI, options, 1e-3);
    println!(
        "{name} free {free} T {:.4} v {:.4} a {:.4} j {:.4} 3rd {:.4} {:?} took {:.3}",
        report.duration,
        report.velocity.value,
        report.acceleration.value,
        report.jerk.value,
        report.third_difference.value,
        report.effort,
        report.took
    );
    report
}

#[test]
fn one_axis_alone() {
    if let Ok(n) = std::env::var("N") {
        look("lissajous", lissajous(n.parse().unwrap()), true);
        return;
    }
    for free in [false, true] {
        look("circle", circle(), free);
        for count in [36, 200, 1000] {
            look(&format!("lissajous {count}"), lissajous(count), free);
        }
        look(
            "meander",
            super::long::meander().take(60).enumerate().map(super::long::cut).collect(),
            free,
        );
        look(
            "teeth",
            super::long::teeth().take(40).enumerate().map(super::long::cut).collect(),
            free,
        );
    }
}
