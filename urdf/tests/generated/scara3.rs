//! Tests of generated SCARAs with a third arm.

use super::{bounds, corners, heights};
use crate::tests::{assert_near, mass, scara, seeded};
use crate::{JointKind, MachineJoint, ScaraDimensions, ScaraHand};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// The SCARA of the SoftMotion vectors with a third arm.
pub(in crate::tests) fn scara3() -> ScaraDimensions {
    let hand = ScaraHand { mass: Some(0.5), ..ScaraHand::new(wrist(), 0.1) };
    ScaraDimensions { hand: Some(hand), ..scara() }
}

fn wrist() -> MachineJoint {
    MachineJoint::new("C", 3, [-PI, PI])
}

#[test]
fn the_hand_hangs_below_the_arms() {
    let short = ScaraDimensions { hand: Some(ScaraHand::new(wrist(), 0.0)), ..scara() };
    let beside = ScaraDimensions { tool: Vector3::new(0.05, -0.02, -0.08), ..scara3() };
    let flat = ScaraDimensions {
        quill_joint: None,
        hand: Some(ScaraHand::new(MachineJoint::new("C", 2, [-PI, PI]), 0.1)),
        ..scara()
    };
    let c = &scara3().model().unwrap().joints[3];
    assert_eq!((c.kind, c.drive.axis(), c.parent), (JointKind::Revolute, Some(3), 3));
    for dimensions in [scara3(), short, beside, flat] {
        let model = dimensions.model().unwrap();
        let names: Vec<_> = model.links.iter().map(|link| link.name.as_str()).collect();
        assert_eq!(names, ["base", "arm1", "arm2", "quill", "hand"]);
        for axes in corners(&model) {
            let [base, arm1, arm2, quill, hand] =
                [0, 1, 2, 3, 4].map(|link| heights(&bounds(&model, link, &axes)));
            assert!(base[1] < arm1[0] && arm1[1] < arm2[0], "{base:?} {arm1:?} {arm2:?}");
            assert!(hand[1] < arm2[0] && hand[1] < quill[0], "{hand:?} {quill:?} {arm2:?}");
            assert!(quill[1] > arm2[0] && hand[0] > base[0] + 0.0199, "{quill:?} {hand:?}");
            let z = dimensions.quill_joint.as_ref().map_or(0.0, |_| axes[2]);
            assert!((model.tip_position(&axes).z - (z - 0.08)).abs() < 1e-15);
        }
    }
}

#[test]
fn masses_add_up() {
    let given = |hand| ScaraDimensions {
        arm_masses: Some([8.0, 4.0]),
        quill_mass: Some(1.5),
        hand,
        ..scara()
    };
    let two = mass(&given(None).model().unwrap());
    assert!((two - 13.8).abs() < 1e-12, "{two}");
    let three = given(scara3().hand).model().unwrap();
    assert!((mass(&three) - 14.3).abs() < 1e-12, "{}", mass(&three));
    // 0.5 kg in the middle of 0.1 m, 0.3 kg of tool at its end.
    let hand = three.links[4].inertial.unwrap();
    assert!((hand.center.x - (0.5 * 0.05 + 0.3 * 0.1) / 0.8).abs() < 1e-15, "{hand:?}");
    let derived = ScaraDimensions { hand: Some(ScaraHand::new(wrist(), 0.0)), ..scara() };
    let hand = derived.model().unwrap().links[4].inertial.unwrap();
    assert!(hand.mass > 0.3 && hand.mass < 1.0, "{hand:?}");
}

proptest! {
    #![proptest_config(seeded())]

    /// Manual 8.2.5: three arms of the directions α, α + β and δ = α + β + γ, and the tool in the frame of the last.
    #[test]
    fn the_tip_is_where_three_arms_lead(
        arms in prop::array::uniform2(0.1..0.8), length in prop_oneof![Just(0.0), 0.0..0.5],
        offsets in prop::array::uniform3(-PI..PI), position in [-PI..PI, -PI..PI, -0.1..0.05, -PI..PI],
        tool in [-0.1..0.1, -0.1..0.1, -0.3..0.0],
    ) {
        let hand = ScaraHand { offset: offsets[2], ..ScaraHand::new(wrist(), length) };
        let [offset_a, offset_b, offset_c] = offsets;
        let dimensions = ScaraDimensions { arms, hand: Some(hand), tool: tool.into(), ..scara() };
        let model = ScaraDimensions { offsets: [offset_a, offset_b], ..dimensions }.model().unwrap();
        let [a, b, z, c] = position;
        let alpha = a - offset_a;
        let forearm = alpha + b - offset_b;
        let direction = forearm + c - offset_c;
        let (sin, cos) = direction.sin_cos();
        let expected = Point3::new(
            arms[0] * alpha.cos() + arms[1] * forearm.cos() + (length + tool[0]) * cos - tool[1] * sin,
            arms[0] * alpha.sin() + arms[1] * forearm.sin() + (length + tool[0]) * sin + tool[1] * cos,
            z + tool[2],
        );
        assert_near(model.tip_position(&position), expected, 1e-12);
        let along = model.link_poses(&position)[4] * Vector3::x();
        prop_assert!((along - Vector3::new(cos, sin, 0.0)).norm() < 1e-12, "{along}");
    }

    #[test]
    fn a_tool_beside_the_quill_turns_with_arm_2(
        position in [-PI..PI, -PI..PI, -0.1..0.05], tool in [-0.1..0.1, -0.1..0.1, -0.3..0.0],
    ) {
        let model = ScaraDimensions { tool: tool.into(), ..scara() }.model().unwrap();
        let [a, b, z] = position;
        let (sin, cos) = (a + b).sin_cos();
        let expected = Point3::new(
            0.25 * a.cos() + (0.2 + tool[0]) * cos - tool[1] * sin,
            0.25 * a.sin() + (0.2 + tool[0]) * sin + tool[1] * cos,
            z + tool[2],
        );
        assert_near(model.tip_position(&position), expected, 1e-12);
    }
}
