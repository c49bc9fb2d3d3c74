//! Contacts between the parts of a machine and its surroundings: reports and state.

use nalgebra::{Point3, Vector3};

use crate::contact_solver::Row;
use crate::distances::Near;
use crate::joint::JointVector;
use crate::surroundings::{Part, Surroundings};

/// Contact force between two parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The parts.
    pub parts: [Part; 2],
    /// All points of contact together, mean over the last cycle, N.
    pub force: f64,
    /// The middle of the force, m, machine frame.
    pub point: Point3<f64>,
    /// Penetration depth, m.
    pub depth: f64,
}

/// The beginning of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// End of the cycle in which they touched, ns since the machine was made.
    pub time_ns: i64,
    /// Approach speed, m/s.
    pub speed: f64,
    /// The contact in that cycle.
    pub contact: Contact,
}

/// Contact between two parts in a step of rapier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Numbers of the parts, the smaller first.
    pub(super) numbers: [usize; 2],
    /// The parts in that order.
    pub(super) parts: [Part; 2],
    /// N·s.
    pub(super) impulse: f64,
    /// The same as a vector, on the second part, machine frame.
    pub(super) push: Vector3<f64>,
    /// Machine frame, m.
    pub(super) point: Point3<f64>,
    /// m.
    pub(super) depth: f64,
    /// Approach speed at the beginning of the step, m/s.
    pub(super) speed: f64,
}

/// Two parts that touch, by their numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct TouchingPair {
    pub(super) parts: [usize; 2],
    /// Penetration depth before the contact was found, m.
    pub(super) depth: f64,
}

/// Contact state between the parts of a machine and its surroundings.
#[derive(Clone, Debug)]
pub(super) struct ContactState {
    /// Contact stiffness, N/m.
    pub(super) stiffness: f64,
    /// Lasting contact effort at the axes, N or Nm.
    pub(super) push: JointVector,
    /// Those of this cycle.
    pub(super) contacts: Vec<Contact>,
    /// Those of the cycle before.
    pub(super) before: Vec<Contact>,
    /// Pairs that touched in the last step.
    pub(super) touching: Vec<TouchingPair>,
    /// Contacts that have begun.
    pub(super) collisions: Vec<Collision>,
    /// Efforts of the contacts that rapier solved in the last cycle: at the axes, and at its joints, N or Nm.
    pub(super) by_rapier: [JointVector; 2],
    /// Velocities of rapier's joints in the last cycle, m/s or rad/s.
    pub(super) velocity: JointVector,
    /// Workspaces.
    pub(super) touches: Vec<Touch>,
    pub(super) near: Vec<Near>,
    pub(super) rows: Vec<Row>,
}

impl Default for ContactState {
    fn default() -> Self {
        Self {
            stiffness: Surroundings::STIFFNESS,
            push: JointVector::zeros(),
            contacts: Vec::new(),
            before: Vec::new(),
            touching: Vec::new(),
            collisions: Vec::new(),
            by_rapier: [JointVector::zeros(); 2],
            velocity: JointVector::zeros(),
            touches: Vec::new(),
            near: Vec::new(),
            rows: Vec::new(),
        }
    }
}
