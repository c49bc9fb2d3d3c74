//! Tolerances no larger than what a shape can make use of.
//!
//! Shares of a tolerance are what a linear program looks for. Where it is a million times the cam's height, all that matters is
//! in the last digits of a share, and neither the solver nor points that are rounded to parts of their tolerance find it. A point
//! that goes beyond several times the height of the cam, or is as steep over the shorter piece beside it, makes nothing gentler.

use super::super::super::curve::Curve;
use super::super::super::error::CamError;
use super::super::super::knot::Knot;
use super::{Tolerance, Wish};

/// So many heights of the cam.
const HEIGHTS: f64 = 4.0;

/// The wish with tolerances that are of use.
pub(super) fn scaled(knots: &[Knot], wish: &Wish) -> Result<Wish, CamError> {
    let found = Curve::polynomial(knots)?.extremes().position;
    let [low, high] = wish.position;
    // What lies beyond the limits of the position has to come back, how far that is.
    let beyond = [low - found.min, found.max - high].into_iter().filter(|by| by.is_finite());
    let height = found.max - found.min + beyond.fold(0.0, f64::max);
    let most = HEIGHTS * height;
    let mut scaled = wish.clone();
    if !(most.is_finite() && most > 0.0) {
        return Ok(scaled);
    }
    let width = |from: usize| {
        let [from, to] = [knots.get(from)?, knots.get(from + 1)?];
        Some(to.master - from.master)
    };
    let last = knots.len().saturating_sub(2);
    for (index, (tolerance, knot)) in scaled.tolerances.iter_mut().zip(knots).enumerate() {
        // Behind the end comes the begin, and before the begin the end.
        let before = index.checked_sub(1).unwrap_or(last);
        let after = if index > last { 0 } else { index };
        let beside = [width(before), width(after)].into_iter().flatten();
        let width = beside.fold(f64::INFINITY, f64::min);
        let Tolerance { slave, velocity, acceleration } = *tolerance;
        *tolerance = Tolerance {
            slave: slave.min(most),
            velocity: velocity.min(knot.velocity.abs() + most / width),
            acceleration: acceleration.min(knot.acceleration.abs() + most / (width * width)),
        };
    }
    Ok(scaled)
}
