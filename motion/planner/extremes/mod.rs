//! Extremes of the axes along a piece of a plan, without samples.
//!
//! At a node, an instant of the piece, positions of the axes and their first three derivatives by time are known in closed
//! form. Between two nodes the velocity of an axis is the polynomial of degree five that has the values, first and second
//! derivatives of both, but for a remainder. A disc about the middle on which the axes are analytic bounds the
//! remainder: if an axis changes by no more than B within the radius ρ about every instant between two nodes that are
//! h apart, its seventh derivative is at most 7!·B/ρ⁷ (Cauchy), and velocity, acceleration and jerk differ from the
//! polynomial and its derivatives by at most 7·B·h⁶/ρ⁷, 42·B·h⁵/ρ⁷ and 210·B·h⁴/ρ⁷ (by Rolle's theorem the difference of
//! the k-th derivatives has 6 − k zeros). Intervals are bisected where that matters. A disc also proves that the whole
//! interval is within reach.
//!
//! At an edge of the reach no disc is left, and accelerations grow without bound. There the change of the velocity across a
//! cycle is a step, and nothing else of that cycle counts.

#![allow(
    clippy::indexing_slicing,
    reason = "numeric code: an index beyond an array is a fault that must stop, not a 0.0 for an axis"
)]

mod bernstein;
#[cfg(test)]
mod tests;

use crate::blended_path::BlendedElement;
use crate::planned_motion::{PathState, Piece};
use crate::time_optimal::{AxisPath, AxisPoint, Rates};
use bernstein::Bernstein;
use twin_kinematics::{AxisVector, KinematicsError, MAX_AXES};

/// To these parts of themselves extremes of velocity, acceleration and jerk are certain.
const CERTAIN: [f64; 3] = [TOLERANCE, TOLERANCE, 1e-3];
/// Between nodes an extreme of a polynomial is exact to this part of itself.
const TOLERANCE: f64 = 1e-6;
/// A disc need not be wider than this many intervals.
const WIDE: f64 = 1e4;
/// Intervals of a piece about whose axes nothing is known but their derivatives.
const SAMPLED: u32 = 16;
/// Where a blend ends or begins derivatives step; those of a piece are looked at so far within it, as a part of its length.
const INSIDE: f64 = 1e-9;
/// Turns of rotary axes are followed in steps no shorter than this part of the way.
const SHORTEST_STEP: f64 = 1e-6;
/// A position may be less certain than an extreme by this, m or rad.
const CERTAIN_POSITION: f64 = 1e-9;

/// A value and when it is taken, s from the start of the piece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// Not negative.
    pub value: f64,
    /// s.
    pub at: f64,
}

impl Largest {
    fn include(&mut self, value: f64, at: f64) {
        if value > self.value || value.is_nan() {
            *self = Self { value, at };
        }
    }
}

/// Values below which an extreme does not count: the smaller of what is known to be taken elsewhere and of what is allowed, and a
/// small part of that at least. SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Positions between these.
    pub position: [f64; 2],
    /// Velocities up to this.
    pub velocity: f64,
    /// Accelerations up to this.
    pub acceleration: f64,
    /// Decelerations up to this, where they have a limit of their own.
    pub deceleration: Option<f64>,
    /// Jerks up to this.
    pub jerk: f64,
}

/// The largest values of one axis along a piece, as far as they are above its [`Floor`]. SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisExtremes {
    /// Smallest and largest position, as far as they are beyond that of the floor.
    pub position: Option<[f64; 2]>,
    /// Speed.
    pub velocity: Largest,
    /// Acceleration; where deceleration has a floor of its own, that of growing speed.
    pub acceleration: Largest,
    /// Deceleration, where it has a floor of its own.
    pub deceleration: Largest,
    /// Jerk.
    pub jerk: Largest,
    /// Change of the velocity at once, at an edge of the reach.
    pub step: Largest,
}

/// State of the axes at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// s from the start of the piece.
    pub time: f64,
    /// m or rad.
    pub position: AxisVector,
    /// First to third derivative by time.
    pub rates: [AxisVector; 3],
    /// First derivative by the path length, 1 or rad/m.
    first: AxisVector,
    /// Radius of the disc, s, and how far the axes change within it; none if nothing is known.
    disc: Option<(f64, AxisVector)>,
    /// True if the axes move as evenly as the path.
    is_even: bool,
}

/// Positions of the axes along an element where they are linear in the path length s: position + first · (s − s₀).
#[derive(Clone, Copy, Debug)]
pub struct LinearAxes {
    /// s₀, m from the start of the element.
    s: f64,
    /// At s₀, m or rad.
    position: AxisVector,
    /// Derivatives by s, 1 or rad/m.
    first: AxisVector,
}

/// The extremes of all axes along a piece.
#[derive(Clone, Debug)]
pub struct Extremes {
    /// In the order of the axes.
    pub axes: [AxisExtremes; MAX_AXES],
    /// First and last instant.
    pub ends: [Node; 2],
    /// The tool is within reach all the way.
    pub is_proven: bool,
    /// The axes along the element, if they are linear in its length.
    pub linear: Option<LinearAxes>,
}

/// A point out of reach, and when it is wanted, s from the start of the piece.
#[derive(Clone, Copy, Debug)]
pub struct OutOfReach {
    /// s.
    pub at: f64,
    /// The reason.
    pub error: KinematicsError,
}

/// Reason why a window has no extremes.
enum Obstacle {
    /// An edge of the reach, s from the start of the piece.
    Edge(f64),
    Beyond(OutOfReach),
}

/// A piece on its element.
#[derive(Clone, Copy)]
struct Along<'e> {
    element: &'e BlendedElement,
    piece: &'e Piece,
    floors: &'e [Floor],
    /// Its start and end on the element, m.
    within: [f64; 2],
    /// Acceleration, velocity and jerk along the path are largest at the ends of the piece.
    is_monotone: bool,
    /// The axes along the element, if they are linear in its length and the piece has its extremes at its ends.
    linear: Option<&'e LinearAxes>,
    /// Their derivatives by the length, if these are known to be the same all along.
    first: Option<&'e AxisVector>,
}

/// Examines pieces of plans on a machine.
#[derive(Debug)]
pub struct Examiner<'a, A> {
    axes: &'a A,
    /// s.
    cycle: f64,
}

impl<'a, A: AxisPath> Examiner<'a, A> {
    /// Of plans on the machine `axes`, whose set-points are `cycle` (s) apart.
    pub fn new(axes: &'a A, cycle: f64) -> Self {
        Self { axes, cycle }
    }

    /// The extremes of `piece` of `element`, which begins near `near`, as far as they are above `floors`. `linear`: the
    /// axes along this element, found in an earlier piece of it.
    ///
    /// # Errors
    /// [`OutOfReach`].
    pub fn examine(
        &self,
        element: &BlendedElement,
        piece: &Piece,
        near: &AxisVector,
        floors: &[Floor],
        linear: Option<&LinearAxes>,
    ) -> Result<Box<Extremes>, OutOfReach> {
        let within = within(element, piece);
        let is_monotone = piece.is_monotone();
        let even = linear.filter(|_| is_monotone);
        let first = even.map(|linear| &linear.first);
        let along = Along { element, piece, floors, within, is_monotone, linear: even, first };
        let nowhere = Node::resting(*near);
        let axes = [AxisExtremes::default(); MAX_AXES];
        let linear = linear.copied();
        // On the heap: it is large.
        let mut found = Box::new(Extremes { axes, ends: [nowhere; 2], is_proven: true, linear });
        let mut begun = false;
        let (mut whole, mut windows) = (Some([0.0, piece.duration]), Vec::new());
        while let Some([from, to]) = whole.take().or_else(|| windows.pop()) {
            let before = found.ends[1].position;
            match self.window(&along, [from, to], &before, &mut found) {
                Ok([first, last]) => {
                    if std::mem::replace(&mut begun, true) {
                        found.step(&first);
                    } else {
                        found.ends[0] = first;
                    }
                    found.ends[1] = last;
                }
                Err(Obstacle::Beyond(error)) => return Err(error),
                Err(Obstacle::Edge(at)) => {
                    found.is_proven = false;
                    let half = 0.5 * self.cycle;
                    if at + half < to {
                        windows.push([at + half, to]);
                    }
                    if from < at - half {
                        windows.push([from, at - half]);
                    }
                }
            }
        }
        let [_, end] = &mut found.ends;
        if end.time < piece.duration {
            // The end is at an edge: the velocities are those before it, and nothing else of that cycle counts.
            end.time = piece.duration;
            end.rates[1..].fill(AxisVector::zeros(end.position.len()));
        }
        Ok(found)
    }

    /// Adds the extremes of a part of a piece to `found` and returns its end nodes. At an edge of the reach `found` stays as it was.
    fn window(
        &self,
        along: &Along<'_>,
        [from, to]: [f64; 2],
        near: &AxisVector,
        found: &mut Extremes,
    ) -> Result<[Node; 2], Obstacle> {
        let first = self.node(along, from, near)?;
        let is_even = first.is_even && along.element.is_line();
        let same = along.first.or(is_even.then_some(&first.first));
        let last =
            self.node(&Along { first: same, ..*along }, to, &self.turns(along, &first, to))?;
        let even = first.is_even && last.is_even && along.is_monotone;
        // Where the axes move evenly every value is taken at one of the ends.
        let mut between = (!even).then(|| found.clone());
        for node in [&first, &last] {
            between.as_mut().unwrap_or(found).take(node, along.floors);
        }
        if even && found.linear.is_none() && !along.element.is_blended() {
            let (position, first) = (last.position, last.first);
            let s = along.place(&along.piece.at(to).0);
            found.linear = Some(LinearAxes { s, position, first });
        }
        if let Some(mut between) = between {
            self.bisect(along, &[first, last], &mut between)?;
            *found = between;
        }
        Ok([first, last])
    }

    /// Adds the extremes between two nodes.
    fn bisect(
        &self,
        along: &Along<'_>,
        ends: &[Node; 2],
        found: &mut Extremes,
    ) -> Result<(), Obstacle> {
        let smallest = 1e-3 * self.cycle;
        let mut left = vec![*ends];
        while let Some([from, to]) = left.pop() {
            let width = to.time - from.time;
            let middle = from.time.midpoint(to.time);
            let middle = self.node(along, middle, &self.turns(along, &from, middle))?;
            found.take(&middle, along.floors);
            let settled = if let Some((radius, change)) = &middle.disc {
                let between = Between { from: &from, to: &to, radius: *radius, change };
                found.settle(&between, along.floors)
            } else {
                found.is_proven = false;
                width * f64::from(SAMPLED) <= along.piece.duration
            };
            if settled {
                continue;
            }
            // Of very long times not every interval can be halved.
            if width <= smallest || middle.time <= from.time || middle.time >= to.time {
                let edge = middle.disc.is_some_and(|(radius, _)| radius < smallest);
                if edge {
                    return Err(Obstacle::Edge(middle.time));
                }
                found.is_proven = false;
                continue;
            }
            left.push([middle, to]);
            left.push([from, middle]);
        }
        Ok(())
    }

    /// Position near that at the time `to`, by the turn of rotary axes: an arc may take them round by more than half a turn.
    fn turns(&self, along: &Along<'_>, first: &Node, to: f64) -> AxisVector {
        let shortest = SHORTEST_STEP * (to - first.time);
        let mut node = *first;
        loop {
            let radius = node.disc.map_or(f64::INFINITY, |(radius, _)| radius);
            let time = node.time + radius.max(shortest);
            if time >= to {
                return node.position;
            }
            match self.node(along, time, &node.position) {
                Ok(next) => node = next,
                Err(_) => return node.position,
            }
        }
    }

    fn node(&self, along: &Along<'_>, time: f64, near: &AxisVector) -> Result<Node, Obstacle> {
        let Along { element, piece, .. } = *along;
        let (state, jerk) = piece.at(time);
        let s = along.place(&state);
        let (v, a) = (state.velocity, state.acceleration);
        let obstacle = |error: KinematicsError| match error {
            KinematicsError::Singular(_) => Obstacle::Edge(time),
            error => Obstacle::Beyond(OutOfReach { at: time, error }),
        };
        // At the ends of an element positions come from the kinematics.
        if let Some(linear) = along.linear.filter(|_| s > 0.0 && s < element.length()) {
            return Ok(Node::even(time, linear.at(s), &linear.first, [v, a, jerk]));
        }
        if let Some(first) = along.first {
            let position = self.axes.position(element, s, near).map_err(obstacle)?;
            return Ok(Node::even(time, position, first, [v, a, jerk]));
        }
        let point = self.axes.axes(element, s, near).map_err(obstacle)?;
        let AxisPoint { position, rates: Rates { first, second, third } } = point;
        let each = |of: &dyn Fn(f64, f64, f64) -> f64| {
            let values = first.iter().zip(second.iter()).zip(third.iter());
            AxisVector::from_values(values.map(|((d1, d2), d3)| of(*d1, *d2, *d3)))
        };
        let rates = [
            each(&|d1, _, _| d1 * v),
            each(&|d1, d2, _| d1 * a + d2 * v * v),
            each(&|d1, d2, d3| d1 * jerk + 3.0 * d2 * v * a + d3 * v * v * v),
        ];
        let disc = self.axes.disc(element, s, &point);
        let is_even = disc.is_some_and(|disc| disc.is_even && disc.radius > 0.0);
        // Where the axes move evenly all is known without one.
        let disc = disc.filter(|_| !(is_even && along.is_monotone)).map(|disc| {
            let [time, way] = piece.law.time_for(&state, jerk, disc.radius);
            // By Schwarz's lemma the axes change by no more than this part within it.
            let part = if disc.radius > 0.0 { way / disc.radius } else { 0.0 };
            (time, AxisVector::from_values(disc.change.iter().map(|change| change * part)))
        });
        Ok(Node { time, position, rates, first, disc, is_even })
    }
}

impl Along<'_> {
    /// Path length on the element in `state`, m.
    fn place(&self, state: &PathState) -> f64 {
        let [from, to] = self.within;
        state.position.max(from).min(to)
    }
}

impl LinearAxes {
    /// Positions at `s`, m or rad.
    fn at(&self, s: f64) -> AxisVector {
        let ways = self.first.iter().map(|first| first * (s - self.s));
        let sums = self.position.iter().zip(ways).map(|(position, way)| position + way);
        AxisVector::from_values(sums)
    }
}

impl Node {
    fn resting(position: AxisVector) -> Self {
        let zero = AxisVector::zeros(position.len());
        Self { time: 0.0, position, rates: [zero; 3], first: zero, disc: None, is_even: false }
    }

    /// Where the axes are linear, with the derivatives `first` by a path length that has these `rates` by time.
    fn even(time: f64, position: AxisVector, first: &AxisVector, rates: [f64; 3]) -> Self {
        let rates = rates.map(|by| AxisVector::from_values(first.iter().map(|first| first * by)));
        Self { time, position, rates, first: *first, disc: None, is_even: true }
    }
}

/// Two nodes, and the disc about their middle.
struct Between<'n> {
    from: &'n Node,
    to: &'n Node,
    radius: f64,
    change: &'n AxisVector,
}

impl Extremes {
    /// Takes the values at an instant.
    fn take(&mut self, node: &Node, floors: &[Floor]) {
        for (index, (axis, floor)) in self.axes.iter_mut().zip(floors).enumerate() {
            let Some(position) = node.position.get(index) else { break };
            let [v, a, j] = node.rates.map(|rates| rates[index]);
            axis.include_position([*position; 2], floor);
            axis.velocity.include(v.abs(), node.time);
            match floor.deceleration {
                // At rest the neighbours say which limit counts.
                Some(_) if v.abs() <= rounding(floor) => {}
                Some(_) if v * a < 0.0 => axis.deceleration.include(a.abs(), node.time),
                _ => axis.acceleration.include(a.abs(), node.time),
            }
            axis.jerk.include(j.abs(), node.time);
        }
    }

    /// Counts the change of velocities across an edge of the reach to `to` as a step, and of positions what they do not explain.
    fn step(&mut self, to: &Node) {
        let [_, from] = &self.ends;
        for (index, axis) in self.axes.iter_mut().take(from.position.len()).enumerate() {
            let [first, last] = [from, to].map(|node| node.rates[0][index]);
            let between = (to.position[index] - from.position[index]) / (to.time - from.time);
            let changes = [last - first, between - first, between - last].map(f64::abs);
            axis.step.include(changes.into_iter().fold(0.0, f64::max), from.time);
            axis.velocity.include(between.abs(), from.time);
        }
    }

    /// Takes the extremes between two nodes; false if they are not certain enough.
    fn settle(&mut self, between: &Between<'_>, floors: &[Floor]) -> bool {
        let Between { from, to, radius, change } = between;
        let width = to.time - from.time;
        // About every instant between the two.
        let radius = radius.min(WIDE * width) - 0.5 * width;
        if radius <= 0.0 || radius.is_nan() {
            return false;
        }
        let count = from.position.len();
        let ratio = width / radius;
        let scale = ratio.powi(4) / radius;
        let mut curves = [None; MAX_AXES];
        for (index, (axis, floor)) in self.axes.iter().zip(floors).take(count).enumerate() {
            // A disc that is larger than it is taken is no worse.
            let most = change[index] * (between.radius.min(WIDE * width) / between.radius).min(1.0);
            let most = if between.radius.is_infinite() { 0.0 } else { most };
            if !most.is_finite() {
                return false;
            }
            let errors = [
                7.0 * most * scale * ratio * ratio,
                42.0 * most * scale * ratio / radius,
                210.0 * most * scale / (radius * radius),
            ];
            let ends = [from, to].map(|node| {
                let [v, a, j] = node.rates.map(|rates| rates[index]);
                [v, a * width, j * width * width]
            });
            let velocity = Bernstein::hermite(ends[0], ends[1]);
            let acceleration = velocity.derivative(width);
            let jerk = acceleration.derivative(width);
            let certain = |order: usize, curve: &Bernstein, known: f64, floor: f64| {
                let [low, high] = curve.hull();
                let least = known.max(floor);
                let slack = CERTAIN[order] * least;
                let bound = low.abs().max(high.abs()) + errors[order];
                bound <= least + slack || errors[order] <= slack
            };
            let [mut harder, mut floor_harder] = [axis.acceleration.value, floor.acceleration];
            if let Some(deceleration) = floor.deceleration {
                harder = harder.min(axis.deceleration.value);
                floor_harder = floor_harder.min(deceleration);
            }
            if !certain(0, &velocity, axis.velocity.value, floor.velocity)
                || !certain(1, &acceleration, harder, floor_harder)
                || !certain(2, &jerk, axis.jerk.value, floor.jerk)
            {
                return false;
            }
            // Which limit counts depends on the sign of the velocity.
            let [low, high] = velocity.hull();
            let both = low < -rounding(floor) && high > rounding(floor);
            if floor.deceleration.is_some() && both {
                return false;
            }
            let turns = low - errors[0] < 0.0 && high + errors[0] > 0.0;
            let way = velocity.integral(width);
            if turns && !is_certain(&way, errors[0] * width, from.position[index], floor) {
                return false;
            }
            curves[index] = Some((velocity, acceleration, jerk, turns));
        }
        for (index, (axis, floor)) in self.axes.iter_mut().zip(floors).take(count).enumerate() {
            let Some((velocity, acceleration, jerk, turns)) = curves[index] else { continue };
            let time = |part: f64| from.time + part * width;
            let upper = |curve: &Bernstein, floor: f64, of: &mut Largest| {
                if let Some((value, part)) = curve.largest(floor.max(of.value), TOLERANCE) {
                    of.include(value, time(part));
                }
            };
            let largest = |curve: &Bernstein, floor: f64, of: &mut Largest| {
                upper(curve, floor, of);
                upper(&curve.negative(), floor, of);
            };
            largest(&velocity, floor.velocity, &mut axis.velocity);
            largest(&jerk, floor.jerk, &mut axis.jerk);
            match floor.deceleration {
                None => largest(&acceleration, floor.acceleration, &mut axis.acceleration),
                Some(deceleration) => {
                    // Where the velocity is 0 the neighbours say which limit counts.
                    let [low, high] = velocity.hull();
                    let growing = if low >= -rounding(floor) {
                        Some(acceleration)
                    } else {
                        (high <= rounding(floor)).then(|| acceleration.negative())
                    };
                    if let Some(growing) = growing {
                        upper(&growing, floor.acceleration, &mut axis.acceleration);
                        upper(&growing.negative(), deceleration, &mut axis.deceleration);
                    }
                }
            }
            if turns {
                let (start, curve) = (from.position[index], velocity.integral(width));
                let [least, most] = floor.position.map(|position| position - start);
                if let Some((value, _)) = curve.largest(most, TOLERANCE) {
                    axis.include_position([start + value; 2], floor);
                }
                if let Some((value, _)) = curve.negative().largest(-least, TOLERANCE) {
                    axis.include_position([start - value; 2], floor);
                }
            }
        }
        true
    }
}

/// True if the positions `start` + `way` (m or rad) are known well enough with this `error`.
fn is_certain(way: &Bernstein, error: f64, start: f64, floor: &Floor) -> bool {
    let [lowest, highest] = way.hull();
    let [least, most] = floor.position.map(|position| position - start);
    error <= CERTAIN_POSITION || (lowest - error >= least && highest + error <= most)
}

/// Start and end of a piece on its element, m. At the ends of blends it is a little less.
fn within(element: &BlendedElement, piece: &Piece) -> [f64; 2] {
    let [from, to] = [0.0, piece.duration].map(|time| piece.at(time).0.position);
    if !element.is_blended() {
        return [from, to];
    }
    let length = element.length();
    let inside = INSIDE * (to - from);
    let at_blend = |s: f64| {
        let inner = element.breaks().filter(|at| *at > 0.0 && *at < length);
        inner.into_iter().any(|at| (at - s).abs() <= INSIDE * length)
    };
    let by = |s: f64| if at_blend(s) { inside } else { 0.0 };
    [from + by(from), to - by(to)]
}

/// A velocity up to this is 0, m/s or rad/s.
fn rounding(floor: &Floor) -> f64 {
    TOLERANCE * floor.velocity
}

impl AxisExtremes {
    fn include_position(&mut self, [low, high]: [f64; 2], floor: &Floor) {
        let [least, most] = floor.position;
        if low < least || high > most {
            let [known_low, known_high] = self.position.unwrap_or([low, high]);
            self.position = Some([known_low.min(low), known_high.max(high)]);
        }
    }
}
