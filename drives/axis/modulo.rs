//! Rotary axes, whose positions repeat, and counters, which wrap.
//!
//! [`super::Encoder`] and [`Gearing`](super::Gearing) are made of them. `twin` plans axes with a period unwound, turn by turn, and
//! drives follow the whole counter: folding positions into a period would lose the turns that programs count, and the tools'
//! directions. Its periods fold only what is shown, in the axis's own unit.

use super::{AxisError, Ratio, ratio::quotient};

/// Largest period of a rotary axis, increments (2.1.3: 16#80000000).
const LONGEST: u128 = 0x8000_0000;
/// Largest denominator of a period in increments that is reckoned with.
const FINEST: u128 = 1 << 32;

/// The period of a rotary axis, `fPositionPeriod`, as an exact number of increments: a fraction where the period is no
/// whole number of them. Residues are those of whole numbers, so that they do not drift however often the axis turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulo {
    ratio: Ratio,
    /// The period in technical units.
    period: f64,
    /// It is this many increments …
    numerator: u64,
    /// … divided by this.
    denominator: u64,
}

/// Where a rotary axis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Whole periods from the zero of the counter on; negative below it.
    pub turns: i64,
    /// Technical units, in [0, period[.
    pub position: f64,
}

fn gcd(a: u128, b: u128) -> u128 {
    let (mut a, mut b) = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// A positive number as its shortest decimal notation says it: numerator and denominator, a power of ten.
fn decimal(value: f64) -> Option<(u128, u128)> {
    let text = value.to_string();
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let denominator = 10_u128.checked_pow(u32::try_from(fraction.len()).ok()?)?;
    let numerator = format!("{whole}{fraction}").parse::<u128>().ok()?;
    Some((numerator, denominator))
}

impl Modulo {
    /// A period in technical units; exactly what its shortest decimal notation says, as it was written: 0.1 is a tenth.
    ///
    /// # Errors
    /// [`AxisError::Gearing`] (90) if it is not above 0, longer than 16#80000000 increments, shorter than one, or with so
    /// many digits that its increments are no fraction with a denominator of 32 bits.
    pub fn new(ratio: Ratio, period: f64) -> Result<Self, AxisError> {
        let wrong = || AxisError::Gearing { what: "fPositionPeriod", value: period };
        if !period.is_finite() || period <= 0.0 {
            return Err(wrong());
        }
        let (digits, power) = decimal(period).ok_or_else(wrong)?;
        let numerator = digits.checked_mul(ratio.denominator().into()).ok_or_else(wrong)?;
        let denominator = power.checked_mul(ratio.numerator().unsigned_abs().into());
        let denominator = denominator.ok_or_else(wrong)?;
        let common = gcd(numerator, denominator).max(1);
        let (numerator, denominator) = (numerator / common, denominator / common);
        let fits = denominator <= FINEST
            && (denominator..=LONGEST.saturating_mul(denominator)).contains(&numerator);
        let small = (u64::try_from(numerator), u64::try_from(denominator));
        match small {
            (Ok(numerator), Ok(denominator)) if fits => {
                Ok(Self { ratio, period, numerator, denominator })
            }
            _ => Err(wrong()),
        }
    }

    /// The period, technical units.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Where an axis is whose counter shows this.
    pub fn place(&self, increments: i64) -> Place {
        let sense = if self.ratio.numerator() < 0 { -1 } else { 1 };
        // At most 2^63 · 2^32; the residue is below 2^63.
        let fine = i128::from(increments) * sense * i128::from(self.denominator);
        let (turns, residue) =
            (fine.div_euclid(self.numerator.into()), fine.rem_euclid(self.numerator.into()));
        let units = residue * i128::from(self.ratio.numerator().unsigned_abs());
        // 32 + 32 bits.
        let parts = self.denominator.saturating_mul(self.ratio.denominator().into());
        let position = quotient(units, parts);
        let turns = i64::try_from(turns).unwrap_or(if turns < 0 { i64::MIN } else { i64::MAX });
        let position = if position < self.period { position } else { self.period.next_down() };
        Place { turns, position }
    }

    /// The shortest way from one position to another, technical units in ]−period/2, period/2].
    pub fn difference(&self, from: f64, to: f64) -> f64 {
        let way = (to - from).rem_euclid(self.period);
        if way > self.period / 2.0 { way - self.period } else { way }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn modulo(units: i32, increments: u32, period: f64) -> Modulo {
        Modulo::new(Ratio::new(units, increments).unwrap(), period).unwrap()
    }

    /// 10000 increments for 7 turns of 360°: 1428 4/7 increments a turn, which no counter shows.
    #[test]
    fn a_period_between_increments_does_not_drift() {
        let table = modulo(7 * 360, 10_000, 360.0);
        let place = table.place(7_000_000_000_000);
        // 7e12 · 0.252° = 4.9e9 turns exactly.
        assert_eq!((place.turns, place.position.to_bits()), (4_900_000_000, 0));
        let next = table.place(7_000_000_000_001);
        assert!((next.position - 0.252).abs() < 1e-15);
        let before = table.place(-1);
        assert_eq!(before.turns, -1);
        assert!((before.position - 359.748).abs() < 1e-12);
        // A tenth is a tenth, not what is nearest to it in binary.
        let tenth = modulo(1, 10, 0.1);
        assert_eq!((tenth.place(12_345_678_901).turns, tenth.period()), (12_345_678_901, 0.1));
        assert_eq!(tenth.place(12_345_678_901).position.to_bits(), 0);
    }

    #[test]
    fn an_axis_that_counts_backwards_goes_down() {
        let place = modulo(-360, 3600, 360.0).place(100);
        assert_eq!(place.turns, -1);
        assert!((place.position - 350.0).abs() < 1e-12);
    }

    /// 2.1.3: at most 16#80000000 increments.
    #[test]
    fn impossible_periods_are_refused() {
        let ratio = Ratio::new(1, 1).unwrap();
        assert!(Modulo::new(ratio, 2_147_483_648.0).is_ok());
        for period in [2_147_483_649.0, 0.0, -1.0, f64::NAN, f64::INFINITY, 0.5, 1.0 / 3.0 + 7.0] {
            assert_eq!(Modulo::new(ratio, period).unwrap_err().number(), Some(90), "{period}");
        }
    }

    #[test]
    fn the_shortest_way_leads_over_zero() {
        let table = modulo(360, 3600, 360.0);
        for (from, to, way) in
            [(350.0, 10.0, 20.0), (10.0, 350.0, -20.0), (0.0, 180.0, 180.0), (180.0, 0.0, 180.0)]
        {
            assert!((table.difference(from, to) - way).abs() < 1e-12, "{from} to {to}");
        }
    }

    proptest! {
        /// Whole numbers say it otherwise: turns·period ≤ position < (turns + 1)·period, and the rest is the position.
        #[test]
        fn places_are_those_of_whole_numbers(
            increments: i64, units in 1_i32..5000, per in 1_u32..5_000_000, period in 1_u32..100_000,
        ) {
            let ratio = Ratio::new(units, per).unwrap();
            let Ok(modulo) = Modulo::new(ratio, period.into()) else { return Ok(()) };
            let Place { turns, position } = modulo.place(increments);
            // Position times per: increments·units; period times per.
            let (whole, turn) = (i128::from(increments) * i128::from(units), i128::from(period) * i128::from(per));
            let rest = whole - i128::from(turns) * turn;
            prop_assert!((0..turn).contains(&rest));
            #[expect(clippy::cast_precision_loss, reason = "an approximation")]
            let expected = rest as f64 / f64::from(per);
            prop_assert!((position - expected).abs() <= 1e-15 * f64::from(period) + 1e-15 * expected);
            prop_assert!((0.0..f64::from(period)).contains(&position));
        }
    }
}
