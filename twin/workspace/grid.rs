//! Grid of sample points over a section of the workspace.

use nalgebra::{Point2, Vector2};

/// Nodes in a plane, one cell apart in both directions; node 0, 0 is at `min`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The first node, m.
    pub min: Point2<f64>,
    /// Distance of neighbours, m.
    pub cell: f64,
    /// Cells along the first direction.
    pub columns: u32,
    /// Cells along the second direction.
    pub rows: u32,
}

impl Grid {
    /// Square cells over a rectangle, `longer` of them along its longer side; the rectangle grows to whole cells.
    pub fn over(min: Point2<f64>, max: Point2<f64>, longer: u32) -> Self {
        let sides = max - min;
        let cell = sides.max() / f64::from(longer.max(1));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 1 and `longer`"
        )]
        let count = |side: f64| (side / cell - 1e-9).ceil().clamp(1.0, f64::from(longer)) as u32;
        let (columns, rows) = (count(sides.x), count(sides.y));
        let grown = Vector2::new(f64::from(columns), f64::from(rows)) * cell;
        Self { min: min - (grown - sides) / 2.0, cell, columns, rows }
    }

    /// The node farthest from [`Self::min`].
    pub fn max(&self) -> Point2<f64> {
        self.node(self.columns, self.rows)
    }

    /// A node.
    pub fn node(&self, column: u32, row: u32) -> Point2<f64> {
        self.min + Vector2::new(f64::from(column), f64::from(row)) * self.cell
    }

    /// All nodes with their places, row by row.
    pub fn nodes(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let columns = self.columns;
        (0..=self.rows).flat_map(move |row| (0..=columns).map(move |column| (column, row)))
    }

    /// Place of a node in the order of [`Self::nodes`].
    pub fn index(&self, column: u32, row: u32) -> usize {
        let index = u64::from(row) * (u64::from(self.columns) + 1) + u64::from(column);
        usize::try_from(index).unwrap_or(usize::MAX)
    }
}
