//! Very short moves, over within a few cycles.

use super::machines::Machine;
use super::random::check;
use super::run::{Settings, run, run_on};
use nalgebra::{Point3, Vector3};
use twin_path::Place;
use twin_path::{ElementKind, PathElement, Shape};

/// Steps of this length, m, to and fro at right angles: the path stops after each.
fn steps(machine: Machine, length: f64, count: u32) -> Vec<PathElement> {
    let [min, max] = machine.room();
    let mut at = Point3::from(0.4 * min + 0.6 * max);
    let directions = [Vector3::x(), Vector3::y(), -Vector3::x(), Vector3::z()];
    let step = |index: u32| {
        let start = at;
        at += directions[index as usize % 4] * length;
        let place = Place::at(index + 1);
        let made = PathElement::new(place, ElementKind::Cut, Shape::Line { start, end: at });
        PathElement { feed: 0.2, acceleration: 20.0, deceleration: 20.0, ..made }
    };
    (0..count).map(step).collect()
}

/// Cells that are a few microseconds long would be too short for their jerks: rounding drowns them. Looked at every 10 µs.
#[test]
fn jerks_are_limited_however_short_the_move() {
    for machine in Machine::ALL {
        for length in [1e-8, 1e-7, 2e-7, 1e-6, 1e-5] {
            let settings = Settings {
                machine,
                jerk: true,
                tolerance: 1e-6,
                angle: 2_f64.to_radians(),
                horizon: 1.5,
            };
            let path = steps(machine, length, 8);
            let axes = [machine.path(true), machine.path(true)];
            let report =
                run_on(axes, path.iter().cloned(), settings.angle, settings.options(), 1e-5);
            assert_eq!(report.stops, 8, "{machine:?} {length}");
            check(&report, &path, &settings).unwrap();
        }
    }
}

/// Centimetres with something very short in between, at which the path turns by `angle` in all, rad: passed without a stop.
fn interrupted(machine: Machine, length: f64, angle: f64, count: u32) -> Vec<PathElement> {
    let [min, max] = machine.room();
    let mut at = Point3::from(0.7 * min + 0.3 * max);
    let step = |index: u32| {
        let start = at;
        let turned = 0.5 * angle * f64::from(index % 4);
        let turned = if index % 4 == 3 { 0.5 * angle } else { turned };
        at += Vector3::new(turned.cos(), turned.sin(), 0.0)
            * if index.is_multiple_of(2) { 0.01 } else { length };
        let place = Place::at(index + 1);
        let made = PathElement::new(place, ElementKind::Cut, Shape::Line { start, end: at });
        PathElement { feed: 0.2, acceleration: 20.0, deceleration: 20.0, ..made }
    };
    (0..count).map(step).collect()
}

/// Every millisecond the limits are kept, and no window fails, however much slower the path has to be there. Turns are such as can
/// be written: 0.1 µm in a centimetre is more than 1e-5 rad.
#[test]
fn what_is_very_short_is_passed_within_the_limits() {
    for machine in Machine::ALL {
        for length in [1e-7, 1e-6, 1e-5, 1e-4] {
            for angle in [0.0, 1e-4, 1e-2, 0.1] {
                let settings =
                    Settings { machine, jerk: true, tolerance: 1e-6, angle: 3.0, horizon: 1.5 };
                let path = interrupted(machine, length, angle, 8);
                let report = run(path.iter().cloned(), &settings, settings.options());
                assert_eq!(report.effort.exceeded, 0, "{machine:?} {length} {angle}");
                check(&report, &path, &settings).unwrap();
            }
        }
    }
}
