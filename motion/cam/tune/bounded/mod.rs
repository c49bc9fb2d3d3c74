//! Offsets and scalings of a cam that are the best within the limits of its slave: with the least error against samples, or
//! with the least change.
//!
//! With y from least to greatest, the slave is between `SlaveScaling` · y + `SlaveOffset` of both; and its velocity,
//! acceleration and jerk are |`SlaveScaling`| · P(`MasterScaling`), with the exact peaks P of the curve. So for a given
//! scaling of the master every limit is linear in scaling and offset of the slave, the square of the error is quadratic in
//! them, and Clarabel solves that (`motion/cam/tune/bounded/program.rs`); the offset of the master, in which the error is
//! not quadratic, is found with them by Gauss and Newton's method, each step such a program. That the master is on the cam when
//! the slave is coupled is linear in scaling and offset of the master. P grows with the master's scaling:
//! this is looked for on a grid between where the limits leave something at all and where they take nothing any more, and
//! for an error a fifth beyond; from the best places of the grid on by golden sections.

mod program;
mod search;

use super::super::bounds::{Factors, MasterMotion, Quantity, SlaveLimits};
use super::super::curve::Curve;
use super::gentle::region::{End, Region};
use super::start;
use super::{Bound, Free, GentleError, Sample};
use program::Program;

/// What is looked for, and what has to hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedWish {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` that are the best without limits.
    pub from: [f64; 4],
    /// Which of them may be changed.
    pub free: Free,
    /// What the master does at most.
    pub master: MasterMotion,
    /// What the slave may do.
    pub limits: SlaveLimits,
    /// Least and greatest position of the slave, u; infinite where there is no limit.
    pub position: [f64; 2],
    /// Whether the cam is put end to end.
    pub repeated: bool,
    /// Between what `MasterScaling` may be, infinite where it may be anything.
    pub scalings: [f64; 2],
    /// Where the master is when the slave is coupled, u: that has to be on the cam, from its begin to its end (error 626).
    /// None if nobody knows, or does not ask.
    pub start: Option<f64>,
}

/// What is found.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounded {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    pub values: [f64; 4],
    /// The limits that hold each of them; none if it is where it would be without limits, or follows the others.
    pub held: [Vec<Bound>; 4],
    /// What was to be small: the error, weighted root mean square, u; or the root of the sum of the squares of the changes.
    pub left: f64,
}

/// With less than this part of a scaling nothing moves.
const STANDS: f64 = 1e-3;
/// A limit that is exceeded by less than this part is kept.
const ROUNDING: f64 = 1e-12;
/// A limit that is reached but for this part holds what it limits.
const REACHED: f64 = 1e-9;
/// Steps of Gauss and Newton's method; each halves itself so often where it does not lead down.
const STEPS: usize = 60;
const HALVINGS: usize = 30;

/// Finds the offsets and scalings within the limits with the least error against samples; `from` has the least one of all.
///
/// # Errors
/// [`GentleError`] if the limits leave nothing, or the curve jumps.
pub fn bounded(
    curve: &Curve,
    samples: &[Sample],
    wish: &BoundedWish,
) -> Result<Bounded, GentleError> {
    Problem::new(curve, wish, Aim::Error(samples)).solved()
}

/// Finds the offsets and scalings within the limits that differ least from `from`: by the sum of the squares of how much the
/// scalings change as parts of themselves, and `SlaveOffset` as a part of the slave's stroke. `MasterOffset` stays.
///
/// # Errors
/// [`GentleError`] if the limits leave nothing, or the curve jumps.
pub fn nearest(curve: &Curve, wish: &BoundedWish) -> Result<Bounded, GentleError> {
    Problem::new(curve, wish, Aim::Change).solved()
}

type Values = [f64; 4];

/// What is to be small.
#[derive(Clone, Copy)]
enum Aim<'a> {
    Error(&'a [Sample]),
    Change,
}

struct Problem<'a> {
    curve: &'a Curve,
    wish: &'a BoundedWish,
    /// Of `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    free: [bool; 4],
    /// Least and greatest position of the curve.
    ends: [f64; 2],
    aim: Aim<'a>,
}

/// A place with what was to be small there, squared, and the limits of the position that hold it.
#[derive(Clone, Debug)]
struct Found {
    values: Values,
    cost: f64,
    by: Vec<Bound>,
}

impl<'a> Problem<'a> {
    fn new(curve: &'a Curve, wish: &'a BoundedWish, aim: Aim<'a>) -> Self {
        let Free { master_offset, master_scaling, slave_offset, slave_scaling } = wish.free;
        let by_samples = matches!(aim, Aim::Error(_));
        let free = [master_offset && by_samples, master_scaling, slave_offset, slave_scaling];
        let y = curve.extremes().position;
        Self { curve, wish, free, ends: [y.min, y.max], aim }
    }

    fn solved(&self) -> Result<Bounded, GentleError> {
        let from = self.wish.from;
        if let Some(value) = self.wish.start.filter(|value| !value.is_finite()) {
            return Err(GentleError::NoNumber { what: "where the master starts", value });
        }
        self.curve.refuse_jumps(&self.wish.limits, self.wish.repeated)?;
        if self.keeps(&from) {
            let left = self.cost(&from).sqrt();
            return Ok(Bounded { values: from, held: Default::default(), left });
        }
        // Its scaling does not move a master that stands at 0.
        if !self.free[1] || self.wish.start == Some(0.0) {
            self.startable(from[1])?;
        }
        let mut found = if self.free[1] {
            self.searched()?
        } else {
            let region = self.region(Some(from[1]));
            self.allowed(&region)?;
            self.best(from, &region)
        };
        if let Some(master) = self.wish.start {
            let [offset, scaling, ..] = found.values;
            let free = [self.free[0], self.free[1]];
            let offset = self.at_an_end(scaling, offset).unwrap_or(offset);
            (found.values[0], found.values[1]) =
                start::onto(self.curve, master, [offset, scaling], free);
        }
        let [_, scaling, _, factor] = found.values;
        for (unknown, value, before) in
            [("MasterScaling", scaling, from[1]), ("SlaveScaling", factor, from[3])]
        {
            if value.abs() < STANDS * before.abs() {
                return Err(GentleError::Stands { unknown });
            }
        }
        Ok(Bounded { values: found.values, held: self.held(&found), left: found.cost.sqrt() })
    }

    /// Peak of a quantity with such a scaling of the master and a scaling of 1 of the slave.
    fn peak(&self, quantity: Quantity, scaling: f64) -> f64 {
        let factors = Factors { master: scaling, slave: 1.0 };
        self.curve.peak(quantity, &self.wish.master, factors).value
    }

    /// The largest part of a limit of the motion that is reached.
    fn reached(&self, scaling: f64, factor: f64) -> f64 {
        let part = |quantity| match self.wish.limits.of(quantity) {
            limit if limit.is_finite() => self.peak(quantity, scaling) * factor.abs() / limit,
            _ => 0.0,
        };
        Quantity::ALL.into_iter().map(part).fold(0.0, f64::max)
    }

    /// Offsets of the master with which it is on the cam when the slave is coupled.
    fn offsets(&self, scaling: f64) -> [f64; 2] {
        match self.wish.start {
            Some(master) => [self.curve.start(), self.curve.end()].map(|x| x - master * scaling),
            None => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The end of the cam at which the master is when the slave is coupled, if it is at one but for rounding: as an offset.
    fn at_an_end(&self, scaling: f64, offset: f64) -> Option<f64> {
        let rounding = ROUNDING * (self.curve.end() - self.curve.start());
        self.offsets(scaling).into_iter().find(|end| (end - offset).abs() <= rounding)
    }

    /// Refuses an offset that stays, with which the master is beside the cam when the slave is coupled.
    fn startable(&self, scaling: f64) -> Result<(), GentleError> {
        let beside = |master: &f64| !self.curve.contains(master * scaling + self.wish.from[0]);
        match self.wish.start.filter(|_| !self.free[0]).filter(beside) {
            Some(master) => {
                let (one, other) = (Bound::Start { master }, Bound::Given);
                Err(GentleError::Contradictory { unknown: "MasterOffset", one, other })
            }
            None => Ok(()),
        }
    }

    /// Between what the scaling of the master may be, and what says so: its interval, or where the master starts.
    fn scalings(&self) -> [(f64, Bound); 2] {
        let mut ends = self.wish.scalings.map(|end| (end, Bound::Interval { end }));
        if let Some(master) = self.wish.start.filter(|master| !self.free[0] && *master != 0.0) {
            let at = |x: f64| (x - self.wish.from[0]) / master;
            let [one, other] = [self.curve.start(), self.curve.end()].map(at);
            let bound = Bound::Start { master };
            if one.min(other) > ends[0].0 {
                ends[0] = (one.min(other), bound);
            }
            if one.max(other) < ends[1].0 {
                ends[1] = (one.max(other), bound);
            }
        }
        ends
    }

    /// Whether all limits are kept but for rounding.
    fn keeps(&self, [offset, scaling, shift, factor]: &Values) -> bool {
        let [one, other] = self.ends.map(|y| y * factor + shift);
        let (least, greatest) = (one.min(other), one.max(other));
        let room = ROUNDING * (greatest - least).max(least.abs()).max(greatest.abs());
        let [low, high] = self.wish.position;
        let starts = |master: f64| self.curve.contains(master * scaling + offset);
        self.wish.start.is_none_or(starts)
            && (self.wish.scalings[0]..=self.wish.scalings[1]).contains(scaling)
            && least >= low - room
            && greatest <= high + room
            && self.reached(*scaling, *factor) <= 1.0 + ROUNDING
    }

    /// Scalings and offsets of the slave that its limits leave with such a scaling of the master; without one those that the
    /// limits of its position leave. The slave goes the way it went.
    fn region(&self, scaling: Option<f64>) -> Region {
        let mut region = Region::default();
        let [.., shift, factor] = self.wish.from;
        for (free, value, by) in
            [(self.free[3], factor, [1.0, 0.0]), (self.free[2], shift, [0.0, 1.0])]
        {
            if !free {
                region.between(by, [(value, Bound::Given); 2]);
            }
        }
        let sign = factor.signum();
        region.between([sign, 0.0], [(0.0, Bound::Given), (f64::INFINITY, Bound::Given)]);
        let limits = self.wish.position.map(|limit| (limit, Bound::Position { limit }));
        for y in self.ends {
            region.between([y, 1.0], limits);
        }
        for quantity in Quantity::ALL {
            let limit = self.wish.limits.of(quantity);
            if let Some(scaling) = scaling.filter(|_| limit.is_finite()) {
                let none = (f64::NEG_INFINITY, Bound::Given);
                let most = (limit, Bound::Limit { quantity, limit });
                region.between([sign * self.peak(quantity, scaling), 0.0], [none, most]);
            }
        }
        region
    }

    /// Least and greatest scaling of the slave, if there is any.
    fn allowed(&self, region: &Region) -> Result<[End; 2], GentleError> {
        let [least, greatest] = region.scalings();
        if least.value <= greatest.value || close(least.value, greatest.value) {
            return Ok([least, greatest]);
        }
        let unknown = match self.free {
            [.., true] => "SlaveScaling",
            [_, _, true, _] => "SlaveOffset",
            _ => "MasterScaling",
        };
        let all = || [least, greatest].into_iter().flat_map(|end| end.by).flatten();
        let one = all().find(|by| *by != Bound::Given).unwrap_or(Bound::Given);
        let other = all().find(|by| *by != one && *by != Bound::Given).unwrap_or(Bound::Given);
        Err(GentleError::Contradictory { unknown, one, other })
    }

    /// The nearest place that the region leaves, to the last digit.
    fn inside(&self, mut values: Values, region: &Region) -> Values {
        let into = |value: f64, [least, greatest]: [End; 2], free: bool| {
            if free && least.value <= greatest.value {
                value.clamp(least.value, greatest.value)
            } else if free {
                f64::midpoint(least.value, greatest.value)
            } else {
                value
            }
        };
        if self.free[0] {
            let [low, high] = self.offsets(values[1]);
            values[0] = values[0].clamp(low, high);
        }
        values[3] = into(values[3], region.scalings(), self.free[3]);
        values[2] = into(values[2], region.offsets(values[3]), self.free[2]);
        values
    }

    /// What is to be small, squared.
    fn cost(&self, values: &Values) -> f64 {
        match self.aim {
            Aim::Change => {
                self.changes(values).into_iter().map(|(change, _)| change * change).sum()
            }
            Aim::Error(samples) => {
                let (mut sum, mut weights) = (0.0, 0.0);
                for sample in samples {
                    let (error, _) = self.error(values, sample);
                    sum += sample.weight * error * error;
                    weights += sample.weight;
                }
                sum / weights
            }
        }
    }

    /// How much `MasterScaling`, `SlaveOffset` and `SlaveScaling` change, each with what its change is a part of.
    fn changes(&self, values: &Values) -> [(f64, f64); 3] {
        let [_, scaling, shift, factor] = self.wish.from;
        let stroke = (self.ends[1] - self.ends[0]) * factor.abs();
        let stroke = if stroke > 0.0 { stroke } else { 1.0 };
        [
            ((values[1] - scaling) / scaling, scaling),
            ((values[2] - shift) / stroke, stroke),
            ((values[3] - factor) / factor, factor),
        ]
    }

    /// The error at a sample, and its derivatives by `MasterOffset`, `SlaveOffset` and `SlaveScaling`.
    fn error(
        &self,
        &[offset, scaling, shift, factor]: &Values,
        sample: &Sample,
    ) -> (f64, [f64; 3]) {
        let x = sample.master * scaling + offset;
        let d = if self.wish.repeated { self.curve.repeated(x) } else { self.curve.at(x) };
        let error = factor * d.position + shift - sample.slave;
        (error, [factor * d.velocity, 1.0, d.position])
    }

    /// The best place within a region, with the scaling of the master as it is.
    fn best(&self, from: Values, region: &Region) -> Found {
        let values = self.inside(from, region);
        let width = self.curve.end() - self.curve.start();
        let farthest = width / 4.0;
        let mut found = Found { values, cost: self.cost(&values), by: Vec::new() };
        for _ in 0..STEPS {
            let Some((to, by)) = Program::new(self, &found.values).solved(region) else { break };
            found.by = by;
            let mut share = 1.0;
            let next = (0..HALVINGS).find_map(|_| {
                let mut next = found.values;
                for (value, to) in next.iter_mut().zip(to) {
                    *value += share * (to - *value);
                }
                // Where the slave hardly moves the offset says little, and a step of it leads anywhere.
                next[0] = next[0].clamp(found.values[0] - farthest, found.values[0] + farthest);
                let next = self.inside(next, region);
                share /= 2.0;
                Some((next, self.cost(&next))).filter(|(_, cost)| *cost <= found.cost)
            });
            let Some((values, cost)) = next else { break };
            let gained = found.cost - cost;
            (found.values, found.cost) = (values, cost);
            if gained <= 1e-15 * cost {
                break;
            }
        }
        if self.free[0]
            && self.wish.repeated
            && self.curve.rise() == 0.0
            && self.wish.start.is_none()
        {
            // Whole passes are the same cam.
            let passes = ((found.values[0] - self.wish.from[0]) / width).round();
            found.values[0] -= passes * width;
        }
        found
    }

    /// What holds each of the values.
    fn held(&self, found: &Found) -> [Vec<Bound>; 4] {
        let from = self.wish.from;
        let [_, scaling, _, factor] = found.values;
        let changed = |index: usize| {
            let of = |values: &Values| values.get(index).copied().unwrap_or_default();
            !close(of(&found.values), of(&from))
        };
        let motion: Vec<Bound> = Quantity::ALL
            .into_iter()
            .filter_map(|quantity| {
                let limit = self.wish.limits.of(quantity);
                let reached =
                    self.peak(quantity, scaling) * factor.abs() >= limit * (1.0 - REACHED);
                (limit.is_finite() && reached).then_some(Bound::Limit { quantity, limit })
            })
            .collect();
        let mut held: [Vec<Bound>; 4] = Default::default();
        if let Some(master) = self.wish.start.filter(|_| self.free[0])
            && self.at_an_end(scaling, found.values[0]).is_some()
        {
            held[0].push(Bound::Start { master });
        }
        if self.free[1] && changed(1) {
            held[1].clone_from(&motion);
            let end = |end: &&(f64, Bound)| close(end.0, scaling);
            held[1].extend(self.scalings().iter().find(end).map(|(_, by)| *by));
        }
        if self.free[2] {
            held[2].clone_from(&found.by);
        }
        if self.free[3] && changed(3) {
            held[3] = if motion.is_empty() { found.by.clone() } else { motion };
        }
        held
    }
}

fn close(one: f64, other: f64) -> bool {
    // What no value fulfils has ends that are infinite.
    (one - other).abs() <= ROUNDING * one.abs().max(other.abs()).min(f64::MAX)
}
