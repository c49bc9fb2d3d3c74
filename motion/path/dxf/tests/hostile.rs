//! Tests of damaged and hostile files.

use super::*;
use proptest::prelude::*;

fn error(text: &str) -> DxfReadError {
    import(text.as_bytes(), &ImportOptions::default()).unwrap_err()
}

#[test]
fn what_is_no_drawing() {
    assert!(matches!(error(""), DxfReadError::Truncated(0)));
    assert!(matches!(error("% program\nN10 G0"), DxfReadError::GroupCode(1)));
    assert!(matches!(error("AutoCAD Binary DXF\r\n\u{1a}\0"), DxfReadError::Binary));
    let whole = drawing(&["LINE 10 0 20 0 11 1 21 0"]);
    let cut = whole.strip_suffix("0\nEOF\n").unwrap();
    assert!(matches!(error(cut), DxfReadError::Truncated(_)));
}

/// The crate stops silently at a number that it cannot read; the survey names its line.
#[test]
fn values_that_are_not_numbers() {
    let line = "LINE 10 0 20 0 11 1 21 0";
    for (entities, number, value) in [
        (["LINE 10 0,5 20 0 11 1 21 0", line, line], 40, "0,5"),
        ([line, "LINE 10 0 20 zero 11 1 21 0", line], 52, "zero"),
        ([line, line, "CIRCLE 62 red 10 0 20 0 40 1mm"], 66, "1mm"),
    ] {
        let text = drawing(&entities);
        assert_eq!(text.lines().nth(number - 1), Some(value));
        assert_eq!(
            error(&text).to_string(),
            format!(
                "line {number}: a number must be here, with a point before its decimals, not \"{value}\""
            )
        );
    }
}

#[test]
fn limits() {
    let with = |limits, text: &str| {
        import(text.as_bytes(), &ImportOptions { limits, ..ImportOptions::default() })
    };
    let line = "LINE 8 0 10 0 20 0 11 1 21 0";
    let text = drawing(&[line]);
    let exactly = Limits { bytes: text.len() as u64, ..Limits::default() };
    assert!(with(exactly, &text).is_ok());
    let less = Limits { bytes: text.len() as u64 - 1, ..exactly };
    assert!(matches!(with(less, &text), Err(DxfReadError::TooLarge(_))));

    // Ten blocks, each inserting the one before a thousand times.
    let more = (1..10).map(|n| (n, format!("INSERT 8 0 2 B{} 10 0 20 0 70 1000", n - 1)));
    let blocks = [(0, line.to_owned())].into_iter().chain(more);
    let block = |(n, entity)| format!("BLOCK 2 B{n} 70 0 10 0 20 0 0 {entity} 0 ENDBLK");
    let blocks = blocks.map(block).collect::<Vec<_>>().join(" 0 ");
    let bomb = full_drawing("", &[&blocks], &["INSERT 8 0 2 B9 10 0 20 0"]);
    let few = Limits { pieces: 10_000, ..Limits::default() };
    assert!(matches!(with(few, &bomb), Err(DxfReadError::TooMany(10_000))));

    let circle = ["BLOCK 2 A 70 0 10 0 20 0", "INSERT 8 0 2 A 10 0 20 0", "ENDBLK"];
    let endless = full_drawing("", &circle, &["INSERT 8 0 2 A 10 0 20 0"]);
    assert!(matches!(with(few, &endless), Err(DxfReadError::TooDeep { .. })));

    let far = with(few, &drawing(&["LINE 10 0 20 0 11 1e9 21 0", "LINE 10 nan 20 0 11 1 21 0"]));
    assert_eq!(notes(&far.unwrap()), [("LINE", Reason::Degenerate, 2)]);
}

proptest! {
    #[test]
    fn damaged_drawings_end(
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, "[0-9A-Z.-]{0,6}|-?[0-9]{1,3}|nan|1e308"), 1..6)
    ) {
        let text = full_drawing(
            "0\nLAYER\n2\nIce\n70\n1\n62\n7\n",
            &["BLOCK 2 A 70 0 10 5 20 0", "ARC 8 0 10 5 20 0 40 1 50 0 51 90", "ENDBLK"],
            &[
                "LINE 8 0 10 0 20 0 11 1 21 0",
                "LWPOLYLINE 90 3 70 1 10 0 20 0 10 10 20 0 42 0.5 10 10 20 10",
                "POLYLINE 8 0 66 1 10 0 20 0 30 2 70 1",
                "VERTEX 8 0 10 0 20 0 42 1",
                "VERTEX 8 0 10 10 20 0",
                "SEQEND",
                "ELLIPSE 10 0 20 0 11 0 21 20 40 0.5 41 0 42 1.5",
                "SPLINE 71 3 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 30 0 10 1 20 1 30 0 10 2 20 1 30 0 10 3 20 0 30 0",
                "INSERT 8 0 2 A 10 100 20 0 41 2 42 3 50 90 70 2 44 5",
                "TEXT 1 x",
            ],
        );
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (at, what, new) in changes {
            let at = at.index(lines.len());
            match what {
                0 => lines[at] = new,
                1 => lines.insert(at, new),
                2 => { lines.remove(at); }
                _ => { let other = lines[at / 2].clone(); lines[at] = other; }
            }
        }
        let limits = Limits { pieces: 10_000, ..Limits::default() };
        let options = ImportOptions { limits, order: Order::Nearest, ..ImportOptions::default() };
        if let Ok(import) = import(lines.join("\n").as_bytes(), &options) {
            for program in &import.programs {
                for pair in program.elements.windows(2) {
                    prop_assert!((pair[0].end() - pair[1].start()).norm() <= 1e-9);
                }
            }
        }
    }

    #[test]
    fn any_bytes_end(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(import(bytes.as_slice(), &ImportOptions::default()).is_err());
    }
}
