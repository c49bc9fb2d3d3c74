//! Tests of the clearance in a recording.

use super::*;
use crate::frame::ClearanceFrame;

/// Frames a ms apart in which the tool comes down to a jaw and goes up again: `distance` mm of each.
fn record(limit: Option<f64>, milliseconds: u32, distance: impl Fn(u32) -> Option<f64>) -> Read {
    written_of(&machine(), limit, |scene| {
        for ms in 0..milliseconds {
            let clearance = distance(ms).map(|mm| ClearanceFrame {
                distance: mm * 1e-3,
                parts: ["the tool", "fixed jaw"],
                points: [mm * 1e-3, 0.0].map(|z| Point3::new(0.1, 0.2, z)),
            });
            scene.frame(&Frame { clearance, ..still(ms, &[Isometry3::identity(); 2]) }).unwrap();
        }
    })
}

/// 50 mm at 0 ms, 0 mm at 50 ms, and as deep below that.
fn down(ms: u32) -> f64 {
    50.0 - f64::from(ms)
}

#[test]
fn clearance_comes_back_in_mm_at_its_time_and_line() {
    let read = record(Some(2e-3), 60, |ms| Some(down(ms)));
    assert_plot(&read, "clearance/twin", 60, |ms| 50.0 - ms);
    assert_plot(&read, "clearance/wanted", 60, |_| 2.0);
    assert!(read.names_of_parts().iter().any(|name| name == "Clearance (mm)"));
    assert!(read.shows("nearest"));
    let about = read.statics::<components::Text>("about", &rerun::TextDocument::descriptor_text());
    assert!(about[0].0.contains("below 20 mm"), "{about:?}");
    // Only what touches is too near: there is no line for that.
    assert_eq!(record(Some(0.0), 3, |ms| Some(down(ms))).scalars("clearance/wanted"), []);
}

/// Joined as often as the machine moves, in mm, the nearer the redder, and no longer once it is far.
#[test]
fn what_is_near_is_joined() {
    let read = record(Some(0.0), 130, |ms| Some((f64::from(ms) - 60.0).abs() / 2.0));
    // 30 mm at 0 ms, 20 mm at 20 ms, which is far, 10 mm at 40 ms, ...
    let strips = read.strips("nearest/line");
    let near: Vec<_> = strips.iter().map(|(time_ns, _)| time_ns / 1_000_000).collect();
    assert_eq!(near, [40, 60, 80]);
    assert_eq!(strips[0].1, [[100.0, 200.0, 10.0], [100.0, 200.0, 0.0]]);
    let positions = rerun::Points3D::descriptor_positions();
    let ends = read.rows::<components::Position3D>("nearest/points", &positions);
    let counts: Vec<_> = ends.iter().map(|(ns, _, at)| (ns / 1_000_000, at.len())).collect();
    // Cleared when it gets far.
    assert_eq!(counts, [(40, 2), (60, 2), (80, 2), (100, 0)]);
    let labels =
        read.rows::<components::Text>("nearest/line", &rerun::LineStrips3D::descriptor_labels());
    assert_eq!(labels[0].2, ["10.00 mm, the tool to fixed jaw".into()]);
    let colors =
        read.rows::<components::Color>("nearest/line", &rerun::LineStrips3D::descriptor_colors());
    assert_eq!(colors[1].2, [palette::nearness(0.0)]);
    assert_eq!(colors[0].2, colors[2].2);
    assert_ne!(colors[0].2, colors[1].2);
}

#[test]
fn where_clearance_is_not_measured_nothing_is_shown_of_it() {
    for read in [record(None, 30, |ms| Some(down(ms))), record(Some(0.0), 30, |_| None)] {
        let of_it = |path: &str| path.contains("clearance") || path.contains("nearest");
        assert_eq!(read.entities(of_it), [""; 0]);
    }
    let parts = record(None, 3, |ms| Some(down(ms))).names_of_parts();
    assert!(!parts.iter().any(|name| name.contains("Clearance")), "{parts:?}");
}
