//! Tests of mistakes in machine files: every row of `mistakes.toml` is one.

use super::{SHORT, drives, edited, problems, simulated, workspace};
use toml::{Table, Value};

/// A machine file that rows change: of this module, or of `machines/`.
fn valid(name: &str) -> String {
    match name {
        "" => String::new(),
        "short" => SHORT.to_owned(),
        "servo" => simulated::text(simulated::SERVO),
        "encoder" => drives::encoder("interpcnc", drives::BOARD_ENCODER),
        "module" => drives::module("axes = [2]\npoints_per_turn = 4000"),
        shipped => {
            let path = workspace().join("machines").join(shipped).with_extension("toml");
            std::fs::read_to_string(path).unwrap()
        }
    }
}

#[test]
fn mistakes_are_named_at_their_place() {
    let path = workspace().join("twin/machine/tests/mistakes.toml");
    let groups: Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let mut missed = Vec::new();
    for (name, group) in &groups {
        let file = valid(group["file"].as_str().unwrap());
        for row in group["rows"].as_array().unwrap() {
            let known = ["from", "to", "at", "says", "help", "of"];
            let mut keys = row.as_table().unwrap().keys();
            assert!(keys.all(|key| known.contains(&key.as_str())), "{name}: {row}");
            let word = |table: &Value, key: &str| {
                let text = table.get(key).map(|value| value.as_str().unwrap());
                text.map(|text| text.replace("\\n", "\n"))
            };
            let to = word(row, "to").unwrap_or_default();
            let to = match word(group, "to") {
                Some(around) => around.replace("{}", &to),
                None => to,
            };
            let text = match word(row, "from").or_else(|| word(group, "from")) {
                Some(from) => edited(&file, &from, &to),
                None => format!("{file}{to}"),
            };
            let says = |message: &str| match &row["says"] {
                Value::Array(parts) => {
                    parts.iter().all(|one| message.contains(one.as_str().unwrap()))
                }
                whole => whole.as_str() == Some(message),
            };
            let fits = |(at, message, help): &(String, String, Option<String>)| {
                word(row, "at").is_none_or(|place| place == *at)
                    && says(message)
                    && word(row, "help").is_none_or(|wanted| Some(wanted) == *help)
            };
            let found = problems(&text);
            let count = row.get("of").map_or(1, |count| count.as_integer().unwrap());
            if usize::try_from(count) != Ok(found.len()) || !found.iter().any(fits) {
                missed.push(format!("{name}: {row}: {found:#?}"));
            }
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
