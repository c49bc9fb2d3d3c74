//! Knife machines: a tool that turns with the path, within the same limits.

use super::machines::{BUILD_UP, Machine};
use super::random::{cases, check, exponential, step, walk};
use super::run::{Report, Settings, run};
use nalgebra::Point3;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use twin_path::Place;
use twin_path::{Arc, ElementKind, PathElement, Shape};

fn settings(tolerance: f64, angle: f64) -> Settings {
    Settings { machine: Machine::Cutter, jerk: true, tolerance, angle, horizon: 1.5 }
}

fn element(line: u32, kind: ElementKind, shape: Shape) -> PathElement {
    let made = PathElement::new(Place::at(line), kind, shape);
    PathElement { feed: 0.2, acceleration: 5.0, deceleration: 5.0, ..made }
}

/// Along these points, m.
fn polyline(points: &[[f64; 3]]) -> Vec<PathElement> {
    let pairs = points.windows(2).zip(1..);
    let lines = pairs.map(|(pair, line)| {
        let shape = Shape::Line { start: pair[0].into(), end: pair[1].into() };
        element(line, ElementKind::Cut, shape)
    });
    lines.collect()
}

fn planned(path: &[PathElement], settings: &Settings) -> Report {
    let report = run(path.iter().cloned(), settings, settings.options());
    if let Err(error) = check(&report, path, settings) {
        panic!("{error}");
    }
    assert_eq!(report.effort.exceeded, 0);
    report
}

/// Rest to rest by `turn`, rad, within the limits of R, which reaches its acceleration: seven segments of constant jerk, or six
/// where its velocity is not reached.
fn turning(turn: f64) -> f64 {
    let (velocity, acceleration) = (1080_f64.to_radians(), 20_000_f64.to_radians());
    let ramp = velocity / acceleration + BUILD_UP;
    if turn >= velocity * ramp {
        return ramp + turn / velocity;
    }
    let half = 0.5 * BUILD_UP;
    let peak = acceleration * ((half * half + turn / acceleration).sqrt() - half);
    assert!(peak >= acceleration * BUILD_UP);
    2.0 * (peak / acceleration + BUILD_UP)
}

/// Corners at which the path stops take the time that the knife needs beside that of the lines.
#[test]
fn turns_on_the_spot_take_their_time() {
    let settings = settings(1e-5, 0.03);
    let along = |length: f64| vec![[0.0, 0.0, 0.0], [length, 0.0, 0.0]];
    let line = planned(&polyline(&along(0.05)), &settings).duration;
    for turn in [FRAC_PI_2, 2.0, 3.0, PI] {
        let (sin, cos) = f64::sin_cos(turn);
        let mut points = along(0.05);
        points.push([0.05 + 0.05 * cos, 0.05 * sin, 0.0]);
        let report = planned(&polyline(&points), &settings);
        let found = report.duration - planned(&polyline(&points[1..]), &settings).duration - line;
        let expected = turning(turn);
        println!("{turn}: {found} {expected} s, {:?}", report.effort);
        // The edge is 2 mm beside R: what the other axes have to give for that is within their limits.
        assert!((found / expected - 1.0).abs() < 5e-4, "{turn}: {found} {expected}");
    }
}

/// At constant radius R limits the velocity to ω·r.
#[test]
fn circles_are_limited_by_the_knife() {
    let radius = 0.005;
    let sweep = 60.0 * PI;
    let [start, center] = [[radius, 0.0, 0.0], [0.0; 3]].map(Point3::from);
    let arc = Arc::new(start, start, center, sweep);
    let path = [element(1, ElementKind::Cut, Shape::Arc(arc))];
    let report = planned(&path, &settings(1e-5, 0.03));
    let velocity = 1080_f64.to_radians();
    assert!(velocity * radius < 0.2);
    let least = sweep / velocity;
    assert!(report.duration > least && report.duration < least + 0.2, "{}", report.duration);
    assert!(report.velocity.value > 0.999, "{:?}", report.velocity);
}

/// Corners within a micrometre, in which the knife turns by up to 160°.
#[test]
fn sharp_corners_within_a_micrometre() {
    for turn in [0.05, 0.5, FRAC_PI_2, 2.8] {
        for tolerance in [1e-6, 1e-5, 1e-4] {
            let (sin, cos) = f64::sin_cos(turn);
            let points = [[0.0; 3], [0.02, 0.0, 0.0], [0.02 + 0.02 * cos, 0.02 * sin, 0.0]];
            let report = planned(&polyline(&points), &settings(tolerance, PI));
            println!(
                "{turn} within {tolerance}: {} s, jerk {:.4} {:.4}, {:?}",
                report.duration, report.jerk.value, report.third_difference.value, report.effort
            );
        }
    }
}

/// Down, along, up, back: the knife turns where the path rests.
#[test]
fn plunges_and_dwells() {
    let mut path = polyline(&[
        [0.1, 0.0, 0.05],
        [0.1, 0.0, 0.0],
        [0.1, 0.05, 0.0],
        [0.1, 0.05, 0.05],
        [0.05, 0.0, 0.05],
        [0.05, 0.0, 0.0],
    ]);
    let at = path[3].start();
    let still = Shape::Line { start: at, end: at };
    path.insert(3, element(9, ElementKind::Dwell { time_ns: 10_000_000 }, still));
    let report = planned(&path, &settings(1e-5, 0.03));
    // At the start, between two elements at a time but the dwell's, there, and behind it, before and after a turn of 135°.
    assert_eq!(report.stops, 7);
    // The same where no corner is a stop: a vertical line has no direction to blend with.
    let report = planned(&path, &settings(1e-5, PI));
    assert_eq!(report.stops, 7);
}

fn settings_of_any_kind() -> impl Strategy<Value = Settings> {
    let angle = prop_oneof![Just(2_f64.to_radians()), Just(PI)];
    (exponential(1e-6..1e-4), angle).prop_map(|(tolerance, angle)| settings(tolerance, angle))
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn limits_of_jerk_are_kept(
        settings in settings_of_any_kind(),
        steps in prop::collection::vec(step(), 1..20),
    ) {
        let path = walk(&steps, settings.machine);
        let report = run(path.iter().cloned(), &settings, settings.options());
        check(&report, &path, &settings)?;
    }

    #[test]
    fn limits_of_acceleration_are_kept(
        settings in settings_of_any_kind(),
        steps in prop::collection::vec(step(), 1..20),
    ) {
        let settings = Settings { jerk: false, ..settings };
        let path = walk(&steps, settings.machine);
        let report = run(path.iter().cloned(), &settings, settings.options());
        check(&report, &path, &settings)?;
    }
}
