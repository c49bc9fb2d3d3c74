//! What is around a machine, and how near it comes to that: in pictures, tables and recordings.

use crate::process::{Desk, number};
use crate::recording::{chunks, entities, rows, series};
use crate::root;
use rerun::components;

/// The portal with a vice, and a program in it.
fn desk() -> Desk {
    let desk = Desk::new();
    for (from, to) in
        [("machines/gantry3_vice.toml", "vice.toml"), ("examples/vice.ngc", "vice.ngc")]
    {
        let text = std::fs::read_to_string(root().join(from)).expect("it is shipped");
        desk.write(to, &text);
    }
    desk
}

/// Where they are in the machine frame: those in the work frame are shifted by (200, 100, 0) mm.
#[test]
fn obstacles_are_in_the_recording_of_a_run() {
    let desk = desk();
    let run = ["run", "vice.ngc", "-m", "vice.toml", "--drives", "none", "--record", "r.rrd"];
    desk.twin(&run).ended(0, "");
    check_obstacles(&desk);
}

#[test]
fn obstacles_are_in_recording_and_picture_of_a_machine() {
    let desk = desk();
    let out = ["--record", "r.rrd", "--svg", "space.svg"];
    desk.twin(&[&["machine", "vice.toml"][..], &out].concat()).ended(0, "");
    check_obstacles(&desk);
    let picture = std::fs::read_to_string(desk.path("space.svg")).expect("it was written");
    assert!(picture.contains("obstacles") && picture.contains("stock"), "{picture}");
    desk.twin(&["machine", "machine.toml", "--svg", "space.svg"]).ended(0, "");
    let without = std::fs::read_to_string(desk.path("space.svg")).expect("it was written");
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
G1 Y-40
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
    let run = ["run", "near.ngc", "-m", "vice.toml", "--drives", "none"];
    desk.twin(&[&run[..], &["--record", "r.rrd", "--report", "r.json"]].concat()).ended(0, "");
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
    let run = ["run", "near.ngc", "-m", "machine.toml", "--drives", "none", "--record", "r.rrd"];
    desk.twin(&run);
    let others = entities(&crate::recording::chunks(&desk));
    assert!(!others.iter().any(|one| one.contains("clearance") || one.contains("nearest")));
}
