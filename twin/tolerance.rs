//! Limit comparison with a rounding tolerance, and detection of set-point jumps that have no velocity of their own.

/// A value may exceed its limit by this fraction before it counts: rounding, not motion.
pub(crate) const ROUNDING: f64 = 1e-9;

/// True if only the position difference of two cycles shows the velocity `stepped`. A jump of the set-point (G92, or
/// the direction of the tool at a corner) has no velocity of its own: neither of the `velocities` then is beyond
/// `most`, or the path rests at both ends.
pub(crate) fn is_hidden(stepped: f64, velocities: [f64; 2], at_rest: bool, most: f64) -> bool {
    let too_fast = velocities.into_iter().any(|velocity| exceeds(velocity, most));
    at_rest || (exceeds(stepped, most) && !too_fast)
}

/// True if `value` exceeds `limit` by more than rounding, or is NaN.
pub(crate) fn exceeds(value: f64, limit: f64) -> bool {
    value.is_nan() || value.abs() > limit * (1.0 + ROUNDING)
}

#[cfg(test)]
mod tests {
    use super::exceeds;

    #[test]
    fn nan_is_above_every_limit() {
        assert!(exceeds(f64::NAN, f64::INFINITY) && exceeds(-2.0, 1.0) && !exceeds(-1.0, 1.0));
    }
}
