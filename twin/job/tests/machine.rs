//! Tests of jobs on machines whose axes are not the coordinates of the tool, against closed forms.

use super::{block, job, machine_file, near, run};
use crate::setpoint::AxisSetpoint;
use twin_machine::Machine;

fn load(name: &str) -> Machine {
    Machine::load(&machine_file(name)).unwrap()
}

/// Moves of a job next to a cam.
fn with_cam(machine: &Machine, text: &str, cam: &str) -> Vec<AxisSetpoint> {
    let (setpoints, findings) = run(&job(text).with("c.cam.toml", cam), machine);
    assert_eq!(findings, []);
    setpoints
}

fn moves(machine: &Machine, text: &str) -> Vec<AxisSetpoint> {
    with_cam(machine, text, "")
}

fn start(a: f64) -> String {
    format!(
        "[[start]]\naxis = \"A\"\nposition_deg = {a}\n[[start]]\naxis = \"B\"\nposition_deg = 60\n"
    )
}

/// The elbow at 250 mm in A, the tool 200 mm on in A + B.
fn is_on_its_arms(one: &AxisSetpoint) {
    let [a, b] = [one.axes.position[0], one.axes.position[1]];
    near(one.tool.pose.position.x, 0.25 * a.cos() + 0.2 * (a + b).cos(), 1e-9);
    near(one.tool.pose.position.y, 0.25 * a.sin() + 0.2 * (a + b).sin(), 1e-9);
}

/// Arms of 250 and 200 mm with 60° between them: with the elbow held, the tool goes on a circle of √(250² + 200² + 2·250·200·cos 60°)
/// mm, and with 60°/s so fast that this is its speed. With the second arm in gear it turns against the first.
#[test]
fn the_arms_of_a_scara() {
    let machine = load("scara2.toml");
    let keys = "distance_deg = 40; velocity_deg_per_s = 60; acceleration_deg_per_s2 = 600";
    let (head, turn) = (start(10.0), block("MC_MoveRelative", "A", keys));
    let setpoints = moves(&machine, &(head.clone() + &turn));
    let radius = (0.25_f64.powi(2) + 0.2_f64.powi(2) + 2.0 * 0.25 * 0.2 * 0.5).sqrt();
    let polar = |one: &AxisSetpoint| {
        let tip = one.tool.pose.position;
        (tip.x.hypot(tip.y), tip.y.atan2(tip.x))
    };
    for one in &setpoints {
        near(polar(one).0, radius, 1e-9);
        near(one.tool.velocity.norm(), radius * one.axes.velocity[0].abs(), 1e-9);
    }
    let [first, last] = [setpoints.first(), setpoints.last()].map(|one| polar(one.unwrap()).1);
    near(last - first, 40.0_f64.to_radians(), 1e-9);
    let fastest = setpoints.iter().map(|one| one.tool.velocity.norm()).fold(0.0, f64::max);
    near(fastest, radius * 60.0_f64.to_radians(), 1e-9);
    // Both arms.
    let keys = "master = \"A\"; ratio_numerator = -1; ratio_denominator = 2";
    for one in &moves(&machine, &(head + &block("MC_GearIn", "B", keys) + &turn)) {
        let [a, b] = [one.axes.position[0], one.axes.position[1]];
        near(b, 60.0_f64.to_radians() - (a - 10.0_f64.to_radians()) / 2.0, 1e-9);
        is_on_its_arms(one);
    }
}

/// Three carriages that go up together take the platform with them, straight up; one alone does not.
#[test]
fn the_carriages_of_a_tripod() {
    let machine = load("tripod.toml");
    let gear =
        |axis: &str| block("MC_GearIn", axis, "master = \"A\"; ratio_numerator = 1; at_s = 0");
    let up = block("MC_MoveRelative", "A", "distance_mm = 20; velocity_mm_per_s = 50; at_s = 0");
    let setpoints = moves(&machine, &[gear("B"), gear("C"), up.clone()].concat());
    let (first, last) = (&setpoints[0], setpoints.last().unwrap());
    for one in &setpoints {
        let (tip, start) = (one.tool.pose.position, first.tool.pose.position);
        near(tip.x, start.x, 1e-9);
        near(tip.y, start.y, 1e-9);
        near(tip.z - start.z, one.axes.position[0] - first.axes.position[0], 1e-9);
        near(one.tool.velocity.z, one.axes.velocity[0], 1e-9);
    }
    near(last.tool.pose.position.z - first.tool.pose.position.z, 0.02, 1e-9);
    let tip = moves(&machine, &up).last().unwrap().tool.pose.position;
    assert!((tip.x - first.tool.pose.position.x).hypot(tip.y - first.tool.pose.position.y) > 1e-3);
}

/// The slave of a cam may be any axis, whatever the tool does then: the second arm of a SCARA over the first one, 30° in a turn
/// by a quintic from rest to rest, and a carriage of a tripod over another one, half as far by a straight line.
#[test]
fn cams_between_axes_of_a_scara_and_of_a_tripod() {
    let cam_in = |keys: &str| {
        let keys = format!("master = \"A\"; cam = \"c.cam.toml\"; periodic = false; {keys}");
        block("MC_CamIn", "B", &keys)
    };
    let cam = "master = { min = 0, max = 90, unit = \"deg\" }\nslave = { min = 0, max = 30, unit = \"deg\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 90, slave = 30 }]\n";
    let turn = "position_deg = 90; velocity_deg_per_s = 60; at_s = 0.1";
    let blocks = cam_in("slave_offset_deg = 60") + &block("MC_MoveAbsolute", "A", turn);
    let setpoints = with_cam(&load("scara2.toml"), &(start(0.0) + &blocks), cam);
    for one in &setpoints {
        let s = (one.axes.position[0].to_degrees() / 90.0).clamp(0.0, 1.0);
        let angle = 60.0 + 30.0 * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
        near(one.axes.position[1], angle.to_radians(), 1e-9);
        is_on_its_arms(one);
    }
    near(setpoints.last().unwrap().axes.position[1], 90.0_f64.to_radians(), 1e-9);

    let machine = load("tripod.toml");
    let move_on =
        |keys: &str| block("MC_MoveRelative", "A", &format!("velocity_mm_per_s = 50; {keys}"));
    let begin = moves(&machine, &move_on("distance_mm = 1"));
    let [a0, b0, c0] = [0, 1, 2].map(|axis: usize| begin[0].axes.position[axis] * 1e3);
    let cam = "master = { min = 0, max = 40, unit = \"mm\" }\nslave = { min = 0, max = 20, unit = \"mm\" }\n\
               elements = [{ from = [0, 0], to = [40, 20] }]\n";
    let keys = format!("master_absolute = false; slave_offset_mm = {b0}; master_offset_mm = 0");
    let text = cam_in(&keys) + &move_on("distance_mm = 30; at_s = 0.1");
    let setpoints = with_cam(&machine, &text, cam);
    for one in &setpoints {
        let [a, b, c] = [0, 1, 2].map(|axis: usize| one.axes.position[axis] * 1e3);
        near(b, b0 + 0.5 * (a - a0), 1e-6);
        near(c, c0, 1e-9);
    }
    near(setpoints.last().unwrap().axes.position[1] * 1e3, b0 + 15.0, 1e-6);
}
