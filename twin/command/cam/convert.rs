//! `twin cam convert`: a cam in another form.

use super::options::{Between, load, magnitude};
use crate::cam::{CamFile, Form, lost, write_file};
use crate::command::whole;
use crate::command::{Failure, Status};
use crate::number::significant;
use clap::ValueEnum;
use std::path::PathBuf;
use twin_motion::cam::file::reduce;
use twin_motion::cam::{
    Cam, CamError, Compile, Curve, Interpolation, PairTable, Peak, Shape, Source, TableScale,
    VariableType,
};

/// Write a cam in another form: what it is read and written as say the endings of the files
///
/// .toml and .cam keep everything: curve, straight lines, tappets, scales with units, [coupling]. .txt keeps points, lines,
/// tappets and scales, and refuses a cam with a [coupling]. .csv keeps points with velocity and acceleration or the pairs of a
/// table, and units in its header; .asc positions alone. What a form does not keep is told line by line.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    /// The cam
    #[arg(value_name = "IN")]
    from: PathBuf,

    /// What it is written to: .toml, .csv, .asc, .cam or .txt
    #[arg(value_name = "OUT")]
    to: PathBuf,

    /// Make a table of it, as SoftMotion compiles cams (manual 4.4.3): so many slave positions at equal distances of the
    /// master, or pairs of which lines get only two
    #[arg(long, value_enum)]
    table: Option<TableKind>,

    /// So many points for a table, or for positions written as .asc or .csv
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1_048_576))]
    points: Option<u32>,

    /// Leave out points of a table of pairs that straight lines between the others miss by no more than this, u
    #[arg(long, value_name = "U", value_parser = magnitude)]
    tolerance: Option<f64>,

    /// Type of the numbers of a table
    #[arg(long, value_enum, default_value = "lreal", requires = "table")]
    r#type: Numbers,

    /// What has the name OUT already is replaced
    #[arg(long)]
    force: bool,

    /// Between the points of tables that are made, or read from .csv and .asc
    #[arg(long, value_enum, default_value = "linear")]
    interpolation: Between,
}

const AFTER_HELP: &str = "\
Examples:
  twin cam convert measured.asc cam.toml --tolerance 0.01
  twin cam convert examples/cams/pick_and_place.toml pick.cam
  twin cam convert examples/cams/pick_and_place.toml pick.cam --table pairs --points 128 --type int";

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
    Form::of(&arguments.to).map_err(Box::new)?;
    let from = [arguments.from.as_path()];
    whole::check_targets(None, from, [("OUT", arguments.to.as_path())])?;
    whole::refuse_existing(&arguments.to, arguments.force)?;
    let mut file = load(&arguments.from, arguments.interpolation)?;
    let whole_curve = file.cam.curve().clone();
    if let Some(kind) = arguments.table {
        file.cam = compiled(&file, kind, arguments)?;
        file.source = None;
    }
    if let Some(tolerance) = arguments.tolerance {
        let (cam, before) = reduced(&file, tolerance, arguments)?;
        tell!("{before} points became {}", cam.shape().len());
        file.cam = cam;
        file.source = None;
    }
    let points = arguments.points.map(|points| usize::try_from(points).unwrap_or(usize::MAX));
    let positions = if arguments.table.is_none() { points } else { None };
    let bytes = write_file(&file, &arguments.to, positions).map_err(Box::new)?;
    whole::write(&arguments.to, &bytes)?;
    tell(&file, &whole_curve, arguments)?;
    Ok(Status::Fit)
}

/// How many points there are, and how far what was written is from what was read.
fn tell(file: &CamFile, whole: &Curve, arguments: &Arguments) -> Result<(), Failure> {
    let again = CamFile::load(&arguments.to, arguments.interpolation.into()).map_err(Box::new)?;
    let Peak { value: far, master: at } = whole.largest_distance(again.cam.curve());
    for line in lost(file, &again) {
        tell!("{}: lost: {line}", arguments.to.display());
    }
    let unit = file.slave.unit();
    // Rounding of decimals that were cleaned moves nothing.
    let height = whole.extremes().position.magnitude();
    let difference = if far <= 1e-13 * height {
        "the slave is where it was everywhere".to_owned()
    } else {
        format!(
            "the slave is {} {unit} from where it was at most, at master {}",
            significant(far, 6),
            significant(at, 6)
        )
    };
    tell!("{}: {} points; {difference}", arguments.to.display(), again.cam.shape().len());
    Ok(())
}

fn compiled(file: &CamFile, kind: TableKind, arguments: &Arguments) -> Result<Cam, Failure> {
    let source: Source = file.to_source().map_err(Box::new)?;
    let Some(points) = arguments.points else {
        return Err(Failure::Usage("--table needs --points".to_owned()));
    };
    let points = usize::try_from(points).unwrap_or(usize::MAX);
    let variable = VariableType::from(arguments.r#type);
    let curve = file.cam.curve();
    let range = curve.extremes().position;
    // What is no floating-point number uses the whole range of its type.
    let scale = |min: f64, max: f64| match variable {
        VariableType::Real | VariableType::Lreal => TableScale::IDENTITY,
        _ => {
            let (table_min, table_max) = variable.limits();
            let max = if max > min { max } else { min + 1.0 };
            TableScale { min, max, table_min, table_max }
        }
    };
    let (master, slave) = (scale(curve.start(), curve.end()), scale(range.min, range.max));
    let interpolation = Interpolation::from(arguments.interpolation);
    let mode = match kind {
        TableKind::Equidistant => Compile::Equidistant { points, variable, slave, interpolation },
        TableKind::Pairs => Compile::Elements { points, variable, master, slave, interpolation },
    };
    source.compile(mode).map_err(|error| unusable(file, &error))
}

/// With fewer points; and how many there were.
fn reduced(file: &CamFile, tolerance: f64, arguments: &Arguments) -> Result<(Cam, usize), Failure> {
    let pairs: Vec<[f64; 2]> = match file.cam.shape() {
        Shape::Pairs(table) => {
            let pair = |[x, y]: &[f64; 2]| [table.master.position(*x), table.slave.position(*y)];
            table.pairs.iter().map(pair).collect()
        }
        Shape::Equidistant(_) => {
            let curve = file.cam.curve();
            curve.joints().map(|x| [x, curve.at(x).position]).collect()
        }
        Shape::Polynomial(_) => {
            let message = "--tolerance is for tables: this cam has points with velocity and acceleration; \
                           make a table of it with --table pairs --points N";
            return Err(Failure::Usage(message.to_owned()));
        }
    };
    let shape = Shape::Pairs(PairTable {
        variable: VariableType::Lreal,
        master: TableScale::IDENTITY,
        slave: TableScale::IDENTITY,
        periodic: file.repeated,
        interpolation: arguments.interpolation.into(),
        pairs: reduce(&pairs, tolerance),
    });
    let cam = Cam::new(file.cam.name(), shape, file.cam.tappets().to_vec());
    Ok((cam.map_err(|error| unusable(file, &error))?, pairs.len()))
}

fn unusable(file: &CamFile, error: &CamError) -> Failure {
    Failure::Usage(format!("{}: {error}", file.path.display()))
}
