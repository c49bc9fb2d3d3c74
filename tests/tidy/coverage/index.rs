//! Index of the manuals' names: `docs/src/manual_names.md`, made from the tables.

use super::table::{Row, State};
use std::collections::BTreeMap;
use std::fmt::Write;

const PAGE: &str = "docs/src/manual_names.md";
const INTRODUCTION: &str = "# Names of the manuals

From a manual's name to its use: the command, the key of a machine file, cam or job, the block of a job or the word of a
program that reaches it. *library* marks what only Rust programs reach, with its path. *left out* and *partly* give the
reason. [Coverage of the manuals](coverage.md) has the totals; the tables are in `tests/coverage`.
";
/// Chapters of SoftMotion that hold no names of their own.
const WITHOUT_NAMES: &str = "Errata";
/// Sections of the drives' manuals in which every row is a register, a command, a bit or a parameter.
const PROSE: [&str; 8] =
    ["Link", "Launching", "Lock", "Recipes", "Errors", "Errata", "Motion", "Handshakes"];

/// The page and its text.
pub(super) fn made(rows: &[Row]) -> (&'static str, String) {
    let mut text = INTRODUCTION.to_owned();
    let is_softmotion = |row: &&Row| {
        row.manual.starts_with("SoftMotion") && !row.chapter.starts_with(WITHOUT_NAMES)
    };
    words(&mut text, rows);
    let mut groups: [(&str, BTreeMap<String, Vec<&Row>>); 4] = [
        "MC blocks and types",
        "SMC blocks and types",
        "Variables, inputs and parameters",
        "Errors",
    ]
    .map(|heading| (heading, BTreeMap::new()));
    for row in rows.iter().filter(is_softmotion).filter(|row| !is_word(row)) {
        for name in names(row) {
            let [mc, smc, variables, errors] = &mut groups;
            let (_, group) = match name {
                _ if row.section == "SMC_Error" => errors,
                _ if name.starts_with("MC_") => mc,
                _ if name.starts_with("SMC_") => smc,
                _ => variables,
            };
            group.entry(name.to_owned()).or_default().push(row);
        }
    }
    for (heading, mut group) in groups {
        for (name, rows) in &mut group {
            // Rows that begin with the name say more than those that mention it.
            if rows.iter().any(|row| row.names().contains(&name.as_str())) {
                rows.retain(|row| row.names().contains(&name.as_str()));
            }
        }
        write!(text, "\n## {heading}\n\n| name | manual | use |\n|---|---|---|\n")
            .unwrap_or_default();
        let mut group: Vec<_> = group.into_iter().collect();
        group.sort_by_key(|(name, _)| name.to_lowercase());
        for (name, rows) in group {
            write!(text, "| `{name}` | ").unwrap_or_default();
            let places = rows.iter().map(|row| row.place.as_str()).collect();
            let uses: Vec<String> = rows.iter().flat_map(|row| uses(row)).collect();
            let uses = without_repetition(uses);
            writeln!(text, "{} | {} |", without_repetition(places).join("; "), uses.join(", "))
                .unwrap_or_default();
        }
    }
    drives(&mut text, rows);
    (PAGE, text)
}

/// G words and letters: programs hold them.
fn words(text: &mut String, rows: &[Row]) {
    text.push_str(
        "\n## G words and letters\n\n`twin check`, `run`, `path` and `limit` read them in programs of the dialect `din66025`.\n\n| word | meaning |\n|---|---|\n",
    );
    let mut words: Vec<&Row> = rows.iter().filter(|row| is_word(row)).collect();
    words.sort_by_key(|row| {
        let name = row.names().first().copied().unwrap_or_default().to_owned();
        (name.get(..1).map(str::to_owned), name.len(), name)
    });
    for row in words {
        writeln!(text, "| {} |", row.item.replacen("` ", "` | ", 1)).unwrap_or_default();
    }
}

/// Registers, commands, bits and parameters of the drives, in the order of their numbers.
fn drives(text: &mut String, rows: &[Row]) {
    let drives = rows.iter().filter(|row| !row.manual.starts_with("SoftMotion"));
    let named = drives.filter(|row| !PROSE.iter().any(|prose| row.section.starts_with(prose)));
    let (mut manual, mut section) = ("", "");
    for row in named {
        if row.manual != manual {
            manual = &row.manual;
            write!(text, "\n## {manual}\n").unwrap_or_default();
        }
        if row.section != section {
            section = &row.section;
            write!(
                text,
                "\n### {section}\n\n| register, command, bit or parameter | use |\n|---|---|\n"
            )
            .unwrap_or_default();
        }
        writeln!(text, "| {} | {} |", row.item, uses(row).join(", ")).unwrap_or_default();
    }
}

/// True for the rows of G words and letters.
fn is_word(row: &Row) -> bool {
    let name = row.names().first().copied().unwrap_or_default();
    ["G words", "Letters"].contains(&row.section.as_str())
        && row.reach.iter().any(|reach| reach == name)
}

/// The names that a row explains: those it begins with, and blocks and types it mentions.
fn names(row: &Row) -> Vec<&str> {
    let mut names = row.names();
    let spans = row.item.split('`').skip(1).step_by(2);
    if row.section != "SMC_Error" {
        names.extend(spans.filter(|name| name.starts_with("MC_") || name.starts_with("SMC_")));
    }
    names.retain(|name| name.chars().all(|c| c.is_ascii_alphanumeric() || "_<>[]–".contains(c)));
    names.sort_unstable();
    names.dedup();
    names
}

/// The uses of a statement.
fn uses(row: &Row) -> Vec<String> {
    let reach = row.reach.iter().map(|reach| one(reach));
    match row.state {
        State::Works => reach.collect(),
        State::Library => reach.map(|reach| format!("*library* {reach}")).collect(),
        State::Partly => {
            vec![format!("*partly* {}: {}", reach.collect::<Vec<_>>().join(", "), row.note)]
        }
        State::LeftOut => vec![format!("*left out*: {}", row.note)],
    }
}

/// Each text once, where it comes first.
fn without_repetition<T: PartialEq>(texts: Vec<T>) -> Vec<T> {
    let mut once = Vec::new();
    for text in texts {
        if !once.contains(&text) {
            once.push(text);
        }
    }
    once
}

fn one(reach: &str) -> String {
    let kind = match reach {
        _ if reach.starts_with("twin ") || reach.contains("::") => "",
        _ if reach.starts_with('[') || reach.ends_with(" =") => "key ",
        _ if reach.starts_with("MC_") || reach.starts_with("SMC_") => "job block ",
        _ => "word ",
    };
    format!("{kind}`{reach}`")
}

#[cfg(test)]
mod tests {
    use super::super::table::{fake, read};
    use super::*;
    use crate::tree::fake::tree;

    #[test]
    fn names_lead_to_their_use() {
        let text = fake::table(&[
            "`MC_Halt` brakes,works,MC_Halt,,a,b",
            "`SMC_sgn` sign,library,twin_axis::sgn,,a,b",
            "`dZ` `dX` of `MC_Halt`,left out,,none,,",
            "1 `SMC_E` raised,works,[[axes]] kind; kind =; G1,,a,b",
        ]);
        let text = text
            .replace("M,C,S", "SoftMotion 2.3,C,S")
            .replace("S,1,1 `SMC_E`", "SMC_Error,1,1 `SMC_E`");
        let (_folder, tree) = tree(&[("tests/coverage/m.csv", &text)]);
        let (rows, _) = read(&tree).unwrap();
        let (_, made) = made(&rows);
        for line in [
            "| `MC_Halt` | 1 | job block `MC_Halt` |",
            "| `SMC_sgn` | 1 | *library* `twin_axis::sgn` |",
            "| `dX` | 1 | *left out*: none |\n| `dZ` | 1 | *left out*: none |",
            "## Errors\n\n| name | manual | use |\n|---|---|---|\n| `SMC_E` | 1 | key `[[axes]] kind`, key `kind =`, word `G1` |",
        ] {
            assert!(made.contains(line), "{line}\n{made}");
        }
    }
}
