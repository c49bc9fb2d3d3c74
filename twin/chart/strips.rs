//! What charts have in common: their curves, the strips below them, and the time.

use super::envelope::{At, Column, Envelope};
use super::page::{Area, Failure, LEFT, RIGHT, Row, Time, line, words};
use crate::page::{FAINT, INK, color, fine, font, stroke};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Height of the strips, pixels.
const STRIP: f64 = 16.0;

/// Between them.
const BETWEEN: f64 = 8.0;

/// Room for the numbers and the name of the time, pixels.
const TIMES: f64 = 50.0;

/// Between numbers of lines that are narrow, pixels.
const SPARSE: f64 = 60.0;

/// Curves along the time, and the strips below them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strips<'a> {
    envelope: &'a Envelope,
    time: Time,
}

impl<'a> Strips<'a> {
    /// How high both strips are with the time below them, pixels.
    pub(crate) const HEIGHT: f64 = 2.0 * STRIP + BETWEEN + TIMES;

    pub(crate) fn new(envelope: &'a Envelope) -> Self {
        Self { envelope, time: Time::new(envelope.span_ns().unwrap_or_default()) }
    }

    pub(crate) fn time(&self) -> &Time {
        &self.time
    }

    /// What of one of the curves is within a row, `scale` times as large.
    pub(crate) fn curve(
        &self,
        root: &Area<'_>,
        row: &Row,
        curve: usize,
        scale: f64,
        style: ShapeStyle,
    ) -> Result<(), Failure> {
        for piece in self.envelope.curve(curve) {
            let place = |At { time_ns, value }| (self.time.x(time_ns), value * scale);
            let line: Vec<_> = piece.into_iter().map(place).collect();
            for piece in row.within(&line) {
                let mut points: Vec<(i32, i32)> = Vec::with_capacity(piece.len());
                for (x, value) in piece {
                    let point = (fine(x), fine(row.y(value)));
                    // What lies between two others on a level line is not seen.
                    if let [.., before, last] = points.as_mut_slice()
                        && before.1 == last.1
                        && last.1 == point.1
                    {
                        *last = point;
                    } else if points.last() != Some(&point) {
                        points.push(point);
                    }
                }
                root.draw(&PathElement::new(points, style))?;
            }
        }
        Ok(())
    }

    /// Below the curves, from `top` on: of what kind the time is, in its colour and in words, the lines of the program, and the
    /// time.
    pub(crate) fn draw(
        &self,
        root: &Area<'_>,
        top: f64,
        kinds: impl Fn(usize) -> RGBColor,
        what: &str,
    ) -> Result<(), Failure> {
        let held = Row { top, height: STRIP, range: [0.0, 1.0] };
        let lines = Row { top: held.bottom() + BETWEEN, ..held };
        for (begin, end, kind) in self.bands(Column::most_held) {
            let Some(kind) = kind else { continue };
            band(root, &held, [begin, end], kinds(kind))?;
        }
        held.frame(root)?;
        words(root, what, (RIGHT + 12.0, held.top + STRIP / 2.0), INK)?;
        self.lines(root, &lines)?;
        self.times(root, lines.bottom())
    }

    /// Stretches of time in which something stays the same.
    pub(crate) fn bands<T: PartialEq + Copy>(
        &self,
        of: impl Fn(&Column) -> T,
    ) -> Vec<(f64, f64, T)> {
        let mut bands: Vec<(f64, f64, T)> = Vec::new();
        for column in self.envelope.columns() {
            let (end, value) = (self.time.x(column.end_ns), of(column));
            match bands.last_mut() {
                Some((_, last, same)) if *same == value => *last = end,
                Some((_, last, _)) => {
                    let begin = *last;
                    bands.push((begin, end, value));
                }
                None => bands.push((self.time.x(column.begin_ns), end, value)),
            }
        }
        bands
    }

    /// The lines of the program: by turns light and dark where there is room, with their numbers where these fit.
    fn lines(&self, root: &Area<'_>, row: &Row) -> Result<(), Failure> {
        let shades = [color([238, 240, 243]), color([214, 218, 224])];
        let mixed = color([226, 229, 234]);
        // Columns in which lines change are mixed.
        let of = |column: &Column| {
            let [first, last] = column.lines;
            (first == last).then_some(first)
        };
        let mut shade = shades.iter().cycle();
        let mut wide: Vec<([f64; 2], u32)> = Vec::new();
        for (begin, end, number) in self.bands(of) {
            let color = if number.is_some() { shade.next() } else { None };
            band(root, row, [begin, end], color.copied().unwrap_or(mixed))?;
            if let Some(number) = number.filter(|number| end - begin >= 2.0 * half_width(*number)) {
                wide.push(([begin, end], number));
            }
        }
        // Where bands are narrow some numbers, with a tick, clear of those in wide bands.
        let mut ticks = Vec::new();
        let mut free = LEFT;
        let mut ahead = wide.iter().peekable();
        for column in self.envelope.columns() {
            let (x, number) = (self.time.x(column.begin_ns), column.lines[0]);
            let near = |([begin, end], number): &&([f64; 2], u32)| {
                begin.min(begin.midpoint(*end) - half_width(*number) - SPARSE / 2.0) <= x
            };
            while let Some(([begin, end], number)) = ahead.next_if(near) {
                free = (begin.midpoint(*end) + half_width(*number)).max(end + 4.0 - SPARSE);
            }
            let half = half_width(number);
            if x - half >= free + 4.0 && x >= free + SPARSE && x + half <= RIGHT {
                ticks.push((x, number));
                free = x + half;
            }
        }
        row.frame(root)?;
        let style = font(11.5, INK).pos(Pos::new(HPos::Center, VPos::Center));
        for (x, _) in &ticks {
            line(root, [(*x, row.top), (*x, row.top + 3.0)], FAINT.stroke_width(stroke(0.8)))?;
        }
        let numbers = wide.into_iter().map(|([begin, end], number)| (begin.midpoint(end), number));
        for (x, number) in numbers.chain(ticks) {
            let at = (fine(x), fine(row.top + STRIP / 2.0 + 0.5));
            root.draw_text(&number.to_string(), &style, at)?;
        }
        words(root, "line of the program", (RIGHT + 12.0, row.top + STRIP / 2.0), INK)
    }

    fn times(&self, root: &Area<'_>, y: f64) -> Result<(), Failure> {
        let (ticks, name) = self.time.ticks();
        let style = font(13.0, INK).pos(Pos::new(HPos::Center, VPos::Top));
        for (x, text) in ticks {
            line(root, [(x, y), (x, y + 4.0)], FAINT.stroke_width(stroke(0.8)))?;
            root.draw_text(&text, &style, (fine(x), fine(y + 7.0)))?;
        }
        let style = font(14.0, INK).pos(Pos::new(HPos::Center, VPos::Top));
        root.draw_text(name, &style, (fine(LEFT.midpoint(RIGHT)), fine(y + 26.0)))
    }
}

/// A stretch of a row in a colour.
pub(crate) fn band(
    root: &Area<'_>,
    row: &Row,
    [begin, end]: [f64; 2],
    color: RGBColor,
) -> Result<(), Failure> {
    let corners = [(begin, row.top), (end, row.bottom())].map(|(x, y)| (fine(x), fine(y)));
    root.draw(&Rectangle::new(corners, color.filled()))
}

/// Half of the room for a number, pixels.
fn half_width(number: u32) -> f64 {
    number.to_string().chars().fold(2.5, |sum, _| sum + 3.4)
}
