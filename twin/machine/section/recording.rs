//! Recording of keys: which tables and keys a reader asks for, and the values that it expects.
//!
//! The reference of machine files is generated from it, so that the table cannot differ from the reader.

use super::Section;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt;
use std::ops::RangeInclusive;

/// Value that a reader expects of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Expected {
    /// A number, in the unit that the key names.
    Number(RangeInclusive<f64>),
    /// A list of numbers of this length.
    Numbers(usize, RangeInclusive<f64>),
    /// A list of numbers of any length.
    NumberList(RangeInclusive<f64>),
    /// A list of pairs of numbers.
    NumberPairs(RangeInclusive<f64>),
    /// A whole number.
    Integer(RangeInclusive<i64>),
    /// A list of whole numbers, at most this long.
    Integers(usize, RangeInclusive<i64>),
    /// A text.
    Text,
    /// One of these words.
    Choice(Vec<String>),
    /// `true` or `false`.
    Flag,
    /// A list of names of this length.
    Names(usize),
    /// A list of pairs of names.
    NamePairs,
    /// A table.
    Table,
    /// An array of tables.
    Tables,
}

impl Expected {
    /// Both of them in one, where they are of the same type: the wider range, all the words.
    #[must_use]
    pub fn with(&self, other: &Self) -> Option<Self> {
        fn wider<T: PartialOrd + Copy>(
            one: &RangeInclusive<T>,
            other: &RangeInclusive<T>,
        ) -> RangeInclusive<T> {
            let low = if one.start() < other.start() { *one.start() } else { *other.start() };
            let high = if one.end() > other.end() { *one.end() } else { *other.end() };
            low..=high
        }
        match (self, other) {
            (Self::Number(one), Self::Number(other)) => Some(Self::Number(wider(one, other))),
            (Self::Integer(one), Self::Integer(other)) => Some(Self::Integer(wider(one, other))),
            (Self::Choice(words), Self::Choice(others)) => {
                let new = others.iter().filter(|word| !words.contains(word));
                Some(Self::Choice(words.iter().chain(new).cloned().collect()))
            }
            (one, other) => (one == other).then(|| one.clone()),
        }
    }
}

/// A bound of a range; powers of ten from a million up, and below a thousandth, as such.
fn bound(value: f64) -> String {
    let power = value.abs().log10();
    let is_power = (power - power.round()).abs() < 1e-9;
    if is_power && !(-3.5..5.5).contains(&power) { format!("{value:e}") } else { value.to_string() }
}

/// A bound of a range of whole numbers, powers of ten from a million up as such.
fn whole_bound(value: i64) -> String {
    let size = value.unsigned_abs();
    match size.checked_ilog10() {
        Some(power) if power > 5 && size == 10_u64.pow(power) => {
            let sign = if value < 0 { "-" } else { "" };
            format!("{sign}10^{power}")
        }
        _ => value.to_string(),
    }
}

/// "FROM to TO".
fn span<T: Copy>(range: &RangeInclusive<T>, text: impl Fn(T) -> String) -> String {
    format!("{} to {}", text(*range.start()), text(*range.end()))
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(range) => write!(f, "number, {}", span(range, bound)),
            Self::Numbers(count, range) => write!(f, "{count} numbers, {}", span(range, bound)),
            Self::NumberList(range) => write!(f, "list of numbers, {}", span(range, bound)),
            Self::NumberPairs(range) => {
                write!(f, "list of pairs of numbers, {}", span(range, bound))
            }
            Self::Integer(range) => write!(f, "whole number, {}", span(range, whole_bound)),
            Self::Integers(most, range) => {
                write!(f, "list of at most {most} whole numbers, {}", span(range, whole_bound))
            }
            Self::Text => f.write_str("text"),
            Self::Choice(words) => {
                let words: Vec<_> = words.iter().map(|word| format!("`\"{word}\"`")).collect();
                f.write_str(&words.join(", "))
            }
            Self::Flag => f.write_str("`true` or `false`"),
            Self::Names(count) => write!(f, "{count} names"),
            Self::NamePairs => f.write_str("list of pairs of names"),
            Self::Table => f.write_str("table"),
            Self::Tables => f.write_str("array of tables"),
        }
    }
}

/// A key that a reader has asked a table for.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyUse {
    /// Path of the table: `axes.physics`; empty: the file as a whole.
    pub table: String,
    /// True if the table is one of an array (`[[axes]]`).
    pub many: bool,
    /// Kind of the table, where its keys depend on that: `linear`, `interpcnc`, `box`.
    pub variant: Option<String>,
    /// The key; `NAME` where the names are up to the user.
    pub key: String,
    /// The value that the reader expects.
    pub expected: Expected,
    /// True if the table must have the key.
    pub required: bool,
}

/// A table that was read.
#[derive(Debug)]
struct Table {
    path: String,
    many: bool,
    parent: Option<usize>,
    variant: Option<String>,
    free_names: bool,
}

#[derive(Debug, Default)]
struct Recorded {
    tables: Vec<Table>,
    uses: Vec<(usize, String, Expected, bool)>,
}

/// Recording of a file that is read.
#[derive(Debug, Default)]
pub(super) struct Recording(RefCell<Recorded>);

impl Recording {
    /// Number of a table that `key` of the table `parent` has; both absent for the file as a whole.
    pub(super) fn enter(&self, of: Option<(usize, &str)>, many: bool) -> usize {
        let mut recorded = self.0.borrow_mut();
        let parent = of.and_then(|(parent, _)| recorded.tables.get(parent));
        let key = of.map_or("", |(_, key)| key);
        let key = if parent.is_some_and(|parent| parent.free_names) { "NAME" } else { key };
        let path = match parent {
            Some(parent) if !parent.path.is_empty() => format!("{}.{key}", parent.path),
            _ => key.to_owned(),
        };
        let parent = of.map(|(parent, _)| parent);
        recorded.tables.push(Table { path, many, parent, variant: None, free_names: false });
        recorded.tables.len() - 1
    }

    fn note(&self, table: usize, key: &str, expected: Expected, required: bool) {
        self.0.borrow_mut().uses.push((table, key.to_owned(), expected, required));
    }

    fn change(&self, table: usize, change: impl FnOnce(&mut Table)) {
        if let Some(table) = self.0.borrow_mut().tables.get_mut(table) {
            change(table);
        }
    }

    /// Every key that was asked for, once per table of the file.
    pub(super) fn into_uses(self) -> Vec<KeyUse> {
        let Recorded { tables, uses } = self.0.into_inner();
        let required: BTreeSet<_> = uses
            .iter()
            .filter(|(.., required)| *required)
            .map(|(table, key, ..)| (*table, key.clone()))
            .collect();
        let variant = |mut at: usize| loop {
            let table = tables.get(at)?;
            if table.variant.is_some() {
                return table.variant.clone();
            }
            at = table.parent?;
        };
        let key_use = |(at, key, expected, _): (usize, String, Expected, bool)| {
            let table = tables.get(at)?;
            let required = required.contains(&(at, key.clone()));
            Some(KeyUse {
                table: table.path.clone(),
                many: table.many,
                variant: variant(at),
                key: if table.free_names { "NAME".to_owned() } else { key },
                expected,
                required,
            })
        };
        uses.into_iter().filter_map(key_use).collect()
    }
}

impl Section<'_> {
    /// Says of which kind the table is, where its keys depend on that.
    pub(crate) fn is_of_kind(&self, variant: &str) {
        if let Some(recording) = &self.complaints.recording {
            recording.change(self.number, |table| table.variant = Some(variant.to_owned()));
        }
    }

    /// Records that the user chooses the names of the keys.
    pub(super) fn has_free_names(&self) {
        if let Some(recording) = &self.complaints.recording {
            recording.change(self.number, |table| table.free_names = true);
        }
    }

    pub(super) fn note(&self, key: &str, required: bool, expected: impl FnOnce() -> Expected) {
        if let Some(recording) = &self.complaints.recording {
            recording.note(self.number, key, expected(), required);
        }
    }
}
