//! Obstacles around a machine and the clearance from them: in pictures, tables and recordings.

use crate::desk::{Desk, number, shipped};
use crate::recording::{chunks, entities, rows, series};
use rerun::components;

/// The portal with a vice, and a program in it.
fn desk() -> Desk {
    let desk = Desk::new();
    for (from, to) in
        [("machines/gantry3_vice.toml", "vice.toml"), ("examples/vice.ngc", "vice.ngc")]
    {
        desk.write(to, &shipped(from));
    }
    desk
}

/// Where they are in the machine frame: those in the work frame are shifted by (200, 100, 0) mm.
#[test]
fn obstacles_are_in_the_recording_of_a_run() {
    let desk = desk();
    desk.twin("run vice.ngc -m vice.toml --drives none --record r.rrd").ended(0, "");
    check_obstacles(&desk);
}

#[test]
fn obstacles_are_in_recording_and_picture_of_a_machine() {
    let desk = desk();
    let out = "--record r.rrd --svg space.svg";
    desk.twin(&format!("machine vice.toml {out}")).ended(0, "");
    check_obstacles(&desk);
    let picture = desk.text("space.svg");
    assert!(picture.contains("obstacles") && picture.contains("stock"), "{picture}");
    desk.twin("machine machine.toml --svg space.svg").ended(0, "");
    let without = desk.text("space.svg");
    assert!(!without.contains("obstacles") && !without.contains("stock"), "{without}");
}

fn check_obstacles(desk: &Desk) {
    let chunks = chunks(desk);
    let found = entities(&chunks);
    let around: Vec<_> = found.iter().filter(|one| one.starts_with("/surroundings/")).collect();
    let wanted = ["fixed\\ jaw/boxes", "moving\\ jaw/boxes", "screw/cylinders", "stock/boxes"];
    let wanted = wanted.into_iter().chain(["table/boxes"]);
    let wanted: Vec<_> = wanted.map(|one| format!("/surroundings/{one}")).collect();
    assert_eq!(around, wanted.iter().collect::<Vec<_>>());
    let descriptor = rerun::Boxes3D::descriptor_centers();
    for (name, wanted) in [
        ("fixed jaw", [250.0, 90.0, -35.0]),
        ("stock", [250.0, 130.0, -15.0]),
        ("table", [300.0, 150.0, -70.0]),
    ] {
        let entity = format!("surroundings/{name}/boxes");
        let centers = rows::<components::Translation3D>(&chunks, &entity, &descriptor);
        assert_eq!(centers.len(), 1, "{name}");
        let [center] = centers[0].1[..] else { panic!("{name}: {centers:?}") };
        for (found, wanted) in center.0.0.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-3, "{name}: {center:?}");
        }
    }
    // The tool in the stock is seen.
    let colors = rerun::Boxes3D::descriptor_colors();
    let alpha = |entity| rows::<components::Color>(&chunks, entity, &colors)[0].1[0].to_array()[3];
    assert_eq!(alpha("surroundings/table/boxes"), 255);
    assert!(alpha("surroundings/stock/boxes") < 255);
}

/// Beside the fixed jaw, whose front is at Y-20 of the program: the tool of 6 mm stops 3 mm from it, and comes back. Then it goes
/// along 1.5 mm above its top, at Z-10.
const NEAR: &str = "\
G21 G90 G17 G54
G0 Z30
G0 X50 Y-40
G1 Z-13 F900
G1 Y-26
G4 P0.1
N70 G1 Y-40
G0 Z30
G0 X50 Y-10
G1 Z-8.5 F900
G1 X100
G0 Z30
M2
";

/// The clearance of the simulated machine is in the recording of a run as often as its errors are, and where it is near the
/// nearest points are joined.
#[test]
fn a_recording_shows_how_near_it_was() {
    let desk = desk();
    desk.write("near.ngc", NEAR);
    let run = "run near.ngc --drives none --record r.rrd";
    desk.twin(&format!("{run} -m vice.toml --report r.json")).ended(0, "");
    let chunks = chunks(&desk);
    let clearance = series(&chunks, "clearance/twin");
    assert_eq!(clearance.len(), series(&chunks, "error/axis_mm/Z/twin").len());
    assert!(
        series(&chunks, "clearance/wanted").iter().all(|(_, value)| (value - 2.0).abs() < 1e-9)
    );
    let least = clearance.iter().fold(f64::INFINITY, |least, (_, value)| least.min(*value));
    let told = number(&desk.read("r.json")["clearance"]["least_mm"]);
    assert!((told - 1.5).abs() < 1e-6, "{told} mm");
    // The simulated machine is hundredths beside its set-points.
    assert!((least - 1.5).abs() < 0.05, "{least} mm");
    let strips = rerun::LineStrips3D::descriptor_strips();
    let joined = rows::<components::LineStrip3D>(&chunks, "nearest/line", &strips);
    let joined: Vec<_> = joined.iter().filter(|(_, strips)| !strips.is_empty()).collect();
    let near = |value: f64| value < 20.0;
    let begin = clearance.iter().find(|(_, value)| near(*value)).expect("it comes near").0;
    assert!((joined[0].0 - begin).abs() <= 20_000_000, "{} and {begin} ns", joined[0].0);
    // The line is as long as the clearance is large then.
    for (time, strips) in joined {
        let ends: Vec<_> = strips[0].0.iter().map(|end| end.0.map(f64::from)).collect();
        let long = ends[0].iter().zip(ends[1]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let (_, value) = clearance.iter().find(|row| row.0 == *time).expect("at the same time");
        assert!((long - value).abs() < 1e-3 && near(*value), "{long} and {value} mm at {time} ns");
    }
    // Where the machine file speaks of nothing there is nothing.
    desk.twin(&format!("{run} -m machine.toml"));
    let others = entities(&crate::recording::chunks(&desk));
    assert!(!others.iter().any(|one| one.contains("clearance") || one.contains("nearest")));
}

/// Every block has a row: where the tool is nearest, in the machine frame, in which the work frame is shifted by (200, 100, 0) mm.
#[test]
fn every_block_is_told_how_near_it_comes() {
    let desk = desk();
    desk.write("near.ngc", NEAR);
    desk.twin("check near.ngc -m vice.toml --clearance near.csv")
        .ended(0, "1.500 mm to fixed jaw; the clearance wanted is 2.000 mm");
    let text = desk.text("near.csv");
    let mut rows = text.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header").join(",");
    assert_eq!(header, "line,block,time_s,clearance_mm,part,other,x_mm,y_mm,z_mm");
    let rows: Vec<_> = rows.collect();
    let lines: Vec<_> = rows.iter().map(|row| row[0].parse::<u32>().expect("a line")).collect();
    assert_eq!(lines, [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    let value = |row: &[&str], column: usize| row[column].parse::<f64>().expect("a number");
    assert!(rows.is_sorted_by(|one, next| value(one, 2) < value(next, 2)), "{text}");
    for (line, block, clearance, y) in
        [(5, "", 3.0, 77.0), (6, "", 3.0, 77.0), (7, "70", 3.0, 77.0), (11, "", 1.5, 90.0)]
    {
        let row = rows.iter().find(|row| row[0] == line.to_string()).expect("a row");
        assert_eq!((row[1], row[4], row[5]), (block, "the tool", "fixed jaw"), "{row:?}");
        assert!((value(row, 3) - clearance).abs() < 1e-3, "{row:?}");
        // Of the tool of 3 mm: its side, or some point of its bottom.
        assert!((value(row, 7) - y).abs() < if line < 11 { 1e-3 } else { 3.0 }, "{row:?}");
        assert!((-13.0..=-8.0).contains(&value(row, 8)), "{row:?}");
    }
}

#[test]
fn clearance_is_drawn_and_collisions_are_marked() {
    let desk = desk();
    desk.write("hit.ngc", &NEAR.replace("G1 Y-26", "G1 Y-19"));
    let check = "check hit.ngc -m vice.toml --format json";
    let out = "--clearance a.svg --clearance b.SVG --clearance hit.csv";
    // The program is not fit; what is known of it is written all the same.
    desk.twin(&format!("{check} {out}")).ended(1, "");
    let picture = desk.text("a.svg");
    assert!(picture.starts_with("<svg ") && picture.trim_end().ends_with("</svg>"));
    for words in [
        "Clearance of hit.ngc on gantry3_vice",
        "the tool is 3.000 mm deep in fixed jaw",
        "; 1 collision",
        "line of the program",
        "what is nearest",
        "wanted: 2 mm",
    ] {
        assert!(picture.contains(words), "{words} is not in\n{picture}");
    }
    let again = desk.text("b.SVG");
    assert!(again == picture, "the second picture differs");
    let table = desk.text("hit.csv");
    let deepest = table.lines().find(|row| row.starts_with("5,")).expect("a row");
    assert!(deepest.contains(",-3,the tool,fixed jaw,"), "{deepest}");
}

#[test]
fn clearance_is_of_one_program_and_of_what_is_known() {
    let desk = desk();
    desk.write("near.ngc", NEAR);
    let check = |arguments: &str| desk.twin(&format!("check near.ngc {arguments}"));
    check("vice.ngc -m vice.toml --clearance a.csv")
        .ended(2, "--clearance is of one program, and 2 are given");
    check("-m machine.toml --clearance a.csv")
        .ended(2, "machine.toml has no obstacles: describe them in [[obstacles]]");
    check("-m vice.toml --clearance a.png").ended(2, ".csv or .svg");
    check("-m vice.toml --clearance nowhere/a.csv").ended(2, "no folder nowhere");
    check("-m vice.toml --clearance a.csv --clearance ./a.csv")
        .ended(2, "--clearance ./a.csv: something else is read from or written to it");
    let own = "check near.csv -m vice.toml --dialect rs274";
    desk.write("near.csv", NEAR);
    desk.twin(&format!("{own} --clearance near.csv")).ended(2, "the program itself");
    assert!(!desk.path("a.csv").exists());
    // What was there stays where nothing can be checked.
    desk.write("a.csv", "yesterday's");
    desk.twin("check none.ngc -m vice.toml --clearance a.csv").ended(2, "none.ngc");
    assert_eq!(desk.text("a.csv"), "yesterday's");
    let help = desk.twin("check --help");
    assert!(help.ended(0, "").stdout.contains("--clearance near.svg"), "{}", help.stdout);
}
