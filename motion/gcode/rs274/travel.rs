//! Moves: straight (G0, G1), arcs (G2, G3), and home (G28, G30).

use super::arc::Ends;
use super::block::{Block, Letter, Letters};
use super::control;
use super::error::{DecodeError, Problem};
use super::leniency::Leniency;
use super::offsets::Location;
use super::options::Position;
use super::output::Output;
use super::settings::OffsetError;
use super::state::State;
use super::word::{FeedMode, Motion, OneShot};
use nalgebra::Point3;
use twin_path::{
    Details, ElementKind, ExtraAxes, ExtraPosition, MParameters, PathElement, Plane, Shape,
};

/// Beyond these no machine is meant, and the squares of lengths lose the micrometre.
const MAX_POSITION: f64 = 1e3;
const MAX_ANGLE: f64 = 1e9;
/// Flat arcs have centres far away.
const MAX_RADIUS: f64 = 1e6;

impl State {
    /// Target of the axis words of `block`.
    pub(super) fn target(&self, block: &Block, relative: bool) -> Result<Location, Problem> {
        let mut to = self.location;
        for (index, axis) in Letter::AXES.into_iter().enumerate() {
            let Some(word) = block.get(axis) else { continue };
            let program = if relative { to.program[index] + word } else { word };
            to.set_program(index, program, &self.offsets, self.units);
            let [x, y, _] = to.machine.linear;
            let machine = match self.offsets.rotation() {
                Some(_) if index < 2 && x.abs() > y.abs() => x,
                Some(_) if index < 2 => y,
                _ => to.machine.axes()[index],
            };
            position_in_range(block, axis, machine)?;
        }
        Ok(to)
    }

    /// `block` with X and Y in place of its polar coordinates; each of these goes on from the present position, if it
    /// is the only one or distances are incremental.
    pub(super) fn without_polar(&self, block: &Block) -> Result<Block, Problem> {
        let [x, y, ..] = self.location.program;
        let (radius, angle) = (block.get(Letter::RADIUS), block.get(Letter::ANGLE));
        let at_origin = x == 0.0 && y == 0.0;
        let (now, direction) = (x.hypot(y), y.atan2(x));
        let polar = |radius: f64, angle: f64| [radius * angle.cos(), radius * angle.sin()];
        let [to_x, to_y] = if self.relative {
            if at_origin {
                return Err(DecodeError::PolarAtOrigin.into());
            }
            if block.get(Letter::L).is_some_and(|repeats| repeats > 1.0) {
                return Err(DecodeError::PolarRepeated.into());
            }
            let turned = angle.unwrap_or_default().to_radians();
            let [to_x, to_y] = polar(now + radius.unwrap_or_default(), direction + turned);
            [to_x - x, to_y - y]
        } else {
            match (radius, angle) {
                (Some(_), None) if at_origin => return Err(DecodeError::PolarAtOrigin.into()),
                (radius, angle) => {
                    polar(radius.unwrap_or(now), angle.map_or(direction, f64::to_radians))
                }
            }
        };
        Ok(block.with_coordinates(to_x, to_y))
    }

    /// Target of the axis words of `block` in the machine frame (G53). Axes of the machine that are not named stay.
    fn machine_target(&self, block: &Block) -> Result<Location, Problem> {
        let values = Letter::AXES.map(|axis| {
            let word = block.get(axis)?;
            let is_angle = Letters::ROTARY.contains(axis);
            Some(if is_angle { word } else { self.units.to_metres(word) })
        });
        let machine = self.offsets.with_machine_axes(&self.location.machine, values);
        for (axis, machine) in Letter::AXES.into_iter().zip(machine.axes()) {
            if block.get(axis).is_some() {
                position_in_range(block, axis, machine)?;
            }
        }
        Ok(Location::new(machine, &self.offsets, self.units))
    }

    /// G0 and G1.
    pub(super) fn go_straight(
        &mut self,
        motion: Motion,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        self.check_exit(true)?;
        let to = if block.g.one_shot == Some(OneShot::MachineFrame) {
            let metres = |axis| block.get(axis).map(|word| self.units.to_metres(word));
            self.words.machine = [Letter::X, Letter::Y, Letter::Z].map(metres);
            self.machine_target(block)?
        } else {
            self.target(block, self.relative)?
        };
        self.mark_known(block);
        if self.is_compensated() {
            return self.compensate_line(motion, block, to, out);
        }
        if motion == Motion::Rapid {
            self.rapid(to, out);
            return Ok(());
        }
        // Behind G40 LinuxCNC's inverse time is that of the programmed line too.
        let programmed = self.programmed_line(&to);
        if let Some(feed) = self.feed_for(&programmed, &to, block.get(Letter::F))? {
            let shape = self.line_to(&to);
            self.go(ElementKind::Cut, shape, feed, to, out);
        }
        Ok(())
    }

    /// G2 and G3.
    pub(super) fn go_round(
        &mut self,
        clockwise: bool,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        self.check_exit(false)?;
        let uncertain = self.uncertain;
        let to = self.target(block, self.relative)?;
        self.mark_known(block);
        match self.arc(clockwise, block, &to, out) {
            Ok(shape) => self.follow_arc(shape, block, to, out),
            Err(problem) => {
                // The blocks after it continue where it was to end.
                self.interrupt_compensation(out);
                self.location = to;
                let [first, second, _] = self.axes().map(|axis| axis.letter);
                let in_doubt = uncertain.contains(first) || uncertain.contains(second);
                if in_doubt && problem.error.depends_on_start() { Ok(()) } else { Err(problem) }
            }
        }
    }

    fn follow_arc(
        &mut self,
        shape: Shape,
        block: &Block,
        to: Location,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if let (Some(control), Shape::Arc(arc)) = (self.control, &shape)
            && !control.takes_radii(arc.radius() * 1e3, arc.end_radius() * 1e3)
        {
            control::unequal_radii(control, out);
        }
        if self.is_compensated() {
            self.compensate_arc(&shape, block, to, out)
        } else {
            self.cut(shape, to, block.get(Letter::F), out)
        }
    }

    fn arc(
        &self,
        clockwise: bool,
        block: &Block,
        to: &Location,
        out: &mut Output,
    ) -> Result<Shape, Problem> {
        if self.parallel_plane {
            return Err(DecodeError::ArcInParallelPlane.into());
        }
        if let Some(degrees) = self.offsets.rotation()
            && self.plane != Plane::Xy
        {
            return Err(OffsetError::RotatedArc(degrees).into());
        }
        let turns = block.whole(Letter::P, 1)?.unwrap_or(1);
        let ends = Ends {
            plane: self.plane,
            start: Point3::from(self.location.machine.linear),
            end: Point3::from(to.machine.linear),
            clockwise,
            turns,
        };
        let [first, second, normal] = self.axes();
        let arc = if let Some(radius) = block.get(Letter::R) {
            if block.letters().meets(Letters::CENTER) {
                return Err(DecodeError::RadiusAndCenter.into());
            }
            if block.get(first.letter).is_none() && block.get(second.letter).is_none() {
                return Err(DecodeError::RadiusWithoutEnd.into());
            }
            let radius = self.units.to_metres(radius);
            block.within(Letter::R, radius, [-MAX_RADIUS, MAX_RADIUS], " m")?;
            ends.by_radius(radius)?
        } else {
            let center = self.center(block, [first, second, normal], out)?;
            ends.about_center(&center, self.units)?
        };
        Ok(Shape::Arc(arc))
    }

    /// The centre that I, J and K say, m.
    fn center(
        &self,
        block: &Block,
        axes: [Axis; 3],
        out: &mut Output,
    ) -> Result<Point3<f64>, Problem> {
        let [first, second, normal] = axes;
        let harmful = |word| self.strict || word != 0.0;
        if block.get(normal.center).is_some_and(harmful) {
            let leniency = Leniency::CenterOutsidePlane(normal.center.as_char());
            self.forgive(leniency, block.columns(normal.center), out)?;
        }
        if !block.letters().meets(Letters::CENTER) {
            return Err(DecodeError::ArcWithoutCenter.into());
        }
        let mut center = [0.0; 3];
        for axis in [first, second] {
            let word = match block.get(axis.center) {
                Some(word) => self.units.to_metres(word),
                None if self.absolute_centers => {
                    let letter = axis.center.as_char();
                    return Err(DecodeError::IncompleteCenter(letter).into());
                }
                None => 0.0,
            };
            center[axis.index] =
                block.within(axis.center, word, [-MAX_RADIUS, MAX_RADIUS], " m")?;
        }
        let center = Point3::from(center);
        Ok(if self.absolute_centers {
            self.offsets.to_machine(center.into()).into()
        } else {
            Point3::from(self.location.machine.linear)
                + Point3::from(self.offsets.turn(center.into())).coords
        })
    }

    /// G28 and G30: to the point of the axis words, if there are any, and from there with the axes named, or all of
    /// them, to `home`, machine frame. With a work frame these are the axes of the machine.
    pub(super) fn go_home(
        &mut self,
        home: Position,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let through = self.target(block, self.relative)?;
        self.rapid(through, out);
        let letters = block.letters();
        let all = !letters.meets(Letters::AXES);
        let here = self.location.machine;
        let target = self.offsets.with_machine_axes(&here, home.axes().map(Some));
        let target = Location::new(target, &self.offsets, self.units);
        let mut to = if all { target } else { self.location };
        for (index, axis) in Letter::AXES.into_iter().enumerate() {
            if all || !letters.contains(axis) {
                continue;
            }
            if self.offsets.rotation().is_some() && index < 2 {
                // With the axes of the program.
                to.set_program(index, target.program[index], &self.offsets, self.units);
            } else {
                to.copy_axis(index, &target);
            }
        }
        if self.offsets.work_frame.is_some() && !all {
            let home = home.axes();
            let named = |axis: usize| letters.contains(Letter::AXES[axis]).then_some(home[axis]);
            let machine = self.offsets.with_machine_axes(&here, std::array::from_fn(named));
            to = Location::new(machine, &self.offsets, self.units);
        }
        check_position(&to)?;
        let from = self.location.machine;
        self.note_extra(&from, &to.machine)?;
        let named = |axis: usize| all || letters.contains(Letter::AXES[axis]);
        self.words.machine = std::array::from_fn(|axis| named(axis).then_some(home.linear[axis]));
        self.rapid(to, out);
        Ok(())
    }

    pub(super) fn line_to(&self, to: &Location) -> Shape {
        Shape::Line {
            start: Point3::from(self.tool_position().linear),
            end: Point3::from(to.machine.linear),
        }
    }

    /// Lets the path go on where a block that cannot be executed was meant to end, as far as that is known.
    pub(super) fn recover(&mut self, block: &Block, out: &mut Output) {
        let radius = self.diameters.then(|| block.with_radius());
        let block = radius.as_ref().unwrap_or(block);
        let polar = block.letters().meets(Letters::POLAR).then(|| self.without_polar(block));
        let cartesian = polar.and_then(Result::ok);
        let block = cartesian.as_ref().unwrap_or(block);
        let assumed = if self.motion_given { self.motion } else { Motion::Rapid };
        let of_block = block.g.motion.unwrap_or(assumed);
        let to = match (block.g.one_shot, of_block) {
            (Some(OneShot::MachineFrame), _) => self.machine_target(block),
            (Some(OneShot::Dwell) | None, Motion::Cycle(_)) => {
                // Above the hole.
                let [.., normal] = self.axes();
                let height = self.location.program[normal.index];
                self.target(block, self.relative).and_then(|to| self.with(&to, normal, height))
            }
            // They end where they touch something, or where they began.
            (_, Motion::Off | Motion::Probe(_) | Motion::Thread(_)) => return,
            (Some(OneShot::Dwell) | None, _) => self.target(block, self.relative),
            _ => return,
        };
        let Ok(to) = to else { return };
        if self.name_extra(block).is_err() {
            return;
        }
        if to != self.location {
            self.interrupt_compensation(out);
            self.location = to;
        }
    }

    /// The positions that a block names are known.
    pub(super) fn mark_known(&mut self, block: &Block) {
        if self.uncertain != Letters::default() && !self.relative {
            self.uncertain = self.uncertain.without(block.letters());
        }
    }

    /// Goes straight to `to` with the velocity of rapids.
    pub(super) fn rapid(&mut self, to: Location, out: &mut Output) {
        let shape = self.line_to(&to);
        self.go(ElementKind::Rapid, shape, self.rapid_velocity, to, out);
    }

    /// Goes straight to `to` with the feed of G94.
    pub(super) fn feed_to(&mut self, to: Location, out: &mut Output) -> Result<(), Problem> {
        let shape = self.line_to(&to);
        self.cut(shape, to, None, out)
    }

    /// Goes along `shape` to `to`, its end, with the feed in force or the F of inverse time.
    fn cut(
        &mut self,
        shape: Shape,
        to: Location,
        inverse_time: Option<f64>,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if let Some(feed) = self.feed_for(&shape, &to, inverse_time)? {
            self.go(ElementKind::Cut, shape, feed, to, out);
        }
        Ok(())
    }

    /// The feed along `shape` to `to`, as [`PathElement::feed`] has it; none if its absence has been reported.
    pub(super) fn feed_for(
        &mut self,
        shape: &Shape,
        to: &Location,
        inverse_time: Option<f64>,
    ) -> Result<Option<f64>, Problem> {
        let error = match self.feed_along(shape, to, inverse_time) {
            Ok(feed) => return Ok(Some(feed)),
            Err(error) => error,
        };
        // The path goes on where it was to lead.
        self.location = *to;
        let of_block = !matches!(error, DecodeError::MissingFeed | DecodeError::ZeroFeed);
        let reported = self.feed_reported && !of_block;
        self.feed_reported |= !of_block;
        if reported { Ok(None) } else { Err(error.into()) }
    }

    /// m/s; a thousandth of degrees/s where only rotary axes move, and of the length in degrees and mm where others
    /// than X, Y, Z move.
    fn feed_along(
        &self,
        shape: &Shape,
        to: &Location,
        inverse_time: Option<f64>,
    ) -> Result<f64, DecodeError> {
        let length = shape.length();
        // Where X, Y and Z move, nothing else counts for LinuxCNC.
        let counts_degrees = self.numbers_of.filter(|control| control.adds_rotary_feed());
        let [turn, shift] = if self.extra && (length <= 0.0 || counts_degrees.is_some()) {
            self.extra_distance(&self.location.machine.extra_axes(), &to.machine.extra_axes())
        } else {
            [0.0; 2]
        };
        let feed = if self.feed_mode == FeedMode::InverseTime {
            let per_minute = inverse_time.ok_or(DecodeError::MissingInverseTime)?;
            let length = if length > 0.0 { length } else { turn.hypot(shift) * 1e-3 };
            // Without a length there is no time to keep, and any feed is right.
            per_minute / 60.0 * if length > 0.0 { length } else { 1.0 }
        } else {
            let feed = self.feed.ok_or(DecodeError::MissingFeed)?;
            let feed = if length > 0.0 {
                let turned = turn.hypot(shift) * 1e-3;
                feed.linear * counts_degrees.map_or(1.0, |_| length / length.hypot(turned))
            } else if shift > 0.0 {
                // F is that of U, V and W.
                feed.linear * (turn.hypot(shift) / shift)
            } else if turn > 0.0 {
                feed.rotary * 1e-3
            } else {
                feed.linear
            };
            match self.feed_mode {
                FeedMode::PerRevolution if feed > 0.0 => feed * self.speed_to(to)?,
                _ => feed,
            }
        };
        if feed > 0.0 { Ok(feed) } else { Err(DecodeError::ZeroFeed) }
    }

    /// Distance of two positions of the extra axes in A B C, degrees, and in U V W, mm.
    pub(super) fn extra_distance(&self, from: &ExtraPosition, to: &ExtraPosition) -> [f64; 2] {
        let [a, b, shared, v, w] = std::array::from_fn(|axis| (to[axis] - from[axis]).powi(2));
        let (c, u) = if self.shared == Some(Letter::U) { (0.0, shared) } else { (shared, 0.0) };
        [(a + b + c).sqrt(), (u + v + w).sqrt()]
    }

    /// Goes along `shape` to `to`.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn go(
        &mut self,
        kind: ElementKind,
        shape: Shape,
        feed: f64,
        to: Location,
        out: &mut Output,
    ) {
        let from = self.tool_position();
        self.compensation.tool = None;
        self.location = to;
        let kept = self.keep_empty_moves || matches!(kind, ElementKind::Probe { .. });
        if !kept && shape.length() <= 0.0 && from.extra_axes() == to.machine.extra_axes() {
            return;
        }
        // Behind an error an arc may begin elsewhere.
        let start = Position { linear: shape.start().into(), ..from };
        self.connect(&start, out);
        self.emit(kind, shape, feed, [&from, &to.machine], None, out);
    }

    /// Waits, or calls an M function, where the tool is.
    pub(super) fn stand(&mut self, kind: ElementKind, parameters: MParameters, out: &mut Output) {
        if self.wait_for_corner(kind, parameters, out) {
            return;
        }
        let at = self.tool_position();
        self.connect(&at, out);
        let point = Point3::from(at.linear);
        let shape = Shape::Line { start: point, end: point };
        self.emit(kind, shape, 0.0, [&at; 2], Some(parameters), out);
    }

    /// Lets the set-point jump to `at` if the path has ended elsewhere: after G43 if the path is that of the tip, or
    /// after a block that could not be executed.
    fn connect(&mut self, at: &Position, out: &mut Output) {
        if let Some(end) = self.path_end
            && end != *at
        {
            let shape =
                Shape::Line { start: Point3::from(end.linear), end: Point3::from(at.linear) };
            self.emit(ElementKind::Jump, shape, 0.0, [&end, at], None, out);
        }
    }

    fn emit(
        &mut self,
        kind: ElementKind,
        shape: Shape,
        feed: f64,
        extra: [&Position; 2],
        parameters: Option<MParameters>,
        out: &mut Output,
    ) {
        let [start, end] = extra;
        self.path_end = Some(Position { linear: shape.end().into(), ..*end });
        let mut details = None;
        let parameters = parameters.filter(|parameters| *parameters != MParameters::default());
        let spindle = self.spindle_along();
        let words = self.keep_words.then_some(self.words);
        if self.extra || parameters.is_some() || words.is_some() {
            let extra = ExtraAxes { start: start.extra_axes(), end: end.extra_axes() };
            details = Some(Box::new(Details {
                extra: self.extra.then_some(extra),
                parameters: parameters.unwrap_or_default(),
                spindle,
                third_is_u: self.shared == Some(Letter::U),
                words,
                ..Details::default()
            }));
        }
        out.element(PathElement {
            feed,
            acceleration: self.acceleration,
            deceleration: self.deceleration,
            details,
            ..PathElement::new(out.place, kind, shape)
        });
    }
}

impl State {
    /// Makes the axes that `block` names part of the path.
    ///
    /// # Errors
    /// [`DecodeError::SharedAxis`] at C or U if the program has named the other one.
    pub(super) fn name_extra(&mut self, block: &Block) -> Result<(), Problem> {
        if !block.letters().meets(Letters::EXTRA) {
            return Ok(());
        }
        self.extra = true;
        let columns = |letter: Letter| block.get(letter).and_then(|_| block.columns(letter));
        let mut letters = [Letter::C, Letter::U];
        letters.sort_by_key(|letter| columns(*letter).map(|columns| columns.start));
        for letter in letters.into_iter().filter(|letter| block.get(*letter).is_some()) {
            self.share(letter).map_err(|error| block.at(letter, error))?;
        }
        Ok(())
    }

    /// Makes the axes that move from `from` to `to` part of the path.
    ///
    /// # Errors
    /// [`DecodeError::SharedAxis`] if C or U moves and the program has named the other one.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn note_extra(&mut self, from: &Position, to: &Position) -> Result<(), DecodeError> {
        self.extra |= (from.rotary, from.parallel) != (to.rotary, to.parallel);
        if from.rotary[2] != to.rotary[2] {
            self.share(Letter::C)?;
        }
        if from.parallel[0] != to.parallel[0] {
            self.share(Letter::U)?;
        }
        Ok(())
    }

    /// Makes C or U the axis that the program moves; the path may begin at other places than 0 of it.
    fn share(&mut self, letter: Letter) -> Result<(), DecodeError> {
        let before = self.shared.replace(letter);
        if let Some(first) = before.filter(|first| *first != letter) {
            self.shared = before;
            let (first, second) = (first.as_char(), letter.as_char());
            return Err(DecodeError::SharedAxis { first, second });
        }
        if before.is_none() && letter == Letter::U {
            // Until then its position counts as one of C.
            for at in [&mut self.location.machine].into_iter().chain(&mut self.path_end) {
                at.parallel[0] += std::mem::take(&mut at.rotary[2]) * 1e-3;
            }
            self.location.find_program(&self.offsets, self.units);
        }
        Ok(())
    }
}

/// An axis of the plane in force, or its normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// In the order of coordinates: X Y Z A B C U V W.
    pub(super) index: usize,
    pub(super) letter: Letter,
    /// Its word for the centre of an arc.
    pub(super) center: Letter,
}

impl Axis {
    pub(super) const X: Self = Self { index: 0, letter: Letter::X, center: Letter::I };
    pub(super) const Y: Self = Self { index: 1, letter: Letter::Y, center: Letter::J };
    pub(super) const Z: Self = Self { index: 2, letter: Letter::Z, center: Letter::K };
    const U: Self = Self { index: 6, letter: Letter::U, center: Letter::I };
    const V: Self = Self { index: 7, letter: Letter::V, center: Letter::J };
    const W: Self = Self { index: 8, letter: Letter::W, center: Letter::K };
}

impl State {
    /// First and second axis of the plane in force, and its normal.
    pub(super) fn axes(&self) -> [Axis; 3] {
        let [x, y, z] = if self.parallel_plane {
            [Axis::U, Axis::V, Axis::W]
        } else {
            [Axis::X, Axis::Y, Axis::Z]
        };
        match self.plane {
            Plane::Xy => [x, y, z],
            Plane::Zx => [z, x, y],
            Plane::Yz => [y, z, x],
        }
    }

    /// Position of the tool if one coordinate of the program changes.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn with(
        &self,
        at: &Location,
        axis: Axis,
        program: f64,
    ) -> Result<Location, Problem> {
        let mut to = *at;
        // What does not change stays, bit for bit.
        if to.program[axis.index] != program {
            to.set_program(axis.index, program, &self.offsets, self.units);
        }
        check_position(&to)?;
        Ok(to)
    }
}

/// Checks that the machine can be meant to go there.
fn check_position(to: &Location) -> Result<(), Problem> {
    let lengths = to.machine.axes().into_iter().zip(Letter::AXES);
    for (value, axis) in lengths.filter(|(_, axis)| !Letters::ROTARY.contains(*axis)) {
        if value.is_nan() || value.abs() > MAX_POSITION {
            let (letter, min, max) = (axis.as_char(), -MAX_POSITION, MAX_POSITION);
            return Err(DecodeError::OutOfRange { letter, value, min, max, unit: " m" }.into());
        }
    }
    Ok(())
}

fn position_in_range(block: &Block, axis: Letter, machine: f64) -> Result<f64, Problem> {
    if Letters::ROTARY.contains(axis) {
        block.within(axis, machine, [-MAX_ANGLE, MAX_ANGLE], "°")
    } else {
        block.within(axis, machine, [-MAX_POSITION, MAX_POSITION], " m")
    }
}
