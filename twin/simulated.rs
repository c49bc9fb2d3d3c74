//! The simulated machine as a plant.

use crate::machine::Machine;
use crate::physics::{PhysicsError, PhysicsMachine, axis_inertia};
use crate::plant::{AxisFeedback, Plant};
use crate::setpoint::AxisSetpoint;
use twin_kinematics::AxisVector;

/// Simulates one cycle per set-point, at once; what it gives back is where the axes are at the set-point's time.
#[derive(Debug)]
pub struct Simulated {
    physics: PhysicsMachine,
    begun: bool,
    arrived: Option<AxisFeedback>,
}

impl Simulated {
    /// The machine at rest at `start` (m or rad), its drives enabled.
    ///
    /// # Errors
    /// If the machine file describes no machine that physics can simulate.
    pub fn new(machine: &Machine, start: &AxisVector) -> Result<Self, PhysicsError> {
        let inertia = axis_inertia(&machine.model, start)?;
        let drives: Vec<_> = machine
            .axes
            .iter()
            .zip(inertia.iter())
            .map(|(axis, inertia)| axis.simulated.drive(*inertia))
            .collect();
        let physics =
            PhysicsMachine::new(&machine.model, &drives, machine.gravity, start, machine.cycle_ns)?;
        Ok(Self { physics, begun: false, arrived: None })
    }
}

impl Plant for Simulated {
    type Error = PhysicsError;

    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), PhysicsError> {
        // The machine stands at the first set-point: it is where the others start from.
        let position = if self.begun {
            self.physics.step(&setpoint.axes)?.position
        } else {
            self.physics.axis_state().position
        };
        self.begun = true;
        self.arrived = Some(AxisFeedback { time_ns: setpoint.time_ns, position });
        Ok(())
    }

    fn feedback(&mut self) -> Result<Option<AxisFeedback>, PhysicsError> {
        Ok(self.arrived.take())
    }
}
