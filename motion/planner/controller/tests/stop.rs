//! Tests of stops requested while the path runs (`bSlow_Stop`).

use super::program::{Elements, Pen, planned, programs, run};
use crate::controller::{Interpolator, PlannedElement, ToolSetpoint};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::num::NonZeroU32;

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

fn run_and_stop(elements: Elements, after: usize) -> (Vec<ToolSetpoint>, f64, f64, bool) {
    let mut interpolator = run(elements);
    let mut setpoints: Vec<_> = interpolator.by_ref().take(after).map(Result::unwrap).collect();
    interpolator.request_stop();
    setpoints.extend(interpolator.by_ref().map(Result::unwrap));
    (setpoints, interpolator.path_length(), interpolator.duration(), interpolator.stopped_early())
}

/// 0.1 m/s, E−0.5 m/s²: 0.2 s and 10 mm, from the set-point after the request.
#[test]
fn brakes_with_the_programmed_deceleration() {
    let elements = Pen::new(0.1, 1.0, 0.5).line(0.1).take();
    let (setpoints, travelled, duration, early) = run_and_stop(elements, 300);
    assert!(early);
    // Set-point 300 is on the plan: 5 mm up to 0.1 s, then 0.1 m/s.
    let begin = setpoints[300];
    assert!(close(begin.position.x, 0.025, 1e-15));
    assert!(close(begin.path_velocity, 0.1, 1e-15));
    assert!(close(begin.acceleration.x, -0.5, 1e-15));
    assert!(close(setpoints[400].position.x, 0.025 + 0.0075, 1e-14));
    assert_eq!(setpoints.len(), 501);
    let last = setpoints[500];
    assert!(close(last.position.x, 0.035, 1e-14));
    assert_eq!((last.velocity, last.acceleration), (Vector3::zeros(), Vector3::zeros()));
    assert!(close(travelled, 0.035, 1e-14));
    assert!(close(duration, 0.5, 1e-12));
}

/// Half of the velocity's square is lost on the first element with 0.5 m/s², the rest on the second with 1 m/s².
#[test]
fn brakes_across_elements_with_the_deceleration_of_each() {
    let mut pen = Pen::new(0.1, 1.0, 0.5);
    pen.line(0.03);
    pen.deceleration = 1.0;
    pen.line(0.1);
    // At 0.3 s: 25 mm. 5 mm with 0.5 m/s² leave v² = 0.005; with 1 m/s² that takes 2.5 mm.
    let (setpoints, travelled, duration, early) = run_and_stop(pen.take(), 300);
    assert!(early);
    assert!(close(travelled, 0.0325, 1e-14));
    let half = 0.005_f64.sqrt();
    assert!(close(duration, 0.3 + (0.1 - half) / 0.5 + half, 1e-12));
    assert_eq!(setpoints.last().unwrap().place.line, 2);
}

#[test]
fn a_stop_before_the_start_stays_there() {
    let (setpoints, travelled, duration, early) =
        run_and_stop(Pen::new(0.1, 1.0, 0.5).line(0.1).take(), 0);
    assert!(early);
    assert_eq!(setpoints.len(), 1);
    assert_eq!(
        (setpoints[0].position, setpoints[0].acceleration),
        (Point3::origin(), Vector3::zeros())
    );
    assert_eq!((travelled, duration), (0.0, 0.0));
}

#[test]
fn a_stop_while_stopping_at_the_end_changes_nothing() {
    let elements = Pen::new(0.1, 1.0, 0.5).line(0.1).take();
    let undisturbed: Vec<_> = run(elements.clone()).map(Result::unwrap).collect();
    // The last 200 ms are the planned deceleration.
    for before_end in [150, 50, 1, 0] {
        let (setpoints, travelled, _, early) =
            run_and_stop(elements.clone(), undisturbed.len() - before_end);
        assert!(!early, "{before_end}");
        assert_eq!(setpoints.len(), undisturbed.len());
        assert_eq!(setpoints.last(), undisturbed.last());
        assert!(close(travelled, 0.1, 1e-15));
    }
}

#[test]
fn a_stop_while_stopping_at_a_corner_ends_there() {
    let elements =
        Pen::new(0.1, 1.0, 0.5).turn(0.3).line(0.07).line(0.03).turn(1.0).line(0.1).take();
    let corner = elements[1].as_ref().unwrap().end();
    // 0.1/0.1 + 0.05 + 0.1 s to the corner, the last 0.2 s of it braking. Wherever rounding puts what is left to
    // travel, the corner is neither missed nor turned.
    for after in 951..1150 {
        let (setpoints, travelled, duration, early) = run_and_stop(elements.clone(), after);
        assert!(early);
        assert!(close(duration, 1.15, 1e-9), "{duration} after {after}");
        let last = setpoints.last().unwrap();
        assert_eq!((last.position, last.place.line), (corner, 2), "after {after}");
        assert!(close(travelled, 0.1, 1e-15));
    }
}

#[test]
fn a_stop_before_a_jump_does_not_jump() {
    let mut pen = Pen::new(1.0, 2.0, 2.0);
    pen.line(0.005).jump([0.0, 0.1, 0.0]).line(0.005);
    // The jump begins at 100 ms; its end would be due at 101 ms.
    let (setpoints, ..) = run_and_stop(pen.elements.clone(), 100);
    assert_eq!(setpoints.len(), 101);
    assert_eq!(setpoints[100].position, Point3::new(0.005, 0.0, 0.0));
    let (setpoints, _, _, early) = run_and_stop(pen.take(), 101);
    assert_eq!(setpoints.len(), 102);
    assert_eq!(setpoints[101].position, Point3::new(0.005, 0.1, 0.0));
    assert!(early);
}

/// Planned velocity at path length `s` of the whole path, m/s: the largest where elements meet.
fn planned_velocity(plan: &[PlannedElement], s: f64) -> f64 {
    let mut from = 0.0;
    let mut largest: f64 = 0.0;
    for planned in plan {
        let element = planned.element();
        let length = element.path_length();
        let here = s - from;
        if element.has_path() && (-1e-12..=length + 1e-12).contains(&here) {
            let here = here.clamp(0.0, length);
            let up_v2 = planned.start_velocity().powi(2) + 2.0 * element.acceleration * here;
            let down_v2 =
                planned.end_velocity().powi(2) + 2.0 * element.deceleration * (length - here);
            largest = largest.max(up_v2.min(down_v2).sqrt().min(element.feed));
        }
        from += length;
    }
    largest
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn stops_come_to_rest_on_the_path_within_the_plan(elements in programs(), when in 0.0..1.1_f64) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        prop_assume!(!whole.is_empty());
        let plan: Vec<_> = planned(elements.clone()).map(Result::unwrap).collect();
        let undisturbed: Vec<_> = run(elements.clone()).map(Result::unwrap).collect();
        let cycle_ns = NonZeroU32::new(1_000_000).unwrap();
        let mut interpolator = Interpolator::new(planned(elements), cycle_ns);
        let after = (when * undisturbed.len() as f64) as usize;
        let before: Vec<_> = interpolator.by_ref().take(after).map(Result::unwrap).collect();
        prop_assert_eq!(&before[..], undisturbed.get(..after).unwrap_or(&undisturbed));
        interpolator.request_stop();
        let mut last = before.last().copied();
        let mut first = true;
        while let Some(setpoint) = interpolator.next() {
            let setpoint = setpoint.unwrap();
            let travelled = interpolator.path_length();
            let element = &whole[setpoint.place.line as usize - 1];
            let speed = setpoint.path_velocity;
            let allowed = planned_velocity(&plan, travelled);
            // Where the plan is about to stop, a rounding of the path length is a larger one of the velocity.
            let rounding = (2.0 * element.deceleration * 1e-14).sqrt() + 1e-9 * allowed;
            prop_assert!(speed <= allowed + rounding, "{} > {} after {} m", speed, allowed, travelled);
            if speed > 0.0 {
                let along = setpoint.acceleration.dot(&setpoint.velocity) / speed;
                prop_assert!(close(along, -element.deceleration, 1e-9 * setpoint.acceleration.norm()));
            }
            if let (Some(last), false) = (last, first) {
                prop_assert!(speed <= last.path_velocity);
            }
            first = false;
            last = Some(setpoint);
        }
        let last = last.unwrap();
        prop_assert_eq!((last.velocity, last.acceleration), (Vector3::zeros(), Vector3::zeros()));
        prop_assert_eq!(
            interpolator.stopped_early(),
            interpolator.elements_done() < whole.len() as u64
        );
        // On the path: as far along the element under way as the path length says.
        let done = interpolator.elements_done() as usize;
        let before: f64 = plan.iter().take(done).map(|planned| planned.element().path_length()).sum();
        let here = interpolator.path_length() - before;
        let expected = match whole.get(done) {
            Some(element) if here > 1e-12 => element.at(here).position,
            Some(element) => element.start(),
            None => whole[done - 1].end(),
        };
        prop_assert!((last.position - expected).norm() < 1e-11, "{} {}", last.position, expected);
    }
}
