//! Fit of a recorded run: offsets and scalings.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, RunSample};
use super::TuneError;
use super::correction::of_coupling;
use twin_cam::file::clean;
use twin_cam::tune::{Estimate, Fit, FitError, FitOptions, Free, Sample, fit};
use twin_machine::cam_file::CamFile;
use twin_number::significant;

/// Finds offsets and scalings in a run, beginning with those in use; `between` says between what `MasterOffset`, `MasterScaling`,
/// `SlaveOffset` and `SlaveScaling` are, where that is known.
/// [`TuneError::Fit`] if the run does not determine them, or contradicts the cam or itself.
pub(crate) fn fit_run(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    free: Free,
    between: [Option<[f64; 2]>; 4],
) -> Result<Fit, TuneError> {
    let from = of_coupling(using);
    let options = FitOptions { free, from, repeated: using.repeated, between };
    let samples: Vec<_> = run
        .samples
        .iter()
        .map(|sample| Sample { master: sample.master, slave: sample.slave, weight: 1.0 })
        .collect();
    let found = fit(file.cam.curve(), &samples, &options).map_err(|error| match error {
        // Lines of the file, not numbers of samples.
        FitError::Outliers { outliers } => {
            let line = |index: usize| run.samples.get(index.wrapping_sub(1)).map(|one| one.line);
            let in_file = |(index, by): (usize, f64)| Some((line(index)?, by));
            TuneError::Outliers { outliers: outliers.into_iter().filter_map(in_file).collect() }
        }
        other => TuneError::Fit(other),
    })?;
    if found.is_noise(samples.len()) {
        Ok(found)
    } else {
        let (correlation, rms, unit) = (found.correlation, found.rms, file.slave.unit().to_owned());
        let named = using.coupling.numbers().into_iter().zip(found.estimates).zip(free.list());
        let sought = named.filter(|(_, sought)| *sought);
        let values: Vec<_> = sought
            .map(|(((_, name, _), found), _)| format!("{name} {}", significant(found.value, 4)))
            .collect();
        Err(TuneError::NoNoise { correlation, rms, unit, nearest: values.join(", ") })
    }
}

/// Refuses a slave that goes more than twice as far as is wanted, or less than half as far.
/// [`TuneError::Stroke`] if it does.
pub(crate) fn refuse_stroke(wanted: &CamUse, fit: &Fit) -> Result<(), TuneError> {
    let scaling = fit.estimates[3].value;
    let strokes = (scaling / wanted.coupling.input.slave_scaling).abs();
    let other = strokes.is_finite() && !(0.5..=2.0).contains(&strokes);
    if other { Err(TuneError::Stroke { scaling, strokes }) } else { Ok(()) }
}

/// The value to a thousandth of its interval: digits beyond say nothing. What was given stays as it is.
pub(crate) fn rounded(estimate: Estimate) -> f64 {
    let Estimate { value, half_width } = estimate;
    if !(half_width > 0.0 && half_width.is_finite()) {
        return clean(value);
    }
    let unit = 10_f64.powf((half_width * 1e-3).log10().floor());
    // Through text: a multiple of a power of ten is not the nearest number to its decimal.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited just before"
    )]
    let decimals = (-unit.log10().round()).clamp(0.0, 15.0) as usize;
    format!("{value:.decimals$}").parse().unwrap_or(value)
}

/// How far the slave of a run was from the cam: master and error of each sample.
pub(crate) fn errors(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Vec<(f64, f64)> {
    let error = |sample: &RunSample| {
        (sample.master, sample.slave - super::slave_on_cam(file, using, sample.master))
    };
    run.samples.iter().map(error).collect()
}

pub(crate) fn rms(errors: &[(f64, f64)]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = errors.len().max(1) as f64;
    (errors.iter().map(|(_, error)| error * error).sum::<f64>() / count).sqrt()
}
