//! Snapshots: the state of the whole machine at one time, which can be restored any number of times.

use crate::machine::PhysicsMachine;

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

    /// Restores the state of the machine. From there the same inputs give the same result to the bit.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.clone_from(&snapshot.0);
    }
}
