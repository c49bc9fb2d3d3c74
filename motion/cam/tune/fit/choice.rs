//! Which of the answers that fit alike is taken.
//!
//! A cam whose return mirrors its rise fits twice: as it is, and half a cam on with a mirrored slave, `SlaveScaling` below 0. A
//! cam that repeats itself fits once for every repeat. The samples do not say which of them it is, but what is in effect does:
//! a slave does not turn round by itself, so the sign of its scaling is kept, and of the places on the cam the nearest is taken,
//! where it is clearly nearer than the next. Who knows better says between what the values are.

use super::super::FitError;
use super::refuse::ALIKE;
use super::{FitOptions, NAMES, Parameters, Problem};

/// Answers are other ones if they are apart by more than this part of the cam, or by as much in `MasterScaling`.
const APART: f64 = 1e-3;
/// The nearest answer is clearly nearer if it is no farther than this part of the way from it to the next one.
const CLEARLY: f64 = 0.25;
/// Of the squares of the slave's positions this part is rounding.
const ROUNDING: f64 = 1e-18;

/// The answer that is taken, and what is beside it.
pub(super) struct Fitted {
    /// What it leaves over.
    pub(super) left: f64,
    pub(super) best: Parameters,
    /// Another answer that fits alike: the next one on the cam, or else one with a mirrored slave.
    pub(super) other: Option<Parameters>,
    /// Why it cannot be taken.
    pub(super) refused: Option<FitError>,
}

impl FitOptions {
    /// The middle of where the offset of the master is looked for.
    pub(super) fn offset_near(&self) -> Option<f64> {
        let [low, high] = self.between[0]?;
        Some(f64::midpoint(low, high)).filter(|middle| middle.is_finite())
    }
}

impl Problem<'_> {
    /// Chooses among bottoms of valleys, each with what it leaves over.
    pub(super) fn chosen(
        &self,
        mut answers: Vec<(f64, Parameters)>,
        options: &FitOptions,
    ) -> Option<Fitted> {
        answers.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (least, _) = answers.first().copied()?;
        let freedom = self.samples.len().saturating_sub(self.free.len()).max(1);
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let variance = least / freedom as f64;
        let size: f64 = self.samples.iter().map(|s| s.weight * s.slave.powi(2)).sum();
        let room = (ALIKE * variance).max(ROUNDING * size);
        // Every valley once, by its deepest bottom.
        let mut alike: Vec<(f64, Parameters)> = Vec::new();
        for (left, p) in answers {
            if left - least <= room && alike.iter().all(|(_, other)| self.differ(&p, other)) {
                alike.push((left, p));
            }
        }
        let meant: Vec<_> =
            alike.iter().filter(|(_, p)| self.beyond(p, options).is_none()).copied().collect();
        let refused = match alike.first() {
            Some((_, p)) if meant.is_empty() => self.beyond(p, options),
            _ => None,
        };
        let mut alike = if meant.is_empty() { alike } else { meant };
        let far = |p: &Parameters| self.apart(p[0], options.master_offset);
        let mirrored = |p: &Parameters| p[3] * options.slave_scaling < 0.0;
        alike.sort_by(|(_, a), (_, b)| {
            mirrored(a).cmp(&mirrored(b)).then(far(a).total_cmp(&far(b)))
        });
        let ((left, best), others) = alike.split_first()?;
        let same = |(_, p): &&(f64, Parameters)| mirrored(p) == mirrored(best);
        let same = others.iter().filter(same).map(|(_, p)| p);
        let scaled = same.clone().find(|p| (p[1] - best[1]).abs() > APART);
        let next =
            same.min_by(|a, b| self.apart(a[0], best[0]).total_cmp(&self.apart(b[0], best[0])));
        let ambiguous = match (scaled, next) {
            (Some(p), _) => Some((1, p, options.master_scaling)),
            (None, Some(p)) if far(best) > CLEARLY * self.apart(p[0], best[0]) => {
                Some((0, p, options.master_offset))
            }
            _ => None,
        };
        let ambiguous = ambiguous.map(|(index, p, begun): (usize, _, _)| {
            let [one, other] =
                [best, p].map(|p| self.folded(*p, options).get(index).copied().unwrap_or_default());
            let unknown = NAMES.get(index).copied().unwrap_or_default();
            FitError::Ambiguous { unknown, one, other, begun }
        });
        let other = next.or_else(|| others.first().map(|(_, p)| p)).copied();
        Some(Fitted { left: *left, best: *best, other, refused: refused.or(ambiguous) })
    }

    /// Whether two answers have the master elsewhere on the cam: what concerns the slave follows from that.
    fn differ(&self, one: &Parameters, other: &Parameters) -> bool {
        self.apart(one[0], other[0]) > APART * self.width() || (one[1] - other[1]).abs() > APART
    }

    /// How far apart offsets of the master are on the cam; whole passes of one that is put end to end are the same place.
    pub(super) fn apart(&self, one: f64, other: f64) -> f64 {
        let by = one - other;
        let passes = if self.repeated { (by / self.width()).round() } else { 0.0 };
        (by - passes * self.width()).abs()
    }

    /// Whole passes taken off an offset of the master, where they are the same cam but for what it gains: the one next to 0, or to
    /// the middle of where it is looked for.
    pub(super) fn folded(&self, mut p: Parameters, options: &FitOptions) -> Parameters {
        if self.repeated && self.free.contains(&0) {
            let near = options.offset_near().unwrap_or(0.0);
            let passes = ((p[0] - near) / self.width()).round();
            if passes != 0.0 && (self.curve.rise() == 0.0 || self.free.contains(&2)) {
                p[0] -= passes * self.width();
                p[2] += p[3] * passes * self.curve.rise();
            }
        }
        p
    }

    /// What of an answer is not where it is looked for.
    fn beyond(&self, p: &Parameters, options: &FitOptions) -> Option<FitError> {
        let p = self.folded(*p, options);
        self.free.iter().find_map(|index| {
            let (value, between) = (*p.get(*index)?, (*options.between.get(*index)?)?);
            let [low, high] = between;
            let unknown = NAMES.get(*index).copied().unwrap_or_default();
            (!(low..=high).contains(&value)).then_some(FitError::Beyond { unknown, value, between })
        })
    }
}
