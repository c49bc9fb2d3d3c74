//! Modal state of the DIN 66025 interpreter: modes, feed, target and variables between blocks, and the execution of a
//! block.

use super::block::{Block, Operand, columns_of};
use super::curve::CurveWords;
use super::emit::Emitter;
use super::error::DecodeError;
use super::idle;
use super::output::Output;
use super::variables::{INT, Variables};
use super::word::{Command, Letter, Motion, Word};
use nalgebra::Point3;
use std::ops::Range;
use twin_path::Place;
use twin_path::{
    AxisMask, Details, ElementKind, ExtraAxes, ExtraPosition, MParameters, Marks, PathElement,
    Shape,
};

/// Acceleration and deceleration until the first E, m/s² (manual 6.5: 100 u/s²).
const DEFAULT_ACCELERATION: f64 = 0.1;

/// The implicit variable of G36, G37 and G20 at the beginning.
const IMPLICIT: f64 = -1.0;

/// The parameters of an M function without O, if there are any (manual 3.2.2).
const GLOBAL_PARAMETERS: &str = "gSMC_MParameters";

const TARGET_WORDS: [Letter; 8] =
    [Letter::X, Letter::Y, Letter::Z, Letter::P, Letter::Q, Letter::U, Letter::V, Letter::W];

/// The program's variables between two blocks.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "modes of the language, each on or off")]
pub(super) struct State {
    /// Where the last block left the tool, m.
    position: Point3<f64>,
    /// And the extra axes, u.
    extra: ExtraPosition,
    /// True if they have been named.
    has_extra: bool,
    /// The same in mm, as programmed: relative targets add up without the rounding of metres.
    programmed: [f64; 8],
    /// The end of the last element; none before the first.
    path_end: Option<(Point3<f64>, ExtraPosition)>,
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
    /// D as programmed.
    d: f64,
    s_profile: AxisMask,
    implicit: f64,
    pub(super) variables: Variables,
    emitter: Emitter,
}

/// A G20 whose condition holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JumpTo {
    /// The N word of the block to go on with.
    pub(super) block: u32,
    /// The L word, to point at.
    pub(super) columns: Range<usize>,
}

impl State {
    pub(super) fn new(start: [f64; 3], extra: ExtraPosition, variables: Variables) -> Self {
        let mut programmed = [0.0; 8];
        let values = start.iter().map(|metres| metres * 1e3).chain(extra);
        programmed.iter_mut().zip(values).for_each(|(slot, value)| *slot = value);
        Self {
            position: Point3::from(start),
            extra,
            has_extra: extra.iter().any(|value| *value != 0.0),
            programmed,
            path_end: None,
            jump: None,
            motion: Motion::Line,
            relative_targets: false,
            relative_centers: true,
            feed: None,
            feed_reported: false,
            acceleration: DEFAULT_ACCELERATION,
            deceleration: DEFAULT_ACCELERATION,
            d: 0.0,
            s_profile: AxisMask::default(),
            implicit: IMPLICIT,
            variables,
            emitter: Emitter::default(),
        }
    }

    pub(super) fn position(&self) -> Point3<f64> {
        self.position
    }

    /// The last element, which waits for the next.
    pub(super) fn held(&self) -> Option<&PathElement> {
        self.emitter.held()
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
        // Of G36 and G37 it is the value.
        if let Some(d) = block.d
            && !matches!(block.command, Some(Command::Variable { .. }))
        {
            self.d = d;
        }
        let [on, off] = block.profiles;
        self.s_profile = self.s_profile.with(on).without(off);
        match block.command {
            Some(Command::Motion(motion)) => self.motion = motion,
            Some(Command::Targets { relative }) => self.relative_targets = relative,
            Some(Command::Centers { relative }) => self.relative_centers = relative,
            _ => {}
        }
    }

    /// A missing F has been reported.
    pub(super) fn forgive_missing_feed(&mut self) {
        self.feed_reported = true;
    }

    /// Does what a block without errors asks for; its words, in `line`, are there to point at. Returns where to go on if
    /// that is not the next line.
    pub(super) fn execute(
        &mut self,
        block: &Block,
        words: &[Word],
        line: &[u8],
        out: &mut Output,
    ) -> Option<JumpTo> {
        let parameters = self
            .parameters(block, line)
            .map_err(|error| out.error(columns_of(words, &[Letter::O]), error))
            .ok()?;
        let mut jump = None;
        let mut moved = false;
        match block.command.unwrap_or(Command::Motion(self.motion)) {
            Command::Motion(motion) => moved = self.travel(motion, block, words, out)?,
            Command::SetPosition => {
                if block.target.iter().any(Option::is_some)
                    && self.move_to(block, false, words, out)
                    && self.path_end.is_some()
                {
                    self.jump = Some(out.place);
                }
            }
            Command::Jump => jump = self.jump_target(block, words, out),
            Command::Variable { add } => self.set_variable(add, block, words, line, out),
            Command::Preparation { starts, ends, .. } => {
                self.prepare(starts, ends, words, out);
            }
            Command::Targets { .. } | Command::Centers { .. } => {}
        }
        let command = block.command.unwrap_or(Command::Motion(self.motion));
        idle::complain(command, block, moved, words, out);
        if let Some(number) = block.m {
            self.auxiliary(number, block, parameters, out);
        }
        jump
    }

    /// The jump of a G92 that no motion has followed, and what is held back.
    pub(super) fn finish(&mut self, out: &mut Output) {
        if let Some(place) = self.jump {
            self.jump_to(self.position, self.extra, place, out);
        }
        self.emitter.finish(out);
    }

    /// False if the block moves nothing; none if it has turned out to be wrong.
    fn travel(
        &mut self,
        motion: Motion,
        block: &Block,
        words: &[Word],
        out: &mut Output,
    ) -> Option<bool> {
        let turns = matches!(motion, Motion::Arc { .. } | Motion::Ellipse { .. });
        let has_center = block.center.iter().any(Option::is_some)
            || matches!(motion, Motion::Arc { .. }) && block.radius.is_some();
        if block.target.iter().all(Option::is_none) && !(turns && has_center) {
            return Some(false);
        }
        let (start, extra) = (self.position, self.extra);
        let before = (self.position, self.extra, self.programmed);
        if !self.move_to(block, self.relative_targets, words, out) {
            return None;
        }
        let curve = CurveWords { block, words, relative_centers: self.relative_centers };
        let shape = match curve.shape(motion, start, self.position, out) {
            Ok(shape) => shape,
            Err(error) => {
                out.error(columns_of(words, motion.words()), error);
                (self.position, self.extra, self.programmed) = before;
                return None;
            }
        };
        let kind = if motion == Motion::Rapid { ElementKind::Rapid } else { ElementKind::Cut };
        let mut element = self.element(out.place, kind, shape, extra);
        if self.feed.is_none() && (self.feed_reported || element.length() > 0.0) {
            if !self.feed_reported {
                out.error(columns_of(words, &[Letter::G]), DecodeError::MissingFeed);
            }
            self.feed_reported = true;
            return None;
        }
        let at = (start, extra);
        if self.jump.is_some() || self.path_end.is_some_and(|end| end != at) {
            // The position was set, or motion was left out for want of a feed.
            self.jump_to(start, extra, self.jump.unwrap_or(out.place), out);
        }
        let requests = if block.switches.first().is_some_and(Option::is_some) {
            block.switches.iter().flatten().cloned().collect()
        } else {
            Vec::new()
        };
        self.jump = None;
        self.path_end = Some((self.position, self.extra));
        element.tool_radius = self.d / 1e3;
        self.emitter.element(element, motion == Motion::Spline, requests, out);
        Some(true)
    }

    /// Sets the position to the block's target; false if that is too far away.
    fn move_to(&mut self, block: &Block, relative: bool, words: &[Word], out: &mut Output) -> bool {
        let mut programmed = self.programmed;
        let mut inside = true;
        let [target_x, target_y, target_z, extra @ ..] = &block.target;
        let names_extra = extra.iter().any(Option::is_some);
        let count = if names_extra { TARGET_WORDS.len() } else { 3 };
        let words_of = block.target.iter().zip(&mut programmed).zip(TARGET_WORDS);
        for ((word, value), letter) in words_of.take(count) {
            let Some(word) = word else { continue };
            *value = if relative { *value + word } else { *word };
            if let Some(error) = letter.check(*value) {
                out.error(columns_of(words, &[letter]), error);
                inside = false;
            }
        }
        if inside {
            self.programmed = programmed;
            let [x, y, z, p, q, u, v, w] = programmed;
            for ((slot, mm), word) in
                self.position.coords.iter_mut().zip([x, y, z]).zip([target_x, target_y, target_z])
            {
                if word.is_some() {
                    *slot = mm / 1e3;
                }
            }
            if names_extra {
                self.has_extra = true;
                self.extra = [p, q, u, v, w];
            }
        }
        inside
    }

    /// An element that ends where the tool is now and starts with the extra axes at `extra`.
    fn element(
        &self,
        place: Place,
        kind: ElementKind,
        shape: Shape,
        extra: ExtraPosition,
    ) -> PathElement {
        let smooth_z = self.s_profile.contains(AxisMask::Z)
            && shape.start().z.to_bits() != shape.end().z.to_bits();
        let details = (self.has_extra || smooth_z).then(|| {
            Box::new(Details {
                extra: self.has_extra.then_some(ExtraAxes { start: extra, end: self.extra }),
                s_profile: if kind.is_motion() { self.s_profile } else { AxisMask::default() },
                ..Details::default()
            })
        });
        PathElement {
            // Nothing is travelled without a feed: those have no length.
            feed: self.feed.unwrap_or_default(),
            acceleration: self.acceleration,
            deceleration: self.deceleration,
            details,
            ..PathElement::new(place, kind, shape)
        }
    }

    /// Lets the set-point jump from where the path ended to `to`.
    fn jump_to(
        &mut self,
        to: Point3<f64>,
        to_extra: ExtraPosition,
        place: Place,
        out: &mut Output,
    ) {
        let (start, extra) = self.path_end.unwrap_or((to, to_extra));
        let mut element =
            self.element(place, ElementKind::Jump, Shape::Line { start, end: to }, extra);
        if let Some(details) = &mut element.details
            && let Some(extra) = &mut details.extra
        {
            extra.end = to_extra;
        }
        self.jump = None;
        self.path_end = Some((to, to_extra));
        self.emitter.element(element, false, Vec::new(), out);
    }

    /// The parameters that O gives the block's M function, if it has one, or else the global ones. An O that an H has
    /// taken is not for it.
    fn parameters(&self, block: &Block, line: &[u8]) -> Result<Option<[f64; 8]>, DecodeError> {
        if block.m.is_none() {
            return Ok(None);
        }
        let is_switch = block.switches.first().is_some_and(Option::is_some);
        let given = match &block.o {
            Some(Operand::Name(name)) => {
                let name = text(line, name);
                let parameters = self.variables.parameters(&name);
                if parameters.is_none() && !is_switch {
                    return Err(DecodeError::UnknownParameters(name));
                }
                parameters
            }
            Some(Operand::Number(value)) if !is_switch => {
                return Err(DecodeError::ParametersExpected(*value));
            }
            _ => None,
        };
        Ok(given.or_else(|| self.variables.parameters(GLOBAL_PARAMETERS)))
    }

    /// An M function: the path waits where the block has led.
    fn auxiliary(&mut self, number: f64, block: &Block, o: Option<[f64; 8]>, out: &mut Output) {
        let at = (self.position, self.extra);
        if self.jump.is_some() || self.path_end.is_some_and(|end| end != at) {
            self.jump_to(self.position, self.extra, self.jump.unwrap_or(out.place), out);
        }
        let shape = Shape::Line { start: self.position, end: self.position };
        let kind = ElementKind::MFunction { number: auxiliary_number(number) };
        let mut element = self.element(out.place, kind, shape, self.extra);
        let parameters = MParameters { k: block.k, l: block.l, o };
        if parameters != MParameters::default() {
            element.details.get_or_insert_default().parameters = parameters;
        }
        self.path_end = Some(at);
        self.emitter.element(element, false, Vec::new(), out);
    }

    fn prepare(&mut self, starts: Marks, ends: Marks, words: &[Word], out: &mut Output) {
        if starts != Marks::default() && starts != Marks::LOOPS && self.d < 0.0 {
            let columns = columns_of(words, &[Letter::D]);
            return out.error(columns, DecodeError::NegativeToolRadius(self.d));
        }
        self.emitter.mark(starts, ends);
    }

    /// G36 and G37: the variable that O names, or the implicit one, becomes D or grows by it.
    fn set_variable(
        &mut self,
        add: bool,
        block: &Block,
        words: &[Word],
        line: &[u8],
        out: &mut Output,
    ) {
        let command = Command::Variable { add }.number();
        let Some(value) = block.d else {
            return out.error(columns_of(words, &[Letter::G]), DecodeError::ValueMissing(command));
        };
        let changed = match &block.o {
            None => {
                let sum = if add { self.implicit + value } else { value };
                INT.hold(sum).map(|held| self.implicit = held)
            }
            Some(Operand::Name(name)) => {
                let name = text(line, name);
                self.variables
                    .change(&name, add, value)
                    .unwrap_or(Err(DecodeError::UnknownVariable(name)))
            }
            Some(Operand::Number(value)) => Err(DecodeError::VariableExpected(*value)),
        };
        if let Err(error) = changed {
            let overflow = matches!(error, DecodeError::VariableOverflow { .. });
            let letter = if overflow { Letter::D } else { Letter::O };
            out.error(columns_of(words, &[letter]), error);
        }
    }

    /// G20: where to go on, if K (or the implicit variable) is not 0.
    fn jump_target(&self, block: &Block, words: &[Word], out: &mut Output) -> Option<JumpTo> {
        let Some(target) = block.l else {
            out.error(columns_of(words, &[Letter::G]), DecodeError::JumpWithoutTarget);
            return None;
        };
        let columns = columns_of(words, &[Letter::L]);
        if let Some(error) = Letter::N.check(target) {
            let error = match error {
                DecodeError::OutOfRange { min, max, unit, .. } => {
                    DecodeError::OutOfRange { letter: 'L', value: target, min, max, unit }
                }
                _ => DecodeError::NotWhole { letter: 'L', value: target },
            };
            out.error(columns, error);
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked as a block number"
        )]
        let block_number = target as u32;
        let condition = block.k.unwrap_or(self.implicit);
        (condition != 0.0).then_some(JumpTo { block: block_number, columns })
    }
}

/// The text of a name.
fn text(line: &[u8], name: &Range<usize>) -> String {
    String::from_utf8_lossy(line.get(name.clone()).unwrap_or_default()).trim().to_owned()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "Letter::check lets only whole u16 pass"
)]
fn auxiliary_number(number: f64) -> u16 {
    number as u16
}
