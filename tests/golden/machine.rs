//! `twin machine` as a process: text, pictures and recordings.

use crate::desk::Desk;

/// Everything follows from machines/gantry3.toml: limits less the tool of 40 mm, and the velocity limits of the axes.
#[test]
fn a_gantry_is_described() {
    let desk = Desk::new();
    let done = desk.twin("machine machine.toml --height -10");
    done.ended(0, "");
    let lines = [
        "gantry3: gantry3 with 3 axes",
        "kinematics gantry3: offsets_mm = [0.0, 0.0, 0.0]",
        "within the software limits: x -50.0 … 650.0, y -250.0 … 450.0, z -100.0 … 80.0 mm",
        "horizontal section at z -10 mm: 4900.0 cm², x -50.0 … 650.0, y -250.0 … 450.0 mm",
        "vertical section through x 0, y 0 mm at 0°: 1260.0 cm², along it -50.0 … 650.0",
        "singularity measure in the horizontal section: 1.000 everywhere",
        "the tool is at X300.0 Y100.0 Z-10.0 with X 300.000 mm, Y 100.000 mm, Z 30.000 mm",
        "400.0 mm/s (X at its 400.0 mm/s)",
        "200.0 mm/s (Z at its 200.0 mm/s)",
    ];
    for line in lines {
        assert!(done.stdout.contains(line), "{line} is not in\n{}", done.stdout);
    }
}

#[test]
fn a_workspace_is_drawn_and_recorded() {
    let desk = Desk::new();
    let machine = "machine machine.toml --section vertical";
    let out = "--svg space.svg --record space.rrd";
    desk.twin(&format!("{machine} {out}")).ended(0, "");
    let picture = desk.text("space.svg");
    assert!(picture.starts_with("<svg ") && picture.trim_end().ends_with("</svg>"));
    assert!(picture.contains("vertical section") && picture.contains("z (mm)"), "{picture}");
    assert!(std::fs::metadata(desk.path("space.rrd")).expect("it was written").len() > 10_000);
    // The same again is the same, byte for byte.
    desk.twin(&format!("{machine} --svg again.svg")).ended(0, "");
    let again = desk.text("again.svg");
    assert!(again == picture, "the second picture differs");
}

#[test]
fn wrong_use_is_status_2() {
    let desk = Desk::new();
    let machine = |options: &str| desk.twin(&format!("machine machine.toml {options}"));
    machine("--svg missing/space.svg").ended(2, "cannot write missing/space.svg");
    machine("--record missing/space.rrd").ended(2, "missing/space.rrd");
    machine("--urdf --svg space.svg").ended(2, "cannot be used with");
    machine("--height nan").ended(2, "finite");
    machine("--height high").ended(2, "--height");
    machine("--section diagonal --svg space.svg").ended(2, "diagonal");
    machine("--serve nowhere").ended(2, "expected PORT or HOST:PORT");
}
