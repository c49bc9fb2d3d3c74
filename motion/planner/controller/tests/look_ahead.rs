//! Tests of the look-ahead against an infinite one.

use super::program::{
    Elements, Error, Pen, checked, planned, planned_within, programs, smooth_programs,
};
use crate::controller::{LookAhead, PlannedElement};
use proptest::prelude::*;
use std::cell::Cell;
use twin_path::prepare::CheckedElement;

/// The whole program at once: backward for stopping, forward for accelerating. End velocities, squared.
fn infinite_look_ahead(elements: &[CheckedElement]) -> Vec<f64> {
    let gain = |element: &CheckedElement, rate: f64| {
        if element.has_path() { 2.0 * rate * element.path_length() } else { 0.0 }
    };
    let mut end_v2: Vec<f64> =
        elements.iter().map(|element| element.end_velocity.powi(2)).collect();
    let mut next_v2 = 0.0;
    for (v2, next) in
        end_v2.iter_mut().rev().zip(std::iter::once(None).chain(elements.iter().rev().map(Some)))
    {
        let braking = next.map_or(0.0, |next| gain(next, next.deceleration));
        *v2 = v2.min(next_v2 + braking);
        next_v2 = *v2;
    }
    let mut start_v2 = 0.0;
    for (v2, element) in end_v2.iter_mut().zip(elements) {
        *v2 = v2.min(start_v2 + gain(element, element.acceleration));
        start_v2 = *v2;
    }
    end_v2
}

fn plan(elements: Elements) -> Vec<PlannedElement> {
    planned(elements).map(Result::unwrap).collect()
}

/// Transitions are the same on both sides and within the elements' accelerations.
fn assert_consistent(plan: &[PlannedElement]) {
    let mut velocity = 0.0;
    for planned in plan {
        let element = planned.element();
        let (start, end) = (planned.start_velocity(), planned.end_velocity());
        assert_eq!(start, velocity);
        assert!(end <= element.end_velocity);
        let (start_v2, end_v2) = (start * start, end * end);
        let rounding = 1e-14 * start_v2.max(end_v2);
        let reach = 2.0 * element.path_length();
        assert!(end_v2 - start_v2 <= element.acceleration * reach + rounding, "{planned:?}");
        assert!(start_v2 - end_v2 <= element.deceleration * reach + rounding, "{planned:?}");
        velocity = end;
    }
    assert_eq!(velocity, 0.0);
}

proptest! {
    #[test]
    fn equals_infinite_look_ahead(elements in programs()) {
        let whole: Vec<_> = checked(elements.clone()).map(Result::unwrap).collect();
        let expected = infinite_look_ahead(&whole);
        let plan = plan(elements);
        prop_assert_eq!(plan.len(), expected.len());
        for (planned, expected_v2) in plan.iter().zip(expected) {
            let found_v2 = planned.end_velocity() * planned.end_velocity();
            prop_assert!((found_v2 - expected_v2).abs() <= 1e-13 * expected_v2, "{found_v2} {expected_v2}");
        }
        assert_consistent(&plan);
    }

    /// A full window is safe: from every transition the path can stop on what the window held.
    #[test]
    fn a_full_window_can_always_stop(elements in smooth_programs(), window in 1_usize..12) {
        let plan: Vec<_> = planned_within(elements.clone(), window).map(Result::unwrap).collect();
        assert_consistent(&plan);
        let infinite = self::plan(elements);
        prop_assert_eq!(plan.len(), infinite.len());
        for (n, (planned, best)) in plan.iter().zip(&infinite).enumerate() {
            prop_assert!(planned.end_velocity() <= best.end_velocity() * (1.0 + 1e-13));
            let known = plan.iter().skip(n + 1).take(window - 1).map(PlannedElement::element);
            let stop_v2: f64 = known.map(|next| 2.0 * next.deceleration * next.path_length()).sum();
            prop_assert!(planned.end_velocity().powi(2) <= stop_v2 * (1.0 + 1e-13));
        }
    }

    /// What is handed out before the source is asked for more does not depend on what would come: here a stop where
    /// the program went on.
    #[test]
    fn what_is_handed_out_is_final(elements in smooth_programs(), cut in 0.0..1.0_f64) {
        let whole = plan(elements.clone());
        let known = (cut * whole.len() as f64) as usize;
        let pulled = Cell::new(0);
        let source = checked(elements).take(known).chain(std::iter::once(Err(Error::Upstream(1))));
        let source = source.inspect(|_| pulled.set(pulled.get() + 1));
        for (planned, expected) in LookAhead::new(source).zip(&whole) {
            if pulled.get() > known { break }
            prop_assert_eq!(&planned.unwrap(), expected);
        }
    }
}

/// Uniform acceleration: v² = 2·a·s on the way up, 2·d·(L − s) on the way down, F between.
#[test]
fn segments_of_a_line_follow_the_law_of_the_whole() {
    let mut pen = Pen::new(0.02, 0.04, 0.08);
    for _ in 0..1000 {
        pen.line(1e-4);
    }
    for (n, planned) in plan(pen.take()).iter().enumerate() {
        let s = (n + 1) as f64 * 1e-4;
        let expected_v2 = (2.0 * 0.04 * s).min((2.0 * 0.08 * (0.1 - s)).max(0.0)).min(0.02 * 0.02);
        let found_v2 = planned.end_velocity().powi(2);
        assert!(
            (found_v2 - expected_v2).abs() < 1e-16,
            "{found_v2} instead of {expected_v2} after {s} m"
        );
    }
}

/// Elements taken from upstream and not yet handed out, at most.
fn largest_backlog(elements: Elements) -> usize {
    let backlog = Cell::new(0_usize);
    let upstream = checked(elements).inspect(|_| backlog.set(backlog.get() + 1));
    let mut largest = 0;
    for planned in LookAhead::new(upstream) {
        planned.unwrap();
        largest = largest.max(backlog.get());
        backlog.set(backlog.get() - 1);
    }
    largest
}

#[test]
fn the_window_grows_no_further_than_a_stop_needs() {
    // 0.1 m/s with 1 m/s²: 5 mm to stop, that is 50 segments of 0.1 mm and the front.
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    for _ in 0..10_000 {
        pen.line(1e-4);
    }
    let backlog = largest_backlog(pen.take());
    assert!((50..=52).contains(&backlog), "{backlog}");

    // A corner in every tenth place: nothing beyond it matters.
    for n in 0..10_000 {
        pen.line(1e-4).turn(if n % 10 == 9 { 1.0 } else { 0.0 });
    }
    let backlog = largest_backlog(pen.take());
    assert!(backlog <= 10, "{backlog}");
}

#[test]
fn the_window_is_a_bound() {
    let mut pen = Pen::new(10.0, 1.0, 1.0);
    for _ in 0..20_000 {
        pen.line(1e-4);
    }
    assert_eq!(largest_backlog(pen.take()), 4096);
}

/// With a full window the velocity stays where the window can stop from, and does not saw.
#[test]
fn a_full_window_goes_at_a_steady_velocity() {
    let mut pen = Pen::new(1.0, 1.0, 1.0);
    for _ in 0..1000 {
        pen.line(1e-3);
    }
    // Behind the front there are 99 mm.
    let steady = (2.0 * 1.0 * 0.099_f64).sqrt();
    let plan: Vec<_> = planned_within(pen.take(), 100).map(Result::unwrap).collect();
    for planned in plan.iter().take(890).skip(110) {
        assert!((planned.end_velocity() - steady).abs() < 1e-12, "{planned:?}");
    }
}

#[test]
fn errors_come_after_a_stop_and_before_a_start() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.line(0.01).line(0.01).fail(7).line(0.01).line(0.01);
    let results: Vec<_> = planned(pen.take()).collect();
    let ends: Vec<_> =
        results.iter().map(|result| result.as_ref().map(PlannedElement::end_velocity)).collect();
    assert_eq!(ends[1], Ok(0.0));
    assert_eq!(ends[2], Err(&Error::Upstream(7)));
    assert_eq!(results[3].as_ref().map(PlannedElement::start_velocity), Ok(0.0));
    assert_eq!(ends[4], Ok(0.0));
    assert!(ends[0].unwrap() > 0.0 && ends[3].unwrap() > 0.0);
}
