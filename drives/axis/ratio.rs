//! Increments of a device and technical units of its user, by an exact ratio (2.1.3).

use super::AxisError;

/// u = increments · `iRatioTechUnitsNum` / `dwRatioTechUnitsDenom`.
///
/// Both ways are exact but for one rounding at the end, however large the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    /// `iRatioTechUnitsNum`; negative where the axis counts the other way round.
    units: i32,
    /// `dwRatioTechUnitsDenom`.
    increments: u32,
}

impl Ratio {
    /// `units` for so many `increments`. The manual's numerator is an INT here and a DWORD there; any that is not 0 will do.
    ///
    /// # Errors
    /// [`AxisError::Gearing`] (90) if one of them is 0.
    pub fn new(units: i32, increments: u32) -> Result<Self, AxisError> {
        let zero = |what| AxisError::Gearing { what, value: 0.0 };
        if units == 0 {
            Err(zero("iRatioTechUnitsNum"))
        } else if increments == 0 {
            Err(zero("dwRatioTechUnitsDenom"))
        } else {
            Ok(Self { units, increments })
        }
    }

    /// `iRatioTechUnitsNum`.
    pub fn numerator(self) -> i32 {
        self.units
    }

    /// `dwRatioTechUnitsDenom`.
    pub fn denominator(self) -> u32 {
        self.increments
    }

    /// Technical units of increments, rounded once.
    pub fn units(self, increments: i64) -> f64 {
        let product = i128::from(increments) * i128::from(self.units);
        quotient(product, self.increments.into())
    }

    /// Technical units of a position, velocity or acceleration that may lie between increments.
    pub fn units_of(self, increments: f64) -> f64 {
        increments * f64::from(self.units) / f64::from(self.increments)
    }

    /// Increments, not whole ones, of technical units: of velocities and accelerations, too.
    pub fn increments_of(self, units: f64) -> f64 {
        units * f64::from(self.increments) / f64::from(self.units)
    }

    /// The whole increments nearest to a position; those half-way go to the even one.
    ///
    /// # Errors
    /// [`AxisError::Overflow`] if there are no such increments.
    pub fn increments(self, units: f64) -> Result<i64, AxisError> {
        let overflow = || AxisError::Overflow { position: units };
        if !units.is_finite() {
            return Err(overflow());
        }
        let (mantissa, exponent) = parts(units.abs());
        let product = u128::from(mantissa) * u128::from(self.increments);
        let divisor = u128::from(self.units.unsigned_abs());
        // product · 2^exponent / divisor.
        let size = if exponent >= 0 {
            let shift = exponent.unsigned_abs();
            // Beyond 2^127 it fits no counter, whatever the divisor, which has 31 bits.
            if shift >= product.leading_zeros() && product != 0 {
                return Err(overflow());
            }
            nearest(product.checked_shl(shift).unwrap_or(0), divisor)
        } else {
            match exponent.unsigned_abs() {
                // Less than 2^85 / 2^96.
                96.. => 0,
                shift => nearest(product, divisor << shift),
            }
        };
        let size = i128::try_from(size).map_err(|_beyond| overflow())?;
        let negative = units.is_sign_negative() != (self.units < 0);
        i64::try_from(if negative { -size } else { size }).map_err(|_beyond| overflow())
    }
}

/// Mantissa and exponent: `value` = mantissa · 2^exponent. `value` is finite and not negative.
pub(super) fn parts(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    // 11 bits.
    let raised = i32::try_from(bits >> 52 & 0x7FF).unwrap_or(0);
    if raised == 0 { (fraction, -1074) } else { (fraction | 1 << 52, raised - 1075) }
}

/// The whole number nearest to a quotient, the even one of two.
fn nearest(numerator: u128, denominator: u128) -> u128 {
    let (Some(whole), Some(rest)) =
        (numerator.checked_div(denominator), numerator.checked_rem(denominator))
    else {
        return 0;
    };
    let up = match rest.cmp(&(denominator - rest)) {
        std::cmp::Ordering::Less => false,
        std::cmp::Ordering::Greater => true,
        std::cmp::Ordering::Equal => whole % 2 == 1,
    };
    whole + u128::from(up)
}

/// The number nearest to a quotient of whole ones; 0 for a denominator of 0. The denominator has at most 64 bits.
pub(super) fn quotient(numerator: i128, denominator: u64) -> f64 {
    let size = numerator.unsigned_abs();
    if size == 0 || denominator == 0 {
        return 0.0;
    }
    // At least 63 bits of the quotient, and whether there is a rest: enough to round once.
    let shift = size.leading_zeros();
    let raised = size << shift;
    let whole = raised / u128::from(denominator);
    let rest = raised % u128::from(denominator);
    let sticky = whole | u128::from(rest != 0);
    #[expect(clippy::cast_precision_loss, reason = "rounds to the nearest: this is the rounding")]
    let rounded = sticky as f64;
    let shift = i32::try_from(shift).unwrap_or(0);
    let value = rounded * 2_f64.powi(-shift);
    if numerator < 0 { -value } else { value }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Manual 2.1.3: 3600000 increments a turn, units in degrees.
    #[test]
    fn the_manuals_example_is_in_degrees() {
        let ratio = Ratio::new(360, 3_600_000).unwrap();
        assert_eq!(ratio.units(3_600_000).to_bits(), 360.0_f64.to_bits());
        assert_eq!(ratio.units(-1).to_bits(), (-0.0001_f64).to_bits());
        assert_eq!(ratio.increments(90.0), Ok(900_000));
        assert_eq!(ratio.increments(0.000_06), Ok(1));
        assert!((ratio.increments_of(0.5) - 5000.0).abs() < 1e-9);
        assert!((ratio.units_of(2.5) - 0.000_25).abs() < 1e-18);
        assert_eq!((ratio.numerator(), ratio.denominator()), (360, 3_600_000));
    }

    #[test]
    fn zero_is_refused_with_90() {
        for (units, increments) in [(0, 1), (1, 0)] {
            assert_eq!(Ratio::new(units, increments).unwrap_err().number(), Some(90));
        }
    }

    #[test]
    fn what_cannot_be_counted_is_an_error() {
        let ratio = Ratio::new(1, 1 << 31).unwrap();
        for units in [1e10, -1e10, 1e300, f64::INFINITY, f64::NAN, 4_294_967_296.0] {
            assert!(matches!(ratio.increments(units), Err(AxisError::Overflow { .. })), "{units}");
        }
        assert_eq!(ratio.increments(4_294_967_295.5), Ok(i64::MAX - (1 << 30) + 1));
        assert_eq!(ratio.increments(-4_294_967_296.0), Ok(i64::MIN));
        assert_eq!(ratio.increments(1e-300), Ok(0));
        // Half-way: to the even one.
        let whole = Ratio::new(1, 1).unwrap();
        let found = [0.5, 1.5, 2.5, -0.5, -1.5, -2.5].map(|units| whole.increments(units).unwrap());
        assert_eq!(found, [0, 2, 2, 0, -2, -2]);
    }

    proptest! {
        /// Of dyadic units n / 2^10: |n·denominator − 2^10·inc·numerator| ≤ 2^9·|numerator|, in whole numbers.
        #[test]
        fn nearest_increments_are_the_nearest(
            n in -1_i64 << 50..1 << 50, units in prop_oneof![-9999_i32..0, 1_i32..9999], increments: u32,
        ) {
            prop_assume!(increments != 0);
            let ratio = Ratio::new(units, increments).unwrap();
            #[expect(clippy::cast_precision_loss, reason = "50 bits")]
            let position = n as f64 / 1024.0;
            let exact = i128::from(n) * i128::from(increments);
            match ratio.increments(position) {
                Ok(found) => {
                    let away = exact - 1024 * i128::from(found) * i128::from(units);
                    prop_assert!(away.abs() <= 512 * i128::from(units).abs());
                }
                Err(_) => prop_assert!(exact.abs() / (1024 * i128::from(units).abs()) >= 1 << 62),
            }
        }

        /// The nearest number: its neighbours are farther from the quotient, in whole numbers.
        #[test]
        fn units_are_rounded_once(
            n in -1_i64 << 40..1 << 40, units in prop_oneof![-999_i32..0, 1_i32..999], d in 1_u32..100_000,
        ) {
            let found = Ratio::new(units, d).unwrap().units(n);
            // found = f / 2^60 exactly where it is large enough; the exact value is n·units / d.
            prop_assume!(found.abs() >= 1e-2);
            let scaled = |value: f64| {
                let (mantissa, exponent) = parts(value.abs());
                let size = i128::from(mantissa) << (exponent + 60);
                if value < 0.0 { -size } else { size }
            };
            // At most 2^50·2^60.
            let exact = i128::from(n) * i128::from(units);
            let away = |value: f64| (exact * (1 << 60) - scaled(value) * i128::from(d)).abs();
            prop_assert!(away(found) <= away(found.next_up()));
            prop_assert!(away(found) <= away(found.next_down()));
        }

        #[test]
        fn increments_return_from_units(increments in -1_i64 << 45..1 << 45, n in 1_i32..32_767, d: u32) {
            prop_assume!(d != 0);
            let ratio = Ratio::new(n, d).unwrap();
            prop_assert_eq!(ratio.increments(ratio.units(increments)), Ok(increments));
        }
    }
}
