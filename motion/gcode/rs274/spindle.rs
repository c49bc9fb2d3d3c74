//! Spindle: speed (S, G96, G97), direction (M3 to M5, M19), and the feeds that follow from it.

use super::block::{Block, Letter, Letters};
use super::error::{DecodeError, Problem};
use super::offsets::Location;
use super::options::LengthUnit;
use super::output::Output;
use super::state::{MAX_SPEED, State};
use super::word::{FeedMode, Motion};
use std::f64::consts::TAU;
use twin_path::{ElementKind, MParameters, Spindle};

/// Constant surface speed (G96).
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceSpeed {
    /// Largest speed of the spindle (D), revolutions per minute; infinite without D.
    limit: f64,
    /// Metres in the unit of S: 1, or 0.3048 after G20.
    unit: f64,
}

impl State {
    /// `$` in the words of a block if something in it is for a spindle, as LinuxCNC sees it.
    pub(super) fn spindle_words(block: &Block, motion: Option<Motion>) -> Letters {
        let uses = block.m.spindle.is_some()
            || block.get(Letter::S).is_some()
            || matches!(motion, Some(Motion::Thread(_)));
        if uses { Letters::of("$") } else { Letters::default() }
    }

    /// Checks that `$` is the only spindle, or all of them (-1) where LinuxCNC takes that.
    ///
    /// # Errors
    /// [`DecodeError::Spindle`] and [`DecodeError::NotWhole`].
    pub(super) fn check_spindle_number(
        block: &Block,
        motion: Option<Motion>,
    ) -> Result<(), Problem> {
        let Some(number) = block.get(Letter::SPINDLE) else { return Ok(()) };
        let takes_all = match motion {
            Some(Motion::Thread(_)) => false,
            Some(Motion::Cycle(cycle)) if cycle.taps() => false,
            _ => {
                block.m.spindle != Some(19)
                    && block.g.surface_speed.is_none()
                    && block.g.feed_mode != Some(FeedMode::PerRevolution)
            }
        };
        if number == 0.0 || takes_all && number + 1.0 == 0.0 {
            return Ok(());
        }
        Err(block.at(Letter::SPINDLE, DecodeError::Spindle { number, takes_all }))
    }

    /// G96, G97 and S.
    pub(super) fn set_speed(&mut self, block: &Block) -> Result<(), Problem> {
        let unit = match self.units {
            LengthUnit::Millimetre => 1.0,
            LengthUnit::Inch => 0.3048,
        };
        let speed = Self::in_range(block, Letter::S, MAX_SPEED)?;
        match block.g.surface_speed {
            Some(true) if speed.is_none() => {
                return Err(DecodeError::missing("G96", 'S').into());
            }
            Some(true) => {
                let limit = block.get(Letter::D).map_or(f64::INFINITY, f64::abs);
                self.surface_speed = Some(SurfaceSpeed { limit, unit });
            }
            Some(false) => self.surface_speed = None,
            None => {}
        }
        if let Some(speed) = speed {
            self.speed = Some(speed);
            if let Some(surface) = &mut self.surface_speed {
                surface.unit = unit;
            }
        }
        Ok(())
    }

    /// Revolutions per minute with the tool at X `x` of the program; infinite at X0 with G96 and no D.
    fn speed_at(&self, x: f64) -> f64 {
        let speed = self.speed.unwrap_or(0.0);
        match self.surface_speed {
            Some(surface) if speed > 0.0 => {
                let radius = self.units.to_metres(x).abs();
                (speed * surface.unit / (TAU * radius)).min(surface.limit)
            }
            _ => speed,
        }
    }

    /// The spindle along the element that ends here, if elements carry it; with G96 the speed is that of its end, of a
    /// thread the lowest.
    pub(super) fn spindle_along(&self) -> Option<Spindle> {
        let speed = self.speed.filter(|_| self.keep_words);
        let at_end = || self.speed_at(self.location.program[0]);
        let speed = speed.map(|_| self.synchronized.unwrap_or_else(at_end))?;
        let synchronized = self.synchronized.is_some();
        speed.is_finite().then_some(Spindle { speed, synchronized })
    }

    /// Lowest speed of the spindle on the straight line to `to`, revolutions per minute.
    ///
    /// # Errors
    /// [`DecodeError::ZeroSpeed`] and [`DecodeError::SurfaceSpeedAtCenter`].
    pub(super) fn speed_to(&self, to: &Location) -> Result<f64, DecodeError> {
        let [from, to] = [&self.location, to].map(|at| self.speed_at(at.program[0]));
        let speed = from.min(to);
        if speed <= 0.0 {
            return Err(DecodeError::ZeroSpeed);
        }
        if speed.is_finite() { Ok(speed) } else { Err(DecodeError::SurfaceSpeedAtCenter) }
    }

    /// M3 to M5 and M19.
    pub(super) fn turn_spindle(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        match block.m.spindle {
            Some(5) => {
                self.spindle = None;
                self.m_function(5, None, out);
            }
            Some(19) => {
                let angle = Self::in_range(block, Letter::R, 360.0)?;
                Self::in_range(block, Letter::P, 2.0)?;
                let direction = block.whole(Letter::P, 0)?;
                if let Some(seconds) = block.get(Letter::Q) {
                    block.check_above("M19", Letter::Q, seconds, 0.0)?;
                }
                self.spindle = None;
                self.orient_spindle(angle.unwrap_or(0.0), direction.map(f64::from), out);
            }
            Some(number) => self.start_spindle(number, 1.0, out),
            None => {}
        }
        Ok(())
    }

    /// M3 or M4 with `scale` times the speed S.
    pub(super) fn start_spindle(&mut self, number: u16, scale: f64, out: &mut Output) {
        self.spindle = Some(number);
        let speed = self.speed.map(|_| scale * self.speed_at(self.location.program[0]));
        self.m_function(number, speed.filter(|speed| speed.is_finite()), out);
    }

    /// M5, if the spindle turns.
    pub(super) fn stop_spindle(&mut self, out: &mut Output) {
        if self.spindle.take().is_some() {
            self.m_function(5, None, out);
        }
    }

    /// M19: `angle` in degrees as parameter K, the direction P as L.
    pub(super) fn orient_spindle(&mut self, angle: f64, direction: Option<f64>, out: &mut Output) {
        let parameters = MParameters { k: Some(angle), l: direction, ..MParameters::default() };
        self.stand(ElementKind::MFunction { number: 19 }, parameters, out);
    }

    /// Checks that the spindle turns with one of `numbers`, M3 and M4.
    ///
    /// # Errors
    /// [`DecodeError::SpindleDirection`].
    pub(super) fn check_spindle(&self, motion: Motion, numbers: &[u16]) -> Result<(), DecodeError> {
        if self.spindle.is_some_and(|number| numbers.contains(&number)) {
            return Ok(());
        }
        let needed = match numbers {
            [3] => "M3",
            [4] => "M4",
            _ => "M3 or M4",
        };
        let found = match self.spindle {
            None => "is off",
            Some(3) => "turns with M3",
            Some(_) => "turns with M4",
        };
        Err(DecodeError::SpindleDirection { motion: motion.number(), needed, found })
    }
}
