//! Page frame: title, subtitle, legend, and the signs that mark places.

use super::Point;
use super::color::{Color, FAINT, INK, Paint, Stroke};
use super::svg::{Anchor, Svg};

/// Sizes of text, pixels.
pub(super) const TITLE: f64 = 22.0;
pub(super) const SUBTITLE: f64 = 15.0;
pub(super) const TEXT: f64 = 13.5;
/// Height of a line of the legend and of notes, pixels.
pub(super) const LINE: f64 = 19.0;
/// Left and right end of the rows, pixels.
pub(super) const LEFT: f64 = 84.0;
pub(super) const RIGHT: f64 = LEFT + 860.0;
/// Mean width of a letter relative to its size: the exact one depends on the font.
const LETTER: f64 = 0.56;

/// Sign of a legend entry or a marked place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sign {
    /// A filled rectangle.
    Patch(Color),
    /// A short line.
    Line(Stroke),
    /// A small disc.
    Dot(Color),
    /// A circle around the place.
    Ring(Color),
    /// A square around the place.
    Square(Color),
    /// A filled diamond.
    Diamond(Color),
    /// An upright cross.
    Plus(Color),
    /// A diagonal cross.
    Cross(Color),
}

/// Signs and what they mean.
pub type Legend = Vec<(Sign, String)>;

impl Sign {
    pub(super) fn draw(self, svg: &mut Svg, (x, y): Point) {
        let edge = |color| Stroke::solid(color, 2.0);
        match self {
            Self::Patch(color) => {
                let edge = Some(Stroke::solid(FAINT, 0.6));
                let paint = Paint { fill: Some(color), edge };
                svg.rectangle((x - 11.0, y - 6.0), (x + 11.0, y + 6.0), paint);
            }
            Self::Line(stroke) => {
                let stroke = Stroke { width: stroke.width.max(1.4), ..stroke };
                svg.line((x - 12.0, y), (x + 12.0, y), stroke);
            }
            Self::Dot(color) => svg.circle((x, y), 3.5, color),
            Self::Ring(color) => svg.circle((x, y), 6.0, Stroke::solid(color, 1.8)),
            Self::Square(color) => {
                svg.rectangle((x - 4.5, y - 4.5), (x + 4.5, y + 4.5), edge(color));
            }
            Self::Diamond(color) => {
                let commands = format!("M{x:.2} {:.2}l6 6l-6 6l-6 -6Z", y - 6.0);
                svg.path("", &commands, color.into(), 1.0);
            }
            Self::Plus(color) => {
                svg.line((x - 5.5, y), (x + 5.5, y), edge(color));
                svg.line((x, y - 5.5), (x, y + 5.5), edge(color));
            }
            Self::Cross(color) => {
                let thin = Stroke::solid(color, 1.1);
                svg.line((x - 3.0, y - 3.0), (x + 3.0, y + 3.0), thin);
                svg.line((x - 3.0, y + 3.0), (x + 3.0, y - 3.0), thin);
            }
        }
    }
}

/// About how wide a text is, pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().fold(0.0, |sum, _| sum + size * LETTER)
}

/// Breaks a text where a line has no room for the next word.
fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().filter(|line| {
            line.is_empty() || width(line, size) + width(word, size) + size * LETTER <= room
        });
        match line {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Title and subtitle as lines that fit the page.
#[derive(Debug)]
pub(super) struct Head {
    lines: Vec<(String, bool)>,
}

impl Head {
    pub(super) fn new(title: &str, subtitle: &str, room: f64) -> Self {
        let title = wrapped(title, TITLE, room).into_iter().map(|line| (line, true));
        let subtitle = wrapped(subtitle, SUBTITLE, room).into_iter().map(|line| (line, false));
        Self { lines: title.chain(subtitle).collect() }
    }

    /// Pixels, with room above and below.
    pub(super) fn height(&self) -> f64 {
        self.lines.iter().fold(28.0, |sum, (_, is_title)| sum + if *is_title { 28.0 } else { LINE })
    }

    pub(super) fn draw(&self, svg: &mut Svg, (x, top): Point) {
        let mut y = top + 12.0;
        for (line, is_title) in &self.lines {
            let (size, color, step) =
                if *is_title { (TITLE, INK, 28.0) } else { (SUBTITLE, FAINT, LINE) };
            svg.text((x, y + step / 2.0), size, color, Anchor::Start, line);
            y += step;
        }
    }
}

/// Places of the items of a legend, from its top left corner, and its height.
pub(super) fn legend_places(legend: &[(Sign, String)], room: f64) -> (Vec<Point>, f64) {
    let (mut x, mut y) = (0.0, 0.0);
    let mut places = Vec::new();
    for (_, word) in legend {
        let width = 32.0 + width(word, TEXT);
        if x + width > room && x > 0.0 {
            (x, y) = (0.0, y + LINE + 2.0);
        }
        places.push((x, y));
        x += width + 16.0;
    }
    (places, y + LINE + 2.0)
}

/// Draws a legend whose first line has its middle at the height of `top`.
pub(super) fn legend(svg: &mut Svg, legend: &[(Sign, String)], (left, top): Point, room: f64) {
    let (places, _) = legend_places(legend, room);
    for ((sign, word), (x, y)) in legend.iter().zip(places) {
        sign.draw(svg, (left + x + 12.0, top + y));
        svg.text((left + x + 30.0, top + y), TEXT, INK, Anchor::Start, word);
    }
}
