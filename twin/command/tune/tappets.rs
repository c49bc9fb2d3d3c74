//! Report on tappets: their places on the cam and the master positions at which they switch.

use super::report::{Report, short};
use crate::cam::edit::Change;
use crate::cam::tune::{KeptTappet, passed_at, told_at};
use serde_json::{Value, json};
use std::io::{self, Write};
use twin_machine::cam_file::tappet_line;

/// A way of the master, as a part of a pass, that is rounding.
const ROUNDING: f64 = 1e-9;

/// A tappet before and after.
struct Placed {
    tappet: KeptTappet,
    /// Where the master passes it, before and after.
    masters: [f64; 2],
    /// Where the slave is told to be when the master is where it passed it, before and after.
    slaves: [f64; 2],
    /// Whether the master passes it where it did.
    stays: bool,
}

impl Report<'_> {
    /// All tappets, those that do not move as well.
    fn placed(&self) -> Vec<Placed> {
        let tappets = self.kept.as_ref().map_or_else(
            || {
                let all = self.file.cam.tappets().iter();
                all.map(|tappet| KeptTappet { tappet: *tappet, from: tappet.master }).collect()
            },
            |kept| kept.tappets.clone(),
        );
        let place = |tappet: KeptTappet| {
            let before = self.before.master_at(tappet.from);
            let after = passed_at(self.file, &self.after, tappet.tappet.master, before);
            let slaves = [&self.before, &self.after].map(|using| told_at(self.file, using, before));
            let stays = (after - before).abs() <= ROUNDING * self.turns()[0];
            Placed { tappet, masters: [before, after], slaves, stays }
        };
        tappets.into_iter().map(place).collect()
    }

    /// How far the master goes on a pass of the cam, before and after.
    fn turns(&self) -> [f64; 2] {
        let curve = self.file.cam.curve();
        [&self.before, &self.after].map(|using| {
            ((curve.end() - curve.start()) / using.coupling.input.master_scaling).abs()
        })
    }

    /// Tells tappets that move, on the cam or on the master, and, where limits changed the coupling, where the slave is there.
    pub(super) fn tell_tappets(&self, out: &mut impl Write) -> io::Result<()> {
        let (master, slave) = (self.file.master.unit(), self.file.slave.unit());
        let placed = self.placed();
        if self.fit.is_some() && self.wanted.is_none() && placed.iter().any(|one| !one.stays) {
            writeln!(out, "tappets belong to the motion of the cam and go with it:")?;
        }
        let height = self.height().abs();
        for Placed { tappet: KeptTappet { tappet, from }, masters, slaves, stays } in &placed {
            let moved = from.to_bits() != tappet.master.to_bits();
            let elsewhere =
                self.within.is_some() && (slaves[1] - slaves[0]).abs() > ROUNDING * height;
            if !moved && *stays && !elsewhere {
                continue;
            }
            let to =
                if moved { format!(" → {}", self.place(tappet.master)) } else { String::new() };
            let [before, after] = masters.map(|at| self.place(at));
            let way = if *stays {
                format!("stays at master {before} {master}")
            } else {
                format!("goes from master {before} to {after} {master}")
            };
            let there = if elsewhere {
                let [before, after] = slaves.map(|position| self.slave(position));
                format!("; the slave is at {after} {slave} there, it was at {before}")
            } else {
                String::new()
            };
            let (group, from) = (tappet.group, self.place(*from));
            writeln!(out, "tappet of group {group} at {from}{to} of the cam {way}{there}")?;
        }
        let [before, after] = self.turns();
        let longer = after - before;
        if self.kept.is_some() && self.after.repeated && longer.abs() > ROUNDING * before {
            let when = if longer > 0.0 { "later" } else { "earlier" };
            writeln!(
                out,
                "  a pass of the cam takes {} {master} of the master, it took {}: with every further pass tappets come {} {master} {when}",
                short(after),
                short(before),
                short(longer.abs())
            )?;
        }
        Ok(())
    }

    /// The tappets that were moved on the cam, as lines of its file.
    pub(super) fn moved_tappets(&self) -> Vec<String> {
        let line = |change: &Change| {
            let Change::Tappet { tappet, .. } = change else { return None };
            Some(format!("{{ {} }},", tappet_line(tappet)))
        };
        self.changes.iter().filter_map(line).collect()
    }

    /// Every tappet with its places on the cam and on the master; none of what was refused.
    pub(super) fn tappets_json(&self) -> Value {
        if self.refused.is_some() {
            return Value::Null;
        }
        let object = |Placed { tappet: KeptTappet { tappet, from }, masters, .. }: &Placed| {
            json!({
                "group": tappet.group, "cam_before": from, "cam_after": tappet.master,
                "master_before": masters[0], "master_after": masters[1],
            })
        };
        self.placed().iter().map(object).collect()
    }

    /// The half width of what is proposed, if it is what undoes the deviation alone.
    pub(super) fn proposed_within(&self, index: usize) -> Option<f64> {
        let found = self.proposed.as_ref()?.get(index)?;
        let [before, after] = [&self.before, &self.after]
            .map(|using| using.coupling.numbers().get(index).map(|(.., value)| value.to_bits()));
        let own = after == Some(found.value.to_bits()) && before != after;
        (own && found.half_width > 0.0).then_some(found.half_width)
    }
}
