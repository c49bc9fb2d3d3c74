//! Simulation of a program during its check.

use super::Checker;
use super::messages;
use crate::plant::{Plant, PlantRecord};
use crate::setpoint::{AxisSetpoint, resting_behind};
use crate::simulated::Simulated;
use crate::spindle::Spindle;
use std::collections::VecDeque;
use twin_machine::{Machine, Scenario, SimulationError};
use twin_physics::{Part, PhysicsError};

/// The simulated machine on which a program is tried.
#[derive(Debug)]
pub(super) struct Rehearsal<'m> {
    machine: &'m Machine,
    scenario: Scenario,
    /// At the beginning.
    spindle: Spindle,
    /// From the first set-point on.
    twin: Option<Simulated>,
    /// It has run away from its set-points.
    lost: bool,
    /// Set-points that it has not come to: drives in its loop look ahead.
    ahead: VecDeque<AxisSetpoint>,
}

impl<'m> Rehearsal<'m> {
    pub(super) fn new(machine: &'m Machine, scenario: Scenario, spindle: Spindle) -> Self {
        Self { machine, scenario, spindle, twin: None, lost: false, ahead: VecDeque::new() }
    }

    /// Simulates up to the last set-point, and returns the record of the whole program.
    pub(super) fn finish(
        mut self,
        checker: &mut Checker<'_>,
    ) -> Result<PlantRecord, SimulationError> {
        let mut last = None;
        while let Some(setpoint) = self.ahead.pop_front() {
            self.follow(&setpoint, checker)?;
            last = Some(setpoint);
        }
        if let Some(last) = last {
            // Drives in the loop are still on their way.
            for resting in resting_behind(&last, self.machine.cycle_ns) {
                if self.lost || self.twin.as_ref().is_none_or(Plant::has_arrived) {
                    break;
                }
                self.follow(&resting, checker)?;
            }
        }
        let mut record = self.twin.map(|twin| twin.record()).unwrap_or_default();
        if self.lost {
            // They might have begun, had it gone on.
            record.faults_to_come.clear();
        }
        Ok(record)
    }

    /// Takes the machine as far as the plan behind it is known.
    pub(super) fn take(
        &mut self,
        setpoint: &AxisSetpoint,
        checker: &mut Checker<'_>,
    ) -> Result<(), SimulationError> {
        self.ahead.push_back(*setpoint);
        let horizon_ns = self.twin.as_ref().map_or(0, Plant::horizon_ns);
        let known_ns = setpoint.time_ns.saturating_sub(horizon_ns);
        while let Some(next) = self.ahead.pop_front_if(|next| next.time_ns <= known_ns) {
            self.follow(&next, checker)?;
        }
        Ok(())
    }

    /// Takes the machine to `setpoint` and reports to `checker` where it came.
    fn follow(
        &mut self,
        setpoint: &AxisSetpoint,
        checker: &mut Checker<'_>,
    ) -> Result<(), SimulationError> {
        if self.lost {
            return Ok(());
        }
        if self.twin.is_none() {
            let (start, spindle) = (&setpoint.axes.position, self.spindle.clone());
            let twin = match Simulated::with_spindle(self.machine, start, spindle) {
                Ok(twin) => twin,
                // The check of set-points reports how deep.
                Err(SimulationError { error: PhysicsError::Overlap { parts, .. }, .. })
                    if !parts.iter().any(|part| matches!(part, Part::Body(_))) =>
                {
                    let at = (setpoint.place, true);
                    let parts = (parts, self.spindle.number());
                    checker.findings.add(None, messages::starts_inside(self.machine, at, parts));
                    self.lost = true;
                    return Ok(());
                }
                Err(error) => return Err(error),
            };
            self.twin = Some(twin.in_scenario(&self.scenario));
        }
        let Some(twin) = &mut self.twin else { return Ok(()) };
        match twin.command_before(setpoint, &self.ahead).and_then(|()| twin.feedback()) {
            Ok(Some(feedback)) => checker.following(setpoint, &feedback.position),
            Ok(None) => {}
            // The same after a tool change.
            Err(PhysicsError::Overlap { parts, .. }) => {
                let (at, parts) = ((setpoint.place, false), (parts, twin.tool()));
                checker.findings.add(None, messages::starts_inside(self.machine, at, parts));
                self.lost = true;
            }
            // A machine that can be built and cannot do what is asked of it: the program is wrong, not the command.
            Err(error) => {
                self.lost = true;
                // What happened reports that.
                let reported = matches!(
                    error,
                    PhysicsError::LimitSwitch { .. } | PhysicsError::Collision { .. }
                );
                if reported {
                    return Ok(());
                }
                let error = SimulationError::with_tool(self.machine, error, twin.tool());
                checker.findings.add(None, messages::lost(setpoint.place, &error));
            }
        }
        Ok(())
    }
}
