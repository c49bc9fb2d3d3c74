//! `twin path` and M functions as a process: what goes from file to file.

use crate::process::Desk;
use crate::root;
use serde_json::Value;

/// A program, the queue file made of it, and the program made of that have the same path.
#[test]
fn queues_and_programs_lead_the_same_way() {
    let desk = Desk::new();
    let program = root().join("examples/plate.cnc").display().to_string();
    let path = |arguments: &[&str]| {
        let done = desk.twin(&[&["path"], arguments].concat());
        done.ended(0, "");
        done.stdout
    };
    let direct = path(&[&program]);
    assert!(direct.lines().count() > 100);
    path(&[&program, "--output", "plate.queue"]);
    assert_eq!(path(&["plate.queue"]), direct);
    path(&["plate.queue", "--output", "again.cnc"]);
    let without_place = |text: &str| {
        let lines = text.lines().map(|line| {
            let mut row: Value = serde_json::from_str(line).expect("JSON");
            let row_map = row.as_object_mut().expect("an object");
            row_map.remove("line");
            row_map.remove("block");
            row.to_string()
        });
        lines.collect::<Vec<_>>()
    };
    assert_eq!(without_place(&path(&["again.cnc"])), without_place(&direct));
    // A queue that is damaged is no path at all.
    let mut bytes = std::fs::read(desk.path("plate.queue")).expect("it was written");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(desk.path("plate.queue"), bytes).expect("written");
    let done = desk.twin(&["path", "plate.queue", "--output", "none.cnc"]);
    done.ended(2, "checksum");
    assert!(!desk.path("none.cnc").exists());
}

/// Both pictures, and the overviews: what is in them is told by the program's text.
#[test]
fn a_program_is_seen_at_a_glance() {
    let desk = Desk::new();
    let program = root().join("examples/contour.cnc").display().to_string();
    let done = desk.twin(&["path", &program, "--prepare", "--output", "contour.svg"]);
    done.ended(0, "");
    let picture = std::fs::read_to_string(desk.path("contour.svg")).expect("it was written");
    assert!(picture.contains("before preparation") && picture.contains("every 100 ms"));
    let info = desk.twin(&["path", &program, "--format", "info"]).stdout;
    for line in ["name             CONTOUR", "angle tolerance  2.000 deg", "errors           none"]
    {
        assert!(info.contains(line), "{info}");
    }
    assert!(info.contains("2 arcs, 2 M functions"), "{info}");
    let viewer = desk.twin(&["path", &program, "--format", "viewer"]).stdout;
    assert!(viewer.contains("    16  N120 G3 X180 Y80 R15\n"), "{viewer}");
    assert!(!viewer.contains("(The contour"), "{viewer}");
    let listing = desk.twin(&["path", &program, "--format", "listing"]).stdout;
    assert!(listing.contains("LINPOS") && listing.contains("CCLW"), "{listing}");
}

/// Without an answer nothing goes on behind an M function that the user must acknowledge.
#[test]
fn a_user_who_is_not_there_acknowledges_nothing() {
    let desk = Desk::new();
    desk.write("m.cnc", "% m\nN10 G1 X10 F100 E500 E-500\nN20 M7\nN30 G1 X0\n");
    let run = ["run", "m.cnc", "--machine", "machine.toml", "--drives", "none"];
    let done = desk.twin(&[&run[..], &["--m-ack", "prompt"]].concat());
    done.ended(2, "M7 at line 3 (N20)").ended(2, "nobody acknowledges M7");
    desk.twin(&run).ended(0, "");
}

/// One file per layer of a drawing.
#[test]
fn layers_become_files() {
    let desk = Desk::new();
    let drawing = std::fs::read_to_string(root().join("tests/data/path_drawing/part.dxf"));
    let drawing = drawing.expect("readable");
    let (arc, line) = drawing.split_once("\n0\nLINE\n8\nCONTOUR").expect("as written");
    desk.write("part.dxf", &format!("{arc}\n0\nLINE\n8\nBORES{line}"));
    let divided = ["path", "part.dxf", "--one-per", "layer", "--format", "din66025"];
    let done = desk.twin(&divided);
    done.ended(2, "--output FOLDER");
    let done = desk.twin(&[&divided[..], &["--output", "programs"]].concat());
    done.ended(0, "");
    let mut names: Vec<_> = std::fs::read_dir(desk.path("programs"))
        .expect("a folder")
        .map(|entry| entry.expect("readable").file_name().into_string().expect("text"))
        .collect();
    names.sort();
    assert_eq!(names, ["001-CONTOUR.cnc", "002-BORES.cnc"]);
}
