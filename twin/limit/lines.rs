//! Lost time per line of a program and per binding limit.

use super::Binding;
use csv::Writer;
use std::collections::BTreeMap;
use std::io::Write;
use twin_machine::Axis;
use twin_number::significant;
use twin_path::Place;

/// Significant digits of feeds and times.
const DIGITS: usize = 9;

/// Effect of a limit on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineShare {
    /// The block.
    pub place: Place,
    /// The largest feed that is programmed on the line, m/s.
    pub programmed: f64,
    /// The largest feed that the machine allows on all of the line, m/s; `None` if that is not known.
    pub allowed: Option<f64>,
    /// The limit; none where it is not known.
    pub binding: Option<Binding>,
    /// Time on the line during which it holds back the path, s.
    pub time_s: f64,
    /// Time lost against the programmed feed, s.
    pub lost_s: f64,
}

/// Adds up what limits do to lines. Needs memory for every line.
#[derive(Clone, Debug, Default)]
pub(super) struct LineShares {
    shares: BTreeMap<(u32, Option<Binding>), LineShare>,
}

impl LineShares {
    pub(super) fn include(&mut self, piece: LineShare) {
        let key = (piece.place.line, piece.binding);
        let add = |share: &mut LineShare| {
            share.programmed = share.programmed.max(piece.programmed);
            share.time_s += piece.time_s;
            share.lost_s += piece.lost_s;
        };
        self.shares.entry(key).and_modify(add).or_insert(piece);
    }

    /// By lines, the limit that costs a line most first. `allowed` knows the largest feed that the machine allows on a line, m/s.
    pub(super) fn finish(self, allowed: impl Fn(u32) -> Option<f64>) -> Vec<LineShare> {
        let shares = self.shares.into_values();
        let mut shares: Vec<_> =
            shares.map(|share| LineShare { allowed: allowed(share.place.line), ..share }).collect();
        shares.sort_by(|one, other| {
            let line = one.place.line.cmp(&other.place.line);
            line.then(other.lost_s.total_cmp(&one.lost_s))
        });
        shares
    }
}

/// Writes a table with the columns `line`, `block`, `programmed_feed_mm_per_s`, `largest_feed_mm_per_s` (empty if not known),
/// `limit` ([`Binding::name`], empty if not known), `axis`, `time_s`, `lost_s`.
///
/// # Errors
/// If `out` cannot be written.
pub fn write_lines<W: Write>(out: W, axes: &[Axis], shares: &[LineShare]) -> csv::Result<()> {
    let mut writer = Writer::from_writer(out);
    writer.write_record([
        "line",
        "block",
        "programmed_feed_mm_per_s",
        "largest_feed_mm_per_s",
        "limit",
        "axis",
        "time_s",
        "lost_s",
    ])?;
    let number = |value: f64| significant(value, DIGITS);
    for share in shares {
        let axis = share.binding.and_then(|binding| binding.axis(axes));
        writer.write_record([
            share.place.line.to_string(),
            share.place.block.map_or_else(String::new, |block| block.to_string()),
            number(share.programmed * 1e3),
            share.allowed.map_or_else(String::new, |allowed| number(allowed * 1e3)),
            share.binding.map_or("", Binding::name).to_owned(),
            axis.map_or_else(String::new, |axis| axis.name.clone()),
            number(share.time_s),
            number(share.lost_s),
        ])?;
    }
    writer.flush()?;
    Ok(())
}
