//! `twin cam` as a process: what it prints is known in closed form.

use crate::process::Desk;
use crate::root;
use serde_json::Value;

/// 0 to 100 mm over 180° from rest to rest, and back.
const LIFT: &str = r#"
name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [
  { master = 0, slave = 0 },  # down
  { master = 180, slave = 100 },
  { master = 360, slave = 0 },
]
tappets = [{ group = 1, master = 90, action = "on" }]
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in\n{text}"))
}

#[track_caller]
fn near(value: &Value, expected: f64) {
    let found = value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
        "{found}, expected {expected}"
    );
}

/// The quintic from rest to rest over w by h: y′ = 15/8 · h/w at most, y″ = 10/√3 · h/w², y‴ = 60 · h/w³.
#[test]
fn bounds_in_closed_form() {
    let desk = desk();
    let check = ["cam", "check", "lift.toml", "--master-velocity", "200", "--format", "json"];
    let done = desk.twin(
        &[
            &check[..],
            &["--max-velocity", "250", "--max-acceleration", "2000", "--position-max", "100"],
        ]
        .concat(),
    );
    done.ended(0, "");
    let found = object(&done.stdout);
    let (h, w, v) = (100.0, 180.0_f64, 200.0);
    near(&found["velocity"]["max"], 15.0 / 8.0 * h / w * v);
    near(&found["velocity"]["at_max"], 90.0);
    near(&found["acceleration"]["max"], 10.0 / 3.0_f64.sqrt() * h / (w * w) * v * v / 1.0);
    near(&found["jerk"]["max"], 60.0 * h / w.powi(3) * v.powi(3));
    near(&found["largest_master"]["velocity"], 250.0 / (15.0 / 8.0 * h / w));
    assert_eq!(found["largest_master"]["limited_by"], "velocity");
    assert_eq!(found["continuity"], "C2");
    near(&found["tappets"][0]["slave"], 50.0);
    // Faster than the slave.
    let done = desk.twin(&[
        "cam",
        "check",
        "lift.toml",
        "--master-velocity",
        "300",
        "--max-velocity",
        "250",
    ]);
    done.ended(1, "axis-velocity")
        .ended(1, "its limit is 250 mm/s")
        .ended(1, "the master may go 240 deg/s");
    assert!(done.stdout.contains("the master may go 240 deg/s"), "{}", done.stdout);
}

/// The limits of machines/gantry3.toml: X slides from −50 to 650 mm with 400 mm/s.
#[test]
fn limits_of_an_axis_of_a_machine() {
    let desk = desk();
    let check = ["cam", "check", "lift.toml", "--machine", "machine.toml", "--format", "json"];
    let found = desk.twin(&[&check[..], &["--axis", "X"]].concat());
    found.ended(0, "");
    let found = object(&found.stdout);
    near(&found["position"]["limit"][0], -50.0);
    near(&found["velocity"]["limit"][1], 400.0);
    let done = desk.twin(&[&check[..], &["--axis", "X", "--slave-offset", "600"]].concat());
    done.ended(1, "");
    let found = object(&done.stdout);
    assert_eq!(found["findings"][0]["rule"], "axis-position");
    near(&found["findings"][0]["value"], 700.0);
    desk.twin(&[&check[..], &["--axis", "Q"]].concat())
        .ended(2, "there is no axis Q; its axes are X, Y, Z");
    desk.write("turn.toml", &LIFT.replace("\"mm\"", "\"deg\""));
    let turned = ["cam", "check", "turn.toml", "--machine", "machine.toml", "--axis", "X"];
    desk.twin(&turned).ended(2, "the slave is in deg, axis X in mm");
}

#[test]
fn samples_are_the_curve() {
    let desk = desk();
    let done =
        desk.twin(&["cam", "sample", "lift.toml", "--step", "45", "--master-velocity", "10"]);
    done.ended(0, "");
    let rows: Vec<_> = done.stdout.lines().collect();
    assert_eq!(
        rows[0],
        "master_deg,slave_mm,velocity_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3"
    );
    assert_eq!(rows.len(), 10);
    // The vector cam-rest-rest: y, v and a at 45 with the master at 1, here at 10.
    let row: Vec<f64> = rows[2].split(',').map(|cell| cell.parse().expect("a number")).collect();
    for (found, expected) in row.iter().zip([45.0, 10.351_562_5, 5.859_375, 1.736_111_111_11]) {
        assert!((found - expected).abs() < 1e-9, "{row:?}");
    }
    desk.twin(&["cam", "sample", "lift.toml", "--points", "3", "-o", "out.csv"]).ended(0, "");
    assert_eq!(std::fs::read_to_string(desk.path("out.csv")).expect("written").lines().count(), 4);
    desk.twin(&["cam", "sample", "lift.toml", "-o", "lift.toml"]).ended(2, "name another file");
}

#[test]
fn forms_are_converted_and_back() {
    let desk = desk();
    let convert = |from: &str, to: &str, more: &[&str], words: &str| {
        desk.twin(&[&["cam", "convert", from, to], more].concat()).ended(0, words);
    };
    let check = |name: &str| {
        let done = desk.twin(&["cam", "check", name, "--format", "json"]);
        done.ended(0, "");
        let mut found = object(&done.stdout);
        let object = found.as_object_mut().expect("an object");
        for key in ["file", "master", "slave", "cam"] {
            object.remove(key);
        }
        found
    };
    convert("lift.toml", "lift.cam", &[], "the slave is where it was everywhere");
    convert("lift.cam", "again.toml", &[], "the slave is where it was everywhere");
    assert_eq!(check("again.toml"), check("lift.toml"));
    convert("lift.toml", "lift.txt", &[], "3 points");
    convert("lift.txt", "words.toml", &[], "3 points");
    assert_eq!(check("words.toml"), check("lift.toml"));
    convert("lift.toml", "points.csv", &[], "3 points; the slave is where it was everywhere");
    // 721 positions, of which few are needed for a hundredth of a mm.
    convert("lift.toml", "lift.asc", &["--points", "721"], "721 points");
    let ascii = std::fs::read(desk.path("lift.asc")).expect("written");
    assert!(ascii.starts_with(b"0;0\r\n0.5;"));
    let done = desk.twin(&["cam", "convert", "lift.asc", "thin.toml", "--tolerance", "0.01"]);
    done.ended(0, "721 points became").ended(0, "u from where it was at most");
    let far = done.stderr.split("the slave is ").nth(1).and_then(|rest| rest.split(' ').next());
    let far: f64 = far.expect("a distance").parse().expect("a number");
    assert!(far <= 0.01 && far > 0.001, "{}", done.stderr);
    convert(
        "lift.toml",
        "table.cam",
        &["--table", "equidistant", "--points", "360", "--type", "int"],
        "360 points",
    );
    desk.twin(&["cam", "convert", "lift.toml", "lift.xyz"]).ended(2, "are read and written as");
    desk.twin(&["cam", "convert", "lift.toml", "x.toml", "--tolerance", "1"])
        .ended(2, "--tolerance is for tables");
    let damaged = std::fs::read(desk.path("lift.cam")).map(|mut bytes| {
        bytes[40] ^= 1;
        bytes
    });
    std::fs::write(desk.path("damaged.cam"), damaged.expect("read")).expect("written");
    desk.twin(&["cam", "check", "damaged.cam"]).ended(2, "checksum");
}

#[test]
fn what_is_wrong_with_a_file_is_shown_at_its_place() {
    let desk = desk();
    desk.write("wrong.toml", &LIFT.replace("slave = 100 }", "slave = 100, speed = 3 }"));
    let done = desk.twin(&["cam", "check", "wrong.toml"]);
    done.ended(2, "unknown key `speed`").ended(2, "wrong.toml:7");
    desk.write("wrong.csv", "master,slave\n0,1\nx,2\n");
    desk.twin(&["cam", "check", "wrong.csv"]).ended(2, "wrong.csv: line 3: `master` is `x`");
}

#[test]
fn shipped_cams_are_checked_and_drawn() {
    let desk = Desk::new();
    let shipped = |name: &str| root().join("examples/cams").join(name).display().to_string();
    let pick = shipped("pick_and_place.toml");
    let limits =
        ["--master-velocity", "360", "--max-velocity", "600", "--max-acceleration", "8000"];
    let check = [&["cam", "check", &pick], &limits[..]].concat();
    desk.twin(&check).ended(0, "");
    let plot = [&["cam", "plot", &pick, "-o", "pick.svg"], &limits[..]].concat();
    desk.twin(&plot).ended(0, "");
    let picture = std::fs::read_to_string(desk.path("pick.svg")).expect("written");
    assert!(picture.starts_with("<svg ") && picture.trim_end().ends_with("</svg>"));
    for word in
        ["position", "velocity", "acceleration", "jerk", "tappets of group 1", "master (deg)"]
    {
        assert!(picture.contains(word), "{word}");
    }
    desk.twin(&[&["cam", "plot", &pick, "-o", "again.svg"], &limits[..]].concat()).ended(0, "");
    assert!(picture == std::fs::read_to_string(desk.path("again.svg")).expect("written"));
    let shear = [
        "cam",
        "check",
        &shipped("flying_shear.toml"),
        "--master-velocity",
        "500",
        "--max-velocity",
        "1200",
    ];
    desk.twin(&[&shear[..], &["--max-acceleration", "12000"]].concat()).ended(0, "");
    let index = shipped("indexer.csv");
    desk.twin(&["cam", "check", &index, "--interpolation", "cubic", "--once"]).ended(0, "");
    desk.twin(&["cam", "check", &index, "--max-acceleration", "1000"]).ended(1, "cam-continuity");
}

/// What a form leaves behind, and files of another kind, are told.
#[test]
fn what_is_lost_or_mistaken_is_told() {
    let desk = desk();
    desk.twin(&["cam", "convert", "lift.toml", "lift.csv"])
        .ended(0, "1 of lift.toml are left behind");
    let plot = ["cam", "plot", "lift.toml", "--master-velocity", "360", "-o", "lift.png"];
    desk.twin(&plot).ended(2, "pictures are SVG");
    assert!(!desk.path("lift.png").exists());
    let run = ["cam", "run", "lift.toml", "--machine", "machine.toml", "--drives", "none"];
    desk.twin(&run).ended(1, "this is a cam, no job");
    desk.write("job.toml", "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n");
    desk.twin(&["cam", "check", "job.toml", "--master-velocity", "1"])
        .ended(2, "this is a job, no cam");
}
