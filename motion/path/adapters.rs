//! Stream adapters of a path: mapping, splitting, linearising.

use super::{ElementKind, OperationError, PathElement, Shape, Similarity};
use nalgebra::Vector3;

/// Every element through a [`Similarity`] (`SMC_ROTATEQUEUE2D`, `SMC_TRANSLATEQUEUE3D`, `SMC_SCALEQUEUE3D`, manual 6.3).
#[derive(Clone, Debug)]
pub struct MapPath<I> {
    upstream: I,
    map: Similarity,
}

impl<I> MapPath<I> {
    /// The elements of `upstream` through `map`.
    pub fn new(upstream: I, map: Similarity) -> Self {
        Self { upstream, map }
    }
}

impl<I, E> Iterator for MapPath<I>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<OperationError>,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(match self.upstream.next()? {
            Ok(element) => self.map.element(&element).map_err(E::from),
            error => error,
        })
    }
}

/// The element number `index` (from 0) of a path in two (manual 3.3).
#[derive(Clone, Debug)]
pub struct SplitAt<I> {
    upstream: I,
    left: Option<u64>,
    at: f64,
    second: Option<PathElement>,
}

impl<I> SplitAt<I> {
    /// Splits at the part `at` (0 to 1) of the element's length. A probing move is an error there.
    pub fn new(upstream: I, index: u64, at: f64) -> Self {
        Self { upstream, left: Some(index), at, second: None }
    }
}

impl<I, E> Iterator for SplitAt<I>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<OperationError>,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(second) = self.second.take() {
            return Some(Ok(second));
        }
        let element = match self.upstream.next()? {
            Ok(element) => element,
            error => return Some(error),
        };
        let due = self.left == Some(0);
        self.left = self.left.and_then(|left| left.checked_sub(1));
        if !due || element.length() <= 0.0 {
            return Some(Ok(element));
        }
        if matches!(element.kind, ElementKind::Probe { .. }) {
            return Some(Err(OperationError::SplitProbe(element.place).into()));
        }
        Some(match element.split(self.at) {
            Ok([first, second]) => {
                self.second = Some(second);
                Ok(first)
            }
            Err(error) => Err(error.into()),
        })
    }
}

/// Length of the lines that replace curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chords {
    /// At most so much path per line, m, all of one curve equally long.
    Length(f64),
    /// Successive lines of one curve differ by less than this angle, rad. Transitions stop unless the angle tolerance
    /// is above it.
    Angle(f64),
    /// Lines are at most this far from their curve, m, but for curves that wind between them.
    Deviation(f64),
}

/// Splines and ellipses as lines (manual 3.3), arcs too if asked for. The ends of the lines are on the curve; extra axes
/// and switches go with their part of it.
#[derive(Clone, Debug)]
pub struct Linearise<I> {
    upstream: I,
    chords: Chords,
    arcs: bool,
    /// The current curve and its remaining parts, as parts of its length, the next one last.
    curve: Option<PathElement>,
    left: Vec<Part>,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    from: f64,
    to: f64,
    depth: u32,
}

/// A part is halved at most so often: a million lines per curve.
const MAX_DEPTH: u32 = 20;

impl<I> Linearise<I> {
    /// Replaces the splines and ellipses of `upstream`.
    pub fn new(upstream: I, chords: Chords) -> Self {
        Self { upstream, chords, arcs: false, curve: None, left: Vec::new() }
    }

    /// Arcs, too.
    #[must_use]
    pub fn with_arcs(self) -> Self {
        Self { arcs: true, ..self }
    }

    /// The next line of the curve at hand.
    fn line(&mut self) -> Option<PathElement> {
        let curve = self.curve.as_ref()?;
        let length = curve.length();
        loop {
            let part = self.left.pop()?;
            let Part { from, to, depth } = part;
            let too_much = match self.chords {
                Chords::Length(most) => (to - from) * length > most * (1.0 + 1e-9),
                // A chord points somewhere between the tangents along it, so half the angle each is enough.
                Chords::Angle(most) => turning(curve, from * length, to * length) >= most / 2.0,
                Chords::Deviation(most) => deviation(curve, from * length, to * length) > most,
            };
            if too_much && depth < MAX_DEPTH {
                let middle = from.midpoint(to);
                self.left.push(Part { from: middle, to, depth: depth + 1 });
                self.left.push(Part { from, to: middle, depth: depth + 1 });
                continue;
            }
            let piece = curve.section(from * length, to * length);
            let shape = Shape::Line { start: piece.start(), end: piece.end() };
            return Some(PathElement { shape, ..piece });
        }
    }

    /// Begins with `curve`.
    fn take(&mut self, curve: PathElement) {
        let depth = 0;
        self.left.clear();
        match self.chords {
            Chords::Length(most) if most > 0.0 => {
                // Equal lines, as few as possible; beyond a million parts of each are halved on.
                let count = (curve.length() / most * (1.0 - 1e-9)).ceil().clamp(1.0, 65536.0);
                let mut to = 1.0;
                let mut index = count - 1.0;
                while index >= 0.0 {
                    let from = index / count;
                    self.left.push(Part { from, to, depth });
                    to = from;
                    index -= 1.0;
                }
            }
            _ => {
                self.left.push(Part { from: 0.0, to: 1.0, depth });
            }
        }
        self.curve = Some(curve);
    }
}

impl<I, E> Iterator for Linearise<I>
where
    I: Iterator<Item = Result<PathElement, E>>,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(line) = self.line() {
                return Some(Ok(line));
            }
            self.curve = None;
            let element = match self.upstream.next()? {
                Ok(element) => element,
                error => return Some(error),
            };
            let bent = match element.shape {
                Shape::Line { .. } => false,
                Shape::Arc(_) => self.arcs,
                Shape::Ellipse(_) | Shape::Cubic(_) => true,
            };
            if !bent || element.length() <= 0.0 {
                return Some(Ok(element));
            }
            self.take(element);
        }
    }
}

/// Parts of an element at which it is looked at.
const STEPS: [f64; 8] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

/// Largest distance of `element` between two path lengths from the line between their points, m, at a few steps.
fn deviation(element: &PathElement, from: f64, to: f64) -> f64 {
    let at = |part: f64| element.at(from + (to - from) * part).position;
    let (start, chord) = (at(0.0), at(1.0) - at(0.0));
    let direction = chord.try_normalize(0.0).unwrap_or_default();
    let distances = STEPS.iter().map(|part| {
        let offset = at(*part) - start;
        let along = direction.dot(&offset).clamp(0.0, chord.norm());
        (offset - direction * along).norm()
    });
    distances.fold(0.0, f64::max)
}

/// Turn of the tangent of `element` between two path lengths, rad: the sum over a few steps, so that turns there and
/// back count twice.
fn turning(element: &PathElement, from: f64, to: f64) -> f64 {
    let tangent = |part: f64| element.at(from + (to - from) * part).tangent;
    let angle = |a: Vector3<f64>, b: Vector3<f64>| a.cross(&b).norm().atan2(a.dot(&b));
    let mut before = tangent(0.0);
    STEPS
        .iter()
        .map(|part| {
            let here = tangent(*part);
            angle(std::mem::replace(&mut before, here), here)
        })
        .sum()
}
