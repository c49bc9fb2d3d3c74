//! Banded interior-point method for quadratic programs whose rows have three neighbouring variables.
//!
//! Mehrotra's predictor and corrector for min ½·xᵀ·P·x + qᵀ·x with A·x + s = r and s ≥ 0. With the multipliers z of the rows,
//! a step solves (P + Aᵀ·(z/s)·A)·Δx = right side, a matrix of five diagonals. Its cost grows linearly with the number of rows.
//! If it fails, Clarabel solves the program ([`super::convex::Program::solve`]).

#![expect(clippy::indexing_slicing, reason = "bands and rows are as long as they are made")]

/// Length of a step, as a part of the way to the nearest bound.
const STEP: f64 = 0.995;
/// Least distance of a row from its bound at the start, and the product of distance and multiplier.
const FIRST_DISTANCE: f64 = 0.05;
const FIRST_PRODUCT: f64 = 2e-3;

/// A row: the first of its three neighbours, their coefficients, and its right side.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BandRow {
    pub(super) first: usize,
    pub(super) factors: [f64; 3],
    pub(super) right: f64,
}

impl BandRow {
    fn times(&self, x: &[f64]) -> f64 {
        let [a, b, c] = self.factors;
        a * x[self.first] + b * x[self.first + 1] + c * x[self.first + 2]
    }

    fn add(&self, factor: f64, to: &mut [f64]) {
        for (slot, value) in to[self.first..].iter_mut().zip(self.factors) {
            *slot += factor * value;
        }
    }
}

/// A program: P's diagonal and what is right of it, q, and the rows. Vectors of variables have two more entries, which are 0, so
/// that every row has three.
#[derive(Debug)]
pub(super) struct BandProgram<'p> {
    pub(super) diagonal: &'p [f64],
    pub(super) beside: &'p [f64],
    pub(super) linear: &'p [f64],
    pub(super) rows: &'p [BandRow],
}

/// The solution: variables, multipliers of the rows, and how many steps it took.
#[derive(Debug)]
pub(super) struct BandAnswer {
    pub(super) x: Vec<f64>,
    pub(super) duals: Vec<f64>,
    pub(super) iterations: u32,
}

/// State of a row: distance from its bound, multiplier, residual, and the changes of the first two.
#[derive(Clone, Copy, Debug, Default)]
struct RowState {
    s: f64,
    z: f64,
    wrong: f64,
    ds: f64,
    dz: f64,
}

impl RowState {
    /// Takes the changes that bring s·z down by `product`, where A·Δx is `change`.
    fn turn(&mut self, product: f64, change: f64) {
        self.ds = -self.wrong - change;
        self.dz = (-product - self.z * self.ds) / self.s;
    }

    /// The largest part of the changes that keeps both positive.
    fn room(&self) -> f64 {
        let until =
            |value: f64, change: f64| if change < 0.0 { -value / change } else { f64::INFINITY };
        until(self.s, self.ds).min(until(self.z, self.dz))
    }
}

impl BandProgram<'_> {
    /// Solves it to `tolerance`: rows absolutely, gradient and gap as parts of the cost's own size. None if that takes more than
    /// `most` steps or is impossible.
    pub(super) fn solve(&self, tolerance: f64, most: u32) -> Option<BandAnswer> {
        let (count, rows) = (self.diagonal.len(), self.rows);
        let size = self.linear.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        if rows.is_empty() || !(size > 0.0 && size.is_finite()) {
            return None;
        }
        // The variables are of the order of 1.
        let mut x = vec![1.0; count + 2];
        x[count..].fill(0.0);
        let begin = |row: &BandRow| {
            let s = (row.right - row.times(&x)).max(FIRST_DISTANCE);
            RowState { s, z: size * FIRST_PRODUCT / s, ..RowState::default() }
        };
        let mut states: Vec<RowState> = rows.iter().map(begin).collect();
        let mut gradient = vec![0.0; count + 2];
        let mut change = vec![0.0; count + 2];
        let mut band = Band::default();
        #[expect(clippy::cast_precision_loss, reason = "a number of rows")]
        let number = rows.len() as f64;
        for iterations in 0..=most {
            self.put_gradient(&x, &states, &mut gradient);
            let (mut product, mut wrong) = (0.0, 0.0_f64);
            for (row, state) in rows.iter().zip(&mut states) {
                state.wrong = row.times(&x) + state.s - row.right;
                wrong = wrong.max(state.wrong.abs());
                product += state.s * state.z;
            }
            let steep = gradient.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            if !(product + wrong + steep).is_finite() {
                return None;
            }
            if wrong <= tolerance
                && steep <= tolerance * size
                && product <= tolerance * self.cost(&x).abs().max(size)
            {
                x.truncate(count);
                let duals = states.iter().map(|state| state.z).collect();
                return Some(BandAnswer { x, duals, iterations });
            }
            band.put(self, &states);
            if !band.factor() {
                return None;
            }
            // Predictor, then corrector.
            self.step(&band, &gradient, &mut states, &mut change, |state| state.s * state.z);
            let room = states.iter().fold(1.0, |least: f64, state| least.min(state.room()));
            let after =
                |state: &RowState| (state.s + room * state.ds) * (state.z + room * state.dz);
            let left = states.iter().map(after).sum::<f64>() / product;
            let aim = left.powi(3) * product / number;
            self.step(&band, &gradient, &mut states, &mut change, |state| {
                state.s * state.z + state.ds * state.dz - aim
            });
            let room = states.iter().fold(1.0 / STEP, |least: f64, state| least.min(state.room()));
            let part = STEP * room;
            for (x, change) in x.iter_mut().zip(&change) {
                *x += part * change;
            }
            for state in &mut states {
                state.s += part * state.ds;
                state.z += part * state.dz;
            }
        }
        None
    }

    /// ½·xᵀ·P·x + qᵀ·x.
    fn cost(&self, x: &[f64]) -> f64 {
        let beside = self.beside.iter().zip(x).zip(&x[1..]).map(|((p, x), next)| p * x * next);
        let own = self.diagonal.iter().zip(self.linear).zip(x);
        own.map(|((p, q), x)| (0.5 * p * x + q) * x).sum::<f64>() + beside.sum::<f64>()
    }

    /// P·x + q + Aᵀ·z.
    fn put_gradient(&self, x: &[f64], states: &[RowState], gradient: &mut [f64]) {
        gradient.fill(0.0);
        for (index, ((p, beside), q)) in
            self.diagonal.iter().zip(self.beside).zip(self.linear).enumerate()
        {
            gradient[index] += p * x[index] + beside * x[index + 1] + q;
            gradient[index + 1] += beside * x[index];
        }
        for (row, state) in self.rows.iter().zip(states) {
            row.add(state.z, gradient);
        }
        gradient[self.diagonal.len()..].fill(0.0);
    }

    /// Solves for the changes that make the gradient 0, the rows right and s·z less by `product`.
    fn step(
        &self,
        band: &Band,
        gradient: &[f64],
        states: &mut [RowState],
        change: &mut [f64],
        product: impl Fn(&RowState) -> f64,
    ) {
        for (slot, gradient) in change.iter_mut().zip(gradient) {
            *slot = -gradient;
        }
        for (row, state) in self.rows.iter().zip(states.iter()) {
            row.add((product(state) - state.z * state.wrong) / state.s, change);
        }
        band.solve(change);
        for (row, state) in self.rows.iter().zip(states) {
            state.turn(product(state), row.times(change));
        }
    }
}

/// A symmetric matrix with two diagonals beside the main one, or its factors L·D·Lᵀ: D, and L's diagonals below.
#[derive(Debug, Default)]
struct Band {
    own: Vec<f64>,
    next: Vec<f64>,
    second: Vec<f64>,
}

impl Band {
    /// P + Aᵀ·(z/s)·A.
    fn put(&mut self, program: &BandProgram<'_>, states: &[RowState]) {
        let count = program.diagonal.len();
        for (values, given) in [
            (&mut self.own, program.diagonal),
            (&mut self.next, program.beside),
            (&mut self.second, &[][..]),
        ] {
            values.clear();
            values.extend_from_slice(given);
            values.resize(count + 2, 0.0);
        }
        for (row, state) in program.rows.iter().zip(states) {
            let ([a, b, c], weight, first) = (row.factors, state.z / state.s, row.first);
            self.own[first] += weight * a * a;
            self.own[first + 1] += weight * b * b;
            self.own[first + 2] += weight * c * c;
            self.next[first] += weight * a * b;
            self.next[first + 1] += weight * b * c;
            self.second[first] += weight * a * c;
        }
        // Variables without cost and rows keep their values.
        for own in self.own.iter_mut().filter(|own| **own == 0.0) {
            *own = 1.0;
        }
    }

    /// Puts the factors in its place; false if it is not positive.
    fn factor(&mut self) -> bool {
        for index in 0..self.own.len() {
            let pivot = self.own[index];
            if pivot <= 0.0 || !pivot.is_finite() {
                return false;
            }
            let (next, second) = (self.next[index], self.second[index]);
            let (l1, l2) = (next / pivot, second / pivot);
            if index + 1 < self.own.len() {
                self.own[index + 1] -= l1 * next;
                self.next[index + 1] -= l1 * second;
            }
            if index + 2 < self.own.len() {
                self.own[index + 2] -= l2 * second;
            }
            (self.next[index], self.second[index]) = (l1, l2);
        }
        true
    }

    /// Solves for one right side, in its place.
    fn solve(&self, right: &mut [f64]) {
        let count = self.own.len();
        for index in 0..count {
            let value = right[index];
            if index + 1 < count {
                right[index + 1] -= self.next[index] * value;
            }
            if index + 2 < count {
                right[index + 2] -= self.second[index] * value;
            }
        }
        for index in (0..count).rev() {
            let mut value = right[index] / self.own[index];
            if index + 1 < count {
                value -= self.next[index] * right[index + 1];
            }
            if index + 2 < count {
                value -= self.second[index] * right[index + 2];
            }
            right[index] = value;
        }
    }
}
