//! The picture of a start with a ramp: what the slave does before and after over the time, beside its cam.

use super::{CamPictureError, reach};
use crate::chart::{
    Area, Failure, GAP, LEFT, RIGHT, Row, Sign, TOP, WIDTH, color_of, dashes, legend,
    legend_places, line, ticks, title, words,
};
use crate::number::{beside, significant};
use crate::page::{FAINT, INK, MARK, color, fine, font, resized, stroke};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use twin_motion::cam::tune::{
    RampError, RampIn, RampMoment, RampShown, RampWish, on_cam, ramp_shown,
};
use twin_motion::profile::State;

/// Height of a row of curves, pixels.
const HEIGHT: f64 = 190.0;
/// Room for the numbers and the name of the time, pixels.
const TIMES: f64 = 50.0;
/// Behind the end of the ramp the slave is shown on its cam for this part of the time.
const BEHIND: f64 = 0.12;
/// A ramp before that takes longer than this many times the one after is shown as far as that.
const LONGEST: f64 = 4.0;
/// Points of the cam's curve.
const POINTS: u32 = 600;
/// Limits that are farther away than this many times what is reached would make a line of the curve.
const FAR: f64 = 4.0;

/// A start to be drawn.
#[derive(Debug)]
pub struct RampPicture<'a> {
    /// What was asked for.
    pub wish: &'a RampWish,
    /// The ramp that the cam's file has; none if it has no values for one.
    pub before: Option<RampIn>,
    /// The ramp that was found.
    pub after: RampIn,
    /// Units of master and slave.
    pub units: [&'a str; 2],
}

/// Draws a start as SVG.
///
/// # Errors
/// What plotters says, or why there is no such start.
pub fn draw_ramp(
    heading: &str,
    below: &str,
    picture: &RampPicture<'_>,
) -> Result<String, CamPictureError> {
    let wrong = |error: RampError| CamPictureError(error.to_string());
    let page = Page::new(picture).map_err(wrong)?;
    page.draw(heading, below).map_err(|error| CamPictureError(error.to_string()))
}

/// Pieces of a line over the time.
type Pieces = Vec<Vec<(f64, f64)>>;

struct Strip {
    name: &'static str,
    unit: String,
    row: Row,
    cam: Vec<(f64, f64)>,
    before: Pieces,
    after: Pieces,
    limits: Vec<f64>,
    /// Limits that are too far away.
    far: Option<f64>,
}

struct Page<'a> {
    picture: &'a RampPicture<'a>,
    end_s: f64,
    durations: [Option<f64>; 2],
    strips: Vec<Strip>,
    bottom: f64,
}

const QUANTITIES: [(&str, &str); 3] =
    [("position", ""), ("velocity", "/s"), ("acceleration", "/s²")];

fn of(state: &State) -> [f64; 3] {
    [state.position, state.velocity, state.acceleration]
}

fn part(state: &State, quantity: usize) -> f64 {
    of(state).get(quantity).copied().unwrap_or_default()
}

/// What was before stands back.
const BEFORE: [u8; 3] = [160, 166, 176];
const OF_CAM: [u8; 3] = [44, 140, 80];

impl<'a> Page<'a> {
    fn new(picture: &'a RampPicture<'a>) -> Result<Self, RampError> {
        let wish = picture.wish;
        let after = ramp_shown(wish, &picture.after)?;
        let before = picture.before.as_ref().map(|ramp| ramp_shown(wish, ramp)).transpose()?;
        let longer = before.as_ref().map_or(0.0, |before| before.duration_s);
        let longest = longer.min(LONGEST * after.duration_s).max(after.duration_s);
        // A slave that is on its cam already is shown for a second.
        let end_s = if longest > 0.0 { longest * (1.0 + BEHIND) } else { 1.0 };
        let mut cam = Vec::new();
        for index in 0..=POINTS {
            let time_s = end_s * f64::from(index) / f64::from(POINTS);
            cam.push((time_s, on_cam(wish, time_s)?));
        }
        // The turn of a rotary slave on which it comes onto its cam.
        let last = after.stretches.last().and_then(|stretch| stretch.last());
        if let Some(last) = last {
            let by = last.cam.position - on_cam(wish, last.time_s)?.position;
            for (_, state) in &mut cam {
                state.position += by;
            }
        }
        let durations = [before.as_ref().map(|it| it.duration_s), Some(after.duration_s)];
        let mut page = Self { picture, end_s, durations, strips: Vec::new(), bottom: TOP };
        for (index, (name, per)) in QUANTITIES.into_iter().enumerate() {
            let of_cam: Vec<_> =
                cam.iter().map(|(time, state)| (*time, part(state, index))).collect();
            let after = page.slave(&after, &cam, index);
            let before = if let Some(before) = &before {
                page.slave(before, &cam, index)
            } else {
                // Without a ramp it jumps at once.
                let from = (0.0, part(&wish.slave, index));
                vec![std::iter::once(from).chain(of_cam.iter().copied()).collect()]
            };
            let unit = format!("{}{per}", picture.units[1]);
            page.add((name, unit), of_cam, [before, after], index);
        }
        Ok(page)
    }

    /// What the slave does: the ramp, and its cam behind it.
    fn slave(&self, shown: &RampShown, cam: &[(f64, State)], quantity: usize) -> Pieces {
        let inside = |stretch: &Vec<_>| {
            let moments = stretch.iter().filter(|moment: &&RampMoment| moment.time_s <= self.end_s);
            let line = moments.map(|moment| (moment.time_s, part(&moment.slave, quantity)));
            line.collect::<Vec<_>>()
        };
        let mut line: Vec<_> = vec![(0.0, part(&self.picture.wish.slave, quantity))];
        line.extend(shown.stretches.iter().flat_map(inside));
        // A ramp before may come onto its cam a turn away.
        let last = shown.stretches.last().and_then(|stretch| stretch.last());
        let by = last.filter(|_| quantity == 0).map_or(0.0, |last| {
            let near = cam.iter().min_by(|one, other| {
                (one.0 - last.time_s).abs().total_cmp(&(other.0 - last.time_s).abs())
            });
            let period = self.picture.wish.table.slave_period.filter(|period| *period > 0.0);
            match (near, period) {
                (Some((_, state)), Some(period)) => {
                    ((last.slave.position - state.position) / period).round() * period
                }
                _ => 0.0,
            }
        });
        let behind = cam.iter().filter(|(time, _)| *time > shown.duration_s);
        line.extend(behind.map(|(time, state)| (*time, part(state, quantity) + by)));
        vec![line]
    }

    fn add(
        &mut self,
        (name, unit): (&'static str, String),
        cam: Vec<(f64, f64)>,
        [before, after]: [Pieces; 2],
        quantity: usize,
    ) {
        let wish = self.picture.wish;
        let (velocity, acceleration) = (wish.limits.velocity, wish.limits.acceleration);
        let limits = match quantity {
            0 => wish.position,
            1 => [-velocity, velocity],
            _ => [-acceleration, acceleration],
        };
        let pieces = before.iter().chain(&after).flatten().chain(&cam);
        let [low, high] = reach(pieces.map(|(_, value)| *value)).unwrap_or([0.0, 1.0]);
        let size = low.abs().max(high.abs());
        let finite = limits.into_iter().filter(|limit| limit.is_finite());
        let (near, far): (Vec<_>, Vec<_>) =
            finite.partition(|limit| quantity == 0 || limit.abs() <= FAR * size);
        let [low, high] = reach(near.iter().copied().chain([low, high])).unwrap_or([low, high]);
        let room = (high - low) * 0.1;
        let range = if high > low { [low - room, high + room] } else { [low - 1.0, high + 1.0] };
        let row = Row { top: self.bottom, height: HEIGHT, range };
        let far = far.last().copied();
        self.strips.push(Strip { name, unit, row, cam, before, after, limits: near, far });
        self.bottom += HEIGHT + GAP;
    }

    fn x(&self, time_s: f64) -> f64 {
        LEFT + time_s / self.end_s * (RIGHT - LEFT)
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        let ticks = ticks(0.0, self.end_s, 10.0);
        ticks.into_iter().map(|(value, text)| (self.x(value), text)).collect()
    }

    fn draw(&self, heading: &str, below: &str) -> Result<String, Failure> {
        let items = self.items();
        let times = self.bottom - GAP;
        let end = times + TIMES + 18.0 + legend_places(&items).1;
        let size = (stroke(WIDTH), stroke(end));
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            root.fill(&WHITE)?;
            title(&root, heading, below)?;
            for strip in &self.strips {
                self.strip(&root, strip)?;
            }
            self.times(&root, times)?;
            legend(&root, &items, times + TIMES + 14.0)?;
            root.present()?;
        }
        Ok(resized(&text, size))
    }

    fn strip(&self, root: &Area<'_>, strip: &Strip) -> Result<(), Failure> {
        let Strip { name, unit, row, cam, before, after, limits, far } = strip;
        let at: Vec<_> = self.ticks().into_iter().map(|(x, _)| x).collect();
        row.draw_over(root, &at, [name, &format!("({unit})")])?;
        for (duration, shade) in self.durations.into_iter().zip([color(BEFORE), color_of(0)]) {
            // From here on the slave is on its cam.
            if let Some(x) = duration.filter(|end| *end <= self.end_s).map(|end| self.x(end)) {
                let style = shade.mix(0.6).stroke_width(stroke(0.9));
                line(root, [(x, row.top), (x, row.bottom())], style)?;
            }
        }
        for (pieces, shade) in [(before, color(BEFORE)), (after, color_of(0))] {
            for piece in pieces.iter().flat_map(|piece| row.within(piece)) {
                let style = shade.stroke_width(stroke(1.8));
                root.draw(&PathElement::new(self.points(row, &piece), style))?;
            }
        }
        for piece in row.within(cam) {
            let style = color(OF_CAM).stroke_width(stroke(1.2));
            let points = self.points(row, &piece);
            root.draw(&DashedPathElement::new(points, fine(4.0), fine(4.0), style))?;
        }
        for limit in limits {
            dashes(root, [(LEFT, row.y(*limit)), (RIGHT, row.y(*limit))], MARK)?;
        }
        // Beside the row: what the slave reaches, and limits that have no room in it.
        let mut y = row.top + 9.0;
        for (pieces, shade) in [(before, color(BEFORE)), (after, color_of(0))] {
            if let Some([low, high]) = reach(pieces.iter().flatten().map(|(_, value)| *value)) {
                let size = high - low;
                let text = format!("{} … {}", beside(low, size, 4), beside(high, size, 4));
                words(root, &text, (RIGHT + 12.0, y), shade)?;
                y += 18.0;
            }
        }
        if let Some(far) = far {
            words(root, &format!("limit {}", significant(*far, 4)), (RIGHT + 12.0, y), MARK)?;
        }
        Ok(())
    }

    fn points(&self, row: &Row, piece: &[(f64, f64)]) -> Vec<(i32, i32)> {
        let points = piece.iter().map(|(time, value)| (fine(self.x(*time)), fine(row.y(*value))));
        let mut points: Vec<_> = points.collect();
        points.dedup();
        points
    }

    fn times(&self, root: &Area<'_>, y: f64) -> Result<(), Failure> {
        let style = font(13.0, INK).pos(Pos::new(HPos::Center, VPos::Top));
        for (x, text) in self.ticks() {
            line(root, [(x, y), (x, y + 4.0)], FAINT.stroke_width(stroke(0.8)))?;
            root.draw_text(&text, &style, (fine(x), fine(y + 7.0)))?;
        }
        let master = self.picture.wish.master;
        let unit = self.picture.units[0];
        let name = format!(
            "time (s); the master goes on from {} {unit} with {} {unit}/s",
            significant(master.position, 6),
            significant(master.velocity, 6)
        );
        let style = font(14.0, INK).pos(Pos::new(HPos::Center, VPos::Top));
        root.draw_text(&name, &style, (fine(LEFT.midpoint(RIGHT)), fine(y + 26.0)))
    }

    fn items(&self) -> Vec<(Sign, String)> {
        let on_cam = |duration: Option<f64>| match duration {
            Some(seconds) => {
                format!("with the ramp, on its cam after {} s", significant(seconds, 4))
            }
            None => "without a ramp, a jump".to_owned(),
        };
        let [before, after] = self.durations;
        let mut items = vec![
            (Sign::Dashes(color(OF_CAM)), "cam".to_owned()),
            (Sign::Line(color(BEFORE)), format!("before: {}", on_cam(before))),
            (Sign::Line(color_of(0)), format!("after: {}", on_cam(after))),
        ];
        if self.strips.iter().any(|strip| !strip.limits.is_empty()) {
            items.push((Sign::Dashes(MARK), "limit".to_owned()));
        }
        items
    }
}
