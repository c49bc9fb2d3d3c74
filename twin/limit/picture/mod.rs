//! The profile as a picture: velocity along the path against the programmed feed; velocity, acceleration and jerk of the
//! axes and efforts of their motors against their limits; which limit holds the path back, and the lines of the program.

mod draw;

use super::{Binding, ProfileSample};
use crate::chart::{COLUMNS, Envelope, Failure, Input};
use crate::machine::Axis;
use crate::peak::Peak;

/// Curves before those of the axes: velocity along the path and programmed feed, mm/s.
const PATH: usize = 0;
const FEED: usize = 1;
const FIRST_AXIS: usize = 2;
/// Curves of each axis: velocity, acceleration, jerk and effort of its motor as parts of their limits.
const PER_AXIS: usize = 4;

/// Kinds of limits behind those of the axes.
const KINDS: [&str; 6] = [
    "programmed feed (F)",
    "programmed acceleration (E)",
    "jerk along the path",
    "acceleration of the tool tip",
    "stop",
    "acceleration towards the centre of curves",
];

/// A picture that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture cannot be drawn: {0}")]
pub struct PictureError(#[from] Failure);

/// A picture of a profile. It takes the samples one by one and keeps as much of them as its page shows.
#[derive(Clone, Debug)]
pub struct Picture<'m> {
    axes: &'m [Axis],
    /// The efforts of the motors are known.
    efforts: bool,
    envelope: Envelope,
    values: Vec<Option<f64>>,
    held: Option<usize>,
    peaks: Vec<[Highest; PER_AXIS]>,
    /// Along the path, mm/s.
    fastest: Highest,
    /// Way along the path at the first and the last sample, m.
    way: Option<[f64; 2]>,
}

/// The largest value of a curve, and when that was.
#[derive(Clone, Copy, Debug, Default)]
struct Highest {
    peak: Peak,
    /// With its sign.
    value: f64,
    time_ns: i64,
}

impl Highest {
    fn include(&mut self, value: f64, sample: &ProfileSample) {
        let before = self.peak.value;
        self.peak.include(value, sample.place);
        if self.peak.value > before {
            (self.value, self.time_ns) = (value, sample.time_ns);
        }
    }
}

impl<'m> Picture<'m> {
    /// Of a machine with these axes. With `efforts` the samples have those of the motors.
    pub fn new(axes: &'m [Axis], efforts: bool) -> Self {
        let curves = FIRST_AXIS + PER_AXIS * axes.len();
        Self {
            axes,
            efforts,
            envelope: Envelope::new(COLUMNS, axes.len() + KINDS.len()),
            values: vec![None; curves],
            held: None,
            peaks: vec![[Highest::default(); PER_AXIS]; axes.len()],
            fastest: Highest::default(),
            way: None,
        }
    }

    /// The limits of an axis in the order of its curves.
    fn limits(&self, axis: &Axis) -> [Option<f64>; PER_AXIS] {
        let effort = axis.effort_limit().filter(|_| self.efforts);
        [Some(axis.max_velocity), Some(axis.max_acceleration), axis.max_jerk, effort]
    }

    /// Takes the next sample.
    pub fn include(&mut self, sample: &ProfileSample) {
        self.values.clear();
        self.values.push(Some(sample.path_velocity * 1e3));
        self.values.push((sample.feed > 0.0).then_some(sample.feed * 1e3));
        for (index, axis) in self.axes.iter().enumerate() {
            let limits = self.limits(axis);
            let of = [
                Some(&sample.velocity),
                Some(&sample.acceleration),
                Some(&sample.jerk),
                sample.effort.as_ref(),
            ];
            let Some(peaks) = self.peaks.get_mut(index) else { continue };
            for ((values, limit), highest) in of.into_iter().zip(limits).zip(peaks) {
                let value = values.and_then(|values| values.get(index).copied());
                let value = value.unwrap_or_default();
                let part = limit.map(|limit| value / limit);
                if let Some(part) = part {
                    highest.include(part, sample);
                }
                self.values.push(part);
            }
        }
        self.fastest.include(sample.path_velocity * 1e3, sample);
        let [begin, _] = self.way.unwrap_or([sample.way; 2]);
        self.way = Some([begin, sample.way]);
        let input = Input {
            time_ns: sample.time_ns,
            line: sample.place.line,
            values: &self.values,
            held: self.held,
        };
        self.envelope.include(&input);
        self.held = sample.binding.and_then(|binding| self.kind(binding));
    }

    /// In which colour of the strip a limit is shown: by the place of its axis, or behind the axes.
    fn kind(&self, binding: Binding) -> Option<usize> {
        let number = match binding {
            Binding::Axis { axis, .. } => return (axis < self.axes.len()).then_some(axis),
            Binding::Feed | Binding::EndVelocity => 0,
            Binding::PathAcceleration | Binding::PathDeceleration => 1,
            Binding::PathJerk => 2,
            Binding::ToolAcceleration => 3,
            Binding::Stop => 4,
            Binding::Centripetal => 5,
        };
        Some(self.axes.len() + number)
    }

    /// Draws the picture as SVG, of `program` on `machine`, by their names.
    ///
    /// # Errors
    /// What plotters says.
    pub fn draw(&self, program: &str, machine: &str) -> Result<String, PictureError> {
        Ok(draw::Drawing::new(self).draw(program, machine)?)
    }

    /// The largest values of the axes as parts of their limits.
    fn parts(&self, quantity: usize) -> impl Iterator<Item = (usize, &Axis, &Highest)> {
        self.axes.iter().zip(&self.peaks).enumerate().filter_map(move |(index, (axis, peaks))| {
            self.limits(axis).get(quantity).copied().flatten()?;
            Some((index, axis, peaks.get(quantity)?))
        })
    }
}
