//! Clearance along a program as a picture.

use crate::check::BlockClearance;
use twin_machine::Machine;
use twin_number::seconds;
use twin_number::significant;
use twin_path::Place;
use twin_physics::Part;
use twin_plot::{
    Chart, Color, INK, Legend, MARK, Mark, Row, Shape, Side, Sign, Stroke, Timeline, reach,
};

/// Heights of the rows, pixels: all of it, and what is near.
const HEIGHTS: [f64; 2] = [210.0, 150.0];

/// Upper end of the row of near clearances, as a multiple of the wanted clearance, or of the least.
const NEAR: f64 = 4.0;

/// There is such a row if the whole goes this many times as far.
const FAR: f64 = 3.0;

/// Collisions whose lines are kept; the ground of those behind them is red all the same.
const MOST_HITS: u64 = 200;

/// The curves: all of it, and what of it is a collision; mm.
const CLEARANCE: usize = 0;
const HITS: usize = 1;

/// Nearer than what is wanted, and in each other.
const AMBER: Color = Color::rgb(255, 244, 214);
const ROSE: Color = Color::rgb(253, 222, 222);
/// The line of what is wanted.
const WANTED: Color = Color::rgb(196, 122, 0);

/// Letters of a name next to the curves, at most.
const NAME: usize = 32;

/// A picture of clearance along a program. It takes the set-points one by one and keeps as much of them as its page shows.
#[derive(Clone, Debug)]
pub struct ClearancePicture<'m> {
    machine: &'m Machine,
    /// Nearer than this is a finding, mm.
    wanted: f64,
    /// Kinds are the obstacles that are nearest, behind them links that are nearest to each other.
    timeline: Timeline,
    least: Option<BlockClearance>,
    /// Begin, end and line of each collision that is kept, s.
    hits: Vec<([f64; 2], Place)>,
    hit_count: u64,
    /// The last collision goes on.
    in_hit: bool,
}

impl<'m> ClearancePicture<'m> {
    /// Of nothing yet.
    pub fn new(machine: &'m Machine) -> Self {
        let collision = machine.collision.as_ref();
        Self {
            machine,
            wanted: collision.map_or(0.0, |collision| collision.clearance) * 1e3,
            timeline: Timeline::new(2),
            least: None,
            hits: Vec::new(),
            hit_count: 0,
            in_hit: false,
        }
    }

    /// Takes the next set-point.
    pub fn include(&mut self, now: &BlockClearance) {
        let BlockClearance { place, nearest, .. } = *now;
        let (time_s, clearance) = (seconds(now.time_ns), nearest.distance * 1e3);
        let is_hit = now.is_collision();
        let values = [Some(clearance), is_hit.then_some(clearance)];
        self.timeline.push(time_s, place.line, &values, Some(self.kind(nearest.parts)));
        if self.least.is_none_or(|least| now.is_nearer_than(&least)) {
            self.least = Some(*now);
        }
        if is_hit && !self.in_hit {
            self.hit_count += 1;
            if self.hit_count <= MOST_HITS {
                self.hits.push(([time_s; 2], place));
            }
        } else if is_hit
            && self.hit_count <= MOST_HITS
            && let Some(([_, end], _)) = self.hits.last_mut()
        {
            *end = time_s;
        }
        self.in_hit = is_hit;
    }

    fn obstacles(&self) -> usize {
        let collision = self.machine.collision.as_ref();
        collision.map_or(0, |collision| collision.surroundings.obstacles.len())
    }

    /// Colours of the parts in the strip.
    fn kind(&self, parts: [Part; 2]) -> usize {
        let obstacle = parts.into_iter().find_map(|part| match part {
            Part::Obstacle(index) => Some(index),
            Part::Link(_) | Part::Tool | Part::Body(_) => None,
        });
        obstacle.unwrap_or_else(|| self.obstacles())
    }

    /// Draws the picture as SVG, of `program`, by its name.
    pub fn draw(&self, program: &str) -> String {
        let chart = Chart {
            title: format!("Clearance of {program} on {}", self.machine.name),
            subtitle: self.verdict(),
            across: self.timeline.across(),
            rows: self.rows(),
            strips: self.timeline.strips("what is nearest", Color::series),
            legend: self.legend(),
        };
        chart.svg()
    }

    /// Words below the title.
    fn verdict(&self) -> String {
        let [begin, end] = self.timeline.span();
        let least = self.least.map(|least| least.message(self.machine));
        let least = least.unwrap_or_else(|| "nothing moves".to_owned());
        let hits = match self.hit_count {
            0 => String::new(),
            1 => "; 1 collision".to_owned(),
            count => format!("; {count} collisions"),
        };
        format!("{:.3} s; {least}{hits}", end - begin)
    }

    /// All of it, and, where that would be seen badly, what is near.
    fn rows(&self) -> Vec<Row> {
        let values = self.timeline.curve(CLEARANCE).iter().map(|(_, value)| *value);
        let [low, high] = reach(values).unwrap_or_default();
        let range = |high: f64| [low.min(0.0) - 0.06 * (high - low.min(0.0)), high];
        let most = high.max(self.wanted).max(1e-3) * 1.15;
        let mut all = self.row("clearance", HEIGHTS[0], range(most));
        all.notes = self.notes();
        let labels = self.hits.iter().map(|([begin, end], place)| {
            Shape::Label(begin.midpoint(*end), place.to_string(), MARK)
        });
        all.shapes.extend(labels);
        if let Some(least) = &self.least {
            let label = if least.is_collision() { String::new() } else { least.place.to_string() };
            all.shapes.push(Shape::Mark(Mark {
                at: (seconds(least.time_ns), least.nearest.distance * 1e3),
                color: INK,
                label,
                side: Side::Below,
            }));
        }
        let near = NEAR * low.abs().max(self.wanted).max(0.25);
        if near * FAR > most {
            return vec![all];
        }
        vec![all, self.row("what is near", HEIGHTS[1], range(near))]
    }

    /// The grounds, the lines of what must not be, and the curve.
    fn row(&self, name: &str, height: f64, range: [f64; 2]) -> Row {
        let mut row = Row::new(name, "mm", height, range);
        row.shapes.push(Shape::Ground([0.0, self.wanted], AMBER));
        row.shapes.push(Shape::Ground([range[0], 0.0], ROSE));
        let hits = self.timeline.curve(HITS).split(|(_, value)| value.is_nan());
        let ends = hits.filter_map(|hit| Some([hit.first()?.0, hit.last()?.0]));
        row.shapes.push(Shape::Times(ends.collect(), MARK.with_opacity(0.18)));
        if self.wanted > 0.0 {
            row.shapes.push(Shape::Level(self.wanted, Stroke::dashed(WANTED, 1.1)));
        }
        row.shapes.push(Shape::Level(0.0, Stroke::solid(MARK, 1.2)));
        let curve = self.timeline.curve(CLEARANCE).to_vec();
        row.shapes.push(Shape::Line(curve, Stroke::solid(INK, 1.5)));
        row
    }

    /// What there is to say next to the curves.
    fn notes(&self) -> Vec<(String, Color)> {
        let mut notes = Vec::new();
        if let Some(least) = &self.least {
            let [one, other] = least.names(self.machine);
            let (distance, color, between) = if least.is_collision() {
                (format!("{:.3} mm deep", -least.nearest.distance * 1e3), MARK, ["", "in "])
            } else {
                let distance = least.nearest.distance.max(0.0) * 1e3;
                (format!("{distance:.3} mm"), INK, ["between ", "and "])
            };
            notes.push((format!("least: {distance}"), color));
            notes.push((format!("{}, {:.3} s", least.place, seconds(least.time_ns)), INK));
            notes.push((format!("{}{}", between[0], shortened(&one)), INK));
            notes.push((format!("{}{}", between[1], shortened(&other)), INK));
        }
        if self.wanted > 0.0 {
            notes.push((format!("wanted: {} mm", significant(self.wanted, 6)), WANTED));
        }
        notes
    }

    fn legend(&self) -> Legend {
        let mut legend = vec![(Sign::Line(Stroke::solid(INK, 2.2)), "clearance".to_owned())];
        if self.wanted > 0.0 {
            legend.push((Sign::Line(Stroke::dashed(WANTED, 1.4)), "wanted".to_owned()));
        }
        legend.push((Sign::Line(Stroke::solid(MARK, 2.2)), "what touches".to_owned()));
        if self.hit_count > 0 {
            legend.push((Sign::Patch(ROSE), "in each other".to_owned()));
        }
        legend.push((Sign::Ring(INK), "least clearance".to_owned()));
        let obstacles = self.obstacles();
        for kind in (0..=obstacles).filter(|kind| self.timeline.shows(*kind)) {
            let name = if kind < obstacles {
                self.machine.part_name(Part::Obstacle(kind))
            } else {
                "links to each other".to_owned()
            };
            legend.push((Sign::Patch(Color::series(kind)), shortened(&name)));
        }
        legend
    }
}

/// A name that finds room.
fn shortened(name: &str) -> String {
    if name.chars().count() <= NAME {
        return name.to_owned();
    }
    name.chars().take(NAME - 1).chain(['…']).collect()
}
