//! `twin cam convert`: convert a cam to another file format.

use super::options::{self, Between, load, magnitude};
use super::reduced::{ROUNDING, Wish, reduced, unusable};
use crate::cam::lost;
use crate::command::atomic_file;
use crate::command::{Failure, Status};
use clap::ValueEnum;
use std::path::PathBuf;
use twin_cam::{Cam, Compile, Curve, Interpolation, Peak, TableScale, VariableType};
use twin_machine::cam_file::{CamFile, Form, write_file};
use twin_number::significant;

/// Write a cam in another form: what it is read and written as say the endings of the files
///
/// .toml keeps everything: curve, straight lines, tappets, scales with units, [coupling]. .csv keeps points with velocity and
/// acceleration or the pairs of a table, and units in its header; .asc (ASCII table of SoftMotion) positions alone. What a form
/// does not keep is reported line by line.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    /// The cam
    #[arg(value_name = "IN")]
    from: PathBuf,

    /// What it is written to: .toml, .csv or .asc
    #[arg(value_name = "OUT")]
    to: PathBuf,

    /// Make a table of it, as SoftMotion compiles cams (manual 4.4.3): slave positions at equal distances of the
    /// master, or pairs, of which lines get only two
    #[arg(long, value_enum)]
    table: Option<TableKind>,

    /// Number of points of a table that is made, or for positions written as .asc or .csv
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1_048_576))]
    points: Option<u32>,

    /// Leave out points of a table as long as the slave stays within this distance of the cam, u
    #[arg(long, value_name = "U", value_parser = magnitude)]
    tolerance: Option<f64>,

    /// Type of the numbers of a table
    #[arg(long, value_enum, default_value = "lreal", requires = "table")]
    r#type: Numbers,

    /// What has the name OUT already is replaced
    #[arg(long)]
    force: bool,

    /// Between the points of tables that are made, or read from .csv and .asc [default: linear; with --tolerance as it was]
    #[arg(long, value_enum)]
    interpolation: Option<Between>,
}

const AFTER_HELP: &str = "\
Examples:
  twin cam convert measured.asc cam.toml --tolerance 0.01
  twin cam convert examples/cams/pick_and_place.toml pick.asc --points 721
  twin cam convert examples/cams/pick_and_place.toml table.toml --table pairs --points 128 --type int";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TableKind {
    Equidistant,
    Pairs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Numbers {
    Int,
    Uint,
    Dint,
    Udint,
    Real,
    Lreal,
}

impl From<Numbers> for VariableType {
    fn from(numbers: Numbers) -> Self {
        match numbers {
            Numbers::Int => Self::Int,
            Numbers::Uint => Self::Uint,
            Numbers::Dint => Self::Dint,
            Numbers::Udint => Self::Udint,
            Numbers::Real => Self::Real,
            Numbers::Lreal => Self::Lreal,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let form = Form::of(&arguments.to).map_err(Box::new)?;
    let from = [arguments.from.as_path()];
    atomic_file::check_targets(None, from, [("OUT", arguments.to.as_path())])?;
    atomic_file::refuse_existing(&arguments.to, arguments.force)?;
    let as_text = matches!(form, Form::Csv | Form::Ascii);
    let mut file = read(arguments, as_text)?;
    let whole_curve = file.cam.curve().clone();
    if let Some(kind) = arguments.table {
        file.cam = compiled(&file, kind, arguments)?;
        file.source = None;
    }
    let made = file.clone();
    if let Some(tolerance) = arguments.tolerance {
        // Text forms have straight lines between their points.
        let between = arguments.interpolation.or(as_text.then_some(Between::Linear));
        let wish = Wish { whole: &whole_curve, tolerance, between };
        let cam = reduced(&file, &wish)?;
        stderr!("{} points became {}", file.cam.shape().len(), cam.shape().len());
        file.cam = cam;
        file.source = None;
    }
    let points = arguments.points.map(|points| usize::try_from(points).unwrap_or(usize::MAX));
    let positions = if arguments.table.is_none() { points } else { None };
    let bytes = write_file(&file, &arguments.to, positions).map_err(Box::new)?;
    atomic_file::write(&arguments.to, &bytes)?;
    report(&made, &whole_curve, arguments)?;
    Ok(Status::Fit)
}

/// Reads the cam, and refuses options that would do nothing for it.
fn read(arguments: &Arguments, as_text: bool) -> Result<CamFile, Failure> {
    let Arguments { table, points, tolerance, .. } = arguments;
    let usage = |message: &str| Err(Failure::Usage(message.to_owned()));
    if points.is_some() && table.is_none() {
        if !as_text {
            return usage(
                "--points is for tables that are made (--table), and for positions written as .csv or .asc",
            );
        }
        if tolerance.is_some() {
            return usage(
                "--points writes positions at equal distances, --tolerance leaves some out: give one of them, or --table",
            );
        }
    }
    let makes_a_table = table.is_some() || tolerance.is_some();
    let file = if makes_a_table {
        options::read(&arguments.from, arguments.interpolation)?
    } else {
        load(&arguments.from, arguments.interpolation)?
    };
    if makes_a_table && file.is_tappets_only() {
        let message = "this cam has tappets alone: there is no curve to make a table of";
        return Err(Failure::Usage(format!("{}: {message}", arguments.from.display())));
    }
    Ok(file)
}

/// How many points there are, and how far what was written is from what was read.
fn report(file: &CamFile, whole: &Curve, arguments: &Arguments) -> Result<(), Failure> {
    let again = CamFile::load(&arguments.to, interpolation(arguments)).map_err(Box::new)?;
    let Peak { value: far, master: at } = whole.largest_distance(again.cam.curve());
    for line in lost(file, &again) {
        stderr!("{}: lost: {line}", arguments.to.display());
    }
    let unit = file.slave.unit();
    // Rounding of decimals that were cleaned moves nothing.
    let height = whole.extremes().position.magnitude();
    let difference = if far <= ROUNDING * height {
        "the slave is where it was everywhere".to_owned()
    } else {
        format!(
            "the slave is {} {unit} from where it was at most, at master {}",
            significant(far, 6),
            significant(at, 6)
        )
    };
    stderr!("{}: {} points; {difference}", arguments.to.display(), again.cam.shape().len());
    Ok(())
}

fn interpolation(arguments: &Arguments) -> Interpolation {
    arguments.interpolation.map_or(Interpolation::Linear, Interpolation::from)
}

fn compiled(file: &CamFile, kind: TableKind, arguments: &Arguments) -> Result<Cam, Failure> {
    let Some(source) = file.to_source() else {
        let message = "a table has no points and lines that another table could be made of";
        return Err(Failure::Usage(format!("{}: {message}", file.path.display())));
    };
    let Some(points) = arguments.points else {
        return Err(Failure::Usage("--table needs --points".to_owned()));
    };
    let points = usize::try_from(points).unwrap_or(usize::MAX);
    let variable = VariableType::from(arguments.r#type);
    let curve = file.cam.curve();
    let range = curve.extremes().position;
    // Whole numbers use the range of their type.
    let scale = |min: f64, max: f64| match variable {
        VariableType::Real | VariableType::Lreal => TableScale::IDENTITY,
        _ => {
            let (table_min, table_max) = variable.limits();
            let max = if max > min { max } else { min + 1.0 };
            TableScale { min, max, table_min, table_max }
        }
    };
    let (master, slave) = (scale(curve.start(), curve.end()), scale(range.min, range.max));
    let interpolation = interpolation(arguments);
    let mode = match kind {
        TableKind::Equidistant => Compile::Equidistant { points, variable, slave, interpolation },
        TableKind::Pairs => Compile::Elements { points, variable, master, slave, interpolation },
    };
    source.compile(mode).map_err(|error| unusable(file, &error))
}
