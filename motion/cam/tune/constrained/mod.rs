//! Constrained fit of offsets and scalings: the least error against samples, or the least peak of the slave.
//!
//! With y from least to greatest the slave lies between `SlaveScaling` · y + `SlaveOffset` of both, and its velocity, acceleration
//! and jerk are |`SlaveScaling`| · P(`MasterScaling`, `MasterOffset`) with the exact peaks P of the curve. So for given values of
//! the master all constraints are linear in those of the slave, whose best values follow exactly
//! (`motion/cam/tune/constrained/region.rs`). The smallest peak has the smallest `MasterScaling`; for the least error the
//! values of the master are searched (`motion/cam/tune/constrained/search.rs`).

mod region;
mod search;

pub use region::Bound;
#[cfg(test)]
pub(super) use region::Region;

use super::super::bounds::{Factors, MasterMotion, Quantity, SlaveLimits};
use super::super::curve::Curve;
use super::super::knot::Derivatives;
use super::Sample;
use super::fit::NAMES;
use crate::maximum_master_velocity::LimitError;
#[cfg(not(test))]
use region::Region;
use region::{End, Quadratic};

/// Objective of a fit.
#[derive(Clone, Copy, Debug)]
pub enum Objective<'a> {
    /// The weighted root mean square of the error against samples.
    Error(&'a [Sample]),
    /// The peak of a quantity of the slave.
    Peak(Quantity),
}

/// Unknowns and constraints.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraints {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` as they are, or as they are best without constraints.
    pub from: [f64; 4],
    /// Between what each of them may be, infinite where it may be anything; none for what stays.
    pub sought: [Option<[f64; 2]>; 4],
    /// What the master does at most.
    pub master: MasterMotion,
    /// What the slave may do.
    pub limits: SlaveLimits,
    /// Least and greatest position of the slave, u; infinite where there is no limit.
    pub position: [f64; 2],
    /// Whether the cam is periodic.
    pub repeated: bool,
}

impl Constraints {
    /// Nothing is looked for, and nothing but the master's motion is constrained.
    pub fn new(from: [f64; 4], master: MasterMotion, repeated: bool) -> Self {
        Self {
            from,
            sought: [None; 4],
            master,
            limits: SlaveLimits::NONE,
            position: [f64::NEG_INFINITY, f64::INFINITY],
            repeated,
        }
    }
}

/// Result of a constrained fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Constrained {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    pub values: [f64; 4],
    /// The objective before.
    pub before: f64,
    /// The objective now.
    pub after: f64,
    /// The constraints that hold each of them; none if it could go either way, or follows the others.
    pub held: [Vec<Bound>; 4],
}

/// Why nothing is found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ConstraintError {
    /// The curve jumps, so that the peak is infinite whatever is changed, or a magnitude is none.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The least peak would be that of a slave at rest.
    #[error("{unknown} could become 0, where nothing moves: give it an interval without 0")]
    Unconstrained {
        /// Which.
        unknown: &'static str,
    },
    /// Two constraints leave nothing.
    #[error("{one} and {other} leave nothing of {unknown}")]
    Contradictory {
        /// Which.
        unknown: &'static str,
        /// One constraint.
        one: Bound,
        /// The other one.
        other: Bound,
    },
    /// Within the limits the least error is that of a slave at rest.
    #[error("within the limits the error is least if nothing moves: {unknown} would be next to 0")]
    AtRest {
        /// Which.
        unknown: &'static str,
    },
    /// No place that was tried keeps all constraints.
    #[error(
        "no offset and scaling of the master within the intervals lets the slave keep its limits"
    )]
    Infeasible,
    /// An interval or a value is not a number.
    #[error("{what}: {value} cannot be")]
    NotFinite {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

/// With less than this part of a scaling the slave is at rest.
const RESTS: f64 = 1e-3;
/// Ends of an interval that are nearer, as a part of themselves, are the same.
const SAME: f64 = 1e-9;
/// A limit that is exceeded by less than this part is kept.
const ROUNDING: f64 = 1e-12;
/// A master's scaling that is searched stays within the limits by this part of them: the search may end beyond a row by
/// what the row tolerates. The slave's scaling is solved for, exactly.
const MARGIN: f64 = 1e-10;

type Values = [f64; 4];

/// Finds the values with the least objective that keep all constraints; those that are given, if they do and nothing is better.
///
/// # Errors
/// [`ConstraintError`] if nothing keeps the constraints, or nothing holds a scaling.
pub fn constrained_fit(
    curve: &Curve,
    objective: Objective<'_>,
    wish: &Constraints,
) -> Result<Constrained, ConstraintError> {
    check(curve, objective, wish)?;
    let y = curve.extremes().position;
    let problem = Problem { curve, wish, objective, ends: [y.min, y.max] };
    problem.solved()
}

#[derive(Clone, Copy)]
struct Problem<'a> {
    curve: &'a Curve,
    wish: &'a Constraints,
    objective: Objective<'a>,
    /// Least and greatest y.
    ends: [f64; 2],
}

/// Values, their objective (squared but for a peak), and the constraints that hold the slave.
#[derive(Clone, Debug)]
struct Place {
    values: Values,
    cost: f64,
    by: Vec<Bound>,
}

impl Problem<'_> {
    fn solved(&self) -> Result<Constrained, ConstraintError> {
        let from = self.wish.from;
        let before = self.objective_at(&from);
        if !self.is_peak() && self.keeps(&from) {
            return Ok(Constrained {
                values: from,
                before,
                after: before,
                held: Default::default(),
            });
        }
        let mut place = self.searched()?;
        // A value of -0 would show as a change.
        place.values = place.values.map(|value| value + 0.0);
        let [_, scaling, _, factor] = place.values;
        for (unknown, value, from) in [(NAMES[1], scaling, from[1]), (NAMES[3], factor, from[3])] {
            if !self.is_peak() && value.abs() < RESTS * from.abs() {
                return Err(ConstraintError::AtRest { unknown });
            }
        }
        let held = self.held(&place);
        let after = self.objective_at(&place.values);
        Ok(Constrained { values: place.values, before, after, held })
    }

    fn is_peak(&self) -> bool {
        matches!(self.objective, Objective::Peak(_))
    }

    fn at(&self, x: f64) -> Derivatives {
        if self.wish.repeated { self.curve.repeated(x) } else { self.curve.at(x) }
    }

    fn objective_at(&self, values: &Values) -> f64 {
        let [offset, scaling, shift, factor] = *values;
        match self.objective {
            Objective::Peak(quantity) => self.peak(scaling, quantity) * factor.abs(),
            Objective::Error(samples) => {
                let (mut sum, mut weights) = (0.0, 0.0);
                for s in samples {
                    let y = self.at(s.master * scaling + offset).position;
                    sum += s.weight * (factor * y + shift - s.slave).powi(2);
                    weights += s.weight;
                }
                (sum / weights).sqrt()
            }
        }
    }

    /// The peak of a quantity of y, whatever the master does within its own limits.
    fn peak(&self, scaling: f64, quantity: Quantity) -> f64 {
        let factors = Factors { master: scaling, slave: 1.0 };
        self.curve.peak(quantity, &self.wish.master, factors).value
    }

    /// Whether limits of the position count: a slave that gains in every pass goes everywhere.
    fn has_position(&self) -> bool {
        !self.wish.repeated || self.curve.rise() == 0.0
    }

    /// Whether all limits and the interval of `MasterScaling` are kept but for rounding.
    fn keeps(&self, [_, scaling, shift, factor]: &Values) -> bool {
        let [one, other] = self.ends.map(|y| y * factor + shift);
        let (least, greatest) = (one.min(other), one.max(other));
        let room = ROUNDING * (greatest - least).max(least.abs()).max(greatest.abs());
        let [low, high] = self.wish.position;
        let moves = |quantity| {
            let limit = self.wish.limits.of(quantity);
            limit.is_infinite()
                || self.peak(*scaling, quantity) * factor.abs() <= limit * (1.0 + ROUNDING)
        };
        self.wish.sought[1].is_none_or(|[low, high]| (low..=high).contains(scaling))
            && (!self.has_position() || least >= low - room && greatest <= high + room)
            && Quantity::ALL.into_iter().all(moves)
    }

    /// The interval of one of the four; what stays is one itself.
    fn interval(&self, index: usize) -> [(f64, Bound); 2] {
        match self.wish.sought[index] {
            Some(ends) => ends.map(|end| (end, Bound::Interval { end })),
            None => [(self.wish.from[index], Bound::Given); 2],
        }
    }

    /// Scalings and offsets of the slave that intervals and limits allow with a scaling of the master.
    fn slaves(&self, scaling: f64) -> Region {
        let Constraints { limits, position, from, .. } = self.wish;
        let sign = from[3].signum();
        let free = f64::INFINITY;
        let mut region = Region::default();
        region.between([1.0, 0.0], self.interval(3)).between([0.0, 1.0], self.interval(2));
        if !self.is_peak() {
            // The slave goes the way it went.
            region.between([sign, 0.0], [(0.0, Bound::Given), (free, Bound::Given)]);
        }
        // A y of 0 but for rounding does not depend on the scaling.
        let nothing = SAME * self.curve.extremes().position.magnitude();
        let whole = |y: f64| if y.abs() <= nothing { 0.0 } else { y };
        if self.has_position() {
            let ends = position.map(|limit| (limit, Bound::Position { limit }));
            for y in self.ends {
                region.between([whole(y), 1.0], ends);
            }
        }
        for quantity in Quantity::ALL {
            let limit = limits.of(quantity);
            if limit.is_finite() {
                let solved = self.wish.sought[3].is_some();
                let kept = if solved { limit } else { limit * (1.0 - MARGIN) };
                let ends = [(-free, Bound::Given), (kept, Bound::Limit { quantity, limit })];
                region.between([sign * self.peak(scaling, quantity), 0.0], ends);
            }
        }
        region
    }

    /// Least and greatest scaling of a region, or how far apart they are if it leaves nothing.
    fn scalings(region: &Region, from: f64) -> Result<[End; 2], ([End; 2], f64)> {
        let [mut least, mut greatest] = region.scalings();
        if least.value > greatest.value {
            if !close(least.value, greatest.value) {
                let by = (least.value - greatest.value) / from.abs();
                return Err(([least, greatest], if by.is_finite() { by } else { 1.0 }));
            }
            let value = nearest(from, [least.value, greatest.value]);
            (least.value, greatest.value) = (value, value);
        }
        Ok([least, greatest])
    }

    /// Names the two constraints that leave nothing.
    fn contradiction(ends: [End; 2], unknown: &'static str) -> ConstraintError {
        let all = || ends.into_iter().flat_map(|end| end.by).flatten();
        let one = all().find(|by| *by != Bound::Given).unwrap_or(Bound::Given);
        let other = all().find(|by| *by != one && *by != Bound::Given).unwrap_or(Bound::Given);
        ConstraintError::Contradictory { unknown, one, other }
    }

    /// The name of what the slave's constraints leave nothing of.
    fn unknown_of_slave(&self) -> &'static str {
        match self.wish.sought {
            [.., Some(_)] => NAMES[3],
            [_, _, Some(_), _] => NAMES[2],
            _ => NAMES[1],
        }
    }

    /// The end of a scaling's interval next to 0, on the side where it is.
    fn nearest_zero(&self, index: usize, ends: [End; 2]) -> Result<End, ConstraintError> {
        let from = self.wish.from[index];
        let end = ends[usize::from(from < 0.0)];
        if end.value * from.signum() > SAME * from.abs() {
            Ok(end)
        } else {
            Err(ConstraintError::Unconstrained { unknown: NAMES[index] })
        }
    }

    /// The best values of the slave for given ones of the master, or by how much the constraints are exceeded.
    fn best(&self, scaling: f64, offset: f64) -> Result<Place, f64> {
        let region = self.slaves(scaling);
        let [.., shift, factor] = self.wish.from;
        let ends = Self::scalings(&region, factor).map_err(|(_, by)| by)?;
        let within = |[least, greatest]: [End; 2]| [least.value, greatest.value];
        let (values, cost, by) = match self.objective {
            Objective::Peak(quantity) => {
                // Without anything that holds it, the search ends here and says so.
                let end = self.nearest_zero(3, ends).ok();
                let factor = end.map_or(0.0, |end| end.value);
                let shift = nearest(shift, within(region.offsets(factor)));
                let by = end.into_iter().flat_map(|end| end.by).flatten().collect();
                ([shift, factor], factor.abs() * self.peak(scaling, quantity), by)
            }
            Objective::Error(samples) => {
                let places =
                    samples.iter().map(|s| (s, self.at(s.master * scaling + offset).position));
                let all: Vec<(&Sample, f64)> = places.collect();
                let [mut w, mut wy, mut wyy, mut ws, mut wys] = [0.0; 5];
                for (s, y) in &all {
                    w += s.weight;
                    wy += s.weight * y;
                    wyy += s.weight * y * y;
                    ws += s.weight * s.slave;
                    wys += s.weight * y * s.slave;
                }
                let of = Quadratic { slope: [-wys, -ws], curve: [wyy, wy, w] };
                let (values, by) = Self::least(&region, &of, ends)?;
                let [shift, factor] = values;
                let error =
                    |(s, y): &(&Sample, f64)| s.weight * (factor * y + shift - s.slave).powi(2);
                (values, all.iter().map(error).sum::<f64>() / w, by)
            }
        };
        let [shift, factor] = values;
        Ok(Place { values: [offset, scaling, shift, factor], cost, by })
    }

    /// Offset and scaling of the slave with the least quadratic, to the last digit within the region.
    fn least(
        region: &Region,
        of: &Quadratic,
        [low, high]: [End; 2],
    ) -> Result<([f64; 2], Vec<Bound>), f64> {
        let ([factor, shift], by) = region.least(of).ok_or(0.0)?;
        let factor = nearest(factor, [low.value, high.value]);
        let [low, high] = region.offsets(factor);
        Ok(([nearest(shift, [low.value, high.value]), factor], by))
    }

    /// The constraints that hold each value.
    fn held(&self, place: &Place) -> [Vec<Bound>; 4] {
        let [_, scaling, shift, factor] = place.values;
        let from = self.wish.from;
        let at = |value: f64, ends: [End; 2]| {
            let ends = ends.into_iter().filter(move |end| close(end.value, value));
            ends.flat_map(|end| end.by).flatten().collect::<Vec<_>>()
        };
        let interval = |index| self.interval(index).map(|(value, bound)| End::at(value, bound));
        let mut held = [0, 1, 2, 3].map(|index: usize| at(place.values[index], interval(index)));
        if self.is_peak() {
            held[3].clone_from(&place.by);
            held[2] = at(shift, self.slaves(scaling).offsets(factor));
            held[1].truncate(2);
        } else {
            let reached = |quantity: &Quantity| {
                let limit = self.wish.limits.of(*quantity);
                let peak = self.peak(scaling, *quantity);
                limit.is_finite() && peak * factor.abs() >= limit * (1.0 - SAME)
            };
            let motion = Quantity::ALL.into_iter().filter(reached);
            let motion: Vec<Bound> = motion
                .map(|quantity| Bound::Limit { quantity, limit: self.wish.limits.of(quantity) })
                .collect();
            let position = |bound: &&Bound| matches!(bound, Bound::Position { .. });
            held[2].extend(place.by.iter().filter(position));
            let by = if motion.is_empty() { held[2].clone() } else { motion.clone() };
            held[3].extend(by);
            held[1].splice(0..0, motion);
            for index in [1, 3] {
                if close(place.values[index], from[index]) {
                    held[index].clear();
                }
            }
        }
        for (slot, sought) in held.iter_mut().zip(self.wish.sought) {
            slot.retain(|bound| *bound != Bound::Given && sought.is_some());
            slot.dedup();
        }
        held
    }
}

/// The value in an interval that is nearest; its middle, if rounding alone leaves nothing of it.
fn nearest(value: f64, [low, high]: [f64; 2]) -> f64 {
    if low <= high {
        value.max(low).min(high)
    } else if close(low, value) || close(high, value) {
        value
    } else {
        f64::midpoint(low, high)
    }
}

/// Whether two values are the same but for rounding. An infinite one, an end that is none, is near nothing.
fn close(one: f64, other: f64) -> bool {
    let size = one.abs().max(other.abs());
    size.is_finite() && (one - other).abs() <= SAME * size
}

fn check(
    curve: &Curve,
    objective: Objective<'_>,
    wish: &Constraints,
) -> Result<(), ConstraintError> {
    // Peaks of limited quantities, and the one that is to be small, have to be finite.
    let limits = match objective {
        Objective::Peak(of) => wish.limits.with(of, wish.limits.of(of).min(f64::MAX)),
        Objective::Error(_) => wish.limits,
    };
    curve.refuse_jumps(&limits, wish.repeated)?;
    let MasterMotion { velocity, acceleration, jerk } = wish.master;
    for (name, value) in [
        ("the master's velocity", velocity),
        ("the master's acceleration", acceleration),
        ("the master's jerk", jerk),
    ] {
        if !value.is_finite() || value < 0.0 {
            return Err(LimitError::NoMagnitude { name, value }.into());
        }
    }
    let numbers = [0, 1, 2, 3].map(|index: usize| {
        let value = wish.from[index];
        (NAMES[index], value, value.is_finite() && (index.is_multiple_of(2) || value != 0.0))
    });
    let intervals = NAMES.into_iter().zip(wish.sought).filter_map(|(what, interval)| {
        let [low, high] = interval?;
        Some((what, low, low <= high))
    });
    let mut all = numbers.into_iter().chain(intervals);
    match all.find(|(.., valid)| !valid) {
        Some((what, value, _)) => Err(ConstraintError::NotFinite { what, value }),
        None => Ok(()),
    }
}
