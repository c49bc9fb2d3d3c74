//! Machine file keys: the keys, types and ranges that the readers ask for, with the meanings of `twin/machine/keys.tsv`.

use super::{cell, compare};
use crate::net::{files, rounded};
use crate::root;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use toml::{Table, Value};
use twin_machine::section::{Expected, KeyUse};
use twin_machine::{KeyMeaning, Machine};

/// Kinds of machines that no machine file is shipped of: gantries, without required dimensions.
const OTHER_KINDS: [(&str, &str); 5] = [
    ("gantry2", "XY"),
    ("gantry_cutter2", "XYR"),
    ("gantry2_tool1", "XY"),
    ("gantry2_tool2", "XY"),
    ("gantry3_tool1", "XYZ"),
];

/// Words that change which keys a table has; each of them must have been read.
const KINDS: [(&str, &str); 5] = [
    ("kinematics", "kind"),
    ("axes", "kind"),
    ("drives", "kind"),
    ("obstacles", "shape"),
    ("axes.physics.encoder", "on"),
];

/// A machine file, and the path that it is read from.
type File = (PathBuf, String);

fn machine_files() -> Vec<File> {
    let shipped =
        files("machines", &["toml"]).into_iter().chain(files("tests/data/reference", &["toml"]));
    let shipped = shipped.map(|path| {
        let text = fs::read_to_string(&path).expect("readable");
        // Files that they name are those of the shipped machines.
        (root().join("machines").join(path.file_name().expect("a file")), text)
    });
    let short = OTHER_KINDS.map(|(kind, axes)| {
        let mut text = format!("name = \"{kind}\"\n[body]\n[kinematics]\nkind = \"{kind}\"\n[kinematics.deviations]\n");
        for axis in axes.chars() {
            let (kind, unit) = if axis == 'R' { ("rotary", "deg") } else { ("linear", "mm") };
            write!(
                text,
                "[[axes]]\nname = \"{axis}\"\nkind = \"{kind}\"\nposition_min_{unit} = 0\nposition_max_{unit} = 300\n\
                 max_velocity_{unit}_per_s = 100\nmax_acceleration_{unit}_per_s2 = 1000\n"
            )
            .expect("a string");
        }
        (root().join("machines").join(kind), text)
    });
    shipped.chain(short).collect()
}

fn read((path, text): &File) -> (Machine, Vec<KeyUse>) {
    Machine::parse_recorded(path, text)
        .unwrap_or_else(|problems| panic!("{}: {problems:?}", path.display()))
}

/// A line of the table: a key with what the readers expect, for the kinds of its table.
struct Row {
    key: String,
    expected: Expected,
    variants: BTreeSet<String>,
    always: bool,
    never: bool,
}

/// Keys of a table.
struct Keys {
    many: bool,
    variants: BTreeSet<String>,
    rows: Vec<Row>,
}

/// What the readers ask for, by tables.
fn asked(uses: Vec<KeyUse>) -> BTreeMap<String, Keys> {
    let mut tables = BTreeMap::new();
    for one in &uses {
        let empty = || Keys { many: one.many, variants: BTreeSet::new(), rows: Vec::new() };
        let keys = tables.entry(one.table.clone()).or_insert_with(empty);
        keys.variants.extend(one.variant.clone());
    }
    for one in uses {
        let keys = tables.get_mut(&one.table).expect("entered above");
        // A table that is looked at again without its kind.
        if one.variant.is_none() && !keys.variants.is_empty() {
            continue;
        }
        let same =
            keys.rows.iter_mut().find(|row| row.key == one.key && row.expected == one.expected);
        match same {
            Some(row) => {
                row.always &= one.required;
                row.never &= !one.required;
                row.variants.extend(one.variant);
            }
            None => keys.rows.push(Row {
                key: one.key,
                expected: one.expected,
                variants: one.variant.into_iter().collect(),
                always: one.required,
                never: !one.required,
            }),
        }
    }
    for keys in tables.values_mut() {
        let mut rows: Vec<Row> = Vec::new();
        for row in std::mem::take(&mut keys.rows) {
            // The same key, of tables of the same kind: some of them have a wider range.
            let meets = |other: &&mut Row| {
                other.key == row.key
                    && (!other.variants.is_disjoint(&row.variants) || row.variants.is_empty())
            };
            let Some(other) = rows.iter_mut().find(meets) else {
                rows.push(row);
                continue;
            };
            let both = other.expected.with(&row.expected);
            other.expected = both.unwrap_or_else(|| panic!("`{}` is two things", row.key));
            other.variants.extend(row.variants);
            other.always &= row.always;
            other.never &= row.never;
        }
        keys.rows = rows;
    }
    tables
}

/// Offences of the meanings against what is asked for.
fn offences(tables: &BTreeMap<String, Keys>, meanings: &[KeyMeaning]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (table, keys) in tables {
        for row in &keys.rows {
            let named = format!("[{table}] {}", row.key);
            let meaning = meanings.iter().find(|one| one.table == table && one.key == row.key);
            let Some(KeyMeaning { default, meaning, .. }) = meaning else {
                wrong.push(format!("{named}\t{}\tlacks a meaning in keys.tsv", row.expected));
                continue;
            };
            if meaning.is_empty() {
                wrong.push(format!("{named} has an empty meaning"));
            }
            let needed = default.starts_with("required");
            if row.always && !(default.is_empty() || needed) {
                wrong.push(format!("{named} is required and has the default {default}"));
            }
            if !row.always && default.is_empty() {
                wrong.push(format!("{named}\t{}\tlacks a default", row.expected));
            }
            if !row.always && !row.never && !needed {
                wrong.push(format!(
                    "{named} is required in some tables: say in which (\"required …\")"
                ));
            }
        }
    }
    for (index, one) in meanings.iter().enumerate() {
        let known = tables
            .get(one.table)
            .is_some_and(|keys| keys.rows.iter().any(|row| row.key == one.key));
        if !known {
            wrong.push(format!("no reader asks [{}] for {}", one.table, one.key));
        }
        if meanings.iter().take(index).any(|other| other.table == one.table && other.key == one.key)
        {
            wrong.push(format!("[{}] {} has two meanings", one.table, one.key));
        }
    }
    for (table, key) in KINDS {
        let keys = &tables[table];
        let row = keys.rows.iter().find(|row| row.key == key).expect("the key is there");
        let Expected::Choice(words) = &row.expected else { panic!("{table} {key}") };
        let words: BTreeSet<_> = words.iter().cloned().collect();
        if words != keys.variants {
            wrong.push(format!("[{table}] {key}: read {:?} of {words:?}", keys.variants));
        }
    }
    wrong
}

fn heading(table: &str, many: bool) -> String {
    match table {
        "" => "Top level".to_owned(),
        table if many => format!("`[[{table}]]`"),
        table => format!("`[{table}]`"),
    }
}

const HEAD: &str = "\
# Machine file keys

All tables and keys of a machine file, as its readers ask for them.
The chapter [The machine file](../machine_file.md) explains how they belong together.

- Units are in the names: `_mm`, `_deg`, `_mm_per_s`, `_kg`, `_ms`. Ranges are in the same unit.
- \"Default\" is the value without the key. `required` keys have none.
- \"Only with\" names the kinds that have these keys: the `kind`, `shape` or `on` of the table or of the table above it. `[body]` goes by the `kind` of `[kinematics]`, or by `urdf` where links and joints come from a URDF.
- `NAME` is a name of your choice.
- `twin explain KEY` shows the same lines.
";

fn page(tables: &BTreeMap<String, Keys>, meanings: &[KeyMeaning]) -> String {
    let mut page = HEAD.to_owned();
    let mut order: Vec<&str> = Vec::new();
    for one in meanings {
        if !order.contains(&one.table) {
            order.push(one.table);
        }
    }
    for table in order {
        let keys = &tables[table];
        write!(page, "\n## {}\n", heading(table, keys.many)).expect("a string");
        let mut groups: Vec<(&BTreeSet<String>, Vec<[String; 4]>)> =
            vec![(&keys.variants, Vec::new())];
        for one in meanings.iter().filter(|one| one.table == table) {
            for row in keys.rows.iter().filter(|row| row.key == one.key) {
                let default = match one.default {
                    "" => "required".to_owned(),
                    default => default.to_owned(),
                };
                let line = [
                    format!("`{}`", row.key),
                    row.expected.to_string(),
                    default,
                    one.meaning.to_owned(),
                ];
                match groups.iter_mut().find(|(variants, _)| **variants == row.variants) {
                    Some((_, lines)) => lines.push(line),
                    None => groups.push((&row.variants, vec![line])),
                }
            }
        }
        for (variants, lines) in groups.into_iter().filter(|(_, lines)| !lines.is_empty()) {
            if *variants != keys.variants {
                let names: Vec<_> = variants.iter().map(|name| format!("`{name}`")).collect();
                write!(page, "\nOnly with {}:\n", names.join(", ")).expect("a string");
            }
            page.push_str("\n| key | value | default | meaning |\n|---|---|---|---|\n");
            for line in lines {
                writeln!(page, "| {} |", line.map(|text| cell(&text)).join(" | "))
                    .expect("a string");
            }
        }
    }
    page
}

#[test]
fn the_chapter_on_machine_file_keys_is_up_to_date() {
    let uses = machine_files().iter().flat_map(|file| read(file).1).collect();
    let tables = asked(uses);
    let meanings: Vec<_> = KeyMeaning::all().collect();
    let wrong = offences(&tables, &meanings);
    assert!(wrong.is_empty(), "{} offences:\n{}", wrong.len(), wrong.join("\n"));
    compare("machine_file.md", &page(&tables, &meanings));
}

/// All tables at a path.
fn tables_at<'a>(table: &'a mut Table, path: &str) -> Vec<&'a mut Table> {
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    if first.is_empty() {
        return vec![table];
    }
    let below = match table.get_mut(first) {
        Some(Value::Table(table)) => vec![table],
        Some(Value::Array(array)) => array.iter_mut().filter_map(Value::as_table_mut).collect(),
        _ => Vec::new(),
    };
    below.into_iter().flat_map(|table| tables_at(table, rest)).collect()
}

/// Everything known of a machine, without its file's text; rounded, as constants in SI are not exact.
fn known(mut machine: Machine) -> String {
    machine.dimensions.clear();
    rounded(&format!("{machine:?}"))
}

/// A default in the form of a value is one: with the key a machine is what it is without.
#[test]
fn defaults_of_machine_file_keys_are_what_readers_assume() {
    let files = machine_files();
    let plain: Vec<(_, Table)> =
        files.iter().map(|(path, text)| (path, text.parse().expect("TOML"))).collect();
    let mut wrong = Vec::new();
    for one in KeyMeaning::all() {
        let literal = one.default.strip_prefix('`').and_then(|rest| rest.strip_suffix('`'));
        let Some(literal) = literal.filter(|literal| !literal.contains('`')) else { continue };
        let value: Result<Table, _> = format!("value = {literal}").parse();
        let Ok(mut value) = value else {
            wrong.push(format!("[{}] {}: {literal} is not a value", one.table, one.key));
            continue;
        };
        let value = value.remove("value").expect("there");
        let mut seen = false;
        for (path, table) in &plain {
            let count = tables_at(&mut table.clone(), one.table).len();
            for index in 0..count {
                let [mut without, mut with] = [table.clone(), table.clone()];
                tables_at(&mut without, one.table)[index].remove(one.key);
                tables_at(&mut with, one.table)[index].insert(one.key.to_owned(), value.clone());
                // Tables of another kind do not know the key, and some need it.
                let read = |table: Table| Machine::parse_recorded(path, &table.to_string()).ok();
                let Some(((with, _), (without, _))) = read(with).zip(read(without)) else {
                    continue;
                };
                seen = true;
                if known(with) != known(without) {
                    wrong.push(format!(
                        "[{}] {} = {literal} changes {}",
                        one.table,
                        one.key,
                        path.display()
                    ));
                }
            }
        }
        if !seen {
            wrong.push(format!("[{}] {} = {literal} is not accepted anywhere", one.table, one.key));
        }
    }
    assert!(wrong.is_empty(), "{} defaults:\n{}", wrong.len(), wrong.join("\n"));
}
