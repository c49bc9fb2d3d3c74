//! Report on tappets: their places on the cam and the master positions at which they switch.

use super::report::{Report, Section, short};
use crate::cam::tune::{KeptTappet, passed_at, slave_on_cam};
use serde_json::{Value, json};

/// A way of the master, as a part of a pass, that is rounding.
const ROUNDING: f64 = 1e-9;

impl Report<'_> {
    /// Tappets that move, on the cam or on the master, and, where limits changed the coupling, the slave there; nothing when what is
    /// asked for is refused. The JSON value has all of them.
    pub(super) fn tappets(&self) -> Section {
        let (mut text, mut all) = (Vec::new(), Vec::new());
        if self.refused.is_some() {
            return Section::empty("tappets");
        }
        let [master, slave] = self.units();
        let curve = self.file.cam.curve();
        // How far the master goes on a pass of the cam, before and after.
        let turns = [&self.before, &self.after].map(|using| {
            ((curve.end() - curve.start()) / using.coupling.input.master_scaling).abs()
        });
        let unmoved = self.file.cam.tappets().iter();
        let unmoved = unmoved.map(|tappet| KeptTappet { tappet: *tappet, from: tappet.master });
        let tappets =
            self.kept.as_ref().map_or_else(|| unmoved.collect(), |kept| kept.tappets.clone());
        let mut go = false;
        for KeptTappet { tappet, from } in tappets {
            let before = self.before.master_at(from);
            let after = passed_at(self.file, &self.after, tappet.master, before);
            let [old, new] =
                [&self.before, &self.after].map(|using| slave_on_cam(self.file, using, before));
            let group = tappet.group;
            all.push(json!({
                "group": group, "cam_before": from, "cam_after": tappet.master,
                "master_before": before, "master_after": after,
            }));
            let stays = (after - before).abs() <= ROUNDING * turns[0];
            let moved = from.to_bits() != tappet.master.to_bits();
            let elsewhere = (new - old).abs() > ROUNDING * self.height().abs();
            let elsewhere = (self.within.is_some() || self.least.is_some()) && elsewhere;
            go |= !stays;
            if !moved && stays && !elsewhere {
                continue;
            }
            let [at, before, after] = [from, before, after].map(|at| self.place(at));
            let mut line = format!("tappet of group {group} at {at}");
            if moved {
                line.extend([" → ", &self.place(tappet.master)]);
            }
            let where_to = if stays {
                format!(" of the cam stays at master {before} {master}")
            } else {
                format!(" of the cam goes from master {before} to {after} {master}")
            };
            line += &where_to;
            if elsewhere {
                let [old, new] = [old, new].map(|position| self.slave(position));
                let moved = format!("; the slave is at {new} {slave} there, it was at {old}");
                line += &moved;
            }
            text.push(line);
        }
        if self.fit.is_some() && self.wanted.is_none() && go {
            text.insert(0, "tappets belong to the motion of the cam and go with it:".to_owned());
        }
        let [before, after] = turns;
        let longer = after - before;
        if self.kept.is_some() && self.after.repeated && longer.abs() > ROUNDING * before {
            let when = if longer > 0.0 { "later" } else { "earlier" };
            let [before, after, by] = [before, after, longer.abs()].map(short);
            text.push(format!(
                "  a pass of the cam takes {after} {master} of the master, it took {before}: with every further pass tappets come \
                 {by} {master} {when}"
            ));
        }
        Section { key: "tappets", value: Value::Array(all), text }
    }
}
