//! Units of messages: millimetres.

/// `metres` in mm, without the noise of binary fractions: to the nanometre.
pub(crate) fn mm(metres: f64) -> f64 {
    let mm = metres * 1e3;
    let clean = (mm * 1e6).round() / 1e6;
    if clean.is_finite() && clean != 0.0 { clean } else { mm }
}

#[cfg(test)]
mod tests {
    use super::mm;

    #[test]
    fn without_noise() {
        for (metres, text) in [
            (0.003, "3"),
            (0.0041, "4.1"),
            (-0.1, "-100"),
            (0.0, "0"),
            (1e-12, "0.000000001"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(mm(metres).to_string(), text);
        }
    }
}
