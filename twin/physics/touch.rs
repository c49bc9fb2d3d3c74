//! What touches what in the machine, step by step.
//!
//! What lasts of a contact pushes on through the next step of length h, as an effort τ at the axes: drives, springs and dry friction
//! feel it. Without it the step would end at v₁ = v − h·M⁻¹·τ and q₁ = q − ½·h²·M⁻¹·τ, and if nothing is in each other there,
//! nothing pushes any more. Otherwise `contact` is asked twice:
//!
//! - for what lasts, a new τ: what keeps the forces of the step, v₁ − v₀ from its beginning on, from pressing anything into
//!   anything. It has moved the axes by ½·h²·M⁻¹·τ.
//! - for all of it, blows included, which act from the beginning of the step on.
//!
//! So what presses against something in balance stays where it is, and what hits something comes to rest in a step or two.
//! rapier has looked what is near at the beginning of the cycle, as far as the machine may come in it.

use nalgebra::Point3;

use super::contact::{self, FreeStep, Row};
use super::dynamics::{JointMatrix, JointVector};
use super::error::PhysicsError;
use super::integrate::{JointState, MachineState};
use super::machine::PhysicsMachine;
use super::surroundings::{Part, Surroundings};
use super::world::Near;

/// How far axes are moved to see how gaps open, m or rad: central differences of this are right to 1e-10.
const NUDGE: f64 = 1e-6;

/// How much stiffer than points of contact what keeps a lasting force from doing anything is: as good as rigid.
const RIGID: f64 = 1e6;

/// Two parts that push each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Which.
    pub parts: [Part; 2],
    /// All points of contact together, mean over the last cycle, N.
    pub force: f64,
    /// The middle of the force, m, machine frame.
    pub point: Point3<f64>,
    /// How deep they are in each other, m.
    pub depth: f64,
}

/// The beginning of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// End of the cycle in which they touched, ns since the machine was made.
    pub time_ns: i64,
    /// How fast they came towards each other, m/s.
    pub speed: f64,
    /// What happened in that cycle.
    pub contact: Contact,
}

/// What goes on between the parts of a machine and what is around it.
#[derive(Clone, Debug)]
pub(super) struct Touch {
    stiffness: f64,
    /// What lasts of it, at the axes, N or Nm.
    pub(super) push: JointVector,
    contacts: Vec<Contact>,
    /// Those of the cycle before.
    before: Vec<Contact>,
    collisions: Vec<Collision>,
    /// Workspaces.
    near: Vec<Near>,
    rows: Vec<Row>,
}

impl Default for Touch {
    fn default() -> Self {
        Self {
            stiffness: Surroundings::STIFFNESS,
            push: JointVector::zeros(),
            contacts: Vec::new(),
            before: Vec::new(),
            collisions: Vec::new(),
            near: Vec::new(),
            rows: Vec::new(),
        }
    }
}

impl PhysicsMachine {
    /// Gives the links of a machine at rest their solids as what they touch with, and puts `surroundings` around it.
    ///
    /// # Errors
    /// [`PhysicsError::FlatMesh`], [`PhysicsError::Overlap`], and [`PhysicsError::Input`] if the stiffness is no number above 0.
    pub fn insert_surroundings(&mut self, surroundings: &Surroundings) -> Result<(), PhysicsError> {
        let stiffness = surroundings.stiffness;
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(PhysicsError::Input { time_ns: self.state.time_ns });
        }
        self.touch.stiffness = stiffness;
        self.world.insert(surroundings)
    }

    /// Lets the tool give way to what it touches, as a touch probe does, or makes it stiff again.
    pub fn set_probing(&mut self, probing: bool) {
        self.world.probing = probing;
    }

    /// What touches what, after the last cycle.
    pub fn contacts(&self) -> &[Contact] {
        &self.touch.contacts
    }

    /// Takes the contacts that have begun since it was asked last.
    pub fn take_collisions(&mut self) -> Vec<Collision> {
        std::mem::take(&mut self.touch.collisions)
    }

    /// Looks what may be touched in the cycle that begins.
    pub(super) fn begin_touching(&mut self) {
        self.world.near(&mut self.touch.near);
        std::mem::swap(&mut self.touch.contacts, &mut self.touch.before);
        self.touch.contacts.clear();
    }

    /// Where the machine is after a step of `dt` s that would take it from `from` to `free` if nothing touched anything else than
    /// before.
    pub(super) fn touched(
        &mut self,
        from: &MachineState,
        free: &MachineState,
        dt: f64,
    ) -> Result<MachineState, PhysicsError> {
        if self.touch.near.is_empty() && self.touch.push == JointVector::zeros() {
            return Ok(*free);
        }
        let near = std::mem::take(&mut self.touch.near);
        let axes = self.touched_by((&from.axes, &free.axes, dt), &near);
        self.touch.near = near;
        let axes = axes?;
        let mut motors = axes;
        let slots = motors.position.iter_mut().zip(motors.velocity.iter_mut());
        let known = free.motors.position.iter().zip(&free.motors.velocity);
        for ((position, velocity), (known, train)) in slots.zip(known.zip(&self.trains)) {
            if train.elastic.is_some() {
                (*position, *velocity) = (*known.0, *known.1);
            }
        }
        Ok(MachineState { axes, motors })
    }

    fn touched_by(
        &mut self,
        (from, pushed, dt): (&JointState, &JointState, f64),
        near: &[Near],
    ) -> Result<JointState, PhysicsError> {
        let push = std::mem::replace(&mut self.touch.push, JointVector::zeros());
        let (mut free, mut inertia) = (*pushed, None);
        if push != JointVector::zeros() {
            let matrix = self.equation.inertia(&pushed.position).ok_or(PhysicsError::Apart)?;
            let faster = by_push(&matrix, &push)? * dt;
            free.velocity -= faster;
            free.position -= faster * (0.5 * dt);
            inertia = Some(matrix);
        }
        let poses = self.world.poses_at(&free.position)?;
        let mut rows = std::mem::take(&mut self.touch.rows);
        rows.clear();
        let opening = JointVector::zeros();
        rows.extend(near.iter().map(|near| Row { opening, gap: near.gap(poses) }));
        let end = if rows.iter().all(|row| row.gap >= 0.0) {
            Ok(free)
        } else {
            let known = inertia.or_else(|| self.equation.inertia(&free.position));
            let inertia = known.ok_or(PhysicsError::Apart)?;
            self.push_apart((from, &free, dt), &inertia, near, &mut rows)
        };
        self.touch.rows = rows;
        end
    }

    /// Where the axes are instead of `free`, because of what is near.
    fn push_apart(
        &mut self,
        (from, free, dt): (&JointState, &JointState, f64),
        inertia: &JointMatrix,
        near: &[Near],
        rows: &mut [Row],
    ) -> Result<JointState, PhysicsError> {
        self.open(free, near, rows)?;
        let stiffness = self.touch.stiffness;
        let by_forces = free.velocity - from.velocity;
        let touching = rows.iter().filter(|row| row.gap < 0.0);
        let still = |row: &Row| Row { gap: dt * row.opening.dot(&by_forces), ..*row };
        let touching: Vec<_> = touching.map(still).collect();
        let step = FreeStep { inertia, velocity: &by_forces, dt };
        let rigid = stiffness * RIGID;
        let kept = contact::solve(&step, &touching, rigid).ok_or(PhysicsError::Apart)?;
        let push = efforts(&touching, &kept.forces);
        let lasting = by_push(inertia, &push)? * (0.5 * dt * dt);
        self.touch.push = push;

        for row in rows.iter_mut() {
            row.gap -= row.opening.dot(&lasting);
        }
        let step = FreeStep { inertia, velocity: &free.velocity, dt };
        let touched = contact::solve(&step, rows, stiffness).ok_or(PhysicsError::Apart)?;
        for (near, (row, force)) in near.iter().zip(rows.iter().zip(&touched.forces)) {
            if *force > 0.0 {
                let speed = -row.opening.dot(&from.velocity);
                self.note(near, speed, [*force, dt / self.cycle]);
            }
        }
        let position = free.position - lasting + (touched.velocity - free.velocity) * dt;
        Ok(JointState { position, velocity: touched.velocity })
    }

    /// How the gaps of `rows` open with each axis.
    fn open(
        &mut self,
        free: &JointState,
        near: &[Near],
        rows: &mut [Row],
    ) -> Result<(), PhysicsError> {
        for axis in 0..self.drives.len() {
            for (nudge, sign) in [(NUDGE, 0.5 / NUDGE), (-NUDGE, -0.5 / NUDGE)] {
                let mut position = free.position;
                if let Some(value) = position.get_mut(axis) {
                    *value += nudge;
                }
                let poses = self.world.poses_at(&position)?;
                for (row, near) in rows.iter_mut().zip(near) {
                    if let Some(opening) = row.opening.get_mut(axis) {
                        *opening += near.gap(poses) * sign;
                    }
                }
            }
        }
        Ok(())
    }

    /// Notes a point of contact that pushes with `force` (N) for a `part` of the cycle, and met with `speed` (m/s).
    fn note(&mut self, near: &Near, speed: f64, [force, part]: [f64; 2]) {
        let [Some(one), Some(other)] = near.parts.map(|part| self.world.part(part)) else { return };
        let parts = if one <= other { [one, other] } else { [other, one] };
        let [first, second] = near.places(self.world.poses());
        let point = nalgebra::center(&first, &second);
        let depth = force / self.touch.stiffness;
        let force = force * part;
        let time_ns = self.state.time_ns.saturating_add(self.cycle_ns);
        let Touch { contacts, before, collisions, .. } = &mut self.touch;
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
        if before.iter().any(|contact| contact.parts == parts) {
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

/// The accelerations that `push` gives.
fn by_push(inertia: &JointMatrix, push: &JointVector) -> Result<JointVector, PhysicsError> {
    Ok(inertia.cholesky().ok_or(PhysicsError::Apart)?.solve(push))
}

/// What `forces` at the points of `rows` are at the axes.
fn efforts(rows: &[Row], forces: &[f64]) -> JointVector {
    let of = |(row, force): (&Row, &f64)| row.opening * *force;
    rows.iter().zip(forces).map(of).fold(JointVector::zeros(), |sum, one| sum + one)
}
