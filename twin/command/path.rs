//! `twin path`: the path elements a program is made of.

use super::options::{ReadOptions, unreadable};
use super::{Failure, Status, show};
use crate::finding;
use crate::machine::Machine;
use crate::number::significant;
use crate::program::ElementItem;
use nalgebra::{Point3, Vector3};
use serde_json::value::RawValue;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use twin_kinematics::WorkFrame;
use twin_motion::path::{ElementKind, PathElement, Shape};

/// Digits of the numbers written; a double is preserved by 17, and 12 are a picometre on a metre.
const DIGITS: usize = 12;

/// Print the path elements of a program, one JSON object per line
///
/// Positions are those of the tool tip in mm; with --machine its work frame is applied, else they are as programmed.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The program
    program: PathBuf,

    /// Machine file: its start position and work frame are applied
    #[arg(long, short, value_name = "FILE")]
    machine: Option<PathBuf>,

    #[command(flatten)]
    read: ReadOptions,

    /// Show the path after preparation (transition velocities)
    #[arg(long)]
    prepare: bool,

    /// Output format
    #[arg(long, value_enum, default_value = "jsonl")]
    format: Format,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Format {
    Jsonl,
}

#[derive(serde::Serialize)]
struct Row {
    line: u32,
    block: Option<u32>,
    kind: &'static str,
    start_mm: [Number; 3],
    end_mm: [Number; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    center_mm: Option<[Number; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<[Number; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sweep_deg: Option<Number>,
    length_mm: Number,
    feed_mm_per_s: Number,
    end_velocity_mm_per_s: Number,
}

type Number = Box<RawValue>;

fn number(value: f64) -> Number {
    let text = significant(value, DIGITS);
    // What is not finite is no JSON number; null says so.
    RawValue::from_string(text).unwrap_or_else(|_| RawValue::NULL.to_owned())
}

fn millimetres(point: &Point3<f64>) -> [Number; 3] {
    [number(point.x * 1e3), number(point.y * 1e3), number(point.z * 1e3)]
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let machine = arguments.machine.as_deref().map(Machine::load).transpose()?;
    let program = arguments.read.program(&arguments.program)?;
    eprintln!("{} is read as {}", program.path().display(), program.dialect().name());
    let frame = machine.as_ref().map_or_else(WorkFrame::identity, |machine| machine.frame);
    let start = machine.as_ref().map_or([0.0; 3], |machine| machine.start);
    let tolerance = arguments.prepare.then(|| {
        machine
            .as_ref()
            .map_or(crate::machine::DEFAULT_ANGLE_TOLERANCE, |machine| machine.angle_tolerance)
    });
    let mut findings = Vec::new();
    let mut out = BufWriter::new(io::stdout().lock());
    let mut elements =
        program.elements(start, tolerance).map_err(|source| unreadable(program.path(), source))?;
    for item in &mut elements {
        match item {
            ElementItem::Element(element) => {
                write_element(&mut out, &frame, &element).map_err(Failure::Stdio)?;
            }
            ElementItem::Diagnostic(finding) => findings.push(finding),
            ElementItem::Io(source) => return Err(unreadable(program.path(), source)),
        }
    }
    out.flush().map_err(Failure::Stdio)?;
    finding::sort(&mut findings);
    show::findings(&program, &findings);
    if elements.left_out() > 0 {
        eprintln!("… and {} more that are not kept", elements.left_out());
    }
    Ok(if finding::unfit(&findings) { Status::Unfit } else { Status::Fit })
}

fn write_element(out: &mut impl Write, frame: &WorkFrame, element: &PathElement) -> io::Result<()> {
    let arc = match &element.shape {
        Shape::Arc(arc) => Some(arc),
        Shape::Line { .. } => None,
    };
    let kind = match (element.kind, &element.shape) {
        (ElementKind::Rapid, _) => "rapid",
        (ElementKind::Jump, _) => "jump",
        (ElementKind::Cut, Shape::Line { .. }) => "line",
        (ElementKind::Cut, Shape::Arc(_)) => "arc",
    };
    let machine = |point: &Point3<f64>| millimetres(&frame.point_to_machine(point));
    let normal = frame.vector_to_machine(&Vector3::z());
    let row = Row {
        line: element.place.line,
        block: element.place.block,
        kind,
        start_mm: machine(&element.shape.start()),
        end_mm: machine(&element.shape.end()),
        center_mm: arc.map(|arc| machine(&arc.center())),
        normal: arc.map(|_| [number(normal.x), number(normal.y), number(normal.z)]),
        sweep_deg: arc.map(|arc| number(arc.sweep().to_degrees())),
        length_mm: number(element.length() * 1e3),
        feed_mm_per_s: number(element.feed * 1e3),
        end_velocity_mm_per_s: number(element.end_velocity * 1e3),
    };
    serde_json::to_writer(&mut *out, &row)?;
    writeln!(out)
}
