//! Tests of the interpolator.

use super::program::{Error, Pen, planned, programs, run, setpoints, smooth_programs};
use crate::controller::{DEFAULT_CYCLE_NS, Interpolator, ToolSetpoint};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::num::NonZeroU32;
use twin_path::{ElementKind, PathElement};

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

fn at_ms(setpoints: &[ToolSetpoint], ms: usize) -> ToolSetpoint {
    assert_eq!(setpoints[ms].time_ns, ms as i64 * 1_000_000);
    setpoints[ms]
}

fn is_at_rest(setpoint: &ToolSetpoint) -> bool {
    setpoint.velocity == Vector3::zeros()
        && setpoint.acceleration == Vector3::zeros()
        && setpoint.path_velocity == 0.0
}

/// Vector `ipo-trapezoid`, in one piece and in segments of 0.1 mm: the path is the same, so is the motion.
#[test]
fn ipo_trapezoid() {
    for pieces in [1, 1000] {
        let mut pen = Pen::new(0.02, 0.04, 0.08);
        for _ in 0..pieces {
            pen.line(0.1 / f64::from(pieces));
        }
        let mut interpolator = run(pen.take());
        let setpoints: Vec<_> = interpolator.by_ref().map(Result::unwrap).collect();
        assert_eq!(setpoints.len(), 5376);
        for (ms, x_mm) in [(0, 0.0), (250, 1.25), (1000, 15.0), (5250, 99.375), (5375, 100.0)] {
            let x = at_ms(&setpoints, ms).position.x;
            assert!(close(1e3 * x, x_mm, 1e-10), "{x} m after {ms} ms in {pieces} pieces");
        }
        assert!(close(at_ms(&setpoints, 250).path_velocity, 0.01, 1e-14));
        assert_eq!(at_ms(&setpoints, 250).acceleration, Vector3::new(0.04, 0.0, 0.0));
        assert_eq!(at_ms(&setpoints, 1000).velocity, Vector3::new(0.02, 0.0, 0.0));
        assert_eq!(at_ms(&setpoints, 1000).acceleration, Vector3::zeros());
        assert!(close(interpolator.duration(), 5.375, 1e-12));
        assert!(close(interpolator.path_length(), 0.1, 1e-13));
        assert_eq!(interpolator.elements_done(), u64::try_from(pieces).unwrap());
        assert!(!interpolator.stopped_early());
    }
}

/// Vector `ipo-triangle`: the end falls between two cycles.
#[test]
fn ipo_triangle() {
    let mut interpolator = run(Pen::new(0.02, 0.04, 0.08).line(0.005).take());
    let setpoints: Vec<_> = interpolator.by_ref().map(Result::unwrap).collect();
    assert!(close(interpolator.duration(), 0.612_372_436, 1e-8));
    let last = setpoints.last().unwrap();
    assert_eq!(last.time_ns, 613_000_000);
    assert_eq!(last.position, Point3::new(0.005, 0.0, 0.0));
    assert!(is_at_rest(last));
}

#[test]
fn the_first_setpoint_is_the_start_at_rest() {
    let setpoints = setpoints(Pen::new(0.02, 0.04, 0.08).line(0.01).take());
    assert_eq!(setpoints[0].time_ns, 0);
    assert_eq!(setpoints[0].position, Point3::origin());
    assert_eq!(setpoints[0].velocity, Vector3::zeros());
    assert_eq!(setpoints[0].path_velocity, 0.0);
}

#[test]
fn no_elements_no_setpoints() {
    let mut interpolator = run(Vec::new());
    assert!(interpolator.next().is_none());
    assert!(interpolator.next().is_none());
    assert_eq!(interpolator.duration(), 0.0);
}

/// A circle at constant velocity: velocity across the radius, acceleration v²/r to the centre.
#[test]
fn circles_accelerate_to_their_centre() {
    let (radius, feed) = (0.05, 0.1);
    let setpoints = setpoints(Pen::new(feed, 0.5, 0.5).arc(radius, TAU, 0.0).take());
    let center = Point3::new(0.0, radius, 0.0);
    for setpoint in &setpoints {
        let arm = setpoint.position - center;
        assert!(close(arm.norm(), radius, 1e-15));
        assert!(close(setpoint.velocity.dot(&arm), 0.0, 1e-15));
        assert!(close(setpoint.velocity.norm(), setpoint.path_velocity, 1e-15));
        let inward = -setpoint.acceleration.dot(&arm) / radius;
        assert!(close(inward, setpoint.path_velocity.powi(2) / radius, 1e-13));
    }
    assert!(setpoints.iter().any(|setpoint| setpoint.path_velocity == feed));
}

/// 10 µm segments at 100 mm/s: ten per cycle.
#[test]
fn several_elements_pass_in_one_cycle() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    for _ in 0..10_000 {
        pen.line(1e-5);
    }
    // L/F + F/2a + F/2d = 1.1 s.
    let setpoints = setpoints(pen.take());
    assert_eq!(setpoints.len(), 1101);
    let x = at_ms(&setpoints, 600).position.x;
    assert!(close(x, 0.005 + 0.05, 1e-13), "{x}");
    assert!(at_ms(&setpoints, 600).place.line.abs_diff(5501) <= 1);
}

/// The cycle samples the motion, it does not shape it.
#[test]
fn a_shorter_cycle_shows_the_same_motion() {
    let mut pen = Pen::new(0.1, 1.0, 0.7);
    pen.line(0.01).arc(0.02, 1.0, 0.001).feed(0.05).line(0.003).turn(1.0).line(0.007);
    let coarse = setpoints(pen.elements.clone());
    let cycle_ns = NonZeroU32::new(250_000).unwrap();
    let fine: Vec<_> =
        Interpolator::new(planned(pen.take()), cycle_ns).map(Result::unwrap).collect();
    for (n, setpoint) in coarse.iter().take(coarse.len() - 1).enumerate() {
        assert_eq!(setpoint, &fine[4 * n]);
    }
}

/// Manual 3.2: G92 while running is a jump of the set-point. Positions around it cycle by cycle.
#[test]
fn jumps_take_one_cycle() {
    // 0.1 s to the corner: two ramps of 2.5 mm.
    let mut pen = Pen::new(1.0, 2.0, 2.0);
    pen.line(0.005).jump([0.0, 0.1, 0.0]).line(0.005);
    let setpoints = setpoints(pen.take());
    let corner = at_ms(&setpoints, 100);
    assert_eq!((corner.position, corner.place.line), (Point3::new(0.005, 0.0, 0.0), 2));
    assert!(is_at_rest(&corner));
    // The next element starts from the end of the jump at this very cycle.
    let landed = at_ms(&setpoints, 101);
    assert_eq!((landed.position, landed.place.line), (Point3::new(0.005, 0.1, 0.0), 3));
    assert_eq!(landed.velocity, Vector3::zeros());
    let last = setpoints.last().unwrap();
    assert_eq!((last.time_ns, last.position), (201_000_000, Point3::new(0.01, 0.1, 0.0)));
}

/// Manual 3.2: a G1 without a path between two G92 gives the first of them a cycle of output.
#[test]
fn elements_without_a_path_take_one_cycle() {
    let mut pen = Pen::new(1.0, 2.0, 2.0);
    pen.jump([0.1, 0.0, 0.0]).line(0.0).jump([0.1, 0.0, 0.0]);
    let mut interpolator = run(pen.take());
    let setpoints: Vec<_> = interpolator.by_ref().map(Result::unwrap).collect();
    let shown: Vec<_> =
        setpoints.iter().map(|setpoint| (setpoint.position.x, setpoint.place.line)).collect();
    assert_eq!(shown, [(0.0, 1), (0.1, 2), (0.1, 3), (0.2, 3)]);
    assert!(setpoints.iter().all(is_at_rest));
    assert_eq!(interpolator.path_length(), 0.0);
    assert_eq!(interpolator.elements_done(), 3);
    assert!(close(interpolator.duration(), 0.003, 1e-15));
}

#[test]
fn what_has_no_path_waits_for_a_cycle() {
    // The triangle of the vector ends after 612.37 ms.
    let setpoints = setpoints(Pen::new(0.02, 0.04, 0.08).line(0.005).line(0.0).take());
    assert_eq!(setpoints.last().unwrap().time_ns, 614_000_000);
    assert_eq!(at_ms(&setpoints, 613).place.line, 2);
}

#[test]
fn rapids_are_told_apart() {
    let setpoints = setpoints(Pen::new(0.1, 1.0, 1.0).rapid(0.01).line(0.01).take());
    for setpoint in &setpoints {
        assert_eq!(setpoint.rapid, setpoint.place.line == 1);
        assert_eq!(setpoint.feed, 0.1);
    }
    assert!(setpoints[0].rapid && !setpoints.last().unwrap().rapid);
}

#[test]
fn an_error_comes_after_the_tool_has_stopped_and_ends_the_motion() {
    let mut results: Vec<_> =
        run(Pen::new(0.1, 1.0, 1.0).line(0.01).fail(3).line(0.01).take()).collect();
    assert_eq!(results.pop(), Some(Err(Error::Upstream(3))));
    let last = results.pop().unwrap().unwrap();
    assert_eq!(last.position, Point3::new(0.01, 0.0, 0.0));
    assert!(is_at_rest(&last));
    assert!(results.iter().all(Result::is_ok));

    let results: Vec<_> = run(Pen::new(0.1, 1.0, 1.0).fail(4).line(0.01).take()).collect();
    assert_eq!(results, [Err(Error::Upstream(4))]);
}

/// Durations that are not whole numbers of cycles do not drift: 20,000 half circles at constant velocity.
#[test]
fn time_does_not_drift() {
    let mut pen = Pen::new(0.1, 10.0, 10.0);
    for _ in 0..20_000 {
        pen.arc(0.001, PI, 0.0);
    }
    let mut interpolator = run(pen.take());
    assert!(interpolator.by_ref().all(|setpoint| setpoint.is_ok()));
    let length = 20_000.0 * PI * 0.001;
    assert!(close(interpolator.path_length(), length, 1e-12));
    assert!(close(interpolator.duration(), length / 0.1 + 0.1 / 10.0, 1e-9));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn setpoints_keep_the_limits(elements in programs()) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        let length: f64 =
            whole.iter().filter(|e| e.kind != ElementKind::Jump).map(PathElement::length).sum();
        let jumps = whole.iter().any(|e| e.kind == ElementKind::Jump);
        let rate = whole.iter().fold(0.0, |rate: f64, e| rate.max(e.acceleration).max(e.deceleration));
        let mut interpolator = run(elements);
        let dt = 1e-3;
        let mut last: Option<(ToolSetpoint, f64)> = None;
        let mut count = 0;
        while let Some(setpoint) = interpolator.next() {
            let setpoint = setpoint.unwrap();
            let element = &whole[setpoint.place.line as usize - 1];
            prop_assert_eq!(setpoint.time_ns, count * 1_000_000);
            prop_assert!(setpoint.path_velocity <= element.feed);
            let speed = setpoint.path_velocity;
            prop_assert!(close(setpoint.velocity.norm(), speed, 1e-12 * speed));
            if speed > 0.0 {
                let along = setpoint.acceleration.dot(&setpoint.velocity) / speed;
                let rounding = 1e-9 * setpoint.acceleration.norm();
                prop_assert!(along <= element.acceleration + rounding);
                prop_assert!(-along <= element.deceleration + rounding);
            }
            let travelled = interpolator.path_length();
            if let Some((last, travelled_before)) = last {
                // Path length is the integral of the velocity, and the chord is no longer than the path.
                let moved = travelled - travelled_before;
                let fastest = 0.5 * (last.path_velocity + speed) * dt + 0.25 * rate * dt * dt;
                prop_assert!(moved >= -1e-12 && moved <= fastest + 1e-12, "{moved} > {fastest}");
                prop_assert!((speed - last.path_velocity).abs() <= rate * dt * (1.0 + 1e-9));
                let chord = (setpoint.position - last.position).norm();
                prop_assert!(jumps || chord <= moved + 1e-12, "{chord} > {moved}");
            }
            last = Some((setpoint, travelled));
            count += 1;
        }
        if let Some((last, travelled)) = last {
            prop_assert!(is_at_rest(&last));
            prop_assert!((last.position - whole.last().unwrap().end()).norm() == 0.0);
            prop_assert!(close(travelled, length, 1e-12 * length));
            let late = 1e-9 * last.time_ns as f64 - interpolator.duration();
            prop_assert!((-1e-12..dt).contains(&late), "{late}");
        }
        prop_assert_eq!(interpolator.elements_done(), whole.len() as u64);
    }

    /// Velocity and acceleration are the derivatives of the positions, wherever nothing steps in between.
    #[test]
    fn derivatives_fit_the_positions(elements in smooth_programs()) {
        let cycle_ns = NonZeroU32::new(100_000).unwrap();
        let mut setpoints: Vec<_> =
            Interpolator::new(planned(elements), cycle_ns).take(20_000).map(Result::unwrap).collect();
        // It rests where the path ended within the cycle.
        setpoints.pop();
        let h = 1e-4;
        for three in setpoints.windows(3) {
            let [before, now, after] = [three[0], three[1], three[2]];
            let steady = before.place == after.place
                && (before.acceleration - now.acceleration).norm() < 0.02
                && (after.acceleration - now.acceleration).norm() < 0.02;
            if steady {
                let velocity = (after.position - before.position) / (2.0 * h);
                prop_assert!((velocity - now.velocity).norm() < 1e-5);
                let acceleration =
                    (after.position.coords - now.position.coords * 2.0 + before.position.coords) / (h * h);
                prop_assert!((acceleration - now.acceleration).norm() < 0.03);
            }
        }
    }

    #[test]
    fn the_same_program_gives_the_same_setpoints(elements in programs()) {
        prop_assert_eq!(setpoints(elements.clone()), setpoints(elements));
    }
}

#[test]
fn the_default_cycle_is_a_millisecond() {
    assert_eq!(DEFAULT_CYCLE_NS.get(), 1_000_000);
}
