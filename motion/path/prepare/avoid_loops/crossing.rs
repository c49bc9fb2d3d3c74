//! Crossings of two elements of a path.

use super::super::piece::POINT_EPS;
use super::super::planar::{Bounds, Fit, crossings, fit};
use crate::{ElementKind, PathElement, Plane, Shape};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// Curves are searched along arcs no further than this from them, m.
const FIT: f64 = 1e-6;
/// Steps of Newton's method from the crossing of such arcs to that of the curves.
const STEPS: usize = 8;
/// Directions closer than this are the same: the path runs along itself, rad.
const ALONG: f64 = 1e-9;
/// Loops no longer than this are left alone, m: rounding makes them where an arc goes on tangentially.
const SMALLEST_LOOP: f64 = 1e-6;
/// Paths whose heights differ by more than this do not cross, m.
const HEIGHT: f64 = 1e-6;

/// The path of an element in X and Y.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pieces: Vec<Fit>,
    bounds: Bounds,
}

/// A common point: path length on the one and on the other, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meeting {
    pub(super) s: f64,
    pub(super) t: f64,
}

impl Track {
    /// The path of `element`, if it can cross and be crossed: it cuts, and it moves in X or Y.
    pub(super) fn of(element: &PathElement) -> Option<Self> {
        if element.kind != ElementKind::Cut
            || matches!(&element.shape, Shape::Arc(arc) if arc.plane() != Plane::Xy)
        {
            return None;
        }
        let pieces = fit(&element.shape, FIT);
        let bounds = pieces.iter().map(|piece| piece.curve.bounds()).reduce(|a, b| a.around(&b))?;
        let length: f64 = pieces.iter().map(|piece| piece.curve.length()).sum();
        (length > POINT_EPS).then_some(Self { pieces, bounds })
    }

    /// False if the two are too far apart to meet.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        self.bounds.meets(&other.bounds)
    }
}

/// The first crossing along `first` of it and `later`. Behind them come `neighbours`; between them lies `walked` of
/// the path, m.
pub(super) fn first(
    (first, track): (&PathElement, &Track),
    (later, later_track): (&PathElement, &Track),
    neighbours: [Option<&PathElement>; 2],
    walked: f64,
) -> Option<Meeting> {
    let lengths = [first.shape.length(), later.shape.length()];
    let mut found: Option<Meeting> = None;
    for a in &track.pieces {
        for b in &later_track.pieces {
            for crossing in crossings(&a.curve, &b.curve) {
                let mut meeting = Meeting {
                    s: a.from + crossing.u * (a.to - a.from),
                    t: b.from + crossing.v * (b.to - b.from),
                };
                let sound = refine(&first.shape, &later.shape, &mut meeting)
                    && counts(first, later, lengths, &meeting, neighbours, walked);
                if sound && found.is_none_or(|found| meeting.s < found.s) {
                    found = Some(meeting);
                }
            }
        }
    }
    found
}

/// Moves a meeting of arcs to that of the curves they stand for; false if there is none.
fn refine(a: &Shape, b: &Shape, meeting: &mut Meeting) -> bool {
    let [length_a, length_b] = [a.length(), b.length()];
    for _ in 0..STEPS {
        let (at_a, at_b) = (a.at(meeting.s), b.at(meeting.t));
        let gap = (at_b.position - at_a.position).xy();
        if gap.norm() <= 1e-12 {
            break;
        }
        let slopes = Matrix2::from_columns(&[at_a.tangent.xy(), -at_b.tangent.xy()]);
        let Some(inverse) = slopes.try_inverse() else { break };
        let step = inverse * gap;
        meeting.s = (meeting.s + step.x).clamp(0.0, length_a);
        meeting.t = (meeting.t + step.y).clamp(0.0, length_b);
    }
    // Ends are ends, bit for bit.
    for (s, length) in [(&mut meeting.s, length_a), (&mut meeting.t, length_b)] {
        if *s <= POINT_EPS {
            *s = 0.0;
        } else if *s >= length - POINT_EPS {
            *s = length;
        }
    }
    (b.at(meeting.t).position - a.at(meeting.s).position).xy().norm() <= POINT_EPS
}

/// True if the path crosses itself there, and not just touches.
fn counts(
    first: &PathElement,
    later: &PathElement,
    lengths: [f64; 2],
    meeting: &Meeting,
    neighbours: [Option<&PathElement>; 2],
    walked: f64,
) -> bool {
    let Meeting { s, t } = *meeting;
    let at_end = [s >= lengths[0], t >= lengths[1]];
    // A crossing at the start of an element has been found at the end of the one before.
    if s <= 0.0 || t <= 0.0 || at_end == [true, true] {
        return false;
    }
    if lengths[0] - s + walked + t <= SMALLEST_LOOP {
        return false;
    }
    if (first.at(s).position.z - later.at(t).position.z).abs() > HEIGHT {
        return false;
    }
    let into = [direction(first, s), direction(later, t)];
    let mut out = into;
    for ((out, at_end), neighbour) in out.iter_mut().zip(at_end).zip(neighbours) {
        if at_end {
            *out = neighbour.and_then(|neighbour| direction(neighbour, 0.0));
        }
    }
    match (into, out) {
        ([Some(a_in), Some(b_in)], [Some(a_out), Some(b_out)]) => {
            crosses([a_in, a_out], [b_in, b_out])
        }
        _ => false,
    }
}

fn direction(element: &PathElement, s: f64) -> Option<Vector2<f64>> {
    element.shape.at(s).tangent.xy().try_normalize(f64::EPSILON)
}

/// True if a path that comes and goes in the directions `b` changes the side of one that comes and goes in the
/// directions `a`.
fn crosses([a_in, a_out]: [Vector2<f64>; 2], [b_in, b_out]: [Vector2<f64>; 2]) -> bool {
    // Seen from the point, counter-clockwise from where a goes.
    let angle = |ray: Vector2<f64>| a_out.perp(&ray).atan2(a_out.dot(&ray)).rem_euclid(TAU);
    let back = angle(-a_in);
    let sides = [angle(-b_in), angle(b_out)].map(|ray| {
        let along = ray < ALONG || TAU - ray < ALONG || (ray - back).abs() < ALONG;
        (!along).then_some(ray < back)
    });
    matches!(sides, [Some(one), Some(other)] if one != other)
}
