//! Master axis of the random sequences.

use super::*;

/// An axis that is led about, for others to follow: at most 10 u/s and 60 u/s².
pub(super) struct Lead {
    pub(super) rig: Rig,
    to: Block<MoveAbsolute>,
    on: Block<MoveVelocity>,
    halt: Block<Halt>,
    which: usize,
}

impl Lead {
    pub(super) fn new(config: AxisConfig) -> Self {
        let (acceleration, deceleration) = (60.0, 60.0);
        let to = MoveAbsolute { acceleration, deceleration, ..to(30.0).inputs };
        let on = MoveVelocity { acceleration, deceleration, ..endless(10.0).inputs };
        let rig = Rig::new(AxisConfig { jerk: 0.5 * JERK, ..config });
        let halt = Block::new(Halt { deceleration });
        Self { rig, to: Block::new(to), on: Block::new(on), halt, which: 0 }
    }

    pub(super) fn cycle(&mut self, random: &mut Random) {
        let Self { rig, to, on, halt, which } = self;
        let changes = random.one_in(150);
        if changes {
            *which = random.one_of(&[0, 1, 1, 2]);
            to.inputs.position = random.between(0.0, 90.0);
            to.inputs.direction = random.direction();
            on.inputs.velocity = random.between(0.0, 10.0);
            on.inputs.direction = random.one_of(&[Direction::Positive, Direction::Negative]);
        }
        // Old ones are called until they say so; the new one begins the cycle after.
        let execute = [0, 1, 2].map(|index| index == *which && !changes);
        rig.cycle(|axis| {
            to.call(execute[0], axis);
            on.call(execute[1], axis);
            halt.call(execute[2], axis);
        });
    }
}
