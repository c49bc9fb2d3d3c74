//! Tests of jobs on machines whose axes are not the coordinates of the tool, against closed forms.

use super::tests::{job, near, run};
use crate::setpoint::AxisSetpoint;
use std::path::Path;
use twin_machine::Machine;

fn shipped(name: &str) -> Machine {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines").join(name);
    Machine::load(&path).unwrap()
}

fn moves(machine: &Machine, text: &str) -> Vec<AxisSetpoint> {
    let (setpoints, findings) = run(&job(text), machine);
    assert_eq!(findings, []);
    setpoints
}

/// Arms of 250 and 200 mm with 60° between them: with the elbow held, the tool goes on a circle of √(250² + 200² + 2·250·200·cos 60°)
/// mm, and with 60°/s so fast that this is its speed. With the second arm in gear it turns against the first.
#[test]
fn the_arms_of_a_scara() {
    let machine = shipped("scara2.toml");
    let head =
        "[[start]]\naxis = \"A\"\nposition_deg = 10\n[[start]]\naxis = \"B\"\nposition_deg = 60\n";
    let turn = "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"A\"\ndistance_deg = 40\nvelocity_deg_per_s = 60\n\
                acceleration_deg_per_s2 = 600\n";
    let setpoints = moves(&machine, &[head, turn].concat());
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
    // Both arms: the elbow at 250 mm in A, the tool 200 mm on in A + B.
    let gear = "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"B\"\nmaster = \"A\"\nratio_numerator = -1\nratio_denominator = 2\n";
    let setpoints = moves(&machine, &[head, gear, turn].concat());
    for one in &setpoints {
        let [a, b] = [one.axes.position[0], one.axes.position[1]];
        near(b, 60.0_f64.to_radians() - (a - 10.0_f64.to_radians()) / 2.0, 1e-9);
        near(one.tool.pose.position.x, 0.25 * a.cos() + 0.2 * (a + b).cos(), 1e-9);
        near(one.tool.pose.position.y, 0.25 * a.sin() + 0.2 * (a + b).sin(), 1e-9);
    }
}

/// Three carriages that go up together take the platform with them, straight up; one alone does not.
#[test]
fn the_carriages_of_a_tripod() {
    let machine = shipped("tripod.toml");
    let gear = |axis: &str| {
        format!(
            "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"{axis}\"\nmaster = \"A\"\nratio_numerator = 1\nat_s = 0\n"
        )
    };
    let up = "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"A\"\ndistance_mm = 20\nvelocity_mm_per_s = 50\nat_s = 0\n";
    let setpoints = moves(&machine, &[gear("B"), gear("C"), up.to_owned()].concat());
    let (first, last) = (&setpoints[0], setpoints.last().unwrap());
    for one in &setpoints {
        let (tip, start) = (one.tool.pose.position, first.tool.pose.position);
        near(tip.x, start.x, 1e-9);
        near(tip.y, start.y, 1e-9);
        near(tip.z - start.z, one.axes.position[0] - first.axes.position[0], 1e-9);
        near(one.tool.velocity.z, one.axes.velocity[0], 1e-9);
    }
    near(last.tool.pose.position.z - first.tool.pose.position.z, 0.02, 1e-9);
    let alone = moves(&machine, up);
    let tip = alone.last().unwrap().tool.pose.position;
    assert!((tip.x - first.tool.pose.position.x).hypot(tip.y - first.tool.pose.position.y) > 1e-3);
}

/// A slave on a cam may be any axis, whatever the tool does with it: the second arm of a SCARA over the first one, 30° in a turn by
/// a quintic from rest to rest, and a carriage of a tripod over another one, half as far by a straight line.
#[test]
fn cams_between_axes_of_a_scara_and_of_a_tripod() {
    let with = |text: &str, cam: &str| {
        let job = job(text);
        std::fs::write(job.folder.path().join("c.cam.toml"), cam).unwrap();
        job
    };
    let block = |slave: &str, keys: &str| {
        format!(
            "[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"{slave}\"\nmaster = \"A\"\ncam = \"c.cam.toml\"\nperiodic = false\n{keys}"
        )
    };
    let cam = "master = { min = 0, max = 90, unit = \"deg\" }\nslave = { min = 0, max = 30, unit = \"deg\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 90, slave = 30 }]\n";
    let text = [
        "[[start]]\naxis = \"A\"\nposition_deg = 0\n[[start]]\naxis = \"B\"\nposition_deg = 60\n",
        &block("B", "slave_offset_deg = 60\n"),
        "[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"A\"\nposition_deg = 90\nvelocity_deg_per_s = 60\nat_s = 0.1\n",
    ];
    let (setpoints, findings) = run(&with(&text.concat(), cam), &shipped("scara2.toml"));
    assert_eq!(findings, []);
    for one in &setpoints {
        let [a, b] = [one.axes.position[0], one.axes.position[1]];
        let s = (a.to_degrees() / 90.0).clamp(0.0, 1.0);
        let angle = 60.0 + 30.0 * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
        near(b, angle.to_radians(), 1e-9);
        near(one.tool.pose.position.x, 0.25 * a.cos() + 0.2 * (a + b).cos(), 1e-9);
        near(one.tool.pose.position.y, 0.25 * a.sin() + 0.2 * (a + b).sin(), 1e-9);
    }
    near(setpoints.last().unwrap().axes.position[1], 90.0_f64.to_radians(), 1e-9);

    let machine = shipped("tripod.toml");
    let begin = moves(
        &machine,
        "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"A\"\ndistance_mm = 1\nvelocity_mm_per_s = 50\n",
    );
    let [a0, b0] = [0, 1].map(|axis: usize| begin[0].axes.position[axis] * 1e3);
    let cam = "master = { min = 0, max = 40, unit = \"mm\" }\nslave = { min = 0, max = 20, unit = \"mm\" }\n\
               elements = [{ from = [0, 0], to = [40, 20] }]\n";
    let keys = format!("master_absolute = false\nslave_offset_mm = {b0}\nmaster_offset_mm = 0\n");
    let text = [
        &block("B", &keys),
        "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"A\"\ndistance_mm = 30\nvelocity_mm_per_s = 50\nat_s = 0.1\n",
    ];
    let (setpoints, findings) = run(&with(&text.concat(), cam), &machine);
    assert_eq!(findings, []);
    for one in &setpoints {
        let [a, b, c] = [0, 1, 2].map(|axis: usize| one.axes.position[axis] * 1e3);
        near(b, b0 + 0.5 * (a - a0), 1e-6);
        near(c, begin[0].axes.position[2] * 1e3, 1e-9);
    }
    near(setpoints.last().unwrap().axes.position[1] * 1e3, b0 + 15.0, 1e-6);
}
