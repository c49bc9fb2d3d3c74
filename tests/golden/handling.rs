//! Loose bodies, belts, clamps and grippers: what the binary reports, against closed forms.

use crate::desk::{Desk, number};
use serde_json::Value;

/// Free fall, m/s².
const G: f64 = 9.81;

/// A table whose top is at Z-60, and a part of 1 kg on it whose top is at Z-30, at X100 Y50.
const TABLE: &str = r#"
[[obstacles]]
name = "table"
shape = "box"
size_mm = [800, 800, 20]
position_mm = [300, 100, -70]
material = "steel"
"#;

const PART: &str = r#"
[[bodies]]
name = "part"
shape = "box"
size_mm = [40, 40, 30]
position_mm = [100, 50, -45]
mass_kg = 1
material = "rubber"

[[friction]]
materials = ["steel", "rubber"]
coefficient = 0.5
"#;

/// A suction cup at the tool tip.
fn cup(force: f64) -> String {
    format!(
        "\n[[grippers]]\nname = \"cup\"\nkind = \"suction\"\nforce_n = {force}\nclose_m = 10\nopen_m = 11\ndelay_ms = 50\n"
    )
}

/// The portal with this scene next to it, and a program; M10 and M11 take 0.3 s, M20 0.5 s and M21 2 s.
fn desk(scene: &str, program: &str) -> Desk {
    let desk = Desk::new();
    for (number, time_ms) in [(10, 300), (11, 300), (20, 500), (21, 2000)] {
        desk.add_to_machine(&format!("\n[[m_functions]]\nm = {number}\ntime_ms = {time_ms}\n"));
    }
    desk.write("scene.toml", scene);
    desk.write("program.cnc", &format!("% handling\n{program}"));
    desk
}

/// Report of the check of the program with the simulated machine.
#[track_caller]
fn report(desk: &Desk, status: i32) -> Value {
    let check = "check program.cnc -m machine.toml --scene scene.toml --physics --format json";
    desk.twin(&format!("{check} --limits programmed")).ended(status, "").object()
}

#[track_caller]
fn assert_at(report: &Value, wanted: [f64; 3], tolerance: f64) {
    let place = &report["bodies"][0]["pose"]["position_mm"];
    for (found, wanted) in place.as_array().expect("a place").iter().zip(wanted) {
        assert!((number(found) - wanted).abs() < tolerance, "{place}, not {wanted}");
    }
}

/// The only finding of `rule`.
#[track_caller]
fn finding<'r>(report: &'r Value, rule: &str) -> &'r Value {
    let findings = report["findings"].as_array().expect("a list");
    let found: Vec<_> = findings.iter().filter(|one| one["rule"] == rule).collect();
    let [found] = found[..] else { panic!("{rule}: {findings:#?}") };
    found
}

/// Over the part, 1 mm above it, and closed.
const PICK: &str = "\
N10 G1 X100 Y50 Z-20 F100 E1000 E-1000
N20 G1 Z-29 F20 E200 E-200
N30 M10
";

#[test]
fn a_part_is_picked_carried_and_put_down() {
    let away = "N50 G1 Z0\nN60 G1 X300 Y150 F100 E1000 E-1000\n";
    let down = "N70 G1 Z-29 F20 E200 E-200\nN80 M11\nN100 G1 Z0\n";
    let desk = self::desk(&format!("{TABLE}{PART}{}", cup(40.0)), &format!("{PICK}{away}{down}"));
    let found = report(&desk, 0);
    assert_at(&found, [300.0, 150.0, -45.0], 5e-3);
    assert_eq!(found["bodies"][0]["held_by"], Value::Null);
    let run = "run program.cnc -m machine.toml --scene scene.toml --drives none --report r.json";
    desk.twin(&format!("{run} --limits programmed")).ended(0, "");
    assert_eq!(desk.read("r.json")["bodies"], found["bodies"]);

    // It hangs where it was taken: its middle 16 mm below the tip.
    let desk =
        self::desk(&format!("{TABLE}{PART}{}", cup(40.0)), &format!("{PICK}{away}N70 M20\n"));
    let found = report(&desk, 0);
    assert_at(&found, [300.0, 150.0, -16.0], 2e-2);
    assert_eq!(found["bodies"][0]["held_by"], "cup");
}

/// A cup of 11 N carries 1 kg with 3.5 m/s², and loses it where m·√(g² + a²) is more: above 4.98 m/s².
#[test]
fn a_part_is_lost_at_the_acceleration_that_the_cup_does_not_hold() {
    let carry = |acceleration: u32| {
        let line = format!("N60 G1 X300 F300 E{acceleration} E-{acceleration}\n");
        let program = format!("{PICK}N50 G1 Z0\n{line}N70 M20\n");
        let desk = self::desk(&format!("{TABLE}{PART}{}", cup(11.0)), &program);
        let limit = "max_acceleration_mm_per_s2 = 3000.0";
        desk.edit_machine(limit, "max_acceleration_mm_per_s2 = 10000.0");
        desk
    };
    let held = report(&carry(3500), 0);
    assert_eq!(held["bodies"][0]["held_by"], "cup");
    let lost = report(&carry(8000), 1);
    let loss = finding(&lost, "part-lost");
    assert_eq!((number(&loss["limit"]), &loss["unit"]), (11.0, &Value::from("N")), "{loss}");
    assert!((11.0..G.hypot(10.0)).contains(&number(&loss["value"])), "{loss}");
    assert_eq!((&loss["line"], &loss["block"]), (&6.into(), &60.into()), "{loss}");
    let message = loss["message"].as_str().expect("a message");
    assert!(message.contains("gripper cup lost part") && message.contains("acceleration"));
    assert_eq!(lost["bodies"][0]["held_by"], Value::Null);
}

/// The tip is 10 mm above the part, and the cup reaches 2 mm.
#[test]
fn a_grip_is_missed() {
    let program = "N10 G1 X100 Y50 Z-20 F100 E1000 E-1000\nN15 M20\nN20 M10\n";
    let desk = self::desk(&format!("{TABLE}{PART}{}", cup(40.0)), program);
    let found = report(&desk, 1);
    let miss = finding(&found, "grip-missed");
    assert!((number(&miss["value"]) - 10.0).abs() < 0.02, "{miss}");
    assert_eq!((&miss["limit"], &miss["unit"]), (&2.0.into(), &"mm".into()), "{miss}");
    assert_at(&found, [100.0, 50.0, -45.0], 1e-3);
    // Without the simulated machine nothing is gripped, and that is said once.
    desk.twin("check program.cnc -m machine.toml --scene scene.toml")
        .ended(0, "machine.toml has loose bodies or grippers, which only --physics moves");
}

/// A clamp that holds a part of 1 kg in the air holds m·g: 9.9 N do, 9.7 N do not, and the part falls.
#[test]
fn a_clamp_holds_the_weight_of_its_part() {
    let place = "[100, 50, -45]";
    assert!(PART.contains(place));
    let part = |clamp: f64| PART.replace(place, &format!("[5000, 50, 100]\nclamp_n = {clamp}"));
    let scene = |clamp: f64| format!("{TABLE}{}", part(clamp));
    let waiting = "N10 G1 X1 F10 E1000 E-1000\nN20 M21\n";
    let held = report(&self::desk(&scene(9.9), waiting), 0);
    assert_at(&held, [5000.0, 50.0, 100.0], 1e-3);
    let fallen = report(&self::desk(&scene(9.7), waiting), 1);
    let gave_way = finding(&fallen, "clamp-overloaded");
    assert!((number(&gave_way["value"]) - G).abs() < 1e-3, "{gave_way}");
    assert_eq!((&gave_way["limit"], &gave_way["unit"]), (&9.7.into(), &"N".into()));
    let dropped = finding(&fallen, "dropped");
    assert!(dropped["message"].as_str().expect("a message").contains("part fell"), "{dropped}");
}

/// A tool of 16 mm at X70 that goes 20 mm towards the part, 22 mm from its side, pushes it by 8 mm.
#[test]
fn a_pushed_part_has_moved() {
    let push = "N10 G1 X50 Y50 Z0 F100 E1000 E-1000\nN20 G1 Z-50\nN30 G1 X80 F10\nN40 G1 X50\n";
    let found = report(&self::desk(&format!("{TABLE}{PART}"), push), 1);
    let moved = finding(&found, "part-moved");
    assert_eq!(moved["line"], 4, "{moved}");
    assert!(moved["message"].as_str().expect("a message").starts_with("the tool pushed part"));
    assert_at(&found, [108.0, 50.0, -45.0], 0.1);
}

/// A belt of 50 mm/s takes the part along for 6 s: v·t less the v²/(2µg) in which it slides.
#[test]
fn a_belt_carries() {
    let belt = TABLE.replace("material =", "belt_mm_per_s = [50, 0, 0]\nmaterial =");
    let program = "N10 G1 X1 F10 E1000 E-1000\nN20 M21\nN30 M21\nN40 M21\n";
    let found = report(&self::desk(&format!("{belt}{PART}"), program), 0);
    let way = 50.0 * number(&found["duration_s"]) - 1e3 * 0.05 * 0.05 / (2.0 * 0.5 * G);
    assert!(way > 300.0, "{way} mm");
    assert_at(&found, [100.0 + way, 50.0, -45.0], 0.1);
}

/// H1 keeps the gripper closed while the switch is on.
#[test]
fn a_switch_of_the_path_closes_a_gripper() {
    let cup = cup(40.0).replace("close_m = 10\nopen_m = 11\ndelay_ms = 50", "switch = 1");
    let program = "\
N10 G1 X100 Y50 Z-20 F100 E1000 E-1000
N20 G1 Z-29 F20 E200 E-200
N25 M20
N30 G1 Z0 H1 O0
N40 G1 X200 H-1 O1
N50 M21
";
    let found = report(&self::desk(&format!("{TABLE}{PART}{cup}"), program), 0);
    let place = &found["bodies"][0]["pose"]["position_mm"];
    assert!((number(&place[0]) - 200.0).abs() < 10.0, "{place}");
    assert!((number(&place[2]) + 45.0).abs() < 0.01, "{place}");
}

#[test]
fn faults_of_scenes_are_named() {
    let inside = PART.replace("-45]", "-47]");
    let desk = self::desk(&format!("{TABLE}{inside}"), "N10 G1 X1 F10 E1000 E-1000\n");
    desk.twin("check program.cnc -m machine.toml --scene scene.toml --physics")
        .ended(2, "2.000 mm deep in")
        .reports(&["part", "table"]);
    desk.write("scene.toml", &format!("{TABLE}{PART}").replace("mass_kg = 1", "mass = 1"));
    desk.twin("machine machine.toml --scene scene.toml")
        .ended(2, "body \"part\": give either `mass_kg` or `density_kg_per_m3`")
        .reports(&["scene.toml", "unknown key `mass`"]);
    desk.twin("machine machine.toml --scene machine.toml")
        .ended(2, "this is a machine file, not a scene file");
    desk.write("scene.toml", &format!("{TABLE}{PART}{}", cup(40.0)));
    desk.twin("machine machine.toml --scene scene.toml").ended(0, "").says_all(&[
        "body part: 1 kg at X100.0 Y50.0 Z-45.0",
        "gripper cup: suction on quill, holds 40 N within 2 mm; M10 closes, M11 opens",
    ]);
}

/// The example of the book: a part goes from a table to a belt of 60 mm/s, which carries it on.
#[test]
fn the_example_puts_a_part_on_a_belt() {
    let desk = Desk::new();
    let check = "check examples/handling/pick.ngc -m machines/scara2.toml --scene examples/handling/belt.toml";
    let found = desk.twin(&format!("{check} --physics --format json")).ended(0, "").object();
    let calls = &found["m_functions"]["calls"];
    assert_eq!((&calls[1]["m"], &calls[1]["line"]), (&111.into(), &10.into()), "{calls}");
    // The valve takes 50 ms; the part comes to the speed of the belt within 0.3 mm.
    let carried = number(&found["duration_s"]) - number(&calls[1]["time_s"]) - 0.05;
    assert_at(&found, [250.0 + 60.0 * carried, 100.0, -30.0], 0.6);
}
