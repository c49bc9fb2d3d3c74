//! Curves of a block: G2, G3, G6, G8, G9.

use super::arc;
use super::block::{Block, columns_of};
use super::error::DecodeError;
use super::output::Output;
use super::word::{Letter, Motion, Word};
use nalgebra::{Point2, Point3};
use twin_path::{Cubic, Ellipse, Shape};

/// A control point of a parabola closer than this to a line is on it, m (manual 6.4, `g_fSMC_CNC_EPS_RELUCTANT`).
const ON_LINE: f64 = 1e-9;
/// R may differ this much from the ratio that start and end determine: programs round.
const RATIO_TOLERANCE: f64 = 1e-3;

/// Words of a block that describe its curve.
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
                let control = self.center(start)?.ok_or(DecodeError::CurveWithoutPoint(number))?;
                Ok(self.parabola(start, control, end, out))
            }
            Motion::Ellipse { clockwise } => {
                let number = motion.number();
                let center = self.center(start)?.ok_or(DecodeError::CurveWithoutPoint(number))?;
                let direction = self.block.k.unwrap_or_default().to_radians();
                let ratio = self.block.radius;
                Ok(match Ellipse::through(start, end, center, direction, ratio, clockwise) {
                    Ok(ellipse) => {
                        let actual = ellipse.minor() / ellipse.major().norm();
                        if let Some(given) = ratio
                            && (given - actual).abs() > RATIO_TOLERANCE
                        {
                            let columns = columns_of(self.words, &[Letter::R]);
                            out.warning(columns, DecodeError::OtherRatio { given, ratio: actual });
                        }
                        Shape::Ellipse(Box::new(ellipse))
                    }
                    Err(error) => {
                        let columns = columns_of(self.words, motion.words());
                        out.warning(columns, DecodeError::NoEllipse(error));
                        Shape::Line { start, end }
                    }
                })
            }
        }
    }

    /// The parabola whose tangents meet at `control` (m). On one line it is that line, or runs out on it and back.
    fn parabola(
        &self,
        start: Point3<f64>,
        control: Point2<f64>,
        end: Point3<f64>,
        out: &mut Output,
    ) -> Shape {
        let chord = (end - start).xy();
        let [to, from] = [control - start.xy(), end.xy() - control];
        let length = chord.norm();
        if length > ON_LINE && chord.perp(&to).abs() / length > ON_LINE {
            return Shape::Cubic(Box::new(Cubic::parabola(start, control, end)));
        }
        if to.dot(&chord) < 0.0 || from.dot(&chord) < 0.0 || length <= ON_LINE {
            let columns = columns_of(self.words, &[Letter::I, Letter::J]);
            out.warning(columns, DecodeError::StraightParabola);
        }
        Shape::Line { start, end }
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
        let i = i.ok_or(DecodeError::IncompleteCenter('I'))?;
        let j = j.ok_or(DecodeError::IncompleteCenter('J'))?;
        Ok(Some(Point2::new(i, j)))
    }
}
