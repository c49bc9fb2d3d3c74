//! Outputs that M functions and tappets switch during a run, and the acknowledgement of M functions.

use super::run::Run;
use super::{Answer, Observer, Stopped};
use crate::hardware::Hardware;
use crate::m_function::MCall;
use crate::plant::Plant;
use crate::setpoint::AxisSetpoint;
use twin_machine::MFunction;
use twin_machine::Machine;
use twin_machine::switch_points::changed;
use twin_machine::tappets::Signal;
use twin_physics::PhysicsError;

/// The outputs of `machine` that follow one of `signals`: index of the signal, device, output.
pub(super) fn tappet_outputs(machine: &Machine, signals: &[Signal]) -> Vec<(usize, usize, u8)> {
    let found = machine.tappet_outputs.iter().filter_map(|one| {
        let wanted = |signal: &Signal| signal.axis == one.axis && signal.group == one.group;
        Some((signals.iter().position(wanted)?, one.device, one.output))
    });
    found.collect()
}

impl<'a, P: Plant<Error = PhysicsError>> Run<'a, '_, P> {
    /// True if the plan waits for the acknowledgement of an M function. A stop does not wait for it.
    pub(super) fn waits_for_word(&self) -> bool {
        self.stopped.is_none() && self.items.waits_for_word()
    }

    /// Starts an M function that is executed now.
    pub(super) fn begin_m_function(&mut self, call: MCall, observer: &mut dyn Observer) {
        if self.m_call.is_some_and(|last| last.index == call.index) {
            return;
        }
        self.m_call = Some(call);
        let switched = self.switches(call.number);
        if let (Some(function), Some(hardware)) = (switched, &mut self.hardware) {
            hardware.switch(&function.outputs_on, &function.outputs_off, call.since_ns);
        }
        observer.m_function(&call, self.items.waits_for_word() && switched.is_none());
    }

    /// Outputs follow their tappets and the switches of the path. They are switched when the set-point is due, and take as
    /// long as the wire does: `dead_time_s` of a cam makes up for that.
    pub(super) fn switch_outputs(&mut self, before: Option<&AxisSetpoint>, now: &AxisSetpoint) {
        let Some(hardware) = &mut self.hardware else { return };
        let tappets = before.map(|before| before.tappets).unwrap_or_default();
        let switches = before.map(|before| before.switches).unwrap_or_default();
        for (number, on) in changed(switches, now.switches) {
            let outputs = self.machine.switch_outputs.iter().filter(|one| one.number == number);
            outputs.for_each(|one| {
                hardware.switch_output(one.device, one.output, on, now.time_ns);
            });
        }
        for (signal, on) in now.tappets.changed(tappets) {
            let followers = self.tappet_outputs.iter().filter(|(index, ..)| *index == signal);
            followers.for_each(|(_, device, output)| {
                hardware.switch_output(*device, *output, on, now.time_ns);
            });
        }
    }

    /// What the M function switches on the drives, if there are any.
    fn switches(&self, number: u16) -> Option<&'a MFunction> {
        self.hardware.as_ref()?;
        self.machine.m_functions.iter().find(|function| function.number == number)
    }

    /// Lets the path go on if the M function at which it waits is done: the drives have switched its outputs and its
    /// time is over, or the user acknowledges it.
    pub(super) fn acknowledge(&mut self, observer: &mut dyn Observer) {
        // First it has to be executed: the plan is ahead.
        let Some(call) = self.m_call.filter(|call| self.items.m_call() == Some(*call)) else {
            return;
        };
        if !self.waits_for_word() {
            return;
        }
        if let Some(function) = self.switches(call.number) {
            let switched = self.hardware.as_ref().is_none_or(Hardware::has_switched);
            if switched && self.executed_ns() - call.since_ns >= function.time_ns {
                self.items.acknowledge();
            }
            return;
        }
        match observer.answer() {
            Answer::NotYet => {}
            Answer::Done => self.items.acknowledge(),
            Answer::Nobody => {
                let MCall { number, place, .. } = call;
                self.stopped = Some(Stopped::Unacknowledged { number, place });
                self.items.request_stop();
            }
        }
    }
}
