//! Report of values that constraints hold: limits of a run, the least change, and the smallest peak.

use super::report::{Report, of, short};
use crate::cam::run::RecordedRun;
use crate::cam::tune::{Constrained, errors, with_exactly};
use serde_json::{Value, json};
use std::io::{self, Write};
use twin_cam::tune::Bound;
use twin_number::significant;

/// Why a value has changed that no constraint holds.
const CHANGE: &str = "for the least change with the others";

impl Report<'_> {
    /// How far the slave is from what is wanted, sample by sample: in the run, and with what is proposed.
    pub(super) fn run_errors(&self, run: &RecordedRun) -> [Vec<(f64, f64)>; 2] {
        let wanted = self.wanted.as_ref().unwrap_or(&self.before);
        let did = self.did.as_ref().unwrap_or(&self.after);
        let before = errors(self.file, wanted, run);
        let after = match (&self.limited, &self.wanted) {
            (None, _) => errors(self.file, did, run),
            // The run is the motion wanted.
            (Some(limited), None) => errors(self.file, &limited.does, run),
            // What is no deviation stays; what limits leave of the deviation comes on top.
            (Some(limited), Some(_)) => {
                let does = errors(self.file, &limited.does, run);
                let noise = errors(self.file, did, run).into_iter();
                let both = noise.zip(before.iter().zip(does));
                both.map(|((at, noise), ((_, wanted), (_, does)))| (at, noise + wanted - does))
                    .collect()
            }
        };
        [before, after]
    }

    pub(super) fn tell_limited(
        &self,
        out: &mut impl Write,
        limited: &Constrained,
    ) -> io::Result<()> {
        let slave = self.file.slave.unit();
        let start = |bound: &Bound| matches!(bound, Bound::Start { .. });
        let all = || limited.held.iter().flatten();
        let starts = all().any(start);
        let (what, them) = match (starts, starts && all().all(start)) {
            (_, true) => ("that MC_CamIn starts leaves", "it"),
            (true, _) => ("the limits of the slave, and that MC_CamIn starts, leave", "them"),
            _ => ("the limits of the slave leave", "them"),
        };
        let [left, without] = [limited.after, limited.before].map(|error| self.slave(error));
        writeln!(out, "{what} an error of {left} {slave} rms ({without} without {them}):")?;
        let numbers = self.after.coupling.numbers();
        for (index, ((_, name, value), held)) in numbers.iter().zip(&limited.held).enumerate() {
            let without = limited.from[index];
            if held.is_empty() && without.to_bits() == value.to_bits() {
                continue;
            }
            let by = self.held_by(limited, index, "for the least error with the others");
            let [value, without] = [*value, without].map(|value| self.input(index, value));
            writeln!(out, "  {name}: {value}, {by} ({without} without limits)")?;
        }
        if starts {
            let loose = with_exactly(&self.after, limited.from);
            let [from, to] = loose.starts(self.file.cam.curve()).map(|at| self.place(at));
            let unit = self.file.master.unit();
            writeln!(
                out,
                "  without that it would start with the master from {from} to {to} {unit}: where it does, --master-start says so"
            )?;
        }
        Ok(())
    }

    /// What was changed for the smallest peak or to keep the limits, and what holds each value.
    pub(super) fn tell_constrained(
        &self,
        out: &mut impl Write,
        found: &Constrained,
    ) -> io::Result<()> {
        let (indent, keeps) =
            if found.quantity.is_some() { ("  ", "") } else { ("", " keeps the limits") };
        if let Some(quantity) = found.quantity {
            let unit = of(self.file.slave.unit(), quantity);
            let way = if found.part { " on the way of the master" } else { "" };
            let [before, after] = [found.before, found.after].map(short);
            writeln!(out, "the slave's largest {quantity}{way}: {before} → {after} {unit}")?;
        }
        let numbers = self.after.coupling.numbers();
        let mut changed = false;
        for (index, ((_, name, after), held)) in numbers.iter().zip(&found.held).enumerate() {
            let stays = found.from[index].to_bits() == after.to_bits();
            if stays && (held.is_empty() || found.quantity.is_none()) {
                continue;
            }
            changed = true;
            let otherwise = if found.quantity.is_some() { "which nothing holds" } else { CHANGE };
            let by = self.held_by(found, index, otherwise);
            let [before, after] = [found.from[index], *after].map(|value| self.input(index, value));
            writeln!(out, "{indent}{name}: {before} → {after}{keeps}, {by}")?;
        }
        if changed || found.quantity.is_some() {
            Ok(())
        } else {
            writeln!(out, "the limits are kept as it is")
        }
    }

    fn held_by(&self, found: &Constrained, index: usize, otherwise: &str) -> String {
        let held = self.said(found, &found.held[index]);
        if held.is_empty() {
            otherwise.to_owned()
        } else {
            format!("held by {}", held.join(" and "))
        }
    }

    /// Constraints with their units.
    fn said(&self, found: &Constrained, held: &[Bound]) -> Vec<String> {
        let slave = self.file.slave.unit();
        let said = |bound: &Bound| match bound {
            Bound::Limit { quantity, limit } => {
                format!("the {quantity}, {} {}", significant(*limit, 6), of(slave, *quantity))
            }
            Bound::Position { limit } => {
                format!("the position, {} {slave}", significant(*limit, 6))
            }
            Bound::Start { master } => {
                let (at, unit) = (self.place(*master), self.file.master.unit());
                format!("the start with the master at {at} {unit} (error 626 beyond)")
            }
            Bound::Interval { end } if found.quantity.is_none() => {
                format!("the end of --scaling-range, {}", significant(*end, 6))
            }
            other => other.to_string(),
        };
        held.iter().map(said).collect()
    }

    pub(super) fn constrained_json(&self, found: &Constrained) -> Value {
        let names = self.after.coupling.numbers();
        let held = names.iter().zip(&found.held);
        let held: serde_json::Map<_, _> = held
            .map(|((_, name, _), held)| ((*name).to_owned(), json!(self.said(found, held))))
            .collect();
        json!({
            "of": found.quantity.map(|quantity| format!("peak {quantity}")),
            "from": found.from, "before": found.before, "after": found.after, "held": held,
        })
    }

    pub(super) fn limited_json(&self, limited: &Constrained) -> Value {
        let Value::Object(mut object) = self.constrained_json(limited) else { return Value::Null };
        for (key, value) in [("rms_left", limited.after), ("rms_without", limited.before)] {
            object.insert(key.to_owned(), json!(value));
        }
        Value::Object(object)
    }
}
