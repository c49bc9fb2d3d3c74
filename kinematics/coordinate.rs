//! Coordinates of a tool pose: x, y, z and the direction about the vertical.

use crate::Pose;
use nalgebra::Vector3;
use std::fmt;

/// A coordinate of the tool: where its tip is, and which way it points about the vertical.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coordinate {
    /// Along +x, m.
    X,
    /// Along +y, m.
    Y,
    /// Along +z, m.
    Z,
    /// About +z, rad ([`Pose::direction`]).
    Direction,
}

impl Coordinate {
    /// All of them, in order.
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Direction];

    /// Those that are lengths.
    pub(crate) const TRANSLATIONS: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its place in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Its value in a pose.
    pub(crate) fn of_pose(self, pose: &Pose) -> f64 {
        self.of(&pose.position.coords, pose.direction)
    }

    /// Its value among coordinates of the tip, or their derivatives, and of the direction.
    pub(crate) fn of(self, tip: &Vector3<f64>, direction: f64) -> f64 {
        match self {
            Self::X => tip.x,
            Self::Y => tip.y,
            Self::Z => tip.z,
            Self::Direction => direction,
        }
    }

    pub(crate) fn of_mut<'a>(
        self,
        tip: &'a mut Vector3<f64>,
        direction: &'a mut f64,
    ) -> &'a mut f64 {
        match self {
            Self::X => &mut tip.x,
            Self::Y => &mut tip.y,
            Self::Z => &mut tip.z,
            Self::Direction => direction,
        }
    }
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "X",
            Self::Y => "Y",
            Self::Z => "Z",
            Self::Direction => "direction",
        })
    }
}
