//! Velocity profiles and the interpolators (manual 6.2.9, 6.6).

use super::program::{Fault, elements, stream};
use super::vector::{Vector, check};
use std::task::Poll;
use twin_path::PathElement;
use twin_path::prepare::CheckVelocities;
use twin_planner::controller::{
    DEFAULT_CYCLE_NS, Inputs, Interpolator, LookAhead, Profile, ToolSetpoint, VelocityMode,
    XDirection, XInterpolator,
};

/// The vector's line, under its limits.
fn line(vector: &Vector) -> Vec<PathElement> {
    let [length, feed, up, down] = ["L", "v", "acc", "dec"].map(|name| vector.number(name));
    elements(&[], &format!("G1 X{length} F{feed} E{up} E-{down}"))
}

/// Its profile as planned.
fn profile(vector: &Vector) -> Profile {
    let checked = CheckVelocities::new(stream(line(vector)), 0.0);
    let planned: Result<Vec<_>, Fault> = LookAhead::new(checked).collect();
    let planned = planned.expect("a plan");
    assert_eq!(planned.len(), 1);
    planned[0].profile()
}

/// Its set-points, one each millisecond, and the exact duration, s.
fn run(vector: &Vector, mode: VelocityMode) -> (Vec<ToolSetpoint>, f64) {
    let checked = CheckVelocities::new(stream(line(vector)), 0.0);
    let mut interpolator = Interpolator::new(LookAhead::new(checked), DEFAULT_CYCLE_NS);
    interpolator.set_inputs(Inputs { mode, ..Inputs::default() });
    let setpoints: Result<Vec<_>, Fault> = interpolator.by_ref().collect();
    (setpoints.expect("set-points"), interpolator.duration())
}

/// The set-point at a time of whole milliseconds.
fn at_ms(setpoints: &[ToolSetpoint], ms: i64) -> &ToolSetpoint {
    let found = setpoints.iter().find(|setpoint| setpoint.time_ns == ms * 1_000_000);
    found.expect("a set-point each millisecond")
}

#[test]
pub(crate) fn trapezoid() {
    check("ipo-trapezoid", |vector| {
        let [rise, cruise, fall] = profile(vector).phases();
        vector.expect("t_acc", [rise]);
        vector.expect("t_const", [cruise]);
        vector.expect("t_dec", [fall]);
        vector.expect("t_total", [profile(vector).duration()]);
        let (setpoints, duration) = run(vector, VelocityMode::Trapezoid);
        vector.expect("t_total", [duration]);
        for (name, ms) in [("s_at_0_25", 250), ("s_at_1", 1000), ("s_at_5_25", 5250)] {
            vector.expect(name, [at_ms(&setpoints, ms).position.x * 1e3]);
            vector.expect(name, [at_ms(&setpoints, ms).way * 1e3]);
        }
    });
}

#[test]
pub(crate) fn sigmoid() {
    check("ipo-sigmoid", |vector| {
        let (setpoints, duration) = run(vector, VelocityMode::Sigmoid);
        vector.expect("t_total", [duration]);
        for (name, ms) in [("s_at_0_25", 250), ("s_at_5_25", 5250)] {
            vector.expect(name, [at_ms(&setpoints, ms).position.x * 1e3]);
        }
        vector.expect("v_at_0_25", [at_ms(&setpoints, 250).path_velocity * 1e3]);
        let accelerations = setpoints.iter().map(|setpoint| setpoint.acceleration.x * 1e3);
        vector.expect("peak_acc", [accelerations.clone().fold(0.0, f64::max)]);
        vector.expect("peak_dec", [-accelerations.fold(0.0, f64::min)]);
    });
}

#[test]
pub(crate) fn triangle() {
    check("ipo-triangle", |vector| {
        vector.expect("v_peak", [profile(vector).peak_velocity() * 1e3]);
        for mode in [VelocityMode::Trapezoid, VelocityMode::Sigmoid] {
            vector.expect("t_total", [run(vector, mode).1]);
        }
    });
}

#[test]
pub(crate) fn by_position() {
    check("x-interpolator", |vector| {
        let path = elements(&[], &vector.program());
        let length = path.iter().map(PathElement::length).sum::<f64>();
        let mut interpolator =
            XInterpolator::new(stream(path), DEFAULT_CYCLE_NS, XDirection::Positive, 0.0);
        let workpieces = vector.numbers("X");
        let setpoints: Vec<_> = workpieces
            .iter()
            .map(|x| match interpolator.poll_cycle(x * 1e-3, false) {
                Poll::Ready(Some(Ok(setpoint))) => setpoint,
                other => panic!("{other:?}"),
            })
            .collect();
        for (x, setpoint) in workpieces.iter().zip(&setpoints) {
            assert!((setpoint.position.x * 1e3 - x).abs() < 1e-9);
        }
        vector.expect("Y", setpoints.iter().map(|setpoint| setpoint.position.y * 1e3));
        vector.expect("rel", setpoints.iter().map(|setpoint| setpoint.way / length));
    });
}
