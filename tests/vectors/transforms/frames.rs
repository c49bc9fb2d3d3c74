//! Frames (manual 8.3) and directions (manual 8.2.2).

use super::vector::{self, Vector, check};
use nalgebra::{Point3, Vector2, Vector3};
use twin_kinematics::{Cuboid, CuboidError, FrameError, ToPath, UnitVectors};

/// Three numbers among the inputs.
fn three(vector: &Vector, name: &str) -> Vector3<f64> {
    Vector3::from_vec(vector.numbers(name))
}

fn expect_angles(id: &str) {
    check(id, |vector| {
        let axes = UnitVectors::new(three(vector, "vX"), three(vector, "vY"), three(vector, "vZ"));
        let number = axes.as_ref().map_or_else(FrameError::error_number, |_| 0);
        vector.expect("nError", [f64::from(number)]);
        let [roll, pitch, yaw] = axes.unwrap().roll_pitch_yaw();
        vector.expect("dA", [roll]);
        vector.expect("dB", [pitch]);
        vector.expect("dC", [yaw]);
        // And back.
        let back = UnitVectors::from_roll_pitch_yaw(roll, pitch, yaw).unwrap();
        for (found, name) in [(back.x(), "vX"), (back.y(), "vY"), (back.z(), "vZ")] {
            assert!((found - three(vector, name)).norm() < 1e-14, "{name}: {found}");
        }
    });
}

#[test]
pub(crate) fn angles() {
    expect_angles("trafo-rpy");
}

#[test]
pub(crate) fn angles_with_x_upright() {
    expect_angles("trafo-rpy-singular");
}

#[test]
pub(crate) fn no_axes_of_a_frame() {
    check("trafo-rpy-errors", |vector| {
        let cases = vector.numbers("cases");
        let numbers = cases.chunks_exact(9).map(|case| {
            let [x, y, z] = [0, 3, 6].map(|at| Vector3::from_column_slice(&case[at..at + 3]));
            UnitVectors::new(x, y, z).map_or_else(|error| f64::from(error.error_number()), |_| 0.0)
        });
        vector.expect("nError", numbers);
    });
}

/// The axes are those of another vector. No unit here: mm in, mm out.
#[test]
pub(crate) fn coordinates() {
    check("trafo-coord3d", |vector| {
        let of = vector::all().remove(&vector.word("axes")).expect("the vector with the axes");
        let [x, y, z] = ["vX", "vY", "vZ"].map(|name| {
            let axis = of["inputs"][name].as_array().expect("an axis");
            Vector3::from_iterator(axis.iter().map(|value| value.as_f64().expect("a number")))
        });
        let axes = UnitVectors::new(x, y, z).unwrap();
        let point = Point3::from(three(vector, "vIn"));
        let there = axes.coordinate_transformation(&point, &three(vector, "vTranslation"));
        vector.expect("vOut", there.coords.iter().copied());
    });
}

#[test]
pub(crate) fn cuboid() {
    check("trafo-cuboid", |vector| {
        let point = |name| Point3::from(three(vector, name) * 1e-3);
        let cuboid = Cuboid::from_points(
            ["A1", "A2", "A3"].map(point),
            ["B1", "B2"].map(point),
            point("C1"),
        );
        let number = cuboid.as_ref().map_or_else(CuboidError::error_number, |_| Some(0));
        vector.expect("nError", number.map(f64::from));
        let cuboid = cuboid.unwrap();
        vector.expect("M", cuboid.corner().iter().map(|value| value * 1e3));
        for (name, edge) in [("vAB", cuboid.ab()), ("vBC", cuboid.bc()), ("vCA", cuboid.ca())] {
            vector.expect(name, edge.iter().copied());
        }
    });
}

#[test]
pub(crate) fn directions() {
    check("trafo-calcdir", |vector| {
        let path = three(vector, "v").xy();
        let ways = [ToPath::Tangential, ToPath::Opposite, ToPath::Right, ToPath::Left];
        let found = ways.map(|way| way.direction(path).unwrap().to_degrees());
        vector.expect("dDir", found);
        // Without a path there is none: the caller keeps the last.
        assert_eq!(ToPath::Tangential.direction(Vector2::zeros()), None);
    });
}
