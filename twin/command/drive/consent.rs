//! Nothing moves without being asked for.

use crate::command::Failure;
use std::io::{self, BufRead, BufReader, IsTerminal, Write};
use twin_machine::limited_read::LimitedLines;

/// Whether what is asked about may be done: axes moved, parameters written.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(in crate::command) struct Consent {
    /// Say what is going to happen and do it without a question; needed without a terminal
    #[arg(long)]
    yes: bool,
}

/// The same before the action that asks, where it is as good.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Beforehand {
    #[arg(long = "yes", id = "yes_beforehand", hide = true)]
    yes: bool,
}

impl Beforehand {
    /// Whether it was given before the action or with it.
    pub(super) fn or(self, consent: Option<Consent>) -> Consent {
        Consent { yes: self.yes || consent.is_some_and(|consent| consent.yes) }
    }
}

impl Consent {
    /// Whether it was given in advance.
    pub(in crate::command) fn given(self) -> bool {
        self.yes
    }

    /// Says what is going to move where, and asks whether it may.
    pub(in crate::command) fn ask(self, motion: &str) -> Result<(), Failure> {
        self.ask_for(motion, "nothing has moved", "moves")
    }

    /// Says what is going to be written where, and asks whether it may.
    pub(super) fn ask_to_write(self, change: &str) -> Result<(), Failure> {
        self.ask_for(change, "nothing has been written", "writes")
    }

    fn ask_for(self, what: &str, nothing: &str, does: &str) -> Result<(), Failure> {
        let mut terminal = io::stderr();
        if self.yes {
            return writeln!(terminal, "{what}").map_err(Failure::Stdio);
        }
        if !io::stdin().is_terminal() {
            return Err(Failure::Usage(format!(
                "{what}: {nothing}, as there is no terminal to ask at; --yes {does} without asking"
            )));
        }
        write!(terminal, "{what}? [y/N] ").map_err(Failure::Stdio)?;
        terminal.flush().map_err(Failure::Stdio)?;
        let mut answer = String::new();
        let mut terminal = BufReader::new(LimitedLines::new(io::stdin().lock()));
        terminal.read_line(&mut answer).map_err(Failure::Stdio)?;
        if is_yes(&answer) {
            Ok(())
        } else {
            Err(Failure::Usage(format!("not confirmed: {nothing}")))
        }
    }
}

/// Anything but a yes is a no.
fn is_yes(answer: &str) -> bool {
    ["y", "yes"].iter().any(|yes| answer.trim().eq_ignore_ascii_case(yes))
}

#[cfg(test)]
mod tests {
    use super::is_yes;

    #[test]
    fn only_yes_is_yes() {
        assert!(is_yes("y\n") && is_yes("Y") && is_yes(" yes\r\n"));
        assert!(!is_yes("") && !is_yes("\n") && !is_yes("n\n") && !is_yes("yep\n"));
    }
}
