//! Noise of encoder positions, and disturbance forces on axes.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Noise of one axis. White, with a normal distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseParameters {
    /// Root mean square of what the encoder adds at every pass of the loops, m or rad.
    pub position: f64,
    /// Root mean square of a force or torque on the axis, new in every cycle, N or Nm.
    pub effort: f64,
}

impl NoiseParameters {
    /// The fields with their names and ranges.
    pub(super) fn ranges(&self) -> [(&'static str, f64, f64, f64); 2] {
        [
            ("position noise", self.position, 0.0, f64::MAX),
            ("effort noise", self.effort, 0.0, f64::MAX),
        ]
    }
}

/// The noise of one axis, the same for the same seed.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    parameters: NoiseParameters,
    random: ChaCha8Rng,
}

impl Noise {
    /// Of the axis of this number.
    pub(super) fn new(parameters: NoiseParameters, seed: u64, axis: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(u64::try_from(axis).unwrap_or(u64::MAX));
        Self { parameters, random }
    }

    /// Starts again with another seed.
    pub(super) fn reseed(&mut self, seed: u64, axis: usize) {
        *self = Self::new(self.parameters, seed, axis);
    }

    /// Next noise of the encoder, m or rad.
    pub(super) fn position(&mut self) -> f64 {
        self.sample(self.parameters.position)
    }

    /// Next disturbance of the axis, N or Nm.
    pub(super) fn effort(&mut self) -> f64 {
        self.sample(self.parameters.effort)
    }

    /// Nothing is drawn without noise.
    fn sample(&mut self, rms: f64) -> f64 {
        if rms <= 0.0 {
            return 0.0;
        }
        let normal: f64 = StandardNormal.sample(&mut self.random);
        rms * normal
    }
}
