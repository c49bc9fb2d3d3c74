//! Offsets and scalings of a cam with which the peak of its slave's acceleration or jerk is as small as can be.
//!
//! The slave's peak grows with both scalings, so something has to hold them: intervals, tappets that stay where they are
//! within a tolerance, on the master and on the slave, a stroke of the slave, and the limits of its axis. All of these are
//! linear, in master scaling and offset one part, in slave scaling and offset the other: what is allowed is found exactly
//! (`motion/cam/tune/gentle/region.rs`). Where all of the cam is passed the smallest scalings are the answer. Where the
//! master goes only a part of it the peak depends on which one: then scaling and offset of the master are looked for on a
//! grid, and from its best places on, each time with the smallest scaling of the slave.

mod passed;
pub(super) mod region;
mod search;

use super::super::bounds::{MasterMotion, Quantity, SlaveLimits};
use super::super::curve::Curve;
use super::super::largest::LimitError;
use super::start;
use crate::short::Short;
use passed::Passed;
use region::{End, Region};
use std::fmt;

/// What is looked for, and what has to hold.
#[derive(Clone, Debug, PartialEq)]
pub struct GentleWish {
    /// The peak of which quantity is to be small.
    pub quantity: Quantity,
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` as they are.
    pub from: [f64; 4],
    /// Between what each of them may be, infinite where it may be anything; none for what stays.
    pub sought: [Option<[f64; 2]>; 4],
    /// What the master does at most.
    pub master: MasterMotion,
    /// From where to where the master goes, u; all of the cam without it.
    pub travel: Option<[f64; 2]>,
    /// Where the master is when the slave is coupled, u: that has to be on the cam, from its begin to its end (error 626).
    /// None if nobody knows, or does not ask.
    pub start: Option<f64>,
    /// What the slave may do.
    pub limits: SlaveLimits,
    /// Least and greatest position of the slave, u; infinite where there is no limit.
    pub position: [f64; 2],
    /// How far the slave goes at least, u; 0 for any.
    pub stroke: f64,
    /// Tappets, in the cam's master positions.
    pub tappets: Vec<f64>,
    /// How far a tappet may move on the master, and how far the slave may be from where it is there now, u; infinite for any.
    pub tappet_tolerance: [f64; 2],
    /// Whether the cam is put end to end.
    pub repeated: bool,
}

/// What holds a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// The end of its own interval, or of the interval of the offset or scaling beside it.
    Interval {
        /// Which end.
        end: f64,
    },
    /// What stays as it is.
    Given,
    /// A tappet.
    Tappet {
        /// Master of the cam.
        place: f64,
    },
    /// That the master is on the cam when the slave is coupled (error 626).
    Start {
        /// Where it is then, u.
        master: f64,
    },
    /// The stroke of the slave.
    Stroke,
    /// A limit of the slave's position.
    Position {
        /// u.
        limit: f64,
    },
    /// A limit of the slave's motion.
    Limit {
        /// Of what.
        quantity: Quantity,
        /// What it is.
        limit: f64,
    },
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interval { end } => write!(f, "the end of an interval, {}", Short(*end)),
            Self::Given => f.write_str("what stays as it is"),
            Self::Tappet { place } => write!(f, "the tappet at {} of the cam", Short(*place)),
            Self::Start { master } => {
                write!(f, "the start with the master at {}", Short(*master))
            }
            Self::Stroke => f.write_str("the stroke of the slave"),
            Self::Position { limit } => {
                write!(f, "the slave's limit of position, {}", Short(*limit))
            }
            Self::Limit { quantity, limit } => {
                write!(f, "the slave's limit of {quantity}, {}", Short(*limit))
            }
        }
    }
}

/// What is found.
#[derive(Clone, Debug, PartialEq)]
pub struct Gentle {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    pub values: [f64; 4],
    /// The peak before, exact.
    pub before: f64,
    /// The peak now, exact.
    pub after: f64,
    /// What each value is held by; nothing for one that could go either way.
    pub held: [Vec<Bound>; 4],
}

/// Why nothing is found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GentleError {
    /// The curve jumps, so that the peak is infinite whatever is changed, or a magnitude is none.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// The least peak would be that of a slave that stands.
    #[error(
        "nothing keeps {unknown} from 0, where nothing moves: it needs an interval, a stroke of the slave or tappets that hold it"
    )]
    Nothing {
        /// Which.
        unknown: &'static str,
    },
    /// An interval without an end cannot be looked through.
    #[error(
        "{unknown} may be anything: where the master goes a part of the cam only, it needs an interval"
    )]
    Endless {
        /// Which.
        unknown: &'static str,
    },
    /// Two demands leave nothing.
    #[error("{one} and {other} leave nothing of {unknown}")]
    Contradictory {
        /// Which.
        unknown: &'static str,
        /// One demand.
        one: Bound,
        /// The other one.
        other: Bound,
    },
    /// Within the limits the least error is that of a slave that stands.
    #[error("within the limits the error is least if nothing moves: {unknown} would be next to 0")]
    Stands {
        /// Which.
        unknown: &'static str,
    },
    /// Nothing of all that was looked through keeps what has to hold.
    #[error(
        "no offset and scaling of the master within the intervals lets the slave keep its limits and its stroke"
    )]
    NoPlace,
    /// An interval, the stroke, a tolerance or a position is none.
    #[error("{what}: {value} cannot be")]
    NoNumber {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

const NAMES: [&str; 4] = ["MasterOffset", "MasterScaling", "SlaveOffset", "SlaveScaling"];
/// Ends of an interval that are nearer are the same.
const ROUNDING: f64 = 1e-9;

/// Finds offsets and scalings with the smallest peak.
///
/// # Errors
/// [`GentleError`] if what has to hold leaves nothing, or nothing holds a scaling.
pub fn gentle(curve: &Curve, wish: &GentleWish) -> Result<Gentle, GentleError> {
    check(curve, wish)?;
    let problem = Problem { curve, wish };
    let [offset, scaling, ..] = wish.from;
    let before = match problem.passed(scaling, offset) {
        Some(passed) => problem.peak(&passed, wish.quantity) * wish.from[3].abs(),
        None => f64::INFINITY,
    };
    let masters = problem.masters();
    let [least, greatest] = problem.scalings(&masters, 1)?;
    let (scaling, offset, ends) = if wish.travel.is_some() {
        let (scaling, offset) = problem.search(&masters, [least.value, greatest.value])?;
        let near = |end: &End| close(end.value, scaling);
        (scaling, offset, [least, greatest].into_iter().find(near))
    } else {
        let end = if wish.from[1] < 0.0 { greatest } else { least };
        let scaling = problem.nearest_zero(1, end.value)?;
        let [low, high] = masters.offsets(scaling);
        (scaling, nearest(wish.from[0], low.value, high.value), Some(end))
    };
    let sought = [0, 1].map(|index: usize| wish.sought.get(index).copied().flatten().is_some());
    let (offset, scaling) = match wish.start {
        Some(master) => start::onto(curve, master, [offset, scaling], sought),
        None => (offset, scaling),
    };
    let passed = problem.passed(scaling, offset).ok_or(GentleError::NoPlace)?;
    let slaves = problem.slaves(&passed);
    let [least, greatest] = problem.scalings(&slaves, 3)?;
    let end = if wish.from[3] < 0.0 { greatest } else { least };
    let factor = problem.nearest_zero(3, end.value)?;
    let [low, high] = slaves.offsets(factor);
    let shift = nearest(wish.from[2], low.value, high.value);
    let values = [offset, scaling, shift, factor];
    let mut held: [Vec<Bound>; 4] = Default::default();
    let sides = [masters.offsets(scaling), [low, high]];
    for (index, end) in [(1, ends), (3, Some(end))] {
        let bounds = end.into_iter().flat_map(|end| end.by).flatten();
        if let Some(slot) = held.get_mut(index) {
            slot.extend(bounds.filter(|bound| *bound != Bound::Given));
        }
    }
    for ((index, value), ends) in [(0, offset), (2, shift)].into_iter().zip(sides) {
        let at = ends.into_iter().filter(|end| close(end.value, value));
        if let Some(slot) = held.get_mut(index) {
            slot.extend(at.flat_map(|end| end.by).flatten().filter(|bound| *bound != Bound::Given));
        }
    }
    for (slot, sought) in held.iter_mut().zip(wish.sought) {
        if sought.is_none() {
            slot.clear();
        }
        slot.dedup();
    }
    let after = problem.peak(&passed, wish.quantity) * factor.abs();
    Ok(Gentle { values, before, after, held })
}

/// The place in an interval that is nearest; its middle, if rounding alone leaves nothing of it.
fn nearest(value: f64, low: f64, high: f64) -> f64 {
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
    size.is_finite() && (one - other).abs() <= ROUNDING * size
}

fn check(curve: &Curve, wish: &GentleWish) -> Result<(), GentleError> {
    // Each peak of its own finite limit, and the one that is to be small: infinite where a derivative before jumps.
    let mut limits = wish.limits;
    match wish.quantity {
        Quantity::Velocity => limits.velocity = limits.velocity.min(f64::MAX),
        Quantity::Acceleration => limits.acceleration = limits.acceleration.min(f64::MAX),
        Quantity::Jerk => limits.jerk = limits.jerk.min(f64::MAX),
    }
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
    for (what, value) in NAMES.into_iter().zip(wish.from) {
        if !value.is_finite() {
            return Err(GentleError::NoNumber { what, value });
        }
    }
    for (what, value) in [("MasterScaling", wish.from[1]), ("SlaveScaling", wish.from[3])] {
        if value == 0.0 {
            return Err(GentleError::NoNumber { what, value });
        }
    }
    if let Some(value) = wish.start.filter(|value| !value.is_finite()) {
        return Err(GentleError::NoNumber { what: "where the master starts", value });
    }
    for (what, interval) in NAMES.into_iter().zip(wish.sought) {
        let wrong = interval.filter(|[low, high]| low.is_nan() || high.is_nan() || low > high);
        if let Some([value, _]) = wrong {
            return Err(GentleError::NoNumber { what, value });
        }
    }
    let [of_master, of_slave] = wish.tappet_tolerance;
    for (what, value) in [
        ("the stroke", wish.stroke),
        ("the tolerance of tappets", of_master),
        ("the slave's tolerance at tappets", of_slave),
    ] {
        if value.is_nan() || value < 0.0 {
            return Err(GentleError::NoNumber { what, value });
        }
    }
    let mut ends = wish.travel.into_iter().flatten();
    if let Some(value) = ends.find(|value| !value.is_finite()) {
        return Err(GentleError::NoNumber { what: "the way of the master", value });
    }
    Ok(())
}

struct Problem<'a> {
    curve: &'a Curve,
    wish: &'a GentleWish,
}

impl Problem<'_> {
    /// The interval of one of the four; what stays is one itself.
    fn interval(&self, index: usize) -> [(f64, Bound); 2] {
        let value = self.wish.from.get(index).copied().unwrap_or_default();
        match self.wish.sought.get(index).copied().flatten() {
            Some(ends) => ends.map(|end| (end, Bound::Interval { end })),
            None => [(value, Bound::Given); 2],
        }
    }

    /// Scalings and offsets of the master that the intervals and the tappets allow.
    fn masters(&self) -> Region {
        let mut region = Region::default();
        region.between([1.0, 0.0], self.interval(1)).between([0.0, 1.0], self.interval(0));
        if let Some(master) = self.wish.start {
            let bound = Bound::Start { master };
            let ends = [self.curve.start(), self.curve.end()].map(|end| (end, bound));
            region.between([master, 1.0], ends);
        }
        let [tolerance, _] = self.wish.tappet_tolerance;
        let [offset, scaling, ..] = self.wish.from;
        for place in self.outermost() {
            let bound = Bound::Tappet { place };
            // Where it is now. What is positive before a tolerance goes the other way with the master's direction.
            let now = (place - offset) / scaling;
            let room = tolerance.copysign(scaling);
            if room.is_finite() {
                region.between([now + room, 1.0], [(place, bound), (f64::INFINITY, bound)]);
                region.between([now - room, 1.0], [(f64::NEG_INFINITY, bound), (place, bound)]);
            }
        }
        region
    }

    /// Scalings and offsets of the slave that intervals, tappets and limits allow, where the master goes so.
    fn slaves(&self, passed: &Passed) -> Region {
        let GentleWish { limits, position, stroke, from, .. } = self.wish;
        let mut region = Region::default();
        region.between([1.0, 0.0], self.interval(3)).between([0.0, 1.0], self.interval(2));
        let [.., tolerance] = self.wish.tappet_tolerance;
        // What is 0 but for rounding is no scaling's business.
        let nothing = ROUNDING * self.curve.extremes().position.magnitude();
        let whole = |y: f64| if y.abs() <= nothing { 0.0 } else { y };
        if tolerance.is_finite() {
            for (place, y) in self.slave_at_tappets() {
                let y = whole(y);
                let bound = Bound::Tappet { place };
                let now = from[3] * y + from[2];
                region.between([y, 1.0], [(now - tolerance, bound), (now + tolerance, bound)]);
            }
        }
        if let Some([least, greatest]) = passed.position {
            let ends = position.map(|limit| (limit, Bound::Position { limit }));
            region.between([whole(least), 1.0], ends).between([whole(greatest), 1.0], ends);
        }
        let sign = from[3].signum();
        let [least, greatest] = passed.reached;
        let none = (f64::NEG_INFINITY, Bound::Given);
        if *stroke > 0.0 {
            let most = (f64::INFINITY, Bound::Given);
            region.between([sign * (greatest - least), 0.0], [(*stroke, Bound::Stroke), most]);
        }
        for quantity in Quantity::ALL {
            let limit = limits.of(quantity);
            if limit.is_finite() {
                let peak = self.peak(passed, quantity);
                region
                    .between([sign * peak, 0.0], [none, (limit, Bound::Limit { quantity, limit })]);
            }
        }
        region
    }

    /// Least and greatest scaling, which leave something.
    fn scalings(&self, region: &Region, index: usize) -> Result<[End; 2], GentleError> {
        let unknown = NAMES.get(index).copied().unwrap_or_default();
        let [mut least, mut greatest] = region.scalings();
        if least.value > greatest.value {
            if !(close(least.value, greatest.value)) {
                let first = |end: End| end.by.into_iter().flatten().find(|by| *by != Bound::Given);
                let one = first(least).unwrap_or(Bound::Given);
                let other = greatest.by.into_iter().flatten().find(|by| *by != one);
                let other = other.unwrap_or(Bound::Given);
                return Err(GentleError::Contradictory { unknown, one, other });
            }
            let value = self.wish.from.get(index).copied().unwrap_or_default();
            let value = nearest(value, least.value, greatest.value);
            (least.value, greatest.value) = (value, value);
        }
        Ok([least, greatest])
    }

    /// The end of a scaling's interval next to 0, on the side where it is.
    fn nearest_zero(&self, index: usize, value: f64) -> Result<f64, GentleError> {
        let unknown = NAMES.get(index).copied().unwrap_or_default();
        let from = self.wish.from.get(index).copied().unwrap_or_default();
        if value * from.signum() > ROUNDING * from.abs() {
            Ok(value)
        } else {
            Err(GentleError::Nothing { unknown })
        }
    }
}
