//! Threads: G33 (straight), G33.1 (rigid tapping) and G76 (turning in passes), whose feed follows the spindle.
//!
//! ```text
//!        I     from the drive line (X of the start) to the peak of the thread: its sign says inside or outside
//!          J   depth of the first pass below the peak
//!          K   depth of the last pass
//!        P Z   pitch along Z; end
//! ```
//!
//! The feed along the path is the pitch times the speed of the spindle. The tool waits for no mark of the spindle:
//! its angle is not part of the path.

use super::block::{Block, Letter, Letters};
use super::cycle::MAX_CYCLE_MOVES;
use super::error::{DecodeError, Problem};
use super::offsets::Location;
use super::output::Output;
use super::state::{MAX_FEED, State};
use super::travel::Axis;
use super::word::{Motion, Thread};
use twin_path::ElementKind;

/// Axes of G33.1 and G76.
const AXES: Letters = Letters::LINEAR.with(Letters::ROTARY);

impl Thread {
    /// The words of the motion; those of axes are among them.
    pub(super) fn words(self) -> Letters {
        match self {
            Self::Straight => Letters::AXES.with(Letters::of("K")),
            Self::RigidTap => AXES.with(Letters::of("IK")),
            Self::Cycle => AXES.with(Letters::CENTER).with(Letters::of("EFHLPQR")),
        }
    }
}

/// Numbers of G76 in program units.
struct Turning {
    /// Start of the cycle: X and Z of the drive line.
    start: [f64; 2],
    /// +1 for an internal thread, −1 for an external one.
    side: f64,
    /// From the drive line to the peak.
    peak: f64,
    /// Depth of the first pass below the peak.
    first: f64,
    /// Depth of the thread.
    height: f64,
    /// Z at which passes end but for the shift of the compound slide.
    end: f64,
    /// Tangent of the angle of the compound slide.
    slide: f64,
    pitch: f64,
    /// Length of the tapers along Z, 0 for none.
    taper: f64,
    /// Pitch along the tapers.
    taper_pitch: f64,
    at_entry: bool,
    at_exit: bool,
}

impl State {
    /// G33, G33.1 and G76.
    pub(super) fn cut_thread(
        &mut self,
        thread: Thread,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let (from, to) = (self.location, self.target(block, self.relative)?);
        let result = self.thread_to(thread, block, to, out);
        if result.is_err() {
            // The path goes on where it was to lead.
            self.location = if thread == Thread::RigidTap { from } else { to };
        }
        result
    }

    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    fn thread_to(
        &mut self,
        thread: Thread,
        block: &Block,
        to: Location,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let motion = Motion::Thread(thread);
        let ends = self.location.program.into_iter().zip(to.program);
        let mut extra = Letter::AXES.into_iter().zip(ends).skip(3);
        if let Some((letter, _)) = extra.find(|(_, (from, to))| from != to)
            && thread != Thread::Straight
        {
            return Err(block.at(letter, DecodeError::UnusedWord(letter.as_char())));
        }
        let code = format!("G{}", motion.number());
        let missing = |letter: Letter| DecodeError::missing(&code, letter.as_char());
        let needed = |letter| block.get(letter).ok_or_else(|| missing(letter));
        let pitch = if thread == Thread::Cycle { Letter::P } else { Letter::K };
        let revolution = needed(pitch)?;
        block.check_above(&code, pitch, revolution, 0.0)?;
        if thread == Thread::Cycle {
            let turning = self.turning(
                block,
                &to,
                revolution,
                [needed(Letter::I)?, needed(Letter::J)?, needed(Letter::K)?],
            )?;
            self.check_spindle(motion, &[3, 4])?;
            return self.turn(block, &turning, to, out);
        }
        self.check_spindle(motion, &[3, 4])?;
        let from = self.location;
        self.cut_synchronized(to, revolution, out)?;
        if thread == Thread::RigidTap
            && let Some(number) = self.spindle
        {
            let scale = block.get(Letter::I).unwrap_or(1.0).max(1.0);
            self.start_spindle(7 - number, scale, out);
            self.cut_synchronized(from, scale * revolution, out)?;
            self.start_spindle(number, 1.0, out);
        }
        Ok(())
    }

    /// Cuts straight to `to`, `pitch` in program units for each revolution of the spindle.
    fn cut_synchronized(
        &mut self,
        to: Location,
        pitch: f64,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let speed = self.speed_to(&to)?;
        let (feed, max) = (pitch * speed, MAX_FEED / pitch);
        if feed > MAX_FEED {
            let (letter, unit) = ('S', " revolutions/min");
            return Err(
                DecodeError::OutOfRange { letter, value: speed, min: 0.0, max, unit }.into()
            );
        }
        let shape = self.line_to(&to);
        self.synchronized = Some(speed);
        self.go(ElementKind::Cut, shape, self.units.to_metres(feed) / 60.0, to, out);
        self.synchronized = None;
        Ok(())
    }

    /// The numbers of G76 to `to` with I, J and K.
    fn turning(
        &self,
        block: &Block,
        to: &Location,
        pitch: f64,
        [peak, first, height]: [f64; 3],
    ) -> Result<Turning, Problem> {
        if peak == 0.0 {
            return Err(block.at(Letter::I, DecodeError::ThreadWithoutPeak));
        }
        block.check_above("G76", Letter::J, first, 0.0)?;
        block.check_above("G76", Letter::K, height, first)?;
        let scale = if self.diameters { 0.5 } else { 1.0 };
        let (first, height) = (scale * first, scale * height);
        let start = [self.location.program[0], self.location.program[2]];
        let end = to.program[2];
        let toward = if end > start[1] { -1.0 } else { 1.0 };
        let slide = toward * block.get(Letter::Q).unwrap_or(0.0).to_radians().tan();
        let taper = block.get(Letter::E).unwrap_or(0.0).max(0.0);
        let flags = block.whole(Letter::L, 0)?.unwrap_or(0);
        Ok(Turning {
            start,
            side: peak.signum(),
            peak: scale * peak.abs(),
            first,
            height,
            end: end + height * slide,
            slide,
            pitch,
            taper: toward * taper,
            taper_pitch: if taper > 0.0 { pitch * taper.hypot(height) / taper } else { pitch },
            at_entry: taper > 0.0 && flags & 1 != 0,
            at_exit: taper > 0.0 && flags & 2 != 0,
        })
    }

    /// The passes of G76, and a rapid to its end.
    fn turn(
        &mut self,
        block: &Block,
        turning: &Turning,
        to: Location,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let first = turning.first;
        let degression = block.get(Letter::R).unwrap_or(1.0).max(1.0);
        let springs = block.whole(Letter::H, 0)?.unwrap_or(0);
        #[expect(clippy::cast_precision_loss, reason = "it is small")]
        let most = MAX_CYCLE_MOVES as f64 / 7.0;
        let passes = (turning.height / first).powf(degression);
        if passes + f64::from(springs) + 3.0 > most {
            return Err(DecodeError::EndlessCycle(MAX_CYCLE_MOVES).into());
        }
        let (mut depth, mut pass) = (first, 1.0_f64);
        while turning.peak + depth < turning.peak + turning.height {
            self.pass(turning, depth, out)?;
            pass += 1.0;
            depth = first * pass.powf(1.0 / degression);
        }
        for _ in 0..=springs {
            self.pass(turning, turning.height, out)?;
        }
        self.rapid(to, out);
        Ok(())
    }

    /// A pass of G76 at `depth` below the peak.
    fn pass(&mut self, turning: &Turning, depth: f64, out: &mut Output) -> Result<(), Problem> {
        let [x, _, z] = [Axis::X, Axis::Y, Axis::Z];
        let at = |state: &Self, across: f64, along: f64| {
            let to = state.with(&state.location, x, turning.start[0] + turning.side * across)?;
            state.with(&to, z, along)
        };
        let Turning { peak, height, pitch, taper, taper_pitch, .. } = *turning;
        let shift = depth * turning.slide;
        let (begin, end) = (turning.start[1] - shift, turning.end - shift);
        let (deep, clear) = (peak + depth, depth - height);
        self.rapid(at(self, clear, begin)?, out);
        if turning.at_entry {
            self.cut_synchronized(at(self, deep - height, begin)?, taper_pitch, out)?;
            self.cut_synchronized(at(self, deep, begin - taper)?, taper_pitch, out)?;
        } else {
            self.rapid(at(self, deep, begin)?, out);
        }
        if turning.at_exit {
            self.cut_synchronized(at(self, deep, end + taper)?, pitch, out)?;
            self.cut_synchronized(at(self, deep - height, end)?, taper_pitch, out)?;
        } else {
            self.cut_synchronized(at(self, deep, end)?, pitch, out)?;
        }
        self.rapid(at(self, clear, end)?, out);
        Ok(())
    }
}
