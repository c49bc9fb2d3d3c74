//! A transform behind one interface, whatever its number of axes.

use crate::transform::{Differential, Motion, Transform};
use crate::{
    AxisMotion, AxisVector, Branch, Coordinate, Dexterity, Jacobian, KinematicsError, Margins,
    Pose, ToolJerk, ToolMotion,
};
use nalgebra::{SVector, Vector3};

/// How far a coordinate without an axis may be from 0, m: far below anything a machine can show, far above the
/// rounding of a work frame.
pub(crate) const ABSENT: f64 = 1e-9;

/// A transform between the tool pose in the machine frame and a fixed number of axes.
///
/// Implementations hold dimensions and the chosen branch (elbow low or high) and nothing else: no call changes what
/// a later call returns. An unreachable pose is an error, never a clamped answer.
///
/// Every method gives [`KinematicsError::AxisCount`] for axis values that are too few or too many and
/// [`KinematicsError::NotFinite`] for what is infinite or not a number.
pub trait Kinematics: std::fmt::Debug + Send + Sync {
    /// How many axes this transform moves.
    fn axis_count(&self) -> usize;

    /// The coordinates that this transform turns into axis positions. The other lengths must be 0: they have axes of
    /// their own or none ([`MachineAxes`](crate::MachineAxes)); a direction that the transform does not have is ignored.
    fn coordinates(&self) -> &[Coordinate];

    /// Whether an axis turns (positions in rad) as far as the transform knows.
    fn is_rotary(&self, axis: usize) -> bool;

    /// Whether an axis moves the tool.
    fn moves_tool(&self, axis: usize) -> bool {
        axis < self.axis_count()
    }

    /// The tool pose that the axis positions `axes` (m or rad) give, in the machine frame (`SMC_TRAFOF_x`).
    ///
    /// # Errors
    /// [`KinematicsError::Apart`] where the rods of a tripod do not meet.
    fn forward(&self, axes: &AxisVector) -> Result<Pose, KinematicsError>;

    /// The axis positions (m or rad) that put the tool at `pose` in the machine frame (`SMC_TRAFO_x`).
    ///
    /// `near` picks the turn of rotary axes: the answer is the one within half a turn of it. It never picks the
    /// branch, which is part of the transform.
    ///
    /// # Errors
    /// [`KinematicsError::Unreachable`] if no axis position gives the pose, [`KinematicsError::NoAxis`] if the pose
    /// needs a coordinate the machine has no axis for.
    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector, KinematicsError>;

    /// The motion of the tool for moving axes.
    ///
    /// # Errors
    /// Those of [`Self::forward`], and [`KinematicsError::Singular`] where the tool is not held.
    fn forward_motion(&self, axes: &AxisMotion) -> Result<ToolMotion, KinematicsError>;

    /// Axis positions, velocities and accelerations for a moving tool (`SMC_TRAFOV_x`, one derivative
    /// further). `near` as in [`Self::inverse`].
    ///
    /// # Errors
    /// Those of [`Self::inverse`], and [`KinematicsError::Singular`] where the axes cannot follow the tool velocity.
    fn inverse_motion(
        &self,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> Result<AxisMotion, KinematicsError>;

    /// [`Self::forward_motion`] with the jerks of the axes (m/s³ or rad/s³) and of the tool.
    ///
    /// # Errors
    /// Those of [`Self::forward_motion`].
    fn forward_jerk(
        &self,
        axes: &AxisMotion,
        jerk: &AxisVector,
    ) -> Result<(ToolMotion, ToolJerk), KinematicsError>;

    /// [`Self::inverse_motion`] with the jerks of the tool and of the axes (m/s³ or rad/s³).
    ///
    /// # Errors
    /// Those of [`Self::inverse_motion`].
    fn inverse_jerk(
        &self,
        tool: &ToolMotion,
        jerk: &ToolJerk,
        near: &AxisVector,
    ) -> Result<(AxisMotion, AxisVector), KinematicsError>;

    /// How the tool moves with the axes at `axes`.
    ///
    /// # Errors
    /// Those of [`Self::forward_motion`].
    fn jacobian(&self, axes: &AxisVector) -> Result<Jacobian, KinematicsError>;

    /// The derivative of [`Self::jacobian`] by time with the axes moving at `velocity`.
    ///
    /// # Errors
    /// Those of [`Self::forward_motion`].
    fn jacobian_rate(
        &self,
        axes: &AxisVector,
        velocity: &AxisVector,
    ) -> Result<Jacobian, KinematicsError>;

    /// Which solution [`Self::inverse`] gives.
    fn branch(&self) -> Branch;

    /// On which branch axis positions are.
    ///
    /// # Errors
    /// None but those of every method.
    fn branch_at(&self, axes: &AxisVector) -> Result<Branch, KinematicsError>;

    /// How far a pose is from the edge of what the mechanism reaches and from where its solutions meet.
    ///
    /// # Errors
    /// [`KinematicsError::NoAxis`].
    fn margins(&self, pose: &Pose) -> Result<Margins, KinematicsError>;

    /// A length in the order of the machine's size, m: what makes angles and lengths comparable unless the machine
    /// states another.
    fn characteristic_length(&self) -> f64;

    /// The same mechanism with a tool whose tip is at `tip` (m) in the frame of its flange: z up, x forward as the
    /// transform's docs say; straight down is −z. z counts only if the transform has it. A tool held before is taken off.
    fn holding(self: Box<Self>, tip: &Vector3<f64>) -> Box<dyn Kinematics>;

    /// How well the tool can be moved with the axes at `axes`; `length` (m) is what a radian counts, as
    /// [`Self::characteristic_length`] suggests.
    ///
    /// # Errors
    /// Those of [`Self::jacobian`].
    fn dexterity(&self, axes: &AxisVector, length: f64) -> Result<Dexterity, KinematicsError> {
        let moves = |axis: usize| self.moves_tool(axis);
        let turns = |axis: usize| self.is_rotary(axis);
        Ok(self.jacobian(axes)?.dexterity(self.coordinates(), moves, turns, length))
    }
}

/// N axis values out of as many as there are.
fn values<const N: usize>(axes: &AxisVector) -> Result<SVector<f64, N>, KinematicsError> {
    let given = axes.len();
    let values = <[f64; N]>::try_from(&**axes).map_err(|_: std::array::TryFromSliceError| {
        KinematicsError::AxisCount { given, expected: N }
    })?;
    if axes.is_finite() { Ok(values.into()) } else { Err(KinematicsError::NotFinite) }
}

fn vector<const N: usize>(values: &SVector<f64, N>) -> Result<AxisVector, KinematicsError> {
    let axes = AxisVector::from_values(values.iter().copied());
    if axes.is_finite() { Ok(axes) } else { Err(KinematicsError::NotFinite) }
}

fn axis_motion<const N: usize>(motion: &Motion<N>) -> Result<AxisMotion, KinematicsError> {
    Ok(AxisMotion {
        position: vector(&motion.position)?,
        velocity: vector(&motion.velocity)?,
        acceleration: vector(&motion.acceleration)?,
    })
}

/// The tool coordinates of a transform among all.
fn pick<const N: usize>(
    coordinates: &[Coordinate],
    tip: &Vector3<f64>,
    direction: f64,
) -> SVector<f64, N> {
    let mut picked = SVector::<f64, N>::zeros();
    for (slot, coordinate) in picked.iter_mut().zip(coordinates) {
        *slot = coordinate.of(tip, direction);
    }
    picked
}

/// The way back: what the transform does not have is 0.
fn spread<const N: usize>(
    coordinates: &[Coordinate],
    values: &SVector<f64, N>,
) -> (Vector3<f64>, f64) {
    let (mut tip, mut direction) = (Vector3::zeros(), 0.0);
    for (value, coordinate) in values.iter().zip(coordinates) {
        *coordinate.of_mut(&mut tip, &mut direction) = *value;
    }
    (tip, direction)
}

fn pose<const N: usize>(
    coordinates: &[Coordinate],
    tool: &SVector<f64, N>,
) -> Result<Pose, KinematicsError> {
    let (tip, direction) = spread(coordinates, tool);
    let pose = Pose { position: tip.into(), direction };
    if pose.is_finite() { Ok(pose) } else { Err(KinematicsError::NotFinite) }
}

fn tool_motion<const N: usize>(
    coordinates: &[Coordinate],
    motion: &Motion<N>,
) -> Result<ToolMotion, KinematicsError> {
    let (velocity, direction_velocity) = spread(coordinates, &motion.velocity);
    let (acceleration, direction_acceleration) = spread(coordinates, &motion.acceleration);
    let tool = ToolMotion {
        pose: pose(coordinates, &motion.position)?,
        velocity,
        acceleration,
        direction_velocity,
        direction_acceleration,
    };
    if tool.is_finite() { Ok(tool) } else { Err(KinematicsError::NotFinite) }
}

/// A pose as tool coordinates; what the transform does not have must be 0.
fn tool<const N: usize>(
    coordinates: &[Coordinate],
    pose: &Pose,
) -> Result<SVector<f64, N>, KinematicsError> {
    if !pose.is_finite() {
        return Err(KinematicsError::NotFinite);
    }
    for coordinate in Coordinate::TRANSLATIONS {
        let value = coordinate.of_pose(pose);
        if value.abs() > ABSENT && !coordinates.contains(&coordinate) {
            return Err(KinematicsError::NoAxis { coordinate, value });
        }
    }
    Ok(pick(coordinates, &pose.position.coords, pose.direction))
}

fn tool_as_motion<const N: usize>(
    coordinates: &[Coordinate],
    motion: &ToolMotion,
) -> Result<Motion<N>, KinematicsError> {
    if !motion.is_finite() {
        return Err(KinematicsError::NotFinite);
    }
    Ok(Motion {
        position: tool(coordinates, &motion.pose)?,
        velocity: pick(coordinates, &motion.velocity, motion.direction_velocity),
        acceleration: pick(coordinates, &motion.acceleration, motion.direction_acceleration),
    })
}

fn axes_as_motion<const N: usize>(axes: &AxisMotion) -> Result<Motion<N>, KinematicsError> {
    Ok(Motion {
        position: values(&axes.position)?,
        velocity: values(&axes.velocity)?,
        acceleration: values(&axes.acceleration)?,
    })
}

pub(crate) mod with {
    //! The methods of [`Kinematics`](crate::Kinematics) for every transform. Free functions, because a trait cannot be
    //! implemented for all transforms at once: the number of axes is not part of the type.

    use super::{
        AxisMotion, AxisVector, Branch, Differential, Jacobian, KinematicsError, Margins, Motion,
        Pose, SVector, ToolJerk, ToolMotion, Transform, axes_as_motion, axis_motion, pick, pose,
        spread, tool, tool_as_motion, tool_motion, values, vector,
    };
    use nalgebra::SMatrix;

    pub(crate) fn forward<const N: usize>(
        transform: &impl Transform<N>,
        axes: &AxisVector,
    ) -> Result<Pose, KinematicsError> {
        pose(transform.coordinates(), &transform.to_tool(&values(axes)?)?)
    }

    pub(crate) fn inverse<const N: usize>(
        transform: &impl Transform<N>,
        pose: &Pose,
        near: &AxisVector,
    ) -> Result<AxisVector, KinematicsError> {
        let near = values(near)?;
        vector(&transform.to_axes_near(&tool(transform.coordinates(), pose)?, &near)?)
    }

    pub(crate) fn forward_motion<const N: usize>(
        transform: &impl Transform<N>,
        axes: &AxisMotion,
    ) -> Result<ToolMotion, KinematicsError> {
        tool_motion(transform.coordinates(), &transform.tool_motion(&axes_as_motion(axes)?)?)
    }

    pub(crate) fn inverse_motion<const N: usize>(
        transform: &impl Transform<N>,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> Result<AxisMotion, KinematicsError> {
        let near = values(near)?;
        let tool = tool_as_motion(transform.coordinates(), tool)?;
        axis_motion(&transform.axis_motion(&tool, &near)?)
    }

    pub(crate) fn forward_jerk<const N: usize>(
        transform: &impl Transform<N>,
        axes: &AxisMotion,
        jerk: &AxisVector,
    ) -> Result<(ToolMotion, ToolJerk), KinematicsError> {
        let axes = axes_as_motion(axes)?;
        let (position, differential) = transform.at_axes(&axes.position)?;
        let led = differential.lead_jerk(&[axes.velocity, axes.acceleration, values(jerk)?]);
        let Some([velocity, acceleration, jerk]) = led else {
            return Err(transform.singular(&position));
        };
        let motion = Motion { position, velocity, acceleration };
        let (linear, direction) = spread(transform.coordinates(), &jerk);
        let jerk = ToolJerk { linear, direction };
        if !jerk.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        Ok((tool_motion(transform.coordinates(), &motion)?, jerk))
    }

    pub(crate) fn inverse_jerk<const N: usize>(
        transform: &impl Transform<N>,
        tool: &ToolMotion,
        jerk: &ToolJerk,
        near: &AxisVector,
    ) -> Result<(AxisMotion, AxisVector), KinematicsError> {
        if !jerk.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let near = values(near)?;
        let tool = tool_as_motion(transform.coordinates(), tool)?;
        let jerk: SVector<f64, N> = pick(transform.coordinates(), &jerk.linear, jerk.direction);
        let (position, differential) = transform.at_tool(&tool.position, &near)?;
        let followed = differential.follow_jerk(&[tool.velocity, tool.acceleration, jerk]);
        let Some([velocity, acceleration, jerk]) = followed else {
            return Err(transform.singular(&tool.position));
        };
        Ok((axis_motion(&Motion { position, velocity, acceleration })?, vector(&jerk)?))
    }

    fn spread_matrix<const N: usize>(
        transform: &impl Transform<N>,
        tool: &SVector<f64, N>,
        matrix: Option<SMatrix<f64, N, N>>,
    ) -> Result<Jacobian, KinematicsError> {
        let matrix = matrix.ok_or_else(|| transform.singular(tool))?;
        let mut jacobian = Jacobian::zeros(N);
        for (axis, column) in matrix.column_iter().enumerate() {
            for (coordinate, value) in transform.coordinates().iter().zip(&column) {
                jacobian.set(*coordinate, axis, *value);
            }
        }
        Ok(jacobian)
    }

    pub(crate) fn jacobian<const N: usize>(
        transform: &impl Transform<N>,
        axes: &AxisVector,
    ) -> Result<Jacobian, KinematicsError> {
        let (tool, differential) = transform.at_axes(&values(axes)?)?;
        spread_matrix(transform, &tool, differential.jacobian())
    }

    pub(crate) fn jacobian_rate<const N: usize>(
        transform: &impl Transform<N>,
        axes: &AxisVector,
        velocity: &AxisVector,
    ) -> Result<Jacobian, KinematicsError> {
        let (tool, differential) = transform.at_axes(&values(axes)?)?;
        spread_matrix(transform, &tool, differential.jacobian_rate(&values(velocity)?))
    }

    pub(crate) fn branch_at<const N: usize>(
        transform: &impl Transform<N>,
        axes: &AxisVector,
    ) -> Result<Branch, KinematicsError> {
        Ok(transform.branch_at(&values(axes)?))
    }

    pub(crate) fn margins<const N: usize>(
        transform: &impl Transform<N>,
        pose: &Pose,
    ) -> Result<Margins, KinematicsError> {
        Ok(transform.margins(&tool(transform.coordinates(), pose)?))
    }
}

/// Implements [`Kinematics`] for transforms.
macro_rules! implement {
    ($($transform:ty: $axes:literal),* $(,)?) => {$(
        impl Kinematics for $transform {
            fn axis_count(&self) -> usize {
                $axes
            }

            fn coordinates(&self) -> &[Coordinate] {
                Transform::<$axes>::coordinates(self)
            }

            fn is_rotary(&self, axis: usize) -> bool {
                self.rotary().get(axis).copied().unwrap_or_default()
            }

            fn forward(&self, axes: &AxisVector) -> Result<Pose, KinematicsError> {
                with::forward(self, axes)
            }

            fn inverse(
                &self,
                pose: &Pose,
                near: &AxisVector,
            ) -> Result<AxisVector, KinematicsError> {
                with::inverse(self, pose, near)
            }

            fn forward_motion(&self, axes: &AxisMotion) -> Result<ToolMotion, KinematicsError> {
                with::forward_motion(self, axes)
            }

            fn inverse_motion(
                &self,
                tool: &ToolMotion,
                near: &AxisVector,
            ) -> Result<AxisMotion, KinematicsError> {
                with::inverse_motion(self, tool, near)
            }

            fn forward_jerk(
                &self,
                axes: &AxisMotion,
                jerk: &AxisVector,
            ) -> Result<(ToolMotion, ToolJerk), KinematicsError> {
                with::forward_jerk(self, axes, jerk)
            }

            fn inverse_jerk(
                &self,
                tool: &ToolMotion,
                jerk: &ToolJerk,
                near: &AxisVector,
            ) -> Result<(AxisMotion, AxisVector), KinematicsError> {
                with::inverse_jerk(self, tool, jerk, near)
            }

            fn jacobian(&self, axes: &AxisVector) -> Result<Jacobian, KinematicsError> {
                with::jacobian(self, axes)
            }

            fn jacobian_rate(
                &self,
                axes: &AxisVector,
                velocity: &AxisVector,
            ) -> Result<Jacobian, KinematicsError> {
                with::jacobian_rate(self, axes, velocity)
            }

            fn branch(&self) -> Branch {
                Transform::<$axes>::branch(self)
            }

            fn branch_at(&self, axes: &AxisVector) -> Result<Branch, KinematicsError> {
                with::branch_at(self, axes)
            }

            fn margins(&self, pose: &Pose) -> Result<Margins, KinematicsError> {
                with::margins(self, pose)
            }

            fn characteristic_length(&self) -> f64 {
                Transform::<$axes>::characteristic_length(self)
            }

            fn holding(self: Box<Self>, tip: &Vector3<f64>) -> Box<dyn Kinematics> {
                Box::new(Transform::<$axes>::holding(*self, tip))
            }
        }
    )*};
}

implement! {
    crate::gantry::Gantry2: 2,
    crate::gantry::Gantry3: 3,
    crate::gantry::GantryCutter2: 3,
    crate::gantry::GantryCutter3: 4,
    crate::gantry::Gantry2Tool: 2,
    crate::gantry::Gantry3Tool: 3,
    crate::gantry::GantryH2: 2,
    crate::scara::Scara2: 2,
    crate::scara::Scara3: 3,
    crate::tripod::Tripod: 3,
    crate::tripod::CalibratedTripod: 3,
}
