//! Numbers of all dialects, read and written: `[+-]digits[.digits]`, without exponent (E is a word).

/// Powers of ten that are exact.
const POWERS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number `text` is, correctly rounded; infinite if it is too large. `None` if it is not a number.
pub(crate) fn parse(text: &[u8]) -> Option<f64> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    let mut mantissa: u64 = 0;
    let mut count = 0;
    let mut point = None;
    for byte in digits {
        match byte {
            b'0'..=b'9' => {
                mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                count += 1;
            }
            b'.' if point.is_none() => point = Some(count),
            _ => return None,
        }
    }
    if count == 0 {
        return None;
    }
    let decimals: usize = point.map_or(0, |point| count - point);
    // Up to 15 digits both operands are exact and the quotient is correctly rounded.
    let magnitude = match POWERS.get(decimals) {
        Some(power) if count <= 15 => {
            #[expect(clippy::cast_precision_loss, reason = "15 digits are less than 2^53")]
            let mantissa = mantissa as f64;
            mantissa / power
        }
        _ => std::str::from_utf8(digits).ok()?.parse().ok()?,
    };
    Some(if negative { -magnitude } else { magnitude })
}

/// Decimals that give back a number as it was.
pub(crate) const ALL_DECIMALS: usize = 16;

/// `value` with up to `decimals` decimals, without zeros at the end.
pub(crate) fn text(value: f64, decimals: usize) -> String {
    let text = if decimals >= ALL_DECIMALS {
        // The shortest that reads back as the same; it has no exponent.
        format!("{value}")
    } else {
        format!("{value:.decimals$}")
    };
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The written `value` as a decoder reads it.
pub(crate) fn read_back(value: f64, decimals: usize) -> f64 {
    // Values that are not finite are refused when written.
    parse(text(value, decimals).as_bytes()).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::parse;
    use proptest::prelude::*;

    #[test]
    fn numbers() {
        for (text, value) in [
            ("0", 0.0),
            ("007", 7.0),
            ("-.5", -0.5),
            ("+5.", 5.0),
            ("00.25", 0.25),
            ("-1234.5678", -1234.5678),
        ] {
            assert_eq!(
                parse(text.as_bytes()).map(f64::to_bits),
                Some(f64::to_bits(value)),
                "{text}"
            );
        }
        assert_eq!(parse(&[b'9'; 400]), Some(f64::INFINITY));
        for text in
            ["", "-", "+", ".", "-.", "1.2.3", "1-2", "--1", "+-1", "1,5", "1e5", "inf", "nan"]
        {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn as_the_standard_library(text in "[+-]?[0-9]{1,25}(\\.[0-9]{0,25})?") {
            prop_assert_eq!(parse(text.as_bytes()).map(f64::to_bits), text.parse().ok().map(f64::to_bits));
        }
    }
}
