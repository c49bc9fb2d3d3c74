//! Viewer of the running lines of a program (`SMC_GCodeViewer`, manual 6.2.2).

use std::collections::VecDeque;

/// The blocks whose objects are on their way through the look-ahead, the one that is running first.
///
/// Every block that is decoded goes in ([`Self::push`]); the line that the interpolator works on
/// (`iActObjectSourceNo`) is set by [`Self::run`], and those before it are forgotten. So it must have room for all
/// blocks between decoder and interpolator. (`SMC_GCV_BUFFER_WRONG_TYPE`, 1301, cannot happen here: the buffer is its
/// own.)
#[derive(Clone, Debug)]
pub struct GCodeViewer {
    entries: VecDeque<(u32, String)>,
    capacity: usize,
}

/// Error of a viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ViewerError {
    /// More blocks are under way than there is room for (`SMC_GCV_BUFFER_TOO_SMALL`, 1300). The oldest is forgotten.
    #[error("the viewer has room for {0} blocks, and more are under way")]
    BufferTooSmall(usize),
    /// The running line is none of those under way (`SMC_GCV_UNKNOWN_IPO_LINE`, 1302).
    #[error("line {0} is running, but is not among the blocks under way")]
    UnknownLine(u32),
}

impl GCodeViewer {
    /// A viewer with room for `capacity` blocks, at least one.
    pub fn new(capacity: usize) -> Self {
        Self { entries: VecDeque::new(), capacity: capacity.max(1) }
    }

    /// Takes the block of a line that has been decoded, as [`shown_block`] gives it. A block that is run again comes
    /// again.
    ///
    /// # Errors
    /// [`ViewerError::BufferTooSmall`]; the block has been taken nevertheless.
    pub fn push(&mut self, line: u32, block: String) -> Result<(), ViewerError> {
        let full = self.entries.len() >= self.capacity;
        if full {
            self.entries.pop_front();
        }
        self.entries.push_back((line, block));
        if full { Err(ViewerError::BufferTooSmall(self.capacity)) } else { Ok(()) }
    }

    /// The block of `line` is running now: the first of that line which has not been passed.
    ///
    /// # Errors
    /// [`ViewerError::UnknownLine`]; nothing is forgotten then.
    pub fn run(&mut self, line: u32) -> Result<(), ViewerError> {
        let found = self.entries.iter().position(|(number, _)| *number == line);
        let passed = found.ok_or(ViewerError::UnknownLine(line))?;
        self.entries.drain(..passed);
        Ok(())
    }

    /// Line numbers and texts, the running one first (`asGCode`).
    pub fn lines(&self) -> impl Iterator<Item = (u32, &str)> {
        self.entries.iter().map(|(line, text)| (*line, text.as_str()))
    }
}

/// A line of a program as the viewer shows it: without comments, with one blank between words, and with the numbers
/// that `value` gives in place of `$name$` (a name it does not know stays). None if there is nothing in it.
pub fn shown_block(line: &str, value: impl Fn(&str) -> Option<f64>) -> Option<String> {
    let mut text = String::with_capacity(line.len());
    let mut rest = line;
    loop {
        let (before, from) = rest.split_at(rest.find(['(', ';', '$']).unwrap_or(rest.len()));
        text.push_str(before);
        rest = match from.as_bytes().first() {
            Some(b'(') => from.split_once(')').map_or("", |(_, behind)| behind),
            Some(b';') => "",
            _ => {
                let name = from.get(1..).and_then(|name| name.split_once('$'));
                let Some((name, behind)) = name else {
                    text.push_str(from);
                    break;
                };
                match value(name.trim()) {
                    Some(value) => text.push_str(&value.to_string()),
                    None => text.extend(["$", name, "$"]),
                }
                behind
            }
        };
        if rest.is_empty() {
            break;
        }
    }
    let words: Vec<_> = text.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}
