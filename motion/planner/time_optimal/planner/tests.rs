//! Tests of plans against closed forms: fallback scaling, and a deceleration that is a limit of its own.

use crate::blended_path::BlendOptions;
use crate::time_optimal::smooth::Aim;
use crate::time_optimal::{
    AxisLimits, AxisPath, KinematicPath, Leg, LimitOptions, ParallelPlanner, Planned, Planner,
};
use nalgebra::Point3;
use std::f64::consts::{PI, TAU};
use twin_kinematics::AxisVector;
use twin_kinematics::gantry::Gantry2;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{Arc, ElementKind, PathElement, Place, Shape};

fn axes(limits: AxisLimits) -> KinematicPath<Gantry2> {
    let gantry = Gantry2::new([0.0; 2]).expect("a gantry");
    KinematicPath::new(gantry, vec![limits; 2], AxisVector::zeros(2))
}

/// A path, and the limits of both axes of the gantry that follows it.
struct Case {
    shapes: Vec<Shape>,
    limits: AxisLimits,
    /// Programmed velocity, m/s.
    feed: f64,
    /// Blend tolerance, m.
    tolerance: f64,
}

impl Case {
    /// With a feed that no axis reaches.
    fn fast(shapes: Vec<Shape>, limits: AxisLimits) -> Self {
        Self { shapes, limits, feed: 10.0, tolerance: 1e-4 }
    }

    /// The plan. Where Clarabel is to find nothing it is asked for more than there is.
    fn plan(self, solvable: bool) -> (Vec<Leg>, u64, u64) {
        let Self { shapes, limits, feed, tolerance } = self;
        let elements = shapes.into_iter().zip(1..).map(|(shape, line)| {
            let place = Place::at(line);
            let made = PathElement::new(place, ElementKind::Cut, shape);
            let (acceleration, deceleration) = (20.0, 20.0);
            Ok::<_, CheckError>(PathElement { feed, acceleration, deceleration, ..made })
        });
        let options = LimitOptions::new(BlendOptions::new(tolerance));
        let checked = CheckVelocities::new(elements, PI);
        let mut planner = Planner::new(checked, axes(limits), options);
        if !solvable {
            planner.smooth.aim = Aim::Slowest;
            planner.smooth.floors = vec![1e9; 100_000];
        }
        let legs = planner.by_ref().map(|planned| match planned {
            Ok(Planned::Leg(leg)) => leg,
            other => panic!("{other:?}"),
        });
        let legs = legs.collect();
        (legs, planner.effort().failed, planner.effort().windows)
    }

    fn solved(self) -> Vec<Leg> {
        let (legs, failed, _) = self.plan(true);
        assert_eq!(failed, 0);
        legs
    }
}

fn duration(legs: &[Leg]) -> f64 {
    legs.iter().map(|leg| leg.stretch.duration()).sum()
}

/// The largest acceleration and the largest deceleration of an axis, as parts of their limits.
fn largest(legs: &[Leg], limits: AxisLimits) -> [f64; 2] {
    let axes = axes(limits);
    let mut most = [0.0_f64; 2];
    for leg in legs {
        for part in 0..20_u8 {
            let u = leg.stretch.length() * (f64::from(part) + 0.5) / 20.0;
            let point = axes.axes(&leg.element, leg.from + u, &leg.start).expect("reached");
            let (b, a) = leg.stretch.at_position(u);
            for (first, second) in point.rates.first.iter().zip(point.rates.second.iter()) {
                let acceleration = first * a + second * b;
                let slows = first * acceleration < 0.0;
                let limit = if slows { limits.deceleration } else { limits.acceleration };
                let most = &mut most[usize::from(slows)];
                *most = most.max(acceleration.abs() / limit);
            }
        }
    }
    most
}

fn line(from: [f64; 2], to: [f64; 2]) -> Shape {
    let [start, end] = [from, to].map(|[x, y]| Point3::new(x, y, 0.0));
    Shape::Line { start, end }
}

const LIMITS: [[f64; 3]; 4] = [[0.4, 3.0, 1.0], [0.4, 1.0, 3.0], [0.2, 5.0, 0.5], [0.4, 2.0, 2.0]];

/// An arc of 1.6 m at 0.1 mm/s takes over four hours; its windows are as long as those of other paths.
#[test]
fn a_long_element_is_planned_window_by_window() {
    for jerk in [None, Some(20.0)] {
        let limits = AxisLimits { velocity: 0.4, acceleration: 2.0, deceleration: 2.0, jerk };
        let (start, center) = (Point3::origin(), Point3::new(0.25, 0.0, 0.0));
        let arc = Arc::new(start, start, center, TAU);
        let place = Place::at(1);
        let made = PathElement::new(place, ElementKind::Cut, Shape::Arc(arc));
        let element = PathElement { feed: 1e-4, acceleration: 20.0, deceleration: 20.0, ..made };
        let checked = CheckVelocities::new(std::iter::once(Ok::<_, CheckError>(element)), PI);
        let options = LimitOptions::new(BlendOptions::new(1e-4));
        let mut planner = Planner::new(checked, axes(limits), options);
        for _ in 0..5_000 {
            assert!(matches!(planner.next(), Some(Ok(Planned::Leg(_)))));
            let known = planner.cells.len() + planner.ready.len() + planner.tail.len();
            assert!(known < 10_000, "{known} cells, {jerk:?}");
        }
    }
}

/// On a circle that asks for little at its feed, a plan that no override changes takes the same time in a tenth of the legs, within
/// the same limits.
#[test]
fn slow_curves_have_long_legs() {
    for jerk in [None, Some(60.0)] {
        let limits = AxisLimits { velocity: 0.4, acceleration: 3.0, deceleration: 3.0, jerk };
        let circle = Arc::new(Point3::origin(), Point3::origin(), Point3::new(0.02, 0.0, 0.0), TAU);
        let place = Place::at(1);
        let made = PathElement::new(place, ElementKind::Cut, Shape::Arc(circle));
        let element = PathElement { feed: 0.02, acceleration: 20.0, deceleration: 20.0, ..made };
        let plan = |longest: f64| {
            let elements = std::iter::once(Ok::<_, CheckError>(element.clone()));
            let options = LimitOptions { longest, ..LimitOptions::new(BlendOptions::new(1e-4)) };
            let planner = Planner::new(CheckVelocities::new(elements, PI), axes(limits), options);
            let legs = planner.map(|planned| match planned {
                Ok(Planned::Leg(leg)) => leg,
                other => panic!("{other:?}"),
            });
            legs.collect::<Vec<_>>()
        };
        let [short, long] = [2.0, 32.0].map(plan);
        let longer = duration(&long) / duration(&short) - 1.0;
        assert!(longer.abs() < 1e-5, "{longer:e}");
        assert!(10 * long.len() < short.len(), "{} of {}", long.len(), short.len());
        let [speeds, slows] = largest(&long, limits);
        assert!(speeds.max(slows) <= 1.001, "{speeds}, {slows}");
    }
}

/// One axis over the stroke L with acceleration a, deceleration d and velocity v: L/v + v/2·(1/a + 1/d), or without
/// reaching v √(2L·(1/a + 1/d)).
#[test]
fn one_axis_takes_the_time_of_its_trapezoid() {
    for [velocity, acceleration, deceleration] in LIMITS {
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk: None };
        let ramps = 1.0 / acceleration + 1.0 / deceleration;
        for stroke in [0.4_f64, -0.4, 0.01, -0.01] {
            let length = stroke.abs();
            let reaches = 0.5 * velocity.powi(2) * ramps < length;
            let least = if reaches {
                length / velocity + 0.5 * velocity * ramps
            } else {
                (2.0 * length * ramps).sqrt()
            };
            let legs = Case::fast(vec![line([0.0; 2], [stroke, 0.0])], limits).solved();
            let longer = duration(&legs) / least - 1.0;
            assert!((-1e-6..1e-4).contains(&longer), "{limits:?}, {stroke} m: {longer:e}");
        }
    }
}

/// Lines that go on in the same direction take the time of one, wherever they meet, and their legs are on their own elements.
#[test]
fn lines_in_a_row_are_one_line() {
    for jerk in [None, Some(60.0)] {
        for feed in [0.3, 10.0] {
            let limits = AxisLimits { velocity: 0.4, acceleration: 3.0, deceleration: 1.5, jerk };
            let at = |way: f64| [0.8 * way, -0.6 * way];
            let case = |ways: &[f64]| {
                let shapes = ways.windows(2).map(|pair| line(at(pair[0]), at(pair[1]))).collect();
                Case { feed, ..Case::fast(shapes, limits) }.plan(true)
            };
            let (whole, _, _) = case(&[0.0, 0.5]);
            let ways = [0.0, 0.001, 0.02, 0.25, 0.3, 0.499, 0.5];
            let (legs, failed, windows) = case(&ways);
            assert_eq!((failed, windows), (0, 1), "in closed form");
            let longer = duration(&legs) / duration(&whole) - 1.0;
            assert!(longer.abs() < 1e-9, "{longer:e}");
            let mut last = (0.0, 0.0);
            for (index, pair) in ways.windows(2).enumerate() {
                let own =
                    |leg: &&Leg| leg.element.place().line == u32::try_from(index).unwrap() + 1;
                let legs: Vec<_> = legs.iter().filter(own).collect();
                let mut gone = 0.0;
                for leg in &legs {
                    assert!((leg.from - gone).abs() < 1e-9, "{} and not {gone}", leg.from);
                    let (b, a) = leg.stretch.at_position(0.0);
                    assert!((b.sqrt() - last.0).abs() < 1e-6, "{b} after {last:?}");
                    assert!(jerk.is_none() || (a - last.1).abs() < 1e-6, "{a} after {last:?}");
                    gone += leg.stretch.length();
                    let (b, a) = leg.stretch.at_position(leg.stretch.length());
                    last = (b.sqrt(), a);
                }
                assert!((gone - (pair[1] - pair[0])).abs() < 1e-9, "{gone} of {pair:?}");
            }
        }
    }
}

/// With limited jerk J the ramps to v take v/a + a/J and v/d + d/J.
#[test]
fn one_axis_with_limited_jerk_takes_the_time_of_its_two_ramps() {
    let (velocity, jerk) = (0.4, 60.0);
    for [acceleration, deceleration] in [[3.0, 1.5], [1.5, 3.0]] {
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk: Some(jerk) };
        let ramps = [acceleration, deceleration].map(|most| velocity / most + most / jerk);
        let least = 0.4 / velocity + 0.5 * (ramps[0] + ramps[1]);
        for stroke in [0.4, -0.4] {
            let legs = Case::fast(vec![line([0.0; 2], [stroke, 0.0])], limits).solved();
            let longer = duration(&legs) / least - 1.0;
            assert!((-1e-4..0.01).contains(&longer), "{limits:?}, {stroke} m: {longer:e}");
            let [speeds, slows] = largest(&legs, limits);
            assert!(speeds.max(slows) <= 1.001, "{speeds}, {slows}");
        }
    }
}

/// On a circle both axes turn round, twice each; in the zigzag at every corner.
#[test]
fn axes_that_turn_round_keep_both_limits() {
    let [start, end] =
        [0.0, -1e-3_f64].map(|angle| Point3::new(0.1 + 0.1 * angle.cos(), 0.1 * angle.sin(), 0.0));
    let circle = Shape::Arc(Arc::new(start, end, Point3::new(0.1, 0.0, 0.0), TAU - 1e-3));
    let corners: Vec<[f64; 2]> =
        (0..12_u8).map(|at| [0.02 * f64::from(at), 0.03 * f64::from(at % 2)]).collect();
    let zigzag: Vec<Shape> = corners.windows(2).map(|pair| line(pair[0], pair[1])).collect();
    for [velocity, acceleration, deceleration] in LIMITS {
        for jerk in [None, Some(60.0)] {
            let limits = AxisLimits { velocity, acceleration, deceleration, jerk };
            for shapes in [vec![circle.clone()], zigzag.clone()] {
                let legs = Case::fast(shapes.clone(), limits).solved();
                let [speeds, slows] = largest(&legs, limits);
                assert!(speeds.max(slows) <= 1.01, "{limits:?}: {speeds}, {slows}");
                assert!(speeds.max(slows) > 0.9, "{limits:?}: {speeds}, {slows}");
                // The limits of a machine without a deceleration of its own lie below and above.
                let [narrow, wide] =
                    [acceleration.min(deceleration), acceleration.max(deceleration)]
                        .map(|one| AxisLimits { acceleration: one, deceleration: one, ..limits })
                        .map(|limits| duration(&Case::fast(shapes.clone(), limits).solved()));
                let takes = duration(&legs);
                assert!(
                    takes <= 1.005 * narrow && takes >= 0.995 * wide,
                    "{wide}, {takes}, {narrow}"
                );
            }
        }
    }
}

/// The fallback scales a profile until it keeps both limits. A straight line has a closed form.
#[test]
fn without_clarabel_both_limits_are_kept() {
    for [acceleration, deceleration] in [[3.0, 1.0], [1.0, 3.0]] {
        let limits = AxisLimits { velocity: 0.4, acceleration, deceleration, jerk: Some(60.0) };
        let halves = [line([0.0; 2], [0.15, 0.05]), line([0.15, 0.05], [0.3, 0.11])];
        let (legs, failed, _) = Case::fast(halves.to_vec(), limits).plan(false);
        assert!(failed > 0);
        let [speeds, slows] = largest(&legs, limits);
        assert!(speeds.max(slows) <= 1.001, "{speeds}, {slows}");
    }
}

const SMOOTH: AxisLimits =
    AxisLimits { velocity: 0.4, acceleration: 3.0, deceleration: 3.0, jerk: Some(60.0) };

/// Along these points, m, rounded within a tolerance, m, with the feed 0.3 m/s.
fn planned(points: &[[f64; 2]], tolerance: f64, solvable: bool) -> (Vec<Leg>, u64, u64) {
    let shapes = points.windows(2).map(|pair| line(pair[0], pair[1])).collect();
    Case { shapes, limits: SMOOTH, feed: 0.3, tolerance }.plan(solvable)
}

/// All of the path, from rest to rest, with no step of u̇ or ü, and no axis beyond its limits.
fn check(legs: &[Leg], length: f64) {
    let axes = axes(SMOOTH);
    let gone: f64 = legs.iter().map(|leg| leg.stretch.length()).sum();
    assert!((gone - length).abs() <= 1e-9, "{gone} of {length}");
    let mut last = (0.0, 0.0);
    for leg in legs {
        let begins = leg.stretch.at_position(0.0);
        assert!((begins.0.sqrt() - last.0).abs() <= 1e-9, "{begins:?} after {last:?}");
        assert!((begins.1 - last.1).abs() <= 1e-6, "{begins:?} after {last:?}");
        let (b, a) = leg.stretch.at_position(leg.stretch.length());
        last = (b.sqrt(), a);
        // Between the ends, where the third derivative of the path has a step.
        for part in 0..10_u8 {
            let u = leg.stretch.length() * (f64::from(part) + 0.5) / 10.0;
            let point = axes.axes(&leg.element, leg.from + u, &leg.start).expect("reached");
            let (b, a) = leg.stretch.at_position(u);
            let (v, jerk) = (b.sqrt(), leg.stretch.jerk_at(u));
            let rates = &point.rates;
            let axes = rates.first.iter().zip(rates.second.iter()).zip(rates.third.iter());
            for ((first, second), third) in axes {
                assert!((first * v).abs() <= 1.001 * SMOOTH.velocity);
                assert!((first * a + second * b).abs() <= 1.001 * SMOOTH.acceleration);
                let jerk = first * jerk + 3.0 * second * a * v + third * b * v;
                assert!(jerk.abs() <= 1.05 * 60.0, "{jerk} in {leg:?}");
            }
        }
    }
    assert!(last.0 <= 1e-6, "{last:?}");
}

#[test]
fn without_clarabel_the_path_is_gone_within_the_limits() {
    let teeth: Vec<[f64; 2]> =
        (0..24_u8).map(|tooth| [0.01 * f64::from(tooth), 0.02 * f64::from(tooth % 2)]).collect();
    let tooth = vec![[0.0, 0.0], [0.01, 0.02], [0.02, 0.0]];
    for points in [tooth, teeth] {
        let length = points.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
        let (legs, failed, windows) = planned(&points, 1e-4, false);
        check(&legs, length);
        assert!(failed > 0 && failed == windows, "{failed} of {windows}");
        let (fastest, none, _) = planned(&points, 1e-4, true);
        check(&fastest, length);
        assert_eq!(none, 0);
        let longer = duration(&legs) / duration(&fastest);
        assert!((1.0..3.0).contains(&longer), "{longer}");
    }
}

/// One degree that is not rounded: an axis takes the step of its velocity within a cycle of 1 ms.
#[test]
fn kinks_are_passed_slowly_enough() {
    let turn = 1_f64.to_radians();
    let points = [[0.0, 0.0], [0.2, 0.0], [0.2 + 0.2 * turn.cos(), 0.2 * turn.sin()]];
    for solvable in [false, true] {
        let (legs, _, _) = planned(&points, 0.0, solvable);
        let pair = legs.windows(2).find(|pair| pair[0].element.place() != pair[1].element.place());
        let (b, _) = pair.expect("two lines")[1].stretch.at_position(0.0);
        let step = b.sqrt() * turn.sin();
        assert!(step <= 1.0001e-3 * SMOOTH.acceleration, "{step} m/s, solvable: {solvable}");
    }
}

/// Lines, arcs and pauses with and without stops between them: the plan is the same with any number of
/// cores, and as fast as that of one planner.
#[test]
fn any_number_of_workers_makes_the_same_plan() {
    let elements = || {
        let mut elements = Vec::new();
        let mut last = Point3::origin();
        for number in 0..120_u32 {
            let place = Place::at(number + 1);
            let angle = f64::from(number * number % 17);
            let next = last + nalgebra::Vector3::new(angle.cos(), angle.sin(), 0.0) * 0.02;
            let (kind, shape) = match number % 12 {
                7 => (
                    ElementKind::Dwell { time_ns: 5_000_000 },
                    Shape::Line { start: last, end: last },
                ),
                5 => {
                    let center = last + (next - last) * 0.5;
                    (ElementKind::Cut, Shape::Arc(Arc::new(last, next, center, PI)))
                }
                _ => (ElementKind::Cut, Shape::Line { start: last, end: next }),
            };
            last = if number % 12 == 7 { last } else { next };
            let (feed, acceleration, deceleration) = (0.3, 20.0, 20.0);
            let made = PathElement::new(place, kind, shape);
            elements.push(Ok::<_, CheckError>(PathElement {
                feed,
                acceleration,
                deceleration,
                ..made
            }));
        }
        elements.into_iter()
    };
    for jerk in [None, Some(20.0)] {
        let limits = AxisLimits { velocity: 0.4, acceleration: 2.0, deceleration: 2.0, jerk };
        let planner = || {
            let checked = CheckVelocities::new(elements(), 1.0);
            Planner::new(checked, axes(limits), LimitOptions::new(BlendOptions::new(1e-4)))
        };
        let of = |items: &mut dyn Iterator<Item = _>| -> Vec<(u32, f64, f64)> {
            let parts = items.map(|item| match item {
                Ok(Planned::Leg(leg)) => {
                    (leg.element.place().line, leg.from, leg.stretch.duration())
                }
                Ok(Planned::Pause(element)) => (element.place().line, 0.0, 0.0),
                other => panic!("{other:?}"),
            });
            parts.collect()
        };
        let alone = of(&mut planner());
        let plans = [1, 3].map(|count| {
            of(&mut ParallelPlanner::new(planner(), (0..count).map(|_| axes(limits))))
        });
        assert_eq!(plans[0], plans[1]);
        let pauses = |parts: &[(u32, f64, f64)]| parts.iter().filter(|part| part.2 == 0.0).count();
        assert_eq!((pauses(&alone), pauses(&plans[0])), (10, 10));
        let sum = |parts: &[(u32, f64, f64)]| parts.iter().map(|part| part.2).sum::<f64>();
        assert!((sum(&plans[0]) / sum(&alone) - 1.0).abs() < 1e-6, "{jerk:?}");
    }
}
