//! Errors of dimensions from which no machine can be generated.

/// Dimensions from which no machine can be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DimensionError {
    /// A length, a section or a mass.
    #[error("{what} is {value}; it must be a finite number above 0")]
    NotPositive {
        /// The dimension.
        what: &'static str,
        /// Its value, m or kg.
        value: f64,
    },
    /// A measure that may be absent.
    #[error("{what} is {value}; it must be a finite number, 0 or above")]
    Negative {
        /// The dimension.
        what: &'static str,
        /// Its value, m or kg.
        value: f64,
    },
    /// A limit or an offset.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// The dimension.
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
    /// A rod of a tripod that is shorter than what it has to bridge.
    #[error(
        "rod {} of {:.3} mm is too short for its joints and the {:.3} mm between its ends as seen from above",
        rod + 1, length * 1e3, reach * 1e3
    )]
    Rod {
        /// Its number, from 0.
        rod: usize,
        /// Its length, m.
        length: f64,
        /// Between its ends with the platform in the middle, as seen from above, m.
        reach: f64,
    },
    /// Rods of a tripod that are not two for each carriage.
    #[error("the rods hang on the carriages {0:?}; each of 0, 1 and 2 has two of them")]
    RodsOfCarriages([usize; 6]),
    /// Rods of a tripod that do not meet their platform.
    #[error(
        "the rods do not meet the platform with every axis in the middle of its travel; {:.6} mm are left open",
        .0 * 1e3
    )]
    RodsApart(f64),
    /// A belt that does not lead from two motors to two coordinates.
    #[error("the factors {0:?} of the belt are not ±0.5 each, or both coordinates move alike")]
    Belt([[f64; 2]; 2]),
    /// Two joints with one name, or moved by one machine axis.
    #[error("joints {} and {} have the same name or the same machine axis", .0[0], .0[1])]
    JointTwice([String; 2]),
}
