//! Effort curve of a motor: effort over speed.

/// Efforts by speeds, straight in between and constant beyond the ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffortCurve {
    /// Speed (m/s or rad/s at the axis, rising, not below 0) and effort there (N or Nm).
    points: Vec<[f64; 2]>,
}

impl EffortCurve {
    /// No limit at any speed.
    pub const UNLIMITED: Self = Self { points: Vec::new() };

    /// Through `points`: speed and effort. `None` unless speeds rise from 0 or more, and all are finite and not negative.
    pub fn new(points: Vec<[f64; 2]>) -> Option<Self> {
        let valid = points.iter().flatten().all(|value| (0.0..=f64::MAX).contains(value));
        let rises =
            points.iter().zip(points.iter().skip(1)).all(|([one, _], [next, _])| one < next);
        (valid && rises).then_some(Self { points })
    }

    /// The effort at `speed` of either sign; infinite without points.
    pub fn at(&self, speed: f64) -> f64 {
        let speed = speed.abs();
        let mut before: Option<[f64; 2]> = None;
        for point in &self.points {
            let [end, effort] = *point;
            if speed <= end {
                return before.map_or(effort, |[start, first]| {
                    first + (effort - first) * ((speed - start) / (end - start))
                });
            }
            before = Some(*point);
        }
        before.map_or(f64::INFINITY, |[_, effort]| effort)
    }

    /// The smallest effort up to `speed`.
    pub fn least(&self, speed: f64) -> f64 {
        let until = self.points.iter().filter(|[start, _]| *start < speed.abs());
        until.map(|[_, effort]| *effort).fold(self.at(speed), f64::min)
    }
}
