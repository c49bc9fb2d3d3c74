//! Reports: their fields, from the schema, which real reports of checks and runs must keep field by field.

use super::{cell, compare};
use crate::desk::Desk;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::fmt::Write;

const HEAD: &str = "\
# Report

`twin check --format json` prints one object per program; `twin run --report FILE` writes one with the fields of a run as well.
The chapter [The report](../report.md) explains them, and [schema.json](../../../twin/report/schema.json) is the same as a JSON schema.

- A dot leads into an object, `[]` into a list. `AXIS` and `DEVICE` are names from the machine file.
- `optional` fields are absent where they do not apply.
- A unit in backticks is the field that names it. Numbers have at most 12 significant digits.
- The tables and the example are in alphabetical order. Fields are added, never renamed.
";

fn schema() -> Value {
    serde_json::from_str(include_str!("../../../twin/report/schema.json")).expect("JSON")
}

/// Types that a schema allows.
fn types(schema: &Value) -> Vec<&str> {
    match &schema["type"] {
        Value::String(one) => vec![one],
        Value::Array(several) => several.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    }
}

fn is_of(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        _ => false,
    }
}

/// Compares a value with its schema. `seen` takes the paths of the fields.
fn check(
    schema: &Value,
    value: &Value,
    path: &str,
    seen: &mut BTreeSet<String>,
    wrong: &mut Vec<String>,
) {
    if !types(schema).iter().any(|kind| is_of(value, kind)) {
        wrong.push(format!("{path} is {value}, not {}", schema["type"]));
        return;
    }
    if let Some(words) = schema["enum"].as_array()
        && !words.contains(value)
    {
        wrong.push(format!("{path} is {value}, not one of {words:?}"));
    }
    seen.insert(path.to_owned());
    match value {
        Value::Array(items) => {
            for item in items {
                check(&schema["items"], item, &format!("{path}[]"), seen, wrong);
            }
        }
        Value::Object(fields) => {
            let required =
                schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
            for name in required.filter(|name| !fields.contains_key(*name)) {
                wrong.push(format!("{path} lacks {name}"));
            }
            for (name, value) in fields {
                let (below, name) =
                    match (schema["properties"].get(name), schema["x-name"].as_str()) {
                        (Some(below), _) => (below, name.as_str()),
                        (None, Some(name)) => (&schema["additionalProperties"], name),
                        (None, None) => {
                            wrong.push(format!("{path}.{name} is not in twin/report/schema.json"));
                            continue;
                        }
                    };
                let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
                check(below, value, &path, seen, wrong);
            }
        }
        _ => {}
    }
}

/// The fields below a schema, in order: path, schema, and true if it may be absent.
fn fields<'a>(schema: &'a Value, path: &str, out: &mut Vec<(String, &'a Value, bool)>) {
    let required: Vec<_> =
        schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let mut enter = |name: &str, below: &'a Value, optional: bool| {
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        out.push((path.clone(), below, optional));
        fields(below, &path, out);
    };
    for (name, below) in schema["properties"].as_object().into_iter().flatten() {
        enter(name, below, !required.contains(&name.as_str()));
    }
    if let Some(name) = schema["x-name"].as_str() {
        enter(name, &schema["additionalProperties"], false);
    }
    if schema["items"].is_object() {
        let path = format!("{path}[]");
        out.push((path.clone(), &schema["items"], false));
        fields(&schema["items"], &path, out);
    }
}

fn table(page: &mut String, schema: &Value) {
    page.push_str("\n| field | type | unit | meaning |\n|---|---|---|---|\n");
    let mut rows = Vec::new();
    fields(schema, "", &mut rows);
    for (path, field, optional) in rows {
        let optional = if optional { "optional " } else { "" };
        let kind = types(field).join(" or ");
        let unit = field["x-unit"].as_str().unwrap_or("");
        let mut meaning = field["description"]
            .as_str()
            .unwrap_or_else(|| panic!("{path} lacks a description"))
            .to_owned();
        if let Some(words) = field["enum"].as_array() {
            let words: Vec<_> =
                words.iter().filter_map(Value::as_str).map(|word| format!("`{word}`")).collect();
            write!(meaning, " One of {}.", words.join(", ")).expect("a string");
        }
        writeln!(page, "| `{path}` | {optional}{kind} | {unit} | {} |", cell(&meaning))
            .expect("a string");
    }
}

/// Both parts of a schema in one: a run has the fields of a check.
fn merged(one: &Value, other: &Value) -> Value {
    let mut all = one.clone();
    let properties = other["properties"].as_object().expect("an object");
    all["properties"].as_object_mut().expect("an object").extend(properties.clone());
    let required = other["required"].as_array().expect("a list");
    all["required"].as_array_mut().expect("a list").extend(required.iter().cloned());
    all
}

/// Real reports: of checks, and of runs.
fn reports() -> (Vec<Value>, Vec<Value>) {
    let desk = Desk::new();
    let machine = desk.text("machine.toml");
    desk.write("outputs.toml", &(machine + "\n[[m_functions]]\nm = 3\noutputs_on = [1]\n"));
    desk.write(
        "short.cnc",
        "% short\nN10 G1 X20 F100 E500 E-500 H1 L10\nN20 M3 K2.5 L-7 O$g_par$\nN30 G1 X0\n",
    );
    desk.write("values.toml", "g_par = [1, 2]\n");
    desk.write("unfit.cnc", "% unfit\nN10 G1 X300 F500 E2000 E-2000\n");
    desk.write(
        "circles.cnc",
        "% circles\nN10 G2 I30 J0 F100 E500 E-500\nN20 G2 I30 J0\nN30 G2 I30 J0\n",
    );
    desk.write("caller.ngc", "G21\no<far> call\nM2\n");
    desk.write("far.ngc", "o<far> sub\nG0 X700\no<far> endsub\n");
    desk.write(
        "part.toml",
        "[[bodies]]\nname = \"part\"\nshape = \"sphere\"\nradius_mm = 5\nposition_mm = [0, 0, 500]\nmass_kg = 1\nclamp_n = 20\n",
    );
    let vice = "examples/vice.ngc -m machines/gantry3_vice.toml --physics";
    let motors = "short.cnc -m machines/gantry3_motors.toml --physics";
    let checks = [
        vice.to_owned(),
        format!("{motors} --limits axes --variables values.toml"),
        "unfit.cnc -m machine.toml".to_owned(),
        "circles.cnc -m machines/scara2.toml".to_owned(),
        "caller.ngc -m machine.toml".to_owned(),
        "circles.cnc -m machines/scara2.toml --scene part.toml --physics".to_owned(),
        "examples/jobs/flying_shear.toml -m machines/gantry3.toml".to_owned(),
    ]
    .map(|checked| desk.twin(&format!("check {checked} --format json")).object())
    .to_vec();
    let run = "run short.cnc -m outputs.toml --report run.json --variables values.toml";
    desk.twin(&format!("{run} --tracking-error 1 --override-at 0.1s=50%")).ended(0, "");
    let stopped = "run circles.cnc -m machine.toml --report stopped.json";
    desk.interrupted("-INT", "emulated InterpCNC", stopped).ended(2, "stopped by the user");
    (checks, ["run.json", "stopped.json"].map(|name| desk.read(name)).to_vec())
}

/// A finding with all fields, from a check.
fn example(reports: &[Value]) -> String {
    let report = reports.iter().find(|report| report["program"] == "unfit.cnc").expect("there");
    let mut short: Map<String, Value> = report.as_object().expect("an object").clone();
    let peak = short["peak"].as_object_mut().expect("an object");
    peak.retain(|axis, _| axis == "X");
    short.remove("predicted_following");
    serde_json::to_string_pretty(&short).expect("JSON")
}

#[test]
fn the_chapter_on_reports_is_up_to_date_and_reports_keep_its_schema() {
    let schema = schema();
    let [check_fields, run_fields] =
        ["check_fields", "run_fields"].map(|name| &schema["$defs"][name]);
    let run_schema = merged(check_fields, run_fields);
    let (checks, runs) = reports();
    let (mut seen, mut wrong) = (BTreeSet::new(), Vec::new());
    for report in &checks {
        check(check_fields, report, "", &mut seen, &mut wrong);
    }
    for report in &runs {
        check(&run_schema, report, "", &mut seen, &mut wrong);
    }
    let mut rows = Vec::new();
    fields(&run_schema, "", &mut rows);
    let missing = rows.iter().filter(|(path, ..)| !seen.contains(path));
    wrong.extend(missing.map(|(path, ..)| format!("no report of this test has {path}")));
    assert!(wrong.is_empty(), "{} offences:\n{}", wrong.len(), wrong.join("\n"));

    let mut page = HEAD.to_owned();
    page.push_str("\n## Check\n");
    table(&mut page, check_fields);
    page.push_str("\n## Run\n");
    table(&mut page, run_fields);
    write!(
        page,
        "\n## Example\n\nA check of a program of two lines whose move is too fast for axis X. Axes Y and Z and `predicted_following` are left out.\n\n```text\n{}\n```\n",
        example(&checks)
    )
    .expect("a string");
    compare("report.md", &page);
}
