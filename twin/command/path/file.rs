//! Output target: standard output, a file, or a folder of files.

use super::Format;
use crate::command::Failure;
use crate::command::atomic_file::{AtomicFile, unwritable};
use std::fs;
use std::io::{self, BufWriter, Seek, Stdout, Write};
use std::path::{Path, PathBuf};
use tempfile::SpooledTempFile;

/// Output target.
#[derive(Debug)]
pub(super) enum Target {
    Stdout,
    File(PathBuf),
    Folder(PathBuf),
}

impl Target {
    /// `output`, which is a folder if there may be several files.
    pub(super) fn new(output: Option<&Path>, several: bool) -> Result<Self, Failure> {
        match (output, several) {
            (None, false) => Ok(Self::Stdout),
            (None, true) => Err(Failure::Usage(
                "--one-per layer and --one-per section make several files: give --output FOLDER"
                    .to_owned(),
            )),
            (Some(path), false) => Ok(Self::File(path.to_owned())),
            (Some(path), true) => {
                fs::create_dir_all(path).map_err(|source| unwritable(path, source))?;
                Ok(Self::Folder(path.to_owned()))
            }
        }
    }

    pub(super) fn is_stdout(&self) -> bool {
        matches!(self, Self::Stdout)
    }

    /// Begins the file of program `number`, `name`.
    pub(super) fn open(&self, number: u32, name: &str, format: Format) -> Result<File, Failure> {
        let path = match self {
            Self::Stdout if matches!(format, Format::Din66025 | Format::Rs274 | Format::Dxf) => {
                return Ok(File::Held(SpooledTempFile::new(HELD)));
            }
            Self::Stdout => {
                return Ok(File::Stdout(BufWriter::new(io::stdout())));
            }
            Self::File(path) => path.clone(),
            Self::Folder(folder) => {
                let plain = |letter: char| {
                    if letter.is_alphanumeric() || matches!(letter, '-' | '_') {
                        letter
                    } else {
                        '_'
                    }
                };
                let name: String = name.chars().take(60).map(plain).collect();
                folder.join(format!("{number:03}-{name}.{}", format.ending()))
            }
        };
        Ok(File::Named(AtomicFile::create(&path)?))
    }
}

/// A larger program waits on the disk, bytes.
const HELD: usize = 1 << 24;

/// An output file, renamed to its name on success.
#[derive(Debug)]
pub(super) enum File {
    Stdout(BufWriter<Stdout>),
    /// For standard output, as a whole or not at all.
    Held(SpooledTempFile),
    Named(AtomicFile),
}

impl File {
    /// A failure to write, with the name of what cannot be written.
    pub(super) fn named(&self, failed: Failure) -> Failure {
        match (self, failed) {
            (Self::Named(file), Failure::Stdio(source)) => unwritable(file.name(), source),
            (_, failed) => failed,
        }
    }

    /// Gives the file its name.
    pub(super) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Stdout(mut out) => out.flush().map_err(Failure::Stdio),
            Self::Held(mut held) => {
                held.rewind().map_err(Failure::Stdio)?;
                let mut out = io::stdout().lock();
                io::copy(&mut held, &mut out).map_err(Failure::Stdio)?;
                out.flush().map_err(Failure::Stdio)
            }
            Self::Named(file) => file.finish(),
        }
    }
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Stdout(out) => out.write(bytes),
            Self::Held(held) => held.write(bytes),
            Self::Named(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Stdout(out) => out.flush(),
            Self::Held(held) => held.flush(),
            Self::Named(file) => file.flush(),
        }
    }
}
