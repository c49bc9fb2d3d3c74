//! Tuning a cam from a recorded run, limits and tolerances (`twin tune cam`): results, and the lines that apply them.

#![allow(clippy::indexing_slicing, reason = "fixed arrays of the four values")]

mod constrained;
mod correction;
pub(super) mod dead_time;
mod error;
mod from_run;
mod recorded;
mod tappet_shift;
mod unwrap;

pub(crate) use constrained::{
    ANYTHING, Constrained, Intervals, RunFit, exceeds, limited, minimise, refuses, within_limits,
};
pub(crate) use correction::{Deviation, as_fitted, corrected, wanted, with_exactly, within};
pub(crate) use dead_time::run_dead_time;
pub(crate) use error::TuneError;
pub(crate) use from_run::{errors, fit_run, refuse_stroke, rms, rounded};
pub(crate) use recorded::master_motion;
pub(crate) use tappet_shift::{Kept, KeptTappet, keep_tappets, passed_at, slave_on_cam};
pub(crate) use unwrap::{Unwound, unwound};

use super::check::CamUse;
use super::edit::Change;
use std::sync::Arc;
use twin_cam::tune::{RampGoal, RampIn, RampWish};
use twin_cam::{CamTable, StartMode};
use twin_machine::cam_file::{CamFile, WANTED};
use twin_profile::{RampType, State};

/// A start of an axis with such ramps, and what its ramp is to be best in.
pub(crate) fn ramp_wish(
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
    RampWish { table, input, master, slave, limits, position, ramp, goal }
}

/// The ramp that the inputs of the coupling make of a start, of which another one was found; none if they make none.
pub(crate) fn ramp_of(using: &CamUse, wish: &RampWish, found: &RampIn) -> Option<RampIn> {
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

#[expect(clippy::float_cmp, reason = "the same number or another one")]
fn same(one: f64, other: f64) -> bool {
    one == other
}

/// What brings the text of the cam's file from one use to another.
pub(crate) fn changes(before: &CamUse, after: &CamUse) -> Vec<Change> {
    let mut changes = Vec::new();
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
