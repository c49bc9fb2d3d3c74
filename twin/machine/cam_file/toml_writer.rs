//! Cams written as TOML, as people write them.

use crate::cam_file::form::{Coupling, WANTED};
use crate::cam_file::toml_form::POSITIVE;
use std::fmt::{self, Display, Write};
use twin_cam::{
    Action, Element, Equidistant, Interpolation, Kind, Knot, PairTable, Passage, Scale, Shape,
    Source, TableScale, Tappet, VariableType,
};

/// A number as TOML has it, the shortest that reads back as it was.
#[derive(Clone, Copy, Debug)]
pub struct Number(pub f64);

impl Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-6..1e15).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Writes a cam; with a table that takes the place of elements. What is not said is what reading takes it for.
pub fn write_toml(source: &Source, table: Option<&Shape>, coupling: &Coupling) -> String {
    let mut text = String::new();
    // Writing into a text does not fail.
    write(&mut text, source, table, coupling).unwrap_or_default();
    text
}

fn write(
    out: &mut String,
    source: &Source,
    table: Option<&Shape>,
    coupling: &Coupling,
) -> fmt::Result {
    let Source { name, kind, master, slave, period, elements, tappets } = source;
    writeln!(out, "name = {}", quoted(name))?;
    if *kind == Kind::Tappets {
        writeln!(out, "kind = \"tappets\"")?;
    }
    writeln!(out, "master = {{ {} }}", scale(master))?;
    let period = period.map_or(String::new(), |period| format!(", period = {}", Number(period)));
    writeln!(out, "slave = {{ {}{period} }}", scale(slave))?;
    let knots = if let Some(Shape::Polynomial(knots)) = table { knots.as_slice() } else { &[] };
    let points = knots.iter().copied().map(Element::Point);
    list(out, "elements", elements.iter().copied().chain(points).map(|one| element(&one)))?;
    list(out, "tappets", tappets.iter().map(tappet))?;
    match table {
        Some(Shape::Equidistant(table)) => equidistant(out, table, source.period.is_some())?,
        Some(Shape::Pairs(table)) => pairs(out, table, source.period.is_some())?,
        Some(Shape::Polynomial(_)) | None => {}
    }
    write_coupling(out, coupling)
}

fn list(out: &mut String, key: &str, lines: impl Iterator<Item = String>) -> fmt::Result {
    let mut lines = lines.peekable();
    if lines.peek().is_none() {
        return Ok(());
    }
    writeln!(out, "{key} = [")?;
    for line in lines {
        writeln!(out, "  {{ {line} }},")?;
    }
    writeln!(out, "]")
}

fn scale(Scale { min, max, step, unit }: &Scale) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(", unit = {}", quoted(unit)) };
    // Only a computed step can be smaller than the smallest of a file; reading computes it again.
    let step =
        if POSITIVE.contains(step) { format!(", step = {}", Number(*step)) } else { String::new() };
    format!("min = {}, max = {}{step}{unit}", Number(*min), Number(*max))
}

fn write_coupling(out: &mut String, coupling: &Coupling) -> fmt::Result {
    if *coupling == Coupling::default() {
        return Ok(());
    }
    writeln!(out, "\n[coupling]")?;
    let usual = Coupling::default();
    for ((key, _, value), (_, _, usual)) in coupling.numbers().into_iter().zip(usual.numbers()) {
        if value.to_bits() != usual.to_bits() {
            writeln!(out, "{key} = {}", Number(value))?;
        }
    }
    for (key, value) in WANTED.into_iter().zip(coupling.wanted.into_iter().flatten()) {
        writeln!(out, "{key} = {}", Number(value))?;
    }
    if coupling.start_mode() != usual.start_mode() {
        writeln!(out, "start_mode = {}", quoted(coupling.start_mode()))?;
    }
    Ok(())
}

fn element(element: &Element) -> String {
    match element {
        Element::Point(Knot { master, slave, velocity, acceleration }) => {
            let mut text = format!("master = {}, slave = {}", Number(*master), Number(*slave));
            for (key, value) in [("velocity", velocity), ("acceleration", acceleration)] {
                if value.to_bits() != 0 {
                    text = format!("{text}, {key} = {}", Number(*value));
                }
            }
            text
        }
        Element::Line { from, to } => {
            let [from, to] = [from, to].map(|[x, y]| format!("[{}, {}]", Number(*x), Number(*y)));
            format!("from = {from}, to = {to}")
        }
    }
}

/// A tappet as a line of `tappets`.
pub fn tappet(tappet: &Tappet) -> String {
    let Tappet { group, master, passage, action } = *tappet;
    let passage = match passage {
        Passage::Positive => "positive",
        Passage::Negative => "negative",
        Passage::Every => "every",
    };
    let action = match action {
        Action::On => "\"on\"".to_owned(),
        Action::Off => "\"off\"".to_owned(),
        Action::Invert => "\"invert\"".to_owned(),
        Action::Timed { delay_ns, duration_ns } => {
            let [delay, duration] = [delay_ns, duration_ns].map(microseconds);
            format!("\"timed\", delay_us = {delay}, duration_us = {duration}")
        }
    };
    format!(
        "group = {group}, master = {}, passage = \"{passage}\", action = {action}",
        Number(master)
    )
}

/// Nanoseconds as microseconds, exactly.
fn microseconds(ns: i64) -> String {
    let (whole, rest) = (ns / 1000, ns % 1000);
    if rest == 0 { whole.to_string() } else { format!("{whole}.{rest:03}") }
}

fn equidistant(out: &mut String, table: &Equidistant, periodic: bool) -> fmt::Result {
    head(out, table.variable, table.interpolation, (table.periodic, periodic))?;
    table_scale(out, "slave_scale", &table.slave)?;
    writeln!(out, "values = [")?;
    for row in table.values.chunks(10) {
        let row: Vec<_> = row.iter().map(|value| Number(*value).to_string()).collect();
        writeln!(out, "  {},", row.join(", "))?;
    }
    writeln!(out, "]")
}

fn pairs(out: &mut String, table: &PairTable, periodic: bool) -> fmt::Result {
    head(out, table.variable, table.interpolation, (table.periodic, periodic))?;
    table_scale(out, "master_scale", &table.master)?;
    table_scale(out, "slave_scale", &table.slave)?;
    writeln!(out, "pairs = [")?;
    for [master, slave] in &table.pairs {
        writeln!(out, "  [{}, {}],", Number(*master), Number(*slave))?;
    }
    writeln!(out, "]")
}

fn head(
    out: &mut String,
    variable: VariableType,
    interpolation: Interpolation,
    (periodic, usual): (bool, bool),
) -> fmt::Result {
    writeln!(out, "\n[table]")?;
    if variable != VariableType::Lreal {
        writeln!(out, "type = \"{}\"", variable.name())?;
    }
    if interpolation == Interpolation::Cubic {
        writeln!(out, "interpolation = \"cubic\"")?;
    }
    if periodic == usual { Ok(()) } else { writeln!(out, "periodic = {periodic}") }
}

fn table_scale(out: &mut String, key: &str, scale: &TableScale) -> fmt::Result {
    if *scale == TableScale::IDENTITY {
        return Ok(());
    }
    let numbers = [scale.min, scale.max, scale.table_min, scale.table_max];
    let numbers = numbers.map(|number| Number(number).to_string());
    writeln!(
        out,
        "{key} = [{}]  # positions, and the numbers that represent them",
        numbers.join(", ")
    )
}
