//! Random blocks that do not move the axis.

use super::called::Called;
use super::random::Random;
use crate::{
    AbortTrigger, Axis, ControllerMode, Outputs, ParameterNumber, SetControllerMode, TouchProbe,
    Trigger, WriteParameter,
};

/// Another controller mode, now and then.
struct Mode(SetControllerMode);

impl Called for Mode {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        self.0.call(execute, axis)
    }

    fn moves(&self) -> bool {
        false
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        use ControllerMode::{Current, Position, Torque, Velocity};
        self.0.mode = random.one_of(&[Position, Position, Position, Velocity, Torque, Current]);
    }
}

/// Parameters that change nothing about motion, protected ones and unknown ones.
struct Write {
    block: WriteParameter,
    execute: bool,
    /// Which one it was given when it began.
    taken: u16,
}

impl Write {
    const FREE: [u16; 3] = [1112, 1122, 1132];
    const PROTECTED: [u16; 6] = [1000, 1022, 1030, 1100, 1110, 999];
}

impl Called for Write {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        if execute && !self.execute {
            self.taken = match self.block.number {
                ParameterNumber::Axis(number) => number,
                ParameterNumber::Drive(_) => 0,
            };
        }
        self.execute = execute;
        self.block.call(execute, axis)
    }

    fn watch(&mut self, shown: Outputs, axis: &Axis, _: &Axis) -> Result<(), String> {
        let free = Self::FREE.contains(&self.taken);
        if shown.busy || (shown.done && !free) || (shown.error.is_some() && free) {
            return Err(format!("{} in {:?}: {shown:?}", self.taken, axis.state()));
        }
        Ok(())
    }

    fn moves(&self) -> bool {
        false
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        let numbers = if random.one_in(2) { &Self::FREE[..] } else { &Self::PROTECTED };
        self.block.number = ParameterNumber::Axis(random.one_of(numbers));
        self.block.value = random.between(1.0, 100.0);
    }
}

/// A probe of the program or of the drive.
struct Probe {
    block: TouchProbe,
    trigger: Trigger,
    abort: AbortTrigger,
}

impl Called for Probe {
    fn call(&mut self, execute: bool, random: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        self.trigger.input = random.one_in(100);
        self.abort.call(random.one_in(500), axis, &mut self.trigger);
        self.block.call(execute, axis, &mut self.trigger).outputs
    }

    fn moves(&self) -> bool {
        false
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        let window = [random.between(0.0, 90.0), random.between(0.0, 90.0)];
        self.block.window = (!random.one_in(3)).then_some(window);
    }
}

fn probe(trigger: Trigger) -> Box<dyn Called> {
    Box::new(Probe { block: TouchProbe::new(None), trigger, abort: AbortTrigger::default() })
}

pub(super) fn all() -> Vec<Box<dyn Called>> {
    let block = WriteParameter::new(ParameterNumber::Axis(1112), 1.0);
    vec![
        Box::new(Mode(SetControllerMode::default())),
        Box::new(Write { block, execute: false, taken: 1112 }),
        probe(Trigger::of_program()),
        probe(Trigger::of_drive(1)),
    ]
}
