//! The profile as a picture: velocity along the path against the programmed feed; velocity, acceleration and jerk of the
//! axes and efforts of their motors against their limits; which limit holds the path back, and the lines of the program.

use super::text::{self, digits, percent};
use super::{Binding, ProfileSample};
use crate::peak::Peak;
use twin_kinematics::AxisVector;
use twin_machine::Axis;
use twin_machine::axis_kind::AxisKind;
use twin_number::seconds;
use twin_plot::{
    BACK, Chart, Color, INK, Legend, MARK, Mark, Row, Shape, Side, Sign, Stroke, Timeline,
};

/// Curves before those of the axes: velocity along the path and programmed feed, mm/s.
const PATH: usize = 0;
const FEED: usize = 1;
const FIRST_AXIS: usize = 2;
/// Curves of each axis: velocity, acceleration, jerk and effort of its motor in % of their limits.
const PER_AXIS: usize = 4;

/// Height of a row, and of a note next to it, pixels.
const HEIGHT: f64 = 150.0;
const NOTE: f64 = 19.0;
/// Height of a row per largest value; the label of its line needs the room.
const ROOM: f64 = 1.3;

/// Kinds of limits behind those of the axes, and their colours.
const KINDS: [(&str, Color); 6] = [
    ("programmed feed (F)", Color::rgb(214, 218, 224)),
    ("programmed acceleration (E)", Color::rgb(160, 166, 176)),
    ("jerk along the path", Color::rgb(128, 112, 168)),
    ("acceleration of the tool tip", Color::rgb(110, 116, 126)),
    ("stop", Color::rgb(34, 38, 46)),
    ("acceleration towards the centre of curves", Color::rgb(176, 150, 110)),
];

/// Quantities of the axes, and their units of rotary and linear ones.
const QUANTITIES: [(&str, [&str; 2]); PER_AXIS] = [
    ("velocity", ["deg/s", "mm/s"]),
    ("acceleration", ["deg/s²", "mm/s²"]),
    ("jerk", ["deg/s³", "mm/s³"]),
    ("motor effort", ["Nm", "N"]),
];

/// The one of them that is in SI anyway.
const EFFORT: usize = 3;

/// A picture of a profile. It takes the samples one by one and keeps as much of them as its page shows.
#[derive(Clone, Debug)]
pub struct Picture<'m> {
    axes: &'m [Axis],
    /// The efforts of the motors are known.
    efforts: bool,
    timeline: Timeline,
    values: Vec<Option<f64>>,
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
    time_s: f64,
    /// The limit then.
    limit: f64,
}

impl Highest {
    fn include(&mut self, value: f64, limit: f64, sample: &ProfileSample) {
        let before = self.peak.value;
        self.peak.include(value, sample.place);
        if self.peak.value > before {
            (self.value, self.time_s, self.limit) = (value, seconds(sample.time_ns), limit);
        }
    }

    /// Marks it in a row that multiplies it by `scale`.
    fn mark(&self, row: &mut Row, scale: f64, color: Color) {
        if self.peak.value > 0.0 {
            row.shapes.push(Shape::Mark(Mark {
                at: (self.time_s, self.value * scale),
                color,
                label: format!("line {}", text::line(self.peak.place)),
                side: if self.value < 0.0 { Side::Below } else { Side::Above },
            }));
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
            timeline: Timeline::new(curves),
            values: Vec::with_capacity(curves),
            peaks: vec![[Highest::default(); PER_AXIS]; axes.len()],
            fastest: Highest::default(),
            way: None,
        }
    }

    /// The limits of an axis in the order of its curves, while it `slows` down or not.
    fn limits(&self, axis: &Axis, slows: bool) -> [Option<f64>; PER_AXIS] {
        let effort = axis.effort_limit().filter(|_| self.efforts);
        [Some(axis.max_velocity), Some(axis.acceleration_limit(slows)), axis.max_jerk, effort]
    }

    /// Takes the next sample.
    pub fn include(&mut self, sample: &ProfileSample) {
        self.values.clear();
        self.values.push(Some(sample.path_velocity * 1e3));
        self.values.push((sample.feed > 0.0).then_some(sample.feed * 1e3));
        for (index, axis) in self.axes.iter().enumerate() {
            let now = |values: &AxisVector| values.get(index).copied().unwrap_or_default();
            let slows = axis.slows(now(&sample.velocity), now(&sample.acceleration), 0.0);
            let limits = self.limits(axis, slows);
            let of = [
                Some(&sample.velocity),
                Some(&sample.acceleration),
                Some(&sample.jerk),
                sample.effort.as_ref(),
            ];
            let Some(peaks) = self.peaks.get_mut(index) else { continue };
            for ((values, limit), highest) in of.into_iter().zip(limits).zip(peaks) {
                let value = values.map_or(0.0, now);
                let part = limit.map(|limit| value / limit);
                if let Some((part, limit)) = part.zip(limit) {
                    highest.include(part, limit, sample);
                }
                self.values.push(part.map(|part| part * 100.0));
            }
        }
        self.fastest.include(sample.path_velocity * 1e3, 0.0, sample);
        let [begin, _] = self.way.unwrap_or([sample.way; 2]);
        self.way = Some([begin, sample.way]);
        let kind = sample.binding.and_then(|binding| self.kind(binding));
        self.timeline.push(seconds(sample.time_ns), sample.place.line, &self.values, kind);
    }

    /// Kind of a limit in the strip: the place of its axis, or behind the axes.
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

    /// The largest values of the axes as parts of their limits.
    fn parts(&self, quantity: usize) -> impl Iterator<Item = (usize, &Axis, &Highest)> {
        self.axes.iter().zip(&self.peaks).enumerate().filter_map(move |(index, (axis, peaks))| {
            self.limits(axis, false).get(quantity).copied().flatten()?;
            Some((index, axis, peaks.get(quantity)?))
        })
    }

    /// Draws the picture as SVG, of `program` on `machine`, by their names.
    pub fn draw(&self, program: &str, machine: &str) -> String {
        let [begin_s, end_s] = self.timeline.span();
        let [begin, end] = self.way.unwrap_or_default();
        let quantities = QUANTITIES.into_iter().enumerate();
        let shown = quantities.filter(|(quantity, _)| self.parts(*quantity).next().is_some());
        let axes = shown.map(|(quantity, words)| self.axes(quantity, words));
        let color = |kind: usize| {
            let other = kind.checked_sub(self.axes.len()).and_then(|kind| KINDS.get(kind));
            other.map_or_else(|| Color::series(kind), |(_, color)| *color)
        };
        let chart = Chart {
            title: format!("{program} on {machine}"),
            subtitle: format!(
                "{} s, {} mm; {}",
                digits(end_s - begin_s),
                digits((end - begin) * 1e3),
                self.verdict()
            ),
            across: self.timeline.across(),
            rows: std::iter::once(self.path()).chain(axes).collect(),
            strips: self.timeline.strips("what holds back", color),
            legend: self.legend(),
        };
        chart.svg()
    }

    /// The largest part of a limit that is asked for.
    fn verdict(&self) -> String {
        let all = (0..PER_AXIS).flat_map(|quantity| {
            self.parts(quantity).map(move |(_, axis, highest)| (quantity, axis, highest))
        });
        match highest(all, |one| one.2) {
            Some((quantity, axis, highest)) => format!(
                "at most {} of a limit: {} of {} in line {}",
                percent(highest.peak.value),
                QUANTITIES.get(quantity).map_or("", |(name, _)| *name),
                axis.name,
                text::line(highest.peak.place),
            ),
            None => "no axis moves".to_owned(),
        }
    }

    /// As high as the notes next to it need.
    fn height(&self) -> f64 {
        self.axes.iter().fold(12.0, |height, _| height + NOTE).max(HEIGHT)
    }

    fn curve(&self, curve: usize, stroke: Stroke) -> Shape {
        Shape::Line(self.timeline.curve(curve).to_vec(), stroke)
    }

    /// Velocity along the path against the programmed feed.
    fn path(&self) -> Row {
        let points = [PATH, FEED].map(|curve| self.timeline.curve(curve));
        let values = points.into_iter().flatten().map(|(_, value)| *value);
        let [low, high] = twin_plot::reach(values).unwrap_or_default();
        let range = [low.min(0.0) * ROOM, if high > 0.0 { high * ROOM } else { 1.0 }];
        let mut row = Row::new("path velocity", "mm/s", self.height(), range);
        row.shapes = vec![
            self.curve(FEED, Stroke::solid(BACK, 2.4)),
            self.curve(PATH, Stroke::solid(INK, 1.4)),
        ];
        row.notes.push((format!("at most {} mm/s", digits(self.fastest.peak.value)), INK));
        self.fastest.mark(&mut row, 1.0, INK);
        row
    }

    /// One quantity of all axes against their limits.
    fn axes(&self, quantity: usize, (name, units): (&str, [&str; 2])) -> Row {
        let parts: Vec<_> = self.parts(quantity).collect();
        let most = parts.iter().map(|(.., highest)| highest.peak.value).fold(1.0, f64::max);
        let most = most * 100.0 * ROOM;
        let mut row = Row::new(name, "% of limit", self.height(), [-most, most]);
        row.limits = vec![-100.0, 100.0];
        // Those that go far lie behind those that do not.
        let mut order = parts.clone();
        order.sort_by(|one, other| other.2.peak.value.total_cmp(&one.2.peak.value));
        for (index, ..) in order {
            let stroke = Stroke::solid(Color::series(index), 1.4);
            row.shapes.push(self.curve(FIRST_AXIS + PER_AXIS * index + quantity, stroke));
        }
        for (index, axis, highest) in &parts {
            let unit = match axis.kind {
                AxisKind::Rotary => units[0],
                AxisKind::Linear => units[1],
            };
            let value = highest.limit * highest.peak.value;
            let value = if quantity == EFFORT { value } else { axis.from_si(value) };
            let text =
                format!("{}: {}, {} {unit}", axis.name, percent(highest.peak.value), digits(value));
            row.notes.push((text, Color::series(*index)));
        }
        if let Some((index, _, highest)) = highest(parts.into_iter(), |one| one.2) {
            highest.mark(&mut row, 100.0, Color::series(index));
        }
        row
    }

    fn legend(&self) -> Legend {
        let line = |color| Sign::Line(Stroke::solid(color, 2.2));
        let axes = self.axes.iter().enumerate();
        let axes =
            axes.map(|(index, axis)| (line(Color::series(index)), format!("axis {}", axis.name)));
        let words = [
            (Sign::Line(Stroke::dashed(MARK, 1.4)), "limit"),
            (Sign::Ring(INK), "largest value"),
            (line(INK), "along the path"),
            (line(BACK), "programmed"),
        ];
        let kinds = KINDS.into_iter().zip(self.axes.len()..);
        let kinds = kinds.filter(|(_, kind)| self.timeline.shows(*kind));
        let kinds = kinds.map(|((words, color), _)| (Sign::Patch(color), words));
        let words = words.into_iter().chain(kinds).map(|(sign, word)| (sign, word.to_owned()));
        axes.chain(words).collect()
    }
}

/// The first of those with the largest value; none if all are zero.
fn highest<T>(
    all: impl Iterator<Item = T>,
    of: impl for<'t> Fn(&'t T) -> &'t Highest,
) -> Option<T> {
    all.fold(None, |best, one| {
        let most = best.as_ref().map_or(0.0, |best| of(best).peak.value);
        if of(&one).peak.value > most { Some(one) } else { best }
    })
}
