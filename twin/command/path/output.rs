//! Writers for the formats that are written element by element.

use super::{Format, Job, jsonl};
use crate::command::Failure;
use std::io::{self, Write};
use twin_gcode::din66025::{ProgramWriter, WriteError};
use twin_kinematics::WorkFrame;
use twin_path::PathElement;
use twin_path::dxf::{DxfWriteError, DxfWriter};
use twin_path::queue::{Generator, QueueWriteError, QueueWriter};

type Out<'a> = &'a mut dyn Write;

/// Writes elements.
pub(super) enum Writer<'a> {
    Jsonl { out: Out<'a>, frame: WorkFrame },
    Din66025(Box<ProgramWriter<Out<'a>>>),
    Dxf(Box<DxfWriter<Out<'a>>>),
    Queue(Box<QueueWriter<Out<'a>>>),
}

impl<'a> Writer<'a> {
    /// Begins a file of `format`, which is one of these.
    pub(super) fn new(format: Format, job: &Job<'_>, out: Out<'a>) -> Result<Self, Failure> {
        Ok(match format {
            Format::Din66025 => {
                Self::Din66025(Box::new(ProgramWriter::new(out, Some(job.name)).map_err(said)?))
            }
            Format::Dxf => {
                Self::Dxf(Box::new(DxfWriter::new(out).map_err(|error| match error {
                    DxfWriteError::Io(source) => Failure::Stdio(source),
                    DxfWriteError::Frame(error) => Failure::Usage(error.to_string()),
                })?))
            }
            Format::Queue => {
                let stage =
                    if job.prepare { Generator::CheckVelocities } else { Generator::Decoder };
                Self::Queue(Box::new(QueueWriter::new(out, stage).map_err(Failure::Stdio)?))
            }
            Format::Jsonl
            | Format::Svg
            | Format::Info
            | Format::Viewer
            | Format::Listing
            | Format::Setpoints => Self::Jsonl { out, frame: job.frame },
        })
    }

    pub(super) fn write(&mut self, element: &PathElement) -> Result<(), Failure> {
        match self {
            Self::Jsonl { out, frame } => {
                jsonl::write(*out, frame, element).map_err(Failure::Stdio)
            }
            Self::Din66025(writer) => writer.write(element).map_err(said),
            Self::Dxf(writer) => writer.write(element).map_err(Failure::Stdio),
            Self::Queue(writer) => writer.write(element).map_err(|error| match error {
                QueueWriteError::Io(source) => Failure::Stdio(source),
                error @ QueueWriteError::Content { .. } => Failure::Usage(error.to_string()),
            }),
        }
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Jsonl { .. } => Ok(()),
            Self::Din66025(writer) => writer.finish().map(|_| ()).map_err(said),
            Self::Dxf(writer) => writer.finish().map(|_| ()).map_err(Failure::Stdio),
            Self::Queue(writer) => writer.finish().map(|_| ()).map_err(Failure::Stdio),
        }
    }
}

/// What a program cannot say, with what helps.
fn said(error: WriteError) -> Failure {
    match error {
        WriteError::Io(source) => Failure::Stdio(source),
        WriteError::UprightArc(_) | WriteError::Curve(_) | WriteError::Cubic(_) => {
            Failure::Usage(format!("{error} (--linearise MM --arcs)"))
        }
        error => Failure::Usage(error.to_string()),
    }
}

/// Writing to the target fails.
pub(super) fn stdio(source: io::Error) -> Failure {
    Failure::Stdio(source)
}
