//! Errors of the interpolators.

/// Error of an interpolator.
///
/// Of the manual's errors (9.3), 1002, 1004, 1006 and 1081 cannot occur, since only what
/// [`twin_path::prepare::CheckVelocities`] has seen can be planned with, and it decides the end velocities; 1005 and 1007
/// are internal to the original. 1003 is a state, not an error: [`super::Interpolator::starved`]; so is 1080:
/// [`super::Interpolator::limited`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum IpoError {
    /// `SMC_INT_VEL_ZERO` (1001): with this override nothing would move.
    #[error("the override {factor} is too small; the smallest is 0.01")]
    VelocityZero {
        /// The override asked for.
        factor: f64,
    },
    /// `SMC_INT2DIR_BUFFER_TOO_SMALL` (1050) and `SMC_INT2DIR_PATH_FITS_NOT_IN_QUEUE` (1051): to go both ways the
    /// whole path must be held.
    #[error("the path has more than the {capacity} elements that may be held to go backwards")]
    PathTooLong {
        /// Elements that may be held.
        capacity: usize,
    },
}

impl IpoError {
    /// The manual's number of it.
    pub const fn number(self) -> u16 {
        match self {
            Self::VelocityZero { .. } => 1001,
            Self::PathTooLong { .. } => 1051,
        }
    }
}
