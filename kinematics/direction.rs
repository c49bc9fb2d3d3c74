//! Direction of a tool that follows its path (SoftMotion manual 8.2.2).

use nalgebra::{Complex, Vector2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Orientation of a tool relative to its path (`SMC_VECTORDIR`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToPath {
    /// Along the path (`SMC_tangential`).
    #[default]
    Tangential,
    /// Against the path (`SMC_opp_tangential`).
    Opposite,
    /// To the right of the path (`SMC_orthogonal_r`).
    Right,
    /// To the left of the path (`SMC_orthogonal_l`).
    Left,
}

impl ToPath {
    /// Angle added to the direction of the path, rad.
    pub const fn offset(self) -> f64 {
        match self {
            Self::Tangential => 0.0,
            Self::Opposite => PI,
            Self::Right => -FRAC_PI_2,
            Self::Left => FRAC_PI_2,
        }
    }

    /// `SMC_CalcDirectionFromVector`: the direction of a tool on a path along `vector` (x and y of a tangent or
    /// velocity, of any length), rad about +z, 0 = +x, in [0, 2π).
    ///
    /// None for (0, 0), where the path rests or goes straight up or down: the caller keeps the last direction.
    pub fn direction(self, vector: Vector2<f64>) -> Option<f64> {
        if vector == Vector2::zeros() {
            return None;
        }
        let (x, y) = (vector.x, vector.y);
        // Quarter turns of the vector are exact, those of an angle are not.
        let (x, y) = match self {
            Self::Tangential => (x, y),
            Self::Opposite => (-x, -y),
            Self::Right => (y, -x),
            Self::Left => (-y, x),
        };
        let angle = y.atan2(x);
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        // A whole turn less something too small for the sum is 0, not a whole turn; so is −0.
        Some(if angle >= TAU { 0.0 } else { angle + 0.0 })
    }
}

/// First, second and third derivative (rad/s, rad/s², rad/s³) of atan2(y, x) of `vector`, of which `derivatives` are
/// the first, second and third derivative by time. None for (0, 0).
///
/// The k-th depends on the first k derivatives only: a caller who does not have them all gives 0 for the others and
/// ignores what follows. Any vector along the path will do, of any changing length. Where the path comes to rest a
/// velocity loses digits, since it gets short while its derivatives do not; the unit tangent and its derivatives lose
/// none.
///
/// The derivatives are the imaginary parts of those of the logarithm of x + iy = v:
/// v′/v, v″/v − (v′/v)², v‴/v − 3·v″/v·v′/v + 2·(v′/v)³.
pub fn direction_rates(vector: Vector2<f64>, derivatives: [Vector2<f64>; 3]) -> Option<[f64; 3]> {
    if vector == Vector2::zeros() {
        return None;
    }
    // By the length first: its square may be too small or too large for a number.
    let length = vector.x.hypot(vector.y);
    let back = Complex::new(vector.x / length, -vector.y / length);
    let [first, second, third] =
        derivatives.map(|value| Complex::new(value.x / length, value.y / length) * back);
    let square = first * first;
    let acceleration = second - square;
    let jerk = third - second * first * 3.0 + square * first * 2.0;
    Some([first.im, acceleration.im, jerk.im])
}
