//! Biarcs: ellipses and splines approximated by arcs.

use super::distance::to_point;
use super::{Curve, Round, left};
use crate::Shape;
use nalgebra::{Point2, Vector2};

/// Points between the ends of a piece at which its distance from the curve is looked at.
const CHECKS: u32 = 8;
/// Pieces are not halved more often than this, whatever the tolerance.
const DEEPEST: u32 = 12;
/// An arc that turns by less than this is a line, rad.
const STRAIGHT: f64 = 1e-9;
/// Pieces shorter than this have no reliable direction, m: there are such pieces where a spline turns
/// back on itself.
const SHORTEST: f64 = 1e-12;

/// A piece of a curve and the path lengths on it between which it runs, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::prepare) struct Fit {
    pub(in crate::prepare) curve: Curve,
    pub(in crate::prepare) from: f64,
    pub(in crate::prepare) to: f64,
}

/// The projection of `shape` onto X and Y as arcs and lines that meet without a kink and are nowhere further than
/// `tolerance`, m, from it. Lines and arcs are themselves.
///
/// Two arcs with a common tangent (a biarc) take the place of every piece of the curve: both ends and both end
/// directions are met exactly, and the distance shrinks with the cube of the piece's length.
pub(in crate::prepare) fn fit(shape: &Shape, tolerance: f64) -> Vec<Fit> {
    let length = shape.length();
    if let Some(curve) = Curve::of(shape) {
        return vec![Fit { curve, from: 0.0, to: length }];
    }
    let mut pieces = Vec::new();
    // The halves still to do, the next one on top.
    let mut open = vec![(0.0, length, 0)];
    while let Some((from, to, depth)) = open.pop() {
        let biarc = biarc(shape, from, to);
        if depth < DEEPEST && (depth == 0 || deviation(shape, &biarc, from, to) > tolerance) {
            let middle = from.midpoint(to);
            open.push((middle, to, depth + 1));
            open.push((from, middle, depth + 1));
        } else {
            pieces.extend(biarc.into_iter().filter(|piece| piece.curve.length() > SHORTEST));
        }
    }
    // Those that are left share what the others had.
    let mut at = 0.0;
    for piece in &mut pieces {
        piece.from = at;
        at = piece.to;
    }
    match pieces.last_mut() {
        Some(last) => last.to = length,
        None => pieces.push(chord(&shape.start().xy(), &shape.end().xy(), 0.0, length)),
    }
    pieces
}

fn chord(start: &Point2<f64>, end: &Point2<f64>, from: f64, to: f64) -> Fit {
    Fit { curve: Curve::Line { start: *start, end: *end }, from, to }
}

/// The two arcs in place of the piece between two path lengths; one chord where no such arcs exist.
fn biarc(shape: &Shape, from: f64, to: f64) -> Vec<Fit> {
    let (first, last) = (shape.at(from), shape.at(to));
    let (start, end) = (first.position.xy(), last.position.xy());
    let chord = vec![chord(&start, &end, from, to)];
    let directions = (first.tangent.xy().try_normalize(0.0), last.tangent.xy().try_normalize(0.0));
    let (Some(a), Some(b)) = directions else { return chord };
    let Some(joint) = joint(&start, &a, &end, &b) else { return chord };
    let curves = [leaving(&start, &a, &joint), arriving(&joint, &end, &b)];
    let [one, two] = curves.map(|curve| curve.length());
    let middle = from + (to - from) * one / (one + two);
    if !middle.is_finite() {
        return chord;
    }
    let [one, two] = curves;
    vec![Fit { curve: one, from, to: middle }, Fit { curve: two, from: middle, to }]
}

/// Where the two arcs meet, when both have tangents of the same length d: the points start + d·a and end − d·b are 2d
/// apart, and the joint is in the middle between them.
fn joint(
    start: &Point2<f64>,
    a: &Vector2<f64>,
    end: &Point2<f64>,
    b: &Vector2<f64>,
) -> Option<Point2<f64>> {
    let chord = end - start;
    let along = chord.dot(&(a + b));
    // 1 − a·b with its digits.
    let opening = 0.5 * (a - b).norm_squared();
    // The positive root of 2·opening·d² + 2·along·d = chord², in the form that does not cancel.
    let root = (along * along + 2.0 * opening * chord.norm_squared()).sqrt();
    let d = if along >= 0.0 {
        chord.norm_squared() / (along + root)
    } else {
        (root - along) / (2.0 * opening)
    };
    (d.is_finite() && d > 0.0).then(|| nalgebra::center(&(start + a * d), &(end - b * d)))
}

/// The arc from `start` in `direction` to `end`.
fn leaving(start: &Point2<f64>, direction: &Vector2<f64>, end: &Point2<f64>) -> Curve {
    let chord = end - start;
    let half = direction.perp(&chord).atan2(direction.dot(&chord));
    arc(start, end, 2.0 * half, start, direction)
}

/// The arc from `start` to `end`, where it goes in `direction`.
fn arriving(start: &Point2<f64>, end: &Point2<f64>, direction: &Vector2<f64>) -> Curve {
    let chord = end - start;
    let half = chord.perp(direction).atan2(chord.dot(direction));
    arc(start, end, 2.0 * half, end, direction)
}

/// The arc with this sweep that has `direction` at its end `at`.
fn arc(
    start: &Point2<f64>,
    end: &Point2<f64>,
    sweep: f64,
    at: &Point2<f64>,
    direction: &Vector2<f64>,
) -> Curve {
    if sweep.abs() < STRAIGHT {
        return Curve::Line { start: *start, end: *end };
    }
    // Positive with the centre on the left.
    let radius = 0.5 * (end - start).norm() / (0.5 * sweep).sin();
    let center = at + left(direction) * radius;
    Curve::Arc(Round::new(*start, *end, center, sweep))
}

/// The largest distance, m, of points of the shape from the pieces in their place.
fn deviation(shape: &Shape, pieces: &[Fit], from: f64, to: f64) -> f64 {
    let step = (to - from) / f64::from(CHECKS);
    let mut largest = 0.0_f64;
    for check in 1..CHECKS {
        let point = shape.at(from + step * f64::from(check)).position.xy();
        let nearest =
            pieces.iter().map(|piece| to_point(&piece.curve, &point)).fold(f64::INFINITY, f64::min);
        largest = largest.max(nearest);
    }
    largest
}
