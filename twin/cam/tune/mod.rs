//! Tuning a cam from a recorded run, limits and tolerances (`twin tune cam`): what is found, and the lines that apply it.

#![allow(clippy::indexing_slicing, reason = "fixed arrays of the four values")]

mod constrained;
mod correction;
mod from_run;
mod recorded;
mod shape;
mod start;
mod tappet_error;
mod tappet_shift;
mod tappets;
mod units;
mod unwrap;

pub use constrained::{
    Constrained, Least, Told, exceeds, limited, minimise, refuses, scalings, within_limits,
};
pub use correction::{Deviation, as_fitted, corrected, wanted, wants, with_exactly, within};
pub use from_run::{Seen, errors, fit_run, rms, rounded, switchings, tappet_dead_time};
pub use recorded::{master_motion, travel};
pub use shape::{PointTolerance, ShapeGoal, Shaped, shape};
pub use start::{Begin, begin, started_at};
pub use tappet_error::{OutputError, Part, SwitchingPart};
pub use tappet_shift::{Kept, KeptTappet, keep_tappets, passed_at, told_at};
pub use tappets::run_dead_time;
pub use units::{passes_too_often, refuse_stroke};
pub use unwrap::{Unwound, unwound};

use super::check::CamUse;
use super::edit::Change;
use std::sync::Arc;
use twin_cam::tune::{
    ConstraintError, FitError, RampError, RampGoal, RampIn, RampWish, ReshapeError, ramp_in,
};
use twin_cam::{CamError, CamTable, Element, Knot, LimitError, Shape, StartMode};
use twin_machine::cam_file::{CamFile, WANTED};
use twin_number::significant;
use twin_profile::{RampType, State};

/// Why something is not tuned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuneError {
    /// Offsets and scalings.
    #[error("offsets and scalings: {}{}", .0, meant(.0))]
    Fit(#[source] FitError),
    /// Samples that do not fit the others.
    #[error("offsets and scalings: the slave is far from where the other samples have it in {}", lines(.outliers))]
    Outliers {
        /// Lines of the run, and how far the slave is off there, u.
        outliers: Vec<(u64, f64)>,
    },
    /// The slave does something else beside the cam.
    #[error(
        "offsets and scalings: {} {unit} rms are left over, and from sample to sample they are no noise (correlation {}): \
         the slave does something that the cam does not describe, and no interval would hold; the nearest, {nearest}, is \
         not proposed",
        significant(*.rms, 4), significant(*.correlation, 3)
    )]
    NoNoise {
        /// From sample to sample.
        correlation: f64,
        /// What is left over.
        rms: f64,
        /// Its unit.
        unit: String,
        /// The best values all the same.
        nearest: String,
    },
    /// Something else is to be looked for.
    #[error(
        "{error}. With {with} in --find, noise alone is left over: the slave goes another way than the cam has it"
    )]
    Missing {
        /// What is told without it.
        #[source]
        error: Box<TuneError>,
        /// What is to be looked for.
        with: &'static str,
    },
    /// A slave that seems to be in other units.
    #[error(
        "offsets and scalings: the slave makes {strokes} of the stroke that is wanted (SlaveScaling {}): {guess} If that is its \
         scaling, --find slave-scaling=FROM..TO says so",
        significant(*.scaling, 4)
    )]
    Stroke {
        /// What was found.
        scaling: f64,
        /// How many strokes that is.
        strokes: String,
        /// What may be the matter.
        guess: String,
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
    Minimise(#[source] ConstraintError),
    /// The ramp.
    #[error("ramp: {0}")]
    Ramp(#[from] RampError),
    /// A table has no points to move.
    #[error("a table has no points that could be moved: only points of `elements` are")]
    NoPoints,
    /// A point that is to be moved is not there.
    #[error("no point stands at master {master}; {}ends of lines stay where they are", standing(.points))]
    NoPoint {
        /// Where none is.
        master: f64,
        /// Where some are that may be moved.
        points: Vec<f64>,
    },
    /// A tappet leaves the cam.
    #[error(
        "the tappet of group {group} at {} of the cam would have to stand at {} so that the master passes it at {} as before, and \
         the cam goes from {} to {} and is not put end to end: lengthen it, or take the tappet out",
        significant(*.at, 6), significant(*.to, 6), significant(*.master, 6), significant(.range[0], 6),
        significant(.range[1], 6)
    )]
    TappetBeyond {
        /// Its group.
        group: i16,
        /// Where it stands on the cam.
        at: f64,
        /// Where the master passes it.
        master: f64,
        /// Where it would have to stand.
        to: f64,
        /// Begin and end of the cam.
        range: [f64; 2],
    },
    /// Tappets whose order is lost.
    #[error(
        "the tappets of group {group} at {} and {} of the cam, its begin and its end, would both stand at {} so that the master \
         passes them where it did, and there they have no order: leave one of them out",
        significant(.places[0], 6), significant(.places[1], 6), significant(*.to, 6)
    )]
    TappetsMeet {
        /// Their group.
        group: i16,
        /// Where they stand on the cam.
        places: [f64; 2],
        /// Where both would stand.
        to: f64,
    },
    /// Tappets that were moved make no cam.
    #[error("tappets: {0}")]
    Cam(#[source] CamError),
    /// Nothing that is looked for lets the coupling start.
    #[error(
        "with the master at {} MC_CamIn would end with error 626: with what is found it starts with the master from {} to {} {unit}. \
         --find master-offset moves that, --master-start says where the master is if it is elsewhere",
        significant(*.master, 6), significant(.range[0], 6), significant(.range[1], 6)
    )]
    NoStart {
        /// Where the master is.
        master: f64,
        /// From where to where it may be.
        range: [f64; 2],
        /// Its unit.
        unit: String,
    },
    /// A run that never comes onto a cam that is passed once.
    #[error(
        "ramp: the master of the run is never on the cam, on which it is from {} to {} {unit}: say where the ramp begins with \
         --ramp-in MASTER,SLAVE, or --end-to-end if the cam is repeated",
        significant(.range[0], 6), significant(.range[1], 6)
    )]
    BeyondCam {
        /// From where to where the master is on the cam.
        range: [f64; 2],
        /// Its unit.
        unit: String,
    },
    /// No scaling keeps the limits.
    #[error("no {what} keeps the limits: {why}")]
    NoRoom {
        /// Offset or scaling.
        what: &'static str,
        /// Why.
        why: String,
    },
}

impl TuneError {
    /// Whether the call is at fault, not cam or data: a limit is not given that is needed, or no point is where one is to be moved.
    pub fn is_of_call(&self) -> bool {
        matches!(
            self,
            Self::NoPoint { .. }
                | Self::NoPoints
                | Self::Reshape(ReshapeError::NoLimit)
                | Self::Ramp(RampError::NoLimit { .. })
        )
    }
}

/// What to do where several answers fit alike.
fn meant(error: &FitError) -> String {
    let FitError::Ambiguous { unknown, .. } = error else { return String::new() };
    let name = if *unknown == "MasterScaling" { "master-scaling" } else { "master-offset" };
    format!(": --find {name}=FROM..TO says which of them is meant")
}

/// `points stand at 0, 180, 360; `, if they are not too many for that.
fn standing(points: &[f64]) -> String {
    const MOST: usize = 20;
    let all: Vec<_> = points.iter().take(MOST).map(|point| significant(*point, 12)).collect();
    match points.len() {
        0 => String::new(),
        count if count <= MOST => format!("points stand at {}; ", all.join(", ")),
        count => format!("points stand at {}, … ({count} in all); ", all.join(", ")),
    }
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
    let goes_on = using.limits.period.is_some() || file.cam.curve().rise() != 0.0;
    table.slave_period = using.slave_period(file).filter(|_| goes_on);
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
