//! Direction of the path seen from above, for machines whose tool turns with the path.
//!
//! An axis that follows the direction θ of the path has the velocity θ′·ṡ: at a step of θ, the tool has to turn while
//! the path is at rest. Such a turn is a separate element of the blended path, in which only the direction moves.
//!
//! ```text
//!   ──────▶ │ stop, turn by θ, stop │ ↗ ──────
//! ```

use super::joint::{SLOWEST, Steps};
use super::{BlendedElement, BlendedPoint};
use nalgebra::Vector2;
use std::f64::consts::{LN_2, PI, TAU};
use twin_kinematics::direction_rates;
use twin_path::prepare::CheckedElement;
use twin_path::{Arc, PathDisc, Plane, Shape};

/// A tangent whose horizontal part is no longer than this goes straight up or down: steeper than a micrometre per metre.
const UPRIGHT: f64 = 1e-6;
/// Directions that differ by no more than this, rad, are the same.
const SAME: f64 = 1e-8;
/// Number of halvings that find a place on an arc.
const HALVINGS: u32 = 60;
/// Places within this part of the length from the ends of an arc are there; between them and the ends it is upright.
const AT_ENDS: f64 = 1e-7;
/// An arc goes straight up or down at no more places: twice per turn.
const MOST_PLACES: u32 = 64;

/// The angle of a tangent seen from above, rad; none where it goes straight up or down.
fn direction(tangent: Vector2<f64>) -> Option<f64> {
    // Without −0: it is on the other side of the cut along −x.
    (tangent.norm() > UPRIGHT).then(|| (tangent.y + 0.0).atan2(tangent.x))
}

/// The direction of the path seen from above and its derivatives by the parameter of the course.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bearing {
    /// Angle about +z, rad, 0 = +x; any number of turns.
    pub along: f64,
    /// First derivative, rad/m.
    pub first: f64,
    /// Second derivative, rad/m².
    pub second: f64,
    /// Third derivative, rad/m³.
    pub third: f64,
}

impl Bearing {
    /// That of a path that has none.
    pub(super) fn resting(along: f64) -> Self {
        Self { along, ..Self::default() }
    }

    /// At `point`, where the fourth derivative of X and Y is `fourth`; none where the path goes straight up or down.
    /// Derivatives too large for a number, on paths too small for any machine, count as none.
    pub(super) fn at(point: &BlendedPoint, fourth: Vector2<f64>) -> Option<Self> {
        let along = direction(point.first.xy())?;
        let derivatives = [point.second.xy(), point.third.xy(), fourth];
        let rates = direction_rates(point.first.xy(), derivatives)?;
        let finite = |rate: f64| if rate.is_finite() { rate } else { 0.0 };
        let [first, second, third] = rates.map(finite);
        Some(Self { along, first, second, third })
    }
}

/// Direction θ of the path about one of its points: θ(s + σ) − θ − θ′·σ is at most ½·bend·|σ|² for complex |σ| ≤ radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BearingDisc {
    /// Largest |σ|, m; it may be infinite.
    pub radius: f64,
    /// rad/m².
    pub bend: f64,
}

impl BearingDisc {
    /// Of a direction that turns at a constant rate.
    pub(super) const EVEN: Self = Self { radius: f64::INFINITY, bend: 0.0 };

    /// Of an arc at `point`.
    pub(super) fn of_arc(arc: &Arc, point: &BlendedPoint, path: &PathDisc) -> Self {
        let level = point.first.xy().norm();
        if arc.plane() == Plane::Xy {
            // The tangent is (w + i·t·r)·e^(i·t·s) if it turns at the rate t and the radius r grows at the rate w: its angle
            // is t·s and that of the first factor, log(1 + z) of which is z but for |z|², as long as |z| is at most ½.
            let length = arc.length();
            let widening = (arc.end_radius() - arc.radius()) / length;
            let part = (arc.sweep() / length * widening / level).abs();
            Self { radius: 0.5 / part, bend: 2.0 * part * part }
        } else if arc.rise() == 0.0 {
            // Seen from above it is a straight line, and turns round where it is upright.
            Self { radius: level / point.second.norm(), bend: 0.0 }
        } else {
            Self::of_tangent(point, path)
        }
    }

    /// By the tangent: up to half the radius of the path, x′ ± iy′ changes by at most 2·bend·|σ|. As long as this is no
    /// more than half of it, its logarithm, of which θ is the imaginary part, changes by at most 2·ln 2 times the quotient;
    /// so much in the largest radius bounds the remainder (Schwarz).
    pub(super) fn of_tangent(point: &BlendedPoint, path: &PathDisc) -> Self {
        let bend = path.bend.x + path.bend.y;
        let level = point.first.xy().norm();
        if level <= UPRIGHT {
            return Self { radius: 0.0, bend: 0.0 };
        }
        let radius = (0.5 * path.radius).min(0.25 * level / bend);
        Self { radius, bend: 16.0 * LN_2 * bend / (level * radius) }
    }
}

/// The directions in which `element` sets off and arrives, rad; where it does so straight up or down, that half-way. None if
/// it has none.
pub(super) fn directions(element: &CheckedElement) -> Option<[f64; 2]> {
    if !element.has_path() {
        return None;
    }
    let length = element.path_length();
    let at = |s| direction(element.at(s).tangent.xy());
    let half_way = at(0.5 * length);
    Some([at(0.0).or(half_way)?, at(length).or(half_way)?])
}

/// The way from one direction to another, rad, −π to π; none if they are the same. What turns round does so counter-clockwise.
pub(super) fn turn_between(from: f64, to: f64) -> Option<f64> {
    let turn = (to - from + PI).rem_euclid(TAU) - PI;
    let turn = if turn < SAME - PI { turn + TAU } else { turn };
    (turn.abs() > SAME).then_some(turn)
}

/// True if a blend of these steps would turn the tool at once: the path seen from above folds, or begins or ends to go
/// straight up or down. `turns`: the directions in which the two elements arrive and set off differ.
pub(super) fn turns_at_once(steps: &Steps, turns: bool) -> bool {
    let [before, after] = [&steps.before, &steps.after].map(|side| direction(side.first.xy()));
    match (before, after) {
        (Some(before), Some(after)) => {
            let turn = turn_between(before, after).unwrap_or_default();
            (0.5 * turn).cos() < SLOWEST
        }
        (None, None) => turns,
        _ => true,
    }
}

/// `element`, cut where an arc that stands upright goes straight up or down and its direction seen from above turns round.
pub(super) fn cut_upright(element: CheckedElement) -> impl Iterator<Item = CheckedElement> {
    let mut rest = Some(element);
    let mut left = MOST_PLACES;
    std::iter::from_fn(move || {
        let element = rest.take()?;
        let place = turning_round(&element).filter(|_| left > 0);
        left = left.saturating_sub(1);
        let Some(place) = place else { return Some(element) };
        let (first, second) = element.split(place);
        rest = second;
        Some(first)
    })
}

/// The first place, m, at which `element`, if it is such an arc, goes straight up or down.
fn turning_round(element: &CheckedElement) -> Option<f64> {
    let Shape::Arc(arc) = &element.shape else { return None };
    if arc.plane() == Plane::Xy {
        return None;
    }
    let length = element.path_length();
    // What lies across the plane does not turn round: with a rise the path is straight up nowhere.
    let slope = |s: f64| element.shape.at(s).tangent.xy();
    let part = arc.sweep().abs() / length;
    let step = PI / 8.0 / part;
    let near = AT_ENDS * length;
    let across = arc.plane().normal().xy();
    let along = |s: f64| {
        let slope = slope(s);
        (slope - across * slope.dot(&across)).sum()
    };
    let mut from = near;
    while from < length - near {
        let to = (from + step).min(length - near);
        if along(from) * along(to) < 0.0 {
            let (mut low, mut high) = (from, to);
            let negative = along(low) < 0.0;
            for _ in 0..HALVINGS {
                let middle = low.midpoint(high);
                if (along(middle) < 0.0) == negative {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let place = low.midpoint(high);
            return direction(slope(place)).is_none().then_some(place);
        }
        from = to;
    }
    None
}

/// The direction of the path on an element of the course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    /// Direction where the path has none, and at the begin of a turn, rad.
    pub(super) along: f64,
    /// By how much a turn turns, rad; 0 if this is none.
    pub(super) turn: f64,
}

impl BlendedElement {
    /// A turn at the start of `next`, at rest, by `turn` from the direction `along`, rad.
    pub(super) fn turn(next: &CheckedElement, along: f64, turn: f64) -> Self {
        let mut element = Self::new(next.start_at_rest());
        element.hold(Held { along, turn });
        element
    }
}
