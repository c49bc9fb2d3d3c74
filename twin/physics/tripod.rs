//! Tripod (delta) dynamics: equation of motion of three carriages, six rods and a platform.
//!
//! ```text
//! effort = rotors + carriages + what the rods pull at their upper ends + Jᵀ·(platform and what the rods pull at it)
//! ```
//!
//! **Rods.** A rod hangs in ball joints, is rotationally symmetric and does not spin about its own axis, as nothing
//! ever turns it that way. Its kinetic energy is then ½·(m₁₁·u̇² + 2·m₁₂·u̇·l̇ + m₂₂·l̇²) of the velocities u̇, l̇ of
//! its ends, with constant
//!
//! ```text
//! m₂₂ = m·c² + I/L²      m₁₂ = m·c·(1 − c) − I/L²      m₁₁ = m·(1 − c)² + I/L²
//! ```
//!
//! Here m is its mass, c the position of its centre of mass along it (as a part of the length L), and I its inertia
//! across it about that centre. The rod is therefore, exactly, a force m₁₁·ü + m₁₂·l̈ − (1 − c)·m·g at its upper end
//! and m₁₂·ü + m₂₂·l̈ − c·m·g at its lower end.
//!
//! **Closed loops.** With s a rod from its upper to its lower end, r its lower end from the reference point of the platform
//! and ω the angular velocity of the platform, no rod changes its length:
//!
//! ```text
//! s·(ṗ + ω×r) = sz·q̇      s·(p̈ + α×r) = sz·q̈ − ṡ·ṡ − s·(ω×(ω×r))
//! ```
//!
//! Six equations with one matrix A for the motion (ω, ṗ) of the platform: J = A⁻¹·D, where D has the sz of every
//! rod in the column of its carriage. The wrench on the platform acts on the carriages as Jᵀ times it. Rods are
//! separate, so tilting platforms need no special case.
//!
//! Compared with an independent derivation, and with a model of 24 degrees of freedom with its loops closed.

use nalgebra::{Isometry3, Matrix3, Matrix6, SMatrix, Vector3, Vector6};
use twin_kinematics::tripod::{CalibratedTripod, Rod, Tripod};
use twin_kinematics::{MAX_AXES, Transform};
use twin_urdf::Model;

use crate::bodies::MassProperties;
use crate::dynamics::{Dynamics, check_axis_count};
use crate::error::{PhysicsError, Result};
use crate::joint::{JointMatrix, JointVector};
use crate::linear::{solve, solve_and_invert};
use crate::linkage::{Carriage, Linkage, RodBody, level_tripod};

/// The equation of motion of one tripod, including additional axes.
#[derive(Clone, Debug)]
pub(super) struct TripodDynamics {
    axis_count: usize,
    gravity: Vector3<f64>,
    armature: JointVector,
    carriages: [Carriage; 3],
    rods: [RodBody; 6],
    platform: MassProperties,
    kinematics: CalibratedTripod,
    /// Closed form for parallel rod pairs and towers a third of a turn apart: the platform stays level.
    level: Option<Tripod>,
    /// Axes that have nothing to do with the tool.
    others: Option<Dynamics>,
}

/// A tripod at one place, and what follows from that alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct TripodState {
    /// Every rod: from its upper to its lower end, and its lower end from the reference point of the platform.
    rods: [[Vector3<f64>; 2]; 6],
    /// A⁻¹: columns are rods, rows the turn and the shift of the platform.
    inverse: Matrix6<f64>,
    /// J.
    jacobian: SMatrix<f64, 6, 3>,
    /// Centre of mass of the platform from its reference point, and inertia about it, machine frame.
    center: Vector3<f64>,
    inertia: Matrix3<f64>,
}

/// Turn and shift of the platform: a velocity or an acceleration.
#[derive(Clone, Copy, Debug)]
struct Twist {
    turn: Vector3<f64>,
    shift: Vector3<f64>,
}

impl From<Vector6<f64>> for Twist {
    fn from(values: Vector6<f64>) -> Self {
        Self {
            turn: values.fixed_rows::<3>(0).into_owned(),
            shift: values.fixed_rows::<3>(3).into_owned(),
        }
    }
}

impl TripodDynamics {
    /// Equation of motion of the tripod `model` with the axes `0..axis_count` under `gravity` (m/s², machine
    /// frame), with rotors of `armature` (kg).
    /// Errors: those of [`Linkage::of`].
    pub(super) fn new(
        model: &Model,
        axis_count: usize,
        gravity: Vector3<f64>,
        armature: JointVector,
    ) -> Result<Self> {
        check_axis_count(axis_count)?;
        let Linkage { carriages, rods, platform, others } = Linkage::of(model, axis_count)?;
        let unknown = PhysicsError::UnknownMechanism(model.loops.len());
        let of_rod = |rod: &RodBody| Rod {
            carriage: rod.carriage,
            upper: rod.upper,
            lower: rod.lower,
            length: rod.length,
        };
        let kinematics = CalibratedTripod::new(rods.each_ref().map(of_rod), [0.0; 3])
            .map_err(|_no_such_tripod| unknown)?;
        let rotorless = JointVector::zeros();
        let level = level_tripod(&rods);
        let others = others.map(|tree| Dynamics::of_tree(tree, axis_count, gravity, rotorless));
        Ok(Self {
            axis_count,
            gravity,
            armature,
            carriages,
            rods,
            platform,
            kinematics,
            level,
            others,
        })
    }

    /// Pose of the platform in the machine frame with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`] where the rods do not meet.
    pub(super) fn platform(&self, position: &JointVector) -> Result<Isometry3<f64>> {
        let heights = self.of_carriages(position);
        let platform = match &self.level {
            Some(level) => level.to_tool(&heights).map(Isometry3::from),
            None => self.kinematics.platform(&heights),
        };
        platform.map_err(|_apart| PhysicsError::Apart)
    }

    /// Mass of the platform and what is fixed to it, kg.
    pub(super) fn platform_mass(&self) -> f64 {
        self.platform.mass
    }

    /// Velocity of the platform (rows x, y, z) per velocity of each axis, with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`].
    pub(super) fn shift(&self, position: &JointVector) -> Result<JointMatrix> {
        let jacobian = self.state(position)?.jacobian;
        let mut shift = JointMatrix::zeros();
        for (number, carriage) in self.carriages.iter().enumerate() {
            let column = jacobian.fixed_view::<3, 1>(3, number);
            shift.fixed_view_mut::<3, 1>(0, carriage.axis).copy_from(&column);
        }
        Ok(shift)
    }

    /// State of all parts with the axes at `position`.
    /// Errors: [`PhysicsError::Apart`] where the rods do not meet, or do not hold the platform.
    pub(super) fn state(&self, position: &JointVector) -> Result<TripodState> {
        let (heights, platform) = (self.of_carriages(position), self.platform(position)?);
        let rotation = platform.rotation.to_rotation_matrix();
        let (mut matrix, mut pulls) = (Matrix6::zeros(), SMatrix::<f64, 6, 3>::zeros());
        let rods = self.rods.map(|rod| {
            let r = rotation * rod.lower.coords;
            let mut upper = rod.upper.coords;
            upper.z += heights[rod.carriage];
            [platform.translation.vector + r - upper, r]
        });
        let rows = matrix.row_iter_mut().zip(pulls.row_iter_mut());
        for ((mut row, mut pull), ([s, r], rod)) in rows.zip(rods.iter().zip(&self.rods)) {
            row.copy_from(&six(&r.cross(s), s).transpose());
            pull[rod.carriage] = s.z;
        }
        let inverse = matrix.try_inverse().ok_or(PhysicsError::Apart)?;
        let jacobian = inverse * pulls;
        if !jacobian.iter().all(|value| value.is_finite()) {
            return Err(PhysicsError::Apart);
        }
        let center = rotation * self.platform.center.coords;
        let inertia = rotation * self.platform.inertia * rotation.inverse();
        Ok(TripodState { rods, inverse, jacobian, center, inertia })
    }

    /// The efforts that give the axes `acceleration` while they move with `velocity`, with or without their weight.
    pub(super) fn efforts(
        &self,
        state: &TripodState,
        velocity: &JointVector,
        acceleration: &JointVector,
        weighs: bool,
    ) -> JointVector {
        let gravity = if weighs { self.gravity } else { Vector3::zeros() };
        let [rates, changes] = [velocity, acceleration].map(|values| self.of_carriages(values));
        let Twist { turn: omega, shift } = Twist::from(state.jacobian * rates);
        let mut bends = Vector6::zeros();
        for ((bend, [s, r]), rod) in bends.iter_mut().zip(&state.rods).zip(&self.rods) {
            let swing = omega.cross(r);
            let closing = shift + swing - up(&rates, rod.carriage);
            *bend = -closing.norm_squared() - s.dot(&omega.cross(&swing));
        }
        let change = Twist::from(state.jacobian * changes + state.inverse * bends);
        let Twist { turn: alpha, shift: acceleration_of_platform } = change;
        let accelerated = |from: &Vector3<f64>| {
            acceleration_of_platform + alpha.cross(from) + omega.cross(&omega.cross(from))
        };

        let MassProperties { mass, .. } = self.platform;
        let mut force = (accelerated(&state.center) - gravity) * mass;
        let mut torque = state.inertia * alpha
            + omega.cross(&(state.inertia * omega))
            + state.center.cross(&force);
        let mut pulls = Vector3::zeros();
        for ((pull, carriage), change) in pulls.iter_mut().zip(&self.carriages).zip(&changes) {
            *pull = carriage.mass * (change - gravity.z);
        }
        for (rod, [_, r]) in self.rods.iter().zip(&state.rods) {
            let (upper, lower) = (up(&changes, rod.carriage), accelerated(r));
            let [m11, m12, m22] = rod.masses;
            let [weight_above, weight_below] = rod.shares;
            let below = upper * m12 + lower * m22 - gravity * weight_below;
            force += below;
            torque += r.cross(&below);
            pulls[rod.carriage] += m11 * upper.z + m12 * lower.z - gravity.z * weight_above;
        }
        pulls += state.jacobian.tr_mul(&six(&torque, &force));
        let mut efforts = self.armature.component_mul(acceleration);
        for (carriage, pull) in self.carriages.iter().zip(&pulls) {
            efforts[carriage.axis] += pull;
        }
        efforts
    }

    /// The efforts that additional axes add to [`Self::efforts`]; they do not depend on the tripod.
    pub(super) fn additional_efforts(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) -> JointVector {
        let others = self.others.as_mut();
        others.map_or_else(JointVector::zeros, |others| {
            others.inverse_dynamics(position, velocity, acceleration)
        })
    }

    pub(super) fn axis_count(&self) -> usize {
        self.axis_count
    }

    /// The efforts that give the axes `acceleration`; `None` where the rods do not meet.
    pub(super) fn inverse_dynamics(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) -> Option<JointVector> {
        let state = self.state(position).ok()?;
        let additional = self.additional_efforts(position, velocity, acceleration);
        Some(self.efforts(&state, velocity, acceleration, true) + additional)
    }

    /// Accelerations under `effort`; `None` where the rods do not meet, or if an axis moves no inertia.
    pub(super) fn acceleration(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<JointVector> {
        let (inertia, bias) = self.inertia_and_bias(position, velocity)?;
        solve(self.axis_count, &inertia, &(effort - bias))
    }

    /// As [`Self::acceleration`], and the inverse of the inertia, with 1 on its diagonal where the machine has no axis.
    pub(super) fn acceleration_and_mobility(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<(JointVector, JointMatrix)> {
        let (inertia, bias) = self.inertia_and_bias(position, velocity)?;
        solve_and_invert(self.axis_count, &inertia, &(effort - bias))
    }

    /// The inertia, and the efforts without which the axes would not keep their velocity.
    fn inertia_and_bias(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
    ) -> Option<(JointMatrix, JointVector)> {
        let state = self.state(position).ok()?;
        let zero = JointVector::zeros();
        let bias = self.efforts(&state, velocity, &zero, true)
            + self.additional_efforts(position, velocity, &zero);
        Some((self.inertia_of(&state, position), bias))
    }

    /// The inertia that the axes feel at `position`; `None` where the rods do not meet.
    pub(super) fn inertia(&mut self, position: &JointVector) -> Option<JointMatrix> {
        let state = self.state(position).ok()?;
        Some(self.inertia_of(&state, position))
    }

    /// The same where everything is known to be.
    fn inertia_of(&mut self, state: &TripodState, position: &JointVector) -> JointMatrix {
        let zero = JointVector::zeros();
        let mut inertia = JointMatrix::from_diagonal(&self.armature);
        for axis in self.axis_count..MAX_AXES {
            inertia[(axis, axis)] = 1.0;
        }
        for Carriage { axis, .. } in self.carriages {
            let mut unit = zero;
            unit[axis] = 1.0;
            inertia.column_mut(axis).copy_from(&self.efforts(state, &zero, &unit, false));
        }
        if let Some(others) = &mut self.others {
            // Its diagonal is 1 too where the machine lacks an axis.
            let additional = others.inertia_at(position);
            let axes = self.axis_count.min(MAX_AXES);
            let mut block = inertia.view_mut((0, 0), (axes, axes));
            block += additional.view((0, 0), (axes, axes));
        }
        inertia
    }

    /// The values of the carriages.
    fn of_carriages(&self, values: &JointVector) -> Vector3<f64> {
        self.carriages.map(|carriage| values[carriage.axis]).into()
    }
}

/// Both vectors as one.
fn six(turn: &Vector3<f64>, shift: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}

/// The value of a carriage, upwards.
fn up(values: &Vector3<f64>, carriage: usize) -> Vector3<f64> {
    Vector3::z() * values[carriage]
}
