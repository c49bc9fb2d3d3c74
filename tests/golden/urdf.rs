//! Machines from URDF files, as a process.

use crate::desk::{Desk, shipped};
use crate::root;
use std::env;
use std::path::PathBuf;

/// The program of the tutorial's SCARA: three lines, and clockwise three quarters of a circle of 50 mm.
const PROGRAM: &str = include_str!("../data/urdf_scara/program.cnc");

/// 70.71 + 235.62 + 155.24 + 71.41 mm, from the numbers of [`PROGRAM`].
fn length_mm() -> f64 {
    let line = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    let arc = 3.0 * std::f64::consts::FRAC_PI_2 * 50.0;
    line([0.0, 50.0, 50.0]) + arc + line([0.0, 150.0, 40.0]) + line([50.0, 50.0, 10.0])
}

/// The tutorial's SCARA does its program: everything within its limits, and the tool where it is sent.
#[test]
fn a_scara_of_a_tutorial_runs_its_program() {
    let machine = "tests/data/urdf_scara/machine.toml";
    let desk = Desk::new();
    desk.write("program.cnc", PROGRAM);
    let report = desk
        .twin(&format!("check program.cnc --machine {machine} --physics --format json"))
        .ended(0, "")
        .object();
    let found = report["length_mm"].as_f64().expect("a number");
    assert!((found - length_mm()).abs() < 1e-6, "{found} {}", length_mm());
    assert_eq!(report["findings"].as_array().map(Vec::len), Some(0), "{report}");
    let run = format!("run program.cnc --machine {machine} --drives none --report run.json");
    desk.twin(&run).ended(0, "");
    let report = desk.read("run.json");
    let error = report["tool_error_mm"]["twin"]["max"].as_f64().expect("a number");
    assert!(error > 0.0 && error < 1.0, "{report}");

    let done = desk.twin(&format!("machine {machine}"));
    done.ended(0, "");
    done.says_all(&[
        "moving mass 2.70 kg in 10 links",
        "the colour of material \"green\" is not in this file",
    ]);
    // As URDF it is the machine that it is: the axis of the quill points up.
    let done = desk.twin(&format!("machine {machine} --urdf"));
    assert!(done.ended(0, "").stdout.contains("<link name=\"prismatic3\">"), "{}", done.stdout);
    desk.twin(&format!("machine {machine} --record space.rrd --svg space.svg")).ended(0, "");
}

/// A URDF without masses cannot be simulated; the axis that moves nothing is named as the machine file names it.
#[test]
fn what_moves_nothing_is_named() {
    let text = |name: &str| shipped(&format!("tests/data/urdf_scara/{name}"));
    let mut light = String::new();
    for (number, part) in text("scara.urdf").split("<inertial>").enumerate() {
        let rest = part.split_once("</inertial>").map_or(part, |(_, rest)| rest);
        light += if number == 0 { part } else { rest };
    }
    let desk = Desk::new();
    desk.write("scara.urdf", &light);
    desk.write(
        "light.toml",
        &text("machine.toml").replace("name = \"A\"", "name = \"shoulder\"\nrole = \"A\""),
    );
    desk.write("program.cnc", PROGRAM);
    desk.twin("check program.cnc --machine light.toml --physics")
        .ended(2, "axis shoulder moves 0 kg");
}

/// The MELFA of the corpus, if it is there (`TWIN_SHARED` or next to the workspace): a real machine with meshes.
#[test]
fn a_melfa_runs_a_program() {
    let shared = env::var_os("TWIN_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from);
    let urdf = shared.join("corpus/urdf/melfa_rh6crh6020_scara/rh6crh6020.urdf");
    if !urdf.is_file() {
        println!("skipped: no rh6crh6020.urdf (TWIN_SHARED, ../shared)");
        return;
    }
    let desk = Desk::new();
    let axis = |name: &str,
                joint: u8,
                unit: &str,
                limits: [f64; 2],
                motion: [f64; 2],
                effort: &str| {
        let kind = if unit == "deg" { "rotary" } else { "linear" };
        let ([min, max], [v, a]) = (limits, motion);
        format!(
            "[[axes]]\nname = \"{name}\"\njoint = \"rh6crh6020_joint_{joint}\"\nkind = \"{kind}\"\n\
             position_min_{unit} = {min:?}\nposition_max_{unit} = {max:?}\nmax_velocity_{unit}_per_s = {v:?}\n\
             max_acceleration_{unit}_per_s2 = {a:?}\nmax_following_error_{unit} = 0.1\n[axes.physics]\n{effort}\n"
        )
    };
    let machine = [
        format!(
            "name = \"melfa\"\n[kinematics]\nkind = \"scara3\"\narm_lengths_mm = [325.0, 275.0, 0.0]\n\
             [body]\nurdf = {urdf:?}\ntip_link = \"rh6crh6020_default_tcp\"\ndensity_kg_per_m3 = 2700.0\n\
             [tool]\nlength_mm = 80.0\nmass_kg = 0.5\n[program]\nstart_mm = [400.0, 100.0, 0.0]\n"
        ),
        axis("A", 1, "deg", [-132.0, 132.0], [420.0, 2000.0], "max_torque_nm = 300.0"),
        axis("B", 2, "deg", [-150.0, 150.0], [720.0, 4000.0], "max_torque_nm = 100.0"),
        axis("C", 4, "deg", [-360.0, 360.0], [2500.0, 20000.0], "max_torque_nm = 10.0"),
        axis("Z", 3, "mm", [-51.0, 149.0], [1100.0, 8000.0], "max_force_n = 500.0"),
    ];
    desk.write("melfa.toml", &machine.concat());
    desk.write(
        "program.cnc",
        "%\nN10 G01 X400 Y200 Z-50 F100 E1000\nN20 G02 X350 Y250 I-50 J0\nN30 G01 X400 Y100 Z0\n",
    );
    desk.twin("check program.cnc --machine melfa.toml --physics").ended(0, "");
    let run =
        "run program.cnc --machine melfa.toml --drives none --report run.json --record run.rrd";
    desk.twin(run).ended(0, "");
    let report = desk.read("run.json");
    let error = report["tool_error_mm"]["twin"]["max"].as_f64().expect("a number");
    assert!(error > 0.0 && error < 0.1, "{report}");
    // The meshes of the robot are in the recording: some 60,000 triangles, 72 bytes a corner.
    let size = std::fs::metadata(desk.path("run.rrd")).expect("it was written").len();
    assert!(size > 1_000_000, "{size}");
    // The tool is where it is in space, and 5 mm off is noticed.
    desk.write("wrong.toml", &machine.concat().replace("325.0, 275.0", "320.0, 280.0"));
    desk.twin("check program.cnc --machine wrong.toml")
        .ended(2, "these dimensions would fit: arm_lengths_mm = [325, 275, 0]");
}
