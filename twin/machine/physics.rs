//! The simulated machine of a machine file, in rapier.

use super::Machine;
use twin_gcode::rs274::Tool;
use twin_kinematics::AxisVector;
use twin_physics::{PhysicsError, PhysicsMachine, axis_inertia, check_bodies};

impl Machine {
    /// The machine in rapier at rest at `start`, with its drives, its obstacles and what it handles.
    ///
    /// # Errors
    /// [`PhysicsError`] if bodies or drives cannot be simulated; [`super::SimulationError::of`] names them.
    pub fn physics(&self, start: &AxisVector) -> Result<PhysicsMachine, PhysicsError> {
        self.physics_with(start, None)
    }

    /// The same with the body of `tool` of a tool table in the spindle; masses are those of the machine file.
    ///
    /// # Errors
    /// Those of [`Self::physics`].
    pub fn physics_with(
        &self,
        start: &AxisVector,
        tool: Option<&Tool>,
    ) -> Result<PhysicsMachine, PhysicsError> {
        let inertia = axis_inertia(&self.model, start)?;
        let axes = self.axes.iter().zip(inertia.iter());
        let drives: Vec<_> = axes.map(|(axis, inertia)| axis.simulated.drive(*inertia)).collect();
        let mut physics =
            PhysicsMachine::new(&self.model, &drives, self.gravity, start, self.cycle_ns)?;
        if let Some(bodies) = self.spindle_bodies() {
            let (model, surroundings) = bodies.with(tool);
            check_bodies(&model, &surroundings, start)?;
            physics.insert_bodies(&model, &surroundings)?;
        }
        Ok(physics)
    }
}
