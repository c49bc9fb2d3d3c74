//! Where the links of a machine are whose links go round in circles: rapier closes loops to a fraction of a micrometre only, and at ten
//! times the cost.

use nalgebra::Isometry3;
use twin_urdf::{JointDrive, JointPositions, Model};

use super::dynamics::JointVector;
use super::error::PhysicsError;
use super::passive::PassiveJoints;
use super::tripod::TripodDynamics;

/// The joints of a tripod.
#[derive(Clone, Debug)]
pub(super) struct Posed {
    tripod: Box<TripodDynamics>,
    /// m or rad, one per joint.
    positions: Vec<f64>,
    passive: Passive,
}

/// How the passive joints are found.
#[derive(Clone, Debug)]
enum Passive {
    Closed(Box<PassiveJoints>),
    /// By an iteration, where they are not at right angles.
    Sought(Box<JointPositions>),
}

impl Posed {
    pub(super) fn new(model: &Model, tripod: &TripodDynamics) -> Self {
        let passive = match PassiveJoints::of(model) {
            Some(joints) => Passive::Closed(Box::new(joints)),
            None => Passive::Sought(Box::new(JointPositions::at_rest(model))),
        };
        let positions = vec![0.0; model.joints.len()];
        Self { tripod: Box::new(tripod.clone()), positions, passive }
    }

    /// Fills `poses` with those of the links of `model` in the machine frame, the axes at `position`.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`].
    pub(super) fn poses(
        &mut self,
        model: &Model,
        position: &JointVector,
        poses: &mut [Isometry3<f64>],
    ) -> Result<(), PhysicsError> {
        let axes = position.as_slice();
        let axes = axes.get(..self.tripod.axis_count()).unwrap_or(axes);
        match &mut self.passive {
            Passive::Closed(passive) => {
                let platform = self.tripod.platform(position)?;
                for (value, joint) in self.positions.iter_mut().zip(&model.joints) {
                    if !matches!(joint.drive, JointDrive::Passive { .. }) {
                        *value = joint.drive.position(axes);
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
