//! Cam tables: equidistant slave positions, or pairs of master and slave (manual 4.4.3, 4.7).
//!
//! A table holds numbers of a type of its own (`INT` … `LREAL`) and in units of its own, which a scale maps onto those of
//! the axes. Between its points the slave moves along straight lines or along cubics.

use super::curve::Curve;
use super::error::CamError;
use super::knot::Knot;

/// The type of a table's variables (`byVarType`, manual 4.7; the numbers are those of its example).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VariableType {
    /// 16 bits with sign.
    Int,
    /// 16 bits.
    Uint,
    /// 32 bits with sign.
    Dint,
    /// 32 bits.
    Udint,
    /// IEEE 754 single.
    Real,
    /// IEEE 754 double.
    Lreal,
}

impl VariableType {
    /// All of them, by their numbers.
    pub const ALL: [Self; 6] =
        [Self::Int, Self::Uint, Self::Dint, Self::Udint, Self::Real, Self::Lreal];

    /// The manual's number.
    pub const fn number(self) -> u8 {
        match self {
            Self::Int => 1,
            Self::Uint => 2,
            Self::Dint => 3,
            Self::Udint => 4,
            Self::Real => 5,
            Self::Lreal => 6,
        }
    }

    /// The type of that number.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.number() == number)
    }

    /// As IEC 61131-3 writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Int => "INT",
            Self::Uint => "UINT",
            Self::Dint => "DINT",
            Self::Udint => "UDINT",
            Self::Real => "REAL",
            Self::Lreal => "LREAL",
        }
    }

    /// Least and greatest value.
    pub const fn limits(self) -> (f64, f64) {
        match self {
            Self::Int => (-32_768.0, 32_767.0),
            Self::Uint => (0.0, 65_535.0),
            Self::Dint => (-2_147_483_648.0, 2_147_483_647.0),
            Self::Udint => (0.0, 4_294_967_295.0),
            Self::Real => (-3.402_823_466_385_288_6e38, 3.402_823_466_385_288_6e38),
            Self::Lreal => (f64::MIN, f64::MAX),
        }
    }

    /// The value of this type next to `value`.
    ///
    /// # Errors
    /// [`CamError::OutsideType`] if there is none; `index` is for its message, from 1.
    pub(crate) fn hold(self, index: usize, value: f64) -> Result<f64, CamError> {
        let near = match self {
            // A whole number has no −0.
            Self::Int | Self::Uint | Self::Dint | Self::Udint => value.round() + 0.0,
            #[expect(clippy::cast_possible_truncation, reason = "what a REAL can hold of it")]
            Self::Real => f64::from(value as f32),
            Self::Lreal => value,
        };
        let (min, max) = self.limits();
        if near.is_finite() && (min..=max).contains(&near) {
            return Ok(near);
        }
        Err(CamError::OutsideType { index, value, kind: self.name(), min, max })
    }

    /// A value of a table of this type; whole numbers have no fraction.
    ///
    /// # Errors
    /// [`CamError::Fraction`], and as [`Self::hold`].
    fn taken(self, index: usize, value: f64) -> Result<f64, CamError> {
        let held = self.hold(index, value)?;
        let whole = !matches!(self, Self::Real | Self::Lreal);
        if whole && value.fract() != 0.0 {
            return Err(CamError::Fraction { index, value, kind: self.name() });
        }
        Ok(held)
    }
}

/// Interpolation of a table between its points (`byInterpolationQuality`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Straight lines, 1: the velocity jumps at the points.
    #[default]
    Linear,
    /// Cubics, 3: the acceleration jumps at the points. Every point has the tangent of the parabola through it and its
    /// neighbours (where points are equidistant, Catmull and Rom's).
    Cubic,
}

impl Interpolation {
    /// The manual's number.
    pub const fn number(self) -> u8 {
        match self {
            Self::Linear => 1,
            Self::Cubic => 3,
        }
    }

    /// The interpolation of that number.
    pub fn from_number(number: u8) -> Option<Self> {
        [Self::Linear, Self::Cubic].into_iter().find(|kind| kind.number() == number)
    }
}

/// Scale of a table: its numbers and their positions (`fEditorMasterMin` … `fTableSlaveMax`, manual 4.7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableScale {
    /// Position (`fEditor…Min`), u.
    pub min: f64,
    /// Position (`fEditor…Max`), u.
    pub max: f64,
    /// Number for `min` (`fTable…Min`).
    pub table_min: f64,
    /// Number for `max` (`fTable…Max`).
    pub table_max: f64,
}

impl TableScale {
    /// A table in the axis's own units.
    pub const IDENTITY: Self = Self { min: 0.0, max: 1.0, table_min: 0.0, table_max: 1.0 };

    #[expect(clippy::float_cmp, reason = "a range of no width")]
    fn check(&self, axis: &'static str) -> Result<(), CamError> {
        let Self { min, max, table_min, table_max } = *self;
        let finite = [min, max, table_min, table_max].iter().all(|value| value.is_finite());
        if finite && min != max && table_min != table_max {
            return Ok(());
        }
        Err(CamError::Scaling { axis, min, max, table_min, table_max })
    }

    /// The position of a number, u.
    pub fn position(&self, number: f64) -> f64 {
        let share = (number - self.table_min) / (self.table_max - self.table_min);
        self.min + share * (self.max - self.min)
    }

    /// The number for a position.
    pub fn number(&self, position: f64) -> f64 {
        let share = (position - self.min) / (self.max - self.min);
        self.table_min + share * (self.table_max - self.table_min)
    }
}

/// Slave positions at equal distances of the master (`SMC_CAMTable_<type>_<n>_1`, `byType` 1).
#[doc(alias = "SMC_CAMTable")]
#[derive(Clone, Debug, PartialEq)]
pub struct Equidistant {
    /// Type of the numbers.
    pub variable: VariableType,
    /// Begin of the master's range, u.
    pub start: f64,
    /// End of the master's range, u.
    pub end: f64,
    /// True if the last number is one step before the end, where the first one repeats; else it is at the end.
    pub periodic: bool,
    /// Scale of the numbers.
    pub slave: TableScale,
    /// Between the points.
    pub interpolation: Interpolation,
    /// The numbers, in units of the table.
    pub values: Vec<f64>,
}

impl Equidistant {
    /// The curve.
    ///
    /// # Errors
    /// [`CamError`] if the scale is none, numbers do not fit their type, or there are too few of them.
    pub fn curve(&self) -> Result<Curve, CamError> {
        self.slave.check("slave")?;
        if !(self.start.is_finite() && self.end.is_finite() && self.start < self.end) {
            return Err(CamError::NotAscending { index: 2, master: self.end, before: self.start });
        }
        let mut knots = Vec::with_capacity(self.values.len() + 1);
        for (index, number) in self.values.iter().enumerate() {
            let held = self.variable.taken(index + 1, *number)?;
            knots.push(Knot::at_rest(self.master(index), self.slave.position(held)));
        }
        if self.periodic
            && let Some(first) = knots.first()
        {
            knots.push(Knot::at_rest(self.end, first.slave));
        }
        curve(knots, self.interpolation, self.periodic)
    }

    /// Position of number `index`, master u.
    pub fn master(&self, index: usize) -> f64 {
        let steps = if self.periodic { self.values.len() } else { self.values.len().max(2) - 1 };
        if index == steps {
            return self.end;
        }
        #[expect(clippy::cast_precision_loss, reason = "there are fewer than 2^53 values")]
        let share = index as f64 / steps as f64;
        self.start + (self.end - self.start) * share
    }
}

/// Pairs of master and slave positions (`SMC_CAMTable_<type>_<n>_2`, `byType` 2), both ends included.
#[doc(alias = "SMC_CAMTable")]
#[derive(Clone, Debug, PartialEq)]
pub struct PairTable {
    /// Type of the numbers.
    pub variable: VariableType,
    /// Scale of the first number of a pair.
    pub master: TableScale,
    /// Scale of the second one.
    pub slave: TableScale,
    /// True if the tangents at both ends are equal.
    pub periodic: bool,
    /// Between the points.
    pub interpolation: Interpolation,
    /// Master and slave, in units of the table, by ascending masters.
    pub pairs: Vec<[f64; 2]>,
}

impl PairTable {
    /// The curve.
    ///
    /// # Errors
    /// [`CamError`] if a scale is none, numbers do not fit their type, there are too few of them, or masters do not
    /// ascend.
    pub fn curve(&self) -> Result<Curve, CamError> {
        self.master.check("master")?;
        self.slave.check("slave")?;
        let mut knots = Vec::with_capacity(self.pairs.len());
        for (index, [master, slave]) in self.pairs.iter().enumerate() {
            let master = self.master.position(self.variable.taken(index + 1, *master)?);
            let slave = self.slave.position(self.variable.taken(index + 1, *slave)?);
            knots.push(Knot::at_rest(master, slave));
        }
        curve(knots, self.interpolation, self.periodic)
    }
}

fn curve(
    mut knots: Vec<Knot>,
    interpolation: Interpolation,
    periodic: bool,
) -> Result<Curve, CamError> {
    match interpolation {
        Interpolation::Linear => Curve::linear(&knots),
        Interpolation::Cubic => {
            set_tangents(&mut knots, periodic);
            Curve::cubic(&knots)
        }
    }
}

/// Gives every point the tangent of the parabola through it and its neighbours.
///
/// On a parabola the velocity of a chord is the mean of those at its ends: so the ends of a curve that is not periodic
/// follow from their neighbours.
fn set_tangents(knots: &mut [Knot], periodic: bool) {
    let inner: Vec<_> = knots
        .windows(3)
        .map(|three| match three {
            [a, b, c] => {
                tangent(chord(a, b), b.master - a.master, chord(b, c), c.master - b.master)
            }
            _ => 0.0,
        })
        .collect();
    let (Some([first, second]), Some([before, last])) =
        (knots.first_chunk::<2>(), knots.last_chunk::<2>())
    else {
        return;
    };
    let (begin, end) = (chord(first, second), chord(before, last));
    let ends = if periodic {
        let one = tangent(end, last.master - before.master, begin, second.master - first.master);
        [one, one]
    } else {
        let mirrored =
            |tangent: Option<&f64>, chord: f64| tangent.map_or(chord, |t| 2.0 * chord - t);
        [mirrored(inner.first(), begin), mirrored(inner.last(), end)]
    };
    let [begin, end] = ends;
    for (knot, tangent) in knots.iter_mut().zip([begin].into_iter().chain(inner).chain([end])) {
        knot.velocity = tangent;
    }
}

/// The velocity on the way from `a` to `b`.
fn chord(a: &Knot, b: &Knot) -> f64 {
    (b.slave - a.slave) / (b.master - a.master)
}

/// The velocity, where two chords of these velocities and widths meet, of the parabola through all three points.
fn tangent(before: f64, width_before: f64, after: f64, width_after: f64) -> f64 {
    (before * width_after + after * width_before) / (width_before + width_after)
}
