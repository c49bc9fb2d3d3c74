//! Convex programs, solved by bands ([`super::banded`]) or by Clarabel: min ½·xᵀ·P·x + qᵀ·x with A·x ≤ 1, P tridiagonal, rows of
//! a few neighbours, cones.

use super::banded::{BandAnswer, BandProgram, BandRow};
use super::bound::Constraint;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// A convex program whose variables are all of the order of 1.
///
/// Every right-hand side is 1, which spares the solver its equilibration and most of its iterations.
#[derive(Debug, Default)]
pub(super) struct Program {
    /// Diagonal of P, and what is right of it.
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    linear: Vec<f64>,
    /// Rows one after the other: where each ends in `entries`.
    ends: Vec<usize>,
    entries: Vec<(usize, f64)>,
    right: Vec<f64>,
    /// Where each row comes from.
    origins: Vec<Origin>,
    /// |three rows| ≤ 1.
    cones: Vec<(Cone, Origin)>,
    /// Rows that are left out as long as a solution keeps them.
    spare: Vec<Spare>,
    /// Largest number of iterations, if below the usual one.
    pub(super) most_iterations: Option<u32>,
}

/// A row that is left out.
#[derive(Clone, Copy, Debug)]
struct Spare {
    entries: [(usize, f64); 3],
    right: f64,
    origin: Origin,
}

impl Spare {
    fn is_broken(&self, x: &[f64]) -> bool {
        let value = |(index, factor): &(usize, f64)| x.get(*index).map_or(0.0, |x| factor * x);
        let kept = match self.origin.constraint {
            Constraint::AxisJerk(_) => KEPT_JERK,
            _ => KEPT,
        };
        self.entries.iter().map(value).sum::<f64>() > self.right + kept
    }
}

/// The cone |rows·x + given| ≤ 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cone {
    pub(super) rows: [[(usize, f64); 3]; 3],
    pub(super) given: [f64; 3],
}

/// Origin of a row: the cell and its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Origin {
    /// The cell, from that of the window.
    pub(super) cell: usize,
    /// The limit.
    pub(super) constraint: Constraint,
    /// True if it is the upper limit, of two that differ by their signs alone.
    pub(super) upper: bool,
    /// By how much the right side of the row grows where the limit does, both as parts of themselves.
    pub(super) share: f64,
}

/// A row that was left out has to be kept to within this part of the variables' scale.
const KEPT: f64 = 1e-5;
/// One of a jerk, which is allowed more between the places where it is limited, to within this.
const KEPT_JERK: f64 = 2e-3;

/// Where there is an answer it takes less than a third of these iterations.
const MOST_ITERATIONS: u32 = 100;
/// Largest number of banded steps, and the number of them that take the time of one iteration of Clarabel.
const MOST_STEPS: u32 = 60;
const CHEAPER: u32 = 4;

/// Less is rounding of the solver.
const NO_GAIN: f64 = 1e-9;

/// Solution of a solve.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) x: Vec<f64>,
    /// Sensitivities: the gain in cost if a limit were larger, per part of the limit, for every row that counts.
    pub(super) gains: Vec<(Origin, f64)>,
    /// Iterations of Clarabel, or their equivalent in time.
    pub(super) iterations: u32,
}

/// Clarabel came to no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("Clarabel ended with {status:?} after {iterations} iterations")]
pub struct NotSolved {
    /// Its own word for it.
    pub status: SolverStatus,
    /// Iterations until then.
    pub iterations: u32,
}

impl Program {
    /// Starts over with `variables` variables and no rows.
    pub(super) fn reset(&mut self, variables: usize) {
        for values in [&mut self.diagonal, &mut self.beside, &mut self.linear] {
            values.clear();
            values.resize(variables, 0.0);
        }
        self.ends.clear();
        self.entries.clear();
        self.right.clear();
        self.spare.clear();
        self.origins.clear();
        self.cones.clear();
    }

    /// Adds ½·p·x² + q·x for variable `index`.
    pub(super) fn add_cost(&mut self, index: usize, p: f64, q: f64) {
        if let (Some(diagonal), Some(linear)) =
            (self.diagonal.get_mut(index), self.linear.get_mut(index))
        {
            *diagonal += p;
            *linear += q;
        }
    }

    /// Adds p·xᵢ·xᵢ₊₁ for variable `index`.
    pub(super) fn add_coupling(&mut self, index: usize, p: f64) {
        if let Some(beside) = self.beside.get_mut(index) {
            *beside += p;
        }
    }

    /// Adds the row Σ coefficient·x ≤ `right`. Zero coefficients are left out.
    pub(super) fn add_row(&mut self, entries: &[(usize, f64)], right: f64, origin: Origin) {
        self.entries.extend(entries.iter().filter(|(_, value)| *value != 0.0));
        self.ends.push(self.entries.len());
        self.right.push(right);
        self.origins.push(origin);
    }

    /// Adds a row only once a solution does not keep it.
    pub(super) fn add_spare(&mut self, entries: [(usize, f64); 3], right: f64, origin: Origin) {
        self.spare.push(Spare { entries, right, origin });
    }

    /// Origins of the spare rows that `x` does not keep.
    pub(super) fn broken(&self, x: &[f64]) -> impl Iterator<Item = Origin> {
        self.spare.iter().filter(|row| row.is_broken(x)).map(|row| row.origin)
    }

    /// True if `x` does not keep a spare row that bounds a velocity from below.
    pub(super) fn goes_backwards(&self, x: &[f64]) -> bool {
        let below = |row: &&Spare| {
            !row.origin.upper && matches!(row.origin.constraint, Constraint::Velocity(_))
        };
        self.spare.iter().filter(below).any(|row| row.is_broken(x))
    }

    /// Adds the spare rows that `x` does not keep.
    pub(super) fn add_broken(&mut self, x: &[f64]) {
        let (broken, spare): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.spare).into_iter().partition(|row| row.is_broken(x));
        self.spare = spare;
        for row in broken {
            self.add_row(&row.entries, row.right, row.origin);
        }
    }

    /// Deducts iterations from those that are left, where they are counted.
    pub(super) fn count_down(&mut self, iterations: u32) {
        if let Some(most) = &mut self.most_iterations {
            *most = most.saturating_sub(iterations).max(1);
        }
    }

    /// Adds a cone.
    pub(super) fn add_cone(&mut self, cone: Cone, origin: Origin) {
        self.cones.push((cone, origin));
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.ends.len()
    }

    /// Sensitivities of the cost to the limits, from these multipliers.
    fn gains(&self, duals: &[f64]) -> Vec<(Origin, f64)> {
        let rows = self.origins.iter().zip(duals).zip(&self.right);
        let of_rows = rows.map(|((origin, dual), right)| (*origin, dual * right * origin.share));
        let tops = duals.get(self.rows()..).unwrap_or_default().chunks(4);
        let of_cones = self.cones.iter().zip(tops).map(|((_, origin), duals)| {
            (*origin, duals.first().copied().unwrap_or_default() * origin.share)
        });
        of_rows.chain(of_cones).filter(|(_, gain)| *gain > NO_GAIN).collect()
    }

    /// P as upper triangle.
    fn quadratic(&self) -> CscMatrix<f64> {
        let n = self.diagonal.len();
        let (mut starts, mut rows, mut values) =
            (Vec::with_capacity(n + 1), Vec::with_capacity(2 * n), Vec::with_capacity(2 * n));
        starts.push(0);
        let mut above = 0.0;
        for (column, (diagonal, beside)) in self.diagonal.iter().zip(&self.beside).enumerate() {
            if above != 0.0 {
                rows.push(column.saturating_sub(1));
                values.push(above);
            }
            rows.push(column);
            values.push(*diagonal);
            starts.push(values.len());
            above = *beside;
        }
        CscMatrix::new(n, n, starts, rows, values)
    }

    /// A by columns: first the rows, then the cones, four rows each of which the first is empty.
    fn constraints(&self) -> CscMatrix<f64> {
        let n = self.diagonal.len();
        let plain = self.ends.len();
        let rows = self.entries_by_row().chain(self.cones.iter().enumerate().flat_map(
            |(index, (cone, _))| {
                cone.rows.iter().zip(1..).flat_map(move |(row, offset)| {
                    let row_index = plain + 4 * index + offset;
                    let entries = row.iter().filter(|(_, value)| *value != 0.0);
                    // A cone holds right side minus row.
                    entries.map(move |(column, value)| (row_index, *column, *value))
                })
            },
        ));
        let mut starts = vec![0usize; n + 1];
        let mut count = 0;
        for (_, column, _) in rows.clone() {
            count += 1;
            if let Some(slot) = starts.get_mut(column + 1) {
                *slot += 1;
            }
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut next = starts.clone();
        let mut indices = vec![0usize; count];
        let mut values = vec![0.0; count];
        for (row, column, value) in rows {
            let Some(slot) = next.get_mut(column) else { continue };
            if let (Some(index), Some(entry)) = (indices.get_mut(*slot), values.get_mut(*slot)) {
                (*index, *entry) = (row, value);
            }
            *slot += 1;
        }
        CscMatrix::new(plain + 4 * self.cones.len(), n, starts, indices, values)
    }

    /// Row, column and value of the entries of the rows.
    fn entries_by_row(&self) -> impl Iterator<Item = (usize, usize, f64)> + Clone {
        let mut from = 0;
        self.ends.iter().enumerate().flat_map(move |(row, end)| {
            let entries = self.entries.get(from..*end).unwrap_or_default();
            from = *end;
            entries.iter().map(move |(column, value)| (row, *column, *value))
        })
    }

    /// Solves it to `tolerance` (of feasibility and, relative, of the cost): by bands, and by Clarabel where there are cones, or
    /// where the bands come to no answer.
    ///
    /// # Errors
    /// If Clarabel comes to no answer of at least nearly that quality.
    pub(super) fn solve(&self, tolerance: f64) -> Result<Answer, NotSolved> {
        self.solve_banded(tolerance).map_or_else(|| self.solve_with_clarabel(tolerance), Ok)
    }

    /// By bands; none where that comes to no answer.
    fn solve_banded(&self, tolerance: f64) -> Option<Answer> {
        if !self.cones.is_empty() {
            return None;
        }
        let mut from = 0;
        let rows = self.ends.iter().zip(&self.right).map(|(end, right)| {
            let entries = self.entries.get(from..*end).unwrap_or_default();
            from = *end;
            let first = entries.iter().map(|(index, _)| *index).min().unwrap_or_default();
            let mut row = BandRow { first, factors: [0.0; 3], right: *right };
            for (index, value) in entries {
                *row.factors.get_mut(index - first)? += value;
            }
            Some(row)
        });
        let rows: Vec<BandRow> = rows.collect::<Option<_>>()?;
        let (diagonal, beside, linear) = (&self.diagonal, &self.beside, &self.linear);
        let most = self.most_iterations.map_or(MOST_STEPS, |most| most.saturating_mul(CHEAPER));
        let BandAnswer { x, duals, iterations } =
            BandProgram { diagonal, beside, linear, rows: &rows }
                .solve(tolerance, most.min(MOST_STEPS))?;
        Some(Answer { x, gains: self.gains(&duals), iterations: iterations.div_ceil(CHEAPER) })
    }

    /// By Clarabel.
    fn solve_with_clarabel(&self, tolerance: f64) -> Result<Answer, NotSolved> {
        let (p, a) = (self.quadratic(), self.constraints());
        let plain = self.ends.len();
        let mut cones = vec![SupportedConeT::NonnegativeConeT(plain)];
        cones.extend(self.cones.iter().map(|_| SupportedConeT::SecondOrderConeT(4)));
        let mut right = self.right.clone();
        right.extend(self.cones.iter().flat_map(|(cone, _)| {
            let [x, y, z] = cone.given;
            [1.0, -x, -y, -z]
        }));
        let most = self.most_iterations.unwrap_or(MOST_ITERATIONS).min(MOST_ITERATIONS);
        let settings = DefaultSettings {
            verbose: false,
            max_iter: most,
            max_step_fraction: 0.995,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            equilibrate_enable: false,
            presolve_enable: false,
            direct_solve_method: "qdldl".to_owned(),
            max_threads: 1,
            // Rows of a few neighbours are well conditioned: what refinement takes is not worth it.
            iterative_refinement_enable: !self.cones.is_empty(),
            ..DefaultSettings::default()
        };
        let not_solved = |status, iterations| NotSolved { status, iterations };
        if self.diagonal.is_empty() {
            return Err(not_solved(SolverStatus::Unsolved, 0));
        }
        let mut solver = DefaultSolver::new(&p, &self.linear, &a, &right, &cones, settings)
            .map_err(|_invalid| not_solved(SolverStatus::NumericalError, 0))?;
        solver.solve();
        let solution = solver.solution;
        let iterations = solution.iterations;
        match solution.status {
            // One that was cut short is not as good as it could be.
            SolverStatus::Solved | SolverStatus::AlmostSolved
                if (solution.status == SolverStatus::Solved || iterations < most)
                    && solution.x.iter().all(|value| value.is_finite()) =>
            {
                let gains = self.gains(&solution.z);
                Ok(Answer { x: solution.x, gains, iterations })
            }
            status => Err(not_solved(status, iterations)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ORIGIN: Origin =
        Origin { cell: 0, constraint: Constraint::ToolAcceleration, upper: true, share: 1.0 };

    /// Program with rows that x = 1 satisfies with the given slack.
    fn program(
        costs: &[(f64, f64, f64)],
        rows: &[(prop::sample::Index, [f64; 3], f64)],
    ) -> Program {
        let mut program = Program::default();
        let count = costs.len();
        program.reset(count);
        for (index, (own, beside, linear)) in costs.iter().enumerate() {
            // ½·(own·xᵢ + beside·xᵢ₊₁)².
            program.add_cost(index, own * own, *linear);
            if index + 1 < count {
                program.add_cost(index + 1, beside * beside, 0.0);
                program.add_coupling(index, own * beside);
            }
        }
        for (index, factors, slack) in rows {
            let first = index.index(count);
            let entries: Vec<_> =
                (first..count).zip(*factors).filter(|(_, factor)| *factor != 0.0).collect();
            let sum: f64 = entries.iter().map(|(_, factor)| factor).sum();
            program.add_row(&entries, sum + slack, ORIGIN);
        }
        for index in 0..count {
            program.add_row(&[(index, 1.0)], 1.5, ORIGIN);
            program.add_row(&[(index, -1.0)], 0.5, ORIGIN);
        }
        program
    }

    fn cost(program: &Program, x: &[f64]) -> f64 {
        let own = program.diagonal.iter().zip(&program.linear).zip(x);
        let beside = program.beside.iter().zip(x.windows(2));
        own.map(|((p, q), x)| (0.5 * p * x + q) * x).sum::<f64>()
            + beside.map(|(p, pair)| p * pair[0] * pair[1]).sum::<f64>()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        /// Bands and Clarabel come to the same cost within the same rows, with multipliers that explain it.
        #[test]
        fn bands_come_to_what_clarabel_does(
            costs in prop::collection::vec((0.2..2.0_f64, -1.0..1.0_f64, -3.0..3.0_f64), 1..40),
            rows in prop::collection::vec(
                (any::<prop::sample::Index>(), [-2.0..2.0_f64, -2.0..2.0_f64, -2.0..2.0_f64], 0.0..0.5_f64), 0..80,
            ),
        ) {
            let program = program(&costs, &rows);
            let banded = program.solve_banded(1e-9).expect("there is an answer");
            let clarabel = program.solve_with_clarabel(1e-9).expect("there is an answer");
            let [one, other] = [&banded, &clarabel].map(|answer| cost(&program, &answer.x));
            prop_assert!((one - other).abs() <= 1e-7 * (1.0 + other.abs()), "{one} {other}");
            let gains = |answer: &Answer| answer.gains.iter().map(|(_, gain)| gain).sum::<f64>();
            let [first, second] = [&banded, &clarabel].map(gains);
            prop_assert!((first - second).abs() <= 1e-4 * (1.0 + second.abs()), "{first} {second}");
            let mut from = 0;
            for (end, right) in program.ends.iter().zip(&program.right) {
                let entries = &program.entries[from..*end];
                from = *end;
                let value: f64 = entries.iter().map(|(index, factor)| factor * banded.x[*index]).sum();
                prop_assert!(value <= right + 1e-8, "{value} {right}");
            }
        }
    }
}
