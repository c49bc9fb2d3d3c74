//! Profile output files of `twin limit`.

use super::Failure;
use crate::command::atomic_file;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::limit::{Limits, Picture, ProfileCsv, ProfileSample};
use crate::program::ProgramFile;
use std::path::{Path, PathBuf};
use twin_machine::Machine;

/// The files a profile is written to.
#[derive(Default)]
pub(super) struct Outputs<'m> {
    tables: Vec<(&'m Path, ProfileCsv<'m, AtomicFile>)>,
    pictures: Vec<&'m Path>,
    picture: Option<Picture<'m>>,
}

impl<'m> Outputs<'m> {
    pub(super) fn new(machine: &'m Machine, files: &'m [PathBuf]) -> Result<Self, Failure> {
        let efforts = machine.path_dynamics().is_ok_and(|dynamics| dynamics.is_some());
        let mut outputs = Self { tables: Vec::new(), pictures: Vec::new(), picture: None };
        for path in files {
            let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
            match ending.as_deref() {
                Some("csv") => {
                    let file = AtomicFile::create(path)?;
                    let table = ProfileCsv::new(file, &machine.axes, efforts);
                    outputs
                        .tables
                        .push((path, table.map_err(|error| unwritable(path, error.into()))?));
                }
                Some("svg") => {
                    outputs.pictures.push(path);
                    outputs.picture.get_or_insert_with(|| Picture::new(&machine.axes, efforts));
                }
                _ => {
                    return Err(Failure::Usage(format!(
                        "{}: profiles are written as .csv or .svg",
                        path.display()
                    )));
                }
            }
        }
        Ok(outputs)
    }

    /// True if nothing is written.
    pub(super) fn is_empty(&self) -> bool {
        self.tables.is_empty() && self.pictures.is_empty()
    }

    pub(super) fn include(&mut self, sample: &ProfileSample) -> Result<(), Failure> {
        for (path, table) in &mut self.tables {
            table.write(sample).map_err(|error| unwritable(path, error.into()))?;
        }
        if let Some(picture) = &mut self.picture {
            picture.include(sample);
        }
        Ok(())
    }

    pub(super) fn finish(
        self,
        program: &ProgramFile,
        machine: &Machine,
        limits: Limits,
    ) -> Result<(), Failure> {
        for (path, table) in self.tables {
            table.finish().map_err(|source| unwritable(path, source))?.finish()?;
        }
        if let Some(picture) = self.picture {
            let name = program.path().display().to_string();
            let machine = match limits {
                Limits::Axes => machine.name.clone(),
                Limits::Programmed => format!("{} as its controller plans it", machine.name),
            };
            let text = picture.draw(&name, &machine);
            for path in self.pictures {
                atomic_file::write(path, text.as_bytes())?;
            }
        }
        Ok(())
    }
}
