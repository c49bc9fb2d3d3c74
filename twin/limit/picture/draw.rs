//! Draws a profile.

use super::colors::{OTHERS, color_of};
use super::envelope::{At, Column};
use super::page::{
    Area, Failure, GAP, LEFT, LINE, RIGHT, Row, Sign, TOP, Time, WIDTH, dashes, legend,
    legend_places, line, words,
};
use super::{FEED, FIRST_AXIS, Highest, KINDS, PATH, PER_AXIS, Picture};
use crate::limit::text::{self, digits, percent};
use crate::machine::AxisKind;
use crate::page::{FAINT, INK, MARK, color, fine, font, resized, stroke};
use crate::report::seconds;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The rows are so much higher than the largest value: there its line is written.
const ROOM: f64 = 1.3;

/// Height of the strips, pixels.
const STRIP: f64 = 16.0;

/// From the middle of a text to a line that must not cross it, pixels.
const CLEAR: f64 = 9.0;

/// Between numbers of lines that are narrow, pixels.
const SPARSE: f64 = 60.0;

/// What the rows of the axes show.
const QUANTITIES: [(&str, [&str; 2]); PER_AXIS] = [
    ("velocity", ["deg/s", "mm/s"]),
    ("acceleration", ["deg/s²", "mm/s²"]),
    ("jerk", ["deg/s³", "mm/s³"]),
    ("motor effort", ["Nm", "N"]),
];

/// The one of them that is in SI anyway.
const EFFORT: usize = 3;

/// A picture being drawn.
pub(super) struct Drawing<'a, 'm> {
    picture: &'a Picture<'m>,
    time: Time,
}

impl<'a, 'm> Drawing<'a, 'm> {
    pub(super) fn new(picture: &'a Picture<'m>) -> Self {
        let span_ns = picture.envelope.span_ns().unwrap_or_default();
        Self { picture, time: Time::new(span_ns) }
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
        let held = Row { top: bottom, height: STRIP, range: [0.0, 1.0] };
        let lines = Row { top: bottom + STRIP + 8.0, ..held };
        let items = self.items();
        let below = lines.bottom() + 50.0;
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
            self.held(&root, &held)?;
            self.lines(&root, &lines)?;
            self.times(&root, lines.bottom())?;
            legend(&root, &items, below + 14.0)?;
            root.present()?;
        }
        Ok(resized(&text, size))
    }

    fn title(&self, root: &Area<'_>, program: &str, machine: &str) -> Result<(), Failure> {
        let at = |y: f64| (fine(LEFT), fine(y));
        root.draw_text(&format!("{program} on {machine}"), &font(23.0, INK), at(16.0))?;
        let [begin_ns, end_ns] = self.picture.envelope.span_ns().unwrap_or_default();
        let [begin, end] = self.picture.way.unwrap_or_default();
        let below = format!(
            "{} s, {} mm; {}",
            digits(seconds(end_ns - begin_ns)),
            digits((end - begin) * 1e3),
            self.verdict(),
        );
        root.draw_text(&below, &font(15.5, FAINT), at(46.0))
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

    fn curve(
        &self,
        root: &Area<'_>,
        row: &Row,
        curve: usize,
        scale: f64,
        style: ShapeStyle,
    ) -> Result<(), Failure> {
        for piece in self.picture.envelope.curve(curve) {
            let mut points: Vec<(i32, i32)> = Vec::with_capacity(piece.len());
            for At { time_ns, value } in piece {
                let point = (fine(self.time.x(time_ns)), fine(row.y(value * scale)));
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
        Ok(())
    }

    /// Velocity along the path against the programmed feed.
    fn path(&self, root: &Area<'_>, row: &Row) -> Result<(), Failure> {
        row.draw(root, &self.time, ["path velocity", "(mm/s)"])?;
        self.curve(root, row, FEED, 1.0, color([160, 166, 176]).stroke_width(stroke(2.4)))?;
        self.curve(root, row, PATH, 1.0, INK.stroke_width(stroke(1.4)))?;
        let fastest = &self.picture.fastest;
        let at = (RIGHT + 12.0, row.top + LINE / 2.0);
        words(root, &format!("at most {} mm/s", digits(fastest.peak.value)), at, INK)?;
        self.ring(root, row, fastest, 1.0, None, INK)
    }

    /// One quantity of all axes against their limits.
    fn axes(&self, root: &Area<'_>, row: &Row, quantity: usize) -> Result<(), Failure> {
        let Some((name, units)) = QUANTITIES.get(quantity) else { return Ok(()) };
        row.draw(root, &self.time, [name, "(% of limit)"])?;
        // Those that go far lie behind those that do not.
        let mut order: Vec<_> = self.picture.parts(quantity).collect();
        order.sort_by(|one, other| other.2.peak.value.total_cmp(&one.2.peak.value));
        for (index, ..) in order {
            let style = color_of(index).stroke_width(stroke(1.4));
            self.curve(root, row, FIRST_AXIS + PER_AXIS * index + quantity, 100.0, style)?;
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
        let at = (self.time.x(highest.time_ns), row.y(highest.value * scale));
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

    /// Which limit holds the path back.
    fn held(&self, root: &Area<'_>, row: &Row) -> Result<(), Failure> {
        let of = |column: &Column| column.most_held();
        for (begin, end, kind) in self.bands(of) {
            let Some(kind) = kind else { continue };
            band(root, row, [begin, end], self.kind_color(kind))?;
        }
        row.frame(root)?;
        words(root, "what holds back", (RIGHT + 12.0, row.top + STRIP / 2.0), INK)
    }

    /// Stretches of time in which something stays the same.
    fn bands<T: PartialEq + Copy>(&self, of: impl Fn(&Column) -> T) -> Vec<(f64, f64, T)> {
        let mut bands: Vec<(f64, f64, T)> = Vec::new();
        for column in self.picture.envelope.columns() {
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
        for column in self.picture.envelope.columns() {
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

fn band(
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
