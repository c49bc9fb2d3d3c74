//! Banded interior-point method for quadratic programs whose rows have three neighbouring variables.
//!
//! Mehrotra's predictor and corrector for min ½·xᵀ·P·x + qᵀ·x with A·x + s = r and s ≥ 0. With the multipliers z of the rows,
//! a step solves (P + Aᵀ·(z/s)·A)·Δx = right side, a matrix of five diagonals. Its cost grows linearly with the number of rows,
//! which are gone through three times in a step.
//! If it fails, Clarabel solves the program ([`super::convex::Program::solve`]).

#![expect(clippy::indexing_slicing, reason = "bands and rows are as long as they are made")]

/// Length of a step, as a part of the way to the nearest bound.
const STEP: f64 = 0.995;
/// Least distance of a row from its bound at the start, and the product of distance and multiplier.
const FIRST_DISTANCE: f64 = 0.05;
const FIRST_PRODUCT: f64 = 2e-3;

/// A row: the first of its three neighbours, their coefficients, and its right side. Coefficients of variables that the program
/// does not have are 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BandRow {
    pub(super) first: usize,
    pub(super) factors: [f64; 3],
    pub(super) right: f64,
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

impl BandProgram<'_> {
    /// Solves it to `tolerance`: rows absolutely, gradient and gap as parts of the cost's own size. None if that takes more than
    /// `most` steps or is impossible.
    pub(super) fn solve(&self, tolerance: f64, most: u32) -> Option<BandAnswer> {
        let count = self.diagonal.len();
        let size = self.linear.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        if self.rows.is_empty() || !(size > 0.0 && size.is_finite()) {
            return None;
        }
        // The variables are of the order of 1.
        let mut x = vec![1.0; count + 2];
        x[count..].fill(0.0);
        let mut rows = Rows::new(self.rows, count, size);
        let [mut gradient, mut change, mut bent, mut central] =
            [(); 4].map(|()| vec![0.0; count + 2]);
        let mut band = Band::default();
        let mut part = 0.0;
        #[expect(clippy::cast_precision_loss, reason = "a number of rows")]
        let number = self.rows.len() as f64;
        for iterations in 0..=most {
            band.put(self);
            self.put_gradient(&x, &mut gradient);
            for (change, gradient) in change.iter_mut().zip(&gradient) {
                *change = -gradient;
            }
            let (product, wrong) = rows.go(part, &x, &mut gradient, &mut change, &mut band);
            let steep = gradient.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            if !(product + wrong + steep).is_finite() {
                return None;
            }
            if wrong <= tolerance
                && steep <= tolerance * size
                && product <= tolerance * self.cost(&x).abs().max(size)
            {
                x.truncate(count);
                return Some(BandAnswer { x, duals: rows.multipliers(), iterations });
            }
            if !band.factor() {
                return None;
            }
            band.solve(&mut change);
            let left = rows.predict(&change, &mut bent, &mut central) / product;
            let aim = left.powi(3) * product / number;
            for (bent, central) in bent.iter_mut().zip(&central) {
                *bent -= aim * central;
            }
            band.solve(&mut bent);
            for (change, bent) in change.iter_mut().zip(&bent) {
                *change += bent;
            }
            part = STEP * rows.correct(&change, aim);
            for (x, change) in x.iter_mut().zip(&change) {
                *x += part * change;
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

    /// P·x + q.
    fn put_gradient(&self, x: &[f64], gradient: &mut [f64]) {
        gradient.fill(0.0);
        for (index, ((p, beside), q)) in
            self.diagonal.iter().zip(self.beside).zip(self.linear).enumerate()
        {
            gradient[index] += p * x[index] + beside * x[index + 1] + q;
            gradient[index + 1] += beside * x[index];
        }
        gradient[self.diagonal.len()..].fill(0.0);
    }
}

/// The rows in the order of their first variables.
#[derive(Debug)]
struct Rows {
    all: Vec<Row>,
    /// Where those of each variable begin, and where the last ones end.
    begins: Vec<usize>,
    /// Where each of the program's rows is.
    places: Vec<usize>,
}

/// A row on the way to the solution.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    factors: [f64; 3],
    right: f64,
    /// Distance from the bound, multiplier, and their changes.
    s: f64,
    z: f64,
    ds: f64,
    dz: f64,
    /// A·x + s − r, 1/s, and Δs·Δz/s of the predictor.
    wrong: f64,
    inverse: f64,
    bend: f64,
}

impl Row {
    #[inline]
    fn times(&self, [x, y, z]: [f64; 3]) -> f64 {
        let [a, b, c] = self.factors;
        a * x + b * y + c * z
    }
}

impl Rows {
    /// About variables that are 1, with costs of this `size`.
    fn new(given: &[BandRow], variables: usize, size: f64) -> Self {
        let mut begins = vec![0; variables + 1];
        for row in given {
            begins[row.first + 1] += 1;
        }
        for index in 0..variables {
            begins[index + 1] += begins[index];
        }
        let mut next = begins.clone();
        let mut rows = vec![Row::default(); given.len()];
        let place = |BandRow { first, factors, right }: &BandRow| {
            let s = (right - factors.iter().sum::<f64>()).max(FIRST_DISTANCE);
            let z = size * FIRST_PRODUCT / s;
            let place = next[*first];
            next[*first] += 1;
            rows[place] = Row { factors: *factors, right: *right, s, z, ..Row::default() };
            place
        };
        let places = given.iter().map(place).collect();
        Self { all: rows, begins, places }
    }

    /// The rows of each variable.
    fn groups(&mut self) -> impl Iterator<Item = &mut [Row]> {
        let mut left = self.all.as_mut_slice();
        self.begins.windows(2).map(move |ends| {
            let group = left.split_off_mut(..ends[1] - ends[0]);
            group.unwrap_or_default()
        })
    }

    /// Takes `part` of the changes, which leads to `x`, and adds Aᵀ·z to `gradient`, −Aᵀ·(z/s·wrong) to `change` and Aᵀ·(z/s)·A
    /// to `band`. The sum of the products s·z, and by how much the worst row is wrong.
    fn go(
        &mut self,
        part: f64,
        x: &[f64],
        gradient: &mut [f64],
        change: &mut [f64],
        band: &mut Band,
    ) -> (f64, f64) {
        let (mut product, mut most) = (0.0, 0.0_f64);
        for (index, group) in self.groups().enumerate() {
            let x = three(x, index);
            let [mut multipliers, mut wrongs, mut own, mut beside] = [[0.0; 3]; 4];
            for row in group {
                row.s += part * row.ds;
                row.z += part * row.dz;
                row.wrong = row.times(x) + row.s - row.right;
                row.inverse = 1.0 / row.s;
                product += row.s * row.z;
                most = most.max(row.wrong.abs());
                let weight = row.z * row.inverse;
                let [a, b, c] = row.factors;
                add(&mut multipliers, row.z, row.factors);
                add(&mut wrongs, -weight * row.wrong, row.factors);
                add(&mut own, weight, [a * a, b * b, c * c]);
                add(&mut beside, weight, [a * b, b * c, a * c]);
            }
            add(&mut gradient[index..], 1.0, multipliers);
            add(&mut change[index..], 1.0, wrongs);
            add(&mut band.own[index..], 1.0, own);
            add(&mut band.next[index..], 1.0, [beside[0], beside[1]]);
            band.second[index] += beside[2];
        }
        (product, most)
    }

    /// With the predictor's `change` of the variables: puts Aᵀ·(Δs·Δz/s) into `bent` and Aᵀ·(1/s) into `central`. The sum of s·z after
    /// as much of the change as there is room for.
    fn predict(&mut self, change: &[f64], bent: &mut [f64], central: &mut [f64]) -> f64 {
        bent.fill(0.0);
        central.fill(0.0);
        let (mut most, mut product, mut bends) = (1.0_f64, 0.0, 0.0);
        for (index, group) in self.groups().enumerate() {
            let change = three(change, index);
            let [mut bend, mut centre] = [[0.0; 3]; 2];
            for row in group {
                // s and z change by these parts of themselves: z·Δs + s·Δz = −s·z.
                let ds = (-row.wrong - row.times(change)) * row.inverse;
                let dz = -1.0 - ds;
                most = most.max(-ds).max(-dz);
                product += row.s * row.z;
                row.bend = ds * dz * row.z;
                bends += row.bend * row.s;
                add(&mut bend, row.bend, row.factors);
                add(&mut centre, row.inverse, row.factors);
            }
            add(&mut bent[index..], 1.0, bend);
            add(&mut central[index..], 1.0, centre);
        }
        let room = 1.0 / most;
        (1.0 - room) * product + room * room * bends
    }

    /// Takes over the `change` of the variables, after which s·z would be `aim` in each row. The largest part of it that keeps both
    /// positive.
    fn correct(&mut self, change: &[f64], aim: f64) -> f64 {
        let mut most = STEP;
        for (index, group) in self.groups().enumerate() {
            let change = three(change, index);
            for row in group {
                row.ds = -row.wrong - row.times(change);
                row.dz = (aim - row.z * row.ds) * row.inverse - row.bend - row.z;
                most = most.max(-row.ds * row.inverse).max(-row.dz / row.z);
            }
        }
        1.0 / most
    }

    /// Those of the program's rows.
    fn multipliers(&self) -> Vec<f64> {
        self.places.iter().map(|place| self.all[*place].z).collect()
    }
}

#[inline]
fn three(values: &[f64], index: usize) -> [f64; 3] {
    let values = &values[index..index + 3];
    [values[0], values[1], values[2]]
}

#[inline]
fn add<const N: usize>(to: &mut [f64], factor: f64, values: [f64; N]) {
    for (slot, value) in to[..N].iter_mut().zip(values) {
        *slot += factor * value;
    }
}

/// A symmetric matrix with two diagonals beside the main one, or its factors L·D·Lᵀ: 1/D, and L's diagonals below.
#[derive(Debug, Default)]
struct Band {
    own: Vec<f64>,
    next: Vec<f64>,
    second: Vec<f64>,
}

impl Band {
    /// P.
    fn put(&mut self, program: &BandProgram<'_>) {
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
    }

    /// Puts the factors in its place; false if it is not positive.
    fn factor(&mut self) -> bool {
        for index in 0..self.own.len().saturating_sub(2) {
            // Variables without cost and rows keep their values.
            let pivot = if self.own[index] == 0.0 { 1.0 } else { self.own[index] };
            if pivot <= 0.0 || !pivot.is_finite() {
                return false;
            }
            let inverse = 1.0 / pivot;
            let (next, second) = (self.next[index], self.second[index]);
            let (l1, l2) = (next * inverse, second * inverse);
            self.own[index + 1] -= l1 * next;
            self.own[index + 2] -= l2 * second;
            self.next[index + 1] -= l1 * second;
            (self.own[index], self.next[index], self.second[index]) = (inverse, l1, l2);
        }
        true
    }

    /// Solves for one right side, in its place.
    fn solve(&self, right: &mut [f64]) {
        let count = self.own.len().saturating_sub(2);
        for index in 0..count {
            let value = right[index];
            right[index + 1] -= self.next[index] * value;
            right[index + 2] -= self.second[index] * value;
        }
        for index in (0..count).rev() {
            let behind =
                self.next[index] * right[index + 1] + self.second[index] * right[index + 2];
            right[index] = right[index] * self.own[index] - behind;
        }
    }
}
