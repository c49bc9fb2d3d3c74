//! `[table]` of cams in TOML: numbers at equal distances of the master, or pairs.

use crate::cam_file::toml_form::ANY;
use crate::section::Section;
use std::ops::Range;
use twin_cam::{Equidistant, Interpolation, PairTable, Scale, Shape, TableScale, VariableType};

/// Reads a table of a cam with this scale of the master, if that is known, and reports all its errors either way.
pub(super) fn shape(
    section: &Section<'_>,
    master: Option<&Scale>,
    periodic: bool,
) -> Option<Shape> {
    let interpolations = [("linear", Interpolation::Linear), ("cubic", Interpolation::Cubic)];
    let interpolation = section.choice("interpolation", &interpolations).unwrap_or_default();
    let kinds = VariableType::ALL.map(|kind| (kind.name(), kind));
    let variable = section.choice("type", &kinds).unwrap_or(VariableType::Lreal);
    let slave = scale(section, "slave_scale");
    let periodic = section.flag("periodic").unwrap_or(periodic);
    match [section.has("values"), section.has("pairs")] {
        [true, false] => {
            let values = section.list("values", &ANY);
            let (slave, values) = (slave?, values?);
            let (start, end) = (master?.min, master?.max);
            let table =
                Equidistant { variable, start, end, periodic, slave, interpolation, values };
            Some(Shape::Equidistant(table))
        }
        [false, true] => {
            let master_scale = scale(section, "master_scale");
            let pairs = section.pairs("pairs", &ANY);
            let (scale, pairs) = (master_scale?, pairs?);
            let fits = ends_fit(section, &pairs, &scale, master?);
            let table = PairTable {
                variable,
                master: scale,
                slave: slave?,
                periodic,
                interpolation,
                pairs,
            };
            fits.then_some(Shape::Pairs(table))
        }
        _ => {
            section.complain("[table] needs `values` at equal distances of the master, or `pairs`");
            section.accept_all();
            None
        }
    }
}

/// Two positions and the numbers that represent them; the numbers are the positions if nothing is said.
fn scale(section: &Section<'_>, key: &str) -> Option<TableScale> {
    if !section.has(key) {
        section.accept(key);
        return Some(TableScale::IDENTITY);
    }
    let [min, max, table_min, table_max] = section.numbers::<4>(key, ANY)?;
    Some(TableScale { min, max, table_min, table_max })
}

/// True if the pairs begin and end with the scale of the master.
fn ends_fit(section: &Section<'_>, pairs: &[[f64; 2]], scale: &TableScale, master: &Scale) -> bool {
    let ends = [pairs.first(), pairs.last()].map(|pair| pair.map(|pair| scale.position(pair[0])));
    let size = (master.max - master.min).abs();
    for (what, found, expected) in [("begin", ends[0], master.min), ("end", ends[1], master.max)] {
        if let Some(found) = found.filter(|found| (found - expected).abs() > 1e-9 * size) {
            let message =
                format!("`pairs` {what} at master {found}; the scale of the master at {expected}");
            section.complain_at("pairs", message);
            return false;
        }
    }
    true
}

/// Place in the file of a number or pair, from 0.
pub(super) fn span_of_item(section: &Section<'_>, index: usize) -> Option<Range<usize>> {
    ["values", "pairs"].into_iter().find_map(|key| section.span_of_item(key, index))
}
