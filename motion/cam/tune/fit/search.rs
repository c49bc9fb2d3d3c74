//! From a grid over what concerns the master down into the best valleys.

use super::{FitOptions, Free, Parameters, Problem};

/// Samples that the search looks at; the fit then takes them all.
const SEARCHED: usize = 256;
/// Valleys that are gone down, of each sign of the slave's scaling: those of the other one would crowd them out.
const VALLEYS: usize = 6;
/// So many of the others are gone down, too, as they are next to what is in effect, or to the middle of where the offset is looked
/// for: a cam may repeat itself more often.
const NEAREST: usize = 3;

impl Problem<'_> {
    /// Starts at the bottom of the best valleys of a grid over what concerns the master.
    pub(super) fn valleys(&self, options: &FitOptions) -> Vec<Parameters> {
        let stride = self.samples.len().div_ceil(SEARCHED);
        let some: Vec<_> = self.samples.iter().step_by(stride).copied().collect();
        let few = Problem { samples: &some, ..*self };
        let Free { master_offset, master_scaling, .. } = options.free;
        let masters = some.iter().map(|sample| sample.master);
        let (low, high) =
            masters.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), m| (a.min(m), b.max(m)));
        let scalings = if master_scaling {
            // So fine that the ends of the run differ by a small part of the cam.
            let range = options.scaling_range.abs() * options.master_scaling.abs();
            let about = [options.master_scaling - range, options.master_scaling + range];
            let given = options.between[1].filter(|ends| ends.iter().all(|end| end.is_finite()));
            let [from, to] = given.unwrap_or(about);
            let step = self.width() / 24.0 / (high - low).max(f64::MIN_POSITIVE);
            steps(from, to, step, 60)
        } else {
            vec![options.master_scaling]
        };
        let mut found: Vec<(f64, Parameters)> = Vec::new();
        for scaling in scalings {
            let offsets = if master_offset {
                let half = self.width() / 2.0;
                // Without an end to end cam the run may lie anywhere on it.
                let middle = if self.repeated {
                    0.0
                } else {
                    self.curve.start() + half - f64::midpoint(low, high) * scaling
                };
                let reach = if self.repeated { half } else { 2.0 * half };
                let pieces = self.curve.pieces().len();
                steps(middle - reach, middle + reach, self.width() / 64.0, 8 * pieces.clamp(16, 64))
            } else {
                vec![options.master_offset]
            };
            let row: Vec<_> = offsets
                .into_iter()
                .map(|offset| {
                    let given = [offset, scaling, options.slave_offset, options.slave_scaling];
                    few.project(given, options.free)
                })
                .collect();
            for (index, (left, start)) in row.iter().enumerate() {
                let beside = |index: Option<usize>| {
                    index.and_then(|index| row.get(index)).is_none_or(|(other, _)| left <= other)
                };
                if beside(index.checked_sub(1)) && beside(Some(index + 1)) {
                    found.push((*left, *start));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mirrored, kept): (Vec<_>, Vec<_>) =
            found.into_iter().partition(|(_, p)| p[3] * options.slave_scaling < 0.0);
        let near = options.offset_near().unwrap_or(options.master_offset);
        let mut starts = Vec::new();
        for mut found in [kept, mirrored] {
            let mut rest = found.split_off(VALLEYS.min(found.len()));
            let far = |p: &Parameters| self.apart(p[0], near);
            rest.sort_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
            starts.extend(found.into_iter().chain(rest.into_iter().take(NEAREST)));
        }
        starts.into_iter().map(|(_, start)| start).collect()
    }

    /// The best slave offset and scaling for given values of the master.
    pub(super) fn project(&self, mut p: Parameters, free: Free) -> (f64, Parameters) {
        let [mut w, mut wy, mut wyy, mut ws, mut wys] = [0.0; 5];
        for sample in self.samples {
            let y = self.model([p[0], p[1], 0.0, 1.0], sample.master).0;
            w += sample.weight;
            wy += sample.weight * y;
            wyy += sample.weight * y * y;
            ws += sample.weight * sample.slave;
            wys += sample.weight * y * sample.slave;
        }
        let spread = wyy - wy * wy / w;
        match (free.slave_offset, free.slave_scaling) {
            (true, true) if spread > 1e-12 * wyy => {
                p[3] = (wys - wy * ws / w) / spread;
                p[2] = (ws - p[3] * wy) / w;
            }
            (true, _) => p[2] = (ws - p[3] * wy) / w,
            (false, true) if wyy > 0.0 => p[3] = (wys - p[2] * wy) / wyy,
            (false, _) => {}
        }
        (self.left(p), p)
    }

    /// Down to the bottom, with steps damped where they do not lead down.
    pub(super) fn descend(&self, start: Parameters) -> Option<(f64, Parameters)> {
        let (mut p, mut left) = (start, self.left(start));
        let mut damping = 1e-6;
        for _ in 0..100 {
            let (matrix, right) = self.normal(p, self.samples);
            let mut damped = matrix.clone();
            for index in 0..self.free.len() {
                if let Some(value) = damped.get_mut((index, index)) {
                    *value *= 1.0 + damping;
                }
            }
            let step = damped.cholesky()?.solve(&right);
            let next = self.moved(p, &step);
            let after = self.left(next);
            if after.is_finite() && after <= left {
                let gained = left - after;
                (p, left) = (next, after);
                damping = (damping * 0.1).max(1e-12);
                if gained <= 1e-13 * left {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        Some((left, p))
    }
}

/// Values from one to another, both included, so many at most.
fn steps(from: f64, to: f64, step: f64, most: usize) -> Vec<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates, and is limited at once"
    )]
    let count = (((to - from) / step).ceil() as usize).clamp(1, most);
    #[expect(clippy::cast_precision_loss, reason = "a few hundred")]
    let at = |index: usize| from + (to - from) * index as f64 / count as f64;
    (0..=count).map(at).collect()
}
