//! Errors of a machine whose axes do not fit its transform.

use crate::{Coordinate, MAX_AXES};

/// Axes that do not fit their transform.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MachineAxesError {
    /// More than [`MAX_AXES`].
    #[error("{0} axes given, a machine can have {MAX_AXES}")]
    TooMany(usize),
    /// An output that the transform does not have.
    #[error("output {output} of the transform is assigned to an axis, but the transform has {outputs}", output = output + 1)]
    NoSuchOutput {
        /// The output, from 0.
        output: usize,
        /// Number of outputs of the transform.
        outputs: usize,
    },
    /// An output of the transform that moves nothing.
    #[error("output {} of the transform moves no axis", .0 + 1)]
    OutputWithoutAxis(usize),
    /// One output, two axes.
    #[error("output {} of the transform is assigned to two axes", .0 + 1)]
    OutputTwice(usize),
    /// A coordinate that the transform turns into positions of its own axes, or one that no axis alone can move: the direction.
    #[error("{0} is assigned to an axis of its own, but only the transform can use it")]
    CoordinateOfTransform(Coordinate),
    /// One coordinate, two axes.
    #[error("{0} is assigned to two axes")]
    CoordinateTwice(Coordinate),
    /// One additional axis, two axes.
    #[error("additional axis {} is assigned to two axes", .0 + 1)]
    AdditionalTwice(u8),
    /// A tool that no axis can bring to z = 0.
    #[error("a tool {:.3} mm long needs an axis that moves Z", .0 * 1e3)]
    ToolWithoutZ(f64),
    /// The tip of the tool is infinite or not a number.
    #[error("the tip of the tool is not a finite number")]
    Tool,
    /// A period that is not a finite number above 0.
    #[error("axis {} has a period of {period}; it must be above 0", axis + 1)]
    Period {
        /// The axis, from 0.
        axis: usize,
        /// The period given, m or rad.
        period: f64,
    },
}
