//! Tests of tables and pictures of clearances.

use super::{ClearanceCsv, ClearancePicture};
use crate::check::BlockClearance;
use nalgebra::Point3;
use std::path::Path;
use twin_machine::Machine;
use twin_path::Place;
use twin_physics::{Clearance, Part};

/// Nearer than 2 mm is reported; its obstacles are table, fixed jaw, moving jaw, screw and stock.
fn machine() -> Machine {
    let text = include_str!("../../../machines/gantry3_vice.toml");
    Machine::parse(Path::new("vice.toml"), text).unwrap_or_else(|error| panic!("{error:#?}"))
}

/// In `line` at `ms` the tool is so near to an obstacle, mm.
fn at(line: u32, ms: i64, mm: f64, obstacle: usize) -> BlockClearance {
    BlockClearance {
        place: Place { block: (line == 2).then_some(20), ..Place::at(line) },
        time_ns: ms * 1_000_000,
        nearest: Clearance {
            distance: mm * 1e-3,
            parts: [Part::Tool, Part::Obstacle(obstacle)],
            points: [Point3::new(0.1, -0.2, mm * 1e-3), Point3::new(0.1, -0.2, 0.0)],
        },
        tool: None,
        may_touch: false,
    }
}

fn table(samples: &[BlockClearance]) -> String {
    let machine = machine();
    let mut table = ClearanceCsv::new(Vec::new(), &machine).unwrap();
    for sample in samples {
        table.include(sample).unwrap();
    }
    String::from_utf8(table.finish().unwrap()).unwrap()
}

fn picture(samples: &[BlockClearance]) -> String {
    let machine = machine();
    let mut picture = ClearancePicture::new(&machine);
    for sample in samples {
        picture.include(sample);
    }
    picture.draw("part.ngc")
}

/// Whether these words, and no others next to them, are somewhere in a picture.
fn says(picture: &str, words: &str) -> bool {
    picture.contains(&format!(">{words}</text>"))
}

/// Each time a block is run through has a row, with where it was nearest.
#[test]
fn every_block_has_its_nearest() {
    let samples = [
        at(1, 0, 5.0, 1),
        at(1, 1, 3.0, 2),
        at(1, 2, 4.0, 1),
        at(2, 3, 1.25, 1),
        at(1, 4, -0.5, 3),
        at(1, 5, 0.5, 3),
        // A jump of rounding is none of the machine.
        at(3, 6, -1e-14, 1),
    ];
    let header = "line,block,time_s,clearance_mm,part,other,x_mm,y_mm,z_mm\n";
    let rows = "\
1,,0.001,3,the tool,moving jaw,100,-200,3
2,20,0.003,1.25,the tool,fixed jaw,100,-200,1.25
1,,0.004,-0.5,the tool,screw,100,-200,-0.5
3,,0.006,0,the tool,fixed jaw,100,-200,0
";
    assert_eq!(table(&samples), [header, rows].concat());
    assert_eq!(table(&[]), header);
}

#[test]
fn a_picture_names_what_is_nearest_and_what_is_hit() {
    let far = picture(&[at(1, 0, 5.0, 1), at(2, 1000, 3.0, 2)]);
    for words in [
        "Clearance of part.ngc on gantry3_vice",
        "3.000 mm between the tool and moving jaw, line 2 (N20)",
        "wanted: 2 mm",
    ] {
        assert!(far.contains(words), "{words} is not in\n{far}");
    }
    // What has been nearest since the set-point before.
    assert!(says(&far, "fixed jaw") && !far.contains("collision"), "{far}");
    assert!(!says(&far, "what is near"), "{far}");

    let hits = [
        at(1, 0, 5.0, 1),
        at(3, 500, -2.0, 1),
        at(4, 600, -3.0, 1),
        at(4, 700, 1.0, 1),
        at(6, 800, -1.0, 1),
        at(7, 1000, 1.0, 1),
    ];
    let hit = picture(&hits);
    for words in ["the tool is 3.000 mm deep in fixed jaw, line 4; 2 collisions", "in each other"] {
        assert!(hit.contains(words), "{words} is not in\n{hit}");
    }
    assert!(says(&hit, "line 3") && says(&hit, "line 6"), "{hit}");
    // Probes may touch, and no more.
    let probe = hits.map(|hit| BlockClearance { may_touch: true, ..hit });
    let touch = picture(&probe);
    assert!(touch.contains("3.000 mm deep") && touch.contains("2 collisions"), "{touch}");
    // What touches does not collide.
    assert!(picture(&[at(1, 0, 5.0, 1), at(2, 9, -1e-4, 1)]).contains("0.000 mm between the tool"));
}

/// What is near gets a row of its own where little is seen of it next to what is far.
#[test]
fn what_is_near_is_seen_beside_what_is_far() {
    let samples = [at(1, 0, 300.0, 0), at(2, 1000, 2.5, 1), at(3, 2000, 300.0, 0)];
    let near = picture(&samples);
    assert!(says(&near, "what is near") && says(&near, "line 2 (N20)"), "{near}");
    assert!(!says(&picture(&samples[1..2]), "what is near"));
}

#[test]
fn nothing_and_very_much_can_be_drawn() {
    assert!(picture(&[]).contains("nothing moves"));
    let hits: Vec<_> =
        (0..5000_i64).map(|ms| at(1, ms, if ms % 2 == 0 { -1.0 } else { 1.0 }, 1)).collect();
    let text = picture(&hits);
    assert!(text.contains("2500 collisions"), "{text}");
    assert!(text.len() < 300_000, "{} bytes", text.len());
}
