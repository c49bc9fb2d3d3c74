//! Extremes of a polynomial and a sine together: what a cam and a sigmoid ramp beside it reach.
//!
//! There is no closed form, but between two places a function exceeds the larger one of its values there by no more than the
//! largest curvature by an eighth of their distance's square. Stretches that cannot hold the extreme are left out, the
//! others are halved, until nothing is left to be gained but rounding.

use super::super::polynomial::{Coefficients, Extremes, extremes, value};

/// A sine beside a polynomial: `amplitude` · sin(`phase` + `angular` · u).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swing {
    pub(super) amplitude: f64,
    pub(super) phase: f64,
    pub(super) angular: f64,
}

/// Of the size of both together, what is left undecided.
const LEFT: f64 = 1e-12;
/// Halvings for one extreme. Where these are not enough what is told is beyond the extreme, never within.
const MOST: usize = 20_000;

impl Swing {
    /// Value of both together.
    pub(super) fn value(&self, c: &Coefficients, u: f64) -> f64 {
        value(c, u) + self.amplitude * (self.phase + self.angular * u).sin()
    }

    /// Least and greatest value of both together on [0, `width`].
    pub(super) fn extremes(&self, c: &Coefficients, width: f64) -> Extremes {
        if self.amplitude == 0.0 || self.angular == 0.0 {
            let mut of_both = *c;
            of_both[0] += self.amplitude * self.phase.sin();
            return extremes(&of_both, width);
        }
        let mut found = Extremes::NONE;
        let (at, most) = self.greatest(c, width);
        found.include(at, most);
        let mirrored = Self { amplitude: -self.amplitude, ..*self };
        let (at, most) = mirrored.greatest(&c.map(|c| -c), width);
        found.include(at, -most);
        found
    }

    fn greatest(&self, c: &Coefficients, width: f64) -> (f64, f64) {
        let size = c.iter().rev().fold(0.0, |sum, c| sum * width + c.abs()) + self.amplitude.abs();
        let ends = [(0.0, self.value(c, 0.0)), (width, self.value(c, width))];
        let mut best = if ends[0].1 >= ends[1].1 { ends[0] } else { ends[1] };
        let mut left = vec![ends];
        let mut halved = 0;
        while let Some([(from, at_from), (to, at_to)]) = left.pop() {
            let long = to - from;
            let beyond = at_from.max(at_to) + self.curvature(c, to) * long * long / 8.0;
            if beyond <= best.1 + LEFT * size {
                continue;
            }
            let middle = f64::midpoint(from, to);
            let at_middle = self.value(c, middle);
            halved += 1;
            if halved > MOST || middle <= from || middle >= to {
                best = (middle, best.1.max(beyond));
                continue;
            }
            if at_middle > best.1 {
                best = (middle, at_middle);
            }
            let halves =
                [[(from, at_from), (middle, at_middle)], [(middle, at_middle), (to, at_to)]];
            // The better half first: it is the sooner the best there is.
            let [one, other] = halves;
            if at_from > at_to { left.extend([other, one]) } else { left.extend([one, other]) }
        }
        best
    }

    /// What the second derivative does not exceed on [0, `to`].
    fn curvature(&self, c: &Coefficients, to: f64) -> f64 {
        let [_, _, c2, c3, c4, c5, c6] = c.map(f64::abs);
        let of_polynomial =
            2.0 * c2 + to * (6.0 * c3 + to * (12.0 * c4 + to * (20.0 * c5 + to * 30.0 * c6)));
        of_polynomial + self.amplitude.abs() * self.angular * self.angular
    }
}

#[cfg(test)]
mod tests {
    use super::Swing;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// u/2 + sin u is greatest where cos u = −1/2: at 2π/3, and least at 4π/3; on [0, 2π] that is π/3 + √3/2 and 2π/3 − √3/2.
    #[test]
    fn a_line_and_a_sine() {
        let swing = Swing { amplitude: 1.0, phase: 0.0, angular: 1.0 };
        let found = swing.extremes(&[1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], 5.0);
        let root = 3.0_f64.sqrt() / 2.0;
        assert!((found.max - (1.0 + PI / 3.0 + root)).abs() < 1e-11, "{found:?}");
        assert!((found.at_max - 2.0 * PI / 3.0).abs() < 1e-5, "{found:?}");
        // The begin is lower than the dip behind the top.
        assert!((found.min - 1.0).abs() < 1e-11 && found.at_min == 0.0, "{found:?}");
    }

    /// 3 u² − 2 u³ beside its own size as a sine of the other sign, against ten thousand places each.
    #[test]
    fn no_place_is_beyond() {
        for step in 0..200_u32 {
            let share = f64::from(step) / 200.0;
            let swing = Swing {
                amplitude: 2.0 * share - 1.0,
                phase: 7.0 * share,
                angular: 1.0 + 9.0 * share,
            };
            let c = [share, -1.0, 3.0, -2.0, share, -0.5, 0.25];
            let found = swing.extremes(&c, 1.5);
            let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
            for place in 0..=10_000 {
                let at = swing.value(&c, 1.5 * f64::from(place) / 10_000.0);
                (least, greatest) = (least.min(at), greatest.max(at));
            }
            assert!(
                least >= found.min - 1e-11 && greatest <= found.max + 1e-11,
                "{step}: {found:?}"
            );
            assert!(
                (least - found.min).abs() < 1e-6 && (greatest - found.max).abs() < 1e-6,
                "{step}"
            );
        }
        let still = Swing { amplitude: 2.0, phase: FRAC_PI_2, angular: 0.0 };
        assert!((still.extremes(&[1.0; 7].map(|c| c * 0.0), 3.0).max - 2.0).abs() < 1e-15);
    }
}
