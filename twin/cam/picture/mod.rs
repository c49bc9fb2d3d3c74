//! Pictures of cams: position, velocity, acceleration and jerk over the master, and the tappets below.

mod bars;
mod lines;
mod ramp;
mod stack;

use bars::alternates;
pub(super) use bars::on_stretches;
pub use ramp::{RampPicture, draw_ramp};
pub use stack::stacked;

use super::CamFile;
use super::check::CamUse;
use super::sample::{reach as reached, reaches};
use crate::chart::{
    Area, Failure, GAP, LEFT, RIGHT, Row, Sign, TOP, WIDTH, color_of, dashes, legend,
    legend_places, line, ticks, title, words,
};
use crate::number::beside;
use crate::page::{FAINT, INK, MARK, color, fine, font, resized, stroke};
use lines::{curve, line_of, thinned};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::collections::HashSet;
use twin_motion::cam::SlaveLimits;

/// Height of a row of curves, pixels.
const HEIGHT: f64 = 150.0;
/// Height of the bars of a group of tappets, and between them, pixels.
const BAR: f64 = 14.0;
const BETWEEN: f64 = 6.0;
/// Room for the numbers and the name of the master, pixels.
const MASTERS: f64 = 50.0;
/// Dots of a run that are no farther apart are one, pixels.
const DOTS: f64 = 0.5;
/// Of tappets whose signal has a period of two passes.
const OTHER_WAY_ROUND: &str = " in the first pass; the next one is the other way round";
/// Values that are less are rounding.
const DUST: f64 = 1e-12;

/// A picture that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture cannot be drawn: {0}")]
pub struct CamPictureError(String);

/// A cam in a picture.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The cam.
    pub file: &'a CamFile,
    /// How it is used; its limits are drawn where they are of the last one.
    pub using: &'a CamUse,
    /// What it is called in the legend.
    pub name: &'a str,
}

/// Recorded positions.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// Master, on the scale of the picture, and slave.
    pub points: Vec<(f64, f64)>,
    /// Master and error of the slave, before and after.
    pub errors: [Vec<(f64, f64)>; 2],
}

/// Draws cams over each other as SVG, the last one in front.
///
/// # Errors
/// What plotters says.
pub fn draw(
    heading: &str,
    below: &str,
    cams: &[Shown<'_>],
    recorded: &Recorded,
) -> Result<String, CamPictureError> {
    let page = Page::new(cams, recorded);
    page.draw(heading, below).map_err(|error| CamPictureError(error.to_string()))
}

/// Curves of one quantity.
struct Strip {
    name: &'static str,
    unit: String,
    /// What values are divided by.
    scale: f64,
    row: Row,
    curves: Vec<Vec<Vec<(f64, f64)>>>,
    /// Least and greatest of the last one, whatever its master does.
    sides: Vec<Vec<(f64, f64)>>,
    limits: Vec<f64>,
}

struct Page<'a> {
    cams: &'a [Shown<'a>],
    recorded: &'a Recorded,
    range: [f64; 2],
    strips: Vec<Strip>,
    bottom: f64,
}

const QUANTITIES: [(&str, &str); 4] =
    [("position", ""), ("velocity", "/s"), ("acceleration", "/s²"), ("jerk", "/s³")];

/// How far a recorded slave is from its cam.
const ERROR: &str = "error of the slave";

impl<'a> Page<'a> {
    fn new(cams: &'a [Shown<'a>], recorded: &'a Recorded) -> Self {
        let ends = cams.iter().flat_map(|shown| {
            let curve = shown.file.cam.curve();
            [curve.start(), curve.end()].map(|place| shown.using.master_at(place))
        });
        let ends = ends.chain(recorded.points.iter().map(|(master, _)| *master));
        let range = reach(ends).unwrap_or([0.0, 1.0]);
        let mut page = Self { cams, recorded, range, strips: Vec::new(), bottom: TOP };
        let unit = cams.last().map_or("u", |shown| shown.file.slave.unit());
        for (index, (name, per)) in QUANTITIES.into_iter().enumerate() {
            let curves: Vec<_> = cams.iter().map(|shown| curve(shown, index)).collect();
            // What the last one may reach while its master accelerates and jerks either way.
            let mut sides = Vec::new();
            let last = cams.last().filter(|shown| reaches(shown.using));
            if let (Some(shown), Some(quantity)) = (last, index.checked_sub(2)) {
                for side in 0..2 {
                    sides.extend(line_of(shown, &|place| {
                        let both = reached(shown.file, shown.using, place);
                        both.get(quantity).and_then(|both| both.get(side)).copied().unwrap_or(0.0)
                    }));
                }
            }
            let limits = page.limits(index);
            page.add(name, format!("{unit}{per}"), curves, sides, limits);
        }
        if recorded.errors.iter().any(|errors| !errors.is_empty()) {
            let curves =
                recorded.errors.iter().map(|errors| vec![thinned(errors, range)]).collect();
            page.add(ERROR, unit.to_owned(), curves, Vec::new(), vec![0.0]);
        }
        page
    }

    fn limits(&self, quantity: usize) -> Vec<f64> {
        let Some(shown) = self.cams.last() else { return Vec::new() };
        let SlaveLimits { velocity, acceleration, jerk } = shown.using.limits.motion;
        let limits = match quantity {
            0 => shown.using.limits.position,
            1 => [-velocity, velocity],
            2 => [-acceleration, acceleration],
            _ => [-jerk, jerk],
        };
        limits.into_iter().filter(|limit| limit.is_finite()).collect()
    }

    fn add(
        &mut self,
        name: &'static str,
        mut unit: String,
        mut curves: Vec<Vec<Vec<(f64, f64)>>>,
        mut sides: Vec<Vec<(f64, f64)>>,
        mut limits: Vec<f64>,
    ) {
        // Numbers of more than five digits, or with more than three behind the point, have no room beside the row.
        let pieces = curves.iter().flatten().chain(&sides);
        let reached = pieces.flatten().map(|(_, value)| value.abs());
        let most = reached.filter(|value| value.is_finite()).fold(0.0, f64::max);
        let mut scale = 1.0;
        if most >= 1e5 || (most > DUST && most < 5e-3) {
            #[expect(clippy::cast_possible_truncation, reason = "a power of ten")]
            let power = (most.log10() / 3.0).floor() as i32 * 3;
            scale = 10_f64.powi(power);
            let pieces = curves.iter_mut().flatten().chain(&mut sides);
            for (_, value) in pieces.flatten() {
                *value /= scale;
            }
            for limit in &mut limits {
                *limit /= scale;
            }
            unit = format!("10{} {unit}", superscript(power));
        }
        let pieces = curves.iter().flatten().chain(&sides);
        let values = pieces.flatten().map(|(_, value)| *value);
        let of_run = self.recorded.points.iter().map(|(_, slave)| *slave / scale);
        let of_run = of_run.filter(|_| name == "position");
        let [low, high] = reach(values.chain(of_run)).unwrap_or([0.0, 1.0]);
        // Limits that are far away would make a line of the curve.
        let size = high - low;
        let near: Vec<_> = limits
            .into_iter()
            .filter(|limit| *limit >= low - 0.6 * size && *limit <= high + 0.6 * size)
            .collect();
        let [low, high] = reach(near.iter().copied().chain([low, high])).unwrap_or([low, high]);
        let room = ((high - low) * 0.12).max(f64::MIN_POSITIVE);
        let range = if high > low { [low - room, high + room] } else { [low - 1.0, high + 1.0] };
        let row = Row { top: self.bottom, height: HEIGHT, range };
        self.strips.push(Strip { name, unit, scale, row, curves, sides, limits: near });
        self.bottom += HEIGHT + GAP;
    }

    fn x(&self, master: f64) -> f64 {
        let [low, high] = self.range;
        LEFT + (master - low) / (high - low) * (RIGHT - LEFT)
    }

    fn groups(&self) -> Vec<i16> {
        let Some(shown) = self.cams.last() else { return Vec::new() };
        let mut groups: Vec<_> =
            shown.file.cam.tappets().iter().map(|tappet| tappet.group).collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    fn draw(&self, heading: &str, below: &str) -> Result<String, Failure> {
        let groups = self.groups();
        let bars = groups.iter().fold(0.0, |height, _| height + BAR + BETWEEN);
        let items = self.items(&groups);
        let masters = self.bottom - GAP + if groups.is_empty() { 0.0 } else { BETWEEN + bars };
        let end = masters + MASTERS + 18.0 + legend_places(&items).1;
        let size = (stroke(WIDTH), stroke(end));
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            root.fill(&WHITE)?;
            title(&root, heading, below)?;
            for strip in &self.strips {
                self.strip(&root, strip)?;
            }
            let mut top = self.bottom - GAP + BETWEEN;
            for (index, group) in groups.into_iter().enumerate() {
                self.bars(&root, group, index, top)?;
                top += BAR + BETWEEN;
            }
            self.masters(&root, masters)?;
            legend(&root, &items, masters + MASTERS + 14.0)?;
            root.present()?;
        }
        Ok(resized(&text, size))
    }

    fn strip(&self, root: &Area<'_>, strip: &Strip) -> Result<(), Failure> {
        let Strip { name, unit, scale, row, curves, sides, limits } = strip;
        let at: Vec<_> = self.ticks().into_iter().map(|(x, _)| x).collect();
        row.draw_over(root, &at, [name, &format!("({unit})")])?;
        if *name == "position" {
            // Where one is already another one changes nothing.
            let mut drawn = HashSet::new();
            for (master, slave) in &self.recorded.points {
                let place = (fine(self.x(*master)), fine(row.y(*slave / scale)));
                if !drawn.insert([place.0, place.1].map(|place| place / fine(DOTS))) {
                    continue;
                }
                root.draw(&Circle::new(place, stroke(1.5), MARK.mix(0.55).filled()))?;
            }
        }
        let thin = color_of(3).stroke_width(stroke(0.9));
        sides.iter().try_for_each(|piece| self.path(root, row, piece, thin))?;
        for (index, pieces) in curves.iter().enumerate() {
            let style = shade(index, curves.len()).stroke_width(stroke(1.6));
            pieces.iter().try_for_each(|piece| self.path(root, row, piece, style))?;
        }
        for limit in limits {
            dashes(root, [(LEFT, row.y(*limit)), (RIGHT, row.y(*limit))], MARK)?;
        }
        // Beside the row: what each curve reaches.
        let mut y = row.top + 9.0;
        for (index, pieces) in curves.iter().enumerate() {
            if let Some([low, high]) = reach(pieces.iter().flatten().map(|(_, value)| *value)) {
                let size = low.abs().max(high.abs());
                let [low, high] = [low, high].map(|value| beside(value, size, 4));
                let text = format!("{low} … {high}");
                words(root, &text, (RIGHT + 12.0, y), shade(index, curves.len()))?;
                y += 18.0;
            }
        }
        Ok(())
    }

    fn path(
        &self,
        root: &Area<'_>,
        row: &Row,
        piece: &[(f64, f64)],
        style: ShapeStyle,
    ) -> Result<(), Failure> {
        for inside in row.within(piece) {
            let mut points: Vec<(i32, i32)> = Vec::with_capacity(inside.len());
            for (master, value) in inside {
                let point = (fine(self.x(master)), fine(row.y(value)));
                if points.last() != Some(&point) {
                    points.push(point);
                }
            }
            root.draw(&PathElement::new(points, style))?;
        }
        Ok(())
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range;
        ticks(low, high, 12.0).into_iter().map(|(value, text)| (self.x(value), text)).collect()
    }

    fn masters(&self, root: &Area<'_>, y: f64) -> Result<(), Failure> {
        let style = font(13.0, INK).pos(Pos::new(HPos::Center, VPos::Top));
        for (x, text) in self.ticks() {
            line(root, [(x, y), (x, y + 4.0)], FAINT.stroke_width(stroke(0.8)))?;
            root.draw_text(&text, &style, (fine(x), fine(y + 7.0)))?;
        }
        let unit = self.cams.last().map_or("u", |shown| shown.file.master.unit());
        let style = font(14.0, INK).pos(Pos::new(HPos::Center, VPos::Top));
        let name = format!("master ({unit})");
        root.draw_text(&name, &style, (fine(LEFT.midpoint(RIGHT)), fine(y + 26.0)))
    }

    /// When the bit of a group is on, while the master goes forwards at its velocity.
    fn bars(&self, root: &Area<'_>, group: i16, index: usize, top: f64) -> Result<(), Failure> {
        let Some(shown) = self.cams.last() else { return Ok(()) };
        let row = Row { top, height: BAR, range: [0.0, 1.0] };
        for [begin, end] in on_stretches(shown, group) {
            let [begin, end] = [begin, end].map(|place| self.x(shown.using.master_at(place)));
            let corners = [(begin.min(end), row.top), (begin.max(end), row.bottom())];
            let corners = corners.map(|(x, y)| (fine(x), fine(y)));
            root.draw(&Rectangle::new(corners, color_of(index + 1).mix(0.75).filled()))?;
        }
        row.frame(root)?;
        for tappet in shown.file.cam.tappets().iter().filter(|tappet| tappet.group == group) {
            let x = self.x(shown.using.master_at(tappet.master));
            line(
                root,
                [(x, row.top - 2.0), (x, row.bottom() + 2.0)],
                INK.stroke_width(stroke(1.3)),
            )?;
        }
        words(root, &format!("tappets of group {group}"), (RIGHT + 12.0, top + BAR / 2.0), INK)
    }

    fn items(&self, groups: &[i16]) -> Vec<(Sign, String)> {
        let mut items: Vec<_> = self
            .cams
            .iter()
            .enumerate()
            .map(|(index, shown)| {
                (Sign::Line(shade(index, self.cams.len())), shown.name.to_owned())
            })
            .collect();
        if !self.recorded.points.is_empty() {
            items.push((Sign::Patch(MARK), "recorded".to_owned()));
        }
        if self.strips.iter().any(|strip| !strip.sides.is_empty()) {
            let what = "least and greatest while the master accelerates and jerks";
            items.push((Sign::Line(color_of(3)), what.to_owned()));
        }
        // The line at 0 of an error is none.
        if self.strips.iter().any(|strip| !strip.limits.is_empty() && strip.name != ERROR) {
            items.push((Sign::Dashes(MARK), "limit".to_owned()));
        }
        // As the bars are drawn.
        for (index, group) in (1..).zip(groups) {
            let which = match groups {
                [_] => String::new(),
                _ => format!(" of group {group}"),
            };
            let turns = self.cams.last().is_some_and(|shown| alternates(shown, *group));
            let when = if turns { OTHER_WAY_ROUND } else { "" };
            let what = format!("tappets{which} that are on{when}");
            items.push((Sign::Patch(color_of(index)), what));
        }
        items
    }
}

/// A number as an exponent.
fn superscript(number: i32) -> String {
    let digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let raised = |digit: char| {
        if digit == '-' {
            return '⁻';
        }
        let index = digit.to_digit(10).and_then(|digit| usize::try_from(digit).ok());
        index.and_then(|index| digits.chars().nth(index)).unwrap_or(digit)
    };
    number.to_string().chars().map(raised).collect()
}

/// What was before stands back behind what is now.
fn shade(index: usize, count: usize) -> RGBColor {
    if index + 1 < count { color([160, 166, 176]) } else { color_of(0) }
}

/// Lowest and highest.
fn reach(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.filter(|value| value.is_finite()).fold(None, |reach, value| {
        let [low, high] = reach.unwrap_or([value, value]);
        Some([low.min(value), high.max(value)])
    })
}
