//! Implementation of [`Kinematics`] for every [`Transform`], by a macro: a blanket implementation is impossible,
//! because the number of axes is not part of a transform's type.

use crate::kinematics::ABSENT;
use crate::transform::Values;
use crate::transform::{Differential, Motion, Transform};
use crate::{
    AxisDisc, AxisMotion, AxisVector, Branch, Coordinate, Jacobian, Kinematics, KinematicsError,
    Margins, Pose, Result, ToolDisc, ToolJerk, ToolMotion,
};
use nalgebra::{SMatrix, SVector, Vector3};

/// N axis values out of as many as there are.
fn values<const N: usize>(axes: &AxisVector) -> Result<Values<N>> {
    let given = axes.len();
    let Some(values) = axes.first_chunk::<N>().filter(|_| given == N) else {
        return Err(KinematicsError::AxisCount { given, expected: N });
    };
    if axes.is_finite() { Ok((*values).into()) } else { Err(KinematicsError::NotFinite) }
}

fn vector<const N: usize>(values: &Values<N>) -> Result<AxisVector> {
    let axes = AxisVector::from_values(values.iter().copied());
    if axes.is_finite() { Ok(axes) } else { Err(KinematicsError::NotFinite) }
}

fn axis_motion<const N: usize>(motion: &Motion<N>) -> Result<AxisMotion> {
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
) -> Values<N> {
    let mut picked = SVector::<f64, N>::zeros();
    for (slot, coordinate) in picked.iter_mut().zip(coordinates) {
        *slot = coordinate.of(tip, direction);
    }
    picked
}

/// The way back: what the transform does not have is 0.
fn spread<const N: usize>(coordinates: &[Coordinate], values: &Values<N>) -> (Vector3<f64>, f64) {
    let (mut tip, mut direction) = (Vector3::zeros(), 0.0);
    for (value, coordinate) in values.iter().zip(coordinates) {
        *coordinate.of_mut(&mut tip, &mut direction) = *value;
    }
    (tip, direction)
}

fn pose<const N: usize>(coordinates: &[Coordinate], tool: &Values<N>) -> Result<Pose> {
    let (tip, direction) = spread(coordinates, tool);
    let pose = Pose { position: tip.into(), direction };
    if pose.is_finite() { Ok(pose) } else { Err(KinematicsError::NotFinite) }
}

fn tool_motion<const N: usize>(
    coordinates: &[Coordinate],
    motion: &Motion<N>,
) -> Result<ToolMotion> {
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
fn tool<const N: usize>(coordinates: &[Coordinate], pose: &Pose) -> Result<Values<N>> {
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
) -> Result<Motion<N>> {
    if !motion.is_finite() {
        return Err(KinematicsError::NotFinite);
    }
    Ok(Motion {
        position: tool(coordinates, &motion.pose)?,
        velocity: pick(coordinates, &motion.velocity, motion.direction_velocity),
        acceleration: pick(coordinates, &motion.acceleration, motion.direction_acceleration),
    })
}

fn axes_as_motion<const N: usize>(axes: &AxisMotion) -> Result<Motion<N>> {
    Ok(Motion {
        position: values(&axes.position)?,
        velocity: values(&axes.velocity)?,
        acceleration: values(&axes.acceleration)?,
    })
}

fn inverse_jerk_of<const N: usize>(
    transform: &impl Transform<N>,
    tool: &ToolMotion,
    jerk: &ToolJerk,
    near: &AxisVector,
) -> Result<(AxisMotion, AxisVector)> {
    if !jerk.is_finite() {
        return Err(KinematicsError::NotFinite);
    }
    let near = values(near)?;
    let tool = tool_as_motion(transform.coordinates(), tool)?;
    let jerk: Values<N> = pick(transform.coordinates(), &jerk.linear, jerk.direction);
    let (position, differential) = transform.at_tool(&tool.position, &near)?;
    let followed = differential.follow_jerk(&[tool.velocity, tool.acceleration, jerk]);
    let Some([velocity, acceleration, jerk]) = followed else {
        return Err(transform.singular(&tool.position));
    };
    Ok((axis_motion(&Motion { position, velocity, acceleration })?, vector(&jerk)?))
}

fn spread_matrix<const N: usize>(
    transform: &impl Transform<N>,
    tool: &Values<N>,
    matrix: Option<SMatrix<f64, N, N>>,
) -> Result<Jacobian> {
    let matrix = matrix.ok_or_else(|| transform.singular(tool))?;
    let mut jacobian = Jacobian::zeros(N);
    for (axis, column) in matrix.column_iter().enumerate() {
        for (coordinate, value) in transform.coordinates().iter().zip(&column) {
            jacobian.set(*coordinate, axis, *value);
        }
    }
    Ok(jacobian)
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

            fn forward(&self, axes: &AxisVector) -> Result<Pose> {
                pose(Transform::<$axes>::coordinates(self), &self.to_tool(&values(axes)?)?)
            }

            fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector> {
                let tool = tool(Transform::<$axes>::coordinates(self), pose)?;
                vector(&self.to_axes_near(&tool, &values(near)?)?)
            }

            fn forward_motion(&self, axes: &AxisMotion) -> Result<ToolMotion> {
                tool_motion(Transform::<$axes>::coordinates(self), &self.tool_motion(&axes_as_motion(axes)?)?)
            }

            fn inverse_motion(&self, tool: &ToolMotion, near: &AxisVector) -> Result<AxisMotion> {
                let tool = tool_as_motion(Transform::<$axes>::coordinates(self), tool)?;
                axis_motion(&self.axis_motion(&tool, &values(near)?)?)
            }

            fn inverse_jerk(
                &self,
                tool: &ToolMotion,
                jerk: &ToolJerk,
                near: &AxisVector,
            ) -> Result<(AxisMotion, AxisVector)> {
                inverse_jerk_of(self, tool, jerk, near)
            }

            fn jacobian(&self, axes: &AxisVector) -> Result<Jacobian> {
                let (tool, differential) = self.at_axes(&values(axes)?)?;
                spread_matrix(self, &tool, differential.jacobian())
            }

            fn branch(&self) -> Branch {
                Transform::<$axes>::branch(self)
            }

            fn branch_at(&self, axes: &AxisVector) -> Result<Branch> {
                Ok(Transform::<$axes>::branch_at(self, &values(axes)?))
            }

            fn margins(&self, pose: &Pose) -> Result<Margins> {
                Ok(Transform::<$axes>::margins(self, &tool(Transform::<$axes>::coordinates(self), pose)?))
            }

            fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
                Transform::<$axes>::disc(self, path)
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
    crate::gantry::GantryH2: 2,
    crate::scara::Scara2: 2,
    crate::scara::Scara3: 3,
    crate::tripod::Tripod: 3,
    crate::tripod::CalibratedTripod: 3,
}
