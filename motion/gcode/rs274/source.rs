//! Lines of a program and of its subroutine files, from any of them on.
//!
//! The program is read once, line by line. Lines that may be executed again (of loops, of subroutines) are kept, and
//! nothing else is, so that memory does not grow with the length of a program without them.

use super::decoder::MAX_LINE_BYTES;
use crate::lines;
use std::fs;
use std::io::{self, BufRead};
use std::path::PathBuf;
use twin_path::{FileLine, FilePath};

/// The largest subroutine file that is read, bytes.
const MAX_FILE_BYTES: u64 = 1 << 24;

/// Number of a subroutine file, from 0 on.
pub(super) type FileNumber = usize;

/// A place between two lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Spot {
    /// None in the program itself.
    pub(super) file: Option<FileNumber>,
    /// Lines before it.
    pub(super) line: u32,
}

impl Spot {
    /// The place behind the next line, whose number `line` is then.
    pub(super) fn behind(self) -> Self {
        Self { line: self.line.saturating_add(1), ..self }
    }
}

/// Lines in a row.
#[derive(Debug, Default)]
struct Lines {
    text: Vec<u8>,
    /// Where each line ends in `text`.
    ends: Vec<usize>,
    /// Lines before the first of them.
    before: u32,
}

impl Lines {
    fn get(&self, line: u32) -> Option<&[u8]> {
        let index = usize::try_from(line.checked_sub(self.before)?).ok()?;
        let start = match index.checked_sub(1) {
            Some(previous) => *self.ends.get(previous)?,
            None => 0,
        };
        self.text.get(start..*self.ends.get(index)?)
    }

    fn push(&mut self, line: &[u8]) {
        self.text.extend_from_slice(line);
        self.ends.push(self.text.len());
    }

    fn clear(&mut self, before: u32) {
        self.text.clear();
        self.ends.clear();
        self.before = before;
    }
}

/// A file with subroutines.
#[derive(Debug)]
struct File {
    path: FilePath,
    lines: Lines,
}

/// Reading of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// The line was read.
    Line,
    /// The line is longer than [`MAX_LINE_BYTES`] and was left out.
    TooLong,
    /// The file has no more lines.
    End,
}

/// A program and its subroutine files.
#[derive(Debug)]
pub(super) struct Source<R> {
    pub(super) reader: R,
    /// Folders of subroutine files, in the order of search.
    folders: Vec<PathBuf>,
    kept: Lines,
    /// Lines read from `reader`.
    read: u32,
    files: Vec<File>,
}

impl<R: BufRead> Source<R> {
    pub(super) fn new(reader: R, folders: Vec<PathBuf>) -> Self {
        Self { reader, folders, kept: Lines::default(), read: 0, files: Vec::new() }
    }

    /// Lines of the program read so far.
    pub(super) fn lines(&self) -> u32 {
        self.read
    }

    /// Bytes of the lines that are kept.
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.kept.text.capacity() + self.kept.ends.capacity()
    }

    /// Reads the line behind `spot` into `line`. Keeps lines of the program that come from its reader if `keep`.
    pub(super) fn read(
        &mut self,
        spot: Spot,
        keep: bool,
        line: &mut Vec<u8>,
    ) -> io::Result<Reading> {
        line.clear();
        let kept = match spot.file {
            Some(file) => self.files.get(file).map(|file| &file.lines),
            None => Some(&self.kept),
        };
        if let Some(text) = kept.and_then(|lines| lines.get(spot.line)) {
            line.extend_from_slice(text);
            return Ok(Reading::Line);
        }
        if spot.file.is_some() {
            return Ok(Reading::End);
        }
        if !keep && !self.kept.ends.is_empty() {
            self.kept.clear(self.read);
        }
        if lines::read_line(&mut self.reader, MAX_LINE_BYTES, line)?.is_none() {
            return Ok(Reading::End);
        }
        let is_long = line.len() > MAX_LINE_BYTES;
        if is_long {
            line.clear();
        }
        if keep {
            if self.kept.ends.is_empty() {
                self.kept.clear(self.read);
            }
            self.kept.push(line);
        }
        self.read = self.read.saturating_add(1);
        Ok(if is_long { Reading::TooLong } else { Reading::Line })
    }

    /// Keeps `line`, the one behind `at` and the last that was read.
    pub(super) fn keep(&mut self, at: Spot, line: &[u8]) {
        if at.file.is_some() || self.kept.get(at.line).is_some() {
            return;
        }
        self.kept.clear(at.line);
        self.kept.push(line);
    }

    /// Opens the file of a subroutine called `name`; none if no folder has it.
    ///
    /// # Errors
    /// If it is there and cannot be read.
    pub(super) fn open(&mut self, name: &str) -> io::Result<Option<FileNumber>> {
        // A name is not a way to other folders.
        if name.is_empty() || name.contains(['/', '\\', '\0']) {
            return Ok(None);
        }
        let paths = self.folders.iter().map(|folder| folder.join(format!("{name}.ngc")));
        let Some(path) = paths.into_iter().find(|path| path.is_file()) else { return Ok(None) };
        if let Some(open) = self.files.iter().position(|file| file.path.path() == path) {
            return Ok(Some(open));
        }
        let text = lines::read_file(fs::File::open(&path)?, MAX_FILE_BYTES)?;
        if text.len() as u64 > MAX_FILE_BYTES {
            let message = format!("more than {MAX_FILE_BYTES} bytes");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
        }
        let mut lines = Lines::default();
        lines::lines(&text).for_each(|line| lines.push(line));
        self.files.push(File { path: FilePath::new(&path), lines });
        Ok(Some(self.files.len() - 1))
    }

    /// The line before `spot`, if it is in a subroutine file.
    pub(super) fn line_of(&self, spot: Spot) -> Option<FileLine> {
        let file = self.files.get(spot.file?)?.path;
        Some(FileLine { file, line: spot.line })
    }
}
