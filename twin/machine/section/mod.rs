//! TOML reader of machine files, jobs and cams: every value knows its place, and every error names it.

mod file_kind;
mod keys;
mod numbers;
mod problem;
mod recording;

pub use file_kind::FileKind;
pub(crate) use problem::load;
pub use problem::{Elsewhere, MachineFileError, Problem, Shown};
use recording::Recording;
pub use recording::{Expected, KeyUse};
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Collector of the errors of a file, so that a user sees all of them at once.
#[derive(Debug, Default)]
pub(crate) struct Complaints {
    list: RefCell<Vec<Problem>>,
    /// Keys that readers ask for, where the reference wants to know them.
    recording: Option<Recording>,
}

impl Complaints {
    /// Adds a problem at `span` of the file.
    pub(crate) fn add(&self, span: Range<usize>, message: String, help: Option<String>) {
        self.list.borrow_mut().push(Problem { span, message, help, elsewhere: None });
    }

    fn add_elsewhere(&self, span: Range<usize>, elsewhere: Elsewhere) {
        let message = elsewhere.to_string();
        let elsewhere = Some(Arc::new(elsewhere));
        self.list.borrow_mut().push(Problem { span, message, help: None, elsewhere });
    }

    fn enter(&self, of: Option<(usize, &str)>, many: bool) -> usize {
        self.recording.as_ref().map_or(0, |recording| recording.enter(of, many))
    }

    /// All problems, in the order in which they were found.
    pub(crate) fn into_list(self) -> Vec<Problem> {
        let mut list = self.list.into_inner();
        list.sort_by_key(|problem| problem.span.start);
        list
    }
}

/// Parses a file's text and passes its root section to `read`.
///
/// # Errors
/// With everything that is wrong with it, in file order.
pub fn parse<T>(
    text: &str,
    read: impl FnOnce(&Section<'_>) -> Option<T>,
) -> Result<T, Vec<Problem>> {
    let (result, _) = parse_with(text, None, read)?;
    Ok(result)
}

/// As [`parse`], with every key that `read` asks for.
///
/// # Errors
/// As [`parse`].
pub fn parse_recorded<T>(
    text: &str,
    read: impl FnOnce(&Section<'_>) -> Option<T>,
) -> Result<(T, Vec<KeyUse>), Vec<Problem>> {
    let (result, recording) = parse_with(text, Some(Recording::default()), read)?;
    Ok((result, recording.map_or_else(Vec::new, Recording::into_uses)))
}

fn parse_with<T>(
    text: &str,
    recording: Option<Recording>,
    read: impl FnOnce(&Section<'_>) -> Option<T>,
) -> Result<(T, Option<Recording>), Vec<Problem>> {
    let table = DeTable::parse(text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        vec![Problem { span, message: error.message().to_owned(), help: None, elsewhere: None }]
    })?;
    let mut complaints = Complaints { recording, ..Complaints::default() };
    let result = read(&Section::root(&table, &complaints));
    let recording = complaints.recording.take();
    let problems = complaints.into_list();
    match result {
        Some(result) if problems.is_empty() => Ok((result, recording)),
        _ => Err(problems),
    }
}

/// One table of the file. It records the keys that are read: the others are unknown keys.
#[derive(Debug)]
pub struct Section<'a> {
    name: String,
    table: Option<&'a DeTable<'a>>,
    span: Range<usize>,
    complaints: &'a Complaints,
    known: RefCell<Vec<String>>,
    /// Number in the recording.
    number: usize,
}

impl<'a> Section<'a> {
    /// The file as a whole.
    pub(crate) fn root(table: &'a Spanned<DeTable<'a>>, complaints: &'a Complaints) -> Self {
        let number = complaints.enter(None, false);
        let name = "the file".to_owned();
        Self { number, ..Self::new(name, Some(table.get_ref()), 0..0, complaints) }
    }

    fn new(
        name: String,
        table: Option<&'a DeTable<'a>>,
        span: Range<usize>,
        complaints: &'a Complaints,
    ) -> Self {
        Self { name, table, span, complaints, known: RefCell::default(), number: 0 }
    }

    /// Complains about this section as a whole.
    pub fn complain(&self, message: impl Into<String>) {
        self.complaints.add(self.span.clone(), message.into(), None);
    }

    /// Complains about the value of `key`, or about the section if the key is absent.
    pub fn complain_at(&self, key: &str, message: impl Into<String>) {
        self.complaints.add(self.span_of(key), message.into(), None);
    }

    /// Complains about the value of `key`, with what would be right.
    pub(crate) fn complain_with_help(&self, key: &str, message: String, help: Option<String>) {
        self.complaints.add(self.span_of(key), message, help);
    }

    /// The keys that have been read.
    pub fn asked_for(&self) -> std::collections::BTreeSet<String> {
        self.known.borrow().iter().cloned().collect()
    }

    /// Complains about the value of `key`, which names a file that something is wrong with.
    pub(crate) fn complain_elsewhere(&self, key: &str, elsewhere: Elsewhere) {
        self.complaints.add_elsewhere(self.span_of(key), elsewhere);
    }

    /// The keys that are there, none of which is unknown then.
    pub fn keys(&self) -> Vec<&'a str> {
        self.has_free_names();
        self.accept_all();
        self.table.into_iter().flatten().map(|(key, _)| key.get_ref().as_ref()).collect()
    }

    /// Complains about a place known from before.
    pub(crate) fn complain_over(&self, span: &Range<usize>, message: String) {
        self.complaints.add(span.clone(), message, None);
    }

    /// Place of the value of `key`; that of the section, if the key is absent.
    pub fn span_of(&self, key: &str) -> Range<usize> {
        self.look_up(key).map_or_else(|| self.span.clone(), Spanned::span)
    }

    /// Place of entry `index` of the array `key`, from 0; complains about nothing and leaves the key unknown.
    pub(crate) fn span_of_item(&self, key: &str, index: usize) -> Option<Range<usize>> {
        let array = self.look_up(key)?.get_ref().as_array()?;
        array.get(index).map(Spanned::span)
    }

    /// The text of `key`, if that is what it is; complains about nothing and leaves the key unknown.
    pub fn glance_at_text(&self, key: &str) -> Option<&'a str> {
        self.look_up(key)?.get_ref().as_str()
    }

    /// True if the section has the key, which stays unknown.
    pub fn has(&self, key: &str) -> bool {
        self.look_up(key).is_some()
    }

    /// Marks `key` as known, without reading it.
    pub fn accept(&self, key: &str) {
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

    /// Complains if `key` is missing, which is known then.
    fn require(&self, key: &str) -> Option<()> {
        if !self.has(key) {
            self.value(key);
            self.complain(format!("{} lacks `{key}`", self.name));
        }
        self.has(key).then_some(())
    }

    /// The entries of an array; complains if `value` is something else.
    fn array<'v>(
        &self,
        key: &str,
        value: &'v Spanned<DeValue<'a>>,
        expected: &str,
    ) -> Option<&'v DeArray<'a>> {
        let array = value.get_ref().as_array();
        if array.is_none() {
            self.wrong_type(key, value, expected);
        }
        array
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
    #[must_use]
    pub fn section(&self, key: &str) -> Section<'a> {
        self.note(key, false, || Expected::Table);
        let value = self.value(key);
        let table = value.and_then(|value| {
            let table = value.get_ref().as_table();
            if table.is_none() {
                self.wrong_type(key, value, "a table");
            }
            table
        });
        let span = value.map_or_else(|| self.span.clone(), Spanned::span);
        let number = self.complaints.enter(Some((self.number, key)), false);
        Section { number, ..Section::new(format!("[{key}]"), table, span, self.complaints) }
    }

    /// An array of tables (`[[key]]`), empty if absent.
    pub fn sections(&self, key: &str) -> Vec<Section<'a>> {
        self.note(key, false, || Expected::Tables);
        let Some(value) = self.value(key) else { return Vec::new() };
        let expected = format!("tables headed [[{key}]]");
        let Some(array) = self.array(key, value, &expected) else { return Vec::new() };
        let mut sections = Vec::new();
        for (index, item) in array.iter().enumerate() {
            match item.get_ref().as_table() {
                Some(table) => {
                    let number = self.complaints.enter(Some((self.number, key)), true);
                    let name = format!("[[{key}]] number {}", index + 1);
                    let section = Section::new(name, Some(table), item.span(), self.complaints);
                    sections.push(Section { number, ..section });
                }
                None => self.wrong_type(key, item, &expected),
            }
        }
        sections
    }

    /// The text of `key`, if it is there.
    pub fn text(&self, key: &str) -> Option<&'a str> {
        self.note(key, false, || Expected::Text);
        self.text_of(key)
    }

    fn text_of(&self, key: &str) -> Option<&'a str> {
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

    /// The text of `key`; a problem if it is missing.
    pub fn required_text(&self, key: &str) -> Option<&'a str> {
        self.note(key, true, || Expected::Text);
        self.require(key)?;
        self.text(key)
    }

    /// One of a few words, each with its meaning.
    pub fn choice<T: Copy>(&self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        self.note(key, false, || choice_of(choices));
        let text = self.text_of(key)?;
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

    /// One of the `choices` by its name; a problem if `key` is missing or names none of them.
    pub fn required_choice<T: Copy>(&self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        self.note(key, true, || choice_of(choices));
        self.require(key)?;
        self.choice(key, choices)
    }

    /// Place of the section.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// `true` or `false`.
    pub fn flag(&self, key: &str) -> Option<bool> {
        self.note(key, false, || Expected::Flag);
        let value = self.value(key)?;
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(key, value, "true or false");
        }
        flag
    }

    /// Pairs of names, each with its place in the file; none if the key is absent.
    pub(crate) fn pairs_of_names(&self, key: &str) -> Vec<([String; 2], Range<usize>)> {
        self.note(key, false, || Expected::NamePairs);
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(array) = self.array(key, value, "an array of pairs of names") else {
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

    /// The `N` names of `key`; a problem if it is missing or something else.
    pub(crate) fn required_names<const N: usize>(&self, key: &str) -> Option<[&'a str; N]> {
        self.note(key, true, || Expected::Names(N));
        self.require(key)?;
        let value = self.value(key)?;
        let array = self.array(key, value, &format!("an array of {N} names"))?;
        let names: Option<Vec<_>> = array.iter().map(|name| name.get_ref().as_str()).collect();
        let names = names.and_then(|names| names.try_into().ok());
        if names.is_none() {
            self.complain_at(key, format!("`{key}` has to be {N} names"));
        }
        names
    }

    /// Lets every key pass, where an earlier complaint keeps the section from being read.
    pub fn accept_all(&self) {
        let keys = self.table.into_iter().flatten().map(|(key, _)| key.get_ref().to_string());
        self.known.borrow_mut().extend(keys);
    }

    /// Ends reading: reports keys that were not read as unknown.
    pub fn finish(self) {
        self.check_unknown();
    }

    /// As [`Self::finish`], for a section that is still used.
    pub fn check_unknown(&self) {
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

fn choice_of<T>(choices: &[(&str, T)]) -> Expected {
    Expected::Choice(choices.iter().map(|(word, _)| (*word).to_owned()).collect())
}

/// The candidate that a mistyped `word` was most likely meant to be.
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
