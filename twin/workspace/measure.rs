//! Singularity measure: distance of the axis positions from a singular pose.

use twin_kinematics::{AxisVector, Kinematics};
use twin_machine::Machine;

/// The singularity measure with the axes at `axes`: the smallest singular value of the Jacobian, dimensionless; 0 where
/// there is no Jacobian.
pub(super) fn smallest(machine: &Machine, axes: &AxisVector) -> f64 {
    let dexterity = machine.kinematics.dexterity(axes, machine.length_scale);
    dexterity.map_or(0.0, |dexterity| dexterity.smallest)
}
