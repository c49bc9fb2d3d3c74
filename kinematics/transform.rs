//! [`Transform`]: a transform as plain mathematics, with N tool coordinates and N axes known at compile time.

use crate::smooth::SmoothMap;
pub use crate::smooth::Values;
use crate::turn::nearest_turn;
use crate::{AxisDisc, Branch, Coordinate, KinematicsError, Margins, Result, ToolDisc};
use nalgebra::{SMatrix, SVector, Vector3};
use std::f64::consts::TAU;

/// Position, velocity and acceleration of N axes or N tool coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<const N: usize> {
    /// m or rad.
    pub position: Values<N>,
    /// m/s or rad/s.
    pub velocity: Values<N>,
    /// m/s² or rad/s².
    pub acceleration: Values<N>,
}

/// A transform with N axes, the core of a [`Kinematics`](crate::Kinematics) without its bookkeeping: this is what to call where speed
/// counts. Tool coordinates are in the order of [`Self::coordinates`], in the machine frame; SI.
///
/// Inputs that are not numbers give errors or answers that are not numbers, never a panic.
pub trait Transform<const N: usize>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// Differential of a transform at one point: rates of the axes for those of the tool, and back.
    type Differential: Differential<N>;

    /// The tool coordinates that this transform turns into axis positions, N of them.
    fn coordinates(&self) -> &'static [Coordinate];

    /// True for every axis that is rotary.
    fn rotary(&self) -> [bool; N];

    /// The tool at the axis positions `axes` (`SMC_TRAFOF_x`).
    ///
    /// # Errors
    /// [`KinematicsError::Apart`], where axes can be where no tool position fits.
    fn to_tool(&self, axes: &Values<N>) -> Result<Values<N>>;

    /// The axis positions that put the tool at `tool` (`SMC_TRAFO_x`); rotary axes within ±π of their
    /// offsets.
    ///
    /// # Errors
    /// [`KinematicsError::Unreachable`].
    fn to_axes(&self, tool: &Values<N>) -> Result<Values<N>>;

    /// [`Self::to_axes`] with every rotary axis within half a turn of where it is in `near`.
    ///
    /// # Errors
    /// As [`Self::to_axes`].
    #[inline]
    fn to_axes_near(&self, tool: &Values<N>, near: &Values<N>) -> Result<Values<N>> {
        let mut axes = self.to_axes(tool)?;
        self.turn_to(&mut axes, near);
        Ok(axes)
    }

    /// Adds the whole turns to rotary axes that bring them closest to `near`.
    #[inline]
    fn turn_to(&self, axes: &mut Values<N>, near: &Values<N>) {
        for ((axis, near), rotary) in axes.iter_mut().zip(near).zip(self.rotary()) {
            if rotary {
                *axis = nearest_turn(*axis, *near, TAU);
            }
        }
    }

    /// The tool at `axes`, and the differential there.
    ///
    /// # Errors
    /// As [`Self::to_tool`].
    fn at_axes(&self, axes: &Values<N>) -> Result<(Values<N>, Self::Differential)>;

    /// The axes at `tool` near `near`, and the differential there.
    ///
    /// # Errors
    /// As [`Self::to_axes`].
    fn at_tool(
        &self,
        tool: &Values<N>,
        near: &Values<N>,
    ) -> Result<(Values<N>, Self::Differential)>;

    /// Branch that [`Self::to_axes`] gives.
    fn branch(&self) -> Branch {
        Branch::Only
    }

    /// Branch of axis positions.
    fn branch_at(&self, _axes: &Values<N>) -> Branch {
        self.branch()
    }

    /// Margins of a tool position to the edge of the reach.
    fn margins(&self, _tool: &Values<N>) -> Margins {
        Margins::UNBOUNDED
    }

    /// A disc of the parameter of a tool path on which the axes are analytic; `None` if that is not known, or out of
    /// reach. What the transform does not have counts nothing.
    fn disc(&self, _path: &ToolDisc) -> Option<AxisDisc> {
        None
    }

    /// A length in the order of the machine's size, m: what makes angles and lengths comparable unless the machine
    /// states another.
    fn characteristic_length(&self) -> f64;

    /// The same mechanism with a tool whose tip is at `tip` (m) in the frame of its flange: z up, x forward as the
    /// transform's docs say. z counts only if the transform has it. A tool held before is taken off.
    #[must_use]
    fn holding(self, tip: &Vector3<f64>) -> Self;

    /// Axis positions, velocities and accelerations for a moving tool (`SMC_TRAFOV_x`, one derivative further).
    ///
    /// # Errors
    /// Those of [`Self::to_axes`], and [`KinematicsError::Singular`] where the axes cannot follow.
    #[inline]
    fn axis_motion(&self, tool: &Motion<N>, near: &Values<N>) -> Result<Motion<N>> {
        let (position, differential) = self.at_tool(&tool.position, near)?;
        let followed = differential.follow(&tool.velocity, &tool.acceleration);
        let Some([velocity, acceleration]) = followed else {
            return Err(self.singular(&tool.position));
        };
        Ok(Motion { position, velocity, acceleration })
    }

    /// The motion of the tool for moving axes.
    ///
    /// # Errors
    /// Those of [`Self::to_tool`], and [`KinematicsError::Singular`] where the tool is not held.
    #[inline]
    fn tool_motion(&self, axes: &Motion<N>) -> Result<Motion<N>> {
        let (position, differential) = self.at_axes(&axes.position)?;
        let led = differential.lead(&axes.velocity, &axes.acceleration);
        let Some([velocity, acceleration]) = led else { return Err(self.singular(&position)) };
        Ok(Motion { position, velocity, acceleration })
    }

    /// The error that says that a tool position is singular.
    #[cold]
    fn singular(&self, tool: &Values<N>) -> KinematicsError {
        KinematicsError::Singular(self.tip(tool))
    }

    /// x, y and z among tool coordinates; what the transform does not have is 0.
    #[cold]
    fn tip(&self, tool: &Values<N>) -> [f64; 3] {
        let mut tip = [0.0; 3];
        for (coordinate, value) in self.coordinates().iter().zip(tool) {
            if let Some(slot) = tip.get_mut(coordinate.index()) {
                *slot = *value;
            }
        }
        tip
    }
}

/// Differential of a transform at one point: rates of the axes for those of the tool, and back.
pub trait Differential<const N: usize> {
    /// Axis velocities and accelerations for those of the tool; `None` where the axes cannot follow.
    fn follow(&self, velocity: &Values<N>, acceleration: &Values<N>) -> Option<[Values<N>; 2]>;

    /// Axis velocities, accelerations and jerks for those of the tool; `None` where the axes cannot follow.
    fn follow_jerk(&self, tool: &[Values<N>; 3]) -> Option<[Values<N>; 3]>;

    /// Tool velocity and acceleration for those of the axes; `None` where the tool is not held.
    fn lead(&self, velocity: &Values<N>, acceleration: &Values<N>) -> Option<[Values<N>; 2]>;

    /// Tool velocity, acceleration and jerk for those of the axes; `None` where the tool is not held.
    fn lead_jerk(&self, axes: &[Values<N>; 3]) -> Option<[Values<N>; 3]>;

    /// Jacobian: column i is its velocity per unit velocity of axis i. `None` where the tool is not held.
    fn jacobian(&self) -> Option<SMatrix<f64, N, N>>;
}

/// A mechanism that is a smooth map from its axes to the tool.
#[derive(Clone, Copy, Debug)]
pub struct Serial<M>(pub M);

/// A mechanism that is a smooth map from the tool to its axes.
#[derive(Clone, Copy, Debug)]
pub struct Parallel<M>(pub M);

#[inline]
fn against<const N: usize>(
    map: &impl SmoothMap<N>,
    v: &Values<N>,
    a: &Values<N>,
) -> Option<[Values<N>; 2]> {
    let velocity = map.solve(v)?;
    let acceleration = map.solve(&(a - map.second(&velocity)))?;
    Some([velocity, acceleration])
}

fn against_jerk<const N: usize>(
    map: &impl SmoothMap<N>,
    [v, a, j]: &[Values<N>; 3],
) -> Option<[Values<N>; 3]> {
    let [velocity, acceleration] = against(map, v, a)?;
    let jerk = map.solve(&(j - map.third(&velocity, &acceleration)))?;
    Some([velocity, acceleration, jerk])
}

impl<M: SmoothMap<N>, const N: usize> Differential<N> for Serial<M> {
    #[inline]
    fn follow(&self, velocity: &Values<N>, acceleration: &Values<N>) -> Option<[Values<N>; 2]> {
        against(&self.0, velocity, acceleration)
    }

    fn follow_jerk(&self, tool: &[Values<N>; 3]) -> Option<[Values<N>; 3]> {
        against_jerk(&self.0, tool)
    }

    #[inline]
    fn lead(&self, velocity: &Values<N>, acceleration: &Values<N>) -> Option<[Values<N>; 2]> {
        Some(self.0.along(velocity, acceleration))
    }

    fn lead_jerk(&self, axes: &[Values<N>; 3]) -> Option<[Values<N>; 3]> {
        Some(self.0.along_jerk(axes))
    }

    fn jacobian(&self) -> Option<SMatrix<f64, N, N>> {
        Some(self.0.matrix())
    }
}

impl<M: SmoothMap<N>, const N: usize> Differential<N> for Parallel<M> {
    #[inline]
    fn follow(&self, velocity: &Values<N>, acceleration: &Values<N>) -> Option<[Values<N>; 2]> {
        if self.0.is_singular() {
            return rest_or_none(velocity, acceleration);
        }
        Some(self.0.along(velocity, acceleration))
    }

    fn follow_jerk(&self, tool: &[Values<N>; 3]) -> Option<[Values<N>; 3]> {
        if self.0.is_singular() {
            let rest = tool.iter().flatten().all(|value| *value == 0.0);
            return rest.then(|| [SVector::zeros(); 3]);
        }
        Some(self.0.along_jerk(tool))
    }

    #[inline]
    fn lead(&self, velocity: &Values<N>, acceleration: &Values<N>) -> Option<[Values<N>; 2]> {
        against(&self.0, velocity, acceleration)
    }

    fn lead_jerk(&self, axes: &[Values<N>; 3]) -> Option<[Values<N>; 3]> {
        against_jerk(&self.0, axes)
    }

    fn jacobian(&self) -> Option<SMatrix<f64, N, N>> {
        columns(|unit| self.0.solve(unit))
    }
}

/// A tool at rest stays so where nothing could follow it.
#[cold]
fn rest_or_none<const N: usize>(
    velocity: &Values<N>,
    acceleration: &Values<N>,
) -> Option<[Values<N>; 2]> {
    let rest = velocity.iter().chain(acceleration).all(|value| *value == 0.0);
    rest.then(|| [SVector::zeros(); 2])
}

/// The matrix whose columns are `of` the unit vectors.
fn columns<const N: usize>(
    of: impl Fn(&Values<N>) -> Option<Values<N>>,
) -> Option<SMatrix<f64, N, N>> {
    let mut result = SMatrix::<f64, N, N>::zeros();
    for (index, mut column) in result.column_iter_mut().enumerate() {
        let unit = SVector::<f64, N>::from_fn(|row, _| if row == index { 1.0 } else { 0.0 });
        column.copy_from(&of(&unit)?);
    }
    Some(result)
}

/// A map that only adds a constant: every derivative passes unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Straight;

impl<const N: usize> SmoothMap<N> for Straight {
    #[inline]
    fn rate(&self, v: &Values<N>) -> Values<N> {
        *v
    }

    #[inline]
    fn solve(&self, rate: &Values<N>) -> Option<Values<N>> {
        Some(*rate)
    }

    #[inline]
    fn second(&self, _v: &Values<N>) -> Values<N> {
        SVector::zeros()
    }

    #[inline]
    fn third(&self, _v: &Values<N>, _a: &Values<N>) -> Values<N> {
        SVector::zeros()
    }
}

/// A map that multiplies by a constant matrix, and by `inverse` on the way back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<const N: usize> {
    /// J.
    pub matrix: SMatrix<f64, N, N>,
    /// J⁻¹.
    pub inverse: SMatrix<f64, N, N>,
}

impl<const N: usize> SmoothMap<N> for Linear<N> {
    #[inline]
    fn rate(&self, v: &Values<N>) -> Values<N> {
        self.matrix * v
    }

    #[inline]
    fn solve(&self, rate: &Values<N>) -> Option<Values<N>> {
        Some(self.inverse * rate)
    }

    #[inline]
    fn second(&self, _v: &Values<N>) -> Values<N> {
        SVector::zeros()
    }

    #[inline]
    fn third(&self, _v: &Values<N>, _a: &Values<N>) -> Values<N> {
        SVector::zeros()
    }
}
