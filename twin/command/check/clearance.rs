//! `--clearance` option: output files with the clearances along the program.

use super::{Arguments, Failure};
use crate::check::{BlockClearance, ClearanceCsv, ClearancePicture};
use crate::command::atomic_file;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::program::ProgramFile;
use std::path::{Path, PathBuf};
use twin_machine::{Machine, SimulationError};

/// The files that it is written to.
pub(super) struct ClearanceFiles<'m> {
    tables: Vec<(&'m Path, ClearanceCsv<'m, AtomicFile>)>,
    pictures: Vec<&'m Path>,
    picture: Option<ClearancePicture<'m>>,
    /// What could not be written.
    failure: Option<Failure>,
}

impl<'m> ClearanceFiles<'m> {
    pub(super) fn new(machine: &'m Machine, files: &'m [PathBuf]) -> Result<Self, Failure> {
        let mut found =
            Self { tables: Vec::new(), pictures: Vec::new(), picture: None, failure: None };
        for path in files {
            match Kind::of(path)? {
                Kind::Table => {
                    let table = ClearanceCsv::new(AtomicFile::create(path)?, machine);
                    let table = table.map_err(|error| unwritable(path, error.into()))?;
                    found.tables.push((path, table));
                }
                Kind::Picture => {
                    found.pictures.push(path);
                    found.picture.get_or_insert_with(|| ClearancePicture::new(machine));
                }
            }
        }
        Ok(found)
    }

    /// Takes the next set-point.
    pub(super) fn include(&mut self, now: &BlockClearance) {
        for (path, table) in &mut self.tables {
            if let Err(error) = table.include(now) {
                // The check goes on; the first failure is reported at its end.
                self.failure.get_or_insert(unwritable(path, error.into()));
            }
        }
        if let Some(picture) = &mut self.picture {
            picture.include(now);
        }
    }

    pub(super) fn finish(self, program: &ProgramFile) -> Result<(), Failure> {
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        for (path, table) in self.tables {
            table.finish().map_err(|error| unwritable(path, error.into()))?.finish()?;
        }
        if let Some(picture) = self.picture {
            let text = picture.draw(&program.path().display().to_string());
            for path in self.pictures {
                atomic_file::write(path, text.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// What a file is, by the ending of its name.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Table,
    Picture,
}

impl Kind {
    fn of(path: &Path) -> Result<Self, Failure> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("csv") => Ok(Self::Table),
            Some("svg") => Ok(Self::Picture),
            _ => Err(Failure::Usage(format!(
                "{}: clearance is written as .csv or .svg",
                path.display()
            ))),
        }
    }
}

/// Checks before the program check that there are clearances to write, and that the files can be written.
pub(super) fn check(arguments: &Arguments, machine: &Machine) -> Result<(), Failure> {
    let files = &arguments.clearance;
    if files.is_empty() {
        return Ok(());
    }
    let [program] = &arguments.programs[..] else {
        return Err(Failure::Usage(format!(
            "--clearance is of one program, and {} are given: check them one by one",
            arguments.programs.len()
        )));
    };
    for path in files {
        Kind::of(path)?;
    }
    let scan = machine.clearance_scan();
    if scan.map_err(|error| SimulationError::of(machine, error))?.is_none() {
        return Err(Failure::Usage(format!(
            "--clearance: {} has no obstacles: describe them in [[obstacles]] and [collision], as machines/gantry3_vice.toml does",
            machine.path.display()
        )));
    }
    let read = [arguments.machine.path()].into_iter().chain(arguments.read.variables_file());
    let read = read.chain(arguments.simulation.faults_file()).chain(arguments.scene.file());
    let targets = files.iter().map(|path| ("--clearance", path.as_path()));
    atomic_file::check_targets(Some(program), read, targets)
}
