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
    /// A step motor lost these full steps: its rotor fell behind its field by more than two (below 0: ahead).
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
    /// The axis does not move any more, however hard it is pushed.
    Jam,
    /// This number of full steps of the pulse train does not reach the step motor; servo motors ignore it.
    LostSteps(f64),
    /// An elastic transmission keeps this part of stiffness and damping, and gets this additional play (m or rad).
    LooseBelt {
        /// Above 0, usually below 1.
        stiffness: f64,
        /// m or rad, not below 0.
        backlash: f64,
    },
    /// The drive has no power any more; its brake, if there is one, closes.
    PowerLoss,
}
