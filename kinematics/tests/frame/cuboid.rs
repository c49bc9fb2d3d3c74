//! Tests of the work frame of a probed cuboid.

use crate::tests::seeded;
use crate::{Cuboid, CuboidError, WorkFrame};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;

type Points = [Point3<f64>; 6];

fn cuboid(points: Points) -> Result<Cuboid, CuboidError> {
    let [a1, a2, a3, b1, b2, c1] = points;
    Cuboid::from_points([a1, a2, a3], [b1, b2], c1)
}

/// Points on a cuboid in its own frame: corner at the origin, A on top (z = 0), B in front (y = 0), C on the left (x = 0).
fn probed() -> Points {
    [
        Point3::new(0.02, 0.03, 0.0),
        Point3::new(0.11, 0.01, 0.0),
        Point3::new(0.05, 0.08, 0.0),
        Point3::new(0.015, 0.0, -0.01),
        Point3::new(0.09, 0.0, -0.02),
        Point3::new(0.0, 0.05, -0.015),
    ]
}

/// C on the left: the frame of the points. C on the right: z still goes up, x along the work to the left, y to the front.
#[test]
fn the_work_frame_of_the_sketch() {
    for side in [1.0, -1.0] {
        let found = cuboid(probed().map(|at| Point3::new(side * at.x, at.y, at.z))).unwrap();
        for (edge, expected) in [
            (found.ab(), Vector3::x() * side),
            (found.ca(), Vector3::y()),
            (found.bc(), -Vector3::z()),
        ] {
            assert!((edge - expected).norm() < 1e-15, "{found:?}");
        }
        let frame = WorkFrame::from_cuboid(&found);
        assert!(frame.machine_from_work().translation.vector.norm() < 1e-16, "{frame:?}");
        for (axis, sign) in [(Vector3::x(), side), (Vector3::y(), side), (Vector3::z(), 1.0)] {
            assert!((frame.vector_to_machine(&axis) - axis * sign).norm() < 1e-15, "{frame:?}");
        }
    }
}

/// A on a line is error 1, B with one projection error 2; with B and C on the edges of A nothing says what is up.
#[test]
fn degenerate_points_are_refused() {
    let points = probed();
    let moved = |index: usize, to: Point3<f64>| {
        let mut points = points;
        points[index] = to;
        points
    };
    let between = points[0] + (points[1] - points[0]) * 0.3;
    let near = between + Vector3::new(1e-8, -1e-8, 3e-8);
    let same = |x, z| moved(4, points[3] + Vector3::new(x, 0.0, z));
    let (line, projection) =
        ((CuboidError::Collinear, Some(1)), (CuboidError::SameProjection, Some(2)));
    let mut level = points;
    level[3..].iter_mut().for_each(|point| point.z = 0.0);
    for (points, expected) in [
        (moved(2, between), line),
        (moved(2, near), line),
        (moved(2, points[0]), line),
        (moved(2, points[1]), line),
        ([Point3::new(1.0, 2.0, 3.0); 6], line),
        (same(0.0, 0.0), projection),
        (same(0.0, -0.01), projection),
        (same(3e-8, 0.005), projection),
        (level, (CuboidError::NoSide { face: 'A' }, None)),
    ] {
        let found = cuboid(points).unwrap_err();
        assert_eq!((found, found.error_number()), expected, "{points:?}");
    }
}

#[test]
fn what_is_not_finite_is_refused() {
    for number in 0..18 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut points = probed();
            points[number / 3][number % 3] = value;
            assert_eq!(cuboid(points), Err(CuboidError::NotFinite));
        }
    }
    // Nor distances.
    let mut points = probed();
    points[0].x = -1e308;
    points[1].x = 1e308;
    assert_eq!(cuboid(points), Err(CuboidError::NotFinite));
}

#[test]
fn any_scale_will_do() {
    for scale in [1e-300, 1e-100, 1e-6, 1e3, 1e100, 1e300] {
        let found = cuboid(probed().map(|point| point * scale)).unwrap();
        assert!((found.ab() - Vector3::x()).norm() < 1e-14, "{scale} {found:?}");
        assert!(found.corner().coords.amax() < 1e-15 * scale, "{scale} {found:?}");
    }
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn the_corner_and_the_edges_come_back(
        corner in prop::array::uniform3(-2.0..2.0), angles in prop::array::uniform3(-3.0..3.0),
        along in prop::array::uniform9(0.01..0.3_f64), more in prop::array::uniform3(0.01..0.3_f64), left in any::<bool>(),
    ) {
        let side = if left { 1.0 } else { -1.0 };
        let [a1, a2, a3] = [[along[0], along[1]], [along[2], along[3]], [along[4], along[5]]];
        let height = (a2[0] - a1[0]) * (a3[1] - a1[1]) - (a2[1] - a1[1]) * (a3[0] - a1[0]);
        prop_assume!(height.abs() > 1e-4 && (along[6] - along[7]).abs() > 1e-3);
        let flat = |[x, y]: [f64; 2]| Point3::new(x * side, y, 0.0);
        let points = [
            flat(a1), flat(a2), flat(a3),
            Point3::new(along[6] * side, 0.0, -along[8]), Point3::new(along[7] * side, 0.0, -more[0]),
            Point3::new(0.0, more[1], -more[2]),
        ];
        let rotation = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
        let corner = Point3::from(corner);
        let found = cuboid(points.map(|point| corner + rotation * point.coords)).unwrap();
        // The shortest base is a millimetre, against 0.5 m; coordinates are up to 3 m.
        prop_assert!((found.corner() - corner).norm() < 1e-11, "{found:?}");
        for (edge, expected) in [(found.ab(), Vector3::x() * side), (found.ca(), Vector3::y()), (found.bc(), -Vector3::z())] {
            prop_assert!((edge - rotation * expected).norm() < 1e-11, "{found:?}");
        }
        let frame = WorkFrame::from_cuboid(&found);
        let [a, b, c] = [points[0], points[3], points[5]]
            .map(|point| frame.point_to_work(&(corner + rotation * point.coords)));
        prop_assert!(a.z.abs() < 1e-11 && b.y.abs() < 1e-11 && c.x.abs() < 1e-11);
        prop_assert!(a.x > 0.0 && a.y * side > 0.0 && b.x > 0.0 && b.z < 0.0 && c.y * side > 0.0 && c.z < 0.0);
    }
}

/// C was touched between the points on A: the corner would be inside the work.
#[test]
fn points_on_both_sides_of_a_face() {
    let point = |x: f64, y: f64, z: f64| Point3::new(x, y, z) * 1e-3;
    let a = [point(310.0, 10.0, 0.0), point(390.0, 10.0, 0.0), point(310.0, 70.0, 0.0)];
    let b = [point(310.0, 0.0, -5.0), point(390.0, 0.0, -5.0)];
    assert!(Cuboid::from_points(a, b, point(300.0, 20.0, -5.0)).is_ok());
    let error = Cuboid::from_points(a, b, point(350.0, 20.0, -5.0)).unwrap_err();
    assert_eq!(error, CuboidError::BothSides { face: 'C' });
}
