//! `twin machine`: what a machine file describes.

use super::{Failure, Status, show};
use crate::machine::Machine;
use comfy_table::{Cell, CellAlignment};
use std::io::{self, Write};
use std::path::PathBuf;
use twin_kinematics::Kinematics;

/// Check a machine file and show what it describes
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Machine file (TOML)
    #[arg(value_name = "FILE")]
    machine: PathBuf,

    /// Print the machine as URDF instead
    #[arg(long)]
    urdf: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let machine = Machine::load(&arguments.machine)?;
    let mut out = io::stdout().lock();
    if arguments.urdf {
        let text = machine.model.to_urdf()?;
        writeln!(out, "{text}").map_err(Failure::Stdio)?;
    } else {
        describe(&mut out, &machine).map_err(Failure::Stdio)?;
    }
    Ok(Status::Fit)
}

fn describe(out: &mut impl Write, machine: &Machine) -> io::Result<()> {
    writeln!(out, "{}: {} with {} axes", machine.name, machine.kind, machine.axes.len())?;
    let mut table = show::table();
    table.set_header([
        "axis",
        "kind",
        "limits",
        "velocity",
        "acceleration",
        "jerk",
        "drive",
        "increments",
    ]);
    for axis in &machine.axes {
        let unit = axis.unit();
        let [low, high] = axis.position_limits.map(|limit| axis.from_si(limit));
        let drive = axis.drive.as_ref().and_then(|drive| {
            let device = machine.drives.get(drive.device)?;
            let letter = ["X", "Y", "Z", "A", "B"].get(drive.index)?;
            Some((
                format!("{} {letter}", device.name),
                format!("{} per {} {unit}", drive.ratio.increments, drive.ratio.per_units),
            ))
        });
        let (drive, increments) = drive.unwrap_or_else(|| ("–".to_owned(), "–".to_owned()));
        let row = [
            axis.name.clone(),
            format!("{:?}", axis.kind).to_lowercase(),
            format!("{low:.1} … {high:.1} {unit}"),
            format!("{:.1} {unit}/s", axis.from_si(axis.max_velocity)),
            format!("{:.1} {unit}/s²", axis.from_si(axis.max_acceleration)),
            axis.max_jerk
                .map_or("–".to_owned(), |jerk| format!("{:.1} {unit}/s³", axis.from_si(jerk))),
            drive,
            increments,
        ];
        table.add_row(row.into_iter().enumerate().map(|(column, text)| {
            let right = (2..6).contains(&column);
            Cell::new(text).set_alignment(if right {
                CellAlignment::Right
            } else {
                CellAlignment::Left
            })
        }));
    }
    writeln!(out, "{table}")?;
    let mass: f64 = machine
        .model
        .links
        .iter()
        .filter_map(|link| link.inertial.map(|inertial| inertial.mass))
        .sum();
    writeln!(out, "moving mass {mass:.2} kg in {} links", machine.model.links.len())?;
    for device in &machine.drives {
        let port = device.port.as_deref().unwrap_or("no port given");
        writeln!(
            out,
            "drive {}: InterpCNC on {port}, station {}, {} baud",
            device.name, device.station, device.baud
        )?;
    }
    let [x, y, z] = machine.conditions.start.map(|value| value * 1e3);
    write!(out, "start of programs that do not say where: X{x} Y{y} Z{z}")?;
    match machine.start_axes() {
        Some(axes) => {
            let axes: Vec<_> = machine
                .axes
                .iter()
                .zip(axes.iter())
                .map(|(axis, position)| {
                    format!("{} {:.3} {}", axis.name, axis.from_si(*position), axis.unit())
                })
                .collect();
            writeln!(out, " = {}", axes.join(", "))?;
        }
        None => {
            writeln!(out, ", which the machine cannot reach: such programs must begin with G92")?;
        }
    }
    let zero = twin_kinematics::AxisVector::zeros(machine.axes.len());
    if let Ok(pose) = machine.kinematics.forward(&zero) {
        let tip = pose.position * 1e3;
        writeln!(
            out,
            "tool tip with all axes at 0: ({:.3}, {:.3}, {:.3}) mm in the machine frame",
            tip.x, tip.y, tip.z
        )?;
    }
    Ok(())
}
