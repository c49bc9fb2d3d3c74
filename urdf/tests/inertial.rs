//! Tests of mass properties against sums over the volume and closed forms.

use crate::{DimensionError, Inertial, Link, Mesh, Solid, SolidShape};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Of the octahedron.
const MIDDLE: [f64; 3] = [0.2, -0.1, 0.1];

/// Corners 1 from its middle along every axis.
fn octahedron() -> Arc<Mesh> {
    let [x, y, z] = MIDDLE;
    let corner = |i: usize, side: f64| {
        let mut corner = Point3::new(x, y, z);
        corner[i] += side;
        corner
    };
    let vertices = (0..3).flat_map(|i| [corner(i, 1.0), corner(i, -1.0)]).collect();
    // Seen from outside, +x, +y, +z go round counter-clockwise; with an odd number of them mirrored, the other way.
    let triangles = (0..8_u32).map(|side| {
        let of = |axis: u32| 2 * axis + (side >> axis & 1);
        let (one, other) = if side.count_ones() % 2 == 0 { (1, 2) } else { (2, 1) };
        [of(0), of(one), of(other)]
    });
    Arc::new(Mesh::new("octahedron.stl", vertices, triangles.collect()).unwrap())
}

/// Mass properties of `solid` (mass 1) summed over many small cubes of the link frame.
fn summed(solid: &Solid, reach: f64) -> Inertial {
    const STEPS: i32 = 80;
    let step = 2.0 * reach / f64::from(STEPS);
    let at = |i: i32| -reach + (f64::from(i) + 0.5) * step;
    let inside = |point: &Point3<f64>| {
        let p = solid.origin.inverse() * point;
        match &solid.shape {
            SolidShape::Box { size } => (0..3).all(|i| p[i].abs() <= size[i] / 2.0),
            SolidShape::Cylinder { radius, length } => {
                p.xy().coords.norm() <= *radius && p.z.abs() <= length / 2.0
            }
            SolidShape::Sphere { radius } => p.coords.norm() <= *radius,
            SolidShape::Capsule { radius, length } => {
                let beyond = (p.z.abs() - length / 2.0).max(0.0);
                p.xy().coords.norm().hypot(beyond) <= *radius
            }
            // The mesh below: an octahedron of scaled size.
            SolidShape::Mesh { scale, .. } => {
                (0..3).map(|i| (p[i] / scale[i] - MIDDLE[i]).abs()).sum::<f64>() <= 1.0
            }
        }
    };
    let range = || 0..STEPS;
    let cubes = range().flat_map(|i| {
        range().flat_map(move |j| range().map(move |k| Point3::new(at(i), at(j), at(k))))
    });
    let points: Vec<_> = cubes.filter(inside).collect();
    let mass = 1.0 / f64::from(u32::try_from(points.len()).unwrap());
    let center = Point3::from(points.iter().map(|point| point.coords * mass).sum::<Vector3<f64>>());
    let inertia = points.iter().map(|point| {
        let arm = point - center;
        (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * mass
    });
    Inertial { mass: 1.0, center, inertia: inertia.sum() }
}

#[track_caller]
fn assert_same(found: &Inertial, expected: &Inertial, within: f64) {
    let off = [
        (found.mass - expected.mass).abs(),
        (found.center - expected.center).norm(),
        (found.inertia - expected.inertia).norm(),
    ];
    assert!(off.iter().all(|off| *off < within), "{found:?} {expected:?}");
}

#[test]
fn shapes_agree_with_a_sum_over_their_volume() {
    let origin = Isometry3::new(Vector3::new(0.1, -0.2, 0.15), Vector3::new(0.5, -1.0, 0.7));
    let shapes = [
        SolidShape::Box { size: Vector3::new(0.9, 0.6, 0.4) },
        SolidShape::Cylinder { radius: 0.35, length: 0.8 },
        SolidShape::Sphere { radius: 0.45 },
        SolidShape::Capsule { radius: 0.25, length: 0.5 },
        SolidShape::Mesh { mesh: octahedron(), scale: Vector3::new(0.6, 0.4, 0.5) },
        SolidShape::Mesh { mesh: octahedron(), scale: Vector3::new(0.6, -0.4, 0.5) },
    ];
    for shape in shapes {
        let solid = Solid { shape, origin, color: [1.0; 4] };
        let [low, high] = solid.shape.bounds();
        assert!((0..3).all(|i| low[i] < high[i]), "{low} {high}");
        let found = solid.uniform(1.0);
        assert_same(&found, &summed(&solid, 1.0), 2e-3);
        assert_eq!(found.inertia, found.inertia.transpose());
    }
}

/// A cylinder lying along x: its own axis has m·r²/2.
#[test]
fn a_turned_cylinder_turns_its_inertia() {
    let origin = Isometry3::new(Vector3::zeros(), Vector3::new(0.0, FRAC_PI_2, 0.0));
    let shape = SolidShape::Cylinder { radius: 0.1, length: 0.6 };
    let found = Solid { shape, origin, color: [1.0; 4] }.uniform(3.0).inertia;
    let (along, across) = (3.0 * 0.01 / 2.0, 3.0 * (0.03 + 0.36) / 12.0);
    let expected = Matrix3::from_diagonal(&Vector3::new(along, across, across));
    assert!((found - expected).norm() < 1e-16, "{found}");
    // A thin long one is a rod.
    let rod = Inertial::uniform_cylinder(1.0, 1e-9, PI, Point3::origin());
    assert!((rod.inertia.m11 - PI * PI / 12.0).abs() < 1e-15);
}

#[test]
fn a_union_is_the_whole() {
    let half =
        |x| Inertial::uniform_box(2.0, Vector3::new(0.5, 0.2, 0.1), Point3::new(x, 0.0, 0.3));
    let found = Inertial::union(&[half(0.25), half(0.75)]).unwrap();
    let whole = Inertial::uniform_box(4.0, Vector3::new(1.0, 0.2, 0.1), Point3::new(0.5, 0.0, 0.3));
    assert_same(&found, &whole, 1e-15);
    assert_eq!(Inertial::union(&[]), None);
    let weightless = Inertial::uniform_sphere(0.0, 1.0, Point3::origin());
    assert_eq!(Inertial::union(&[weightless]), None);
    assert_eq!(Inertial::union(&[weightless, whole]), Some(whole));
}

#[test]
fn volumes_are_closed_forms() {
    let close = |shape: &SolidShape, expected: f64| {
        let found = shape.volume().unwrap();
        assert!((found - expected).abs() < 1e-12 * expected, "{shape:?}: {found} {expected}");
    };
    close(&SolidShape::Box { size: Vector3::new(2.0, 3.0, 0.5) }, 3.0);
    close(&SolidShape::Cylinder { radius: 2.0, length: 0.5 }, 2.0 * PI);
    close(&SolidShape::Sphere { radius: 3.0 }, 36.0 * PI);
    close(&SolidShape::Capsule { radius: 3.0, length: 2.0 }, 36.0 * PI + 18.0 * PI);
    // Eight corners of a cube's eighth, 1/6 each.
    let scale = Vector3::new(0.1, -0.2, 0.3);
    close(&SolidShape::Mesh { mesh: octahedron(), scale }, 8.0 / 6.0 * 0.006);
    let open = octahedron();
    let open = Mesh::new("open", open.vertices().to_vec(), open.triangles()[1..].to_vec()).unwrap();
    let open = SolidShape::Mesh { mesh: Arc::new(open), scale };
    assert_eq!(open.volume(), None);
}

#[test]
fn links_weigh_what_their_solids_do() {
    let solid = |size: [f64; 3], x: f64| Solid {
        shape: SolidShape::Box { size: Vector3::from(size) },
        origin: Isometry3::translation(x, 0.0, 0.0),
        color: [1.0; 4],
    };
    // Two bars of one section, 0.1 and 0.3 m long, end to end.
    let bars = vec![solid([0.1, 0.02, 0.02], 0.05), solid([0.3, 0.02, 0.02], 0.25)];
    let (mass, size) = (0.4 * 0.02 * 0.02 * 2700.0, Vector3::new(0.4, 0.02, 0.02));
    let whole = Inertial::uniform_box(mass, size, Point3::new(0.2, 0.0, 0.0));
    let link = Link::new("bars", None, bars);
    assert_same(&link.uniform_at(2700.0).unwrap(), &whole, 1e-12);
    assert_same(&link.uniform_of(mass), &whole, 1e-12);
    let nothing = Link::new("frame", None, Vec::new());
    assert_eq!(nothing.uniform_at(2700.0), None);
    let point = nothing.uniform_of(0.2);
    assert_eq!((point.mass, point.center, point.inertia.norm()), (0.2, Point3::origin(), 0.0));
}

/// A payload is given as seen from the flange, however the flange is turned in its link.
#[test]
fn a_payload_becomes_a_part_of_the_link_that_carries_it() {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    let flange = Isometry3::from_parts(Translation3::new(0.1, 0.0, 0.0), turn);
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03));
    let payload = Inertial { mass: 2.0, center: Point3::new(0.0, 0.0, 0.5), inertia };
    let mut model = super::gantry().model().unwrap();
    let link = model.tip.link;
    model.links[link].inertial = None;
    model.mount_payload(&flange, &payload).unwrap();
    // z of the flange is x of the link, and x of the flange is −z of it.
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.03, 0.02, 0.01));
    let expected = Inertial { mass: 2.0, center: Point3::new(0.6, 0.0, 0.0), inertia };
    assert_same(&model.links[link].inertial.unwrap(), &expected, 1e-15);
    let refusal = |payload| model.clone().mount_payload(&flange, &payload).unwrap_err();
    let light = refusal(Inertial { mass: 0.0, ..payload });
    assert!(light.to_string().starts_with("the mass of the payload is 0"), "{light}");
    let nowhere = refusal(Inertial { center: Point3::new(f64::NAN, 0.0, 0.0), ..payload });
    assert_eq!(nowhere, DimensionError::NotFinite { what: "the inertia of the payload" });
}
