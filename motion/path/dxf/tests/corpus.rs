//! Tests of other people's drawings, with numbers from ezdxf 1.4.5. The numbers are counts, and lengths from ezdxf's
//! attributes by closed forms (ellipses by Simpson's rule with two million points, AC1003 by a script that sums up its
//! pairs).

use super::*;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Lines, arcs, ellipses: how many, and how long in units of the drawing.
type Expected = [(usize, f64); 3];

type LeftOut = (&'static str, Reason, u64);

const NONE: (usize, f64) = (0, 0.0);

const fn texts(count: u64) -> LeftOut {
    ("TEXT", Reason::NotUnderstood, count)
}

const fn degenerate(kind: &'static str, count: u64) -> LeftOut {
    (kind, Reason::Degenerate, count)
}

/// `AC1003` has lines without a Y coordinate (ezdxf refuses those), the circles of `circle_radius_le_0` radii of 0 and
/// −1, and one line of `pycam-text` is a point.
const FILES: [(&str, f64, Expected, Option<LeftOut>); 12] = [
    ("ezdxf/1_polylines", 1.0, [(52, 1_493.262_093), (22, 467.909_039), NONE], Some(texts(9))),
    ("ezdxf/2_polylines", 1.0, [(57, 1_708.554_327), (22, 467.909_039), NONE], Some(texts(7))),
    ("ezdxf/6_closed_loop_with_arcs", 1.0, [(9, 526.965_497), (2, 126.092_982), NONE], None),
    ("ezdxf/AC1003_LINE_Example", 1e-3, [(13, 9.186_250), (9, 4.319_690), NONE], None),
    ("ezdxf/ASCII_R12", 1e-3, [(2, 14.926_864), NONE, NONE], Some(texts(1))),
    ("ezdxf/Minimal_DXF_AC1009", 1e-3, [NONE; 3], None),
    ("ezdxf/circle_radius_le_0", 1.0, [NONE; 3], Some(degenerate("CIRCLE", 2))),
    ("ezdxf/clockwise_arcs_hatch", 1.0, [NONE; 3], Some(("HATCH", Reason::NotUnderstood, 1))),
    ("ezdxf/forms", 1e-3, [(184, 13_657.538_078), (5, 797.964_534), (2, 1_125.752_841)], None),
    ("pycam/bezier_lines", 1e-3, [(36, 1_641.216_185), (44, 629.211_630), NONE], None),
    ("pycam/pycam-text", 1e-3, [(282, 480.684_199), NONE, NONE], Some(degenerate("LINE", 1))),
    ("pycam/simple-shapes", 1e-3, [(11, 722.197_243), NONE, (1, 274.021_964)], None),
];

#[test]
fn drawings_of_others() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus/dxf");
    let mut seen = 0;
    for (name, unit, expected, left_out) in FILES {
        let Ok(file) = File::open(folder.join(name).with_extension("dxf")) else { continue };
        seen += 1;
        let import = import(BufReader::new(file), &ImportOptions::default()).unwrap();
        assert_close(import.unit, unit);
        assert_eq!(notes(&import), left_out.as_slice(), "{name}");
        let mut found = [NONE; 3];
        for element in cuts(&import) {
            let kind = match element.shape {
                Shape::Line { .. } => 0,
                Shape::Arc(_) => 1,
                Shape::Ellipse(_) => 2,
                Shape::Cubic(_) => panic!("{name} has no splines"),
            };
            found[kind].0 += 1;
            found[kind].1 += element.length() / unit;
        }
        for (found, expected) in found.into_iter().zip(expected) {
            assert_eq!(found.0, expected.0, "{name}");
            assert!((found.1 - expected.1).abs() < 2e-6, "{name}: {}", found.1);
        }
    }
    if seen == 0 {
        println!("skipped: no drawings in {}", folder.display());
    }
}
