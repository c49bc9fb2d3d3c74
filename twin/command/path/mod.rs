//! `twin path`: print, prepare and convert the path of a program.

mod drawing;
mod file;
mod info;
mod jsonl;
mod numbers;
mod options;
mod output;
mod picture;
mod setpoints;
mod svg;

use super::options::{ReadOptions, controls, expect_path, unreadable};
use super::{Failure, Status, show};
use crate::command::atomic_file;
use crate::finding;
use crate::finding::Finding;
use crate::program::{Dialect, ElementItem, Elements, ProgramFile};
use drawing::DrawingOptions;
use file::Target;
use options::{OperationOptions, PreparationOptions};
use output::Writer;
use setpoints::SetpointOptions;
use std::io;
use std::path::{Path, PathBuf};
use twin_gcode::rs274::Control;
use twin_kinematics::WorkFrame;
use twin_machine::{Machine, ProgramConditions};

/// Print the path of a program, before or after preparation, or make something of it
///
/// Reads programs (DIN 66025, RS274) and drawings (DXF).
/// Writes path elements as JSON lines, programs, drawings, pictures and overviews.
/// Lengths are in mm, angles in degrees.
///
/// Examples:
///   twin path examples/plate.cnc --format info
///   twin path examples/plate.cnc --prepare --output plate.svg
///   twin path part.dxf --order nearest --safe-height 5 --cut-height -1 --output part.cnc
///   twin path part.cnc --rotate 90 --translate 100,0 --output turned.cnc
///   twin path program.ngc --linearise 0.5 --arcs --output program.cnc
///   twin path part.cnc --prepare --format rs274 --output part.nc
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Arguments {
    /// The program or drawing
    program: PathBuf,

    /// Machine file: its start position, work frame (in jsonl), and inputs of preparation are applied
    #[arg(long, short, value_name = "FILE")]
    machine: Option<PathBuf>,

    #[command(flatten)]
    read: ReadOptions,

    /// Control that an RS274 program was written for, with --format rs274, where --for is the control that shall read the result:
    /// its G4, M98, G70 and G71, and its F with rotary axes count [default: `control` of [rs274] in the machine file, or that of --for]
    #[arg(long, value_name = "CONTROL", value_parser = controls())]
    from: Option<Control>,

    /// What to write [default: by the ending of --output; din66025 with --one-per layer or section; else jsonl]
    #[arg(long, value_enum)]
    format: Option<Format>,

    /// File to write to, which is replaced when all is well (programs and drawings are not written of a program
    /// with errors); with --one-per layer or section a folder [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    preparation: PreparationOptions,

    #[command(flatten)]
    operations: OperationOptions,

    #[command(flatten)]
    setpoints: SetpointOptions,

    #[command(flatten)]
    drawing: DrawingOptions,
}

/// Output format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Path elements, one JSON object per line, in the machine frame
    Jsonl,
    /// A program in SoftMotion's dialect of DIN 66025 (.cnc)
    Din66025,
    /// A program in RS274, in mm, with canned cycles, loops and expressions carried out (.ngc .nc .tap .gcode)
    Rs274,
    /// A drawing: rapids on the layer RAPID, cuts on the layer CUT (.dxf)
    Dxf,
    /// Top view of the path (.svg); --prepare adds the path before preparation and a cross every 100 ms
    Svg,
    /// Key figures: name, lines, objects, length, duration, start, errors by rule
    Info,
    /// The blocks as a G-code viewer shows them: without comments, with the values of variables
    Viewer,
    /// The first ten lines of the program and the first ten objects of the queue
    Listing,
    /// Set-points as the interpolator makes them, one JSON object per ms, in the frame of the program
    Setpoints,
}

impl Format {
    /// The one that the name of a file asks for.
    fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_string_lossy().to_lowercase();
        Some(match &*ending {
            "jsonl" => Self::Jsonl,
            "cnc" => Self::Din66025,
            "ngc" | "nc" | "tap" | "gcode" => Self::Rs274,
            "dxf" => Self::Dxf,
            "svg" => Self::Svg,
            _ => return None,
        })
    }

    /// The ending of its files.
    const fn ending(self) -> &'static str {
        match self {
            Self::Jsonl | Self::Setpoints => "jsonl",
            Self::Din66025 => "cnc",
            Self::Rs274 => "ngc",
            Self::Dxf => "dxf",
            Self::Svg => "svg",
            Self::Info | Self::Viewer | Self::Listing => "txt",
        }
    }
}

impl Arguments {
    /// The format asked for, that of the output's ending, or the default.
    fn chosen_format(&self) -> Result<Format, Failure> {
        if let Some(format) = self.format {
            return Ok(format);
        }
        match &self.output {
            // Several programs are meant to be programs.
            _ if self.drawing.is_divided() => Ok(Format::Din66025),
            None => Ok(Format::Jsonl),
            Some(path) => Format::of(path).ok_or_else(|| {
                Failure::Usage(format!(
                    "the ending of {} is none of .jsonl .cnc .ngc .nc .tap .gcode .dxf .svg; say --format",
                    path.display()
                ))
            }),
        }
    }
}

/// The task for one program.
struct Job<'a> {
    program: &'a ProgramFile,
    /// Its name.
    name: &'a str,
    conditions: &'a ProgramConditions,
    frame: WorkFrame,
    prepare: bool,
    /// The control that reads the program that is written.
    control: Option<Control>,
    setpoints: &'a SetpointOptions,
    findings: Vec<Finding>,
    left_out: u64,
    elements: u64,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let machine = arguments.machine.as_deref().map(Machine::load).transpose()?;
    let mut conditions = machine
        .as_ref()
        .map_or_else(ProgramConditions::default, |machine| machine.conditions.clone());
    arguments.preparation.complete(&mut conditions);
    let mut settings = arguments.read.settings(conditions.rs274.units)?;
    settings.operations = arguments.operations.operations()?;
    let frame = machine.as_ref().map_or_else(WorkFrame::identity, |machine| machine.frame);
    let format = arguments.chosen_format()?;
    let mut control = None;
    if format == Format::Rs274 {
        // It reads what is written, not the source.
        control = settings.control.take();
        conditions.rs274.numbers_of = arguments.from.or(conditions.rs274.control).or(control);
        (conditions.rs274.control, conditions.rs274.keep_words) = (None, true);
    } else if arguments.from.is_some() {
        let message = "--from has no effect without --format rs274; --for says what the program is";
        return Err(Failure::Usage(message.to_owned()));
    }

    let source = &arguments.program;
    let (programs, notes) = if drawing::is_drawing(source, arguments.read.dialect)? {
        arguments.read.check_for(Some(Dialect::Dxf))?;
        arguments.drawing.import(source, &conditions, &settings)?
    } else {
        arguments.drawing.check_unused()?;
        let dialect = arguments.read.dialect_of(source)?;
        arguments.read.check_for(dialect)?;
        let program = ProgramFile::new(source, dialect, settings)?;
        expect_path(&program)?;
        (vec![(drawing::name(source), program)], Vec::new())
    };
    let dialect = programs.first().map_or("dxf", |(_, program)| program.dialect().name());
    stderr!("{} is read as {dialect}", source.display());
    for note in &notes {
        stderr!("{}: {note}", source.display());
    }
    if arguments.output.as_deref().is_some_and(|output| atomic_file::is_same(output, source)) {
        let message = format!("{} would be replaced by what is made of it", source.display());
        return Err(Failure::Usage(message));
    }
    let read = arguments.machine.as_deref().into_iter().chain(arguments.read.variables_file());
    let is_read = |output: &Path| read.clone().any(|read| atomic_file::is_same(output, read));
    if let Some(output) = arguments.output.as_deref().filter(|output| is_read(output)) {
        let message = format!("--output {}: it is read from; name another file", output.display());
        return Err(Failure::Usage(message));
    }
    let target = Target::new(arguments.output.as_deref(), arguments.drawing.is_divided())?;

    let mut status = Status::Fit;
    for (number, (name, program)) in (1..).zip(&programs) {
        let mut job = Job {
            program,
            name,
            conditions: &conditions,
            frame,
            prepare: arguments.preparation.prepare,
            control,
            setpoints: &arguments.setpoints,
            findings: Vec::new(),
            left_out: 0,
            elements: 0,
        };
        // What others would take for a whole program must be one.
        let mut file = target.open(number, name, format)?;
        job.write(format, &mut file).map_err(|failure| file.named(failure))?;
        let unfit = finding::unfit(&job.findings);
        let is_kept = match format {
            Format::Din66025 | Format::Rs274 | Format::Dxf => !unfit,
            Format::Setpoints => !unfit || target.is_stdout(),
            _ => true,
        };
        if is_kept {
            file.finish()?;
        } else {
            stderr!("{name} is not written: the program has errors");
        }
        finding::sort(&mut job.findings);
        show::findings(program, &job.findings, show::Shown::WithNotes);
        if job.left_out > 0 {
            stderr!("… and {} more that are not kept", job.left_out);
        }
        if unfit {
            status = Status::Unfit;
        }
        // The viewer shows blocks, not elements.
        if job.elements == 0 && !unfit && !matches!(format, Format::Viewer) {
            stderr!("{} has nothing in it that is a path", source.display());
            status = Status::Unfit;
        }
    }
    if programs.is_empty() {
        stderr!("{} has nothing in it that is a path", source.display());
        status = Status::Unfit;
    }
    Ok(status)
}

impl Job<'_> {
    fn write(&mut self, format: Format, out: &mut dyn io::Write) -> Result<(), Failure> {
        match format {
            Format::Info => return info::key_figures(self, out),
            Format::Viewer => return info::viewer(self, out),
            Format::Listing => return info::listing(self, out),
            Format::Svg => return svg::picture(self, out),
            Format::Setpoints => return setpoints::write(self, self.setpoints, out),
            Format::Jsonl | Format::Din66025 | Format::Rs274 | Format::Dxf => {}
        }
        let mut writer = Writer::new(format, self, out)?;
        let mut failed = None;
        self.each(|element| {
            if failed.is_none() {
                failed = writer.write(&element).err();
            }
            Ok(())
        })?;
        match failed {
            None => writer.finish(),
            // Errors of the program come first: what cannot be written may follow from them.
            Some(_) if finding::unfit(&self.findings) => Ok(()),
            Some(failure) => Err(failure),
        }
    }

    /// Its path as asked for.
    fn path(&self) -> Result<Elements, Failure> {
        let path = if self.prepare {
            self.program.prepared(self.conditions)
        } else {
            self.program.elements(self.conditions)
        };
        path.map_err(|source| unreadable(self.program.path(), source))
    }

    /// Hands on the elements of its path and keeps the findings.
    fn each(
        &mut self,
        take: impl FnMut(twin_path::PathElement) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let path = self.path()?;
        self.take(path, take)
    }

    fn take(
        &mut self,
        mut path: Elements,
        mut take: impl FnMut(twin_path::PathElement) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for item in &mut path {
            match item {
                ElementItem::Element(element) => {
                    self.elements += 1;
                    take(element)?;
                }
                ElementItem::Diagnostic(finding) => self.findings.push(finding),
                ElementItem::Io(source) => return Err(unreadable(self.program.path(), source)),
            }
        }
        self.left_out = path.left_out();
        if let Some((object, _)) = self.program.settings().operations.split
            && object >= path.decoded()
        {
            return Err(Failure::Usage(format!(
                "--split: there is no object {object}; the path has {}",
                path.decoded()
            )));
        }
        Ok(())
    }
}
