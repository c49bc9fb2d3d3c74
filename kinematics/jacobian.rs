//! Jacobian of a whole machine and its dexterity: smallest and largest singular value.

use crate::{AxisVector, Coordinate, MAX_AXES};
use nalgebra::SMatrix;

/// Jacobian: the velocity of every tool coordinate (m/s or rad/s) per unit velocity of every axis (m/s or rad/s).
/// Coordinates the machine does not have, and axes that do not move the tool, are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobian {
    /// Rows in the order of [`Coordinate::ALL`].
    entries: SMatrix<f64, 4, MAX_AXES>,
    axes: usize,
}

impl Jacobian {
    /// All zeros, for a machine with `axes` axes.
    pub fn zeros(axes: usize) -> Self {
        Self { entries: SMatrix::zeros(), axes: axes.min(MAX_AXES) }
    }

    /// Number of axes.
    pub const fn axis_count(&self) -> usize {
        self.axes
    }

    /// The velocity of a tool coordinate per unit velocity of an axis; 0 for an axis beyond the last.
    pub fn get(&self, coordinate: Coordinate, axis: usize) -> f64 {
        self.entries.get((coordinate.index(), axis)).copied().unwrap_or_default()
    }

    /// Sets the velocity of a tool coordinate per unit velocity of an axis; nothing for an axis beyond the last.
    pub fn set(&mut self, coordinate: Coordinate, axis: usize, value: f64) {
        if let Some(entry) = self.entries.get_mut((coordinate.index(), axis)) {
            *entry = value;
        }
    }

    /// The velocities of x, y, z (m/s) and direction (rad/s) for those of the axes.
    pub fn tool_velocity(&self, axes: &AxisVector) -> [f64; 4] {
        Coordinate::ALL.map(|coordinate| {
            axes.iter().enumerate().map(|(axis, v)| self.get(coordinate, axis) * v).sum()
        })
    }

    /// Singular values of the part that belongs to `coordinates` and the axes of which `moves` is true; a square
    /// part. They are dimensionless: `length` (m) is what a radian counts, of the direction and of every axis that `turns`.
    pub(crate) fn dexterity(
        &self,
        coordinates: &[Coordinate],
        moves: impl Fn(usize) -> bool,
        turns: impl Fn(usize) -> bool,
        length: f64,
    ) -> Dexterity {
        let mut scaled = SMatrix::<f64, 4, MAX_AXES>::zeros();
        let mut used = [false; MAX_AXES];
        for (axis, used) in used.iter_mut().enumerate().take(self.axes) {
            *used = moves(axis);
            if !*used {
                continue;
            }
            for coordinate in coordinates {
                let row = if *coordinate == Coordinate::Direction { length } else { 1.0 };
                let column = if turns(axis) { length } else { 1.0 };
                if let Some(entry) = scaled.get_mut((coordinate.index(), axis)) {
                    *entry = self.get(*coordinate, axis) * row / column;
                }
            }
        }
        let values = singular_values(scaled);
        let used = || values.iter().zip(used).filter(|(_, used)| *used).map(|(value, _)| *value);
        Dexterity {
            smallest: used().fold(f64::INFINITY, f64::min),
            largest: used().fold(0.0, f64::max),
        }
    }
}

/// Dexterity of a machine in a pose: the singular values of its Jacobian, made dimensionless.
///
/// Axes moving with a unit velocity all together (the root of the sum of squares, an axis that turns counting its
/// rate times the length scale) move the tool with between `smallest` and `largest` of it. A gantry has 1 and 1. Where
/// `smallest` is 0 there is a direction in which the tool cannot be moved at all, and near it the axes have to be 1/`smallest`
/// times faster than the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dexterity {
    /// Smallest singular value, the measure of how singular a pose is.
    pub smallest: f64,
    /// Largest singular value.
    pub largest: f64,
}

/// The singular values of a matrix by one-sided Jacobi rotations of its columns: small ones keep their digits. Columns of zeros give
/// zeros, in their place.
fn singular_values(mut matrix: SMatrix<f64, 4, MAX_AXES>) -> [f64; MAX_AXES] {
    // A handful of sweeps makes the columns orthogonal; the number is bounded in case one is not a number.
    for _ in 0..30 {
        let mut orthogonal = true;
        for first in 0..MAX_AXES {
            for second in first + 1..MAX_AXES {
                let (p, q) = (matrix.column(first), matrix.column(second));
                let (dot, pp, qq) = (p.dot(&q), p.norm_squared(), q.norm_squared());
                if dot.abs() <= f64::EPSILON * (pp * qq).sqrt() {
                    continue;
                }
                orthogonal = false;
                let ratio = (qq - pp) / (2.0 * dot);
                let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
                let cos = 1.0 / tangent.hypot(1.0);
                let sin = cos * tangent;
                let (turned_p, turned_q) = (p * cos - q * sin, p * sin + q * cos);
                matrix.set_column(first, &turned_p);
                matrix.set_column(second, &turned_q);
            }
        }
        if orthogonal {
            break;
        }
    }
    std::array::from_fn(|column| matrix.column(column).norm())
}

#[cfg(test)]
mod tests {
    use super::singular_values;
    use crate::MAX_AXES;
    use nalgebra::{Matrix4, SMatrix};

    #[test]
    fn singular_values_agree_with_another_method() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from(u32::try_from(seed >> 33).unwrap()) / 2_f64.powi(30) - 1.0
        };
        for _ in 0..200 {
            let square = Matrix4::from_fn(|_, _| next());
            let mut wide = SMatrix::<f64, 4, MAX_AXES>::zeros();
            wide.fixed_view_mut::<4, 4>(0, 2).copy_from(&square);
            let mut found: Vec<_> = singular_values(wide)[2..6].to_vec();
            found.sort_by(f64::total_cmp);
            let mut expected: Vec<_> = square.singular_values().iter().copied().collect();
            expected.sort_by(f64::total_cmp);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-13, "{found} {expected}");
            }
        }
    }
}
