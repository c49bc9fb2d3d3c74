//! Cam curve: the slave position as a function of the master position.

use super::cells::Cells;
use super::error::CamError;
use super::knot::{Derivatives, Knot, MOST, Piece};
use super::polynomial::{Extremes, extremes};

/// The most points a curve may have.
pub(crate) const MAX_POINTS: usize = 1 << 24;

/// A cam curve: polynomials of degree 5 or less, piece by piece over a range of the master (manual 4.2).
///
/// Finding a piece takes the same time wherever the master is: a table of equal cells says which piece each begins in.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pieces: Box<[Piece]>,
    start: f64,
    end: f64,
    /// What the slave has gained at the end.
    rise: f64,
    cells: Cells,
}

/// Jump: two pieces that meet with different derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Its position, master u.
    pub master: f64,
    /// By how much the value rises there.
    pub by: f64,
}

/// The largest jumps of a curve: 0 everywhere for one that is twice continuously differentiable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jumps {
    /// Of the position, u.
    pub position: Jump,
    /// Of y′.
    pub velocity: Jump,
    /// Of y″, 1/u.
    pub acceleration: Jump,
}

impl Curve {
    /// Polynomials of degree 5 through the points (`byType` 3, manual 4.7), straight where the points say so.
    ///
    /// # Errors
    /// [`CamError`] if there are less than two points, their masters do not ascend, or a value is beyond ±1e80.
    pub fn polynomial(knots: &[Knot]) -> Result<Self, CamError> {
        check(knots)?;
        Self::from_pieces(knots, pairs(knots).map(|(from, to)| Piece::between(from, to)).collect())
    }

    /// Straight lines between points, of which only the positions count (`byInterpolationQuality` 1).
    ///
    /// # Errors
    /// As [`Self::polynomial`].
    pub(crate) fn linear(knots: &[Knot]) -> Result<Self, CamError> {
        check(knots)?;
        Self::from_pieces(knots, pairs(knots).map(|(from, to)| Piece::linear(from, to)).collect())
    }

    /// Cubics between points with tangents (`byInterpolationQuality` 3).
    ///
    /// # Errors
    /// As [`Self::polynomial`].
    pub(crate) fn cubic(knots: &[Knot]) -> Result<Self, CamError> {
        check(knots)?;
        Self::from_pieces(knots, pairs(knots).map(|(from, to)| Piece::cubic(from, to)).collect())
    }

    fn from_pieces(knots: &[Knot], pieces: Vec<Piece>) -> Result<Self, CamError> {
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return Err(CamError::TooFewPoints { found: pieces.len() });
        };
        let (start, end) = (first.start, last.start + last.width);
        // Of the points: a cam that comes back to where it began gains nothing, not a rounding.
        let ends = [knots.first(), knots.last()].map(|knot| knot.map_or(0.0, |knot| knot.slave));
        let rise = ends[1] - ends[0];
        if let Some(index) = pieces.iter().position(|piece| !piece.is_within(MOST)) {
            return Err(CamError::Beyond { index: index + 2 });
        }
        let begins: Vec<_> = pieces.iter().map(|piece| piece.start).collect();
        Ok(Self { start, end, rise, cells: Cells::new(&begins, end), pieces: pieces.into() })
    }

    /// Begin of the master's range (`xStart`), u.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// End of the master's range (`xEnd`), u.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Rise of the slave from begin to end, u.
    pub fn rise(&self) -> f64 {
        self.rise
    }

    /// True if the master's range holds `master`, both ends included.
    pub fn contains(&self, master: f64) -> bool {
        (self.start..=self.end).contains(&master)
    }

    /// Begins of the pieces, and the end.
    pub fn joints(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces.iter().map(|piece| piece.start).chain([self.end])
    }

    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The slave where the master is; beyond the ends it stays where they are (manual 4.6.1, `Periodic` FALSE).
    #[inline]
    pub fn at(&self, master: f64) -> Derivatives {
        if master >= self.start && master <= self.end {
            self.inside(master)
        } else {
            self.beyond(master)
        }
    }

    /// The slave where the master is, with a periodic curve (manual 4.6.1, `Periodic` TRUE): every pass goes on
    /// where the one before has led.
    #[inline]
    pub fn repeated(&self, master: f64) -> Derivatives {
        let (inside, passes) = self.wrap(master);
        let mut found = self.inside(inside);
        found.position += passes * self.rise;
        found
    }

    /// The place in the range, begin included and end not, and how often the range fits in between.
    #[inline]
    pub fn wrap(&self, master: f64) -> (f64, f64) {
        if master >= self.start && master < self.end {
            return (master, 0.0);
        }
        let width = self.end - self.start;
        let passes = ((master - self.start) / width).floor();
        let inside = master - passes * width;
        // Rounding may put it on the wrong side of an end.
        if inside < self.start {
            (self.start, passes)
        } else if inside >= self.end {
            (self.start, passes + 1.0)
        } else {
            (inside, passes)
        }
    }

    #[cold]
    fn beyond(&self, master: f64) -> Derivatives {
        let edge = if master > self.end { self.end } else { self.start };
        Derivatives { position: self.inside(edge).position, ..Derivatives::default() }
    }

    #[inline]
    fn inside(&self, master: f64) -> Derivatives {
        self.pieces
            .get(self.cells.piece(master))
            .map_or_else(Derivatives::default, |piece| piece.at(master - piece.start))
    }

    /// Extremes of position, velocity and acceleration (manual 4.4.3, "show extremes"), exact: at the ends of pieces and
    /// at the roots of their derivatives.
    pub fn extremes(&self) -> CurveExtremes {
        let mut found = [Extremes::NONE; 4];
        for piece in &self.pieces {
            for (found, c) in found.iter_mut().zip(piece.polynomials()) {
                found.join(&extremes(&c, piece.width), piece.start);
            }
        }
        let [position, velocity, acceleration, jerk] = found.map(Range::from);
        CurveExtremes { position, velocity, acceleration, jerk }
    }

    /// The largest jumps at the joints between pieces, and with `repeated` also at the one between end and begin.
    pub fn jumps(&self, repeated: bool) -> Jumps {
        let none = Jump { master: self.start, by: 0.0 };
        let mut found = Jumps { position: none, velocity: none, acceleration: none };
        let take = |jump: &mut Jump, master: f64, by: f64| {
            if by.abs() > jump.by.abs() {
                *jump = Jump { master, by };
            }
        };
        let inner = self.pieces.iter().zip(self.pieces.iter().skip(1));
        for (before, after) in inner {
            let (end, begin) = (before.end(), after.begin());
            take(&mut found.position, after.start, begin.position - end.position);
            take(&mut found.velocity, after.start, begin.velocity - end.velocity);
            take(&mut found.acceleration, after.start, begin.acceleration - end.acceleration);
        }
        if let (true, Some(first), Some(last)) = (repeated, self.pieces.first(), self.pieces.last())
        {
            let (end, begin) = (last.end(), first.begin());
            take(&mut found.velocity, self.end, begin.velocity - end.velocity);
            take(&mut found.acceleration, self.end, begin.acceleration - end.acceleration);
        }
        found
    }
}

/// A least and a greatest value, and where the master is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The least value.
    pub min: f64,
    /// Its position, master u.
    pub at_min: f64,
    /// The greatest value.
    pub max: f64,
    /// Its position, master u.
    pub at_max: f64,
}

impl Range {
    /// The larger of both magnitudes.
    pub fn magnitude(&self) -> f64 {
        self.min.abs().max(self.max.abs())
    }
}

impl From<Extremes> for Range {
    fn from(extremes: Extremes) -> Self {
        let Extremes { min, at_min, max, at_max } = extremes;
        Self { min, at_min, max, at_max }
    }
}

/// Extremes of a curve and of its derivatives by the master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveExtremes {
    /// y, u.
    pub position: Range,
    /// y′.
    pub velocity: Range,
    /// y″, 1/u.
    pub acceleration: Range,
    /// y‴, 1/u².
    pub jerk: Range,
}

fn pairs(knots: &[Knot]) -> impl Iterator<Item = (&Knot, &Knot)> {
    knots.iter().zip(knots.iter().skip(1))
}

fn check(knots: &[Knot]) -> Result<(), CamError> {
    if knots.len() < 2 {
        return Err(CamError::TooFewPoints { found: knots.len() });
    }
    if knots.len() > MAX_POINTS {
        return Err(CamError::TooManyPoints { found: knots.len(), limit: MAX_POINTS });
    }
    for (index, knot) in knots.iter().enumerate() {
        if !knot.is_within(MOST) {
            return Err(CamError::Beyond { index: index + 1 });
        }
    }
    for (index, (from, to)) in pairs(knots).enumerate() {
        if to.master <= from.master {
            return Err(CamError::NotAscending {
                index: index + 2,
                master: to.master,
                before: from.master,
            });
        }
    }
    Ok(())
}
