//! What is said of how a run was recorded: within periods of its axes, and whether its time can be right.

use super::report::{Report, short};
use crate::cam::tune;
use std::io::{self, Write};

impl Report<'_> {
    pub(super) fn tell_recorded(&self, out: &mut impl Write) -> io::Result<()> {
        let units = [self.file.master.unit(), self.file.slave.unit()];
        for ((name, period), unit) in ["master", "slave"].into_iter().zip(self.wound).zip(units) {
            let Some(period) = period else { continue };
            writeln!(
                out,
                "the {name} is recorded within its period of {} {unit}, and is taken to go on where that begins again",
                short(period)
            )?;
        }
        if let Some(passes) = tune::passes_too_often(self.file, &self.before) {
            writeln!(
                out,
                "that is {} passes of the cam a second: is the time of the run in the unit that its column says?",
                short(passes)
            )?;
        }
        Ok(())
    }
}
