//! Tests of profiles without steps of the acceleration.

use super::program::{Checked, Elements, Error, Pen, magnitude, planned, run, smooth_programs};
use crate::controller::{
    DEFAULT_CYCLE_NS, Inputs, Interpolator, LookAhead, ToolSetpoint, VelocityMode,
};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::num::NonZeroU32;

pub(super) const SIGMOID: VelocityMode = VelocityMode::Sigmoid;

pub(super) fn run_in(
    mode: VelocityMode,
    elements: Elements,
) -> Interpolator<LookAhead<Checked, Error>, Error> {
    let mut interpolator = run(elements);
    interpolator.set_inputs(Inputs { mode, ..Inputs::default() });
    interpolator
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

fn all(mode: VelocityMode, elements: Elements) -> (Vec<ToolSetpoint>, f64) {
    let mut interpolator = run_in(mode, elements);
    let setpoints = interpolator.by_ref().map(Result::unwrap).collect();
    (setpoints, interpolator.duration())
}

/// Vector `ipo-sigmoid`: as long as `ipo-trapezoid`, in one piece and in segments of 0.1 mm.
#[test]
fn ipo_sigmoid() {
    for pieces in [1, 1000] {
        let mut pen = Pen::new(0.02, 0.04, 0.08);
        for _ in 0..pieces {
            pen.line(0.1 / f64::from(pieces));
        }
        let (setpoints, duration) = all(SIGMOID, pen.take());
        assert!(close(duration, 5.375, 1e-10), "{duration}");
        assert_eq!(setpoints.len(), 5376);
        let x_mm = |ms: usize| 1e3 * setpoints[ms].position.x;
        assert!(close(x_mm(250), 0.908_450_569, 1e-8), "{}", x_mm(250));
        assert!(close(1e3 * setpoints[250].path_velocity, 10.0, 1e-9));
        assert!(close(x_mm(1000), 15.0, 1e-9));
        assert!(close(x_mm(5250), 99.545_774_715, 1e-8), "{}", x_mm(5250));
        assert!(close(x_mm(5375), 100.0, 1e-10));
        let accelerations = setpoints.iter().map(|setpoint| 1e3 * setpoint.acceleration.x);
        let most = accelerations.clone().fold(0.0, f64::max);
        let least = accelerations.fold(0.0, f64::min);
        assert!(close(most, 62.831_853_072, 1e-8), "{most}");
        assert!(close(least, -125.663_706_144, 1e-8), "{least}");
    }
}

/// `ipo-triangle` with sin² ramps: the same peak and duration.
#[test]
fn a_triangle_keeps_its_duration() {
    let (setpoints, duration) = all(SIGMOID, Pen::new(0.02, 0.04, 0.08).line(0.005).take());
    assert!(close(duration, 0.612_372_436, 1e-8), "{duration}");
    let peak = setpoints.iter().map(|setpoint| setpoint.path_velocity).fold(0.0, f64::max);
    assert!(close(1e3 * peak, 16.329_931_619, 1e-3), "{peak}");
}

/// 0.1 m/s with 1 m/s² and 20 m/s³: 0.05 s up to 1 m/s², 0.05 s at it, 0.05 s down; 7.5 mm per ramp.
#[test]
fn limited_jerk_by_hand() {
    let (setpoints, duration) =
        all(VelocityMode::JerkLimited { jerk: 20.0 }, Pen::new(0.1, 1.0, 1.0).line(0.1).take());
    assert!(close(duration, 2.0 * 0.15 + 0.085 / 0.1, 1e-9), "{duration}");
    assert!(close(setpoints[50].path_velocity, 0.5 * 20.0 * 0.05 * 0.05, 1e-12));
    assert!(close(setpoints[50].acceleration.x, 1.0, 1e-9));
    assert!(close(setpoints[75].path_velocity, 0.05, 1e-12));
    assert!(close(setpoints[150].position.x, 0.0075, 1e-12));
    assert!(close(setpoints[25].acceleration.x, 0.5, 1e-9));
    // What it can do without reaching 1 m/s²: four equal parts of 0.1 s, s = 2·j·t³.
    let (_, duration) = all(
        VelocityMode::JerkLimited { jerk: 2.0 },
        Pen::new(1.0, 1.0, 1.0).line(2.0 * 2.0 * 1e-3).take(),
    );
    assert!(close(duration, 0.4, 1e-9), "{duration}");
}

/// A feed that changes on the way: each ramp has its own peak, and the sum takes no longer than with trapezoids.
#[test]
fn ramps_between_feeds() {
    let mut pen = Pen::new(0.1, 1.0, 0.5);
    pen.line(0.05).feed(0.04).line(0.03).feed(0.2).line(0.2);
    let (_, trapezoid) = all(VelocityMode::Trapezoid, pen.elements.clone());
    let (setpoints, sigmoid) = all(SIGMOID, pen.take());
    assert!(close(trapezoid, sigmoid, 1e-9), "{trapezoid} {sigmoid}");
    let slow: Vec<_> = setpoints.iter().filter(|setpoint| setpoint.place.line == 2).collect();
    assert!(slow.iter().all(|setpoint| setpoint.path_velocity <= 0.04 * (1.0 + 1e-12)));
}

fn modes() -> impl Strategy<Value = VelocityMode> {
    prop_oneof![
        Just(SIGMOID),
        magnitude(-1.0..3.0).prop_map(|jerk| VelocityMode::JerkLimited { jerk })
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn sigmoids_take_as_long_as_trapezoids(elements in smooth_programs()) {
        let mut trapezoid = run(elements.clone());
        let mut sigmoid = run_in(SIGMOID, elements);
        prop_assert_eq!(trapezoid.by_ref().count() > 0, sigmoid.by_ref().count() > 0);
        prop_assert!(close(trapezoid.duration(), sigmoid.duration(), 1e-6 * trapezoid.duration() + 1e-9),
            "{} {}", trapezoid.duration(), sigmoid.duration());
    }

    /// Neither feed nor acceleration nor jerk are exceeded, and the acceleration does not step.
    #[test]
    fn smooth_profiles_keep_their_promises(elements in smooth_programs(), mode in modes()) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        let cycle_ns = NonZeroU32::new(200_000).unwrap();
        let mut interpolator = Interpolator::new(planned(elements), cycle_ns);
        interpolator.set_inputs(Inputs { mode, ..Inputs::default() });
        let (factor, dt) = (if mode == SIGMOID { PI / 2.0 } else { 1.0 }, 2e-4);
        let mut last: Option<(f64, f64, f64)> = None;
        for setpoint in interpolator.by_ref() {
            let setpoint = setpoint.unwrap();
            let element = &whole[setpoint.place.line as usize - 1];
            let speed = setpoint.path_velocity;
            prop_assert!(speed <= element.feed * (1.0 + 1e-8), "{speed} > {}", element.feed);
            let along = if speed > 0.0 {
                setpoint.acceleration.dot(&setpoint.velocity) / speed
            } else {
                0.0
            };
            let rounding = 1e-9 * setpoint.acceleration.norm() + 1e-6;
            prop_assert!(along <= element.acceleration * factor + rounding, "{along} {:?}", element.acceleration);
            prop_assert!(-along <= element.deceleration * factor + rounding, "{along} {:?}", element.deceleration);
            if let (Some((way, v, a)), VelocityMode::JerkLimited { jerk }) = (last, mode) {
                prop_assert!((along - a).abs() <= jerk * dt * 1.01 + rounding, "{a} to {along}, jerk {jerk}");
                let moved = setpoint.way - way - v * dt;
                prop_assert!(moved.abs() <= element.acceleration.max(element.deceleration).max(a.abs()) * dt * dt + 1e-9);
            }
            last = Some((setpoint.way, speed, along));
        }
        let length: f64 = whole.iter().map(twin_path::PathElement::length).sum();
        prop_assert!(close(interpolator.path_length(), length, 1e-11));
        prop_assert_eq!(interpolator.elements_done(), whole.len() as u64);
    }
}

#[test]
fn default_inputs_change_nothing() {
    let elements = Pen::new(0.1, 1.0, 0.5).line(0.01).arc(0.02, 1.0, 0.0).take();
    let plain: Vec<_> = run(elements.clone()).collect();
    let mut asked = run(elements);
    let inputs = Inputs::default();
    let mut n = 0;
    while let std::task::Poll::Ready(Some(setpoint)) = asked.poll_cycle(&inputs) {
        assert_eq!(Some(&setpoint), plain.get(n));
        n += 1;
    }
    assert_eq!(n, plain.len());
    assert_eq!(DEFAULT_CYCLE_NS.get(), 1_000_000);
}
