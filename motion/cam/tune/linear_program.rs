//! Small linear programs for Clarabel: min qᵀ·x with some rows A·x = b, and others A·x ≤ b.
//!
//! Those of the feed (`motion/planner/time_optimal/convex.rs`) have thousands of unknowns, each next to its neighbours, and settings of their own
//! for that; these have a few, and Clarabel's own settings.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

/// A program, row by row.
#[derive(Debug)]
pub(super) struct Program {
    linear: Vec<f64>,
    equal: Rows,
    most: Rows,
}

/// Rows of a sparse matrix, and their right sides.
#[derive(Debug, Default)]
struct Rows {
    entries: Vec<(usize, usize, f64)>,
    right: Vec<f64>,
}

impl Rows {
    fn add(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        let row = self.right.len();
        let entries = entries.into_iter().filter(|(_, value)| *value != 0.0);
        self.entries.extend(entries.map(|(column, value)| (row, column, value)));
        self.right.push(right);
    }
}

impl Program {
    /// As many unknowns as costs, and no rows.
    pub(super) fn new(linear: Vec<f64>) -> Self {
        Self { linear, equal: Rows::default(), most: Rows::default() }
    }

    /// Adds the row Σ factor·x = `right`.
    pub(super) fn equal(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        self.equal.add(entries, right);
    }

    /// Adds the row Σ factor·x ≤ `right`.
    pub(super) fn most(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        self.most.add(entries, right);
    }

    /// Solves it.
    ///
    /// # Errors
    /// Clarabel's status, if it finds no solution of nearly its own tolerance.
    pub(super) fn solved(self) -> Result<Vec<f64>, SolverStatus> {
        let Self { linear, equal, most } = self;
        let (n, equations, inequalities) = (linear.len(), equal.right.len(), most.right.len());
        let mut cones = vec![SupportedConeT::NonnegativeConeT(inequalities)];
        if equations > 0 {
            cones.insert(0, SupportedConeT::ZeroConeT(equations));
        }
        let below = most.entries.into_iter().map(|(row, column, by)| (equations + row, column, by));
        let entries = equal.entries.into_iter().chain(below);
        let (places, factors): (Vec<(usize, usize)>, Vec<f64>) =
            entries.map(|(row, column, factor)| ((row, column), factor)).unzip();
        let (rows, columns) = places.into_iter().unzip();
        let a = CscMatrix::new_from_triplets(equations + inequalities, n, rows, columns, factors);
        let right: Vec<f64> = equal.right.into_iter().chain(most.right).collect();
        let p = CscMatrix::zeros((n, n));
        let settings: DefaultSettings<f64> =
            DefaultSettingsBuilder::default().verbose(false).build().unwrap_or_default();
        let mut solver = DefaultSolver::new(&p, &linear, &a, &right, &cones, settings)
            .map_err(|_invalid| SolverStatus::Unsolved)?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(solver.solution.x),
            status => Err(status),
        }
    }
}
