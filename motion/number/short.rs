//! Short number format for messages.

use std::fmt;

/// A number in short form, as people write it: without the noise of binary fractions and of lengths converted from
/// metres, 6 instead of 5.999999999999999.
#[derive(Clone, Copy, Debug)]
pub struct Short(pub f64);

/// Magnitude from which decimals are left out.
const LARGE: f64 = 1e9;
/// Magnitude below which six decimals would not show the value.
const SMALL: f64 = 1e-3;

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        let magnitude = value.abs();
        if magnitude >= 1e15 || (magnitude > 0.0 && magnitude < 1e-9) {
            return write!(f, "{value:e}");
        }
        if magnitude >= LARGE {
            return write!(f, "{value}");
        }
        let scale = if magnitude < SMALL { 1e12 } else { 1e6 };
        // Plus zero, so that nothing is never minus nothing.
        write!(f, "{}", (value * scale).round() / scale + 0.0)
    }
}
