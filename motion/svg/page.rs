//! The page around the path: frame, grid, marks, legend.

use super::curves::{Point, number};
use crate::path::Bounds;
use nalgebra::Point3;
use std::io::{self, Write};

/// The longer side of the drawing, pixels.
const SIDE: f64 = 1000.0;
/// The shorter side is at least this, so that title and legend find room.
const SHORTEST: f64 = 320.0;
/// Room around it for title, labels and legend, pixels: left, top, right, bottom.
const MARGINS: [f64; 4] = [64.0, 56.0, 24.0, 64.0];
/// Free room between path and frame, as a part of its size.
const ROOM: f64 = 0.04;
/// Smallest size of what is drawn, m.
const SMALLEST: f64 = 1e-4;
/// Largest size, m; what is farther away than this is not seen.
const LARGEST: f64 = 1e6;
/// Lines of the grid along the longer side, about.
const GRID_LINES: f64 = 10.0;

/// How the work is laid on the page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Page {
    /// Lower left corner of the drawing, mm.
    corner: Point,
    /// Its sides, mm.
    sides: Point,
    /// Pixels per mm.
    scale: f64,
    /// What the title says of the size: sides of the path's box, mm.
    size_mm: Option<[f64; 3]>,
}

impl Page {
    pub(super) fn new(bounds: Option<Bounds>) -> Self {
        let fits = |bounds: &Bounds| {
            let all = bounds.min.iter().chain(bounds.max.iter());
            all.into_iter().all(|metres| metres.abs() <= LARGEST)
        };
        let bounds = bounds.filter(fits);
        let frame =
            bounds.unwrap_or(Bounds { min: Point3::origin(), max: Point3::new(0.1, 0.1, 0.0) });
        let [width, height, _] = frame.size();
        let longer = width.max(height).max(SMALLEST);
        // Not thinner than its title.
        let (width, height) = (
            (width + 2.0 * ROOM * longer).max(longer * SHORTEST / SIDE),
            (height + 2.0 * ROOM * longer).max(longer * SHORTEST / SIDE),
        );
        let middle = nalgebra::center(&frame.min, &frame.max);
        let (width, height) = (width * 1e3, height * 1e3);
        Self {
            corner: Point { x: middle.x * 1e3 - width / 2.0, y: middle.y * 1e3 - height / 2.0 },
            sides: Point { x: width, y: height },
            scale: SIDE / width.max(height),
            size_mm: bounds.map(|bounds| bounds.size().map(|metres| metres * 1e3)),
        }
    }

    /// So many pixels, m.
    pub(super) fn metres(&self, pixels: f64) -> f64 {
        pixels / self.scale / 1e3
    }

    /// Where a point in mm is on the page, pixels from the top left.
    pub(super) fn pixels(&self, at: Point) -> Point {
        let [left, top, ..] = MARGINS;
        Point {
            x: left + (at.x - self.corner.x) * self.scale,
            y: top + (self.corner.y + self.sides.y - at.y) * self.scale,
        }
    }

    /// Width and height of the page, pixels.
    pub(super) fn size(&self) -> Point {
        let [left, top, right, bottom] = MARGINS;
        Point {
            x: left + self.sides.x * self.scale + right,
            y: top + self.sides.y * self.scale + bottom,
        }
    }

    /// Everything up to the path. `title` is escaped.
    pub(super) fn begin(&self, out: &mut impl Write, title: &str) -> io::Result<()> {
        let (page, scale) = (self.size(), self.scale);
        let [width, height] = [page.x, page.y].map(number);
        // Lines are in mm, like the path: so many pixels of it.
        let line = |pixels: f64| format!("{:.6}", pixels / scale);
        let (thin, fine, dash, gap) = (line(1.8), line(1.1), line(7.0), line(5.0));
        writeln!(
            out,
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="sans-serif">
<title>{title}</title>
<style>
.before,.rapid,.cut,.probe,.jump,.cross,.hull{{fill:none;stroke-linejoin:round;stroke-linecap:round;stroke-width:{thin}}}
.before{{stroke:#bbb}}
.rapid{{stroke:#16a02c;stroke-dasharray:{dash} {gap};stroke-linecap:butt}}
.cut{{stroke:#1f5fd6}}
.probe{{stroke:#8e24aa}}
.jump{{stroke:#999;stroke-dasharray:{fine} {gap};stroke-width:{fine}}}
.cross{{stroke:#444;stroke-width:{fine}}}
.hull{{stroke:#ccc;stroke-width:{fine}}}
.grid{{stroke:#e8e8ee}}.axis{{stroke:#b4b4c0}}.frame{{fill:none;stroke:#8a8a98}}
.label{{fill:#666;font-size:12px}}
.arrow{{fill:#12326f}}.function{{fill:#f08a00}}.switch{{fill:#18b030}}
.sample{{stroke-width:2}}.sample.rapid{{stroke-dasharray:6 4}}.sample.jump{{stroke-dasharray:1 4}}
</style>
<rect width="{width}" height="{height}" fill="#fff"/>"##
        )?;
        let [left, ..] = MARGINS.map(number);
        writeln!(out, r##"<text x="{left}" y="26" font-size="18" fill="#222">{title}</text>"##)?;
        let size = match self.size_mm {
            Some([x, y, z]) => format!("{} × {} × {} mm (X × Y × Z)", short(x), short(y), short(z)),
            None => "no path".to_owned(),
        };
        writeln!(out, r#"<text class="label" x="{left}" y="45">{size}</text>"#)?;
        self.grid(out)?;
        let origin = self.pixels(Point { x: 0.0, y: 0.0 });
        let frame = self.frame();
        writeln!(
            out,
            "<clipPath id=\"frame\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>",
            number(frame[0].x),
            number(frame[0].y),
            number(frame[1].x - frame[0].x),
            number(frame[1].y - frame[0].y)
        )?;
        writeln!(
            out,
            "<g clip-path=\"url(#frame)\"><g transform=\"translate({} {}) scale({scale:.9} -{scale:.9})\">",
            number(origin.x),
            number(origin.y)
        )
    }

    /// Top left and bottom right corner of the drawing, pixels.
    fn frame(&self) -> [Point; 2] {
        let top_left = Point { x: self.corner.x, y: self.corner.y + self.sides.y };
        let bottom_right = Point { x: self.corner.x + self.sides.x, y: self.corner.y };
        [self.pixels(top_left), self.pixels(bottom_right)]
    }

    fn grid(&self, out: &mut impl Write) -> io::Result<()> {
        let step = step(self.sides.x.max(self.sides.y) / GRID_LINES);
        let [top_left, bottom_right] = self.frame();
        let class = |at: f64| if at == 0.0 { "axis" } else { "grid" };
        for at in ticks(self.corner.x, self.sides.x, step) {
            let x = number(self.pixels(Point { x: at, y: 0.0 }).x);
            let (top, bottom) = (number(top_left.y), number(bottom_right.y));
            writeln!(
                out,
                r#"<path class="{}" d="M{x} {top}V{bottom}"/><text class="label" x="{x}" y="{}" text-anchor="middle">{}</text>"#,
                class(at),
                number(bottom_right.y + 16.0),
                short(at)
            )?;
        }
        for at in ticks(self.corner.y, self.sides.y, step) {
            let y = self.pixels(Point { x: 0.0, y: at }).y;
            let (left, right) = (number(top_left.x), number(bottom_right.x));
            writeln!(
                out,
                r#"<path class="{}" d="M{left} {}H{right}"/><text class="label" x="{}" y="{}" text-anchor="end">{}</text>"#,
                class(at),
                number(y),
                number(top_left.x - 6.0),
                number(y + 4.0),
                short(at)
            )?;
        }
        writeln!(
            out,
            r#"<rect class="frame" x="{}" y="{}" width="{}" height="{}"/>"#,
            number(top_left.x),
            number(top_left.y),
            number(bottom_right.x - top_left.x),
            number(bottom_right.y - top_left.y)
        )
    }

    /// What lies on the path.
    pub(super) fn marks(
        &self,
        out: &mut impl Write,
        arrows: &[(Point, Point)],
        functions: &[Point],
        switches: &[Point],
        [start, end]: [Option<Point>; 2],
    ) -> io::Result<()> {
        writeln!(out, "</g>")?;
        for (at, direction) in arrows {
            let (at, size) = (self.pixels(*at), direction.x.hypot(direction.y));
            // On the page Y points downwards.
            let (x, y) = (direction.x / size, -direction.y / size);
            let corner = |along: f64, aside: f64| Point {
                x: at.x + along * x - aside * y,
                y: at.y + along * y + aside * x,
            };
            let [tip, left, right] = [corner(7.5, 0.0), corner(-5.0, 4.6), corner(-5.0, -4.6)];
            writeln!(out, r#"<path class="arrow" d="M{tip}L{left}L{right}Z"/>"#)?;
        }
        for at in functions {
            let Point { x, y } = self.pixels(*at);
            let (x, y) = (number(x), number(y - 6.0));
            writeln!(out, r#"<path class="function" d="M{x} {y}l6 6l-6 6l-6 -6Z"/>"#)?;
        }
        for at in switches {
            let Point { x, y } = self.pixels(*at);
            writeln!(
                out,
                r#"<circle class="switch" cx="{}" cy="{}" r="3.5"/>"#,
                number(x),
                number(y)
            )?;
        }
        if let Some(end) = end {
            let Point { x, y } = self.pixels(end);
            writeln!(
                out,
                r##"<rect x="{}" y="{}" width="9" height="9" fill="none" stroke="#c22" stroke-width="2"/>"##,
                number(x - 4.5),
                number(y - 4.5)
            )?;
        }
        if let Some(start) = start {
            let Point { x, y } = self.pixels(start);
            writeln!(
                out,
                r##"<circle cx="{}" cy="{}" r="7" fill="none" stroke="#c22" stroke-width="2"/>"##,
                number(x),
                number(y)
            )?;
        }
        writeln!(out, "</g>")
    }

    /// The legend, and the end.
    pub(super) fn end(&self, out: &mut impl Write, legend: &[(&str, &str)]) -> io::Result<()> {
        let [_, bottom_right] = self.frame();
        let y = bottom_right.y + 42.0;
        let [left, ..] = MARGINS;
        let mut x = left;
        let mut row = y;
        let ends = [("start", "start"), ("end", "end")];
        for (class, text) in legend.iter().chain(&ends) {
            let length = text.chars().fold(0.0, |sum, _| sum + 6.6);
            if x + 34.0 + length > self.size().x && x > left {
                (x, row) = (left, row + 15.0);
            }
            let (from, to, middle) = (number(x), number(x + 24.0), number(row - 4.0));
            let centre = number(x + 12.0);
            match *class {
                "function" => writeln!(
                    out,
                    r#"<path class="function" d="M{centre} {}l6 6l-6 6l-6 -6Z"/>"#,
                    number(row - 10.0)
                )?,
                "switch" => {
                    writeln!(
                        out,
                        r#"<circle class="switch" cx="{centre}" cy="{middle}" r="3.5"/>"#
                    )?;
                }
                "start" => writeln!(
                    out,
                    r##"<circle cx="{centre}" cy="{middle}" r="6" fill="none" stroke="#c22" stroke-width="2"/>"##
                )?,
                "end" => writeln!(
                    out,
                    r##"<rect x="{}" y="{}" width="9" height="9" fill="none" stroke="#c22" stroke-width="2"/>"##,
                    number(x + 7.5),
                    number(row - 8.5)
                )?,
                "cross" => writeln!(
                    out,
                    r#"<path class="sample cross" d="M{} {}l6 6m0 -6l-6 6"/>"#,
                    number(x + 9.0),
                    number(row - 7.0)
                )?,
                class => {
                    writeln!(out, r#"<path class="sample {class}" d="M{from} {middle}H{to}"/>"#)?;
                }
            }
            writeln!(
                out,
                r#"<text class="label" x="{}" y="{}">{text}</text>"#,
                number(x + 30.0),
                number(row)
            )?;
            x += 30.0 + length + 22.0;
        }
        writeln!(out, "</svg>")
    }
}

/// Polygons around splines, in mm like the path.
pub(super) fn hulls(out: &mut impl Write, hulls: &[Vec<Point>]) -> io::Result<()> {
    for hull in hulls {
        let corners: Vec<_> = hull.iter().map(ToString::to_string).collect();
        writeln!(out, "<path class=\"hull\" d=\"M{}Z\"/>", corners.join("L"))?;
    }
    Ok(())
}

/// The smallest of 1, 2, 5 and their tenfolds that is not below `least`.
pub(super) fn step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|step| *step >= least)
        .unwrap_or(10.0 * power)
}

/// Multiples of `step` from `start` over `length`.
pub(super) fn ticks(start: f64, length: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (start / step).ceil();
    (0_u32..)
        .map(move |number| (first + f64::from(number)) * step)
        .take_while(move |at| *at <= start + length)
        .take(100)
}

/// A number for people, to the micrometre.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Text that may stand in XML.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            letter if letter.is_control() => escaped.push(' '),
            letter => escaped.push(letter),
        }
    }
    escaped
}
