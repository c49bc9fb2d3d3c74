//! Tuning a cam from a recorded run, limits and tolerances (`twin tune cam`): what is found, and the lines that apply it.

mod correct;
mod from_run;
mod minimise;
mod passed;
mod recorded;
mod shape;
mod tappet_error;
mod tappets;

pub use correct::{Deviation, as_fitted, corrected, wanted, wants};
pub use from_run::{Seen, errors, fit_run, rms, rounded, switchings, tappet_dead_time, unwound};
pub use minimise::{Least, Minimised, minimise};
pub use recorded::{master_motion, start, travel};
pub use shape::{PointTolerance, ShapeGoal, Shaped, shape};
pub use tappet_error::{OutputError, Part, SwitchingPart};
pub use tappets::run_dead_time;

use super::check::CamUse;
use super::edit::Change;
use super::{CamFile, WANTED};
use crate::number::{apart, significant};
use std::sync::Arc;
use twin_motion::axis::profile::{RampType, State};
use twin_motion::cam::file::clean;
use twin_motion::cam::tune::{
    FitError, Free, GentleError, RampError, RampGoal, RampIn, RampWish, ReshapeError, ramp_in,
};
use twin_motion::cam::{CamTable, Element, Knot, LimitError, Quantity, Shape, StartMode};

/// Why something is not tuned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuneError {
    /// Offsets and scalings.
    #[error("offsets and scalings: {0}")]
    Fit(#[source] FitError),
    /// Samples that do not fit the others.
    #[error("offsets and scalings: the slave is far from where the other samples have it in {}", lines(.outliers))]
    Outliers {
        /// Lines of the run, and how far the slave is off there, u.
        outliers: Vec<(u64, f64)>,
    },
    /// The dead time of tappets.
    #[error("dead time of the tappets: {0}")]
    DeadTime(#[source] FitError),
    /// A switching that does not fit the others.
    #[error(
        "dead time of the tappets: the output of line {line} switches {} s behind its tappet, the others about {} s: \
         something else switched it, or it is not this cam's",
        significant(*.behind_s, 4), significant(*.usual_s, 4)
    )]
    Outlier {
        /// Of the run.
        line: u64,
        /// s.
        behind_s: f64,
        /// The median of all, s.
        usual_s: f64,
    },
    /// Switchings that have nothing to do with the tappets.
    #[error(
        "dead time of the tappets: {count} switchings tell it to ± {} s only, and the master comes to such a tappet every {} s: \
         something else switches the output, or it is not this cam's",
        significant(*.half_width_s, 4), significant(*.every_s, 4)
    )]
    Scattered {
        /// How many were seen.
        count: usize,
        /// s.
        half_width_s: f64,
        /// s.
        every_s: f64,
    },
    /// Outputs that switch before their tappets.
    #[error(
        "dead time of the tappets: the output switches {} ± {} s before its tappets, and no dead time is negative: it is \
         inverted, or not this cam's, or more was compensated than `dead_time_s` says",
        significant(-.value_s, 4), significant(*.half_width_s, 4)
    )]
    Early {
        /// s.
        value_s: f64,
        /// s.
        half_width_s: f64,
    },
    /// Outputs that may belong to other tappets.
    #[error(
        "dead time of the tappets: the output switches {} s behind its tappets, and the master comes to such a tappet every {} s: \
         nobody can tell which tappet switched it, or it is inverted",
        significant(*.value_s, 4), significant(*.every_s, 4)
    )]
    Late {
        /// s.
        value_s: f64,
        /// s.
        every_s: f64,
    },
    /// Outputs that tappets cannot have switched so.
    #[error("dead time of the tappets: {0}")]
    Output(#[from] OutputError),
    /// The shape.
    #[error("shape: {0}")]
    Reshape(#[from] ReshapeError),
    /// The cam cannot be followed at any velocity.
    #[error("shape: no velocity of the master is slow enough: {0}")]
    TooFast(#[source] LimitError),
    /// The smallest peak.
    #[error("the smallest peak: {0}")]
    Minimise(#[source] GentleError),
    /// The ramp.
    #[error("ramp: {0}")]
    Ramp(#[from] RampError),
    /// A table has no points to move.
    #[error("a table has no points that could be moved: only points of `elements` are")]
    NoPoints,
    /// A point that is to be moved is not there.
    #[error("no point stands at master {0}; ends of lines stay where they are")]
    NoPoint(f64),
    /// No scaling keeps the limits.
    #[error("no {what} keeps the limits: {why}")]
    NoRoom {
        /// Offset or scaling.
        what: &'static str,
        /// Why.
        why: String,
    },
}

/// `line 17 (by 3.2), line 41 (by -2.7)`.
fn lines(outliers: &[(u64, f64)]) -> String {
    let each =
        outliers.iter().map(|(line, by)| format!("line {line} (by {})", significant(*by, 4)));
    each.collect::<Vec<_>>().join(", ")
}

/// Time from one set-point to the next, s.
const CYCLE_S: f64 = 1e-3;

/// A start of an axis with such ramps, and what its ramp is to be best in.
pub fn ramp_wish(
    file: &CamFile,
    using: &CamUse,
    master: f64,
    slave: State,
    (ramp, goal): (RampType, RampGoal),
) -> RampWish {
    let mut table = CamTable::new(Arc::new(file.cam.clone()));
    table.periodic = using.repeated;
    // An axis of a machine file says itself whether it goes round.
    let of_cam = file.period.filter(|_| file.cam.curve().rise() != 0.0);
    table.slave_period = using.limits.period.or(of_cam);
    let mut input = using.coupling.input;
    if matches!(input.start_mode, StartMode::Absolute | StartMode::Relative) {
        input.start_mode = StartMode::RampIn;
    }
    let velocity = using.master.velocity;
    let master = State { position: master, velocity, acceleration: 0.0 };
    let (limits, position) = (using.limits.motion, using.limits.position);
    RampWish { table, input, master, slave, limits, position, ramp, cycle_s: CYCLE_S, goal }
}

/// Finds the ramp of a start.
///
/// # Errors
/// [`TuneError::Ramp`] if there is none within the limits.
pub fn ramp(wish: &RampWish) -> Result<RampIn, TuneError> {
    Ok(ramp_in(wish)?)
}

/// The ramp that the inputs of the coupling make of a start, of which another one was found; none if they make none.
pub fn ramp_of(using: &CamUse, wish: &RampWish, found: &RampIn) -> Option<RampIn> {
    let input = &using.coupling.input;
    let values = [input.velocity_difference, input.acceleration, input.deceleration];
    let [velocity_difference, acceleration, deceleration] = values;
    let ramps = !matches!(input.start_mode, StartMode::Absolute | StartMode::Relative);
    (ramps && values.into_iter().all(|value| value.is_finite() && value > 0.0)).then_some(RampIn {
        velocity_difference,
        acceleration,
        deceleration,
        ramp_jerk: wish.limits.jerk,
        ..*found
    })
}

/// The nearest offset and scalings with which the cam keeps the limits, at the motion of the master: what is free is changed
/// by as little as can be, the scalings are made smaller only.
///
/// # Errors
/// [`TuneError::NoRoom`] if nothing does.
pub fn within_limits(file: &CamFile, using: &CamUse, free: Free) -> Result<CamUse, TuneError> {
    let mut found = *using;
    let curve = file.cam.curve();
    let peak = |using: &CamUse| {
        Quantity::ALL.map(|quantity| {
            let limit = match quantity {
                Quantity::Velocity => using.limits.motion.velocity,
                Quantity::Acceleration => using.limits.motion.acceleration,
                Quantity::Jerk => using.limits.motion.jerk,
            };
            curve.peak(quantity, &using.master, using.factors()).value / limit
        })
    };
    let worst = |using: &CamUse| peak(using).into_iter().fold(0.0, f64::max);
    if free.master_scaling {
        // All peaks grow with the scaling: halve until the largest one that keeps them is known to the last digit.
        let scaled = |share: f64| {
            let mut scaled = *using;
            scaled.coupling.input.master_scaling *= share;
            scaled
        };
        let (mut low, mut high) = (0.0, 1.0);
        if worst(&scaled(1.0)) <= 1.0 {
            low = 1.0;
        }
        while high - low > 1e-15 {
            let middle = f64::midpoint(low, high);
            if worst(&scaled(middle)) <= 1.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        found = scaled(low);
    }
    let position = curve.extremes().position;
    let [low, high] = found.limits.position;
    let height = position.max - position.min;
    if free.slave_scaling {
        // Peaks are proportional to it.
        let mut share = 1.0 / worst(&found).max(1.0);
        if free.slave_offset && (high - low).is_finite() {
            let scaling = found.coupling.input.slave_scaling.abs();
            share = share.min((high - low) / (height * scaling)).min(1.0);
        }
        if !free.slave_offset {
            share = share.min(within_positions(&found, [position.min, position.max])?);
        }
        found.coupling.input.slave_scaling *= share * (1.0 - 2.0 * f64::EPSILON);
        if same(share, 1.0) {
            found.coupling.input.slave_scaling = using.coupling.input.slave_scaling;
        }
    }
    if free.slave_offset {
        let ends = [position.min, position.max].map(|y| found.slave_at(y));
        let [bottom, top] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        if top - bottom > (high - low) * (1.0 + 1e-12) {
            let [height, way] = apart(top - bottom, high - low);
            let why = format!("the cam is {height} high, the way of the slave {way}");
            return Err(TuneError::NoRoom { what: "SlaveOffset", why });
        }
        let by = if bottom < low {
            low - bottom
        } else if top > high {
            high - top
        } else {
            0.0
        };
        found.coupling.input.slave_offset += by;
    }
    // What is changed is for files.
    let input = &mut found.coupling.input;
    let old = &using.coupling.input;
    for (new, old) in [
        (&mut input.master_scaling, old.master_scaling),
        (&mut input.slave_scaling, old.slave_scaling),
        (&mut input.slave_offset, old.slave_offset),
    ] {
        if !same(*new, old) {
            *new = clean(*new);
        }
    }
    let names = ["velocity", "acceleration", "jerk"];
    for (part, name) in peak(&found).into_iter().zip(names) {
        if part > 1.0 + 1e-9 && (free.master_scaling || free.slave_scaling) {
            let why = format!("the slave's {name} is {:.1} % of its limit", part * 100.0);
            return Err(TuneError::NoRoom { what: "scaling", why });
        }
    }
    Ok(found)
}

/// The largest part of the slave's scaling, 1 at most, with which a cam from `ends[0]` to `ends[1]` stays within its positions
/// where its offset is.
fn within_positions(using: &CamUse, ends: [f64; 2]) -> Result<f64, TuneError> {
    let input = &using.coupling.input;
    let [low, high] = using.limits.position;
    let offset = input.slave_offset;
    let mut share: f64 = 1.0;
    for way in ends.map(|y| y * input.slave_scaling) {
        let (beyond, limit) =
            if offset + way > high { (true, high) } else { (offset + way < low, low) };
        // What goes beyond a limit is nearer to it the smaller it is, if the other end of it is not beyond, too.
        let part = (limit - offset) / way;
        if beyond && !(part > 0.0 && part < 1.0) {
            let [offset, low, high] = [offset, low, high].map(|value| significant(value, 6));
            let why = format!("the slave's offset alone, {offset}, leaves {low} to {high}");
            return Err(TuneError::NoRoom { what: "SlaveScaling", why });
        }
        if beyond {
            share = share.min(part);
        }
    }
    // Made smaller for one end, a cam that is all on one side of 0 may be too near for the other limit.
    let kept = ends.iter().all(|y| {
        let at = offset + y * input.slave_scaling * share;
        let room = 1e-12 * at.abs().max(1.0);
        at >= low - room && at <= high + room
    });
    if kept {
        return Ok(share);
    }
    let [low, high] = [low, high].map(|value| significant(value, 6));
    let why =
        format!("what keeps one of {low} to {high} leaves the other; --find slave-offset as well");
    Err(TuneError::NoRoom { what: "SlaveScaling", why })
}

/// The same number.
#[expect(clippy::float_cmp, reason = "the same number or another one")]
fn same(one: f64, other: f64) -> bool {
    one == other
}

/// What brings the text of the cam's file from one use and shape to another.
pub fn changes(before: &CamUse, after: &CamUse, shape: Option<(&CamFile, &[Knot])>) -> Vec<Change> {
    let mut changes = Vec::new();
    if let Some((file, knots)) = shape
        && let Shape::Polynomial(old) = file.cam.shape()
    {
        let stands = |knot: &Knot| {
            file.source.as_ref().is_none_or(|source| {
                source.elements.iter().any(
                    |element| matches!(element, Element::Point(point) if same(point.master, knot.master)),
                )
            })
        };
        let moved = old.iter().zip(knots).filter(|(old, new)| old != new);
        changes.extend(moved.filter(|(_, new)| stands(new)).map(|(_, new)| Change::Point(*new)));
    }
    let pairs = before.coupling.numbers().into_iter().zip(after.coupling.numbers());
    for ((key, _, old), (_, _, new)) in pairs {
        if old.to_bits() != new.to_bits() {
            changes.push(Change::Coupling(key, new));
        }
    }
    if let Some(values) =
        after.coupling.wanted.filter(|_| before.coupling.wanted != after.coupling.wanted)
    {
        changes.extend(
            WANTED.into_iter().zip(values).map(|(key, value)| Change::Coupling(key, value)),
        );
    }
    if before.coupling.start_mode() != after.coupling.start_mode() {
        changes.push(Change::CouplingWord("start_mode", after.coupling.start_mode()));
    }
    changes
}
