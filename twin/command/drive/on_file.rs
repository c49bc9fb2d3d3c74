//! Parameters of a device on file, and back.

use super::consent::Consent;
use crate::command::Failure;
use crate::command::atomic_file::{AtomicFile, refuse_existing};
use std::path::{Path, PathBuf};
use twin_drives::Drive;
use twin_drives::backup::{BackupError, plan, read, write_parameters};
use twin_machine::text::Text;

/// What is done with a file of parameters.
#[derive(Clone, Debug, clap::Subcommand)]
pub(super) enum OnFile {
    /// Write all parameters to a text file; changes nothing
    Backup {
        /// The file
        file: PathBuf,

        /// Replace a file that is there already
        #[arg(long)]
        force: bool,
    },
    /// Give the drive the parameters of a file, after showing what differs (asks first); its axes must be at rest
    Restore {
        /// The file
        file: PathBuf,

        #[command(flatten)]
        consent: Consent,

        /// Make the drive keep them when it is switched off; a SmartDRIVE's position becomes 0
        #[arg(long)]
        save: bool,
    },
}

impl OnFile {
    /// Whether it was given with it.
    pub(super) fn consent(&self) -> Option<Consent> {
        match self {
            Self::Backup { .. } => None,
            Self::Restore { consent, .. } => Some(*consent),
        }
    }

    /// Does it.
    pub(super) fn carry_out(&self, drive: &mut dyn Drive, consent: Consent) -> Result<(), Failure> {
        match self {
            Self::Backup { file, force } => {
                // Before the device is asked hundreds of questions.
                // A backup is what is left of a device that has failed.
                refuse_existing(file, *force)?;
                refuse_xml(file)?;
                backup(drive, file)
            }
            Self::Restore { file, save, .. } => restore(drive, (file, *save), consent),
        }
    }
}

/// Text under a name of XML would mislead whoever reads it.
fn refuse_xml(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("xml")) {
        let text = path.with_extension("txt");
        let (path, text) = (path.display(), text.display());
        return Err(Failure::Usage(format!("{path}: a backup is text, not XML; name it {text}")));
    }
    Ok(())
}

fn backup(drive: &mut dyn Drive, path: &Path) -> Result<(), Failure> {
    let mut file = AtomicFile::create(path)?;
    let name = path.display().to_string();
    let count = write_parameters(drive, &name, &mut file)?;
    file.finish()?;
    say!("{count} parameters of {} are in {name}", drive.describe());
    Ok(())
}

fn restore(
    drive: &mut dyn Drive,
    (path, save): (&Path, bool),
    consent: Consent,
) -> Result<(), Failure> {
    let name = path.display().to_string();
    let mut file =
        Text::open(path).map_err(|source| BackupError::Read { file: name.clone(), source })?;
    let plan = plan(drive, &read(&name, &mut file)?)?;
    say!("{plan}");
    if plan.is_empty() {
        let unsaved = if save { plan.unsaved(drive)? } else { 0 };
        if unsaved > 0 {
            consent.ask_to_write(&format!(
                "save the parameters, of which the drive has not saved {unsaved}"
            ))?;
            plan.carry_out(drive, save)?;
            say!("saved, and read back");
        } else if save {
            say!("the drive keeps all of them already");
        }
        return Ok(());
    }
    consent.ask_to_write(&format!("write {} parameters of {name}", plan.changes.len()))?;
    plan.carry_out(drive, save)?;
    if plan.unseen {
        say!("written: `reset` makes the module read and report them");
        return Ok(());
    }
    say!("{}, and read back", if save { "written, saved" } else { "written" });
    if plan.needs_restart() {
        say!("some act after a restart of the drive");
    }
    Ok(())
}
