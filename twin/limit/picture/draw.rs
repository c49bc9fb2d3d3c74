//! Draws a profile.

use super::{FEED, FIRST_AXIS, Highest, KINDS, PATH, PER_AXIS, Picture};
use crate::axis_kind::AxisKind;
use crate::chart::{
    Area, Failure, GAP, LEFT, LINE, RIGHT, Row, Sign, Strips, TOP, WIDTH, color_of, dashes, legend,
    legend_places, title, words,
};
use crate::limit::text::{self, digits, percent};
use crate::number::seconds;
use crate::page::{INK, MARK, color, fine, font, resized, stroke};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The rows are so much higher than the largest value: there its line is written.
const ROOM: f64 = 1.3;

/// From the middle of a text to a line that must not cross it, pixels.
const CLEAR: f64 = 9.0;

/// What the rows of the axes show.
const QUANTITIES: [(&str, [&str; 2]); PER_AXIS] = [
    ("velocity", ["deg/s", "mm/s"]),
    ("acceleration", ["deg/s²", "mm/s²"]),
    ("jerk", ["deg/s³", "mm/s³"]),
    ("motor effort", ["Nm", "N"]),
];

/// The one of them that is in SI anyway.
const EFFORT: usize = 3;

/// Colours of limits that are of no axis.
const OTHERS: [[u8; 3]; KINDS.len()] = [
    [214, 218, 224],
    [160, 166, 176],
    [128, 112, 168],
    [110, 116, 126],
    [34, 38, 46],
    [176, 150, 110],
];

/// A picture being drawn.
pub(super) struct Drawing<'a, 'm> {
    picture: &'a Picture<'m>,
    strips: Strips<'a>,
}

impl<'a, 'm> Drawing<'a, 'm> {
    pub(super) fn new(picture: &'a Picture<'m>) -> Self {
        Self { picture, strips: Strips::new(&picture.envelope) }
    }

    pub(super) fn draw(&self, program: &str, machine: &str) -> Result<String, Failure> {
        // As high as the curves need to be read, and as the list beside them.
        let least = self.picture.axes.iter().fold(12.0, |height, _| height + LINE);
        let height = 150.0_f64.max(least);
        let mut rows = vec![(None, Row { top: TOP, height, range: self.feeds() })];
        let mut bottom = TOP + height + GAP;
        for quantity in 0..PER_AXIS {
            if self.picture.parts(quantity).next().is_some() {
                let range = self.shares(quantity);
                rows.push((Some(quantity), Row { top: bottom, height, range }));
                bottom += height + GAP;
            }
        }
        let items = self.items();
        let below = bottom + Strips::HEIGHT;
        let end = below + 18.0 + legend_places(&items).1;
        let size = (stroke(WIDTH), stroke(end));
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            root.fill(&WHITE)?;
            self.title(&root, program, machine)?;
            for (quantity, row) in &rows {
                match quantity {
                    None => self.path(&root, row)?,
                    Some(quantity) => self.axes(&root, row, *quantity)?,
                }
            }
            let kinds = |kind| self.kind_color(kind);
            self.strips.draw(&root, bottom, kinds, "what holds back")?;
            legend(&root, &items, below + 14.0)?;
            root.present()?;
        }
        Ok(resized(&text, size))
    }

    fn title(&self, root: &Area<'_>, program: &str, machine: &str) -> Result<(), Failure> {
        let [begin_ns, end_ns] = self.picture.envelope.span_ns().unwrap_or_default();
        let [begin, end] = self.picture.way.unwrap_or_default();
        let below = format!(
            "{} s, {} mm; {}",
            digits(seconds(end_ns - begin_ns)),
            digits((end - begin) * 1e3),
            self.verdict(),
        );
        title(root, &format!("{program} on {machine}"), &below)
    }

    /// The largest part of a limit that is asked for.
    fn verdict(&self) -> String {
        let all = (0..PER_AXIS).flat_map(|quantity| {
            self.picture.parts(quantity).map(move |(_, axis, highest)| (quantity, axis, highest))
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

    /// From 0 to some way above the fastest, along the path and as programmed, mm/s.
    fn feeds(&self) -> [f64; 2] {
        let envelope = &self.picture.envelope;
        let top = [PATH, FEED].into_iter().filter_map(|curve| Some(envelope.range(curve)?[1]));
        let top = top.fold(0.0, f64::max);
        let low = envelope.range(PATH).map_or(0.0, |[low, _]| low.min(0.0));
        [low * ROOM, if top > 0.0 { top * ROOM } else { 1.0 }]
    }

    /// Some more than the limits, or than what is asked for, %.
    fn shares(&self, quantity: usize) -> [f64; 2] {
        let parts = self.picture.parts(quantity).map(|(_, _, highest)| highest.peak.value);
        let most = parts.fold(1.0, f64::max) * 100.0 * ROOM;
        [-most, most]
    }

    /// Velocity along the path against the programmed feed.
    fn path(&self, root: &Area<'_>, row: &Row) -> Result<(), Failure> {
        row.draw(root, self.strips.time(), ["path velocity", "(mm/s)"])?;
        self.strips.curve(
            root,
            row,
            FEED,
            1.0,
            color([160, 166, 176]).stroke_width(stroke(2.4)),
        )?;
        self.strips.curve(root, row, PATH, 1.0, INK.stroke_width(stroke(1.4)))?;
        let fastest = &self.picture.fastest;
        let at = (RIGHT + 12.0, row.top + LINE / 2.0);
        words(root, &format!("at most {} mm/s", digits(fastest.peak.value)), at, INK)?;
        self.ring(root, row, fastest, 1.0, None, INK)
    }

    /// One quantity of all axes against their limits.
    fn axes(&self, root: &Area<'_>, row: &Row, quantity: usize) -> Result<(), Failure> {
        let Some((name, units)) = QUANTITIES.get(quantity) else { return Ok(()) };
        row.draw(root, self.strips.time(), [name, "(% of limit)"])?;
        // Those that go far lie behind those that do not.
        let mut order: Vec<_> = self.picture.parts(quantity).collect();
        order.sort_by(|one, other| other.2.peak.value.total_cmp(&one.2.peak.value));
        for (index, ..) in order {
            let style = color_of(index).stroke_width(stroke(1.4));
            self.strips.curve(root, row, FIRST_AXIS + PER_AXIS * index + quantity, 100.0, style)?;
        }
        for limit in [-100.0, 100.0] {
            dashes(root, [(LEFT, row.y(limit)), (RIGHT, row.y(limit))], MARK)?;
        }
        let mut y = row.top + LINE / 2.0;
        for (index, axis, highest) in self.picture.parts(quantity) {
            let unit = match axis.kind {
                AxisKind::Rotary => units[0],
                AxisKind::Linear => units[1],
            };
            let limit = self.picture.limits(axis).get(quantity).copied().flatten();
            let limit = limit.unwrap_or_default() * highest.peak.value;
            let value = if quantity == EFFORT { limit } else { axis.from_si(limit) };
            let text = format!("{}: {}, {}", axis.name, percent(highest.peak.value), digits(value));
            words(root, &format!("{text} {unit}"), (RIGHT + 12.0, y), color_of(index))?;
            y += LINE;
        }
        match highest(self.picture.parts(quantity), |one| one.2) {
            Some((index, _, highest)) => {
                self.ring(root, row, highest, 100.0, Some(100.0), color_of(index))
            }
            None => Ok(()),
        }
    }

    /// Marks the largest value of a row, in which ±`limit` is drawn.
    fn ring(
        &self,
        root: &Area<'_>,
        row: &Row,
        highest: &Highest,
        scale: f64,
        limit: Option<f64>,
        color: RGBColor,
    ) -> Result<(), Failure> {
        if highest.peak.value <= 0.0 {
            return Ok(());
        }
        let at = (self.strips.time().x(highest.time_ns), row.y(highest.value * scale));
        let ring = color.stroke_width(stroke(1.6));
        root.draw(&Circle::new((fine(at.0), fine(at.1)), stroke(5.0), ring))?;
        // Outside of the curve, where the row has room for it, not across the dashes of a limit, and within the page.
        let text = format!("line {}", text::line(highest.peak.place));
        let half = text.chars().fold(0.0, |sum, _| sum + 3.2);
        let outwards = if highest.value < 0.0 { 1.0 } else { -1.0 };
        let mut y = at.1 + 13.0 * outwards;
        if let Some(limit) = limit.map(|limit| row.y(-limit * outwards))
            && (y - limit).abs() < CLEAR
        {
            y = limit + CLEAR * outwards;
        }
        let x = at.0.clamp(LEFT + half, RIGHT - half);
        let style = font(12.5, color).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw_text(&text, &style, (fine(x), fine(y)))
    }

    fn kind_color(&self, kind: usize) -> RGBColor {
        let other = kind.checked_sub(self.picture.axes.len()).and_then(|other| OTHERS.get(other));
        other.map_or_else(|| color_of(kind), |other| color(*other))
    }

    fn items(&self) -> Vec<(Sign, String)> {
        let axes = self.picture.axes;
        let mut items: Vec<_> = axes
            .iter()
            .enumerate()
            .map(|(index, axis)| (Sign::Line(color_of(index)), format!("axis {}", axis.name)))
            .collect();
        items.push((Sign::Dashes(MARK), "limit".to_owned()));
        items.push((Sign::Ring, "largest value".to_owned()));
        items.push((Sign::Line(INK), "along the path".to_owned()));
        items.push((Sign::Line(color([160, 166, 176])), "programmed".to_owned()));
        let columns = self.picture.envelope.columns();
        for (number, words) in KINDS.into_iter().enumerate() {
            let kind = axes.len() + number;
            if columns.iter().any(|column| column.most_held() == Some(kind)) {
                items.push((Sign::Patch(self.kind_color(kind)), words.to_owned()));
            }
        }
        items
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
