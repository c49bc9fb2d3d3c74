//! Motor load of an axis: forces, powers, energy.

/// Motor load since the machine was made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorLoad {
    /// Duration, s.
    pub duration: f64,
    /// Largest effort, N or Nm.
    pub peak_effort: f64,
    /// Root of the mean square of the effort, N or Nm.
    pub rms_effort: f64,
    /// Largest mechanical power, driving or braking, W.
    pub peak_power: f64,
    /// Root of the mean square of the power, W.
    pub rms_power: f64,
    /// Energy given to the axis, J.
    pub driving_energy: f64,
    /// Energy taken back while braking, J.
    pub braking_energy: f64,
    /// Largest winding losses relative to the continuous limit, smoothed (I²t); `None` if unknown.
    pub peak_warmth: Option<f64>,
}

/// State of a motor in a cycle; efforts at the axis (behind the gear).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorState {
    /// Force or torque, mean over the cycle, N or Nm.
    pub effort: f64,
    /// The largest it could give at the speed it has at the end of the cycle, N or Nm; `None` without a limit.
    pub effort_limit: Option<f64>,
    /// Mechanical power, mean over the cycle, W; less than 0 while it brakes.
    pub power: f64,
    /// Winding losses relative to the continuous limit, smoothed (I²t), at the end of the cycle; `None` if unknown.
    pub warmth: Option<f64>,
    /// Load angle of a step motor: lead of the field over the rotor at the end of the cycle, full steps.
    pub load_angle: Option<f64>,
}

impl MotorState {
    /// Utilisation: effort relative to the effort limit; 1 is all. `None` without a limit, or where the limit is 0.
    pub fn utilisation(&self) -> Option<f64> {
        let limit = self.effort_limit.filter(|limit| *limit > 0.0)?;
        Some(self.effort.abs() / limit)
    }
}

/// Sums of one axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoadSums {
    duration: f64,
    peak_effort: f64,
    effort_v2: f64,
    peak_power: f64,
    power_v2: f64,
    driving: f64,
    braking: f64,
    warmth: Option<f64>,
}

impl LoadSums {
    /// Of `dt` s with the mean `effort` at the mean `velocity`.
    pub(super) fn add(&mut self, effort: f64, velocity: f64, dt: f64) {
        let power = effort * velocity;
        self.duration += dt;
        self.peak_effort = self.peak_effort.max(effort.abs());
        self.effort_v2 += effort * effort * dt;
        self.peak_power = self.peak_power.max(power.abs());
        self.power_v2 += power * power * dt;
        if power > 0.0 {
            self.driving += power * dt;
        } else {
            self.braking -= power * dt;
        }
    }

    /// Takes the present warmth of the winding.
    pub(super) fn observe_warmth(&mut self, warmth: f64) {
        self.warmth = Some(self.warmth.map_or(warmth, |most| most.max(warmth)));
    }

    /// The load from these sums.
    pub(super) fn load(&self) -> MotorLoad {
        let rms = |sum: f64| if self.duration > 0.0 { (sum / self.duration).sqrt() } else { 0.0 };
        MotorLoad {
            duration: self.duration,
            peak_effort: self.peak_effort,
            rms_effort: rms(self.effort_v2),
            peak_power: self.peak_power,
            rms_power: rms(self.power_v2),
            driving_energy: self.driving,
            braking_energy: self.braking,
            peak_warmth: self.warmth,
        }
    }
}
