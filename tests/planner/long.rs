//! Long paths, generated while they are planned and never held as a whole.

use super::machines::Machine;
use super::run::{Report, Settings, run};
use nalgebra::Point3;
use std::f64::consts::{FRAC_PI_2, PI};
use twin_path::Place;
use twin_path::{Arc, ElementKind, PathElement, Plane, Shape};

/// A meander of lines and half circles, without corners.
pub fn meander() -> impl Iterator<Item = Shape> {
    let mut at: Point3<f64> = Point3::new(0.26, -0.02, 0.02);
    (0_u32..).map(move |index| {
        let row = index / 2;
        // To the left and back, upwards for sixteen rows and downwards for as many.
        let aside = if row % 2 == 0 { 4e-3 } else { -4e-3 };
        let up = if (row / 16) % 2 == 0 { 1e-3 } else { -1e-3 };
        let shape = if index % 2 == 0 {
            Shape::Line { start: at, end: Point3::new(at.x + aside, at.y, at.z) }
        } else {
            let center = Point3::new(at.x, at.y + up, at.z);
            let end = Point3::new(at.x, at.y + 2.0 * up, at.z);
            let sweep = if aside * up > 0.0 { PI } else { -PI };
            Shape::Arc(Arc::in_plane(Plane::Xy, at, end, center, sweep))
        };
        at = shape.end();
        shape
    })
}

/// Teeth of short lines and quarter circles, with corners all along.
pub fn teeth() -> impl Iterator<Item = Shape> {
    let mut at: Point3<f64> = Point3::new(0.28, -0.02, 0.02);
    (0_u32..).map(move |index| {
        let way = if (index / 40) % 2 == 0 { 1e-3 } else { -1e-3 };
        let aside = if index % 4 < 2 { 4e-4 } else { -4e-4 };
        let shape = if index % 2 == 0 {
            Shape::Line { start: at, end: Point3::new(at.x + aside, at.y + way, at.z) }
        } else {
            let half = Point3::new(at.x, at.y + 0.5 * way, at.z);
            // A quarter of a circle: its centre is as far aside as it is on.
            let center = Point3::new(half.x + 0.5 * way, half.y, half.z);
            let end = Point3::new(at.x, at.y + way, at.z);
            Shape::Arc(Arc::in_plane(Plane::Xy, at, end, center, -FRAC_PI_2))
        };
        at = shape.end();
        shape
    })
}

pub fn cut((index, shape): (usize, Shape)) -> PathElement {
    let place = Place::at(index as u32 + 1);
    let made = PathElement::new(place, ElementKind::Cut, shape);
    PathElement { feed: 0.02, acceleration: 1.0, deceleration: 1.0, ..made }
}

const SETTINGS: Settings =
    Settings { machine: Machine::Scara2, jerk: true, tolerance: 5e-6, angle: PI, horizon: 1.5 };

fn check(report: &Report, count: usize) {
    println!(
        "{count} elements, {} cells in {} windows, {:.1} times, {:.1} s, {:.0} cells/s, jerk {:.4}",
        report.effort.committed,
        report.effort.windows,
        report.effort.cells as f64 / report.effort.committed as f64,
        report.duration,
        report.points_per_second(),
        report.jerk.value,
    );
    assert_eq!((report.effort.failed, report.effort.exceeded, report.errors.len()), (0, 0, 0));
    assert_eq!(report.lines.len(), count);
    assert!(report.acceleration.value <= 1.001, "{:?}", report.acceleration);
    assert!(report.jerk.value <= 1.05, "{:?}", report.jerk);
    assert!(report.brief_jerk.value <= 1.05, "{:?}", report.brief_jerk);
    assert!(report.third_difference.value <= 1.05, "{:?}", report.third_difference);
}

/// Resident memory of this process, bytes; 0 where the system does not tell.
fn resident() -> usize {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = statm.split_whitespace().nth(1).and_then(|pages| pages.parse::<usize>().ok());
    pages.unwrap_or(0) * 4096
}

/// Elements that make more than a million cells.
const MILLION: usize = 15_000;

/// As many elements as `TWIN_LONG_ELEMENTS` says; more than a million cells where the corpus is looked at in full.
#[test]
fn a_long_path_takes_no_more_memory() {
    let full = std::env::var_os("TWIN_CORPUS_FULL").is_some();
    let count = std::env::var("TWIN_LONG_ELEMENTS").ok();
    let count: usize =
        count.map_or(if full { MILLION } else { 60 }, |count| count.parse().unwrap());
    let mut at = Vec::new();
    let path = meander().take(count).enumerate().map(cut).inspect(|element| {
        if [count / 3, count].contains(&(element.place.line as usize)) {
            at.push(resident());
        }
    });
    let report = run(path, &SETTINGS, SETTINGS.options());
    check(&report, count);
    assert!(count < MILLION || report.effort.committed >= 1_000_000, "{:?}", report.effort);
    let [early, late] = at[..] else { panic!("{at:?}") };
    println!("{} kB after a third, {} kB at the end", early / 1000, late / 1000);
    // Other tests run at the same time; what would grow is a kilobyte per cell.
    assert!(count < 1000 || late < early + 32_000_000, "{early} {late}");
}

#[test]
fn corners_all_along() {
    let report = run(teeth().take(40).enumerate().map(cut), &SETTINGS, SETTINGS.options());
    check(&report, 40);
}
