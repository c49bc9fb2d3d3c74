//! Start range of `MC_CamIn`: the master must be on the cam, even on a periodic one, or the block ends with error 626
//! (manual 4.6.1).

use super::usage::CamUse;
use crate::finding::{Finding, Rule};
use serde_json::{Value, json};
use twin_cam::Curve;
use twin_cam::file::clean;
use twin_machine::cam_file::CamFile;
use twin_number::beside;
use twin_path::Place;

/// What a rotary slave gains in whole passes is a whole number of its periods but for this part.
const WHOLE: f64 = 1e-9;

impl CamUse {
    /// Where the master is on the scale of the cam, passes included.
    pub(crate) fn place_at(&self, master: f64) -> f64 {
        let input = &self.coupling.input;
        master * input.master_scaling + input.master_offset
    }

    /// Whether `MC_CamIn` starts with the master there.
    pub(crate) fn starts_at(&self, curve: &Curve, master: f64) -> bool {
        curve.contains(self.place_at(master))
    }

    /// From where to where the master may be when `MC_CamIn` starts.
    pub(crate) fn starts(&self, curve: &Curve) -> [f64; 2] {
        let [one, other] = [curve.start(), curve.end()].map(|place| self.master_at(place));
        [one.min(other), one.max(other)]
    }

    /// The same motion with offsets with which `MC_CamIn` starts with the master there: of a periodic cam `MasterOffset` may
    /// be whole passes more or less, with what the slave gains in them in `SlaveOffset`. None if it starts as it is, or never.
    pub(crate) fn folded(&self, file: &CamFile, master: f64) -> Option<Self> {
        let curve = file.cam.curve();
        if !self.repeated || self.starts_at(curve, master) {
            return None;
        }
        let width = curve.end() - curve.start();
        let passes = ((self.place_at(master) - curve.start()) / width).floor();
        let gained = passes * curve.rise() * self.coupling.input.slave_scaling;
        let turns = self.slave_period(file).map(|period| gained / period);
        let round = turns.is_some_and(|turns| (turns - turns.round()).abs() <= WHOLE);
        let mut folded = *self;
        let input = &mut folded.coupling.input;
        if gained != 0.0 && !round {
            input.slave_offset = clean(input.slave_offset + gained);
        }
        let offset = input.master_offset - passes * width;
        [clean(offset), offset].into_iter().find_map(|master_offset| {
            folded.coupling.input.master_offset = master_offset;
            folded.starts_at(curve, master).then_some(folded)
        })
    }

    /// Where the master may be at the start, where it is, and where that is on the cam, as an object.
    pub(super) fn start_json(&self, file: &CamFile) -> Value {
        let curve = file.cam.curve();
        let [min, max] = self.starts(curve);
        json!({
            "min": min, "max": max, "master": self.start,
            "place": self.start.map(|master| self.place_at(master)),
            "starts": self.start.map(|master| self.starts_at(curve, master)),
        })
    }

    /// Finding about the start of the master, if that is known and off the cam.
    pub(super) fn refused_start(&self, file: &CamFile) -> Option<Finding> {
        let curve = file.cam.curve();
        let master = self.start.filter(|master| !self.starts_at(curve, *master))?;
        let unit = file.master.unit();
        let width = curve.end() - curve.start();
        let place = |x: f64| beside(x, width, 6);
        let input = &self.coupling.input;
        let at = |master: f64| beside(master, width / input.master_scaling, 6);
        let message = format!(
            "MC_CamIn ends with error 626: the master at {} {unit} is at {} of the cam, outside {} to {}",
            at(master),
            place(self.place_at(master)),
            place(curve.start()),
            place(curve.end())
        );
        let mut finding = Finding::error(Rule::Coupling, Place::at(0), message);
        let [from, to] = self.starts(curve).map(at);
        let other = if let Some(folded) = self.folded(file, master) {
            let folded = folded.coupling.input;
            let slave = if folded.slave_offset.to_bits() == input.slave_offset.to_bits() {
                String::new()
            } else {
                format!(" and SlaveOffset {}", folded.slave_offset)
            };
            format!("set MasterOffset {}{slave} for the same motion", folded.master_offset)
        } else {
            let scaled = master * input.master_scaling;
            let [from, to] = [curve.start() - scaled, curve.end() - scaled].map(place);
            format!("set MasterOffset from {from} to {to}, or lengthen the cam")
        };
        finding.hint =
            Some(format!("start with the master from {from} to {to} {unit}, or {other}"));
        Some(finding)
    }
}
