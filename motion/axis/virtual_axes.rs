//! Virtual axes: time and encoder (manual 2.1.4, 2.2.6, 2.2.9).

use super::{Axis, AxisConfig, AxisState, Movement, SmcError};
use twin_profile::State;

/// An axis whose position is the time, s (`SMC_TimeAxisFB`, manual 2.2.6).
///
/// It counts from 0 while Execute is TRUE, from the rising edge on, and stops when it is FALSE.
#[doc(alias = "SMC_TimeAxisFB")]
#[derive(Clone, Debug)]
pub struct TimeAxis {
    /// `fOverride`: how fast the time goes; 1 as usual.
    pub time_override: f64,
    /// `fRampInTime`: how long a change of the override takes, s.
    pub ramp_in_time: f64,
    axis: Axis,
    execute: bool,
    /// Override at work, the one it comes from and the one it goes to.
    speed: f64,
    ramp: [f64; 2],
}

impl TimeAxis {
    /// Counts in cycles of `cycle` s (`fTaskCycle`), from 0 again after `period` s (`bPeriodic`, `fPeriod`).
    #[must_use]
    pub fn new(cycle: f64, period: Option<f64>) -> Self {
        let movement = period.map_or(Movement::Linear, |period| Movement::Rotary { period });
        let config = AxisConfig { movement, cycle, ..AxisConfig::default() };
        let mut axis = Axis::new(config);
        // Its set values are what a follower takes.
        axis.values.regulator_on = true;
        Self {
            time_override: 1.0,
            ramp_in_time: 0.0,
            axis,
            execute: false,
            speed: 1.0,
            ramp: [1.0, 1.0],
        }
    }

    /// Calls it, for a cycle.
    pub fn call(&mut self, execute: bool) -> &Axis {
        let rising = execute && !self.execute;
        self.execute = execute;
        let cycle = self.axis.cycle();
        self.axis.saved = self.axis.total();
        let State { mut position, velocity: before, .. } = self.axis.saved;
        let mut change = 0.0;
        if rising {
            if self.time_override.is_finite() {
                self.speed = self.time_override;
            }
            self.ramp = [self.speed; 2];
            // Counting anew is not a motion.
            self.axis.zero -= position;
            position = 0.0;
        }
        self.axis.values.save_position = position;
        self.axis.values.save_velocity = before;
        if execute && !rising {
            let before = self.speed;
            self.change_speed(cycle);
            change = self.speed - before;
            position += 0.5 * (before + self.speed) * cycle;
        }
        position = self.axis.wrapped(position);
        let velocity = if execute { self.speed } else { 0.0 };
        let acceleration = if cycle > 0.0 { change / cycle } else { 0.0 };
        self.axis.enter(if execute { AxisState::ContinuousMotion } else { AxisState::Standstill });
        self.axis.drive_to(State { position, velocity, acceleration });
        &self.axis
    }

    /// The axis, to be followed.
    #[must_use]
    pub fn axis(&self) -> &Axis {
        &self.axis
    }

    fn change_speed(&mut self, cycle: f64) {
        if !self.time_override.is_finite() {
            return;
        }
        let [_, to] = self.ramp;
        if (self.time_override - to).abs() > 0.0 {
            self.ramp = [self.speed, self.time_override];
        }
        let [from, to] = self.ramp;
        let step = if self.ramp_in_time > cycle {
            (to - from).abs() * cycle / self.ramp_in_time
        } else {
            f64::INFINITY
        };
        let left = to - self.speed;
        self.speed = if left.abs() <= step { to } else { self.speed + step.copysign(left) };
    }
}

/// An encoder as an axis that others follow (`SMC_Encoder`, manual 2.2.9).
#[doc(alias = "SMC_Encoder")]
#[doc(alias = "SMC_ENCODER_REF")]
#[derive(Clone, Debug)]
pub struct Encoder {
    /// Increments to u.
    ratio: [i64; 2],
    /// Increments until the encoder wraps.
    modulo: i64,
    axis: Axis,
    /// Increments counted so far, without wrapping, and the last raw value.
    counted: i64,
    last: Option<u32>,
    /// Velocity in the cycle before, u/s, from the second value on.
    velocity: Option<f64>,
}

/// Outputs of [`Encoder`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EncoderOutputs {
    /// `bValid`: the axis may be followed.
    pub valid: bool,
    /// 5000 for a ratio with the denominator 0, 5001 if a block moves the axis.
    pub error: Option<SmcError>,
}

impl Encoder {
    /// An encoder (`SMC_ENCODER_REF`, manual 2.1.4): its number, ratio, movement, software limits and cycle time in `config`;
    /// it wraps after `modulo` increments (`dwEncoderModulo`), with 0 after 32 bit. Nothing is counted yet.
    #[must_use]
    pub fn new(config: AxisConfig, modulo: u32) -> Self {
        let axis = Axis::new(config);
        let modulo = if modulo == 0 { 1 << 32 } else { i64::from(modulo) };
        Self { ratio: config.ratio, modulo, axis, counted: 0, last: None, velocity: None }
    }

    /// Takes in the encoder's value for a cycle; velocity and acceleration are differences, as those of a drive's actual
    /// position. `set` (`bSet`, `fSetValue`) makes the present position that value, u.
    pub fn call(&mut self, raw: u32, set: Option<f64>) -> EncoderOutputs {
        if self.ratio[1] == 0 {
            return EncoderOutputs { valid: false, error: Some(SmcError::EncDenomZero) };
        }
        if self.axis.owner() != 0 {
            return EncoderOutputs { valid: false, error: Some(SmcError::EncAxisusedbyotherfb) };
        }
        let known = self.last.is_some();
        self.counted += self.travel(raw);
        self.last = Some(raw);
        let position = units(self.counted, self.ratio);
        let cycle = self.axis.cycle();
        let way = position - self.axis.drive.position;
        let velocity = (known && cycle > 0.0).then(|| way / cycle);
        let change = velocity.zip(self.velocity).map(|(now, before)| (now - before) / cycle);
        self.velocity = velocity;
        let (velocity, acceleration) = (velocity.unwrap_or_default(), change.unwrap_or_default());
        if !known {
            // The first value is not a motion.
            self.axis.zero += way;
        }
        self.axis.drive.position = position;
        if let Some(value) = set.filter(|value| value.is_finite()) {
            self.axis.zero += value - position - self.axis.values.offset_position;
            self.axis.values.offset_position = value - position;
        }
        self.axis.base = State { position, velocity, acceleration };
        self.axis.saved = self.axis.base;
        self.axis.show_set_values();
        self.axis.values.act_position = self.axis.set_position();
        self.axis.values.act_velocity = velocity;
        self.axis.values.act_acceleration = acceleration;
        self.axis.values.communication = true;
        self.axis.watch_encoder_limits();
        EncoderOutputs { valid: true, error: None }
    }

    /// The axis, to be followed; its actual values count.
    #[must_use]
    pub fn axis(&self) -> &Axis {
        &self.axis
    }

    /// The same, for blocks that need it to themselves.
    #[cfg(test)]
    pub(crate) fn axis_mut(&mut self) -> &mut Axis {
        &mut self.axis
    }

    /// Increments since the last value, the short way round.
    fn travel(&self, raw: u32) -> i64 {
        // The first value counts from 0.
        let Some(last) = self.last else { return i64::from(raw) };
        let way = (i64::from(raw) - i64::from(last)).rem_euclid(self.modulo);
        if way * 2 > self.modulo { way - self.modulo } else { way }
    }
}

impl Axis {
    fn watch_encoder_limits(&mut self) {
        let watched = self.values.sw_limit_enable && self.movement == Movement::Linear;
        let inside = (self.values.sw_limit_negative..=self.values.sw_limit_positive)
            .contains(&self.values.act_position);
        if watched && !inside {
            self.fail_with(SmcError::DiSwlimitsExceeded.number());
        }
    }
}

/// Increments in u, by numerator and denominator (manual 2.1.3).
#[must_use]
pub fn units(increments: i64, [numerator, denominator]: [i64; 2]) -> f64 {
    // Whole turns and rest separately, so that a large count keeps its digits.
    let number = |value: i64| {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53 are exact")]
        let number = value as f64;
        number
    };
    if denominator == 0 {
        return 0.0;
    }
    let (whole, rest) = (increments.div_euclid(denominator), increments.rem_euclid(denominator));
    number(whole) * number(numerator) + number(rest) * number(numerator) / number(denominator)
}
