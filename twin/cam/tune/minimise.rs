//! Offsets and scalings with the smallest peak of the slave, in the units of the axes.

use super::super::CamFile;
use super::super::check::CamUse;
use super::TuneError;
use super::bounded::no_room;
use super::correct::{with_exactly, with_values};
use twin_motion::cam::Quantity;
use twin_motion::cam::tune::{GentleWish, gentle};

/// The peak that is to be small, and what holds offsets and scalings.
#[derive(Clone, Debug, PartialEq)]
pub struct Least {
    /// Peak of the slave's acceleration or jerk.
    pub quantity: Quantity,
    /// Between what `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` may be; none for what stays.
    pub sought: [Option<[f64; 2]>; 4],
    /// From where to where the master goes; all of the cam without it.
    pub travel: Option<[f64; 2]>,
    /// How far the slave goes at least.
    pub stroke: f64,
    /// How far tappets may move on the master, and how far from where it is at them the slave may be.
    pub tappet_tolerance: [f64; 2],
}

/// The peak before and after, and what every value that was found is held by.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimised {
    /// Of which quantity.
    pub quantity: Quantity,
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` before.
    pub from: [f64; 4],
    /// u/s² or u/s³.
    pub before: f64,
    /// u/s² or u/s³.
    pub after: f64,
    /// In the order of `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`: in words, one each.
    pub held: [Vec<String>; 4],
    /// Whether the master goes a part of the cam only, for which alone the limits were looked at.
    pub part: bool,
}

/// Finds offsets and scalings with the smallest peak.
///
/// # Errors
/// [`TuneError::Minimise`] if nothing is left, or nothing holds a scaling.
pub fn minimise(
    file: &CamFile,
    using: &CamUse,
    least: &Least,
) -> Result<(CamUse, Minimised), TuneError> {
    let input = &using.coupling.input;
    let from = [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling];
    let wish = GentleWish {
        quantity: least.quantity,
        from,
        sought: least.sought,
        master: using.master,
        travel: least.travel,
        // Of a cam that is put end to end another pass starts wherever the master is.
        start: using.start.filter(|_| !using.repeated),
        limits: using.limits.motion,
        position: using.limits.position,
        stroke: least.stroke,
        tappets: file.cam.tappets().iter().map(|tappet| tappet.master).collect(),
        tappet_tolerance: least.tappet_tolerance,
        repeated: using.repeated,
    };
    let found =
        gentle(file.cam.curve(), &wish).map_err(|error| match no_room(file, using, &error) {
            start @ TuneError::NoStart { .. } => start,
            _ => TuneError::Minimise(error),
        })?;
    // Rounding does not put the master beside the cam.
    let all = [with_values(using, found.values), with_exactly(using, found.values)];
    let starts =
        |new: &CamUse| wish.start.is_none_or(|master| new.starts_at(file.cam.curve(), master));
    let new = all.into_iter().find(starts).unwrap_or(all[1]);
    let held = found.held.map(|bounds| bounds.iter().map(ToString::to_string).collect());
    let minimised = Minimised {
        quantity: least.quantity,
        from,
        before: found.before,
        after: found.after,
        held,
        part: least.travel.is_some(),
    };
    Ok((new, minimised))
}
