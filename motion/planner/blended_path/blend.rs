//! Blends: polynomials that replace the path near a joint.

use super::{BlendedPoint, Order};
use nalgebra::{Point3, SVector, Vector2};
use twin_path::{ExtraPoint, PathDisc};

/// Blend of a joint: a quintic in each coordinate and extra axis over the last [`Self::half_width`] metres of one
/// element and as many of the next. At both ends it has the position and the first two derivatives of the path it
/// replaces. With [`Order::Jerk`] it is a septic, and has the third as well.
///
/// Its parameter is the path length of the two elements, counted from the joint. Inside, its first derivative is no
/// unit vector: in the middle of a corner that turns by θ it is cos(θ/2).
///
/// Both halves are equally wide. For a corner of two lines the first derivative is then the mean of the two directions
/// weighted by 3w² − 2w³ (of a septic by 10w³ − 15w⁴ + 6w⁵), which runs from 0 to 1 without overshoot. Halves in a ratio beyond 2 : 3 would make it turn
/// back and forth, and even at that ratio, where the longer one is half as wide again, the largest second derivative is
/// only a twentieth smaller.
#[derive(Clone, Debug, PartialEq)]
pub struct Blend {
    half_width: f64,
    space: Hermite<3>,
    extra: Option<Hermite<5>>,
}

impl Blend {
    /// From the point `before` a joint to the point `after` it, each `half_width`, m, from it; none if that leads to
    /// what is not a number.
    pub(super) fn new(
        half_width: f64,
        joint: Point3<f64>,
        before: &BlendedPoint,
        after: &BlendedPoint,
        order: Order,
    ) -> Option<Self> {
        let scale = half_width;
        let ends = [before, after]
            .map(|end| [end.position - joint, end.first * scale, end.second * (scale * scale)]);
        let third = [before.third, after.third].map(|third| third * scale * scale * scale);
        let thirds = (order == Order::Jerk).then_some(third);
        let space = Hermite::between(joint.coords, ends, thirds)?;
        let extra = match (before.extra, after.extra) {
            (None, None) => None,
            // Before the first block that names an extra axis all are where that block finds them.
            (from, to) => {
                let from = from.or(to.map(resting)).unwrap_or_default();
                let to = to.unwrap_or(resting(from));
                let start = SVector::from(from.position);
                let ends = [from, to].map(|end| {
                    let [first, second] = [end.first, end.second].map(SVector::from);
                    [SVector::from(end.position) - start, first * scale, second * (scale * scale)]
                });
                let third = [from, to].map(|end| SVector::from(end.third) * scale * scale * scale);
                let thirds = (order == Order::Jerk).then_some(third);
                Some(Hermite::between(start, ends, thirds)?)
            }
        };
        Some(Self { half_width, space, extra })
    }

    /// Its reach to either side of the joint, m.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// Position and derivatives at `way` m from the joint, −[`Self::half_width`] to [`Self::half_width`]; what is
    /// beyond counts as the end.
    pub fn at(&self, way: f64) -> BlendedPoint {
        let x = (way / self.half_width).clamp(-1.0, 1.0);
        let [position, first, second, third] = self.space.at(x, self.half_width);
        let extra = self.extra.as_ref().map(|extra| {
            let [position, first, second, third] = extra.at(x, self.half_width).map(Into::into);
            ExtraPoint { position, first, second, third }
        });
        BlendedPoint { position: position.into(), first, second, third, extra }
    }

    /// The blend within twice its reach, as [`PathDisc`].
    pub(super) fn disc(&self) -> PathDisc {
        let scale = self.half_width * self.half_width;
        let mut extra_bend = [0.0; 5];
        if let Some(extra) = &self.extra {
            extra_bend = (extra.largest_second() / scale).into();
        }
        let bend = self.space.largest_second() / scale;
        PathDisc { radius: self.half_width, bend, extra_bend }
    }

    /// The fourth derivative of X and Y at `way` m from the joint, 1/m³.
    pub(super) fn fourth(&self, way: f64) -> Vector2<f64> {
        let x = (way / self.half_width).clamp(-1.0, 1.0);
        self.space.fourth(x, self.half_width).xy()
    }
}

/// Extra axes that stay where another element has them.
pub(super) fn resting(at: ExtraPoint) -> ExtraPoint {
    ExtraPoint { position: at.position, ..ExtraPoint::default() }
}

/// N polynomials of degree five, or seven, over −1 to 1.
#[derive(Clone, Debug, PartialEq)]
struct Hermite<const N: usize> {
    /// Where 0 is: positions far from the origin keep their digits.
    origin: SVector<f64, N>,
    coefficients: [SVector<f64, N>; 6],
    /// Those of x⁶ and x⁷.
    further: Option<[SVector<f64, N>; 2]>,
}

impl<const N: usize> Hermite<N> {
    /// With these positions (from `origin`), first and second derivatives at −1 and 1, and third ones, if any are given.
    ///
    /// Half the sum of the two ends is that of the even part e₀ + e₂x² + e₄x⁴ + e₆x⁶ and its second derivative, and of the
    /// odd part's first and third; half the difference that of the odd part o₁x + o₃x³ + o₅x⁵ + o₇x⁷ and its second
    /// derivative, and of the even part's first and third. That leaves three equations in three coefficients for each, or
    /// four in four.
    fn between(
        origin: SVector<f64, N>,
        [[p0, v0, a0], [p1, v1, a1]]: [[SVector<f64, N>; 3]; 2],
        thirds: Option<[SVector<f64, N>; 2]>,
    ) -> Option<Self> {
        let sum = |from: SVector<f64, N>, to: SVector<f64, N>| (from + to) * 0.5;
        let difference = |from: SVector<f64, N>, to: SVector<f64, N>| (to - from) * 0.5;
        let (even, even_first, even_second) = (sum(p0, p1), difference(v0, v1), sum(a0, a1));
        let (odd, odd_first, odd_second) = (difference(p0, p1), sum(v0, v1), difference(a0, a1));
        let mut e4 = (even_second - even_first) / 8.0;
        let mut o5 = (odd_second - odd_first * 3.0 + odd * 3.0) / 8.0;
        let further = thirds.map(|[j0, j1]| {
            let (even_third, odd_third) = (difference(j0, j1), sum(j0, j1));
            let e6 = (even_third - (even_second - even_first) * 3.0) / 48.0;
            let o7 = (odd_third - odd_second * 6.0 + (odd_first - odd) * 15.0) / 48.0;
            e4 -= e6 * 3.0;
            o5 -= o7 * 3.0;
            [e6, o7]
        });
        let [e6, o7] = further.unwrap_or([SVector::zeros(); 2]);
        let e2 = even_first * 0.5 - e4 * 2.0 - e6 * 3.0;
        let e0 = even - e2 - e4 - e6;
        let o3 = (odd_second - o5 * 20.0 - o7 * 42.0) / 6.0;
        let o1 = odd - o3 - o5 - o7;
        let coefficients = [e0, o1, e2, o3, e4, o5];
        let mut all = coefficients.iter().chain(further.iter().flatten()).flatten();
        let finite = all.all(|value| value.is_finite());
        finite.then_some(Self { origin, coefficients, further })
    }

    /// Position and three derivatives at `x`, of which 1 is `scale` of the parameter.
    fn at(&self, x: f64, scale: f64) -> [SVector<f64, N>; 4] {
        let [c0, c1, c2, c3, c4, c5] = self.coefficients;
        let mut position = c0 + (c1 + (c2 + (c3 + (c4 + c5 * x) * x) * x) * x) * x;
        let mut first = c1 + (c2 * 2.0 + (c3 * 3.0 + (c4 * 4.0 + c5 * (5.0 * x)) * x) * x) * x;
        let mut second = c2 * 2.0 + (c3 * 6.0 + (c4 * 12.0 + c5 * (20.0 * x)) * x) * x;
        let mut third = c3 * 6.0 + (c4 * 24.0 + c5 * (60.0 * x)) * x;
        if let Some([c6, c7]) = self.further {
            let cube = x * x * x;
            position += (c6 + c7 * x) * (cube * cube);
            first += (c6 * 6.0 + c7 * (7.0 * x)) * (cube * x * x);
            second += (c6 * 30.0 + c7 * (42.0 * x)) * (cube * x);
            third += (c6 * 120.0 + c7 * (210.0 * x)) * cube;
        }
        // Divided step by step: the cube of the scale is the first to be too small for a number.
        let second = second / scale / scale;
        let third = third / scale / scale / scale;
        [self.origin + position, first / scale, second, third]
    }

    /// No less than the second derivative for complex |x| ≤ 2.
    fn largest_second(&self) -> SVector<f64, N> {
        let [_, _, c2, c3, c4, c5] = self.coefficients.map(|c| c.abs());
        let [c6, c7] = self.further.unwrap_or([SVector::zeros(); 2]).map(|c| c.abs());
        c2 * 2.0 + c3 * 12.0 + c4 * 48.0 + c5 * 160.0 + c6 * 480.0 + c7 * 1_344.0
    }

    /// The fourth derivative, as [`Self::at`].
    fn fourth(&self, x: f64, scale: f64) -> SVector<f64, N> {
        let [_, _, _, _, c4, c5] = self.coefficients;
        let [c6, c7] = self.further.unwrap_or([SVector::zeros(); 2]);
        let fourth = c4 * 24.0 + (c5 * 120.0 + (c6 * 360.0 + c7 * (840.0 * x)) * x) * x;
        fourth / scale / scale / scale / scale
    }
}
