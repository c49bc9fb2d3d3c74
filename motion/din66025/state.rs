//! What stays from block to block, and what a block makes of it.

use super::arc;
use super::block::{Block, columns_of};
use super::decoder::Output;
use super::error::DecodeError;
use super::word::{Command, Letter, Motion, Word};
use crate::Place;
use crate::path::{ElementKind, PathElement, Shape};
use nalgebra::{Point2, Point3};

/// Acceleration and deceleration until the first E, m/s² (manual 6.5: 100 u/s²).
const DEFAULT_ACCELERATION: f64 = 0.1;

const TARGET_WORDS: [Letter; 3] = [Letter::X, Letter::Y, Letter::Z];
const ARC_WORDS: [Letter; 3] = [Letter::I, Letter::J, Letter::R];

/// The program's variables between two blocks.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Where the last block left the tool, m.
    position: Point3<f64>,
    /// The same in mm, as programmed: relative targets add up without the rounding of metres.
    position_mm: [f64; 3],
    /// The end of the last element; none before the first.
    path_end: Option<Point3<f64>>,
    /// A G92 that waits for its jump.
    jump: Option<Place>,
    motion: Motion,
    relative_targets: bool,
    relative_centers: bool,
    /// m/s, once there was an F.
    feed: Option<f64>,
    feed_reported: bool,
    /// m/s².
    acceleration: f64,
    /// m/s².
    deceleration: f64,
}

impl State {
    pub(super) fn new(start: [f64; 3]) -> Self {
        Self {
            position: Point3::from(start),
            position_mm: start.map(|metres| metres * 1e3),
            path_end: None,
            jump: None,
            motion: Motion::Line,
            relative_targets: false,
            relative_centers: true,
            feed: None,
            feed_reported: false,
            acceleration: DEFAULT_ACCELERATION,
            deceleration: DEFAULT_ACCELERATION,
        }
    }

    pub(super) fn position(&self) -> Point3<f64> {
        self.position
    }

    /// Takes over what stays of a block, right or wrong.
    pub(super) fn store(&mut self, block: &Block) {
        if let Some(feed) = block.feed {
            self.feed = Some(feed / 1e3);
        }
        if let Some(acceleration) = block.acceleration {
            self.acceleration = acceleration / 1e3;
        }
        if let Some(deceleration) = block.deceleration {
            self.deceleration = deceleration / 1e3;
        }
        match block.command {
            Some(Command::Motion(motion)) => self.motion = motion,
            Some(Command::Targets { relative }) => self.relative_targets = relative,
            Some(Command::Centers { relative }) => self.relative_centers = relative,
            Some(Command::SetPosition) | None => {}
        }
    }

    /// A missing F has been told of, in one way or another.
    pub(super) fn forgive_missing_feed(&mut self) {
        self.feed_reported = true;
    }

    /// Does what a block without errors asks for. Its words are there to point at.
    pub(super) fn execute(&mut self, block: &Block, words: &[Word], out: &mut Output) {
        let place = out.place();
        match block.command.unwrap_or(Command::Motion(self.motion)) {
            Command::Motion(motion) => self.travel(motion, block, words, out),
            Command::SetPosition => {
                Self::warn_unused(92, words, out);
                if block.target.iter().any(Option::is_some)
                    && self.move_to(block, false, words, out)
                    && self.path_end.is_some()
                {
                    self.jump = Some(place);
                }
            }
            command @ (Command::Targets { .. } | Command::Centers { .. }) => {
                let idle = |word: &&Word| {
                    TARGET_WORDS.contains(&word.letter) || ARC_WORDS.contains(&word.letter)
                };
                for word in words.iter().filter(idle) {
                    let (letter, command) = (word.letter.as_char(), command.number());
                    out.error(
                        word.columns.clone(),
                        DecodeError::WordWithoutMotion { letter, command },
                    );
                }
            }
        }
    }

    /// The jump of a G92 that no motion has followed.
    pub(super) fn finish(&mut self, out: &mut Output) {
        if let Some(place) = self.jump {
            self.jump_to(self.position, place, out);
        }
    }

    fn travel(&mut self, motion: Motion, block: &Block, words: &[Word], out: &mut Output) {
        let is_arc = matches!(motion, Motion::Arc { .. });
        let has_center = block.radius.is_some() || block.center.iter().any(Option::is_some);
        if !is_arc {
            Self::warn_unused(motion.number(), words, out);
        }
        if block.target.iter().all(Option::is_none) && !(is_arc && has_center) {
            return;
        }
        let start = self.position;
        let before = (self.position, self.position_mm);
        if !self.move_to(block, self.relative_targets, words, out) {
            return;
        }
        let end = self.position;
        let line = Shape::Line { start, end };
        let (kind, shape) = match motion {
            Motion::Rapid => (ElementKind::Rapid, line),
            Motion::Line => (ElementKind::Cut, line),
            Motion::Arc { clockwise } => match self.arc([start, end], clockwise, block, words, out)
            {
                Ok(shape) => (ElementKind::Cut, shape),
                Err(error) => {
                    out.error(columns_of(words, &ARC_WORDS), error);
                    (self.position, self.position_mm) = before;
                    return;
                }
            },
        };
        if self.feed.is_none() && (self.feed_reported || shape.length() > 0.0) {
            if !self.feed_reported {
                out.error(columns_of(words, &[Letter::G]), DecodeError::MissingFeed);
            }
            self.feed_reported = true;
            return;
        }
        if self.jump.is_some() || self.path_end.is_some_and(|end| end != start) {
            // The position was set, or motion was left out for want of a feed.
            self.jump_to(start, self.jump.unwrap_or(out.place()), out);
        }
        self.emit(out.place(), kind, shape, out);
    }

    /// Sets the position to the block's target; false if that is too far away.
    fn move_to(&mut self, block: &Block, relative: bool, words: &[Word], out: &mut Output) -> bool {
        let (mut position, mut position_mm) = (self.position, self.position_mm);
        let mut inside = true;
        for (((word, mm), metres), letter) in block
            .target
            .iter()
            .zip(&mut position_mm)
            .zip(position.coords.iter_mut())
            .zip(TARGET_WORDS)
        {
            let Some(word) = word else { continue };
            *mm = if relative { *mm + word } else { *word };
            *metres = *mm / 1e3;
            if let Some(error) = letter.check(*mm) {
                out.error(columns_of(words, &[letter]), error);
                inside = false;
            }
        }
        if inside {
            (self.position, self.position_mm) = (position, position_mm);
        }
        inside
    }

    /// The shape of G2 and G3: a straight line where no such arc can be.
    ///
    /// # Errors
    /// If the words do not say which arc.
    fn arc(
        &self,
        [start, end]: [Point3<f64>; 2],
        clockwise: bool,
        block: &Block,
        words: &[Word],
        out: &mut Output,
    ) -> Result<Shape, DecodeError> {
        let (arc, letters): (_, &[Letter]) = match block.radius {
            Some(_) if block.center.iter().any(Option::is_some) => {
                return Err(DecodeError::RadiusAndCenter);
            }
            Some(radius_mm) => {
                if radius_mm < 0.0 {
                    out.warning(
                        columns_of(words, &[Letter::R]),
                        DecodeError::NegativeRadius { radius_mm },
                    );
                }
                (arc::by_radius(start, end, radius_mm.abs() / 1e3, clockwise), &[Letter::R])
            }
            None => {
                let center = self.center(start, block)?;
                (arc::about_center(start, end, center, clockwise), &[Letter::I, Letter::J])
            }
        };
        Ok(match arc {
            Ok(arc) => Shape::Arc(arc),
            Err(error) => {
                out.warning(columns_of(words, letters), error);
                Shape::Line { start, end }
            }
        })
    }

    /// The centre I and J say, m. Relative ones are 0 where they are left out.
    fn center(&self, start: Point3<f64>, block: &Block) -> Result<Point2<f64>, DecodeError> {
        let [i, j] = block.center.map(|word| word.map(|mm| mm / 1e3));
        if i.is_none() && j.is_none() {
            return Err(DecodeError::ArcWithoutCenter);
        }
        if self.relative_centers {
            return Ok(Point2::new(
                start.x + i.unwrap_or_default(),
                start.y + j.unwrap_or_default(),
            ));
        }
        let i = i.ok_or(DecodeError::IncompleteCenter { missing: 'I' })?;
        let j = j.ok_or(DecodeError::IncompleteCenter { missing: 'J' })?;
        Ok(Point2::new(i, j))
    }

    /// Warns of I, J and R, which G`command` does not look at.
    fn warn_unused(command: u8, words: &[Word], out: &mut Output) {
        for word in words.iter().filter(|word| ARC_WORDS.contains(&word.letter)) {
            let letter = word.letter.as_char();
            out.warning(word.columns.clone(), DecodeError::UnusedWord { letter, command });
        }
    }

    /// Lets the set-point jump from where the path ended to `to`.
    fn jump_to(&mut self, to: Point3<f64>, place: Place, out: &mut Output) {
        let start = self.path_end.unwrap_or(to);
        self.emit(place, ElementKind::Jump, Shape::Line { start, end: to }, out);
    }

    fn emit(&mut self, place: Place, kind: ElementKind, shape: Shape, out: &mut Output) {
        self.jump = None;
        self.path_end = Some(shape.end());
        out.element(PathElement {
            // Nothing is travelled without a feed: those have no length.
            feed: self.feed.unwrap_or_default(),
            acceleration: self.acceleration,
            deceleration: self.deceleration,
            ..PathElement::new(place, kind, shape)
        });
    }
}
