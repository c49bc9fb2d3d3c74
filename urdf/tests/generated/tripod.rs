//! Tests of generated tripods: loops, masses, and positions against the manual's transforms.

use super::{assert_refused, bounds, corners_of, meet};
use crate::tests::{assert_near, mass, pose_of, seeded};
use crate::{
    DimensionError, Joint, JointDrive, JointPositions, LoopError, MachineJoint, Model, SolidShape,
    TripodDimensions,
};
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use twin_kinematics::tripod::{Rod, TripodDeviations, TripodDimensions as Rings};

const RINGS: Rings = Rings {
    inner_radius: 0.06,
    outer_radius: 0.25,
    rod_length: 0.4,
    rod_distance: 0.06,
    rotation: PI / 2.0,
};

fn axes(limits: [f64; 2]) -> [MachineJoint; 3] {
    [("A", 0), ("B", 1), ("C", 2)].map(|(name, axis)| MachineJoint::new(name, axis, limits))
}

fn dimensions(rings: &Rings, limits: [f64; 2]) -> TripodDimensions {
    let rods = rings.rods(&TripodDeviations::default()).unwrap();
    TripodDimensions::new("tripod", axes(limits), rods)
}

pub(in crate::tests) fn tripod() -> TripodDimensions {
    let tool = Vector3::new(0.0, 0.0, -0.04);
    TripodDimensions { tool, tool_mass: 0.1, ..dimensions(&RINGS, [0.3, 0.6]) }
}

/// Manual 8.2.6: e, the way from the ends of a pair of rods on the platform out to those on its carriage.
fn eccentricity(rings: &Rings) -> f64 {
    let half = (rings.rod_distance / 2.0).powi(2);
    (rings.outer_radius.powi(2) - half).sqrt() - (rings.inner_radius.powi(2) - half).sqrt()
}

/// Manual 8.2.6: positions of the axes (without offsets) with the platform at `place`.
fn inverse(rings: &Rings, place: &Point3<f64>) -> [f64; 3] {
    let e = eccentricity(rings);
    [0.0, 1.0, 2.0].map(|i| {
        let (sin, cos) = (rings.rotation + i * TAU / 3.0).sin_cos();
        let h2 = (place.x - e * cos).powi(2) + (place.y - e * sin).powi(2);
        // Not all too near to where the rod is level.
        assert!(h2 < 0.96 * rings.rod_length.powi(2), "{place}");
        place.z + (rings.rod_length.powi(2) - h2).sqrt()
    })
}

/// Manual 8.2.6, forward: the platform below carriages at `heights`, as the digest writes it.
fn forward(rings: &Rings, heights: [f64; 3]) -> Point3<f64> {
    let e = eccentricity(rings);
    let mean = heights.iter().sum::<f64>() / 3.0;
    let q = heights.map(|height| height - mean);
    let sum = |of: fn(f64, (f64, f64)) -> f64| -> f64 {
        (0_u8..)
            .zip(q)
            .map(|(i, q)| of(q, (rings.rotation + f64::from(i) * TAU / 3.0).sin_cos()))
            .sum()
    };
    let (cx, cy) =
        (sum(|q, (_, cos)| q * q * cos) / (3.0 * e), sum(|q, (sin, _)| q * q * sin) / (3.0 * e));
    let (dx, dy) = (
        2.0 * sum(|q, (_, cos)| q * cos) / (3.0 * e),
        2.0 * sum(|q, (sin, _)| q * sin) / (3.0 * e),
    );
    let a = 1.0 + dx * dx + dy * dy;
    let b = -2.0 * (cx * dx + cy * dy);
    let c = cx * cx + cy * cy + sum(|q, _| q * q) / 3.0 + e * e - rings.rod_length.powi(2);
    let z = (-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    Point3::new(cx - dx * z, cy - dy * z, z + mean)
}

fn platform(model: &Model, joints: &JointPositions) -> Isometry3<f64> {
    let mut poses = vec![Isometry3::identity(); model.links.len()];
    model.link_poses_at(joints.values(), &mut poses);
    poses[model.tip.link]
}

/// How far the rods are from their lengths: ends on carriage and platform, at any pose of the links.
fn strain(dimensions: &TripodDimensions, axes: &[f64], platform: &Isometry3<f64>) -> f64 {
    let strain = |rod: &Rod| {
        let axis = axes[dimensions.joints[rod.carriage].machine_axis];
        let upper = rod.upper + Vector3::z() * (axis - dimensions.offsets[rod.carriage]);
        ((upper - platform * rod.lower).norm() - rod.length).abs()
    };
    dimensions.rods.iter().map(strain).fold(0.0, f64::max)
}

/// Distance of a point from a solid, 0 inside, for points in the frame of the solid's link.
fn distance(solid: &crate::Solid, point: &Point3<f64>) -> f64 {
    let p = solid.origin.inverse_transform_point(point);
    match solid.shape {
        SolidShape::Box { size } => (p.coords.abs() - size / 2.0).sup(&Vector3::zeros()).norm(),
        SolidShape::Cylinder { radius, length } => {
            let (side, end) = (p.x.hypot(p.y) - radius, p.z.abs() - length / 2.0);
            side.max(0.0).hypot(end.max(0.0))
        }
        SolidShape::Sphere { radius } => (p.coords.norm() - radius).max(0.0),
        SolidShape::Capsule { .. } | SolidShape::Mesh { .. } => panic!("not generated"),
    }
}

fn link(model: &Model, name: &str) -> usize {
    model.links.iter().position(|link| link.name == name).unwrap()
}

#[test]
fn a_tripod_touches_itself_nowhere() {
    let model = tripod().model().unwrap();
    let rod_radius = RINGS.rod_length / 80.0;
    let solid_links: Vec<_> =
        (0..model.links.len()).filter(|link| !model.links[*link].solids.is_empty()).collect();
    assert_eq!(solid_links.len(), 1 + 3 + 6 + 1);
    let (platform, table) = (link(&model, "platform"), 0);
    let turns = |radius| (0..6).map(move |turn| (radius, f64::from(turn) * PI / 3.0 + 0.1));
    for (radius, turn) in [0.0, 0.08, 0.14].into_iter().flat_map(turns) {
        let place = Point3::new(radius * turn.cos(), radius * turn.sin(), 0.05);
        let axes = inverse(&RINGS, &place);
        let poses = model.link_poses(&axes);
        let around = |link: usize| bounds(&model, link, &axes);
        let moving = [1, 2, 3, platform];
        for (index, one) in moving.into_iter().enumerate() {
            for other in moving.into_iter().skip(index + 1) {
                assert!(!meet(&around(one), &around(other)), "{one} {other} at {place}");
            }
        }
        let tip = model.tip_position(&axes);
        assert!(around(table)[0][1].z < tip.z - 0.0199, "{tip}");
        // Carriages and platform against the base, turned as it is: by points on and in them.
        for moving in moving {
            for solid in &model.links[moving].solids {
                for corner in 0..27_u8 {
                    let side = |power: u8| f64::from(corner / power % 3) - 1.0;
                    let half = match solid.shape {
                        SolidShape::Box { size } => size / 2.0,
                        SolidShape::Cylinder { radius, length } => {
                            Vector3::new(radius * 0.7, radius * 0.7, length / 2.0)
                        }
                        SolidShape::Sphere { radius } => Vector3::repeat(radius * 0.57),
                        SolidShape::Capsule { .. } | SolidShape::Mesh { .. } => panic!(),
                    };
                    let inside = Vector3::new(side(1), side(3), side(9)).component_mul(&half);
                    let point = poses[moving] * (solid.origin * Point3::from(inside));
                    for still in &model.links[0].solids {
                        assert!(distance(still, &point) > 0.0, "{moving} at {place}: {still:?}");
                    }
                }
            }
        }
        for number in 1..=6 {
            let rod = link(&model, &format!("rod{number}"));
            for step in 0..=60 {
                // Clear of its own balls.
                let along = 2.0 * 1.8 * rod_radius;
                let along = along + (RINGS.rod_length - 2.0 * along) * f64::from(step) / 60.0;
                let point = poses[rod] * Point3::new(0.0, 0.0, -along);
                for other in solid_links.iter().filter(|other| **other != rod) {
                    let point = poses[*other].inverse_transform_point(&point);
                    for solid in &model.links[*other].solids {
                        let clear = distance(solid, &point);
                        assert!(clear > rod_radius, "rod {number}, link {other} at {place}");
                    }
                }
            }
        }
    }
}

#[test]
fn masses_add_up() {
    let given = TripodDimensions {
        carriage_mass: Some(1.5),
        rod_mass: Some(0.05),
        platform_mass: Some(0.4),
        ..tripod()
    };
    let model = given.model().unwrap();
    assert!((mass(&model) - (4.5 + 0.3 + 0.4 + 0.1)).abs() < 1e-12, "{}", mass(&model));
    let center = |name| model.links[link(&model, name)].inertial.unwrap().center;
    assert_near(center("platform"), [0.0, 0.0, -0.1 * 0.02 / 0.5], 1e-15);
    assert_near(center("rod4"), [0.0, 0.0, -0.2], 1e-15);
    // Derived ones are those of a machine of this size.
    let derived = mass(&tripod().model().unwrap());
    assert!(derived > 1.0 && derived < 10.0, "{derived}");
}

#[test]
fn rods_hang_on_joints_that_nothing_drives() {
    let mut dimensions = tripod();
    dimensions.joints = axes([0.25, 0.75]);
    dimensions.joints.iter_mut().zip([2, 0, 1]).for_each(|(joint, axis)| joint.machine_axis = axis);
    dimensions.offsets = [0.1, 0.0, -0.2];
    let model = dimensions.model().unwrap();
    let passive = |joint: &&Joint| matches!(joint.drive, JointDrive::Passive { .. });
    assert_eq!(model.joints.iter().filter(passive).count(), 15);
    assert_eq!((model.loops.len(), model.joints.len(), model.links.len()), (5, 19, 20));
    let driven: Vec<_> = model.joints.iter().filter_map(|joint| joint.drive.axis()).collect();
    assert_eq!(driven, [2, 0, 1]);
    // At rest every axis is in the middle of its travel.
    let rest = JointPositions::at_rest(&model);
    let place = model.link_poses(&[0.5; 3])[model.tip.link].translation.vector;
    assert!((platform(&model, &rest).translation.vector - place).norm() < 1e-13);
    let found = pose_of(&model, &[0.5; 3], None).unwrap();
    assert_eq!((found.values(), found.steps()), (rest.values(), 0));
    let text = model.to_urdf().unwrap();
    assert_eq!(text.matches("<passive joint=").count(), 15, "{text}");
    assert_eq!(text.matches("<point xyz=\"0 0 -0.4\"/>").count(), 5, "{text}");
    assert_eq!(Model::from_urdf(&text, &["B", "C", "A"]).unwrap(), model);
    // For readers that know nothing of loops each joint moves alone.
    let names: Vec<_> = model.moving_joints().map(|(_, joint)| joint.name.as_str()).collect();
    let read = Model::from_urdf(&crate::tests::plain(&text), &names).unwrap();
    let positions: Vec<_> = model.moving_joints().map(|(index, _)| found.values()[index]).collect();
    let error = read.tip_position(&positions) - model.tip_position(&[0.5; 3]);
    assert!(error.norm() < 1e-14, "{error}");
}

#[test]
fn where_the_rods_do_not_reach_is_said() {
    let model = tripod().model().unwrap();
    // Two carriages of which one would have to be more than two rods above the other.
    let error = pose_of(&model, &[0.0, 1.5, 0.0], None).unwrap_err();
    assert!(matches!(error, LoopError::Open(gap) if gap > 0.01), "{error}");
    // Followed there and back, it is where it was.
    let mut kept = pose_of(&model, &[0.4; 3], None).unwrap();
    let before = kept.clone();
    assert!(kept.follow(&model, &[0.0, 1.5, 0.0]).is_err());
    kept.follow(&model, &[0.4; 3]).unwrap();
    let [before, after] = [before, kept].map(|kept| platform(&model, &kept).translation.vector);
    assert!((before - after).norm() < 1e-12, "{before} {after}");
}

#[test]
fn impossible_tripods_are_named() {
    let changed = |change: fn(&mut TripodDimensions)| {
        let mut dimensions = tripod();
        change(&mut dimensions);
        dimensions.model()
    };
    let refused = |change, said| assert_refused(changed(change), said);
    refused(|d| d.rods[3].length = 0.15, "rod 4 of 150.000 mm is too short …");
    let hang =
        "the rods hang on the carriages [0, 0, 1, 0, 2, 2]; each of 0, 1 and 2 has two of them";
    refused(|d| d.rods[3].carriage = 0, hang);
    refused(|d| d.rods[0].carriage = 3, "the rods hang on the carriages …");
    refused(|d| d.rods[1].upper.y = f64::NAN, "an end of a rod is not a finite number");
    refused(|d| d.offsets[2] = f64::INFINITY, "an offset is not a finite number");
    refused(|d| d.joints[2].machine_axis = 0, "joints …");
    refused(|d| d.rod_radius = Some(0.1), "rod …");
    refused(|d| d.platform_mass = Some(0.0), "the mass of the platform is 0; …");
    // In the middle of the travel one carriage would be more than a rod above the others.
    let apart = changed(|d| d.joints[1].position_limits = [2.0, 3.0]).unwrap_err();
    assert!(matches!(apart, DimensionError::RodsApart(gap) if gap > 0.1), "{apart}");
}

proptest! {
    #![proptest_config(seeded())]

    /// Manual 8.2.6, both ways: the tool is where the closed forms say, the platform level, every loop closed.
    #[test]
    fn the_tip_of_a_tripod_is_where_its_transform_says(
        outer_radius in 0.2_f64..0.6, inner in 0.15_f64..0.8, distance in 0.2_f64..1.9, longer in 1.03_f64..3.0, rotation in -PI..PI,
        radius in 0.0..0.6, turn in -PI..PI, z in -0.5..0.5, tool in [-0.1..0.1, -0.1..0.1, -0.3..0.0],
        offsets in prop::array::uniform3(-1.0..1.0),
    ) {
        let inner_radius = outer_radius * inner;
        let distance = inner_radius * distance;
        let radius = radius * outer_radius;
        // Long enough to reach anywhere at this radius.
        let half: f64 = distance / 2.0;
        let chord = |radius: f64| (radius * radius - half * half).sqrt();
        let across = chord(outer_radius) - chord(inner_radius);
        let length = longer * (across + radius);
        let rings =
            Rings { inner_radius, outer_radius, rod_length: length, rod_distance: distance, rotation };
        let place = Point3::new(radius * turn.cos(), radius * turn.sin(), z);
        let heights = inverse(&rings, &place);
        let positions = [0, 1, 2].map(|axis| heights[axis] + offsets[axis]);
        let mut dimensions = TripodDimensions { offsets, tool: tool.into(), ..dimensions(&rings, [0.0; 2]) };
        // The rest need not be where the machine goes.
        dimensions.joints.iter_mut().zip(offsets).for_each(|(joint, offset)| {
            joint.position_limits = [z + offset - 0.3, z + offset + 0.6];
        });
        let model = dimensions.model().unwrap();

        let found = pose_of(&model, &positions, None).unwrap();
        prop_assert!(found.residual() < 1e-12, "{}", found.residual());
        let tip = model.tip_position(&positions);
        assert_near(tip, place + Vector3::from(tool), 1e-11);
        let platform = platform(&model, &found);
        prop_assert!(platform.rotation.angle() < 1e-11, "{platform}");
        assert_near(forward(&rings, heights) + Vector3::from(tool), tip, 1e-11);
        prop_assert!(strain(&dimensions, &positions, &platform) < 1e-12);
        // The platform below its carriages.
        prop_assert!(heights.iter().all(|height| *height > platform.translation.z));
    }

    /// Rods and ends as measured: the platform is where all six rods have their lengths, tilted a little, and does not jump.
    #[test]
    fn measured_rods_have_their_lengths(
        errors in prop::collection::vec(-2e-3..2e-3, 42), radius in 0.0..0.12, turn in -PI..PI, height in 0.0..0.2,
    ) {
        let mut dimensions = tripod();
        for (rod, errors) in dimensions.rods.iter_mut().zip(errors.chunks(7)) {
            rod.upper += Vector3::new(errors[0], errors[1], errors[2]);
            rod.lower += Vector3::new(errors[3], errors[4], errors[5]);
            rod.length += errors[6];
        }
        let model = dimensions.model().unwrap();
        let place = Point3::new(radius * turn.cos(), radius * turn.sin(), height);
        let axes = inverse(&RINGS, &place);
        let mut kept = pose_of(&model, &axes, None).unwrap();
        prop_assert!(kept.residual() < 1e-14);
        let start = model.link_poses(&axes)[model.tip.link];
        prop_assert!(strain(&dimensions, &axes, &start) < 1e-14);
        // A few millimetres from the nominal place, tilted by a few degrees.
        let off = (start.translation.vector - place.coords).norm();
        prop_assert!(off > 1e-6 && off < 0.05, "{off}");
        let tilt = Rotation3::from(start.rotation).angle();
        prop_assert!(tilt > 1e-5 && tilt < 0.4, "{tilt}");
        // A millimetre on from there, in as many steps as a machine takes in a tenth of a second.
        for step in 1..=10 {
            let up = 1e-4 * f64::from(step);
            let axes = axes.map(|axis| axis + up);
            kept.follow(&model, &axes).unwrap();
            prop_assert!(kept.steps() <= 3, "{}", kept.steps());
            let risen = platform(&model, &kept).translation.vector - start.translation.vector;
            prop_assert!((risen - Vector3::z() * up).norm() < 1e-13, "{risen}");
        }
    }
}

#[test]
fn corners_of_the_travel_are_closed_or_refused() {
    let model = TripodDimensions { joints: axes([0.35, 0.5]), ..tripod() }.model().unwrap();
    let mut kept = JointPositions::at_rest(&model);
    for axes in corners_of(&[[0.35, 0.5]; 3]) {
        kept.follow(&model, &axes).unwrap();
        let expected = forward(&RINGS, [axes[0], axes[1], axes[2]]) + Vector3::new(0.0, 0.0, -0.04);
        assert_near(model.tip_position(&axes), expected, 1e-12);
        assert_near(platform(&model, &kept) * model.tip.point, expected, 1e-12);
    }
}
