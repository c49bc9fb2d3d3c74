//! The simulated machine: links with mass on driven joints, in double precision.
//!
//! ```text
//! AxisMotion (set-point) ─▶ drive ── effort ─▶ joint-space dynamics ─▶ rapier world ─▶ AxisState, link poses
//!                             ▲                  (q₁, v₁)               (bodies)    │
//!                             └─────────────── position, velocity ──────────────────┘
//! ```
//!
//! Axes are integrated in joint space, where a micrometre is no matter of solver iterations; rapier owns the bodies and
//! whatever they may touch. Both agree by construction. One cycle of length T (1 ms):
//!
//! 1. The drives (`drive`) run their loops [`CONTROL_PERIODS`] times, and the equation of motion
//!    (`dynamics`, `integrate`) takes the joints from q, v to q₁, v₁.
//! 2. If nothing is near to anything that it may touch, rapier's bodies are put where q₁ is, and rapier looks what is near there: q₁ and v₁
//!    are the new q and v. Otherwise
//! 3. rapier's multibody gets the velocity v* = (q₁ − q)/T, which takes it exactly there,
//! 4. and the bias efforts b(q, v*), so that nothing but contact can change that velocity.
//! 5. One step of rapier.
//! 6. Its joint positions are the new q, and v = v₁ + (its velocity − v*): what contact did comes back.
//!
//! Links that go round in circles, as those of a tripod, have an equation of motion of their own (`tripod`); their bodies are put
//! where they are.
//!
//! [`PhysicsMachine::link_poses`] reads the bodies.
//! Two runs with the same inputs give the same bits.

mod along_path;
mod bodies;
mod drive;
mod dynamics;
mod equation;
mod error;
mod folded;
mod integrate;
mod level;
mod linear;
mod linkage;
mod maths;
mod mechanism;
mod multibody;
mod passive;
mod posed;
mod setpoint;
mod solids;
mod spatial;
mod tripod;
mod world;

#[cfg(test)]
mod tests;

use nalgebra::{Isometry3, Vector3};
use twin_kinematics::{AxisMotion, AxisVector, MAX_AXES};
use twin_urdf::Model;

pub use along_path::{AxisEffort, AxisLoad, EffortRow, PathDynamics, TorqueAlongPath};
pub use drive::{AxisDriveParameters, EffortFeedForward};
pub use error::PhysicsError;

use drive::{AxisDrive, DriveInput};
use dynamics::{JointVector, at};
use equation::Equation;
use integrate::{Friction, JointState};
use setpoint::Setpoint;
use world::RapierWorld;

/// Passes of the drive loops, and steps of the equation of motion, in one cycle: 4 kHz at a cycle of 1 ms.
pub const CONTROL_PERIODS: u8 = 4;

/// What the axes of the machine do at the end of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisState {
    /// Since the machine was made, ns.
    pub time_ns: i64,
    /// m or rad.
    pub position: AxisVector,
    /// m/s or rad/s.
    pub velocity: AxisVector,
    /// Motor force or torque, mean over the cycle, N or Nm.
    pub effort: AxisVector,
    /// True where the drive was at its effort limit at some time in the cycle; in axis order.
    pub saturated: [bool; MAX_AXES],
}

/// A machine with its drives.
#[derive(Debug)]
pub struct PhysicsMachine {
    equation: Equation,
    friction: Friction,
    world: RapierWorld,
    drives: Vec<AxisDrive>,
    joints: JointState,
    /// At the end of the last cycle.
    setpoint: AxisMotion,
    state: AxisState,
    cycle_ns: i64,
    /// s.
    cycle: f64,
}

impl PhysicsMachine {
    /// The machine `model` at rest at `initial` (m or rad, machine-file order) with its drives enabled, one of
    /// `drives` per machine axis, under `gravity` (m/s², machine frame), stepping `cycle_ns` at a time.
    ///
    /// The drives start with the effort that holds the machine against gravity, so that nothing sags.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model is no tree of links whose moving joints are the machine's axes, if an axis
    /// moves no inertia, or if a number is out of range.
    pub fn new(
        model: &Model,
        drives: &[AxisDriveParameters],
        gravity: Vector3<f64>,
        initial: &AxisVector,
        cycle_ns: i64,
    ) -> Result<Self, PhysicsError> {
        let cycle_time = PhysicsError::CycleTime { cycle_ns };
        let cycle = u32::try_from(cycle_ns)
            .ok()
            .filter(|ns| (1_000..=1_000_000_000).contains(ns))
            .map(|ns| f64::from(ns) * 1e-9)
            .ok_or(cycle_time)?;
        for (axis, drive) in drives.iter().enumerate() {
            if let Some((parameter, value)) = drive.out_of_range() {
                return Err(PhysicsError::DriveParameter { axis, parameter, value });
            }
        }
        let per_axis =
            |value: fn(&AxisDriveParameters) -> f64| joint_vector(drives.iter().map(value));
        let armature = per_axis(|drive| drive.armature);
        let mut equation = Equation::new(model, drives.len(), gravity, armature)?;
        let setpoint = AxisMotion::at_rest(*initial);
        let joints = JointState {
            position: checked(initial, drives.len(), 0)?,
            velocity: JointVector::zeros(),
        };

        let inertia = equation.inertia(&joints.position).ok_or(PhysicsError::Apart)?.diagonal();
        if let Some((axis, inertia)) =
            inertia.iter().copied().take(drives.len()).enumerate().find(|(_, i)| *i <= 0.0)
        {
            return Err(PhysicsError::NoInertia { axis, inertia });
        }
        let zero = JointVector::zeros();
        let holding = equation.inverse_dynamics(&joints.position, &zero, &zero);
        let holding = holding.ok_or(PhysicsError::Apart)?;
        let enabled = drives.iter().zip(holding.iter()).map(|(parameters, holding)| {
            let fed_forward = match parameters.effort_feed_forward {
                EffortFeedForward::Dynamics(part) => part * holding,
                EffortFeedForward::None | EffortFeedForward::Inertia(_) => 0.0,
            };
            AxisDrive::enabled(*parameters, holding - fed_forward)
        });
        let state = AxisState {
            time_ns: 0,
            position: *initial,
            velocity: setpoint.velocity,
            effort: axis_vector(&holding, drives.len()),
            saturated: [false; MAX_AXES],
        };
        let at_rest = &joints.position;
        let world = RapierWorld::new(model, &equation, gravity, &armature, at_rest, (cycle, 1))?;
        Ok(Self {
            friction: Friction {
                coulomb: per_axis(|drive| drive.coulomb_friction),
                viscous: per_axis(|drive| drive.viscous_friction),
            },
            world,
            drives: enabled.collect(),
            equation,
            joints,
            setpoint,
            state,
            cycle_ns,
            cycle,
        })
    }

    /// Advances one cycle, at the end of which the axes should be at `setpoint`, and returns what they did.
    ///
    /// The drives interpolate from the set-point before to this one (cubic in position, linear in acceleration), as
    /// drives do that are given a set-point per bus cycle, so the position to compare `setpoint` with is the one
    /// returned.
    ///
    /// # Errors
    /// [`PhysicsError::AxisCount`], [`PhysicsError::Input`] if `setpoint` is not finite, and
    /// [`PhysicsError::Diverged`].
    pub fn step(&mut self, setpoint: &AxisMotion) -> Result<AxisState, PhysicsError> {
        let [from, to] = [&self.setpoint, setpoint]
            .map(|motion| Setpoint::new(motion, self.drives.len(), self.state.time_ns));
        let (from, to) = (from?, to?);
        let period = self.cycle / f64::from(CONTROL_PERIODS);
        let mut joints = self.joints;
        let mut mean_effort = JointVector::zeros();
        let mut saturated = [false; MAX_AXES];
        for pass in 0..CONTROL_PERIODS {
            let phase = f64::from(pass) / f64::from(CONTROL_PERIODS);
            let now = from.towards(&to, phase, self.cycle);
            // What is fed forward is held for the period: take it from its middle.
            let ahead = from.towards(&to, phase + 0.5 / f64::from(CONTROL_PERIODS), self.cycle);
            let effort = self.control(&joints, &now, &ahead, period, &mut saturated)?;
            joints = self.integrate(&joints, &effort, period)?;
            mean_effort += effort / f64::from(CONTROL_PERIODS);
        }
        self.setpoint = *setpoint;
        self.finish_cycle(&joints, &mean_effort, saturated)
    }

    /// Advances one cycle with the given motor efforts (N or Nm), the drives switched off; limits are not applied.
    ///
    /// # Errors
    /// Those of [`Self::step`].
    pub fn step_with_efforts(&mut self, effort: &AxisVector) -> Result<AxisState, PhysicsError> {
        let effort = checked(effort, self.drives.len(), self.state.time_ns)?;
        let mut joints = self.joints;
        for _ in 0..CONTROL_PERIODS {
            joints = self.integrate(&joints, &effort, self.cycle / f64::from(CONTROL_PERIODS))?;
        }
        self.finish_cycle(&joints, &effort, [false; MAX_AXES])
    }

    /// Gives the links of a machine at rest their solids as what they touch with, beside the ground, a slab whose top is at z =
    /// `ground` (m, machine frame).
    pub fn insert_solids(&mut self, ground: f64) {
        self.world.insert_solids(ground);
    }

    /// The axes at the end of the last cycle.
    pub fn axis_state(&self) -> &AxisState {
        &self.state
    }

    /// The set-point at the end of the last cycle.
    pub fn setpoint(&self) -> &AxisMotion {
        &self.setpoint
    }

    /// Poses of the links in the machine frame, in the order of [`Model::links`], as rapier's bodies have them.
    pub fn link_poses(&self) -> Vec<Isometry3<f64>> {
        self.world.link_poses()
    }

    /// One pass of all drives: the efforts for the next `period` (s), with the set-point `now` and what is fed
    /// forward from `ahead`.
    fn control(
        &mut self,
        joints: &JointState,
        now: &Setpoint,
        ahead: &Setpoint,
        period: f64,
        saturated: &mut [bool; MAX_AXES],
    ) -> Result<JointVector, PhysicsError> {
        let dynamic = |drive: &AxisDrive| {
            matches!(drive.parameters.effort_feed_forward, EffortFeedForward::Dynamics(_))
        };
        let whole_machine = if self.drives.iter().any(dynamic) {
            let Setpoint { position, velocity, acceleration } = ahead;
            let efforts = self.equation.inverse_dynamics(position, velocity, acceleration);
            efforts.ok_or(PhysicsError::Apart)?
        } else {
            JointVector::zeros()
        };
        let efforts =
            self.drives.iter_mut().zip(saturated).enumerate().map(|(axis, (drive, saturated))| {
                let input = DriveInput {
                    position_setpoint: at(&now.position, axis),
                    velocity_setpoint: at(&now.velocity, axis),
                    effort: match drive.parameters.effort_feed_forward {
                        EffortFeedForward::None => 0.0,
                        EffortFeedForward::Inertia(inertia) => {
                            inertia * at(&ahead.acceleration, axis)
                        }
                        EffortFeedForward::Dynamics(part) => part * at(&whole_machine, axis),
                    },
                    position: at(&joints.position, axis),
                    velocity: at(&joints.velocity, axis),
                };
                let output = drive.control(&input, period);
                *saturated |= output.saturated;
                output.effort
            });
        Ok(joint_vector(efforts))
    }

    fn integrate(
        &mut self,
        joints: &JointState,
        effort: &JointVector,
        dt: f64,
    ) -> Result<JointState, PhysicsError> {
        integrate::advance(&mut self.equation, joints, effort, &self.friction, dt)
            .filter(JointState::is_finite)
            .ok_or(PhysicsError::Diverged { time_ns: self.state.time_ns })
    }

    /// Steps 2 to 6 of the module's docs: takes rapier's bodies to `next`.
    fn finish_cycle(
        &mut self,
        next: &JointState,
        effort: &JointVector,
        saturated: [bool; MAX_AXES],
    ) -> Result<AxisState, PhysicsError> {
        let mean_velocity = (next.position - self.joints.position) / self.cycle;
        let zero = JointVector::zeros();
        let bias = self.equation.inverse_dynamics(&self.joints.position, &mean_velocity, &zero);
        let (position, faster) = self.world.advance(
            &next.position,
            &mean_velocity,
            &bias.ok_or(PhysicsError::Apart)?,
        )?;
        self.joints = JointState { position, velocity: next.velocity + faster };
        if !self.joints.is_finite() {
            return Err(PhysicsError::Diverged { time_ns: self.state.time_ns });
        }
        let axes = self.drives.len();
        self.state = AxisState {
            time_ns: self.state.time_ns.saturating_add(self.cycle_ns),
            position: axis_vector(&self.joints.position, axes),
            velocity: axis_vector(&self.joints.velocity, axes),
            effort: axis_vector(effort, axes),
            saturated,
        };
        Ok(self.state)
    }
}

/// The inertia that each axis of `model` feels at `position` while the others stand still (kg or kg·m²), without
/// rotors: what [`AxisDriveParameters::tuned`] wants.
///
/// # Errors
/// Those of [`PhysicsMachine::new`] that concern the model, and [`PhysicsError::Input`].
pub fn axis_inertia(model: &Model, position: &AxisVector) -> Result<AxisVector, PhysicsError> {
    let axes = position.len();
    let mut equation = Equation::new(model, axes, Vector3::zeros(), JointVector::zeros())?;
    let inertia = equation.inertia(&checked(position, axes, 0)?).ok_or(PhysicsError::Apart)?;
    Ok(axis_vector(&inertia.diagonal(), axes))
}

/// The efforts (N or Nm) that hold `model` at `position` against `gravity` (m/s²).
///
/// # Errors
/// Those of [`axis_inertia`].
#[cfg(test)]
pub fn holding_effort(
    model: &Model,
    gravity: Vector3<f64>,
    position: &AxisVector,
) -> Result<AxisVector, PhysicsError> {
    let axes = position.len();
    let mut dynamics = dynamics::Dynamics::new(model, axes, gravity, JointVector::zeros())?;
    let zero = JointVector::zeros();
    Ok(axis_vector(&dynamics.inverse_dynamics(&checked(position, axes, 0)?, &zero, &zero), axes))
}

/// The efforts (N or Nm) that `model` takes in `motion` against `gravity` (m/s²), without friction, with rotors of these
/// inertias behind the gears (kg or kg·m²).
///
/// # Errors
/// Those of [`axis_inertia`].
#[cfg(test)]
pub fn motion_effort(
    model: &Model,
    gravity: Vector3<f64>,
    armature: &[f64],
    motion: &AxisMotion,
) -> Result<AxisVector, PhysicsError> {
    let axes = armature.len();
    let armature = joint_vector(armature.iter().copied());
    let mut dynamics = dynamics::Dynamics::new(model, axes, gravity, armature)?;
    let of = |values: &AxisVector| checked(values, axes, 0);
    let effort = dynamics.inverse_dynamics(
        &of(&motion.position)?,
        &of(&motion.velocity)?,
        &of(&motion.acceleration)?,
    );
    Ok(axis_vector(&effort, axes))
}

fn joint_vector(values: impl Iterator<Item = f64>) -> JointVector {
    let mut result = JointVector::zeros();
    for (slot, value) in result.iter_mut().zip(values) {
        *slot = value;
    }
    result
}

fn axis_vector(values: &JointVector, axes: usize) -> AxisVector {
    AxisVector::from_values(values.iter().copied().take(axes))
}

/// `values` as a joint vector, if there are `axes` of them and all are finite.
fn checked(values: &AxisVector, axes: usize, time_ns: i64) -> Result<JointVector, PhysicsError> {
    if values.len() != axes {
        return Err(PhysicsError::AxisCount { given: values.len(), expected: axes });
    }
    if !values.is_finite() {
        return Err(PhysicsError::Input { time_ns });
    }
    Ok(joint_vector(values.iter().copied()))
}
