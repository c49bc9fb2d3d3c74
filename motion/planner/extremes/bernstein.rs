//! Extremes of polynomials in Bernstein form, which lie within the hull of their coefficients.

/// Degree of an axis's velocity between two nodes; that of its position is one more.
const DEGREE: usize = 5;
/// Places are distinguished to this part of an interval.
const SMALLEST: f64 = 1e-9;

/// A polynomial over 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bernstein {
    coefficients: [f64; DEGREE + 2],
    degree: usize,
}

impl Bernstein {
    /// Of degree five, with these values and first and second derivatives at 0 and 1.
    pub(super) fn hermite([f0, d0, s0]: [f64; 3], [f1, d1, s1]: [f64; 3]) -> Self {
        let coefficients = [
            f0,
            f0 + d0 / 5.0,
            f0 + 2.0 * d0 / 5.0 + s0 / 20.0,
            f1 - 2.0 * d1 / 5.0 + s1 / 20.0,
            f1 - d1 / 5.0,
            f1,
            0.0,
        ];
        Self { coefficients, degree: DEGREE }
    }

    /// Its integral from 0 on, over an interval of this width.
    pub(super) fn integral(&self, width: f64) -> Self {
        let mut integral = Self { coefficients: [0.0; DEGREE + 2], degree: DEGREE + 1 };
        let mut sum = 0.0;
        for (slot, value) in integral.coefficients.iter_mut().skip(1).zip(&self.coefficients) {
            sum += value * width / 6.0;
            *slot = sum;
        }
        integral
    }

    /// Its derivative over an interval of this width.
    pub(super) fn derivative(&self, width: f64) -> Self {
        let mut derivative = *self;
        derivative.degree = self.degree - 1;
        #[expect(clippy::cast_precision_loss, reason = "a degree of five at most")]
        let factor = self.degree as f64 / width;
        for (slot, pair) in derivative.coefficients.iter_mut().zip(self.coefficients.windows(2)) {
            *slot = (pair[1] - pair[0]) * factor;
        }
        derivative
    }

    fn used(&self) -> &[f64] {
        &self.coefficients[..=self.degree]
    }

    /// Bounds over 0 to 1.
    pub(super) fn hull(&self) -> [f64; 2] {
        self.used().iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(*value), high.max(*value)]
        })
    }

    /// Values at 0 and 1.
    fn ends(&self) -> [f64; 2] {
        [self.coefficients[0], self.coefficients[self.degree]]
    }

    /// Both halves, by de Casteljau.
    fn halves(&self) -> [Self; 2] {
        let (mut first, mut second) = (*self, *self);
        let last = self.degree;
        for step in 1..=last {
            first.coefficients[step - 1] = second.coefficients[0];
            for index in 0..=last - step {
                second.coefficients[index] =
                    second.coefficients[index].midpoint(second.coefficients[index + 1]);
            }
            // What is left of the triangle is the second half, from its end.
        }
        first.coefficients[last] = second.coefficients[0];
        [first, second]
    }

    /// The largest value over 0 to 1 and its place, if it is above `floor`: exact to the part `tolerance` of it.
    pub(super) fn largest(&self, floor: f64, tolerance: f64) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        let mut left = vec![(*self, 0.0, 1.0)];
        while let Some((part, from, width)) = left.pop() {
            let least = best.map_or(floor, |(value, _)| value);
            let [_, high] = part.hull();
            let better = least + if best.is_some() { tolerance * high.abs() } else { 0.0 };
            if high <= better || high.is_nan() {
                continue;
            }
            for (value, at) in part.ends().into_iter().zip([from, from + width]) {
                if value > best.map_or(floor, |(value, _)| value) {
                    best = Some((value, at));
                }
            }
            if width > SMALLEST {
                let [first, second] = part.halves();
                let half = 0.5 * width;
                let [one, other] = [(first, from, half), (second, from + half, half)];
                // The better one first.
                let better = one.0.hull()[1] > other.0.hull()[1];
                left.extend(if better { [other, one] } else { [one, other] });
            }
        }
        best
    }

    pub(super) fn negative(mut self) -> Self {
        self.coefficients.iter_mut().for_each(|value| *value = -*value);
        self
    }
}
