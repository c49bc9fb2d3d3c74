//! `twin cam plot`: plot of a cam.

use super::options::{LimitOptions, MasterOptions, UseOptions, load};
use crate::cam::check::CamCheck;
use crate::cam::picture::{Recorded, Shown, cam_chart};
use crate::command::atomic_file;
use crate::command::{Failure, Status};
use std::path::PathBuf;
use twin_cam::Largest;
use twin_number::{at_most, readable};

/// Draw a cam: position, velocity, acceleration and jerk of the slave over the master, and the tappets
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The cam
    #[arg(value_name = "CAM")]
    cam: PathBuf,

    /// The picture
    #[arg(long, short, value_name = "FILE.svg")]
    output: PathBuf,

    #[command(flatten)]
    master: MasterOptions,

    #[command(flatten)]
    limits: LimitOptions,

    #[command(flatten)]
    coupling: UseOptions,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    atomic_file::check_picture(&arguments.output)?;
    let read = [arguments.cam.as_path()].into_iter().chain(arguments.limits.machine_file());
    atomic_file::check_targets(None, read, [("--output", arguments.output.as_path())])?;
    let file = load(&arguments.cam, arguments.coupling.interpolation)?;
    let limits = arguments.limits.limits(&file)?;
    let using = arguments.coupling.using(&file, arguments.master.motion(), limits);
    let check = CamCheck::new(&file, using);
    let short = |value: f64| readable(value, 6);
    let fastest = match &check.largest {
        Ok(Largest { value, limited: Some((quantity, place)) }) => format!(
            "; at most {} {}/s: {quantity} at {}",
            at_most(*value, 6),
            file.master.unit(),
            short(using.master_at(*place))
        ),
        _ => String::new(),
    };
    let below = format!(
        "master at {} {}/s, {}{fastest}",
        short(using.master.velocity),
        file.master.unit(),
        check.smoothness()
    );
    let name = file.cam.name().to_owned();
    let shown = Shown { file: &file, using: &using, name: &name };
    let heading = format!("{name} ({})", file.path.display());
    let chart = cam_chart(&heading, &below, &[shown], &Recorded::default());
    atomic_file::write(&arguments.output, chart.svg().as_bytes())?;
    Ok(Status::Fit)
}
