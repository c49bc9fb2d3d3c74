//! `twin axes`: forward and inverse kinematics as a calculator, and probing moves of one axis.

use super::options::MachineOption;
use super::{Failure, Status};
use nalgebra::Point3;
use std::io;
use twin_kinematics::{AxisVector, Coordinate, Kinematics, Pose};
use twin_machine::Machine;
use twin_machine::limited_read::LimitedLines;
use twin_number::significant;

/// Largest position of an axis or coordinate, mm or degrees.
const FARTHEST: f64 = 1e9;
/// Digits of the answers.
const DIGITS: usize = 12;

/// Convert tool positions to axis positions and back: CSV lines from standard input to standard output
///
/// A line that cannot be converted gives `error,REASON`; the exit status is then 1. Positions are those of the tool
/// tip in the machine frame; without a z the tip is where it is with every linear axis at 0, without a direction the tool
/// points as where programs start. Rotary axes go on from line to line: each answer is the one
/// nearest to the line before; modulo axes show their position within their period.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    direction: Direction,
}

#[derive(Debug, clap::Subcommand)]
enum Direction {
    /// Lines `x_mm,y_mm[,z_mm[,direction_deg]]` to the axes in machine-file order, in mm and degrees
    Inverse {
        #[command(flatten)]
        machine: MachineOption,
    },
    /// Lines with the axes in machine-file order, in mm and degrees, to `x_mm,y_mm,z_mm,direction_deg`
    Forward {
        #[command(flatten)]
        machine: MachineOption,
    },
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    match &arguments.direction {
        Direction::Inverse { machine } => {
            let machine = machine.load()?;
            let mut near = machine.middle();
            convert(|numbers| inverse(&machine, numbers, &mut near))
        }
        Direction::Forward { machine } => {
            let machine = machine.load()?;
            convert(|numbers| forward(&machine, numbers))
        }
    }
}

fn convert(mut line: impl FnMut(&[f64]) -> Result<Vec<f64>, String>) -> Result<Status, Failure> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        // Text in quotes may go on over lines, and numbers need none.
        .quoting(false)
        .from_reader(LimitedLines::new(io::stdin().lock()));
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(io::stdout().lock());
    let mut status = Status::Fit;
    let mut record = csv::ByteRecord::new();
    while reader.read_byte_record(&mut record).map_err(stdio)? {
        let answer = numbers(&record).and_then(|numbers| line(&numbers));
        match answer {
            Ok(values) => {
                let fields = values.into_iter().map(|value| significant(value, DIGITS));
                writer.write_record(fields).map_err(stdio)?;
            }
            Err(reason) => {
                status = Status::Unfit;
                writer.write_record(["error", &reason]).map_err(stdio)?;
            }
        }
        // Line by line, for whoever asks one question after the other through a pipe.
        writer.flush().map_err(Failure::Stdio)?;
    }
    Ok(status)
}

fn stdio(error: csv::Error) -> Failure {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => Failure::Stdio(error),
        other => Failure::Stdio(io::Error::other(format!("{other:?}"))),
    }
}

fn numbers(record: &csv::ByteRecord) -> Result<Vec<f64>, String> {
    record
        .iter()
        .map(|field| {
            let text = String::from_utf8_lossy(field);
            let shown = || text.chars().take(40).collect::<String>();
            match text.trim_matches('"').parse::<f64>() {
                Ok(number) if number.abs() <= FARTHEST => Ok(number),
                Ok(number) if number.is_finite() => {
                    Err(format!("`{}` is beyond ±{FARTHEST:e}", shown()))
                }
                _ => Err(format!("`{}` is not a number", shown())),
            }
        })
        .collect()
}

fn inverse(machine: &Machine, numbers: &[f64], near: &mut AxisVector) -> Result<Vec<f64>, String> {
    let (x, y, z, direction) = match *numbers {
        [x, y] => (x, y, None, None),
        [x, y, z] => (x, y, Some(z), None),
        [x, y, z, direction] => (x, y, Some(z), Some(direction.to_radians())),
        _ => {
            return Err(format!(
                "{} values; expected x_mm,y_mm[,z_mm[,direction_deg]]",
                numbers.len()
            ));
        }
    };
    let turns = machine.kinematics.coordinates().contains(&Coordinate::Direction);
    if let Some(direction) = direction.filter(|direction| *direction != 0.0 && !turns) {
        let (degrees, kind) = (direction.to_degrees(), machine.kind);
        return Err(format!("direction {degrees:.3} deg: a {kind} does not turn its tool"));
    }
    // Without a z the tool is where it is with every linear axis at 0.
    let z = z.map_or_else(|| machine.rest_height(), |z| z * 1e-3);
    let direction = direction.unwrap_or_else(|| machine.start_pose().direction);
    let pose = Pose { position: Point3::new(x * 1e-3, y * 1e-3, z), direction };
    let axes = machine.kinematics.inverse(&pose, near).map_err(|error| error.to_string())?;
    *near = axes;
    note_limits(machine, &axes);
    let shown = machine.kinematics.fold(&axes);
    Ok(machine
        .axes
        .iter()
        .zip(shown.iter())
        .map(|(axis, position)| axis.from_si(*position))
        .collect())
}

/// The transform knows no software limits; whoever uses it should.
fn note_limits(machine: &Machine, axes: &AxisVector) {
    for (axis, position) in machine.axes.iter().zip(axes.iter()) {
        let [low, high] = axis.position_limits;
        if !(low..=high).contains(position) {
            stderr!(
                "note: axis {} at {:.3} {unit} is beyond its limits {:.3} to {:.3} {unit}",
                axis.name,
                axis.from_si(*position),
                axis.from_si(low),
                axis.from_si(high),
                unit = axis.unit()
            );
        }
    }
}

fn forward(machine: &Machine, numbers: &[f64]) -> Result<Vec<f64>, String> {
    if numbers.len() != machine.axes.len() {
        let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        return Err(format!("{} values; expected {}", numbers.len(), names.join(",")));
    }
    let axes = machine.axes.iter().zip(numbers).map(|(axis, number)| axis.to_si(*number));
    let axes = AxisVector::from_values(axes);
    note_limits(machine, &axes);
    let pose = machine.kinematics.forward(&axes).map_err(|error| error.to_string())?;
    let position = pose.position * 1e3;
    Ok(vec![position.x, position.y, position.z, pose.direction.to_degrees()])
}
