//! Tests of generated gantries: clearances, masses, belts, and positions against the manual's transforms.

use super::{assert_refused, bounds, corners, corners_of, meet};
use crate::tests::{assert_near, gantry, mass, seeded};
use crate::{
    GantryDimensions, HBelt, Joint, JointDrive, JointKind, MachineJoint, Model, PlaneDrive,
    RotaryTool,
};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

fn motor(name: &str, axis: usize, limits: [f64; 2]) -> MachineJoint {
    MachineJoint {
        velocity_limit: Some(0.4),
        effort_limit: Some(300.0),
        ..MachineJoint::new(name, axis, limits)
    }
}

/// Both drives from −0.5 to 0.8 m of belt: the flange between ±0.65 m along x and −0.5 and 0.8 m along y.
pub(in crate::tests) fn h_gantry() -> GantryDimensions {
    let belt = HBelt::new([motor("A", 0, [-0.5, 0.8]), motor("B", 1, [-0.5, 0.8])]);
    GantryDimensions {
        tool: Vector3::new(0.0, 0.0, -0.05),
        tool_mass: 0.2,
        ..GantryDimensions::h_belt("h gantry", belt, Some(motor("Z", 2, [-0.1, 0.0])))
    }
}

pub(super) fn cutter() -> GantryDimensions {
    let rotary = RotaryTool {
        offset: 0.3,
        mass: Some(0.4),
        ..RotaryTool::new(MachineJoint::new("R", 3, [-PI, PI]))
    };
    GantryDimensions { rotary: Some(rotary), ..gantry() }
}

/// What a link may not touch: every other one, table and rails included.
fn touches_itself_nowhere(dimensions: &GantryDimensions, axes: impl IntoIterator<Item = Vec<f64>>) {
    let model = dimensions.model().unwrap();
    for axes in axes {
        let bounds = |link| bounds(&model, link, &axes);
        let links: Vec<_> = (0..model.links.len()).map(bounds).collect();
        for one in 0..links.len() {
            for other in 0..one {
                let (a, b) = (&links[one], &links[other]);
                let name = &model.name;
                assert!(!meet(a, b), "{one} and {other} of {name} at {axes:?}: {a:?} {b:?}");
            }
        }
        let [table, ..] = links[0][0..1] else { panic!("no table") };
        let tip = model.tip_position(&axes);
        assert!(table[1].z < tip.z, "{table:?} {tip}");
        assert!((0..2).all(|i| table[0][i] < tip[i] && tip[i] < table[1][i]), "{table:?} {tip}");
    }
}

#[test]
fn no_gantry_touches_itself() {
    let beside = GantryDimensions { tool: Vector3::new(-0.08, 0.11, -0.05), ..gantry() };
    let level = GantryDimensions { tool: Vector3::new(0.3, -0.25, 0.0), ..gantry() };
    let dragged = GantryDimensions { tool: Vector3::new(-0.02, 0.0, -0.05), ..cutter() };
    let two = GantryDimensions { quill_joint: None, ..gantry() };
    let flat_cutter = GantryDimensions {
        quill_joint: None,
        rotary: Some(RotaryTool::new(MachineJoint::new("R", 2, [-PI, PI]))),
        ..cutter()
    };
    let moved = GantryDimensions { offsets: [0.3, -0.1, 0.05], ..gantry() };
    for dimensions in [gantry(), moved, beside, level, cutter(), dragged, two, flat_cutter] {
        let model = dimensions.model().unwrap();
        // The corners of the travel, and every quarter turn of R between.
        let mut all = corners(&model);
        if dimensions.rotary.is_some() {
            let mut turned = all.clone();
            for axes in &mut turned {
                *axes.last_mut().unwrap() /= 2.0;
            }
            all.extend(turned);
        }
        touches_itself_nowhere(&dimensions, all);
    }
    // With a belt the corners of the travel are where the motors are at the sums and differences.
    let corners = corners_of(&[[-0.65, 0.65], [-0.5, 0.8], [-0.1, 0.0]]).into_iter();
    let motors = corners.map(|at| vec![at[1] + at[0], at[1] - at[0], at[2]]);
    touches_itself_nowhere(&h_gantry(), motors);
    // Parts that meet would be noticed.
    let model = gantry().model().unwrap();
    let quill_in_table = bounds(&model, 3, &[0.3, 0.0, -0.25]);
    assert!(meet(&bounds(&model, 0, &[0.0; 3]), &quill_in_table));
}

#[test]
fn masses_add_up() {
    let given = |dimensions| GantryDimensions {
        bridge_mass: Some(12.0),
        carriage_mass: Some(4.0),
        quill_mass: Some(2.0),
        ..dimensions
    };
    for (dimensions, expected) in [(gantry(), 18.2), (cutter(), 18.6), (h_gantry(), 18.2)] {
        let model = given(dimensions).model().unwrap();
        assert!((mass(&model) - expected).abs() < 1e-12, "{}", mass(&model));
    }
    // Half a kilogram 0.1 m beside the axis.
    let tool = Vector3::new(0.06, 0.08, -0.05);
    let model = given(GantryDimensions { tool, tool_mass: 0.5, ..gantry() }).model().unwrap();
    let quill = model.links[3].inertial.unwrap();
    assert!((quill.center.xy() - Point3::new(0.012, 0.016, 0.0).xy()).norm() < 1e-15, "{quill:?}");
}

/// The force at the bridge is that of both motors, its speed half the sum of both.
#[test]
fn a_belt_shares_limits() {
    let model = h_gantry().model().unwrap();
    let limits =
        |joint: &Joint| (joint.position_limits.unwrap(), joint.velocity_limit, joint.effort_limit);
    assert_eq!(limits(&model.joints[0]), ([-0.65, 0.65], Some(0.4), Some(600.0)));
    assert_eq!(limits(&model.joints[1]), ([-0.5, 0.8], Some(0.4), Some(600.0)));
    assert_eq!(model.joints[0].drive, JointDrive::Combination(vec![(0, 0.5), (1, -0.5)]));
    assert_eq!(model.joints[1].drive, JointDrive::Combination(vec![(0, 0.5), (1, 0.5)]));
    assert_eq!([&model.joints[0].name, &model.joints[1].name], ["bridge", "carriage"]);
    let belt = HBelt::new([motor("A", 1, [0.0, 1.0]), motor("B", 0, [-0.5, 0.5])]);
    let offsets = [0.1, 0.2, 0.0];
    let free = GantryDimensions { offsets, ..GantryDimensions::h_belt("h", belt, None) };
    let model = free.model().unwrap();
    assert_eq!(limits(&model.joints[0]), ([-0.25, 0.75], Some(0.4), Some(600.0)));
    assert_eq!(limits(&model.joints[1]), ([-0.25, 0.75], Some(0.4), Some(600.0)));
    assert_eq!(model.joints[2].kind, JointKind::Fixed);
}

#[test]
fn what_is_written_can_be_read() {
    let model = cutter().model().unwrap();
    let text = model.to_urdf().unwrap();
    let read = Model::from_urdf(&text, &["X", "Y", "Z", "R"]).unwrap();
    let axes = [0.1, 0.1, -0.1, 1.0];
    assert_near(read.tip_position(&axes), model.tip_position(&axes), 1e-15);
    let model = h_gantry().model().unwrap();
    let text = model.to_urdf().unwrap();
    // As readers have it that know nothing of belts.
    let plain = crate::tests::plain(&text);
    let read = Model::from_urdf(&plain, &["bridge", "carriage", "Z"]).unwrap();
    assert_eq!(read.tip_position(&[0.2, 0.3, -0.05]), model.tip_position(&[0.5, 0.1, -0.05]));
    assert_eq!(read.links, model.links);
}

#[test]
fn impossible_gantries_are_named() {
    let refused = |made: fn() -> GantryDimensions, change: fn(&mut GantryDimensions), said| {
        let mut dimensions = made();
        change(&mut dimensions);
        assert_refused(dimensions.model(), said);
    };
    for (factors, said) in [
        ([[0.5, 0.5], [-0.5, -0.5]], "the factors [[0.5, 0.5], [-0.5, -0.5]] of the belt are …"),
        ([[1.0, -1.0], [1.0, 1.0]], "the factors [[1.0, -1.0], [1.0, 1.0]] of the belt are …"),
        ([[f64::NAN; 2]; 2], "the factors [[NaN, NaN], [NaN, NaN]] of the belt are …"),
    ] {
        let motors = [motor("A", 0, [0.0, 1.0]), motor("B", 1, [0.0, 1.0])];
        let belt = HBelt { factors, ..HBelt::new(motors) };
        assert_refused(GantryDimensions::h_belt("h", belt, None).model(), said);
    }
    refused(h_gantry, |d| d.quill_joint.as_mut().unwrap().name = "bridge".into(), "joints …");
    refused(cutter, |d| d.rotary.as_mut().unwrap().joint.machine_axis = 0, "joints …");
    let offset = "an offset is not a finite number";
    refused(cutter, |d| d.rotary.as_mut().unwrap().offset = f64::NAN, offset);
    refused(
        cutter,
        |d| d.rotary.as_mut().unwrap().mass = Some(0.0),
        "the mass of the head is 0; …",
    );
    refused(gantry, |d| d.tool.z = 0.01, "the length of the tool is -0.01; …");
    refused(gantry, |d| d.tool.x = f64::NAN, "the place of the tool is not a finite number");
    let twice = "joints X and X have the same name or the same machine axis";
    refused(gantry, |d| d.quill_joint.as_mut().unwrap().name = "X".into(), twice);
    let shared = "joints Y and Z have the same name or the same machine axis";
    refused(gantry, |d| d.quill_joint.as_mut().unwrap().machine_axis = 1, shared);
    let stuck = |d: &mut GantryDimensions| {
        let PlaneDrive::Axes([x, _]) = &mut d.plane else { panic!() };
        x.position_limits = [0.5, 0.5];
    };
    refused(gantry, stuck, "joint X can move from 0.5 to 0.5; …");
}

proptest! {
    #![proptest_config(seeded())]

    /// Manual 8.2.2: the tip is at axis − offset, plus A·u + B·n beside it (`Gantry2Tool2`, with Z too).
    #[test]
    fn a_tool_beside_the_axis(
        offsets in prop::array::uniform3(-1.0..1.0), position in [0.0..0.6, -0.2..0.2, -0.15..0.0],
        alpha in -PI..PI, a in -0.3..0.3, b in -0.3..0.3, length in 0.0_f64..0.3,
    ) {
        let (sin, cos) = f64::sin_cos(alpha);
        let (along, across) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
        let beside: Vector2<f64> = along * a + across * b;
        let tool = Vector3::new(beside.x, beside.y, -length);
        let model = GantryDimensions { offsets, tool, ..gantry() }.model().unwrap();
        let expected = Point3::new(
            position[0] - offsets[0] + a * cos - b * sin,
            position[1] - offsets[1] + a * sin + b * cos,
            position[2] - offsets[2] - length,
        );
        assert_near(model.tip_position(&position), expected, 1e-14);
        let mut poses = [Isometry3::translation(9.0, 9.0, 9.0); 4];
        model.link_poses_into(&position, &mut poses);
        assert_near(poses[3] * model.tip.point, expected, 1e-14);
        prop_assert_eq!(poses.to_vec(), model.link_poses(&position));
        // Without Z the flange stays in one plane.
        let flat = GantryDimensions { offsets, tool, quill_joint: None, ..gantry() }.model().unwrap();
        assert_near(flat.tip_position(&position[..2]), [expected.x, expected.y, -length], 1e-12);
    }

    /// Manual 8.2.1, `GantryCutter`: dr = iDirectionR·direction + dOffsetR.
    #[test]
    fn a_cutter_points_along_its_path(
        offset in -PI..PI, clockwise in any::<bool>(), direction in -PI..PI,
        position in [0.0..0.6, -0.2..0.2, -0.15..0.0], trail in 0.0_f64..0.05,
    ) {
        let rotary = RotaryTool { offset, clockwise, ..cutter().rotary.unwrap() };
        let tool = Vector3::new(-trail, 0.0, -0.05);
        let model = GantryDimensions { rotary: Some(rotary), tool, ..gantry() }.model().unwrap();
        let sense = if clockwise { -1.0 } else { 1.0 };
        let [x, y, z] = position;
        let axes = [x, y, z, sense * direction + offset];
        let ahead = Vector3::new(direction.cos(), direction.sin(), 0.0);
        let pose = model.link_poses(&axes)[4];
        prop_assert!((pose * Vector3::x() - ahead).norm() < 1e-12);
        let expected = Point3::new(x, y, z - 0.05) - ahead * trail;
        assert_near(model.tip_position(&axes), expected, 1e-12);
    }

    /// Manual 8.2.3: x = (a − b)/2 − dOffsetX, y = (a + b)/2 − dOffsetY, and the layouts with signs or coordinates
    /// exchanged.
    #[test]
    fn a_belt_moves_both_ways(
        offsets in prop::array::uniform3(-1.0..1.0), position in [-0.5..0.8, -0.5..0.8, -0.1..0.0],
        negative_a in any::<bool>(), negative_b in any::<bool>(), exchanged in any::<bool>(),
        second_first in any::<bool>(),
    ) {
        let [sign_a, sign_b] = [negative_a, negative_b].map(|negative| if negative { -1.0 } else { 1.0 });
        let rows = [[0.5 * sign_a, -0.5 * sign_b], [0.5 * sign_a, 0.5 * sign_b]];
        let factors = if exchanged { [rows[1], rows[0]] } else { rows };
        let indices = if second_first { [1, 0] } else { [0, 1] };
        let motors = [motor("A", indices[0], [-0.5, 0.8]), motor("B", indices[1], [-0.5, 0.8])];
        let belt = HBelt { factors, ..HBelt::new(motors) };
        let dimensions = GantryDimensions::h_belt("h", belt, Some(motor("Z", 2, [-0.1, 0.0])));
        let tool = Vector3::new(0.0, 0.0, -0.05);
        let model = GantryDimensions { offsets, tool, ..dimensions }.model().unwrap();
        let (a, b) = (sign_a * position[indices[0]], sign_b * position[indices[1]]);
        let [difference, sum] = [a - b, a + b].map(|both| 0.5 * both);
        let (x, y) = if exchanged { (sum, difference) } else { (difference, sum) };
        let expected = [x - offsets[0], y - offsets[1], position[2] - offsets[2] - 0.05];
        assert_near(model.tip_position(&position), expected, 1e-12);
    }
}
