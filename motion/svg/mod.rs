//! Pictures of paths as SVG: seen from above, X to the right and Y upwards (the preview of manual 3.4 to 3.7).
//!
//! The picture is written as the elements pass, so however long the path no more than a few marks are held. For that
//! its frame must be known first: the box around all that will be drawn, as [`crate::info::ProgramInfo`] has it.
//! (Which is why this is no document tree of the `svg` crate.)

mod curves;
mod page;
#[cfg(test)]
mod tests;

use crate::path::{Bounds, ElementKind, PathElement, Shape};
use curves::Point;
use nalgebra::Point3;
use page::{Page, escaped};
use std::io::{self, Write};

/// Arrows and other marks that are drawn at most; when there are more, every second one is left out.
const MOST_MARKS: usize = 400;
/// Arrows are at first this far apart along the path, pixels.
const ARROW_DISTANCE: f64 = 90.0;
/// An element gets an arrow only if it is longer than this, pixels.
const ARROW_ROOM: f64 = 14.0;
/// Crosses are this wide, pixels.
const CROSS: f64 = 5.0;

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
    fn class(self) -> &'static str {
        match self {
            Self::Before => "before",
            Self::Rapid => "rapid",
            Self::Cut => "cut",
            Self::Probe => "probe",
            Self::Jump => "jump",
            Self::Cross => "cross",
        }
    }
}

/// Writes the picture of a path, and of what it was before preparation: rapids in green dashes, cuts in blue, probing moves in violet, the path
/// before it in light grey below, M functions as orange diamonds, switches as green dots, the convex hulls of splines in
/// light grey, start and end, arrows in the direction of travel, and a grid in mm.
///
/// Draw what lies below first: [`Self::before`] the path as programmed, then [`Self::element`] the path as it is
/// travelled, then [`Self::cross`] where the tool is every 100 ms.
#[derive(Debug)]
pub struct Picture<W> {
    out: W,
    page: Page,
    /// The line that is being written, and the point at which it ends.
    line: Option<(Style, Point)>,
    /// Commands on the present line of text.
    commands: u32,
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
    /// Begins a picture of what is within `bounds`; nothing at all if there are none.
    ///
    /// # Errors
    /// What `out` says.
    pub fn new(mut out: W, bounds: Option<Bounds>, title: &str) -> io::Result<Self> {
        let page = Page::new(bounds);
        page.begin(&mut out, &escaped(title))?;
        let arrow_distance = page.metres(ARROW_DISTANCE);
        Ok(Self {
            out,
            page,
            line: None,
            commands: 0,
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
        })
    }

    /// Draws an element of the path before preparation.
    ///
    /// # Errors
    /// What the file says.
    pub fn before(&mut self, element: &PathElement) -> io::Result<()> {
        if element.kind.is_motion() { self.draw(Style::Before, element) } else { Ok(()) }
    }

    /// Draws an element of the path.
    ///
    /// # Errors
    /// What the file says.
    pub fn element(&mut self, element: &PathElement) -> io::Result<()> {
        self.start.get_or_insert(curves::point(&element.start()));
        self.end = Some(curves::point(&element.end()));
        let style = match element.kind {
            ElementKind::Rapid => Style::Rapid,
            ElementKind::Cut => Style::Cut,
            ElementKind::Probe { .. } => Style::Probe,
            ElementKind::Jump => Style::Jump,
            ElementKind::MFunction { .. } => {
                self.functions.add(curves::point(&element.start()));
                return Ok(());
            }
            ElementKind::Dwell { .. } => return Ok(()),
        };
        let length = element.shape.length();
        for switch in element.switches() {
            self.switches.add(curves::point(&element.shape.at(switch.at * length).position));
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
    /// What the file says.
    pub fn cross(&mut self, place: &Point3<f64>) -> io::Result<()> {
        let (Point { x, y }, reach) = (curves::point(place), self.page.metres(CROSS / 2.0) * 1e3);
        for [from, to] in [[(-reach, -reach), (reach, reach)], [(-reach, reach), (reach, -reach)]] {
            let from = Point { x: x + from.0, y: y + from.1 };
            let to = Point { x: x + to.0, y: y + to.1 };
            self.go_to(Style::Cross, from)?;
            self.command(&format!("L{to}"), to)?;
        }
        Ok(())
    }

    /// Draws the marks and the legend, and gives back what was written to.
    ///
    /// # Errors
    /// What it says.
    pub fn finish(mut self) -> io::Result<W> {
        self.close()?;
        let Self { mut out, page, arrows, functions, switches, hulls, start, end, used, .. } = self;
        let ends = [start, end];
        page::hulls(&mut out, &hulls.kept)?;
        page.marks(&mut out, &arrows.kept, &functions.kept, &switches.kept, ends)?;
        let mut legend: Vec<_> = [
            (Style::Before, "before preparation"),
            (Style::Rapid, "rapid"),
            (Style::Cut, "cut"),
            (Style::Probe, "probing"),
            (Style::Jump, "set (G92)"),
            (Style::Cross, "every 100 ms"),
        ]
        .into_iter()
        .filter(|(style, _)| used.contains(style))
        .map(|(style, text)| (style.class(), text))
        .collect();
        if !hulls.kept.is_empty() {
            legend.push(("hull", "hull of a spline"));
        }
        if !functions.kept.is_empty() {
            legend.push(("function", "M function"));
        }
        if !switches.kept.is_empty() {
            legend.push(("switch", "switch"));
        }
        page.end(&mut out, &legend)?;
        out.flush()?;
        Ok(out)
    }

    fn arrow(&mut self, element: &PathElement, length: f64) {
        self.since_arrow += length;
        if self.since_arrow < self.arrow_distance || length < self.page.metres(ARROW_ROOM) {
            return;
        }
        let middle = element.shape.at(length / 2.0);
        let (x, y) = (middle.tangent.x, middle.tangent.y);
        // Straight up or down is nowhere in this picture.
        if x.hypot(y) > 0.5 {
            self.since_arrow = 0.0;
            if self.arrows.add((curves::point(&middle.position), Point { x, y })) {
                self.arrows.every = 1;
                self.arrow_distance *= 2.0;
            }
        }
    }

    fn draw(&mut self, style: Style, element: &PathElement) -> io::Result<()> {
        self.go_to(style, curves::point(&element.start()))?;
        for (command, end) in curves::commands(&element.shape) {
            self.command(&command, end)?;
        }
        Ok(())
    }

    /// Begins or goes on with a line of `style` at `start`.
    fn go_to(&mut self, style: Style, start: Point) -> io::Result<()> {
        match self.line {
            Some((present, at)) if present == style => {
                if at != start {
                    self.command(&format!("M{start}"), start)?;
                }
                return Ok(());
            }
            Some(_) => self.close()?,
            None => {}
        }
        if !self.used.contains(&style) {
            self.used.push(style);
        }
        write!(self.out, "<path class=\"{}\" d=\"M{start}", style.class())?;
        self.line = Some((style, start));
        self.commands = 0;
        Ok(())
    }

    fn command(&mut self, command: &str, end: Point) -> io::Result<()> {
        self.commands += 1;
        if self.commands.is_multiple_of(8) {
            writeln!(self.out)?;
        }
        write!(self.out, "{command}")?;
        if let Some((_, at)) = &mut self.line {
            *at = end;
        }
        Ok(())
    }

    fn close(&mut self) -> io::Result<()> {
        if self.line.take().is_some() {
            writeln!(self.out, "\"/>")?;
        }
        Ok(())
    }
}
