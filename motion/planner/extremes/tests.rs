//! Tests of planned motions: extremes against many samples, and closed forms.

use super::{AxisExtremes, Examiner, Extremes, Floor};
use crate::blended_path::{BlendOptions, BlendedElement, BlendedPath};
use crate::planned_motion::{Law, Piece};
use crate::time_optimal::{AxisPath, KinematicPath};
use nalgebra::Point3;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use twin_kinematics::gantry::{BeltLayout, Gantry3, GantryH2};
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::tripod::{Tripod, TripodDimensions};
use twin_kinematics::{AxisVector, Kinematics};
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{Arc, Cubic, ElementKind, PathElement, Place, Shape};

fn element(shape: Shape) -> BlendedElement {
    let mut element = PathElement::new(Place::default(), ElementKind::Cut, shape);
    (element.feed, element.acceleration, element.deceleration) = (1.0, 1.0, 1.0);
    let upstream = std::iter::once(Ok::<_, CheckError>(element));
    let checked = CheckVelocities::new(upstream, 0.1);
    let mut path = BlendedPath::new(checked, BlendOptions::new(1e-6));
    path.next().unwrap().unwrap()
}

fn axes<K: Kinematics>(kinematics: K) -> KinematicPath<K> {
    let count = kinematics.axis_count();
    KinematicPath::new(kinematics, Vec::new(), AxisVector::zeros(count))
}

/// Everything down to a thousandth of these is of interest.
fn floor(velocity: f64, acceleration: f64, jerk: f64) -> Floor {
    Floor {
        position: [f64::INFINITY, f64::NEG_INFINITY],
        velocity: 1e-3 * velocity,
        acceleration: 1e-3 * acceleration,
        deceleration: None,
        jerk: 1e-3 * jerk,
    }
}

fn examine(path: &impl AxisPath, shape: Shape, piece: &Piece) -> (Extremes, BlendedElement) {
    let element = element(shape);
    let floors = [floor(0.1, 1.0, 100.0); 3];
    let found = Examiner::new(path, 1e-3).examine(&element, piece, &path.home(), &floors, None);
    (*found.unwrap(), element)
}

/// Samples of a piece.
const SAMPLES: u32 = 4_000;

/// No sample is above what is found, and what is found is so at its time.
fn holds(path: &impl AxisPath, shape: Shape, kind: u8, speed: f64) {
    let piece = &piece(kind, shape.length(), speed);
    let (found, element) = examine(path, shape, piece);
    check(found.is_proven, "proven");
    let mut near = path.home();
    let mut sampled = [AxisExtremes::default(); 3];
    let samples =
        (0..=SAMPLES).map(|sample| piece.duration * f64::from(sample) / f64::from(SAMPLES));
    let of =
        |axis: &AxisExtremes| [axis.velocity, axis.acceleration, axis.jerk].map(|most| most.at);
    let mut times: Vec<_> = samples.chain(found.axes.iter().flat_map(of)).collect();
    times.sort_by(f64::total_cmp);
    for time in times {
        let (state, jerk) = piece.at(time);
        let point = path.axes(&element, state.position, &near).unwrap();
        near = point.position;
        let (v, a) = (state.velocity, state.acceleration);
        for (index, axis) in sampled.iter_mut().take(near.len()).enumerate() {
            let [d1, d2, d3] =
                [&point.rates.first, &point.rates.second, &point.rates.third].map(|d| d[index]);
            let values =
                [d1 * v, d1 * a + d2 * v * v, d1 * jerk + 3.0 * d2 * v * a + d3 * v * v * v];
            let slots = [&mut axis.velocity, &mut axis.acceleration, &mut axis.jerk];
            for (slot, value) in slots.into_iter().zip(values) {
                slot.value = slot.value.max(value.abs());
            }
            let [low, high] = axis.position.unwrap_or([near[index]; 2]);
            axis.position = Some([low.min(near[index]), high.max(near[index])]);
        }
    }
    for (index, (sampled, found)) in sampled.iter().zip(&found.axes).take(near.len()).enumerate() {
        let pairs = [
            ("velocity", sampled.velocity.value, found.velocity.value, 0.1),
            ("acceleration", sampled.acceleration.value, found.acceleration.value, 1.0),
            ("jerk", sampled.jerk.value, found.jerk.value, 100.0),
        ];
        for (name, sampled, found, scale) in pairs {
            let above = sampled <= found * (1.0 + 2e-6) + 1e-6 * scale;
            check(above, &format!("axis {index}: {name} {sampled} > {found}, {piece:?}"));
            let near = found <= sampled * (1.0 + 1e-3) + 1e-3 * scale;
            check(near, &format!("axis {index}: {name} {found} >> {sampled}, {piece:?}"));
        }
        let [low, high] = sampled.position.unwrap();
        let [least, most] = found.position.unwrap();
        let range = format!("axis {index}: {least} {low} {high} {most}, {piece:?}");
        check(least <= low + 1e-8 && most >= high - 1e-8, &range);
        check(least >= low - 1e-6 && most <= high + 1e-6, &range);
    }
}

#[track_caller]
fn check(holds: bool, what: &str) {
    assert!(holds, "{what}");
}

/// Along a length: at constant speed, with constant acceleration, with constant jerk from rest, or on a sin² ramp.
fn piece(kind: u8, length: f64, speed: f64) -> Piece {
    let time = length / speed;
    let (duration, law) = match kind {
        0 => (time, Law::Poly { velocity: speed, acceleration: 0.0, jerk: 0.0 }),
        1 => {
            let acceleration = 0.5 * speed / time;
            let velocity = 0.75 * speed;
            (time, Law::Poly { velocity, acceleration, jerk: 0.0 })
        }
        2 => {
            let jerk = 6.0 * length / time.powi(3);
            (time, Law::Poly { velocity: 0.0, acceleration: 0.0, jerk })
        }
        _ => {
            let angular = PI / time;
            (time, Law::Sine { velocity: 0.0, change: 2.0 * speed, angular, skipped: 0.0 })
        }
    };
    Piece { from: 0.0, duration, law }
}

fn line(start: [f64; 2], end: [f64; 2], z: f64) -> Shape {
    let [start, end] = [[start[0], start[1], 0.0], [end[0], end[1], z]].map(Point3::from);
    Shape::Line { start, end }
}

fn arc(center: [f64; 2], radius: f64, from: f64, sweep: f64, z: f64) -> Shape {
    let on = |angle: f64, z: f64| {
        let (sin, cos) = angle.sin_cos();
        Point3::new(center[0] + radius * cos, center[1] + radius * sin, z)
    };
    let center = Point3::new(center[0], center[1], 0.0);
    Shape::Arc(Arc::new(on(from, 0.0), on(from + sweep, z), center, sweep))
}

fn scara() -> KinematicPath<Scara2> {
    axes(Scara2::new([0.25, 0.2], [0.1, -0.2], Elbow::Low).unwrap())
}

fn tripod() -> KinematicPath<Tripod> {
    let dimensions = TripodDimensions {
        inner_radius: 0.05,
        outer_radius: 0.2,
        rod_length: 0.35,
        rod_distance: 0.08,
        rotation: 0.0,
    };
    axes(Tripod::new(dimensions, [0.0; 3]).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn lines_and_arcs_on_a_scara(
        kind in 0_u8..4, angle in 0.0..TAU, at in 0.08..0.42_f64, long in 0.002..0.03_f64,
        direction in 0.0..TAU, sweep in -6.0..6.0_f64, speed in 0.02..0.5_f64,
    ) {
        let place = [at * angle.cos(), at * angle.sin()];
        let end = [place[0] + long * direction.cos(), place[1] + long * direction.sin()];
        let inside = |point: [f64; 2]| (0.06..0.445).contains(&point[0].hypot(point[1]));
        prop_assume!(sweep.abs() > 0.01 && inside(end) && inside([place[0].midpoint(end[0]), place[1].midpoint(end[1])]));
        for shape in [line(place, end, 0.0), arc(place, 0.3 * long, direction, sweep, 0.0)] {
            holds(&scara(), shape, kind, speed);
        }
    }

    #[test]
    fn lines_and_arcs_on_a_tripod(
        kind in 0_u8..4, angle in 0.0..TAU, at in 0.0..0.1_f64, long in 0.002..0.06_f64,
        direction in 0.0..TAU, sweep in -6.0..6.0_f64, rise in -0.02..0.02_f64, speed in 0.02..0.5_f64,
    ) {
        let place = [at * angle.cos(), at * angle.sin()];
        let end = [place[0] + long * direction.cos(), place[1] + long * direction.sin()];
        prop_assume!(sweep.abs() > 0.01);
        for shape in [line(place, end, rise), arc(place, 0.3 * long, direction, sweep, rise)] {
            holds(&tripod(), shape, kind, speed);
        }
    }

    #[test]
    fn arcs_and_curves_on_gantries(
        kind in 0_u8..4, radius in 0.001..0.1_f64, from in 0.0..TAU, sweep in -12.0..12.0_f64,
        rise in -0.05..0.05_f64, speed in 0.02..0.5_f64, control in -0.05..0.02_f64,
    ) {
        prop_assume!(sweep.abs() > 0.01);
        let gantry = axes(Gantry3::new([0.0; 3]).unwrap());
        let belt = axes(GantryH2::new([0.0; 2], BeltLayout::default()).unwrap());
        let shape = arc([0.1, 0.2], radius, from, sweep, rise);
        holds(&gantry, shape, kind, speed);
        let shape = arc([0.1, 0.2], radius, from, sweep, 0.0);
        holds(&belt, shape, kind, speed);
        let [start, end] = [Point3::origin(), Point3::new(0.05, 0.03, rise)];
        let curve = Cubic::parabola(start, [control, 0.06].into(), end);
        let shape = Shape::Cubic(Box::new(curve));
        holds(&gantry, shape, kind, speed);
    }
}

/// At constant speed v an arc of radius R asks a gantry for v, v²/R and v³/R².
#[test]
fn circles_on_a_gantry_have_closed_forms() {
    let gantry = axes(Gantry3::new([0.0; 3]).unwrap());
    let (radius, speed) = (0.02, 0.1);
    let shape = arc([0.0; 2], radius, 0.3, 5.0, 0.0);
    let piece = piece(0, shape.length(), speed);
    let (found, _) = examine(&gantry, shape, &piece);
    for axis in &found.axes[..2] {
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 2e-6;
        assert!(close(axis.velocity.value, speed), "{axis:?}");
        assert!(close(axis.acceleration.value, speed * speed / radius), "{axis:?}");
        assert!(close(axis.jerk.value, speed.powi(3) / radius.powi(2)), "{axis:?}");
    }
}

/// A line that touches the inner edge of the reach: B reverses at once, from and to |β̇| = v/√(L1·L2).
#[test]
fn a_line_that_touches_the_edge_steps() {
    // Inner edge at 0.05: a line at that distance passes it with |β̇| = v/√(L1·L2).
    let speed = 0.1;
    let shape = line([-0.02, 0.05], [0.03, 0.05], 0.0);
    let piece = piece(0, shape.length(), speed);
    let (found, _) = examine(&scara(), shape, &piece);
    let expected = 2.0 * speed / (0.25_f64 * 0.2).sqrt();
    let step = found.axes[1].step.value;
    assert!((step / expected - 1.0).abs() < 1e-2, "{step} {expected}");
    assert!(!found.is_proven);
}

/// Stopping with a constant deceleration at the outer edge, straight outwards: B arrives with √(a·Ro/(L1·L2)) for all that.
#[test]
fn a_stop_at_the_edge_steps() {
    let shape = line([0.40, 0.0], [0.45, 0.0], 0.0);
    let (length, speed) = (0.05, 0.2);
    let deceleration = speed * speed / (2.0 * length);
    let law = Law::Poly { velocity: speed, acceleration: -deceleration, jerk: 0.0 };
    let piece = Piece { from: 0.0, duration: 2.0 * length / speed, law };
    let (found, _) = examine(&scara(), shape, &piece);
    let expected = (deceleration * 0.45 / (0.25 * 0.2)).sqrt();
    // What follows says whether it goes on from there.
    let arrives = found.ends[1].rates[0][1].abs();
    assert!((arrives / expected - 1.0).abs() < 1e-2, "{arrives} {expected}");
    assert!(found.ends[1].rates[1][1].abs() < 1e-300);
}

#[test]
fn a_point_out_of_reach_between_two_within_is_found() {
    // Both ends are within 0.45 m, the middle is not.
    let shape = arc([0.40, 0.0], 0.06, -1.2, 2.4, 0.0);
    let piece = piece(0, shape.length(), 0.1);
    let element = element(shape);
    let path = scara();
    let floors = [floor(0.1, 1.0, 100.0); 3];
    let found = Examiner::new(&path, 1e-3).examine(&element, &piece, &path.home(), &floors, None);
    assert!(found.is_err());
}

/// Ten turns around the first axis of a SCARA, in one ramp from rest to rest, are ten turns of A and none of B.
#[test]
fn turns_are_counted() {
    for kind in [0, 1, 2] {
        let turns = 10.0;
        let shape = arc([0.0; 2], 0.3, 0.4, turns * TAU, 0.0);
        let piece = piece(kind, shape.length(), 0.5);
        let (found, _) = examine(&scara(), shape, &piece);
        let [start, end] = found.ends.map(|node| node.position);
        assert!((end[0] - start[0] - turns * TAU).abs() < 1e-6, "{kind}: {start:?} {end:?}");
        assert!((end[1] - start[1]).abs() < 1e-6);
        let [low, high] = found.axes[0].position.unwrap();
        assert!((high - low - turns * TAU).abs() < 1e-6, "{kind}: {low} {high}");
    }
}

/// A machine that counts how often it is asked.
struct Counting<P>(P, std::cell::Cell<u32>);

impl<P: AxisPath> AxisPath for Counting<P> {
    fn limits(&self) -> &[crate::time_optimal::AxisLimits] {
        self.0.limits()
    }

    fn home(&self) -> AxisVector {
        self.0.home()
    }

    fn axes(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<crate::time_optimal::AxisPoint, twin_kinematics::KinematicsError> {
        self.1.set(self.1.get() + 1);
        self.0.axes(element, s, near)
    }

    fn disc(
        &self,
        element: &BlendedElement,
        s: f64,
        point: &crate::time_optimal::AxisPoint,
    ) -> Option<twin_kinematics::AxisDisc> {
        self.0.disc(element, s, point)
    }
}

/// After the first piece of a line on a gantry the kinematics are asked for its end only; extremes stay the same. A piece that slows
/// down, stops and goes back looks between its ends. On an arc and on a SCARA nothing is linear.
#[test]
fn a_line_on_a_gantry_is_known_after_its_first_piece() {
    let path = Counting(axes(Gantry3::new([0.0; 3]).unwrap()), std::cell::Cell::default());
    let element = element(line([0.1, 0.2], [0.4, -0.1], 0.1));
    let (length, floors) = (element.length(), [floor(0.1, 1.0, 100.0); 3]);
    let ramp = |from: f64, velocity: f64, acceleration: f64, duration: f64| {
        let law = Law::Poly { velocity, acceleration, jerk: 0.0 };
        Piece { from, duration, law }
    };
    let examiner = Examiner::new(&path, 1e-3);
    let examine = |piece: &Piece, linear| {
        path.1.set(0);
        let found = examiner.examine(&element, piece, &path.home(), &floors, linear).unwrap();
        (found, path.1.get())
    };
    let (first, calls) = examine(&ramp(0.0, 0.0, 1.0, 0.2), None);
    assert_eq!(calls, 2);
    let linear = first.linear.as_ref();
    let inside = ramp(0.02, 0.2, 0.0, 0.5);
    let last = ramp(length - 0.02, 0.2, -1.0, 0.2);
    let back = Piece {
        from: 0.1,
        duration: 0.2,
        law: Law::Poly { velocity: 0.1, acceleration: -1.0, jerk: 20.0 },
    };
    for (piece, expected) in [(inside, 0), (last, 1), (back, 0)] {
        let (found, calls) = examine(&piece, linear);
        let (alone, _) = examine(&piece, None);
        assert!(calls == expected || !piece.is_monotone(), "{calls} calls, {expected} expected");
        assert!(found.linear.is_some());
        for (one, other) in found.axes.iter().zip(&alone.axes) {
            for (one, other) in [
                (one.velocity, other.velocity),
                (one.acceleration, other.acceleration),
                (one.jerk, other.jerk),
            ] {
                assert!((one.value - other.value).abs() <= 1e-12 * other.value);
            }
        }
        for (one, other) in found.ends.iter().zip(&alone.ends) {
            let apart = one.position.iter().zip(other.position.iter());
            assert!(apart.map(|(one, other)| (one - other).abs()).all(|apart| apart < 1e-12));
        }
    }
    let shape = line([0.3, -0.1], [0.3, 0.1], 0.0);
    assert!(even_motion(&scara(), shape).linear.is_none());
    let shape = arc([0.2, 0.0], 0.1, 0.0, 1.0, 0.0);
    assert!(even_motion(&axes(Gantry3::new([0.0; 3]).unwrap()), shape).linear.is_none());
}

fn even_motion(path: &impl AxisPath, shape: Shape) -> Extremes {
    let piece = piece(0, shape.length(), 0.1);
    examine(path, shape, &piece).0
}
