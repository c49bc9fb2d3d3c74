//! Joints of rapier's multibody, and how the axes move them.
//!
//! The joints of a tree are those of the machine. Of a tripod the platform alone is moved by forces: three slides along
//! x, y and z carry it, each with the inertia that the platform has in that direction. It does not tilt in rapier,
//! which is wrong by what a calibrated tripod tilts, some 10⁻⁴ rad. Its carriages and rods push loose bodies
//! and do not feel them.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use twin_kinematics::MAX_AXES;
use twin_urdf::Model;

use crate::bodies::{Body, MassProperties, Motion, Tree};
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::joint::{JointMatrix, JointVector};
use crate::linkage;

/// Singular values below this part of the largest count as 0.
const SINGULAR: f64 = 1e-9;

/// The joints that rapier moves.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    /// Links of the multibody.
    pub(super) tree: Tree,
    /// Rotor inertia per joint, kg or kg·m²; of a tripod it depends on the position.
    pub(super) armature: JointVector,
    map: Map,
}

/// Map from axes to joints.
#[derive(Clone, Debug)]
enum Map {
    /// By matrices: of the joints per axis, of the axes per joint, and the inertia of rotors between joints, which
    /// rapier does not have.
    Linear(Box<[JointMatrix; 3]>),
    /// By the place of the platform, which is this link.
    Platform(usize),
}

/// Joints and axes at one position.
#[derive(Clone, Debug)]
pub(super) struct Coordinates {
    /// Velocities of the joints per velocity of the axes, and the other way round.
    pub(super) to_joints: JointMatrix,
    pub(super) to_axes: JointMatrix,
    /// Inertia of the joints, as rapier has it; 1 on the diagonal without a joint.
    pub(super) mass: JointMatrix,
}

impl Driven {
    /// Of `model`, which moves by `equation` with rotors of `armature` (kg or kg·m²) per axis.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn new(model: &Model, equation: &Equation, armature: &JointVector) -> Result<Self> {
        let Equation::Tripod(tripod) = equation else {
            let tree = Tree::new(model, equation.axis_count())?;
            let to_joints = tree.coupling.unwrap_or_else(JointMatrix::identity);
            let inverse = to_joints.pseudo_inverse(SINGULAR);
            let to_axes = inverse.map_err(|_singular| PhysicsError::Apart)?;
            // Rotors that several joints share are felt by each as if the others were at rest.
            let rotors = to_axes.tr_mul(&(JointMatrix::from_diagonal(armature) * to_axes));
            let between = rotors - JointMatrix::from_diagonal(&rotors.diagonal());
            let map = Map::Linear(Box::new([to_joints, to_axes, between]));
            return Ok(Self { tree, armature: rotors.diagonal(), map });
        };
        let platform = linkage::platform(model).ok_or(PhysicsError::Apart)?;
        let slide = |joint: usize, axis, mass| Body {
            parent: joint.checked_sub(1),
            origin: Isometry3::identity(),
            motion: Motion::Prismatic(joint, axis),
            mass: MassProperties { mass, center: Point3::origin(), inertia: Matrix3::zeros() },
        };
        let bodies = vec![
            slide(0, Vector3::x_axis(), 0.0),
            slide(1, Vector3::y_axis(), 0.0),
            slide(2, Vector3::z_axis(), tripod.platform_mass()),
        ];
        let tree = Tree { bodies, coupling: None, followers: 0 };
        Ok(Self { tree, armature: JointVector::zeros(), map: Map::Platform(platform) })
    }

    /// The platform of a tripod, by its place among the links; `None` of a tree.
    pub(super) fn platform(&self) -> Option<usize> {
        match self.map {
            Map::Linear(_) => None,
            Map::Platform(link) => Some(link),
        }
    }

    /// Positions of the joints with the axes at `position` and the links at `poses`, m or rad.
    pub(super) fn joints(&self, position: &JointVector, poses: &[Isometry3<f64>]) -> JointVector {
        match &self.map {
            Map::Linear(matrices) => matrices[0] * position,
            Map::Platform(link) => {
                let place = poses.get(*link).map(|pose| pose.translation.vector);
                crate::joint::joint_vector(place.unwrap_or_default().iter().copied())
            }
        }
    }

    /// Joints and axes with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn coordinates(
        &self,
        equation: &mut Equation,
        position: &JointVector,
    ) -> Result<Coordinates> {
        let inertia = equation.inertia(position).ok_or(PhysicsError::Apart)?;
        let (to_joints, to_axes) = match (&self.map, equation) {
            (Map::Linear(matrices), _) => {
                let [to_joints, to_axes, _] = **matrices;
                (to_joints, to_axes)
            }
            (Map::Platform(_), Equation::Tripod(tripod)) => {
                let to_joints = tripod.shift(position)?;
                let inverse = to_joints.pseudo_inverse(SINGULAR);
                (to_joints, inverse.map_err(|_singular| PhysicsError::Apart)?)
            }
            (Map::Platform(_), Equation::Tree(_)) => return Err(PhysicsError::Apart),
        };
        let mut mass = to_axes.tr_mul(&(inertia * to_axes));
        match &self.map {
            Map::Linear(matrices) => mass -= matrices[2],
            Map::Platform(_) => mass = JointMatrix::from_diagonal(&mass.diagonal()),
        }
        for joint in 0..MAX_AXES {
            if mass[(joint, joint)] <= 0.0 {
                mass[(joint, joint)] = 1.0;
            }
        }
        Ok(Coordinates { to_joints, to_axes, mass })
    }
}
