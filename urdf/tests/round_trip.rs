//! Round trips: models written as URDF and read again.

use super::{gantry, generated, read, scara, seeded};
use crate::{
    Calibration, Inertial, Joint, JointDetails, JointDrive, JointKind, Link, Model,
    SafetyController, Solid, SolidShape, Tip,
};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// What a reader paints collision geometry with.
const GREY: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// What is read from what is written; twice, and the second time alike.
fn back(model: &Model, axes: &[&str]) -> Model {
    let text = model.to_urdf().unwrap();
    assert_eq!(read(&text).to_urdf().unwrap(), text);
    Model::from_urdf(&text, axes).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn generated_machines_come_back_unchanged() {
    for (model, axes) in [
        (scara().model(), &["A", "B", "Z"][..]),
        (generated::scara3::scara3().model(), &["A", "B", "Z", "C"]),
        (gantry().model(), &["X", "Y", "Z"]),
        (generated::gantry::h_gantry().model(), &["A", "B", "Z"]),
        (generated::tripod::tripod().model(), &["A", "B", "C"]),
    ] {
        let model = model.unwrap();
        assert_eq!(back(&model, axes), model);
    }
}

#[test]
fn generated_urdf_is_clean() {
    let text = scara().model().unwrap().to_urdf().unwrap();
    assert!(!text.contains("<mass value=\"0\"") && !text.contains("<twin>"), "{text}");
    assert!(!text.contains(crate::QUATERNION) && !text.contains("\"-0 "), "{text}");
    assert_eq!(text.matches("<inertial>").count(), 3, "{text}");
    assert_eq!(text.matches("<visual>").count(), text.matches("<collision>").count());
}

/// A machine with everything the generator does not make: turned solids, a sphere, a joint without end, missing and
/// one-sided limits, slanted axes, an oblique inertia, names that XML has to escape, a branch, numbers of every size.
fn odd() -> Model {
    let joint = |name: &str, kind, parent, child, axis: Option<usize>| {
        let origin = Isometry3::translation(0.1, -1e-17, 1.0 / 3.0);
        let direction = Unit::new_normalize(Vector3::new(1.0, 2.0, -3.0));
        let drive = axis.map_or(JointDrive::Fixed, JointDrive::Axis);
        Joint::new(name, kind, [parent, child], origin, direction, drive)
    };
    let details = JointDetails {
        calibration: Some(Calibration { rising: None, falling: Some(-0.1) }),
        ..JointDetails::default()
    };
    let solid =
        |shape, x: f64, color| Solid { shape, origin: Isometry3::translation(x, 0.0, 0.0), color };
    let red = [1.0, 0.1, 0.1 + 0.2, 0.5];
    let solids = vec![
        solid(SolidShape::Box { size: Vector3::new(0.1, 1e-9, 12_345.678_901) }, 0.2, red),
        solid(SolidShape::Sphere { radius: f64::MIN_POSITIVE }, 0.1 + 0.2, GREY),
        solid(SolidShape::Cylinder { radius: 0.1, length: 1e22 }, -0.0, GREY),
        solid(SolidShape::Capsule { radius: 0.1, length: 0.3 }, -0.0, GREY),
    ];
    let inertia = Matrix3::new(1.0, 0.1, -0.2, 0.1, 1.5, 0.3, -0.2, 0.3, 2.0);
    let body = |mass, center: [f64; 3]| Inertial { mass, center: center.into(), inertia };
    let link = |name: &str, inertial, solids: &[Solid]| Link::new(name, inertial, solids.to_vec());
    Model {
        name: "<odd> & \"quoted\"".to_owned(),
        links: vec![
            link("base", None, &[]),
            link("turn & <table>", Some(body(0.1, [0.1, 0.2, 0.3])), &solids),
            link("slide", Some(body(1e-3, [0.0; 3])), &solids[1..]),
            Link { collision: solids[1..].to_vec(), ..link("bracket", None, &solids[..1]) },
        ],
        joints: vec![
            Joint {
                velocity_limit: Some(2.0),
                details: JointDetails {
                    damping: 0.1 + 0.2,
                    friction: 1e-7,
                    safety: Some(SafetyController {
                        soft_limits: [-0.1, 0.3],
                        k_position: 20.0,
                        k_velocity: 0.1 + 0.7,
                    }),
                    calibration: Some(Calibration { rising: Some(1.0 / 3.0), falling: None }),
                    motion_limits: [Some(3.0), None, Some(700.0)],
                },
                ..joint("C '1'", JointKind::Revolute, 0, 1, Some(1))
            },
            Joint {
                position_limits: Some([f64::NEG_INFINITY, 0.7]),
                effort_limit: Some(0.0),
                ..joint("ü", JointKind::Prismatic, 0, 2, Some(0))
            },
            Joint { details, ..joint("fixed", JointKind::Fixed, 1, 3, None) },
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
    for (part, count) in [
        ("<color rgba=\"1 0.1 0.30000000000000004 0.5\"/>", 1),
        ("<material name=\"color_1\"/>", 2),
        ("<material name=\"color_2\"/>", 6),
    ] {
        assert_eq!(text.matches(part).count(), count, "{part}: {text}");
    }
}

proptest! {
    #![proptest_config(seeded())]

    /// To the last digit, also at a pitch of ±90°; readers that know nothing of the quaternion have them within rounding.
    #[test]
    fn rotations_come_back(
        roll in -PI..PI, pitch in prop_oneof![-PI..PI, Just(FRAC_PI_2), Just(-FRAC_PI_2)], yaw in -PI..PI,
        wobble in prop_oneof![Just(0.0), -1e-7..1e-7], more in prop::array::uniform3(-3.0..3.0),
    ) {
        let more = UnitQuaternion::from_scaled_axis(Vector3::from(more));
        for rotation in [more, UnitQuaternion::from_euler_angles(roll, pitch + wobble, yaw) * more] {
            let mut model = scara().model().unwrap();
            let origin = Isometry3::from_parts(Translation3::new(0.1, 0.2, 0.3), rotation);
            model.joints[0].origin = origin;
            model.links[1].solids[0].origin = origin;
            prop_assert_eq!(&back(&model, &["A", "B", "Z"]), &model);
            let plain = model.to_urdf().unwrap().replace(crate::QUATERNION, "unknown");
            let found = Model::from_urdf(&plain, &["A", "B", "Z"]).unwrap();
            let found = found.joints[0].origin.rotation;
            prop_assert!(found.angle_to(&rotation) < 1e-7);
            let matrices = [found, rotation].map(UnitQuaternion::to_rotation_matrix);
            let error = (matrices[0].matrix() - matrices[1].matrix()).norm();
            prop_assert!(error < 4e-15, "{error}");
        }
    }
}
