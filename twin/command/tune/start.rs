//! Report on the start: the range of the master for `MC_CamIn`, and the start of a ramp that begins as a run does.

use super::report::{Report, short};
use crate::cam::check::CamUse;
use serde_json::{Value, json};
use std::io::{self, Write};

/// How it is known where the master is at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Started {
    /// `--master-start`, or the place of a `--ramp-in`.
    Given,
    /// The run begins there, on the cam.
    Run,
}

impl Report<'_> {
    /// Tells the same motion so that it starts: `MasterOffset` by whole passes of the cam elsewhere.
    pub(super) fn fold(&mut self) {
        let after = self.after;
        let told = after.start.and_then(|master| after.folded(self.file, master));
        let Some(told) = told else { return };
        let [old, new] = [&after, &told].map(|using| {
            let input = &using.coupling.input;
            [input.master_offset, input.slave_offset]
        });
        // What undoes the deviation is known as well as before.
        if let Some([offset, _, shift, _]) = &mut self.proposed {
            for ((slot, old), new) in [offset, shift].into_iter().zip(old).zip(new) {
                if slot.value.to_bits() == old.to_bits() {
                    slot.value = new;
                }
            }
        }
        self.folded = Some(old);
        self.after = told;
    }

    fn starts(&self, using: &CamUse) -> [f64; 2] {
        using.starts(self.file.cam.curve())
    }

    /// Whether what was found changes where the master may be at the start.
    fn start_changes(&self) -> bool {
        let [before, after] = [&self.before, &self.after].map(|using| {
            let input = &using.coupling.input;
            [input.master_offset.to_bits(), input.master_scaling.to_bits()]
        });
        before != after
    }

    pub(super) fn tell_start(&self, out: &mut impl Write) -> io::Result<()> {
        let unit = self.file.master.unit();
        let after = self.after.coupling.input;
        if let (Some([offset, shift]), Some(master)) = (self.folded, self.after.start) {
            let slave = if shift.to_bits() == after.slave_offset.to_bits() {
                String::new()
            } else {
                let [new, old] = [after.slave_offset, shift].map(|value| self.input(2, value));
                format!(" and SlaveOffset {new} in place of {old}")
            };
            writeln!(
                out,
                "MasterOffset is told as {} in place of {}{slave}, which is the same motion: so MC_CamIn starts with the master at {} \
                 {unit}, where it would end with error 626",
                self.input(0, after.master_offset),
                self.input(0, offset),
                self.place(master)
            )?;
        }
        if self.start_changes() {
            let [from, to] = self.starts(&self.after).map(|at| self.place(at));
            let [old_from, old_to] = self.starts(&self.before).map(|at| self.place(at));
            let known = match (self.after.start, self.started) {
                (Some(master), Some(Started::Run)) => {
                    format!("; the run begins at {}", self.place(master))
                }
                (Some(_), _) => String::new(),
                (None, _) => "; --master-start says where it is".to_owned(),
            };
            writeln!(
                out,
                "MC_CamIn starts with the master from {from} to {to} {unit} (it was from {old_from} to {old_to}), elsewhere it ends \
                 with error 626{known}"
            )?;
        }
        Ok(())
    }

    /// Where a ramp begins that is to begin as the run does, if that is not at its first sample as it is.
    pub(super) fn tell_begin(&self, out: &mut impl Write) -> io::Result<()> {
        let (unit, slave) = (self.file.master.unit(), self.file.slave.unit());
        let Some(begin) = self.begin else { return Ok(()) };
        let [master, position] = [self.place(begin.master), self.slave(begin.slave.position)];
        if begin.before > 0 {
            writeln!(
                out,
                "the run begins beyond the cam: the ramp begins where its master comes onto the cam, in line {}, at {master} {unit} with \
                 the slave at {position} {slave}",
                begin.line
            )?;
        } else if begin.passes != 0.0 {
            writeln!(
                out,
                "the run begins {} passes of the cam {}: the ramp begins at the same place of the pass on which MC_CamIn starts, at \
                 {master} {unit} with the slave at {position} {slave}",
                short(begin.passes.abs()),
                if begin.passes > 0.0 { "on" } else { "back" }
            )?;
        }
        Ok(())
    }

    /// The same as an object.
    pub(super) fn start_json(&self) -> Value {
        let [[min, max], [min_before, max_before]] =
            [&self.after, &self.before].map(|using| self.starts(using));
        json!({
            "master": self.after.start,
            "known_by": self.started.map(|by| if by == Started::Run { "run" } else { "given" }),
            "min": min, "max": max, "min_before": min_before, "max_before": max_before,
            "told_without": self.folded.map(|[offset, shift]| json!({
                "master_offset": offset, "slave_offset": shift,
            })),
            "ramp": self.begin.map(|begin| json!({
                "line": begin.line, "master": begin.master, "slave": begin.slave.position,
                "velocity": begin.slave.velocity, "passes": begin.passes, "samples_before": begin.before,
            })),
        })
    }
}
