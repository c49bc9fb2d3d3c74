//! `twin machine`: check a machine file and describe the machine.

mod devices;
mod json;
mod motors;
mod text;

use super::options::{self, DEFAULT_ADDRESS, SceneOption};
use super::{Failure, Status, run};
use crate::command::atomic_file;
use crate::workspace::{Example, Section, View, Workspace, WorkspaceError, picture};
use std::io::{self, Write};
use std::net::SocketAddr;
use std::path::PathBuf;
use twin_machine::Machine;
use twin_viz::{SceneOptions, Viewer};

/// Check a machine file and show what the machine is and can do
///
/// Limits, drives, reach, workspace within the software limits and its singularity measure: how fast the tool goes in its
/// slowest direction for 1 of all axes together, 0 where there is a direction in which they cannot move it.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Machine file (TOML)
    #[arg(value_name = "FILE")]
    machine: PathBuf,

    #[command(flatten)]
    scene: SceneOption,

    /// Print the machine as URDF instead
    #[arg(long, conflicts_with_all = ["svg", "section", "height", "azimuth", "direction", "record", "serve", "format"])]
    urdf: bool,

    /// Draw a section through the workspace
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,

    /// Which section is drawn by --svg and shown by --record and --serve [default: horizontal]
    #[arg(long, value_enum)]
    section: Option<Which>,

    /// Height of the tool tip in the horizontal section, machine frame [default: where programs start, else the middle]
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    height: Option<f64>,

    /// Direction of the vertical section, from +x counter-clockwise. It goes through the axis of the first arm, or
    /// through where programs start
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    azimuth: f64,

    /// Direction of the tool, from +x counter-clockwise, for machines that turn it [default: where programs start]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    direction: Option<f64>,

    /// Write machine and section as a rerun recording
    #[arg(long, value_name = "OUT.rrd")]
    record: Option<PathBuf>,

    /// Show machine and section in the built-in web viewer, until Ctrl-C [default address: 127.0.0.1:9090]
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = DEFAULT_ADDRESS, value_parser = options::address)]
    serve: Option<SocketAddr>,

    /// Text for people, or one JSON object
    #[arg(long, value_enum, default_value = "human")]
    format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Which {
    /// Level, at --height
    Horizontal,
    /// Upright, in the direction --azimuth
    Vertical,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Human,
    Json,
}

/// Facts about a machine that are shown.
struct Facts<'m> {
    machine: &'m Machine,
    workspace: Workspace<'m>,
    horizontal: Section<'m>,
    /// `None` if the workspace has no height.
    vertical: Option<Section<'m>>,
    /// `None` if the axes cannot move the tool every way there.
    example: Option<Example>,
}

impl Arguments {
    fn view(&self) -> Result<View, Failure> {
        let numbers = [self.height, Some(self.azimuth), self.direction];
        if numbers.into_iter().flatten().any(|number| !number.is_finite()) {
            let message = "--height, --azimuth and --direction are finite numbers";
            return Err(Failure::Usage(message.to_owned()));
        }
        let is_shown = self.svg.is_some() || self.record.is_some() || self.serve.is_some();
        if self.section.is_some() && !is_shown {
            let message = "--section says which section is shown: give --svg, --record or --serve";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(View {
            height: self.height.map(|height| height * 1e-3),
            azimuth: self.azimuth.to_radians(),
            direction: self.direction.map(f64::to_radians),
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let view = arguments.view()?;
    let mut machine = Machine::load(&arguments.machine)?;
    arguments.scene.apply(&mut machine)?;
    let svg = arguments.svg.iter().map(|path| ("--svg", path.as_path()));
    let record = arguments.record.iter().map(|path| ("--record", path.as_path()));
    let read = [arguments.machine.as_path()].into_iter().chain(arguments.scene.file());
    atomic_file::check_targets(None, read, svg.chain(record))?;
    let mut out = io::stdout().lock();
    if arguments.urdf {
        let text = machine.model.to_urdf()?;
        writeln!(out, "{text}").map_err(Failure::Stdio)?;
        return Ok(Status::Fit);
    }
    let workspace = Workspace::survey(&machine, &view)?;
    let horizontal = workspace.horizontal();
    let vertical = match workspace.vertical() {
        Ok(section) => Some(section),
        Err(WorkspaceError::Flat) if arguments.section != Some(Which::Vertical) => None,
        Err(error) => return Err(error.into()),
    };
    let example = workspace.example(&horizontal).and_then(Result::ok);
    let facts = Facts { machine: &machine, workspace, horizontal, vertical, example };
    let section = match (arguments.section, &facts.vertical) {
        (Some(Which::Vertical), Some(vertical)) => vertical,
        _ => &facts.horizontal,
    };
    if let Some(path) = &arguments.svg {
        let text = picture(&facts.workspace, section, facts.example.as_ref());
        atomic_file::write(path, text.as_bytes())?;
    }
    let viewer = show(arguments, &facts, section)?;
    match arguments.format {
        Format::Human => text::describe(&mut out, &facts),
        Format::Json => json::describe(&mut out, &facts),
    }
    .and_then(|()| out.flush())
    .map_err(Failure::Stdio)?;
    if let Some(viewer) = viewer {
        let interrupt = run::Interrupt::catch_as_started()?;
        stderr!("the workspace is shown at {}", viewer.url());
        stderr!("{}", interrupt.how_it_ends());
        interrupt.wait();
    }
    Ok(Status::Fit)
}

/// Machine and section in space.
fn show(
    arguments: &Arguments,
    facts: &Facts<'_>,
    section: &Section<'_>,
) -> Result<Option<Viewer>, Failure> {
    if arguments.record.is_none() && arguments.serve.is_none() {
        return Ok(None);
    }
    let options = SceneOptions {
        record: arguments.record.clone(),
        serve: arguments.serve,
        ..SceneOptions::default()
    };
    Ok(crate::workspace::show(&options, &facts.workspace, section, facts.example.as_ref())?)
}
