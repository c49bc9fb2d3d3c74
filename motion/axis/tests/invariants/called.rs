//! Interface from the checker to the blocks: their calls, and the promise of each.

use super::*;
use std::any::type_name;

/// A block that can be called.
pub(super) trait Called {
    fn call(&mut self, execute: bool, dice: &mut Random, axis: &mut Axis, lead: &Axis) -> Outputs;

    /// Checks its additional invariants after a call.
    fn watch(&mut self, _shown: Outputs, _axis: &Axis, _lead: &Axis) -> Checked {
        Ok(())
    }

    /// Other inputs, now and then wrong ones.
    fn change(&mut self, dice: &mut Random, axis: &Axis, lead: &Axis);

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

    /// True for what never comes: done (direct set-points), aborted (homing and stops), failed (probes of the program).
    fn exceptions(&self) -> [bool; 3] {
        [&["Follow", "ControlAxis"][..], &["Stop", "Home"], &["Probe"]]
            .map(|names| names.iter().any(|it| self.name().contains(it)))
    }

    /// Its promise while it moves the axis.
    fn promise(&self) -> Promise {
        Promise::USUAL
    }

    /// Its limits while it moves on top of another block.
    fn on_top(&self) -> Option<AxisLimits> {
        None
    }
}

/// Further input of a block, from the master.
pub(super) trait Take {
    fn take(lead: &Axis) -> Self;
}

impl Take for () {
    fn take(_: &Axis) -> Self {}
}

impl Take for Master {
    fn take(lead: &Axis) -> Self {
        Self::of(lead)
    }
}

/// A block after a call, with its inputs at its start and what it has shown.
pub(super) struct Look<'a, M: Motion> {
    pub(super) block: &'a Block<M>,
    pub(super) taken: &'a M,
    pub(super) shown: Outputs,
    pub(super) axis: &'a Axis,
    pub(super) lead: &'a Axis,
}

/// Additional invariants of a block.
pub(super) trait Watch<M: Motion> {
    fn see(&mut self, it: &Look<'_, M>) -> Checked;

    /// The block's promise, if it is not that of its inputs.
    fn promise(&self) -> Option<Promise> {
        None
    }
}

impl<M: Motion> Watch<M> for () {
    fn see(&mut self, _: &Look<'_, M>) -> Checked {
        Ok(())
    }
}

/// Planted fault in the ownership of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Owning {
    /// It commands the axis when another one has it: to where that has it.
    Usurps,
    /// The same, and it says that it is that one.
    Masked,
    /// It only says so.
    Claims,
    /// It does not notice that it has lost the axis.
    Deaf,
    /// There are two of it.
    Two,
}

/// A planted fault of a block: how it does other than it was asked. None by default.
pub(super) struct Fault<M: Motion> {
    /// Other inputs.
    pub(super) inputs: fn(&mut M),
    /// Factor of the jerk that it plans with.
    pub(super) jerk: f64,
    /// Another set-point.
    pub(super) setpoint: fn(&M::Run, &mut State),
    pub(super) owning: Option<Owning>,
}

impl<M: Motion> Fault<M> {
    pub(super) fn inputs(inputs: fn(&mut M)) -> Self {
        Self { inputs, ..Self::default() }
    }

    pub(super) fn setpoint(setpoint: fn(&M::Run, &mut State)) -> Self {
        Self { setpoint, ..Self::default() }
    }
}

impl<M: Motion> Default for Fault<M> {
    fn default() -> Self {
        Self { inputs: |_| (), jerk: 1.0, setpoint: |_, _| (), owning: None }
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

/// Choice of inputs, for an axis and its master.
type Inputs<M> = fn(&mut Random, &Axis, &Axis) -> M;

/// Change of inputs that count every cycle; the state is the axis's in the last cycle.
type Live<M> = fn(&mut M, &mut Random, &Axis, State);

/// A [`Block`], how its inputs are chosen, and how those that count every cycle change.
pub(super) struct Moving<M: Motion, W> {
    block: Block<M>,
    promise: Keeps<M>,
    /// Inputs at its start.
    taken: M,
    begun: Begun,
    inputs: Inputs<M>,
    live: Live<M>,
    execute: bool,
    fault: Fault<M>,
    /// Another one that it pretends to be.
    mask: Option<i64>,
    watch: W,
}

impl<M: Motion, W> Moving<M, W> {
    pub(super) fn living(self, live: Live<M>) -> Self {
        Self { live, ..self }
    }
}

impl<M: Motion<With: Take> + Clone, W: Watch<M>> Called for Moving<M, W> {
    fn call(&mut self, execute: bool, dice: &mut Random, axis: &mut Axis, lead: &Axis) -> Outputs {
        let rises = execute && !self.execute;
        self.execute = execute;
        // A takeover includes superimposed motions.
        let goes_on = self.block.owner() == Some(axis.owner()) && !rises;
        let from = if goes_on { axis.saved_base } else { axis.saved };
        (self.live)(&mut self.block.inputs, dice, axis, from);
        self.begun.cycles += 1;
        if rises {
            self.taken = self.block.inputs.clone();
            self.begun = Begun { from: axis.start().state, ..Begun::default() };
        }
        let (asked, jerk) = (self.block.inputs.clone(), axis.values.max_jerk);
        let twin = self.fault.owning.map(|owning| (owning, self.block.clone()));
        (self.fault.inputs)(&mut self.block.inputs);
        axis.values.max_jerk *= self.fault.jerk;
        let mut shown = self.block.call_with(execute, axis, M::With::take(lead));
        (self.block.inputs, axis.values.max_jerk) = (asked, jerk);
        let before = axis.base;
        if let Some(run) = self.block.running() {
            (self.fault.setpoint)(run, &mut axis.base);
        }
        if axis.base != before {
            axis.show_set_values();
        }
        self.begun.done |= shown.done;
        let Some((owning, mut twin)) = twin else { return shown };
        let (mine, owner) = (self.block.owner(), axis.owner());
        let others = execute && owner != 0 && mine != Some(owner);
        let masks = matches!(owning, Owning::Masked | Owning::Claims);
        self.mask = (others && masks).then_some(owner);
        match owning {
            Owning::Usurps | Owning::Masked if others => axis.drive_to(axis.base),
            Owning::Deaf if shown.command_aborted && axis.state().is_motion() => {
                (shown.command_aborted, shown.busy) = (false, true);
            }
            Owning::Two if mine.is_some() && twin.owner() == mine => {
                twin.call_with(execute, axis, M::With::take(lead));
            }
            _ => {}
        }
        shown
    }

    fn watch(&mut self, shown: Outputs, axis: &Axis, lead: &Axis) -> Checked {
        self.watch.see(&Look { block: &self.block, taken: &self.taken, shown, axis, lead })
    }

    fn change(&mut self, dice: &mut Random, axis: &Axis, lead: &Axis) {
        self.block.inputs = (self.inputs)(dice, axis, lead);
    }

    fn name(&self) -> &'static str {
        type_name::<M>()
    }

    fn owner(&self) -> i64 {
        self.mask.or(self.block.owner()).unwrap_or_default()
    }

    fn promise(&self) -> Promise {
        self.watch.promise().unwrap_or_else(|| (self.promise)(&self.taken, &self.begun))
    }
}

/// A block with a promise, whose inputs are taken over at the rising edge.
pub(super) fn moving<M: Motion<With: Take> + Clone, W>(
    promise: Keeps<M>,
    inputs: Inputs<M>,
    fault: Fault<M>,
    watch: W,
) -> Moving<M, W> {
    let nowhere = Axis::new(AxisConfig::default());
    let block = Block::new(inputs(&mut Random(1), &nowhere, &nowhere));
    let (taken, begun) = (block.inputs.clone(), Begun::default());
    let (live, execute, mask): (Live<M>, _, _) = (|_, _, _, _| (), false, None);
    Moving { block, promise, taken, begun, inputs, live, execute, fault, mask, watch }
}

/// The same without a fault and without additional invariants.
pub(super) fn limited<M: Motion<With: Take> + Clone + 'static>(
    promise: Keeps<M>,
    inputs: Inputs<M>,
) -> Box<dyn Called> {
    Box::new(moving(promise, inputs, Fault::default(), ()))
}

/// The block's own velocity, acceleration and deceleration.
pub(super) fn own(velocity: f64, acceleration: f64, deceleration: f64) -> Promise {
    Promise::Limits(limits(velocity, acceleration, deceleration))
}

/// All blocks; the superimposed motion is called last, as in the manual.
pub(super) fn all() -> Blocks {
    let mut blocks = alone::moves();
    blocks.extend(alone::continued());
    blocks.extend(tables::all());
    blocks.extend(coupled::all());
    blocks.extend(direct::all());
    blocks.extend(alone::others());
    blocks.push(alone::hasty_on_top(1.0));
    blocks
}

/// Moves of the axis alone.
pub(super) fn single() -> Blocks {
    let mut blocks = alone::moves();
    blocks.push(alone::hasty_on_top(1.0));
    blocks
}
