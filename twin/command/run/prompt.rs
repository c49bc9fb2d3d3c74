//! Acknowledgement of M functions by the user.

use crate::session::Answer;
use std::io::{self, BufRead, IsTerminal};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

/// The lines of standard input, of which only the ends count.
#[derive(Debug, Default)]
pub(super) struct Prompt {
    /// None before the first question: what is piped in is read only if somebody asks.
    lines: Option<Receiver<()>>,
}

impl Prompt {
    /// Starts reading an answer; discards what was typed at a terminal before the question.
    ///
    /// # Errors
    /// If no thread can be had.
    pub(super) fn ask(&mut self) -> io::Result<()> {
        if let Some(lines) = &self.lines {
            while io::stdin().is_terminal() && lines.try_recv().is_ok() {}
            return Ok(());
        }
        let (sender, lines) = sync_channel(0);
        // It ends with the process: nothing can wake it while it waits for a line.
        std::thread::Builder::new().name("prompt".to_owned()).spawn(move || {
            let mut lines = io::stdin().lock();
            while matches!(lines.skip_until(b'\n'), Ok(1..)) && sender.send(()).is_ok() {}
        })?;
        self.lines = Some(lines);
        Ok(())
    }

    /// The answer since the question, if any.
    pub(super) fn answer(&self) -> Answer {
        match self.lines.as_ref().map(Receiver::try_recv) {
            Some(Ok(())) => Answer::Done,
            Some(Err(TryRecvError::Empty)) => Answer::NotYet,
            Some(Err(TryRecvError::Disconnected)) | None => Answer::Nobody,
        }
    }
}
