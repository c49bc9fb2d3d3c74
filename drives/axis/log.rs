//! `SMC_AxisDiagnosticLog` (10.4): chosen values of an axis, cycle by cycle, on file.
//!
//! The fast task records into a buffer of 5 kB, a slower one writes it. Numbers are written as short as they can be read
//! back exactly; the manual does not say how.

use std::io::{self, Write};

use super::AxisError;

/// Bytes of the buffer.
const CAPACITY: usize = 5 * 1024;

/// Which values are recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "the six inputs of the manual")]
pub struct LogSelection {
    /// `bSetPosition`.
    pub set_position: bool,
    /// `bActPosition`.
    pub act_position: bool,
    /// `bSetVelocity`.
    pub set_velocity: bool,
    /// `bActVelocity`.
    pub act_velocity: bool,
    /// `bSetAcceleration`.
    pub set_acceleration: bool,
    /// `bActAcceleration`.
    pub act_acceleration: bool,
}

/// Values of an axis at one instant, technical units, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LogValues {
    /// `fSetPosition`.
    pub set_position: f64,
    /// `fActPosition`.
    pub act_position: f64,
    /// `fSetVelocity`.
    pub set_velocity: f64,
    /// `fActVelocity`.
    pub act_velocity: f64,
    /// `fSetAcceleration`.
    pub set_acceleration: f64,
    /// `fActAcceleration`.
    pub act_acceleration: f64,
}

/// What stands between values and records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogFormat {
    /// `bySeparatorChar`, between the values of a record.
    pub separator: u8,
    /// `sRecordSeparatorString`, at the end of every record; at most three characters count.
    pub record_separator: String,
}

impl Default for LogFormat {
    /// TAB and CR LF.
    fn default() -> Self {
        Self { separator: b'\t', record_separator: "\r\n".to_owned() }
    }
}

/// A log of an axis. [`Self::start`] is the rising edge of `bExecute`.
#[doc(alias = "SMC_AxisDiagnosticLog")]
#[derive(Debug)]
pub struct DiagnosticLog<W: Write> {
    selection: LogSelection,
    separator: u8,
    record_separator: String,
    buffer: Vec<u8>,
    /// While the file is open.
    file: Option<W>,
    error: Option<AxisError>,
}

impl<W: Write> DiagnosticLog<W> {
    /// Opens the file, whose old content is lost, and records from now on.
    ///
    /// # Errors
    /// [`AxisError::LogNotOpened`] (2100).
    pub fn start(
        open: impl FnOnce() -> io::Result<W>,
        selection: LogSelection,
        format: &LogFormat,
    ) -> Result<Self, AxisError> {
        let file = open().map_err(|error| AxisError::LogNotOpened { reason: error.to_string() })?;
        Ok(Self {
            selection,
            separator: format.separator,
            record_separator: format.record_separator.chars().take(3).collect(),
            buffer: Vec::with_capacity(CAPACITY),
            file: Some(file),
            error: None,
        })
    }

    /// `bRecording`: the file is open and nothing has gone wrong.
    pub fn recording(&self) -> bool {
        self.file.is_some() && self.error.is_none()
    }

    /// `bDone`: the file has been closed.
    pub fn done(&self) -> bool {
        self.file.is_none()
    }

    /// Takes down the values of one cycle, whole or not at all. Without recording nothing happens.
    ///
    /// # Errors
    /// [`AxisError::LogOverrun`] (2101) if the buffer is full: recording ends, what is in the buffer can still be written.
    pub fn record(&mut self, values: &LogValues) -> Result<(), AxisError> {
        if !self.recording() {
            return Ok(());
        }
        let chosen = self.selection;
        let all = [
            (chosen.set_position, values.set_position),
            (chosen.act_position, values.act_position),
            (chosen.set_velocity, values.set_velocity),
            (chosen.act_velocity, values.act_velocity),
            (chosen.set_acceleration, values.set_acceleration),
            (chosen.act_acceleration, values.act_acceleration),
        ];
        let mut record = Vec::with_capacity(128);
        for (place, (_, value)) in all.iter().filter(|(chosen, _)| *chosen).enumerate() {
            if place > 0 {
                record.push(self.separator);
            }
            record.extend_from_slice(value.to_string().as_bytes());
        }
        record.extend_from_slice(self.record_separator.as_bytes());
        if self.buffer.len() + record.len() > CAPACITY {
            let overrun = AxisError::LogOverrun { capacity: CAPACITY };
            self.error = Some(overrun.clone());
            return Err(overrun);
        }
        self.buffer.append(&mut record);
        Ok(())
    }

    /// `WriteToFile`: writes what has been recorded, from the slower task.
    ///
    /// # Errors
    /// [`AxisError::LogNotWritten`]: recording ends.
    pub fn write_to_file(&mut self) -> Result<(), AxisError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let written = file.write_all(&self.buffer).and_then(|()| file.flush());
        self.buffer.clear();
        written.map_err(|error| {
            let error = AxisError::LogNotWritten { reason: error.to_string() };
            self.error = Some(error.clone());
            error
        })
    }

    /// `bCloseFile`: writes what is left and closes the file, which is handed back.
    ///
    /// # Errors
    /// [`AxisError::LogNotWritten`]: the file is closed all the same.
    pub fn close(&mut self) -> Result<Option<W>, AxisError> {
        let written = self.write_to_file();
        let file = self.file.take();
        written.map(|()| file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: LogSelection = LogSelection {
        set_position: true,
        act_position: true,
        set_velocity: true,
        act_velocity: true,
        set_acceleration: true,
        act_acceleration: true,
    };

    fn values(first: f64) -> LogValues {
        LogValues {
            set_position: first,
            act_position: 0.25,
            set_velocity: -3.0,
            act_velocity: 1e-9,
            set_acceleration: 0.1,
            act_acceleration: -0.0,
        }
    }

    /// TAB between values, $R$N after records.
    #[test]
    fn chosen_values_are_written_in_the_manuals_order() {
        let format = LogFormat::default();
        let mut log = DiagnosticLog::start(|| Ok(Vec::new()), ALL, &format).unwrap();
        assert!(log.recording() && !log.done());
        log.record(&values(1.5)).unwrap();
        let some = LogSelection { act_velocity: true, set_position: true, ..Default::default() };
        assert_eq!(log.close().unwrap().unwrap(), b"1.5\t0.25\t-3\t0.000000001\t0.1\t-0\r\n");
        assert!(log.done() && !log.recording());
        log.record(&values(2.0)).unwrap();
        assert_eq!(log.close(), Ok(None), "closed");
        let format = LogFormat { separator: b';', record_separator: "||\n!".to_owned() };
        let mut log = DiagnosticLog::start(|| Ok(Vec::new()), some, &format).unwrap();
        log.record(&values(1.0)).unwrap();
        log.write_to_file().unwrap();
        log.record(&values(2.0)).unwrap();
        assert_eq!(log.close().unwrap().unwrap(), b"1;0.000000001||\n2;0.000000001||\n");
    }

    #[test]
    fn a_full_buffer_is_2101_and_keeps_whole_records() {
        let only = LogSelection { set_position: true, ..Default::default() };
        let format = LogFormat::default();
        let mut log = DiagnosticLog::start(|| Ok(Vec::new()), only, &format).unwrap();
        // Ten bytes each: 512 fit.
        for _ in 0..512 {
            log.record(&values(1.234_567)).unwrap();
        }
        assert_eq!(log.record(&values(1.234_567)).unwrap_err().number(), Some(2101));
        assert!(!log.recording() && !log.done());
        let file = log.close().unwrap().unwrap();
        assert_eq!(file.len(), 5120);
        assert!(file.chunks(10).all(|record| record == b"1.234567\r\n"));
        // Written in time it never fills up.
        let mut log = DiagnosticLog::start(|| Ok(Vec::new()), only, &format).unwrap();
        for cycle in 0..5000 {
            log.record(&values(1.234_567)).unwrap();
            if cycle % 50 == 0 {
                log.write_to_file().unwrap();
            }
        }
        assert_eq!(log.close().unwrap().unwrap().len(), 50_000);
    }

    /// A file on a full disk.
    #[derive(Debug)]
    struct Full;

    impl Write for Full {
        fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn files_that_fail_are_told() {
        let format = LogFormat::default();
        let none = || Err::<Vec<u8>, _>(io::ErrorKind::PermissionDenied.into());
        let error = DiagnosticLog::start(none, ALL, &format).unwrap_err();
        assert_eq!(error.number(), Some(2100));
        let mut log = DiagnosticLog::start(|| Ok(Full), ALL, &format).unwrap();
        log.record(&values(1.0)).unwrap();
        assert!(matches!(log.write_to_file(), Err(AxisError::LogNotWritten { .. })));
        assert!(!log.recording());
        assert!(log.close().is_ok() && log.done());
    }
}
