//! `SMC_Encoder`: an axis made of what an encoder counts (2.1.4, 2.2.9).

use super::{AxisError, AxisLimits, Gearing, LimitWatch, Movement, Unwrapped};
use crate::{AxisSignals, axis::Direction};

/// `SMC_ENCODER_REF`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderOptions {
    /// `wEncoderId`.
    pub id: u16,
    /// `iRatioTechUnitsNum`: so many technical units are …
    pub units: i32,
    /// `dwRatioTechUnitsDenom`: … so many increments.
    pub increments: u32,
    /// `iMovementType` and `fPositionPeriod`.
    pub movement: Movement,
    /// `bSWLimitEnable`, `fSWLimitNegative` and `fSWLimitPositive`, technical units; linear encoders only.
    pub software_limits: Option<(f64, f64)>,
    /// `dwEncoderModulo`: where the counter wraps; 0 for 32 bits.
    pub modulo: u32,
}

/// What an encoder says about its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderState {
    /// Technical units; in [0, period[ if it is rotary.
    pub position: f64,
    /// u/s, mean since the look before; 0 at the first.
    pub velocity: f64,
}

/// An encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoder {
    options: EncoderOptions,
    gearing: Gearing,
    watch: LimitWatch,
    /// Once it has been looked at.
    counter: Option<(Unwrapped, i64)>,
    /// Increments that the position has more than the counter.
    offset: i64,
}

impl Encoder {
    /// An encoder that has not been looked at.
    ///
    /// # Errors
    /// [`AxisError::EncoderDenominator`] (5000) if the denominator of its ratio is 0; [`AxisError::Gearing`] if its
    /// numerator is, or the period is impossible.
    pub fn new(options: &EncoderOptions) -> Result<Self, AxisError> {
        if options.increments == 0 {
            return Err(AxisError::EncoderDenominator);
        }
        let (units, increments) = (options.units, options.increments);
        let gearing = Gearing::new(units, increments, Direction::Positive, options.movement)?;
        let limits = AxisLimits { software: options.software_limits, hardware: false };
        let watch = LimitWatch::new(limits, options.movement);
        Ok(Self { options: *options, gearing, watch, counter: None, offset: 0 })
    }

    /// Its configuration.
    pub fn options(&self) -> &EncoderOptions {
        &self.options
    }

    /// `bValid`: it has been looked at and is in its window.
    pub fn valid(&self) -> bool {
        self.counter.is_some() && self.watch.error().is_none()
    }

    /// What the counter shows at `time_ns`.
    ///
    /// # Errors
    /// [`AxisError::EncoderJump`] if that is impossible, which leaves the position as it was;
    /// [`AxisError::SoftwareLimit`] (10) outside the window, until [`Self::reset`]; [`AxisError::Overflow`].
    pub fn update(&mut self, counter: u32, time_ns: i64) -> Result<EncoderState, AxisError> {
        let (before, now, since_ns) = if let Some((unwrapped, at_ns)) = &mut self.counter {
            let before = unwrapped.total();
            let now = unwrapped.update(counter)?;
            (before, now, time_ns.saturating_sub(std::mem::replace(at_ns, time_ns)))
        } else {
            let unwrapped = Unwrapped::new(self.options.modulo, counter)?;
            self.counter = Some((unwrapped, time_ns));
            (unwrapped.total(), unwrapped.total(), 0)
        };
        #[expect(clippy::cast_precision_loss, reason = "for a message")]
        let overflow = || AxisError::Overflow { position: now as f64 };
        let increments = now.checked_add(self.offset).ok_or_else(overflow)?;
        let position = self.gearing.place(increments).position;
        let way = self.gearing.ratio().units(now.saturating_sub(before));
        #[expect(clippy::cast_precision_loss, reason = "nanoseconds between two looks")]
        let velocity = if since_ns > 0 { way / (since_ns as f64 * 1e-9) } else { 0.0 };
        self.watch.look(position, AxisSignals::default())?;
        Ok(EncoderState { position, velocity })
    }

    /// `bSet`: the present position is `position` (`fSetValue`), to the nearest increment.
    ///
    /// # Errors
    /// [`AxisError::Overflow`] if there is no such position.
    pub fn set(&mut self, position: f64) -> Result<(), AxisError> {
        let overflow = || AxisError::Overflow { position };
        let total = self.counter.map_or(0, |(unwrapped, _)| unwrapped.total());
        let wanted = self.gearing.ratio().increments(position)?;
        self.offset = wanted.checked_sub(total).ok_or_else(overflow)?;
        Ok(())
    }

    /// Leaves the error of a window that has been left.
    pub fn reset(&mut self) {
        self.watch.reset();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: EncoderOptions = EncoderOptions {
        id: 3,
        units: 360,
        increments: 4000,
        movement: Movement::Rotary { period: 360.0 },
        software_limits: None,
        modulo: 0x1_0000,
    };

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }

    #[test]
    fn a_counter_that_wraps_becomes_an_axis() {
        let mut encoder = Encoder::new(&OPTIONS).unwrap();
        assert!(!encoder.valid());
        let first = encoder.update(65_000, 0).unwrap();
        // 65000 · 0.09° = 5850° = 16 turns and 90°.
        near(first.position, 90.0);
        near(first.velocity, 0.0);
        assert!(encoder.valid());
        // Over the end of the counter: 1000 increments in 0.1 s.
        let next = encoder.update(464, 100_000_000).unwrap();
        near(next.position, 180.0);
        near(next.velocity, 900.0);
        // 9.02° is nearest to 100 increments.
        encoder.set(9.02).unwrap();
        near(encoder.update(464, 200_000_000).unwrap().position, 9.0);
        near(encoder.update(364, 300_000_000).unwrap().position, 0.0);
        assert!(matches!(encoder.update(0x1_0000, 1), Err(AxisError::EncoderJump { .. })));
        assert!(matches!(encoder.set(f64::NAN), Err(AxisError::Overflow { .. })));
        assert_eq!(encoder.options().id, 3);
    }

    #[test]
    fn a_window_is_watched_and_a_denominator_is_wanted() {
        let none = EncoderOptions { increments: 0, ..OPTIONS };
        assert_eq!(Encoder::new(&none).unwrap_err().number(), Some(5000));
        let none = EncoderOptions { units: 0, ..OPTIONS };
        assert_eq!(Encoder::new(&none).unwrap_err().number(), Some(90));
        let linear = EncoderOptions {
            movement: Movement::Linear,
            software_limits: Some((0.0, 45.0)),
            modulo: 0,
            ..OPTIONS
        };
        let mut encoder = Encoder::new(&linear).unwrap();
        near(encoder.update(500, 0).unwrap().position, 45.0);
        assert_eq!(encoder.update(501, 1).unwrap_err().number(), Some(10));
        assert!(!encoder.valid());
        assert!(encoder.update(400, 2).is_err(), "until it is reset");
        encoder.reset();
        near(encoder.update(400, 3).unwrap().position, 36.0);
    }
}
