//! `--assume`: what a manual leaves open, answered on the command line.

use super::{Failure, show};
use clap::builder::{StringValueParser, TypedValueParser};
use clap::error::ErrorKind;
use std::ffi::OsStr;
use twin_drives::Assumed;

/// Assumptions that are not the usual ones.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct Assume {
    /// What is assumed where the manual is silent, may be given several times; `--assume help` lists what there is, what it
    /// means and what it can be
    #[arg(long, value_name = "NAME=VALUE", value_parser = Said)]
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
}

/// Reads `NAME=VALUE` and leaves it to the family of the command. Of `help` it makes the list of the family: nothing else has to be
/// said then, where the device is neither.
#[derive(Clone, Copy, Debug)]
struct Said;

impl TypedValueParser for Said {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        let said = StringValueParser::new().parse_ref(command, argument, value)?;
        if said != "help" {
            return Ok(said);
        }
        let list = match command.get_name() {
            "smartdrive" => list::<twin_drives::smartdrive::Assumptions>(),
            "bim2ax" => list::<twin_drives::bim2ax::Assumptions>(),
            _ => list::<twin_drives::interpcnc::Assumptions>(),
        };
        Err(clap::Error::raw(ErrorKind::DisplayHelp, format!("{list}\n")))
    }
}

/// What can be assumed about a family.
fn list<A: Assumed>() -> String {
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
    table.to_string()
}
