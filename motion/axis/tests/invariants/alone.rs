//! Random moves of a single axis, superimposed motion, homing and probes.

use super::*;

pub(super) fn rate(random: &mut Random) -> f64 {
    if random.one_in(50) { 0.0 } else { random.between(0.2 * STEEPEST, STEEPEST) }
}

pub(super) fn speed(random: &mut Random) -> f64 {
    random.between(0.1, 0.5 * FASTEST)
}

pub(super) fn way(random: &mut Random) -> f64 {
    random.between(-20.0, 20.0)
}

/// A block with its own rates; the fields before and after them, in the order of their draws.
macro_rules! own_rates {
    ($block:ident, $random:ident, [$($before:ident: $first:expr),*], [$($after:ident: $last:expr),*]) => {
        limited(
            |it: &$block, _| own(it.velocity, it.acceleration, it.deceleration),
            |$random, _, _| $block {
                $($before: $first,)*
                acceleration: rate($random),
                deceleration: rate($random),
                $($after: $last,)*
            },
        )
    };
}

/// Moves to positions, by distances and with velocities, and stops.
pub(super) fn moves() -> Blocks {
    vec![
        own_rates!(
            MoveAbsolute,
            random,
            [position: random.between(0.0, 90.0), velocity: speed(random)],
            [direction: random.direction()]
        ),
        own_rates!(MoveRelative, random, [distance: way(random), velocity: speed(random)], []),
        own_rates!(MoveAdditive, random, [distance: way(random), velocity: speed(random)], []),
        own_rates!(MoveVelocity, random, [velocity: speed(random)], [direction: random.direction()]),
        limited(
            |it: &Halt, _| own(0.0, it.deceleration, it.deceleration),
            |random, _, _| Halt { deceleration: rate(random) },
        ),
        limited(
            |it: &Stop, _| own(0.0, it.deceleration, it.deceleration),
            |random, _, _| Stop { deceleration: rate(random) },
        ),
    ]
}

/// Continuous moves.
pub(super) fn continued() -> Blocks {
    vec![
        own_rates!(
            MoveContinuousAbsolute,
            random,
            [
                position: random.between(0.0, 90.0),
                velocity: 0.5 * FASTEST,
                end_velocity: speed(random),
                end_velocity_direction: random.direction()
            ],
            [direction: random.direction()]
        ),
        own_rates!(
            MoveContinuousRelative,
            random,
            [
                distance: way(random),
                velocity: 0.5 * FASTEST,
                end_velocity: speed(random),
                end_velocity_direction: random.direction()
            ],
            []
        ),
    ]
}

/// Superimposed motion.
struct OnTop {
    block: SuperImposed,
    /// Limits at its begin.
    taken: AxisLimits,
    execute: bool,
    /// Factor of its real limits.
    more: f64,
}

impl Called for OnTop {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        let inputs = self.block.inputs;
        if execute && !self.execute {
            let MoveSuperImposed { velocity_diff, acceleration, deceleration, .. } = inputs;
            self.taken = limits(velocity_diff, acceleration, deceleration);
        }
        self.execute = execute;
        self.block.inputs.velocity_diff *= self.more;
        self.block.inputs.acceleration *= self.more;
        let shown = self.block.call(execute, axis);
        self.block.inputs = inputs;
        shown
    }

    fn on_top(&self) -> Option<AxisLimits> {
        Some(self.taken)
    }

    fn owner(&self) -> i64 {
        self.block.owner().unwrap_or_default()
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        self.block.inputs.distance = random.between(-6.0, 6.0);
        self.block.inputs.velocity_diff = speed(random);
        self.block.inputs.acceleration = rate(random);
        self.block.inputs.deceleration = rate(random);
    }
}

/// A superimposed motion with a factor of its limits, which is a planted fault but for 1.
pub(super) fn hasty_on_top(more: f64) -> Box<dyn Called> {
    let taken = limits(1.0, 1.0, 1.0);
    Box::new(OnTop { block: on_top(1.0, 1.0, 1.0), taken, execute: false, more })
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

/// Homing by the drive, and probes, which do not move the axis.
pub(super) fn others() -> Blocks {
    let homing = limited(
        |_, _| Promise::Nothing,
        |random, _, _| Home { position: way(random), deceleration: random.one_of(&[0.0, 50.0]) },
    );
    vec![homing, probe(Trigger::of_program()), probe(Trigger::of_drive(1))]
}
