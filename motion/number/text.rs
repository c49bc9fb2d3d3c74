//! Number formatting, for other programs and for people.

/// `value` with `digits` significant digits, in plain decimal notation, without trailing zeros. Not finite values
/// come out as Rust writes them.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    // Through the scientific form, which rounds correctly also where rounding adds a digit (9.9996 → 10.00).
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 =
        scientific.rsplit('e').next().and_then(|text| text.parse().ok()).unwrap_or(0);
    let decimals =
        i32::try_from(digits).unwrap_or(i32::MAX).saturating_sub(1).saturating_sub(exponent);
    let text = format!("{value:.*}", usize::try_from(decimals).unwrap_or(0));
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Below this magnitude, and from [`LARGE`] on, zeros would hide the digits.
const SMALL: f64 = 1e-9;
/// See [`SMALL`].
const LARGE: f64 = 1e15;

/// As [`significant`], for people: with a power of ten where zeros would hide the digits.
pub fn readable(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() || (SMALL..LARGE).contains(&value.abs()) {
        return significant(value, digits);
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    match scientific.split_once('e') {
        Some((mantissa, exponent)) if mantissa.contains('.') => {
            let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
            format!("{mantissa}e{exponent}")
        }
        _ => scientific,
    }
}

/// As [`readable`], for a value that must not be exceeded: no more than `value` except for rounding.
pub fn at_most(value: f64, digits: usize) -> String {
    let near = readable(value, digits);
    if near.parse().is_ok_and(|near: f64| near <= value + 1e-12 * value.abs()) {
        return near;
    }
    // The same digits, cut off instead of rounded.
    let scientific = format!("{value:.17e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let kept: String = mantissa.chars().take(digits + 1).collect();
    format!("{kept}e{exponent}").parse().map_or(near, |kept| readable(kept, digits))
}

/// Part of a scale that is rounding.
const DUST: f64 = 1e-12;

/// `value`, or 0 if it is rounding of values as large as `scale`.
pub fn without_dust(value: f64, scale: f64) -> f64 {
    if value.abs() <= DUST * scale.abs() { 0.0 } else { value }
}

/// As [`without_dust`], for people, with `digits` significant digits.
pub fn beside(value: f64, scale: f64, digits: usize) -> String {
    readable(without_dust(value, scale), digits)
}

/// `value` with `decimals` decimals, without a sign if it rounds to 0.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|digit| matches!(digit, b'0' | b'.')) => {
            digits.to_owned()
        }
        _ => text,
    }
}

/// A value and a limit that it exceeds, with six significant digits, or as many more as make them differ.
pub fn apart(value: f64, limit: f64) -> [String; 2] {
    let message = |digits: usize| [value, limit].map(|number| readable(number, digits));
    let differs = |[one, other]: &[String; 2]| one != other;
    (6..17).map(message).find(differs).unwrap_or_else(|| message(17))
}

/// A count with its noun, `what` being the singular.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Nanoseconds as seconds, exactly.
pub fn exact_seconds(time_ns: i64) -> String {
    let sign = if time_ns < 0 { "-" } else { "" };
    let ns = time_ns.unsigned_abs();
    let text = format!("{sign}{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Rounds to 12 significant digits: unit conversion adds noise beyond them (239.99999999999997).
pub fn rounded(value: f64) -> f64 {
    significant(value, 12).parse().unwrap_or(value)
}

/// Nanoseconds as seconds.
#[expect(clippy::cast_precision_loss, reason = "a program of 104 days would lose a nanosecond")]
pub fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-9
}
