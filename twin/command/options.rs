//! Options that several commands share.

use super::Failure;
use crate::machine::Machine;
use crate::program::{Dialect, ProgramFile};
use std::path::{Path, PathBuf};

/// The machine.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct MachineOption {
    /// Machine file (TOML); machines/*.toml are commented examples
    #[arg(long, short, value_name = "FILE")]
    pub(super) machine: PathBuf,
}

impl MachineOption {
    pub(super) fn load(&self) -> Result<Machine, Failure> {
        Ok(Machine::load(&self.machine)?)
    }
}

/// How the program is read.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct ReadOptions {
    /// Language of the program [default: by its ending and first lines; the choice is printed]
    #[arg(long, value_enum)]
    pub(super) dialect: Option<Dialect>,

    /// Leave out blocks that begin with `/`
    #[arg(long)]
    pub(super) skip_suppressed: bool,
}

impl ReadOptions {
    pub(super) fn program(self, path: &Path) -> Result<ProgramFile, Failure> {
        let dialect = match self.dialect {
            Some(dialect) => Some(dialect),
            None => Dialect::guess(path).map_err(|source| unreadable(path, source))?,
        };
        Ok(ProgramFile::new(path, dialect, self.skip_suppressed)?)
    }
}

/// The failure to read a program.
pub(super) fn unreadable(path: &Path, source: std::io::Error) -> Failure {
    Failure::Program { path: path.display().to_string(), source }
}
