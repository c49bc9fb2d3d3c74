//! Plots of motors: force, torque, power, utilisation, warmth and load angle.

use crate::frame::{Axis, AxisUnit, MotorFrame};

/// A quantity of motors, with a plot of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MotorPlot {
    /// Of linear axes, N.
    Force,
    /// Of rotary axes, Nm.
    Torque,
    /// Effort against what the motor can give at its speed, %.
    Utilisation,
    /// Mechanical, W.
    Power,
    /// Smoothed losses of the winding against those it bears (I²t), %.
    Warmth,
    /// From the field of a step motor to its rotor, full steps.
    LoadAngle,
}

impl MotorPlot {
    /// The plots of motors of which `motors` is known, one per axis, the one looked at first on top.
    pub(crate) fn of(axes: &[Axis], motors: &[MotorFrame]) -> Vec<Self> {
        let has = |unit| axes.iter().zip(motors).any(|(axis, _)| axis.unit == unit);
        let know = |known: fn(&MotorFrame) -> bool| motors.iter().any(known);
        let plots = [
            (has(AxisUnit::Linear), Self::Force),
            (has(AxisUnit::Rotary), Self::Torque),
            (know(|motor| motor.utilisation.is_some()), Self::Utilisation),
            (!motors.is_empty(), Self::Power),
            (know(|motor| motor.warmth.is_some()), Self::Warmth),
            (know(|motor| motor.load_angle.is_some()), Self::LoadAngle),
        ];
        plots.into_iter().filter_map(|(shown, plot)| shown.then_some(plot)).collect()
    }

    /// The effort of such an axis.
    pub(crate) fn effort(unit: AxisUnit) -> Self {
        match unit {
            AxisUnit::Rotary => Self::Torque,
            AxisUnit::Linear => Self::Force,
        }
    }

    /// Entity path of its series.
    pub(crate) fn entity(self) -> &'static str {
        match self {
            Self::Force => "motor/force_n",
            Self::Torque => "motor/torque_nm",
            Self::Utilisation => "motor/utilisation_percent",
            Self::Power => "motor/power_w",
            Self::Warmth => "motor/warmth_percent",
            Self::LoadAngle => "motor/load_angle_full_steps",
        }
    }

    /// Title of the plot.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Force => "Motor forces at the axes (N)",
            Self::Torque => "Motor torques at the axes (Nm)",
            Self::Utilisation => "Motor utilisation (% of what it can give at its speed)",
            Self::Power => "Mechanical power (W)",
            Self::Warmth => "Warmth of the windings, I²t (%)",
            Self::LoadAngle => "Load angle of step motors (full steps)",
        }
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Torque => "Nm",
            Self::Utilisation | Self::Warmth => "%",
            Self::Power => "W",
            Self::LoadAngle => "full steps",
        }
    }
}
