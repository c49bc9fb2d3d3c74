//! `twin path` and M functions as a process: conversions between programs, drawings and set-points.

use crate::desk::{Desk, shipped};
use serde_json::Value;

/// Both pictures, and the overviews: the program's text says what they show.
#[test]
fn a_program_is_seen_at_a_glance() {
    let desk = Desk::new();
    let program = "examples/contour.cnc";
    desk.twin(&format!("path {program} --prepare --output contour.svg")).ended(0, "");
    let picture = desk.text("contour.svg");
    assert!(picture.contains("before preparation") && picture.contains("every 100 ms"));
    let info = desk.twin(&format!("path {program} --format info")).stdout;
    for line in ["name             CONTOUR", "angle tolerance  2.000 deg", "errors           none"]
    {
        assert!(info.contains(line), "{info}");
    }
    assert!(info.contains("2 arcs, 2 M functions"), "{info}");
    let viewer = desk.twin(&format!("path {program} --format viewer"));
    viewer.ended(0, "").says("    16  N120 G3 X180 Y80 R15\n");
    let viewer = viewer.stdout;
    assert!(!viewer.contains("(The contour"), "{viewer}");
    let listing = desk.twin(&format!("path {program} --format listing")).stdout;
    assert!(listing.contains("LINPOS") && listing.contains("CCLW"), "{listing}");
}

/// Without an answer nothing goes on behind an M function that the user must acknowledge.
#[test]
fn a_user_who_is_not_there_acknowledges_nothing() {
    let desk = Desk::new();
    desk.write("m.cnc", "% m\nN10 G1 X10 F100 E500 E-500\nN20 M7\nN30 G1 X0\n");
    let run = "run m.cnc --machine machine.toml --drives none";
    desk.twin(&format!("{run} --m-ack prompt"))
        .ended(2, "M7 at line 3 (N20) cannot be acknowledged");
    desk.twin(run).ended(0, "");
}

/// One file per layer of a drawing.
#[test]
fn layers_become_files() {
    let desk = Desk::new();
    let drawing = shipped("tests/data/path_drawing/part.dxf");
    let (arc, line) = drawing.split_once("\n0\nLINE\n8\nCONTOUR").expect("as written");
    desk.write("part.dxf", &format!("{arc}\n0\nLINE\n8\nBORES{line}"));
    let divided = "path part.dxf --one-per layer --format din66025";
    desk.twin(divided).ended(2, "--output FOLDER");
    desk.twin(&format!("{divided} --output programs")).ended(0, "");
    let mut names: Vec<_> = std::fs::read_dir(desk.path("programs"))
        .expect("a folder")
        .map(|entry| entry.expect("readable").file_name().into_string().expect("text"))
        .collect();
    names.sort();
    assert_eq!(names, ["001-CONTOUR.cnc", "002-BORES.cnc"]);
}

/// Set-points of 100 mm with F20 E40 E-80, as JSON.
fn setpoints(desk: &Desk, arguments: &str) -> Vec<Value> {
    desk.write("line.cnc", "% line\nN10 G92 X0 Y0\nN20 G1 X100 F20 E40 E-80\n");
    let done = desk.twin(&format!("path line.cnc --format setpoints {arguments}"));
    done.ended(0, "").rows()
}

fn near(row: &Value, key: &str, expected: f64) {
    let value = if key == "x" { &row["position_mm"][0] } else { &row[key] };
    let value = value.as_f64().expect("a number");
    assert!((value - expected).abs() < 1e-6, "{key} {value}, expected {expected}: {row}");
}

/// Closed forms: 5 mm in 0.5 s up to 20 mm/s, 15 mm in 1 s; from 20 to 10 mm/s 1.875 mm in 0.125 s, from 10 to 0 as long
/// over 0.625 mm, so 82.5 mm at 10 mm/s: 9.5 s.
#[test]
fn the_override_changes_on_the_way() {
    let rows = setpoints(&Desk::new(), "--at 1:override=50");
    near(&rows[500], "velocity_mm_per_s", 20.0);
    near(&rows[1000], "x", 15.0);
    near(&rows[1125], "velocity_mm_per_s", 10.0);
    near(&rows[1125], "x", 16.875);
    let last = rows.last().expect("set-points");
    near(last, "time_s", 9.5);
    near(last, "x", 100.0);
    near(last, "way_mm", 100.0);
    assert_eq!(
        (&rows[200]["status"], &rows[1050]["status"]),
        (&"accelerating".into(), &"decelerating".into())
    );
}

/// From 20 mm/s to rest over 2.5 mm in 0.25 s; on from there a second later.
#[test]
fn stops_hold_the_path() {
    let stop = "--at 1:slow-stop=on --at 2:slow-stop=off";
    let rows = setpoints(&Desk::new(), stop);
    near(&rows[1250], "x", 17.5);
    near(&rows[1999], "x", 17.5);
    assert_eq!(rows[1500]["status"], "waiting");
    near(&rows[2500], "x", 22.5);
    // A path that nobody lets go on ends, and so does one that is aborted.
    let rows = setpoints(&Desk::new(), "--at 1:slow-stop=on");
    near(rows.last().expect("set-points"), "x", 17.5);
    assert!(rows.len() < 12_000);
    let rows = setpoints(&Desk::new(), "--at 1:abort=on");
    // Where the last set-point had it, at 0.999 s.
    near(rows.last().expect("set-points"), "x", 14.98);
}

#[test]
fn a_path_is_gone_both_ways_and_by_position() {
    let desk = Desk::new();
    let rows = setpoints(&desk, "--both-ways --at 2:override=-100");
    let farthest = rows.iter().filter_map(|row| row["position_mm"][0].as_f64()).fold(0.0, f64::max);
    // 35 mm after 2 s, and 2.5 mm to stop.
    assert!((farthest - 37.5).abs() < 1e-6, "{farthest}");
    near(rows.last().expect("set-points"), "x", 0.0);

    desk.write("slope.cnc", "% slope\nN10 G92 X0 Y0\nN20 G1 X10 Y5 F20\n");
    desk.write("x.txt", "100\n101.5\n104\n109\n111\n");
    let slope = "path slope.cnc --format setpoints";
    let done = desk.twin(&format!("{slope} --by-position x.txt --position-offset 100"));
    let rows = done.ended(0, "").rows();
    for (row, y) in rows.iter().zip([0.0, 0.75, 2.0, 4.5, 5.0]) {
        let found = row["position_mm"][1].as_f64().expect("a number");
        assert!((found - y).abs() < 1e-6, "{row}");
    }
    assert_eq!(rows.len(), 5);
    desk.twin(&format!("{slope} --at 1:override=0")).ended(2, "--both-ways");
    desk.twin(&format!("{slope} --at soon")).ended(2, "TIME:INPUT=VALUE");
}
