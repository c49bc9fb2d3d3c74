//! Report on the start: the range of the master for `MC_CamIn`.

use super::report::{Report, Section};
use crate::cam::check::CamUse;
use serde_json::json;
use twin_cam::CamInput;

impl Report<'_> {
    /// Gives the same motion offsets with which it starts: `MasterOffset` by whole passes of the cam elsewhere.
    pub(super) fn fold(&mut self) {
        let after = self.after;
        let folded = after.start.and_then(|master| after.folded(self.file, master));
        let Some(folded) = folded else { return };
        let [old, new] = [&after, &folded].map(|using| {
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
        self.after = folded;
    }

    /// Where the master may be when the slave is coupled, and what was changed for that.
    pub(super) fn start(&self) -> Section {
        let [unit, _] = self.units();
        let starts = |using: &CamUse| using.starts(self.file.cam.curve());
        let [before, after] = [&self.before, &self.after].map(starts);
        let [input, old] = [&self.after, &self.before].map(|using| using.coupling.input);
        let mut text = Vec::new();
        if let (Some([offset, shift]), Some(master)) = (self.folded, self.after.start) {
            let mut slave = String::new();
            if shift.to_bits() != input.slave_offset.to_bits() {
                let [new, old] = [input.slave_offset, shift].map(|value| self.input(2, value));
                slave = format!(" and SlaveOffset {new} in place of {old}");
            }
            let [new, old] = [input.master_offset, offset].map(|value| self.input(0, value));
            let at = self.place(master);
            text.push(format!(
                "MasterOffset is given as {new} in place of {old}{slave}, which is the same motion: so MC_CamIn starts with the \
                 master at {at} {unit}, where it would end with error 626"
            ));
        }
        let values =
            |input: &CamInput| [input.master_offset, input.master_scaling].map(f64::to_bits);
        if values(&input) != values(&old) {
            let [from, to] = after.map(|at| self.place(at));
            let [old_from, old_to] = before.map(|at| self.place(at));
            let known = match self.after.start {
                Some(at) => format!("; it starts at {}", self.place(at)),
                None => "; --master-start says where it is".to_owned(),
            };
            text.push(format!(
                "MC_CamIn starts with the master from {from} to {to} {unit} (it was from {old_from} to {old_to}), elsewhere it \
                 ends with error 626{known}"
            ));
        }
        if self.refused.is_some() {
            text.clear();
        }
        let value = json!({
            "master": self.after.start,
            "min": after[0], "max": after[1], "min_before": before[0], "max_before": before[1],
            "told_without": self.folded.map(|[offset, shift]| json!({
                "master_offset": offset, "slave_offset": shift,
            })),
        });
        Section { key: "start", value, text }
    }
}
