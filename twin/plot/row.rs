//! A row of a chart: curves, limits, marks and notes over one quantity.

use super::Point;
use super::color::{BACK, Color, GRID, INK, MARK, Stroke};
use super::page::{LEFT, LINE, RIGHT, TEXT, width};
use super::series::thinned;
use super::svg::{Anchor, Svg};
use super::ticks::{power_of_ten, short, ticks};
use std::collections::HashSet;

/// From a label to a line that must not cross it, pixels.
const CLEAR: f64 = 9.0;
/// Dots nearer to each other are drawn as one, pixels.
const DOTS: f64 = 0.5;
/// Grounds are at least this wide, pixels.
const SEEN: f64 = 1.5;
/// Values this small are rounding.
const DUST: f64 = 1e-12;

/// Preferred side of the label of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// Higher than the mark.
    Above,
    /// Lower.
    Below,
}

/// A marked place and its label.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its position.
    pub at: Point,
    /// Colour of the mark.
    pub color: Color,
    /// Text next to it.
    pub label: String,
    /// Side of the label.
    pub side: Side,
}

/// Element of a row, in the order of drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A coloured ground between two values.
    Ground([f64; 2], Color),
    /// Coloured grounds between places across.
    Times(Vec<[f64; 2]>, Color),
    /// A line; a value that is not a number is a gap.
    Line(Vec<Point>, Stroke),
    /// A line from side to side at a value.
    Level(f64, Stroke),
    /// A line from bottom to top at a place across.
    Upright(f64, Stroke),
    /// Dots.
    Dots(Vec<Point>, Color),
    /// A mark with its label.
    Mark(Mark),
    /// A label at the top, left out where the one before it leaves no room.
    Label(f64, String, Color),
}

/// A row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// The quantity.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Pixels.
    pub height: f64,
    /// Values at its bottom and top.
    pub range: [f64; 2],
    /// Limits: dashed lines, or notes where they are outside of the range.
    pub limits: Vec<f64>,
    /// Drawn elements.
    pub shapes: Vec<Shape>,
    /// Lines of text next to it.
    pub notes: Vec<(String, Color)>,
}

impl Row {
    /// An empty row.
    pub fn new(name: &str, unit: &str, height: f64, range: [f64; 2]) -> Self {
        Self { name: name.to_owned(), unit: unit.to_owned(), height, range, ..Self::default() }
    }

    /// A row for values from low to high, and for limits near them: far ones would flatten the curve.
    pub fn fitted(
        name: &str,
        unit: &str,
        height: f64,
        values: Option<[f64; 2]>,
        limits: &[f64],
    ) -> Self {
        let [low, high] = values.unwrap_or([0.0, 1.0]);
        let size = high - low;
        let limits: Vec<_> = limits.iter().copied().filter(|limit| limit.is_finite()).collect();
        let near = limits.iter().copied();
        let near = near.filter(|limit| *limit >= low - size && *limit <= high + size);
        let [low, high] = reach(near.chain([low, high])).unwrap_or([low, high]);
        let room = ((high - low) * 0.12).max(f64::MIN_POSITIVE);
        let range = if high > low { [low - room, high + room] } else { [low - 1.0, high + 1.0] };
        Self { limits, ..Self::new(name, unit, height, range) }
    }

    /// True if a limit is within the range.
    pub fn shows_limit(&self) -> bool {
        self.limits.iter().any(|limit| self.has(*limit))
    }

    fn has(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }

    /// Power of ten by which the numbers next to the row are divided.
    fn power(&self) -> i32 {
        let most = self.range[0].abs().max(self.range[1].abs());
        if most >= 1e4 || (most > DUST && most < 5e-3) {
            #[expect(clippy::cast_possible_truncation, reason = "a power of ten")]
            let power = (most.log10() / 3.0).floor() as i32 * 3;
            return power;
        }
        0
    }

    /// Divisor of the numbers next to the row.
    pub fn scale(&self) -> f64 {
        10_f64.powi(self.power())
    }

    /// Draws it below `top`; `across` places on the page, `uprights` are lines of the grid.
    pub(super) fn draw(
        &self,
        svg: &mut Svg,
        top: f64,
        across: &dyn Fn(f64) -> f64,
        uprights: &[f64],
    ) {
        let bottom = top + self.height;
        let [low, high] = self.range;
        let y = |value: f64| {
            let y = bottom - (value - low) / (high - low) * self.height;
            y.clamp(top - 1e4, bottom + 1e4)
        };
        let grid = Stroke::solid(GRID, 0.8);
        let scale = self.scale();
        for (value, text) in ticks(low / scale, high / scale, self.height / 28.0) {
            let y = y(value * scale);
            svg.line((LEFT, y), (RIGHT, y), grid);
            svg.text((LEFT - 7.0, y), 13.0, INK, Anchor::End, &text);
        }
        for x in uprights {
            svg.line((*x, top), (*x, bottom), grid);
        }
        let middle = top + self.height / 2.0;
        svg.text((11.0, middle), 14.0, INK, Anchor::Upwards, &self.name);
        let unit = format!("({}{})", power_of_ten(self.power()), self.unit);
        svg.text((29.0, middle), 14.0, INK, Anchor::Upwards, &unit);

        svg.open_window((LEFT, top), (RIGHT - LEFT, self.height));
        for shape in &self.shapes {
            self.shape(svg, shape, across, &y);
        }
        for limit in self.limits.iter().filter(|limit| self.has(**limit)) {
            svg.line((LEFT, y(*limit)), (RIGHT, y(*limit)), Stroke::dashed(MARK, 1.1));
        }
        svg.close();
        svg.rectangle((LEFT, top), (RIGHT, bottom), Stroke::solid(BACK, 0.8));
        self.labels(svg, top, across, &y);

        let far = self.limits.iter().filter(|limit| !self.has(**limit));
        let far = far.map(|limit| (format!("limit {}", short(limit / scale)), MARK));
        let mut line = top + LINE / 2.0;
        for (note, color) in self.notes.iter().cloned().chain(far) {
            svg.text((RIGHT + 12.0, line), TEXT, color, Anchor::Start, &note);
            line += LINE;
        }
    }

    fn shape(
        &self,
        svg: &mut Svg,
        shape: &Shape,
        across: &dyn Fn(f64) -> f64,
        y: &dyn Fn(f64) -> f64,
    ) {
        let [top, bottom] = [self.range[1], self.range[0]].map(y);
        match shape {
            Shape::Ground([low, high], color) => {
                svg.rectangle((LEFT, y(*low)), (RIGHT, y(*high)), *color);
            }
            Shape::Times(times, color) => {
                let mut wide: Vec<[f64; 2]> = Vec::new();
                for [begin, end] in times {
                    let (begin, end) = (across(*begin), across(*end));
                    let end = end.max(begin + SEEN);
                    match wide.last_mut() {
                        Some(last) if begin <= last[1] => last[1] = last[1].max(end),
                        _ => wide.push([begin, end]),
                    }
                }
                for [begin, end] in wide {
                    svg.rectangle((begin, top), (end, bottom), *color);
                }
            }
            Shape::Line(points, stroke) => {
                let place = |(at, value): &Point| {
                    let value = if value.is_nan() { f64::NAN } else { y(*value) };
                    (hundredth(across(*at)), hundredth(value))
                };
                let points: Vec<_> = points.iter().map(place).collect();
                let points = thinned(&points, [LEFT, RIGHT]);
                for piece in points.split(|point| point.1.is_nan()) {
                    let piece = without_needless(piece);
                    if piece.len() > 1 {
                        svg.polyline(&piece, *stroke);
                    }
                }
            }
            Shape::Level(value, stroke) => svg.line((LEFT, y(*value)), (RIGHT, y(*value)), *stroke),
            Shape::Upright(at, stroke) => {
                svg.line((across(*at), top), (across(*at), bottom), *stroke);
            }
            Shape::Dots(points, color) => {
                let mut drawn = HashSet::new();
                for (at, value) in points {
                    let place = (across(*at), y(*value));
                    if drawn
                        .insert([place.0, place.1].map(|pixels| (pixels / DOTS).round().to_bits()))
                    {
                        svg.circle(place, 1.5, *color);
                    }
                }
            }
            Shape::Mark(mark) => {
                let ring = Stroke::solid(mark.color, 1.6);
                svg.circle((across(mark.at.0), y(mark.at.1)), 5.0, ring);
            }
            Shape::Label(..) => {}
        }
    }

    /// Labels may reach over the edge of the row a little.
    fn labels(&self, svg: &mut Svg, top: f64, across: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64) {
        let levels = self.shapes.iter().filter_map(|shape| match shape {
            Shape::Level(value, _) => Some(*value),
            _ => None,
        });
        let lines: Vec<_> = levels.chain(self.limits.iter().copied()).map(y).collect();
        let (highest, lowest) = (top + 8.0, top + self.height - 8.0);
        let mut free = LEFT;
        for shape in &self.shapes {
            let (at, text) = match shape {
                Shape::Mark(mark) => (mark.at.0, &mark.label),
                Shape::Label(at, text, _) => (*at, text),
                _ => continue,
            };
            let half = width(text, 12.5) / 2.0;
            let x = across(at).clamp(LEFT + half + 2.0, RIGHT - half - 2.0);
            match shape {
                Shape::Mark(Mark { at, color, side, .. }) => {
                    let at = y(at.1);
                    let sign = if *side == Side::Above { -1.0 } else { 1.0 };
                    let places = [14.0, 20.0, 28.0, -14.0, -20.0, -28.0].map(|by| at + sign * by);
                    let is_free = |place: &f64| {
                        (highest..=lowest).contains(place)
                            && lines.iter().all(|line| (line - place).abs() > CLEAR)
                    };
                    let place = places.into_iter().find(is_free).unwrap_or(places[0]);
                    svg.text((x, place), 12.5, *color, Anchor::Middle, text);
                }
                Shape::Label(_, _, color) if x - half >= free => {
                    svg.text((x, top + 9.0), 12.5, *color, Anchor::Middle, text);
                    free = x + half + 6.0;
                }
                _ => {}
            }
        }
    }
}

fn hundredth(pixels: f64) -> f64 {
    (pixels * 100.0).round() / 100.0
}

/// A line without points that repeat, and without those between two others on a level line.
fn without_needless(line: &[Point]) -> Vec<Point> {
    let same = |one: f64, other: f64| one.to_bits() == other.to_bits();
    let mut kept: Vec<Point> = Vec::with_capacity(line.len());
    for point in line {
        if let [.., before, last] = kept.as_mut_slice()
            && same(before.1, last.1)
            && same(last.1, point.1)
        {
            *last = *point;
        } else if kept.last() != Some(point) {
            kept.push(*point);
        }
    }
    kept
}

/// The lowest and the highest of the finite values.
pub fn reach(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().filter(|value| value.is_finite()).fold(None, |reach, value| {
        let [low, high] = reach.unwrap_or([value, value]);
        Some([low.min(value), high.max(value)])
    })
}
