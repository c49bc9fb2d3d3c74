//! Runs that seem to be in other units than the cam.

use super::super::check::CamUse;
use super::TuneError;
use twin_cam::tune::{Estimate, Fit};
use twin_machine::cam_file::CamFile;
use twin_number::significant;

/// A slave with this many times the wanted stroke, or that part of it, seems to be in other units.
const STROKES: f64 = 2.0;
/// Beside its units a slave deviates by no more than this part.
const DEVIATION: f64 = 0.05;
/// A master that passes the cam more often in a second is taken for one whose time is in other units.
const PASSES_PER_S: f64 = 100.0;

/// How many of the unit of the cam a unit of the run has.
const LENGTHS: [(&str, f64); 4] = [("inch", 25.4), ("cm", 10.0), ("m", 1e3), ("µm", 1e-3)];
const ANGLES: [(&str, f64); 2] = [("rad", 180.0 / std::f64::consts::PI), ("turns", 360.0)];

/// Whether the slave goes as far as is wanted, or twice as far or half as far at most, unless between what its scaling is was said.
/// [`TuneError::Stroke`] if it does not.
pub(crate) fn refuse_stroke(
    file: &CamFile,
    wanted: &CamUse,
    fit: &Fit,
    said: Option<[f64; 2]>,
) -> Result<(), TuneError> {
    let Estimate { value, half_width } = fit.estimates[3];
    let of = wanted.coupling.input.slave_scaling.abs();
    let (strokes, known) = (value.abs() / of, half_width / of);
    if said.is_some() || !strokes.is_finite() || (1.0 / STROKES..=STROKES).contains(&strokes) {
        return Ok(());
    }
    let unit = file.slave.unit();
    let units: &[(&str, f64)] = match unit {
        "mm" => &LENGTHS,
        "deg" | "°" => &ANGLES,
        _ => &[],
    };
    // Where the run has the other unit, positions are that part of what they are in the cam's.
    let near = |size: f64| known + DEVIATION / size;
    let other = units.iter().find(|(_, size)| (strokes - 1.0 / size).abs() <= near(*size));
    let guess = other.map_or_else(
        || "is it recorded in other units than the cam's?".to_owned(),
        |(name, _)| format!("is it recorded in {name}, and the cam in {unit}?"),
    );
    let strokes = if strokes < 1.0 {
        format!("1/{}", significant(1.0 / strokes, 4))
    } else {
        significant(strokes, 4)
    };
    Err(TuneError::Stroke { scaling: value, strokes, guess })
}

/// How often a master at this velocity passes the cam in a second, if that is more often than machines do.
pub(crate) fn passes_too_often(file: &CamFile, using: &CamUse) -> Option<f64> {
    let curve = file.cam.curve();
    let scaled = using.master.velocity * using.coupling.input.master_scaling;
    let passes = (scaled / (curve.end() - curve.start())).abs();
    (passes.is_finite() && passes > PASSES_PER_S).then_some(passes)
}
