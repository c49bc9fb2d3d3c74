//! Forward kinematics of trees, mimic joints and tripods with closed loops.

use nalgebra::Isometry3;
use twin_urdf::{JointDrive, JointPositions, Model};

use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::joint::JointVector;
use crate::passive::PassiveJoints;
use crate::tripod::TripodDynamics;

/// The joints of a machine, and how they are found.
#[derive(Clone, Debug)]
pub(super) struct Posed {
    axis_count: usize,
    /// m or rad, one per joint.
    positions: Vec<f64>,
    passive: Passive,
}

/// Method for the positions of the passive joints.
#[derive(Clone, Debug)]
enum Passive {
    /// There are none: a tree.
    None,
    Closed(Box<PassiveJoints>, Box<TripodDynamics>),
    /// By an iteration, where they are not at right angles.
    Sought(Box<JointPositions>),
}

impl Posed {
    /// Of `model`, which moves by `equation`.
    pub(super) fn of(model: &Model, equation: &Equation) -> Self {
        match equation {
            Equation::Tree(_) => Self::of_tree(equation.axis_count()),
            Equation::Tripod(tripod) => Self::of_tripod(model, tripod),
        }
    }

    fn of_tree(axis_count: usize) -> Self {
        Self { axis_count, positions: Vec::new(), passive: Passive::None }
    }

    fn of_tripod(model: &Model, tripod: &TripodDynamics) -> Self {
        let passive = match PassiveJoints::of(model) {
            Some(joints) => Passive::Closed(Box::new(joints), Box::new(tripod.clone())),
            None => Passive::Sought(Box::new(JointPositions::at_rest(model))),
        };
        let positions = vec![0.0; model.joints.len()];
        Self { axis_count: tripod.axis_count(), positions, passive }
    }

    /// Fills `poses` with the link poses of `model` in the machine frame, with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn poses(
        &mut self,
        model: &Model,
        position: &JointVector,
        poses: &mut [Isometry3<f64>],
    ) -> Result<()> {
        let axes = position.as_slice();
        let axes = axes.get(..self.axis_count).unwrap_or(axes);
        match &mut self.passive {
            Passive::None => model.link_poses_into(axes, poses),
            Passive::Closed(passive, tripod) => {
                let platform = tripod.platform(position)?;
                let joints = self.positions.iter_mut().zip(&model.joints).enumerate();
                for (index, (value, joint)) in joints {
                    if !matches!(joint.drive, JointDrive::Passive { .. }) {
                        *value = model.joint_position(index, axes);
                    }
                }
                passive.follow(axes, &platform, &mut self.positions);
                model.link_poses_at(&self.positions, poses);
            }
            Passive::Sought(joints) => {
                joints.follow(model, axes).map_err(|_open| PhysicsError::Apart)?;
                model.link_poses_at(joints.values(), poses);
            }
        }
        Ok(())
    }
}
