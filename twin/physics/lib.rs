//! Simulated machine: links with mass on driven joints, in double precision.
//!
//! ```text
//! AxisMotion (set-point) ─▶ drives ── effort ─▶ rotors, springs, joints ─▶ rapier world ─▶ AxisState, poses
//!                             ▲                    (q₁, v₁)                (bodies)    │
//!                             └──────────────── position, velocity ────────────────────┘
//! ```
//!
//! Axes are integrated in joint space, exactly; rapier has everything that touches: links, obstacles, loose bodies,
//! grippers. One cycle of T (1 ms):
//!
//! 1. In short steps (`stepping`) the drives (`drive`) run their loops when they are due. The equation of motion
//!    (`dynamics`, `tripod`, `integrate`) takes the joints, and rotors behind springs (`transmission`), from q, v to
//!    q₁, v₁. Contact efforts of the cycle before go on pushing.
//! 2. If parts would meet, or there are loose bodies (`loose`), rapier takes a step (`rapier_step`, `world`): the links
//!    of the machine are a multibody (`multibody`, `driven`) with the mean velocities of that motion, and what contacts
//!    do to it comes back to the joints. A cycle in which nothing can touch has the same bits without that step.
//! 3. Contacts of a tripod with what is fixed are solved in joint space (`contact_step`, `contact_solver`): its rods
//!    are closed loops, which rapier holds together to a fraction of a micrometre only.
//!
//! [`PhysicsMachine::link_poses`] and [`PhysicsMachine::body_poses`] say where everything is.
//! Two runs with the same inputs give the same result to the bit.
//!
//! ```
//! use nalgebra::Vector3;
//! use twin_kinematics::{AxisMotion, AxisVector};
//! use twin_physics::{AxisDriveParameters, PhysicsMachine};
//! use twin_urdf::Model;
//!
//! // A carriage of 10 kg on a vertical slide, released: it falls by g t²/2.
//! let text = r#"
//! <robot name="slide">
//!   <link name="base"/>
//!   <link name="carriage">
//!     <inertial>
//!       <mass value="10"/>
//!       <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
//!     </inertial>
//!   </link>
//!   <link name="tool_tip"/>
//!   <joint name="Z" type="prismatic">
//!     <parent link="base"/><child link="carriage"/><axis xyz="0 0 1"/>
//!     <limit lower="-1" upper="1" effort="1000" velocity="10"/>
//!   </joint>
//!   <joint name="tool_tip" type="fixed"><parent link="carriage"/><child link="tool_tip"/></joint>
//! </robot>"#;
//! let model = Model::from_urdf(text, &["Z"])?;
//! let (gravity, start) = (Vector3::new(0.0, 0.0, -9.81), AxisVector::zeros(1));
//! let drives = [AxisDriveParameters::SLACK];
//! let mut machine = PhysicsMachine::new(&model, &drives, gravity, &start, 1_000_000)?;
//! // 100 cycles of 1 ms without any effort of the motor.
//! for _ in 0..100 {
//!     machine.step_with_efforts(&AxisVector::zeros(1))?;
//! }
//! let fallen = -machine.axis_state().position[0];
//! assert!((fallen - 9.81 * 0.1 * 0.1 / 2.0).abs() < 1e-4, "49.05 mm, but {fallen} m");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![allow(
    clippy::indexing_slicing,
    reason = "numeric code: an index beyond an array is a fault that must stop, not a 0.0 for an axis"
)]

mod along_path;
mod bodies;
mod clearance;
mod contact;
mod contact_solver;
mod contact_step;
mod distances;
mod drive;
mod driven;
mod dry_friction;
mod dynamics;
mod equation;
mod error;
mod event;
mod fault;
mod friction;
mod integrate;
mod joint;
mod linear;
mod linkage;
mod load;
mod loose;
mod machine;
mod maths;
mod multibody;
mod noise;
mod pairs;
mod passive;
mod penetration;
mod posed;
mod rapier_step;
mod runge_kutta;
mod setpoint;
mod sets;
mod side;
mod solids;
mod spatial;
mod start;
mod state;
mod step;
mod stepping;
mod stop;
mod surroundings;
mod transmission;
mod tree_dynamics;
mod tripod;
mod world;

#[cfg(test)]
mod tests;

use nalgebra::Vector3;
use twin_kinematics::AxisVector;
use twin_urdf::Model;

pub use along_path::{AxisEffort, AxisLoad, EffortRow, PathDynamics, TorqueAlongPath};
pub use clearance::ClearanceScan;
pub use contact::{Collision, Contact};
pub use distances::Clearance;
pub use drive::{
    AxisDriveParameters, BrakeParameters, EffortCurve, EffortFeedForward, EncoderParameters,
    EncoderSide, Motor, OverloadParameters, ServoParameters, StepperParameters, SwitchParameters,
    SwitchStates,
};
pub use error::{PhysicsError, Result, Subject};
pub use event::{BodyEvent, BodyEventKind, EventKind, Fault, LossCause, PhysicsEvent};
pub use friction::FrictionParameters;
pub use load::{MotorLoad, MotorState};
pub use machine::{AxisState, PhysicsMachine};
pub use noise::NoiseParameters;
pub use side::Side;
pub use start::{check_bodies, distance_to_bodies};
pub use surroundings::{
    Body, Gripper, Material, Obstacle, ObstacleKind, Part, Surface, Surroundings, YieldingTool,
};
pub use transmission::ElasticTransmission;

use equation::Equation;
use joint::{JointVector, axis_vector, joint_vector};

/// Inertia of each axis of `model` at `position` (kg or kg·m²), the others at rest, without rotors.
///
/// # Errors
/// Those of [`PhysicsMachine::new`] that concern the model, and [`PhysicsError::Input`].
pub fn axis_inertia(model: &Model, position: &AxisVector) -> Result<AxisVector> {
    let axes = position.len();
    let mut equation = Equation::new(model, axes, Vector3::zeros(), JointVector::zeros())?;
    let inertia = equation.inertia(&checked(position, axes, 0)?).ok_or(PhysicsError::Apart)?;
    Ok(axis_vector(&inertia.diagonal(), axes))
}

/// Efforts (N or Nm) of `model` in `motion` under `gravity` (m/s²), without friction, with rotors of `armature` (kg
/// or kg·m²).
///
/// # Errors
/// Those of [`axis_inertia`].
pub fn motion_effort(
    model: &Model,
    gravity: Vector3<f64>,
    armature: &[f64],
    motion: &twin_kinematics::AxisMotion,
) -> Result<AxisVector> {
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

/// `values` as a joint vector; an error unless there are `axes` of them, all finite.
fn checked(values: &AxisVector, axes: usize, time_ns: i64) -> Result<JointVector> {
    if values.len() != axes {
        return Err(PhysicsError::AxisCount { given: values.len(), expected: axes });
    }
    if !values.is_finite() {
        return Err(PhysicsError::Input(time_ns));
    }
    Ok(joint_vector(values.iter().copied()))
}
