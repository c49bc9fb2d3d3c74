//! The page of a chart: where its rows are, its ticks, and its signs.

use crate::page::{FAINT, GRID, INK, fine, font, stroke};
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub(crate) type Failure = DrawingAreaErrorKind<std::io::Error>;
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Left and right end of the curves, pixels.
pub(crate) const LEFT: f64 = 84.0;
pub(crate) const RIGHT: f64 = LEFT + 860.0;
/// Width of the page, pixels: beside the curves there is a list.
pub(crate) const WIDTH: f64 = RIGHT + 246.0;
/// Where the first row begins, pixels.
pub(crate) const TOP: f64 = 84.0;
/// Between rows.
pub(crate) const GAP: f64 = 20.0;
/// Height of a line of the list.
pub(crate) const LINE: f64 = 18.0;

/// Time from left to right.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Time {
    begin_ns: i64,
    /// Pixels per ns.
    scale: f64,
    span_s: f64,
}

impl Time {
    #[expect(clippy::cast_precision_loss, reason = "a place on a page")]
    pub(crate) fn new([begin_ns, end_ns]: [i64; 2]) -> Self {
        let span_ns = end_ns.saturating_sub(begin_ns).max(1) as f64;
        Self { begin_ns, scale: (RIGHT - LEFT) / span_ns, span_s: span_ns * 1e-9 }
    }

    #[expect(clippy::cast_precision_loss, reason = "a place on a page")]
    pub(crate) fn x(&self, time_ns: i64) -> f64 {
        LEFT + time_ns.saturating_sub(self.begin_ns) as f64 * self.scale
    }

    /// Ticks: where, and the number; and what the numbers are.
    pub(crate) fn ticks(&self) -> (Vec<(f64, String)>, &'static str) {
        let (unit_s, name) = match self.span_s {
            span if span < 600.0 => (1.0, "time (s)"),
            span if span < 36_000.0 => (60.0, "time (min)"),
            _ => (3600.0, "time (h)"),
        };
        #[expect(clippy::cast_precision_loss, reason = "a number on a page")]
        let begin = self.begin_ns as f64 * 1e-9 / unit_s;
        let span = self.span_s / unit_s;
        let ticks = ticks(begin, begin + span, 10.0);
        let x = |value: f64| LEFT + (value - begin) / span * (RIGHT - LEFT);
        (ticks.into_iter().map(|(value, text)| (x(value), text)).collect(), name)
    }
}

/// Round numbers from `low` to `high`, about `count` of them, with as many decimals as they need.
pub(crate) fn ticks(low: f64, high: f64, count: f64) -> Vec<(f64, String)> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return vec![(low, format!("{low:.3}"))];
    }
    let rough = span / count;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power);
    let step = step.into_iter().find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(power * 10.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few decimals")]
    let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize;
    let mut ticks = Vec::new();
    let mut number = (low / step - 1e-9).ceil();
    while number * step <= high + step * 1e-9 && ticks.len() < 100 {
        // Plus zero, so that nothing is never minus nothing.
        let value = number * step + 0.0;
        ticks.push((value, format!("{value:.decimals$}")));
        number += 1.0;
    }
    ticks
}

/// A row of curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) top: f64,
    pub(crate) height: f64,
    /// Values at its bottom and top.
    pub(crate) range: [f64; 2],
}

impl Row {
    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn y(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        self.bottom() - (value - low) / (high - low) * self.height
    }

    /// What of a line, of places along the time and values, is within the row: pieces of it.
    pub(crate) fn within(&self, line: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let [low, high] = self.range;
        let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
        let mut goes_on = false;
        for (from, to) in line.iter().zip(line.iter().skip(1)) {
            let rise = to.1 - from.1;
            // From where to where along it.
            let [begin, end] = if rise == 0.0 {
                if (low..=high).contains(&from.1) { [0.0, 1.0] } else { [1.0, 0.0] }
            } else {
                let [one, other] = [low, high].map(|limit| (limit - from.1) / rise);
                [one.min(other).max(0.0), one.max(other).min(1.0)]
            };
            let at = |part: f64| match part {
                0.0 => *from,
                1.0 => *to,
                part => (from.0 + (to.0 - from.0) * part, from.1 + rise * part),
            };
            if begin > end {
                goes_on = false;
                continue;
            }
            if !goes_on {
                pieces.push(vec![at(begin)]);
            }
            if let Some(piece) = pieces.last_mut() {
                piece.push(at(end));
            }
            goes_on = end >= 1.0;
        }
        pieces
    }

    /// Its frame, ticks and name.
    pub(crate) fn draw(
        &self,
        root: &Area<'_>,
        time: &Time,
        name: [&str; 2],
    ) -> Result<(), Failure> {
        let at: Vec<_> = time.ticks().0.into_iter().map(|(x, _)| x).collect();
        self.draw_over(root, &at, name)
    }

    /// As [`Self::draw`], with ticks at these places from left to right.
    pub(crate) fn draw_over(
        &self,
        root: &Area<'_>,
        at: &[f64],
        name: [&str; 2],
    ) -> Result<(), Failure> {
        let numbers = font(13.0, INK).pos(Pos::new(HPos::Right, VPos::Center));
        for (value, text) in ticks(self.range[0], self.range[1], 6.0) {
            let y = self.y(value);
            line(root, [(LEFT, y), (RIGHT, y)], GRID.stroke_width(stroke(0.8)))?;
            root.draw_text(&text, &numbers, (fine(LEFT - 7.0), fine(y)))?;
        }
        for x in at {
            line(root, [(*x, self.top), (*x, self.bottom())], GRID.stroke_width(stroke(0.8)))?;
        }
        self.frame(root)?;
        let style = font(14.0, INK).pos(Pos::new(HPos::Center, VPos::Center));
        let style = style.transform(FontTransform::Rotate270);
        let middle = self.top + self.height / 2.0;
        root.draw_text(name[0], &style, (fine(19.0), fine(middle)))?;
        root.draw_text(name[1], &style, (fine(36.0), fine(middle)))
    }

    pub(crate) fn frame(&self, root: &Area<'_>) -> Result<(), Failure> {
        let corners = [(LEFT, self.top), (RIGHT, self.bottom())].map(|(x, y)| (fine(x), fine(y)));
        root.draw(&Rectangle::new(corners, FAINT.stroke_width(stroke(0.8))))
    }
}

pub(crate) fn line(
    root: &Area<'_>,
    ends: [(f64, f64); 2],
    style: ShapeStyle,
) -> Result<(), Failure> {
    root.draw(&PathElement::new(ends.map(|(x, y)| (fine(x), fine(y))).to_vec(), style))
}

pub(crate) fn dashes(
    root: &Area<'_>,
    ends: [(f64, f64); 2],
    color: RGBColor,
) -> Result<(), Failure> {
    let ends = ends.map(|(x, y)| (fine(x), fine(y)));
    let style = color.stroke_width(stroke(1.1));
    root.draw(&DashedPathElement::new(ends, fine(6.0), fine(4.0), style))
}

/// What the chart is of, and in smaller letters what there is to say of it first.
pub(crate) fn title(root: &Area<'_>, title: &str, below: &str) -> Result<(), Failure> {
    let at = |y: f64| (fine(LEFT), fine(y));
    root.draw_text(title, &font(23.0, INK), at(16.0))?;
    root.draw_text(below, &font(15.5, FAINT), at(46.0))
}

/// Words that begin at `x`.
pub(crate) fn words(
    root: &Area<'_>,
    text: &str,
    (x, y): (f64, f64),
    color: RGBColor,
) -> Result<(), Failure> {
    let style = font(13.5, color).pos(Pos::new(HPos::Left, VPos::Center));
    root.draw_text(text, &style, (fine(x), fine(y)))
}

/// What stands before a word of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sign {
    Patch(RGBColor),
    Line(RGBColor),
    Dashes(RGBColor),
    Ring,
}

impl Sign {
    fn draw(self, root: &Area<'_>, x: f64, y: f64) -> Result<(), Failure> {
        match self {
            Self::Patch(color) => {
                let corners = [(x, y - 6.0), (x + 22.0, y + 6.0)].map(|(x, y)| (fine(x), fine(y)));
                root.draw(&Rectangle::new(corners, color.filled()))?;
                root.draw(&Rectangle::new(corners, FAINT.stroke_width(stroke(0.6))))
            }
            Self::Line(color) => {
                line(root, [(x, y), (x + 22.0, y)], color.stroke_width(stroke(2.2)))
            }
            Self::Dashes(color) => dashes(root, [(x, y), (x + 22.0, y)], color),
            Self::Ring => {
                let ring = INK.stroke_width(stroke(1.4));
                root.draw(&Circle::new((fine(x + 11.0), fine(y)), stroke(4.5), ring))
            }
        }
    }
}

/// Rows of the legend, and where each item begins.
pub(crate) fn legend_places(items: &[(Sign, String)]) -> (Vec<(f64, f64)>, f64) {
    let (mut x, mut y) = (LEFT, 0.0);
    let mut places = Vec::new();
    for (_, word) in items {
        // Without a font there is no width: a letter is so wide on average.
        let width = 34.0 + word.chars().fold(0.0, |sum, _| sum + 6.3);
        if x + width > WIDTH - 10.0 && x > LEFT {
            (x, y) = (LEFT, y + 21.0);
        }
        places.push((x, y));
        x += width + 16.0;
    }
    (places, y + 21.0)
}

pub(crate) fn legend(root: &Area<'_>, items: &[(Sign, String)], top: f64) -> Result<(), Failure> {
    let (places, _) = legend_places(items);
    for ((sign, word), (x, y)) in items.iter().zip(places) {
        sign.draw(root, x, top + y)?;
        words(root, word, (x + 30.0, top + y), INK)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Row, ticks};

    #[test]
    fn lines_end_where_they_leave_the_row() {
        let row = Row { top: 0.0, height: 100.0, range: [-1.0, 10.0] };
        let line = [(0.0, 20.0), (1.0, 10.0), (2.0, 0.0), (3.0, -2.0), (4.0, -2.0), (6.0, 18.0)];
        let pieces = row.within(&line);
        assert_eq!(
            pieces,
            [
                vec![(1.0, 10.0), (1.0, 10.0), (2.0, 0.0), (2.5, -1.0)],
                vec![(4.1, -1.0), (5.2, 10.0)],
            ]
        );
        // What is within it stays as it is.
        let line = [(0.0, 0.1), (0.3, 10.0), (0.7, 10.0), (0.9, -1.0)];
        assert_eq!(row.within(&line), [line.to_vec()]);
        assert!(row.within(&[(0.0, 11.0), (1.0, 11.0)]).is_empty());
    }

    #[test]
    fn ticks_are_round() {
        let texts = |low, high, count| -> Vec<String> {
            ticks(low, high, count).into_iter().map(|(_, text)| text).collect()
        };
        assert_eq!(texts(0.0, 1.0, 5.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(-110.0, 110.0, 5.0), ["-100", "-50", "0", "50", "100"]);
        assert_eq!(texts(0.0, 7300.0, 4.0), ["0", "2000", "4000", "6000"]);
        assert_eq!(texts(0.0, 0.001, 2.0), ["0.0000", "0.0005", "0.0010"]);
        assert_eq!(ticks(1.0, 1.0, 5.0).len(), 1);
        assert_eq!(ticks(0.0, f64::INFINITY, 5.0).len(), 1);
    }
}
