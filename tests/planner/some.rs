//! Jerk limits of only some of the axes.

use super::long::{cut, meander, teeth};
use super::machines::Machine;
use super::run::{Report, run_on};
use nalgebra::Point3;
use std::f64::consts::{PI, TAU};
use twin_path::Place;
use twin_path::{Arc, ElementKind, PathElement, Plane, Shape};
use twin_planner::blended_path::BlendOptions;
use twin_planner::time_optimal::{AxisLimits, LimitOptions};

/// The arm's first joint alone has a jerk limit.
fn limits() -> Vec<AxisLimits> {
    let mut limits = Machine::Scara2.limits(true);
    for axis in &mut limits[1..] {
        axis.jerk = None;
    }
    limits
}

fn element(index: usize, shape: Shape) -> PathElement {
    let place = Place::at(index as u32 + 1);
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

/// Plans `path` under these limits, with or without what the program asks for.
fn plan(path: &[PathElement], limits: &[AxisLimits], programmed: bool) -> Report {
    let axes = [limits, limits].map(|limits| Machine::Scara2.path_within(limits.to_vec()));
    let options = LimitOptions::new(BlendOptions::new(1e-5));
    let options = LimitOptions { feed: programmed, path_acceleration: programmed, ..options };
    run_on(axes, path.iter().cloned(), PI, options, 1e-3)
}

/// Where the other axes may change their accelerations at once, the limits of the one are kept all the same, and the motion is
/// between that without jerk limits and that with all of them.
#[test]
fn one_axis_alone_has_a_jerk_limit() {
    let mut paths = vec![
        ("circle", circle()),
        ("36 lines", lissajous(36)),
        ("200 lines", lissajous(200)),
        ("meander", meander().take(24).enumerate().map(cut).collect()),
        ("teeth", teeth().take(24).enumerate().map(cut).collect()),
    ];
    if std::env::var_os("TWIN_CORPUS_FULL").is_some() {
        paths.push(("1000 lines", lissajous(1000)));
    }
    for (name, path) in paths {
        for programmed in [true, false] {
            let report = plan(&path, &limits(), programmed);
            let effort = report.effort;
            println!(
                "{name}, as programmed {programmed}: {:.4} s, jerk {:.4}, {effort:?}, {:.2} s",
                report.duration, report.jerk.value, report.took,
            );
            assert_eq!((effort.failed, effort.exceeded), (0, 0), "{name} {programmed}");
            assert!(report.errors.is_empty(), "{:?}", report.errors);
            assert!(report.velocity.value <= 1.001, "{name} {:?}", report.velocity);
            assert!(report.acceleration.value <= 1.001, "{name} {:?}", report.acceleration);
            assert!(report.jerk.value <= 1.05, "{name} {:?}", report.jerk);
            assert!(report.third_difference.value <= 1.05, "{name} {:?}", report.third_difference);
            // Planned again and again it would take for ever.
            assert!(effort.cells <= 12 * effort.committed, "{name} {effort:?}");
            let none = plan(&path, &Machine::Scara2.limits(false), programmed);
            let all = plan(&path, &Machine::Scara2.limits(true), programmed);
            assert!(none.duration <= report.duration * 1.001, "{name} {}", none.duration);
            assert!(report.duration <= all.duration * 1.001, "{name} {}", all.duration);
        }
    }
}
