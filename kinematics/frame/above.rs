//! Directions seen from above through a tilted work frame: the map between the frame's angles and the machine's.

use nalgebra::{Matrix2, Matrix3, Rotation3, Vector2};
use std::f64::consts::TAU;

/// Squared length below which a direction seen from above is a point: it is vertical.
const UPRIGHT_2: f64 = 1e-24;

/// A map of directions: a linear map of the plane, taken to angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Above {
    /// Only turned.
    Turned {
        /// What direction 0 is seen as, rad.
        start: f64,
        /// 1, or −1 for a frame that is upside down.
        sense: f64,
    },
    /// Tilted.
    Tilted {
        /// Takes the vector of a direction to a vector in the direction that it is seen in.
        projection: Matrix2<f64>,
        /// With `sense`, the turn alone that the map follows: once in every half turn of the direction, and so after
        /// each half turn from there, the direction is seen as `start` + `sense`·direction. rad.
        start: f64,
        /// 1, or −1 for a frame that is upside down.
        sense: f64,
    },
}

impl Above {
    /// From the work frame to the machine frame.
    pub(super) fn new(rotation: &Rotation3<f64>) -> Self {
        let matrix: &Matrix3<f64> = rotation.matrix();
        // What is left of a horizontal vector seen from above, and where it shows the x axis.
        let projection = matrix.fixed_view::<2, 2>(0, 0).into_owned();
        let x = projection.column(0);
        let sense = if projection.determinant() < 0.0 { -1.0 } else { 1.0 };
        Self::Tilted { projection, start: x.y.atan2(x.x), sense }
    }

    /// The way back. A frame seen edge-on has none: there, a direction is taken to turn as far one way as the other.
    pub(super) fn inverse(&self) -> Self {
        match *self {
            Self::Turned { start, sense } => Self::Turned { start: -sense * start, sense },
            Self::Tilted { projection, start, sense } => {
                let determinant = projection.determinant();
                let start = -sense * start;
                if determinant * determinant < UPRIGHT_2 {
                    return Self::Turned { start, sense };
                }
                // The inverse times the size of the determinant, which no angle sees.
                let adjugate =
                    Matrix2::new(projection.m22, -projection.m12, -projection.m21, projection.m11);
                Self::Tilted { projection: sense * adjugate, start, sense }
            }
        }
    }

    /// The direction that `direction` is seen in (rad), and its first three derivatives by `direction`.
    pub(super) fn of(&self, direction: f64) -> [f64; 4] {
        let (projection, start, sense) = match *self {
            Self::Turned { start, sense } => return [start + sense * direction, sense, 0.0, 0.0],
            Self::Tilted { projection, start, sense } => (projection, start, sense),
        };
        // The map is linear, so half turns of the direction are seen as half turns: what is seen is never more than one
        // away from where `start` and `sense` alone would have it. This gives the turn it is in.
        let turned = start + sense * direction;
        let (sin, cos) = direction.sin_cos();
        let seen = projection * Vector2::new(cos, sin);
        let length_2 = seen.norm_squared();
        if length_2 < UPRIGHT_2 {
            return [turned, sense, 0.0, 0.0];
        }
        let angle = seen.y.atan2(seen.x);
        // The first derivative is the determinant by the squared length; p and q are the derivatives of the latter,
        // by the length itself. The second derivative of `seen` is −`seen`.
        let change = projection * Vector2::new(-sin, cos);
        let slope = projection.determinant() / length_2;
        let p = 2.0 * seen.dot(&change) / length_2;
        let q = 2.0 * (change.norm_squared() / length_2 - 1.0);
        let angle = angle + TAU * ((turned - angle) / TAU).round();
        [angle, slope, -slope * p, slope * (2.0 * p * p - q)]
    }
}
