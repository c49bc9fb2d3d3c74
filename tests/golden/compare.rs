//! Compares what was printed with what was expected.

use serde_json::Value;

/// Every expected line must be matched by the line of the same number: each key given must be there, numbers within
/// `tolerance`.
pub(crate) fn json_lines(expected: &str, actual: &str, tolerance: f64) -> Vec<String> {
    let expected: Vec<_> = lines(expected).collect();
    let actual: Vec<_> = lines(actual).collect();
    let mut wrong = Vec::new();
    if expected.len() != actual.len() {
        wrong.push(format!("{} lines printed, {} expected", actual.len(), expected.len()));
    }
    for (number, (expected, actual)) in expected.into_iter().zip(actual).enumerate() {
        match (serde_json::from_str(expected), serde_json::from_str(actual)) {
            (Ok(expected), Ok(actual)) => {
                differ(&format!("line {}", number + 1), &expected, &actual, tolerance, &mut wrong);
            }
            (Err(error), _) => wrong.push(format!("expected line {}: {error}", number + 1)),
            (_, Err(error)) => {
                wrong.push(format!("printed line {}: {error}: {actual}", number + 1));
            }
        }
    }
    wrong
}

fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.trim().is_empty())
}

fn differ(place: &str, expected: &Value, actual: &Value, tolerance: f64, wrong: &mut Vec<String>) {
    match (expected, actual) {
        (Value::Object(expected), Value::Object(actual)) => {
            for (key, value) in expected {
                match actual.get(key) {
                    Some(found) => {
                        differ(&format!("{place}.{key}"), value, found, tolerance, wrong);
                    }
                    None => wrong.push(format!("{place} lacks `{key}`")),
                }
            }
        }
        (Value::Array(expected), Value::Array(actual)) if expected.len() == actual.len() => {
            for (index, (expected, actual)) in expected.iter().zip(actual).enumerate() {
                differ(&format!("{place}[{index}]"), expected, actual, tolerance, wrong);
            }
        }
        (Value::Number(one), Value::Number(other)) => {
            let distance = one.as_f64().zip(other.as_f64()).map(|(one, other)| (one - other).abs());
            if distance.is_none_or(|distance| distance > tolerance) {
                wrong.push(format!("{place} is {other}, expected {one} ± {tolerance}"));
            }
        }
        (expected, actual) if expected == actual => {}
        (expected, actual) => wrong.push(format!("{place} is {actual}, expected {expected}")),
    }
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
    assert!(json_lines(r#"{"a":1}"#, r#"{"a":1.0000001,"b":2}"#, 1e-6).is_empty());
    assert_eq!(json_lines(r#"{"a":1}"#, r#"{"a":1.1}"#, 1e-6).len(), 1);
    assert_eq!(json_lines(r#"{"a":1}"#, "{}", 1e-6).len(), 1);
    assert_eq!(json_lines("{}\n{}", "{}", 1e-6).len(), 1);
    assert_eq!(json_lines(r#"{"a":[1,2]}"#, r#"{"a":[1]}"#, 1e-6).len(), 1);
    assert!(csv("1,2\nerror,too far", "1.0,2.0\nerror,too far away", 1e-9).is_empty());
    assert_eq!(csv("1,2", "1,2,3", 1e-9).len(), 1);
    assert_eq!(csv("1,2", "1,2.1", 1e-9).len(), 1);
    assert_eq!(csv("error,too far", "1,2", 1e-9).len(), 1);
}
