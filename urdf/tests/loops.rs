//! Tests of loop closure and of joints that several axes move.

use super::{assert_near, pose_of, seeded};
use crate::{Joint, JointDrive, JointKind, Link, Loop, LoopError, Model, Tip, UrdfOptions};
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::path::Path;

/// With the axis of the joint.
type Kind = (JointKind, [f64; 3]);

const TURNING: Kind = (JointKind::Revolute, [0.0, 0.0, 1.0]);
const ALONG_X: Kind = (JointKind::Prismatic, [1.0, 0.0, 0.0]);
const ALONG_Y: Kind = (JointKind::Prismatic, [0.0, 1.0, 0.0]);

/// A link of no body behind a joint of `parent`.
fn add(model: &mut Model, kind: Kind, parent: usize, at: [f64; 3], drive: JointDrive) -> usize {
    let child = model.links.len();
    let name = format!("part{child}");
    model.links.push(Link::new(name.clone(), None, Vec::new()));
    let (kind, axis) = kind;
    let origin = Isometry3::from(Vector3::from(at));
    let axis = Unit::new_normalize(Vector3::from(axis));
    model.joints.push(Joint::new(name, kind, [parent, child], origin, axis, drive));
    child
}

fn base() -> Model {
    Model {
        name: "linkage".to_owned(),
        links: vec![Link::new("base", None, Vec::new())],
        joints: Vec::new(),
        loops: Vec::new(),
        tip: Tip { link: 0, point: Point3::origin() },
    }
}

/// A crank of length `crank` about z at the origin, a rod of length `rod`, and a slider on the x axis in front of it.
fn slider_crank(crank: f64, rod: f64) -> Model {
    let mut model = base();
    let passive = |rest| JointDrive::Passive { rest };
    let arm = add(&mut model, TURNING, 0, [0.0; 3], JointDrive::Axis(0));
    let coupler = add(&mut model, TURNING, arm, [crank, 0.0, 0.0], passive(0.0));
    let slider = add(&mut model, ALONG_X, 0, [0.0; 3], passive(crank + rod));
    let points = [Point3::new(rod, 0.0, 0.0), Point3::origin()];
    model.loops.push(Loop { links: [coupler, slider], points });
    model.tip = Tip { link: slider, point: Point3::new(0.0, 0.0, 0.1) };
    model
}

proptest! {
    #![proptest_config(seeded())]

    /// s = r·cos φ + √(l² − r²·sin² φ), in both directions and from any start.
    #[test]
    fn a_slider_is_where_its_crank_puts_it(
        crank in 0.05..0.5, longer in 1.1..3.0, angle in -3.0 * PI..3.0 * PI, before in -3.0..3.0,
    ) {
        let rod = crank * longer;
        let model = slider_crank(crank, rod);
        let slider = |angle: f64| {
            crank * angle.cos() + (rod * rod - (crank * angle.sin()).powi(2)).sqrt()
        };
        let found = pose_of(&model, &[angle], None).unwrap();
        let size = 2.0 * (crank + rod);
        prop_assert!(found.residual() <= 1e-14 * size, "{found:?}");
        // Where crank and rod are at right angles, nothing is lost; where they are in line neither.
        let error = (found.values()[2] - slider(angle)).abs();
        prop_assert!(error <= 1e-12, "{error} {found:?}");
        assert_near(model.tip_position(&[angle]), [slider(angle), 0.0, 0.1], 1e-12);

        // From the instant before it takes a few steps, and only the start differs.
        let mut kept = pose_of(&model, &[angle - 0.01 * before], None).unwrap();
        kept.follow(&model, &[angle]).unwrap();
        prop_assert!((kept.values()[2] - slider(angle)).abs() <= 1e-12);
        prop_assert!(kept.steps() <= 6, "{}", kept.steps());
        let again = pose_of(&model, &[angle], Some(found.values())).unwrap();
        prop_assert_eq!((again.values(), again.steps()), (found.values(), 0));
        let mut poses = model.link_poses(&[0.0]);
        model.link_poses_at(found.values(), &mut poses);
        prop_assert_eq!(poses, model.link_poses(&[angle]));
    }
}

#[test]
fn what_cannot_be_joined_is_said() {
    // The rod is too short to let the crank stand across.
    let model = slider_crank(0.3, 0.2);
    let error = pose_of(&model, &[PI / 2.0], None).unwrap_err();
    let LoopError::Open(gap) = error else { panic!("{error}") };
    assert!((gap - 0.1).abs() < 1e-6, "the crank pin is 0.3 m away, the rod 0.2 m long: {gap}");
    assert!(error.to_string().starts_with("the links of the machine cannot be joined"), "{error}");
    // A picture shows it as nearly joined as it can be.
    let poses = model.link_poses(&[PI / 2.0]);
    let ends = [poses[2] * Point3::new(0.2, 0.0, 0.0), poses[3] * Point3::origin()];
    assert!(((ends[0] - ends[1]).norm() - gap).abs() < 1e-9);
    // Having been out there, it comes back.
    let mut kept = crate::JointPositions::at_rest(&model);
    assert!(kept.follow(&model, &[PI / 2.0]).is_err());
    kept.follow(&model, &[0.5]).unwrap();

    for (axis, start, expected) in [
        (f64::NAN, None, LoopError::NotFinite),
        (0.0, Some(&[0.0, f64::NAN, 0.0][..]), LoopError::NotFinite),
        (0.0, Some(&[0.0][..]), LoopError::Start { given: 1, expected: 3 }),
    ] {
        assert_eq!(pose_of(&model, &[axis], start).unwrap_err(), expected);
    }
    // Links that are not there are at the origin, and so is nothing that could close the loop.
    let mut odd = model.clone();
    odd.loops[0].links[1] = 9;
    assert!(pose_of(&odd, &[0.5], None).is_err());
    let mut stiff = model;
    stiff.joints.iter_mut().for_each(|joint| joint.drive = JointDrive::Axis(0));
    assert!(matches!(pose_of(&stiff, &[0.5], None), Err(LoopError::Open(_))));
}

/// Two motors, one belt: the joints are half the sum and half the difference.
#[test]
fn joints_that_axes_share() {
    let mut model = base();
    let parts = |a, b| JointDrive::Combination(vec![(0, a), (1, b)]);
    let x = add(&mut model, ALONG_X, 0, [0.1, 0.0, 0.0], parts(0.5, -0.5));
    model.tip.link = add(&mut model, ALONG_Y, x, [0.0, 0.2, 0.0], parts(0.5, 0.5));
    assert_near(model.tip_position(&[0.7, 0.3]), [0.3, 0.7, 0.0], 1e-15);
    let found = pose_of(&model, &[0.7, 0.3], None).unwrap();
    assert!((found.values()[0] - 0.2).abs() < 1e-15 && (found.values()[1] - 0.5).abs() < 1e-15);
    assert_eq!((found.residual(), found.steps()), (0.0, 0));
}

#[test]
fn couplings_come_back() {
    let mut model = slider_crank(0.3, 0.5);
    model.joints[0].drive = JointDrive::Combination(vec![(0, 0.5), (1, -0.1)]);
    model.joints[0].name = "a --> b".to_owned();
    model.links[2].name = "rod---".to_owned();
    let text = model.to_urdf().unwrap();
    let beyond = &text[text.find("<twin>").unwrap()..text.find("</twin>").unwrap()];
    for said in [
        "<drive joint=\"a --&gt; b\">",
        "<part axis=\"1\" factor=\"-0.1\"/>",
        "<passive joint=\"part3\" rest=\"0.8\"/>",
        "<loop from=\"rod---\" to=\"part3\">",
    ] {
        assert!(beyond.contains(said), "{said}: {text}");
    }
    let read = Model::read_urdf(&text, Path::new(""), &UrdfOptions::default()).unwrap();
    assert_eq!((read.model, read.warnings), (model.clone(), Vec::new()));
    assert_eq!(Model::from_urdf(&text, &["a", "b"]).unwrap(), model);
    assert!(Model::from_urdf(&text, &["a", "b", "c"]).is_err(), "nothing moves with c");

    let refused = |from: &str, to: &str, expected: &str| {
        let text = text.replacen(from, to, 1);
        let refusal = Model::read_urdf(&text, Path::new("m.urdf"), &UrdfOptions::default());
        let refusal = refusal.unwrap_err();
        let line = text.lines().nth(usize::try_from(refusal.line).unwrap() - 1).unwrap();
        assert!(line.contains(to) || line.contains("<loop"), "{refusal}: {line}");
        assert!(refusal.to_string().ends_with(expected), "{refusal}");
    };
    let no_joint = "<twin>: there is no joint other that moves and mimics no other";
    refused("<passive joint=\"part3\"", "<passive joint=\"other\"", no_joint);
    refused("from=\"rod---\"", "from=\"other\"", "<twin>: there is no link other");
    refused("rest=\"0.8\"", "rest=\"inf\"", "joint part3: its rest is not a finite number");
    refused("axis=\"1\"", "axis=\"-1\"", "expected a whole number from 0 to 255");
    refused("<point ", "<pint ", "<twin>: a loop has two points, not 1");
}
