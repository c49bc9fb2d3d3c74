//! Report of values that constraints hold: limits of a run, limits alone, and the smallest peak.

use super::report::{Report, Section, short};
use crate::cam::run::RecordedRun;
use crate::cam::tune::{Constrained, errors};
use serde_json::{Map, Value, json};
use twin_cam::tune::Bound;

impl Report<'_> {
    /// Error of the slave, sample by sample: in the run, and with the proposal.
    pub(super) fn run_errors(&self, run: &RecordedRun) -> [Vec<(f64, f64)>; 2] {
        let wanted = self.wanted.as_ref().unwrap_or(&self.before);
        let before = errors(self.file, wanted, run);
        let after = errors(self.file, self.did.as_ref().unwrap_or(&self.after), run);
        let Some(limited) = &self.limited else { return [before, after] };
        let mut does = errors(self.file, &limited.does, run);
        if self.wanted.is_some() {
            // Noise stays; what limits leave of the deviation comes on top.
            for ((does, noise), wanted) in does.iter_mut().zip(after).zip(&before) {
                does.1 = noise.1 + wanted.1 - does.1;
            }
        }
        [before, does]
    }

    /// What limits leave of what a run determines.
    pub(super) fn limited(&self) -> Section {
        let Some(limited) = &self.limited else { return Section::empty("limited") };
        let [_, slave] = self.units();
        let [left, without] = [limited.after, limited.before].map(|error| self.slave(error));
        let mut text = vec![format!(
            "the limits of the slave leave an error of {left} {slave} rms ({without} without them):"
        )];
        for (index, (_, name, value)) in self.after.coupling.numbers().iter().enumerate().take(4) {
            let without = limited.from[index];
            if limited.held[index].is_empty() && without.to_bits() == value.to_bits() {
                continue;
            }
            let by = self.held_by(limited, index, "for the least error with the others");
            let [value, without] = [*value, without].map(|value| self.input(index, value));
            text.push(format!("  {name}: {value}, {by} ({without} without limits)"));
        }
        let mut value = self.constrained_json(limited);
        value["rms_left"] = json!(limited.after);
        value["rms_without"] = json!(limited.before);
        Section { key: "limited", value, text }
    }

    /// What was changed for the smallest peak or to keep the limits, and what holds each value.
    pub(super) fn constrained(&self, key: &'static str, found: Option<&Constrained>) -> Section {
        let Some(found) = found else { return Section::empty(key) };
        let mut text = Vec::new();
        let (indent, keeps, otherwise) = match found.quantity {
            Some(_) => ("  ", "", "which nothing holds"),
            None => ("", " keeps the limits", "for the least error with the others"),
        };
        if let Some(quantity) = found.quantity {
            let [before, after] = [found.before, found.after].map(short);
            let unit = self.of(quantity);
            text.push(format!("the slave's largest {quantity}: {before} → {after} {unit}"));
        }
        for (index, (_, name, after)) in self.after.coupling.numbers().iter().enumerate().take(4) {
            let stays = found.from[index].to_bits() == after.to_bits();
            // Its passes alone may have changed, for the start.
            let start = index == 0 && found.held[0].is_empty();
            if start || stays && (found.held[index].is_empty() || found.quantity.is_none()) {
                continue;
            }
            let by = self.held_by(found, index, otherwise);
            let [before, after] = [found.from[index], *after].map(|value| self.input(index, value));
            text.push(format!("{indent}{name}: {before} → {after}{keeps}, {by}"));
        }
        if text.is_empty() {
            text.push("the limits are kept as it is".to_owned());
        }
        Section { key, value: self.constrained_json(found), text }
    }

    fn held_by(&self, found: &Constrained, index: usize, otherwise: &str) -> String {
        let held = self.said(&found.held[index]);
        if held.is_empty() {
            otherwise.to_owned()
        } else {
            format!("held by {}", held.join(" and "))
        }
    }

    /// Constraints with their units.
    fn said(&self, held: &[Bound]) -> Vec<String> {
        let [_, slave] = self.units();
        let said = |bound: &Bound| match bound {
            Bound::Limit { quantity, limit } => {
                format!("the {quantity}, {} {}", short(*limit), self.of(*quantity))
            }
            Bound::Position { limit } => format!("the position, {} {slave}", short(*limit)),
            other => other.to_string(),
        };
        held.iter().map(said).collect()
    }

    fn constrained_json(&self, found: &Constrained) -> Value {
        let names = self.after.coupling.numbers();
        let held = names.iter().zip(&found.held);
        let held: Map<_, _> =
            held.map(|((_, name, _), held)| ((*name).to_owned(), json!(self.said(held)))).collect();
        json!({
            "of": found.quantity.map(|quantity| format!("peak {quantity}")),
            "from": found.from, "before": found.before, "after": found.after, "held": held,
        })
    }
}
