//! What is said of limits that hold what a run tells.

use super::report::{Report, of};
use crate::cam::run::RecordedRun;
use crate::cam::tune::{Limited, errors};
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
            (Some(_), None) => errors(self.file, &self.after, run),
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
        writeln!(
            out,
            "the limits of the slave leave an error of {} {slave} rms ({} without them):",
            self.slave(limited.left),
            self.slave(limited.otherwise)
        )?;
        let pairs = limited.without.iter().zip(self.after.coupling.numbers()).zip(&limited.held);
        for (index, ((without, (_, name, value)), held)) in pairs.enumerate() {
            if held.is_empty() && without.to_bits() == value.to_bits() {
                continue;
            }
            let by: Vec<_> = held.iter().map(|bound| self.said(bound)).collect();
            let by = if by.is_empty() {
                "for the least error with the others".to_owned()
            } else {
                format!("held by {}", by.join(" and "))
            };
            let [value, without] = [value, *without].map(|value| self.input(index, value));
            writeln!(out, "  {name}: {value}, {by} ({without} without limits)")?;
        }
        Ok(())
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
            other => other.to_string(),
        }
    }

    pub(super) fn limited_json(&self, limited: &Limited) -> Value {
        let names = self.after.coupling.numbers();
        let held = names.iter().zip(&limited.held).map(|((_, name, _), held)| {
            let by: Vec<_> = held.iter().map(|bound| self.said(bound)).collect();
            ((*name).to_owned(), json!(by))
        });
        json!({
            "rms_left": limited.left, "rms_without": limited.otherwise, "without": limited.without,
            "held": held.collect::<serde_json::Map<_, _>>(),
        })
    }
}
