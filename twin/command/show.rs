//! Terminal output shared by commands: tables of peaks and loads, coloured cells, progress bars.

pub(super) use super::findings::{Shown, findings, verdict};
use crate::check::Progress;
use crate::peak::{AxisPeak, Peak};
pub(super) use crate::table::table;
use comfy_table::{Cell, CellAlignment, Color, Table};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use twin_machine::{Axis, Machine};
use twin_number::fixed;
use twin_number::seconds;
use twin_physics::MotorLoad;

/// The table of largest values per axis, each against its limit.
pub(super) fn peaks(machine: &Machine, peaks: &[AxisPeak]) -> Table {
    let mut table = table();
    let physics = peaks.iter().any(|peak| peak.following_error.is_some());
    let mut header = vec![
        "axis",
        "position",
        "limits",
        "velocity",
        "limit",
        "line",
        "acceleration",
        "limit",
        "line",
    ];
    let decelerations = peaks.iter().any(|peak| peak.deceleration.is_some());
    if decelerations {
        header.extend(["deceleration", "limit", "line"]);
    }
    if physics {
        header.extend(["following error", "line"]);
    }
    table.set_header(header);
    for (axis, peak) in machine.axes.iter().zip(peaks) {
        let show = |value: f64| amount(axis.from_si(value), 1, "");
        let unit = axis.unit();
        let position = peak
            .position
            .map_or("–".to_owned(), |[min, max]| format!("{} … {} {unit}", show(min), show(max)));
        let mut row = vec![
            Cell::new(&axis.name),
            Cell::new(position),
            Cell::new(limits(axis)),
            against(
                format!("{} {unit}/s", show(peak.velocity.value)),
                peak.velocity.value,
                axis.max_velocity,
            ),
            Cell::new(show(axis.max_velocity)),
            line(&peak.velocity),
            against(
                format!("{} {unit}/s²", show(peak.acceleration.value)),
                peak.acceleration.value,
                peak.acceleration_limit(axis),
            ),
            Cell::new(show(peak.acceleration_limit(axis))),
            line(&peak.acceleration),
        ];
        if decelerations {
            row.extend(peak.deceleration.as_ref().map_or_else(
                || ["–", "–", "–"].map(Cell::new),
                |deceleration| {
                    let (value, limit) = (deceleration.value, axis.max_deceleration);
                    let shown = format!("{} {unit}/s²", show(value));
                    [against(shown, value, limit), Cell::new(show(limit)), line(deceleration)]
                },
            ));
        }
        if physics {
            let error = peak.following_error.unwrap_or_default();
            row.push(Cell::new(amount(axis.from_si(error.value), 4, unit)));
            row.push(line(&error));
        }
        table.add_row(row.into_iter().enumerate().map(|(column, cell)| {
            if column == 0 { cell } else { cell.set_alignment(CellAlignment::Right) }
        }));
    }
    table
}

/// The table of what motors gave in the simulated machine.
pub(super) fn loads(machine: &Machine, loads: &[MotorLoad]) -> Table {
    let mut table = table();
    let knows_warmth = loads.iter().any(|load| load.peak_warmth.is_some());
    let mut header = vec!["motor", "peak", "limit", "rms", "peak power", "rms power", "energy"];
    if knows_warmth {
        header.push("I²t");
    }
    table.set_header(header);
    for (axis, load) in machine.axes.iter().zip(loads) {
        let unit = axis.kind.effort_unit();
        let limit = axis.effort_limit();
        let peak = amount(load.peak_effort, 1, unit);
        let mut row = vec![
            Cell::new(&axis.name),
            against(peak, load.peak_effort, limit.unwrap_or(f64::INFINITY)),
            Cell::new(limit.map_or("–".to_owned(), |limit| format!("{limit:.1}"))),
            Cell::new(amount(load.rms_effort, 1, unit)),
            Cell::new(amount(load.peak_power, 1, "W")),
            Cell::new(amount(load.rms_power, 1, "W")),
            Cell::new(amount(load.driving_energy, 1, "J")),
        ];
        if knows_warmth {
            row.push(load.peak_warmth.map_or(Cell::new("–"), |warmth| {
                against(format!("{:.0} %", warmth * 100.0), warmth, 1.0)
            }));
        }
        table.add_row(row.into_iter().enumerate().map(|(column, cell)| {
            if column == 0 { cell } else { cell.set_alignment(CellAlignment::Right) }
        }));
    }
    table
}

/// Numbers beyond this say no more than that something has run away.
const HUGE: f64 = 1e5;

/// A number with `decimals` decimals and its unit, for a table.
pub(super) fn amount(value: f64, decimals: usize, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    if value.abs() < HUGE {
        format!("{}{space}{unit}", fixed(value, decimals))
    } else if value < 0.0 {
        format!("< -{HUGE:.0}{space}{unit}")
    } else {
        // What is not a number has run away, too.
        format!("> {HUGE:.0}{space}{unit}")
    }
}

/// The line of a peak; an axis that does not move has none.
fn line(peak: &Peak) -> Cell {
    if peak.value > 0.0 { Cell::new(peak.place.line) } else { Cell::new("–") }
}

/// A cell that turns red beyond its limit and yellow close to it.
pub(super) fn against(text: String, value: f64, limit: f64) -> Cell {
    let cell = Cell::new(text);
    if value > limit * (1.0 + 1e-9) {
        cell.fg(Color::Red)
    } else if value > limit * 0.9 {
        cell.fg(Color::Yellow)
    } else {
        cell
    }
}

/// A progress bar over `length` units, on standard error, only on a terminal.
pub(super) fn progress(length: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("━╸ "));
    }
    bar
}

/// Updates a bar from the progress of a check. If the end is not known, the bar becomes a spinner with the time of the
/// program.
pub(super) fn advance(bar: &ProgressBar, progress: &Progress) {
    if let Some(bytes) = progress.bytes {
        bar.set_position(bytes);
        return;
    }
    if bar.length().is_some() {
        bar.unset_length();
        if let Ok(style) = ProgressStyle::with_template("{msg} {spinner} at {prefix}") {
            bar.set_style(style);
        }
    }
    bar.set_prefix(format!("{:.1} s", seconds(progress.time_ns)));
    bar.tick();
}

/// The software limits of an axis in its unit, or a note that its rotation is unlimited.
pub(super) fn limits(axis: &Axis) -> String {
    let show = |value: f64| fixed(axis.from_si(value), 1);
    match axis.period {
        Some(period) if !axis.limited => format!("modulo {}", show(period)),
        _ => {
            let [low, high] = axis.position_limits;
            format!("{} … {}", show(low), show(high))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::amount;

    #[test]
    fn numbers_that_have_run_away_are_short() {
        assert_eq!(amount(99_999.94, 1, "mm"), "99999.9 mm");
        assert_eq!(amount(1.0e20, 4, "mm"), "> 100000 mm");
        assert_eq!(amount(-3.0e7, 1, ""), "< -100000");
        // An axis that is at 0 but for rounding is at 0.
        assert_eq!(amount(-1e-12, 1, "mm"), "0.0 mm");
        assert_eq!(amount(f64::NAN, 4, "W"), "> 100000 W");
    }
}
