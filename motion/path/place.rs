//! Place in a program: file, line and block number.

use std::fmt;
use std::num::NonZeroU32;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A block of the program: its line in the file and the number of its N word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Line of the program, counted from 1; 0 is the time before the first line. For a block in a subroutine file, the
    /// line of the program that calls it.
    pub line: u32,
    /// The block's N word, if it has one.
    pub block: Option<u32>,
    /// Line of the subroutine file, if the block is in one.
    pub within: Option<FileLine>,
}

/// Line of the program, and of the subroutine file that it calls, if the block is in one; see [`Place::key`].
pub type LineKey = (u32, Option<FileLine>);

/// A line of a subroutine file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileLine {
    /// The file.
    pub file: FilePath,
    /// Its line, counted from 1.
    pub line: u32,
}

/// Path of a subroutine file, as a number that is small enough for every element. Each path is stored once, until the
/// process ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FilePath(NonZeroU32);

/// Paths of all subroutine files that were opened, by their numbers from 1 on.
static PATHS: Mutex<Vec<&'static Path>> = Mutex::new(Vec::new());

fn paths() -> MutexGuard<'static, Vec<&'static Path>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Place {
    /// A line of the program, without N word.
    pub const fn at(line: u32) -> Self {
        Self { line, block: None, within: None }
    }

    /// Line of the file that has the block: a subroutine file or the program.
    pub fn line_in_file(&self) -> u32 {
        self.within.map_or(self.line, |within| within.line)
    }

    /// The subroutine file, if the block is in one.
    pub fn file(&self) -> Option<FilePath> {
        self.within.map(|within| within.file)
    }

    /// Line of the program that calls the subroutine file, if the block is in one.
    pub fn called_from(&self) -> Option<u32> {
        self.within.map(|_| self.line)
    }

    /// The line alone: places of one line have the same.
    pub const fn key(&self) -> LineKey {
        (self.line, self.within)
    }
}

impl FilePath {
    /// Stores `path`.
    pub fn new(path: &Path) -> Self {
        let mut paths = paths();
        let known = paths.iter().position(|known| *known == path);
        let index = known.unwrap_or_else(|| {
            paths.push(Box::leak(path.to_path_buf().into_boxed_path()));
            paths.len() - 1
        });
        let index = u32::try_from(index).unwrap_or(u32::MAX);
        Self(NonZeroU32::MIN.saturating_add(index))
    }

    /// The path.
    pub fn path(self) -> &'static Path {
        let index = usize::try_from(self.0.get() - 1).unwrap_or(usize::MAX);
        paths().get(index).copied().unwrap_or(Path::new(""))
    }
}

/// The name without its folder.
impl fmt::Display for FilePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.path().file_name().unwrap_or_default().to_string_lossy().fmt(f)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(FileLine { file, line }) = self.within {
            write!(f, "{file} ")?;
            Self { line, within: None, ..*self }.fmt(f)?;
            return write!(f, " (called from line {})", self.line);
        }
        match self.block {
            Some(block) => write!(f, "line {} (N{block})", self.line),
            None => write!(f, "line {}", self.line),
        }
    }
}
