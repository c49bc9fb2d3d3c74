//! Gantries whose tool is offset from the crossing of their axes (`SMC_TRAFO_Gantry2Tool1`, `_Gantry2Tool2` and their
//! `TRAFOF`; SoftMotion manual 8.2.2), with two or three axes.
//!
//! ```text
//!            tool ●
//!         B > 0   │  n
//!   axes ●────────┘      u = (cos α, sin α)
//!            A           n = (−sin α, cos α): to the left of u
//!
//!   tool = axes + A·u + B·n
//!   axis X = x − A·cos α + B·sin α + offset X
//!   axis Y = y − A·sin α − B·cos α + offset Y
//! ```
//!
//! Path and feed are those of the tool. The manual's Tool1 has B = 0. α is constant: no coordinate turns this tool.
//! Everything else as in [`Gantry`](super::Gantry).

use super::Gantry;
use super::view::{GantryToolView, Range};
use crate::error::{DimensionError, all_finite};
use crate::transform::Values;
use crate::transform::{Serial, Straight, Transform};
use crate::{Coordinate, Result};
use nalgebra::{Vector2, Vector3};

/// Offset of a tool from the axes that carry it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolBeside {
    /// The direction from which `ahead` and `left` are counted, from +x counter-clockwise, rad: `dAlpha`.
    pub angle: f64,
    /// Along that direction, m: `dToolA`.
    pub ahead: f64,
    /// To its left, m: `dToolB`.
    pub left: f64,
}

impl ToolBeside {
    /// End of `ahead`, from the axes: the corner of the manual's triangle, m.
    pub fn corner(&self) -> Vector2<f64> {
        Vector2::new(self.angle.cos(), self.angle.sin()) * self.ahead
    }

    /// Position of the tool, from the axes, m.
    pub fn offset(&self) -> Vector2<f64> {
        self.corner() + Vector2::new(-self.angle.sin(), self.angle.cos()) * self.left
    }
}

/// A gantry with N axes, 2 or 3, and a tool offset from their crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GantryTool<const N: usize> {
    gantry: Gantry<N>,
    beside: ToolBeside,
}

/// Two axes along x and y and a tool offset from them (`dToolB` = 0: the manual's `Gantry2Tool1`).
pub type Gantry2Tool = GantryTool<2>;
/// Three axes along x, y and z and a tool offset from them.
pub type Gantry3Tool = GantryTool<3>;

impl<const N: usize> GantryTool<N> {
    /// A gantry whose axes are at `offsets` (m) when they cross at the origin, with a tool offset from them.
    ///
    /// # Errors
    /// [`DimensionError::NotFinite`].
    pub fn new(offsets: [f64; N], beside: ToolBeside) -> Result<Self, DimensionError> {
        all_finite(&[beside.angle, beside.ahead, beside.left])?;
        let gantry = Gantry::new(offsets)?;
        Ok(Self { gantry, beside }.holding(&Vector3::zeros()))
    }

    /// Axis positions when they cross at the origin, m.
    pub fn offsets(&self) -> [f64; N] {
        self.gantry.offsets()
    }

    /// Offset of the tool.
    pub const fn beside(&self) -> &ToolBeside {
        &self.beside
    }

    /// The manual's normalised outputs with the axes at `axes` (m).
    pub fn view(&self, axes: &Values<N>, range: &Range) -> Option<GantryToolView> {
        let offsets = self.offsets();
        let [x, y] = [offsets.first()?, offsets.get(1)?];
        let crossing = Vector2::new(axes.get(0)? - x, axes.get(1)? - y);
        Some(range.tool_view(crossing, [*x, *y], &self.beside))
    }
}

impl<const N: usize> Transform<N> for GantryTool<N> {
    type Differential = Serial<Straight>;

    fn coordinates(&self) -> &'static [Coordinate] {
        self.gantry.coordinates()
    }

    fn rotary(&self) -> [bool; N] {
        self.gantry.rotary()
    }

    #[inline]
    fn to_tool(&self, axes: &Values<N>) -> Result<Values<N>> {
        self.gantry.to_tool(axes)
    }

    #[inline]
    fn to_axes(&self, tool: &Values<N>) -> Result<Values<N>> {
        self.gantry.to_axes(tool)
    }

    #[inline]
    fn at_axes(&self, axes: &Values<N>) -> Result<(Values<N>, Self::Differential)> {
        self.gantry.at_axes(axes)
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Values<N>,
        near: &Values<N>,
    ) -> Result<(Values<N>, Self::Differential)> {
        self.gantry.at_tool(tool, near)
    }

    fn characteristic_length(&self) -> f64 {
        self.gantry.characteristic_length()
    }

    /// The tip counts from the end of the arm beside the axes.
    fn holding(self, tip: &Vector3<f64>) -> Self {
        let beside = self.beside.offset();
        let tip = tip + Vector3::new(beside.x, beside.y, 0.0);
        Self { gantry: self.gantry.holding(&tip), ..self }
    }
}
