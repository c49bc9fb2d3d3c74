//! SVG elements as text.

use super::Point;
use super::color::{Attributes, Color, Paint, Stroke};
use super::ticks::rounded;
use std::fmt;

/// Anchor of a text: the part of it at its place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
    /// The middle of a text that is read upwards.
    Upwards,
}

/// A document that is being written.
#[derive(Debug, Default)]
pub(super) struct Svg(String);

impl Svg {
    pub(super) fn add(&mut self, element: fmt::Arguments<'_>) {
        self.0.push_str(&element.to_string());
        self.0.push('\n');
    }

    /// A document of this size with a white ground, and its title for readers of the file.
    pub(super) fn open(&mut self, (width, height): Point, title: &str) {
        let [width, height] = [width, height].map(number);
        self.add(format_args!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="sans-serif">"#
        ));
        self.add(format_args!("<title>{}</title>", escaped(title)));
        self.add(format_args!(r##"<rect width="{width}" height="{height}" fill="#fff"/>"##));
    }

    pub(super) fn close(&mut self) {
        self.add(format_args!("</svg>"));
    }

    /// Begins a part of the page outside of which nothing is seen; coordinates remain those of the page.
    pub(super) fn open_window(&mut self, corner: Point, size: Point) {
        let [x, y, width, height] = [corner.0, corner.1, size.0, size.1].map(number);
        self.add(format_args!(
            r#"<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">"#
        ));
    }

    pub(super) fn rectangle(&mut self, from: Point, to: Point, paint: impl Into<Paint>) {
        let [x, y] = [from.0.min(to.0), from.1.min(to.1)].map(number);
        let [width, height] = [(to.0 - from.0).abs(), (to.1 - from.1).abs()].map(number);
        let paint = Attributes(paint.into(), 1.0);
        self.add(format_args!(
            r#"<rect x="{x}" y="{y}" width="{width}" height="{height}"{paint}/>"#
        ));
    }

    pub(super) fn circle(&mut self, center: Point, radius: f64, paint: impl Into<Paint>) {
        let [x, y, radius] = [center.0, center.1, radius].map(number);
        let paint = Attributes(paint.into(), 1.0);
        self.add(format_args!(r#"<circle cx="{x}" cy="{y}" r="{radius}"{paint}/>"#));
    }

    pub(super) fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(number);
        let paint = Attributes(stroke.into(), 1.0);
        self.add(format_args!(r#"<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}"{paint}/>"#));
    }

    pub(super) fn polyline(&mut self, points: &[Point], stroke: Stroke) {
        let points: Vec<_> =
            points.iter().map(|(x, y)| format!("{},{}", number(*x), number(*y))).collect();
        let paint = Attributes(stroke.into(), 1.0);
        self.add(format_args!(
            r#"<polyline points="{}"{paint} stroke-linejoin="round"/>"#,
            points.join(" ")
        ));
    }

    /// A path of SVG commands, in a coordinate system of which `scale` pixels are one unit.
    pub(super) fn path(&mut self, class: &str, commands: &str, paint: Paint, scale: f64) {
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        let paint = Attributes(paint, scale);
        self.add(format_args!(
            r#"<path{class} d="{commands}"{paint} stroke-linejoin="round" stroke-linecap="round"/>"#
        ));
    }

    /// A text whose middle is at the height of `at`.
    pub(super) fn text(&mut self, at: Point, size: f64, color: Color, anchor: Anchor, text: &str) {
        let [x, y, size] = [at.0, at.1, size].map(number);
        let place = match anchor {
            Anchor::Start => String::new(),
            Anchor::Middle => " text-anchor=\"middle\"".to_owned(),
            Anchor::End => " text-anchor=\"end\"".to_owned(),
            Anchor::Upwards => {
                format!(" text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\"")
            }
        };
        let text = escaped(text);
        self.add(format_args!(
            r#"<text x="{x}" y="{y}" dy="0.35em" font-size="{size}" fill="{color}"{place}>{text}</text>"#
        ));
    }

    /// Takes the text written since the last call.
    pub(super) fn take(&mut self) -> String {
        std::mem::take(&mut self.0)
    }
}

/// A length with at most four decimals; 0 if it is not finite.
pub fn number(value: f64) -> String {
    rounded(if value.is_finite() { value } else { 0.0 }, 4)
}

/// Text escaped for XML.
fn escaped(text: &str) -> String {
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
