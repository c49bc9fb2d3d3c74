//! Pieces of a curve on the way of a master.

use super::super::curve::{Curve, CurveExtremes, Range};
use super::super::polynomial::{Coefficients, Extremes, extremes, shifted};

/// Extremes of a curve on the way of a master.
pub(super) fn extremes_along(curve: &Curve, from: f64, way: f64, repeated: bool) -> CurveExtremes {
    let mut found = [Extremes::NONE; 4];
    along(curve, from, way, repeated, &mut |polynomials, width, _| {
        for (found, c) in found.iter_mut().zip(polynomials) {
            found.join(&extremes(&c, width), 0.0);
        }
    });
    let [position, velocity, acceleration, jerk] = found.map(Range::from);
    CurveExtremes { position, velocity, acceleration, jerk }
}

/// Gives the stretches of pieces that a master passes, of one pass at most if it makes more: the polynomials from where a
/// stretch begins, how long it is with the sign of the way, and how far it begins from the start.
///
/// Backwards the polynomials are in the distance from where the stretch is entered.
pub(super) fn along(
    curve: &Curve,
    from: f64,
    way: f64,
    repeated: bool,
    visit: &mut dyn FnMut([Coefficients; 4], f64, f64),
) {
    let (sign, length) = (if way < 0.0 { -1.0 } else { 1.0 }, way.abs());
    let mut gone = 0.0;
    let (mut at, _) = if repeated { curve.wrap(from) } else { (from, 0.0) };
    // Each piece twice at most: its begin and its end may be in different passes.
    for _ in 0..2 * curve.pieces().len() + 2 {
        let inside = curve.contains(at);
        let last = curve.pieces().len().saturating_sub(1);
        let next = curve
            .pieces()
            .partition_point(|piece| if sign > 0.0 { piece.start <= at } else { piece.start < at });
        let piece = curve.pieces().get(next.max(1).min(last + 1) - 1);
        let Some(piece) = piece.filter(|_| inside) else { break };
        let left = if sign > 0.0 { piece.start + piece.width - at } else { at - piece.start };
        let width = left.min(length - gone).max(0.0);
        let here = piece.polynomials().map(|c| reversed(shifted(&c, at - piece.start), sign));
        visit(here, width, gone);
        gone += width;
        if gone >= length {
            return;
        }
        at = if sign > 0.0 { piece.start + piece.width } else { piece.start };
        if repeated && sign > 0.0 && at >= curve.end() {
            at = curve.start();
        } else if repeated && sign < 0.0 && at <= curve.start() {
            at = curve.end();
        } else if !repeated && (at >= curve.end() || at <= curve.start()) {
            break;
        }
    }
    if gone < length && !repeated {
        // Beyond its ends a cam is at rest.
        let rest = curve.at(at).position;
        let mut still = [[0.0; 7]; 4];
        let [position, ..] = &mut still;
        position[0] = rest;
        visit(still, length - gone, gone);
    }
}

/// The polynomial in the distance the other way.
fn reversed(c: Coefficients, sign: f64) -> Coefficients {
    let mut power = 1.0;
    c.map(|c| {
        let value = c * power;
        power *= sign;
        value
    })
}
