//! Errors of the transforms: unreachable, singular or invalid poses, and invalid dimensions.

use crate::Coordinate;

/// What a transform gives: the answer, or why there is none.
pub type Result<T, E = KinematicsError> = std::result::Result<T, E>;

/// A pose or axis vector that a transform cannot convert. Numbers are SI; who shows them picks the unit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum KinematicsError {
    /// The target is farther from, or nearer to, a part of the machine than its arms or rods allow.
    #[error("({:.3}, {:.3}, {:.3}) mm {}", target[0] * 1e3, target[1] * 1e3, target[2] * 1e3,
        of.sentence(*distance, *reach))]
    Unreachable {
        /// Tool tip asked for, machine frame, m.
        target: [f64; 3],
        /// The part that does not reach.
        of: ReachOf,
        /// The distance at which the part would have to reach the target, m.
        distance: f64,
        /// Smallest and largest distance within reach, m.
        reach: [f64; 2],
    },
    /// The arms are stretched or folded, or rods are horizontal: no finite axis velocity gives the tool velocity.
    #[error("the machine is at an edge of its reach at ({:.3}, {:.3}, {:.3}) mm: the axes cannot follow",
        .0[0] * 1e3, .0[1] * 1e3, .0[2] * 1e3)]
    Singular([f64; 3]),
    /// The carriages of a tripod stand so far apart that its rods do not meet at the platform, or only where some of them
    /// would have to point up.
    #[error("carriages at {:.3}, {:.3} and {:.3} mm are so far apart that no platform hangs on all rods",
        .0[0] * 1e3, .0[1] * 1e3, .0[2] * 1e3)]
    Apart([f64; 3]),
    /// The program moves a coordinate for which the machine has no axis.
    #[error("{coordinate} = {:.3} mm is asked for, but no axis of the machine moves {coordinate}", value * 1e3)]
    NoAxis {
        /// The coordinate, a length.
        coordinate: Coordinate,
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
    /// An input is infinite or not a number.
    #[error("a coordinate or axis value is not a finite number")]
    NotFinite,
}

/// The part that does not reach a target, and the meaning of the distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReachOf {
    /// The arms of a SCARA: horizontal distance of the tool tip from the first arm's axis.
    Arms,
    /// The first two arms of a SCARA with three: horizontal distance of the axis of the third from that of the first.
    Wrist,
    /// A rod (or rod pair) of a tripod with the carriage of this number, from 0: horizontal distance of its ends; the
    /// reach is its length.
    Rod(usize),
    /// The rods of a calibrated tripod together: no pose of the platform fits them. The distance is how far the last one found
    /// is from fitting, the reach 0.
    Platform,
}

impl ReachOf {
    fn sentence(self, distance: f64, reach: [f64; 2]) -> String {
        let [distance, low, high] = [distance, reach[0], reach[1]].map(|value| value * 1e3);
        // As many digits as it takes to see that one is beyond the other.
        let beyond = (distance - low).abs().min((distance - high).abs());
        let digits = if beyond < 2e-3 { 6 } else { 3 };
        match self {
            Self::Arms => {
                format!(
                    "is {distance:.digits$} mm away, reach is {low:.digits$} to {high:.digits$} mm"
                )
            }
            Self::Wrist => format!(
                "with this direction needs the wrist {distance:.digits$} mm away, its reach is {low:.digits$} to {high:.digits$} mm"
            ),
            Self::Rod(carriage) => {
                let carriage = ["A", "B", "C"].get(carriage).copied().unwrap_or("?");
                format!(
                    "needs the rods of carriage {carriage} to span {distance:.digits$} mm sideways, they are {high:.digits$} mm long"
                )
            }
            Self::Platform => {
                format!(
                    "fits no pose of the platform: a rod would be {distance:.digits$} mm off its length"
                )
            }
        }
    }
}

/// Dimensions of which no machine can be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DimensionError {
    /// An arm without a length.
    #[error("arm {} is {:.3} mm long; it must be longer than 0{}", arm + 1, length * 1e3,
        if *arm == 2 { ", or 0" } else { "" })]
    ArmLength {
        /// Index of the arm, from 0.
        arm: usize,
        /// The length given, m.
        length: f64,
    },
    /// A rod without a length.
    #[error("rod {} is {:.3} mm long; it must be longer than 0", rod + 1, length * 1e3)]
    RodLength {
        /// Index of the rod, from 0.
        rod: usize,
        /// The length given, m.
        length: f64,
    },
    /// A ring on which the ends of a rod pair do not fit.
    #[error("a ring of radius {:.3} mm has no place for rods {:.3} mm apart", radius * 1e3, distance * 1e3)]
    Ring {
        /// Radius, m.
        radius: f64,
        /// Distance of the rods of a pair, m.
        distance: f64,
    },
    /// Rods that cannot carry the platform: it could move with the carriages at rest.
    #[error("these rods do not hold the platform: it could move with the carriages at rest")]
    Loose,
    /// Something infinite or not a number.
    #[error("a dimension is not a finite number")]
    NotFinite,
}

/// Err if a dimension is not finite.
pub(crate) fn all_finite<'a>(
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), DimensionError> {
    if values.into_iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(DimensionError::NotFinite)
    }
}
