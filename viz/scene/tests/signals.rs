//! Signals that are switched, read back.

use super::*;
use rerun::external::re_sdk_types::blueprint::archetypes as layout;
use rerun::external::re_sdk_types::blueprint::components::QueryExpression;

fn frame(scene: &mut Scene, ms: u32) {
    scene
        .frame(&Frame {
            time_ns: i64::from(ms) * 1_000_000,
            line: 3,
            setpoint: Point3::origin(),
            path_speed: 0.0,
            programmed_speed: None,
            link_poses: &[Isometry3::identity(); 2],
            twin: Deviation { tool: Point3::origin(), tool_error: 0.0, axis_errors: &[0.0; 2] },
            motors: &[],
            clearance: None,
            drives: None,
        })
        .unwrap();
}

fn record(names: &[String]) -> Read {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("signals.rrd");
    let options = SceneOptions { record: Some(path.clone()), ..SceneOptions::default() };
    let mut scene = open_measured(&options, &machine(), None).unwrap();
    scene.signals(names);
    for ms in 0..30 {
        if ms == 10 || ms == 20 {
            let tool = Point3::new(0.1, f64::from(ms) * 1e-3, 0.0);
            scene.switched((i64::from(ms) * 1_000_000, 3), &tool, 1, ms == 10).unwrap();
        }
        frame(&mut scene, ms);
    }
    scene.finish().unwrap();
    Read::new(&path)
}

/// The second of two is on from 10 to 20 ms: a line that is high meanwhile, above that of the first, and marks in mm where it is
/// switched.
#[test]
fn what_is_switched_is_seen_when_and_where() {
    let read = record(&["tappet 1 of X".to_owned(), "tappet 2 of X".to_owned()]);
    let [first, second] = ["switched/0", "switched/1"].map(|entity| read.scalars(entity));
    assert_eq!((first.len(), second.len()), (30, 30));
    for (ms, ((_, _, first), (time_ns, line, second))) in (0_u32..).zip(first.iter().zip(&second)) {
        assert_eq!((*time_ns, *line), (i64::from(ms) * 1_000_000, 3));
        assert_near(*first, 0.0);
        assert_near(*second, if (10..20).contains(&ms) { 2.2 } else { 1.2 });
    }
    let marks = read
        .rows::<components::Position3D>("trail/switched", &rerun::Points3D::descriptor_positions());
    let marks: Vec<_> = marks.iter().map(|(time_ns, _, at)| (time_ns / 1_000_000, at[0])).collect();
    assert_eq!(marks, [(10, [100.0, 10.0, 0.0].into()), (20, [100.0, 20.0, 0.0].into())]);
    let labels =
        read.rows::<components::Text>("trail/switched", &rerun::Points3D::descriptor_labels());
    assert_eq!(labels[0].2, ["tappet 2 of X on".into()]);
    assert_eq!(labels[1].2, ["tappet 2 of X off".into()]);
    assert!(read.names_of_parts().iter().any(|name| name.starts_with("Switched")));
    let queries = read.of_layout::<QueryExpression>(&layout::ViewContents::descriptor_query());
    assert!(queries.iter().any(|query| query.0.as_str() == "+ /trail/**"), "{queries:?}");
}

#[test]
fn without_signals_nothing_is_shown_of_them() {
    let read = record(&[]);
    let paths = read.chunks.iter().map(|chunk| chunk.entity_path().to_string());
    assert_eq!(paths.filter(|path| path.contains("switched")).count(), 0);
    assert!(!read.names_of_parts().iter().any(|name| name.starts_with("Switched")));
}
