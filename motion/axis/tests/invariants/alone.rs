//! Random moves of a single axis, and superimposed motion.

use super::called::{Called, limited, own};
use super::checker::Limits;
use super::random::Random;
use super::{FASTEST, STEEPEST};
use crate::tests::rig;
use crate::{
    Axis, Halt, MoveAbsolute, MoveAdditive, MoveContinuousAbsolute, MoveContinuousRelative,
    MoveRelative, MoveSuperImposed, MoveVelocity, Outputs, Stop, SuperImposed,
};

pub(super) fn rate(random: &mut Random) -> f64 {
    if random.one_in(50) { 0.0 } else { random.between(0.2 * STEEPEST, STEEPEST) }
}

pub(super) fn speed(random: &mut Random) -> f64 {
    random.between(0.1, 0.5 * FASTEST)
}

pub(super) fn way(random: &mut Random) -> f64 {
    random.between(-20.0, 20.0)
}

/// To places, with velocities, and to rest.
pub(super) fn moves() -> Vec<Box<dyn Called>> {
    vec![
        limited(
            |it: &MoveAbsolute, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveAbsolute {
                position: random.between(0.0, 90.0),
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            },
        ),
        limited(
            |it: &MoveRelative, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveRelative {
                distance: way(random),
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |it: &MoveAdditive, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveAdditive {
                distance: way(random),
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |it: &MoveVelocity, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveVelocity {
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            },
        ),
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

/// On from a place.
pub(super) fn continued() -> Vec<Box<dyn Called>> {
    vec![
        limited(
            |it: &MoveContinuousAbsolute, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveContinuousAbsolute {
                position: random.between(0.0, 90.0),
                velocity: 0.5 * FASTEST,
                end_velocity: speed(random),
                end_velocity_direction: random.direction(),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            },
        ),
        limited(
            |it: &MoveContinuousRelative, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveContinuousRelative {
                distance: way(random),
                velocity: 0.5 * FASTEST,
                end_velocity: speed(random),
                end_velocity_direction: random.direction(),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
    ]
}

/// Superimposed motion.
pub(super) struct OnTop {
    block: SuperImposed,
    /// What it was given when it began.
    taken: Limits,
    execute: bool,
    /// So much more than it says it is given; 1 but for one that is not as it should be.
    more: f64,
}

impl Called for OnTop {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        let inputs = self.block.inputs;
        if execute && !self.execute {
            let MoveSuperImposed { velocity_diff, acceleration, deceleration, .. } = inputs;
            self.taken = Limits::new(velocity_diff, acceleration, deceleration);
        }
        self.execute = execute;
        self.block.inputs.velocity_diff *= self.more;
        self.block.inputs.acceleration *= self.more;
        let shown = self.block.call(execute, axis);
        self.block.inputs = inputs;
        shown
    }

    fn on_top(&self) -> Option<Limits> {
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

pub(super) fn on_top() -> Box<dyn Called> {
    hasty_on_top(1.0)
}

/// One that is so much faster than it was asked.
pub(super) fn hasty_on_top(more: f64) -> Box<dyn Called> {
    let taken = Limits::new(1.0, 1.0, 1.0);
    Box::new(OnTop { block: rig::on_top(1.0, 1.0, 1.0), taken, execute: false, more })
}
