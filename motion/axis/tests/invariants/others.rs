//! Random homing by the drive, and probes, which do not move the axis.

use super::*;

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
    let homing = limited(
        |_, _| Promise::Nothing,
        |random, _, _| Home { position: way(random), deceleration: random.one_of(&[0.0, 50.0]) },
    );
    vec![homing, probe(Trigger::of_program()), probe(Trigger::of_drive(1))]
}
