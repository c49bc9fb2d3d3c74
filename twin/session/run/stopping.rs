//! Stops before the end of a run, by the user or after a failure.

use super::{Plan, Run};
use crate::plant::Plant;
use crate::session::Stopped;
use crate::session::braking::{braking, resting};
use twin_machine::SimulationError;
use twin_physics::PhysicsError;

impl<P: Plant<Error = PhysicsError>> Run<'_, '_, P> {
    /// Handles interrupts of the user, `interrupts` being their number so far.
    pub(in crate::session) fn handle_interrupt(&mut self, interrupts: u32) {
        while self.interrupts < interrupts {
            self.interrupts += 1;
            self.resting.asked_ns.get_or_insert(self.executed_ns());
            if self.interrupts == 1 {
                // What is planned to its end goes to its end.
                if self.plan == Plan::GoesOn && self.stopped.is_none() {
                    self.stopped = Some(Stopped::Interrupted(self.place()));
                    self.items.request_stop();
                }
                continue;
            }
            self.stopped.get_or_insert(Stopped::Interrupted(self.place()));
            if self.plan != Plan::Brakes && self.goes_on() {
                self.brake();
            } else if let Some(hardware) = &mut self.hardware {
                hardware.stop();
            }
        }
    }

    /// Brakes every axis at its own limits from now on, on the simulated machine and on the drives. After the last
    /// set-point is due there is no plan to change: drives that still move are behind theirs, and brake on their own
    /// ramps.
    pub(in crate::session) fn brake(&mut self) {
        if !self.goes_on() {
            if let Some(hardware) = &mut self.hardware {
                hardware.stop();
            }
            return;
        }
        if self.plan == Plan::Brakes {
            return;
        }
        // Where planning has kept everything else waiting, the drives are ahead of the simulated machine.
        let now_ns = self.clock.map_or(self.executed_ns(), |clock| clock.now_ns());
        let due = self.planned.iter().take_while(|next| next.time_ns <= now_ns).count();
        // Everything stands at the first.
        self.planned.truncate(due.max(usize::from(self.executed.is_none())));
        self.come_to_rest();
    }

    /// Brakes every axis at its own limits from the end of the plan.
    pub(super) fn come_to_rest(&mut self) {
        self.plan = Plan::Brakes;
        let kept = self.planned.len();
        let moving = self.executed.is_some() || kept > 1;
        let from = self.planned.back().or(self.executed.as_ref()).copied();
        let rest = from.filter(|_| moving).map(|from| (from, braking(self.machine, &from)));
        if let Some((from, Ok(rest))) = rest {
            self.planned.extend(rest);
            if self.planned.len() > kept {
                self.off_path = Some(from.place);
            }
            if let Some(hardware) = &mut self.hardware {
                hardware.replan(from.time_ns, &self.planned.iter().skip(kept));
            }
        } else if let Some(hardware) = &mut self.hardware {
            hardware.stop();
        }
    }

    /// Appends set-points at rest after a stop that brakes as hard as the axes allow.
    pub(super) fn settle_stop(&mut self) {
        if self.stopped.is_none() || !self.items.is_within_axes() {
            return;
        }
        let Some(last) = self.planned.back().or(self.executed.as_ref()).copied() else { return };
        for setpoint in resting(self.machine, &last) {
            self.planned.push_back(setpoint);
            if let Some(hardware) = &mut self.hardware
                && let Err(source) = hardware.command(&setpoint)
            {
                return self.lose_drives(source);
            }
        }
    }

    /// Handles a failure of the planner: there are no set-points that lead to rest on the path. The existing plan is
    /// still good, and the axes brake from its end.
    pub(super) fn fail_plan(&mut self, reason: Stopped) {
        self.stopped.get_or_insert(reason);
        self.come_to_rest();
    }

    /// Handles a failure of the simulated machine: the drives brake, and the run ends.
    pub(super) fn lose_twin(&mut self, source: SimulationError) {
        self.twin_failed = true;
        self.resting.twin = None;
        self.stopped.get_or_insert(Stopped::Twin { place: self.place(), source });
        self.brake();
    }
}
