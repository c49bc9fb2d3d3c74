//! Peaks: the largest position, velocity, acceleration and jerk commanded to each axis, with their lines.

use twin_machine::Axis;
use twin_number::rounded;
use twin_path::Place;

/// A value, its limit and where it was found. SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// The largest absolute value.
    pub value: f64,
    /// Its place.
    pub place: Place,
}

impl Peak {
    /// Takes `value` if it is larger.
    pub fn include(&mut self, value: f64, place: Place) {
        if value.abs() > self.value {
            *self = Self { value: value.abs(), place };
        }
    }
}

/// The largest values asked of one axis. SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisPeak {
    /// Smallest and largest position.
    pub position: Option<[f64; 2]>,
    /// Velocity.
    pub velocity: Peak,
    /// Acceleration.
    pub acceleration: Peak,
    /// Deceleration, where it has a limit of its own and was kept apart: [`Self::acceleration`] is then that of growing
    /// speed.
    pub deceleration: Option<Peak>,
    /// Jerk, by differences of the acceleration between cycles.
    pub jerk: Peak,
    /// Distance between set-point and simulated machine, if it was simulated.
    pub following_error: Option<Peak>,
    /// Force or torque of the motor, N or Nm, where it is known.
    pub effort: Option<Peak>,
}

impl AxisPeak {
    /// Takes a range of positions, m or rad.
    pub(crate) fn include_position(&mut self, [low, high]: [f64; 2]) {
        let [least, most] = self.position.unwrap_or([low, high]);
        self.position = Some([least.min(low), most.max(high)]);
    }

    /// Takes an acceleration of `axis`, at which its speed falls if it `slows`.
    pub fn include_acceleration(&mut self, axis: &Axis, slows: bool, value: f64, place: Place) {
        if axis.own_deceleration().is_some() {
            let deceleration = self.deceleration.get_or_insert_default();
            if slows {
                return deceleration.include(value, place);
            }
        }
        self.acceleration.include(value, place);
    }

    /// The larger of acceleration and deceleration, by their shares of their limits, with its limit (m/s² or rad/s²).
    pub fn hardest(&self, axis: &Axis) -> (Peak, f64) {
        let limit = self.acceleration_limit(axis);
        match self.deceleration {
            Some(slowing)
                if slowing.value / axis.max_deceleration > self.acceleration.value / limit =>
            {
                (slowing, axis.max_deceleration)
            }
            _ => (self.acceleration, limit),
        }
    }

    /// Limit of [`Self::acceleration`], m/s² or rad/s².
    pub fn acceleration_limit(&self, axis: &Axis) -> f64 {
        match self.deceleration {
            Some(_) => axis.max_acceleration,
            None => axis.smallest_acceleration(),
        }
    }
}

#[derive(Clone, Copy, Debug, serde::Serialize)]
struct PeakReport {
    value: f64,
    limit: Option<f64>,
    /// None if the axis was asked for nothing.
    line: Option<u32>,
    block: Option<u32>,
}

#[derive(Clone, Debug, serde::Serialize)]
struct PositionReport {
    min: Option<f64>,
    max: Option<f64>,
    limit_min: Option<f64>,
    limit_max: Option<f64>,
}

/// The largest values asked of one axis, in its unit.
#[derive(Clone, Debug, serde::Serialize)]
pub struct AxisPeakReport {
    unit: &'static str,
    position: PositionReport,
    velocity: PeakReport,
    acceleration: PeakReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    deceleration: Option<PeakReport>,
    jerk: PeakReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    following_error: Option<PeakReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    effort: Option<EffortReport>,
}

/// The largest force or torque of a motor.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct EffortReport {
    unit: &'static str,
    #[serde(flatten)]
    peak: PeakReport,
}

impl AxisPeakReport {
    /// For one axis.
    pub fn new(axis: &Axis, peak: &AxisPeak) -> Self {
        let plain = |value: f64, limit: Option<f64>, peak: &Peak| PeakReport {
            value: rounded(value),
            limit: limit.map(rounded),
            line: (peak.value > 0.0).then_some(peak.place.line),
            block: peak.place.block,
        };
        let report = |peak: &Peak, limit: Option<f64>| {
            plain(axis.from_si(peak.value), limit.map(|limit| axis.from_si(limit)), peak)
        };
        let limits = axis.position_limits.map(|limit| rounded(axis.from_si(limit)));
        let [limit_min, limit_max] = limits.map(|limit| axis.limited.then_some(limit));
        Self {
            unit: axis.unit(),
            position: PositionReport {
                min: peak.position.map(|[min, _]| rounded(axis.from_si(min))),
                max: peak.position.map(|[_, max]| rounded(axis.from_si(max))),
                limit_min,
                limit_max,
            },
            velocity: report(&peak.velocity, Some(axis.max_velocity)),
            acceleration: report(&peak.acceleration, Some(peak.acceleration_limit(axis))),
            deceleration: peak
                .deceleration
                .as_ref()
                .map(|deceleration| report(deceleration, Some(axis.max_deceleration))),
            jerk: report(&peak.jerk, axis.max_jerk),
            following_error: peak
                .following_error
                .as_ref()
                .map(|error| report(error, axis.max_following_error)),
            effort: peak.effort.as_ref().map(|effort| EffortReport {
                unit: axis.kind.effort_unit(),
                peak: plain(effort.value, axis.effort_limit(), effort),
            }),
        }
    }
}
