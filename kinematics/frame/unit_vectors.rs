//! Axes of a frame as unit vectors or as three angles (SoftMotion manual 8.3).

use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};

/// Tolerance of unit vectors: the deviation of an axis length from 1, and of the cosine between two axes from 0.
///
/// Axes typed or shown with six decimals pass; axes that are wrong by what any use of a frame would notice (1 µm on
/// 1 m) do not.
pub const UNIT_VECTOR_TOLERANCE: f64 = 1e-6;

/// Cosine of the pitch below which roll and yaw turn about the same axis: there yaw is 0 and roll is all of the turn.
/// It is what rounding leaves of a vertical x axis. Taking such a tilt for none moves no axis by more than twice
/// as much.
const GIMBAL: f64 = 4e-15;

/// Vectors that are not the axes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// An axis is not 1 long (or not finite).
    #[error("axis {axis} is {length} long; it must be 1")]
    NotUnit {
        /// x, y or z.
        axis: char,
        /// Its length.
        length: f64,
    },
    /// Two axes are not perpendicular.
    #[error("the cosine of the angle between axes {} and {} is {cosine}; it must be 0", axes[0], axes[1])]
    NotPerpendicular {
        /// The two axes.
        axes: [char; 2],
        /// Cosine of the angle between them.
        cosine: f64,
    },
    /// z points to the other side of x × y.
    #[error("the axes are left-handed: z points against x × y")]
    NotRightHanded,
}

impl FrameError {
    /// `nError` of `SMC_UnitVectorToRPY`.
    pub const fn error_number(&self) -> u16 {
        match self {
            Self::NotUnit { .. } => 1,
            Self::NotPerpendicular { .. } => 2,
            Self::NotRightHanded => 3,
        }
    }
}

/// The axes of a new frame as seen from an old one: `vX`, `vY`, `vZ` of `SMC_UnitVectorToRPY` and
/// `SMC_CoordinateTransformation3D`. They are 1 long, perpendicular and right-handed within [`UNIT_VECTOR_TOLERANCE`].
///
/// The same frame as three angles, from old to new: turned about the old x axis by the roll (`dA`), about the old y
/// axis by the pitch (`dB`), about the old z axis by the yaw (`dC`); or, which comes to the same, about z by the yaw,
/// about the y axis turned with it by the pitch, about the x axis turned with both by the roll. The vectors are the
/// columns of
///
/// ```text
/// R = Rz(dC)·Ry(dB)·Rx(dA) = ⎡ cC·cB   cC·sB·sA − sC·cA   cC·sB·cA + sC·sA ⎤
///                            ⎢ sC·cB   sC·sB·sA + cC·cA   sC·sB·cA − cC·sA ⎥
///                            ⎣  −sB         cB·sA              cB·cA       ⎦
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitVectors {
    x: Vector3<f64>,
    y: Vector3<f64>,
    z: Vector3<f64>,
}

impl UnitVectors {
    /// The axes of the new frame, in the old one.
    ///
    /// # Errors
    /// [`FrameError::NotUnit`], [`FrameError::NotPerpendicular`] and [`FrameError::NotRightHanded`], in this order.
    pub fn new(x: Vector3<f64>, y: Vector3<f64>, z: Vector3<f64>) -> Result<Self, FrameError> {
        // Written so that what is not a number is refused.
        let near = |value: f64, wanted: f64| (value - wanted).abs() <= UNIT_VECTOR_TOLERANCE;
        for (axis, vector) in [('x', &x), ('y', &y), ('z', &z)] {
            let length = vector.norm();
            if !near(length, 1.0) {
                return Err(FrameError::NotUnit { axis, length });
            }
        }
        for (axes, one, other) in [(['x', 'y'], &x, &y), (['y', 'z'], &y, &z), (['z', 'x'], &z, &x)]
        {
            let cosine = one.dot(other);
            if !near(cosine, 0.0) {
                return Err(FrameError::NotPerpendicular { axes, cosine });
            }
        }
        if x.cross(&y).dot(&z) < 0.0 {
            return Err(FrameError::NotRightHanded);
        }
        Ok(Self { x, y, z })
    }

    /// The axes of a frame turned by `roll` about x, then by `pitch` about y, then by `yaw` about z (rad).
    ///
    /// # Errors
    /// [`FrameError::NotUnit`] if an angle is not finite.
    pub fn from_roll_pitch_yaw(roll: f64, pitch: f64, yaw: f64) -> Result<Self, FrameError> {
        let ((sa, ca), (sb, cb), (sc, cc)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
        Self::new(
            Vector3::new(cc * cb, sc * cb, -sb),
            Vector3::new(cc * sb * sa - sc * ca, sc * sb * sa + cc * ca, cb * sa),
            Vector3::new(cc * sb * ca + sc * sa, sc * sb * ca - cc * sa, cb * ca),
        )
    }

    /// The axes x, z × x and z, for axes that are unit vectors and perpendicular by construction.
    pub(super) fn from_x_and_z(x: Vector3<f64>, z: Vector3<f64>) -> Self {
        Self { x, y: z.cross(&x), z }
    }

    /// `vX`, the new x axis in the old frame.
    pub const fn x(&self) -> &Vector3<f64> {
        &self.x
    }

    /// `vY`, the new y axis in the old frame.
    pub const fn y(&self) -> &Vector3<f64> {
        &self.y
    }

    /// `vZ`, the new z axis in the old frame.
    pub const fn z(&self) -> &Vector3<f64> {
        &self.z
    }

    /// The rotation that takes coordinates of the new frame to the old one. It is one to the last digit even if the
    /// vectors are not: x is kept, y keeps its side of it, z is perpendicular to both.
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.matrix()))
    }

    /// `SMC_UnitVectorToRPY`: roll `dA` about x, pitch `dB` about y and yaw `dC` about z, rad. Roll and yaw are in
    /// [−π, π], pitch is in [−π/2, π/2].
    ///
    /// With x upright (pitch ±π/2) only the sum or the difference of roll and yaw is known; yaw is 0 then. Near there
    /// each of the two is as uncertain as the direction of what is left of x seen from above, but not what they are
    /// for: the three angles give the frame back within 10⁻¹⁴, everywhere.
    pub fn roll_pitch_yaw(&self) -> [f64; 3] {
        let matrix = self.matrix();
        let (x, y, z) = (matrix.column(0), matrix.column(1), matrix.column(2));
        let cosine = x.x.hypot(x.y);
        let pitch = (-x.z).atan2(cosine);
        let yaw = if cosine < GIMBAL { 0.0 } else { x.y.atan2(x.x) };
        // With the yaw taken back, y and z have cos(roll) and −sin(roll) along y. These do not fade as the pitch comes
        // to a quarter turn, as those in the last row of R do, and what the yaw has wrong the roll makes good.
        let (sin, cos) = yaw.sin_cos();
        let roll = (z.x * sin - z.y * cos).atan2(y.y * cos - y.x * sin);
        [roll, pitch, yaw]
    }

    /// `SMC_CoordinateTransformation3D`: `point` of the old frame (`vIn`, m) in the new one (`vOut`, m).
    ///
    /// `translation` (`vTranslation`, m) is where the *old* origin is in the *new* frame:
    /// vOut = (vX·vIn, vY·vIn, vZ·vIn) + vTranslation. A [`WorkFrame`](crate::WorkFrame) is given its origin in the old
    /// frame instead, which is −R·vTranslation.
    pub fn coordinate_transformation(
        &self,
        point: &Point3<f64>,
        translation: &Vector3<f64>,
    ) -> Point3<f64> {
        let point = &point.coords;
        Point3::new(self.x.dot(point), self.y.dot(point), self.z.dot(point)) + translation
    }

    /// R, with what the tolerance lets through taken out.
    fn matrix(&self) -> Matrix3<f64> {
        let x = self.x / self.x.norm();
        let y = self.y - x * x.dot(&self.y);
        let y = y / y.norm();
        Matrix3::from_columns(&[x, y, x.cross(&y)])
    }
}
