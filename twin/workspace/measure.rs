//! How far the axes are from a pose in which they cannot move the tool every way.

use crate::machine::Machine;
use nalgebra::DMatrix;
use twin_kinematics::{AxisVector, Kinematics};

/// Smallest over largest singular value of the Jacobian.
pub(super) fn isotropy(machine: &Machine, axes: &AxisVector) -> Option<f64> {
    const STEP: f64 = 1e-6;
    let moved = |axis: usize, by: f64| {
        let mut axes = *axes;
        *axes.get_mut(axis)? += by;
        machine.kinematics.forward(&axes).ok()
    };
    let length = length_scale(machine);
    let mut columns = Vec::new();
    for (index, axis) in machine.axes.iter().enumerate() {
        let ahead = moved(index, STEP)?;
        let behind = moved(index, -STEP)?;
        let rate = (ahead.position - behind.position) / (2.0 * STEP);
        let scale = match axis.kind {
            crate::machine::AxisKind::Rotary => 1.0 / length,
            crate::machine::AxisKind::Linear => 1.0,
        };
        if rate.norm() > 1e-9 {
            columns.push(rate * scale);
        }
    }
    let jacobian = DMatrix::from_fn(3, columns.len(), |row, column| {
        columns.get(column).and_then(|rate| rate.get(row)).copied().unwrap_or(0.0)
    });
    let values = jacobian.singular_values();
    let (largest, smallest) = (values.max(), values.min());
    (largest > 0.0).then_some(smallest / largest)
}

/// m.
pub(super) fn length_scale(_machine: &Machine) -> f64 {
    0.32
}
