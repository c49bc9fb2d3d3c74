//! Interface from the checker to the blocks: their calls, and the promise of each.

use super::checker::{Limits, Promise};
use super::random::Random;
use super::{alone, coupled, direct, homed, others, tables};
use crate::{Axis, Block, Master, Motion, Outputs};
use std::any::type_name;
use twin_profile::State;

/// A block that can be called.
pub(super) trait Called {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs;

    /// Checks its additional invariants after a call.
    fn watch(&mut self, _shown: Outputs, _axis: &Axis, _master: &Axis) -> Result<(), String> {
        Ok(())
    }

    /// Other inputs, now and then wrong ones.
    fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis);

    /// Its name.
    fn name(&self) -> &'static str {
        type_name::<Self>()
    }

    /// True if it moves the axis while it is busy.
    fn moves(&self) -> bool {
        true
    }

    /// Its owner number while it moves the axis, or moves on top of another block.
    fn owner(&self) -> i64 {
        0
    }

    /// Whether it never ends, never fails, and is never aborted.
    fn exceptions(&self) -> [bool; 3] {
        let name = self.name();
        [
            name.contains("Follow") || name.contains("ControlAxis"),
            name.contains("Probe") || name.contains("Mode"),
            ["Stop", "Hom", "Mode", "Write"].iter().any(|it| name.contains(it)),
        ]
    }

    /// Its promise while it moves the axis.
    fn promise(&self) -> Promise {
        Promise::USUAL
    }

    /// Its limits while it moves on top of another block.
    fn on_top(&self) -> Option<Limits> {
        None
    }
}

/// Passes methods of [`Called`] on to a field.
macro_rules! passes_on {
    ($field:tt: $($method:ident)*) => {
        $(passes_on! { @$method $field })*
    };
    (@call $field:tt) => {
        fn call(
            &mut self,
            execute: bool,
            random: &mut Random,
            axis: &mut Axis,
            master: &Axis,
        ) -> Outputs {
            self.$field.call(execute, random, axis, master)
        }
    };
    (@change $field:tt) => {
        fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis) {
            self.$field.change(random, axis, master);
        }
    };
    (@name $field:tt) => {
        fn name(&self) -> &'static str {
            self.$field.name()
        }
    };
    (@owner $field:tt) => {
        fn owner(&self) -> i64 {
            self.$field.owner()
        }
    };
    (@promise $field:tt) => {
        fn promise(&self) -> Promise {
            self.$field.promise()
        }
    };
}

pub(super) use passes_on;

/// Further input of a block, from the master.
pub(super) trait Take {
    fn take(master: &Axis) -> Self;
}

impl Take for () {
    fn take(_: &Axis) -> Self {}
}

impl Take for Master {
    fn take(master: &Axis) -> Self {
        Self::of(master)
    }
}

/// A [`Block`], how its inputs are chosen, and how those that count every cycle change.
pub(super) struct Moving<M: Motion> {
    pub(super) block: Block<M>,
    promise: Keeps<M>,
    /// Inputs at its start.
    pub(super) taken: M,
    begun: Begun,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
    live: Live<M>,
    execute: bool,
    fault: Fault<M>,
}

/// A planted fault of a block: how it does other than it was asked. None by default.
pub(super) struct Fault<M: Motion> {
    /// Other inputs.
    pub(super) inputs: fn(&mut M),
    /// Factor of the jerk that it plans with.
    pub(super) jerk: f64,
    /// Another set-point.
    pub(super) setpoint: fn(&M::Run, &mut State),
}

impl<M: Motion> Default for Fault<M> {
    fn default() -> Self {
        Self { inputs: |_| (), jerk: 1.0, setpoint: |_, _| () }
    }
}

/// Start of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Begun {
    /// Motion of the axis then.
    pub(super) from: State,
    /// True if it has been done (in gear) since.
    pub(super) done: bool,
    /// Cycles since then.
    pub(super) cycles: u32,
}

/// Promise of a block for these inputs.
pub(super) type Keeps<M> = fn(&M, &Begun) -> Promise;

/// Change of inputs that count every cycle; the state is the axis's in the last cycle.
type Live<M> = fn(&mut M, &mut Random, &Axis, State);

impl<M: Motion> Moving<M> {
    pub(super) fn with(self, fault: Fault<M>) -> Self {
        Self { fault, ..self }
    }
}

impl<M: Motion<With: Take> + Clone> Called for Moving<M> {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs {
        let rises = execute && !self.execute;
        self.execute = execute;
        // A takeover includes superimposed motions.
        let goes_on = self.block.owner() == Some(axis.owner()) && !rises;
        let from = if goes_on { axis.saved_base } else { axis.saved };
        (self.live)(&mut self.block.inputs, random, axis, from);
        self.begun.cycles += 1;
        if rises {
            self.taken = self.block.inputs.clone();
            self.begun = Begun { from: axis.start().state, ..Begun::default() };
        }
        let (asked, jerk) = (self.block.inputs.clone(), axis.values.max_jerk);
        (self.fault.inputs)(&mut self.block.inputs);
        axis.values.max_jerk *= self.fault.jerk;
        let shown = self.block.call_with(execute, axis, M::With::take(master));
        (self.block.inputs, axis.values.max_jerk) = (asked, jerk);
        let before = axis.base;
        if let Some(run) = self.block.running() {
            (self.fault.setpoint)(run, &mut axis.base);
        }
        if axis.base != before {
            axis.show_set_values();
        }
        self.begun.done |= shown.done;
        shown
    }

    fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis) {
        self.block.inputs = (self.inputs)(random, axis, master);
    }

    fn name(&self) -> &'static str {
        type_name::<M>()
    }

    fn owner(&self) -> i64 {
        self.block.owner().unwrap_or_default()
    }

    fn promise(&self) -> Promise {
        (self.promise)(&self.taken, &self.begun)
    }
}

/// A block with a promise, whose inputs are taken over at the rising edge.
pub(super) fn limited<M: Motion<With: Take> + Clone + 'static>(
    promise: Keeps<M>,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
) -> Box<dyn Called> {
    any(promise, inputs, |_, _, _, _| ())
}

pub(super) fn any<M: Motion<With: Take> + Clone + 'static>(
    promise: Keeps<M>,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
    live: Live<M>,
) -> Box<dyn Called> {
    Box::new(moving(promise, inputs, live))
}

pub(super) fn moving<M: Motion<With: Take> + Clone>(
    promise: Keeps<M>,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
    live: Live<M>,
) -> Moving<M> {
    let nowhere = Axis::new(crate::AxisConfig::default());
    let block = Block::new(inputs(&mut Random(1), &nowhere, &nowhere));
    let taken = block.inputs.clone();
    let begun = Begun::default();
    let fault = Fault::default();
    Moving { block, promise, taken, begun, inputs, live, execute: false, fault }
}

/// The block's own velocity, acceleration and deceleration.
pub(super) fn own(velocity: f64, acceleration: f64, deceleration: f64) -> Promise {
    Promise::Limits(Limits::new(velocity, acceleration, deceleration))
}

/// All blocks; the superimposed motion is called last, as in the manual.
pub(super) fn all() -> Vec<Box<dyn Called>> {
    let mut blocks = alone::moves();
    blocks.extend(alone::continued());
    blocks.extend(tables::all());
    blocks.extend(coupled::all());
    blocks.extend(direct::all());
    blocks.extend(homed::all());
    blocks.extend(others::all());
    blocks.push(alone::on_top());
    blocks
}

/// Moves of the axis alone.
pub(super) fn single() -> Vec<Box<dyn Called>> {
    let mut blocks = alone::moves();
    blocks.push(alone::on_top());
    blocks
}
