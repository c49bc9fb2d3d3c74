//! Tests of the crate, and the machines that several of them share.

mod bind;
mod generated;
mod hostile;
mod inertial;
mod lines;
mod loops;
mod meshes;
mod mimic;
mod read;
mod refused;
mod round_trip;

use crate::{
    GantryDimensions, JointPositions, LoopError, MachineJoint, Model, ScaraDimensions, UrdfOptions,
};
use nalgebra::{Point3, Vector3};
use proptest::test_runner::{Config as ProptestConfig, RngSeed};
use std::path::Path;

/// The same cases in every run; `PROPTEST_CASES` sets their number.
fn seeded() -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// The model of a text, an axis for every joint that moves.
fn read(text: &str) -> Model {
    Model::read_urdf(text, Path::new(""), &UrdfOptions::default()).unwrap().model
}

/// The mass of all links.
fn mass(model: &Model) -> f64 {
    model.links.iter().filter_map(|link| link.inertial).map(|inertial| inertial.mass).sum()
}

#[track_caller]
fn assert_near(found: Point3<f64>, expected: impl Into<Point3<f64>>, within: f64) {
    let expected = expected.into();
    assert!((found - expected).norm() < within, "{found} {expected}");
}

/// URDF text without what only we read.
fn plain(text: &str) -> String {
    let (from, to) = (text.find("<twin>").unwrap(), text.find("</twin>").unwrap());
    text[..from].to_owned() + &text[to + "</twin>".len()..]
}

/// The SCARA of the SoftMotion vectors, with a quill and a tool.
fn scara() -> ScaraDimensions {
    let arm_joints =
        [MachineJoint::new("A", 0, [-2.5, 2.5]), MachineJoint::new("B", 1, [-2.6, 2.6])];
    let quill_joint = MachineJoint::new("Z", 2, [-0.1, 0.05]);
    let dimensions = ScaraDimensions::new("scara", arm_joints, Some(quill_joint), [0.25, 0.2]);
    ScaraDimensions { tool: Vector3::new(0.0, 0.0, -0.08), tool_mass: 0.3, ..dimensions }
}

/// The joint positions of `model` with its axes at `axes`, passive joints from `start` or else from where they rest.
fn pose_of(
    model: &Model,
    axes: &[f64],
    start: Option<&[f64]>,
) -> Result<JointPositions, LoopError> {
    let mut positions = JointPositions::at_rest(model);
    if let Some(start) = start {
        positions.start_from(start)?;
    }
    positions.follow(model, axes)?;
    Ok(positions)
}

fn gantry() -> GantryDimensions {
    let joint = |name: &str, axis, limits| MachineJoint {
        velocity_limit: Some(0.5),
        effort_limit: Some(200.0),
        ..MachineJoint::new(name, axis, limits)
    };
    let plane = [joint("X", 0, [0.0, 0.6]), joint("Y", 1, [-0.2, 0.2])];
    GantryDimensions {
        tool: Vector3::new(0.0, 0.0, -0.05),
        tool_mass: 0.2,
        ..GantryDimensions::new("gantry", plane, Some(joint("Z", 2, [-0.15, 0.0])))
    }
}
