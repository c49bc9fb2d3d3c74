//! Small convex programs for Clarabel: min ½·xᵀ·P·x + qᵀ·x with some rows A·x = b, and others A·x ≤ b.
//!
//! Those of the feed (`motion/limit/convex.rs`) have thousands of unknowns, each beside its neighbours, and settings of their own
//! for that; these have a few, and Clarabel's own settings.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

/// A program, row by row.
#[derive(Debug)]
pub(super) struct Program {
    linear: Vec<f64>,
    quadratic: Sparse,
    equal: Sparse,
    most: Sparse,
    right: [Vec<f64>; 2],
}

/// What a program comes to. Of the multipliers and of what is left, those of equations come first.
#[derive(Debug)]
pub(super) struct Solution {
    pub(super) x: Vec<f64>,
    /// How much each row is left below its right side.
    pub(super) left: Vec<f64>,
    /// How much each row holds the cost back.
    pub(super) push: Vec<f64>,
}

/// Entries of a matrix by columns, each with its row.
#[derive(Debug)]
struct Sparse {
    columns: Vec<Vec<(usize, f64)>>,
    rows: usize,
}

impl Sparse {
    fn new(columns: usize) -> Self {
        Self { columns: vec![Vec::new(); columns], rows: 0 }
    }

    fn add(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (column, value) in entries {
            if let Some(column) = self.columns.get_mut(column).filter(|_| value != 0.0) {
                column.push((self.rows, value));
            }
        }
        self.rows += 1;
    }

    /// This one above the other.
    fn above(mut self, other: Self) -> Self {
        for (column, below) in self.columns.iter_mut().zip(other.columns) {
            column.extend(below.into_iter().map(|(row, value)| (self.rows + row, value)));
        }
        self.rows += other.rows;
        self
    }

    fn matrix(self) -> CscMatrix<f64> {
        let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for (row, value) in self.columns.iter().flatten() {
            indices.push(*row);
            values.push(*value);
        }
        starts.extend(self.columns.iter().scan(0, |sum, column| {
            *sum += column.len();
            Some(*sum)
        }));
        CscMatrix::new(self.rows, self.columns.len(), starts, indices, values)
    }
}

impl Program {
    /// As many unknowns as costs, and no rows.
    pub(super) fn new(linear: Vec<f64>) -> Self {
        let [quadratic, equal, most] = [(); 3].map(|()| Sparse::new(linear.len()));
        Self { linear, quadratic, equal, most, right: [Vec::new(), Vec::new()] }
    }

    /// Sets P, which is symmetric, by what is on and right of its diagonal: once, row by row.
    pub(super) fn curve(&mut self, rows: impl IntoIterator<Item = Vec<(usize, f64)>>) {
        rows.into_iter().for_each(|row| self.quadratic.add(row));
    }

    /// Adds the row Σ factor·x = `right`.
    pub(super) fn equal(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        self.equal.add(entries);
        let [equal, _] = &mut self.right;
        equal.push(right);
    }

    /// Adds the row Σ factor·x ≤ `right`.
    pub(super) fn most(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        self.most.add(entries);
        let [_, most] = &mut self.right;
        most.push(right);
    }

    /// Solves it.
    ///
    /// # Errors
    /// Clarabel's own word for why there is no solution of at least nearly the quality that it aims at.
    pub(super) fn solved(self) -> Result<Solution, SolverStatus> {
        let Self { linear, mut quadratic, equal, most, right: [mut right, of_most] } = self;
        quadratic.rows = linear.len();
        let mut cones = Vec::with_capacity(2);
        if equal.rows > 0 {
            cones.push(SupportedConeT::ZeroConeT(equal.rows));
        }
        cones.push(SupportedConeT::NonnegativeConeT(most.rows));
        right.extend(of_most);
        let settings: DefaultSettings<f64> =
            DefaultSettingsBuilder::default().verbose(false).build().unwrap_or_default();
        let (p, a) = (quadratic.matrix(), equal.above(most).matrix());
        let mut solver = DefaultSolver::new(&p, &linear, &a, &right, &cones, settings)
            .map_err(|_invalid| SolverStatus::Unsolved)?;
        solver.solve();
        let solution = solver.solution;
        match solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                Ok(Solution { x: solution.x, left: solution.s, push: solution.z })
            }
            status => Err(status),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Program;
    use clarabel::solver::SolverStatus;

    /// The place of least x² + x·y + y² − 3·x on x − y = 1 and x ≤ ½: the equation leaves 3·x² − 6·x + …, so the limit holds x.
    #[test]
    fn equations_and_limits() {
        let mut program = Program::new(vec![-3.0, 0.0]);
        program.curve([vec![(0, 2.0), (1, 1.0)], vec![(1, 2.0)]]);
        program.most([(0, 1.0)], 0.5);
        program.equal([(0, 1.0), (1, -1.0)], 1.0);
        program.most([(1, 1.0)], 8.0);
        let found = program.solved().expect("a solution");
        assert!((found.x[0] - 0.5).abs() < 1e-7 && (found.x[1] + 0.5).abs() < 1e-7, "{found:?}");
        // x holds with 6·(1 − ½), the other limit is 8½ away and holds nothing.
        assert!((found.push[1] - 3.0).abs() < 1e-6 && found.push[2].abs() < 1e-6, "{found:?}");
        assert!(found.left[1].abs() < 1e-7 && (found.left[2] - 8.5).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn what_contradicts_itself_is_told() {
        let mut program = Program::new(vec![1.0]);
        program.most([(0, 1.0)], -1.0);
        program.most([(0, -1.0)], -1.0);
        assert_eq!(program.solved().expect_err("none"), SolverStatus::PrimalInfeasible);
    }
}
