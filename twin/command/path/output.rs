//! Writers for the formats that are written element by element.

use super::{Format, Job, jsonl};
use crate::command::Failure;
use std::io::{self, Write};
use twin_gcode::din66025::{ProgramWriter, WriteError};
use twin_gcode::rs274;
use twin_kinematics::WorkFrame;
use twin_path::PathElement;
use twin_path::dxf::{DxfWriteError, DxfWriter};

type Out<'a> = &'a mut dyn Write;

/// Writes elements.
pub(super) enum Writer<'a> {
    Jsonl { out: Out<'a>, frame: WorkFrame },
    Din66025(Box<ProgramWriter<Out<'a>>>),
    Rs274(Box<rs274::ProgramWriter<Out<'a>>>),
    Dxf(Box<DxfWriter<Out<'a>>>),
}

impl<'a> Writer<'a> {
    /// Begins a file of `format`, which is one of these.
    pub(super) fn new(format: Format, job: &Job<'_>, out: Out<'a>) -> Result<Self, Failure> {
        Ok(match format {
            Format::Din66025 => {
                Self::Din66025(Box::new(ProgramWriter::new(out, Some(job.name)).map_err(said)?))
            }
            Format::Rs274 => {
                let options = rs274::WriteOptions { control: job.control, ..Default::default() };
                let writer = rs274::ProgramWriter::new(out, options).map_err(said)?;
                Self::Rs274(Box::new(writer))
            }
            Format::Dxf => {
                Self::Dxf(Box::new(DxfWriter::new(out).map_err(|error| match error {
                    DxfWriteError::Io(source) => Failure::Stdio(source),
                    DxfWriteError::Frame(error) => Failure::Usage(error.to_string()),
                })?))
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
            Self::Rs274(writer) => writer.write(element).map_err(said),
            Self::Dxf(writer) => writer.write(element).map_err(Failure::Stdio),
        }
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Jsonl { .. } => Ok(()),
            Self::Din66025(writer) => writer.finish().map(|_| ()).map_err(said),
            Self::Rs274(writer) => writer.finish().map(|_| ()).map_err(said),
            Self::Dxf(writer) => writer.finish().map(|_| ()).map_err(Failure::Stdio),
        }
    }
}

/// What a program cannot express, with what helps.
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
