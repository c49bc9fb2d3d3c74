//! Events of the simulated machine: lost steps, overload, limit switches, brakes, faults.

use crate::side::Side;

/// Something that happened in the simulated machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicsEvent {
    /// End of the cycle in which it did, ns since the machine was made.
    pub time_ns: i64,
    /// The axis, from 0.
    pub axis: usize,
    /// Its kind.
    pub kind: EventKind,
}

/// Kinds of events of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// The rotor of a step motor fell behind its field (or was pushed ahead of it, below 0) by more than two full steps, and
    /// these full steps are lost.
    LostSteps(i64),
    /// The motor has exceeded its continuous limit for too long.
    Overload,
    /// The axis ran on its lower or upper limit switch; its drive brakes.
    LimitSwitch(Side),
    /// Without power the brake has closed.
    BrakeClosed,
    /// An injected fault has begun.
    Failed(Fault),
}

/// A fault of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The axis does not move any more, whatever pushes it.
    Jam,
    /// The next full steps of the pulse train, this number, do not reach the step motor. A servo motor has none to
    /// lose.
    LostSteps(f64),
    /// The belt, or whatever gives way, has this part of its stiffness and damping left, and this much more play (m or rad).
    /// A rigid transmission has nothing to loosen.
    LooseBelt {
        /// Above 0, usually below 1.
        stiffness: f64,
        /// m or rad, not below 0.
        backlash: f64,
    },
    /// The drive has no power any more; its brake, if there is one, closes.
    PowerLoss,
}
