//! Comparison of printed output with the expected output: JSON lines and CSV.

use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Every expected line must be matched by the line of the same number: each key given must be there, numbers within
/// `tolerance`, or within that of `tolerances` for the key they are under. An object with the only key `some` stands for an
/// array with these elements, among others and in any order.
pub(crate) fn json_lines(
    expected: &str,
    actual: &str,
    tolerance: f64,
    tolerances: &BTreeMap<String, f64>,
) -> Vec<String> {
    let mut differences = Differences { tolerances, wrong: Vec::new() };
    let expected: Vec<_> = lines(expected).collect();
    let actual: Vec<_> = lines(actual).collect();
    if expected.len() != actual.len() {
        differences.wrong.push(format!(
            "{} lines printed, {} expected",
            actual.len(),
            expected.len()
        ));
    }
    for (number, (expected, actual)) in expected.into_iter().zip(actual).enumerate() {
        match (serde_json::from_str(expected), serde_json::from_str(actual)) {
            (Ok(expected), Ok(actual)) => {
                differences.find(&format!("line {}", number + 1), &expected, &actual, tolerance);
            }
            (Err(error), _) => {
                differences.wrong.push(format!("expected line {}: {error}", number + 1));
            }
            (_, Err(error)) => {
                differences.wrong.push(format!("printed line {}: {error}: {actual}", number + 1));
            }
        }
    }
    differences.wrong
}

fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.trim().is_empty())
}

struct Differences<'a> {
    tolerances: &'a BTreeMap<String, f64>,
    wrong: Vec<String>,
}

impl Differences<'_> {
    fn find(&mut self, place: &str, expected: &Value, actual: &Value, tolerance: f64) {
        match (expected, actual) {
            (Value::Object(expected), Value::Array(actual)) if is_some(expected) => {
                self.find_some(place, &expected["some"], actual, tolerance);
            }
            (Value::Object(expected), Value::Object(actual)) => {
                for (key, value) in expected {
                    let tolerance = self.tolerances.get(key).copied().unwrap_or(tolerance);
                    match actual.get(key) {
                        Some(found) => {
                            self.find(&format!("{place}.{key}"), value, found, tolerance);
                        }
                        None => self.wrong.push(format!("{place} lacks `{key}`")),
                    }
                }
            }
            (Value::Array(expected), Value::Array(actual)) if expected.len() == actual.len() => {
                for (index, (expected, actual)) in expected.iter().zip(actual).enumerate() {
                    self.find(&format!("{place}[{index}]"), expected, actual, tolerance);
                }
            }
            (Value::Number(one), Value::Number(other)) => {
                let both = one.as_f64().zip(other.as_f64());
                if both.is_none_or(|(one, other)| (one - other).abs() > tolerance) {
                    self.wrong.push(format!("{place} is {other}, expected {one} ± {tolerance}"));
                }
            }
            (expected, actual) if expected == actual => {}
            (expected, actual) => {
                self.wrong.push(format!("{place} is {actual}, expected {expected}"));
            }
        }
    }

    /// Every element of `expected` is one of `actual`.
    fn find_some(&mut self, place: &str, expected: &Value, actual: &[Value], tolerance: f64) {
        for element in expected.as_array().into_iter().flatten() {
            let is = |actual: &Value| {
                let mut differences = Self { tolerances: self.tolerances, wrong: Vec::new() };
                differences.find(place, element, actual, tolerance);
                differences.wrong.is_empty()
            };
            if !actual.iter().any(is) {
                self.wrong.push(format!("{place} lacks {element} ± {tolerance}"));
            }
        }
    }
}

/// Whether the object names some elements of an array.
fn is_some(expected: &Map<String, Value>) -> bool {
    expected.len() == 1 && expected.contains_key("some")
}

/// Line by line and field by field: numbers within `tolerance`, other fields must begin with what is expected.
pub(crate) fn csv(expected: &str, actual: &str, tolerance: f64) -> Vec<String> {
    let expected: Vec<_> = lines(expected).filter(|line| !line.starts_with('#')).collect();
    let actual: Vec<_> = lines(actual).collect();
    let mut wrong = Vec::new();
    if expected.len() != actual.len() {
        wrong.push(format!("{} lines printed, {} expected", actual.len(), expected.len()));
    }
    for (number, (expected, actual)) in expected.iter().zip(&actual).enumerate() {
        let (one, other): (Vec<_>, Vec<_>) =
            (expected.split(',').collect(), actual.split(',').collect());
        let same = |one: &str, other: &str| match (one.trim().parse::<f64>(), other.parse::<f64>())
        {
            (Ok(one), Ok(other)) => (one - other).abs() <= tolerance,
            _ => other.trim_matches('"').starts_with(one.trim()),
        };
        let fits =
            one.len() <= other.len() && one.iter().zip(&other).all(|(one, other)| same(one, other));
        let numbers = one.iter().all(|field| field.trim().parse::<f64>().is_ok());
        if !fits || (numbers && one.len() != other.len()) {
            wrong.push(format!("line {}: {actual}, expected {expected} ± {tolerance}", number + 1));
        }
    }
    wrong
}

#[test]
fn differences_are_found() {
    let strict = BTreeMap::from([("a".to_owned(), 1e-9)]);
    assert_eq!(json_lines(r#"{"a":1}"#, r#"{"a":1.0000001}"#, 1e-6, &strict).len(), 1);
    assert!(json_lines(r#"{"b":1}"#, r#"{"b":1.0000001}"#, 1e-6, &strict).is_empty());
    let json = |one: &str, other: &str| json_lines(one, other, 1e-6, &BTreeMap::new());
    assert!(json(r#"{"a":1}"#, r#"{"a":1.0000001,"b":2}"#).is_empty());
    assert_eq!(json(r#"{"a":1}"#, r#"{"a":1.1}"#).len(), 1);
    assert_eq!(json(r#"{"a":1}"#, "{}").len(), 1);
    assert_eq!(json("{}\n{}", "{}").len(), 1);
    assert_eq!(json(r#"{"a":[1,2]}"#, r#"{"a":[1]}"#).len(), 1);
    let some = r#"{"a":{"some":[{"b":2}]}}"#;
    assert!(json(some, r#"{"a":[{"b":1},{"b":2,"c":3}]}"#).is_empty());
    assert_eq!(json(some, r#"{"a":[{"b":1}]}"#).len(), 1);
    assert!(csv("1,2\nerror,too far", "1.0,2.0\nerror,too far away", 1e-9).is_empty());
    assert_eq!(csv("1,2", "1,2,3", 1e-9).len(), 1);
    assert_eq!(csv("1,2", "1,2.1", 1e-9).len(), 1);
    assert_eq!(csv("error,too far", "1,2", 1e-9).len(), 1);
}
