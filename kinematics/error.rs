//! What a transform refuses, and why.

/// A pose or axis vector that a transform cannot convert. Numbers are SI; who shows them picks the unit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum KinematicsError {
    /// The target is farther from, or nearer to, the machine than its arms allow.
    #[error("({:.3}, {:.3}, {:.3}) mm is {:.6} mm away, reach is {:.6} to {:.6} mm",
        target[0] * 1e3, target[1] * 1e3, target[2] * 1e3, distance * 1e3, reach[0] * 1e3, reach[1] * 1e3)]
    Unreachable {
        /// Tool tip asked for, machine frame, m.
        target: [f64; 3],
        /// Its distance from where reach is measured (first arm's axis), m.
        distance: f64,
        /// Smallest and largest distance within reach, m.
        reach: [f64; 2],
    },
    /// The arms are stretched or folded: no finite axis velocity gives the tool velocity.
    #[error("the arms are stretched or folded at ({:.3}, {:.3}, {:.3}) mm: the axes cannot follow",
        target[0] * 1e3, target[1] * 1e3, target[2] * 1e3)]
    Singular {
        /// Tool tip, machine frame, m.
        target: [f64; 3],
    },
    /// The program moves a coordinate for which the machine has no axis.
    #[error("{coordinate} = {:.3} mm is asked for, but no axis of the machine moves {coordinate}", value * 1e3)]
    NoAxis {
        /// The coordinate.
        coordinate: crate::Coordinate,
        /// The value asked for, m.
        value: f64,
    },
    /// The number of axis values does not fit the transform.
    #[error("{given} axis values given, the machine has {expected} axes")]
    AxisCount {
        /// Values given.
        given: usize,
        /// Values expected.
        expected: usize,
    },
    /// An arm without a length.
    #[error("arm {} is {:.3} mm long; it must be longer than 0", arm + 1, length * 1e3)]
    ArmLength {
        /// Index of the arm, from 0.
        arm: usize,
        /// The length given, m.
        length: f64,
    },
    /// An input is infinite or not a number.
    #[error("a coordinate or axis value is not a finite number")]
    NotFinite,
}
