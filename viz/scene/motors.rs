//! Time series of the motors: force or torque, power, utilisation, warmth, load angle.

use super::At;
use super::series::Series;
use crate::error::Result;
use crate::frame::{Axis, MotorFrame};
use crate::motor_plot::MotorPlot;
use crate::palette;
use crate::recorder::Recorder;

/// The series of the motor of one axis.
#[derive(Debug)]
pub(super) struct MotorSeries {
    effort: Series,
    /// The same up and down.
    limit: Series,
    power: Series,
    utilisation: Series,
    warmth: Series,
    load_angle: Series,
}

impl MotorSeries {
    /// One per axis, below `motor/<quantity>_<unit>`: the twin in green of different brightness, limits in grey.
    pub(super) fn all(axes: &[Axis]) -> Vec<Self> {
        let mut all = Vec::with_capacity(axes.len());
        for (index, axis) in axes.iter().enumerate() {
            let before = axes.iter().take(index).filter(|before| before.unit == axis.unit).count();
            let name = rerun::EntityPath::from_single_string(axis.name.clone());
            let twin = |plot: MotorPlot, index| {
                let entity = format!("{}{name}/twin", plot.entity());
                let label = format!("{} twin ({})", axis.name, plot.unit());
                Series::new(entity, &label, palette::shade(palette::twin(), index))
            };
            let effort = MotorPlot::effort(axis.unit);
            let entity = format!("{}{name}/limit", effort.entity());
            let label = format!("{} limit ({})", axis.name, effort.unit());
            // The limit is often so large that the effort would look flat.
            let limit =
                Series::new(entity, &label, palette::shade(palette::limit(), before)).hidden();
            all.push(Self {
                // Forces and torques have plots of their own, the others one for all axes.
                effort: twin(effort, before),
                limit,
                power: twin(MotorPlot::Power, index),
                utilisation: twin(MotorPlot::Utilisation, index),
                warmth: twin(MotorPlot::Warmth, index),
                load_angle: twin(MotorPlot::LoadAngle, index),
            });
        }
        all
    }

    /// Adds what the motor does.
    pub(super) fn add(&mut self, at: At, motor: &MotorFrame) {
        let MotorFrame { effort, effort_limit, power, utilisation, warmth, load_angle } = *motor;
        for (series, value) in [
            (&mut self.effort, Some(effort)),
            (&mut self.limit, effort_limit),
            (&mut self.power, Some(power)),
            (&mut self.utilisation, utilisation.map(|part| part * 100.0)),
            (&mut self.warmth, warmth.map(|part| part * 100.0)),
            (&mut self.load_angle, load_angle),
        ] {
            if let Some(value) = value {
                series.add(at, value);
            }
        }
    }

    /// Sends what is held back.
    pub(super) fn flush(&mut self, stream: &mut Recorder) -> Result<()> {
        let Self { effort, limit, power, utilisation, warmth, load_angle } = self;
        [effort, limit, power, utilisation, warmth, load_angle]
            .into_iter()
            .try_for_each(|series| series.flush(stream))
    }
}
