//! The normalised outputs of the manual's `TRAFOF` blocks for gantries, which its visualisation templates show
//! (`SMC_VISU_Gantry2` and so on; SoftMotion manual 8.2.1 to 8.2.3).

use super::ToolBeside;
use nalgebra::Vector2;

/// Extent of the picture: `minX`, `maxX`, `minY`, `maxY`, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Left and right edge.
    pub x: [f64; 2],
    /// Lower and upper edge.
    pub y: [f64; 2],
}

/// The outputs for every gantry. All are parts of the picture's width or height; they are infinite or not numbers where the
/// picture has none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GantryView {
    /// The tool: `dnx`, `dny`, 0 at the lower left edge of the picture, 1 at the upper right.
    pub tool: [f64; 2],
    /// `dnOffsetX`, `dnOffsetY`.
    pub offset: [f64; 2],
    /// Width of the picture by its height: `ratio`.
    pub ratio: f64,
}

/// The outputs for gantries with a tool offset from their axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GantryToolView {
    /// The crossing of the axes.
    pub crossing: GantryView,
    /// `dnl` (Tool1) or `dnl1` and `dnl2` (Tool2): the two legs, as parts of the picture's width.
    pub legs: [f64; 2],
    /// The corner between the legs: `dntx`, `dnty`.
    pub corner: [f64; 2],
    /// The tool.
    pub tool: [f64; 2],
}

impl Range {
    fn width(&self) -> f64 {
        self.x[1] - self.x[0]
    }

    fn height(&self) -> f64 {
        self.y[1] - self.y[0]
    }

    fn normal(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.x[0]) / self.width(), (y - self.y[0]) / self.height()]
    }

    pub(super) fn view(&self, tool: [f64; 2], offset: [f64; 2]) -> GantryView {
        GantryView {
            tool: self.normal(tool),
            offset: [offset[0] / self.width(), offset[1] / self.height()],
            ratio: self.width() / self.height(),
        }
    }

    pub(super) fn tool_view(
        &self,
        crossing: Vector2<f64>,
        offset: [f64; 2],
        beside: &ToolBeside,
    ) -> GantryToolView {
        GantryToolView {
            crossing: self.view(crossing.into(), offset),
            legs: [beside.ahead / self.width(), beside.left / self.width()],
            corner: self.normal((crossing + beside.corner()).into()),
            tool: self.normal((crossing + beside.offset()).into()),
        }
    }
}
