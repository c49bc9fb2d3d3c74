//! What is around a machine, and how near it comes to that: in pictures, tables and recordings.

use crate::process::Desk;
use crate::recording::{chunks, entities, rows};
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
