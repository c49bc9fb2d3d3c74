//! Following-error prediction as a table for people.

use super::show::{against, amount, table};
use crate::check::{Outcome, PredictedFollowing};
use crate::compare::Statistics;
use crate::hardware::lost_answer;
use comfy_table::{Cell, CellAlignment, Table};
use twin_drives::WireRates;
use twin_machine::Machine;

/// The table of how well the drives will follow.
pub(super) fn predicted(machine: &Machine, predicted: &PredictedFollowing) -> Table {
    let mut table = table();
    table.set_header([
        "drives, predicted",
        "largest error",
        "limit",
        "rms",
        "line",
        "wire carries",
    ]);
    let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
    let mut row = |name: String,
                   of: &Statistics,
                   limit: Option<f64>,
                   (scale, unit): (f64, &str),
                   wire: String| {
        let Some((max, place)) = of.maximum() else { return };
        let largest = amount(max * scale, 4, unit);
        table.add_row([
            Cell::new(name),
            against(largest, max, limit.unwrap_or(f64::INFINITY))
                .set_alignment(CellAlignment::Right),
            right(limit.map_or("–".to_owned(), |limit| format!("{:.4}", limit * scale))),
            right(amount(of.rms() * scale, 4, unit)),
            right(place.line.to_string()),
            Cell::new(wire),
        ]);
    };
    row("tool".to_owned(), &predicted.tool, None, (1e3, "mm"), String::new());
    for traffic in &predicted.devices {
        let Some(device) = machine.drives.get(traffic.device) else { continue };
        // Once per device.
        let mut wire = rates(&traffic.rates);
        for (index, axis) in machine.axes_of(traffic.device) {
            let Some(Some(statistics)) = predicted.axes.get(index) else { continue };
            let name = format!("axis {} ({})", axis.name, device.name);
            let scale = (axis.from_si(1.0), axis.unit());
            let wire = std::mem::take(&mut wire);
            row(name, statistics, axis.max_following_error, scale, wire);
        }
    }
    table
}

/// Rates of a wire, in words.
pub(super) fn rates(rates: &WireRates) -> String {
    format!("{:.0} commands/s, {:.0} samples/s", rates.commands_per_s, rates.samples_per_s)
}

/// Cost of one lost answer, in a line; none if no axis would stop the run. Until the driver has given the answer up and
/// asked again, the axes of its device are not corrected. An axis that moves farther than its `max_following_error` in
/// that time stops the run.
pub(super) fn lost_answers(machine: &Machine, outcome: &Outcome) -> Option<String> {
    let mut devices = Vec::new();
    for (index, entry) in machine.drives.iter().enumerate() {
        let lost = lost_answer(machine, (index, entry));
        let mut axes = Vec::new();
        for (place, axis) in machine.axes_of(index) {
            let peak = outcome.peaks.get(place).map(|peak| peak.velocity);
            let Some((limit, peak)) = axis.max_following_error.zip(peak) else { continue };
            let way = peak.value * lost.as_secs_f64();
            if way <= limit {
                continue;
            }
            let [way, limit] = [way, limit].map(|si| axis.from_si(si));
            let (unit, name, line) = (axis.unit(), &axis.name, peak.place.line);
            axes.push(format!("{name} {way:.2} {unit} (limit {limit:.2}, line {line})"));
        }
        if !axes.is_empty() {
            let (name, lost, axes) = (&entry.name, lost.as_millis(), axes.join(", "));
            devices.push(format!("device `{name}` takes up to {lost} ms: {axes}"));
        }
    }
    let devices = devices.join("; ");
    (!devices.is_empty())
        .then(|| format!("note: one lost answer of a real drive stops the run; {devices}"))
}
