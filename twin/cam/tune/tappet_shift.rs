//! Tappet shift: tappets stay where they are on the master when its offset and scaling change.
//!
//! A tappet at x of the cam is passed where master · `MasterScaling` + `MasterOffset` is x. With other values it has to be
//! elsewhere on the cam to be passed there again. A periodic cam is passed again and again: with another scaling
//! its passes are longer or shorter on the master, so tappets are kept on one of them, that which the cam's own range was.

use super::super::check::CamUse;
use super::super::edit::Change;
use super::{TuneError, same};
use twin_cam::{Cam, Tappet};
use twin_machine::cam_file::CamFile;

/// A tappet, and where it stood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KeptTappet {
    /// The tappet as it is now.
    pub(crate) tappet: Tappet,
    /// Where it stood on the cam, master u.
    pub(crate) from: f64,
}

/// A cam whose tappets stay where they are on the master.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kept {
    pub(crate) file: CamFile,
    /// By ascending places where they stood.
    pub(crate) tappets: Vec<KeptTappet>,
}

impl Kept {
    /// What moves them in the text of the cam's file.
    pub(crate) fn changes(&self) -> impl Iterator<Item = Change> + '_ {
        let moved = self.tappets.iter().filter(|moved| !same(moved.from, moved.tappet.master));
        moved.map(|moved| Change::Tappet { from: moved.from, tappet: moved.tappet })
    }
}

/// Digits that tappets keep of the longest number of their cam: more are rounding.
const DIGITS: f64 = 12.0;

/// The cam with its tappets moved along, so that the master passes them where it did; none if nothing is to be moved.
/// [`TuneError::TappetBeyond`] if one leaves a cam that is not periodic, [`TuneError::TappetsMeet`] if those at begin
/// and end of one that is would come to one place, where they have no order.
pub(crate) fn keep_tappets(
    file: &CamFile,
    before: &CamUse,
    after: &CamUse,
) -> Result<Option<Kept>, TuneError> {
    let [old, new] = [before, after].map(|using| using.coupling.input);
    let unmoved =
        same(old.master_offset, new.master_offset) && same(old.master_scaling, new.master_scaling);
    if unmoved || file.cam.tappets().is_empty() {
        return Ok(None);
    }
    let mut tappets = Vec::new();
    for tappet in file.cam.tappets() {
        let to = place(file, before, after, tappet)?;
        let moved = KeptTappet { tappet: Tappet { master: to, ..*tappet }, from: tappet.master };
        let meets = |other: &&KeptTappet| {
            other.tappet.group == tappet.group
                && same(other.tappet.master, to)
                && !same(other.from, tappet.master)
        };
        // Only those at begin and end of the cam can.
        let at_end = same(tappet.master, file.cam.curve().end());
        if let Some(other) = tappets.iter().filter(|_| at_end).find(meets) {
            let places = [other.from, tappet.master];
            return Err(TuneError::TappetsMeet { group: tappet.group, places, to });
        }
        tappets.push(moved);
    }
    if tappets.iter().all(|moved| same(moved.from, moved.tappet.master)) {
        return Ok(None);
    }
    let all: Vec<_> = tappets.iter().map(|moved| moved.tappet).collect();
    let cam = Cam::new(file.cam.name(), file.cam.shape().clone(), all).map_err(TuneError::Cam)?;
    let mut kept = CamFile { cam, ..file.clone() };
    if let Some(source) = &mut kept.source {
        for tappet in &mut source.tappets {
            let here = tappets.partition_point(|moved| moved.from < tappet.master);
            if let Some(moved) = tappets.get(here) {
                tappet.master = moved.tappet.master;
            }
        }
    }
    Ok(Some(Kept { file: kept, tappets }))
}

/// The new place of a tappet on the cam.
fn place(
    file: &CamFile,
    before: &CamUse,
    after: &CamUse,
    tappet: &Tappet,
) -> Result<f64, TuneError> {
    let curve = file.cam.curve();
    let (start, end) = (curve.start(), curve.end());
    let master = before.master_at(tappet.master);
    let input = &after.coupling.input;
    let scale = start.abs().max(end.abs());
    let to = rounded(master * input.master_scaling + input.master_offset, scale);
    if curve.contains(to) {
        return Ok(to);
    }
    if !after.repeated {
        let (group, at) = (tappet.group, tappet.master);
        return Err(TuneError::TappetBeyond { group, at, master, to, range: [start, end] });
    }
    // What rounding puts at the end is at the begin.
    let (inside, _) = curve.wrap(rounded(curve.wrap(to).0, scale));
    Ok(inside)
}

/// A place among numbers as large as `scale`, without rounding.
fn rounded(place: f64, scale: f64) -> f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited just before"
    )]
    let decimals = (DIGITS - scale.abs().log10().ceil()).clamp(0.0, 18.0) as usize;
    format!("{place:.decimals$}").parse().unwrap_or(place)
}

/// Where the master is when it passes a place of the cam: of all passes of a periodic one that next to `near`.
pub(crate) fn passed_at(file: &CamFile, using: &CamUse, place: f64, near: f64) -> f64 {
    let curve = file.cam.curve();
    let turn = (curve.end() - curve.start()) / using.coupling.input.master_scaling;
    let master = using.master_at(place);
    if using.repeated { master + ((near - master) / turn).round() * turn } else { master }
}

/// The set-point of the slave with the master at a place.
pub(crate) fn slave_on_cam(file: &CamFile, using: &CamUse, master: f64) -> f64 {
    let (curve, input) = (file.cam.curve(), &using.coupling.input);
    let x = master * input.master_scaling + input.master_offset;
    let y = if using.repeated { curve.repeated(x) } else { curve.at(x) };
    using.slave_at(y.position)
}
