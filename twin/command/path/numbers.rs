//! Lists of numbers on the command line.

/// `text` as numbers with commas between: at least `least` and at most `N`, the others 0.
pub(super) fn list<const N: usize>(text: &str, least: usize) -> Result<[f64; N], String> {
    let mut numbers = [0.0; N];
    let mut count = 0;
    for part in text.split(',') {
        let number: f64 =
            part.trim().parse().ok().ok_or_else(|| format!("`{part}` is not a number"))?;
        let Some(slot) = numbers.get_mut(count) else {
            return Err(format!("more than {N} numbers"));
        };
        if !number.is_finite() || number.abs() > 1e9 {
            return Err(format!("{number} is beyond ±1e9"));
        }
        *slot = number;
        count += 1;
    }
    if count < least { Err(format!("fewer than {least} numbers")) } else { Ok(numbers) }
}

/// One number within `range`.
pub(super) fn within(text: &str, range: std::ops::RangeInclusive<f64>) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().ok().ok_or_else(|| format!("`{text}` is not a number"))?;
    if range.contains(&number) {
        Ok(number)
    } else {
        Err(format!("{number} is not between {} and {}", range.start(), range.end()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_numbers() {
        assert_eq!(list::<3>("1, -2.5", 2), Ok([1.0, -2.5, 0.0]));
        for (text, part) in [
            ("1", "fewer than 2"),
            ("1,2,3,4", "more than 3"),
            ("1,x", "`x` is not a number"),
            ("1,inf", "beyond"),
            ("", "not a number"),
        ] {
            assert!(list::<3>(text, 2).unwrap_err().contains(part), "{text}");
        }
        assert_eq!(within("5", 0.0..=10.0), Ok(5.0));
        assert!(within("nan", 0.0..=10.0).is_err() && within("11", 0.0..=10.0).is_err());
    }
}
