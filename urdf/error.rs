//! What is refused, and why.

/// Dimensions from which no machine can be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DimensionError {
    /// A length, a section or a mass.
    #[error("{what} is {value}; it must be a finite number above 0")]
    NotPositive {
        /// Which dimension.
        what: &'static str,
        /// Its value, m or kg.
        value: f64,
    },
    /// A measure that may be absent.
    #[error("{what} is {value}; it must be a finite number, 0 or above")]
    Negative {
        /// Which dimension.
        what: &'static str,
        /// Its value, m or kg.
        value: f64,
    },
    /// A limit or an offset.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// Which dimension.
        what: &'static str,
    },
    /// Position limits of which the lower is not below the upper.
    #[error(
        "joint {joint} can move from {lower} to {upper}; the lower limit must be below the upper one"
    )]
    Limits {
        /// The joint.
        joint: String,
        /// m or rad.
        lower: f64,
        /// m or rad.
        upper: f64,
    },
    /// Two joints with one name, or moved by one machine axis.
    #[error("joints {} and {} have the same name or the same machine axis", joints[0], joints[1])]
    JointTwice {
        /// Their names.
        joints: [String; 2],
    },
}
