//! The picture.

use crate::chart::{
    Area, COLUMNS, Envelope, Failure, GAP, Input, LEFT, LINE, RIGHT, Row, Sign, Strips, TOP, WIDTH,
    color_of, dashes, legend, legend_places, line, title, words,
};
use crate::check::BlockClearance;
use crate::machine::Machine;
use crate::number::seconds;
use crate::page::{INK, MARK, fine, font, resized, stroke};
use crate::physics::Part;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use twin_motion::Place;

/// Heights of the rows, pixels: all of it, and what is near.
const HEIGHTS: [f64; 2] = [210.0, 150.0];

/// The row of what is near goes to so many times the wanted clearance, or the least.
const NEAR: f64 = 4.0;

/// It is there if all of it goes so many times as far: else it is seen there.
const FAR: f64 = 3.0;

/// Collisions that are kept to be marked; behind them the ground is red all the same.
const MOST_HITS: usize = 200;

/// The curves: all of it, and what of it is a collision; mm.
const CLEARANCE: usize = 0;
const HITS: usize = 1;

/// Nearer than what is wanted, and in each other.
const AMBER: RGBColor = RGBColor(255, 244, 214);
const ROSE: RGBColor = RGBColor(253, 222, 222);
/// The line of what is wanted.
const WANTED: RGBColor = RGBColor(196, 122, 0);

/// From the middle of a text to a line that must not cross it, pixels.
const CLEAR: f64 = 9.0;

/// Letters of a name beside the curves, at most.
const NAME: usize = 32;

/// A picture that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture cannot be drawn: {0}")]
pub struct ClearancePictureError(#[from] Failure);

/// A picture of clearance along a program. It takes the set-points one by one and keeps as much of them as its page shows.
#[derive(Clone, Debug)]
pub struct ClearancePicture<'m> {
    machine: &'m Machine,
    /// Nearer than this is told, mm.
    wanted: f64,
    /// Kinds are the obstacles that are nearest, behind them links that are nearest to each other.
    envelope: Envelope,
    /// What was nearest last.
    nearest: Option<usize>,
    least: Option<BlockClearance>,
    hits: Vec<Hit>,
    /// The last of them goes on.
    in_hit: bool,
    hits_left_out: u64,
}

/// For as long as something is in something.
#[derive(Clone, Copy, Debug)]
struct Hit {
    begin_ns: i64,
    end_ns: i64,
    /// Where it begins.
    place: Place,
}

impl<'m> ClearancePicture<'m> {
    /// Of nothing yet.
    pub fn new(machine: &'m Machine) -> Self {
        let collision = machine.collision.as_ref();
        let obstacles = collision.map_or(0, |collision| collision.surroundings.obstacles.len());
        Self {
            machine,
            wanted: collision.map_or(0.0, |collision| collision.clearance) * 1e3,
            envelope: Envelope::new(COLUMNS, obstacles + 1),
            nearest: None,
            least: None,
            hits: Vec::new(),
            in_hit: false,
            hits_left_out: 0,
        }
    }

    /// Takes the next set-point.
    pub fn include(&mut self, now: &BlockClearance) {
        let BlockClearance { place, time_ns, nearest, .. } = *now;
        let (clearance, hits) = (nearest.distance * 1e3, now.is_collision());
        let input = Input {
            time_ns,
            line: place.line,
            values: &[Some(clearance), hits.then_some(clearance)],
            held: self.nearest,
        };
        self.envelope.include(&input);
        self.nearest = Some(self.kind(nearest.parts));
        if self.least.is_none_or(|least| now.is_nearer_than(&least)) {
            self.least = Some(*now);
        }
        if hits && !self.in_hit {
            if self.hits.len() < MOST_HITS {
                self.hits.push(Hit { begin_ns: time_ns, end_ns: time_ns, place });
            } else {
                self.hits_left_out += 1;
            }
        } else if hits
            // Those that are left out come behind all that are kept.
            && self.hits_left_out == 0
            && let Some(hit) = self.hits.last_mut()
        {
            hit.end_ns = time_ns;
        }
        self.in_hit = hits;
    }

    fn obstacles(&self) -> usize {
        let collision = self.machine.collision.as_ref();
        collision.map_or(0, |collision| collision.surroundings.obstacles.len())
    }

    /// By what the parts are told apart in the strip.
    fn kind(&self, parts: [Part; 2]) -> usize {
        let obstacle = parts.into_iter().find_map(|part| match part {
            Part::Obstacle(index) => Some(index),
            Part::Link(_) | Part::Tool => None,
        });
        obstacle.unwrap_or_else(|| self.obstacles())
    }

    /// Draws the picture as SVG, of `program`, by its name.
    ///
    /// # Errors
    /// What plotters says.
    pub fn draw(&self, program: &str) -> Result<String, ClearancePictureError> {
        let rows = self.rows();
        let bottom = rows.last().map_or(TOP, Row::bottom) + GAP;
        let items = self.items();
        let below = bottom + Strips::HEIGHT;
        let size = (stroke(WIDTH), stroke(below + 18.0 + legend_places(&items).1));
        let strips = Strips::new(&self.envelope);
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            root.fill(&WHITE)?;
            let name = format!("Clearance of {program} on {}", self.machine.name);
            title(&root, &name, &self.verdict())?;
            for (row, name) in rows.iter().zip(["clearance", "what is near"]) {
                self.curve(&root, &strips, row, name)?;
            }
            if let Some(row) = rows.first() {
                self.list(&root, row)?;
                self.marks(&root, &strips, row)?;
            }
            strips.draw(&root, bottom, color_of, "what is nearest")?;
            legend(&root, &items, below + 14.0)?;
            root.present()?;
        }
        Ok(resized(&text, size))
    }

    /// All of it, and, where that would be seen badly, what is near.
    fn rows(&self) -> Vec<Row> {
        let [low, high] = self.envelope.range(CLEARANCE).unwrap_or_default();
        let range = |high: f64| [low.min(0.0) - 0.06 * (high - low.min(0.0)), high];
        let most = high.max(self.wanted).max(1e-3) * 1.15;
        let all = Row { top: TOP, height: HEIGHTS[0], range: range(most) };
        let near = NEAR * low.abs().max(self.wanted).max(0.25);
        if near * FAR > most {
            return vec![all];
        }
        vec![all, Row { top: all.bottom() + GAP, height: HEIGHTS[1], range: range(near) }]
    }

    /// Words below the title.
    fn verdict(&self) -> String {
        let [begin_ns, end_ns] = self.envelope.span_ns().unwrap_or_default();
        let least = self.least.map(|least| least.told(self.machine));
        let least = least.unwrap_or_else(|| "nothing moves".to_owned());
        format!(
            "{:.3} s; {least}{}",
            seconds(end_ns - begin_ns),
            match self.hit_count() {
                0 => String::new(),
                1 => "; 1 collision".to_owned(),
                count => format!("; {count} collisions"),
            }
        )
    }

    fn hit_count(&self) -> u64 {
        u64::try_from(self.hits.len()).unwrap_or(u64::MAX).saturating_add(self.hits_left_out)
    }

    /// One row: the grounds, the lines of what must not be, and the curve.
    fn curve(
        &self,
        root: &Area<'_>,
        strips: &Strips<'_>,
        row: &Row,
        name: &str,
    ) -> Result<(), Failure> {
        let ground = |[low, high]: [f64; 2], shade: RGBColor| {
            let [bottom, top] = [low, high].map(|value| row.y(value).clamp(row.top, row.bottom()));
            let corners = [(LEFT, top), (RIGHT, bottom)].map(|(x, y)| (fine(x), fine(y)));
            root.draw(&Rectangle::new(corners, shade.filled()))
        };
        if self.wanted > 0.0 {
            ground([0.0, self.wanted], AMBER)?;
        }
        ground([row.range[0], 0.0], ROSE)?;
        row.draw(root, strips.time(), [name, "(mm)"])?;
        // For as long as something is in something.
        for (begin, end, is_hit) in strips.bands(|column| column.has(HITS)) {
            if is_hit {
                let end = end.max(begin + 1.5);
                let corners = [(begin, row.top), (end, row.bottom())];
                let corners = corners.map(|(x, y)| (fine(x), fine(y)));
                root.draw(&Rectangle::new(corners, MARK.mix(0.18).filled()))?;
            }
        }
        if self.wanted > 0.0 {
            dashes(root, [(LEFT, row.y(self.wanted)), (RIGHT, row.y(self.wanted))], WANTED)?;
        }
        let zero = row.y(0.0);
        line(root, [(LEFT, zero), (RIGHT, zero)], MARK.stroke_width(stroke(1.2)))?;
        strips.curve(root, row, CLEARANCE, 1.0, INK.stroke_width(stroke(1.5)))
    }

    /// What there is to say beside the curves.
    fn list(&self, root: &Area<'_>, row: &Row) -> Result<(), Failure> {
        let mut lines = Vec::new();
        if let Some(least) = &self.least {
            let [one, other] = least.nearest.parts.map(|part| self.machine.part_name(part));
            let (distance, shade, between) = if least.is_collision() {
                (format!("{:.3} mm deep", -least.nearest.distance * 1e3), MARK, ["", "in "])
            } else {
                let distance = least.nearest.distance.max(0.0) * 1e3;
                (format!("{distance:.3} mm"), INK, ["between ", "and "])
            };
            lines.push((format!("least: {distance}"), shade));
            lines.push((format!("{}, {:.3} s", least.place, seconds(least.time_ns)), INK));
            lines.push((format!("{}{}", between[0], shortened(&one)), INK));
            lines.push((format!("{}{}", between[1], shortened(&other)), INK));
        }
        if self.wanted > 0.0 {
            lines.push((
                format!("wanted: {} mm", crate::number::significant(self.wanted, 6)),
                WANTED,
            ));
        }
        let mut y = row.top + LINE / 2.0;
        for (text, shade) in lines {
            words(root, &text, (RIGHT + 12.0, y), shade)?;
            y += LINE;
        }
        Ok(())
    }

    /// A ring around the least of all and, where there is room, the lines in which collisions begin.
    fn marks(&self, root: &Area<'_>, strips: &Strips<'_>, row: &Row) -> Result<(), Failure> {
        let style = |shade| font(12.5, shade).pos(Pos::new(HPos::Center, VPos::Center));
        let mut free = LEFT;
        for hit in &self.hits {
            let [begin, end] = [hit.begin_ns, hit.end_ns].map(|time_ns| strips.time().x(time_ns));
            let (text, half) = label(hit.place);
            let x = begin.midpoint(end).clamp(LEFT + half, RIGHT - half);
            if x - half >= free {
                root.draw_text(&text, &style(MARK), (fine(x), fine(row.top + 9.0)))?;
                free = x + half + 6.0;
            }
        }
        let Some(least) = &self.least else { return Ok(()) };
        let at = (strips.time().x(least.time_ns), row.y(least.nearest.distance * 1e3));
        let ring = INK.stroke_width(stroke(1.6));
        root.draw(&Circle::new((fine(at.0), fine(at.1)), stroke(5.0), ring))?;
        if least.is_collision() {
            return Ok(());
        }
        let (text, half) = label(least.place);
        // The curve is above the least of all; below it there may be lines.
        let below = at.1 + 14.0;
        let lines = [row.y(0.0), row.y(self.wanted), row.bottom()];
        let is_free = lines.iter().all(|line| (line - below).abs() > CLEAR);
        let y = if is_free { below } else { at.1 - 14.0 };
        let at = (fine(at.0.clamp(LEFT + half, RIGHT - half)), fine(y));
        root.draw_text(&text, &style(INK), at)
    }

    fn items(&self) -> Vec<(Sign, String)> {
        let mut items = vec![(Sign::Line(INK), "clearance".to_owned())];
        if self.wanted > 0.0 {
            items.push((Sign::Dashes(WANTED), "wanted".to_owned()));
        }
        items.push((Sign::Line(MARK), "what touches".to_owned()));
        if self.hit_count() > 0 {
            items.push((Sign::Patch(ROSE), "in each other".to_owned()));
        }
        items.push((Sign::Ring, "least clearance".to_owned()));
        let columns = self.envelope.columns();
        for kind in 0..=self.obstacles() {
            if columns.iter().any(|column| column.most_held() == Some(kind)) {
                let name = if kind < self.obstacles() {
                    self.machine.part_name(Part::Obstacle(kind))
                } else {
                    "links to each other".to_owned()
                };
                items.push((Sign::Patch(color_of(kind)), shortened(&name)));
            }
        }
        items
    }
}

/// A line of the program, and half of the room for it, pixels.
fn label(place: Place) -> (String, f64) {
    let text = place.to_string();
    let half = text.chars().fold(0.0, |sum, _| sum + 3.2);
    (text, half)
}

/// A name that finds room.
fn shortened(name: &str) -> String {
    if name.chars().count() <= NAME {
        return name.to_owned();
    }
    name.chars().take(NAME - 1).chain(['…']).collect()
}
