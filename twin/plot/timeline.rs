//! Time line of a program: curves, strips of kinds (such as the limiting cause or nearest body), and program lines.

use super::Point;
use super::chart::{Across, Strip};
use super::color::Color;
use super::series::{Series, Stretches};

/// Curves and strips that are recorded sample by sample.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    curves: Vec<Series>,
    kinds: Stretches<Option<usize>>,
    lines: Stretches<u32>,
    /// Kind from the last sample on.
    kind: Option<usize>,
    span: Option<[f64; 2]>,
}

impl Timeline {
    /// An empty time line with `curves` curves.
    pub fn new(curves: usize) -> Self {
        Self { curves: vec![Series::default(); curves], ..Self::default() }
    }

    /// Adds a sample: time in s, line of the program, a value of each curve, and the kind that holds until the next one.
    pub fn push(&mut self, time_s: f64, line: u32, values: &[Option<f64>], kind: Option<usize>) {
        for (curve, value) in self.curves.iter_mut().zip(values) {
            curve.push(time_s, *value);
        }
        self.kinds.push(time_s, self.kind);
        self.lines.push(time_s, line);
        self.kind = kind;
        self.span = Some([self.span.map_or(time_s, |[begin, _]| begin), time_s]);
    }

    /// The points of a curve.
    pub fn curve(&self, index: usize) -> &[Point] {
        self.curves.get(index).map_or(&[], Series::points)
    }

    /// Begin and end, s.
    pub fn span(&self) -> [f64; 2] {
        self.span.unwrap_or_default()
    }

    /// The axis below the curves.
    pub fn across(&self) -> Across {
        Across::time(self.span())
    }

    /// True if a kind is seen in its strip.
    pub fn shows(&self, kind: usize) -> bool {
        self.kinds.iter().any(|(begin, end, held)| held == Some(kind) && end > begin)
    }

    /// The strips below the curves: the kinds in their colours, and the lines of the program.
    pub fn strips(&self, name: &str, color: impl Fn(usize) -> Color) -> Vec<Strip> {
        let parts = self.kinds.iter();
        let parts = parts.filter_map(|(begin, end, kind)| Some((begin, end, color(kind?))));
        let kinds = Strip { parts: parts.collect(), ..Strip::new(name) };
        vec![kinds, Strip::of_numbers("line of the program", &self.lines, self.span())]
    }
}
