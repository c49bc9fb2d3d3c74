//! Exact ratio of increments to units, written in decimals as machine files give it.
//!
//! A machine file says what its builder reads off gear, belt and encoder: 10000 increments per 3 mm, 3200 per
//! 3.14159265358979 mm. Both ways are exact but for one rounding at the end, so nothing adds up however far an axis goes
//! and however often.

/// increments = units · `increments` / `per_units`, exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecimalRatio {
    /// The axis counts the other way round.
    negative: bool,
    /// increments = units · `numerator` · 10^`power` / `denominator`, in lowest terms; `power` is 0 where that fits.
    numerator: u64,
    denominator: u64,
    /// 0 to 38.
    power: u32,
}

impl DecimalRatio {
    /// `increments` increments for `per_units` units, times 10^`power`: 3 makes millimetres metres.
    ///
    /// `per_units` counts as the shortest decimal that is read as this number: 9.525 is 9525/1000, as whoever wrote it meant.
    ///
    /// `None` if one of them is 0, `per_units` is negative, not finite or not between 10⁻¹² and 10¹⁵, or `power` is more
    /// than 9.
    pub fn new(increments: i64, per_units: f64, power: u32) -> Option<Self> {
        if increments == 0 || power > 9 || !(1e-12..=1e15).contains(&per_units) {
            return None;
        }
        // Never with an exponent; the shortest that is read back as the same number.
        let text = per_units.to_string();
        let (whole, decimals) = text.split_once('.').unwrap_or((&text, ""));
        let digits: u64 = format!("{whole}{decimals}").parse().ok()?;
        let places = u32::try_from(decimals.len()).ok()?;
        if digits == 0 {
            return None;
        }
        let (numerator, denominator) = lowest(increments.unsigned_abs(), digits);
        let mut ratio =
            Self { negative: increments < 0, numerator, denominator, power: places + power };
        // One ten after the other, as long as there is room.
        while ratio.power > 0 {
            let (ten, denominator) = lowest(10, ratio.denominator);
            let Some(numerator) = ratio.numerator.checked_mul(ten) else { break };
            (ratio.numerator, ratio.denominator) = lowest(numerator, denominator);
            ratio.power -= 1;
        }
        Some(ratio)
    }

    /// Increments, not whole ones, of a position, velocity or acceleration: the number nearest to them.
    pub fn increments_of(self, units: f64) -> f64 {
        self.converted(units, Way::ToIncrements)
    }

    /// Units of a number of increments, which may lie between whole ones: the number nearest to them.
    pub fn units_of(self, increments: f64) -> f64 {
        self.converted(increments, Way::ToUnits)
    }

    /// The whole increments nearest to a position, the even one of two; `None` if they do not fit 63 bits.
    pub fn increments(self, units: f64) -> Option<i64> {
        if !units.is_finite() {
            return None;
        }
        if let Some(nearest) = self.quickly(units, Way::ToIncrements).and_then(clearly_nearest) {
            return Some(nearest);
        }
        let size = self.divided(units.abs(), Way::ToIncrements).nearest()?;
        Some(if units.is_sign_negative() == self.negative { size } else { -size })
    }

    fn converted(self, value: f64, way: Way) -> f64 {
        let (times, over) = self.factors(way);
        let is_exact = times == 1 || over == 1;
        if let Some(nearest) = self.quickly(value, way).filter(|_| is_exact) {
            return nearest;
        }
        let size =
            if value.is_finite() { self.divided(value.abs(), way).rounded() } else { value.abs() };
        if value.is_sign_negative() == self.negative { size } else { -size }
    }

    /// By what to multiply and to divide, but for the power of ten.
    fn factors(self, way: Way) -> (u64, u64) {
        match way {
            Way::ToIncrements => (self.numerator, self.denominator),
            Way::ToUnits => (self.denominator, self.numerator),
        }
    }

    /// By a multiplication and a division of numbers, each with its rounding, if both factors are numbers without one.
    fn quickly(self, value: f64, way: Way) -> Option<f64> {
        let (times, over) = self.factors(way);
        if self.power > 0 || times.max(over) > 1 << f64::MANTISSA_DIGITS {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let size = value * times as f64 / over as f64;
        Some(if self.negative { -size } else { size })
    }

    /// `size` is finite and not negative.
    fn divided(self, size: f64, way: Way) -> Quotient {
        let (mantissa, exponent) = parts(size);
        if mantissa == 0 {
            return Quotient::default();
        }
        let (times, over) = self.factors(way);
        if self.power == 0 {
            // At most 117 bits.
            return narrow(u128::from(mantissa) * u128::from(times), over, exponent);
        }
        // Each has at most 64 bits.
        let half = self.power / 2;
        let tens = [half, self.power - half].map(|power| 10_u64.pow(power));
        let mut wide = Wide::of(mantissa);
        wide.times(times);
        if way == Way::ToIncrements {
            for ten in tens {
                wide.times(ten);
            }
        }
        let exponent = exponent - wide.raise();
        wide.over(over);
        if way == Way::ToUnits {
            for ten in tens {
                wide.over(ten);
            }
        }
        wide.quotient(exponent)
    }
}

/// The whole number nearest to `value`, if it is so even where two roundings have changed `value`.
fn clearly_nearest(value: f64) -> Option<i64> {
    let whole = value.round_ties_even();
    let is_clear = (value - whole).abs() < 0.5 - 4.0 * f64::EPSILON * value.abs();
    #[expect(clippy::cast_possible_truncation, reason = "smaller than 2^53 where it is clear")]
    let nearest = is_clear.then_some(whole as i64);
    nearest
}

/// Mantissa and exponent: `value` = mantissa · 2^exponent. `value` is finite and not negative.
fn parts(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    // 11 bits.
    let raised = i32::try_from(bits >> 52 & 0x7FF).unwrap_or(0);
    if raised == 0 { (fraction, -1074) } else { (fraction | 1 << 52, raised - 1075) }
}

/// From what to what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    ToIncrements,
    ToUnits,
}

/// What a division leaves: `size` · 2^`exponent`, and whether there is a rest.
#[derive(Clone, Copy, Debug, Default)]
struct Quotient {
    /// At least 64 significant bits, unless it is 0.
    size: u128,
    exponent: i32,
    inexact: bool,
}

impl Quotient {
    /// The nearest number.
    fn rounded(self) -> f64 {
        let sticky = self.size | u128::from(self.inexact);
        #[expect(
            clippy::cast_precision_loss,
            reason = "rounds to the nearest: this is the rounding"
        )]
        let rounded = sticky as f64;
        // In two goes: neither power is too large or too small for a number of its own.
        let half = self.exponent / 2;
        rounded * 2_f64.powi(half) * 2_f64.powi(self.exponent - half)
    }

    /// The nearest whole number, the even one of two, if it has at most 63 bits.
    fn nearest(self) -> Option<i64> {
        let Self { size, exponent, inexact } = self;
        let whole = match exponent {
            0.. => {
                let shift = exponent.unsigned_abs();
                if size != 0 && shift >= size.leading_zeros() {
                    return None;
                }
                size.checked_shl(shift).unwrap_or(0)
            }
            -127..0 => {
                let shift = exponent.unsigned_abs();
                let (whole, half) = (size >> shift, 1_u128 << (shift - 1));
                let rest = size & ((half << 1) - 1);
                let more = rest > half || rest == half && (inexact || whole % 2 == 1);
                whole + u128::from(more)
            }
            // Less than 2^128 / 2^128; half of it and more only where `size` has 128 bits.
            -128 => u128::from(size > 1 << 127 || size == 1 << 127 && inexact),
            _ => 0,
        };
        i64::try_from(whole).ok()
    }
}

/// A quotient whose numerator has at most 128 bits. `over` is not 0.
fn narrow(numerator: u128, over: u64, exponent: i32) -> Quotient {
    let shift = numerator.leading_zeros();
    let raised = numerator << shift;
    let over = u128::from(over.max(1));
    let exponent = exponent - i32::try_from(shift).unwrap_or(0);
    Quotient { size: raised / over, exponent, inexact: !raised.is_multiple_of(over) }
}

/// Two numbers without their common divisor. Neither is 0.
fn lowest(one: u64, other: u64) -> (u64, u64) {
    let (mut a, mut b) = (one, other);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (one / a.max(1), other / a.max(1))
}

/// 384 bits, the lowest first, and whether a division has left a rest. Room for 53 bits times three of 64; raised and divided
/// by three of 64 at least 128 bits are left.
#[derive(Clone, Copy, Debug)]
struct Wide {
    limbs: [u64; 6],
    rest: bool,
}

impl Wide {
    fn of(value: u64) -> Self {
        Self { limbs: [value, 0, 0, 0, 0, 0], rest: false }
    }

    fn times(&mut self, factor: u64) {
        let mut carry = 0_u128;
        for limb in &mut self.limbs {
            carry += u128::from(*limb) * u128::from(factor);
            (*limb, carry) = (low(carry), carry >> 64);
        }
    }

    /// Of nested divisions the quotients are those of one by the product, and there is a rest where one of them has one.
    fn over(&mut self, divisor: u64) {
        let divisor = u128::from(divisor.max(1));
        let mut rest = 0_u128;
        for limb in self.limbs.iter_mut().rev() {
            let value = rest << 64 | u128::from(*limb);
            (*limb, rest) = (low(value / divisor), value % divisor);
        }
        self.rest |= rest != 0;
    }

    /// Up until the highest bit is set; by how many.
    fn raise(&mut self) -> i32 {
        let mut by = 0;
        while self.limbs.iter().any(|limb| *limb != 0) {
            let [a, b, c, d, e, highest] = self.limbs;
            match highest.leading_zeros() {
                0 => break,
                64 => {
                    self.limbs = [0, a, b, c, d, e];
                    by += 64;
                }
                zeros => {
                    self.times(1 << zeros);
                    by += i32::try_from(zeros).unwrap_or(0);
                }
            }
        }
        by
    }

    /// Its highest 128 bits, with what is below them as a rest. It has 128 at least.
    fn quotient(mut self, exponent: i32) -> Quotient {
        let raised = self.raise();
        let [a, b, c, d, low, high] = self.limbs;
        Quotient {
            size: u128::from(high) << 64 | u128::from(low),
            exponent: exponent - raised + 256,
            inexact: self.rest || [a, b, c, d].into_iter().any(|limb| limb != 0),
        }
    }
}

/// The lowest 64 bits.
fn low(value: u128) -> u64 {
    u64::try_from(value & u128::from(u64::MAX)).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MILLIMETRES: u32 = 3;

    #[test]
    fn thirds_are_right_a_billion_increments_away_and_back() {
        // 10000 increments per 3 mm: of 3k mm they are 10000k, of 3k + 1 mm a third more.
        let ratio = DecimalRatio::new(10_000, 3.0, 0).unwrap();
        for k in (0..=100_000_i32).step_by(7) {
            let (units, whole) = (3.0 * f64::from(k), 10_000 * i64::from(k));
            assert_eq!(ratio.increments(units), Some(whole));
            assert_eq!(ratio.increments(units + 1.0), Some(whole + 3333));
            assert_eq!(ratio.increments(units + 2.0), Some(whole + 6667));
            assert_eq!(ratio.increments(-units - 2.0), Some(-whole - 6667));
            #[expect(clippy::cast_precision_loss, reason = "10^9")]
            let increments = whole as f64;
            assert_eq!(ratio.increments_of(units).to_bits(), increments.to_bits());
            assert_eq!(ratio.units_of(increments).to_bits(), units.to_bits());
        }
        // (10^9 + 1) · 3/10000 = 300000.0003, and the number that is written so is the nearest.
        assert_eq!(ratio.units_of(1_000_000_001.0).to_bits(), 300_000.000_3_f64.to_bits());
        assert_eq!(ratio.units_of(-1_000_000_001.0).to_bits(), (-300_000.000_3_f64).to_bits());
    }

    #[test]
    fn decimals_are_those_that_were_written() {
        // 400 increments per 9.525 mm (3/8 inch): 9.525 m are 400000, to the last bit, and 9.525 itself is no binary number.
        let pitch = DecimalRatio::new(400, 9.525, MILLIMETRES).unwrap();
        assert_eq!((pitch.numerator, pitch.denominator, pitch.power), (16_000_000, 381, 0));
        assert_eq!(pitch.increments(9.525), Some(400_000));
        // Round a pulley of 10 mm: 3200·10^16 / 314159265358979, which is more than 64 bits have room for.
        let pulley = DecimalRatio::new(-3200, 31.415_926_535_897_9, MILLIMETRES).unwrap();
        assert!(pulley.power > 0, "{pulley:?}");
        assert_eq!(pulley.increments(31_415.926_535_897_9), Some(-3_200_000_000));
        assert_eq!(pulley.increments(-31_415.926_535_897_9 / 2.0), Some(1_600_000_000));
        assert_eq!(pulley.units_of(-3_200_000_000.0).to_bits(), 31_415.926_535_897_9_f64.to_bits());
        assert_eq!(
            pulley.increments_of(31_415.926_535_897_9).to_bits(),
            (-3_200_000_000.0_f64).to_bits()
        );
    }

    #[test]
    fn what_cannot_be_counted_is_refused() {
        let ratio = DecimalRatio::new(1 << 31, 1.0, 0).unwrap();
        for units in [1e10, -1e10, 1e300, f64::INFINITY, f64::NAN, 4_294_967_296.0] {
            assert_eq!(ratio.increments(units), None, "{units}");
        }
        assert_eq!(ratio.increments(4_294_967_295.5), Some(i64::MAX - (1 << 30) + 1));
        assert_eq!(ratio.increments(1e-300), Some(0));
        assert!(ratio.increments_of(f64::NAN).is_nan());
        let reversed = DecimalRatio::new(-1, 1.0, 0).unwrap();
        assert_eq!(reversed.units_of(f64::INFINITY).to_bits(), f64::NEG_INFINITY.to_bits());
        // Half-way: to the even one.
        let whole = DecimalRatio::new(1, 1.0, 0).unwrap();
        let found = [0.5, 1.5, 2.5, -0.5, -1.5, -2.5].map(|units| whole.increments(units).unwrap());
        assert_eq!(found, [0, 2, 2, 0, -2, -2]);
        // A little less and a little more than half of an increment, by a ratio without an end.
        let third = DecimalRatio::new(1, 3.0, 0).unwrap();
        assert_eq!(
            [1.5, 1.5_f64.next_up()].map(|units| third.increments(units)),
            [Some(0), Some(1)]
        );
    }

    #[test]
    fn impossible_ratios_are_refused() {
        for (increments, units, power) in [
            (0, 1.0, 0),
            (1, 0.0, 0),
            (1, -1.0, 0),
            (1, f64::NAN, 0),
            (1, f64::INFINITY, 0),
            (1, 1e16, 0),
            (1, 1e-13, 0),
            (1, 1.0, 10),
        ] {
            assert_eq!(
                DecimalRatio::new(increments, units, power),
                None,
                "{increments} per {units}"
            );
        }
    }

    proptest! {
        /// Of dyadic units n / 2^10: |n·inc·10^9 − 2^10·found·nano| ≤ 2^9·nano, in whole numbers, nano the units in 10⁻⁹.
        #[test]
        fn nearest_increments_are_the_nearest(
            n in -1_i64 << 40..1 << 40, increments in 1_i64..1 << 20, nano in 1_i64..1 << 45,
        ) {
            #[expect(clippy::cast_precision_loss, reason = "45 bits")]
            let ratio = DecimalRatio::new(increments, nano as f64 / 1e9, 0).unwrap();
            #[expect(clippy::cast_precision_loss, reason = "40 bits")]
            let position = n as f64 / 1024.0;
            let exact = i128::from(n) * i128::from(increments) * 1_000_000_000;
            match ratio.increments(position) {
                Some(found) => {
                    let away = exact - 1024 * i128::from(found) * i128::from(nano);
                    prop_assert!(away.abs() <= 512 * i128::from(nano));
                }
                None => prop_assert!(exact.abs() / (1024 * i128::from(nano)) >= 1 << 62),
            }
        }

        /// Both forms of the reckoning give the same: one in 128 bits and one in 384.
        #[test]
        fn long_ratios_are_reckoned_as_short_ones(
            increments in prop_oneof![Just(1_i64), Just(1024), 1_i64..1 << 30],
            digits in prop_oneof![Just(1_u32), Just(10), 1_u32..1 << 30],
            value in prop_oneof![-1e9..1e9, any::<i32>().prop_map(|halves| f64::from(halves) / 2048.0)],
        ) {
            let short = DecimalRatio::new(increments, digits.into(), 0).unwrap();
            // The same, with a power of ten that is taken back in the denominator.
            let (numerator, power) = (short.numerator, 8);
            let Some(denominator) = short.denominator.checked_mul(100_000_000) else { return Ok(()) };
            let long = DecimalRatio { negative: false, numerator, denominator, power };
            prop_assert_eq!(long.increments(value), short.increments(value));
            for (one, other) in [
                (long.increments_of(value), short.increments_of(value)),
                (long.units_of(value), short.units_of(value)),
            ] {
                prop_assert_eq!(one.to_bits(), other.to_bits());
            }
        }

        #[test]
        fn increments_return_from_units(
            counted in -1_i64 << 45..1 << 45, increments in 1_i64..1_000_000, units in 1e-3..1e3,
        ) {
            let ratio = DecimalRatio::new(increments, units, MILLIMETRES).unwrap();
            #[expect(clippy::cast_precision_loss, reason = "45 bits")]
            let back = ratio.increments(ratio.units_of(counted as f64));
            prop_assert_eq!(back, Some(counted));
        }
    }
}
