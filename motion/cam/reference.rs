//! [`Cam`]: description, curve and tappets of a cam that can be followed (`MC_CAM_REF`, manual 4.7).

use super::curve::Curve;
use super::error::CamError;
use super::knot::Knot;
use super::table::{Equidistant, PairTable};
use super::tappet::Tappet;

/// Description of a cam (`byType`).
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// 1: slave positions at equal distances of the master.
    Equidistant(Equidistant),
    /// 2: pairs of master and slave.
    Pairs(PairTable),
    /// 3: points with velocity and acceleration (XYVA).
    Polynomial(Vec<Knot>),
}

impl Shape {
    /// The manual's number.
    pub const fn number(&self) -> u8 {
        match self {
            Self::Equidistant(_) => 1,
            Self::Pairs(_) => 2,
            Self::Polynomial(_) => 3,
        }
    }

    /// Number of its elements (`nElements`).
    pub fn len(&self) -> usize {
        match self {
            Self::Equidistant(table) => table.values.len(),
            Self::Pairs(table) => table.pairs.len(),
            Self::Polynomial(knots) => knots.len(),
        }
    }

    /// True if it has no element.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn curve(&self) -> Result<Curve, CamError> {
        match self {
            Self::Equidistant(table) => table.curve(),
            Self::Pairs(table) => table.curve(),
            Self::Polynomial(knots) => Curve::polynomial(knots),
        }
    }
}

/// A cam (`MC_CAM_REF`, manual 4.7). Its curve always belongs to its description.
#[doc(alias = "MC_CAM_REF")]
#[derive(Clone, Debug, PartialEq)]
pub struct Cam {
    name: String,
    shape: Shape,
    curve: Curve,
    tappets: Vec<Tappet>,
}

impl Cam {
    /// Makes the curve. Tappets are put in the order of their masters.
    ///
    /// # Errors
    /// [`CamError`] if the description makes no curve, or a tappet lies outside the range of the master or has times
    /// below 0.
    pub fn new(name: &str, shape: Shape, mut tappets: Vec<Tappet>) -> Result<Self, CamError> {
        let curve = shape.curve()?;
        for (index, tappet) in (1..).zip(&tappets) {
            if !curve.contains(tappet.master) {
                let (min, max) = (curve.start(), curve.end());
                let (what, master) = ("tappet", tappet.master);
                return Err(CamError::OutsideScale { what, index, master, min, max });
            }
            tappet.check(index)?;
        }
        tappets.sort_by(|a, b| a.master.total_cmp(&b.master));
        Ok(Self { name: name.to_owned(), shape, curve, tappets })
    }

    /// Its name (`strCAMName`).
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its description (`byType`, `nElements`, `pce`).
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The curve (`xStart`, `xEnd` are its range).
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The tappets by ascending masters (`nTappets`, `pt`).
    pub fn tappets(&self) -> &[Tappet] {
        &self.tappets
    }
}
