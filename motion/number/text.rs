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

/// Below this, and from [`LARGE`] on, zeros would hide what a number says.
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
    // As many digits, and those behind them left away.
    let scientific = format!("{value:.17e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let kept: String = mantissa.chars().take(digits + 1).collect();
    format!("{kept}e{exponent}").parse().map_or(near, |kept| readable(kept, digits))
}

/// A part of what a value stands beside that is rounding.
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

/// A value and a limit that it exceeds, with six significant digits, or as many more as it takes to tell them apart.
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

/// To 12 significant digits: what conversion between units adds beyond is noise (239.99999999999997).
pub fn rounded(value: f64) -> f64 {
    significant(value, 12).parse().unwrap_or(value)
}

/// Nanoseconds as seconds.
#[expect(clippy::cast_precision_loss, reason = "a program of 104 days would lose a nanosecond")]
pub fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    use super::{apart, at_most, beside, exact_seconds, fixed, readable, significant};

    #[test]
    fn people_get_powers_of_ten_instead_of_zeros() {
        for (value, text) in [
            (6e-16, "6e-16"),
            (-1.234_567_8e300, "-1.23457e300"),
            (9.999_999_9e-10, "1e-9"),
            (1e-9, "0.000000001"),
            (999_999_000_000_000.0, "999999000000000"),
            (1e15, "1e15"),
            (0.0, "0"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(readable(value, 6), text);
        }
        assert_eq!(at_most(5.999_999_96e-16, 6), "5.99999e-16");
        assert_eq!(at_most(6e-16, 6), "6e-16");
        assert_eq!(apart(2e-12, 1.999_999_9e-12), ["2e-12", "1.9999999e-12"]);
    }

    #[test]
    fn nothing_has_no_sign() {
        for (value, decimals, text) in [
            (-0.04, 1, "0.0"),
            (-0.0, 1, "0.0"),
            (-0.4, 0, "0"),
            (-0.05, 2, "-0.05"),
            (-10.0, 1, "-10.0"),
            (0.04, 1, "0.0"),
        ] {
            assert_eq!(fixed(value, decimals), text);
        }
    }

    #[test]
    fn dust_is_nothing_and_what_exceeds_is_more() {
        assert_eq!(beside(4.4e-16, 360.0, 6), "0");
        assert_eq!(beside(-4.4e-16, -1.0, 6), "0");
        assert_eq!(beside(4.4e-16, 1e-15, 6), "4.4e-16");
        assert_eq!(beside(0.0, 0.0, 6), "0");
        assert_eq!(beside(1.999_999_967, 1.0, 6), "2");
        assert_eq!(apart(205.123_456_789, 205.0), ["205.123", "205"]);
        assert_eq!(apart(205.000_000_4, 205.0), ["205.0000004", "205"]);
        assert_eq!(apart(-3.0, 2.0), ["-3", "2"]);
        assert_eq!(apart(1.0, 1.0), ["1", "1"]);
    }

    #[test]
    fn what_may_not_be_exceeded_is_not_rounded_up() {
        assert_eq!(at_most(361.127_73, 6), "361.127");
        assert_eq!(at_most(361.127_23, 6), "361.127");
        assert_eq!(at_most(0.000_999_999_7, 6), "0.000999999");
        assert_eq!(at_most(299.999_999_999_999_94, 6), "300");
        assert_eq!(at_most(7.0, 6), "7");
        assert_eq!(at_most(0.0, 6), "0");
        assert_eq!(at_most(f64::INFINITY, 6), "inf");
    }

    #[test]
    fn digits_are_significant_not_decimal() {
        assert_eq!(significant(0.0, 12), "0");
        assert_eq!(significant(-0.0, 12), "0");
        assert_eq!(significant(std::f64::consts::PI, 12), "3.14159265359");
        assert_eq!(significant(100.0 * std::f64::consts::PI, 12), "314.159265359");
        assert_eq!(significant(-std::f64::consts::PI * 1e-6, 12), "-0.00000314159265359");
        assert_eq!(significant(9.999_96, 5), "10");
        assert_eq!(significant(1234.5, 12), "1234.5");
        assert_eq!(significant(123_456.0, 3), "123456");
        assert_eq!(significant(f64::INFINITY, 3), "inf");
    }

    #[test]
    fn times_are_exact() {
        for (ns, text) in [
            (0, "0"),
            (1, "0.000000001"),
            (1_500_000_000, "1.5"),
            (86_400_000_000_001, "86400.000000001"),
            (-2_000_000, "-0.002"),
            (i64::MAX, "9223372036.854775807"),
        ] {
            assert_eq!(exact_seconds(ns), text);
        }
    }
}
