//! Mass distribution of bodies in a frame, and the wrench that accelerates it.

use nalgebra::{Matrix3, Vector3};

use crate::bodies::MassProperties;

/// Σ m·r·rᵀ, symmetric, kg·m².
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SecondMoments {
    pub(super) xx: f64,
    pub(super) yy: f64,
    pub(super) zz: f64,
    pub(super) xy: f64,
    pub(super) xz: f64,
    pub(super) yz: f64,
}

impl SecondMoments {
    /// Of the symmetric `matrix`.
    fn of(matrix: &Matrix3<f64>) -> Self {
        Self {
            xx: matrix.m11,
            yy: matrix.m22,
            zz: matrix.m33,
            xy: matrix.m12,
            xz: matrix.m13,
            yz: matrix.m23,
        }
    }

    fn matrix(&self) -> Matrix3<f64> {
        let Self { xx, yy, zz, xy, xz, yz } = *self;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }
}

/// The mass in a frame: Σ m, Σ m·r and Σ m·r·rᵀ.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    pub(super) mass: f64,
    pub(super) first: Vector3<f64>,
    pub(super) second: SecondMoments,
}

impl Spread {
    /// Of a link.
    pub(super) fn of(properties: &MassProperties) -> Self {
        let MassProperties { mass, center, inertia } = *properties;
        let about_center = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
        let second = SecondMoments::of(&about_center);
        Self { mass, first: Vector3::zeros(), second }.shifted(&center.coords)
    }

    #[inline]
    pub(super) fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.first += other.first;
        let (second, other) = (&mut self.second, &other.second);
        second.xx += other.xx;
        second.yy += other.yy;
        second.zz += other.zz;
        second.xy += other.xy;
        second.xz += other.xz;
        second.yz += other.yz;
    }

    /// In a frame in which the present one is turned by `rotation`.
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        let second = rotation * self.second.matrix() * rotation.transpose();
        Self { first: rotation * self.first, second: SecondMoments::of(&second), ..*self }
    }

    /// In a frame in which the present one is turned about z.
    #[inline]
    pub(super) fn turned_about_z(&self, [sin, cos]: [f64; 2]) -> Self {
        let SecondMoments { xx, yy, zz, xy, xz, yz } = self.second;
        // What mean and difference of xx and yy become.
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let (sin2, cos2) = (2.0 * sin * cos, (cos - sin) * (cos + sin));
        let turned = half * cos2 - xy * sin2;
        let second = SecondMoments {
            xx: mean + turned,
            yy: mean - turned,
            zz,
            xy: half * sin2 + xy * cos2,
            xz: xz * cos - yz * sin,
            yz: xz * sin + yz * cos,
        };
        let (x, y) = (self.first.x, self.first.y);
        let first = Vector3::new(x * cos - y * sin, x * sin + y * cos, self.first.z);
        Self { mass: self.mass, first, second }
    }

    /// In a frame in which the origin of the present one is at `r`.
    #[inline]
    pub(super) fn shifted(&self, r: &Vector3<f64>) -> Self {
        let shift = r * self.mass;
        let half = self.first + shift * 0.5;
        let SecondMoments { xx, yy, zz, xy, xz, yz } = self.second;
        let second = SecondMoments {
            xx: xx + 2.0 * half.x * r.x,
            yy: yy + 2.0 * half.y * r.y,
            zz: zz + 2.0 * half.z * r.z,
            xy: xy + (half.x * r.y + half.y * r.x),
            xz: xz + (half.x * r.z + half.z * r.x),
            yz: yz + (half.y * r.z + half.z * r.y),
        };
        Self { mass: self.mass, first: self.first + shift, second }
    }

    /// Force, and torque about the origin, that accelerate it so.
    #[inline]
    pub(super) fn wrench(&self, motion: &Motion) -> [Vector3<f64>; 2] {
        let Motion { acceleration, change } = motion;
        let force = acceleration * self.mass + change * self.first;
        let SecondMoments { xx, yy, zz, xy, xz, yz } = self.second;
        let b = change;
        let torque = Vector3::new(
            (b.m31 * xy + b.m32 * yy + b.m33 * yz) - (b.m21 * xz + b.m22 * yz + b.m23 * zz),
            (b.m11 * xz + b.m12 * yz + b.m13 * zz) - (b.m31 * xx + b.m32 * xy + b.m33 * xz),
            (b.m21 * xx + b.m22 * xy + b.m23 * xz) - (b.m11 * xy + b.m12 * yy + b.m13 * yz),
        );
        [force, torque + self.first.cross(acceleration)]
    }
}

/// The acceleration field of a rigid body: a + B·r, in its frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    /// a, of the origin.
    pub(super) acceleration: Vector3<f64>,
    /// B = α× + ω×ω×.
    pub(super) change: Matrix3<f64>,
}

impl Motion {
    /// Of a body that turns with ω = `omega` and α = `alpha`.
    #[inline]
    pub(super) fn new(
        acceleration: Vector3<f64>,
        omega: &Vector3<f64>,
        alpha: &Vector3<f64>,
    ) -> Self {
        let (x, y, z) = (omega.x, omega.y, omega.z);
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (xy, xz, yz) = (x * y, x * z, y * z);
        let change = Matrix3::new(
            -(yy + zz),
            xy - alpha.z,
            xz + alpha.y,
            xy + alpha.z,
            -(xx + zz),
            yz - alpha.x,
            xz - alpha.y,
            yz + alpha.x,
            -(xx + yy),
        );
        Self { acceleration, change }
    }
}
