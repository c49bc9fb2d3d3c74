//! Modal state of the RS274 interpreter: G codes, offsets, feed and tool between blocks, and the execution of a block.

use super::block::{Block, Letter, Letters};
use super::compensation::Compensation;
use super::control::{self, Control};
use super::cycle::Series;
use super::error::{DecodeError, Problem};
use super::input_output::m_letters;
use super::leniency::Leniency;
use super::modes::{Overrides, Saved};
use super::offsets::{Home, Location, Offsets};
use super::options::{DecoderOptions, LengthUnit, PathMode, Position};
use super::output::Output;
use super::parameters::Parameters;
use super::probe::ProbeTarget;
use super::spindle::SurfaceSpeed;
use super::spline::Nurbs;
use super::tool_table::ToolTable;
use super::travel::Axis;
use super::word::{Compensate, FeedMode, Motion, OneShot, PathControl, Spline, Thread, ToolLength};
use std::ops::Range;
use twin_path::{ElementKind, MParameters, Plane, Words};

/// Limits of numbers, in their own units.
pub(super) const MAX_FEED: f64 = 1e9;
pub(super) const MAX_SPEED: f64 = 1e9;
const MAX_DWELL_S: f64 = 1e6;

/// F of G94 in both of its meanings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Feed {
    /// m/s.
    pub(super) linear: f64,
    /// Feed of moves of rotary axes only, degrees/s.
    pub(super) rotary: f64,
}

impl Feed {
    /// That of an F word.
    pub(super) fn per_minute(number: f64, units: LengthUnit) -> Self {
        Self { linear: units.to_metres(number) / 60.0, rotary: number / 60.0 }
    }
}

/// The interpreter between two blocks.
#[derive(Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "modes of the language, each on or off")]
pub(super) struct State {
    pub(super) rapid_velocity: f64,
    pub(super) acceleration: f64,
    pub(super) deceleration: f64,
    pub(super) keep_empty_moves: bool,
    pub(super) keep_words: bool,
    /// Those of the current block.
    pub(super) words: Words,
    /// Speed with which the current move follows the angle of the spindle, revolutions per minute.
    pub(super) synchronized: Option<f64>,
    /// Refuses what LinuxCNC refuses.
    pub(super) strict: bool,
    /// The control that the program is meant for.
    pub(super) control: Option<Control>,
    /// The control whose numbers it has.
    pub(super) numbers_of: Option<Control>,
    pub(super) tools: Option<ToolTable>,
    /// Without a tool table every tool exists, with length zero unless G10 says otherwise.
    pub(super) assumes_tools: bool,
    /// Target of the probe, if it is known.
    pub(super) probe_target: Option<Box<dyn ProbeTarget>>,
    pub(super) probe_settle_ns: i64,

    pub(super) offsets: Offsets,
    pub(super) location: Location,
    pub(super) compensation: Compensation,
    /// End of the last element; none before the first.
    pub(super) path_end: Option<Position>,
    /// The path has extra axes: one of A, B, C, U, V, W has been named or has moved.
    pub(super) extra: bool,
    /// C or U, whichever the program moves: both are the extra axis U.
    pub(super) shared: Option<Letter>,

    pub(super) units: LengthUnit,
    pub(super) plane: Plane,
    /// The plane is that of U, V, W in place of X, Y, Z (G17.1 to G19.1).
    pub(super) parallel_plane: bool,
    pub(super) motion: Motion,
    /// A word has said how to move, or that nothing moves.
    pub(super) motion_given: bool,
    pub(super) relative: bool,
    pub(super) absolute_centers: bool,
    /// G7: X words are diameters.
    pub(super) diameters: bool,
    pub(super) feed_mode: FeedMode,
    pub(super) initial_level: bool,
    pub(super) path_mode: PathMode,
    pub(super) feed: Option<Feed>,
    /// F in force as the program wrote it.
    pub(super) feed_word: f64,
    /// A block has had an F word.
    pub(super) feed_given: bool,
    pub(super) feed_reported: bool,
    /// Axes whose position is not known behind a block that could not be read.
    pub(super) uncertain: Letters,
    pub(super) series: Series,
    /// I and J of a G5 that has none, in units of the program: P and Q of the last G5, turned around.
    pub(super) spline_start: [f64; 2],
    /// The curve of G5.2.
    pub(super) nurbs: Option<Nurbs>,
    /// S: revolutions per minute, or m/min or feet/min with G96.
    pub(super) speed: Option<f64>,
    /// G96.
    pub(super) surface_speed: Option<SurfaceSpeed>,
    /// M3 or M4.
    pub(super) spindle: Option<u16>,
    /// Mist (M7) and flood (M8).
    pub(super) coolant: [bool; 2],
    pub(super) overrides: Overrides,
    /// States saved by M70 and M73: of the program, then of each open subroutine.
    pub(super) saved: Vec<Saved>,
    pub(super) selected_tool: Option<u32>,
    pub(super) tool: u32,
    pub(super) parameters: Parameters,
}

impl State {
    pub(super) fn new(options: DecoderOptions) -> Self {
        let offsets = Offsets::new(&options);
        let location = Location::new(options.start, &offsets, options.units);
        let mut state = Self {
            rapid_velocity: options.rapid_velocity,
            acceleration: options.acceleration,
            deceleration: options.deceleration,
            keep_empty_moves: options.keep_empty_moves,
            keep_words: options.keep_words,
            strict: options.strict,
            control: options.control,
            numbers_of: options.numbers_of.or(options.control),
            assumes_tools: options.tools.is_none(),
            probe_target: options.surroundings.map(|surroundings| {
                surroundings.target(options.tools.as_ref().unwrap_or(&ToolTable::default()))
            }),
            tools: options.tools,
            probe_settle_ns: options.probe_settle_ns,
            offsets,
            location,
            extra: options.start.extra_axes().iter().any(|position| *position != 0.0),
            units: options.units,
            tool: options.tool,
            ..Self::default()
        };
        for (number, value) in options.parameters.iter() {
            state.parameters.set(number, value);
        }
        state.load_tool(options.tool);
        state
    }

    /// Passes over what LinuxCNC refuses, with a warning.
    ///
    /// # Errors
    /// That of LinuxCNC, if it must be obeyed.
    pub(super) fn forgive(
        &self,
        leniency: Leniency,
        columns: Option<Range<usize>>,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if self.strict {
            return Err(Problem { columns, error: leniency.refusal() });
        }
        match self.control {
            Some(control) => control::forgive(control, leniency, columns, out),
            None => out.remark(columns, DecodeError::Lenient(leniency), false),
        }
        Ok(())
    }

    /// Takes over the modes of a block that cannot be executed, so that the blocks after it mean what they are meant
    /// to.
    pub(super) fn adopt(&mut self, block: &Block) {
        if self.set_feed(block).is_err() {
            self.feed_reported = true;
        }
        self.adopt_compensation(block);
        self.set_modes(block);
        if let Some(motion) = block.g.motion {
            self.set_motion(motion);
        }
    }

    /// Does what a block asks for; false if the program ends with it.
    ///
    /// # Errors
    /// The error of the block. Nothing of it has been done then, or only what comes before in LinuxCNC's order.
    pub(super) fn execute(&mut self, block: &Block, out: &mut Output) -> Result<bool, Problem> {
        let diameters = block.g.diameters.unwrap_or(self.diameters);
        let radius = diameters.then(|| block.with_radius());
        let block = radius.as_ref().unwrap_or(block);
        // Most blocks: G1 X1 Y2, X1 Y2.
        let motion = self.motion_of(block)?;
        if self.keep_words {
            // Numbers of G91 name no position.
            let relative = block.g.relative.unwrap_or(self.relative);
            self.words =
                if relative { Words::default() } else { words_of(block, motion, self.axes()) };
        }
        if motion == Some(Motion::Rapid) && self.motion == Motion::Off && block.g.motion.is_none() {
            self.forgive(Leniency::NoMotionWord, None, out)?;
        }
        self.check_words(block, motion)?;
        self.name_extra(block)?;
        Self::check_spindle_number(block, motion)?;
        self.check_before_compensation(block, out)?;
        self.set_feed(block)?;
        self.set_tool_and_speed(block, out)?;
        if block.g.one_shot == Some(OneShot::Dwell) {
            let seconds = block
                .get(Letter::P)
                .ok_or_else(|| DecodeError::missing("G4", "the time P in seconds"))?;
            self.dwell(seconds, out)?;
        }
        self.set_modes(block);
        self.set_compensation(block, out)?;
        self.check_compensated(block, motion)?;
        self.set_tool_length(block, out)?;
        if let Some(system) = block.g.system {
            self.offsets.select(system);
            self.location.find_program(&self.offsets, self.units);
        }
        self.set_path_mode(block);
        match block.g.one_shot {
            Some(OneShot::GoHome(home)) => self.go_home(self.offsets.home(home), block, out)?,
            Some(OneShot::EndNurbs) => self.end_nurbs(block, out)?,
            Some(OneShot::Dwell | OneShot::MachineFrame) | None => {}
            Some(shot) => self.set_offsets(shot, block, out)?,
        }
        if let Some(shot) = block.g.g92_switch.filter(|_| !self.keeps_offsets(out)) {
            self.switch_g92(shot);
        }
        if let Some(motion) = block.g.motion {
            self.set_motion(motion);
        }
        if let Some(motion) = motion {
            self.assume_feed(motion, block, out)?;
            let cartesian;
            let block = if block.letters().meets(Letters::POLAR) {
                cartesian = self.without_polar(block)?;
                &cartesian
            } else {
                block
            };
            match motion {
                Motion::Rapid | Motion::Line => self.go_straight(motion, block, out)?,
                Motion::Arc { clockwise } => self.go_round(clockwise, block, out)?,
                Motion::Spline(spline) => self.follow_spline(spline, block, out)?,
                Motion::Probe(probing) => self.probe(probing, block, out)?,
                Motion::Thread(thread) => self.cut_thread(thread, block, out)?,
                Motion::Cycle(cycle) => self.run_cycle(cycle, block, out)?,
                Motion::Off => {}
            }
        }
        if block.m.stop.is_some() {
            self.settle_compensation(out)?;
        }
        match block.m.stop {
            Some(2 | 30) if self.nurbs.is_some() => return Err(DecodeError::NurbsNotEnded.into()),
            Some(2 | 30) => return Ok(false),
            Some(number) => self.m_function(number, None, out),
            None => {}
        }
        Ok(true)
    }

    /// The motion that a block asks for, if any.
    fn motion_of(&self, block: &Block) -> Result<Option<Motion>, DecodeError> {
        let axes = block.letters().meets(Letters::AXES);
        let active = block.g.motion.filter(|motion| *motion != Motion::Off);
        let ends_nurbs = block.g.one_shot == Some(OneShot::EndNurbs);
        match block.g.motion {
            Some(Motion::Spline(Spline::Nurbs)) => {}
            Some(_) if ends_nurbs || self.nurbs.is_some() => {
                return Err(DecodeError::NurbsNotEnded);
            }
            None if ends_nurbs => return Ok(None),
            _ => {}
        }
        let other = match block.g.one_shot {
            Some(OneShot::SetData) => Some((10.0, false)),
            Some(OneShot::GoHome(Home::First)) => Some((28.0, false)),
            Some(OneShot::GoHome(Home::Second)) => Some((30.0, false)),
            Some(OneShot::LocalOffset) => Some((52.0, true)),
            Some(OneShot::SetPosition) => Some((92.0, true)),
            _ => None,
        };
        if let Some((number, needs_axes)) = other {
            return match active {
                Some(motion) => Err(DecodeError::AxesUsedTwice(motion.number())),
                None if needs_axes && !axes => Err(DecodeError::MissingAxes(number)),
                None => Ok(None),
            };
        }
        match (block.g.motion, axes) {
            (Some(motion @ Motion::Spline(spline)), false) if spline != Spline::Nurbs => {
                Err(DecodeError::MissingAxes(motion.number()))
            }
            (Some(motion @ (Motion::Cycle(_) | Motion::Thread(_) | Motion::Probe(_))), false) => {
                Err(DecodeError::MissingAxes(motion.number()))
            }
            (Some(Motion::Off), true) => Err(DecodeError::AxesWithoutMotion),
            (Some(motion), _) => Ok(Some(motion)),
            (None, true) if block.g.tool_length == Some(ToolLength::Direct) => Ok(None),
            (None, true) if self.motion == Motion::Off => {
                let assumed = (!self.motion_given).then_some(Motion::Rapid);
                assumed.map(Some).ok_or(DecodeError::AxesWithoutMotion)
            }
            (None, true) => Ok(Some(self.motion)),
            (None, false) if matches!(self.motion, Motion::Arc { .. }) => {
                Ok(block.letters().meets(Letters::CENTER).then_some(self.motion))
            }
            (None, false) => Ok(None),
        }
    }

    /// Checks that each word of `block` has something to act on.
    fn check_words(&self, block: &Block, motion: Option<Motion>) -> Result<(), Problem> {
        const PLAIN: Letters = Letters::AXES.with(Letters::of("FST"));
        let mut used = PLAIN.with(m_letters(block));
        match motion {
            Some(Motion::Arc { .. }) => {
                used = used.with(Letters::CENTER).with(Letters::of("PR"));
            }
            Some(Motion::Spline(spline)) => {
                used = used.without(Letters::AXES).with(spline.words());
            }
            None if block.g.one_shot == Some(OneShot::EndNurbs) => {
                used = used.without(Letters::AXES);
            }
            Some(Motion::Cycle(cycle)) => {
                let parallel = block.g.parallel_plane.unwrap_or(self.parallel_plane);
                let other = if parallel { Letters::LINEAR } else { Letters::PARALLEL };
                used = used.without(Letters::ROTARY.with(other)).with(cycle.words());
            }
            Some(Motion::Thread(thread)) => {
                used = thread.words().with(Letters::of("ST"));
            }
            _ => {}
        }
        used = used.with(Self::spindle_words(block, motion));
        let (g, m) = (&block.g, &block.m);
        let mut takes = |is_there: bool, letters: &str| {
            if is_there {
                used = used.with(Letters::of(letters));
            }
        };
        takes(g.one_shot == Some(OneShot::Dwell), "P");
        takes(g.path_control == Some(PathControl::Blend), "PQ");
        // LinuxCNC passes over it.
        takes(matches!(g.compensation, Some(Compensate::Diameter { .. })), "R");
        takes(g.compensation.is_some_and(|word| word != Compensate::Off), "DL");
        takes(matches!(g.tool_length, Some(ToolLength::Table | ToolLength::Added)), "H");
        takes(g.surface_speed == Some(true), "D");
        takes(m.spindle == Some(19), "PQR");
        takes(g.one_shot == Some(OneShot::SetData), "IJLPQR");
        takes(m.tool_change == Some(61), "Q");
        if let Some(letter) = block.letters().without(used).first() {
            return Err(block.at(letter, DecodeError::UnusedWord(letter.as_char())));
        }
        if block.letters().meets(Letters::POLAR) {
            let coordinates = Letters::of("XY");
            if motion.is_none() || block.g.one_shot.is_some_and(|shot| shot != OneShot::Dwell) {
                return Err(DecodeError::PolarWithoutMotion.into());
            }
            if self.plane != Plane::Xy || self.parallel_plane {
                return Err(DecodeError::PolarOutsideXy.into());
            }
            if block.letters().meets(coordinates) {
                return Err(DecodeError::PolarAndCoordinate.into());
            }
        }
        if block.g.one_shot == Some(OneShot::MachineFrame) {
            if !matches!(motion, Some(Motion::Rapid | Motion::Line)) {
                return Err(DecodeError::missing("G53", "G0 or G1").into());
            }
            if block.g.relative.unwrap_or(self.relative) {
                return Err(DecodeError::MachineFrameIncremental.into());
            }
        }
        Ok(())
    }

    /// The number of a word that must be from 0 to `max`.
    pub(super) fn in_range(
        block: &Block,
        letter: Letter,
        max: f64,
    ) -> Result<Option<f64>, Problem> {
        block.get(letter).map(|value| block.within(letter, value, [0.0, max], "")).transpose()
    }

    fn set_feed(&mut self, block: &Block) -> Result<(), Problem> {
        if let Some(mode) = block.g.feed_mode {
            self.feed_mode = mode;
            if mode != FeedMode::InverseTime {
                self.feed = None;
            }
        }
        let Some(feed) = Self::in_range(block, Letter::F, MAX_FEED)? else { return Ok(()) };
        self.feed_word = feed;
        self.feed_given = true;
        if self.feed_mode != FeedMode::InverseTime {
            self.feed = Some(Feed::per_minute(feed, self.units));
            // F0 is none.
            self.feed_reported &= feed <= 0.0;
        }
        Ok(())
    }

    /// Gives a program that has set none a feed.
    fn assume_feed(
        &mut self,
        motion: Motion,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let needs_none = matches!(motion, Motion::Rapid | Motion::Off | Motion::Thread(_));
        if self.feed_given || self.strict || needs_none || self.feed_mode != FeedMode::PerMinute {
            return Ok(());
        }
        self.feed = Some(Feed::ASSUMED);
        // An F that could not be read has been reported.
        if self.feed_reported {
            return Ok(());
        }
        self.forgive(Leniency::NoFeed, block.last_columns(), out)
    }

    fn set_tool_and_speed(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        self.set_speed(block)?;
        if let Some(tool) = block.whole(Letter::T, 0)? {
            self.find_tool(tool, Letter::T, block, out)?;
            self.selected_tool = Some(tool);
        }
        self.set_outputs(block, out)?;
        if block.m.tool_change == Some(6) {
            // The spindle number replaces it.
            self.stop_spindle(out);
            self.load_tool(self.selected_tool.unwrap_or(self.tool));
            self.m_function(6, Some(f64::from(self.tool)), out);
        }
        if block.m.tool_change == Some(61) {
            self.set_tool_number(block, out)?;
        }
        self.turn_spindle(block, out)?;
        self.keep_modes(block, out)?;
        if let Some(number) = block.m.coolant {
            self.set_coolant(number, out);
        }
        self.set_overrides(block);
        self.call_user(block, out)?;
        Ok(())
    }

    /// At the end of a program spindle and coolant stop.
    pub(super) fn end(&mut self, out: &mut Output) {
        self.release(out);
        self.stop_spindle(out);
        if self.coolant.contains(&true) {
            self.set_coolant(9, out);
        }
    }

    fn set_modes(&mut self, block: &Block) {
        let words = &block.g;
        if let Some(units) = words.units
            && units != self.units
        {
            self.units = units;
            self.location.find_program(&self.offsets, units);
        }
        self.diameters = words.diameters.unwrap_or(self.diameters);
        self.plane = words.plane.unwrap_or(self.plane);
        self.parallel_plane = words.parallel_plane.unwrap_or(self.parallel_plane);
        self.relative = words.relative.unwrap_or(self.relative);
        self.absolute_centers = words.absolute_centers.unwrap_or(self.absolute_centers);
        self.initial_level = words.initial_level.unwrap_or(self.initial_level);
    }

    fn set_motion(&mut self, motion: Motion) {
        self.motion_given = true;
        match motion {
            // For their block only.
            Motion::Spline(Spline::Cubic | Spline::Quadratic) => return,
            Motion::Spline(Spline::Nurbs) => {}
            _ => self.nurbs = None,
        }
        self.motion = motion;
        if !matches!(motion, Motion::Cycle(_)) {
            (self.series.cycle, self.series.initial) = (None, None);
        }
    }

    fn set_path_mode(&mut self, block: &Block) {
        // A negative number counts as none.
        let metres = |letter| {
            block.get(letter).filter(|it| *it >= 0.0).map(|length| self.units.to_metres(length))
        };
        match block.g.path_control {
            Some(PathControl::ExactPath) => self.path_mode = PathMode::ExactPath,
            Some(PathControl::ExactStop) => self.path_mode = PathMode::ExactStop,
            Some(PathControl::Blend) => {
                self.path_mode = match metres(Letter::P) {
                    Some(path) => PathMode::Tolerance { path, naive_cam: metres(Letter::Q) },
                    None => PathMode::Continuous,
                }
            }
            None => {}
        }
    }

    /// `seconds` in ns.
    ///
    /// # Errors
    /// [`DecodeError::OutOfRange`].
    pub(super) fn dwell_ns(seconds: f64) -> Result<i64, DecodeError> {
        if !(0.0..=MAX_DWELL_S).contains(&seconds) {
            let (min, max) = (0.0, MAX_DWELL_S);
            let letter = Letter::P.as_char();
            return Err(DecodeError::OutOfRange { letter, value: seconds, min, max, unit: " s" });
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 10¹⁵")]
        Ok((seconds * 1e9).round() as i64)
    }

    /// Waits for `seconds`, or what the control of the program makes of this number.
    pub(super) fn dwell(&mut self, seconds: f64, out: &mut Output) -> Result<(), DecodeError> {
        let seconds = self.numbers_of.map_or(seconds, |control| control.seconds(seconds));
        let time_ns = Self::dwell_ns(seconds)?;
        self.stand(ElementKind::Dwell { time_ns }, MParameters::default(), out);
        Ok(())
    }

    pub(super) fn m_function(&mut self, number: u16, k: Option<f64>, out: &mut Output) {
        let parameters = MParameters { k, ..MParameters::default() };
        self.stand(ElementKind::MFunction { number }, parameters, out);
    }
}

/// The axes that a block names; a canned cycle names the normal of its plane too, G76 X and Z.
fn words_of(block: &Block, motion: Option<Motion>, axes: [Axis; 3]) -> Words {
    let [.., normal] = axes;
    let letters = block.letters();
    let polar = letters.meets(Letters::POLAR);
    let names = |axis: usize| {
        Letter::AXES.get(axis).is_some_and(|letter| letters.contains(*letter))
            || (polar && axis < 2)
            || (matches!(motion, Some(Motion::Cycle(_))) && axis == normal.index)
            || (motion == Some(Motion::Thread(Thread::Cycle)) && matches!(axis, 0 | 2))
    };
    Words { named: std::array::from_fn(names), ..Words::default() }
}
