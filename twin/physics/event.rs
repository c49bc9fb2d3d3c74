//! Events of the simulated machine: lost steps, overload, limit switches, brakes, faults, and what happens to loose
//! bodies.

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

/// Something that happened to a loose body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyEvent {
    /// End of the cycle in which it did, ns since the machine was made.
    pub time_ns: i64,
    /// Its kind.
    pub kind: BodyEventKind,
}

/// Kinds of events of loose bodies; bodies and grippers by their places in [`crate::Surroundings`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyEventKind {
    /// A gripper closed and holds a body.
    Gripped {
        /// The gripper.
        gripper: usize,
        /// The body.
        body: usize,
    },
    /// A gripper closed, and no body was within its reach.
    Missed {
        /// The gripper.
        gripper: usize,
    },
    /// A gripper opened.
    Released {
        /// The gripper.
        gripper: usize,
        /// The body.
        body: usize,
    },
    /// A load was larger than a gripper holds.
    Lost {
        /// The gripper.
        gripper: usize,
        /// The body.
        body: usize,
        /// Its cause.
        cause: LossCause,
        /// Force (N) and moment (Nm) at the gripper.
        load: [f64; 2],
    },
    /// A load was larger than a clamp holds.
    ClampGaveWay {
        /// The body.
        body: usize,
        /// N.
        force: f64,
    },
    /// The machine pushed a body from its place.
    Moved {
        /// The body.
        body: usize,
        /// The part of the machine that pushed it.
        by: crate::Part,
    },
    /// A body fell below everything that could carry it.
    Dropped {
        /// The body.
        body: usize,
    },
}

/// Cause of the loss of a gripped body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LossCause {
    /// Its weight and its acceleration.
    Acceleration,
    /// It touched something.
    Collision,
}
