//! Acceleration limits of the tool tip.

use super::machines::Machine;
use super::random::{Form, Step, cases, check, exponential, settings, step, walk};
use super::run::{Settings, run};
use nalgebra::Point3;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use twin_path::Place;
use twin_path::{Arc, ElementKind, PathElement, Plane, Shape};
use twin_planner::time_optimal::LimitOptions;

/// Once around, faster than the tool may go on the circle, in several windows and in one.
#[test]
fn circles_are_as_fast_as_the_tool_may_be_accelerated() {
    const RADIUS: f64 = 0.02;
    const LIMIT: f64 = 0.5;
    for machine in Machine::ALL {
        let [min, max] = machine.room();
        let center = Point3::from(0.5 * (min + max));
        let start = Point3::new(center.x + RADIUS, center.y, center.z);
        let arc = Arc::in_plane(Plane::Xy, start, start, center, TAU);
        let place = Place::at(1);
        let made = PathElement::new(place, ElementKind::Cut, Shape::Arc(arc));
        let path = [PathElement { feed: 0.15, acceleration: 20.0, deceleration: 20.0, ..made }];
        // v̇² + (v²/r)² = a²: to √(a·r) it takes √(r/a)·∫dx/√(1 − x⁴), on π/4 of the radius.
        let steady = (TAU - FRAC_PI_2) * RADIUS / (LIMIT * RADIUS).sqrt();
        let least = steady + 2.0 * 1.311_028_777 * (RADIUS / LIMIT).sqrt();
        for (jerk, horizon) in [(false, 0.6), (true, 0.6), (true, 1e3)] {
            let settings = Settings { machine, jerk, tolerance: 1e-6, angle: PI, horizon };
            let options = LimitOptions { tool_acceleration: Some(LIMIT), ..settings.options() };
            let report = run(path.iter().cloned(), &settings, options);
            check(&report, &path, &settings).expect("limits that are kept");
            let (peak, duration) = (report.tool_acceleration.value / LIMIT, report.duration);
            println!(
                "{machine:?}, jerk {jerk}, {horizon} s: {peak:.5}, {duration:.5} s, {least:.5} s"
            );
            assert!(peak <= 1.001, "{peak}");
            // By a part of a cell of 1.25 ms; with limited jerk by about the time in which accelerations come and go.
            let later = if jerk { 0.03 } else { 2.5e-4 };
            assert!(duration > least * (1.0 - 1e-6), "{duration}");
            assert!(duration < least + later, "{duration}");
        }
    }
}

/// Where the tool goes round at constant speed, accelerations that are far from holding it have coefficients of rounding.
#[test]
fn what_leaves_a_circle_keeps_the_limit() {
    let arc = Form::Arc { plane: Plane::Xy, sweep: -5.007, rise: 0.0 };
    let steps = [
        Step::new(arc, false, 0.005, [0.0, -0.856, 0.0], 0.5, [1.0, 1.0]),
        Step::new(Form::Line, true, 0.003_268, [-0.696, -0.636, 0.446], 0.0468, [1.252, 1.333]),
    ];
    let machine = Machine::Gantry3;
    let angle = 2_f64.to_radians();
    let settings = Settings { machine, jerk: false, tolerance: 1e-4, angle, horizon: 1.5 };
    let path = walk(&steps, machine);
    let options = LimitOptions { tool_acceleration: Some(1.0), ..settings.options() };
    let report = run(path.iter().cloned(), &settings, options);
    check(&report, &path, &settings).expect("limits that are kept");
    assert!(report.tool_acceleration.value <= 1.001, "{:?}", report.tool_acceleration);
}

proptest! {
    #![proptest_config(cases(8))]

    #[test]
    fn limits_of_the_tool_are_kept(
        settings in settings(),
        jerk in any::<bool>(),
        limit in exponential(0.2..5.0),
        steps in prop::collection::vec(step(), 1..20),
    ) {
        let settings = Settings { jerk, ..settings };
        let path = walk(&steps, settings.machine);
        let options = LimitOptions { tool_acceleration: Some(limit), ..settings.options() };
        let report = run(path.iter().cloned(), &settings, options);
        check(&report, &path, &settings)?;
        let peak = report.tool_acceleration;
        prop_assert!(peak.value <= 1.001 * limit, "{peak:?} of {limit} on {settings:?}, {:?}", report.effort);
    }
}
