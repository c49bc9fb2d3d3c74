//! Cutter radius compensation (G40, G41, G42, G41.1, G42.1): the tool's centre next to the programmed contour.
//!
//! ```text
//! G41 D1        left of the contour by the radius of tool 1; G42 right; without D the tool in the spindle
//! G1 X10 Y0     entry move: straight to the point next to the end of this move, or an arc (G2, G3)
//! X50           contour; the end of each move is known when the next one is read
//! G40           the last move ends next to its end
//! G1 X60 Y-20   exit move: straight, from there to its programmed end
//! ```
//!
//! The rules are LinuxCNC's, so that the moves are. An outer corner gets an arc about the corner (of a rapid: a
//! straight move), in the line of the move behind the corner. An inner corner cuts off the end of the move before it.
//! Hence the last move in the plane waits in a queue ([`Queue`]), and with it everything that comes before the next
//! one: moves along the normal, dwells and M functions. The queue is the only look-ahead.
//!
//! Errors are LinuxCNC's too: an inner corner that the tool cannot enter is an error that names both lines. Only
//! neighbouring moves are compared. [`twin_path::prepare`](twin_path) looks for gouges between any two moves of a
//! contour, and its corners differ: it has the whole contour, and this decoder one move.
//!
//! Everything is calculated in the machine frame (m) and in the components of the plane, mirrored for G42: the tool is
//! always to the left then.

mod corner;
mod moves;
mod queue;

use super::block::{Block, Letter};
use super::error::{DecodeError, Problem};
use super::offsets::{Home, Location};
use super::options::Position;
use super::output::Output;
use super::state::State;
use super::word::{Compensate, Motion, OneShot};
use corner::Frame;
use nalgebra::Vector2;
use queue::Queue;
use twin_path::Plane;

/// The largest number of moves, dwells and M functions that wait for the next move in the plane.
const MAX_WAITING: usize = 10_000;

/// Compensation in force, if any, and the moves that wait for the next corner.
#[derive(Debug, Default)]
pub(super) struct Compensation {
    cutter: Option<Cutter>,
    queue: Queue,
    /// Position of the tool while that is not the programmed one: during compensation, and behind it until the exit
    /// move. Machine frame.
    pub(super) tool: Option<Position>,
    /// The next move is the exit move.
    arc_forbidden: bool,
    /// The path is as programmed; see [`State::ignore_compensation`].
    ignored: bool,
}

/// The tool next to the contour.
#[derive(Clone, Copy, Debug)]
struct Cutter {
    frame: Frame,
    /// m.
    radius: f64,
    /// From the centre of the radius to the point whose path it is, of a lathe tool, m.
    shift: [f64; 3],
    /// Its centre at the end of the last move, in the frame; none before the entry move.
    center: Option<Vector2<f64>>,
}

impl State {
    /// Leaves the path as it is programmed: G41 and G42 act as with a tool without radius, and nothing waits.
    pub(super) fn ignore_compensation(&mut self) {
        self.compensation.ignored = true;
    }

    /// Position of the tool, where the next element begins.
    pub(super) fn tool_position(&self) -> Position {
        self.compensation.tool.unwrap_or(self.location.machine)
    }

    /// Checks what comes before G40 in LinuxCNC's order.
    pub(super) fn check_before_compensation(
        &mut self,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if self.compensation.cutter.is_none() {
            // Nothing waits but behind an error.
            self.release(out);
            return Ok(());
        }
        if self.compensation.queue.len() >= MAX_WAITING {
            self.interrupt_compensation(out);
            return Err(DecodeError::CompensationQueue(MAX_WAITING).into());
        }
        let refused = |word| Err(DecodeError::Compensated(word).into());
        match block.g.plane {
            Some(plane) if plane != self.plane || block.g.parallel_plane == Some(true) => {
                refused("another plane (G17 to G19.1)")
            }
            _ if block.m.input_output.is_some() => refused("an input or output (M62 to M68)"),
            _ if block.m.overrides.is_some() => refused("an override switch (M48 to M53)"),
            _ if block.m.tool_change == Some(6) => refused("M6"),
            _ => Ok(()),
        }
    }

    /// Checks that nothing in `block` excludes compensation, if it is on.
    pub(super) fn check_compensated(
        &self,
        block: &Block,
        motion: Option<Motion>,
    ) -> Result<(), Problem> {
        let Some(cutter) = &self.compensation.cutter else { return Ok(()) };
        let words = &block.g;
        let word = match words.one_shot {
            Some(OneShot::GoHome(Home::First)) => Some("G28"),
            Some(OneShot::GoHome(Home::Second)) => Some("G30"),
            Some(OneShot::SaveHome(_)) => Some("G28.1 or G30.1"),
            Some(OneShot::SetData) => Some("G10"),
            Some(OneShot::LocalOffset) => Some("G52"),
            Some(OneShot::MachineFrame) if cutter.radius > 0.0 => Some("G53"),
            Some(OneShot::SetPosition) => Some("G92"),
            Some(OneShot::EndNurbs) => Some("G5.3"),
            _ => None,
        };
        let word = word
            .or(words.tool_length.map(|_| "a tool length (G43, G49)"))
            .or(words.system.map(|_| "another coordinate system (G54 to G59.3)"))
            .or(words.path_control.map(|_| "another path mode (G61, G64)"))
            .or(words.initial_level.map(|_| "another retract mode (G98, G99)"))
            .or(match motion {
                Some(Motion::Probe(_)) => Some("a probing move (G38.2 to G38.5)"),
                Some(Motion::Spline(_)) => Some("a spline (G5 to G5.2)"),
                Some(Motion::Cycle(_)) => Some("a canned cycle"),
                Some(Motion::Thread(_)) => Some("a thread (G33, G33.1, G76)"),
                _ => None,
            });
        word.map_or(Ok(()), |word| Err(DecodeError::Compensated(word).into()))
    }

    /// True if G92.1 to G92.3 do nothing because compensation is on.
    pub(super) fn keeps_offsets(&self, out: &mut Output) -> bool {
        let keeps = self.compensation.cutter.is_some();
        if keeps {
            out.warning(None, DecodeError::CompensatedOffset);
        }
        keeps
    }

    /// G40 to G42.1.
    pub(super) fn set_compensation(
        &mut self,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let Some(word) = block.g.compensation else { return Ok(()) };
        let left = match word {
            Compensate::Off => return self.end_compensation(out),
            Compensate::Tool { left } | Compensate::Diameter { left } => left,
        };
        if self.plane == Plane::Yz || self.parallel_plane {
            return Err(DecodeError::CompensationPlane(word.number()).into());
        }
        if self.compensation.cutter.is_some() {
            return Err(DecodeError::CompensationTwice(word.number()).into());
        }
        let (diameter, orientation) = match word {
            Compensate::Tool { .. } => self.cutter_of_table(word.number(), block)?,
            _ => self.cutter_of_words(word.number(), block)?,
        };
        let radius = if self.compensation.ignored { 0.0 } else { diameter / 2.0 };
        let frame = Frame::new(self.plane, left == (radius >= 0.0));
        let radius = radius.abs();
        let shift = lathe_shift(self.plane, orientation, radius);
        self.compensation.cutter = Some(Cutter { frame, radius, shift, center: None });
        self.compensation.queue = Queue::new(frame, shift);
        Ok(())
    }

    /// Diameter (m) and orientation of the tool that D names, or of that in the spindle.
    fn cutter_of_table(&self, word: f64, block: &Block) -> Result<(f64, u32), Problem> {
        // D0 is the tool in the spindle.
        let tool = block.whole(Letter::D, 0)?.filter(|tool| *tool != 0);
        let at_word = |error| block.at(Letter::D, error);
        let number = tool.unwrap_or(self.tool);
        let Some(tools) = &self.tools else {
            return Err(at_word(DecodeError::NoDiameter { word, tool: number }));
        };
        let tool = match tools.get(number) {
            Some(tool) => *tool,
            None if number == 0 => super::Tool::default(),
            None => return Err(at_word(DecodeError::UnknownTool(number))),
        };
        let orientation = u32::from(tool.orientation);
        if self.plane != Plane::Zx && !is_centered(orientation) {
            return Err(at_word(DecodeError::LatheToolPlane { word, orientation }));
        }
        Ok((tool.diameter, orientation))
    }

    /// Diameter (m) D and orientation L.
    fn cutter_of_words(&self, word: f64, block: &Block) -> Result<(f64, u32), Problem> {
        let missing = || DecodeError::missing(format!("G{word}"), "the diameter D of the tool");
        let diameter = self.length(block, Letter::D)?.ok_or_else(missing)?;
        match block.whole(Letter::L, 0)? {
            Some(orientation) if self.plane != Plane::Zx => {
                Err(block.at(Letter::L, DecodeError::LatheToolPlane { word, orientation }))
            }
            orientation => Ok((diameter, orientation.unwrap_or(0))),
        }
    }

    /// G40: the last move ends next to its end; the next one must be straight.
    fn end_compensation(&mut self, out: &mut Output) -> Result<(), Problem> {
        let result = self.settle_compensation(out);
        let cutter = self.compensation.cutter.take();
        self.compensation.arc_forbidden |= cutter.is_some_and(|cutter| cutter.center.is_some());
        result
    }

    /// Does the moves that wait as if no other came behind them: before M0, and at the end.
    pub(super) fn settle_compensation(&mut self, out: &mut Output) -> Result<(), Problem> {
        let center = self.compensation.cutter.and_then(|cutter| cutter.center);
        let result = center.map_or(Ok(()), |center| self.end_waiting_at(center, out));
        self.release(out);
        result
    }

    /// Takes over the words of a block with an error.
    pub(super) fn adopt_compensation(&mut self, block: &Block) {
        let other_plane = block.g.plane.is_some_and(|plane| plane != self.plane);
        if other_plane || block.g.compensation == Some(Compensate::Off) {
            self.compensation.cutter = None;
        }
    }

    /// Checks that the move behind G40 is straight.
    ///
    /// # Errors
    /// [`DecodeError::ArcAfterCompensation`] if it is an arc.
    pub(super) fn check_exit(&mut self, straight: bool) -> Result<(), DecodeError> {
        if straight {
            self.compensation.arc_forbidden = false;
        }
        if self.compensation.arc_forbidden {
            return Err(DecodeError::ArcAfterCompensation);
        }
        Ok(())
    }

    /// Coordinates of the tool's centre, or of the tool without compensation, in the program's units.
    pub(super) fn compensated_program(&self) -> [f64; 9] {
        let cutter = self.compensation.cutter.as_ref();
        let Some((frame, center)) = cutter.and_then(|one| Some((one.frame, one.center?))) else {
            return self.location.program;
        };
        let mut machine = self.location.machine;
        let (_, height) = frame.flat(machine.linear);
        machine.linear = frame.point(center, height).into();
        Location::new(machine, &self.offsets, self.units).program
    }

    /// The word in force, in tenths: 410 with the tool to the left, 420 to the right, else 400.
    pub(super) fn compensation_number(&self) -> f64 {
        match self.compensation.cutter {
            None => 400.0,
            Some(cutter) if cutter.frame.side > 0.0 => 410.0,
            Some(_) => 420.0,
        }
    }

    /// True between G41 or G42 and G40.
    pub(super) fn compensation_is_on(&self) -> bool {
        self.compensation.cutter.is_some()
    }

    /// True if the moves are compensated.
    pub(super) fn is_compensated(&self) -> bool {
        self.compensation.cutter.is_some_and(|cutter| cutter.radius > 0.0)
    }
}

/// True if the point whose path it is, is the centre of the tool's radius: a mill, or a lathe tool of orientation 9.
fn is_centered(orientation: u32) -> bool {
    matches!(orientation, 0 | 9)
}

/// From the centre of the radius of a lathe tool to its point, m.
fn lathe_shift(plane: Plane, orientation: u32, radius: f64) -> [f64; 3] {
    if plane != Plane::Zx {
        return [0.0; 3];
    }
    let x = match orientation {
        1 | 2 | 6 => -radius,
        3 | 4 | 8 => radius,
        _ => 0.0,
    };
    let z = match orientation {
        2 | 3 | 7 => -radius,
        1 | 4 | 5 => radius,
        _ => 0.0,
    };
    [x, 0.0, z]
}
