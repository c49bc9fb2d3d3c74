//! Events of the simulated machine: lost steps, overload, limit switches, brakes, faults.

use super::fault::Fault;

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
    /// The motor has given more than it bears for ever, for too long.
    Overload,
    /// The axis ran on its lower or upper limit switch; its drive brakes.
    LimitSwitch(Side),
    /// Without power the brake has closed.
    BrakeClosed,
    /// A fault has begun that was asked for.
    Failed(Fault),
}

/// An end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where positions are small.
    Lower,
    /// Where they are large.
    Upper,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        })
    }
}
