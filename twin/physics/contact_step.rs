//! Contact handling in each step: pairs that touch, lasting contact forces, and collisions.
//!
//! A lasting contact force acts through the next step of length h as an effort τ at the axes. Without it the step
//! would end at v₁ = v − h·M⁻¹·τ and q₁ = q − ½·h²·M⁻¹·τ. If no parts overlap there, the force ends. Otherwise
//! `contact_solver` is called twice:
//!
//! - for the lasting force, a new τ. It keeps the other forces of the step, v₁ − v₀ from its beginning on, from
//!   pressing parts into each other. It moves the axes by ½·h²·M⁻¹·τ.
//! - for all contact forces, impacts included, which act from the beginning of the step on.
//!
//! A body that presses against another stays in place; one that hits another comes to rest in a step or two. Nearby
//! pairs were found at the beginning of the cycle, as far as the machine may move in it.

use nalgebra::Point3;

use crate::contact::{Collision, Contact, ContactState, TouchingPair};
use crate::contact_solver::{self, FreeStep, Row};
use crate::distances::Near;
use crate::error::{PhysicsError, Result};
use crate::joint::{JointMatrix, JointVector};
use crate::machine::PhysicsMachine;
use crate::state::{JointState, MachineState};
use crate::surroundings::{Part, Surroundings, YieldingTool};
use twin_urdf::Model;

/// Axis displacement for the central differences of the gaps, m or rad: they are right to 1e-10.
const NUDGE: f64 = 1e-6;

/// Factor of the contact stiffness that is as good as rigid.
const RIGID: f64 = 1e6;

/// Parts of a step at which it is looked whether parts meet.
const PLACES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

impl PhysicsMachine {
    /// Adds collision shapes to the links of a machine at rest, and `surroundings` around it.
    ///
    /// # Errors
    /// [`PhysicsError::FlatMesh`], [`PhysicsError::Overlap`], and [`PhysicsError::Input`] unless the stiffness is above
    /// 0.
    pub fn insert_surroundings(&mut self, surroundings: &Surroundings) -> Result<()> {
        let model = self.world.model().clone();
        self.insert_bodies(&model, surroundings)
    }

    /// The same with the bodies of `model`: those of the machine with another tool on the same links and joints. Masses stay. Parts may
    /// touch; their contacts begin anew.
    ///
    /// # Errors
    /// Those of [`Self::insert_surroundings`]; nothing is changed then.
    pub fn insert_bodies(&mut self, model: &Model, surroundings: &Surroundings) -> Result<()> {
        let stiffness = surroundings.stiffness;
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(PhysicsError::Input(self.state.time_ns));
        }
        self.world.insert(model, surroundings, self.cycle)?;
        self.contact.stiffness = stiffness;
        self.contact.touching.clear();
        Ok(())
    }

    /// Sets the parts without contact force against the tool.
    pub fn set_yielding(&mut self, yielding: YieldingTool) {
        self.world.yielding = yielding;
    }

    /// Peak force of a blow of `impulse` (N·s) with `speed` (m/s) at the contact stiffness, N. It does not depend on the
    /// cycle time, as the impulse over it would.
    pub fn peak_force(&self, impulse: f64, speed: f64) -> f64 {
        (self.contact.stiffness * impulse * speed).max(0.0).sqrt()
    }

    /// Contacts after the last cycle.
    pub fn contacts(&self) -> &[Contact] {
        &self.contact.contacts
    }

    /// Takes the contacts that have begun since the last call.
    pub fn take_collisions(&mut self) -> Vec<Collision> {
        std::mem::take(&mut self.contact.collisions)
    }

    /// Finds the near points of the cycle that begins.
    pub(super) fn begin_contacts(&mut self) {
        self.world.near(&mut self.contact.near);
        std::mem::swap(&mut self.contact.contacts, &mut self.contact.before);
        self.contact.contacts.clear();
    }

    /// State after a step of `dt` s that would take the machine from `from` to `free` without new contacts.
    pub(super) fn with_contacts(
        &mut self,
        from: &MachineState,
        free: &MachineState,
        dt: f64,
    ) -> Result<MachineState> {
        if self.world.solves_contacts() {
            return Ok(*free);
        }
        if self.contact.near.is_empty() && self.contact.push == JointVector::zeros() {
            self.contact.touching.clear();
            return Ok(*free);
        }
        let near = std::mem::take(&mut self.contact.near);
        let axes = self.axes_with_contacts((&from.axes, &free.axes, dt), &near);
        self.contact.near = near;
        let axes = axes?;
        Ok(self.with_axes(axes, free))
    }

    /// `free` with the axes at `axes`; motors without springs are where their axes are.
    pub(super) fn with_axes(&self, axes: JointState, free: &MachineState) -> MachineState {
        let mut motors = axes;
        let slots = motors.position.iter_mut().zip(motors.velocity.iter_mut());
        let known = free.motors.position.iter().zip(&free.motors.velocity);
        for ((position, velocity), (known, train)) in slots.zip(known.zip(&self.trains)) {
            if train.elastic.is_some() {
                (*position, *velocity) = (*known.0, *known.1);
            }
        }
        MachineState { axes, motors }
    }

    fn axes_with_contacts(
        &mut self,
        (from, pushed, dt): (&JointState, &JointState, f64),
        near: &[Near],
    ) -> Result<JointState> {
        let push = std::mem::replace(&mut self.contact.push, JointVector::zeros());
        let (mut free, mut inertia) = (*pushed, None);
        if push != JointVector::zeros() {
            let matrix = self.equation.inertia(&pushed.position).ok_or(PhysicsError::Apart)?;
            let unsolved = PhysicsError::Contact(self.state.time_ns);
            let faster = by_push(&matrix, &push).ok_or(unsolved)? * dt;
            free.velocity -= faster;
            free.position -= faster * (0.5 * dt);
            inertia = Some(matrix);
        }
        let mut rows = std::mem::take(&mut self.contact.rows);
        rows.clear();
        let poses = self.world.poses_at(&free.position)?;
        let opening = JointVector::zeros();
        rows.extend(near.iter().map(|near| Row { opening, gap: near.gap(poses) }));
        if rows.iter().any(|row| row.gap < 0.0) {
            self.confirm([from, &free], near, &mut rows)?;
        }
        let end = if rows.iter().all(|row| row.gap >= 0.0) {
            self.contact.touching.clear();
            Ok(free)
        } else {
            let known = inertia.or_else(|| self.equation.inertia(&free.position));
            let inertia = known.ok_or(PhysicsError::Apart)?;
            self.push_apart((from, &free, dt), &inertia, near, &mut rows)
        };
        self.contact.rows = rows;
        end
    }

    /// Removes from `rows` points that only seem to touch: a contact point represents a plane, and bodies end at
    /// their edges. A pair keeps the depth that it had when the contact was found.
    fn confirm(
        &mut self,
        [from, free]: [&JointState; 2],
        near: &[Near],
        rows: &mut [Row],
    ) -> Result<()> {
        let mut touching = std::mem::take(&mut self.contact.touching);
        // What does not even seem to touch any more is let go.
        touching.retain(|held| {
            let mut points = near.iter().zip(rows.iter());
            points.any(|(near, row)| near.parts == held.parts && row.gap < 0.0)
        });
        let seeming = near.iter().zip(rows.iter()).filter(|(_, row)| row.gap < 0.0);
        let mut seeming: Vec<_> = seeming.map(|(near, _)| near.parts).collect();
        seeming.dedup();
        for parts in seeming {
            if touching.iter().any(|pair| pair.parts == parts) {
                continue;
            }
            let way = free.position - from.position;
            let mut meets = false;
            for part in PLACES {
                meets = meets || self.world.meet(parts, &(from.position + way * part))?;
            }
            if meets {
                let poses = self.world.poses_at(&from.position)?;
                let points = near.iter().filter(|near| near.parts == parts);
                let depth = points.map(|near| -near.gap(poses)).fold(0.0, f64::max);
                touching.push(TouchingPair { parts, depth });
            }
        }
        for (row, near) in rows.iter_mut().zip(near) {
            match touching.iter().find(|pair| pair.parts == near.parts) {
                Some(held) => row.gap += held.depth,
                None => row.gap = f64::INFINITY,
            }
        }
        self.contact.touching = touching;
        Ok(())
    }

    /// Axis state that replaces `free` because of nearby parts.
    fn push_apart(
        &mut self,
        (from, free, dt): (&JointState, &JointState, f64),
        inertia: &JointMatrix,
        near: &[Near],
        rows: &mut [Row],
    ) -> Result<JointState> {
        self.open(free, near, rows)?;
        let stiffness = self.contact.stiffness;
        let unsolved = PhysicsError::Contact(self.state.time_ns);
        let by_forces = free.velocity - from.velocity;
        let touching = rows.iter().filter(|row| row.gap < 0.0);
        let still = |row: &Row| Row { gap: dt * row.opening.dot(&by_forces), ..*row };
        let touching: Vec<_> = touching.map(still).collect();
        let step = FreeStep { inertia, velocity: &by_forces, dt };
        let rigid = stiffness * RIGID;
        let kept = contact_solver::solve(&step, &touching, rigid).ok_or(unsolved)?;
        let push = efforts(&touching, &kept.forces);
        let lasting = by_push(inertia, &push).ok_or(unsolved)? * (0.5 * dt * dt);
        self.contact.push = push;

        for row in rows.iter_mut() {
            row.gap -= row.opening.dot(&lasting);
        }
        let step = FreeStep { inertia, velocity: &free.velocity, dt };
        let touched = contact_solver::solve(&step, rows, stiffness).ok_or(unsolved)?;
        for (near, (row, force)) in near.iter().zip(rows.iter().zip(&touched.forces)) {
            if *force > 0.0 {
                let speed = -row.opening.dot(&from.velocity);
                self.note(near, speed, [*force, dt / self.cycle]);
            }
        }
        let position = free.position - lasting + (touched.velocity - free.velocity) * dt;
        Ok(JointState { position, velocity: touched.velocity })
    }

    /// Fills `rows` with the change of the gaps with each axis.
    fn open(&mut self, free: &JointState, near: &[Near], rows: &mut [Row]) -> Result<()> {
        for axis in 0..self.drives.len() {
            for (nudge, sign) in [(NUDGE, 0.5 / NUDGE), (-NUDGE, -0.5 / NUDGE)] {
                let mut position = free.position;
                position[axis] += nudge;
                let poses = self.world.poses_at(&position)?;
                for (row, near) in rows.iter_mut().zip(near) {
                    row.opening[axis] += near.gap(poses) * sign;
                }
            }
        }
        Ok(())
    }

    /// Notes a point of contact that pushes with `force` (N) for a `part` of the cycle, and met with `speed` (m/s).
    fn note(&mut self, near: &Near, speed: f64, [force, part]: [f64; 2]) {
        let [Some(one), Some(other)] = near.parts.map(|part| self.world.part(part)) else { return };
        let [first, second] = near.places(self.world.poses());
        let point = nalgebra::center(&first, &second);
        let depth = force / self.contact.stiffness;
        self.note_parts([one, other], point, speed, [force * part, depth]);
    }

    /// Notes a contact at `point` (machine frame, m) that pushes with `force` (N, mean over the cycle) from a `depth`
    /// (m), and met with `speed` (m/s).
    pub(super) fn note_parts(
        &mut self,
        [one, other]: [Part; 2],
        point: Point3<f64>,
        speed: f64,
        [force, depth]: [f64; 2],
    ) {
        let parts = if one <= other { [one, other] } else { [other, one] };
        let time_ns = self.state.time_ns.saturating_add(self.cycle_ns);
        let ContactState { contacts, before, collisions, .. } = &mut self.contact;
        let contact = if let Some(known) = contacts.iter_mut().find(|known| known.parts == parts) {
            known.force += force;
            known.point += (point - known.point) * (force / known.force);
            known.depth = known.depth.max(depth);
            *known
        } else {
            let contact = Contact { parts, force, point, depth };
            contacts.push(contact);
            contact
        };
        let loose = parts.iter().any(|part| matches!(part, Part::Body(_)));
        if loose || before.iter().any(|contact| contact.parts == parts) {
            return;
        }
        let begun =
            collisions.iter_mut().find(|one| one.time_ns == time_ns && one.contact.parts == parts);
        if let Some(begun) = begun {
            begun.contact = contact;
            begun.speed = begun.speed.max(speed);
        } else {
            collisions.push(Collision { time_ns, speed, contact });
        }
    }
}

/// The accelerations that `push` gives; `None` if some axis moves no inertia.
fn by_push(inertia: &JointMatrix, push: &JointVector) -> Option<JointVector> {
    Some(inertia.cholesky()?.solve(push))
}

/// Efforts of the axes from `forces` at the points of `rows`.
fn efforts(rows: &[Row], forces: &[f64]) -> JointVector {
    let of = |(row, force): (&Row, &f64)| row.opening * *force;
    rows.iter().zip(forces).map(of).fold(JointVector::zeros(), |sum, one| sum + one)
}
