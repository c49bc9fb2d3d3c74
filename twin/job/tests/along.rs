//! Tests of cams over the path length of a program, against closed forms (manual 4, 6.2.9).

use super::{Job, finds, job, machine, near, run, time};
use crate::setpoint::AxisSetpoint;

/// Z goes 0.1 mm for every mm of the path, up to 40 mm of it.
const CAM: &str = "name = \"rise\"\nmaster = { min = 0, max = 40, unit = \"mm\" }\nslave = { min = 0, max = 4, unit = \"mm\" }\n\
                   elements = [{ from = [0, 0], to = [40, 4] }]\n";

/// 30 mm along X, 10 mm along Y with a stop between: 0.4 s and 0.2 s at 100 mm/s with 1000 mm/s².
const PROGRAM: &str =
    "% contour\nN10 G92 X100 Y50 Z20\nN20 G1 X130 F100 E1000 E-1000\nN30 G1 Y60\n";

const JOB: &str = "[[virtual_axes]]\nname = \"way\"\nkind = \"linear\"\n\
                   [[start]]\naxis = \"X\"\nposition_mm = 100\n[[start]]\naxis = \"Y\"\nposition_mm = 50\n\
                   [[start]]\naxis = \"Z\"\nposition_mm = 20\n\
                   [[blocks]]\nblock = \"MC_CamIn\"\naxis = \"Z\"\nmaster = \"way\"\ncam = \"rise.toml\"\nslave_offset_mm = 20\nperiodic = false\n\
                   [[blocks]]\nblock = \"SMC_Interpolator\"\naxis = \"way\"\nprogram = \"contour.cnc\"\n";

fn with_files(text: &str) -> Job {
    job(text).with("rise.toml", CAM).with("contour.cnc", PROGRAM)
}

fn at(setpoints: &[AxisSetpoint], seconds: f64) -> [f64; 3] {
    let found = setpoints
        .iter()
        .min_by(|one, other| (time(one) - seconds).abs().total_cmp(&(time(other) - seconds).abs()));
    let position = found.unwrap().axes.position;
    [0, 1, 2].map(|axis| position[axis] * 1e3)
}

#[test]
fn a_cam_follows_the_path_length_of_a_program() {
    let (setpoints, findings) = run(&with_files(JOB), &machine());
    assert!(findings.is_empty(), "{findings:?}");
    // A cycle or two until block and cam have begun, of 0.1 mm each.
    for (seconds, way) in [(0.1, 5.0), (0.3, 25.0), (0.4, 30.0), (0.5, 35.0), (0.7, 40.0)] {
        let [x, y, z] = at(&setpoints, seconds);
        near(x + y - 150.0, way, 0.35);
        near(z, 20.0 + 0.1 * way, 0.035);
        // The slave is where its master is in the same cycle.
        near(z - 20.0, 0.1 * (x + y - 150.0), 1e-6);
    }
    near(time(setpoints.last().unwrap()), 0.6, 10e-3);
}

#[test]
fn a_block_without_a_usable_program_is_refused() {
    for (from, to, line, said) in [
        ("contour.cnc", "missing.cnc", 23, "missing.cnc"),
        ("program = \"contour.cnc\"", "", 20, "lacks `program`"),
        ("axis = \"way\"\nprogram", "axis = \"X\"\nprogram", 22, "virtual"),
    ] {
        let (_, findings) = run(&with_files(&JOB.replace(from, to)), &machine());
        finds(&findings, line, said);
    }
}
