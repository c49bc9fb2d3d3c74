//! Every machine file that is shipped, whatever it may be: one machine in several descriptions, and what is written of it.

use super::workspace;
use crate::machine::Machine;
use crate::plant::Plant;
use crate::setpoint::AxisSetpoint;
use crate::simulated::Simulated;
use nalgebra::{Isometry3, Matrix3, Matrix4, Point3, Vector3};
use std::f64::consts::TAU;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics, Pose, ToolMotion};
use twin_motion::Place;
use twin_urdf::{Joint, JointKind, JointPositions, Model, UrdfOptions};

/// What forward kinematics may be apart, m.
const SAME: f64 = 1e-10;

/// All of `machines/`, by name.
fn machines() -> Vec<Machine> {
    let files = std::fs::read_dir(workspace().join("machines")).unwrap();
    let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    assert!(paths.len() >= 9, "{paths:?}");
    let load =
        |path: &std::path::PathBuf| Machine::load(path).unwrap_or_else(|error| panic!("{error:?}"));
    paths.iter().map(load).collect()
}

/// Every axis back and forth about the middle of its travel, each at a pace of its own and well within its limits; one without limits goes
/// to a turn and more.
fn swing(machine: &Machine, time: f64) -> AxisMotion {
    let mut rows = [Vec::new(), Vec::new(), Vec::new()];
    for (index, axis) in (0_u8..).zip(&machine.axes) {
        let [low, high] = if axis.limited { axis.position_limits } else { [-15.0, 15.0] };
        let (middle, half) = (low.midpoint(high), 0.2 * (high - low));
        // Velocity and acceleration are half·pace and half·pace² at most.
        let fastest =
            (0.8 * axis.max_velocity / half).min((0.8 * axis.max_acceleration / half).sqrt());
        let pace = fastest.min(TAU * (1.0 + 0.2 * f64::from(index)));
        let (sin, cos) = (pace * time).sin_cos();
        let motion = [middle - half * cos, half * pace * sin, half * pace * pace * cos];
        rows.iter_mut().zip(motion).for_each(|(row, value)| row.push(value));
    }
    let [position, velocity, acceleration] = rows.map(AxisVector::from_values);
    AxisMotion { position, velocity, acceleration }
}

/// Where `joint` puts its child in its parent: written out, in no way as [`Model`] does it.
fn matrix(joint: &Joint, position: f64) -> Matrix4<f64> {
    let mut origin = Matrix4::identity();
    let [i, j, k, w] = joint.origin.rotation.coords.into();
    let rotation = Matrix3::new(
        1.0 - 2.0 * (j * j + k * k),
        2.0 * (i * j - k * w),
        2.0 * (i * k + j * w),
        2.0 * (i * j + k * w),
        1.0 - 2.0 * (i * i + k * k),
        2.0 * (j * k - i * w),
        2.0 * (i * k - j * w),
        2.0 * (j * k + i * w),
        1.0 - 2.0 * (i * i + j * j),
    );
    origin.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    origin.fixed_view_mut::<3, 1>(0, 3).copy_from(&joint.origin.translation.vector);
    let axis = joint.axis.into_inner();
    let mut motion = Matrix4::identity();
    match joint.kind {
        JointKind::Revolute => {
            // Rodrigues.
            let cross = axis.cross_matrix();
            let (sin, cos) = position.sin_cos();
            let turn = Matrix3::identity() + cross * sin + cross * cross * (1.0 - cos);
            motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        }
        JointKind::Prismatic => {
            motion.fixed_view_mut::<3, 1>(0, 3).copy_from(&(axis * position));
        }
        JointKind::Fixed => {}
    }
    origin * motion
}

/// The machine as whoever reads its URDF has it.
struct Read {
    model: Model,
    joints: JointPositions,
}

impl Read {
    fn of(machine: &Machine) -> Self {
        let text = machine.model.to_urdf().unwrap();
        let folder = machine.path.parent().unwrap();
        let read = Model::read_urdf(&text, &folder.join("it.urdf"), &UrdfOptions::default());
        let model = read.unwrap_or_else(|error| panic!("{}: {error}", machine.name)).model;
        let joints = JointPositions::at_rest(&model);
        Self { model, joints }
    }

    /// The tip with the axes at `axes`: one matrix after the other.
    fn tip(&mut self, axes: &AxisVector) -> Point3<f64> {
        self.joints.follow(&self.model, axes).unwrap();
        let mut matrices = vec![Matrix4::identity()];
        for (joint, position) in self.model.joints.iter().zip(self.joints.values()) {
            matrices.push(matrices[joint.parent] * matrix(joint, *position));
        }
        let tip = self.model.tip;
        Point3::from_homogeneous(matrices[tip.link] * tip.point.to_homogeneous()).unwrap()
    }
}

/// The largest distance of the links of two sets of poses, turns included, m.
fn apart(one: &[Isometry3<f64>], other: &[Isometry3<f64>]) -> f64 {
    assert_eq!(one.len(), other.len());
    let points = [Vector3::zeros(), Vector3::x(), Vector3::y()].map(|way| Point3::from(way * 0.3));
    let pairs = one.iter().zip(other);
    pairs
        .flat_map(|(one, other)| points.map(|point| (one * point - other * point).norm()))
        .fold(0.0, f64::max)
}

/// Transform, chain of joints, URDF and rapier's bodies have the tool and the links in the same places, at every step of machines
/// that move as their drives have them.
#[test]
fn transform_chain_urdf_and_bodies_agree() {
    for machine in machines() {
        let name = &machine.name;
        let mut read = Read::of(&machine);
        let mut kept = JointPositions::at_rest(&machine.model);
        let start = swing(&machine, 0.0).position;
        let mut twin = Simulated::new(&machine, &start).unwrap();
        let [mut least, mut most] = [start, start];
        let mut worst = [0.0_f64; 4];
        for step in 0..=800_i32 {
            let axes = swing(&machine, f64::from(step) * 1e-3);
            let setpoint = AxisSetpoint {
                time_ns: i64::from(step) * machine.cycle_ns,
                place: Place::default(),
                axes,
                tool: ToolMotion::at_rest(Pose::at(0.0, 0.0, 0.0)),
                m_call: None,
                path_velocity: 0.0,
                feed: None,
            };
            twin.command(&setpoint).unwrap();
            let measured = twin.feedback().unwrap().unwrap().position;
            for (index, value) in measured.iter().enumerate() {
                least[index] = least[index].min(*value);
                most[index] = most[index].max(*value);
            }
            let transform = machine.kinematics.forward(&measured).unwrap().position;
            kept.follow(&machine.model, &measured).unwrap();
            let mut links = vec![Isometry3::identity(); machine.model.links.len()];
            machine.model.link_poses_at(kept.values(), &mut links);
            let bodies = twin.physics().link_poses();
            let tip = machine.model.tip;
            let errors = [
                (links[tip.link] * tip.point - transform).norm(),
                (read.tip(&measured) - transform).norm(),
                (bodies[tip.link] * tip.point - transform).norm(),
                apart(&bodies, &links),
            ];
            for (worst, error) in worst.iter_mut().zip(errors) {
                assert!(error <= SAME, "{name} at step {step}: {errors:?} m");
                *worst = worst.max(error);
            }
        }
        println!("{name}: chain, URDF, bodies' tip, bodies' links at most {worst:?} m apart");
        // All of them have been somewhere.
        for (index, axis) in machine.axes.iter().enumerate() {
            let (way, far) = (most[index] - least[index], 0.08 * axis.max_velocity);
            assert!(way > far, "{name}: {} made only {way} (m or rad)", axis.name);
        }
        assert!(!machine.model.links[machine.model.tip.link].solids.is_empty(), "{name}: no body");
    }
}
