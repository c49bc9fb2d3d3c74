//! The table.

use crate::check::BlockClearance;
use csv::Writer;
use std::io::Write;
use twin_machine::Machine;
use twin_number::{exact_seconds, significant};

/// Significant digits of lengths, which are given to the nanometre: beyond that is noise.
const DIGITS: usize = 12;

/// Writes the clearance of every block as CSV: a header, then a line per block in the order in which they are run through.
///
/// The columns are `line`, `block` (empty without an N word), `time_s` (when it was nearest, since the start of the program),
/// `clearance_mm` (below 0 the two are as deep in each other), `part` and `other` (what came nearest to what), `x_mm`, `y_mm` and
/// `z_mm` (the nearest point of `part` in the machine frame).
#[derive(Debug)]
pub struct ClearanceCsv<'m, W: Write> {
    machine: &'m Machine,
    writer: Writer<W>,
    /// The block that goes on.
    block: Option<BlockClearance>,
}

impl<'m, W: Write> ClearanceCsv<'m, W> {
    /// Writes the header.
    ///
    /// # Errors
    /// If `out` cannot be written.
    pub fn new(out: W, machine: &'m Machine) -> Result<Self, csv::Error> {
        let mut writer = Writer::from_writer(out);
        writer.write_record([
            "line",
            "block",
            "time_s",
            "clearance_mm",
            "part",
            "other",
            "x_mm",
            "y_mm",
            "z_mm",
        ])?;
        Ok(Self { machine, writer, block: None })
    }

    /// Takes the next set-point; writes the block that it ends.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn include(&mut self, now: &BlockClearance) -> Result<(), csv::Error> {
        if self.block.as_mut().is_some_and(|block| block.include(now)) {
            return Ok(());
        }
        let ended = self.block.replace(*now);
        ended.map_or(Ok(()), |ended| self.write(&ended))
    }

    fn write(&mut self, block: &BlockClearance) -> Result<(), csv::Error> {
        let BlockClearance { place, time_ns, nearest, .. } = block;
        let [part, other] = block.names(self.machine);
        let [x, y, z] = nearest.points[0].coords.into();
        let mm = |metres: f64| significant((metres * 1e9).round() * 1e-6, DIGITS);
        self.writer.write_record([
            place.line.to_string(),
            place.block.map_or_else(String::new, |block| block.to_string()),
            exact_seconds(*time_ns),
            mm(nearest.distance),
            part,
            other,
            mm(x),
            mm(y),
            mm(z),
        ])
    }

    /// Writes what is left and gives the output back.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn finish(mut self) -> Result<W, csv::Error> {
        if let Some(block) = self.block.take() {
            self.write(&block)?;
        }
        self.writer.into_inner().map_err(|error| error.into_error().into())
    }
}
