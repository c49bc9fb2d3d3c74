//! Random machines of every kind with valid axis positions, for property tests.

use crate::gantry::{
    BeltLayout, Gantry2, Gantry3, GantryCutter2, GantryCutter3, GantryH2, Sense, ToolBeside,
};
use crate::scara::{Elbow, Scara2, Scara3};
use crate::tripod::{CalibratedTripod, Tripod, TripodDeviations, TripodDimensions};
use crate::{DimensionError, Transform};
use nalgebra::{SVector, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// A machine with axis positions.
#[derive(Clone, Debug)]
pub(crate) struct Placed<T, const N: usize> {
    pub(crate) machine: T,
    pub(crate) axes: SVector<f64, N>,
}

/// Least distance of axis positions from the edges of the reach, as a part of the machine's size or an angle.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Reach {
    /// Where derivatives are at most about a hundred.
    Inside,
    /// 10⁻⁶ from the edge.
    Close,
}

fn tools() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-0.1..0.1).prop_map(Vector3::from)
}

fn values<const N: usize>(range: f64) -> impl Strategy<Value = SVector<f64, N>> {
    prop::collection::vec(-range..range, N).prop_map(SVector::from_vec)
}

pub(crate) fn elbows() -> impl Strategy<Value = Elbow> {
    prop_oneof![Just(Elbow::Low), Just(Elbow::High)]
}

/// Gantries that `made` makes of offsets and of something `more`, with a tool, and axes in a range.
fn gantries<T: Transform<N>, const N: usize, M: fmt::Debug>(
    more: impl Strategy<Value = M>,
    range: f64,
    made: impl Fn([f64; N], M) -> Result<T, DimensionError>,
) -> impl Strategy<Value = Placed<T, N>> {
    (values::<N>(1.0), more, tools(), values(range)).prop_map(move |(offsets, more, tool, axes)| {
        Placed { machine: made(offsets.into(), more).unwrap().holding(&tool), axes }
    })
}

pub(crate) fn gantry2() -> impl Strategy<Value = Placed<Gantry2, 2>> {
    gantries(Just(()), 1.0, |offsets, ()| Gantry2::new(offsets))
}

pub(crate) fn gantry3() -> impl Strategy<Value = Placed<Gantry3, 3>> {
    gantries(Just(()), 1.0, |offsets, ()| Gantry3::new(offsets))
}

fn senses() -> impl Strategy<Value = Sense> {
    prop_oneof![Just(Sense::CounterClockwise), Just(Sense::Clockwise)]
}

pub(crate) fn gantry_cutter2() -> impl Strategy<Value = Placed<GantryCutter2, 3>> {
    gantries(senses(), 3.0, GantryCutter2::new)
}

pub(crate) fn gantry_cutter3() -> impl Strategy<Value = Placed<GantryCutter3, 4>> {
    gantries(senses(), 3.0, GantryCutter3::new)
}

fn beside() -> impl Strategy<Value = ToolBeside> {
    let place = (-PI..PI, -0.3..0.3, -0.3..0.3);
    place.prop_map(|(angle, ahead, left)| ToolBeside { angle, ahead, left })
}

pub(crate) fn gantry2_tool() -> impl Strategy<Value = Placed<Gantry2, 2>> {
    gantries(beside(), 1.0, Gantry2::with_tool_offset)
}

pub(crate) fn gantry3_tool() -> impl Strategy<Value = Placed<Gantry3, 3>> {
    gantries(beside(), 1.0, Gantry3::with_tool_offset)
}

pub(crate) fn gantry_h2() -> impl Strategy<Value = Placed<GantryH2, 2>> {
    gantries(any::<[bool; 2]>(), 1.0, |offsets, [coordinates_exchanged, drives_exchanged]| {
        GantryH2::new(offsets, BeltLayout { coordinates_exchanged, drives_exchanged })
    })
}

/// An angle between stretched and folded arms.
fn bends(reach: Reach) -> BoxedStrategy<f64> {
    match reach {
        Reach::Inside => (0.3..PI - 0.3).boxed(),
        Reach::Close => prop_oneof![Just(0.0), Just(1.0)].boxed(),
    }
}

/// β for a bend: where that is an edge, 10⁻⁶ of the reach from it.
fn beta(reach: Reach, bend: f64, first: f64, second: f64) -> f64 {
    if matches!(reach, Reach::Inside) {
        return bend;
    }
    let (sum, gap) = (first + second, (first - second).abs());
    let r = if bend > 0.5 { gap + 1e-6 * sum } else { sum * (1.0 - 1e-6) };
    let outer = (sum - r) * (sum + r);
    let inner = (r - gap) * (r + gap);
    (outer * inner).sqrt().atan2(0.5 * (inner - outer))
}

/// Arms of which neither is much shorter than the other: near the middle of equal ones the first turns as fast as one likes.
fn arms() -> impl Strategy<Value = [f64; 2]> {
    (0.1..0.6, 0.3..0.9, any::<bool>()).prop_map(|(long, part, swap)| {
        let short = long * part;
        if swap { [short, long] } else { [long, short] }
    })
}

pub(crate) fn scara2(reach: Reach) -> impl Strategy<Value = Placed<Scara2, 2>> {
    (arms(), values::<2>(TAU), elbows(), bends(reach), -PI..PI, prop::array::uniform2(-2..=2))
        .prop_map(move |(arms, offsets, elbow, bend, alpha, turns)| {
            let machine = Scara2::new(arms, offsets.into(), elbow).unwrap();
            let beta = beta(reach, bend, arms[0], arms[1]);
            let angles = Vector2::new(alpha, if elbow == Elbow::Low { beta } else { -beta });
            let turns = Vector2::from(turns).map(|turn: i32| f64::from(turn) * TAU);
            Placed { machine, axes: angles + offsets + turns }
        })
}

/// With a tool beside the second arm; the elbow bends as it does without.
pub(crate) fn scara2_tool() -> impl Strategy<Value = Placed<Scara2, 2>> {
    (scara2(Reach::Inside), prop::array::uniform2(-0.05..0.05)).prop_map(|(placed, tool)| {
        let machine = placed.machine;
        let scale = machine.arms()[1];
        let tip = Vector3::new(tool[0], tool[1], -5.0) * scale;
        // The axis of B moves by as much as the line to the tip turns.
        let turned = tip.y.atan2(scale + tip.x);
        Placed { machine: machine.holding(&tip), axes: placed.axes - Vector2::new(0.0, turned) }
    })
}

pub(crate) fn scara3(reach: Reach) -> impl Strategy<Value = Placed<Scara3, 3>> {
    let hands = (0.0..0.3, prop::array::uniform2(-0.1..0.1));
    (scara2(reach), hands, values::<2>(TAU)).prop_map(|(placed, (third, tool), last)| {
        let [first, second] = placed.machine.arms();
        let [a, b] = placed.machine.offsets();
        let machine =
            Scara3::new([first, second, third], [a, b, last.x], placed.machine.elbow()).unwrap();
        let machine = machine.holding(&Vector3::new(tool[0], tool[1], -0.2));
        Placed { machine, axes: placed.axes.push(last.x + last.y) }
    })
}

fn tripod_dimensions() -> impl Strategy<Value = TripodDimensions> {
    (0.2..0.4, 0.1..0.35, 0.25..0.6, 0.2..1.0, -PI..PI).prop_map(
        |(rod_length, inner, overhang, distance, rotation)| {
            let inner_radius = inner * rod_length;
            TripodDimensions {
                inner_radius,
                outer_radius: inner_radius + overhang * rod_length,
                rod_length,
                rod_distance: distance * inner_radius,
                rotation,
            }
        },
    )
}

pub(crate) fn tripod(reach: Reach) -> impl Strategy<Value = Placed<Tripod, 3>> {
    let places = (-PI..PI, 0.0..0.9, -0.5..0.5);
    (tripod_dimensions(), values::<3>(0.5), tools(), places).prop_map(
        move |(dimensions, offsets, tool, (angle, part, z))| {
            let machine = Tripod::new(dimensions, offsets.into()).unwrap().holding(&tool);
            let direction = Vector3::new(f64::cos(angle), f64::sin(angle), 0.0);
            let at = |r: f64| direction * r + Vector3::z() * z + tool;
            // The distance at which the first rod is horizontal.
            let inside = farthest(2.0 * dimensions.rod_length, |r| machine.to_axes(&at(r)).is_ok());
            let r = match reach {
                Reach::Inside => part * inside,
                Reach::Close => inside - 1e-6 * dimensions.rod_length,
            };
            let axes = machine.to_axes(&at(r)).unwrap();
            Placed { machine, axes }
        },
    )
}

/// The largest value below `outside` up to which `reached` holds.
fn farthest(mut outside: f64, reached: impl Fn(f64) -> bool) -> f64 {
    let mut inside = 0.0;
    for _ in 0..80 {
        let middle = f64::midpoint(inside, outside);
        if reached(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

fn deviations() -> impl Strategy<Value = TripodDeviations> {
    let of = || prop::array::uniform3(-1.0..1.0_f64);
    (of(), of(), of(), of(), (of(), of()), prop::array::uniform6(-1.0..1.0_f64)).prop_map(
        |(towers, platform, outer, inner, (outer_distances, inner_distances), rods)| {
            let mm = |values: [f64; 3]| values.map(|value| value * 1e-3);
            TripodDeviations {
                tower_angles: towers.map(|value| value * 0.01),
                platform_angles: platform.map(|value| value * 0.01),
                outer_radii: mm(outer),
                inner_radii: mm(inner),
                outer_distances: mm(outer_distances),
                inner_distances: mm(inner_distances),
                rod_lengths: rods.map(|value| value * 1e-3),
            }
        },
    )
}

/// A tripod as measured, up to a millimetre and half a degree from its design.
pub(crate) fn calibrated(reach: Reach) -> impl Strategy<Value = Placed<CalibratedTripod, 3>> {
    let wide = tripod(Reach::Inside)
        .prop_filter("rods far enough apart to hold the platform", |placed| {
            placed.machine.dimensions().rod_distance > 0.05
        });
    (wide, deviations(), tools()).prop_filter_map(
        "the rods do not reach",
        move |(placed, deviations, tool)| {
            let ideal = placed.machine;
            let rods = ideal.dimensions().rods(&deviations).unwrap();
            let machine = CalibratedTripod::new(rods, ideal.offsets()).unwrap().holding(&tool);
            let target = ideal.holding(&tool).to_tool(&placed.axes).unwrap();
            let target = match reach {
                Reach::Inside => target,
                Reach::Close => close(&machine, target)?,
            };
            let axes = machine.to_axes(&target).ok()?;
            Some(Placed { machine, axes })
        },
    )
}

/// From a reachable point outwards, to 10⁻⁶ of the size from where the rods end.
fn close(machine: &CalibratedTripod, start: Vector3<f64>) -> Option<Vector3<f64>> {
    let size = machine.characteristic_length();
    let outwards = Vector3::new(1.0, 0.3, 0.0).normalize();
    machine.to_axes(&start).ok()?;
    let reached = |way: f64| machine.to_axes(&(start + outwards * way)).is_ok();
    let inside = farthest(2.0 * size, reached);
    let close = start + outwards * (inside - 1e-6 * size);
    // One rod of a pair may be level before the platform is at the end of its way, and the platform then tilts: the
    // last bit of that way is nearer to the edge than it is long.
    let tilt = machine.platform(&machine.to_axes(&close).ok()?).ok()?.rotation.angle();
    // Where the two ways back meet, that way loses digits.
    (tilt < 0.1 && machine.margins(&close).branch > 0.1 * size).then_some(close)
}
