//! Fuzz target: any bytes as a DXF drawing, imported in every way, exported and imported again, planned and sampled.

#![no_main]

mod path;

use libfuzzer_sys::fuzz_target;
use twin_path::dxf::{import, DxfWriter, Heights, ImportOptions, Limits, Order, Program, Split};

/// What a small drawing may make.
const PIECES: usize = 2_000;
/// Largest coordinate, m.
const FARTHEST: f64 = 1e3;

fuzz_target!(|drawing: &[u8]| {
    let limits = Limits { bytes: 1 << 16, pieces: PIECES, farthest: FARTHEST, ..Limits::default() };
    let heights = Heights { safe: 0.01, cut: -0.001, plunge_feed: 0.01 };
    for (split, order, heights) in [
        (Split::Whole, Order::Drawing, None),
        (Split::Layers, Order::Nearest, Some(heights)),
        (Split::Sections, Order::Nearest, None),
    ] {
        let options = ImportOptions { split, order, heights, limits, ..ImportOptions::default() };
        let Ok(import) = import(drawing, &options) else { continue };
        for note in &import.notes {
            assert!(!note.to_string().is_empty());
        }
        for Program { elements, .. } in import.programs {
            path::connected(&elements, 0.0);
            // What cannot be kept becomes lines within a tolerance: of them there may be many.
            for element in &elements {
                let end = element.end();
                assert!(end.coords.amax() <= 2.0 * FARTHEST, "{element:?}");
            }
            if split == Split::Whole {
                let mut writer = DxfWriter::new(Vec::new()).expect("memory takes everything");
                for element in &elements {
                    writer.write(element).expect("memory takes everything");
                }
                let written = writer.finish().expect("memory takes everything");
                let limits = Limits::default();
                let again = self::import(&written[..], &ImportOptions { limits, ..options });
                assert!(again.is_ok(), "{again:?}");
                path::sampled(path::prepared(&elements, &path::by_marks(&elements)), false, |_| {
                    None
                });
            }
        }
    }
});
