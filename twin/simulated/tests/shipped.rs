//! Tests of every shipped machine file: its descriptions agree, and its URDF export is valid.

use super::workspace;
use crate::simulated::Simulated;
use nalgebra::{Isometry3, Matrix3, Matrix4, Point3, Vector3};
use std::f64::consts::TAU;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics};
use twin_machine::Machine;
use twin_physics::PhysicsMachine;
use twin_urdf::{Joint, JointKind, JointPositions, Loaded, Model, Solid, SolidShape, UrdfOptions};

/// Largest difference of forward kinematics, m.
pub(super) const SAME: f64 = 1e-10;

/// All of `machines/`, by name.
pub(super) fn machines() -> Vec<Machine> {
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
    let placed = |turn: &Matrix3<f64>, way: &Vector3<f64>| {
        let mut matrix = turn.to_homogeneous();
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(way);
        matrix
    };
    let origin = placed(&rotation, &joint.origin.translation.vector);
    let axis = joint.axis.into_inner();
    let motion = match joint.kind {
        JointKind::Revolute => {
            // Rodrigues.
            let cross = axis.cross_matrix();
            let (sin, cos) = position.sin_cos();
            let turn = Matrix3::identity() + cross * sin + cross * cross * (1.0 - cos);
            turn.to_homogeneous()
        }
        JointKind::Prismatic => placed(&Matrix3::identity(), &(axis * position)),
        JointKind::Fixed => Matrix4::identity(),
    };
    origin * motion
}

/// The URDF of a machine, read again.
fn read_again(machine: &Machine) -> Loaded {
    let text = machine.model.to_urdf().unwrap();
    let path = machine.path.with_extension("urdf");
    let read = Model::read_urdf(&text, &path, &UrdfOptions::default());
    read.unwrap_or_else(|error| panic!("{}: {error}", machine.name))
}

/// The largest distance of the links of two sets of poses, turns included, m.
fn apart(one: &[Isometry3<f64>], other: &[Isometry3<f64>]) -> f64 {
    assert_eq!(one.len(), other.len());
    let points = [Vector3::zeros(), Vector3::x(), Vector3::y()].map(|way| Point3::from(way * 0.3));
    let pairs = one.iter().zip(other);
    let ways = pairs.flat_map(|(one, other)| points.map(|point| one * point - other * point));
    ways.map(|way| way.norm()).fold(0.0, f64::max)
}

/// The descriptions of a machine, to be compared at any axis positions.
pub(super) struct Descriptions {
    /// The machine as whoever reads its URDF has it, and its joints.
    read: Model,
    joints: JointPositions,
    kept: JointPositions,
}

impl Descriptions {
    pub(super) fn of(machine: &Machine) -> Self {
        let read = read_again(machine).model;
        let joints = JointPositions::at_rest(&read);
        Self { read, joints, kept: JointPositions::at_rest(&machine.model) }
    }

    /// The tip of the URDF with the axes at `axes`: one matrix after the other.
    fn tip(&mut self, axes: &AxisVector) -> Point3<f64> {
        self.joints.follow(&self.read, axes).unwrap();
        let mut matrices = vec![Matrix4::identity()];
        for (joint, position) in self.read.joints.iter().zip(self.joints.values()) {
            matrices.push(matrices[joint.parent] * matrix(joint, *position));
        }
        let tip = self.read.tip;
        Point3::from_homogeneous(matrices[tip.link] * tip.point.to_homogeneous()).unwrap()
    }

    /// Distances between the transform and chain, URDF and rapier's bodies, and of all links of chain and bodies, m.
    pub(super) fn errors(
        &mut self,
        machine: &Machine,
        physics: &PhysicsMachine,
        axes: &AxisVector,
    ) -> [f64; 4] {
        let (model, tip) = (&machine.model, machine.model.tip);
        let transform = machine.kinematics.forward(axes).unwrap().position;
        self.kept.follow(model, axes).unwrap();
        let mut links = vec![Isometry3::identity(); model.links.len()];
        model.link_poses_at(self.kept.values(), &mut links);
        let bodies = physics.link_poses();
        [
            (links[tip.link] * tip.point - transform).norm(),
            (self.tip(axes) - transform).norm(),
            (bodies[tip.link] * tip.point - transform).norm(),
            apart(&bodies, &links),
        ]
    }
}

/// Transform, chain of joints, URDF and rapier's bodies have the tool and the links in the same places, at every step of machines
/// that move as their drives have them.
#[test]
fn transform_chain_urdf_and_bodies_agree() {
    for mut machine in machines() {
        // Where a machine moves through what is around it.
        machine.collision = None;
        let name = &machine.name;
        let mut descriptions = Descriptions::of(&machine);
        let start = swing(&machine, 0.0).position;
        let mut twin = Simulated::new(&machine, &start).unwrap();
        let [mut least, mut most] = [start, start];
        for step in 0..=800_i32 {
            let axes = swing(&machine, f64::from(step) * 1e-3);
            let time_ns = i64::from(step) * machine.cycle_ns;
            let measured = super::step(&mut twin, time_ns, axes).unwrap();
            for (index, value) in measured.iter().enumerate() {
                least[index] = least[index].min(*value);
                most[index] = most[index].max(*value);
            }
            let errors = descriptions.errors(&machine, twin.physics(), &measured);
            assert!(errors.iter().all(|error| *error <= SAME), "{name} at {step}: {errors:?} m");
        }
        // All of them have been somewhere.
        for (index, axis) in machine.axes.iter().enumerate() {
            let (way, far) = (most[index] - least[index], 0.08 * axis.max_velocity);
            assert!(way > far, "{name}: {} made only {way} (m or rad)", axis.name);
        }
        assert!(!machine.model.links[machine.model.tip.link].solids.is_empty(), "{name}: no body");
    }
}

/// Every machine is a URDF that comes back to the last digit, with a picture and a mass of everything that moves.
#[test]
fn every_machine_is_a_urdf() {
    for machine in machines() {
        let (name, model) = (&machine.name, &machine.model);
        let read = read_again(&machine);
        assert_eq!((&read.model, read.warnings.as_slice()), (model, [].as_slice()), "{name}");
        let text = model.to_urdf().unwrap();
        let solids: usize = model.links.iter().map(|link| link.solids.len()).sum();
        assert_eq!(text.matches("<visual>").count(), solids, "{name}");
        assert_eq!(text.matches("<collision>").count(), solids, "{name}");
        let weighed = model.links.iter().filter(|link| link.inertial.is_some()).count();
        assert_eq!(text.matches("<inertial>").count(), weighed, "{name}");
        for link in &model.links[1..] {
            // The crosses of ball joints are nothing but joints.
            let is_frame = link.solids.is_empty() && machine.kind == "tripod";
            // The mass of a holder is that of the tool.
            let is_holder = link.name == "holder";
            assert!(link.inertial.is_some() || is_frame || is_holder, "{name} {}", link.name);
            assert!(!link.solids.is_empty() || link.inertial.is_none(), "{name} {}", link.name);
        }
    }
}

/// What moves is a body that can be: its mass above 0, its inertia symmetric, positive definite and no moment of it larger than the
/// other two together, its centre of mass within the box around it.
#[test]
fn every_link_is_a_possible_body() {
    for machine in machines() {
        for link in &machine.model.links {
            let Some(body) = link.inertial else { continue };
            let about = format!("{} {}: {body:?}", machine.name, link.name);
            let moments = body.inertia.symmetric_eigenvalues();
            assert!(body.mass > 0.0 && moments.min() > 0.0, "{about}");
            assert!((body.inertia - body.inertia.transpose()).amax() < 1e-15, "{about}");
            assert!(2.0 * moments.max() <= moments.sum() * (1.0 + 1e-12), "{about}");
            for way in [Vector3::x(), Vector3::y(), Vector3::z()] {
                let reach = |way: Vector3<f64>| {
                    let solids = link.solids.iter();
                    let ends = solids.map(|solid| way.dot(&farthest(solid, &solid.origin, &way)));
                    ends.fold(f64::NEG_INFINITY, f64::max)
                };
                let along = way.dot(&body.center.coords);
                assert!(-reach(-way) <= along && along <= reach(way), "{about}");
            }
        }
    }
}

/// The point of a solid at `pose` that is farthest along `way`.
pub(super) fn farthest(solid: &Solid, pose: &Isometry3<f64>, way: &Vector3<f64>) -> Vector3<f64> {
    let own = pose.inverse_transform_vector(way);
    let ball = |radius: f64| own.try_normalize(0.0).unwrap_or_default() * radius;
    let up = |half: f64| Vector3::z() * half.copysign(own.z);
    let point = match &solid.shape {
        SolidShape::Box { size } => own.zip_map(size, |own, edge| (0.5 * edge).copysign(own)),
        SolidShape::Cylinder { radius, length } => {
            let across = Vector3::new(own.x, own.y, 0.0).try_normalize(0.0).unwrap_or_default();
            across * *radius + up(0.5 * length)
        }
        SolidShape::Sphere { radius } => ball(*radius),
        SolidShape::Capsule { radius, length } => ball(*radius) + up(0.5 * length),
        SolidShape::Mesh { .. } => panic!("none is shipped"),
    };
    (pose * Point3::from(point)).coords
}

/// What touches does not meet: a rod ends on its ball. m.
const TOUCHING: f64 = 1e-12;

/// Whether a plane parts two solids: one at right angles to an edge of either or to one of each, which is all that boxes need, or that to
/// which Gilbert's iteration leads, towards the least difference of a point of one and a point of the other (*An iterative procedure for
/// computing the minimum of a quadratic form on a convex set*, 1966).
fn are_parted(one: (&Solid, Isometry3<f64>), other: (&Solid, Isometry3<f64>)) -> bool {
    // The least difference along a way from `other` to `one`.
    let nearest =
        |way: &Vector3<f64>| farthest(one.0, &one.1, &-way) - farthest(other.0, &other.1, way);
    let parts = |way: Vector3<f64>| {
        way.try_normalize(1e-9).is_some_and(|way| way.dot(&nearest(&way)) > -TOUCHING)
    };
    let edges =
        |pose: &Isometry3<f64>| [Vector3::x(), Vector3::y(), Vector3::z()].map(|edge| pose * edge);
    let (ones, others) = (edges(&one.1), edges(&other.1));
    let crossed = ones.iter().flat_map(|one| others.map(|other| one.cross(&other)));
    let ways: Vec<_> = ones.iter().chain(&others).copied().chain(crossed).collect();
    if ways.iter().any(|way| parts(*way) || parts(-way)) {
        return true;
    }
    let mut least = one.1.translation.vector - other.1.translation.vector;
    for _ in 0..10_000 {
        if parts(least) {
            return true;
        }
        let nearest = nearest(&least);
        let way = nearest - least;
        if way.norm_squared() == 0.0 {
            return false;
        }
        least += way * (-least.dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    }
    false
}

/// The links whose solids meet with the axes at `axes`.
fn meeting(model: &Model, axes: &AxisVector) -> Vec<[String; 2]> {
    let poses = model.link_poses(axes);
    let placed = |link: usize| {
        let solids = &model.links[link].solids;
        solids.iter().map(|solid| (solid, poses[link] * solid.origin)).collect::<Vec<_>>()
    };
    let mut found = Vec::new();
    for one in 0..model.links.len() {
        for other in 0..one {
            let (ones, others) = (placed(one), placed(other));
            let parted = ones.iter().all(|a| others.iter().all(|b| are_parted(*a, *b)));
            if !parted {
                found.push([other, one].map(|link| model.links[link].name.clone()));
            }
        }
    }
    found
}

/// At the start and at two other positions solids of different links do not meet, except quills of SCARAs, whose arms are boxes
/// without a bore, and the tool in its holder.
#[test]
fn solids_of_different_links_do_not_meet() {
    for machine in machines() {
        let bored = machine.model.links.iter().any(|link| link.name == "arm2");
        let held = machine.model.links.iter().any(|link| link.name == "holder");
        let expected = bored.then_some(["arm2", "quill"]).into_iter();
        let expected = expected.chain(held.then_some(["quill", "holder"]));
        let expected: Vec<_> = expected.map(|pair| pair.map(str::to_owned)).collect();
        let [early, late] = [0.0, 0.5].map(|time| swing(&machine, time).position);
        for axes in [machine.start_axes().unwrap(), early, late] {
            assert_eq!(meeting(&machine.model, &axes), expected, "{} at {axes:?}", machine.name);
        }
    }
}

/// What meets would be noticed, and what nearly does not.
#[test]
fn solids_that_meet_are_noticed() {
    let solid = |shape| Solid { shape, origin: Isometry3::identity(), color: [1.0; 4] };
    let cube = solid(SolidShape::Box { size: Vector3::repeat(0.1) });
    let rod = solid(SolidShape::Cylinder { radius: 0.01, length: 0.4 });
    let ball = solid(SolidShape::Sphere { radius: 0.05 });
    // A rod that leans over an edge of the cube by 45°: √2·50 mm and its radius from the middle.
    let lean = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -TAU / 8.0);
    let edge = 0.05 * 2.0_f64.sqrt() + 0.01;
    for (gap, parted) in [(1e-4, true), (-1e-4, false)] {
        let way = (edge + gap) / 2.0_f64.sqrt();
        let pose = Isometry3::from_parts(nalgebra::Translation3::new(way, 0.0, way), lean);
        assert_eq!(are_parted((&cube, Isometry3::identity()), (&rod, pose)), parted, "{gap}");
        // A ball over a corner.
        let way = 0.05 + (0.05 + gap) / 3.0_f64.sqrt();
        let pose = Isometry3::translation(way, way, way);
        assert_eq!(are_parted((&cube, Isometry3::identity()), (&ball, pose)), parted, "{gap}");
    }
}
