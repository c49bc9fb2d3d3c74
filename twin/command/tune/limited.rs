//! What is said of limits that hold what a run tells.

use super::report::{Report, of};
use crate::cam::run::RecordedRun;
use crate::cam::tune::{Limited, errors, with_exactly};
use crate::number::significant;
use serde_json::{Value, json};
use std::io::{self, Write};
use twin_motion::cam::tune::Bound;

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

    pub(super) fn tell_limited(&self, out: &mut impl Write, limited: &Limited) -> io::Result<()> {
        let slave = self.file.slave.unit();
        let start = |bound: &Bound| matches!(bound, Bound::Start { .. });
        let all = limited.held.iter().flatten();
        let what = if all.clone().any(start) && all.clone().all(start) {
            "that MC_CamIn starts leaves"
        } else if all.clone().any(start) {
            "the limits of the slave, and that MC_CamIn starts, leave"
        } else {
            "the limits of the slave leave"
        };
        writeln!(
            out,
            "{what} an error of {} {slave} rms ({} without {}):",
            self.slave(limited.left),
            self.slave(limited.otherwise),
            if what.starts_with("that") { "it" } else { "them" }
        )?;
        let pairs = limited.without.iter().zip(limited.values).zip(&limited.held);
        for ((index, ((without, value), held)), (_, name, _)) in
            pairs.enumerate().zip(self.after.coupling.numbers())
        {
            if held.is_empty() && without.to_bits() == value.to_bits() {
                continue;
            }
            let by = if held.is_empty() {
                "for the least error with the others".to_owned()
            } else {
                format!("held by {}", self.said_all(held))
            };
            let [value, without] = [value, *without].map(|value| self.input(index, value));
            writeln!(out, "  {name}: {value}, {by} ({without} without limits)")?;
        }
        if limited.held.iter().flatten().any(start) {
            let loose = with_exactly(&self.after, limited.without);
            let [from, to] = loose.starts(self.file.cam.curve()).map(|at| self.place(at));
            let unit = self.file.master.unit();
            writeln!(
                out,
                "  without that it would start with the master from {from} to {to} {unit}: where it does, --master-start says so"
            )?;
        }
        Ok(())
    }

    /// What was changed to keep the limits, and what holds each value.
    pub(super) fn tell_within(
        &self,
        out: &mut impl Write,
        held: &[Vec<Bound>; 4],
    ) -> io::Result<()> {
        let pairs = self.before.coupling.numbers().into_iter().zip(self.after.coupling.numbers());
        let mut changed = false;
        for ((index, ((_, name, before), (_, _, after))), held) in pairs.enumerate().zip(held) {
            if before.to_bits() == after.to_bits() {
                continue;
            }
            let [before, after] = [before, after].map(|value| self.input(index, value));
            let by = if held.is_empty() {
                "for the least change with the others".to_owned()
            } else {
                format!("held by {}", self.said_all(held))
            };
            writeln!(out, "{name}: {before} → {after} keeps the limits, {by}")?;
            changed = true;
        }
        if changed { Ok(()) } else { writeln!(out, "the limits are kept as it is") }
    }

    /// Limits with their units.
    fn said_all(&self, held: &[Bound]) -> String {
        held.iter().map(|bound| self.said(bound)).collect::<Vec<_>>().join(" and ")
    }

    fn held_json(&self, held: &[Vec<Bound>; 4]) -> Value {
        let names = self.after.coupling.numbers();
        let held = names.iter().zip(held).map(|((_, name, _), held)| {
            let by: Vec<_> = held.iter().map(|bound| self.said(bound)).collect();
            ((*name).to_owned(), json!(by))
        });
        Value::Object(held.collect())
    }

    pub(super) fn within_json(&self, held: &[Vec<Bound>; 4]) -> Value {
        let [one, two, three, four, ..] = self.before.coupling.numbers().map(|(.., value)| value);
        json!({ "from": [one, two, three, four], "held": self.held_json(held) })
    }

    /// A limit with its unit.
    fn said(&self, bound: &Bound) -> String {
        let slave = self.file.slave.unit();
        match bound {
            Bound::Limit { quantity, limit } => {
                format!("the {quantity}, {} {}", significant(*limit, 6), of(slave, *quantity))
            }
            Bound::Position { limit } => {
                format!("the position, {} {slave}", significant(*limit, 6))
            }
            Bound::Start { master } => {
                let unit = self.file.master.unit();
                format!(
                    "the start with the master at {} {unit} (error 626 beyond)",
                    self.place(*master)
                )
            }
            // No other interval is asked of these.
            Bound::Interval { end } => {
                format!("the end of --scaling-range, {}", significant(*end, 6))
            }
            other => other.to_string(),
        }
    }

    pub(super) fn limited_json(&self, limited: &Limited) -> Value {
        json!({
            "rms_left": limited.left, "rms_without": limited.otherwise, "without": limited.without,
            "held": self.held_json(&limited.held),
        })
    }
}
