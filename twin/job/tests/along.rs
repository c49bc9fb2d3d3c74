//! Tests of cams over the path length of a program, against closed forms (manual 4, 6.2.9).

use super::tests::{job, machine, near, run, time};
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

fn at(setpoints: &[AxisSetpoint], seconds: f64) -> [f64; 3] {
    let found = setpoints
        .iter()
        .min_by(|one, other| (time(one) - seconds).abs().total_cmp(&(time(other) - seconds).abs()));
    let position = found.unwrap().axes.position;
    [0, 1, 2].map(|axis| position[axis] * 1e3)
}

#[test]
fn a_cam_follows_the_path_length_of_a_program() {
    let job = job(JOB);
    std::fs::write(job.folder.path().join("rise.toml"), CAM).unwrap();
    std::fs::write(job.folder.path().join("contour.cnc"), PROGRAM).unwrap();
    let (setpoints, findings) = run(&job, &machine());
    assert!(findings.is_empty(), "{findings:?}");
    // A cycle or two until block and cam have begun, of 0.1 mm each.
    for (seconds, way) in [(0.1, 5.0), (0.3, 25.0), (0.4, 30.0), (0.5, 35.0), (0.7, 40.0)] {
        let [x, y, z] = at(&setpoints, seconds);
        near(x + y - 150.0, way, 0.35);
        near(z, 20.0 + 0.1 * way, 0.035);
        // The slave is where its master is in the same cycle.
        near(z - 20.0, 0.1 * (x + y - 150.0), 1e-6);
    }
    let last = setpoints.last().unwrap();
    near(time(last), 0.6, 10e-3);
}

#[test]
fn what_no_program_is_is_refused() {
    for (from, to, said) in [
        ("contour.cnc", "missing.cnc", "missing.cnc"),
        ("program = \"contour.cnc\"", "", "lacks `program`"),
        ("axis = \"way\"\nprogram", "axis = \"X\"\nprogram", "virtual"),
    ] {
        let job = job(&JOB.replace(from, to));
        std::fs::write(job.folder.path().join("rise.toml"), CAM).unwrap();
        std::fs::write(job.folder.path().join("contour.cnc"), PROGRAM).unwrap();
        let (_, findings) = run(&job, &machine());
        assert!(findings.iter().any(|one| one.message.contains(said)), "{to}: {findings:?}");
    }
}
