//! Cost: the duration to second order.
//!
//! With s = √c and S = sₖ + sₖ₊₁ the slope of a cell by bₖ is at c, and at most (its second derivatives are positive, so
//! that it is largest where all b are U, and U − c ≤ 0.6·c)
//!
//! ```text
//!   −h/(s·S²)     and     −h/(s·S²) + 0.6·h/S²·(0.5/s + 1/S + s′/(s·S)) = −0.1·h/(s·S²)
//! ```
//!
//! so that the cost falls in every x all over 0 ≤ x ≤ 1.

use crate::time_optimal::convex::Program;

/// The duration of a cell, 2h/(√b₀ + √b₁), to second order about c.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellCost {
    h: f64,
    sides: [Side; 2],
    cross: f64,
}

/// One end of it.
#[derive(Clone, Copy, Debug)]
struct Side {
    c: f64,
    slope: f64,
    bend: f64,
}

impl CellCost {
    pub(super) fn new(h: f64, c: [f64; 2]) -> Self {
        let [s0, s1] = c.map(f64::sqrt);
        let sum = s0 + s1;
        let [first, second] = slopes(h, c);
        let side = |c: f64, s: f64, slope: f64| Side {
            c,
            slope,
            bend: h / (sum * sum) * (0.5 / (s * s * s) + 1.0 / (s * s * sum)),
        };
        let sides = [side(c[0], s0, first), side(c[1], s1, second)];
        Self { h, sides, cross: h / (s0 * s1 * sum * sum * sum) }
    }

    /// Adds it to the cost of a program with b/`scales` as variables where there are such; other b are those of c.
    pub(super) fn add_to(
        &self,
        program: &mut Program,
        scales: [f64; 2],
        variables: [Option<usize>; 2],
    ) {
        let ([first, second], [from, to]) = (variables, self.sides);
        for (variable, other, own, beside, scale) in
            [(first, second, from, to, scales[0]), (second, first, to, from, scales[1])]
        {
            let Some(variable) = variable else { continue };
            let with = if other.is_some() { self.cross * beside.c } else { 0.0 };
            let linear = own.slope - own.bend * own.c - with;
            program.add_cost(variable, own.bend * scale * scale, linear * scale);
        }
        if let (Some(variable), Some(_)) = (first, second) {
            program.add_coupling(variable, self.cross * scales[0] * scales[1]);
        }
    }

    /// By how much less time a part more of the b of the variables saves here than the duration itself says at `b`, s.
    pub(super) fn astray(&self, b: [f64; 2], variables: [Option<usize>; 2]) -> f64 {
        let ([from, to], [here, next]) = (self.sides, b);
        let ([first, second], duration) = (variables, slopes(self.h, b));
        let off =
            |variable: Option<usize>, slope: f64, own: (Side, f64), other: (Side, f64, bool)| {
                if variable.is_none() || own.1 <= 0.0 {
                    return 0.0;
                }
                // What is given is what it was taken about, and may be 0.
                let with = if other.2 { self.cross * (other.1 - other.0.c) } else { 0.0 };
                (own.0.slope + own.0.bend * (own.1 - own.0.c) + with - slope).abs() * own.1
            };
        off(first, duration[0], (from, here), (to, next, second.is_some()))
            + off(second, duration[1], (to, next), (from, here, first.is_some()))
    }
}

/// The slopes of 2h/(√b₀ + √b₁).
fn slopes(h: f64, b: [f64; 2]) -> [f64; 2] {
    let [s0, s1] = b.map(f64::sqrt);
    let sum = s0 + s1;
    [-h / (s0 * sum * sum), -h / (s1 * sum * sum)]
}
