use super::{gantry, scara, seeded};
use crate::{Inertial, Joint, JointDrive, JointKind, Link, Model, Solid, SolidShape, Tip};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn back(model: &Model, axes: &[&str]) -> Model {
    let text = model.to_urdf().unwrap();
    Model::from_urdf(&text, axes).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn generated_machines_come_back_unchanged() {
    let model = scara().model().unwrap();
    assert_eq!(back(&model, &["A", "B", "Z"]), model);
    let model = gantry().model().unwrap();
    assert_eq!(back(&model, &["X", "Y", "Z"]), model);
}

/// A machine with everything the generator does not make: turned solids, a sphere, a joint without end, missing and
/// one-sided limits, slanted axes, an oblique inertia, names that XML has to escape, a branch, numbers of every size.
fn odd() -> Model {
    let joint = |name: &str, kind, parent, child, axis: Option<usize>| Joint {
        name: name.to_owned(),
        kind,
        parent,
        child,
        origin: Isometry3::translation(0.1, -1e-17, 1.0 / 3.0),
        axis: Unit::new_normalize(Vector3::new(1.0, 2.0, -3.0)),
        drive: axis.map_or(JointDrive::Fixed, JointDrive::Axis),
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    let solid =
        |shape, x: f64, color| Solid { shape, origin: Isometry3::translation(x, 0.0, 0.0), color };
    let red = [1.0, 0.1, 0.3, 0.5];
    let solids = vec![
        solid(SolidShape::Box { size: Vector3::new(0.1, 1e-9, 12_345.678_901) }, 0.2, red),
        solid(
            SolidShape::Sphere { radius: f64::MIN_POSITIVE },
            0.1 + 0.2,
            [0.0, 0.1 + 0.2, 1.0, 1.0],
        ),
        solid(SolidShape::Cylinder { radius: 0.1, length: 1e22 }, -0.0, red),
    ];
    let inertia = Matrix3::new(1.0, 0.1, -0.2, 0.1, 1.5, 0.3, -0.2, 0.3, 2.0);
    let link = |name: &str, inertial, solids: &[Solid]| Link {
        name: name.to_owned(),
        inertial,
        solids: solids.to_vec(),
    };
    Model {
        name: "<odd> & \"quoted\"".to_owned(),
        links: vec![
            link("base", None, &[]),
            link(
                "turn & <table>",
                Some(Inertial { mass: 0.1, center: Point3::new(0.1, 0.2, 0.3), inertia }),
                &solids,
            ),
            link(
                "slide",
                Some(Inertial { mass: 1e-3, center: Point3::origin(), inertia }),
                &solids[1..],
            ),
            link("bracket", None, &solids[..1]),
        ],
        joints: vec![
            Joint {
                velocity_limit: Some(2.0),
                ..joint("C '1'", JointKind::Revolute, 0, 1, Some(1))
            },
            Joint {
                position_limits: Some([f64::NEG_INFINITY, 0.7]),
                effort_limit: Some(0.0),
                ..joint("ü", JointKind::Prismatic, 0, 2, Some(0))
            },
            joint("fixed", JointKind::Fixed, 1, 3, None),
        ],
        loops: Vec::new(),
        tip: Tip { link: 3, point: Point3::new(0.1, 0.2, -0.3) },
    }
}

#[test]
fn an_odd_machine_comes_back_unchanged() {
    let model = odd();
    assert_eq!(back(&model, &["ü", "C '1'"]), model);
}

#[test]
fn the_oldest_version_that_can_say_it_is_written() {
    let version = |model: &Model| model.to_urdf().unwrap().contains("version=\"1.2\"");
    let mut model = gantry().model().unwrap();
    assert!(!version(&model), "every limit is given");
    model.joints[1].velocity_limit = None;
    assert!(version(&model));
    assert!(version(&odd()));
    // A turning joint needs no limits of position in any version.
    let mut model = gantry().model().unwrap();
    model.joints[1].kind = JointKind::Revolute;
    model.joints[1].position_limits = None;
    assert!(!version(&model));
    assert!(model.to_urdf().unwrap().contains("type=\"continuous\""));
    assert_eq!(back(&model, &["X", "Y", "Z"]), model);
}

#[test]
fn colours_are_named_once() {
    let text = odd().to_urdf().unwrap();
    assert_eq!(text.matches("<color rgba=\"1 0.1 0.3 0.5\"/>").count(), 1, "{text}");
    assert_eq!(text.matches("<material name=\"color_1\"/>").count(), 4, "{text}");
}

proptest! {
    #![proptest_config(seeded())]

    /// Rotations pass through roll, pitch and yaw, the pitch of ±90° included.
    #[test]
    fn rotations_come_back_to_within_rounding(
        roll in -PI..PI, pitch in prop_oneof![-PI..PI, Just(FRAC_PI_2), Just(-FRAC_PI_2)], yaw in -PI..PI,
        wobble in prop_oneof![Just(0.0), -1e-7..1e-7],
    ) {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch + wobble, yaw);
        let mut model = scara().model().unwrap();
        let origin = Isometry3::from_parts(Translation3::new(0.1, 0.2, 0.3), rotation);
        model.joints[0].origin = origin;
        model.links[1].solids[0].origin = origin;
        let found = back(&model, &["A", "B", "Z"]);
        for found in [found.joints[0].origin, found.links[1].solids[0].origin] {
            prop_assert_eq!(found.translation, origin.translation);
            prop_assert!(found.rotation.angle_to(&rotation) < 1e-7);
            let matrices = [found.rotation, rotation].map(UnitQuaternion::to_rotation_matrix);
            let error = (matrices[0].matrix() - matrices[1].matrix()).norm();
            prop_assert!(error < 4e-15, "{error}");
        }
    }
}
