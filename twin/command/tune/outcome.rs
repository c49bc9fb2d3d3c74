//! Output of tuning: the picture, and the changed file.

use super::report::Report;
use crate::cam::edit;
use crate::cam::picture::{RampPicture, Recorded, Shown, cam_chart, ramp_chart};
use crate::cam::run::RecordedRun;
use crate::cam::tune::ramp_of;
use crate::command::Failure;
use crate::command::atomic_file;
use std::path::Path;
use twin_cam::Cam;
use twin_machine::cam_file::{CamFile, Form};

pub(super) fn picture(
    path: &Path,
    file: &CamFile,
    after: &CamFile,
    report: &Report<'_>,
    run: Option<&RecordedRun>,
) -> Result<(), Failure> {
    let mut recorded = Recorded::default();
    // Whole passes on it is the same cam; the nearest pass is compared.
    let drawn = report.after.beside(&report.before, file);
    if let Some(run) = run {
        // On one pass of the cam, where the picture is.
        let using = &drawn;
        let input = &using.coupling.input;
        let place = |master: f64| {
            let x = master * input.master_scaling + input.master_offset;
            let (inside, passes) = if using.repeated { file.cam.curve().wrap(x) } else { (x, 0.0) };
            (using.master_at(inside), passes * file.cam.curve().rise() * input.slave_scaling)
        };
        let point = |sample: &crate::cam::run::RunSample| {
            let (master, gained) = place(sample.master);
            (master, sample.slave - gained)
        };
        recorded.points = run.samples.iter().map(point).collect();
        for (slot, errors) in recorded.errors.iter_mut().zip(report.run_errors(run)) {
            let mut errors: Vec<_> =
                errors.into_iter().map(|(master, error)| (place(master).0, error)).collect();
            errors.sort_by(|one, other| one.0.total_cmp(&other.0));
            *slot = errors;
        }
    }
    let shown = [
        Shown { file, using: &report.before, name: "before" },
        Shown { file: after, using: &drawn, name: "after" },
    ];
    let heading = format!("{} ({})", file.cam.name(), file.path.display());
    let page = if let (Some((_, ramp)), Some(wish)) = (&report.ramp, &report.start) {
        let picture = RampPicture {
            wish,
            before: ramp_of(&report.before, wish, ramp),
            after: *ramp,
            units: [file.master.unit(), file.slave.unit()],
        };
        ramp_chart(&format!("start onto {heading}"), &report.headline(), &picture)
            .map_err(|error| Failure::Usage(format!("the picture cannot be drawn: {error}")))?
    } else {
        cam_chart(&heading, &report.headline(), &shown, &recorded)
    };
    atomic_file::write(path, page.svg().as_bytes())
}

/// Writes what was found: into the text of a TOML file, comments kept, or as a new one.
pub(super) fn apply(
    file: &CamFile,
    after: &CamFile,
    report: &Report<'_>,
    target: Option<&Path>,
) -> Result<(), Failure> {
    let target = target.unwrap_or(&file.path);
    if Form::of(target).map_err(Box::new)? != Form::Toml {
        let message = format!("{}: what was found is written as .toml", target.display());
        return Err(Failure::Usage(message));
    }
    let wrong = |message: String| Failure::Usage(format!("{}: {message}", target.display()));
    let text = match &file.text {
        Some(text) if file.form == Form::Toml => {
            edit::apply(text, &report.changes).map_err(|error| wrong(error.to_string()))?
        }
        _ => {
            let mut other = after.clone();
            other.coupling = report.after.coupling;
            other.to_toml()
        }
    };
    // The text must say what was found, or nothing is written.
    let again = CamFile::from_toml(target, text.clone()).map_err(Box::new)?;
    let same = again.coupling == report.after.coupling
        && again.cam.shape() == after.cam.shape()
        && has_tappets(&again.cam, &after.cam);
    if !same {
        return Err(wrong("the file cannot be changed so that it says what was found".to_owned()));
    }
    atomic_file::write(target, text.as_bytes())?;
    stderr!("written to {}", target.display());
    Ok(())
}

/// Whether the tappets are the same; those of different groups at one place may come in any order.
fn has_tappets(one: &Cam, other: &Cam) -> bool {
    let [one, other] = [one, other].map(|cam| {
        let mut tappets = cam.tappets().to_vec();
        tappets.sort_by(|a, b| a.master.total_cmp(&b.master).then(a.group.cmp(&b.group)));
        tappets
    });
    one == other
}
