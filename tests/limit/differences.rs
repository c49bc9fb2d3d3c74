//! Differences of axis positions sampled in equal cycles: velocity, acceleration and jerk as the drives see them.

/// Largest velocity, acceleration and jerk, m or rad and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    pub velocity: f64,
    pub acceleration: f64,
    pub jerk: f64,
}

impl Peak {
    /// The larger of both, each for itself.
    pub fn max(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.max(other.velocity),
            acceleration: self.acceleration.max(other.acceleration),
            jerk: self.jerk.max(other.jerk),
        }
    }
}

/// Backward differences of the positions of some axes, of which the first, second and third are remembered where they
/// are largest. Before the first sample and after the last the axes stand still: what that asks of them counts.
#[derive(Clone, Debug)]
pub struct Differences {
    cycle: f64,
    /// Position and differences of the newest sample, per axis.
    newest: Vec<[f64; 4]>,
    peaks: Vec<Peak>,
    samples: usize,
}

impl Differences {
    /// Samples a `cycle` apart, s.
    pub fn new(cycle: f64) -> Self {
        Self { cycle, newest: Vec::new(), peaks: Vec::new(), samples: 0 }
    }

    /// The next sample.
    pub fn push(&mut self, positions: &[f64]) {
        if self.samples == 0 {
            self.newest = positions.iter().map(|position| [*position, 0.0, 0.0, 0.0]).collect();
            self.peaks = vec![Peak::default(); positions.len()];
        }
        assert_eq!(positions.len(), self.newest.len(), "as many axes as before");
        self.samples += 1;
        for ((newest, peak), position) in self.newest.iter_mut().zip(&mut self.peaks).zip(positions)
        {
            let mut value = *position;
            for slot in newest.iter_mut() {
                let difference = value - *slot;
                *slot = value;
                value = difference;
            }
            let [_, first, second, third] = newest.map(f64::abs);
            *peak = peak.max(Peak {
                velocity: first / self.cycle,
                acceleration: second / self.cycle.powi(2),
                jerk: third / self.cycle.powi(3),
            });
        }
    }

    /// Duration of the samples, s.
    pub fn duration(&self) -> f64 {
        self.cycle * crate::path::as_float(self.samples.saturating_sub(1))
    }

    /// The largest of every axis, standing still at the end.
    pub fn peaks(mut self) -> Vec<Peak> {
        let last: Vec<_> = self.newest.iter().map(|[position, ..]| *position).collect();
        for _ in 0..3 {
            self.push(&last);
        }
        self.peaks
    }
}

/// The largest of all axes.
pub fn largest(peaks: &[Peak]) -> Peak {
    peaks.iter().copied().fold(Peak::default(), Peak::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::as_float;

    const CYCLE: f64 = 1e-3;

    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() <= tolerance, "{value} instead of {expected}");
    }

    /// Differences of s(t) from 0 to the time `end`.
    fn of(end: usize, position: impl Fn(f64) -> f64) -> Peak {
        let mut differences = Differences::new(CYCLE);
        for sample in 0..=end {
            differences.push(&[position(CYCLE * as_float(sample)), 0.7]);
        }
        close(differences.duration(), CYCLE * as_float(end), 1e-12);
        let peaks = differences.peaks();
        assert_eq!(peaks[1], Peak::default(), "an axis at rest");
        peaks[0]
    }

    /// Third differences of a cubic are its jerk exactly; second ones its acceleration a cycle before.
    #[test]
    fn differences_of_a_cubic() {
        // x = t³ from rest; at the end of 50 ms it stops dead.
        let mut differences = Differences::new(CYCLE);
        for sample in 0..=50 {
            differences.push(&[(CYCLE * as_float(sample)).powi(3)]);
        }
        let peak = differences.peaks[0];
        close(peak.jerk, 6.0, 1e-6);
        close(peak.acceleration, 6.0 * 0.049, 1e-9);
        close(peak.velocity, 3.0 * 0.0495_f64.powi(2) + 0.25 * CYCLE * CYCLE, 1e-12);
    }

    /// A versed sine from rest to rest: v = ω/2, a = ω²/2, j = ω³/2 at its largest, but for the square of a cycle.
    #[test]
    fn differences_of_a_sine() {
        let omega = std::f64::consts::TAU / 0.4;
        let peak = of(400, |t| 0.5 * (1.0 - (omega * t).cos()));
        close(peak.velocity, omega / 2.0, omega * 1e-4);
        close(peak.acceleration, omega.powi(2) / 2.0, omega.powi(2) * 1e-4);
        // At both ends its largest acceleration comes and goes, half of it in each of two cycles.
        close(peak.jerk, omega.powi(2) / 4.0 / CYCLE, omega.powi(2) * 1e-3 / CYCLE);
    }

    /// A start and a stop without a ramp are steps of the velocity, which ask for v/T during one cycle, from 0 and back.
    #[test]
    fn steps_of_the_velocity_count_at_both_ends() {
        for stopping in [false, true] {
            let constant = move |t: f64| if stopping { 0.25 * t } else { 0.25 * (0.1 - t) };
            let peak = of(100, constant);
            close(peak.velocity, 0.25, 1e-9);
            close(peak.acceleration, 0.25 / CYCLE, 1e-5);
            close(peak.jerk, 0.25 / CYCLE.powi(2), 1e-2);
        }
        // At one end alone.
        let ramp = |t: f64| 0.5 * t * t;
        let peak = of(100, ramp);
        close(peak.acceleration, 0.0995 / CYCLE, 1e-6);
    }
}
