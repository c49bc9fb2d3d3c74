//! Snapshots: the whole machine at one time, to go on from there as often as one likes.

use super::machine::PhysicsMachine;

/// A machine as it was: bodies, contacts, rotors, drives, heat, noise.
#[derive(Clone, Debug)]
pub struct Snapshot(Box<PhysicsMachine>);

impl Snapshot {
    /// Since the machine was made, ns.
    pub fn time_ns(&self) -> i64 {
        self.0.axis_state().time_ns
    }
}

impl PhysicsMachine {
    /// The machine as it is now.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(Box::new(self.clone()))
    }

    /// Puts the machine back to where it was; from there it does the same bits if it is told the same.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.clone_from(&snapshot.0);
    }
}
