//! Motor overload model: I²t.

/// Continuous effort and thermal time constant of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverloadParameters {
    /// The effort it can give for ever, N or Nm at the axis.
    pub continuous_effort: f64,
    /// Thermal time constant, s; windings have 10 to 60 s.
    pub time_constant: f64,
}

impl OverloadParameters {
    /// The fields with their names and ranges.
    pub(super) fn ranges(&self) -> [(&'static str, f64, f64, f64); 2] {
        [
            ("continuous effort", self.continuous_effort, f64::MIN_POSITIVE, f64::MAX),
            ("thermal time constant", self.time_constant, f64::MIN_POSITIVE, f64::MAX),
        ]
    }
}

/// The losses of a motor, smoothed by its thermal time constant: 1 is the continuous limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overload {
    parameters: OverloadParameters,
    warmth: f64,
    warned: bool,
}

impl Overload {
    /// Of a motor that has always given `effort`, if it can.
    pub(super) fn new(parameters: OverloadParameters, effort: f64) -> Self {
        let warmth = (effort / parameters.continuous_effort).powi(2).min(1.0);
        Self { parameters, warmth, warned: false }
    }

    /// After `dt` s with `effort`. True when it gets too warm, once until it has cooled down to 90 %.
    pub(crate) fn advance(&mut self, effort: f64, dt: f64) -> bool {
        let losses = (effort / self.parameters.continuous_effort).powi(2);
        self.warmth = losses + (self.warmth - losses) * (-dt / self.parameters.time_constant).exp();
        let too_warm = self.warmth > 1.0;
        let warns = too_warm && !self.warned;
        self.warned = too_warm || (self.warned && self.warmth > 0.9);
        warns
    }

    /// Smoothed losses; 1 is the continuous limit.
    pub(crate) fn warmth(&self) -> f64 {
        self.warmth
    }
}
