//! Switchings of the path's switches as a table.

use super::show::table;
use comfy_table::{Cell, CellAlignment};
use std::io::{self, Write};
use twin_machine::switch_points::{SwitchPoint, SwitchPoints};
use twin_number::seconds;

/// Number of switchings that are shown; of more the first ones.
const SHOWN: usize = 20;

/// The table, and how many are left out; nothing if the path switches nothing.
pub(super) fn write(out: &mut impl Write, points: &SwitchPoints) -> io::Result<()> {
    let first = points.first();
    if first.is_empty() {
        return Ok(());
    }
    let mut table = table();
    table.set_header(["switch points", "switched", "time", "line"]);
    let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
    for SwitchPoint { number, on, time_ns, place } in first.iter().take(SHOWN) {
        table.add_row(vec![
            Cell::new(format!("H{number}")),
            Cell::new(if *on { "on" } else { "off" }),
            right(format!("{:.3} s", seconds(*time_ns))),
            right(place.line.to_string()),
        ]);
    }
    let kept = u64::try_from(first.len().saturating_sub(SHOWN)).unwrap_or(u64::MAX);
    let hidden = kept.saturating_add(points.left_out());
    if hidden > 0 {
        table.add_row(vec![Cell::new(format!("… {hidden} more"))]);
    }
    writeln!(out, "{table}")
}
