//! Extremes of a polynomial and a sine together: what a cam and a sigmoid ramp beside it reach.
//!
//! There is no closed form, but about its middle a stretch is a parabola, but for no more than the largest third derivative by a
//! sixth of half its length, cubed. Stretches that cannot hold the extreme are left out. Where both together only grow, only
//! fall, or are bent upwards, an end is greatest; where they are bent downwards there is one place, which Newton's steps
//! find. What is none of these is halved.

use super::super::polynomial::{Coefficients, Extremes, extremes, shifted, value};

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
/// Newton's steps, at most, for a place that is known to within a part of its stretch.
const STEPS: usize = 60;
const NEAR: f64 = 1e-9;

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
        let mut best = (0.0, f64::NEG_INFINITY);
        let include = |best: &mut (f64, f64), u: f64| {
            let at = self.value(c, u);
            if at > best.1 {
                *best = (u, at);
            }
        };
        include(&mut best, 0.0);
        include(&mut best, width);
        let half = width / 2.0;
        let mut left = vec![Stretch { middle: half, half, c: shifted(c, half) }];
        let mut halved = 0;
        while let Some(stretch) = left.pop() {
            let Stretch { middle, half, .. } = stretch;
            let Bent { value, slope, bend, rate } = self.bent(&stretch);
            let rest = rate * half * half * half / 6.0;
            let top = if bend < 0.0 && slope.abs() <= -bend * half {
                value - slope * slope / (2.0 * bend)
            } else {
                value + slope.abs() * half + bend * half * half / 2.0
            };
            if top + rest <= best.1 + LEFT * size {
                continue;
            }
            let turn = rate * half;
            let monotone = slope.abs() >= (bend.abs() + turn / 2.0) * half;
            if monotone || bend >= turn {
                include(&mut best, middle - half);
                include(&mut best, middle + half);
            } else if bend <= -turn {
                include(&mut best, self.top(c, [middle - half, middle + half]));
            } else if halved > MOST || middle - half >= middle {
                best = (middle, best.1.max(top + rest));
            } else {
                halved += 1;
                let half = half / 2.0;
                let part =
                    |by: f64| Stretch { middle: middle + by, half, c: shifted(&stretch.c, by) };
                // The better half first: it is the sooner the best there is.
                let by = if slope > 0.0 { half } else { -half };
                left.extend([part(-by), part(by)]);
            }
        }
        best
    }

    /// How both together are bent about the middle of a stretch.
    fn bent(&self, Stretch { middle, half, c }: &Stretch) -> Bent {
        let (sin, cos) = (self.phase + self.angular * middle).sin_cos();
        let [sin, cos] = [sin, cos].map(|by| self.amplitude * by);
        let angular = self.angular;
        let [c0, c1, c2, c3, c4, c5, c6] = *c;
        let third = 6.0 * c3.abs()
            + half * (24.0 * c4.abs() + half * (60.0 * c5.abs() + half * 120.0 * c6.abs()));
        Bent {
            value: c0 + sin,
            slope: c1 + angular * cos,
            bend: 2.0 * c2 - angular * angular * sin,
            rate: third + self.amplitude.abs() * angular.abs().powi(3),
        }
    }

    /// Where a stretch that is bent downwards is greatest.
    fn top(&self, c: &Coefficients, [from, to]: [f64; 2]) -> f64 {
        let (mut low, mut high) = (from, to);
        let mut u = f64::midpoint(from, to);
        for _ in 0..STEPS {
            let here = Stretch { middle: u, half: 0.0, c: shifted(c, u) };
            let Bent { slope, bend, .. } = self.bent(&here);
            if slope > 0.0 {
                low = u;
            } else {
                high = u;
            }
            let newton = u - slope / bend;
            let next =
                if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
            // The value is off by the square of that.
            if (next - u).abs() <= NEAR * (to - from) {
                return next;
            }
            u = next;
        }
        u
    }
}

/// A stretch, and the polynomial counted from its middle on.
struct Stretch {
    middle: f64,
    half: f64,
    c: Coefficients,
}

/// Value and derivatives in the middle of a stretch, and what the third one does not exceed in all of it.
struct Bent {
    value: f64,
    slope: f64,
    bend: f64,
    rate: f64,
}
