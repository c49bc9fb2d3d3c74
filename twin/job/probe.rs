//! Touch-probe blocks of jobs (manual 5.3), and their trigger inputs.

use super::block::{Called, With};
use twin_axis::{AbortTrigger, Axis, Outputs, TouchProbe};

/// Condition under which the input of a trigger is TRUE, for a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum When {
    /// At this time of the job, s.
    At(f64),
    /// When this axis passes this place, in its unit, in either direction.
    Passes(usize, f64),
}

/// An input of the job's program that latches.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JobTrigger {
    pub(super) name: String,
    pub(super) when: When,
}

/// Waits for a trigger, by its number.
#[derive(Debug)]
struct Probe {
    block: TouchProbe,
    trigger: usize,
    recorded: Option<f64>,
}

impl Called for Probe {
    fn call(&mut self, execute: bool, axis: &mut Axis, with: With<'_>) -> Outputs {
        let Some(trigger) = with.triggers.get_mut(self.trigger) else { return Outputs::default() };
        let probed = self.block.call(execute, axis, trigger);
        self.recorded = probed.outputs.done.then_some(probed.recorded_position);
        probed.outputs
    }

    fn recorded(&self) -> Option<f64> {
        self.recorded
    }

    fn trigger(&self) -> Option<usize> {
        Some(self.trigger)
    }
}

/// Lets go of a trigger, by its number.
#[derive(Debug)]
struct Abort(AbortTrigger, usize);

impl Called for Abort {
    fn call(&mut self, execute: bool, axis: &mut Axis, with: With<'_>) -> Outputs {
        let trigger = with.triggers.get_mut(self.1);
        trigger.map_or(Outputs::default(), |trigger| self.0.call(execute, axis, trigger))
    }
}

/// A probe of the trigger with this number, between two places if there are any.
pub(super) fn probe(trigger: usize, window: Option<[f64; 2]>) -> Box<dyn Called> {
    Box::new(Probe { block: TouchProbe::new(window), trigger, recorded: None })
}

/// Lets the trigger with this number go.
pub(super) fn abort(trigger: usize) -> Box<dyn Called> {
    Box::new(Abort(AbortTrigger::default(), trigger))
}
