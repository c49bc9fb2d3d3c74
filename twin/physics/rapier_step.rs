//! A cycle in which rapier takes the step: what contacts and gripped bodies do to the axes.
//!
//! The equation of motion takes the machine from q to q₁, v₁ within the cycle of T, with the contact efforts τ of the
//! cycle before. rapier gets the mean velocities of that motion without these efforts, and returns velocities that keep
//! parts apart and bodies gripped. In the coordinates of rapier's joints (`driven`), whose inertia is M:
//!
//! ```text
//! v* = (q₁ − q) / T        handed = v* − T·M⁻¹·τ        v = v₁ + (returned − v*)        τ' = M·(returned − handed) / T
//! ```
//!
//! Nothing changes without contact: returned = v*. Momentum is exact in each cycle, and the efforts of a contact that
//! lasts are those of the motors, whose springs and loops feel them within the cycle. A blow is over at the end of its
//! cycle, and its effort must not go on: τ' is at most what keeps the velocities of the cycle before.

use crate::error::{PhysicsError, Result};
use crate::event::BodyEvent;
use crate::joint::JointVector;
use crate::machine::PhysicsMachine;
use crate::state::{JointState, MachineState};

impl PhysicsMachine {
    /// State at the end of a cycle that would end at `free` without new contacts.
    pub(super) fn with_rapier(&mut self, free: &MachineState) -> Result<MachineState> {
        if !self.world.is_stepped() {
            return Ok(*free);
        }
        let way = [&self.joints.axes.position, &free.axes.position];
        let mean = self.world.mean_velocities(way, self.cycle)?;
        let before = std::mem::replace(&mut self.contact.velocity, mean);
        let [_, lasting] = std::mem::take(&mut self.contact.by_rapier);
        if !self.world.must_step(way)? && lasting == JointVector::zeros() {
            return Ok(*free);
        }
        let coordinates = self.world.coordinates(&mut self.equation, &free.axes.position)?;
        let unsolved = PhysicsError::Contact(self.state.time_ns);
        let factors = coordinates.mass.cholesky().ok_or(unsolved)?;
        let handed = mean - factors.solve(&lasting) * self.cycle;

        let mut touches = std::mem::take(&mut self.contact.touches);
        touches.clear();
        let mut happened = Vec::new();
        let (cycle, diagonal) = (self.cycle, coordinates.mass.diagonal());
        let time = (self.state.time_ns, cycle);
        let stepped =
            self.world.step(way, (&handed, &diagonal), time, (&mut touches, &mut happened));
        for touch in &touches {
            let load = [touch.impulse / cycle, touch.depth];
            self.note_parts(touch.parts, touch.point, touch.speed, load);
        }
        self.contact.touches = touches;
        let time_ns = self.state.time_ns.saturating_add(self.cycle_ns);
        self.body_events.extend(happened.into_iter().map(|kind| BodyEvent { time_ns, kind }));
        // Efforts that have ended acted in this cycle already: rapier takes them back.
        let stepped = stepped?.filter(|(_, acts)| *acts || lasting != JointVector::zeros());
        let Some(([way, velocity], _)) = stepped else { return Ok(*free) };

        let size = |effort: &JointVector| effort.dot(&factors.solve(effort)).sqrt();
        let by_contact = coordinates.mass * (velocity - handed) / cycle;
        let keeping = coordinates.mass * (before - handed) / cycle;
        let part = size(&keeping) / size(&by_contact);
        let lasting = by_contact * if part < 1.0 { part } else { 1.0 };
        self.contact.by_rapier = [coordinates.to_joints.tr_mul(&lasting), lasting];
        self.contact.velocity = velocity;

        let axes = JointState {
            position: free.axes.position + coordinates.to_axes * (way - mean * cycle),
            velocity: free.axes.velocity + coordinates.to_axes * (velocity - mean),
        };
        Ok(self.with_axes(axes, free))
    }
}
