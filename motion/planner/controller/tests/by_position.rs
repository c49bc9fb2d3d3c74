//! Tests of interpolation by a measured position.

use super::program::{Error, Pen};
use crate::controller::{
    DEFAULT_CYCLE_NS, Status, ToolSetpoint, XAmbiguity, XDirection, XInterpolator,
};
use nalgebra::Point3;
use proptest::prelude::*;
use std::f64::consts::PI;
use std::task::Poll;
use twin_path::Place;
use twin_path::{Arc, Cubic, ElementKind, PathElement, Shape};

type Elements = Vec<Result<PathElement, Error>>;

fn at(
    interpolator: &mut XInterpolator<std::vec::IntoIter<Result<PathElement, Error>>>,
    x: f64,
) -> ToolSetpoint {
    let Poll::Ready(Some(Ok(setpoint))) = interpolator.poll_cycle(x, false) else { panic!() };
    setpoint
}

fn following(
    elements: Elements,
    direction: XDirection,
    offset: f64,
) -> XInterpolator<std::vec::IntoIter<Result<PathElement, Error>>> {
    XInterpolator::new(elements.into_iter(), DEFAULT_CYCLE_NS, direction, offset)
}

/// G2 from 0/0 to 100/0 about 50/0.
fn semicircle() -> PathElement {
    let points = [0.0, 0.1, 0.05].map(|x| Point3::new(x, 0.0, 0.0));
    let arc = Arc::new(points[0], points[1], points[2], -PI);
    PathElement::new(Place::default(), ElementKind::Cut, Shape::Arc(arc))
}

/// Vector `x-interpolator`.
#[test]
fn x_interpolator() {
    for offset in [0.0, 0.3] {
        let mut interpolator = following(vec![Ok(semicircle())], XDirection::Positive, offset);
        for (x_mm, part) in [(20.0, 0.295_167_235), (80.0, 0.704_832_765)] {
            let setpoint = at(&mut interpolator, 1e-3 * x_mm + offset);
            assert!((1e3 * setpoint.position.x - x_mm).abs() < 1e-9);
            assert!((1e3 * setpoint.position.y - 40.0).abs() < 1e-8, "{}", setpoint.position);
            assert!((setpoint.way / (0.05 * PI) - part).abs() < 1e-8, "{}", setpoint.way);
        }
        let last = at(&mut interpolator, 0.1 + offset);
        assert_eq!((last.position.x, last.status), (0.1, Status::Finished));
        assert!(matches!(interpolator.poll_cycle(0.2, false), Poll::Ready(None)));
    }
}

/// In the other direction the same path backwards.
#[test]
fn workpieces_may_come_from_the_other_side() {
    let mut interpolator = following(vec![Ok(semicircle().reversed())], XDirection::Negative, 0.0);
    assert_eq!(at(&mut interpolator, 0.2).position.x, 0.1);
    assert!((1e3 * at(&mut interpolator, 0.08).position.y - 40.0).abs() < 1e-8);
    assert!((1e3 * at(&mut interpolator, 0.02).position.y - 40.0).abs() < 1e-8);
    assert_eq!(at(&mut interpolator, -0.1).status, Status::Finished);
}

/// The workpiece at 0.1 m/s along a path of lines: the tool's velocity in X is the workpiece's.
#[test]
fn velocities_are_the_workpieces() {
    let mut pen = Pen::new(1.0, 1.0, 1.0);
    pen.turn(0.5).line(0.02).switch(2, true, 0.5).turn(-1.0).line(0.02).switch(2, false, 0.5);
    let mut interpolator = following(pen.take(), XDirection::Positive, 0.0);
    let mut switched = Vec::new();
    for n in 0..300 {
        let setpoint = at(&mut interpolator, 1e-4 * f64::from(n));
        assert!((setpoint.position.x - 1e-4 * f64::from(n)).abs() < 1e-15);
        if n > 0 && n % 170 != 0 && !(174..=178).contains(&n) {
            assert!((setpoint.velocity.x - 0.1).abs() < 1e-9, "{n}: {}", setpoint.velocity);
        }
        switched.push(setpoint.switches);
    }
    // 20 mm at 0.5 rad are 17.55 mm in X.
    assert_eq!((switched[87], switched[88]), (0, 2));
    assert_eq!((switched[263], switched[264]), (2, 0));
}

#[test]
fn an_abort_ends_it() {
    let mut interpolator = following(vec![Ok(semicircle())], XDirection::Positive, 0.0);
    at(&mut interpolator, 0.02);
    let Poll::Ready(Some(Ok(last))) = interpolator.poll_cycle(0.03, true) else { panic!() };
    assert_eq!(last.status, Status::Finished);
    assert!(matches!(interpolator.poll_cycle(0.04, false), Poll::Ready(None)));
}

proptest! {
    /// Whatever steps the workpiece makes, the set-point is where the path has its X.
    #[test]
    fn x_is_met(lines in prop::collection::vec((-1.4..1.4_f64, 1e-3..0.02_f64), 1..20), steps in prop::collection::vec(0.0..0.02_f64, 1..40)) {
        let mut pen = Pen::new(1.0, 1.0, 1.0);
        for (heading, length) in lines {
            pen.heading = heading;
            pen.line(length);
        }
        let end = pen.at.x;
        let mut interpolator = following(pen.take(), XDirection::Positive, 0.0);
        let (mut x, mut way) = (0.0, 0.0);
        for step in steps {
            x += step;
            let setpoint = at(&mut interpolator, x);
            prop_assert!((setpoint.position.x - x.min(end)).abs() < 1e-12);
            prop_assert!(setpoint.way >= way);
            way = setpoint.way;
            if x >= end {
                prop_assert_eq!(setpoint.status, Status::Finished);
                break;
            }
        }
    }
}

/// "Every X position must have exactly one position on the path" (manual 6.6).
#[test]
fn ambiguous_elements() {
    let line = |from: [f64; 2], to: [f64; 2]| {
        let at = |[x, y]: [f64; 2]| Point3::new(x, y, 0.0) * 1e-3;
        let shape = Shape::Line { start: at(from), end: at(to) };
        PathElement::new(Place::default(), ElementKind::Cut, shape)
    };
    let forwards = |element: &PathElement| XAmbiguity::of(element, XDirection::Positive);
    let backwards = |element: &PathElement| XAmbiguity::of(element, XDirection::Negative);
    let near = |found: Option<XAmbiguity>, expected: XAmbiguity| match (found, expected) {
        (Some(XAmbiguity::Back(a)), XAmbiguity::Back(b))
        | (Some(XAmbiguity::Step(a)), XAmbiguity::Step(b))
        | (Some(XAmbiguity::Jump(a)), XAmbiguity::Jump(b)) => (a - b).abs() < 1e-9,
        _ => false,
    };
    let slope = line([0.0, 0.0], [10.0, 5.0]);
    assert_eq!(forwards(&slope), None);
    assert!(near(backwards(&slope), XAmbiguity::Back(0.01)));
    let step = line([10.0, 0.0], [10.0, 5.0]);
    assert!(near(forwards(&step), XAmbiguity::Step(0.005)));
    assert!(near(backwards(&step), XAmbiguity::Step(0.005)));
    assert_eq!(forwards(&line([10.0, 0.0], [10.0, 0.0])), None);
    // The semicircle has one point for each X; three quarters of it go 50 mm beyond their end and come back.
    assert_eq!(forwards(&semicircle()), None);
    let points = [[0.0, 0.0], [50.0, -50.0], [50.0, 0.0]];
    let [start, end, center] = points.map(|[x, y]| Point3::new(x, y, 0.0) * 1e-3);
    let arc = Shape::Arc(Arc::new(start, end, center, -1.5 * PI));
    let arc = PathElement::new(Place::default(), ElementKind::Cut, arc);
    assert!(near(forwards(&arc), XAmbiguity::Back(0.05)), "{:?}", forwards(&arc));
    // x = t(1 − t)(1 − 2t)·k + t: it turns twice between its ends.
    let spline = |swing: f64| {
        let coefficients = [0.0, 1.0 + swing, -3.0 * swing, 2.0 * swing];
        let x = coefficients.map(|value| value * 0.1);
        let cubic = Cubic::new(x, [0.0, 0.1, 0.0, 0.0], 0.0, 0.0);
        PathElement::new(Place::default(), ElementKind::Cut, Shape::Cubic(Box::new(cubic)))
    };
    assert_eq!(forwards(&spline(1.0)), None);
    assert!(matches!(forwards(&spline(6.0)), Some(XAmbiguity::Back(_))));
    let mut jump = line([10.0, 0.0], [30.0, 0.0]);
    jump.kind = ElementKind::Jump;
    assert!(near(forwards(&jump), XAmbiguity::Jump(0.02)));
}
