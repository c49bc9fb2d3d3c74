//! Two or three straight axes along x, y and z (`SMC_TRAFO_Gantry2`, `_Gantry3`, their `TRAFOF` and `TRAFOV`;
//! SoftMotion manual 8.2.1).
//!
//! ```text
//!   z ▲  ▲ y        axis X = x + offset X
//!     │ ╱           axis Y = y + offset Y
//!     │╱            axis Z = z + offset Z
//!     └────▶ x
//! ```
//!
//! Zero pose: with offsets 0 the tool tip is at the origin of the machine frame when every axis is at 0. An offset
//! is the position of its axis when the tip is there. Positive is along the coordinate. There are no branches, no
//! singularities and no bound of reach; velocities and accelerations pass unchanged, because offsets are constant
//! (the manual's `dvx = dVel · vx`). The flange keeps its attitude: x forward.

use super::ToolBeside;
use crate::error::{DimensionError, all_finite};
use crate::transform::Values;
use crate::transform::{Serial, Straight, Transform};
use crate::{AxisDisc, AxisVector, Coordinate, Result, ToolDisc};
use nalgebra::{SVector, Vector3};

/// A gantry with N axes, 2 or 3: x and y, or x, y and z. Its tool may be offset from their crossing ([`ToolBeside`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gantry<const N: usize> {
    offsets: Values<N>,
    /// What the flange hangs on.
    beside: ToolBeside,
    /// Added to the tip to give the axes: offsets less the tool tip, from the crossing of the axes.
    shift: Values<N>,
}

/// A gantry with two axes along x and y.
pub type Gantry2 = Gantry<2>;
/// A gantry with three axes along x, y and z.
pub type Gantry3 = Gantry<3>;

impl<const N: usize> Gantry<N> {
    /// A gantry whose axes are at `offsets` (m: `dOffsetX`, `dOffsetY`, `dOffsetZ`) when the tool tip is at the origin.
    ///
    /// # Errors
    /// [`DimensionError::NotFinite`].
    pub fn new(offsets: [f64; N]) -> Result<Self, DimensionError> {
        Self::with_tool_offset(offsets, ToolBeside::default())
    }

    /// A gantry whose axes are at `offsets` (m) when they cross at the origin, with a tool offset from there.
    ///
    /// # Errors
    /// [`DimensionError::NotFinite`].
    pub fn with_tool_offset(offsets: [f64; N], beside: ToolBeside) -> Result<Self, DimensionError> {
        const { assert!(N == 2 || N == 3, "a gantry has two or three axes") };
        all_finite(offsets.iter().chain(&[beside.angle, beside.ahead, beside.left]))?;
        let offsets = SVector::from(offsets);
        Ok(Self { offsets, beside, shift: offsets }.holding(&Vector3::zeros()))
    }

    /// Axis positions with the tool tip (of a machine without tool: the flange) at the origin, m.
    pub fn offsets(&self) -> [f64; N] {
        self.offsets.into()
    }
}

impl<const N: usize> Transform<N> for Gantry<N> {
    type Differential = Serial<Straight>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &Coordinate::TRANSLATIONS[..N]
    }

    fn rotary(&self) -> [bool; N] {
        [false; N]
    }

    #[inline]
    fn to_tool(&self, axes: &Values<N>) -> Result<Values<N>> {
        Ok(axes - self.shift)
    }

    #[inline]
    fn to_axes(&self, tool: &Values<N>) -> Result<Values<N>> {
        Ok(tool + self.shift)
    }

    #[inline]
    fn at_axes(&self, axes: &Values<N>) -> Result<(Values<N>, Self::Differential)> {
        Ok((axes - self.shift, Serial(Straight)))
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Values<N>,
        _near: &Values<N>,
    ) -> Result<(Values<N>, Self::Differential)> {
        Ok((tool + self.shift, Serial(Straight)))
    }

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let radius = path.radius;
        let way: [f64; 3] = path.way(radius).into();
        let change = AxisVector::from_values(way.into_iter().take(N));
        Some(AxisDisc { radius, change, is_even: path.is_even() })
    }

    fn characteristic_length(&self) -> f64 {
        super::CHARACTERISTIC_LENGTH
    }

    /// The tip counts from the end of the arm beside the axes.
    fn holding(self, tip: &Vector3<f64>) -> Self {
        let tip = tip + self.beside.offset().push(0.0);
        let tool = SVector::<f64, N>::from_iterator(tip.iter().copied().take(N));
        Self { shift: self.offsets - tool, ..self }
    }
}
