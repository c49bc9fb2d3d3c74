//! Errors of tool radius correction.

use crate::Marks;
use crate::Place;
use crate::units::mm;
use std::fmt;

/// Side of the contour on which the tool is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// To the left of the direction of motion (G41).
    Left,
    /// To the right (G42).
    Right,
}

impl Side {
    /// The side that a mark asks for.
    pub(super) fn of(marks: Marks) -> Option<Self> {
        if marks.contains(Marks::CORRECTION_LEFT) {
            Some(Self::Left)
        } else if marks.contains(Marks::CORRECTION_RIGHT) {
            Some(Self::Right)
        } else {
            None
        }
    }

    /// 1 to the left, −1 to the right.
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// Reason why a path cannot be offset by the tool's radius.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ToolRadiusError {
    /// The other side was asked for without an end in between.
    #[error(
        "{place}: tool radius correction to the {to} begins before that to the {from} has ended"
    )]
    SideChange {
        /// The block.
        place: Place,
        /// The side up to here.
        from: Side,
        /// The side asked for.
        to: Side,
    },
    /// The radius changes while the path is corrected.
    #[error(
        "{place}: the tool radius changes from {} mm to {} mm within tool radius correction; end it with G40 before",
        mm(*from),
        mm(*to)
    )]
    RadiusChange {
        /// The block.
        place: Place,
        /// The radius up to here, m.
        from: f64,
        /// The new one, m.
        to: f64,
    },
    /// The radius is negative or no number.
    #[error("{place}: a path cannot be corrected by a tool radius of {} mm", mm(*radius))]
    Radius {
        /// The block.
        place: Place,
        /// The radius, m.
        radius: f64,
    },
    /// A probing move, whose way is where the probe itself goes.
    #[error("{0}: a probing move cannot be corrected by the tool radius")]
    Probe(Place),
    /// An arc in another plane than that of X and Y.
    #[error("{0}: tool radius correction is in X and Y, the arc is in another plane")]
    Plane(Place),
}

impl ToolRadiusError {
    /// The block it is about.
    pub const fn place(&self) -> Place {
        match self {
            Self::SideChange { place, .. }
            | Self::RadiusChange { place, .. }
            | Self::Radius { place, .. }
            | Self::Probe(place)
            | Self::Plane(place) => *place,
        }
    }
}
