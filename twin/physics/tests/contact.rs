//! Tests of contact: pressing forces in closed form, collisions, and clearances.

use twin_kinematics::Kinematics;
use twin_kinematics::tripod::{Tripod, TripodDeviations};
use twin_urdf::{MachineJoint, Mesh, ScaraDimensions, Solid, SolidShape};

use super::parallel::{generated, rings};
use super::*;

pub(super) fn solid(shape: SolidShape, place: [f64; 3]) -> Solid {
    let [x, y, z] = place;
    Solid { shape, origin: Isometry3::translation(x, y, z), color: [1.0; 4] }
}

pub(super) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
    let (low, high) = (Vector3::from(low), Vector3::from(high));
    solid(SolidShape::Box { size: high - low }, ((low + high) * 0.5).into())
}

pub(super) fn around<const N: usize>(solids: [(&str, Solid); N]) -> Surroundings {
    let obstacles = solids.into_iter().map(|(name, solid)| Obstacle {
        name: name.into(),
        kind: ObstacleKind::Fixture,
        solids: vec![solid],
        surface: Surface::default(),
    });
    Surroundings { obstacles: obstacles.collect(), ..Surroundings::default() }
}

/// The gantry with a ball of 30 mm at its quill and a box for a bridge.
pub(super) fn solid_gantry() -> Model {
    let mut model = gantry();
    model.links[3].solids.push(solid(SolidShape::Sphere { radius: 0.03 }, [0.0; 3]));
    model.links[1].solids.push(cuboid([-0.05, -0.6, 0.3], [0.05, 0.6, 0.4]));
    model
}

/// An arm in the plane with arms of 250 and 200 mm and a tool 60 mm below.
pub(super) fn arm() -> Model {
    let joint = |name: &str, axis| MachineJoint::new(name, axis, [-2.8, 2.8]);
    let mut dimensions =
        ScaraDimensions::new("scara", [joint("A", 0), joint("B", 1)], None, [0.25, 0.2]);
    dimensions.tool = Vector3::new(0.0, 0.0, -0.06);
    dimensions.tool_mass = 0.3;
    dimensions.model().unwrap()
}

/// Position control without integral action: what it gives depends on where it is alone.
fn springy(inertia: f64) -> AxisDriveParameters {
    AxisDriveParameters::servo(ServoParameters {
        integral_time: f64::INFINITY,
        ..ServoParameters::tuned(inertia, 40.0, 500.0)
    })
}

/// Where the arm's tool presses against a wall, the motors give what its Jacobian makes of the force, to 0.1 %: rapier ends its search
/// for the nearest points where their distance is right to 5e-8 of itself, and on a round side the direction to half a milliradian.
#[test]
fn an_arm_presses_as_hard_as_its_motors_push() {
    let model = arm();
    let start = axes([0.4, 0.9]);
    let tip = model.tip_position(&start);
    let drives = drives_of(&model, &start, springy);
    let mut machine = started(&model, &drives, down(), &start);
    // The tool's radius is a tenth of its length; the wall is half a millimetre away.
    let face = tip.x + 0.006 + 0.0005;
    // As high as the tool, lower than the arms.
    let wall = cuboid([face, -1.0, tip.z - 0.01], [face + 0.005, 1.0, tip.z + 0.03]);
    machine.insert_surroundings(&around([("wall", wall)])).unwrap();
    let (a, ab): (f64, f64) = (0.4 - 0.01, 0.4 - 0.01 + 0.9);
    let state = machine.hold([a, ab - a], 4000);
    assert!(state.velocity.iter().all(|velocity| velocity.abs() < 1e-7), "{state:?}");
    let [contact] = machine.contacts() else { panic!("{:?}", machine.contacts()) };
    assert_eq!(contact.parts, [Part::Tool, Part::Obstacle(0)]);
    let ((s1, _), (s12, _)) =
        (state.position[0].sin_cos(), (state.position[0] + state.position[1]).sin_cos());
    let opening = [-0.25 * s1 - 0.2 * s12, -0.2 * s12];
    assert!(contact.force > 10.0, "{contact:?}");
    for (effort, opening) in state.effort.iter().zip(opening) {
        // The wall pushes towards −x.
        let expected = contact.force * opening;
        assert!((effort - expected).abs() < 1e-3 * expected.abs(), "{state:?} {contact:?}");
    }
    assert!((contact.point.x - face).abs() < 2e-6, "{contact:?}");
}

/// A slide at the limit of its motor presses with that and its weight, springs and play in between or not.
#[test]
fn a_slide_presses_with_its_limit_and_its_weight() {
    let mut model = lift(3.0);
    model.links[1].solids.push(cuboid([-0.05; 3], [0.05; 3]));
    let rigid = tuned(3.0, 40.0, 50.0);
    let spring = ElasticTransmission::damped(1e5, 0.1, 1e-5, 2.0, 3.0);
    let elastic =
        AxisDriveParameters { armature: 2.0, transmission: Some(spring), ..tuned(5.0, 15.0, 50.0) };
    for drive in [rigid, elastic] {
        let mut machine = started(&model, &[drive], down(), &axes([0.052]));
        machine.insert_surroundings(&Surroundings::floor(0.0)).unwrap();
        for cycle in 0..4000 {
            let down = (f64::from(cycle) * 2e-5).min(0.04);
            machine.step(&AxisMotion::at_rest(axes([0.052 - down]))).unwrap();
        }
        let [contact] = machine.contacts() else { panic!("{:?}", machine.contacts()) };
        let expected = 50.0 + 3.0 * G;
        assert!((contact.force - expected).abs() < 1e-6 * expected, "{contact:?}");
        assert!(contact.depth < 1e-5, "{contact:?}");
        let collisions = machine.take_collisions();
        assert_eq!(collisions[0].contact.parts, [Part::Link(1), Part::Obstacle(0)]);
    }
}

/// A tripod in its middle presses with what its three motors give, by virtual work.
#[test]
fn a_tripod_presses_with_its_three_motors() {
    let model = generated(&TripodDeviations::default());
    let start = axes([0.35; 3]);
    let tip = model.tip_position(&start);
    let drives = drives_of(&model, &start, springy);
    let mut machine = started(&model, &drives, Vector3::zeros(), &start);
    let floor = |top| Surroundings { among_links: false, ..Surroundings::floor(top) };
    let mut scan = ClearanceScan::new(&model, 3, &floor(tip.z - 0.1)).unwrap();
    let lowest = scan.nearest(&start).unwrap().unwrap().points[0].z;
    // A machine does not start in something.
    let overlap = machine.clone().insert_surroundings(&floor(lowest + 1e-3)).unwrap_err();
    let PhysicsError::Overlap { parts: [_, Part::Obstacle(0)], depth } = overlap else {
        panic!("{overlap:?}")
    };
    assert!((depth - 1e-3).abs() < 1e-9, "{overlap:?}");
    machine.insert_surroundings(&floor(lowest - 3e-4)).unwrap();
    let state = machine.hold([0.348; 3], 3000);
    let contacts = machine.contacts();
    let force: f64 = contacts.iter().map(|contact| contact.force).sum();
    let given: f64 = -state.effort.iter().sum::<f64>();
    assert!(force > 20.0 && (force - given).abs() < 1e-6 * force, "{contacts:?} {state:?}");
    let transform = Tripod::new(rings(), [0.0; 3]).unwrap();
    let here = transform.forward(&state.position).unwrap().position;
    let before = transform.forward(&start).unwrap().position;
    assert!((here.z - before.z + 3e-4).abs() < 2e-6, "{here} {before}");
}

/// However fast a machine is, nothing of it comes through a plate of 5 mm, and no blow makes it faster.
#[test]
fn a_crash_ends_at_the_plate() {
    for speed in [0.2, 1.0, 2.0, 3.7, 5.0, 12.0] {
        for offset in [0.0, 3e-4, 7e-4] {
            let start = axes([0.1 + offset, 0.0, 0.1]);
            let mut machine = started(&solid_gantry(), &[SLACK; 3], Vector3::zeros(), &start);
            let plate = cuboid([0.5, -0.2, 0.0], [0.505, 0.2, 0.6]);
            machine.insert_surroundings(&around([("plate", plate)])).unwrap();
            machine.start_moving(&axes([speed, 0.3 * speed, 0.0]));
            let mut fastest = 0.0_f64;
            let mut crashed = false;
            for _ in 0..2500 {
                // The motor goes on pushing.
                let state = machine.step_with_efforts(&axes([600.0, 0.0, 0.0])).unwrap();
                // The ball is 50 mm ahead of the axis, and 30 mm large.
                let ahead = state.position[0] + 0.08;
                assert!(ahead < 0.5 + 2.5e-3, "{speed} m/s: {ahead}");
                let now = state.velocity[0];
                let by_now = (speed * speed + 2.0 * 600.0 / 20.0 * 0.4).sqrt();
                assert!(now.abs() <= by_now, "{speed} m/s: {now}");
                if crashed {
                    fastest = fastest.max(now.abs());
                }
                crashed |= !machine.contacts().is_empty();
                if state.position[1] > 0.15 {
                    break;
                }
            }
            let collisions = machine.take_collisions();
            assert_eq!(collisions[0].contact.parts, [Part::Link(3), Part::Obstacle(0)]);
            let met = collisions[0].speed;
            assert!(met >= speed && met < speed + 8.0, "{collisions:?}");
            assert!(fastest < met, "{fastest} m/s after {met} m/s");
        }
    }
}

/// What a joint joins may be in each other; what folds back on itself is stopped.
#[test]
fn links_stop_each_other() {
    let mut model = arm();
    // A post on the base where the second arm comes when it is folded back.
    model.links[0].collision = vec![cuboid([0.05, 0.08, -0.5], [0.09, 0.12, 0.5])];
    let start = axes([0.0, 1.2]);
    let drives = drives_of(&model, &start, |inertia| tuned(inertia, 30.0, 60.0));
    let folded = |left_out: &[Part]| {
        let mut machine = started(&model, &drives, down(), &start);
        let left_out = left_out.iter().map(|link| [*link, Part::Link(0)]).collect();
        let surroundings = Surroundings { left_out, ..Surroundings::default() };
        machine.insert_surroundings(&surroundings).unwrap();
        for cycle in 0..2500 {
            machine.hold([0.0, 1.2 + f64::min(f64::from(cycle) * 1e-3, 1.5)], 1);
        }
        (machine.take_collisions(), machine.axis_state().position[1])
    };
    let (collisions, bend) = folded(&[]);
    let [one, other] = collisions[0].contact.parts;
    assert_eq!(one, Part::Link(0), "{collisions:?}");
    assert!(matches!(other, Part::Link(2) | Part::Tool), "{collisions:?}");
    assert!(bend < 2.6, "{bend}");
    let (collisions, bend) = folded(&[Part::Link(1), Part::Link(2), Part::Link(3), Part::Tool]);
    assert!(collisions.is_empty(), "{collisions:?}");
    assert!((bend - 2.7).abs() < 1e-3, "{bend}");
}

/// An L of triangles, 40 mm long, 10 mm thick, 10 mm high.
fn bracket() -> Mesh {
    let outline = [[0.0, 0.0], [0.04, 0.0], [0.04, 0.01], [0.01, 0.01], [0.01, 0.04], [0.0, 0.04]];
    let vertices = [0.0, 0.01].into_iter().flat_map(|z| outline.map(|[x, y]| Point3::new(x, y, z)));
    let mut triangles = Vec::new();
    let top = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    for [a, b, c] in top {
        triangles.push([a, c, b]);
        triangles.push([a + 6, b + 6, c + 6]);
    }
    for edge in 0..6_u32 {
        let next = (edge + 1) % 6;
        triangles.push([edge, next, next + 6]);
        triangles.push([edge, next + 6, edge + 6]);
    }
    Mesh::new("bracket.stl", vertices.collect(), triangles).unwrap()
}

/// A ball goes into the corner of a bracket, which its convex hull would not let it.
#[test]
fn meshes_are_convex_parts() {
    let mut surroundings = around([("bracket", solid(mesh(bracket(), 10.0), [0.0; 3]))]);
    let model = solid_gantry();
    let mut scan = ClearanceScan::new(&model, 3, &surroundings).unwrap();
    // The ball's middle at 0.2, 0.2, half of the bracket's height: 0.1 m from both legs.
    let mut nearest = |place| scan.nearest(&axes(place)).unwrap().unwrap();
    let found = nearest([0.15, 0.2, -0.15]);
    assert_eq!(found.parts, [Part::Link(3), Part::Obstacle(0)]);
    assert!((found.distance - 0.07).abs() < 2e-3, "{found:?}");
    // 10 mm before the end of a leg.
    assert!((nearest([0.39, 0.05, -0.15]).distance - 0.01).abs() < 2e-3);
    assert!(nearest([0.0, 0.05, -0.15]).distance < -0.03);

    // A mesh that is convex is one body, exactly.
    surroundings.obstacles[0].solids = vec![solid(mesh(tetrahedron(), 10.0), [1.0, 0.0, 0.0])];
    let mut scan = ClearanceScan::new(&model, 3, &surroundings).unwrap();
    let nearest = scan.nearest(&axes([0.05, 0.5, 0.3])).unwrap().unwrap();
    assert!((nearest.distance - (0.9 - 0.03)).abs() < 1e-9, "{nearest:?}");

    // One without volume can touch nothing, and is said.
    let flat = Mesh::new(
        "flat.stl",
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from).to_vec(),
        vec![[0, 1, 2]],
    );
    surroundings.obstacles[0].solids = vec![solid(mesh(flat.unwrap(), 10.0), [1.0, 0.0, 0.0])];
    assert_eq!(
        ClearanceScan::new(&model, 3, &surroundings).unwrap_err(),
        PhysicsError::FlatMesh { part: Part::Obstacle(0), solid: 0 }
    );
}

/// Pairs are measured when they may be nearest, and only then: with all of them measured anew it is the same.
#[test]
fn what_is_nearest_is_found_along_the_way() {
    let model = solid_gantry();
    let surroundings = around([
        ("post", cuboid([0.3, 0.1, 0.0], [0.35, 0.15, 0.5])),
        ("ball", solid(SolidShape::Sphere { radius: 0.05 }, [-0.2, -0.3, 0.3])),
        ("rod", solid(SolidShape::Cylinder { radius: 0.01, length: 0.4 }, [0.0, 0.4, 0.2])),
        ("pill", solid(SolidShape::Capsule { radius: 0.02, length: 0.1 }, [0.4, -0.3, 0.1])),
    ]);
    let mut scan = ClearanceScan::new(&model, 3, &surroundings).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for step in 0..2000 {
        let t = f64::from(step) * 5e-3;
        let place = axes([0.3 * t.sin(), 0.4 * (0.7 * t).cos(), 0.1 * (2.3 * t).sin()]);
        let found = scan.nearest(&place).unwrap().unwrap();
        let fresh = ClearanceScan::new(&model, 3, &surroundings);
        let anew = fresh.unwrap().nearest(&place).unwrap().unwrap();
        assert!((found.distance - anew.distance).abs() < 1e-9, "{t}: {found:?} {anew:?}");
        // The middle of the ball that moves, and what is in closed form.
        let middle = Point3::new(place[0] + 0.05, place[1], 0.2 + place[2]);
        let ball = (middle - Point3::new(-0.2, -0.3, 0.3)).norm() - 0.08;
        assert!(found.distance <= ball + 1e-9, "{found:?} {ball}");
        if found.parts == [Part::Link(3), Part::Obstacle(1)] {
            assert!((found.distance - ball).abs() < 1e-9, "{found:?} {ball}");
        }
        seen.insert(found.parts);
    }
    assert!(seen.len() >= 4, "{seen:?}");
}

/// A tool may be in the stock, and nothing else may; a probe finds it.
#[test]
fn stock_is_for_the_tool_alone() {
    let model = arm();
    let start = axes([0.4, 0.9]);
    let tip = model.tip_position(&start);
    let stock = cuboid([-1.0, -1.0, tip.z - 0.5], [1.0, 1.0, tip.z + 0.01]);
    let mut surroundings = around([("stock", stock)]);
    let nearest = |scan: Result<ClearanceScan, _>| scan.unwrap().nearest(&start).unwrap().unwrap();
    let found = nearest(ClearanceScan::new(&model, 2, &surroundings));
    assert!(found.parts.contains(&Part::Tool) && found.distance < -9e-3, "{found:?}");
    surroundings.obstacles[0].kind = ObstacleKind::Stock;
    let found = nearest(ClearanceScan::new(&model, 2, &surroundings));
    assert!(!found.parts.contains(&Part::Tool) && found.distance > 0.0, "{found:?}");
    let found = nearest(ClearanceScan::of_tool(&model, 2, &surroundings));
    assert_eq!(found.parts, [Part::Tool, Part::Obstacle(0)]);
}

/// A gantry whose quill carries `solid` in the place of the ball.
fn carrying(solid: Solid) -> Model {
    let mut model = gantry();
    model.links[3].solids.push(solid);
    model
}

fn mesh(mesh: Mesh, scale: f64) -> SolidShape {
    SolidShape::Mesh { mesh: std::sync::Arc::new(mesh), scale: Vector3::repeat(scale) }
}

/// What a quill may end in: a tool, a turned box, a mesh in one and in several parts.
fn ends() -> [Solid; 4] {
    let mut turned = solid(SolidShape::Box { size: Vector3::new(0.03, 0.05, 0.04) }, [0.0; 3]);
    turned.origin.rotation = nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.5, 0.2);
    [
        solid(SolidShape::Cylinder { radius: 0.004, length: 0.06 }, [0.0, 0.0, 0.03]),
        turned,
        solid(mesh(tetrahedron(), 0.05), [-0.01, -0.01, 0.0]),
        solid(mesh(bracket(), 1.0), [-0.02, -0.02, 0.0]),
    ]
}

fn tetrahedron() -> Mesh {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from);
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    Mesh::new("corner.stl", corners.to_vec(), faces).unwrap()
}

/// What goes past an edge does not touch it, however near and however fast; what does not go past is stopped there.
#[test]
fn edges_end_where_they_are() {
    for (kind, end) in ends().into_iter().enumerate() {
        let model = carrying(end);
        let block = around([("block", cuboid([0.3, -0.2, -0.2], [0.4, 0.2, 0.1]))]);
        for speed in [0.02, 0.3, 2.0] {
            for height in [2e-5, 2e-4, 5e-4, 1e-3, -1e-3] {
                // As high above the block, from 20 mm before it on.
                let mut scan = ClearanceScan::new(&model, 3, &block).unwrap();
                let above = scan.nearest(&axes([0.3, 0.0, 0.2])).unwrap().unwrap();
                let start = axes([0.17, 0.0, 0.2 - above.distance + height]);
                let mut machine = started(&model, &[SLACK; 3], Vector3::zeros(), &start);
                machine.insert_surroundings(&block).unwrap();
                machine.start_moving(&axes([speed, 0.0, 0.0]));
                let mut way = 0.0;
                while way < 0.3 && machine.contacts().is_empty() {
                    machine.step_with_efforts(&axes([0.0; 3])).unwrap();
                    way += speed * 1e-3;
                }
                let hit = !machine.take_collisions().is_empty();
                assert_eq!(hit, height < 0.0, "{kind}: {height} m above the block, {speed} m/s");
            }
        }
    }
}

/// Nothing passes through a plate, and no impact makes anything faster.
#[test]
fn crashes_of_all_shapes_end_at_the_plate() {
    for (kind, end) in ends().into_iter().enumerate() {
        let model = carrying(end);
        let plate = around([("plate", cuboid([0.5, -0.3, -0.3], [0.505, 0.3, 0.9]))]);
        for speed in [0.3, 1.1, 2.0, 4.3] {
            let velocity = axes([speed, 0.1 * speed, -0.05 * speed]);
            let start = AxisMotion { velocity, ..AxisMotion::at_rest(axes([0.1, 0.0, 0.1])) };
            let mut machine = moving(&model, &[SLACK; 3], Vector3::zeros(), &start);
            machine.insert_surroundings(&plate).unwrap();
            let energy = |velocity: &AxisVector| {
                let masses = [20.0, 8.0, 3.0].into_iter().zip(velocity.iter());
                masses.map(|(mass, velocity)| 0.5 * mass * velocity * velocity).sum::<f64>()
            };
            let begun = energy(&velocity);
            let mut deepest = 0.0_f64;
            for _ in 0..1500 {
                let state = machine.step_with_efforts(&axes([300.0, 0.0, 0.0])).unwrap();
                let work = 300.0 * (state.position[0] - 0.1);
                let now = energy(&state.velocity);
                let most = begun + work;
                assert!(now <= most + 1e-6, "{kind}, {speed} m/s: {now} of {most} J");
                let depths = machine.contacts().iter().map(|contact| contact.depth);
                deepest = depths.fold(deepest, f64::max);
                assert!(state.position[0] < 0.5, "{kind}, {speed} m/s: {state:?}");
                // Along the plate, which ends there.
                if state.position[1] > 0.2 {
                    break;
                }
            }
            assert!(!machine.take_collisions().is_empty(), "{kind}, {speed} m/s");
            assert!(deepest < 2.5e-3, "{kind}, {speed} m/s: {deepest} m");
        }
    }
}
