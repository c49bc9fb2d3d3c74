//! Path switch points (H words) in the live view.

use crate::desk::Desk;
use crate::recording::{chunks, rows, series};
use rerun::components::Position3D;

/// H1 switches on half way along the second line (O: part of its length), at X15, and off 5 mm before the end of the third
/// (L below 0: from the end).
const PROGRAM: &str =
    "% switches\nN10 G1 X10 F10 E1000 E-1000\nN20 G1 X20 H1 O0.5\nN30 G1 X30 H-1 L-5\n";

#[test]
fn switch_points_have_marks_and_a_line() {
    let desk = Desk::new();
    desk.write("switches.cnc", PROGRAM);
    let run = "run switches.cnc -m machine.toml --drives none";
    desk.twin(&format!("{run} --limits programmed --record r.rrd")).ended(0, "");
    let chunks = chunks(&desk);
    let positions = rerun::Points3D::descriptor_positions();
    let marks: Vec<_> = rows::<Position3D>(&chunks, "trail/switched", &positions);
    let x: Vec<_> = marks.iter().map(|(_, points)| points[0].x()).collect();
    // A cycle at 10 mm/s is 0.01 mm.
    let near = |x: f32, wanted: f32| (x - wanted).abs() < 0.02;
    assert!(matches!(x[..], [on, off] if near(on, 15.0) && near(off, 25.0)), "{x:?}");
    let line = series(&chunks, "switched/0");
    let switched = line.windows(2).filter(|pair| (pair[0].1 > 0.5) != (pair[1].1 > 0.5)).count();
    assert_eq!(switched, 2);
}
