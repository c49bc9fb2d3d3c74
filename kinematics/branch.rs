//! Branches (solutions) of an inverse transform, and the margins of a pose to the other solutions and to the reach.

use std::fmt;

/// Branch of a transform: the solution that it gives when several axis positions lead to one pose. It is part of the
/// transform's value: no call changes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// There is one solution only.
    Only,
    /// The elbow of a SCARA bends counter-clockwise, β ≥ 0 (`bElbowLow`).
    ElbowLow,
    /// The elbow of a SCARA bends clockwise, β ≤ 0.
    ElbowHigh,
    /// The rods of a tripod point down from their carriages. A real one cannot leave this branch: the carriages would
    /// have to pass the platform.
    PlatformBelow,
}

impl fmt::Display for Branch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Only => "only one",
            Self::ElbowLow => "elbow low",
            Self::ElbowHigh => "elbow high",
            Self::PlatformBelow => "platform below the carriages",
        })
    }
}

/// Distances of a pose from the edge of the reach and from the place where two solutions meet, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// To the edge of what the mechanism reaches (arms stretched or folded, tripod rods horizontal), software limits
    /// aside: how far the tool tip can go in the worst direction. Negative: so far outside. Infinite where there is no
    /// edge.
    pub boundary: f64,
    /// To where two solutions meet and the mechanism loses its stiffness: for a tripod the height of the plane through
    /// the three points about which its rod pairs turn above the platform's reference point (there the forward transform has its
    /// two solutions); for a SCARA, whose elbows meet at the edge of reach, the same as [`Self::boundary`]. Infinite
    /// where there is one solution only.
    pub branch: f64,
}

impl Margins {
    /// Of a mechanism without edges and with one solution.
    pub const UNBOUNDED: Self = Self { boundary: f64::INFINITY, branch: f64::INFINITY };
}
