//! From what a slave did to the coupling with which it does what is wanted.

use super::super::CamFile;
use super::super::check::CamUse;
use twin_motion::cam::tune::{Estimate, Fit};

/// A deviation that is smaller than this part of what it is measured against is rounding, whatever its interval says.
const ROUNDING: f64 = 1e-9;

/// What the slave is to do: the coupling that the cam's file says is `wanted_…`, or else the coupling as it stands.
pub fn wanted(using: &CamUse) -> CamUse {
    let mut wanted = *using;
    if let Some(values) = using.coupling.wanted {
        let input = &mut wanted.coupling.input;
        [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling] =
            values;
    }
    wanted
}

/// What was fitted, as a use of the cam.
pub fn as_fitted(using: &CamUse, fit: &Fit) -> CamUse {
    let mut fitted = *using;
    let input = &mut fitted.coupling.input;
    input.master_offset = fit.master_offset.value;
    input.master_scaling = fit.master_scaling.value;
    input.slave_offset = fit.slave_offset.value;
    input.slave_scaling = fit.slave_scaling.value;
    fitted
}

/// The coupling with which a slave that did what `fit` says, with `using` in effect, does what is wanted.
///
/// The slave is taken to be where a line has it of where it should be, γ · p + d, and to see the master so, too, κ · m + c:
/// gain, shift and, at one velocity of the master, lag. What was in effect and what came of it tell these four; the new
/// coupling undoes them. So the same machine with the new coupling shows no deviation, and another run changes nothing. What
/// deviates by no more than its interval stays as it is.
pub fn corrected(file: &CamFile, using: &CamUse, fit: &Fit) -> CamUse {
    let curve = file.cam.curve();
    let (width, rise) = (curve.end() - curve.start(), curve.rise());
    let height = curve.extremes().position;
    let height = (height.max - height.min).abs();
    let target = wanted(using).coupling.input;
    let mut did = *fit;
    if using.repeated && width > 0.0 {
        // Whole passes are the same cam, up to what it gains.
        let passes = ((did.master_offset.value - target.master_offset) / width).round();
        if rise == 0.0 || did.slave_offset.half_width > 0.0 {
            did.master_offset.value -= passes * width;
            did.slave_offset.value += did.slave_scaling.value * passes * rise;
        }
    }
    let seen = |found: Estimate, wanted: f64, scale: f64| {
        let by = (found.value - wanted).abs();
        if by <= found.half_width.max(ROUNDING * scale) { wanted } else { found.value }
    };
    let master_scaling = seen(did.master_scaling, target.master_scaling, 1.0);
    let master_offset = seen(did.master_offset, target.master_offset, width);
    let slave_scaling = seen(did.slave_scaling, target.slave_scaling, 1.0);
    let slave_offset = seen(did.slave_offset, target.slave_offset, height);
    let mut new = *using;
    let old = using.coupling.input;
    let input = &mut new.coupling.input;
    let put = |slot: &mut f64, value: f64, found: Estimate, still: bool| {
        if !still {
            *slot = super::rounded(Estimate { value, ..found });
        }
    };
    let same = |one: f64, other: f64| one.to_bits() == other.to_bits();
    let factor = target.master_scaling / master_scaling;
    let offset = target.master_offset - factor * (master_offset - old.master_offset);
    let scaling_stays = same(master_scaling, target.master_scaling);
    put(
        &mut input.master_offset,
        offset,
        did.master_offset,
        scaling_stays && same(master_offset, target.master_offset),
    );
    put(&mut input.master_scaling, old.master_scaling * factor, did.master_scaling, scaling_stays);
    let gain = old.slave_scaling / slave_scaling;
    let offset = old.slave_offset + (target.slave_offset - slave_offset) * gain;
    put(&mut input.slave_offset, offset, did.slave_offset, same(slave_offset, target.slave_offset));
    let scaling_stays = same(slave_scaling, target.slave_scaling);
    put(&mut input.slave_scaling, target.slave_scaling * gain, did.slave_scaling, scaling_stays);
    if *input != old {
        let to = [
            target.master_offset,
            target.master_scaling,
            target.slave_offset,
            target.slave_scaling,
        ];
        new.coupling.wanted = Some(to);
    }
    new
}
