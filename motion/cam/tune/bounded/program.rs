//! The quadratic program of a step: offset of the master, offset and scaling of the slave.

use super::super::convex;
use super::super::gentle::region::Region;
use super::{Aim, Bound, Problem, Values};
use nalgebra::{DMatrix, DVector};

/// Of the units in which the program is solved: so nearly rows that hold it are kept by what they alone say.
const KEPT: f64 = 1e-9;

/// Places of the unknowns among the four values.
const PLACES: [usize; 3] = [0, 2, 3];

/// ½ · zᵀ · `matrix` · z + `slope` · z is to be small, with z = (x − `from`) / `units`; `matrix` has ones on its diagonal.
pub(super) struct Program {
    from: Values,
    /// Which of the four values each unknown is, and its unit.
    unknowns: Vec<(usize, f64)>,
    matrix: DMatrix<f64>,
    slope: DVector<f64>,
    /// Between what the offset of the master may be, and what says so.
    offsets: Option<([f64; 2], Bound)>,
}

/// factors · z ≤ room.
struct Row {
    factors: DVector<f64>,
    room: f64,
    bound: Bound,
}

impl Program {
    /// What is to be small about some values, with the errors as straight as they are there.
    pub(super) fn new(problem: &Problem<'_>, from: &Values) -> Self {
        let mut all = [[0.0; 3]; 3];
        let mut slopes = [0.0; 3];
        let mut add = |weight: f64, error: f64, by: [f64; 3]| {
            for ((row, slope), one) in all.iter_mut().zip(&mut slopes).zip(by) {
                *slope += weight * error * one;
                for (slot, other) in row.iter_mut().zip(by) {
                    *slot += weight * one * other;
                }
            }
        };
        match problem.aim {
            Aim::Error(samples) => {
                for sample in samples {
                    let (error, by) = problem.error(from, sample);
                    add(sample.weight, error, by);
                }
            }
            Aim::Change => {
                let [_, (shift, stroke), (factor, scaling)] = problem.changes(from);
                add(1.0, shift, [0.0, 1.0 / stroke, 0.0]);
                add(1.0, factor, [0.0, 0.0, 1.0 / scaling]);
            }
        }
        let size = |index: usize| {
            let row: Option<&[f64; 3]> = all.get(index);
            row.and_then(|row| row.get(index)).copied().unwrap_or_default()
        };
        let free = |place: usize| problem.free.get(place).copied().unwrap_or_default();
        let kept: Vec<(usize, usize, f64)> = PLACES
            .into_iter()
            .enumerate()
            .filter(|(index, place)| free(*place) && size(*index) > 0.0)
            .map(|(index, place)| (index, place, 1.0 / size(index).sqrt()))
            .collect();
        let n = kept.len();
        let at = |row: usize| kept.get(row).copied().unwrap_or_default();
        let matrix = DMatrix::from_fn(n, n, |row, column| {
            let ((i, _, one), (j, _, other)) = (at(row), at(column));
            let entry = all.get(i).and_then(|row| row.get(j)).copied().unwrap_or_default();
            // What the unknowns have in common is never all of it: so there is one answer.
            entry * one * other * if row == column { 1.0 + 1e-12 } else { 1.0 }
        });
        let slope = DVector::from_fn(n, |row, _| {
            let (index, _, unit) = at(row);
            slopes.get(index).copied().unwrap_or_default() * unit
        });
        let unknowns = kept.into_iter().map(|(_, place, unit)| (place, unit)).collect();
        let bound = |master: f64| (problem.offsets(from[1]), Bound::Start { master });
        let offsets = problem.wish.start.map(bound);
        Self { from: *from, unknowns, matrix, slope, offsets }
    }

    /// The best values within a region, and the limits of the position that hold them; none if there is nothing to be found.
    pub(super) fn solved(&self, region: &Region) -> Option<(Values, Vec<Bound>)> {
        if self.unknowns.is_empty() {
            return None;
        }
        let rows = self.rows(region);
        let (z, active) = match self.held_by(&[]) {
            // Within everything without being held.
            Some((z, _)) if rows.iter().all(|row| row.factors.dot(&z) <= row.room) => {
                (z, Vec::new())
            }
            _ => self.by_clarabel(&rows)?,
        };
        let mut values = self.from;
        for ((place, unit), z) in self.unknowns.iter().zip(z.iter()) {
            if let Some(value) = values.get_mut(*place) {
                *value += unit * z;
            }
        }
        let position = |row: &&Row| matches!(row.bound, Bound::Position { .. });
        let mut by: Vec<Bound> = active.into_iter().filter(position).map(|row| row.bound).collect();
        by.dedup();
        Some((values, by))
    }

    fn rows(&self, region: &Region) -> Vec<Row> {
        let [offset, _, shift, factor] = self.from;
        let row = |([of_offset, of_shift, of_factor], most, bound): ([f64; 3], f64, Bound)| {
            let factors = DVector::from_iterator(
                self.unknowns.len(),
                self.unknowns.iter().map(|(place, unit)| match place {
                    0 => of_offset * unit,
                    2 => of_shift * unit,
                    3 => of_factor * unit,
                    _ => 0.0,
                }),
            );
            let size = factors.norm();
            let now = of_offset * offset + of_shift * shift + of_factor * factor;
            let room = (most - now) / size;
            // From a place that is left, but for rounding.
            (size > 0.0).then(|| Row { factors: factors / size, room: room.max(0.0), bound })
        };
        let of_slave = region
            .demands()
            .map(|([of_factor, of_shift], most, bound)| ([0.0, of_shift, of_factor], most, bound));
        let of_master = self.offsets.into_iter().flat_map(|([low, high], bound)| {
            [([1.0, 0.0, 0.0], high, bound), ([-1.0, 0.0, 0.0], -low, bound)]
        });
        of_slave.chain(of_master).filter_map(row).collect()
    }

    fn by_clarabel<'r>(&self, rows: &'r [Row]) -> Option<(DVector<f64>, Vec<&'r Row>)> {
        let n = self.unknowns.len();
        // In units of the way that is left, so that the last digits count however short it is.
        let scale = self.slope.amax().max(f64::MIN_POSITIVE);
        let mut program =
            convex::Program::new(self.slope.iter().map(|slope| slope / scale).collect());
        program.curve((0..n).map(|row| {
            let entries = self.matrix.row(row).into_iter().copied().enumerate();
            entries.skip(row).collect()
        }));
        for row in rows {
            program.most(row.factors.iter().copied().enumerate(), row.room / scale);
        }
        let solution = program.solved().ok()?;
        let mut active: Vec<(f64, &Row)> = rows
            .iter()
            .zip(solution.push.iter().zip(&solution.left))
            .filter(|(_, (push, left))| push > left)
            .map(|(row, (push, _))| (*push, row))
            .collect();
        active.sort_by(|one, other| other.0.total_cmp(&one.0));
        // Rows that hold it alone say where it is to the last digit; of rows that say the same, one.
        let mut holding: Vec<&Row> = Vec::new();
        for (_, row) in active {
            let same = |other: &&Row| row.factors.dot(&other.factors).abs() > 1.0 - KEPT;
            if !holding.iter().any(same) && holding.len() < n {
                holding.push(row);
            }
        }
        let exact = self.held_by(&holding).filter(|(z, push)| {
            let room = KEPT * z.amax().max(1.0);
            rows.iter().all(|row| row.factors.dot(z) <= row.room + room)
                && push.iter().all(|push| *push >= -KEPT * scale)
        });
        let z = match exact {
            Some((z, _)) => z,
            None => DVector::from_iterator(n, solution.x.iter().map(|x| x * scale)),
        };
        Some((z, holding))
    }

    /// The least place on the edges of some rows, and how much each of them holds it back.
    fn held_by(&self, rows: &[&Row]) -> Option<(DVector<f64>, Vec<f64>)> {
        let (n, held) = (self.unknowns.len(), rows.len());
        let mut matrix = DMatrix::zeros(n + held, n + held);
        let mut right = DVector::zeros(n + held);
        matrix.view_mut((0, 0), (n, n)).copy_from(&self.matrix);
        right.rows_mut(0, n).copy_from(&-&self.slope);
        for (index, row) in rows.iter().enumerate() {
            matrix.view_mut((0, n + index), (n, 1)).copy_from(&row.factors);
            matrix.view_mut((n + index, 0), (1, n)).copy_from(&row.factors.transpose());
            right.rows_mut(n + index, 1).fill(row.room);
        }
        let found = matrix.lu().solve(&right)?;
        let z = found.rows(0, n).into_owned();
        let finite = found.iter().all(|value| value.is_finite());
        finite.then(|| (z, found.rows(n, held).iter().copied().collect()))
    }
}
