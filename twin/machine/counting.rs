//! Conversion between axis positions and drive increments by the exact ratio of the machine file.

use crate::axis_kind::AxisKind;
use twin_drives::DecimalRatio;

/// Increments of a drive per unit of the axis, as an exact ratio (the manual's
/// `dwRatioTechUnitsDenom` / `iRatioTechUnitsNum`).
///
/// [`Counting`] converts with it. The manual's 32-bit fraction is not enough for values read off gear, belt and
/// encoder, up to 10^12 increments per 9.525 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncrementRatio {
    /// Increments of the drive …
    pub increments: i64,
    /// … in this number of degrees or millimetres.
    pub per_units: f64,
}

impl IncrementRatio {
    /// Increments per degree or millimetre.
    #[expect(clippy::cast_precision_loss, reason = "read from a file where it is at most 10^12")]
    pub(super) fn per_unit(&self) -> f64 {
        self.increments as f64 / self.per_units
    }
}

/// Position counting of the drive of an axis.
///
/// A position is rounded once on its way, so errors do not add up. Rotary positions use π/180 to 53 bits: 10⁻⁷ of
/// an increment in 10⁹.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counting {
    kind: AxisKind,
    /// Increments per m, or per degree.
    ratio: DecimalRatio,
    /// The largest count of the device's counter, either way.
    most: i64,
}

impl Counting {
    /// `None` for ratios that machine files do not have.
    pub(super) fn new(kind: AxisKind, ratio: &IncrementRatio, most: i64) -> Option<Self> {
        let power = match kind {
            // Millimetres are metres.
            AxisKind::Linear => 3,
            AxisKind::Rotary => 0,
        };
        let ratio = DecimalRatio::new(ratio.increments, ratio.per_units, power)?;
        Some(Self { kind, ratio, most })
    }

    /// Kind of its units: mm or degrees.
    pub const fn kind(&self) -> AxisKind {
        self.kind
    }

    /// The largest count of the device's counter, either way.
    pub const fn most(&self) -> i64 {
        self.most
    }

    /// Increments, not whole ones, of a position (m, rad), a velocity or an acceleration.
    pub fn increments(&self, si: f64) -> f64 {
        self.ratio.increments_of(match self.kind {
            AxisKind::Linear => si,
            AxisKind::Rotary => si / self.kind.scale(),
        })
    }

    /// The whole increments nearest to a position, m or rad; `None` if the counter does not go so far.
    pub fn whole(&self, si: f64) -> Option<i64> {
        let counted = self.ratio.increments(match self.kind {
            AxisKind::Linear => si,
            AxisKind::Rotary => si / self.kind.scale(),
        });
        counted.filter(|count| count.unsigned_abs() <= self.most.unsigned_abs())
    }

    /// Increments of a position of a plan, which may lie between whole ones; `None` if the counter does not go so far.
    pub fn within(&self, si: f64) -> Option<f64> {
        let increments = self.increments(si);
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let most = self.most as f64;
        (increments.abs() <= most).then_some(increments)
    }

    /// Position, velocity or acceleration from increments, m or rad.
    pub fn si(&self, increments: f64) -> f64 {
        let units = self.ratio.units_of(increments);
        match self.kind {
            AxisKind::Linear => units,
            AxisKind::Rotary => units * self.kind.scale(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counting(kind: AxisKind, increments: i64, per_units: f64) -> Counting {
        Counting::new(kind, &IncrementRatio { increments, per_units }, i32::MAX.into()).unwrap()
    }

    /// 10000 increments per 3 mm; a billion increments are 300 m.
    #[test]
    fn a_billion_increments_of_a_ratio_without_an_end_are_right_both_ways() {
        let axis = counting(AxisKind::Linear, 10_000, 3.0);
        for k in (0..=100_000_i64).step_by(11) {
            let whole = 10_000 * k;
            #[expect(clippy::cast_precision_loss, reason = "300 m in µm")]
            let metres = |micrometres: i64| micrometres as f64 * 1e-3 * 1e-3;
            assert_eq!(axis.whole(metres(3000 * k)), Some(whole), "{k}");
            assert_eq!(axis.whole(metres(3000 * k + 1000)), Some(whole + 3333), "{k}");
            assert_eq!(axis.whole(-metres(3000 * k + 2000)), Some(-whole - 6667), "{k}");
            #[expect(clippy::cast_precision_loss, reason = "10^9")]
            let back = axis.si((whole + 1) as f64);
            assert_eq!(axis.whole(back), Some(whole + 1), "{k}");
            // 0.3 µm per increment: away from it by rounding alone.
            assert!((back - metres(3000 * k) - 0.3e-6).abs() < 1e-13, "{k}: {back}");
        }
    }

    #[test]
    fn turns_are_counted_in_degrees() {
        // 160000 increments in 3 turns and a third: 1200°.
        let axis = counting(AxisKind::Rotary, 160_000, 1200.0);
        let turn = std::f64::consts::TAU;
        for turns in [3.0, 30_000.0, -15_000.0] {
            #[expect(clippy::cast_possible_truncation, reason = "whole")]
            let expected = (turns * 48_000.0) as i64;
            assert_eq!(axis.whole(turns * turn), Some(expected));
            assert!((axis.increments(turns * turn) - turns * 48_000.0).abs() < 1e-6);
            assert!(
                (axis.si(turns * 48_000.0) - turns * turn).abs() < 1e-15 * (turns * turn).abs()
            );
        }
    }

    #[test]
    fn a_counter_has_an_end_either_way() {
        let axis = counting(AxisKind::Linear, 1000, 1.0);
        let end = f64::from(i32::MAX) * 1e-6;
        assert_eq!(axis.whole(end), Some(i64::from(i32::MAX)));
        assert_eq!(axis.whole(-end), Some(-i64::from(i32::MAX)));
        for beyond in [end + 1e-6, -end - 1e-6, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!((axis.whole(beyond), axis.within(beyond)), (None, None), "{beyond}");
        }
        assert_eq!(axis.within(0.25e-6), Some(0.25));
        assert_eq!(axis.most(), i64::from(i32::MAX));
    }
}
