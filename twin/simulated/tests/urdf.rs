//! Tests of machine files that refer to a URDF.

use super::workspace;
use crate::simulated::Simulated;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics, Pose};
use twin_machine::Machine;
use twin_machine::section::{MachineFileError, Problem};
use twin_physics::{AxisDriveParameters, PhysicsError, PhysicsMachine, ServoParameters};
use twin_urdf::{JointKind, SolidShape, UrdfNote};

fn data() -> PathBuf {
    workspace().join("tests/data/urdf_scara")
}

/// Machine file and URDF of the tutorial.
fn texts() -> [String; 2] {
    ["machine.toml", "scara.urdf"].map(|name| fs::read_to_string(data().join(name)).unwrap())
}

fn tutorial() -> Machine {
    loads(Machine::load(&data().join("machine.toml")))
}

fn loads(loaded: Result<Machine, impl std::fmt::Debug>) -> Machine {
    loaded.unwrap_or_else(|error| panic!("{error:?}"))
}

/// A machine file next to a URDF, loaded.
fn written(machine: &str, urdf: &str) -> Result<Machine, MachineFileError> {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scara.urdf"), urdf).unwrap();
    let path = folder.path().join("machine.toml");
    fs::write(&path, machine).unwrap();
    Machine::load(&path)
}

/// The MELFA RH-6CRH6020 of the corpus, if it is there (`TWIN_SHARED` or next to the workspace), with `body` and `axis` for
/// more keys.
fn melfa(folder: &TempDir) -> Option<Machine> {
    let next_to_it = workspace().join("../shared");
    let shared = std::env::var_os("TWIN_SHARED").map_or(next_to_it, PathBuf::from);
    let urdf = shared.join("corpus/urdf/melfa_rh6crh6020_scara/rh6crh6020.urdf");
    if !urdf.is_file() {
        println!("skipped: no rh6crh6020.urdf (TWIN_SHARED, ../shared)");
        return None;
    }
    let axis = |name: &str, joint: u8, unit: &str, most: &str, values: [f64; 5]| {
        let kind = if unit == "deg" { "rotary" } else { "linear" };
        let [min, max, v, a, effort] = values;
        format!(
            "[[axes]]\nname = \"{name}\"\njoint = \"rh6crh6020_joint_{joint}\"\nkind = \"{kind}\"\nposition_min_{unit} = {min:?}\n\
             position_max_{unit} = {max:?}\nmax_velocity_{unit}_per_s = {v:?}\nmax_acceleration_{unit}_per_s2 = {a:?}\n\
             [axes.physics]\nmax_{most} = {effort:?}\n"
        )
    };
    // Lengths, limits and velocities are those of the maker's URDF; its effort of 1 Nm is a placeholder.
    let text = [
        "name = \"melfa\"\n[kinematics]\nkind = \"scara3\"\narm_lengths_mm = [325.0, 275.0, 0.0]\n[body]\n".to_owned(),
        format!("urdf = {:?}\n", urdf.display().to_string()),
        "tip_link = \"rh6crh6020_default_tcp\"\ndensity_kg_per_m3 = 2700.0\n".to_owned(),
        "[tool]\nlength_mm = 80.0\noffset_mm = [10.0, 5.0]\nmass_kg = 0.5\n".to_owned(),
        axis("A", 1, "deg", "torque_nm", [-132.0, 132.0, 420.0, 2000.0, 300.0]),
        axis("B", 2, "deg", "torque_nm", [-150.0, 150.0, 720.0, 4000.0, 100.0]),
        axis("C", 4, "deg", "torque_nm", [-360.0, 360.0, 2500.0, 20000.0, 10.0]),
        axis("Z", 3, "mm", "force_n", [-51.0, 149.0, 1100.0, 8000.0, 500.0]),
    ];
    let path = folder.path().join("melfa.toml");
    fs::write(&path, text.concat()).unwrap();
    Some(loads(Machine::load(&path)))
}

fn problems(loaded: Result<Machine, MachineFileError>) -> Vec<Problem> {
    match loaded {
        Ok(_) => Vec::new(),
        Err(MachineFileError::Content { problems, .. }) => problems,
        Err(error) => panic!("{error}"),
    }
}

/// Messages about the tutorial's machine file with changes.
fn messages(changes: &[(&str, &str)]) -> String {
    let [mut text, urdf] = texts();
    for (from, to) in changes {
        text = super::edited(&text, from, to);
    }
    let said = problems(written(&text, &urdf))
        .into_iter()
        .map(|problem| format!("{} {}", problem.message, problem.help.unwrap_or_default()));
    said.collect::<Vec<_>>().join("\n")
}

/// The tutorial with this effort in its URDF, and `more` behind its machine file.
fn with_effort(effort: &str, more: &str) -> Machine {
    let [text, urdf] = texts();
    assert!(urdf.contains("effort=\"1000.0\""));
    let urdf = urdf.replace("effort=\"1000.0\"", &format!("effort=\"{effort}\""));
    loads(written(&(text + more), &urdf))
}

/// An effort of exactly 1 Nm is probably a generator's placeholder: only that gives a hint.
#[test]
fn an_effort_of_one_is_perhaps_a_placeholder() {
    let weak = with_effort("1", "");
    assert_eq!(weak.hints.len(), 2, "{:?}", weak.hints);
    for (hint, axis) in weak.hints.iter().zip(&weak.axes) {
        assert_eq!(axis.effort_limit(), Some(1.0));
        assert!(hint.starts_with(&format!("axis {}: its motor gives 1 Nm", axis.name)), "{hint}");
        assert!(hint.contains("placeholder") && hint.contains("`max_torque_nm`"), "{hint}");
    }
    assert!(with_effort("1.5", "").hints.is_empty() && tutorial().hints.is_empty());
    // Z is the last axis of the file, and slides.
    assert_eq!(with_effort("1", "[axes.physics]\nmax_force_n = 900\n").hints.len(), 2);
}

/// Every number is in the URDF.
#[test]
fn the_tutorial_is_read() {
    let machine = tutorial();
    let [a, b, z] = &machine.axes[..] else { panic!() };
    for axis in [a, b] {
        assert_eq!((axis.simulated.viscous_friction(), axis.simulated.dry_friction()), (0.2, 0.1));
        assert_eq!(axis.simulated.effort_limit, 1000.0);
    }
    assert_eq!((z.simulated.viscous_friction(), z.simulated.dry_friction()), (0.4, 5.0));
    // The base and the links fixed to it do not move.
    let masses = [0.5, 0.5, 0.5, 0.5, 0.5, 0.2];
    assert!((machine.moving_mass() - masses.iter().sum::<f64>()).abs() < 1e-12);
    let undefined = |note: &UrdfNote| matches!(note, UrdfNote::NoColor { .. });
    let said: Vec<_> = machine.urdf_warnings.iter().map(|warning| &warning.note).collect();
    assert_eq!(said.iter().filter(|note| undefined(note)).count(), 7, "{said:?}");
    let right = |note: &UrdfNote| matches!(note, UrdfNote::RightAngle { given, .. } if (PI - given - 1.59e-3).abs() < 1e-5);
    assert!(said.iter().any(|note| right(note)), "{said:?}");
    let moving: Vec<_> =
        machine.model.moving_joints().map(|(_, joint)| joint.name.as_str()).collect();
    assert_eq!(moving, ["joint1", "joint2", "joint3"]);
}

/// Forward kinematics of transform, chain and bodies at every step of a motion that must move the tip by `far` at least.
fn agree(machine: &Machine, far: f64) {
    let at = |time: f64| {
        let axes: Vec<_> = (0_u8..)
            .zip(&machine.axes)
            .map(|(index, axis)| swing(time, index, axis.position_limits))
            .collect();
        let [position, velocity, acceleration] =
            [0, 1, 2].map(|row| AxisVector::from_values(axes.iter().map(|axis| axis[row])));
        AxisMotion { position, velocity, acceleration }
    };
    let start = at(0.0).position;
    let inertia = twin_physics::axis_inertia(&machine.model, &start).unwrap();
    let servo = |inertia| ServoParameters::tuned(inertia, 50.0, f64::INFINITY);
    let drives: Vec<_> =
        inertia.iter().map(|inertia| AxisDriveParameters::servo(servo(*inertia))).collect();
    let (model, cycle_ns) = (&machine.model, machine.cycle_ns);
    let mut physics =
        PhysicsMachine::new(model, &drives, machine.gravity, &start, cycle_ns).unwrap();
    let first = machine.kinematics.forward(&start).unwrap().position;
    let mut farthest: f64 = 0.0;
    for step in 1..=1000 {
        let state = physics.step(&at(f64::from(step) * 1e-3)).unwrap();
        let pose = machine.kinematics.forward(&state.position).unwrap();
        let chain = machine.model.tip_position(&state.position);
        let bodies = physics.link_poses()[machine.model.tip.link] * machine.model.tip.point;
        for (name, tip) in [("chain", chain), ("bodies", bodies)] {
            let error = (tip - pose.position).norm();
            assert!(error < 1e-10, "{name} at step {step}: {error}");
        }
        farthest = farthest.max((pose.position - first).norm());
    }
    assert!(farthest > far, "{farthest}");
}

/// Every axis over a part of its travel, each at its own pace.
fn swing(time: f64, index: u8, [low, high]: [f64; 2]) -> [f64; 3] {
    let pace = TAU * (0.3 + 0.1 * f64::from(index));
    let (sin, cos) = (pace * time).sin_cos();
    let (middle, half) = (low.midpoint(high), 0.2 * (high - low));
    [middle - half * cos, half * pace * sin, half * pace * pace * cos]
}

#[test]
fn transform_chain_and_bodies_agree() {
    agree(&tutorial(), 0.3);
    let folder = TempDir::new().unwrap();
    if let Some(machine) = melfa(&folder) {
        agree(&machine, 0.3);
    }
    let shipped = Machine::load(&workspace().join("machines/scara2_urdf.toml")).unwrap();
    agree(&shipped, 0.2);
}

/// The tool goes along a straight line and back: it is where it was sent at every millisecond, to within what drives leave.
fn line(machine: &Machine, from: [f64; 3], to: [f64; 3]) {
    let (from, to) = (Point3::from(from), Point3::from(to));
    let axes = |time: f64| {
        let part = 0.5 - 0.5 * (PI * time).cos();
        let pose = Pose { position: from + (to - from) * part, direction: 0.0 };
        let axes = machine.kinematics.inverse(&pose, &machine.middle());
        (axes.unwrap_or_else(|error| panic!("{error} at {part}")), pose.position)
    };
    let mut twin = Simulated::new(machine, &axes(0.0).0).unwrap();
    let mut reached: f64 = 0.0;
    for step in 0..=2000_u32 {
        let time = f64::from(step) * 1e-3;
        let [before, (now, target), after] = [time - 1e-4, time, time + 1e-4].map(axes);
        let [before, after] = [before.0, after.0];
        let of = |value: &dyn Fn(usize) -> f64| {
            AxisVector::from_values((0..machine.axes.len()).map(value))
        };
        let motion = AxisMotion {
            position: now,
            velocity: of(&|i| (after[i] - before[i]) / 2e-4),
            acceleration: of(&|i| (after[i] - 2.0 * now[i] + before[i]) / 1e-8),
        };
        let position = super::step(&mut twin, i64::from(step) * 1_000_000, motion).unwrap();
        let tip = machine.kinematics.forward(&position).unwrap().position;
        assert!((tip - target).norm() < 1e-3, "{step}: {tip} {target}");
        reached = reached.max((tip - from).norm());
    }
    assert!((reached - (to - from).norm()).abs() < 1e-3, "{reached}");
}

/// The volumes are those of the meshes; the drawing of the maker says that the arms weigh some kilograms.
#[test]
fn the_melfa_is_read() {
    let folder = TempDir::new().unwrap();
    let Some(machine) = melfa(&folder) else { return };
    let meshes = machine.model.links.iter().flat_map(|link| &link.solids);
    let meshes = meshes.filter(|solid| matches!(solid.shape, SolidShape::Mesh { .. }));
    assert_eq!(meshes.count(), 4);
    let mass = |name: &str| {
        let link = machine.model.links.iter().find(|link| link.name == name);
        link.unwrap().inertial.map(|body| body.mass)
    };
    assert_eq!(mass("rh6crh6020_base"), None, "it does not move");
    assert!(mass("rh6crh6020_no1arm").is_some_and(|mass| (2.0..20.0).contains(&mass)));
    assert_eq!(mass("rh6crh6020_shaft_z"), None, "a frame");
    assert!((mass("rh6crh6020_default_tcp").unwrap() - 0.5).abs() < 1e-12, "the tool");
}

#[test]
fn what_differs_is_said_with_what_would_fit() {
    let said = messages(&[("425.0, 345.0", "420.0, 350.0")]);
    assert!(said.contains("are up to ") && said.contains("(0.001 mm are allowed)"), "{said}");
    assert!(said.ends_with("these dimensions would fit: arm_lengths_mm = [425, 345]"), "{said}");
    // Arms 5 mm too short and too long: with the elbow at θ they differ by 5·|1 − e^iθ| mm, at most at its end.
    let expected = 5.0 * 2.0 * (89.9_f64.to_radians() / 2.0).sin();
    assert!(said.contains(&format!("up to {} mm", (expected * 1e6).round() / 1e6)), "{said}");
    let said = messages(&[("-440.0]", "-430.0]")]);
    assert!(said.ends_with("these dimensions would fit: base_mm = [0, 0, -440]"), "{said}");
    assert!(said.contains("up to 10 mm"), "{said}");
    let said = messages(&[("right_angle_tolerance_deg = 0.1", "")]);
    assert!(said.contains("joint prismatic32link2 is 0.091252° off a right angle"), "{said}");
    // Half a millimetre and more is what that makes at the end of the quill.
    assert!(said.contains("up to 0.652988 mm"), "{said}");
    assert_eq!(messages(&[("right_angle_tolerance_deg = 0.1", "tolerance_mm = 0.7")]), "");
}

#[test]
fn axes_and_joints_that_do_not_fit_are_named() {
    let table: toml::Table = include_str!("urdf_mistakes.toml").parse().unwrap();
    for row in table["rows"].as_array().unwrap() {
        let [from, to, says] =
            ["from", "to", "says"].map(|key| row[key].as_str().unwrap().replace("\\n", "\n"));
        let said = messages(&[(from.as_str(), to.as_str())]);
        assert!(said.contains(&says), "{row}: {said}");
    }
    // A joint that nothing moves: the third axis is away.
    let (path, [text, _]) = (data().join("machine.toml"), texts());
    let (before, _) = text.split_once("[[axes]]\nname = \"Z\"").unwrap();
    let refuse = |text: &str| Machine::parse(&path, text).unwrap_err().remove(0);
    let problem = refuse(before);
    assert!(problem.message.ends_with("no axis moves joint3, and nothing holds it"), "{problem:?}");
    let held = |at: f64| {
        before.replace("[program]", &format!("[body.held_joints]\njoint3 = {at:?}\n[program]"))
    };
    let problem = refuse(&held(301.0));
    assert!(problem.message.contains("joint joint3 is held at 0.301"), "{problem:?}");
    // Held 50 mm down it is a machine in a plane, 50 mm below; a start and a tool above it would be out of it.
    let flat = held(50.0).replace("-440.0]", "-390.0]").replace(", -50.0]", ", 0.0]");
    let machine = Machine::parse(&path, &flat).unwrap();
    assert_eq!(machine.model.moving_joints().count(), 2);
    let held = machine.model.joints.iter().find(|joint| joint.name == "joint3").unwrap();
    assert_eq!(held.kind, JointKind::Fixed);
}

/// A URDF is a tree of joints with one axis each.
#[test]
fn machines_that_are_no_tree_have_no_urdf() {
    for (text, expected) in [
        (include_str!("../../../machines/gantry_h2.toml"), "two motors move each coordinate"),
        (include_str!("../../../machines/tripod.toml"), "the rods of a tripod go round in loops"),
    ] {
        let (before, body) = text.split_once("\n[body]\n").unwrap();
        let (_, after) = body.split_once("\n[").unwrap();
        let text = format!("{before}\n[body]\nurdf = \"scara.urdf\"\n\n[{after}");
        let problems = Machine::parse(Path::new("machine.toml"), &text).unwrap_err();
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(problems[0].message.contains(expected), "{problems:?}");
    }
}

#[test]
fn limits_of_joints_bind() {
    let said = messages(&[("= -89.9", "= -91.0"), ("= 28.0", "= 29.0")]);
    let [velocity, position] =
        ["axis \"A\" makes 29", "axis \"A\" goes to -91 deg; joint joint1 of "];
    assert!(said.contains(velocity) && said.contains(position), "{said}");
    // 1.57 rad and 0.5 rad/s.
    assert!(said.contains("ends at -89.954374 deg (<limit>)"), "{said}");
    assert!(said.contains("joint joint1 of ") && said.contains("makes 28.64789 deg/s"), "{said}");
    let said = messages(&[("position_max_mm = 0.0", "position_max_mm = 1.0")]);
    assert!(said.contains("axis \"Z\" goes to 1 mm; joint joint3 of "), "{said}");

    // A safety controller binds too, and says that it is it.
    let [text, urdf] = texts();
    let controller = "<safety_controller k_velocity=\"1\" soft_lower_limit=\"-1.5\" soft_upper_limit=\"1.5\"/><dynamics";
    let problems = problems(written(&text, &urdf.replacen("<dynamics", controller, 1)));
    let [low, high] = &problems[..] else { panic!("{problems:?}") };
    assert!(low.message.ends_with("ends at -85.943669 deg (<safety_controller>)"), "{low:?}");
    assert!(high.message.contains("goes to 89.9 deg"), "{high:?}");
}

/// Links without mass are allowed until the machine is simulated; then a density or a mass helps.
#[test]
fn mass_where_the_urdf_has_none() {
    let [text, urdf] = texts();
    let mut light = String::new();
    for (number, part) in urdf.split("<inertial>").enumerate() {
        light += if number == 0 { part } else { part.split_once("</inertial>").unwrap().1 };
    }
    let load = |more: &str| {
        loads(written(&text.replace("[program]", &format!("{more}\n[program]")), &light))
    };
    let machine = load("");
    assert_eq!(machine.moving_mass(), 0.0);
    let refusal = Simulated::new(&machine, &machine.middle()).unwrap_err();
    assert!(matches!(refusal.error, PhysicsError::NoInertia { axis: 0, .. }), "{refusal}");
    assert!(refusal.to_string().starts_with("axis A moves 0 kg"), "{refusal}");
    assert!(refusal.to_string().contains("density_kg_per_m3"), "{refusal}");

    // Two columns, two bars, a drum and the quill, by their volumes.
    let cylinder = |radius: f64, length: f64| PI * radius * radius * length;
    let volumes = [
        cylinder(0.05, 0.45),
        0.1 * 0.1 * 0.425,
        cylinder(0.05, 0.2),
        0.1 * 0.1 * 0.345,
        cylinder(0.07, 0.15),
        cylinder(0.03, 0.5),
    ];
    let machine = load("density_kg_per_m3 = 1000.0");
    let expected = 1000.0 * volumes.iter().sum::<f64>();
    let mass = machine.moving_mass();
    assert!((mass - expected).abs() < 1e-9, "{mass} {expected}");
    Simulated::new(&machine, &machine.middle()).unwrap();
    let machine = load("density_kg_per_m3 = 1000.0\n[body.links.link3]\nmass_kg = 3.0");
    let quill = machine.model.links.iter().find(|link| link.name == "link3").unwrap();
    let inertial = quill.inertial.unwrap();
    assert!((inertial.mass - 3.0).abs() < 1e-12);
    let across = 3.0 * (3.0 * 0.03 * 0.03 + 0.5 * 0.5) / 12.0;
    assert!((inertial.inertia.m11 - across).abs() < 1e-12, "{inertial:?}");
    assert!((inertial.center - Point3::new(0.0, 0.0, -0.25)).norm() < 1e-12);
}

/// The quill turns down, its link's frame is upside down, and the tool still hangs down from the flange, along the last arm.
#[test]
fn a_tool_hangs_the_way_the_transform_has_it() {
    let (path, [text, _]) = (data().join("machine.toml"), texts());
    let tool = "[tool]\nlength_mm = 60.0\noffset_mm = [20.0, 7.0]\nmass_kg = 0.3\n[program]";
    let machine = Machine::parse(&path, &text.replace("[program]", tool)).unwrap();
    let tip = machine.model.tip_position(&[0.0, PI / 2.0, -0.1]);
    let expected = Point3::new(0.425 - 0.007, 0.345 + 0.02, -0.16);
    assert!((tip - expected).norm() < 1e-12, "{tip}");
    let light = tutorial().moving_mass();
    assert!((machine.moving_mass() - light - 0.3).abs() < 1e-12);
    let solids = &machine.model.links[machine.model.tip.link].solids;
    assert_eq!(solids.len(), 2);
    assert!(machine.model.tip.point.z > 0.0, "{:?}", Vector3::from(machine.model.tip.point.coords));
}

#[test]
fn programs_are_followed() {
    line(&tutorial(), [0.6, 0.2, -0.05], [0.55, 0.3, -0.1]);
    let folder = TempDir::new().unwrap();
    if let Some(machine) = melfa(&folder) {
        line(&machine, [0.4, 0.1, 0.0], [0.3, 0.3, -0.05]);
    }
}
