//! Tests of mimic joints and usable limits.

use super::refused::robot;
use super::{assert_near, pose_of, read, seeded};
use crate::{Joint, JointDrive, JointKind, Link, Loop, Model, Tip};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;

/// Three links that turn about z one after the other, 1 m each; the first with axis 0, the others as `drives` say.
fn chain(drives: [JointDrive; 2]) -> Model {
    let names = ["base", "one", "two", "three"];
    let [second, third] = drives;
    let drives = [JointDrive::Axis(0), second, third];
    let joint = |(index, drive)| {
        let origin = Isometry3::translation(if index == 0 { 0.0 } else { 1.0 }, 0.0, 0.0);
        let name = format!("j{index}");
        let links = [index, index + 1];
        Joint::new(name, JointKind::Revolute, links, origin, Vector3::z_axis(), drive)
    };
    Model {
        name: "chain".to_owned(),
        links: names.map(|name| Link::new(name, None, Vec::new())).into(),
        joints: drives.into_iter().enumerate().map(joint).collect(),
        loops: Vec::new(),
        tip: Tip { link: 3, point: Point3::new(1.0, 0.0, 0.0) },
    }
}

fn mimic(joint: usize, multiplier: f64, offset: f64) -> JointDrive {
    JointDrive::Mimic { joint, multiplier, offset }
}

proptest! {
    #![proptest_config(seeded())]

    /// The second follows the third, which follows the first: −2·(0.5·q + 0.1) + 0.3 = 0.1 − q.
    #[test]
    fn a_mimic_of_a_mimic(angle in -3.0..3.0) {
        let model = chain([mimic(2, -2.0, 0.3), mimic(0, 0.5, 0.1)]);
        let expected = [angle, 0.1 - angle, 0.5 * angle + 0.1];
        for (index, expected) in expected.into_iter().enumerate() {
            prop_assert!((model.joint_position(index, &[angle]) - expected).abs() < 1e-15);
        }
        // A closed form of the tip, and every way of asking for it.
        let sums = [expected[0], expected[0] + expected[1], expected.iter().sum()];
        let tip = sums.iter().fold(Point3::origin(), |tip, sum: &f64| tip + Vector3::new(sum.cos(), sum.sin(), 0.0));
        assert_near(model.tip_position(&[angle]), tip, 1e-14);
        assert_near(model.link_poses(&[angle])[3] * model.tip.point, tip, 1e-14);
        let found = pose_of(&model, &[angle], None).unwrap();
        prop_assert!(found.values().iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-15));
        let text = model.to_urdf().unwrap();
        prop_assert_eq!(&read(&text), &model);
        prop_assert_eq!(Model::from_urdf(&text, &["j0"]).unwrap(), model);
    }

    /// An isosceles triangle of two rods of 1 m: a passive joint, one that follows it, and a slider at x = 2·cos φ.
    #[test]
    fn loops_close_with_joints_that_follow(angle in 0.2_f64..1.3) {
        // The first joint is passive here, the slider is the axis; the second turns back twice as far.
        let mut model = chain([mimic(0, -2.0, 0.0), JointDrive::Fixed]);
        model.joints[0].drive = JointDrive::Passive { rest: 0.6 };
        model.joints[2] = Joint {
            parent: 0,
            child: 3,
            ..Joint::new("slide", JointKind::Prismatic, [0, 3], Isometry3::identity(), Vector3::x_axis(), JointDrive::Axis(0))
        };
        model.loops = vec![Loop { links: [2, 3], points: [Point3::new(1.0, 0.0, 0.0), Point3::origin()] }];
        let found = pose_of(&model, &[2.0 * angle.cos()], None).unwrap();
        let [first, second, slide] = found.values()[..] else { panic!() };
        prop_assert!((first - angle).abs() < 1e-9, "{first} {angle}");
        prop_assert_eq!(second.to_bits(), (-2.0 * first).to_bits());
        prop_assert_eq!(slide.to_bits(), (2.0 * angle.cos()).to_bits());
        prop_assert!(found.residual() < 1e-13);
        prop_assert_eq!(read(&model.to_urdf().unwrap()), model);
    }
}

#[test]
fn mimics_in_a_circle_go_nowhere() {
    let model = chain([mimic(2, 1.0, 0.0), mimic(1, 1.0, 0.0)]);
    assert_eq!((model.following(1), model.following(9)), (None, None));
    assert!(model.joint_position(1, &[1.0]).abs() < 1e-300);
    assert!(model.to_urdf().unwrap_err().to_string().contains("joint j1 mimics itself"));
    assert_eq!(chain([mimic(0, 1.0, 0.0), mimic(0, 1.0, 0.0)]).following(0).unwrap().leader, 0);
}

#[test]
fn usable_limits() {
    let limit = "<limit lower='-1' upper='2' velocity='1' effort='1'/>";
    let joint = |more: &str| {
        let text = robot("", &format!("{limit}{more}"), "").replace("prismatic", "revolute");
        Model::from_urdf(&text, &["X"]).unwrap().joints.remove(0)
    };
    assert_eq!(joint("").usable_limits(), Some([-1.0, 2.0]));
    for (soft, expected) in [
        ("", [-1.0, 2.0]),
        ("soft_lower_limit='-0.5' soft_upper_limit='3'", [-0.5, 2.0]),
        ("soft_lower_limit='-2' soft_upper_limit='1.5'", [-1.0, 1.5]),
    ] {
        let safety = format!("<safety_controller k_velocity='10' k_position='100' {soft}/>");
        assert_eq!(joint(&safety).usable_limits(), Some(expected), "{soft}");
    }
    let details = joint("<dynamics damping='0.2' friction='0.1'/>").details;
    assert_eq!((details.damping, details.friction), (0.2, 0.1));
}
