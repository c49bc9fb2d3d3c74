//! Remedies that `twin check` names, carried out: what they cure is gone when it is checked again.

use crate::desk::{Desk, Done, shipped};

/// Out of reach (450 mm, and 50 mm about the axis of the first arm), and how far the farthest point is away.
const OUT_OF_REACH: [(&str, f64); 6] = [
    // The second line is farther out than the first: √(440² + 200²).
    ("N10 G92 X240 Y0 Z20\nN20 F100 E500 E-500\nN30 G1 X440\nN40 G1 Y200\nN50 G1 X240\n", 483.322),
    // The end of the line: √(425² + 165²).
    ("N10 G92 X425 Y100 Z20\nN20 F50 E500 E-500\nN30 G1 X425 Y165\n", 455.906),
    // The far side of a circle: √(300² + (150.1 − 150)²) + 150.1, nearly.
    ("N10 G92 X300 Y150.1 Z20\nN20 F100 E500 E-500\nN30 G2 X300 Y150.1 I0 J-150.1\n", 450.1),
    // Through the axis of the first arm.
    ("N10 G92 X150 Y0 Z20\nN20 F50 E500 E-500\nN30 G1 X-50 Y0\n", 0.0),
    ("N10 G92 X100 Y0 Z20\nN20 F50 E500 E-500\nN30 G1 X-100 Y0\n", 0.0),
    // Next to it.
    ("N10 G92 X100 Y30 Z20\nN20 F50 E500 E-500\nN30 G1 X-100 Y30\n", 30.0),
];

/// The move of the part in `done`, mm.
fn moved(done: &Done) -> [f64; 3] {
    let words: Vec<_> = done.stderr.split_whitespace().filter(|word| *word != "│").collect();
    let at = words.windows(3).position(|three| three == ["move", "the", "part"]);
    let at = at.unwrap_or_else(|| panic!("no move in\n{}", done.stderr));
    let mut by = [0.0; 3];
    for word in words.iter().skip(at + 4).take_while(|word| **word != "mm") {
        let axis = "XYZ".find(&word[..1]).expect("a coordinate");
        by[axis] = word[1..].parse().expect("a length");
    }
    assert!(by.iter().any(|way| *way != 0.0), "{}", done.stderr);
    by
}

/// A machine file whose work frame is moved.
fn with_frame_at(desk: &Desk, machine: &str, [x, y, z]: [f64; 3]) {
    let (here, there) =
        ("translation_mm = [0.0, 0.0, 0.0]", format!("translation_mm = [{x}, {y}, {z}]"));
    let text = shipped(machine);
    let text = if text.contains(here) {
        text.replace(here, &there)
    } else {
        assert!(!text.contains("[work_frame]"), "{machine}");
        format!("{text}\n[work_frame]\n{there}\nrotation_deg = [0.0, 0.0, 0.0]\n")
    };
    desk.write("moved.toml", &text);
}

#[test]
fn a_part_out_of_reach_is_within_it_after_the_move() {
    let desk = Desk::new();
    for (text, away) in OUT_OF_REACH {
        desk.write("part.cnc", &format!("% PART\n{text}"));
        for limits in ["", "--limits programmed"] {
            with_frame_at(&desk, "machines/scara2.toml", [0.0; 3]);
            let command = format!("check part.cnc -m moved.toml {limits}");
            let done = desk.twin(&command);
            done.ended(1, "the tool cannot be there");
            let report = desk.twin(&format!("{command} --format json")).object();
            let findings = report["findings"].as_array().expect("a list");
            let reach = findings.iter().filter(|one| one["rule"] == "reach");
            let excess = |one: &serde_json::Value| {
                let [value, limit] = ["value", "limit"].map(|key| one[key].as_f64().expect(key));
                ((value - limit).abs(), value)
            };
            let worst = reach.map(excess).max_by(|one, other| one.0.total_cmp(&other.0));
            let (_, value) = worst.expect("an error of reach");
            assert!((value - away).abs() < 0.005, "{value} mm, {text}");
            with_frame_at(&desk, "machines/scara2.toml", moved(&done));
            let done = desk.twin(&command);
            assert!(!done.stderr.contains("cannot be there"), "{text}\n{}", done.stderr);
        }
    }
}

/// A circle that touches the edge of the reach: the move takes it off the edge.
#[test]
fn a_path_on_the_edge_of_the_reach_is_off_it_after_the_move() {
    let desk = Desk::new();
    let circle = "N10 G92 X300 Y150 Z20\nN20 F100 E500 E-500\nN30 G2 X300 Y150 I0 J-150\n";
    desk.write("part.cnc", &format!("% PART\n{circle}"));
    with_frame_at(&desk, "machines/scara2.toml", [0.0; 3]);
    let done = desk.twin("check part.cnc -m moved.toml");
    done.ended(1, "at an edge of its reach");
    with_frame_at(&desk, "machines/scara2.toml", moved(&done));
    let done = desk.twin("check part.cnc -m moved.toml");
    assert!(!done.stderr.contains("edge of its reach"), "{}", done.stderr);
}

/// The tool is 40 mm long, so that Z100 is above the 120 mm of the axis: the part has to go down by 20 mm.
#[test]
fn a_position_beyond_its_limits_names_the_move() {
    let desk = Desk::new();
    desk.write("part.cnc", "% PART\nN10 G92 X300 Y100 Z60\nN20 F100 E500 E-500\nN30 G1 Z100\n");
    with_frame_at(&desk, "machines/gantry3.toml", [0.0; 3]);
    let done = desk.twin("check part.cnc -m moved.toml");
    done.ended(1, "axis Z at 140.000 mm is above its software limit of 120.000 mm");
    assert!((moved(&done)[2] + 20.0).abs() < 0.15, "{}", done.stderr);
    with_frame_at(&desk, "machines/gantry3.toml", moved(&done));
    desk.twin("check part.cnc -m moved.toml").ended(0, "").says("fit: 0 errors");
}

/// The acceleration along a line is what the axis gets: no lower feed helps, a lower E does.
#[test]
fn a_lower_acceleration_is_named_where_no_feed_helps() {
    let desk = Desk::new();
    let line = |e: &str| format!("% LINE\nN10 G92 X100 Y100 Z20\nN20 G1 X300 F100 E{e} E-{e}\n");
    with_frame_at(&desk, "machines/gantry3.toml", [0.0; 3]);
    desk.write("line.cnc", &line("5000"));
    let done = desk.twin("check line.cnc -m moved.toml --limits programmed");
    done.ended(1, "no lower feed helps here: lower E to 3000");
    desk.write("line.cnc", &line("3000"));
    desk.twin("check line.cnc -m moved.toml --limits programmed").ended(0, "");
}

/// Arms that are stretched at the end of a line: no plan keeps the jerk there.
#[test]
fn a_plan_that_breaks_a_jerk_limit_is_not_fit() {
    let desk = Desk::new();
    let line = |x: &str| {
        format!("% E\nN10 G92 X300 Y0 Z20\nN20 F200 E2000 E-2000\nN30 G1 X{x} Y0\nN40 G1 X300\n")
    };
    with_frame_at(&desk, "machines/scara2.toml", [0.0; 3]);
    desk.write("line.cnc", &line("450"));
    let done = desk.twin("check line.cnc -m moved.toml");
    assert_eq!(done.status, Some(1), "{}\n{}", done.stdout, done.stderr);
    desk.write("line.cnc", &line("449.9"));
    desk.twin("check line.cnc -m moved.toml").ended(0, "");
}
