//! Report of a reshaped cam.

use super::report::{Report, of, short};
use crate::cam::tune::{ShapeGoal, Shaped};
use std::io::{self, Write};
use twin_cam::Curve;
use twin_number::at_most;

impl Report<'_> {
    pub(super) fn tell_shape(&self, out: &mut impl Write, shaped: &Shaped) -> io::Result<()> {
        let (master, slave) = (self.file.master.unit(), self.file.slave.unit());
        let (before, after) = (short(shaped.before), short(shaped.after));
        match self.goal {
            Some(ShapeGoal::Peak(quantity)) => writeln!(
                out,
                "shape: the slave's largest {quantity} falls from {before} to {after} {}",
                of(slave, quantity)
            )?,
            _ => writeln!(
                out,
                "shape: the master may go {} {master}/s, it was {} {master}/s",
                at_most(shaped.after, 6),
                at_most(shaped.before, 6)
            )?,
        }
        if let Some((quantity, at)) = shaped.limited {
            writeln!(
                out,
                "  now limited by the slave's {quantity} at master {} {master}",
                self.place(at)
            )?;
        }
        for (at, reached, limit) in self.beyond(shaped) {
            let edge = if reached > limit { "most" } else { "least" };
            writeln!(
                out,
                "  the slave leaves its old range: it goes to {} {slave} at master {} {master}, it was {} at {edge}",
                self.slave(reached),
                self.place(at),
                self.slave(limit)
            )?;
        }
        let plural = if shaped.programs == 1 { "" } else { "s" };
        writeln!(out, "  {} linear program{plural}", shaped.programs)
    }

    /// Where a shape takes the slave beyond the positions it had: master, position, and what it was at most or at least.
    pub(super) fn beyond(&self, shaped: &Shaped) -> Vec<(f64, f64, f64)> {
        let Ok(curve) = Curve::polynomial(&shaped.knots) else { return Vec::new() };
        let using = &self.after;
        let ends = |curve: &Curve| {
            let y = curve.extremes().position;
            let ends = [(y.min, y.at_min), (y.max, y.at_max)]
                .map(|(y, at)| (using.slave_at(y), using.master_at(at)));
            if using.coupling.input.slave_scaling < 0.0 { [ends[1], ends[0]] } else { ends }
        };
        let [old, new] = [ends(self.file.cam.curve()), ends(&curve)];
        let room = 1e-9 * (old[1].0 - old[0].0).abs();
        let beyond = [new[0].0 < old[0].0 - room, new[1].0 > old[1].0 + room];
        let all = old.into_iter().zip(new).zip(beyond).filter(|(_, beyond)| *beyond);
        all.map(|(((limit, _), (reached, at)), _)| (at, reached, limit)).collect()
    }
}
