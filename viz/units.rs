//! Unit conversion from SI to the mm and degrees of the page.
//!
//! Positions go to rerun as `f32`: at 1 m that is 0.06 µm, below anything seen in 3D. Errors stay `f64`.

use nalgebra::{Isometry3, Point3, Vector3};

const MM_PER_M: f64 = 1000.0;

/// m → mm.
pub(crate) fn mm(length: f64) -> f64 {
    length * MM_PER_M
}

/// A number for the graphics card.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the graphics card takes f32; see the module's note on precision"
)]
pub(crate) fn f32_of(value: f64) -> f32 {
    value as f32
}

/// A length in m as mm for the graphics card.
pub(crate) fn mm_f32(length: f64) -> f32 {
    f32_of(mm(length))
}

/// A point in m as mm.
pub(crate) fn point_mm(point: &Point3<f64>) -> [f32; 3] {
    [mm_f32(point.x), mm_f32(point.y), mm_f32(point.z)]
}

/// A vector in m as mm.
pub(crate) fn vector_mm(vector: &Vector3<f64>) -> [f32; 3] {
    [mm_f32(vector.x), mm_f32(vector.y), mm_f32(vector.z)]
}

/// Rotation of a pose.
pub(crate) fn quaternion(pose: &Isometry3<f64>) -> rerun::Quaternion {
    let q = pose.rotation.coords;
    rerun::Quaternion::from_xyzw([f32_of(q.x), f32_of(q.y), f32_of(q.z), f32_of(q.w)])
}

/// A colour with components in 0..=1.
pub(crate) fn color(rgba: &[f64; 4]) -> rerun::Color {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to 0..=255 just before; NaN becomes 0"
    )]
    let byte = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    rerun::Color::from_unmultiplied_rgba(byte(rgba[0]), byte(rgba[1]), byte(rgba[2]), byte(rgba[3]))
}
