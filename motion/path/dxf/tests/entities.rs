//! Tests of every kind of entity. Expectations are closed forms and ezdxf's evaluation of splines.

use super::*;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn lines_arcs_and_circles() {
    let line = only("LINE 10 1 20 2 30 3 11 4 21 6 31 3");
    assert_eq!(line.start() * 1e3, Point3::new(1.0, 2.0, 3.0));
    assert_close(line.length() * 1e3, 5.0);
    // From 350° to 80°, over 0°.
    let arc = only("ARC 10 10 20 0 40 5 50 350 51 80");
    assert!(matches!(&arc, Shape::Arc(arc) if arc.sweep() > 0.0));
    assert_close(arc.length() * 1e3, 5.0 * FRAC_PI_2);
    assert_at(&arc, 10.0 / 90.0, [15.0, 0.0, 0.0]);
    let circle = only("CIRCLE 10 1 20 1 30 2 40 3");
    assert_close(circle.length() * 1e3, 6.0 * PI);
    assert_at(&circle, 0.0, [4.0, 1.0, 2.0]);
    assert_at(&circle, 0.25, [1.0, 4.0, 2.0]);
}

/// With the normal −Z the drawing is seen from behind: x and the sense of rotation are turned around.
#[test]
fn mirrored_entities() {
    let arc = only("ARC 10 10 20 0 30 1 40 5 50 0 51 90 210 0 220 0 230 -1");
    assert!(matches!(&arc, Shape::Arc(arc) if arc.sweep() < 0.0));
    assert_at(&arc, 0.0, [-15.0, 0.0, -1.0]);
    assert_at(&arc, 1.0, [-10.0, 5.0, -1.0]);
    let half = only("LWPOLYLINE 90 2 70 0 10 0 20 0 42 1 10 10 20 0 230 -1");
    assert_at(&half, 1.0, [-10.0, 0.0, 0.0]);
    assert_at(&half, 0.5, [-5.0, -5.0, 0.0]);
    // The end points of a line are what they are.
    assert_at(&only("LINE 10 1 20 0 11 2 21 0 230 -1"), 1.0, [2.0, 0.0, 0.0]);
}

/// A bulge of 1 is a half circle, of tan(22.5°) a quarter; positive on the right of the chord.
#[test]
fn bulges() {
    let half = only("LWPOLYLINE 90 2 70 0 38 7 10 0 20 0 42 1 10 10 20 0");
    assert_close(half.length() * 1e3, 5.0 * PI);
    assert_at(&half, 0.5, [5.0, -5.0, 7.0]);
    let quarter = only("LWPOLYLINE 90 2 70 0 10 10 20 0 42 -0.41421356237309503 10 0 20 10");
    let middle = 10.0 - 5.0 * 2_f64.sqrt();
    assert_at(&quarter, 0.5, [middle, middle, 0.0]);
    let text = drawing(&["LWPOLYLINE 90 3 70 1 10 0 20 0 10 10 20 0 42 0.5 10 10 20 10"]);
    let shapes = cuts(&imported(&text));
    assert_eq!(shapes.len(), 3);
    assert_eq!(shapes[2].end(), shapes[0].start());
}

#[test]
fn old_polylines() {
    let text = drawing(&[
        "POLYLINE 8 0 66 1 10 0 20 0 30 2 70 1",
        "VERTEX 8 0 10 0 20 0 42 1",
        "VERTEX 8 0 10 10 20 0",
        "SEQEND",
        "POLYLINE 66 1 70 8",
        "VERTEX 10 0 20 0 30 0 70 32",
        "VERTEX 10 0 20 0 30 5 70 32",
        "VERTEX 10 0 20 5 30 5 70 32",
        "SEQEND",
        // A mesh.
        "POLYLINE 66 1 70 16 71 2 72 2",
        "VERTEX 10 0 20 0 30 0 70 64",
        "SEQEND",
    ]);
    let import = imported(&text);
    assert_eq!(notes(&import), [("POLYLINE", Reason::NotUnderstood, 1)]);
    let shapes = cuts(&import);
    assert_eq!(shapes.len(), 4);
    assert_at(&shapes[0].shape, 0.5, [5.0, -5.0, 2.0]);
    assert_at(&shapes[1].shape, 1.0, [0.0, 0.0, 2.0]);
    assert_at(&shapes[3].shape, 1.0, [0.0, 5.0, 5.0]);
}

#[test]
fn ellipses() {
    // A quarter, from the end of the main axis (0, 20) to that of the other (−10, 0).
    let quarter = only("ELLIPSE 10 0 20 0 11 0 21 20 40 0.5 41 0 42 1.5707963267948966");
    // Vector `cnc-ellipse-G9`: a quarter of an ellipse with half axes 20 and 10.
    assert_close(quarter.length() * 1e3, 24.221_120_551);
    assert_at(&quarter, 0.0, [0.0, 20.0, 0.0]);
    assert_at(&quarter, 1.0, [-10.0, 0.0, 0.0]);
    let behind = only("ELLIPSE 10 0 20 0 11 0 21 20 40 0.5 41 0 42 1.5707963267948966 230 -1");
    assert_at(&behind, 1.0, [10.0, 0.0, 0.0]);
    let whole = only("ELLIPSE 10 5 20 0 11 20 21 0 40 0.5 41 0 42 6.283185307179586");
    assert_close(whole.length() * 1e3, 96.884_482_205);
    assert_eq!(whole.start(), whole.end());
    // A circle by another name.
    assert!(matches!(only("ELLIPSE 10 0 20 0 11 3 21 4 40 1 41 0 42 3"), Shape::Arc(_)));
}

const POINTS: &str = "10 0 20 0 30 0 10 10 20 20 30 0 10 30 20 25 30 0 10 40 20 0 30 0 10 60 20 -10 30 0 10 70 20 10 30 0";

/// Points and lengths by ezdxf 1.4.5 (`ezdxf.math.BSpline`, 200,000 chords).
#[test]
fn splines() {
    let spline = |head: &str, knots: &str| {
        let knots: Vec<_> = knots.split(' ').flat_map(|knot| ["40", knot]).collect();
        imported(&drawing(&[&format!("SPLINE {head} {} {POINTS}", knots.join(" "))]))
    };
    let length = |import: &Import| cuts(import).iter().map(PathElement::length).sum::<f64>() * 1e3;
    let near = |import: &Import, [x, y]: [f64; 2]| {
        let point = Point3::new(x, y, 0.0) / 1e3;
        let at = |e: &PathElement, i: i32| e.shape.at(e.length() * f64::from(i) / 2e4).position;
        let is_near = |e: &PathElement| (0..=20_000).any(|i| (at(e, i) - point).norm() < 2e-6);
        cuts(import).iter().any(is_near)
    };
    let cubic = spline("71 3", "0 0 0 0 1 2.5 4 4 4 4");
    assert_eq!(cubic.notes, []);
    assert_eq!(cuts(&cubic).len(), 3);
    assert!(cuts(&cubic).iter().all(|element| matches!(element.shape, Shape::Cubic(_))));
    assert_close(length(&cubic), 96.600_63);
    assert_at(&cuts(&cubic)[0].shape, 1.0, [23.8, 20.7, 0.0]);
    for point in
        [[13.475, 18.3375], [33.566_659_259, 14.095_914_815], [56.317_592_593, -3.985_092_593]]
    {
        assert!(near(&cubic, point), "{point:?}");
    }
    let quartic = spline("71 4", "0 0 0 0 0 1 2 2 2 2 2");
    assert_eq!(notes(&quartic), [("SPLINE", Reason::Approximated, 1)]);
    // Chords within 10 µm are shorter by a little: by 8/3 of the square of the sagitta over the chord, each.
    let short = 91.693_237 - length(&quartic);
    let chords: f64 = cuts(&quartic).iter().map(|chord| 8e-4 / (3.0 * chord.length() * 1e3)).sum();
    assert!(short > 0.0 && short < chords + 1e-6, "{short} {chords}");
    let straight = spline("71 1", "0 0 1 2 3 4 5 5");
    assert_eq!((cuts(&straight).len(), notes(&straight)), (5, vec![]));
    assert!(matches!(cuts(&straight)[4].shape, Shape::Line { .. }));
    let quadratic = "SPLINE 71 2 40 0 40 0 40 0 40 1 40 2 40 3 40 3 40 3 \
        10 0 20 0 30 0 10 10 20 20 30 0 10 30 20 25 30 0 10 40 20 0 30 0 10 60 20 -10 30 0";
    let quadratic = imported(&drawing(&[quadratic]));
    assert_eq!((cuts(&quadratic).len(), notes(&quadratic)), (3, vec![]));
    assert_close(length(&quadratic), 85.301_535);
}

/// A quarter of a circle as a rational spline: approximated, with a note. The sign of all weights does not matter.
#[test]
fn rational_splines() {
    let weight = 0.5_f64.sqrt();
    let spline = format!(
        "SPLINE 71 2 40 0 40 0 40 0 40 1 40 1 40 1 41 1 41 {weight} 41 1 10 100 20 0 30 0 10 100 20 100 30 0 10 0 20 100 30 0"
    );
    let import = imported(&drawing(&[&spline]));
    assert_eq!(notes(&import), [("SPLINE", Reason::Approximated, 1)]);
    let negative = spline.replace(" 41 ", " 41 -");
    assert_eq!(imported(&drawing(&[&negative])), import);
    for element in cuts(&import) {
        for part in [0.0, 0.5, 1.0] {
            let off = element.shape.at(part * element.length()).position.coords.norm() - 0.1;
            assert!(off.abs() < 1e-5, "{off}");
        }
    }
}

#[test]
fn splines_that_make_no_sense() {
    let import = imported(&drawing(&[
        "SPLINE 71 3 40 0 40 1 10 0 20 0 30 0 10 1 20 1 30 0",
        "SPLINE 71 3 11 0 21 0 31 0 11 1 21 1 31 0",
        "SPLINE 71 1 40 0 40 0 40 1 40 1 41 1 41 -1 10 0 20 0 30 0 10 1 20 1 30 0",
    ]));
    let expected = [("SPLINE", Reason::NotUnderstood, 1), ("SPLINE", Reason::Degenerate, 2)];
    assert_eq!(notes(&import), expected);
}

/// A block with an arc around its base point (5, 0); and one that inserts it flattened, in a row of three.
#[test]
fn inserted_blocks() {
    let blocks = [
        "BLOCK 2 A 70 0 10 5 20 0",
        "ARC 8 0 10 5 20 0 40 1 50 0 51 90",
        "TEXT 1 x",
        "ENDBLK",
        "BLOCK 2 B 70 0 10 0 20 0",
        "INSERT 8 0 2 a 10 0 20 0 42 0.5 70 3 44 10",
        "ENDBLK",
    ];
    let inserted = |entity| imported(&full_drawing("", &blocks, &[entity]));
    let once = inserted("INSERT 8 0 2 A 10 100 20 0 41 2 42 2 43 2 50 90");
    let shapes = cuts(&once);
    assert!(matches!(&shapes[0].shape, Shape::Arc(arc) if (arc.radius() - 2e-3).abs() < 1e-15));
    assert_at(&shapes[0].shape, 0.0, [100.0, 2.0, 0.0]);
    assert_at(&shapes[0].shape, 1.0, [98.0, 0.0, 0.0]);
    assert_eq!(notes(&once), [("TEXT", Reason::NotUnderstood, 1)]);

    let nested = inserted("INSERT 8 0 2 B 10 0 20 50");
    let shapes = cuts(&nested);
    assert_eq!(shapes.len(), 3);
    for (index, element) in (0..3).zip(&shapes) {
        assert!(matches!(element.shape, Shape::Ellipse(_)));
        assert_at(&element.shape, 0.0, [f64::from(index) * 10.0 + 1.0, 50.0, 0.0]);
        assert_at(&element.shape, 1.0, [f64::from(index) * 10.0, 50.5, 0.0]);
    }
    assert_eq!(notes(&nested), [("TEXT", Reason::NotUnderstood, 3)]);
    // Mirrored by a negative scale: the arc turns the other way.
    let mirrored = inserted("INSERT 8 0 2 A 10 0 20 0 41 -1");
    assert!(matches!(&cuts(&mirrored)[0].shape, Shape::Arc(arc) if arc.sweep() < 0.0));
    assert_at(&cuts(&mirrored)[0].shape, 0.0, [-1.0, 0.0, 0.0]);
}

#[test]
fn what_is_hidden_is_left_out() {
    let tables = "0\nLAYER\n2\nIce\n70\n1\n62\n7\n0\nLAYER\n2\nDark\n70\n0\n62\n-7\n\
        0\nLAYER\n2\nSeen\n70\n0\n62\n7\n";
    let blocks = ["BLOCK 2 A 70 0 10 0 20 0", "LINE 8 0 10 0 20 0 11 1 21 0", "ENDBLK"];
    let import = imported(&full_drawing(
        tables,
        &blocks,
        &[
            "LINE 8 ICE 10 0 20 0 11 1 21 0",
            "LINE 8 Dark 10 0 20 0 11 1 21 0",
            "LINE 8 Seen 10 0 20 0 11 1 21 0",
            "LINE 8 Seen 60 1 10 0 20 0 11 1 21 0",
            "LINE 8 Seen 67 1 10 0 20 0 11 1 21 0",
            "ARC 8 Seen 10 0 20 0 40 1 50 0 51 9 210 1 220 0 230 1",
            // On layer 0 in its block: it is on the INSERT's layer.
            "INSERT 8 Ice 2 A 10 0 20 0",
            "INSERT 8 Seen 2 Missing 10 0 20 0",
            "3DFACE 8 Seen 10 0 20 0 30 0",
        ],
    ));
    assert_eq!(cuts(&import).len(), 1);
    let expected = [
        ("3DFACE", Reason::NotUnderstood, 1),
        ("ARC", Reason::Tilted, 1),
        ("INSERT", Reason::FrozenLayer, 1),
        ("INSERT", Reason::UnknownBlock, 1),
        ("LINE", Reason::FrozenLayer, 1),
        ("LINE", Reason::LayerOff, 1),
        ("LINE", Reason::Invisible, 1),
        ("LINE", Reason::PaperSpace, 1),
    ];
    assert_eq!(notes(&import), expected);
    assert!(import.notes.iter().all(|note| note.to_string().starts_with("1 ")));
}

#[test]
fn units() {
    let options = ImportOptions { default_unit: 0.0254, ..ImportOptions::default() };
    for (number, metres) in [(0, 0.0254), (1, 0.0254), (4, 0.001), (5, 0.01), (6, 1.0), (13, 1e-6)]
    {
        let text = drawing(&["LINE 10 0 20 0 11 2 21 0"]);
        let text = text.replace("70\n4\n", &format!("70\n{number}\n"));
        let import = import(text.as_bytes(), &options).unwrap();
        assert_eq!(import.unit_known, number != 0, "{number}");
        assert!((cuts(&import)[0].length() - 2.0 * metres).abs() < 1e-15, "{number}");
    }
}
