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

use nalgebra::Vector2;

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
    /// Position of the tool, from the axes, m.
    pub fn offset(&self) -> Vector2<f64> {
        let (sin, cos) = (self.angle.sin(), self.angle.cos());
        Vector2::new(cos, sin) * self.ahead + Vector2::new(-sin, cos) * self.left
    }
}
