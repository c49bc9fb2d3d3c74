//! Commands, keys, job blocks, words of programs and library paths that exist, as the sources declare them.

use crate::manifest::Manifest;
use crate::tree::Tree;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use syn::{Attribute, Fields, Item};

const COMMANDS: &str = "twin/command/";
/// Units with which keys end.
const UNITS: [&str; 4] = ["mm", "deg", "s", "ms"];
const RATES: [&str; 4] = ["", "_per_s", "_per_s2", "_per_s3"];

/// Everything that a reach may name.
#[derive(Debug, Default)]
pub(super) struct Reach {
    /// Words of the command line by the file that declares them.
    words: Vec<(String, String)>,
    options: BTreeSet<String>,
    /// Values of options.
    values: BTreeSet<String>,
    /// Blocks that jobs call.
    blocks: BTreeSet<String>,
    /// G words and letters of DIN 66025.
    letters: BTreeSet<String>,
    /// String literals of the readers of machine files, cams and jobs.
    literals: BTreeSet<String>,
    /// Public items by crate.
    items: BTreeMap<String, BTreeSet<String>>,
}

/// True for a path into a crate.
pub(super) fn is_library(reach: &str) -> bool {
    reach.contains("::")
}

impl Reach {
    pub(super) fn of(tree: &Tree) -> io::Result<Self> {
        let mut known = Self::default();
        for file in tree.with_extension("rs").filter(|file| !is_test(file)) {
            let text = tree.read(file)?;
            if file.starts_with(COMMANDS) {
                known.command_line(file, &text)?;
            }
            if file.starts_with("twin/") && text.contains("Section") {
                known.literals.extend(literals(&text).map(str::to_owned));
            }
            if file.starts_with("twin/") && text.contains("const BLOCKS: [(&str") {
                let table = between(&text, "const BLOCKS: [(&str", "];");
                known.blocks.extend(literals(table).map(str::to_owned));
            }
            if file.ends_with("din66025/word.rs") {
                known.words_of_programs(&text);
            }
        }
        let (_, members) = Manifest::workspace(tree)?;
        for member in members {
            let name = member.package().replace('-', "_");
            let inside = format!("{}/", member.folder);
            let items = known.items.entry(name).or_default();
            for file in tree.with_extension("rs").filter(|file| file.starts_with(&inside)) {
                items.extend(tree.read(file)?.lines().filter_map(public).map(str::to_owned));
            }
        }
        Ok(known)
    }

    /// Subcommands, options and their values.
    fn command_line(&mut self, file: &str, text: &str) -> io::Result<()> {
        let parsed =
            syn::parse_file(text).map_err(|error| io::Error::other(format!("{file}: {error}")))?;
        for item in parsed.items {
            match item {
                Item::Enum(item) => {
                    let names = item.variants.iter().map(|one| kebab(&one.ident.to_string()));
                    if derives(&item.attrs, "Subcommand") {
                        self.words.extend(names.map(|name| (file.to_owned(), name)));
                    } else if derives(&item.attrs, "ValueEnum") {
                        self.values.extend(names);
                    }
                    item.variants.iter().for_each(|variant| self.fields(&variant.fields));
                }
                Item::Struct(item) => self.fields(&item.fields),
                // A macro that makes the subcommands of a list `Name(Type)`.
                Item::Macro(item) => {
                    let tokens = item.mac.tokens.to_string();
                    let names = tokens.match_indices('(').filter_map(|(at, _)| {
                        let before = tokens.get(..at)?.trim_end();
                        before.rsplit(|c: char| !c.is_ascii_alphanumeric()).next()
                    });
                    self.words.extend(names.map(|name| (file.to_owned(), kebab(name))));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn fields(&mut self, fields: &Fields) {
        for field in fields {
            for attribute in field.attrs.iter().filter(|one| one.path().is_ident("arg")) {
                let Ok(list) = attribute.meta.require_list() else { continue };
                let tokens = list.tokens.to_string();
                let long = tokens.split(',').map(str::trim).find(|part| {
                    *part == "long" || part.starts_with("long =") || part.starts_with("long=")
                });
                let Some(long) = long else { continue };
                let given = literals(long).next().map(str::to_owned);
                let own = field.ident.as_ref().map(|name| kebab(&name.to_string()));
                self.options.extend(given.or(own));
            }
        }
    }

    /// Letters and G words that the decoder takes.
    fn words_of_programs(&mut self, text: &str) {
        let letters = between(text, "use Letter::{", "}");
        self.letters.extend(letters.split(", ").map(str::to_owned));
        let commands = between(text, "const COMMANDS", "\n};").lines();
        let numbers =
            commands.filter_map(|line| line.split_once('(')?.1.split_once(',')?.0.parse().ok());
        self.letters.extend(numbers.map(|number: u8| format!("G{number}")));
    }

    /// The part of a reach that does not exist, in words.
    pub(super) fn missing(&self, reach: &str) -> Option<String> {
        let missing = if is_library(reach) {
            self.path(reach)
        } else if let Some(command) = reach.strip_prefix("twin ") {
            self.command(command)
        } else if let Some(key) = reach.strip_suffix(" =") {
            self.key(key)
        } else if reach.starts_with('[') {
            let (table, key) = reach.split_once(' ').unwrap_or((reach, ""));
            let tables = table.trim_matches(['[', ']']).split('.');
            tables.chain([key]).find_map(|key| self.key(key))
        } else if reach.starts_with("MC_") || reach.starts_with("SMC_") {
            (!self.blocks.contains(reach)).then(|| "no job calls this block".to_owned())
        } else {
            (!self.letters.contains(reach)).then(|| "neither a command nor a word".to_owned())
        };
        missing.map(|what| format!("`{reach}`: {what}"))
    }

    fn path(&self, reach: &str) -> Option<String> {
        let (package, items) = reach.split_once("::")?;
        let Some(known) = self.items.get(package) else {
            return Some(format!("there is no crate `{package}`"));
        };
        let missing = items.split("::").find(|item| !known.contains(*item));
        missing.map(|item| format!("nothing public of `{package}` is named `{item}`"))
    }

    fn command(&self, line: &str) -> Option<String> {
        let mut words = line.split_whitespace().peekable();
        let first = words.next().unwrap_or_default();
        let is = |file: &str, name: &str| {
            self.words.iter().any(|(place, word)| word == name && place.starts_with(file))
        };
        if !is("twin/command/mod.rs", first) {
            return Some(format!("there is no command `{first}`"));
        }
        let mut option = false;
        for word in words {
            if let Some(name) = word.strip_prefix("--") {
                option = true;
                if !self.options.contains(name) {
                    return Some(format!("there is no option `{word}`"));
                }
            } else if option && !self.values.contains(word) {
                return Some(format!("no option has the value `{word}`"));
            } else if !option && !is(&format!("{COMMANDS}{first}"), word) {
                return Some(format!("`{first}` has no command `{word}`"));
            }
        }
        None
    }

    /// A key that no reader has; literals hold keys as a whole, without their unit or with `{…}` for it.
    fn key(&self, key: &str) -> Option<String> {
        let units = UNITS.iter().flat_map(|unit| RATES.map(|rate| format!("_{unit}{rate}")));
        let bare = units.filter_map(|unit| key.strip_suffix(&unit).map(str::to_owned));
        let known = self.literals.contains(key)
            || bare.into_iter().any(|key| self.literals.contains(&key))
            || self.literals.iter().any(|literal| fills(literal, key));
        (!known).then(|| format!("no reader knows the key `{key}`"))
    }
}

/// True if `key` is `literal` with something for each `{…}`.
fn fills(literal: &str, key: &str) -> bool {
    let Some((before, rest)) = literal.split_once('{') else { return false };
    let Some((_, behind)) = rest.split_once('}') else { return false };
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    !before.is_empty()
        && literal.chars().all(|c| plain(c) || c == '{' || c == '}')
        && key.strip_prefix(before).is_some_and(|rest| rest.ends_with(behind))
}

fn is_test(file: &str) -> bool {
    file.contains("/tests/") || file.ends_with("tests.rs") || file.starts_with("tests/")
}

fn derives(attributes: &[Attribute], name: &str) -> bool {
    let derived = attributes.iter().filter(|one| one.path().is_ident("derive"));
    let lists = derived.filter_map(|one| one.meta.require_list().ok());
    lists.into_iter().any(|list| list.tokens.to_string().contains(name))
}

/// `TwoWay` and `two_way` as `two-way`.
fn kebab(name: &str) -> String {
    let mut text = String::new();
    for c in name.trim_start_matches("r#").chars() {
        if c.is_ascii_uppercase() && !text.is_empty() {
            text.push('-');
        }
        text.push(if c == '_' { '-' } else { c.to_ascii_lowercase() });
    }
    text
}

/// Texts between quotes, line by line.
fn literals(text: &str) -> impl Iterator<Item = &str> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.flat_map(|line| line.split('"').skip(1).step_by(2))
}

/// The text behind the first `begin`, up to `end`.
fn between<'t>(text: &'t str, begin: &str, end: &str) -> &'t str {
    let behind = text.split_once(begin).map_or("", |(_, behind)| behind);
    behind.split_once(end).map_or("", |(inside, _)| inside)
}

/// The name that a line makes public.
fn public(line: &str) -> Option<&str> {
    let rest = line.trim().strip_prefix("pub ")?;
    let rest = rest.strip_prefix("const fn ").map_or(rest, |name| name);
    let kinds = ["fn ", "struct ", "enum ", "trait ", "type ", "const ", "mod ", "unsafe fn "];
    let name = kinds.iter().find_map(|kind| rest.strip_prefix(kind)).unwrap_or(rest);
    name.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .next()
        .filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::fake;

    #[test]
    fn what_the_sources_declare_is_known_and_nothing_else() {
        let (_folder, tree) = fake::tree(&[
            ("twin/command/mod.rs", "#[derive(Subcommand)]\nenum Command { Check(C), Drive(D) }\n"),
            (
                "twin/command/check.rs",
                "struct C { #[arg(long, value_name = \"F\")] format: F, #[arg(long = \"at\")] events: E, #[arg()] short: S }\n#[derive(clap::ValueEnum)]\nenum F { TwoWay }\n",
            ),
            (
                "twin/command/drive/mod.rs",
                "families! { Board(x::Board), }\n#[derive(Subcommand)]\nenum Action { Home {} }\n",
            ),
            (
                "twin/machine/axis.rs",
                "use Section;\nlet a = (\"axes\", \"physics\", \"kind\", \"position\", format!(\"max_velocity_{unit}_per_s\"));\n",
            ),
            (
                "twin/job/kind.rs",
                "const BLOCKS: [(&str, Kind); 1] = [(\"MC_Halt\", Kind::Halt)];\n",
            ),
            (
                "motion/gcode/din66025/word.rs",
                "use Letter::{C, D};\nconst COMMANDS: [X; 1] = {\n  end(5, A),\n};\n",
            ),
            ("Cargo.toml", "[workspace]\nmembers = [\"motion/axis\"]\n"),
            ("motion/axis/Cargo.toml", "[package]\nname = \"twin-axis\"\n"),
            ("motion/axis/lib.rs", "pub struct Axis;\n    pub const fn turn() {}\n"),
        ]);
        let known = Reach::of(&tree).unwrap();
        let there = [
            "twin check",
            "twin check --format two-way",
            "twin check --at",
            "twin drive board home",
            "[[axes]] kind",
            "[[axes]] max_velocity_mm_per_s",
            "[axes.physics] position_deg",
            "kind =",
            "MC_Halt",
            "D",
            "G5",
            "twin_axis::Axis::turn",
        ];
        for reach in there {
            assert_eq!(known.missing(reach), None, "{reach}");
        }
        let gone = [
            "twin fly",
            "twin check home",
            "twin check --short",
            "twin check --format info",
            "[[axes]] mass_kg",
            "[body] kind",
            "mass =",
            "MC_Stop",
            "E",
            "G6",
            "twin_cam::Axis",
            "twin_axis::Halt",
        ];
        for reach in gone {
            assert!(known.missing(reach).is_some(), "{reach}");
        }
    }
}
