//! Numbers of TOML tables, checked for type and range.

use super::{Expected, Section};
use std::ops::{Range, RangeInclusive};
use toml::Spanned;
use toml::de::DeValue;

impl Section<'_> {
    /// A number within `range`, as written (in the unit its key names).
    pub fn number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        self.note(key, false, || Expected::Number(range.clone()));
        let value = self.value(key)?;
        self.checked_number(key, value, &range)
    }

    /// The number of `key` within `range`; a problem if it is missing or outside.
    pub fn required_number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        self.note(key, true, || Expected::Number(range.clone()));
        self.require(key)?;
        self.number(key, range)
    }

    /// `N` numbers, each within `range`.
    pub fn numbers<const N: usize>(
        &self,
        key: &str,
        range: RangeInclusive<f64>,
    ) -> Option<[f64; N]> {
        self.note(key, false, || Expected::Numbers(N, range.clone()));
        let value = self.value(key)?;
        self.checked_numbers(key, value, &range)
    }

    /// Pairs of numbers, each within `range`; `None` if there are none.
    pub fn pairs(&self, key: &str, range: &RangeInclusive<f64>) -> Option<Vec<[f64; 2]>> {
        self.note(key, false, || Expected::NumberPairs(range.clone()));
        let value = self.value(key)?;
        let array = self.array(key, value, "an array of pairs of numbers")?;
        let pairs: Vec<_> =
            array.iter().map(|item| self.checked_numbers(key, item, range)).collect();
        if pairs.is_empty() {
            self.complaints.add(value.span(), format!("`{key}` is empty"), None);
            return None;
        }
        pairs.into_iter().collect()
    }

    /// As many numbers as there are, each within `range`; none if the key is absent.
    pub fn list(&self, key: &str, range: &RangeInclusive<f64>) -> Option<Vec<f64>> {
        self.note(key, false, || Expected::NumberList(range.clone()));
        let value = self.value(key)?;
        let array = self.array(key, value, "an array of numbers")?;
        let list: Vec<_> = array.iter().map(|item| self.checked_number(key, item, range)).collect();
        list.into_iter().collect()
    }

    fn checked_numbers<const N: usize>(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        range: &RangeInclusive<f64>,
    ) -> Option<[f64; N]> {
        let array = self.array(key, value, &format!("an array of {N} numbers"))?;
        let found = array.iter().count();
        if found != N {
            let message = format!("`{key}` has {found} entries; expected {N} numbers");
            self.complaints.add(value.span(), message, None);
            return None;
        }
        let numbers: Vec<_> =
            array.iter().map(|item| self.checked_number(key, item, range)).collect();
        numbers.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    /// The integer of `key` within `range`; a problem if it is missing or outside.
    pub(crate) fn required_integer(&self, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
        self.note(key, true, || Expected::Integer(range.clone()));
        self.require(key)?;
        self.integer(key, range)
    }

    /// The whole numbers of `key`, if that is what they are; complains about nothing and leaves the key unknown.
    pub(crate) fn glance_at_integers(&self, key: &str) -> Vec<i64> {
        let array = self.look_up(key).and_then(|value| value.get_ref().as_array());
        let number = |item: &Spanned<DeValue<'_>>| {
            let integer = item.get_ref().as_integer()?;
            i64::from_str_radix(integer.as_str(), integer.radix()).ok()
        };
        array.into_iter().flatten().filter_map(number).collect()
    }

    /// Whole numbers within `range`, up to `most` of them; none if the key is absent.
    pub(crate) fn integers(&self, key: &str, range: &RangeInclusive<i64>, most: usize) -> Vec<i64> {
        self.note(key, false, || Expected::Integers(most, range.clone()));
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(array) = self.array(key, value, "an array of whole numbers") else {
            return Vec::new();
        };
        if array.iter().count() > most {
            let message = format!("`{key}` has more than {most} entries");
            self.complaints.add(value.span(), message, None);
            return Vec::new();
        }
        array.iter().filter_map(|item| self.checked_integer(key, item, range)).collect()
    }

    /// The `N` numbers of `key`, each within `range`; a problem otherwise.
    pub(crate) fn required_numbers<const N: usize>(
        &self,
        key: &str,
        range: RangeInclusive<f64>,
    ) -> Option<[f64; N]> {
        self.note(key, true, || Expected::Numbers(N, range.clone()));
        self.require(key)?;
        self.numbers(key, range)
    }

    /// A whole number within `range`.
    pub fn integer(&self, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
        self.note(key, false, || Expected::Integer(range.clone()));
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
}
