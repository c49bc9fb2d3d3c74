//! Linear equations of the axes, no larger than the machine has axes: M = L·D·Lᵀ with 1 on the diagonal of L, which takes no
//! roots and, for as few axes as a machine has, no loops when compiled.

use twin_kinematics::MAX_AXES;

use super::dynamics::{JointMatrix, JointVector};

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

/// `inertia⁻¹` of the first `axis_count` axes, with 1 on the diagonal for others; `None` where `inertia` is not positive definite.
pub(super) fn invert(axis_count: usize, inertia: &JointMatrix) -> Option<JointMatrix> {
    match axis_count {
        1 => invert_first::<1>(inertia),
        2 => invert_first::<2>(inertia),
        3 => invert_first::<3>(inertia),
        4 => invert_first::<4>(inertia),
        5 => invert_first::<5>(inertia),
        6 => invert_first::<6>(inertia),
        _ => invert_first::<MAX_AXES>(inertia),
    }
}

fn solve_first<const N: usize>(inertia: &JointMatrix, effort: &JointVector) -> Option<JointVector> {
    let mut solution = [0.0; N];
    for (entry, effort) in solution.iter_mut().zip(effort) {
        *entry = *effort;
    }
    Factors::<N>::of(inertia)?.solve(&mut solution);
    let mut result = JointVector::zeros();
    for (entry, value) in result.iter_mut().zip(solution) {
        *entry = value;
    }
    Some(result)
}

fn invert_first<const N: usize>(inertia: &JointMatrix) -> Option<JointMatrix> {
    let factors = Factors::<N>::of(inertia)?;
    let mut result = JointMatrix::identity();
    for (index, mut column) in result.column_iter_mut().enumerate().take(N) {
        let mut unit = [0.0; N];
        if let Some(entry) = unit.get_mut(index) {
            *entry = 1.0;
        }
        factors.solve(&mut unit);
        for (entry, value) in column.iter_mut().zip(unit) {
            *entry = value;
        }
    }
    Some(result)
}

/// L below its diagonal, and D⁻¹.
struct Factors<const N: usize> {
    lower: [[f64; N]; N],
    inverse: [f64; N],
}

#[expect(clippy::indexing_slicing, reason = "every index is below N, and N not above MAX_AXES")]
impl<const N: usize> Factors<N> {
    /// Of the first N rows and columns; only what is on and below the diagonal is read.
    #[inline]
    fn of(matrix: &JointMatrix) -> Option<Self> {
        let (mut lower, mut inverse, mut diagonal) = ([[0.0; N]; N], [0.0; N], [0.0; N]);
        for row in 0..N {
            let mut pivot = matrix[(row, row)];
            for column in 0..row {
                // L·D first, then L.
                let mut product = matrix[(row, column)];
                for before in 0..column {
                    product -= lower[row][before] * diagonal[before] * lower[column][before];
                }
                let entry = product * inverse[column];
                lower[row][column] = entry;
                pivot -= product * entry;
            }
            // Written so that what is not a number is no pivot.
            if !(pivot > 0.0 && pivot < f64::INFINITY) {
                return None;
            }
            diagonal[row] = pivot;
            inverse[row] = 1.0 / pivot;
        }
        Some(Self { lower, inverse })
    }

    #[inline]
    fn solve(&self, values: &mut [f64; N]) {
        for row in 0..N {
            for column in 0..row {
                values[row] -= self.lower[row][column] * values[column];
            }
        }
        for row in (0..N).rev() {
            values[row] *= self.inverse[row];
            for below in row + 1..N {
                values[row] -= self.lower[below][row] * values[below];
            }
        }
    }
}
