//! Tests of the heading in set-points.

use super::program::{Elements, Error, Pen, checked, curved_programs, run, setpoints};
use crate::controller::{
    DEFAULT_CYCLE_NS, Heading, Inputs, Interpolator, LookAhead, Source, Status, ToolSetpoint,
    TwoWayInterpolator, TwoWayPath, XDirection, XInterpolator,
};
use nalgebra::{Point3, Vector2};
use proptest::prelude::*;
use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::num::NonZeroUsize;
use std::task::Poll;
use twin_path::prepare::CheckedElement;
use twin_path::{Arc, ElementKind, PathElement, Plane, Shape};

const CYCLE: f64 = 1e-3;

#[track_caller]
fn assert_angle(found: f64, expected: f64) {
    let error = (found - expected + PI).rem_euclid(TAU) - PI;
    assert!(error.abs() < 1e-9, "{found}, expected {expected}");
}

#[track_caller]
fn assert_still(setpoint: &ToolSetpoint, along: f64) {
    assert_angle(setpoint.heading.along, along);
    assert_eq!(setpoint.heading, Heading { along: setpoint.heading.along, ..Heading::default() });
}

/// Acceleration along the path.
fn along(setpoint: &ToolSetpoint) -> f64 {
    setpoint.acceleration.dot(&setpoint.tangent())
}

/// r·θ̇ = v and r·θ̈ = a; on a helix the turn per length is φ/L.
#[test]
fn circles_turn_as_they_are_travelled() {
    for (radius, sweep, rise) in [(0.02, 1.8 * PI, 0.0), (0.05, -2.0, 0.0), (0.02, 3.0, 0.04)] {
        let turn = sweep / f64::hypot(radius * sweep, rise);
        let setpoints = setpoints(Pen::new(0.1, 1.0, 0.5).arc(radius, sweep, rise).take());
        let mut constant = 0;
        for setpoint in &setpoints {
            let Heading { along: angle, rate, acceleration } = setpoint.heading;
            assert!((-PI..=PI).contains(&angle));
            assert_angle(angle, turn * setpoint.way);
            assert!((rate - turn * setpoint.path_velocity).abs() < 1e-11, "{rate}");
            if setpoint.path_velocity > 0.0 {
                assert!((acceleration - turn * along(setpoint)).abs() < 1e-9, "{acceleration}");
            }
            constant += usize::from(setpoint.status == Status::Constant);
        }
        assert!(constant > 100);
        // At rest at the start: the acceleration is the one that begins there.
        assert!((setpoints[0].heading.acceleration - turn * 1.0).abs() < 1e-12);
        assert_still(setpoints.last().unwrap(), sweep);
    }
}

/// A line, an arc tangential to it, a corner; the last set-point is at rest on the last line.
#[test]
fn across_a_join_and_a_corner() {
    let mut pen = Pen::new(0.1, 2.0, 2.0);
    pen.turn(0.3).line(0.02).arc(0.02, FRAC_PI_2, 0.0).turn(2.0).line(0.02);
    let corner = 0.3 + FRAC_PI_2;
    let mut lines = [0; 3];
    for setpoint in setpoints(pen.take()) {
        let line = setpoint.place.line as usize;
        lines[line - 1] += 1;
        match line {
            1 => assert_still(&setpoint, 0.3),
            2 => {
                assert_angle(setpoint.heading.along, 0.3 + (setpoint.way - 0.02) / 0.02);
                assert!((setpoint.heading.rate - setpoint.path_velocity / 0.02).abs() < 1e-9);
            }
            _ => assert_still(&setpoint, corner + 2.0),
        }
    }
    assert!(lines.iter().all(|count| *count > 50), "{lines:?}");
}

/// Rate and acceleration are the derivatives over time: by central differences of eighth order of set-points that
/// belong to one element and one acceleration, on curves of every kind.
#[test]
fn rates_are_derivatives() {
    let mut pen = Pen::new(0.05, 0.3, 0.2);
    pen.ellipse(0.02, 0.01, 4.0).cubic(0.05, 1.2).arc(0.03, -4.0, 0.05).cubic(0.03, -0.7);
    let parabola = {
        use twin_path::Cubic;
        let (start, ahead) = (pen.at, Vector2::new(pen.heading.cos(), pen.heading.sin()));
        let control = start.xy() + ahead * 0.02;
        let end = control + Vector2::new(-ahead.y, ahead.x) * 0.03;
        let shape = Cubic::parabola(start, control, Point3::new(end.x, end.y, start.z + 0.01));
        PathElement {
            feed: 0.05,
            acceleration: 0.3,
            deceleration: 0.2,
            ..PathElement::new(
                twin_path::Place::at(5),
                ElementKind::Cut,
                Shape::Cubic(Box::new(shape)),
            )
        }
    };
    let mut elements = pen.take();
    elements.push(Ok(parabola));
    let setpoints = setpoints(elements);
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let mut seen = std::collections::BTreeMap::new();
    for window in setpoints.windows(9) {
        let here = &window[4];
        if window.iter().any(|other| (other.place, other.status) != (here.place, here.status)) {
            continue;
        }
        let turned = |other: &ToolSetpoint| {
            (other.heading.along - here.heading.along + PI).rem_euclid(TAU) - PI
        };
        let difference = |value: &dyn Fn(&ToolSetpoint) -> f64| {
            let pairs = weights.iter().zip(1..);
            let parts = pairs.map(|(weight, k)| {
                weight * (value(&window[4 + k]) - value(&window[4 - k])) / CYCLE
            });
            parts.sum::<f64>()
        };
        let rate = difference(&turned);
        let acceleration = difference(&|other| other.heading.rate);
        let Heading { rate: found, acceleration: second, .. } = here.heading;
        assert!((found - rate).abs() < 1e-8 * (1.0 + rate.abs()), "{found}, expected {rate}");
        let limit = 1e-8 * (1.0 + acceleration.abs());
        assert!((second - acceleration).abs() < limit, "{second}, expected {acceleration}");
        *seen.entry(here.place.line).or_insert(0) += 1;
    }
    assert!(seen.len() == 5 && seen.values().all(|count| *count > 100), "{seen:?}");
}

/// What has no direction of its own keeps the last; before the first it is that which will come.
#[test]
fn where_the_path_has_no_direction() {
    let mut pen = Pen::new(0.1, 2.0, 2.0);
    pen.dwell(5_000_000).m(3).lift(-0.01).jump([0.1, 0.2, 0.0]).line(0.0);
    pen.turn(0.7).line(0.02).lift(0.01).dwell(5_000_000).jump([0.0, -0.1, 0.0]).lift(-0.01);
    pen.turn(1.0).line(0.02).lift(0.02);
    let setpoints = {
        let mut path = run(pen.take());
        path.set_inputs(Inputs { acknowledge_m: true, ..Inputs::default() });
        path.map(Result::unwrap).collect::<Vec<_>>()
    };
    let mut seen = [false; 12];
    for setpoint in &setpoints {
        let line = setpoint.place.line as usize;
        seen[line - 1] = true;
        assert_still(setpoint, if line < 11 { 0.7 } else { 1.7 });
    }
    assert!(seen.iter().all(|seen| *seen), "{seen:?}");
}

/// A vertical arc that begins straight down: its direction is that which it will have.
#[test]
fn arcs_that_begin_straight_down() {
    let [start, end, center] =
        [[0.0, 0.0, 0.0], [0.04, 0.0, 0.0], [0.02, 0.0, 0.0]].map(Point3::from);
    let shape = Shape::Arc(Arc::in_plane(Plane::Zx, start, end, center, -PI));
    let mut pen = Pen::new(0.1, 2.0, 2.0);
    pen.turn(PI).line(1e-4);
    let mut elements = pen.take();
    let line = elements.remove(0).unwrap();
    elements.push(Ok(PathElement { shape, ..line }));
    for setpoint in setpoints(elements) {
        assert!(setpoint.velocity.x >= 0.0);
        assert_still(&setpoint, 0.0);
    }
}

#[test]
fn a_path_without_any_direction_has_the_heading_0() {
    for setpoint in run(Pen::new(0.1, 2.0, 2.0).lift(-0.01).m(1).lift(0.02).take()) {
        let setpoint = setpoint.unwrap();
        assert_eq!(setpoint.heading, Heading::default());
        if setpoint.m_function.is_some() {
            break;
        }
    }
}

/// Elements, and that there is nothing yet.
struct Drip(VecDeque<Option<CheckedElement>>);

impl Source for Drip {
    type Item = Result<CheckedElement, Error>;

    fn poll_next(&mut self) -> Poll<Option<Self::Item>> {
        match self.0.pop_front() {
            Some(Some(element)) => Poll::Ready(Some(Ok(element))),
            Some(None) => Poll::Pending,
            None => Poll::Ready(None),
        }
    }
}

/// What is not known at the start is looked for at rest only.
#[test]
fn no_turn_on_the_way_down() {
    let mut pen = Pen::new(0.1, 2.0, 2.0);
    pen.lift(-0.02).dwell(10_000_000).turn(2.0).line(0.02);
    let mut dripping: VecDeque<_> =
        checked(pen.take()).map(|element| Some(element.unwrap())).collect();
    for _ in 0..3 {
        dripping.insert(1, None);
    }
    let plan = LookAhead::new(Drip(dripping));
    let mut path = Interpolator::new(plan, DEFAULT_CYCLE_NS);
    let mut turned = None;
    for cycle in 0..100_000 {
        match path.poll_cycle(&Inputs::default()) {
            Poll::Ready(Some(setpoint)) => {
                let setpoint: ToolSetpoint = setpoint.unwrap();
                if turned.is_none() && setpoint.heading.along != 0.0 {
                    assert_eq!(setpoint.path_velocity, 0.0);
                    assert_eq!(setpoint.position.z, -0.02);
                    turned = Some(cycle);
                }
                assert_still(&setpoint, if turned.is_some() { 2.0 } else { 0.0 });
            }
            Poll::Pending => {}
            Poll::Ready(None) => break,
        }
    }
    assert!(turned.is_some());
}

fn both_ways(elements: Elements) -> TwoWayInterpolator {
    let capacity = NonZeroUsize::new(1000).unwrap();
    let path = TwoWayPath::new(elements.into_iter(), 0.1, capacity).unwrap();
    TwoWayInterpolator::new(path, DEFAULT_CYCLE_NS)
}

/// The knife does not turn round: at every place it has the direction that the path has as programmed, and turns the
/// other way while it travels the other way.
#[test]
fn backwards_it_is_the_programmed_direction() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.turn(0.5).line(0.04).arc(0.02, 2.0, 0.0).lift(0.01);
    let mut two_way = both_ways(pen.take());
    let mut rates = [0.0_f64; 2];
    let mut before: Option<f64> = None;
    for cycle in 0..3000 {
        let velocity = if (600..1000).contains(&cycle) || cycle > 1800 { -1.0 } else { 1.0 };
        let setpoint = two_way.cycle(&Inputs::default(), velocity).unwrap();
        let heading = setpoint.heading;
        assert!(before.is_none_or(|before| (heading.along - before).abs() < 0.02), "{cycle}");
        before = Some(heading.along);
        match setpoint.place.line {
            1 => assert_still(&setpoint, 0.5),
            2 => {
                // From the centre the tool is a quarter turn to the right of the path.
                let center = Vector2::new(0.5_f64.cos(), 0.5_f64.sin()) * 0.04
                    + Vector2::new(-0.5_f64.sin(), 0.5_f64.cos()) * 0.02;
                let from = setpoint.position.xy().coords - center;
                assert_angle(heading.along, from.y.atan2(from.x) + FRAC_PI_2);
                let speed = setpoint.path_velocity / 0.02;
                assert!((heading.rate.abs() - speed).abs() < 1e-9);
                rates = [rates[0].min(heading.rate), rates[1].max(heading.rate)];
            }
            _ => assert_still(&setpoint, 2.5),
        }
    }
    assert!((rates[0] + 5.0).abs() < 1e-9 && (rates[1] - 5.0).abs() < 1e-9, "{rates:?}");
}

/// A semicircle passed by a workpiece, and its way back.
#[test]
fn by_the_position_of_a_workpiece() {
    let points = [0.0, 0.1, 0.05].map(|x| Point3::new(x, 0.0, 0.0));
    let shape = Shape::Arc(Arc::new(points[0], points[1], points[2], -PI));
    let element = PathElement::new(twin_path::Place::default(), ElementKind::Cut, shape);
    for (direction, element) in
        [(XDirection::Positive, element.clone()), (XDirection::Negative, element.reversed())]
    {
        let positive = direction == XDirection::Positive;
        let elements: Elements = vec![Ok(element)];
        let mut path = XInterpolator::new(elements.into_iter(), DEFAULT_CYCLE_NS, direction, 0.0);
        for x in [0.02, 0.0201, 0.0202, 0.0201, 0.05, 0.09] {
            let x = if positive { x } else { 0.1 - x };
            let Poll::Ready(Some(Ok(setpoint))) = path.poll_cycle(x, false) else { panic!() };
            // The radius turned by a quarter, in the direction of the path.
            let angle = (1.0 - x / 0.05).clamp(-1.0, 1.0).asin();
            let (programmed, turn) = if positive { (angle, -1.0) } else { (angle + PI, 1.0) };
            assert_angle(setpoint.heading.along, programmed);
            let rate = turn * setpoint.path_velocity / 0.05;
            assert!((setpoint.heading.rate - rate).abs() < 1e-9 * (1.0 + rate.abs()));
        }
    }
}

/// Before the first direction it is that in which the workpiece passes.
#[test]
fn a_step_before_the_workpiece() {
    for (direction, angle) in [(XDirection::Positive, 0.0), (XDirection::Negative, PI)] {
        let elements = Pen::new(0.1, 1.0, 1.0).lift(0.1).turn(angle).line(0.1).take();
        let mut path = XInterpolator::new(elements.into_iter(), DEFAULT_CYCLE_NS, direction, 0.0);
        let way = angle.cos();
        for x in [-0.01, 0.0, 0.05, 0.09] {
            let Poll::Ready(Some(Ok(setpoint))) = path.poll_cycle(way * x, false) else { panic!() };
            assert_still(&setpoint, angle);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Where it moves, the heading is the direction of the velocity, and its rate the part of the acceleration across
    /// it: (v × a)/v² of the horizontal parts.
    #[test]
    fn it_is_that_of_the_velocity(elements in curved_programs()) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        let time: f64 = whole.iter().map(|element| element.length() / element.feed + 1.0).sum();
        prop_assume!(time < 120.0);
        for setpoint in run(elements) {
            let setpoint = setpoint.unwrap();
            let Heading { along, rate, acceleration } = setpoint.heading;
            prop_assert!((-PI..=PI).contains(&along) && rate.is_finite() && acceleration.is_finite());
            let (v, a) = (setpoint.velocity.xy(), setpoint.acceleration.xy());
            if v.norm() < 1e-6 {
                continue;
            }
            prop_assert!(v.normalize().dot(&Vector2::new(along.cos(), along.sin())) > 1.0 - 1e-9);
            let expected = v.perp(&a) / v.norm_squared();
            prop_assert!((rate - expected).abs() <= 1e-6 * (1.0 + expected.abs()), "{rate} {expected}");
        }
    }
}
