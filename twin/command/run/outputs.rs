//! Messages about outputs: those that the program switches, before the run, and their delays, after it.

use crate::attached::Attached;
use crate::check::Outcome;
use crate::hardware::{SwitchedOutputs, switching_drive};
use crate::per_axis::PerAxis;
use crate::report::SwitchedOutputsReport;
use twin_machine::MFunction;
use twin_machine::Machine;
use twin_machine::switch_points::{SwitchOutput, has};
use twin_number::rounded;

/// The outputs that the program switches by M functions, tappets and switch points, a line per cause; nothing if it switches
/// none.
pub(super) fn switched(machine: &Machine, drives: &[Attached], outcome: &Outcome) -> Vec<String> {
    let name = |device: usize| machine.drives.get(device).map_or("", |entry| entry.name.as_str());
    let called = |function: &&MFunction| outcome.m_calls.contains(&function.number);
    let board = switching_drive(machine, drives).and_then(|index| drives.get(index));
    let functions = machine.m_functions.iter().filter(called).filter_map(|function| {
        let MFunction { number, outputs_on, outputs_off, .. } = function;
        let board = name(board?.device);
        let parts: Vec<_> = [("on", outputs_on), ("off", outputs_off)]
            .into_iter()
            .filter(|(_, outputs)| !outputs.is_empty())
            .map(|(how, outputs)| format!("{how} {}", list(outputs)))
            .collect();
        let parts = parts.join(" and ");
        (!parts.is_empty())
            .then(|| format!("M{number} of the program switches {parts} of device `{board}`"))
    });
    let attached = |device| drives.iter().any(|drive| drive.device == device);
    let tappets = machine.tappet_outputs.iter().filter(|one| attached(one.device));
    let tappets = tappets.filter_map(|one| {
        let mut signals = outcome.tappets.signals.iter();
        let signal = signals.find(|signal| signal.axis == one.axis && signal.group == one.group)?;
        Some(format!("output {} of device `{}` follows {signal}", one.output, name(one.device)))
    });
    let switches = machine.switch_outputs.iter().filter(|one| attached(one.device));
    let switches = switches.filter(|one| has(&outcome.switch_points, one.number)).map(|one| {
        let SwitchOutput { number, device, output } = one;
        format!("output {output} of device `{}` follows the switch points H{number}", name(*device))
    });
    functions.chain(tappets).chain(switches).collect()
}

/// `output 1` or `outputs 1, 2`.
fn list(outputs: &[u8]) -> String {
    let numbers: Vec<_> = outputs.iter().map(u8::to_string).collect();
    let plural = if outputs.len() == 1 { "output" } else { "outputs" };
    format!("{plural} {}", numbers.join(", "))
}

/// Switching delays of each device, a line each.
pub(super) fn lateness(switched: &[(String, SwitchedOutputs)]) -> impl Iterator<Item = String> {
    switched.iter().map(|(device, outputs)| {
        let times = if outputs.count == 1 { "once" } else { &format!("{} times", outputs.count) };
        let (mean, latest) = (outputs.mean_ms(), outputs.latest_ms());
        format!(
            "device `{device}`: outputs switched {times}, confirmed {mean:.1} ms after they were due on average, {latest:.1} ms at most"
        )
    })
}

/// Switching delays for the report, if anything was switched.
pub(super) fn report(
    switched: &[(String, SwitchedOutputs)],
) -> Option<PerAxis<SwitchedOutputsReport>> {
    let of = |outputs: &SwitchedOutputs| SwitchedOutputsReport {
        count: outputs.count,
        mean_late_ms: rounded(outputs.mean_ms()),
        max_late_ms: rounded(outputs.latest_ms()),
    };
    let all = switched.iter().map(|(name, outputs)| (name.clone(), of(outputs)));
    (!switched.is_empty()).then(|| PerAxis(all.collect()))
}
