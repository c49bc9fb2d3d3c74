//! Tests of the clearance in a recording.

use super::*;
use crate::frame::ClearanceFrame;
use rerun::external::re_sdk_types::blueprint::archetypes as layout;
use rerun::external::re_sdk_types::blueprint::components::QueryExpression;

/// Frames a ms apart in which the tool comes down to a jaw and goes up again: `distance` mm of each.
fn record(limit: Option<f64>, milliseconds: u32, distance: impl Fn(u32) -> Option<f64>) -> Read {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("near.rrd");
    let options = SceneOptions { record: Some(path.clone()), ..SceneOptions::default() };
    let mut scene = open_measured(&options, &machine(), limit).unwrap();
    for ms in 0..milliseconds {
        let clearance = distance(ms).map(|mm| ClearanceFrame {
            distance: mm * 1e-3,
            parts: ["the tool", "fixed jaw"],
            points: [Point3::new(0.1, 0.2, mm * 1e-3), Point3::new(0.1, 0.2, 0.0)],
        });
        scene.frame(&Frame { clearance, ..still(ms, &[Isometry3::identity(); 2]) }).unwrap();
    }
    scene.finish().unwrap();
    Read::new(&path)
}

/// 50 mm at 0 ms, 0 mm at 50 ms, and as deep below that.
fn down(ms: u32) -> f64 {
    50.0 - f64::from(ms)
}

#[test]
fn clearance_comes_back_in_mm_at_its_time_and_line() {
    let read = record(Some(2e-3), 60, |ms| Some(down(ms)));
    let rows = read.scalars("clearance/twin");
    assert_eq!(rows.len(), 60);
    for (ms, (time_ns, line, value)) in (0_u32..).zip(rows) {
        assert_eq!((time_ns, line), (i64::from(ms) * 1_000_000, i64::from(1 + ms / 10)));
        assert_near(value, down(ms));
    }
    let wanted = read.scalars("clearance/wanted");
    assert_eq!(wanted.len(), 60);
    for row in wanted {
        assert_near(row.2, 2.0);
    }
    assert!(read.names_of_parts().iter().any(|name| name == "Clearance (mm)"));
    let queries = read.of_layout::<QueryExpression>(&layout::ViewContents::descriptor_query());
    assert!(queries.iter().any(|query| query.0.as_str() == "+ /nearest/**"), "{queries:?}");
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
    let ends = read
        .rows::<components::Position3D>("nearest/points", &rerun::Points3D::descriptor_positions());
    let counts: Vec<_> =
        ends.iter().map(|(time_ns, _, at)| (time_ns / 1_000_000, at.len())).collect();
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
        let of_it = read.chunks.iter().map(|chunk| chunk.entity_path().to_string());
        let of_it: Vec<_> =
            of_it.filter(|path| path.contains("clearance") || path.contains("nearest")).collect();
        assert!(of_it.is_empty(), "{of_it:?}");
    }
    let parts = record(None, 3, |ms| Some(down(ms))).names_of_parts();
    assert!(!parts.iter().any(|name| name.contains("Clearance")), "{parts:?}");
}
