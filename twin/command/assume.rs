//! `--assume`: what a manual leaves open, answered on the command line.

use super::{Failure, show};
use std::io::{self, Write};
use twin_drives::Assumed;

/// Assumptions that are not the usual ones.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct Assume {
    /// What is assumed where the manual is silent, may be given several times; `--assume help` lists what there is, what it
    /// means and what it can be
    #[arg(long, value_name = "NAME=VALUE")]
    assume: Vec<String>,
}

impl Assume {
    /// The usual assumptions of a family, and what was said.
    ///
    /// # Errors
    /// If there is no such assumption or it cannot be so.
    pub(super) fn take<A: Assumed>(&self) -> Result<A, Failure> {
        let mut assumptions = A::default();
        for said in &self.assume {
            let wrong = |why: String| Failure::Usage(format!("--assume {said}: {why}"));
            let (name, value) = said.split_once('=').ok_or_else(|| {
                wrong("expected NAME=VALUE; `--assume help` lists them".to_owned())
            })?;
            let set = assumptions.set(name.trim(), value.trim());
            set.map_err(|error| wrong(error.to_string()))?;
        }
        Ok(assumptions)
    }

    /// Lists what can be assumed about a family, if that is asked for; true if it was.
    ///
    /// # Errors
    /// If it cannot be printed.
    pub(super) fn helps<A: Assumed>(&self) -> Result<bool, Failure> {
        if !self.assume.iter().any(|said| said == "help") {
            return Ok(false);
        }
        let mut table = show::table();
        table.set_header(["name", "it can be", "assumed", "question of the manual"]);
        for name in A::NAMES {
            let question = A::question(name);
            table.add_row([
                (*name).to_owned(),
                A::allowed(name).unwrap_or_default(),
                question.map_or("", |question| question.default).to_owned(),
                question.map_or("", |question| question.question).to_owned(),
            ]);
        }
        writeln!(io::stdout(), "{table}").map_err(Failure::Stdio)?;
        Ok(true)
    }
}
