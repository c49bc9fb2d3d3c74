//! Program writer: a path as a program of RS274 for a given control, the inverse of the decoder.

mod block;
mod control;

pub use crate::write_error::WriteError;

use super::Control;
use super::arc::Ends;
use super::options::LengthUnit;
use crate::number::{read_back, text};
use block::{Axes, Block, LETTERS};
use nalgebra::Point3;
use std::convert::Infallible;
use std::f64::consts::TAU;
use std::io::Write;
use std::iter;
use twin_path::{
    Arc, AxisMask, Chords, ElementKind, Linearise, MParameters, Marks, PathElement, Place, Plane,
    ProbeOutcome, Probing, Shape, Words,
};

/// Larger steps between elements are gaps, mm or degrees.
const MAX_GAP: f64 = 1e-3;

/// Arcs that are shorter, m, or turn by less, rad, are lines: controls could take them for full circles.
const SHORTEST_ARC: f64 = 1e-6;
const SMALLEST_ANGLE: f64 = 1e-5;

/// Options of a writer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WriteOptions {
    /// The control that is to read the program; LinuxCNC without one.
    pub control: Option<Control>,
    /// Largest distance of lines from the curves that they replace, m: splines, parabolas, ellipses, and arcs whose radii
    /// at start and end differ by more than the control takes.
    pub tolerance: f64,
}

impl Default for WriteOptions {
    /// No control, and 0.01 mm.
    fn default() -> Self {
        Self { control: None, tolerance: 1e-5 }
    }
}

/// Writes path elements as a program of RS274, in mm, absolute, in the frame of the path (G54 without offset).
///
/// Coordinates have four decimals (Fanuc: three), so that the path that a decoder reads is the same to within a
/// micrometre; the centre of an arc is relative to its written start. Moves that are shorter than that are left out.
/// Words appear where they change: an axis that the path does not move is not named, unless the block that the element
/// comes from names it and its position is not known. A path of another dialect begins at zero, or goes to its start with
/// rapids before its first cut: X and Y with the first rapid or before all others, Z last. G28, G30 and G53 are G53.
/// Turns of an arc are P where the control has it, else an arc each.
///
/// The passes of G76 are G33 for LinuxCNC. Other controls get no threads, and none gets G33.1, whose spindle turns back.
///
/// F is per minute along the path. It counts degrees as mm where rotary axes move along with others for grblHAL,
/// FluidNC and Fanuc, and for Fanuc it is that of the circle of a helix. Dwells are P in seconds, in milliseconds for
/// Fanuc; Mach3 must be set to seconds.
///
/// M6 is M0 with a comment for controls without a tool change. M61 is left out for controls without it.
///
/// Accelerations, tool radii and the path mode (G61, G64) are not written. The speed S is written where it changes if
/// elements carry it ([`super::DecoderOptions::keep_words`]), rounded to whole revolutions for Fanuc.
///
/// Behind a probing move there can be no other move, because the program may have gone on from where the probe trips.
#[derive(Debug)]
pub struct ProgramWriter<W> {
    out: W,
    control: Control,
    tolerance: f64,
    /// End of the last element, mm and degrees; none before the first.
    end: Option<Axes>,
    /// The same as written.
    at: Axes,
    /// Axes with a position that the program has set.
    known: [bool; 9],
    /// Axes that a position in the machine frame has moved since.
    foreign: [bool; 9],
    /// Axes of a path of another dialect that its start names and no block yet.
    pending: [bool; 3],
    /// The path has begun.
    moved: bool,
    /// The last move was a thread; true if the spindle has been turned on since.
    thread: Option<bool>,
    probed: Option<Probing>,
    plane: Plane,
    /// Number of the last motion.
    motion: Option<u8>,
    feed: Option<f64>,
    speed: Option<f64>,
}

impl<W: Write> ProgramWriter<W> {
    /// Begins a program.
    ///
    /// # Errors
    /// What `out` says, and [`WriteError::SoftMotion`].
    pub fn new(mut out: W, options: WriteOptions) -> Result<Self, WriteError> {
        let control = options.control.unwrap_or(Control::LinuxCnc);
        let mut note = "(known work offsets and tool lengths are in the numbers)".to_owned();
        match control {
            Control::SoftMotion => return Err(WriteError::SoftMotion),
            Control::Fanuc => {
                note.make_ascii_uppercase();
                writeln!(out, "%\nO0001")?;
            }
            _ => {}
        }
        write!(out, "{note}\n{}", control.header())?;
        Ok(Self {
            out,
            control,
            tolerance: options.tolerance,
            end: None,
            at: [0.0; 9],
            known: [false; 9],
            foreign: [false; 9],
            pending: [false; 3],
            moved: false,
            thread: None,
            probed: None,
            plane: Plane::Xy,
            motion: None,
            feed: None,
            speed: None,
        })
    }

    /// Appends an element.
    ///
    /// # Errors
    /// [`WriteError`]: what the program cannot express. What is written already stays.
    pub fn write(&mut self, element: &PathElement) -> Result<(), WriteError> {
        self.check(element)?;
        match element.kind {
            ElementKind::Rapid | ElementKind::Cut => {
                self.begin(element)?;
                self.motion(element)?;
            }
            ElementKind::Probe { probing, outcome } => {
                if outcome == ProbeOutcome::Tripped {
                    return inexpressible(
                        element,
                        "a probing move without its programmed end, which the path lacks",
                    );
                }
                self.line(element, Some(probing))?;
                self.probed = Some(probing);
            }
            // Only before the first move.
            ElementKind::Jump => {}
            ElementKind::MFunction { number } => {
                self.m_function(element.place, number, element.m_parameters())?;
            }
            ElementKind::Dwell { time_ns } => self.dwell(element.place, time_ns)?,
        }
        self.moved |= element.kind.is_motion();
        self.end = Some(self.axes(element, true));
        Ok(())
    }

    /// Ends the program, and returns the writer.
    ///
    /// # Errors
    /// What writing says.
    pub fn finish(mut self) -> Result<W, WriteError> {
        let end = if self.control == Control::Fanuc { "M30\n%\n" } else { "M2\n" };
        self.out.write_all(end.as_bytes())?;
        self.out.flush()?;
        Ok(self.out)
    }

    /// Checks that words can express `element`, and that it goes on where the one before ended.
    fn check(&mut self, element: &PathElement) -> Result<(), WriteError> {
        let place = element.place;
        let (start, end) = (self.axes(element, false), self.axes(element, true));
        if element.marks != Marks::default() {
            return inexpressible(element, "G41 to G61 of DIN 66025; use --prepare");
        }
        if !element.switches().is_empty() {
            return inexpressible(element, "switches on the way (H)");
        }
        if let Some(details) = &element.details {
            let extra = details.extra.unwrap_or_default();
            if details.s_profile != AxisMask::default()
                && ((start[2] - end[2]).abs() > 0.0 || extra.length() > 0.0)
            {
                return inexpressible(element, "the S profile (S3, S7 to S11)");
            }
        }
        if element.kind == ElementKind::Jump && self.moved {
            return inexpressible(element, "a jump of the position (tool length or G92)");
        }
        if let Some(probing) = self.probed.filter(|_| element.kind.is_motion()) {
            return Err(WriteError::AfterProbe { place, probing });
        }
        let before = self.end.filter(|_| self.moved).unwrap_or_else(|| {
            // The machine is where the path begins, to the last digit.
            let rounded = self.rounded(start).into_iter().zip(start);
            let near = |(rounded, exact): (f64, f64)| (rounded - exact).abs() < 1e-9;
            for (slot, pair) in self.at.iter_mut().zip(rounded) {
                *slot = if near(pair) { pair.0 } else { pair.1 };
            }
            start
        });
        let gap_mm = start.iter().zip(before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if gap_mm <= MAX_GAP { Ok(()) } else { Err(WriteError::Gap { place, gap_mm }) }
    }

    /// Start or end of `element`, mm and degrees; other axes that it does not name stay.
    fn axes(&self, element: &PathElement, at_end: bool) -> Axes {
        let point = if at_end { element.end() } else { element.start() };
        let mut axes = self.end.unwrap_or_default();
        axes[..3].copy_from_slice((point.coords * 1e3).as_slice());
        if let Some(extra) = element.extra() {
            let [a, b, third, v, w] = if at_end { extra.end } else { extra.start };
            let is_u = element.details.as_ref().is_some_and(|details| details.third_is_u);
            (axes[3], axes[4], axes[7], axes[8]) = (a, b, v, w);
            axes[if is_u { 6 } else { 5 }] = third;
        }
        axes
    }

    fn rounded(&self, axes: Axes) -> Axes {
        axes.map(|value| read_back(value, self.control.decimals()))
    }

    /// Checks that the control has `word`.
    fn check_word(&self, place: Place, word: String) -> Result<(), WriteError> {
        let (reason, control) = (self.control.refusal(&word), self.control.title());
        reason.map_or(Ok(()), |reason| Err(WriteError::Word { place, word, control, reason }))
    }

    /// Checks that the control may have the axis `letter`; grblHAL has it if it is built with it.
    fn check_axis(&self, place: Place, letter: char) -> Result<(), WriteError> {
        if self.control == Control::GrblHal {
            return Ok(());
        }
        self.check_word(place, letter.to_string())
    }

    /// Millimetres for each revolution along a thread; none if `element` does not follow the spindle.
    fn pitch(&mut self, element: &PathElement) -> Result<Option<f64>, WriteError> {
        let spindle = element.details.as_ref().and_then(|details| details.spindle);
        let Some(spindle) = spindle.filter(|spindle| spindle.synchronized) else {
            self.thread = None;
            return Ok(None);
        };
        self.check_word(element.place, "G33".to_owned())?;
        if self.thread == Some(true) {
            return inexpressible(
                element,
                "rigid tapping (G33.1), whose spindle turns back in the thread: write that block by hand",
            );
        }
        self.thread = Some(false);
        Ok(Some(self.feed_of(element) / spindle.speed))
    }

    /// Brings the machine to where a path begins that does not come from blocks of RS274. Where a rapid leads it there,
    /// or zero is its start, the path itself does.
    fn begin(&mut self, element: &PathElement) -> Result<(), WriteError> {
        if words(element).is_some() {
            return Ok(());
        }
        if !self.moved {
            let [x, y, z, ..] = self.at.map(|value| text(value, self.control.decimals()));
            let verb = if self.control == Control::Fanuc { "BEGINS AT" } else { "begins at" };
            writeln!(self.out, "({verb} X{x} Y{y} Z{z})")?;
            self.known = [true; 9];
            self.pending = [x, y, z].map(|number| number != "0");
        }
        if element.kind == ElementKind::Rapid {
            return Ok(());
        }
        for axes in [0..2, 2..3] {
            let mut block = Block::new(element.place, self.control);
            if self.motion != Some(0) {
                block.push("G0");
            }
            for axis in axes {
                if std::mem::take(&mut self.pending[axis]) {
                    let decimals = self.control.decimals();
                    self.at[axis] = block.number(LETTERS[axis], self.at[axis], decimals)?;
                }
            }
            if !block.is_without_numbers() {
                self.motion = Some(0);
                self.emit(&block)?;
            }
        }
        Ok(())
    }

    /// A rapid or a cut.
    fn motion(&mut self, element: &PathElement) -> Result<(), WriteError> {
        if let Some(machine) = words(element).map(|words| words.machine)
            && machine.iter().any(Option::is_some)
        {
            return self.machine_move(element, machine);
        }
        match &element.shape {
            Shape::Line { .. } => self.line(element, None),
            _ if element.kind == ElementKind::Rapid => {
                inexpressible(element, "a rapid along a curve")
            }
            Shape::Arc(arc) => self.turns(element, arc),
            Shape::Ellipse(_) | Shape::Cubic(_) => self.lines(element),
        }
    }

    /// A straight move to a position in the machine frame, m.
    fn machine_move(
        &mut self,
        element: &PathElement,
        machine: [Option<f64>; 3],
    ) -> Result<(), WriteError> {
        self.check_word(element.place, "G53".to_owned())?;
        let number = u8::from(element.kind != ElementKind::Rapid);
        if number == 1 && self.control == Control::Fanuc {
            return inexpressible(element, "G53 with G1: Fanuc goes there at rapid");
        }
        let mut block = Block::new(element.place, self.control);
        block.push(&format!("G53 G{number}"));
        for (axis, (value, letter)) in machine.into_iter().zip(LETTERS).enumerate() {
            let Some(metres) = value else { continue };
            block.number(letter, metres * 1e3, self.control.decimals())?;
            self.foreign[axis] = true;
        }
        let to = self.rounded(self.axes(element, true));
        for ((value, before), letter) in to.into_iter().zip(self.at).zip(LETTERS).skip(3) {
            if value.to_bits() != before.to_bits() {
                self.check_axis(element.place, letter)?;
                block.number(letter, value, self.control.decimals())?;
            }
        }
        self.at = to;
        self.pace(&mut block, element)?;
        self.motion = Some(number);
        self.emit(&block)
    }

    /// A straight move, a thread or a probing move; none if no coordinate changes.
    fn line(&mut self, element: &PathElement, probing: Option<Probing>) -> Result<(), WriteError> {
        let place = element.place;
        let pitch = self.pitch(element)?;
        let number = match element.kind {
            ElementKind::Rapid => 0,
            _ if pitch.is_some() => 33,
            _ => 1,
        };
        let mut block = Block::new(place, self.control);
        if let Some(probing) = probing {
            self.check_word(place, probing.to_string())?;
            block.push(&probing.to_string());
        } else if self.motion != Some(number) {
            block.push(&format!("G{number}"));
        }
        let is_rapid = element.kind == ElementKind::Rapid;
        let forced: &[usize] =
            if is_rapid && (self.pending[0] || self.pending[1]) { &[0, 1] } else { &[] };
        let to = self.target(&mut block, element, forced)?;
        if block.is_without_numbers() {
            return Ok(());
        }
        if let Some(pitch) = pitch {
            block.number('K', pitch, 6)?;
        }
        self.pace(&mut block, element)?;
        self.motion = Some(number).filter(|_| probing.is_none());
        self.at = to;
        self.emit(&block)
    }

    /// The words of the coordinates that change, and of those of `forced`; gives the point that a decoder reads.
    fn target(
        &mut self,
        block: &mut Block,
        element: &PathElement,
        forced: &[usize],
    ) -> Result<Axes, WriteError> {
        let (mut to, decimals) = (self.at, self.control.decimals());
        let named = words(element).map_or([false; 9], |words| words.named);
        let ends = self.axes(element, true).into_iter().zip(LETTERS);
        for (index, ((value, letter), slot)) in ends.zip(&mut to).enumerate() {
            let changes = read_back(value, decimals).to_bits() != slot.to_bits();
            let is_unknown = !self.known[index] || self.foreign[index];
            if changes && is_unknown && !named[index] {
                return inexpressible(
                    element,
                    "a move by G91 from a position that no block has named",
                );
            }
            let is_needed = named[index] && is_unknown;
            if !(changes || is_needed || forced.contains(&index)) {
                continue;
            }
            if index > 2 {
                self.check_axis(element.place, letter)?;
            }
            if let Some(pending) = self.pending.get_mut(index) {
                *pending = false;
            }
            *slot = block.number(letter, value, decimals)?;
            (self.known[index], self.foreign[index]) = (true, false);
        }
        Ok(to)
    }

    /// F and S where they change.
    fn pace(&mut self, block: &mut Block, element: &PathElement) -> Result<(), WriteError> {
        let spindle = element.details.as_ref().and_then(|details| details.spindle);
        let follows = spindle.is_some_and(|spindle| spindle.synchronized);
        if element.kind != ElementKind::Rapid && !follows {
            let value = self.feed_of(element);
            let decimals = if value < 0.1 { 9 } else { 4 };
            let feed = read_back(value, decimals);
            if feed.is_nan() || feed <= 0.0 {
                return Err(WriteError::Value { place: element.place, letter: 'F', value });
            }
            if self.feed != Some(feed) {
                self.feed = Some(block.number('F', value, decimals)?);
            }
        }
        if let Some(speed) = spindle.map(|spindle| self.rounded_speed(spindle.speed))
            && self.speed != Some(speed)
        {
            block.exact('S', speed)?;
            self.speed = Some(speed);
        }
        Ok(())
    }

    fn rounded_speed(&self, speed: f64) -> f64 {
        if self.control == Control::Fanuc { speed.round() } else { speed }
    }

    /// F of `element`, mm/min, or degrees/min where only rotary axes move.
    fn feed_of(&self, element: &PathElement) -> f64 {
        let (feed, length) = (element.feed * 60e3, element.tool_length());
        if length <= 0.0 {
            // Where U, V or W move, the angles of A, B and C do not count.
            let (from, to) = (self.axes(element, false), self.axes(element, true));
            let [.., u, v, w] = std::array::from_fn::<f64, 9, _>(|axis| to[axis] - from[axis]);
            let shift = u.hypot(v).hypot(w) * 1e-3;
            return if shift > 0.0 { feed * (shift / element.length()) } else { feed };
        }
        match &element.shape {
            Shape::Arc(arc) if self.control == Control::Fanuc => {
                feed * (1.0 - (arc.rise() / length).powi(2)).max(0.0).sqrt()
            }
            _ if self.control.adds_rotary_feed() => {
                let turned = element.extra().map_or(0.0, |extra| extra.length() * 1e-3);
                feed * length.hypot(turned) / length
            }
            _ => feed,
        }
    }

    /// An arc of any number of turns.
    fn turns(&mut self, element: &PathElement, arc: &Arc) -> Result<(), WriteError> {
        let turns = arc.sweep().abs() / TAU;
        if !self.control.takes_radii(arc.radius() * 1e3, arc.end_radius() * 1e3) {
            return self.lines(element);
        }
        if turns <= 1.0 + 1e-9 || self.control.refusal("arc with P").is_none() {
            return self.arc(element, arc);
        }
        let length = element.length();
        let (turn, mut from) = (length / turns, 0.0);
        while from < length {
            let to = if length - from <= turn * (1.0 + 1e-9) { length } else { from + turn };
            self.piece(element, from, to)?;
            from = to;
        }
        Ok(())
    }

    /// The part of an arc between two path lengths, m.
    fn piece(&mut self, element: &PathElement, from: f64, to: f64) -> Result<(), WriteError> {
        let piece = element.section(from, to);
        match &piece.shape {
            Shape::Arc(arc) => self.arc(&piece, arc),
            _ => self.line(&piece, None),
        }
    }

    /// An arc of as many turns as the control takes in one block, or two halves of it if rounding could make a full
    /// circle of it, or none.
    fn arc(&mut self, element: &PathElement, arc: &Arc) -> Result<(), WriteError> {
        let (sweep, radius) = (arc.sweep().abs(), arc.radius());
        let least = SMALLEST_ANGLE.max(SHORTEST_ARC / radius);
        if sweep.is_nan() || sweep <= least {
            return self.line(element, None);
        }
        let turns = (sweep / TAU - 1e-9).ceil().max(1.0);
        let clockwise = arc.sweep() < 0.0;
        let number = if clockwise { 2 } else { 3 };
        let mut block = Block::new(element.place, self.control);
        let (plane, axes) = match arc.plane() {
            Plane::Xy => ("G17", [0, 1]),
            Plane::Zx => ("G18", [0, 2]),
            Plane::Yz => ("G19", [1, 2]),
        };
        if axes.iter().any(|axis| self.foreign[*axis]) {
            return inexpressible(
                element,
                "an arc from a position in the machine frame (G28, G30, G53)",
            );
        }
        if self.plane != arc.plane() {
            block.push(plane);
        }
        if self.motion != Some(number) {
            block.push(&format!("G{number}"));
        }
        let to = self.target(&mut block, element, &axes)?;
        let (mut center, mut is_same) = (arc.center() * 1e3, true);
        for axis in axes {
            let letter = if axis == 0 {
                'I'
            } else if axis == 1 {
                'J'
            } else {
                'K'
            };
            let offset = center[axis] - self.at[axis];
            center[axis] = self.at[axis] + block.number(letter, offset, self.control.decimals())?;
            is_same &= to[axis].to_bits() == self.at[axis].to_bits();
        }
        if turns > 1.0 {
            block.exact('P', turns)?;
        }
        let point = |[x, y, z, ..]: Axes| Point3::new(x, y, z) / 1e3;
        let (start, end) = (point(self.at), point(to));
        let ends = Ends { plane: arc.plane(), start, end, clockwise, turns: whole(turns) };
        let Ok(read) = ends.about_center(&(center / 1e3), LengthUnit::Millimetre) else {
            return self.lines(element);
        };
        let part = sweep - TAU * (turns - 1.0);
        let is_doubtful = !is_same && (part <= least || TAU - part <= least);
        if is_doubtful || (read.sweep() - arc.sweep()).abs() > 1.0 {
            let length = element.length();
            self.piece(element, 0.0, length / 2.0)?;
            return self.piece(element, length / 2.0, length);
        }
        self.pace(&mut block, element)?;
        (self.plane, self.motion, self.at) = (arc.plane(), Some(number), to);
        self.emit(&block)
    }

    /// A curve as lines.
    fn lines(&mut self, element: &PathElement) -> Result<(), WriteError> {
        let curve = iter::once(Ok::<_, Infallible>(element.clone()));
        let lines = Linearise::new(curve, Chords::Deviation(self.tolerance)).with_arcs();
        for Ok(line) in lines {
            self.line(&line, None)?;
        }
        Ok(())
    }

    fn m_function(
        &mut self,
        place: Place,
        number: u16,
        parameters: MParameters,
    ) -> Result<(), WriteError> {
        let word = format!("M{number}");
        if number == 6 && self.control.refusal("M6").is_some() {
            return self.change_by_hand(place, parameters.k);
        }
        if number == 61 && self.control.refusal("M61").is_some() {
            // Nothing moves: the tool is in the spindle already.
            return Ok(());
        }
        if matches!(number, 2 | 30 | 47 | 70..=73 | 98 | 99) {
            let reason = "it would end the program, or go on elsewhere";
            return Err(WriteError::Word { place, word, control: self.control.title(), reason });
        }
        self.check_word(place, word.clone())?;
        let MParameters { mut k, l, o } = parameters;
        let is_fanuc = self.control == Control::Fanuc;
        let letters = match number {
            3 | 4 => [Some('S'), None],
            6 => [Some('T'), None],
            61 => [Some('Q'), None],
            19 if !is_fanuc => [Some('R'), Some('P')],
            62..=65 => [Some('P'), None],
            66 => [Some('P'), Some('E')],
            67 | 68 => [Some('E'), Some('Q')],
            100..=199 => [Some('P'), Some('Q')],
            _ => [None; 2],
        };
        match number {
            3 | 4 => {
                self.thread = self.thread.map(|_| true);
                k = k.map(|speed| self.rounded_speed(speed));
                self.speed = k.or(self.speed);
            }
            // The builder of the machine sets the angle.
            19 if is_fanuc => k = k.filter(|angle| *angle != 0.0),
            _ => {}
        }
        let mut block = Block::new(place, self.control);
        block.push(&word);
        for ((value, letter), parameter) in [k, l].into_iter().zip(letters).zip(['K', 'L']) {
            let Some(value) = value else { continue };
            let letter = letter.ok_or(WriteError::Parameter { place, number, parameter })?;
            block.exact(letter, value)?;
        }
        match o {
            Some([kind, timeout, ..]) if number == 66 => {
                block.exact('L', kind)?;
                block.exact('Q', timeout)?;
            }
            Some(_) => return Err(WriteError::Parameter { place, number, parameter: 'O' }),
            None => {}
        }
        self.emit(&block)
    }

    /// A stop in place of M6 that the control does not have.
    fn change_by_hand(&mut self, place: Place, tool: Option<f64>) -> Result<(), WriteError> {
        let mut block = Block::new(place, self.control);
        block.push(&format!("M0 (tool {})", tool.unwrap_or(0.0)));
        self.emit(&block)
    }

    fn dwell(&mut self, place: Place, time_ns: i64) -> Result<(), WriteError> {
        if time_ns <= 0 {
            return Ok(());
        }
        let mut block = Block::new(place, self.control);
        block.push("G4");
        if self.control == Control::Fanuc {
            // Not less than the dwell, in whole milliseconds.
            block.push(&format!("P{}", time_ns.saturating_add(999_999) / 1_000_000));
        } else {
            block.number('P', twin_number::seconds(time_ns), 9)?;
        }
        self.emit(&block)
    }

    fn emit(&mut self, block: &Block) -> Result<(), WriteError> {
        writeln!(self.out, "{}", block.text)?;
        Ok(())
    }
}

fn inexpressible<T>(element: &PathElement, what: &'static str) -> Result<T, WriteError> {
    Err(WriteError::Inexpressible { place: element.place, what })
}

/// Words of the block of `element`, if it is one of RS274.
fn words(element: &PathElement) -> Option<Words> {
    element.details.as_ref().and_then(|details| details.words)
}

/// A whole number of turns.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturating")]
fn whole(turns: f64) -> u32 {
    turns as u32
}
