//! Software maxima of set values (`SMC_CheckLimits`, 2.2.5) and the window of positions, by software and by switches
//! (2.1.3).
//!
//! `twin` holds the ramps of devices against what its plans may ask for with [`SoftwareMaxima::beyond`], before a run. It does not
//! use [`SoftwareMaxima::exceeded`] and [`LimitWatch`], which are for masters that hand on set values as they come: `twin check`
//! knows every set-point of a program beforehand, with its line, jerk and slack for rounding, and a run ends by the path.

use super::{AxisError, Movement};
use crate::{AxisSignals, DeviceLimits};

/// What an axis is asked for at one instant, technical units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SetValues {
    /// `fSetVelocity`, u/s.
    pub velocity: f64,
    /// `fSetAcceleration`, u/s², with sign: against the velocity it is a deceleration.
    pub acceleration: f64,
}

/// The largest values that software asks for: `fSWMaxVelocity`, `fSWMaxAcceleration`, `fSWMaxDeceleration`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftwareMaxima {
    /// u/s.
    pub velocity: f64,
    /// u/s².
    pub acceleration: f64,
    /// u/s².
    pub deceleration: f64,
}

impl Default for SoftwareMaxima {
    /// 100 each (2.4).
    fn default() -> Self {
        Self { velocity: 100.0, acceleration: 100.0, deceleration: 100.0 }
    }
}

impl SoftwareMaxima {
    /// `SMC_CheckLimits`: whether set values exceed the maxima that are asked about (`bCheckVel`, `bCheckAccDec`).
    pub fn exceeded(&self, set: &SetValues, velocity: bool, acceleration: bool) -> bool {
        let braking = set.velocity * set.acceleration < 0.0;
        let most = if braking { self.deceleration } else { self.acceleration };
        // What is no number is within no limit.
        let beyond = |value: f64, most: f64| value.is_nan() || value.abs() > most;
        velocity && beyond(set.velocity, self.velocity)
            || acceleration && beyond(set.acceleration, most)
    }

    /// What of a device's own limits is below these maxima: name, the device's and this one, technical units, of which each
    /// is so many increments ([`super::Ratio::increments_of`] of 1, or a ratio of the caller's that no 32 bits hold). Empty if
    /// the device does whatever may be asked of it, as far as it tells.
    pub fn beyond(
        &self,
        device: &DeviceLimits,
        increments_per_unit: f64,
    ) -> Vec<(&'static str, f64, f64)> {
        let pairs = [
            ("velocity", device.speed, self.velocity),
            ("acceleration", device.acceleration, self.acceleration),
            ("deceleration", device.deceleration, self.deceleration),
        ];
        let in_units = |(name, of_device, wanted): (_, Option<f64>, f64)| {
            let most = (of_device? / increments_per_unit).abs();
            // Ratios are rounded, and a limit that is met is not exceeded.
            (wanted > most * (1.0 + 1e-12)).then_some((name, most, wanted))
        };
        pairs.into_iter().filter_map(in_units).collect()
    }
}

/// The window of positions of a linear axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisLimits {
    /// `fSWLimitNegative` and `fSWLimitPositive` where `bSWLimitEnable` is set, technical units.
    pub software: Option<(f64, f64)>,
    /// `bHWLimitEnable`: whether limit switches are watched.
    pub hardware: bool,
}

/// Watches an axis: once it has left its window it stays in error (`errorstop`) until it is reset.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitWatch {
    limits: AxisLimits,
    error: Option<AxisError>,
}

impl LimitWatch {
    /// Watches an axis with this movement: rotary ones have no window.
    pub fn new(limits: AxisLimits, movement: Movement) -> Self {
        let none = AxisLimits::default();
        let linear = movement == Movement::Linear;
        Self { limits: if linear { limits } else { none }, error: None }
    }

    /// Looks at a measured position, technical units, and at the limit switches as the drive tells them.
    ///
    /// # Errors
    /// [`AxisError::SoftwareLimit`] or [`AxisError::HardwareLimit`] (10), now and until [`Self::reset`].
    pub fn look(&mut self, position: f64, signals: AxisSignals) -> Result<(), AxisError> {
        if self.error.is_none() {
            self.error = self.violation(position, signals);
        }
        self.error.clone().map_or(Ok(()), Err)
    }

    fn violation(&self, position: f64, signals: AxisSignals) -> Option<AxisError> {
        if let Some((negative, positive)) = self.limits.software
            && !(negative..=positive).contains(&position)
        {
            return Some(AxisError::SoftwareLimit { position, negative, positive });
        }
        let on = |switch: Option<bool>| self.limits.hardware && switch == Some(true);
        let (forwards, backwards) = (on(signals.positive_limit), on(signals.negative_limit));
        (forwards || backwards).then_some(AxisError::HardwareLimit { position, positive: forwards })
    }

    /// What it has seen.
    pub fn error(&self) -> Option<&AxisError> {
        self.error.as_ref()
    }

    /// `MC_Reset`: goes on watching. An axis that is still outside is in error at the next look.
    pub fn reset(&mut self) {
        self.error = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_values_are_held_against_their_maxima() {
        let maxima = SoftwareMaxima { velocity: 10.0, acceleration: 20.0, deceleration: 40.0 };
        let exceeded = |velocity, acceleration| {
            let set = SetValues { velocity, acceleration };
            [(true, false), (false, true)].map(|(v, a)| maxima.exceeded(&set, v, a))
        };
        assert_eq!(exceeded(10.0, 20.0), [false, false]);
        assert_eq!(exceeded(-10.1, 0.0), [true, false]);
        assert_eq!(exceeded(5.0, 21.0), [false, true]);
        assert_eq!(exceeded(5.0, -40.0), [false, false], "a deceleration");
        assert_eq!(exceeded(-5.0, 41.0), [false, true]);
        assert_eq!(exceeded(0.0, -21.0), [false, true], "from rest it accelerates");
        assert_eq!(exceeded(f64::NAN, 0.0), [true, false]);
        assert!(!maxima.exceeded(&SetValues { velocity: 99.0, acceleration: 99.0 }, false, false));
        assert!((SoftwareMaxima::default().velocity - 100.0).abs() < f64::EPSILON);
    }

    #[test]
    fn a_device_that_does_less_is_found() {
        let device =
            DeviceLimits { speed: Some(1000.0), acceleration: Some(1999.0), ..Default::default() };
        let maxima = SoftwareMaxima { velocity: 10.0, acceleration: 20.0, deceleration: 1e9 };
        assert_eq!(maxima.beyond(&device, -100.0), [("acceleration", 19.99, 20.0)]);
    }

    #[test]
    fn an_axis_outside_its_window_is_in_error_until_it_is_reset() {
        let limits = AxisLimits { software: Some((-5.0, 10.0)), hardware: true };
        let mut watch = LimitWatch::new(limits, Movement::Linear);
        let free = AxisSignals::default();
        for position in [-5.0, 0.0, 10.0] {
            assert_eq!(watch.look(position, free), Ok(()));
        }
        let error = watch.look(10.001, free).unwrap_err();
        assert_eq!(error.number(), Some(10));
        assert_eq!(error.to_string(), "position 10.001 is outside the software limits (-5 to 10)");
        assert_eq!(watch.look(0.0, free), Err(error.clone()));
        assert_eq!(watch.error(), Some(&error));
        watch.reset();
        assert_eq!(watch.look(0.0, free), Ok(()));
        let switch = AxisSignals { negative_limit: Some(true), ..free };
        let error = watch.look(1.0, switch).unwrap_err();
        assert_eq!(error, AxisError::HardwareLimit { position: 1.0, positive: false });
        assert!(watch.look(f64::NAN, free).is_err());
    }

    #[test]
    fn what_is_not_enabled_is_not_watched() {
        let switch = AxisSignals { positive_limit: Some(true), ..Default::default() };
        let mut off = LimitWatch::new(AxisLimits::default(), Movement::Linear);
        assert_eq!(off.look(1e9, switch), Ok(()));
        let limits = AxisLimits { software: Some((0.0, 1.0)), hardware: true };
        let mut rotary = LimitWatch::new(limits, Movement::Rotary { period: 360.0 });
        assert_eq!(rotary.look(350.0, switch), Ok(()));
    }
}
