//! A program on the simulated machine.

use super::{Checker, sentence};
use crate::machine::{Machine, Scenario, SimulationError};
use crate::physics::PhysicsError;
use crate::plant::{Plant, PlantRecord};
use crate::setpoint::AxisSetpoint;
use crate::simulated::Simulated;

/// The simulated machine on which a program is tried.
#[derive(Debug)]
pub(super) struct Rehearsal<'m> {
    machine: &'m Machine,
    scenario: Scenario,
    /// From the first set-point on.
    twin: Option<Simulated>,
    /// It has run away from its set-points.
    lost: bool,
}

impl<'m> Rehearsal<'m> {
    pub(super) fn new(machine: &'m Machine, scenario: Scenario) -> Self {
        Self { machine, scenario, twin: None, lost: false }
    }

    /// What it has to tell.
    pub(super) fn into_record(self) -> PlantRecord {
        let mut record = self.twin.map(|twin| twin.record()).unwrap_or_default();
        if self.lost {
            // They might have begun, had it gone on.
            record.faults_to_come.clear();
        }
        record
    }

    /// Takes the machine to `setpoint` and tells `checker` where it came.
    pub(super) fn follow(
        &mut self,
        setpoint: &AxisSetpoint,
        checker: &mut Checker<'_>,
    ) -> Result<(), SimulationError> {
        if self.lost {
            return Ok(());
        }
        if self.twin.is_none() {
            let twin = match Simulated::new(self.machine, &setpoint.axes.position) {
                Ok(twin) => twin,
                // That is told by whoever looks at set-points.
                Err(SimulationError { error: PhysicsError::Overlap { .. }, .. }) => {
                    self.lost = true;
                    return Ok(());
                }
                Err(error) => return Err(error),
            };
            self.twin = Some(twin.in_scenario(&self.scenario));
        }
        let Some(twin) = &mut self.twin else { return Ok(()) };
        match twin.command(setpoint).and_then(|()| twin.feedback()) {
            Ok(Some(feedback)) => checker.following(setpoint, &feedback.position),
            Ok(None) => {}
            // A machine that can be built and cannot do what is asked of it: the program is wrong, not the command.
            Err(error) => {
                self.lost = true;
                // That is told with what happened.
                let told = matches!(
                    error,
                    PhysicsError::LimitSwitch { .. } | PhysicsError::Collision { .. }
                );
                if told {
                    return Ok(());
                }
                let error = SimulationError::of(self.machine, error);
                checker.findings.add(None, sentence::lost(setpoint.place, &error));
            }
        }
        Ok(())
    }
}
