//! Tests of shipped machines that run into a plate: nothing passes through it, and all descriptions of one machine
//! agree in contact.

use super::shipped::{Descriptions, SAME, farthest, machines};
use super::{step, workspace};
use crate::simulated::Simulated;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Vector3};
use std::path::Path;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics};
use twin_machine::Machine;
use twin_physics::{Part, PhysicsError, PhysicsMachine};
use twin_urdf::Solid;

/// Of the plate, m.
const THICKNESS: f64 = 5e-3;

/// At constant velocity before the plate, s.
const STEADY: f64 = 0.012;

/// s.
const CYCLE: f64 = 1e-3;

/// A shipped machine with a plate across its way.
struct Plated {
    machine: Machine,
    /// Start of the axes.
    start: AxisVector,
    /// The velocities of the axes in the end, m/s or rad/s.
    velocity: AxisVector,
    /// Acceleration, as a part of that per second.
    rate: f64,
    /// From the tool into the plate.
    into: Vector3<f64>,
    /// A point of the side that is hit.
    face: Point3<f64>,
    /// Speed of the tip, m/s.
    speed: f64,
    /// The tool in its link.
    tool: Solid,
}

fn vector(values: impl Iterator<Item = f64>) -> AxisVector {
    AxisVector::from_values(values)
}

/// The machine of a file with a round tool, and with more text.
fn loaded(path: &Path, more: &str) -> Machine {
    let mut text = std::fs::read_to_string(path).unwrap();
    // A knife has a shape of its own.
    if !text.contains("\ndiameter_mm") && !text.contains("kind = \"gantry_cutter") {
        text = super::edited(&text, "\n[tool]\n", "\n[tool]\ndiameter_mm = 6.0\n");
    }
    let text = format!("{text}\n{more}");
    Machine::parse(path, &text)
        .unwrap_or_else(|problems| panic!("{}: {problems:#?}", path.display()))
}

impl Plated {
    /// A machine of `machines/` whose axes move with these parts of their largest velocities at the plate. The plate is at the
    /// start of programs, at right angles to the way of the tip. An upwards way is reversed, because the tool is below. `None`
    /// if the tip does not move.
    fn new(name: &str, parts: impl Fn(usize) -> f64) -> Option<Self> {
        let path = workspace().join("machines").join(name);
        let bare = loaded(&path, "");
        let hit = bare.start_axes().unwrap();
        let fastest = bare.axes.iter().enumerate();
        let velocity = vector(fastest.map(|(index, axis)| parts(index) * axis.max_velocity));
        let tip_at = |time: f64| {
            let axes = vector(hit.iter().zip(velocity.iter()).map(|(hit, v)| hit + v * time));
            bare.kinematics.forward(&axes).unwrap().position
        };
        let tip_velocity = (tip_at(1e-6) - tip_at(-1e-6)) / 2e-6;
        let speed = tip_velocity.norm();
        if speed < 0.05 {
            return None;
        }
        let sign = if tip_velocity.z > 1e-6 { -1.0 } else { 1.0 };
        let velocity = vector(velocity.iter().map(|v| sign * v));
        let into = tip_velocity * (sign / speed);

        let tip = bare.model.tip;
        let pose = bare.model.link_poses(&hit)[tip.link];
        let below = |solid: &Solid| farthest(solid, &(pose * solid.origin), &-Vector3::z());
        let end = (pose * tip.point).z;
        let solids = bare.model.links[tip.link].solids.iter();
        let tool = solids.min_by(|one, other| {
            let off = |solid| (below(solid).z - end).abs();
            off(one).total_cmp(&off(other))
        });
        let tool = tool.unwrap().clone();
        // By default the lower end.
        let way = into - Vector3::z() * 1e-9;
        let face = Point3::from(farthest(&tool, &(pose * tool.origin), &way));
        let level = into.cross(&Vector3::z()).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        let turn = Matrix3::from_columns(&[level, into.cross(&level), into]);
        let turn = Rotation3::from_matrix_unchecked(turn);
        let (roll, pitch, yaw) = turn.euler_angles();
        let [x, y, z] = ((face + into * (0.5 * THICKNESS)).coords * 1e3).into();
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_degrees);
        let plate = format!(
            "[[obstacles]]\nname = \"plate\"\nshape = \"box\"\nsize_mm = [80.0, 30.0, {:.1}]\n\
             position_mm = [{x:.9}, {y:.9}, {z:.9}]\nrotation_deg = [{roll:.9}, {pitch:.9}, {yaw:.9}]\n",
            THICKNESS * 1e3,
        );
        let machine = loaded(&path, &plate);

        let rates = machine.axes.iter().zip(velocity.iter());
        let rates =
            rates.filter(|(_, v)| **v != 0.0).map(|(axis, v)| axis.max_acceleration / v.abs());
        let rate = rates.fold(f64::INFINITY, f64::min);
        let time = 0.5 / rate + STEADY;
        let start = vector(hit.iter().zip(velocity.iter()).map(|(hit, v)| hit - v * time));
        for (axis, start) in machine.axes.iter().zip(start.iter()).filter(|(axis, _)| axis.limited)
        {
            let [low, high] = axis.position_limits;
            assert!((low..=high).contains(start), "{name}: {} begins at {start}", axis.name);
        }
        Some(Self { machine, start, velocity, rate, into, face, speed, tool })
    }

    /// Set-point of the axes after `time` s; it goes on through the plate for `beyond` s at the largest velocity.
    fn motion(&self, time: f64, beyond: f64) -> AxisMotion {
        let Self { rate, .. } = *self;
        let end = 0.5 / rate + STEADY + beyond;
        let (way, velocity, acceleration) = if time < 1.0 / rate {
            (0.5 * rate * time * time, rate * time, rate)
        } else {
            (time - 0.5 / rate, 1.0, 0.0)
        };
        let (way, velocity) = if way < end { (way, velocity) } else { (end, 0.0) };
        let of = |factor: f64| self.velocity.iter().map(move |v| v * factor);
        AxisMotion {
            position: vector(self.start.iter().zip(of(way)).map(|(start, way)| start + way)),
            velocity: vector(of(velocity)),
            acceleration: vector(of(acceleration)),
        }
    }

    /// Cycles until the tool should meet the plate.
    fn cycles(&self) -> u32 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "hundreds")]
        let cycles = ((1.0 / self.rate + STEADY) / CYCLE).ceil() as u32;
        cycles
    }

    /// Depth of the tool in the plate by rapier's bodies, m.
    fn depth(&self, poses: &[Isometry3<f64>]) -> f64 {
        let pose = poses[self.machine.model.tip.link] * self.tool.origin;
        (farthest(&self.tool, &pose, &self.into) - self.face.coords).dot(&self.into)
    }

    /// Kinetic energy of what moved from `before` to `now` in a cycle, and of rotors, J.
    fn energy(&self, before: &[Isometry3<f64>], physics: &PhysicsMachine) -> f64 {
        let now = physics.link_poses();
        let links = self.machine.model.links.iter().zip(before.iter().zip(&now));
        let bodies = links.filter_map(|(link, (before, now))| {
            let body = link.inertial?;
            let way = (now * body.center - before * body.center) / CYCLE;
            let turn = (now.rotation * before.rotation.inverse()).scaled_axis() / CYCLE;
            let own = now.inverse_transform_vector(&turn);
            Some(0.5 * body.mass * way.norm_squared() + 0.5 * own.dot(&(body.inertia * own)))
        });
        let velocities = physics.axis_state().velocity;
        let rotors = self.machine.axes.iter().zip(velocities.iter());
        let rotors = rotors.map(|(axis, v)| 0.5 * axis.simulated.armature * v * v);
        bodies.chain(rotors).sum()
    }
}

/// Largest distance between the descriptions of the machine at its present position, m.
fn apart(descriptions: &mut Descriptions, machine: &Machine, physics: &PhysicsMachine) -> f64 {
    let errors = descriptions.errors(machine, physics, &physics.axis_state().position);
    errors.into_iter().fold(0.0, f64::max)
}

/// Of one axis alone, or of all of them: the sign of each.
fn ways(machine: &str, axes: usize) -> Vec<Plated> {
    let alone = (0..axes)
        .filter_map(|moved| Plated::new(machine, |axis| if axis == moved { 1.0 } else { 0.0 }));
    let signs = [[1.0, 1.0, 1.0, 1.0], [1.0, -1.0, 1.0, 1.0], [1.0, 1.0, -1.0, -1.0]];
    let all = signs.into_iter().filter_map(|signs| Plated::new(machine, |axis| signs[axis]));
    alone.chain(all).collect()
}

/// Each axis alone, and all together, at their largest velocities into a plate of 5 mm: the tool stays on its side if drives stop
/// and if they push on, the blow adds no energy, and the plant reports the parts. Transform, URDF and rapier's bodies agree
/// all the time.
#[test]
fn no_shipped_machine_goes_through_a_plate_at_its_top_speed() {
    for (name, axes, least) in [
        ("scara2.toml", 3, 3),
        ("scara3.toml", 4, 4),
        ("gantry3.toml", 3, 3),
        ("gantry_h2.toml", 3, 3),
        ("tripod.toml", 3, 3),
        ("gantry_cutter3.toml", 4, 3),
    ] {
        let ways = ways(name, axes);
        assert!(ways.len() >= least + 2, "{name}: {} ways", ways.len());
        for plated in &ways {
            let about = format!("{name} at {:?}", plated.velocity);
            let machine = &plated.machine;
            let twin = Simulated::new(machine, &plated.start)
                .unwrap_or_else(|error| panic!("{about}: {error}"));
            let mut descriptions = Descriptions::of(machine);
            for stops in [true, false] {
                let mut physics = twin.physics().clone();
                let (mut hit, mut before_hit, mut most) = (None, 0.0, [f64::NEG_INFINITY, 0.0]);
                let (mut depth_after, mut worst) = (f64::NEG_INFINITY, 0.0_f64);
                let mut held = None;
                for cycle in 1..plated.cycles() + 60 {
                    let before = physics.link_poses();
                    let motion = plated.motion(f64::from(cycle) * CYCLE, 0.1);
                    physics.step(&held.unwrap_or(motion)).unwrap();
                    let energy = plated.energy(&before, &physics);
                    let collisions = physics.take_collisions();
                    if let (None, Some(first)) = (&hit, collisions.first()) {
                        hit = Some((first.speed, first.contact.parts));
                        held = stops.then(|| AxisMotion::at_rest(physics.axis_state().position));
                    } else if hit.is_none() {
                        before_hit = energy;
                    } else {
                        most[1] = f64::max(most[1], energy);
                    }
                    let depth = plated.depth(&physics.link_poses());
                    most[0] = most[0].max(depth);
                    depth_after = depth;
                    worst = worst.max(apart(&mut descriptions, machine, &physics));
                    let state = physics.axis_state();
                    let finite = state.position.iter().chain(state.velocity.iter());
                    assert!(finite.copied().all(f64::is_finite), "{about}: {state:?}");
                    // Sideways, along the plate, it may get off it.
                    let tip = machine.kinematics.forward(&state.position).unwrap().position;
                    if hit.is_some() && !stops && (tip - plated.face).norm() > 0.012 {
                        break;
                    }
                }
                let (speed, parts) = hit.unwrap_or_else(|| {
                    panic!("{about}: no collision, {most:?}, {} {}", plated.face, plated.into)
                });
                let [deepest, fastest] = most;
                assert_eq!(parts, [Part::Tool, Part::Obstacle(0)], "{about}");
                // A knife that turns meets it with its edge, not with its tip.
                let turns = name.starts_with("gantry_cutter") && plated.velocity[3] != 0.0;
                let near = if turns { 0.2 } else { 0.02 };
                assert!((speed / plated.speed - 1.0).abs() < near, "{about}: {speed} m/s");
                assert!(deepest < 0.1 * THICKNESS, "{about}: {deepest} m deep");
                assert!(depth_after > -0.02, "{about}: it is thrown back {depth_after} m");
                assert!(worst <= SAME, "{about}: {worst} m apart");
                if stops {
                    assert!(fastest <= before_hit * 1.001, "{about}: {before_hit} J, {fastest} J");
                }
            }
            stops_with_a_collision(plated, twin, &about);
        }
    }
}

/// The same through the plant.
fn stops_with_a_collision(plated: &Plated, mut twin: Simulated, about: &str) {
    let collided = (0..plated.cycles() + 5).find_map(|cycle| {
        let time_ns = i64::from(cycle) * plated.machine.cycle_ns;
        step(&mut twin, time_ns, plated.motion(f64::from(cycle) * CYCLE, 0.1)).err()
    });
    let Some(PhysicsError::Collision { parts, impulse }) = collided else {
        panic!("{about}: {collided:?}")
    };
    assert_eq!(parts, [Part::Tool, Part::Obstacle(0)], "{about}");
    assert!(impulse > 0.0 && impulse.is_finite(), "{about}: {impulse} N s");
    let depth = plated.depth(&twin.physics().link_poses());
    assert!(depth < 0.1 * THICKNESS, "{about}: {depth} m deep when it has stopped");
}

/// In the blow against a plate and pressed against it, transform, chain, URDF and rapier's bodies of every shipped machine agree.
#[test]
fn descriptions_agree_in_contact() {
    let names = machines()
        .into_iter()
        .map(|machine| machine.path.file_name().unwrap().to_str().unwrap().to_owned());
    for name in names {
        // The last of the axes that moves the tip, a quarter as fast as it can.
        let plated = (0..4).rev().filter(|axis| !(name == "tripod.toml" && *axis == 3));
        let mut plated = plated.filter_map(|moved| {
            let machine = loaded(&workspace().join("machines").join(&name), "");
            (moved < machine.axes.len()).then_some(())?;
            Plated::new(&name, |axis| if axis == moved { 0.25 } else { 0.0 })
        });
        let plated = plated.next().unwrap();
        let machine = &plated.machine;
        let mut physics = Simulated::new(machine, &plated.start).unwrap().physics().clone();
        let mut descriptions = Descriptions::of(machine);
        let (mut worst, mut pressed) = (0.0_f64, 0);
        for cycle in 1..plated.cycles() + 400 {
            physics.step(&plated.motion(f64::from(cycle) * CYCLE, 2e-3)).unwrap();
            worst = worst.max(apart(&mut descriptions, machine, &physics));
            assert!(worst <= SAME, "{name} in cycle {cycle}: {worst} m apart");
            pressed += u32::from(physics.contacts().iter().any(|contact| contact.force > 1.0));
        }
        assert!(pressed > 100, "{name}: pressed for {pressed} ms");
    }
}
