//! Parsing of command-line values: switches, numbers, addresses, times.

use crate::command::Failure;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::time::Duration;
use twin_drives::Values;

/// A number in a table.
pub(super) fn right(text: impl Display) -> comfy_table::Cell {
    comfy_table::Cell::new(format!("{text}")).set_alignment(comfy_table::CellAlignment::Right)
}

/// `on` or `off`.
pub(super) fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

/// `NAME=on` or `NAME=off`.
pub(super) fn switch(text: &str) -> Result<(String, bool), String> {
    let (name, state) = text.split_once('=').ok_or("expected OUTPUT=on or OUTPUT=off")?;
    match state.to_ascii_lowercase().as_str() {
        "on" | "1" => Ok((name.to_owned(), true)),
        "off" | "0" => Ok((name.to_owned(), false)),
        _ => Err(format!("`{state}` is neither on nor off")),
    }
}

/// `FIRST-LAST`, or one number, within `most`.
pub(super) fn addresses(
    text: &str,
    most: RangeInclusive<u8>,
) -> Result<RangeInclusive<u8>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let number = |text: &str| text.trim().parse::<u8>().ok().filter(|one| most.contains(one));
    match (number(first), number(last)) {
        (Some(first), Some(last)) if first <= last => Ok(first..=last),
        _ => Err(format!("expected FIRST-LAST within {}-{}", most.start(), most.end())),
    }
}

/// A number, decimal or hexadecimal (`0x1F`, `$1F`).
pub(super) fn integer(text: &str) -> Option<i64> {
    match text.strip_prefix("0x").or_else(|| text.strip_prefix('$')) {
        Some(digits) if digits.starts_with(['+', '-']) => None,
        Some(digits) => i64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// As [`integer`], for clap.
pub(super) fn value(text: &str) -> Result<i64, String> {
    integer(text).ok_or_else(|| format!("`{text}` is not a whole number"))
}

/// Milliseconds, more than none and no more than a minute.
pub(super) fn milliseconds(text: &str) -> Result<Duration, String> {
    let number = text.parse().ok().filter(|ms| (1..=60_000).contains(ms));
    number.map(Duration::from_millis).ok_or_else(|| "expected 1 to 60000 ms".to_owned())
}

/// Time that a move of `distance` increments may take, with its ramps: all values per second.
pub(super) fn patience(distance: f64, speed: f64, acceleration: f64) -> Duration {
    let seconds = distance.abs() / speed + 2.0 * speed / acceleration;
    // Twice as long, for what the drive makes of it, and some seconds.
    Duration::try_from_secs_f64(2.0 * seconds + 5.0).unwrap_or(Duration::MAX)
}

/// What a parameter was and is, with its unit. What the numbers mean is in brackets.
pub(super) fn changed(old: impl Display, new: impl Display, unit: &str) -> String {
    // Digits do not mark a legend: "1000 steps/s²" and "/32768" are units.
    let is_legend = ["=", ",", " to ", " or "].iter().any(|mark| unit.contains(mark))
        || matches!(unit, "bits" | "code" | "address");
    match unit {
        "" => format!("{old} -> {new}"),
        unit if is_legend => format!("{old} -> {new} ({unit})"),
        unit if unit.starts_with('/') => format!("{old} -> {new}{unit}"),
        unit => format!("{old} -> {new} {unit}"),
    }
}

/// Checks a value that a parameter is to have.
///
/// # Errors
/// If it does not take it, with what it takes; `unit` is that of the values, or what they mean.
pub(super) fn check_value(
    name: &str,
    value: i64,
    (values, unit): (&Values, &str),
) -> Result<(), Failure> {
    if values.contain(value) {
        return Ok(());
    }
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    Err(Failure::Usage(format!("{name} = {value} is impossible: it takes {values}{unit}")))
}

/// Error of an unknown parameter number.
pub(super) fn unknown_number(number: i64, numbers: &str) -> Failure {
    Failure::Usage(format!("there is no parameter {number}: {numbers}; `get` lists all"))
}

/// Error of an unknown name, with the nearest known one.
pub(super) fn unknown_name<'a>(
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Failure {
    let wanted = name.to_lowercase();
    let distance = |known: &str| strsim::damerau_levenshtein(&known.to_lowercase(), &wanted);
    let nearest: BTreeMap<usize, &str> =
        known.into_iter().map(|known| (distance(known), known)).collect();
    let hint = match nearest.first_key_value() {
        Some((distance, name)) if *distance <= 4 => format!("; is `{name}` meant?"),
        _ => "; `get` lists all".to_owned(),
    };
    Failure::Usage(format!("there is no {what} `{name}`{hint}"))
}

#[cfg(test)]
mod tests {
    use super::{addresses, changed, integer, milliseconds, patience, switch, unknown_name};
    use std::time::Duration;

    #[test]
    fn switches_have_a_name_and_a_state() {
        assert_eq!(switch("3=on"), Ok(("3".to_owned(), true)));
        assert_eq!(switch("LED=OFF"), Ok(("LED".to_owned(), false)));
        assert!(switch("3").is_err() && switch("3=maybe").is_err());
    }

    #[test]
    fn a_change_has_its_unit_or_its_legend() {
        let message = |unit| changed(0, 5, unit);
        assert_eq!(message(""), "0 -> 5");
        assert_eq!(
            [message("rpm"), message("1000 steps/s²")],
            ["0 -> 5 rpm", "0 -> 5 1000 steps/s²"]
        );
        assert_eq!(message("/32768"), "0 -> 5/32768");
        let legends = ["0 = none, 1 = A with X", "bits, X first", "0 to 1023", "0 or 1", "code"];
        for legend in legends {
            assert_eq!(message(legend), format!("0 -> 5 ({legend})"));
        }
    }

    #[test]
    fn addresses_are_a_range_within_what_there_is() {
        assert_eq!(addresses("1-16", 1..=247), Ok(1..=16));
        assert_eq!(addresses("7", 1..=31), Ok(7..=7));
        for nonsense in ["0-3", "3-1", "1-32", "", "a-b", "1-2-3"] {
            assert!(addresses(nonsense, 1..=31).is_err(), "{nonsense}");
        }
    }

    #[test]
    fn numbers_are_decimal_or_hexadecimal() {
        assert_eq!(integer("-12"), Some(-12));
        assert_eq!((integer("0x1F"), integer("$1f")), (Some(31), Some(31)));
        assert_eq!((integer("1.5"), integer("$"), integer("0x-1")), (None, None, None));
        assert_eq!(milliseconds("250"), Ok(Duration::from_millis(250)));
        assert!(milliseconds("0").is_err() && milliseconds("60001").is_err());
    }

    #[test]
    fn patience_is_more_than_the_move_takes() {
        // 10 s at speed and half a second of each ramp.
        assert!(patience(-1000.0, 100.0, 200.0) > Duration::from_millis(10_500));
        assert_eq!(patience(1.0, 0.0, 0.0), Duration::MAX);
    }

    #[test]
    fn unknown_names_come_with_the_nearest() {
        let message = unknown_name("parameter", "trj_velmx", ["Trj_VelMax", "PID"]).to_string();
        assert!(message.contains("`Trj_VelMax`"), "{message}");
        let message = unknown_name("parameter", "nonsense", ["Trj_VelMax"]).to_string();
        assert!(!message.contains("Trj_VelMax"), "{message}");
    }
}
