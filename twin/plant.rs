//! Plant: the interface of anything that follows set-points, a simulated machine or drives.

use crate::setpoint::AxisSetpoint;
use nalgebra::Isometry3;
use std::collections::VecDeque;
use twin_kinematics::AxisVector;
use twin_machine::FaultAt;
use twin_path::Place;
use twin_physics::{BodyEventKind, EventKind, MotorLoad, MotorState, Part};

/// Measured axis positions at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFeedback {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// m or rad, machine-file order.
    pub position: AxisVector,
}

/// An event besides the motion, and its block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Happening {
    /// The block in which the set-point was.
    pub place: Place,
    /// The axis, in machine-file order.
    pub axis: usize,
    /// Its kind. Repeated events of an axis in one line count as one, with the sum of lost steps.
    pub kind: EventKind,
}

/// Something that was run into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// The block in which the set-point was.
    pub place: Place,
    /// The parts that collided.
    pub parts: [Part; 2],
    /// Tool of the tool table in the spindle, by its number.
    pub tool: Option<u32>,
    /// Approach speed, m/s.
    pub speed: f64,
    /// N·s.
    pub impulse: f64,
    /// Peak force at the contact stiffness of the machine file, N: v·√(k·m) of the mass m = impulse/v that was stopped.
    pub peak: f64,
}

/// A probe that touched something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeTouch {
    /// The block in which the set-point was.
    pub place: Place,
    /// Measured axis positions at the end of the cycle, m or rad.
    pub position: AxisVector,
}

/// A probe that should have touched something and has not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeMiss {
    /// The block of the probing move.
    pub place: Place,
    /// As near as it came, m.
    pub nearest: f64,
}

/// Something that happened to a loose body or a gripper, and its block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHappening {
    /// The block in which the set-point was.
    pub place: Place,
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// Its kind.
    pub kind: BodyEventKind,
    /// Distance of a gripper that missed from the nearest body, m.
    pub distance: Option<f64>,
}

impl BodyHappening {
    /// The body, or the gripper where it concerns no body; in machine-file order.
    pub(crate) fn subject(&self) -> usize {
        match self.kind {
            BodyEventKind::Gripped { body, .. }
            | BodyEventKind::Released { body, .. }
            | BodyEventKind::Lost { body, .. }
            | BodyEventKind::ClampGaveWay { body, .. }
            | BodyEventKind::Moved { body, .. }
            | BodyEventKind::Dropped { body } => body,
            BodyEventKind::Missed { gripper } => gripper,
        }
    }
}

/// A loose body at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRecord {
    /// Its pose, machine frame.
    pub pose: Isometry3<f64>,
    /// The gripper that holds it, in machine-file order.
    pub held_by: Option<usize>,
}

/// Record of a plant for a whole run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlantRecord {
    /// Events, in the order of lines.
    pub happenings: Vec<Happening>,
    /// Faults of the scenario that have not begun.
    pub faults_to_come: Vec<FaultAt>,
    /// Touches of probes.
    pub touches: Vec<ProbeTouch>,
    /// Probing moves that should have touched something and have not.
    pub missed: Vec<ProbeMiss>,
    /// Collisions.
    pub blows: Vec<Blow>,
    /// What happened to loose bodies and grippers, in the order of time.
    pub handled: Vec<BodyHappening>,
    /// Loose bodies at the end, in machine-file order; none where they are not known.
    pub bodies: Vec<BodyRecord>,
    /// Number of events that are not kept.
    pub left_out: u64,
    /// Motor loads, in machine-file order; none where they are not known.
    pub loads: Vec<MotorLoad>,
}

/// Something whose axes follow set-points.
///
/// Set-points come in order, one per cycle, time-stamped and possibly ahead of time; feedback comes when it comes.
pub trait Plant {
    /// Why it cannot go on.
    type Error;

    /// Takes the next set-point.
    ///
    /// # Errors
    /// If the plant has failed; its axes have then been brought to a stop as well as it can.
    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), Self::Error>;

    /// How far behind a set-point it wants to see those that are planned, ns.
    fn horizon_ns(&self) -> i64 {
        0
    }

    /// Takes the next set-point, and looks at those that are planned `ahead`, behind it; they may change.
    ///
    /// # Errors
    /// As [`Self::command`].
    fn command_before(
        &mut self,
        setpoint: &AxisSetpoint,
        _ahead: &VecDeque<AxisSetpoint>,
    ) -> Result<(), Self::Error> {
        self.command(setpoint)
    }

    /// The next feedback that has arrived, if any.
    ///
    /// # Errors
    /// As [`Self::command`].
    fn feedback(&mut self) -> Result<Option<AxisFeedback>, Self::Error>;

    /// What its motors did in the cycle of the last set-point, in machine-file order; none where it is not known.
    fn motors(&self) -> &[MotorState] {
        &[]
    }

    /// Tool of the tool table in its spindle, by its number.
    fn tool(&self) -> Option<u32> {
        None
    }

    /// Whether it has come as near to the last set-point as it will; drives that follow late go on behind it.
    fn has_arrived(&self) -> bool {
        true
    }

    /// What happened in the cycle of the last set-point that is reported while the run goes on; each kind of it once
    /// per axis and line.
    fn news(&mut self) -> Vec<Happening> {
        Vec::new()
    }

    /// Poses of the loose bodies after the last cycle, machine frame; none where they are not known.
    fn body_poses(&self) -> Vec<Isometry3<f64>> {
        Vec::new()
    }

    /// What happened to loose bodies and grippers in the cycle of the last set-point.
    fn body_news(&mut self) -> Vec<BodyHappening> {
        Vec::new()
    }

    /// What it has to tell of the run so far.
    fn record(&self) -> PlantRecord {
        PlantRecord::default()
    }
}
