//! Axis vectors: one value per axis in a fixed-size array, without allocation.

use std::fmt;
use std::ops::{Deref, DerefMut};

/// The largest number of axes a machine can have.
pub const MAX_AXES: usize = 8;

/// One value per axis (positions in m or rad, or their derivatives), in the order of the transform or, for a whole
/// machine, of the machine file. Dereferences to a slice.
#[derive(Clone, Copy, PartialEq)]
pub struct AxisVector {
    values: [f64; MAX_AXES],
    len: usize,
}

impl AxisVector {
    /// `len` zeros; more than [`MAX_AXES`] are cut to that number.
    #[inline]
    pub const fn zeros(len: usize) -> Self {
        Self { values: [0.0; MAX_AXES], len: if len < MAX_AXES { len } else { MAX_AXES } }
    }

    /// The values of an iterator; what exceeds [`MAX_AXES`] is left out.
    #[inline]
    pub fn from_values(values: impl IntoIterator<Item = f64>) -> Self {
        let mut result = Self::zeros(0);
        for (slot, value) in result.values.iter_mut().zip(values) {
            *slot = value;
            result.len += 1;
        }
        result
    }

    /// True if every value is finite.
    pub fn is_finite(&self) -> bool {
        self.iter().all(|value| value.is_finite())
    }
}

impl Deref for AxisVector {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        self.values.get(..self.len).unwrap_or_default()
    }
}

impl DerefMut for AxisVector {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        self.values.get_mut(..self.len).unwrap_or_default()
    }
}

impl fmt::Debug for AxisVector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// Position, velocity and acceleration of every axis at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisMotion {
    /// m or rad.
    pub position: AxisVector,
    /// m/s or rad/s.
    pub velocity: AxisVector,
    /// m/s² or rad/s².
    pub acceleration: AxisVector,
}

impl AxisMotion {
    /// At rest at `position`.
    pub fn at_rest(position: AxisVector) -> Self {
        let zero = AxisVector::zeros(position.len());
        Self { position, velocity: zero, acceleration: zero }
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite() && self.acceleration.is_finite()
    }
}
