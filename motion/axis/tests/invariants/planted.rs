//! Blocks that are not as they should be.

use super::called::{self, Called};
use super::checker::Promise;
use crate::axis::ownership::{Refusal, Start};
use crate::axis::{self, Axis, AxisState, Motion, Progress, SmcError};

/// Takes the axis whatever it does.
#[derive(Clone, Debug)]
struct MoveRelative(axis::MoveRelative);

/// Moves on without an end, and calls it discrete.
#[derive(Clone, Debug)]
struct MoveVelocity(axis::MoveVelocity);

impl Motion for MoveRelative {
    type With = ();
    type Run = <axis::MoveRelative as Motion>::Run;
    const STATE: AxisState = AxisState::DiscreteMotion;

    fn admitted(&self, _axis: &Axis) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Self::Run, SmcError> {
        self.0.plan(start, axis, ())
    }

    fn step(&self, run: &mut Self::Run, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        self.0.step(run, axis, ())
    }
}

impl Motion for MoveVelocity {
    type With = ();
    type Run = <axis::MoveVelocity as Motion>::Run;
    const STATE: AxisState = AxisState::DiscreteMotion;

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Self::Run, SmcError> {
        self.0.plan(start, axis, ())
    }

    fn step(&self, run: &mut Self::Run, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        self.0.step(run, axis, ())
    }
}

/// A relative move that no state holds back.
pub(super) fn rude() -> Box<dyn Called> {
    called::limited(
        |_, _| Promise::Smooth,
        |random, _, _| {
            let distance = random.between(-20.0, 20.0);
            let (velocity, rate) = (random.between(0.1, 15.0), random.between(40.0, 200.0));
            let (acceleration, deceleration) = (rate, rate);
            MoveRelative(axis::MoveRelative { distance, velocity, acceleration, deceleration })
        },
    )
}

/// A move of velocity in discrete motion.
pub(super) fn mislabelled() -> Box<dyn Called> {
    called::limited(
        |_, _| Promise::Smooth,
        |random, _, _| {
            let (velocity, rate) = (random.between(0.1, 15.0), random.between(40.0, 200.0));
            let (acceleration, deceleration) = (rate, rate);
            let direction = random.direction();
            MoveVelocity(axis::MoveVelocity { velocity, acceleration, deceleration, direction })
        },
    )
}
