//! Round numbers along an axis, and numbers as text.

/// Round numbers from `low` to `high`, about `count` of them, with as many decimals as they need.
pub(super) fn ticks(low: f64, high: f64, count: f64) -> Vec<(f64, String)> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return vec![(low, short(low))];
    }
    let rough = span / count;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power);
    let step = step.into_iter().find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(power * 10.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few decimals")]
    let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize;
    let mut ticks = Vec::new();
    let mut number = (low / step - 1e-9).ceil();
    while number * step <= high + step * 1e-9 && ticks.len() < 100 {
        // Plus zero, so that zero has no sign.
        let value = number * step + 0.0;
        ticks.push((value, format!("{value:.decimals$}")));
        number += 1.0;
    }
    ticks
}

/// A number with at most three decimals.
pub fn short(value: f64) -> String {
    rounded(value, 3)
}

/// A number with at most this many decimals.
pub(super) fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A power of ten as text; nothing for 1.
pub(super) fn power_of_ten(power: i32) -> String {
    if power == 0 {
        return String::new();
    }
    let raised = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    };
    format!("10{} ", power.to_string().chars().map(raised).collect::<String>())
}
