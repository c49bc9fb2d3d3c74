//! Points with few digits: 71 instead of the solver's 70.99999999957.
//!
//! A change of a whole tolerance, or of none, is taken as such; others are rounded to a part of their tolerance, as coarsely as
//! everything that has to be kept allows with the rounded points.

use super::super::super::curve::Curve;
use super::super::super::file::clean;
use super::super::super::knot::Knot;
use super::Wish;

/// The slave may be so far from where it was at a tappet, as a part of how far it goes at all.
pub(super) const KEPT_AT_TAPPETS: f64 = 1e-9;
/// A change is the whole tolerance, or none, if it is within this part of it.
const WHOLE: f64 = 1e-7;
/// The most decimals of the tolerance that are tried.
const DECIMALS: i32 = 14;

/// The points as short as `keeps` lets them be; as they are found if it lets none. `old` are the points before.
pub(super) fn shortened(
    old: &[Knot],
    found: &[Knot],
    wish: &Wish,
    keeps: &dyn Fn(&[Knot]) -> bool,
) -> Vec<Knot> {
    let Ok(before) = Curve::polynomial(old) else { return found.to_vec() };
    let y = before.extremes().position;
    let off = |knots: &[Knot]| {
        let Ok(curve) = Curve::polynomial(knots) else { return f64::INFINITY };
        let off = |at: &f64| (curve.at(*at).position - before.at(*at).position).abs();
        wish.held.iter().map(off).fold(0.0, f64::max)
    };
    // The rounded points need not be better than the found ones.
    let room = off(found).max(KEPT_AT_TAPPETS * (y.max - y.min));
    let mut all = (0..=DECIMALS).map(|decimals| rounded(old, found, wish, decimals));
    all.find(|knots| off(knots) <= room && keeps(knots)).unwrap_or_else(|| found.to_vec())
}

/// Changes rounded to these decimals of their tolerances.
fn rounded(old: &[Knot], found: &[Knot], wish: &Wish, decimals: i32) -> Vec<Knot> {
    let pairs = old.iter().zip(found).zip(&wish.tolerances);
    let mut knots: Vec<Knot> = pairs
        .map(|((old, found), by)| Knot {
            slave: near(old.slave, found.slave, by.slave, decimals),
            velocity: near(old.velocity, found.velocity, by.velocity, decimals),
            acceleration: near(old.acceleration, found.acceleration, by.acceleration, decimals),
            ..*found
        })
        .collect();
    // The end changes with the begin.
    if let (true, [first, .., last], [begin, .., end]) = (wish.repeated, &mut knots[..], old) {
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
    let [low, high] = [old - tolerance, old + tolerance].map(clean);
    if share.abs() >= 1.0 - WHOLE {
        return if share > 0.0 { high } else { low };
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let unit = tolerance.log10().floor() as i32 - decimals;
    // The nearest multiple of a power of ten, as a decimal, without a minus before 0.
    let nearest = if unit > 0 {
        (found / 10_f64.powi(unit)).round() * 10_f64.powi(unit)
    } else {
        let decimals = usize::try_from(-unit).unwrap_or_default().min(300);
        format!("{found:.decimals$}").parse().unwrap_or(found)
    };
    (nearest + 0.0).clamp(low, high)
}
