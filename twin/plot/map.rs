//! Maps: paths, regions and marks at equal scale, in mm.

use super::Point;
use super::color::{BACK, Color, FAINT, GRID, INK, Paint, Stroke};
use super::page::{self, Head, Legend, Sign};
use super::svg::{Anchor, Svg, number};
use super::ticks::{short, ticks};

/// Room left of the map, to its right, and for the numbers below it, pixels.
const LEFT: f64 = 76.0;
const RIGHT: f64 = 24.0;
const NUMBERS: f64 = 50.0;
/// Room for a scale of colours, pixels.
const SCALE: f64 = 106.0;
/// The scale is at least this high, pixels.
const LOWEST: f64 = 150.0;
/// The page is at least this wide, pixels: title and legend need it.
const NARROWEST: f64 = 780.0;
/// Lines of the grid are about this far apart, pixels.
const APART: f64 = 52.0;
/// Bends of lines that are not seen, pixels.
const UNSEEN: f64 = 0.15;

/// A scale of colours in equal steps from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// The quantity.
    pub name: String,
    /// From 0 on.
    pub colors: Vec<Color>,
    /// Size of the step of each colour.
    pub step: f64,
}

/// Titles, range and legend of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet<'a> {
    /// Title.
    pub title: &'a str,
    /// Subtitle, in smaller letters.
    pub subtitle: &'a str,
    /// Names of the coordinates.
    pub names: [&'a str; 2],
    /// Lowest and highest coordinates, mm.
    pub range: [Point; 2],
    /// The map is at most this large, pixels.
    pub largest: Point,
    /// Next to it.
    pub scale: Option<Scale>,
    /// Every sign that may be in the legend: there is room for them.
    pub legend: &'a [(Sign, String)],
}

/// A map that is being drawn.
#[derive(Debug)]
pub struct Map {
    svg: Svg,
    /// Lowest coordinates, mm.
    low: Point,
    /// Its top left corner on the page and its size, pixels.
    corner: Point,
    size: Point,
    page: Point,
    /// Pixels per mm.
    scale: f64,
    /// True if elements are in mm, Y upwards; otherwise in pixels.
    is_world: bool,
}

impl Map {
    /// An empty map.
    pub fn new(sheet: &Sheet<'_>) -> Self {
        let [low, high] = sheet.range;
        let sides = (high.0 - low.0, high.1 - low.1);
        let scale = (sheet.largest.0 / sides.0).min(sheet.largest.1 / sides.1);
        let size = (sides.0 * scale, sides.1 * scale);
        let right = if sheet.scale.is_some() { SCALE } else { RIGHT };
        let width = (LEFT + size.0 + right).max(NARROWEST);
        let head = Head::new(sheet.title, sheet.subtitle, width - LEFT - 12.0);
        let top = head.height();
        let bar = if sheet.scale.is_some() { size.1.max(LOWEST) } else { size.1 };
        let legend = page::legend_places(sheet.legend, width - LEFT - 12.0).1;
        let page = (width, top + bar + NUMBERS + legend + 6.0);
        let mut svg = Svg::default();
        svg.open(page, sheet.title);
        head.draw(&mut svg, (LEFT, 0.0));
        let corner = (LEFT, top);
        let mut map = Self { svg, low, corner, size, page, scale, is_world: false };
        map.grid(sheet, high);
        if let Some(scale) = &sheet.scale {
            map.colors(scale, bar);
        }
        map.svg.open_window(corner, size);
        map
    }

    fn grid(&mut self, sheet: &Sheet<'_>, high: Point) {
        let (low, corner, size) = (self.low, self.corner, self.size);
        let bottom = corner.1 + size.1;
        let style = |at: f64| Stroke::solid(if at == 0.0 { FAINT } else { GRID }, 0.8);
        for (at, text) in ticks(low.0, high.0, (size.0 / APART).max(2.0)) {
            let (x, _) = self.pixels((at, 0.0));
            self.svg.line((x, corner.1), (x, bottom), style(at));
            self.svg.line((x, bottom), (x, bottom + 4.0), Stroke::solid(FAINT, 0.8));
            self.svg.text((x, bottom + 13.0), page::TEXT, INK, Anchor::Middle, &text);
        }
        for (at, text) in ticks(low.1, high.1, (size.1 / APART).max(2.0)) {
            let (_, y) = self.pixels((0.0, at));
            self.svg.line((corner.0, y), (corner.0 + size.0, y), style(at));
            self.svg.line((corner.0 - 4.0, y), (corner.0, y), Stroke::solid(FAINT, 0.8));
            self.svg.text((corner.0 - 7.0, y), page::TEXT, INK, Anchor::End, &text);
        }
        let [across, up] = sheet.names;
        let middle = (corner.0 + size.0 / 2.0, bottom + 33.0);
        self.svg.text(middle, 14.5, INK, Anchor::Middle, across);
        self.svg.text((17.0, corner.1 + size.1 / 2.0), 14.5, INK, Anchor::Upwards, up);
    }

    /// The scale of colours, to the right of the map.
    fn colors(&mut self, scale: &Scale, height: f64) {
        let (left, top) = (self.page.0 - 84.0, self.corner.1);
        let right = left + 20.0;
        let count = scale.colors.iter().fold(0.0, |count, _| count + 1.0);
        let mut y = top + height;
        let mut steps = Vec::new();
        for color in &scale.colors {
            steps.push(y);
            self.svg.rectangle((left, y - height / count), (right, y), *color);
            y -= height / count;
        }
        steps.push(top);
        self.svg.rectangle((left, top), (right, top + height), Stroke::solid(FAINT, 0.8));
        // As many numbers as find room; 0 is among them.
        let every =
            [1, 2, 4, 5, 10].into_iter().find(|every| height / count * f64::from(*every) >= 26.0);
        let every = usize::try_from(every.unwrap_or(20)).unwrap_or(20);
        for (number, y) in (0_u32..).zip(steps).step_by(every) {
            self.svg.line((right, y), (right + 4.0, y), Stroke::solid(FAINT, 0.8));
            let text = short(f64::from(number) * scale.step);
            self.svg.text((right + 7.0, y), page::TEXT, INK, Anchor::Start, &text);
        }
        let middle = (self.page.0 - 14.0, top + height / 2.0);
        self.svg.text(middle, 14.5, INK, Anchor::Upwards, &scale.name);
    }

    /// Position on the page of a place in mm, pixels.
    pub fn pixels(&self, at: Point) -> Point {
        (
            self.corner.0 + (at.0 - self.low.0) * self.scale,
            self.corner.1 + self.size.1 - (at.1 - self.low.1) * self.scale,
        )
    }

    /// Length of `pixels` on the map, mm.
    pub fn mm(&self, pixels: f64) -> f64 {
        pixels / self.scale
    }

    fn write_in(&mut self, is_world: bool) {
        if is_world == self.is_world {
            return;
        }
        self.is_world = is_world;
        if is_world {
            let (x, y) = self.pixels((0.0, 0.0));
            let (x, y, scale) = (number(x), number(y), self.scale);
            self.svg.add(format_args!(
                r#"<g transform="translate({x} {y}) scale({scale:.9} -{scale:.9})">"#
            ));
        } else {
            self.svg.add(format_args!("</g>"));
        }
    }

    /// Draws SVG commands in mm, Y upwards. `class` names what they show.
    pub fn path(&mut self, class: &str, commands: &str, paint: impl Into<Paint>) {
        self.write_in(true);
        self.svg.path(class, commands, paint.into(), self.scale);
    }

    /// Draws a line through places in mm, without bends that are not seen.
    pub fn line(&mut self, class: &str, line: &[Point], stroke: Stroke) {
        let commands = commands(&straightened(line, self.mm(UNSEEN)));
        self.path(class, &commands, stroke);
    }

    /// Fills what closed lines, in mm, go around.
    pub fn area(&mut self, class: &str, loops: &[Vec<Point>], paint: impl Into<Paint>) {
        let tolerance = self.mm(UNSEEN);
        let closed = |one: &Vec<Point>| {
            let mut all: Vec<_> = one.iter().chain(one.first()).copied().collect();
            all = straightened(&all, tolerance);
            all.pop();
            commands(&all) + "Z"
        };
        let commands: String = loops.iter().filter(|one| one.len() > 2).map(closed).collect();
        if !commands.is_empty() {
            self.path(class, &commands, paint);
        }
    }

    /// Draws a sign at a place in mm.
    pub fn sign(&mut self, at: Point, sign: Sign) {
        self.write_in(false);
        let at = self.pixels(at);
        sign.draw(&mut self.svg, at);
    }

    /// Draws a filled arrow head at a place in mm, pointing this way.
    pub fn head(&mut self, at: Point, way: Point, color: Color) {
        self.write_in(false);
        let (at, size) = (self.pixels(at), way.0.hypot(way.1));
        // On the page Y points downwards.
        let (x, y) = (way.0 / size, -way.1 / size);
        let corner = |along: f64, aside: f64| {
            let [x, y] = [at.0 + along * x - aside * y, at.1 + along * y + aside * x].map(number);
            format!("{x} {y}")
        };
        let [tip, left, right] = [corner(7.5, 0.0), corner(-5.0, 4.6), corner(-5.0, -4.6)];
        self.svg.path("arrow", &format!("M{tip}L{left}L{right}Z"), color.into(), 1.0);
    }

    /// Draws an arrow of this length in pixels, with a word at its end.
    pub fn arrow(&mut self, from: Point, way: Point, length: f64, color: Color, word: &str) {
        let size = way.0.hypot(way.1);
        let at = |pixels: f64| {
            let part = self.mm(pixels) / size;
            (from.0 + way.0 * part, from.1 + way.1 * part)
        };
        let (end, beyond) = (at(length), at(length + 19.0));
        let line = [from, end];
        self.line("", &line, Stroke::solid(color, 1.8));
        self.head(end, way, color);
        let place = self.pixels(beyond);
        self.svg.text(place, 15.0, color, Anchor::Middle, word);
    }

    /// Takes the text drawn since the last call: a picture may be longer than memory.
    pub fn take(&mut self) -> String {
        self.svg.take()
    }

    /// Draws the frame and the legend; gives back what has not been taken yet.
    pub fn finish(mut self, legend: &Legend) -> String {
        self.write_in(false);
        self.svg.close();
        let (corner, size) = (self.corner, self.size);
        let end = (corner.0 + size.0, corner.1 + size.1);
        self.svg.rectangle(corner, end, Stroke::solid(BACK, 0.8));
        let (places, height) = page::legend_places(legend, self.page.0 - LEFT - 12.0);
        if !places.is_empty() {
            let top = self.page.1 - height + 6.0;
            page::legend(&mut self.svg, legend, (LEFT, top), self.page.0 - LEFT - 12.0);
        }
        self.svg.close();
        self.svg.take()
    }
}

fn commands(line: &[Point]) -> String {
    let places = line.iter().map(|(x, y)| format!("{} {}", number(*x), number(*y)));
    format!("M{}", places.collect::<Vec<_>>().join("L"))
}

/// Points of a line within `tolerance` of all its points (Douglas and Peucker 1973).
fn straightened(line: &[Point], tolerance: f64) -> Vec<Point> {
    let [first, between @ .., last] = line else { return line.to_vec() };
    let chord = (last.0 - first.0, last.1 - first.1);
    let length = chord.0.hypot(chord.1);
    let off = |point: &Point| {
        let way = (point.0 - first.0, point.1 - first.1);
        if length > tolerance {
            (chord.0 * way.1 - chord.1 * way.0).abs() / length
        } else {
            way.0.hypot(way.1)
        }
    };
    let farthest =
        between.iter().map(off).enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
    let Some((index, _)) = farthest.filter(|(_, distance)| *distance > tolerance) else {
        return vec![*first, *last];
    };
    let (before, after) = line.split_at(index + 1);
    let [bend, ..] = after else { return line.to_vec() };
    let mut kept = straightened(&[before, &[*bend]].concat(), tolerance);
    kept.pop();
    kept.extend(straightened(after, tolerance));
    kept
}

/// Convex hull, counter-clockwise (Andrew's monotone chain); fewer than three corners if collinear.
pub fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1)));
    let mut hull = half_hull(points.iter());
    hull.extend(half_hull(points.iter().rev()));
    hull
}

/// From the first to the last of `points`, always turning left; without the last one, with which the other half begins.
fn half_hull<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut hull: Vec<Point> = Vec::new();
    for point in points {
        while let [.., one, other] = hull.as_slice()
            && (other.0 - one.0) * (point.1 - one.1) <= (other.1 - one.1) * (point.0 - one.0)
        {
            hull.pop();
        }
        hull.push(*point);
    }
    hull.pop();
    hull
}
