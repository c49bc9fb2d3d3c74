//! Cam table reduction: remove points within a tolerance.

use super::options::Between;
use crate::command::Failure;
use twin_cam::file::reduce;
use twin_cam::{Cam, CamError, Curve, Interpolation, PairTable, Shape, TableScale, VariableType};
use twin_machine::cam_file::CamFile;
use twin_number::{readable, significant};

/// Steps of the search for how many points may be left out: to a part in 4096 of the tolerance.
const STEPS: usize = 12;

/// A slave that is so little of the cam's height from where it should be is there.
pub(super) const ROUNDING: f64 = 1e-13;

/// Requirements of a table reduction.
pub(super) struct Wish<'a> {
    /// The cam to compare with.
    pub(super) whole: &'a Curve,
    /// Largest deviation of the slave, u.
    pub(super) tolerance: f64,
    /// Interpolation between the remaining points; unchanged if none is given.
    pub(super) between: Option<Between>,
}

/// The table of `file` with fewer points. The slave deviates from the whole cam by no more than the tolerance.
///
/// # Errors
/// If it is not a table, or all of its points are too few.
pub(super) fn reduced(file: &CamFile, wish: &Wish<'_>) -> Result<Cam, Failure> {
    let Table { pairs, positions } = Table::of(file, wish.between)?;
    let with = |within: f64| {
        let kept = reduce(&positions, within);
        let mut kept = kept.iter().peekable();
        let mut left = pairs.clone();
        let chosen = pairs.pairs.iter().zip(&positions);
        // Those that are kept are copies.
        let bits = |position: &[f64; 2]| position.map(f64::to_bits);
        let chosen = chosen
            .filter(|(_, position)| kept.next_if(|kept| bits(kept) == bits(position)).is_some());
        left.pairs = chosen.map(|(pair, _)| *pair).collect();
        of_table(file, left)
    };
    let far = |cam: &Cam| wish.whole.largest_distance(cam.curve()).value;
    let most = wish.tolerance + ROUNDING * wish.whole.extremes().position.magnitude();
    let cam = with(wish.tolerance)?;
    if far(&cam) <= most {
        return Ok(cam);
    }
    // The table deviates between its points already, which leaves less tolerance at them.
    let mut best = of_table(file, pairs.clone())?;
    let already = far(&best);
    if already > most {
        return Err(Failure::Usage(format!(
            "with all {} points of the table the slave is {} {} from the cam, more than --tolerance {}; make a table of more \
             points (--table, --points)",
            positions.len(),
            significant(already, 6),
            file.slave.unit(),
            readable(wish.tolerance, 6)
        )));
    }
    let (mut fits, mut fails) = (0.0, wish.tolerance);
    for _ in 0..STEPS {
        let within = f64::midpoint(fits, fails);
        let cam = with(within)?;
        if far(&cam) <= most {
            (fits, best) = (within, cam);
        } else {
            fails = within;
        }
    }
    Ok(best)
}

/// A table of pairs, and their positions.
struct Table {
    pairs: PairTable,
    positions: Vec<[f64; 2]>,
}

impl Table {
    fn of(file: &CamFile, between: Option<Between>) -> Result<Self, Failure> {
        let message = |own: Interpolation| between.map_or(own, Interpolation::from);
        match file.cam.shape() {
            Shape::Pairs(table) => {
                let position =
                    |[x, y]: &[f64; 2]| [table.master.position(*x), table.slave.position(*y)];
                let positions = table.pairs.iter().map(position).collect();
                let interpolation = message(table.interpolation);
                let periodic = file.repeated;
                Ok(Self {
                    pairs: PairTable { interpolation, periodic, ..table.clone() },
                    positions,
                })
            }
            Shape::Equidistant(table) => {
                let curve = file.cam.curve();
                let positions: Vec<_> = curve.joints().map(|x| [x, curve.at(x).position]).collect();
                // Masters at equal distances need not be whole numbers.
                let pairs = PairTable {
                    variable: VariableType::Lreal,
                    master: TableScale::IDENTITY,
                    slave: TableScale::IDENTITY,
                    periodic: file.repeated,
                    interpolation: message(table.interpolation),
                    pairs: positions.clone(),
                };
                Ok(Self { pairs, positions })
            }
            Shape::Polynomial(_) => {
                let message = "--tolerance is for tables: this cam has points with velocity and acceleration; \
                               make a table of it with --table pairs --points N";
                Err(Failure::Usage(message.to_owned()))
            }
        }
    }
}

fn of_table(file: &CamFile, table: PairTable) -> Result<Cam, Failure> {
    let cam = Cam::new(file.cam.name(), Shape::Pairs(table), file.cam.tappets().to_vec());
    cam.map_err(|error| unusable(file, &error))
}

pub(super) fn unusable(file: &CamFile, error: &CamError) -> Failure {
    Failure::Usage(format!("{}: {error}", file.path.display()))
}
