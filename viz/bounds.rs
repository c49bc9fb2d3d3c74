//! Bounding box of the scene, to place the camera.

use nalgebra::{Isometry3, Point3};
use twin_urdf::Solid;

/// An axis-aligned box that grows, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bounds {
    corners: Option<(Point3<f64>, Point3<f64>)>,
}

impl Bounds {
    /// Takes in a point; one that is not finite is left out.
    pub(crate) fn add(&mut self, point: &Point3<f64>) {
        if !point.iter().all(|x| x.is_finite()) {
            return;
        }
        let (low, high) = self.corners.unwrap_or((*point, *point));
        self.corners = Some((low.inf(point), high.sup(point)));
    }

    /// Takes in a solid by the corners of the box around it.
    pub(crate) fn add_solid(&mut self, machine_from_link: &Isometry3<f64>, solid: &Solid) {
        let [low, high] = solid.shape.bounds();
        let machine_from_solid = machine_from_link * solid.origin;
        for corner in 0..8_u8 {
            let side = |bit: u8, low: f64, high: f64| if corner & bit == 0 { low } else { high };
            let [x, y, z] =
                [side(1, low.x, high.x), side(2, low.y, high.y), side(4, low.z, high.z)];
            self.add(&(machine_from_solid * Point3::new(x, y, z)));
        }
    }

    /// Centre and half diagonal, m; `None` while nothing was added.
    pub(crate) fn sphere(&self) -> Option<(Point3<f64>, f64)> {
        self.corners.map(|(low, high)| (nalgebra::center(&low, &high), (high - low).norm() / 2.0))
    }

    /// Lowest z, m.
    pub(crate) fn floor(&self) -> Option<f64> {
        self.corners.map(|(low, _)| low.z)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use twin_urdf::SolidShape;

    use super::*;

    #[test]
    fn a_turned_box_is_framed_by_its_corners() {
        let mut bounds = Bounds::default();
        assert_eq!(bounds.sphere(), None);
        let solid = Solid {
            shape: SolidShape::Box { size: Vector3::new(2.0, 4.0, 6.0) },
            origin: Isometry3::translation(1.0, 0.0, 0.0),
            color: [1.0; 4],
        };
        // A quarter turn about z takes the box from x 0..2, y -2..2 to x -2..2, y 0..2.
        let quarter = Isometry3::rotation(Vector3::z() * std::f64::consts::FRAC_PI_2);
        bounds.add_solid(&quarter, &solid);
        let (center, radius) = bounds.sphere().unwrap();
        assert!((center - Point3::new(0.0, 1.0, 0.0)).norm() < 1e-12, "{center}");
        assert!((radius - (4.0_f64 + 1.0 + 9.0).sqrt()).abs() < 1e-12, "{radius}");
        assert_eq!(bounds.floor(), Some(-3.0));
    }

    #[test]
    fn a_position_that_is_not_a_number_does_not_move_the_camera() {
        let mut bounds = Bounds::default();
        bounds.add(&Point3::new(1.0, 2.0, 3.0));
        bounds.add(&Point3::new(f64::NAN, 0.0, 0.0));
        bounds.add(&Point3::new(0.0, f64::INFINITY, 0.0));
        assert_eq!(bounds.sphere(), Some((Point3::new(1.0, 2.0, 3.0), 0.0)));
    }
}
