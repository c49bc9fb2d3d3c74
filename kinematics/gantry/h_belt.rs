//! H belt gantry: two fixed motors drive one belt around both axes (`SMC_TRAFO_GantryH2`, `SMC_TRAFOF_GantryH2`;
//! SoftMotion manual 8.2.3). Printers call it "Core XY", LinuxCNC `corexykins`.
//!
//! ```text
//!   A ◯═══════════◯         both drives the same way: y
//!     ║           ║         against each other:       x
//!     ◯────▣──────◯
//!     ║           ║         A = y' + x'     x = (A − B)/2 − offset X
//!   B ◯═══════════◯         B = y' − x'     y = (A + B)/2 − offset Y
//! ```
//!
//! Primed coordinates carry the offset: x' = x + offset X. Zero pose: with offsets 0 the tool tip is at the origin when
//! both drives are at 0. The layout of the belt decides signs and roles; a [`BeltLayout`] exchanges the coordinates,
//! the drives, or both. There are no branches, no singularities and no bound of reach. The flange keeps its attitude.
//!
//! Homing: at the reference, [`GantryH2::home`] computes the offsets that put the tool at the origin there.

use crate::error::{DimensionError, all_finite};
use crate::transform::{Linear, Serial, Transform};
use crate::{AxisDisc, AxisVector, Coordinate, Result, ToolDisc};
use nalgebra::{Matrix2, Vector2, Vector3};

/// Layout of the belt of an H gantry, relative to the manual's drawing. Both false: as drawn there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeltLayout {
    /// Both drives the same way move x instead of y: A = x' + y', B = x' − y'.
    pub coordinates_exchanged: bool,
    /// A and B change places.
    pub drives_exchanged: bool,
}

impl BeltLayout {
    /// Rows A and B, columns x and y: what the drives do per coordinate, 1 or −1.
    pub(crate) fn drives_by_coordinates(self) -> Matrix2<f64> {
        let mut matrix = Matrix2::new(1.0, 1.0, -1.0, 1.0);
        if self.coordinates_exchanged {
            matrix.swap_columns(0, 1);
        }
        if self.drives_exchanged {
            matrix.swap_rows(0, 1);
        }
        matrix
    }

    /// Rows x and y, columns A and B: what the coordinates do per drive, ½ or −½.
    pub fn coordinates_by_drives(self) -> Matrix2<f64> {
        // The matrix is √2 times an orthogonal one.
        self.drives_by_coordinates().transpose() * 0.5
    }
}

/// An H gantry with two drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GantryH2 {
    layout: BeltLayout,
    offsets: Vector2<f64>,
    tool: Vector2<f64>,
    belt: Linear<2>,
}

impl GantryH2 {
    /// An H gantry whose tool tip is at −`offsets` (m: `dOffsetX`, `dOffsetY`, added to the coordinates) with both drives at 0.
    ///
    /// # Errors
    /// [`DimensionError::NotFinite`].
    pub fn new(offsets: [f64; 2], layout: BeltLayout) -> Result<Self, DimensionError> {
        all_finite(&offsets)?;
        let belt = Linear {
            matrix: layout.coordinates_by_drives(),
            inverse: layout.drives_by_coordinates(),
        };
        Ok(Self { layout, offsets: offsets.into(), tool: Vector2::zeros(), belt })
    }

    /// The offsets that put the tool at the origin where the drives are at `axes` (m): the manual's way to home.
    ///
    /// # Errors
    /// [`DimensionError::NotFinite`].
    pub fn home(layout: BeltLayout, axes: [f64; 2]) -> Result<Self, DimensionError> {
        all_finite(&axes)?;
        let offsets = layout.coordinates_by_drives() * Vector2::from(axes);
        Self::new(offsets.into(), layout)
    }

    /// Layout of the belt.
    pub const fn layout(&self) -> BeltLayout {
        self.layout
    }

    /// Added to the coordinates before the belt, m.
    pub fn offsets(&self) -> [f64; 2] {
        self.offsets.into()
    }
}

impl Transform<2> for GantryH2 {
    type Differential = Serial<Linear<2>>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &[Coordinate::X, Coordinate::Y]
    }

    fn rotary(&self) -> [bool; 2] {
        [false; 2]
    }

    #[inline]
    fn to_tool(&self, axes: &Vector2<f64>) -> Result<Vector2<f64>> {
        Ok(self.belt.matrix * axes + (self.tool - self.offsets))
    }

    #[inline]
    fn to_axes(&self, tool: &Vector2<f64>) -> Result<Vector2<f64>> {
        Ok(self.belt.inverse * (tool + (self.offsets - self.tool)))
    }

    #[inline]
    fn at_axes(&self, axes: &Vector2<f64>) -> Result<(Vector2<f64>, Self::Differential)> {
        Ok((self.to_tool(axes)?, Serial(self.belt)))
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Vector2<f64>,
        _near: &Vector2<f64>,
    ) -> Result<(Vector2<f64>, Self::Differential)> {
        Ok((self.to_axes(tool)?, Serial(self.belt)))
    }

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let (radius, way) = (path.radius, path.way(path.radius));
        // Each drive goes as far as both coordinates together.
        let change = AxisVector::from_values([way.x + way.y; 2]);
        Some(AxisDisc { radius, change, is_even: path.is_even() })
    }

    fn characteristic_length(&self) -> f64 {
        super::CHARACTERISTIC_LENGTH
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        Self { tool: tip.xy(), ..self }
    }
}
