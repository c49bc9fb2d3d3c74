//! Work frame: the frame of the path in the machine frame, in which G53, G28 and G30 have their positions.

use super::offsets::{Offsets, add, subtract};
use super::options::Position;
use nalgebra::Point3;
use std::array;

/// Coordinates that rounding alone changes keep their number, m.
const ROUNDING: f64 = 1e-12;

impl Offsets {
    /// The controlled point `point` (frame of the path, m) in the machine frame, m.
    pub(super) fn controlled_in_machine(&self, point: [f64; 3]) -> [f64; 3] {
        self.work_frame.map_or(point, |frame| frame.transform_point(&point.into()).into())
    }

    /// The position of the path after `from`, with the controlled point at `values` (m and degrees, machine frame). Axes of
    /// the machine without a value stay.
    pub(super) fn with_machine_axes(&self, from: &Position, values: [Option<f64>; 9]) -> Position {
        let tool = self.machine_frame();
        let (before, offset) = (from.axes(), tool.axes());
        let position = Position::from_axes(array::from_fn(|axis| {
            values[axis].map_or(before[axis], |value| value + offset[axis])
        }));
        let Some(frame) = &self.work_frame else { return position };
        let from = from.linear;
        let now = self.controlled_in_machine(subtract(from, tool.linear));
        let target: [f64; 3] = array::from_fn(|axis| values[axis].unwrap_or(now[axis]));
        let found = frame.inverse_transform_point(&Point3::from(target)).into();
        let found = add(found, tool.linear);
        let moves = |axis: usize| (found[axis] - from[axis]).abs() > ROUNDING;
        let linear = array::from_fn(|axis| if moves(axis) { found[axis] } else { from[axis] });
        Position { linear, ..position }
    }
}
