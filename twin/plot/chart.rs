//! Charts: rows and strips over a common axis.

use super::color::{BACK, Color, FAINT, INK, Stroke};
use super::page::{self, Head, LEFT, Legend, RIGHT, TEXT};
use super::row::Row;
use super::series::Stretches;
use super::svg::{Anchor, Svg};
use super::ticks::ticks;

/// Width of the page, pixels: next to the rows there are notes.
const WIDTH: f64 = RIGHT + 246.0;
/// Between rows, and between strips, pixels.
const GAP: f64 = 20.0;
const BETWEEN: f64 = 8.0;
/// Room for the numbers and the name of the axis, pixels.
const NUMBERS: f64 = 50.0;
/// Height of a strip, pixels.
const STRIP: f64 = 16.0;
/// Between numbers of narrow stretches, pixels.
const SPARSE: f64 = 60.0;
/// Narrower stretches share one colour, pixels.
const NARROW: f64 = 1.0;

/// The axis that all rows have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Across {
    range: [f64; 2],
    name: String,
    /// Divisor of its numbers.
    per: f64,
}

impl Across {
    /// An axis with a name.
    pub fn new(range: [f64; 2], name: String) -> Self {
        Self { range, name, per: 1.0 }
    }

    /// Time from begin to end, s; in minutes or hours where that is long.
    pub fn time([begin, end]: [f64; 2]) -> Self {
        let (per, unit) = match end - begin {
            span if span < 600.0 => (1.0, "s"),
            span if span < 36_000.0 => (60.0, "min"),
            _ => (3600.0, "h"),
        };
        Self { range: [begin, end], name: format!("time ({unit})"), per }
    }

    fn x(&self, at: f64) -> f64 {
        let [low, high] = self.range;
        LEFT + (at - low) / (high - low).max(f64::MIN_POSITIVE) * (RIGHT - LEFT)
    }

    /// Places on the page, and numbers.
    fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range.map(|end| end / self.per);
        let ticks = ticks(low, high, 12.0).into_iter();
        ticks.map(|(value, text)| (self.x(value * self.per), text)).collect()
    }
}

/// A strip of colours below the rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strip {
    /// Title.
    pub name: String,
    /// Begin, end and colour of each part.
    pub parts: Vec<(f64, f64, Color)>,
    /// Lines across it.
    pub marks: Vec<f64>,
    /// Numbers in it, those with `true` with a tick.
    pub labels: Vec<(f64, String, bool)>,
}

impl Strip {
    /// An empty strip.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// Stretches of numbers: by turns light and dark where there is room, with their numbers where these fit.
    pub(super) fn of_numbers(name: &str, numbers: &Stretches<u32>, span: [f64; 2]) -> Self {
        let shades = [Color::rgb(238, 240, 243), Color::rgb(214, 218, 224)];
        let mixed = Color::rgb(226, 229, 234);
        let per_pixel = ((span[1] - span[0]) / (RIGHT - LEFT)).max(f64::MIN_POSITIVE);
        let half = |number: u32| page::width(&number.to_string(), 11.5) / 2.0 * per_pixel;
        let mut strip = Self::new(name);
        let mut shade = shades.into_iter().cycle();
        let mut wide: Vec<[f64; 2]> = Vec::new();
        for (begin, end, number) in numbers.iter() {
            let is_narrow = end - begin < NARROW * per_pixel;
            let color = if is_narrow { Some(mixed) } else { shade.next() };
            match strip.parts.last_mut() {
                Some(last) if is_narrow && last.2 == mixed => last.1 = end,
                _ => strip.parts.push((begin, end, color.unwrap_or(mixed))),
            }
            let room = half(number) + 2.0 * per_pixel;
            if end - begin >= 2.0 * room {
                let middle = begin.midpoint(end);
                wide.push([middle - room, middle + room]);
                strip.labels.push((middle, number.to_string(), false));
            }
        }
        // Of narrow stretches some have a number, with a tick, clear of those in wide ones.
        let mut last = f64::NEG_INFINITY;
        for (begin, end, number) in numbers.iter() {
            let room = half(number) + 4.0 * per_pixel;
            let [left, right] = [begin - room, begin + room];
            let is_free = end - begin < 2.0 * room
                && left >= last
                && left >= span[0]
                && right <= span[1]
                && wide.iter().all(|[from, to]| right <= *from || left >= *to);
            if is_free {
                strip.labels.push((begin, number.to_string(), true));
                last = begin + (SPARSE * per_pixel).max(room);
            }
        }
        strip
    }

    fn draw(&self, svg: &mut Svg, top: f64, across: &dyn Fn(f64) -> f64) {
        let bottom = top + STRIP;
        for (begin, end, color) in &self.parts {
            svg.rectangle((across(*begin), top), (across(*end), bottom), *color);
        }
        svg.rectangle((LEFT, top), (RIGHT, bottom), Stroke::solid(BACK, 0.8));
        for x in self.marks.iter().map(|at| across(*at)) {
            svg.line((x, top - 2.0), (x, bottom + 2.0), Stroke::solid(INK, 1.3));
        }
        for (at, text, has_tick) in &self.labels {
            let x = across(*at);
            if *has_tick {
                svg.line((x, top), (x, top + 3.0), Stroke::solid(FAINT, 0.8));
            }
            svg.text((x, top + STRIP / 2.0 + 0.5), 11.5, INK, Anchor::Middle, text);
        }
        svg.text((RIGHT + 12.0, top + STRIP / 2.0), TEXT, INK, Anchor::Start, &self.name);
    }
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// Subtitle, in smaller letters.
    pub subtitle: String,
    /// The common axis.
    pub across: Across,
    /// From top to bottom.
    pub rows: Vec<Row>,
    /// Below the rows.
    pub strips: Vec<Strip>,
    /// Below everything.
    pub legend: Legend,
}

impl Chart {
    fn head(&self) -> Head {
        Head::new(&self.title, &self.subtitle, WIDTH - LEFT - 12.0)
    }

    fn height(&self) -> f64 {
        let rows = self.rows.iter().fold(0.0, |sum, row| sum + row.height + GAP);
        let strips = self.strips.iter().fold(0.0, |sum, _| sum + STRIP + BETWEEN);
        let legend = page::legend_places(&self.legend, WIDTH - LEFT - 12.0).1;
        self.head().height() + rows + strips + NUMBERS + legend
    }

    fn draw(&self, svg: &mut Svg) {
        let head = self.head();
        head.draw(svg, (LEFT, 0.0));
        let across = |at: f64| self.across.x(at);
        let ticks = self.across.ticks();
        let uprights: Vec<_> = ticks.iter().map(|(x, _)| *x).collect();
        let mut top = head.height();
        for row in &self.rows {
            row.draw(svg, top, &across, &uprights);
            top += row.height + GAP;
        }
        for strip in &self.strips {
            strip.draw(svg, top, &across);
            top += STRIP + BETWEEN;
        }
        top -= if self.strips.is_empty() { GAP } else { BETWEEN };
        for (x, text) in ticks {
            svg.line((x, top), (x, top + 4.0), Stroke::solid(FAINT, 0.8));
            svg.text((x, top + 13.0), 13.0, INK, Anchor::Middle, &text);
        }
        let middle = (LEFT.midpoint(RIGHT), top + 33.0);
        svg.text(middle, 14.0, INK, Anchor::Middle, &self.across.name);
        page::legend(svg, &self.legend, (LEFT, top + NUMBERS + 10.0), WIDTH - LEFT - 12.0);
    }

    /// The chart as SVG.
    pub fn svg(&self) -> String {
        let mut svg = Svg::default();
        svg.open((WIDTH, self.height()), &self.title);
        self.draw(&mut svg);
        svg.close();
        svg.take()
    }
}
