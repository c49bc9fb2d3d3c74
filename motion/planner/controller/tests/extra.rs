//! Tests of extra axes and Z with the S profile, over time.

use super::modes::{SIGMOID, run_in};
use super::program::{Elements, Pen, planned, run};
use crate::controller::{Inputs, Interpolator, ToolSetpoint};
use nalgebra::Vector3;
use std::num::NonZeroU32;
use twin_path::{AxisMask, ExtraAxes};

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// 100 mm with 0.1 m/s and 1 m/s² while P goes from 0 to 40, then it stays; 5 mm per ramp.
fn with_p(s_profile: AxisMask) -> Elements {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.line(0.1);
    let details = pen.details();
    details.extra = Some(ExtraAxes { start: [0.0; 5], end: [40.0, 0.0, 0.0, 0.0, 0.0] });
    details.s_profile = s_profile;
    pen.dwell(5_000_000).details().extra =
        Some(ExtraAxes { start: [40.0, 0.0, 0.0, 0.0, 0.0], end: [40.0, 0.0, 0.0, 0.0, 0.0] });
    pen.take()
}

fn setpoints(elements: Elements) -> Vec<ToolSetpoint> {
    run(elements).map(Result::unwrap).collect()
}

/// 0.1 s and 5 mm of ramp, then 0.1 m/s: 25 mm are reached at 0.3 s.
#[test]
fn extra_axes_follow_the_path_length() {
    let setpoints = setpoints(with_p(AxisMask::default()));
    let [at, ramp] = [setpoints[300].extra, setpoints[50].extra];
    assert!(close(at.position[0], 10.0, 1e-10));
    // 400 u/m.
    assert!(close(at.velocity[0], 40.0, 1e-10) && close(at.acceleration[0], 0.0, 1e-10));
    assert!(close(ramp.velocity[0], 20.0, 1e-10) && close(ramp.acceleration[0], 400.0, 1e-9));
    assert_eq!(setpoints.last().unwrap().extra.position, [40.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(setpoints.last().unwrap().extra.velocity, [0.0; 5]);
}

/// Vector `cnc-S-profile`: s = 25 mm and 50 mm.
#[test]
fn extra_axes_with_the_s_profile() {
    let setpoints = setpoints(with_p(AxisMask::extra(0)));
    assert!(close(setpoints[300].extra.position[0], 4.140_625, 1e-9));
    assert!(close(setpoints[550].extra.position[0], 20.0, 1e-9));
    // 30·w²(1 − w)²·40 u/0.1 m at w = ½, times 0.1 m/s.
    assert!(close(setpoints[550].extra.velocity[0], 30.0 / 16.0 * 40.0, 1e-9));
}

/// Velocity and acceleration of Z and extra axes are the derivatives of their positions.
#[test]
fn derivatives_over_time() {
    let mut elements = with_p(AxisMask::extra(0).with(AxisMask::Z));
    let element = elements[0].as_mut().unwrap();
    let (start, mut end) = (element.start(), element.end());
    end.z = 0.03;
    element.shape = twin_path::Shape::Line { start, end };
    elements.truncate(1);
    let cycle_ns = NonZeroU32::new(100_000).unwrap();
    let mut interpolator = Interpolator::new(planned(elements), cycle_ns);
    interpolator.set_inputs(Inputs { mode: SIGMOID, ..Inputs::default() });
    let setpoints: Vec<_> = interpolator.map(Result::unwrap).collect();
    let h = 1e-4;
    for three in setpoints[..setpoints.len() - 2].windows(3) {
        let p = [0, 1, 2].map(|n: usize| three[n].extra.position[0]);
        let now = three[1];
        assert!(close((p[2] - p[0]) / (2.0 * h), now.extra.velocity[0], 1e-3));
        assert!(close((p[2] - 2.0 * p[1] + p[0]) / (h * h), now.extra.acceleration[0], 0.5));
        let z = [0, 1, 2].map(|n: usize| three[n].position.z);
        assert!(close((z[2] - z[0]) / (2.0 * h), now.velocity.z, 1e-6));
        assert!(close((z[2] - 2.0 * z[1] + z[0]) / (h * h), now.acceleration.z, 1e-3));
    }
}

/// Where only extra axes move, F is u/s for them and the tool stays.
#[test]
fn extra_axes_alone() {
    let mut pen = Pen::new(0.01, 0.1, 0.1);
    pen.line(0.01).line(0.0);
    pen.details().extra = Some(ExtraAxes { start: [0.0; 5], end: [0.0, 0.0, 90.0, 0.0, 0.0] });
    let mut interpolator = run_in(crate::controller::VelocityMode::Trapezoid, pen.take());
    let setpoints: Vec<_> = interpolator.by_ref().map(Result::unwrap).collect();
    // 1 s and 0.1 s; 9 s and 0.1 s.
    assert!(close(interpolator.duration(), 1.1 + 9.1, 1e-9), "{}", interpolator.duration());
    let turning = setpoints[5000];
    assert!(close(turning.extra.velocity[2], 10.0, 1e-9));
    assert_eq!((turning.position.x, turning.velocity), (0.01, Vector3::zeros()));
    assert!(close(setpoints.last().unwrap().extra.position[2], 90.0, 0.0));
}

#[test]
fn what_has_no_path_holds_the_extra_axes() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    for _ in 0..2 {
        pen.m(1).details().extra = Some(ExtraAxes { start: [1.0; 5], end: [1.0; 5] });
    }
    pen.jump([0.1, 0.0, 0.0]).details().extra = Some(ExtraAxes { start: [1.0; 5], end: [2.0; 5] });
    let positions: Vec<_> =
        setpoints(pen.take()).iter().map(|setpoint| setpoint.extra.position[4]).collect();
    assert_eq!(positions, [1.0, 1.0, 1.0, 2.0]);
}
