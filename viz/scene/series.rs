//! Time series (plot lines), sent in batches.

use rerun::{Scalars, SeriesLines, TimeColumn};

use super::At;
use crate::error::Result;
use crate::frame::{Axis, AxisUnit};
use crate::palette;
use crate::recorder::Recorder;
use crate::timeline::{LINE, TIME};
use crate::units::mm;

/// Width of the lines in the plots, points.
const LINE_WIDTH: f32 = 1.5;

/// One line in a plot. It does not exist in the recording until it has a value.
#[derive(Debug, Default)]
pub(super) struct Series {
    entity: String,
    label: String,
    color: rerun::Color,
    is_named: bool,
    is_hidden: bool,
    times_ns: Vec<i64>,
    lines: Vec<i64>,
    values: Vec<f64>,
}

impl Series {
    /// A line with its label in the legend and its colour.
    pub(super) fn new(entity: String, label: &str, color: rerun::Color) -> Self {
        Self { entity, label: label.to_owned(), color, ..Self::default() }
    }

    /// The same, of which only the legend is seen until it is clicked at.
    pub(super) fn hidden(self) -> Self {
        Self { is_hidden: true, ..self }
    }

    /// Adds a length in m or a speed in m/s, shown in mm or mm/s.
    pub(super) fn add_length(&mut self, at: At, value: f64) {
        self.add(at, mm(value));
    }

    /// Adds an angle in rad, shown in degrees.
    pub(super) fn add_angle(&mut self, at: At, value: f64) {
        self.add(at, value.to_degrees());
    }

    /// Adds a number that is shown as it is.
    pub(super) fn add(&mut self, at: At, shown: f64) {
        self.times_ns.push(at.time_ns);
        self.lines.push(i64::from(at.line));
        self.values.push(shown);
    }

    /// Sends what is held back.
    pub(super) fn flush(&mut self, stream: &mut Recorder) -> Result<()> {
        if self.values.is_empty() {
            return Ok(());
        }
        if !self.is_named {
            self.is_named = true;
            let looks = SeriesLines::new()
                .with_names([self.label.as_str()])
                .with_colors([self.color])
                .with_widths([LINE_WIDTH])
                .with_visible_series([!self.is_hidden]);
            // Columns without a time are static. They are sent at once: the name must not come after the values.
            stream.send_columns(self.entity.as_str(), [], looks.columns_of_unit_batches()?)?;
        }
        let times = TimeColumn::new_duration_nanos(TIME, std::mem::take(&mut self.times_ns));
        let lines = TimeColumn::new_sequence(LINE, std::mem::take(&mut self.lines));
        let values = Scalars::new(std::mem::take(&mut self.values)).columns_of_unit_batches()?;
        stream.send_columns(self.entity.as_str(), [times, lines], values)
    }
}

/// The errors of one axis.
#[derive(Debug)]
pub(super) struct AxisSeries {
    unit: AxisUnit,
    twin: Series,
    drives: Series,
}

impl AxisSeries {
    /// One per axis, below `error/axis_deg` or `error/axis_mm`: drives orange, twin green, by brightness.
    pub(super) fn all(axes: &[Axis]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::with_capacity(axes.len());
        for axis in axes {
            let index = all.iter().filter(|before| before.unit == axis.unit).count();
            let (folder, unit) = match axis.unit {
                AxisUnit::Rotary => ("axis_deg", "°"),
                AxisUnit::Linear => ("axis_mm", "mm"),
            };
            let entity = format!(
                "error/{folder}{}",
                rerun::EntityPath::from_single_string(axis.name.clone())
            );
            let line = |who: &str, color| {
                let label = format!("{} {who} ({unit})", axis.name);
                Series::new(format!("{entity}/{who}"), &label, palette::shade(color, index))
            };
            all.push(Self {
                unit: axis.unit,
                twin: line("twin", palette::twin()),
                drives: line("drives", palette::drives()),
            });
        }
        all
    }

    /// Adds the errors against the set-point, rad or m.
    pub(super) fn add(&mut self, at: At, twin: Option<f64>, drives: Option<f64>) {
        for (series, error) in [(&mut self.twin, twin), (&mut self.drives, drives)] {
            match (self.unit, error) {
                (AxisUnit::Rotary, Some(error)) => series.add_angle(at, error),
                (AxisUnit::Linear, Some(error)) => series.add_length(at, error),
                (_, None) => {}
            }
        }
    }

    /// Sends what is held back.
    pub(super) fn flush(&mut self, stream: &mut Recorder) -> Result<()> {
        self.twin.flush(stream)?;
        self.drives.flush(stream)
    }
}
