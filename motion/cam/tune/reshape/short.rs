//! Points with as few digits as they need.
//!
//! What a linear program says ends in digits that mean nothing: 70.99999999957 for a point that goes as far as it may, to 71.
//! Changes that are whole tolerances, or none, but for that are taken for what they are, and the others are rounded to a part of
//! their tolerance, as coarsely as keeps everything that has to be kept, which is looked at with the points as they are rounded.

use super::super::super::curve::Curve;
use super::super::super::file::clean;
use super::super::super::knot::Knot;
use super::{KEPT_AT_TAPPETS, Wish};

/// A change is the whole tolerance, or none, if it is within this part of it.
const WHOLE: f64 = 1e-7;
/// Rounding is tried to so many decimals of the tolerance.
const DECIMALS: i32 = 14;

/// The points as short as `keeps` lets them be; as they are found if it lets none. `old` are the points before.
pub(super) fn shortened(
    old: &[Knot],
    found: &[Knot],
    wish: &Wish,
    keeps: &dyn Fn(&[Knot]) -> bool,
) -> Vec<Knot> {
    let Ok(before) = Curve::polynomial(old) else { return found.to_vec() };
    let height = before.extremes().position;
    let height = height.max - height.min;
    let off = |knots: &[Knot]| {
        let Ok(curve) = Curve::polynomial(knots) else { return f64::INFINITY };
        let off = |at: &f64| (curve.at(*at).position - before.at(*at).position).abs();
        wish.held.iter().map(off).fold(0.0, f64::max)
    };
    // What is found need not be better.
    let room = off(found).max(KEPT_AT_TAPPETS * height);
    let all = (0..=DECIMALS).map(|decimals| rounded(old, found, wish, decimals));
    all.into_iter()
        .find(|knots| off(knots) <= room && keeps(knots))
        .unwrap_or_else(|| found.to_vec())
}

/// Changes rounded to so many decimals of their tolerances.
fn rounded(old: &[Knot], found: &[Knot], wish: &Wish, decimals: i32) -> Vec<Knot> {
    let mut knots: Vec<Knot> = old
        .iter()
        .zip(found)
        .zip(&wish.tolerances)
        .map(|((old, found), tolerance)| Knot {
            slave: near(old.slave, found.slave, tolerance.slave, decimals),
            velocity: near(old.velocity, found.velocity, tolerance.velocity, decimals),
            acceleration: near(
                old.acceleration,
                found.acceleration,
                tolerance.acceleration,
                decimals,
            ),
            ..*found
        })
        .collect();
    // What is changed at the begin is changed at the end.
    if let (true, [first, .., last]) = (wish.repeated, knots.as_mut_slice())
        && let [begin, .., end] = old
    {
        let with = |begin: f64, end: f64, now: f64| {
            if begin.to_bits() == end.to_bits() { now } else { clean(end + (now - begin)) }
        };
        last.slave = with(begin.slave, end.slave, first.slave);
        last.velocity = with(begin.velocity, end.velocity, first.velocity);
        last.acceleration = with(begin.acceleration, end.acceleration, first.acceleration);
    }
    knots
}

/// A value that was `old` and is `found`, within its tolerance.
pub(in crate::tune) fn near(old: f64, found: f64, tolerance: f64, decimals: i32) -> f64 {
    let share = (found - old) / tolerance;
    if tolerance <= 0.0 || share.abs() <= WHOLE {
        return old;
    }
    let ends = [old - tolerance, old + tolerance].map(clean);
    if share.abs() >= 1.0 - WHOLE {
        return if share > 0.0 { ends[1] } else { ends[0] };
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let unit = tolerance.log10().floor() as i32 - decimals;
    let nearest = to_unit(found, unit);
    let [low, high] = ends;
    if (low..=high).contains(&nearest) { nearest } else { nearest.clamp(low, high) }
}

/// The nearest multiple of a power of ten, as a decimal.
fn to_unit(value: f64, exponent: i32) -> f64 {
    let short = if exponent > 0 {
        let unit = 10_f64.powi(exponent);
        (value / unit).round() * unit
    } else {
        let decimals = usize::try_from(-exponent).unwrap_or_default().min(300);
        format!("{value:.decimals$}").parse().unwrap_or(value)
    };
    // No minus before nothing.
    if short == 0.0 { 0.0 } else { short }
}
