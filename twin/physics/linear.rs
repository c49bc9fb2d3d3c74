//! Linear solver for the equations of the axes: M = L·D·Lᵀ with 1 on the diagonal of L.
//!
//! One row per axis. The factorisation needs no square roots, and no loops when compiled.

use twin_kinematics::MAX_AXES;

use crate::joint::{JointMatrix, JointVector};

/// `inertia⁻¹·effort` for the first `axis_count` axes, 0 for others; `None` where `inertia` is not positive definite.
#[inline]
pub(super) fn solve(
    axis_count: usize,
    inertia: &JointMatrix,
    effort: &JointVector,
) -> Option<JointVector> {
    match axis_count {
        1 => solve_first::<1>(inertia, effort),
        2 => solve_first::<2>(inertia, effort),
        3 => solve_first::<3>(inertia, effort),
        4 => solve_first::<4>(inertia, effort),
        5 => solve_first::<5>(inertia, effort),
        6 => solve_first::<6>(inertia, effort),
        _ => solve_first::<MAX_AXES>(inertia, effort),
    }
}

/// [`solve`], and `inertia⁻¹` of the first `axis_count` axes with 1 on the diagonal for others.
#[inline]
pub(super) fn solve_and_invert(
    axis_count: usize,
    inertia: &JointMatrix,
    effort: &JointVector,
) -> Option<(JointVector, JointMatrix)> {
    match axis_count {
        1 => both_first::<1>(inertia, effort),
        2 => both_first::<2>(inertia, effort),
        3 => both_first::<3>(inertia, effort),
        4 => both_first::<4>(inertia, effort),
        5 => both_first::<5>(inertia, effort),
        6 => both_first::<6>(inertia, effort),
        _ => both_first::<MAX_AXES>(inertia, effort),
    }
}

fn solve_first<const N: usize>(inertia: &JointMatrix, effort: &JointVector) -> Option<JointVector> {
    Some(Factors::<N>::of(inertia)?.solution(effort))
}

fn both_first<const N: usize>(
    inertia: &JointMatrix,
    effort: &JointVector,
) -> Option<(JointVector, JointMatrix)> {
    let factors = Factors::<N>::of(inertia)?;
    Some((factors.solution(effort), factors.inverse()))
}

/// L below its diagonal, and D⁻¹.
struct Factors<const N: usize> {
    lower: [[f64; N]; N],
    pivots: [f64; N],
}

impl<const N: usize> Factors<N> {
    /// Of the first N rows and columns; only what is on and below the diagonal is read.
    #[inline]
    fn of(matrix: &JointMatrix) -> Option<Self> {
        let (mut lower, mut pivots, mut diagonal) = ([[0.0; N]; N], [0.0; N], [0.0; N]);
        for row in 0..N {
            let mut pivot = matrix[(row, row)];
            for column in 0..row {
                // L·D first, then L.
                let mut product = matrix[(row, column)];
                for before in 0..column {
                    product -= lower[row][before] * diagonal[before] * lower[column][before];
                }
                let entry = product * pivots[column];
                lower[row][column] = entry;
                pivot -= product * entry;
            }
            // Written so that what is not a number is not a pivot.
            if !(pivot > 0.0 && pivot < f64::INFINITY) {
                return None;
            }
            diagonal[row] = pivot;
            pivots[row] = 1.0 / pivot;
        }
        Some(Self { lower, pivots })
    }

    #[inline]
    fn solve(&self, values: &mut [f64; N]) {
        for row in 0..N {
            for column in 0..row {
                values[row] -= self.lower[row][column] * values[column];
            }
        }
        for row in (0..N).rev() {
            values[row] *= self.pivots[row];
            for below in row + 1..N {
                values[row] -= self.lower[below][row] * values[below];
            }
        }
    }

    #[inline]
    fn solution(&self, effort: &JointVector) -> JointVector {
        let mut values = [0.0; N];
        for (value, effort) in values.iter_mut().zip(effort) {
            *value = *effort;
        }
        self.solve(&mut values);
        let mut result = JointVector::zeros();
        for (entry, value) in result.iter_mut().zip(values) {
            *entry = value;
        }
        result
    }

    #[inline]
    fn inverse(&self) -> JointMatrix {
        let mut result = JointMatrix::identity();
        for column in 0..N {
            let mut unit = [0.0; N];
            unit[column] = 1.0;
            self.solve(&mut unit);
            for row in 0..N {
                result[(row, column)] = unit[row];
            }
        }
        result
    }
}
