//! Braking bound: the largest start velocity of a piece of path from which it can still brake.

use twin_path::prepare::CheckedElement;

/// Largest squared velocity at the start of a piece of path as a function of the one at its end:
/// `x ↦ min(cap, x + gain)`.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub(super) struct Braking {
    /// With every transition velocity kept.
    pub(super) cap_v2: f64,
    /// Braking over the whole piece.
    pub(super) gain_v2: f64,
    /// Largest squared velocity from which its stops, at least, can be kept: what counts when an override has been
    /// lowered and the path is too fast for everything else.
    pub(super) stop_v2: f64,
}

impl Braking {
    /// A piece of length zero.
    pub(super) const NONE: Self =
        Self { cap_v2: f64::INFINITY, gain_v2: 0.0, stop_v2: f64::INFINITY };

    /// Over `element`, which ends with at most `end_velocity`.
    pub(super) fn over(element: &CheckedElement, end_velocity: f64) -> Self {
        // Without a path there are no limits to multiply with.
        let gain_v2 = if element.has_path() {
            2.0 * element.deceleration * element.path_length()
        } else {
            0.0
        };
        let stop_v2 = if end_velocity > 0.0 { f64::INFINITY } else { gain_v2 };
        Self { cap_v2: end_velocity * end_velocity + gain_v2, gain_v2, stop_v2 }
    }

    /// This piece followed by `later`.
    pub(super) fn then(self, later: Self) -> Self {
        Self {
            cap_v2: self.cap_v2.min(later.cap_v2 + self.gain_v2),
            gain_v2: self.gain_v2 + later.gain_v2,
            stop_v2: self.stop_v2.min(later.stop_v2 + self.gain_v2),
        }
    }
}
