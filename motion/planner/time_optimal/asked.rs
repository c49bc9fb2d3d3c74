//! Set of limits whose rows are always in a convex program, even if they seem inactive.

use super::bound::Constraint;
use super::convex::Origin;

/// A set of the limits of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Asked(u64);

impl Asked {
    /// All of them.
    pub(super) const ALL: Self = Self(u64::MAX);

    /// Adds the limit that a row comes from.
    pub(super) fn add(&mut self, origin: &Origin) {
        self.0 |= bit(origin);
    }

    /// True if the limit that a row comes from is in it.
    pub(super) fn has(self, origin: &Origin) -> bool {
        self.0 & bit(origin) != 0
    }
}

/// Sixteen bits for each kind: two signs of up to eight axes. Those with more share theirs, which costs rows and nothing else.
fn bit(origin: &Origin) -> u64 {
    let (kind, number) = match origin.constraint {
        Constraint::AxisAcceleration(axis) => (0, 2 * (axis % 8) + u8::from(origin.upper)),
        Constraint::AxisJerk(axis) => (1, 2 * (axis % 8) + u8::from(origin.upper)),
        Constraint::Further(index) => (2, index),
        Constraint::Velocity(_) | Constraint::ToolAcceleration => (3, 0),
    };
    1 << (16 * kind + number % 16)
}
