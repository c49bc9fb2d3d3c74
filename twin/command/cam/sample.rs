//! `twin cam sample`: sample a cam as a table.

use super::options::{MasterOptions, UseOptions, load, positive};
use crate::cam::check::AxisLimits;
use crate::cam::sample::{MOST, Sampling, write};
use crate::command::atomic_file;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::command::{Failure, Status};
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Sample a cam: CSV of master, slave and its velocity, acceleration and jerk with the master at its velocity
///
/// With --master-acceleration or --master-jerk the least and the greatest acceleration and jerk of the slave follow: those
/// that it may have there, as acceleration and jerk of the master are anywhere between both signs.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The cam
    #[arg(value_name = "CAM")]
    cam: PathBuf,

    /// Number of places at equal distances, both ends included
    #[arg(long, value_name = "N", default_value = "361", value_parser = count)]
    points: usize,

    /// Distance of the places, in units of the cam; its end is always one
    #[arg(long, value_name = "U", conflicts_with = "points", value_parser = positive)]
    step: Option<f64>,

    /// Write into this file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    master: MasterOptions,

    #[command(flatten)]
    coupling: UseOptions,
}

fn count(text: &str) -> Result<usize, String> {
    let count: usize =
        text.parse().ok().ok_or_else(|| format!("`{text}` is not a number of points"))?;
    if (2..=MOST).contains(&count) {
        Ok(count)
    } else {
        Err(format!("{count} is not between 2 and {MOST}"))
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let file = load(&arguments.cam, arguments.coupling.interpolation)?;
    let using = arguments.coupling.using(&file, arguments.master.motion(), AxisLimits::NONE);
    let sampling = arguments.step.map_or(Sampling::Count(arguments.points), Sampling::Step);
    let curve = file.cam.curve();
    sampling
        .check(curve.start(), curve.end())
        .map_err(|error| Failure::Usage(format!("--step: {error}")))?;
    if let Some(path) = &arguments.output {
        atomic_file::check_targets(
            None,
            [arguments.cam.as_path()],
            [("--output", path.as_path())],
        )?;
        let mut out = AtomicFile::create(path)?;
        write(&file, &using, sampling, &mut out).map_err(|error| unwritable(path, error))?;
        out.finish()?;
    } else {
        let mut out = BufWriter::new(io::stdout().lock());
        write(&file, &using, sampling, &mut out).map_err(Failure::Stdio)?;
        out.flush().map_err(Failure::Stdio)?;
    }
    Ok(Status::Fit)
}
