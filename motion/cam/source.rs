//! Cam source as edited: points, straight lines and tappets on a scale, and its compilation (manual 4.2 to 4.4).

use super::curve::Curve;
use super::error::CamError;
use super::file::clean;
use super::knot::Knot;
use super::reference::{Cam, Shape};
use super::table::{Equidistant, Interpolation, PairTable, TableScale, VariableType};
use super::tappet::Tappet;

/// A scale of master or slave (manual 4.3).
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Least value, u.
    pub min: f64,
    /// Greatest value, u.
    pub max: f64,
    /// Distance of the marks in a picture, u.
    pub step: f64,
    /// Unit of u.
    pub unit: String,
}

impl Scale {
    /// One turn: 0 to 360 in steps of 20 degrees, as the manual presets it.
    pub fn turn() -> Self {
        Self { min: 0.0, max: 360.0, step: 20.0, unit: "°".to_owned() }
    }
}

/// An element of a cam curve (manual 4.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// A point with velocity and acceleration at will.
    Point(Knot),
    /// A straight line: constant velocity, no acceleration.
    Line {
        /// Begin: master and slave, u.
        from: [f64; 2],
        /// End: master and slave, u.
        to: [f64; 2],
    },
}

impl Element {
    /// Begin and end; of a point, the point twice.
    pub(crate) fn ends(&self) -> [Knot; 2] {
        match *self {
            Self::Point(knot) => [knot, knot],
            Self::Line { from, to } => {
                let velocity = (to[1] - from[1]) / (to[0] - from[0]);
                [from, to].map(|[master, slave]| Knot { velocity, ..Knot::at_rest(master, slave) })
            }
        }
    }
}

/// Kind of a cam: a curve, or tappets only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A curve, with or without tappets.
    #[default]
    Cam,
    /// Tappets only.
    Tappets,
}

/// A cam as it is edited (manual 4.3, 4.4).
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Its name.
    pub name: String,
    /// Curve, or tappets only.
    pub kind: Kind,
    /// Scale of the master: where the curve begins and ends.
    pub master: Scale,
    /// Scale of the slave, for pictures.
    pub slave: Scale,
    /// The slave's period if the cam is periodic, u: the end then takes velocity and acceleration of the begin, and its
    /// position but for whole periods.
    pub period: Option<f64>,
    /// Points and lines by ascending masters.
    pub elements: Vec<Element>,
    /// Tappets.
    pub tappets: Vec<Tappet>,
}

/// Result of compiling a cam (manual 4.4.3); the fourth mode is not to compile it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compile {
    /// Points with velocity and acceleration: nothing is lost.
    Polynomial,
    /// Slave positions at equal distances of the master.
    Equidistant {
        /// Number of points.
        points: usize,
        /// Type of the numbers.
        variable: VariableType,
        /// Their scale.
        slave: TableScale,
        /// Between the points.
        interpolation: Interpolation,
    },
    /// Pairs: lines get their ends only, the others are spread evenly over the rest.
    Elements {
        /// Number of points.
        points: usize,
        /// Type of the numbers.
        variable: VariableType,
        /// Scale of the master numbers.
        master: TableScale,
        /// Scale of the slave numbers.
        slave: TableScale,
        /// Between the points.
        interpolation: Interpolation,
    },
}

/// Values of two elements that meet are the same within this part of themselves.
const SAME: f64 = 1e-9;

impl Source {
    /// A cam over one turn of the master, with nothing on it.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind: Kind::Cam,
            master: Scale::turn(),
            slave: Scale { step: 40.0, ..Scale::turn() },
            period: Some(360.0),
            elements: Vec::new(),
            tappets: Vec::new(),
        }
    }

    /// Inserts a point with a horizontal tangent, in its order (manual 4.4.3).
    pub fn insert_point(&mut self, master: f64, slave: f64) {
        self.insert(Element::Point(Knot::at_rest(master, slave)));
    }

    /// Inserts a straight line in its order. Its end may not lie before its begin, nor behind the element that follows:
    /// compiling says so.
    pub fn insert_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.insert(Element::Line { from, to });
    }

    /// Inserts a tappet, in the order of the masters.
    pub fn insert_tappet(&mut self, tappet: Tappet) {
        let at = self.tappets.partition_point(|other| other.master <= tappet.master);
        self.tappets.insert(at, tappet);
    }

    /// A scale of the slave where nothing is said of one: from the least to the greatest position of its curve, or, before there is
    /// one, of its points and lines. Marks stay as they are if there are any.
    pub fn scale_slave(&mut self, curve: Option<&Curve>) {
        let [mut min, mut max] = [f64::INFINITY, f64::NEG_INFINITY];
        for knot in self.elements.iter().flat_map(Element::ends) {
            (min, max) = (min.min(knot.slave), max.max(knot.slave));
        }
        if let Some(curve) = curve {
            let y = curve.extremes().position;
            // A curve that ends with its points does so but for rounding.
            let near = |one: f64, other: f64| (one - other).abs() <= SAME * (y.max - y.min);
            min = if near(min, y.min) { min } else { y.min };
            max = if near(max, y.max) { max } else { y.max };
        }
        if !(min.is_finite() && max.is_finite()) {
            (min, max) = (0.0, 1.0);
        } else if max <= min {
            // About a slave at rest, wide enough to be a scale.
            let half = 0.5_f64.max(min.abs() * 1e-3);
            (min, max) = (min - half, min + half);
        }
        // The marks are those of the curve, where there is to be one.
        let said = self.slave.step > 0.0 || (curve.is_none() && self.kind == Kind::Cam);
        let step = if said { self.slave.step } else { (max - min) / 10.0 };
        self.slave = Scale { min, max, step, ..std::mem::replace(&mut self.slave, Scale::turn()) };
    }

    pub(crate) fn insert(&mut self, element: Element) {
        let begin = |element: &Element| element.ends()[0].master;
        let at = self.elements.partition_point(|other| begin(other) <= begin(&element));
        self.elements.insert(at, element);
    }

    /// The points of the curve, both ends included, with velocity and acceleration.
    ///
    /// # Errors
    /// [`CamError`] if elements overlap, meet with different values, lie outside the scale, or an end is missing.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub fn knots(&self) -> Result<Vec<Knot>, CamError> {
        let mut knots: Vec<Knot> = Vec::with_capacity(2 * self.elements.len() + 1);
        for (index, element) in (1..).zip(&self.elements) {
            let [begin, end] = element.ends();
            for knot in [begin, end] {
                let Scale { min, max, .. } = self.master;
                if !(min..=max).contains(&knot.master) {
                    let (what, master) = ("element", knot.master);
                    return Err(CamError::OutsideScale { what, index, master, min, max });
                }
            }
            let is_line = matches!(element, Element::Line { .. });
            if is_line && end.master <= begin.master {
                let (master, before) = (end.master, begin.master);
                return Err(CamError::NotAscending { index, master, before });
            }
            match knots.last() {
                Some(last) if last.master == begin.master => self.meet(index, last, &begin)?,
                Some(last) if last.master > begin.master => {
                    let (master, before) = (begin.master, last.master);
                    return Err(CamError::NotAscending { index, master, before });
                }
                _ => knots.push(begin),
            }
            if is_line {
                knots.push(end);
            }
        }
        self.close(&mut knots)?;
        Ok(knots)
    }

    /// Both ends are where the scale has them; the end of a periodic cam goes on as its begin does.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    fn close(&self, knots: &mut Vec<Knot>) -> Result<(), CamError> {
        let found = knots.len();
        let (Some(first), Some(last)) = (knots.first().copied(), knots.last().copied()) else {
            return Err(CamError::TooFewPoints { found });
        };
        let missing = |what, master, scale| Err(CamError::EndMissing { what, master, scale });
        if first.master != self.master.min {
            return missing("begin", first.master, self.master.min);
        }
        let Some(period) = self.period else {
            if last.master != self.master.max {
                return missing("end", last.master, self.master.max);
            }
            return Ok(());
        };
        let whole = |slave: f64| {
            let passes = ((slave - first.slave) / period).round();
            first.slave + if passes.is_finite() { passes * period } else { 0.0 }
        };
        let end = Knot { master: self.master.max, slave: whole(last.slave), ..first };
        if last.master != self.master.max {
            knots.push(end);
            return Ok(());
        }
        // Edits of an end point are ignored (manual 4.3); a line would not be straight any more.
        if matches!(self.elements.last(), Some(Element::Line { .. })) {
            self.meet(self.elements.len(), &end, &last)?;
        }
        if let Some(last) = knots.last_mut() {
            *last = end;
        }
        Ok(())
    }

    fn meet(&self, index: usize, before: &Knot, begin: &Knot) -> Result<(), CamError> {
        let width = self.master.max - self.master.min;
        let size = (self.slave.max - self.slave.min).abs().max(before.slave.abs());
        for (what, before, value, size) in [
            ("slave", before.slave, begin.slave, size),
            ("velocity", before.velocity, begin.velocity, size / width),
            ("acceleration", before.acceleration, begin.acceleration, size / (width * width)),
        ] {
            if (value - before).abs() > SAME * size.max(value.abs()) {
                return Err(CamError::Kink { index, what, master: begin.master, value, before });
            }
        }
        Ok(())
    }

    /// Compiles it (manual 4.4.3).
    ///
    /// # Errors
    /// As [`Self::knots`], and [`CamError`] if a table has too few points for the elements or numbers that do not fit
    /// its type, or a tappet lies outside the scale.
    pub fn compile(&self, mode: Compile) -> Result<Cam, CamError> {
        let knots = match self.kind {
            Kind::Cam => self.knots()?,
            // What carries tappets only is a curve at rest.
            Kind::Tappets => {
                vec![Knot::at_rest(self.master.min, 0.0), Knot::at_rest(self.master.max, 0.0)]
            }
        };
        let whole = Cam::new(&self.name, Shape::Polynomial(knots), self.tappets.clone())?;
        let shape = match mode {
            Compile::Polynomial => return Ok(whole),
            Compile::Equidistant { points, variable, slave, interpolation } => {
                self.equidistant(&whole, points, variable, slave, interpolation)?
            }
            Compile::Elements { points, variable, master, slave, interpolation } => {
                let masters = self.spread(points)?;
                let mut pairs = Vec::with_capacity(points);
                for (index, at) in (1..).zip(masters) {
                    let [x, y] = [master.number(at), slave.number(whole.curve().at(at).position)];
                    pairs.push([variable.hold(index, clean(x))?, variable.hold(index, clean(y))?]);
                }
                let periodic = self.period.is_some();
                Shape::Pairs(PairTable { variable, master, slave, periodic, interpolation, pairs })
            }
        };
        Cam::new(&self.name, shape, self.tappets.clone())
    }

    fn equidistant(
        &self,
        whole: &Cam,
        points: usize,
        variable: VariableType,
        slave: TableScale,
        interpolation: Interpolation,
    ) -> Result<Shape, CamError> {
        // A table that leaves out its end comes back to its begin: a cam that gains periods needs the end.
        let periodic = self.period.is_some() && whole.curve().rise() == 0.0;
        let least = if periodic { 1 } else { 2 };
        if points < least {
            return Err(CamError::TooFewPoints { found: points });
        }
        let mut table = Equidistant {
            variable,
            start: self.master.min,
            end: self.master.max,
            periodic,
            slave,
            interpolation,
            values: vec![0.0; points],
        };
        let mut values = Vec::with_capacity(points);
        for index in 0..points {
            let position = whole.curve().at(table.master(index)).position;
            values.push(variable.hold(index + 1, clean(slave.number(position)))?);
        }
        table.values = values;
        Ok(Shape::Equidistant(table))
    }

    /// Masters of `points` pairs: ends of lines and of the cam, and the others evenly between them, not on lines.
    fn spread(&self, points: usize) -> Result<Vec<f64>, CamError> {
        let mut fixed = vec![(self.master.min, false)];
        for element in &self.elements {
            if let Element::Line { from, to } = element {
                // A line reaches back to the point before it.
                if fixed.last().is_none_or(|(last, _)| *last < from[0]) {
                    fixed.push((from[0], false));
                }
                fixed.push((to[0], true));
            }
        }
        if fixed.last().is_none_or(|(last, _)| *last < self.master.max) {
            fixed.push((self.master.max, false));
        }
        let Some(more) = points.checked_sub(fixed.len()) else {
            return Err(CamError::TooFewPoints { found: points });
        };
        let gaps = fixed.iter().zip(fixed.iter().skip(1));
        let free: f64 = gaps.clone().filter(|(_, to)| !to.1).map(|(from, to)| to.0 - from.0).sum();
        #[expect(clippy::cast_precision_loss, reason = "a table has fewer than 2^53 points")]
        let per_unit = if free > 0.0 { more as f64 / free } else { 0.0 };
        let mut masters = vec![self.master.min];
        let (mut gone, mut given) = (0.0, 0usize);
        for ((from, _), (to, is_line)) in gaps {
            if !is_line {
                gone += to - from;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a count, not negative"
                )]
                let until = (gone * per_unit).round() as usize;
                let until = until.min(more);
                let here = until - given;
                given = until;
                for index in 1..=here {
                    #[expect(clippy::cast_precision_loss, reason = "counts of points")]
                    let share = index as f64 / (here + 1) as f64;
                    masters.push(from + (to - from) * share);
                }
            }
            masters.push(*to);
        }
        Ok(masters)
    }
}
