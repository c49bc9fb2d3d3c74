//! Restore plan: the parameters that a backup file would change on a device, and writing those changes.

use std::fmt;

use super::{Backup, BackupError, LineError, LineFault, RestoreError};
use crate::{Drive, DriveError, ParameterId, ParameterInfo};

/// A parameter of which file and device say different things.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Line of the file.
    pub line: u32,
    /// Number of the parameter.
    pub id: ParameterId,
    /// Name that the device gives it.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Value of the device; `None` if it does not answer for it.
    pub from: Option<i64>,
    /// Value of the file.
    pub to: i64,
    /// Whether it acts after a restart only.
    pub needs_restart: bool,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { id, name, unit, from, to, .. } = self;
        let gap = if unit.is_empty() { "" } else { " " };
        match from {
            Some(from) => write!(f, "{id} ({name}): {from} -> {to}{gap}{unit}")?,
            None => write!(f, "{id} ({name}): ? -> {to}{gap}{unit}")?,
        }
        f.write_str(if self.needs_restart { ", after a restart" } else { "" })
    }
}

/// Changes that a file would make on a device: nothing has been written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Values to write, in the order of the file.
    pub changes: Vec<Change>,
    /// Differences that cannot be written.
    pub read_only: Vec<Change>,
    /// Differences that are not written, because the device would not be heard any more: address, speed and parity of the line.
    pub of_the_line: Vec<Change>,
    /// Parameters that are as in the file.
    pub same: usize,
    /// Those that the device keeps on demand: what can be written, but for what the line depends on.
    pub kept: Vec<ParameterId>,
    /// Parameters that can be written and that the file does not have.
    pub absent: Vec<(ParameterId, String)>,
    /// The device takes parameters and reports none ([`DriveError::takes_writes_only`]): all that can be written is, and
    /// nothing is read back.
    pub unseen: bool,
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for change in &self.changes {
            writeln!(f, "{change}")?;
        }
        for change in &self.read_only {
            writeln!(f, "{change}: left as it is, read-only")?;
        }
        for change in &self.of_the_line {
            writeln!(f, "{change}: left as it is, the line depends on it")?;
        }
        write!(f, "{} to change, {} as they are", self.changes.len(), self.same)?;
        match self.absent.as_slice() {
            [] => Ok(()),
            [(id, name)] => write!(f, "\n{id} ({name}) is not in the file: left as it is"),
            [(id, name), ..] => {
                let all = self.absent.len();
                write!(
                    f,
                    "\n{all} parameters are not in the file, the first {id} ({name}): left as they are"
                )
            }
        }
    }
}

/// Holds a file against a device and says what it would change. Writes nothing.
///
/// # Errors
/// [`BackupError::Lines`] with every line that the device cannot have: another family, unknown parameters, parameters
/// given twice, impossible values. [`BackupError::List`] or [`BackupError::Drive`] if the device does not answer.
pub fn plan(drive: &mut dyn Drive, backup: &Backup) -> Result<Plan, BackupError> {
    let mut errors = Vec::new();
    let mut error = |line, fault| errors.push(LineError { file: backup.file.clone(), line, fault });
    let expected = drive.identity()?.family;
    let (found, line) = &backup.family;
    if !expected.eq_ignore_ascii_case(found) {
        let (found, expected) = (found.clone(), expected.to_owned());
        error(*line, LineFault::Family { found, expected });
        return Err(BackupError::Lines(errors));
    }
    let known = drive.parameters().map_err(BackupError::List)?;
    let of_file = |info: &&ParameterInfo| backup.entries.iter().any(|entry| entry.id == info.id);
    let (known, absent): (Vec<_>, Vec<_>) = known.iter().partition(of_file);
    let ids: Vec<_> = known.iter().map(|info| info.id).collect();
    let (present, unseen) = match drive.parameter_values(&ids) {
        Ok(values) => (values.into_iter().map(Some).collect(), false),
        Err(error) if error.takes_writes_only() => (vec![None; ids.len()], true),
        Err(error) => return Err(error.into()),
    };
    let written = |info: &&&ParameterInfo| info.writable && !info.of_the_line;
    let absent = absent.into_iter().filter(|info| info.writable);
    let mut plan = Plan {
        kept: known.iter().filter(written).map(|info| info.id).collect(),
        absent: absent.map(|info| (info.id, info.name.clone())).collect(),
        unseen,
        ..Plan::default()
    };
    for (place, entry) in backup.entries.iter().enumerate() {
        let id = entry.id;
        let described = known.iter().zip(&present).find(|(info, _)| info.id == id);
        let Some((info, from)) = described.map(|(info, from)| (*info, *from)) else {
            error(entry.line, LineFault::NoParameter { id });
            continue;
        };
        if let Some(first) = backup.entries.iter().take(place).find(|before| before.id == id) {
            error(entry.line, LineFault::Twice { id, first: first.line });
            continue;
        }
        if from == Some(entry.value) {
            plan.same += 1;
        } else if from.is_none() && !info.writable {
            // What it measures itself is not missed.
        } else if info.writable && !info.values.contain(entry.value) {
            let (name, values) = (info.name.clone(), info.values.clone());
            error(entry.line, LineFault::Value { id, name, value: entry.value, values });
        } else {
            plan.of(info).push(Change {
                line: entry.line,
                id,
                name: info.name.clone(),
                unit: info.unit,
                from,
                to: entry.value,
                needs_restart: info.needs_restart,
            });
        }
    }
    if errors.is_empty() { Ok(plan) } else { Err(BackupError::Lines(errors)) }
}

impl Plan {
    fn of(&mut self, info: &ParameterInfo) -> &mut Vec<Change> {
        if !info.writable {
            &mut self.read_only
        } else if info.of_the_line {
            &mut self.of_the_line
        } else {
            &mut self.changes
        }
    }

    /// Whether the device has everything that can be written.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Whether a change acts after a restart of the device only.
    pub fn needs_restart(&self) -> bool {
        self.changes.iter().any(|change| change.needs_restart)
    }

    /// Number of the file's parameters that the device would lose when it is switched off, as it has them now
    /// ([`Drive::unsaved_parameters`]).
    ///
    /// # Errors
    /// If the device does not answer.
    pub fn unsaved(&self, drive: &mut dyn Drive) -> Result<usize, DriveError> {
        Ok(drive.unsaved_parameters(&self.kept)?.len())
    }

    /// Writes the changes to the device, whose axes are at rest, and reads all of them back; `save` makes it keep them and
    /// what else of the file it has not saved ([`Drive::save_parameters`]), then they are read once more.
    ///
    /// # Errors
    /// See [`RestoreError`]; the first thing that goes wrong ends it.
    pub fn carry_out(&self, drive: &mut dyn Drive, save: bool) -> Result<(), RestoreError> {
        let all = self.changes.len();
        for (written, change) in self.changes.iter().enumerate() {
            let (id, value) = (change.id, change.to);
            drive.set_parameter(id, value).map_err(|source| {
                let (name, source) = (change.name.clone(), Box::new(source));
                RestoreError::Write { id, name, value, written, all, source }
            })?;
        }
        self.verify(drive)?;
        if save && (!self.is_empty() || self.unsaved(drive)? > 0) {
            drive.save_parameters()?;
            self.verify(drive)?;
        }
        Ok(())
    }

    fn verify(&self, drive: &mut dyn Drive) -> Result<(), RestoreError> {
        if self.unseen {
            return Ok(());
        }
        let ids: Vec<_> = self.changes.iter().map(|change| change.id).collect();
        let present = drive.parameter_values(&ids)?;
        for (change, found) in self.changes.iter().zip(present) {
            let (id, value) = (change.id, change.to);
            if found != value {
                let name = change.name.clone();
                return Err(RestoreError::Differs { id, name, value, found });
            }
        }
        Ok(())
    }
}
