//! Switched signals: lines over time in a plot, and marks along the trails.

use nalgebra::Point3;
use rerun::{Points3D, Radius};

use super::At;
use super::series::Series;
use crate::error::Result;
use crate::palette;
use crate::recorder::Recorder;
use crate::units::point_mm;

/// Marks are kept as trails are: all up to the cursor are shown.
const MARKS: &str = "trail/switched";
/// Radius of a mark, points.
const MARK_RADIUS: f32 = 3.5;
/// How far apart the lines of two signals are; one that is on is this much less 0.2 above its own zero.
const APART: f64 = 1.2;

/// The signals of a program.
#[derive(Debug, Default)]
pub(super) struct Signals {
    signals: Vec<Signal>,
}

#[derive(Debug)]
struct Signal {
    name: String,
    is_on: bool,
    series: Series,
    /// Where its line is in the plot while it is off.
    zero: f64,
}

impl Signals {
    /// All off, one above the other.
    pub(super) fn new(names: &[String]) -> Self {
        let mut zero = 0.0;
        let signal = |(index, name): (usize, &String)| {
            let color = palette::shade(palette::between(), index);
            let series = Series::new(format!("switched/{index}"), name, color);
            let signal = Signal { name: name.clone(), is_on: false, series, zero };
            zero += APART;
            signal
        };
        Self { signals: names.iter().enumerate().map(signal).collect() }
    }

    pub(super) fn are_there(&self) -> bool {
        !self.signals.is_empty()
    }

    /// Switches a signal at the set-point; the words for it, if there is such a signal.
    pub(super) fn switch(
        &mut self,
        stream: &mut Recorder,
        tool: &Point3<f64>,
        index: usize,
        on: bool,
    ) -> Result<Option<String>> {
        let Some(signal) = self.signals.get_mut(index) else { return Ok(None) };
        signal.is_on = on;
        let words = format!("{} {}", signal.name, if on { "on" } else { "off" });
        let color = palette::shade(palette::between(), index);
        let mark = Points3D::new([point_mm(tool)])
            .with_colors([color])
            .with_radii([Radius::new_ui_points(MARK_RADIUS)])
            .with_labels([words.as_str()])
            .with_show_labels(false);
        stream.log(MARKS, &mark)?;
        Ok(Some(words))
    }

    /// Adds the present state of every signal to its series.
    pub(super) fn add(&mut self, at: At) {
        for Signal { is_on, series, zero, .. } in &mut self.signals {
            series.add(at, *zero + f64::from(u8::from(*is_on)));
        }
    }

    /// Sends what is held back.
    pub(super) fn flush(&mut self, stream: &mut Recorder) -> Result<()> {
        self.signals.iter_mut().try_for_each(|signal| signal.series.flush(stream))
    }
}
