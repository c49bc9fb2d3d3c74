//! The page around a section: sizes, title, scale, legend.

use super::{Area, Failure};
use crate::page::{self, FAINT, INK, MARK, color, fine, font, stroke};
use crate::workspace::scale::Scale;
use crate::workspace::section::Section;
use nalgebra::Point2;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Largest size of the section on the page, pixels.
const LARGEST: [f64; 2] = [690.0, 620.0];
/// Room around the section, pixels: left, top, right, bottom.
const MARGINS: [f64; 4] = [76.0, 78.0, 106.0, 122.0];
/// Room for the numbers below the section, pixels.
pub(super) const NUMBERS: f64 = 50.0;
/// The page is at least this wide, pixels: title and legend need it.
const NARROWEST: f64 = 780.0;
/// The colour scale is at least this high, pixels.
const LOWEST_SCALE: f64 = 150.0;

/// How a section lies on the page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Page {
    pub(super) min: Point2<f64>,
    pub(super) max: Point2<f64>,
    /// Size of the section, pixels.
    plot: [f64; 2],
    /// Pixels per m.
    scale: f64,
    width: f64,
    height: f64,
}

/// What stands before a word of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sign {
    Patch(RGBAColor),
    Line(RGBColor, f64),
    Dashes(RGBColor),
    Ring,
    Cross,
}

impl Page {
    pub(super) fn new(section: &Section<'_>) -> Self {
        let (min, max) = (section.grid.min, section.grid.max());
        let sides = max - min;
        let scale = (LARGEST[0] / sides.x).min(LARGEST[1] / sides.y);
        let plot = [sides.x * scale, sides.y * scale];
        let [left, top, right, bottom] = MARGINS;
        let width = (left + plot[0] + right).max(NARROWEST);
        let height = top + plot[1].max(LOWEST_SCALE) + bottom;
        Self { min, max, plot, scale, width, height }
    }

    /// Of the page, as plotters counts.
    pub(super) fn size(&self) -> (u32, u32) {
        (stroke(self.width), stroke(self.height))
    }

    /// Room left, above, right of and below the section.
    pub(super) fn margins(&self) -> [f64; 4] {
        let [left, top, ..] = MARGINS;
        let [width, height] = self.plot;
        [left, top, self.width - left - width, self.height - top - height]
    }

    /// Coordinates along one side, mm.
    pub(super) fn range(&self, side: usize) -> std::ops::Range<f64> {
        let of = |point: &Point2<f64>| point.coords.get(side).copied().unwrap_or_default() * 1e3;
        of(&self.min)..of(&self.max)
    }

    /// So many pixels, m.
    pub(super) fn metres(&self, pixels: f64) -> f64 {
        pixels / self.scale
    }

    /// The picture at its size; inside it counts finer.
    pub(super) fn resized(&self, text: &str) -> String {
        page::resized(text, self.size())
    }

    pub(super) fn title(root: &Area<'_>, title: &str, below: &str) -> Result<(), Failure> {
        let at = |y: f64| (fine(MARGINS[0]), fine(y));
        root.draw_text(title, &font(23.0, INK), at(18.0))?;
        root.draw_text(below, &font(15.5, FAINT), at(47.0))
    }

    /// What the coordinates are, below and to the left of the section.
    pub(super) fn sides(&self, root: &Area<'_>, [below, left]: [&str; 2]) -> Result<(), Failure> {
        let [x, y, ..] = MARGINS;
        let [width, height] = self.plot;
        let style = font(15.5, INK).pos(Pos::new(HPos::Center, VPos::Center));
        let middle = (fine(x + width / 2.0), fine(y + height + NUMBERS - 8.0));
        root.draw_text(below, &style, middle)?;
        let middle = (fine(18.0), fine(y + height / 2.0));
        root.draw_text(left, &style.transform(FontTransform::Rotate270), middle)
    }

    /// True if a convex polygon within the section takes most of it, or as much as most of a workspace of this area, m².
    pub(super) fn is_filled_by(&self, polygon: &[Point2<f64>], workspace: f64) -> bool {
        let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
        let double = sides.map(|(one, other)| one.coords.perp(&other.coords)).sum::<f64>();
        double / 2.0 > 0.5 * (self.max - self.min).product().min(workspace)
    }

    /// The colours of the measure with their numbers, to the right of the section.
    pub(super) fn scale(&self, root: &Area<'_>, scale: Scale) -> Result<(), Failure> {
        let [_, top, ..] = MARGINS;
        let height = self.plot[1].max(LOWEST_SCALE);
        let (left, right) = (self.width - 84.0, self.width - 64.0);
        let y = |band: u32| top + height * (1.0 - f64::from(band) / f64::from(scale.bands()));
        for band in 0..scale.bands() {
            let corners = [(fine(left), fine(y(band + 1))), (fine(right), fine(y(band)))];
            root.draw(&Rectangle::new(corners, color(scale.color(band)).filled()))?;
        }
        let frame = [(left, top), (right, top), (right, top + height), (left, top + height)];
        let frame = frame.into_iter().chain([(left, top)]).map(|(x, y)| (fine(x), fine(y)));
        root.draw(&PathElement::new(frame.collect::<Vec<_>>(), FAINT.stroke_width(stroke(0.8))))?;
        // As many numbers as find room; 0 is among them.
        let every = [1, 2, 4, 5, 10]
            .into_iter()
            .find(|every| height / f64::from(scale.bands()) * f64::from(*every) >= 26.0);
        let style = font(14.5, INK).pos(Pos::new(HPos::Left, VPos::Center));
        for band in (0..=scale.bands()).filter(|band| band.is_multiple_of(every.unwrap_or(20))) {
            let (x, y) = (right + 7.0, y(band));
            let tick = vec![(fine(right), fine(y)), (fine(right + 4.0), fine(y))];
            root.draw(&PathElement::new(tick, FAINT.stroke_width(stroke(0.8))))?;
            root.draw_text(&super::number(scale.least(band)), &style, (fine(x), fine(y)))?;
        }
        let style = font(14.5, INK).transform(FontTransform::Rotate90);
        let style = style.pos(Pos::new(HPos::Center, VPos::Bottom));
        let middle = (fine(self.width - 22.0), fine(top + height / 2.0));
        root.draw_text("singularity measure", &style, middle)
    }

    /// The legend, in rows below the section.
    pub(super) fn legend(&self, root: &Area<'_>, items: &[(Sign, String)]) -> Result<(), Failure> {
        let [left, top, ..] = MARGINS;
        let mut x = left;
        let mut y = top + self.plot[1].max(LOWEST_SCALE) + NUMBERS + 18.0;
        for (sign, word) in items {
            // Without a font there is no width: a letter is so wide on average.
            let width = 34.0 + word.chars().fold(0.0, |sum, _| sum + 6.4);
            if x + width > self.width - 10.0 && x > left {
                (x, y) = (left, y + 21.0);
            }
            sign.draw(root, x, y)?;
            let style = font(14.5, INK).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw_text(word, &style, (fine(x + 30.0), fine(y)))?;
            x += width + 18.0;
        }
        Ok(())
    }
}

impl Sign {
    /// Before a word that begins 30 pixels to the right of `x`.
    fn draw(self, root: &Area<'_>, x: f64, y: f64) -> Result<(), Failure> {
        let line = |from: f64, to: f64| vec![(fine(from), fine(y)), (fine(to), fine(y))];
        match self {
            Self::Patch(color) => root.draw(&Rectangle::new(
                [(fine(x), fine(y - 6.0)), (fine(x + 22.0), fine(y + 6.0))],
                color.filled(),
            )),
            Self::Line(color, width) => {
                root.draw(&PathElement::new(line(x, x + 22.0), color.stroke_width(stroke(width))))
            }
            Self::Dashes(color) => [x, x + 8.0, x + 16.0].into_iter().try_for_each(|x| {
                let style = color.stroke_width(stroke(1.4));
                root.draw(&PathElement::new(line(x, x + 5.0), style))
            }),
            Self::Ring => {
                let style = MARK.stroke_width(stroke(2.0));
                root.draw(&Circle::new((fine(x + 11.0), fine(y)), stroke(5.5), style))
            }
            Self::Cross => cross((x + 11.0, y)).into_iter().try_for_each(|line| {
                let line = line.map(|(x, y)| (fine(x), fine(y)));
                root.draw(&PathElement::new(line.to_vec(), MARK.stroke_width(stroke(2.0))))
            }),
        }
    }
}

/// The two lines of a cross, pixels.
pub(super) fn cross((x, y): (f64, f64)) -> [[(f64, f64); 2]; 2] {
    let arm = 5.5;
    [[(x - arm, y), (x + arm, y)], [(x, y - arm), (x, y + arm)]]
}
