//! Work frame of a cuboid, from six probed points (`SMC_DetermineCuboidBearing`, SoftMotion manual 8.3).

use super::UnitVectors;
use nalgebra::{Point3, Vector3};

/// Lengths below this part of the distance between the probed points count as 0.
///
/// No probe repeats to a millionth of the workpiece it touches, so a shorter length does not locate it.
const DEGENERATE: f64 = 1e-6;

/// Points may lie on the wrong side of a face by this part of the distance between them: faces are not quite square.
const UNEVEN: f64 = 1e-2;

/// Points that do not say how a cuboid lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CuboidError {
    /// The three points of face A lie on a straight line (or two of them at the same place).
    #[error("the three points of face A lie on a straight line")]
    Collinear,
    /// The two points of face B are at the same place seen at right angles to face A.
    #[error("the two points of face B have the same projection on face A")]
    SameProjection,
    /// The points of the other faces all lie on an edge, so they do not say which way the face goes on from there.
    #[error(
        "the points of the other faces lie in the plane of face {face}, so the side of the cuboid is unknown; probe one of them farther from that plane"
    )]
    NoSide {
        /// A, B or C.
        face: char,
    },
    /// Points of the other faces on both sides of one: no cuboid has them. One was touched elsewhere than it should have
    /// been.
    #[error(
        "points of the other faces lie on both sides of face {face}: one of them was probed on another face than it says"
    )]
    BothSides {
        /// A, B or C.
        face: char,
    },
    /// A coordinate of a point or of the corner, or a difference of two, is not a finite number.
    #[error("a coordinate of a probed point is not a finite number, or too large")]
    NotFinite,
}

impl CuboidError {
    /// `nError` of `SMC_DetermineCuboidBearing`, for the two errors that it knows.
    pub const fn error_number(&self) -> Option<u16> {
        match self {
            Self::Collinear => Some(1),
            Self::SameProjection => Some(2),
            Self::NoSide { .. } | Self::BothSides { .. } | Self::NotFinite => None,
        }
    }
}

/// Corner and edge directions of a cuboid (`SMC_DetermineCuboidBearing`), from three points on one of its faces, two on
/// another and one on a third.
///
/// The three faces meet in the corner. An edge has the letters of the two faces that it is part of, and points from
/// the corner along the cuboid. The work frame ([`WorkFrame::from_cuboid`](crate::WorkFrame::from_cuboid),
/// [`Self::unit_vectors`]) has its origin in the corner, z out of the material through face A, x along the edge AB, and
/// y = z × x:
///
/// ```text
///          z     CA = y
///          │    ╱
///          │   ╱      A
///          │  ╱
///          │ ╱
///          ●──────────────── AB = x     ●  corner, origin
///         ╱│                            A  the top, probed three times
///        ╱ │                            B  the side towards you, probed twice
///      C   │          B                 C  the side on your left, probed once
///          │
///          BC = −z
/// ```
///
/// With C on the left of someone in front of B with A on top, y is the edge CA and the work lies at x ≥ 0, y ≥ 0,
/// z ≤ 0. With C on the right, x still goes along the work, which is to the left then, and y comes out of face B
/// against CA: the work lies at y ≤ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    corner: Point3<f64>,
    ab: Vector3<f64>,
    bc: Vector3<f64>,
    ca: Vector3<f64>,
}

impl Cuboid {
    /// The cuboid with the points `a` on its face A, `b` on B and `c` on C (m, any frame; the result is in the same).
    ///
    /// Face A lies in the plane of its points. Face B is perpendicular to it along its two points as seen at right
    /// angles to A, face C perpendicular to both through its point.
    ///
    /// # Errors
    /// [`CuboidError`]. Distances below a millionth of that between the points are too small.
    pub fn from_points(
        a: [Point3<f64>; 3],
        b: [Point3<f64>; 2],
        c: Point3<f64>,
    ) -> Result<Self, CuboidError> {
        let [origin, a2, a3] = a;
        let [b1, b2] = b;
        // From the first point and by the distance between all of them, so that nothing here is very large or small.
        let mut points = [a2, a3, b1, b2, c].map(|point| point - origin);
        let scale = points.iter().map(Vector3::amax).fold(0.0, f64::max);
        if !points.iter().flatten().all(|value| value.is_finite()) {
            return Err(CuboidError::NotFinite);
        }
        if scale == 0.0 {
            return Err(CuboidError::Collinear);
        }
        for point in &mut points {
            *point /= scale;
        }
        let [a2, a3, b1, b2, c] = points;

        // The normal of A: the height of the triangle over its longest side shows if there is one.
        let normal = a2.cross(&a3);
        let longest = a2.norm().max(a3.norm()).max((a3 - a2).norm());
        if normal.norm() <= DEGENERATE * longest {
            return Err(CuboidError::Collinear);
        }
        let bc = normal.normalize();
        let along = b2 - b1;
        let along = along - bc * bc.dot(&along);
        if along.norm() <= DEGENERATE {
            return Err(CuboidError::SameProjection);
        }
        // Once more, for what is left of the normal if B's points lay nearly above each other.
        let along = along.normalize();
        let ab = (along - bc * bc.dot(&along)).normalize();
        let ca = ab.cross(&bc);

        // The corner is on all three faces; the first point, on A, is at 0.
        let corner = ca * ca.dot(&b1) + ab * ab.dot(&c);
        let outward = |edge: &Vector3<f64>, points: &[&Vector3<f64>], face| {
            let side: f64 = points.iter().map(|point| edge.dot(&(*point - corner))).sum();
            if side.abs() <= DEGENERATE {
                return Err(CuboidError::NoSide { face });
            }
            let outward = edge * side.signum();
            if points.iter().any(|point| outward.dot(&(*point - corner)) < -UNEVEN) {
                return Err(CuboidError::BothSides { face });
            }
            Ok(outward)
        };
        let placed = origin + corner * scale;
        if !placed.iter().all(|value| value.is_finite()) {
            return Err(CuboidError::NotFinite);
        }
        let a1 = Vector3::zeros();
        Ok(Self {
            corner: placed,
            ab: outward(&ab, &[&a1, &a2, &a3, &b1, &b2], 'C')?,
            bc: outward(&bc, &[&b1, &b2, &c], 'A')?,
            ca: outward(&ca, &[&a1, &a2, &a3, &c], 'B')?,
        })
    }

    /// `M`, the corner where the three faces meet, m.
    pub const fn corner(&self) -> &Point3<f64> {
        &self.corner
    }

    /// `vAB`, the direction of the edge of A and B from the corner.
    pub const fn ab(&self) -> &Vector3<f64> {
        &self.ab
    }

    /// `vBC`, the direction of the edge of B and C from the corner: into the material, seen from A.
    pub const fn bc(&self) -> &Vector3<f64> {
        &self.bc
    }

    /// `vCA`, the direction of the edge of C and A from the corner.
    pub const fn ca(&self) -> &Vector3<f64> {
        &self.ca
    }

    /// The axes of the work frame on this cuboid: x = vAB, z = −vBC, y = z × x, which is vCA or −vCA.
    pub fn unit_vectors(&self) -> UnitVectors {
        UnitVectors::from_x_and_z(self.ab, -self.bc)
    }
}
