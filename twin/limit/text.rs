//! Summary of a plan as text for people.

use super::{Binding, Change, LimitSummary, Limits};
use crate::peak::Peak;
use crate::program::ProgramFile;
use crate::table::table;
use comfy_table::{Cell, CellAlignment, Color, Table};
use std::io::{self, Write};
use twin_machine::{Axis, Machine};
use twin_number::significant;
use twin_path::Place;

/// Changes are named that gain at least this, s, and this part of the program's time; the largest number of them.
const WORTH_S: f64 = 1e-3;
const WORTH: f64 = 1e-3;
const NAMED_CHANGES: usize = 3;

/// The part of a limit from which on it is exceeded: a thousandth is what sampling may add.
const EXCEEDED: f64 = 1.001;

/// Writes the summary: durations, largest values, what holds the program back, and where.
///
/// # Errors
/// If `out` cannot be written.
pub fn write_summary(
    out: &mut impl Write,
    machine: &Machine,
    program: &ProgramFile,
    summary: &LimitSummary,
) -> io::Result<()> {
    let LimitSummary { duration_s, duration_by_feed_s: by_feed_s, .. } = *summary;
    write!(
        out,
        "{} ({}) on {}: {:.1} mm in {duration_s:.3} s; with ",
        program.path().display(),
        program.dialect().name(),
        machine.name,
        summary.length * 1e3,
    )?;
    let percent = 100.0 * summary.override_factor;
    if (percent - 100.0).abs() > 1e-9 {
        write!(out, "{} % of ", significant(percent, 4))?;
    }
    write!(out, "the programmed feed alone {by_feed_s:.3} s")?;
    if by_feed_s > 0.0 {
        write!(out, " ({:+.1} %)", (duration_s / by_feed_s - 1.0) * 100.0)?;
    }
    writeln!(out)?;
    if let Some(axes_s) = summary.duration_under_axes_s {
        write!(out, "planned by the controller alone; under the limits of the axes {axes_s:.3} s")?;
        if duration_s > 0.0 {
            write!(out, ", {:.3} times as long", axes_s / duration_s)?;
        }
        writeln!(out)?;
    }
    if summary.peaks.iter().any(|peak| peak.position.is_some()) {
        writeln!(out, "{}", peaks(machine, summary))?;
    }
    for beyond in beyond(machine, summary) {
        writeln!(out, "{beyond}")?;
    }
    if !summary.limited_by.is_empty() {
        writeln!(out, "{}", limited_by(machine, summary))?;
    }
    if !summary.lines.is_empty() {
        writeln!(out, "{}", lines(machine, summary))?;
    }
    let worth = |change: &&Change| change.gain_s >= WORTH_S.max(WORTH * duration_s);
    for change in summary.changes.iter().filter(worth).take(NAMED_CHANGES) {
        let Change { binding, gain_s } = change;
        let percent = Change::RAISED * 100.0;
        writeln!(
            out,
            "{} {percent:.0} % up: about {gain_s:.3} s less",
            binding.words(&machine.axes)
        )?;
    }
    let windows = summary.windows;
    if windows.exceeded > 0 {
        writeln!(
            out,
            "in {} of {} windows a limit is slightly exceeded between the checked points; the table of axes shows by how much",
            windows.exceeded, windows.count
        )?;
    }
    if windows.failed > 0 {
        writeln!(
            out,
            "in {} of {} windows the solver failed; a slower profile replaces its plan there, or the path brakes to \
             rest on the previous plan",
            windows.failed, windows.count
        )?;
    }
    Ok(())
}

/// Per axis the largest velocity, acceleration and jerk and, where it is known, the largest effort of its motor, each with
/// its share of the limit and its line.
fn peaks(machine: &Machine, summary: &LimitSummary) -> Table {
    let mut table = table();
    let efforts = summary.peaks.iter().any(|peak| peak.effort.is_some());
    let mut header = vec!["axis"];
    for quantity in ["velocity", "acceleration", "jerk"] {
        header.extend([quantity, "of limit", "line"]);
    }
    if efforts {
        header.extend(["motor", "of limit", "line"]);
    }
    table.set_header(header);
    for (axis, peak) in machine.axes.iter().zip(&summary.peaks) {
        let mut row = vec![Cell::new(&axis.name)];
        let (acceleration, limit) = peak.hardest(axis);
        for (peak, limit, per) in [
            (&peak.velocity, Some(axis.max_velocity), "s"),
            (&acceleration, Some(limit), "s²"),
            (&peak.jerk, axis.max_jerk, "s³"),
        ] {
            let value = format!("{} {}/{per}", digits(axis.from_si(peak.value)), axis.unit());
            row.extend(against(value, peak, limit));
        }
        if efforts {
            let effort = peak.effort.unwrap_or_default();
            let value = format!("{} {}", digits(effort.value), axis.kind.effort_unit());
            row.extend(against(value, &effort, axis.effort_limit()));
        }
        add(&mut table, 1, row);
    }
    table
}

fn against(value: String, peak: &Peak, limit: Option<f64>) -> [Cell; 3] {
    let share = limit.map(|limit| peak.value / limit);
    let cell = Cell::new(share.map_or("–".to_owned(), percent));
    let cell = match share {
        Some(share) if share > EXCEEDED => cell.fg(Color::Red),
        Some(share) if share > 0.9 => cell.fg(Color::Yellow),
        _ => cell,
    };
    let line = if peak.value > 0.0 { line(peak.place) } else { "–".to_owned() };
    [Cell::new(value), cell, Cell::new(line)]
}

/// By how much axes are beyond their limits, the worst first; only where nobody has kept them within.
fn beyond(machine: &Machine, summary: &LimitSummary) -> Vec<String> {
    if summary.limits == Limits::Axes {
        return Vec::new();
    }
    let mut found: Vec<(f64, String)> = Vec::new();
    for (axis, peak) in machine.axes.iter().zip(&summary.peaks) {
        let effort = peak.effort.unwrap_or_default();
        let (acceleration, limit) = peak.hardest(axis);
        for (name, peak, limit) in [
            ("velocity", &peak.velocity, Some(axis.max_velocity)),
            ("acceleration", &acceleration, Some(limit)),
            ("jerk", &peak.jerk, axis.max_jerk),
            (axis.kind.effort_name(), &effort, axis.effort_limit()),
        ] {
            let Some(part) = limit.map(|limit| peak.value / limit).filter(|part| *part > EXCEEDED)
            else {
                continue;
            };
            let Axis { name: of, .. } = axis;
            let (times, at) = (significant(part, 4), line(peak.place));
            found.push((part, format!("{name} of {of}: {times} times its limit in line {at}")));
        }
    }
    found.sort_by(|one, other| other.0.total_cmp(&one.0));
    found.into_iter().map(|(_, text)| text).collect()
}

/// What holds the program back.
fn limited_by(machine: &Machine, summary: &LimitSummary) -> Table {
    let mut table = table();
    table.set_header(["held back by", "time", "share", "lost"]);
    for share in &summary.limited_by {
        let part = if summary.duration_s > 0.0 { share.time_s / summary.duration_s } else { 0.0 };
        let row = [
            words(share.binding, machine),
            format!("{:.3} s", share.time_s),
            percent(part),
            format!("{:.3} s", share.lost_s),
        ];
        add(&mut table, 1, row.map(Cell::new).to_vec());
    }
    table
}

/// The lines that lose most time.
fn lines(machine: &Machine, summary: &LimitSummary) -> Table {
    let mut table = table();
    table.set_header(["line", "lost", "of", "programmed", "largest feed", "held back by"]);
    for loss in &summary.lines {
        let mut row = vec![
            Cell::new(line(loss.place)),
            Cell::new(format!("{:.3} s", loss.lost_s)),
            Cell::new(format!("{:.3} s", loss.time_s)),
            Cell::new(format!("{} mm/s", digits(loss.programmed * 1e3))),
            Cell::new(
                loss.allowed
                    .map_or("–".to_owned(), |feed| format!("{} mm/s", digits(feed * 1e3))),
            ),
        ];
        for cell in row.iter_mut().skip(1) {
            *cell = cell.clone().set_alignment(CellAlignment::Right);
        }
        row.push(Cell::new(words(loss.binding, machine)));
        table.add_row(row);
    }
    table
}

/// Adds a row of which the first `texts` cells are words and the others numbers.
fn add(table: &mut Table, texts: usize, row: Vec<Cell>) {
    table.add_row(row.into_iter().enumerate().map(|(column, cell)| {
        if column < texts { cell } else { cell.set_alignment(CellAlignment::Right) }
    }));
}

fn words(binding: Option<Binding>, machine: &Machine) -> String {
    binding.map_or("not known".to_owned(), |binding| binding.words(&machine.axes))
}

pub(super) fn line(place: Place) -> String {
    let block = place.block.map_or(String::new(), |block| format!(" (N{block})"));
    format!("{}{block}", place.line)
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}

/// Four digits, for people; more where they are before the point, none for rounding errors.
pub(super) fn digits(value: f64) -> String {
    if value.abs() < 1e-9 {
        "0".to_owned()
    } else if value.abs() >= 1e4 {
        format!("{value:.0}")
    } else {
        significant(value, 4)
    }
}
