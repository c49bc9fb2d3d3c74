//! Program writer: a path as a DIN 66025 program, the inverse of the decoder.

mod curve;
mod words;

pub use crate::write_error::WriteError;

use super::word::Letter;
use crate::number::{ALL_DECIMALS, read_back};
use curve::{Curve, Spline};
use nalgebra::Point3;
use std::io::Write;
use twin_path::{AxisMask, ElementKind, ExtraPosition, MParameters, Marks, PathElement};
use words::{DECIMALS, Words};

/// Largest deviation of a program from its path, m (and u).
const TOLERANCE: f64 = 1e-9;

const TARGETS: [Letter; 3] = [Letter::X, Letter::Y, Letter::Z];
const EXTRA_TARGETS: [Letter; 5] = [Letter::P, Letter::Q, Letter::U, Letter::V, Letter::W];

/// Marks that begin and end preparation, and their G numbers.
const PREPARATIONS: [(Marks, i64); 8] = [
    (Marks::CORRECTION_LEFT, 41),
    (Marks::CORRECTION_RIGHT, 42),
    (Marks::SMOOTHING, 51),
    (Marks::ROUNDING, 52),
    (Marks::LOOPS, 61),
    (Marks::CORRECTION_END, 40),
    (Marks::CORNERS_END, 50),
    (Marks::LOOPS_END, 60),
];

/// Writes path elements as a program of SoftMotion's dialect, with N words in tens.
///
/// The decoder reads the same path from it, to within a nanometre everywhere; coordinates have nine decimals, more
/// only where a curve needs them. The program begins with G92 if the path does not start at zero. A jump before the
/// first path object is then not a jump but that start, and of several in a row the last one remains.
///
/// Transition velocities (`dVelEnd`) have no word: what the preparation has lowered there is found again by preparing.
/// Neither have tool radii of what is no path object. One element is held back, because a spline depends on the next.
#[derive(Debug)]
pub struct ProgramWriter<W> {
    out: W,
    begun: bool,
    /// N word of the last block, while there are numbers left.
    number: Option<u32>,
    held: Option<PathElement>,
    spline: Spline,
    /// What the decoder holds after the blocks written so far.
    at: Point3<f64>,
    extra: ExtraPosition,
    has_extra: bool,
    feed: Option<f64>,
    acceleration: f64,
    deceleration: f64,
    d: f64,
    s_profile: AxisMask,
}

impl<W: Write> ProgramWriter<W> {
    /// Begins the program `name`.
    ///
    /// # Errors
    /// What `out` says.
    pub fn new(mut out: W, name: Option<&str>) -> Result<Self, WriteError> {
        let name: String =
            name.unwrap_or_default().chars().filter(|letter| !letter.is_control()).collect();
        writeln!(out, "{}", format!("% {}", name.trim()).trim_end())?;
        Ok(Self {
            out,
            begun: false,
            number: Some(0),
            held: None,
            spline: Spline::default(),
            at: Point3::origin(),
            extra: [0.0; 5],
            has_extra: false,
            feed: None,
            acceleration: 100.0,
            deceleration: 100.0,
            d: 0.0,
            s_profile: AxisMask::default(),
        })
    }

    /// Appends an element.
    ///
    /// # Errors
    /// [`WriteError`]: what the program cannot say, which may be of the element before. What is written already stays.
    pub fn write(&mut self, element: &PathElement) -> Result<(), WriteError> {
        if let Some(held) = self.held.replace(element.clone()) {
            self.emit(&held, Some(element))?;
        }
        Ok(())
    }

    /// Writes the element held back, and returns the writer.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn finish(mut self) -> Result<W, WriteError> {
        if let Some(held) = self.held.take() {
            self.emit(&held, None)?;
        }
        self.out.flush()?;
        Ok(self.out)
    }

    fn emit(
        &mut self,
        element: &PathElement,
        next: Option<&PathElement>,
    ) -> Result<(), WriteError> {
        if !std::mem::replace(&mut self.begun, true) {
            self.set_start(element)?;
        }
        self.check_gap(element)?;
        self.begin_preparation(element)?;
        match element.kind {
            ElementKind::Rapid | ElementKind::Cut => self.motion(element, next)?,
            ElementKind::Jump => self.jump(element)?,
            ElementKind::MFunction { number } => self.auxiliary(element, number)?,
            ElementKind::Dwell { .. } => {
                let what = "SoftMotion's dialect has no dwell; remove it from the source program";
                return Err(WriteError::Inexpressible { place: element.place, what });
            }
            ElementKind::Probe { probing, .. } => {
                return Err(WriteError::Probe { place: element.place, probing });
            }
        }
        self.end_preparation(element)
    }

    /// G92, if the program does not start at zero or the first element names extra axes.
    fn set_start(&mut self, element: &PathElement) -> Result<(), WriteError> {
        let mut words = Words::new(element.place, DECIMALS);
        words.whole(Letter::G, 92);
        let command = words.text.len();
        let start = element.start();
        let mut target =
            self.target(&mut words, start, element.extra().map(|extra| extra.start))?;
        if target != start && words.text.len() > command {
            // Curves may need it exactly.
            words = Words::new(element.place, ALL_DECIMALS);
            words.whole(Letter::G, 92);
            target = self.target(&mut words, start, element.extra().map(|extra| extra.start))?;
        }
        if words.text.len() > command {
            self.arrive(target, element.extra().map(|extra| extra.start));
            self.block(&words)?;
        }
        Ok(())
    }

    /// The words that lead to `end`: of the coordinates that change. Gives the point the decoder reads.
    fn target(
        &self,
        words: &mut Words,
        end: Point3<f64>,
        extra: Option<ExtraPosition>,
    ) -> Result<Point3<f64>, WriteError> {
        let mut read = self.at;
        for ((slot, metres), letter) in read.coords.iter_mut().zip(end.iter()).zip(TARGETS) {
            if metres.to_bits() != slot.to_bits() {
                *slot = words.word(letter, metres * 1e3)? / 1e3;
            }
        }
        if let Some(extra) = extra {
            for ((value, before), letter) in extra.iter().zip(self.extra).zip(EXTRA_TARGETS) {
                let first = !self.has_extra && letter == Letter::P;
                if first || value.to_bits() != before.to_bits() {
                    words.exact(letter, *value)?;
                }
            }
        }
        Ok(read)
    }

    /// The tool is there now.
    fn arrive(&mut self, at: Point3<f64>, extra: Option<ExtraPosition>) {
        self.at = at;
        if let Some(extra) = extra {
            self.extra = extra;
            self.has_extra = true;
        }
    }

    fn check_gap(&self, element: &PathElement) -> Result<(), WriteError> {
        let gap = (element.start() - self.at).amax();
        let extra_gap = element.extra().map_or(0.0, |extra| {
            let gaps = extra.start.iter().zip(self.extra).map(|(start, at)| (start - at).abs());
            gaps.fold(0.0, f64::max)
        });
        // An absent number is a gap, too.
        if gap <= TOLERANCE && extra_gap <= TOLERANCE {
            Ok(())
        } else {
            let gap_mm = if gap <= TOLERANCE { extra_gap } else { gap * 1e3 };
            Err(WriteError::Gap { place: element.place, gap_mm })
        }
    }

    fn motion(
        &mut self,
        element: &PathElement,
        next: Option<&PathElement>,
    ) -> Result<(), WriteError> {
        let place = element.place;
        let extra = element.extra().map(|extra| extra.end);
        // As few decimals as will do.
        let mut found = None;
        for decimals in [DECIMALS, ALL_DECIMALS] {
            let mut words = Words::new(place, decimals);
            let end = element.end().map(|metres| read_back(metres * 1e3, decimals) / 1e3);
            let curve = Curve { element, start: self.at, end };
            let Some(command) = curve.command(&self.spline, next, decimals)? else { continue };
            words.whole(Letter::G, command.number);
            let before = words.text.len();
            self.target(&mut words, element.end(), extra)?;
            if words.text.len() == before {
                words.word(Letter::X, element.end().x * 1e3)?;
            }
            for (letter, value) in command.words {
                words.word(letter, value)?;
            }
            found = Some((words, end, command.number));
            break;
        }
        let Some((mut words, end, number)) = found else {
            return Err(Curve::unsaid(element));
        };
        if element.feed <= 0.0 && element.length() > 0.0 {
            let value = element.feed * 1e3;
            return Err(WriteError::Value { place, letter: 'F', value });
        }
        self.limits(element, &mut words)?;
        self.tool_radius(element, &mut words)?;
        self.profiles(element, &mut words);
        Self::switches(element, &mut words)?;
        self.block(&words)?;
        self.arrive(end, extra);
        self.spline.advance(element, number == 5);
        Ok(())
    }

    fn jump(&mut self, element: &PathElement) -> Result<(), WriteError> {
        let mut words = Words::new(element.place, DECIMALS);
        words.whole(Letter::G, 92);
        let extra = element.extra().map(|extra| extra.end);
        let before = words.text.len();
        let end = self.target(&mut words, element.end(), extra)?;
        if words.text.len() == before {
            words.word(Letter::X, element.end().x * 1e3)?;
        }
        self.limits(element, &mut words)?;
        self.block(&words)?;
        self.arrive(end, extra);
        self.spline.advance(element, false);
        Ok(())
    }

    fn auxiliary(&mut self, element: &PathElement, number: u16) -> Result<(), WriteError> {
        let mut words = Words::new(element.place, DECIMALS);
        words.whole(Letter::M, number.into());
        let none = MParameters::default();
        let MParameters { k, l, o } =
            element.details.as_ref().map_or(&none, |details| &details.parameters);
        if o.is_some() {
            return Err(WriteError::Parameters { place: element.place, number });
        }
        for (letter, value) in [(Letter::K, k), (Letter::L, l)] {
            if let Some(value) = value {
                words.exact(letter, *value)?;
            }
        }
        self.limits(element, &mut words)?;
        self.block(&words)?;
        self.spline.advance(element, false);
        Ok(())
    }

    /// F and E where they change. Elements that are not path objects may have none.
    fn limits(&mut self, element: &PathElement, words: &mut Words) -> Result<(), WriteError> {
        let needed = element.length() > 0.0;
        let feed = read_back(element.feed * 1e3, DECIMALS);
        if (feed > 0.0 || needed) && self.feed != Some(feed) {
            self.feed = Some(words.word(Letter::F, element.feed * 1e3)?);
        }
        for (value, held, sign) in [
            (element.acceleration, &mut self.acceleration, 1.0),
            (element.deceleration, &mut self.deceleration, -1.0),
        ] {
            let written = read_back(value * 1e3, DECIMALS);
            if written > 0.0 {
                if written.to_bits() != held.to_bits() {
                    *held = words.word(Letter::E, sign * value * 1e3)?.abs();
                }
            } else if needed {
                let value = sign * value * 1e3;
                return Err(WriteError::Value { place: element.place, letter: 'E', value });
            }
        }
        Ok(())
    }

    fn tool_radius(&mut self, element: &PathElement, words: &mut Words) -> Result<(), WriteError> {
        let d = read_back(element.tool_radius * 1e3, DECIMALS);
        if d.to_bits() != self.d.to_bits() {
            self.d = words.word(Letter::D, element.tool_radius * 1e3)?;
        }
        Ok(())
    }

    fn profiles(&mut self, element: &PathElement, words: &mut Words) {
        let wanted = match &element.details {
            Some(details) => details.s_profile,
            // Without details it matters to Z alone, and only where Z moves.
            None if element.start().z.to_bits() != element.end().z.to_bits() => {
                self.s_profile.without(AxisMask::Z)
            }
            None => return,
        };
        for number in [3_u8, 7, 8, 9, 10, 11] {
            let Some(axis) = AxisMask::from_s_number(number) else { continue };
            match (wanted.contains(axis), self.s_profile.contains(axis)) {
                (true, false) => {
                    words.whole(Letter::S, number.into());
                    self.s_profile = self.s_profile.with(axis);
                }
                (false, true) => {
                    words.whole(Letter::S, -i64::from(number));
                    self.s_profile = self.s_profile.without(axis);
                }
                _ => {}
            }
        }
    }

    /// H and O, the last switch first: words act from right to left.
    fn switches(element: &PathElement, words: &mut Words) -> Result<(), WriteError> {
        for switch in element.switches().iter().rev() {
            let number = f64::from(switch.number) * if switch.on { 1.0 } else { -1.0 };
            words.exact(Letter::H, number)?;
            if !(0.0..=1.0).contains(&switch.at) {
                let value = switch.at;
                return Err(WriteError::Value { place: element.place, letter: 'O', value });
            }
            words.exact(Letter::O, switch.at)?;
        }
        Ok(())
    }

    fn begin_preparation(&mut self, element: &PathElement) -> Result<(), WriteError> {
        let marks = element.marks;
        let starts = Marks(marks.0 & Marks::STARTS.0);
        if starts == Marks::default() {
            return Ok(());
        }
        for (mark, number) in PREPARATIONS {
            if !Marks::STARTS.contains(mark) || !starts.contains(mark) {
                continue;
            }
            let rivals = mark.rivals().without(mark);
            if !element.kind.is_motion() || starts.0 & rivals.0 != 0 {
                return Err(WriteError::Marks { place: element.place, marks: marks.0 });
            }
            let mut words = Words::new(element.place, DECIMALS);
            words.whole(Letter::G, number);
            self.tool_radius(element, &mut words)?;
            if self.d < 0.0 && mark != Marks::LOOPS {
                return Err(WriteError::Value { place: element.place, letter: 'D', value: self.d });
            }
            self.block(&words)?;
        }
        Ok(())
    }

    fn end_preparation(&mut self, element: &PathElement) -> Result<(), WriteError> {
        for (mark, number) in PREPARATIONS {
            if !Marks::STARTS.contains(mark) && element.marks.contains(mark) {
                let mut words = Words::new(element.place, DECIMALS);
                words.whole(Letter::G, number);
                self.block(&words)?;
            }
        }
        Ok(())
    }

    fn block(&mut self, words: &Words) -> Result<(), WriteError> {
        self.number = self.number.and_then(|number| number.checked_add(10));
        match self.number {
            Some(number) => writeln!(self.out, "N{number} {}", words.text)?,
            // N words are left out when there are no more numbers.
            None => writeln!(self.out, "{}", words.text)?,
        }
        Ok(())
    }
}
