//! The picture of a path: seen from above, X to the right and Y upwards (the preview of manual 3.4 to 3.7).
//!
//! It is written as the elements pass: however long the path, memory holds a few marks and a piece of a line. For that the
//! box around all that will be drawn must be known first, as [`twin_gcode::info::ProgramInfo`] has it.

mod curves;
#[cfg(test)]
mod tests;

use curves::{place, point};
use nalgebra::Point3;
use std::io::{self, Write};
use twin_path::{Bounds, ElementKind, PathElement, Shape};
use twin_plot::{Color, Legend, Map, Point, Sheet, Sign, Stroke, short};

/// Arrows and other marks that are drawn at most; when there are more, every second one is left out.
const MOST_MARKS: usize = 400;
/// Arrows are at first this far apart along the path, pixels.
const ARROW_DISTANCE: f64 = 90.0;
/// An element gets an arrow only if it is longer than this, pixels.
const ARROW_ROOM: f64 = 14.0;
/// Crosses are this wide, pixels.
const CROSS: f64 = 5.0;
/// Letters of a line that are held before they are written.
const HELD: usize = 65_536;
/// The longer side of the drawing, pixels, and the least part of it that the shorter one is.
const SIDE: f64 = 1000.0;
const NARROWEST: f64 = 0.32;
/// Room between path and frame, as a part of the longer side.
const ROOM: f64 = 0.04;
/// Smallest size of a drawing, and largest distance, m; anything farther away is not drawn.
const SMALLEST: f64 = 1e-4;
const LARGEST: f64 = 1e6;

const ARROW: Color = Color::rgb(18, 50, 111);
const FUNCTION: Sign = Sign::Diamond(Color::rgb(240, 138, 0));
const SWITCH: Sign = Sign::Dot(Color::rgb(24, 176, 48));
const START: Sign = Sign::Ring(Color::rgb(204, 34, 34));
const END: Sign = Sign::Square(Color::rgb(204, 34, 34));
const HULL: Stroke = Stroke::solid(Color::rgb(204, 204, 204), 1.1);

/// What a line of the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    Before,
    Rapid,
    Cut,
    Probe,
    Jump,
    Cross,
}

impl Style {
    const ALL: [Self; 6] =
        [Self::Before, Self::Rapid, Self::Cut, Self::Probe, Self::Jump, Self::Cross];

    /// Its class in the file, its meaning, and how it is drawn.
    fn look(self) -> (&'static str, &'static str, Stroke) {
        let solid = |rgb: [u8; 3], width| Stroke::solid(Color::rgb(rgb[0], rgb[1], rgb[2]), width);
        match self {
            Self::Before => ("before", "before preparation", solid([187, 187, 187], 1.8)),
            Self::Rapid => {
                ("rapid", "rapid", Stroke { dash: Some([7.0, 5.0]), ..solid([22, 160, 44], 1.8) })
            }
            Self::Cut => ("cut", "cut", solid([31, 95, 214], 1.8)),
            Self::Probe => ("probe", "probing", solid([142, 36, 170], 1.8)),
            Self::Jump => (
                "jump",
                "set (G92)",
                Stroke { dash: Some([1.1, 5.0]), ..solid([153, 153, 153], 1.1) },
            ),
            Self::Cross => ("cross", "every 100 ms", solid([68, 68, 68], 1.1)),
        }
    }

    fn sign(self) -> Sign {
        let (.., stroke) = self.look();
        if self == Self::Cross { Sign::Cross(stroke.color) } else { Sign::Line(stroke) }
    }
}

/// Writes the picture of a path, and of what it was before preparation.
///
/// Draw what lies below first: [`Self::before`] the path as programmed, then [`Self::element`] the path as it is
/// travelled, then [`Self::cross`] where the tool is every 100 ms.
#[derive(Debug)]
pub(super) struct Picture<W> {
    out: W,
    map: Map,
    /// The line that is being drawn, and the place at which it ends.
    line: Option<(Style, Point)>,
    commands: String,
    start: Option<Point>,
    end: Option<Point>,
    arrows: Marks<(Point, Point)>,
    /// Length since the last arrow, m.
    since_arrow: f64,
    arrow_distance: f64,
    functions: Marks<Point>,
    switches: Marks<Point>,
    hulls: Marks<Vec<Point>>,
    used: Vec<Style>,
}

/// As many marks as are good to look at.
#[derive(Debug)]
struct Marks<T> {
    kept: Vec<T>,
    /// One of so many is kept.
    every: u64,
    seen: u64,
}

impl<T> Marks<T> {
    fn new() -> Self {
        Self { kept: Vec::new(), every: 1, seen: 0 }
    }

    /// True if it thinned them out.
    fn add(&mut self, mark: T) -> bool {
        let wanted = self.seen.is_multiple_of(self.every);
        self.seen += 1;
        if !wanted {
            return false;
        }
        self.kept.push(mark);
        if self.kept.len() < MOST_MARKS {
            return false;
        }
        let mut keep = false;
        self.kept.retain(|_| {
            keep = !keep;
            keep
        });
        self.every *= 2;
        true
    }
}

impl<W: Write> Picture<W> {
    /// Begins a picture of the area within `bounds`; empty without bounds.
    pub(super) fn new(out: W, bounds: Option<Bounds>, title: &str) -> Self {
        let map = map(bounds, title);
        let arrow_distance = map.mm(ARROW_DISTANCE) * 1e-3;
        Self {
            out,
            map,
            line: None,
            commands: String::new(),
            start: None,
            end: None,
            arrows: Marks::new(),
            // The first arrow comes soon.
            since_arrow: arrow_distance,
            arrow_distance,
            functions: Marks::new(),
            switches: Marks::new(),
            hulls: Marks::new(),
            used: Vec::new(),
        }
    }

    /// Draws an element of the path before preparation.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn before(&mut self, element: &PathElement) -> io::Result<()> {
        if element.kind.is_motion() { self.draw(Style::Before, element) } else { Ok(()) }
    }

    /// Draws an element of the path.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn element(&mut self, element: &PathElement) -> io::Result<()> {
        self.start.get_or_insert(point(&element.start()));
        self.end = Some(point(&element.end()));
        let style = match element.kind {
            ElementKind::Rapid => Style::Rapid,
            ElementKind::Cut => Style::Cut,
            ElementKind::Probe { .. } => Style::Probe,
            ElementKind::Jump => Style::Jump,
            ElementKind::MFunction { .. } => {
                self.functions.add(point(&element.start()));
                return Ok(());
            }
            ElementKind::Dwell { .. } => return Ok(()),
        };
        let length = element.shape.length();
        for switch in element.switches() {
            self.switches.add(point(&element.shape.at(switch.at * length).position));
        }
        if let Shape::Cubic(cubic) = &element.shape {
            let hull = curves::convex_hull(cubic);
            if hull.len() > 2 {
                self.hulls.add(hull);
            }
        }
        if element.kind.is_motion() {
            self.arrow(element, length);
        }
        self.draw(style, element)
    }

    /// Marks a place of the tool.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn cross(&mut self, at: &Point3<f64>) -> io::Result<()> {
        let ((x, y), reach) = (point(at), self.map.mm(CROSS / 2.0));
        for rise in [-reach, reach] {
            let to = (x + reach, y + rise);
            self.go_to(Style::Cross, (x - reach, y - rise))?;
            self.commands += "L";
            self.commands += &place(to);
            self.line = Some((Style::Cross, to));
        }
        Ok(())
    }

    /// Draws the marks and the legend, and gives back what was written to.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn finish(mut self) -> io::Result<W> {
        self.close()?;
        let Self { mut out, mut map, arrows, functions, switches, hulls, start, end, used, .. } =
            self;
        let mut legend = styles(|style| used.contains(&style));
        let marks = [
            (Sign::Line(HULL), "hull of a spline", hulls.kept.is_empty()),
            (FUNCTION, "M function", functions.kept.is_empty()),
            (SWITCH, "switch", switches.kept.is_empty()),
            (START, "start", start.is_none()),
            (END, "end", end.is_none()),
        ];
        let marks = marks.into_iter().filter(|(.., is_missing)| !is_missing);
        legend.extend(marks.map(|(sign, word, _)| (sign, word.to_owned())));
        for hull in hulls.kept {
            map.area("hull", &[hull], HULL);
        }
        for (at, way) in arrows.kept {
            map.head(at, way, ARROW);
        }
        let functions = functions.kept.into_iter().map(|at| (at, FUNCTION));
        let switches = switches.kept.into_iter().map(|at| (at, SWITCH));
        let ends = end.map(|at| (at, END)).into_iter().chain(start.map(|at| (at, START)));
        for (at, sign) in functions.chain(switches).chain(ends) {
            map.sign(at, sign);
        }
        out.write_all(map.finish(&legend).as_bytes())?;
        out.flush()?;
        Ok(out)
    }

    fn arrow(&mut self, element: &PathElement, length: f64) {
        self.since_arrow += length;
        if self.since_arrow < self.arrow_distance || length * 1e3 < self.map.mm(ARROW_ROOM) {
            return;
        }
        let middle = element.shape.at(length / 2.0);
        let way = (middle.tangent.x, middle.tangent.y);
        // Straight up or down is nowhere in this picture.
        if way.0.hypot(way.1) > 0.5 {
            self.since_arrow = 0.0;
            if self.arrows.add((point(&middle.position), way)) {
                self.arrows.every = 1;
                self.arrow_distance *= 2.0;
            }
        }
    }

    fn draw(&mut self, style: Style, element: &PathElement) -> io::Result<()> {
        self.go_to(style, point(&element.start()))?;
        for (command, end) in curves::commands(&element.shape) {
            self.commands.push_str(&command);
            self.line = Some((style, end));
        }
        Ok(())
    }

    /// Begins or goes on with a line of `style` at `start`.
    fn go_to(&mut self, style: Style, start: Point) -> io::Result<()> {
        if self.line.is_none_or(|(present, _)| present != style) || self.commands.len() > HELD {
            self.close()?;
        }
        if self.line.is_none_or(|(_, at)| at != start) {
            self.commands += "M";
            self.commands += &place(start);
            self.line = Some((style, start));
        }
        if !self.used.contains(&style) {
            self.used.push(style);
        }
        Ok(())
    }

    fn close(&mut self) -> io::Result<()> {
        if let Some((style, _)) = self.line.take() {
            let (class, _, stroke) = style.look();
            self.map.path(class, &self.commands, stroke);
            self.commands.clear();
        }
        self.out.write_all(self.map.take().as_bytes())
    }
}

/// Styles with their meaning.
fn styles(is_wanted: impl Fn(Style) -> bool) -> Legend {
    let wanted = Style::ALL.into_iter().filter(|style| is_wanted(*style));
    wanted.map(|style| (style.sign(), style.look().1.to_owned())).collect()
}

/// A map with room around the box.
fn map(bounds: Option<Bounds>, title: &str) -> Map {
    let fits = |bounds: &Bounds| {
        bounds.min.iter().chain(bounds.max.iter()).all(|metres| metres.abs() <= LARGEST)
    };
    let bounds = bounds.filter(fits);
    let corners = bounds
        .map_or([(0.0, 0.0), (100.0, 100.0)], |bounds| [point(&bounds.min), point(&bounds.max)]);
    let [low, high] = corners;
    let longer = (high.0 - low.0).max(high.1 - low.1).max(SMALLEST * 1e3);
    let sides = |low: f64, high: f64| {
        let half = (high - low + 2.0 * ROOM * longer).max(longer * NARROWEST) / 2.0;
        [low.midpoint(high) - half, low.midpoint(high) + half]
    };
    let ([left, right], [front, back]) = (sides(low.0, high.0), sides(low.1, high.1));
    let size = bounds.map_or_else(
        || "no path".to_owned(),
        |bounds| {
            let [x, y, z] = bounds.size().map(|metres| short(metres * 1e3));
            format!("{x} × {y} × {z} mm (X × Y × Z)")
        },
    );
    // Room for every word that there may be.
    let mut legend = styles(|_| true);
    let marks = ["hull of a spline", "M function", "switch", "start", "end"];
    legend.extend(marks.map(|word| (START, word.to_owned())));
    Map::new(&Sheet {
        title,
        subtitle: &size,
        names: ["X (mm)", "Y (mm)"],
        range: [(left, front), (right, back)],
        largest: (SIDE, SIDE),
        scale: None,
        legend: &legend,
    })
}
