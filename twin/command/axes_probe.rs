//! `twin axes probe`: a probing move of one axis of the simulated machine.

use super::options::{InLoopOption, MachineOption};
use super::{Failure, Status};
use crate::machine::{Axis, DriveFamily, Machine};
use crate::number::significant;
use crate::probe::{AxisProbe, AxisProbeEnd};
use crate::simulated::Simulated;
use std::io::{self, Write};
use twin_kinematics::AxisVector;

/// Digits of the answers.
const DIGITS: usize = 12;

/// Let one axis of the simulated machine go until its tool touches what the machine file says is there
///
/// As `ICNC_CMD_PROBE` (command 40) of an InterpCNC board does, and a PLC with `MC_TouchProbe`: where the axis is when the probe
/// trips is latched, then it is braked to rest. Prints `tripped,LATCHED,REST` in mm or degrees, `not tripped` (the end of
/// the stroke came first) or `already tripped`; the exit status of these two is 1.
///
/// An axis whose InterpCNC board is in the loop (`--drives-in-loop`) is moved by the board's own command 40: latched is its
/// counter, in whole steps.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    machine: MachineOption,

    /// The axis, as the machine file names it
    #[arg(long)]
    axis: String,

    /// How far it goes at most, mm or degrees; below 0: backwards
    #[arg(long, allow_negative_numbers = true, value_name = "MM|DEG")]
    stroke: f64,

    /// Where all axes are before, in machine-file order, mm and degrees [default: where programs start]
    #[arg(long, allow_hyphen_values = true, value_delimiter = ',', value_name = "MM|DEG,...")]
    from: Vec<f64>,

    /// Velocity of the search, mm/s or degrees/s
    #[arg(long, default_value_t = 5.0)]
    velocity: f64,

    /// Velocity at which it may start and stop at once, as step motors do [default: 0; of a board in the loop, its own]
    #[arg(long)]
    start_velocity: Option<f64>,

    /// Acceleration to the velocity of the search, mm/s² or degrees/s²
    #[arg(long, default_value_t = 100.0)]
    acceleration: f64,

    /// Deceleration to rest
    #[arg(long, default_value_t = 100.0)]
    deceleration: f64,

    /// Where a trip counts, from and to (`WindowOnly`, `FirstPosition` and `LastPosition` of `MC_TouchProbe`), mm or degrees
    /// [default: everywhere]
    #[arg(
        long,
        allow_hyphen_values = true,
        value_delimiter = ',',
        num_args = 1,
        value_name = "MM|DEG,..."
    )]
    window: Vec<f64>,

    #[command(flatten)]
    in_loop: InLoopOption,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let mut machine = arguments.machine.load()?;
    arguments.in_loop.apply(&mut machine)?;
    let (index, axis) = find(&machine, &arguments.axis)?;
    let start_velocity = arguments.start_velocity.unwrap_or_else(|| default_start(&machine, axis));
    let above = [
        ("--velocity", arguments.velocity),
        ("--acceleration", arguments.acceleration),
        ("--deceleration", arguments.deceleration),
    ];
    for (option, value) in above {
        if !(value.is_finite() && value > 0.0) {
            return Err(Failure::Usage(format!("{option} {value}: it has to be above 0")));
        }
    }
    if arguments.stroke == 0.0 {
        return Err(Failure::Usage("--stroke 0: the axis would go nowhere".to_owned()));
    }
    let from = start(&machine, &arguments.from)?;
    check_way(axis, from.get(index).copied().unwrap_or_default(), start_velocity, arguments)?;
    let window = match arguments.window[..] {
        [] => None,
        [first, last] => Some([first, last].map(|place| axis.to_si(place))),
        _ => return Err(Failure::Usage("--window needs two places: FROM,TO".to_owned())),
    };
    let probe = AxisProbe {
        axis: index,
        stroke: axis.to_si(arguments.stroke),
        start_velocity: axis.to_si(start_velocity),
        velocity: axis.to_si(arguments.velocity),
        acceleration: axis.to_si(arguments.acceleration),
        deceleration: axis.to_si(arguments.deceleration),
        window,
    };
    if machine.collision.is_none() {
        let message = format!(
            "{} says nothing of what the probe could touch: see [[obstacles]] in machines/gantry3_vice.toml",
            machine.path.display()
        );
        return Err(Failure::Usage(message));
    }
    let mut simulated =
        Simulated::new(&machine, &from).map_err(|error| Failure::Usage(error.to_string()))?;
    let end = probe
        .run(&machine, &mut simulated)
        .map_err(|error| Failure::Usage(format!("axis {}: {error}", axis.name)))?;
    let mut out = io::stdout().lock();
    // A nanometre is no more than rounding.
    let shown = |value: f64| significant((axis.from_si(value) * 1e6).round() * 1e-6 + 0.0, DIGITS);
    let (said, status) = match end {
        AxisProbeEnd::Tripped { latched, rest } => {
            (format!("tripped,{},{}", shown(latched), shown(rest)), Status::Fit)
        }
        AxisProbeEnd::NotTripped => ("not tripped".to_owned(), Status::Unfit),
        AxisProbeEnd::AlreadyTripped => ("already tripped".to_owned(), Status::Unfit),
    };
    writeln!(out, "{said}").map_err(Failure::Stdio)?;
    Ok(status)
}

/// What an axis starts at: nothing, or what the ramps of its board do.
fn default_start(machine: &Machine, axis: &Axis) -> f64 {
    let device = axis.drive.as_ref().and_then(|drive| machine.drives.get(drive.device));
    match device.filter(|device| device.in_loop).map(|device| &device.family) {
        Some(DriveFamily::InterpCnc(board)) => {
            axis.from_si(f64::from(board.start_stop_hz) / axis.increments_per_si().abs())
        }
        _ => 0.0,
    }
}

/// Whether the axis may do that.
fn check_way(
    axis: &Axis,
    from: f64,
    start_velocity: f64,
    arguments: &Arguments,
) -> Result<(), Failure> {
    let unit = axis.unit();
    let end = axis.from_si(from) + arguments.stroke;
    let [low, high] = axis.position_limits.map(|limit| axis.from_si(limit));
    if !(low..=high).contains(&end) {
        return Err(Failure::Usage(format!(
            "--stroke {}: axis {} would come to {end:.3} {unit}, beyond its limits {low:.3} to {high:.3} {unit}",
            arguments.stroke, axis.name
        )));
    }
    let most = [
        ("--velocity", arguments.velocity, axis.max_velocity, ""),
        ("--start-velocity", start_velocity, axis.max_velocity, ""),
        ("--acceleration", arguments.acceleration, axis.max_acceleration, "/s"),
        ("--deceleration", arguments.deceleration, axis.max_deceleration, "/s"),
    ];
    for (option, value, most, per) in most {
        let most = axis.from_si(most);
        if !(0.0..=most).contains(&value) {
            return Err(Failure::Usage(format!(
                "{option} {value}: axis {} has 0 to {most:.3} {unit}/s{per}",
                axis.name
            )));
        }
    }
    Ok(())
}

fn find<'m>(machine: &'m Machine, name: &str) -> Result<(usize, &'m Axis), Failure> {
    let mut axes = machine.axes.iter().enumerate();
    axes.find(|(_, axis)| axis.name == name).ok_or_else(|| {
        let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        Failure::Usage(format!("--axis {name}: the machine has {}", names.join(", ")))
    })
}

/// Where all axes are before the move, within their limits.
fn start(machine: &Machine, from: &[f64]) -> Result<AxisVector, Failure> {
    if from.is_empty() {
        return machine.start_axes().ok_or_else(|| {
            Failure::Usage("the machine cannot be where programs start: say --from".to_owned())
        });
    }
    if from.len() != machine.axes.len() {
        let message = format!(
            "--from has {} values; the machine has {} axes",
            from.len(),
            machine.axes.len()
        );
        return Err(Failure::Usage(message));
    }
    for (axis, value) in machine.axes.iter().zip(from) {
        let [low, high] = axis.position_limits.map(|limit| axis.from_si(limit));
        if !(low..=high).contains(value) {
            let unit = axis.unit();
            let message = format!(
                "--from: axis {} at {value} {unit} is beyond its limits {low:.3} to {high:.3} {unit}",
                axis.name
            );
            return Err(Failure::Usage(message));
        }
    }
    let axes = machine.axes.iter().zip(from).map(|(axis, value)| axis.to_si(*value));
    Ok(AxisVector::from_values(axes))
}
