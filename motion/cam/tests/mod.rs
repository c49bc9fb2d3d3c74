//! Tests of cams against closed forms and dense sampling.

#![expect(clippy::float_cmp, reason = "given, or exact in binary fractions")]

mod bounds;
mod by_program;
mod coupling;
mod curve;
mod files;
mod source;
mod tappet_starts;
mod tappets;

use super::{Curve, Knot};
use proptest::prelude::*;

/// Points of any cam, with widths that differ a thousandfold.
fn knots() -> impl Strategy<Value = Vec<Knot>> {
    let step = (-3.0..3.0_f64, -50.0..50.0_f64, -2.0..2.0_f64, -0.1..0.1_f64);
    (-500.0..500.0_f64, prop::collection::vec(step, 2..12)).prop_map(|(start, steps)| {
        let mut master = start;
        steps
            .into_iter()
            .map(|(power, slave, velocity, acceleration)| {
                master += 10.0_f64.powf(power / 2.0 + 0.5);
                Knot { master, slave, velocity, acceleration }
            })
            .collect()
    })
}

fn curve(knots: &[Knot]) -> Curve {
    Curve::polynomial(knots).expect("a curve")
}

/// Master positions all over the range, joints included.
fn samples(curve: &Curve, per_piece: u32) -> Vec<f64> {
    let joints: Vec<_> = curve.joints().collect();
    let between = joints.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (0..per_piece).map(move |i| from + (to - from) * f64::from(i) / f64::from(per_piece))
    });
    between.chain([curve.end()]).collect()
}
