//! Changes to the text of a cam's TOML file that leave everything else as it is, comments included.

use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use twin_cam::Tappet;
use twin_machine::cam_file::Number;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Change {
    /// A number of `[coupling]`.
    Coupling(&'static str, f64),
    /// A word of `[coupling]`.
    CouplingWord(&'static str, &'static str),
    /// The master of the tappets at `from`.
    Tappet {
        from: f64,
        /// One of them as it is to be.
        tappet: Tappet,
    },
}

/// Why a text is not changed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum EditError {
    #[error("the text is not TOML: {0}")]
    Toml(String),
    #[error("`tappets` has no tappet at master {0}")]
    NoTappet(String),
    #[error("`{0}` is not a table that numbers can be written into")]
    NoTable(&'static str),
}

/// The text with all changes.
/// [`EditError`] if there is no place for one of them.
pub(crate) fn apply(text: &str, changes: &[Change]) -> Result<String, EditError> {
    let mut text = tappets(text, changes)?;
    // One after the other: places move with every change.
    for change in changes {
        text = match change {
            Change::Coupling(key, value) => coupling(&text, key, &Number(*value).to_string())?,
            Change::CouplingWord(key, word) => coupling(&text, key, &format!("\"{word}\""))?,
            Change::Tappet { .. } => text,
        };
    }
    Ok(text)
}

fn parse(text: &str) -> Result<Spanned<DeTable<'_>>, EditError> {
    DeTable::parse(text).map_err(|error| EditError::Toml(error.message().to_owned()))
}

fn replaced(text: &str, range: Range<usize>, with: &str) -> String {
    let mut changed = text.to_owned();
    changed.replace_range(range, with);
    changed
}

fn coupling(text: &str, key: &str, value: &str) -> Result<String, EditError> {
    let root = parse(text)?;
    let section = root.get_ref().iter().find(|(name, _)| name.get_ref() == "coupling");
    let Some((name, section)) = section else {
        let gap = if text.ends_with('\n') { "\n" } else { "\n\n" };
        return Ok(format!("{text}{gap}[coupling]\n{key} = {value}\n"));
    };
    let table = section.get_ref().as_table().ok_or(EditError::NoTable("coupling"))?;
    Ok(set(text, table, section.span(), name.span().end, key, value))
}

/// Sets a key of a table that is there: over its value, or behind what the table ends with.
fn set(
    text: &str,
    table: &DeTable<'_>,
    span: Range<usize>,
    head: usize,
    key: &str,
    value: &str,
) -> String {
    if let Some(old) = table.get(key) {
        return replaced(text, old.span(), value);
    }
    let last = table.iter().map(|(_, value)| value.span().end).max();
    let inline = text.get(span.clone()).is_some_and(|text| text.trim_start().starts_with('{'));
    if inline {
        return match last {
            Some(end) => replaced(text, end..end, &format!(", {key} = {value}")),
            None => replaced(text, span, &format!("{{ {key} = {value} }}")),
        };
    }
    // On a line of its own, behind the comment of the line before.
    let from = last.unwrap_or(head);
    let end = text.get(from..).and_then(|rest| rest.find('\n')).map(|by| from + by);
    match end {
        Some(end) => replaced(text, end..end, &format!("\n{key} = {value}")),
        None => format!("{text}\n{key} = {value}\n"),
    }
}

/// Moves tappets: all at once, for one may come to where another one stood.
fn tappets(text: &str, changes: &[Change]) -> Result<String, EditError> {
    let moves: Vec<_> = changes
        .iter()
        .filter_map(|change| match change {
            Change::Tappet { from, tappet } => Some((*from, tappet.master)),
            _ => None,
        })
        .collect();
    if moves.is_empty() {
        return Ok(text.to_owned());
    }
    let root = parse(text)?;
    let all = root.get_ref().get("tappets").map(Spanned::get_ref);
    let all = all.and_then(DeValue::as_array).ok_or(EditError::NoTable("tappets"))?;
    let mut masters: Vec<_> = all
        .iter()
        .filter_map(|item| {
            let master = item.get_ref().as_table()?.get("master")?;
            Some((number(master.get_ref())?, master.span()))
        })
        .collect();
    masters.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut places = Vec::new();
    for (from, to) in moves {
        let begin = masters.partition_point(|(at, _)| *at < from);
        let here = masters.get(begin..).unwrap_or_default().iter();
        let mut here = here.take_while(|(at, _)| same(*at, from)).peekable();
        if here.peek().is_none() {
            return Err(EditError::NoTappet(Number(from).to_string()));
        }
        places.extend(here.map(|(_, span)| (span.clone(), to)));
    }
    // Several moves of one place are the same.
    places.sort_by_key(|(span, _)| span.start);
    places.dedup_by_key(|(span, _)| span.start);
    let (mut moved, mut done) = (String::with_capacity(text.len()), 0);
    for (span, to) in places {
        moved.push_str(text.get(done..span.start).unwrap_or_default());
        moved.push_str(&Number(to).to_string());
        done = span.end;
    }
    moved.push_str(text.get(done..).unwrap_or_default());
    Ok(moved)
}

/// The same number, 0 with either sign.
#[expect(clippy::float_cmp, reason = "the same number or another one")]
fn same(one: f64, other: f64) -> bool {
    one == other
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => integer.as_str().parse().ok(),
        _ => None,
    }
}
