//! Planes of arcs (G17 to G19).

use nalgebra::Vector3;

/// A plane through two axes of the work frame, with the sense that makes "clockwise" mean something: seen from the
/// tip of its normal (DIN 66025 part 2, G17 to G19).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Plane {
    /// G17: X to Y, about Z. The only one of SoftMotion's dialect.
    #[default]
    Xy,
    /// G18: Z to X, about Y.
    Zx,
    /// G19: Y to Z, about X.
    Yz,
}

impl Plane {
    /// The components of `vector` along the plane's first and second axis and along its normal.
    pub fn split(self, vector: &Vector3<f64>) -> [f64; 3] {
        let [x, y, z] = [vector.x, vector.y, vector.z];
        match self {
            Self::Xy => [x, y, z],
            Self::Zx => [z, x, y],
            Self::Yz => [y, z, x],
        }
    }

    /// The vector with these components: the inverse of [`Self::split`].
    pub fn join(self, [first, second, normal]: [f64; 3]) -> Vector3<f64> {
        match self {
            Self::Xy => Vector3::new(first, second, normal),
            Self::Zx => Vector3::new(second, normal, first),
            Self::Yz => Vector3::new(normal, first, second),
        }
    }

    /// The unit vector about which a positive angle turns.
    pub fn normal(self) -> Vector3<f64> {
        self.join([0.0, 0.0, 1.0])
    }
}
