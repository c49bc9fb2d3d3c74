//! Reads values out of TOML tables, so that every complaint knows its place in the file.

use super::problem::Problem;
use std::cell::RefCell;
use std::ops::{Range, RangeInclusive};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Gathers what is wrong with a file, so that a user sees all of it at once.
#[derive(Debug, Default)]
pub(crate) struct Complaints {
    list: RefCell<Vec<Problem>>,
}

impl Complaints {
    pub(crate) fn add(&self, span: Range<usize>, message: String, help: Option<String>) {
        self.list.borrow_mut().push(Problem { span, message, help });
    }

    pub(crate) fn into_list(self) -> Vec<Problem> {
        let mut list = self.list.into_inner();
        list.sort_by_key(|problem| problem.span.start);
        list
    }
}

/// What `read` makes of the text of a file.
///
/// # Errors
/// With everything that is wrong with it, in file order.
pub(crate) fn parse<T>(
    text: &str,
    read: impl FnOnce(&Section<'_>) -> Option<T>,
) -> Result<T, Vec<Problem>> {
    let table = DeTable::parse(text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        vec![Problem { span, message: error.message().to_owned(), help: None }]
    })?;
    let complaints = Complaints::default();
    let result = read(&Section::root(&table, &complaints));
    let problems = complaints.into_list();
    result.filter(|_| problems.is_empty()).ok_or(problems)
}

/// One table of the file. Remembers which keys were asked for: the others are unknown keys.
#[derive(Debug)]
pub(crate) struct Section<'a> {
    name: String,
    table: Option<&'a DeTable<'a>>,
    span: Range<usize>,
    complaints: &'a Complaints,
    known: RefCell<Vec<String>>,
}

impl<'a> Section<'a> {
    pub(crate) fn root(table: &'a Spanned<DeTable<'a>>, complaints: &'a Complaints) -> Self {
        Self::new("the file".to_owned(), Some(table.get_ref()), 0..0, complaints)
    }

    fn new(
        name: String,
        table: Option<&'a DeTable<'a>>,
        span: Range<usize>,
        complaints: &'a Complaints,
    ) -> Self {
        Self { name, table, span, complaints, known: RefCell::default() }
    }

    /// Complains about this section as a whole.
    pub(crate) fn complain(&self, message: String) {
        self.complaints.add(self.span.clone(), message, None);
    }

    /// Complains about the value of `key`, or about the section if the key is absent.
    pub(crate) fn complain_at(&self, key: &str, message: String) {
        self.complaints.add(self.span_of(key), message, None);
    }

    /// Complains about the value of `key`, with what would be right.
    pub(crate) fn complain_with_help(&self, key: &str, message: String, help: Option<String>) {
        self.complaints.add(self.span_of(key), message, help);
    }

    /// The keys that are there, none of which is unknown then.
    pub(crate) fn keys(&self) -> Vec<&'a str> {
        self.accept_all();
        self.table.into_iter().flatten().map(|(key, _)| key.get_ref().as_ref()).collect()
    }

    /// Complains about a place known from before.
    pub(crate) fn complain_over(&self, span: &Range<usize>, message: String) {
        self.complaints.add(span.clone(), message, None);
    }

    /// Where the value of `key` is; where the section is, if the key is absent.
    pub(crate) fn span_of(&self, key: &str) -> Range<usize> {
        self.look_up(key).map_or_else(|| self.span.clone(), Spanned::span)
    }

    /// The text of `key`, if that is what it is; complains about nothing and leaves the key unknown.
    pub(crate) fn glance_at_text(&self, key: &str) -> Option<&'a str> {
        self.look_up(key)?.get_ref().as_str()
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.look_up(key).is_some()
    }

    /// Notes that `key` is known, whatever it is.
    pub(crate) fn accept(&self, key: &str) {
        self.value(key);
    }

    fn look_up(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table?.get(key)
    }

    /// The value of `key`, noting that the key is known.
    fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.known.borrow_mut().push(key.to_owned());
        self.look_up(key)
    }

    fn missing(&self, key: &str) {
        self.complain(format!("{} lacks `{key}`", self.name));
    }

    fn wrong_type(&self, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
        let found = value.get_ref().type_str();
        let article = if found.starts_with(['a', 'i']) { "an" } else { "a" };
        self.complaints.add(
            value.span(),
            format!("`{key}` is {article} {found}; expected {expected}"),
            None,
        );
    }

    /// A table; an absent one is read as empty, so that its keys take their defaults.
    pub(crate) fn section(&self, key: &str) -> Section<'a> {
        let value = self.value(key);
        let table = value.and_then(|value| {
            let table = value.get_ref().as_table();
            if table.is_none() {
                self.wrong_type(key, value, "a table");
            }
            table
        });
        let span = value.map_or_else(|| self.span.clone(), Spanned::span);
        Section::new(format!("[{key}]"), table, span, self.complaints)
    }

    /// An array of tables (`[[key]]`), empty if absent.
    pub(crate) fn sections(&self, key: &str) -> Vec<Section<'a>> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, &format!("tables headed [[{key}]]"));
            return Vec::new();
        };
        let mut sections = Vec::new();
        for (index, item) in array.iter().enumerate() {
            match item.get_ref().as_table() {
                Some(table) => sections.push(Section::new(
                    format!("[[{key}]] number {}", index + 1),
                    Some(table),
                    item.span(),
                    self.complaints,
                )),
                None => self.wrong_type(key, item, &format!("tables headed [[{key}]]")),
            }
        }
        sections
    }

    pub(crate) fn text(&self, key: &str) -> Option<&'a str> {
        let value = self.value(key)?;
        let Some(text) = value.get_ref().as_str() else {
            self.wrong_type(key, value, "a string");
            return None;
        };
        if text.trim().is_empty() {
            self.complaints.add(value.span(), format!("`{key}` is empty"), None);
            return None;
        }
        Some(text)
    }

    pub(crate) fn required_text(&self, key: &str) -> Option<&'a str> {
        if !self.has(key) {
            self.value(key);
            self.missing(key);
            return None;
        }
        self.text(key)
    }

    /// One of a few words, each with its meaning.
    pub(crate) fn choice<T: Copy>(&self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        let text = self.text(key)?;
        let found = choices.iter().find(|(word, _)| *word == text).map(|(_, meaning)| *meaning);
        if found.is_none() {
            let words: Vec<_> = choices.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            let help = nearest(text, choices.iter().map(|(word, _)| *word))
                .map(|word| format!("did you mean \"{word}\"?"));
            self.complaints.add(
                self.span_of(key),
                format!("`{key}` is \"{text}\"; expected {}", alternatives(&words)),
                help,
            );
        }
        found
    }

    pub(crate) fn required_choice<T: Copy>(&self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        if !self.has(key) {
            self.value(key);
            self.missing(key);
            return None;
        }
        self.choice(key, choices)
    }

    /// A number within `range`, as written (in the unit its key names).
    pub(crate) fn number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let value = self.value(key)?;
        self.checked_number(key, value, &range)
    }

    pub(crate) fn required_number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        if !self.has(key) {
            self.value(key);
            self.missing(key);
            return None;
        }
        self.number(key, range)
    }

    /// `N` numbers, each within `range`.
    pub(crate) fn numbers<const N: usize>(
        &self,
        key: &str,
        range: RangeInclusive<f64>,
    ) -> Option<[f64; N]> {
        let value = self.value(key)?;
        self.checked_numbers(key, value, &range)
    }

    /// Pairs of numbers, each within `range`; `None` if there are none.
    pub(crate) fn pairs(&self, key: &str, range: &RangeInclusive<f64>) -> Option<Vec<[f64; 2]>> {
        let value = self.value(key)?;
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "an array of pairs of numbers");
            return None;
        };
        let pairs: Vec<_> =
            array.iter().map(|item| self.checked_numbers(key, item, range)).collect();
        if pairs.is_empty() {
            self.complaints.add(value.span(), format!("`{key}` is empty"), None);
            return None;
        }
        pairs.into_iter().collect()
    }

    /// As many numbers as there are, each within `range`; none if the key is absent.
    pub(crate) fn list(&self, key: &str, range: &RangeInclusive<f64>) -> Option<Vec<f64>> {
        let value = self.value(key)?;
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "an array of numbers");
            return None;
        };
        let list: Vec<_> = array.iter().map(|item| self.checked_number(key, item, range)).collect();
        list.into_iter().collect()
    }

    /// Where it is.
    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self, key: &str) -> Option<bool> {
        let value = self.value(key)?;
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(key, value, "true or false");
        }
        flag
    }

    /// Pairs of names, each with its place in the file; none if the key is absent.
    pub(crate) fn pairs_of_names(&self, key: &str) -> Vec<([String; 2], Range<usize>)> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "an array of pairs of names");
            return Vec::new();
        };
        let pair = |item: &Spanned<DeValue<'_>>| {
            let pair = item.get_ref().as_array()?;
            let names = pair.iter().map(|name| name.get_ref().as_str().map(str::to_owned));
            let names: Option<Vec<_>> = names.collect();
            Some((names?.try_into().ok()?, item.span()))
        };
        let mut pairs = Vec::new();
        for item in array {
            match pair(item) {
                Some(pair) => pairs.push(pair),
                None => self.wrong_type(key, item, "a pair of names"),
            }
        }
        pairs
    }

    fn checked_numbers<const N: usize>(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        range: &RangeInclusive<f64>,
    ) -> Option<[f64; N]> {
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, &format!("an array of {N} numbers"));
            return None;
        };
        if array.iter().count() != N {
            let found = array.iter().count();
            let message = format!("`{key}` has {found} entries; expected {N} numbers");
            self.complaints.add(value.span(), message, None);
            return None;
        }
        let mut numbers = [0.0; N];
        let mut complete = true;
        for (slot, item) in numbers.iter_mut().zip(array.iter()) {
            match self.checked_number(key, item, range) {
                Some(number) => *slot = number,
                None => complete = false,
            }
        }
        complete.then_some(numbers)
    }

    pub(crate) fn required_integer(&self, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
        if !self.has(key) {
            self.value(key);
            self.missing(key);
            return None;
        }
        self.integer(key, range)
    }

    /// Whole numbers within `range`, up to `most` of them; none if the key is absent.
    pub(crate) fn integers(&self, key: &str, range: &RangeInclusive<i64>, most: usize) -> Vec<i64> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "an array of whole numbers");
            return Vec::new();
        };
        if array.iter().count() > most {
            let message = format!("`{key}` has more than {most} entries");
            self.complaints.add(value.span(), message, None);
            return Vec::new();
        }
        array.iter().filter_map(|item| self.checked_integer(key, item, range)).collect()
    }

    pub(crate) fn required_numbers<const N: usize>(
        &self,
        key: &str,
        range: RangeInclusive<f64>,
    ) -> Option<[f64; N]> {
        if !self.has(key) {
            self.value(key);
            self.missing(key);
            return None;
        }
        self.numbers(key, range)
    }

    /// A whole number within `range`.
    pub(crate) fn integer(&self, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
        let value = self.value(key)?;
        self.checked_integer(key, value, &range)
    }

    fn checked_integer(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        range: &RangeInclusive<i64>,
    ) -> Option<i64> {
        let Some(integer) = value.get_ref().as_integer() else {
            self.wrong_type(key, value, "a whole number");
            return None;
        };
        let parsed = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
        let found = parsed.filter(|number| range.contains(number));
        if found.is_none() {
            let text = integer.to_string();
            self.out_of_range(key, value.span(), &text, range.start(), range.end());
        }
        found
    }

    fn checked_number(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        range: &RangeInclusive<f64>,
    ) -> Option<f64> {
        let (text, number) = match value.get_ref() {
            DeValue::Float(float) => (float.to_string(), float.as_str().parse().ok()),
            DeValue::Integer(integer) if integer.radix() == 10 => {
                (integer.to_string(), integer.as_str().parse().ok())
            }
            DeValue::Integer(integer) => {
                let whole = u32::from_str_radix(integer.as_str(), integer.radix());
                (integer.to_string(), whole.ok().map(f64::from))
            }
            _ => {
                self.wrong_type(key, value, "a number");
                return None;
            }
        };
        let number = number.filter(|number| range.contains(number));
        if number.is_none() {
            self.out_of_range(key, value.span(), &text, range.start(), range.end());
        }
        number
    }

    fn out_of_range<T: std::fmt::Display>(
        &self,
        key: &str,
        span: Range<usize>,
        text: &str,
        low: &T,
        high: &T,
    ) {
        let message = format!("`{key}` is {text}; it must lie between {low} and {high}");
        self.complaints.add(span, message, None);
    }

    /// Lets every key pass, where an earlier complaint keeps the section from being read.
    pub(crate) fn accept_all(&self) {
        let keys = self.table.into_iter().flatten().map(|(key, _)| key.get_ref().to_string());
        self.known.borrow_mut().extend(keys);
    }

    /// To be called when everything has been read: keys nobody asked for are unknown.
    pub(crate) fn finish(self) {
        self.check_unknown();
    }

    /// As [`Self::finish`], for a section that is still used.
    pub(crate) fn check_unknown(&self) {
        let Some(table) = self.table else { return };
        let known = self.known.borrow();
        for (key, _) in table {
            let name: &str = key.get_ref();
            if known.iter().any(|known| known == name) {
                continue;
            }
            // What is there already is not what was meant.
            let absent = known.iter().map(String::as_str).filter(|known| !self.has(known));
            let help = match nearest(name, absent) {
                Some(known) => format!("did you mean `{known}`?"),
                None => format!("known here: {}", known.join(", ")),
            };
            let message = format!("unknown key `{name}` in {}", self.name);
            self.complaints.add(key.span(), message, Some(help));
        }
    }
}

/// The candidate that a mistyped `word` most likely stands for.
fn nearest<'c>(word: &str, candidates: impl Iterator<Item = &'c str>) -> Option<&'c str> {
    candidates
        .map(|candidate| (strsim::jaro_winkler(word, candidate), candidate))
        .filter(|(similarity, _)| *similarity > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// "a", "a or b", "a, b or c".
fn alternatives(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [before @ .., last] => format!("{} or {last}", before.join(", ")),
    }
}
