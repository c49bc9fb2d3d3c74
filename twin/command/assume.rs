//! `--assume` option: assumptions about drives where their manuals leave something open.

use super::{Failure, show};
use clap::builder::{StringValueParser, TypedValueParser};
use clap::error::ErrorKind;
use comfy_table::ContentArrangement;
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
    /// The default assumptions of a family, changed by the given ones.
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
            "smartdrive" => list::<twin_smartdrive::Assumptions>(),
            "bim2ax" => list::<twin_bim2ax::Assumptions>(),
            _ => list::<twin_interpcnc::Assumptions>(),
        };
        Err(clap::Error::raw(ErrorKind::DisplayHelp, format!("{list}\n")))
    }
}

/// Columns of a list that is read on a terminal, or printed.
const WIDTH: u16 = 100;

/// What can be assumed about a family.
fn list<A: Assumed>() -> String {
    let mut table = show::table();
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table.set_header(["name", "it can be", "assumed", "question of the manual"]);
    for name in A::NAMES {
        let (Some(values), Some(question)) = (A::values(name), A::question(name)) else {
            continue;
        };
        let unit = values.unit;
        let with_unit = |text: String| {
            if unit.is_empty() { text } else { format!("{text} {unit}") }
        };
        table.add_row([
            (*name).to_owned(),
            with_unit(values.allowed),
            with_unit(values.usual),
            question.question.to_owned(),
        ]);
    }
    table.to_string()
}

#[cfg(test)]
mod tests {
    use super::list;

    /// What is listed can be said: no names of the program's own, and numbers with their units.
    #[test]
    fn what_is_assumed_is_listed_as_it_is_said() {
        let flat = |table: String| table.split_whitespace().collect::<Vec<_>>().join(" ");
        let board = flat(list::<twin_interpcnc::Assumptions>());
        for said in
            ["raw or hundreds or index raw", "0 to 10000000000 ns 5000000 ns", "none or 1 to"]
        {
            assert!(board.contains(said), "{said}: {board}");
        }
        let drives = flat(list::<twin_smartdrive::Assumptions>());
        assert!(drives.contains("is-offset or goes-offset is-offset"), "{drives}");
        let module = flat(list::<twin_bim2ax::Assumptions>());
        assert!(module.contains("edge-taken or far-edge edge-taken"), "{module}");
        for debug in ["AtOnce", "IsOffset", "EdgeTaken", "None"] {
            assert!(![&board, &drives, &module].iter().any(|list| list.contains(debug)), "{debug}");
        }
    }
}
