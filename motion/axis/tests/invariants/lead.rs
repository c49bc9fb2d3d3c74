//! Master axis of the random sequences.

use super::random::Random;
use super::{JERK, POWER};
use crate::{Axis, AxisConfig, Block, Direction, Halt, MoveAbsolute, MoveVelocity, VirtualDrive};

/// An axis that is led about, for others to follow: at most 10 u/s and 60 u/s².
pub(super) struct Lead {
    pub(super) axis: Axis,
    drive: VirtualDrive,
    to: Block<MoveAbsolute>,
    on: Block<MoveVelocity>,
    halt: Block<Halt>,
    which: usize,
}

impl Lead {
    pub(super) fn new(config: AxisConfig) -> Self {
        let (velocity, acceleration, deceleration) = (10.0, 60.0, 60.0);
        let (position, direction) = (30.0, Direction::Positive);
        let to = MoveAbsolute { position, velocity, acceleration, deceleration, direction };
        let on = MoveVelocity { velocity, acceleration, deceleration, direction };
        Self {
            axis: Axis::new(AxisConfig { jerk: 0.5 * JERK, ..config }),
            drive: VirtualDrive::new(0.0),
            to: Block::new(to),
            on: Block::new(on),
            halt: Block::new(Halt { deceleration }),
            which: 0,
        }
    }

    pub(super) fn cycle(&mut self, random: &mut Random) {
        let changes = random.one_in(150);
        if changes {
            self.which = random.one_of(&[0, 1, 1, 2]);
            self.to.inputs.position = random.between(0.0, 90.0);
            self.to.inputs.direction = random.direction();
            self.on.inputs.velocity = random.between(0.0, 10.0);
            self.on.inputs.direction = random.one_of(&[Direction::Positive, Direction::Negative]);
        }
        self.axis.begin_cycle(&self.drive.feedback());
        let powered = POWER.call(true, &mut self.axis).status;
        let mut execute = [false; 3];
        execute[self.which] = powered && !changes;
        // Old ones are called until they say so; the new one begins the cycle after.
        self.to.call(execute[0], &mut self.axis);
        self.on.call(execute[1], &mut self.axis);
        self.halt.call(execute[2], &mut self.axis);
        self.drive.follow(&self.axis.end_cycle());
    }
}
