//! Limits of a plan: those of each axis, and the efforts of the axes along paths.

use super::{Axis, AxisLimit, Machine, SimulationError};
use twin_physics::{AxisLoad, PathDynamics};

impl Machine {
    /// Limits of each axis in a plan, in machine-file order, less the override headroom.
    pub fn axis_limits(&self) -> Vec<AxisLimit> {
        self.axes.iter().map(Axis::limit).collect()
    }

    /// Efforts of the axes along paths; `None` if no axis has a `max_torque_nm` or `max_force_n`.
    ///
    /// # Errors
    /// [`SimulationError`] if physics cannot simulate the model.
    pub fn path_dynamics(&self) -> Result<Option<PathDynamics>, SimulationError> {
        let loads: Vec<_> = self
            .axes
            .iter()
            .map(|axis| AxisLoad {
                effort_limit: axis.simulated.effort_limit,
                coulomb_friction: axis.simulated.dry_friction(),
                viscous_friction: axis.simulated.viscous_friction(),
                armature: axis.simulated.armature,
                headroom: axis.headroom,
            })
            .collect();
        if loads.iter().all(|load| load.effort_limit.is_infinite()) {
            return Ok(None);
        }
        let dynamics = PathDynamics::new(&self.model, &loads, self.gravity);
        dynamics.map(Some).map_err(|error| SimulationError::of(self, error))
    }
}
