//! Assumptions by name, as people write them: `name` and `value` of `name = value`.

use std::{fmt::Display, ops::RangeInclusive, str::FromStr};

use crate::OpenQuestion;

/// What is assumed about a family, by name.
pub trait Assumed: Default + PartialEq {
    /// Names, those of the fields. What is within a field has its name after it, as in `exceptions_value`.
    const NAMES: &'static [&'static str];
    /// What the manual leaves open about the family.
    const QUESTIONS: &'static [OpenQuestion];

    /// Assumes something else. `-` in a name is as good as `_`.
    ///
    /// # Errors
    /// If there is no such assumption, or it cannot be so.
    fn set(&mut self, name: &str, value: &str) -> Result<(), AssumedError>;

    /// The question that an assumption answers.
    fn question(name: &str) -> Option<&'static OpenQuestion> {
        let of = |option: &str| {
            option.strip_prefix("Assumptions.").is_some_and(|field| name.starts_with(field))
        };
        // One name may begin like another, shorter one.
        let found = Self::QUESTIONS.iter().filter(|question| of(question.option));
        found.max_by_key(|question| question.option.len())
    }

    /// What is assumed if nothing is said, as [`Self::set`] takes it; none if there is no such assumption.
    fn usual(name: &str) -> Option<String> {
        let is_usual = |value: &str| {
            let mut assumed = Self::default();
            assumed.set(name, value).is_ok() && assumed == Self::default()
        };
        let allowed = Self::allowed(name)?;
        // Choices are named in what is allowed, numbers in the question.
        let shown = Self::question(name).map_or("", |question| question.default);
        let numbers = shown.split(|letter: char| !letter.is_ascii_digit());
        let mut values = allowed.split(" or ").chain(numbers.filter(|digits| !digits.is_empty()));
        values.find(|value| is_usual(value)).map(str::to_owned)
    }

    /// The unit of an assumption that is a number, or what it counts; empty for others.
    fn unit(_name: &str) -> &'static str {
        ""
    }

    /// What an assumption can be, in words; none if there is no such assumption.
    fn allowed(name: &str) -> Option<String> {
        match Self::default().set(name, "") {
            Err(AssumedError::Value { allowed, .. }) => Some(allowed),
            _ => None,
        }
    }
}

/// What cannot be assumed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AssumedError {
    /// There is no such assumption.
    #[error("there is no assumption `{name}`; there are {}", known.join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
        /// All there are.
        known: &'static [&'static str],
    },
    /// It cannot be so.
    #[error("{name} = `{value}`: it can be {allowed}")]
    Value {
        /// The assumption.
        name: String,
        /// What was asked for.
        value: String,
        /// What can be asked for.
        allowed: String,
    },
}

/// Name and value, as they were said.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Said<'a> {
    pub(crate) name: &'a str,
    pub(crate) value: &'a str,
}

impl Said<'_> {
    fn bad(&self, allowed: String) -> AssumedError {
        AssumedError::Value { name: self.name.to_owned(), value: self.value.to_owned(), allowed }
    }

    pub(crate) fn yes_no(&self, field: &mut bool) -> Result<(), AssumedError> {
        self.choice(field, &[("true", true), ("false", false)])
    }

    pub(crate) fn choice<T: Copy>(
        &self,
        field: &mut T,
        choices: &[(&str, T)],
    ) -> Result<(), AssumedError> {
        let value = self.value.replace('_', "-");
        let found = choices.iter().find(|(name, _)| name.eq_ignore_ascii_case(&value));
        let Some((_, choice)) = found else {
            let names: Vec<_> = choices.iter().map(|(name, _)| *name).collect();
            return Err(self.bad(names.join(" or ")));
        };
        *field = *choice;
        Ok(())
    }

    pub(crate) fn number<T: FromStr + PartialOrd + Display>(
        &self,
        field: &mut T,
        range: &RangeInclusive<T>,
    ) -> Result<(), AssumedError> {
        let found = self.value.parse().ok().filter(|number| range.contains(number));
        let allowed = || self.bad(format!("{} to {}", range.start(), range.end()));
        *field = found.ok_or_else(allowed)?;
        Ok(())
    }

    /// A number or `none`.
    pub(crate) fn optional<T: FromStr + PartialOrd + Display>(
        &self,
        range: &RangeInclusive<T>,
    ) -> Result<Option<T>, AssumedError> {
        if self.value.eq_ignore_ascii_case("none") {
            return Ok(None);
        }
        let found = self.value.parse().ok().filter(|number| range.contains(number));
        let allowed = || self.bad(format!("none or {} to {}", range.start(), range.end()));
        found.ok_or_else(allowed).map(Some)
    }
}

/// The name with the signs of a field.
pub(crate) fn field(name: &str) -> String {
    name.to_lowercase().replace('-', "_")
}
