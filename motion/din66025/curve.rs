//! The curves of a block: G2, G3, G6, G8, G9.

use super::arc;
use super::block::{Block, columns_of};
use super::decoder::Output;
use super::error::DecodeError;
use super::word::{Letter, Motion, Word};
use crate::path::{Cubic, Ellipse, Shape};
use nalgebra::{Point2, Point3};

/// What a block says of its curve.
pub(super) struct CurveWords<'a> {
    pub(super) block: &'a Block,
    pub(super) words: &'a [Word],
    /// I and J count from the start (G99).
    pub(super) relative_centers: bool,
}

impl CurveWords<'_> {
    /// The shape of `motion` from `start` to `end` (m): a straight line where no such curve can be.
    ///
    /// # Errors
    /// If the words do not say which.
    pub(super) fn shape(
        &self,
        motion: Motion,
        start: Point3<f64>,
        end: Point3<f64>,
        out: &mut Output,
    ) -> Result<Shape, DecodeError> {
        match motion {
            Motion::Rapid | Motion::Line | Motion::Spline => Ok(Shape::Line { start, end }),
            Motion::Arc { clockwise } => self.arc(start, end, clockwise, out),
            Motion::Parabola => {
                let number = motion.number();
                let control =
                    self.center(start)?.ok_or(DecodeError::CurveWithoutPoint { number })?;
                Ok(Shape::Cubic(Box::new(Cubic::parabola(start, control, end))))
            }
            Motion::Ellipse { clockwise } => {
                let number = motion.number();
                let center =
                    self.center(start)?.ok_or(DecodeError::CurveWithoutPoint { number })?;
                let direction = self.block.k.unwrap_or_default().to_radians();
                let ratio = self.block.radius;
                Ok(match Ellipse::through(start, end, center, direction, ratio, clockwise) {
                    Ok(ellipse) => Shape::Ellipse(Box::new(ellipse)),
                    Err(error) => {
                        let columns = columns_of(self.words, motion.words());
                        out.warning(columns, DecodeError::NoEllipse(error));
                        Shape::Line { start, end }
                    }
                })
            }
        }
    }

    fn arc(
        &self,
        start: Point3<f64>,
        end: Point3<f64>,
        clockwise: bool,
        out: &mut Output,
    ) -> Result<Shape, DecodeError> {
        let (arc, letters): (_, &[Letter]) = match self.block.radius {
            Some(_) if self.block.center.iter().any(Option::is_some) => {
                return Err(DecodeError::RadiusAndCenter);
            }
            Some(radius_mm) => {
                if radius_mm < 0.0 {
                    out.warning(
                        columns_of(self.words, &[Letter::R]),
                        DecodeError::NegativeRadius { radius_mm },
                    );
                }
                (arc::by_radius(start, end, radius_mm.abs() / 1e3, clockwise), &[Letter::R])
            }
            None => {
                let center = self.center(start)?.ok_or(DecodeError::ArcWithoutCenter)?;
                (arc::about_center(start, end, center, clockwise), &[Letter::I, Letter::J])
            }
        };
        Ok(match arc {
            Ok(arc) => Shape::Arc(arc),
            Err(error) => {
                out.warning(columns_of(self.words, letters), error);
                Shape::Line { start, end }
            }
        })
    }

    /// The point that I and J say, m; none if there is neither. Relative ones are 0 where they are left out.
    fn center(&self, start: Point3<f64>) -> Result<Option<Point2<f64>>, DecodeError> {
        let [i, j] = self.block.center.map(|word| word.map(|mm| mm / 1e3));
        if i.is_none() && j.is_none() {
            return Ok(None);
        }
        if self.relative_centers {
            return Ok(Some(Point2::new(
                start.x + i.unwrap_or_default(),
                start.y + j.unwrap_or_default(),
            )));
        }
        let i = i.ok_or(DecodeError::IncompleteCenter { missing: 'I' })?;
        let j = j.ok_or(DecodeError::IncompleteCenter { missing: 'J' })?;
        Ok(Some(Point2::new(i, j)))
    }
}
