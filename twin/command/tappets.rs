//! Tappet switchings as a table.

use super::show::table;
use comfy_table::{Cell, CellAlignment};
use std::io::{self, Write};
use twin_machine::tappets::{MasterPlace, Switched, TappetSwitch};
use twin_number::fixed;
use twin_number::seconds;

/// Number of switchings that are shown whole; of more, the first and the last ones.
const SHOWN: usize = 20;

/// The table, and how many are left out; nothing if there are no tappets.
pub(super) fn write(out: &mut impl Write, switched: &Switched) -> io::Result<()> {
    let Switched { signals, switches, left_out, .. } = switched;
    if signals.is_empty() {
        return Ok(());
    }
    let names = |wanted: bool| {
        let counts = switched.counts.iter().copied().chain(std::iter::repeat(0));
        let of = signals.iter().zip(counts).filter(|(_, count)| (*count > 0) == wanted);
        of.map(|(signal, _)| signal.to_string()).collect::<Vec<_>>().join(", ")
    };
    let idle = names(false);
    if !idle.is_empty() {
        writeln!(out, "never switched: {idle}")?;
    }
    if switches.is_empty() {
        return Ok(());
    }
    let mut table = table();
    table.set_header(["tappets", "switched", "time", "line", "master"]);
    let (head, tail) = if switches.len() <= SHOWN {
        (switches.as_slice(), [].as_slice())
    } else {
        let half = SHOWN / 2;
        let head = switches.get(..half).unwrap_or_default();
        // What was not kept comes behind the last that was.
        let tail = if *left_out > 0 { 0 } else { half };
        (head, switches.get(switches.len() - tail..).unwrap_or_default())
    };
    let row = |one: &TappetSwitch| {
        let TappetSwitch { signal, on, time_ns, place, master } = one;
        let name = signals.get(*signal).map_or_else(String::new, ToString::to_string);
        let master = master.as_ref().map_or_else(String::new, |master| {
            let MasterPlace { axis, position, unit } = master;
            format!("{axis} at {} {unit}", fixed(*position, 3))
        });
        let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
        vec![
            Cell::new(name),
            Cell::new(if *on { "on" } else { "off" }),
            right(format!("{:.3} s", seconds(*time_ns))),
            right(place.line.to_string()),
            right(master),
        ]
    };
    for one in head {
        table.add_row(row(one));
    }
    let shown = head.len() + tail.len();
    let kept = u64::try_from(switches.len() - shown).unwrap_or(u64::MAX);
    let hidden = kept.saturating_add(*left_out);
    if hidden > 0 {
        table.add_row(vec![Cell::new(format!("… {hidden} more"))]);
    }
    for one in tail {
        table.add_row(row(one));
    }
    writeln!(out, "{table}")
}
