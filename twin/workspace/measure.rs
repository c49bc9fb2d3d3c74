//! How far the axes are from a pose in which they cannot move the tool every way.

use crate::machine::Machine;
use twin_kinematics::{AxisVector, Kinematics};

/// The singularity measure with the axes at `axes`: smallest over largest singular value of the Jacobian, 0 to 1; 0 where
/// there is no Jacobian.
pub(super) fn isotropy(machine: &Machine, axes: &AxisVector) -> f64 {
    let dexterity = machine.kinematics.dexterity(axes, machine.length_scale);
    dexterity.map_or(0.0, |dexterity| dexterity.isotropy())
}
