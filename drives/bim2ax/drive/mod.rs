//! The module as a [`Drive`].

mod checks;
mod encoders;
pub(crate) mod follow;
mod homing;
mod leg;
pub(crate) mod options;
mod positions;
mod settings;

use std::time::Duration;

use tokio::{runtime::Runtime, time::sleep};

pub use options::Bim2AxDriveOptions;

use encoders::Encoders;
use homing::Homes;
use leg::mean;

use super::{AXES, AxisSettings, Bim2Ax, BusStamp, ModuleAxis, Start};
use crate::{
    drive::follow::{Follower, Timing},
    protocol::{
        bits::{coefficient, message},
        memory::Memory,
        zone::{Positions, WriteZone},
    },
};
use twin_drives::{
    Action, Clock, Commanded, DeviceLimits, Drive, DriveError, Exchange, HomingWays, Identity,
    Increments, Losses, MAX_DRIVE_AXES, ParameterId, ParameterInfo, Sample, SetpointStream,
    Signals, drive::is_zero, exchanges::Repeats, no_clock,
};

/// Order latency that the manual promises at most, ns (5.5: "au maximum de 10ms").
const ORDER_NS: i64 = 10_000_000;
/// Duration of a look until it is known better, ns.
const LOOK_NS: i64 = 2_000_000;
/// What keeps a module from being enabled.
const FAULTS: u16 = message::POWER_ABSENT | message::PHASE_OPEN | message::PHASE_SHORT;

/// Where following is.
#[derive(Clone, Copy, Debug, Default)]
enum Following {
    /// Nothing is known.
    #[default]
    Unknown,
    /// The axes rest there.
    Rest([i32; AXES]),
    /// They move, probably until then, ns.
    Leg(i64),
}

/// Orders of legs that came to nothing.
#[derive(Clone, Copy, Debug, Default)]
struct Vain {
    /// In a row without answer, and since when.
    unanswered: Option<(Repeats, u32)>,
    /// In a row confirmed and without effect.
    idle: u32,
    /// Where the last leg began.
    from: [i32; AXES],
}

/// What keeps a move from being what was meant: phases are off after a reset, when positions are lost, and a move would
/// switch them on.
const NOT_READY: u16 = FAULTS | message::PHASES_OFF;
/// Looks that have to agree on something being wrong: one may have been spoilt on the bus, which has no check sums.
const STRAY_LOOKS: u32 = 2;

/// A BIM2AX-BOCM module behind a memory.
///
/// Owns the runtime its exchanges run on; calls must not be made from within another runtime.
#[derive(Debug)]
pub struct Bim2AxDrive {
    module: Bim2Ax,
    options: Bim2AxDriveOptions,
    /// Of the axes in use, once the module has reported them.
    settings: Vec<AxisSettings>,
    encoders: Encoders,
    follower: Follower,
    following: Following,
    /// Homing has been begun and its end not been seen.
    homing: bool,
    /// What is known of the axes that are homed, until their counters have been looked at.
    homes: Homes,
    /// Where the axes in use have been sent, until something else moves or stops them.
    sent: Option<[i32; AXES]>,
    /// Legs in a row whose orders have had no effect, or no answer, and where the last of them was to begin.
    vain: Vain,
    timing: Timing,
    runtime: Runtime,
}

impl Bim2AxDrive {
    /// The module in a memory; `port` is its name in messages. Reads and writes nothing.
    ///
    /// # Errors
    /// If no axis is in use or one twice, or there is no runtime.
    pub fn new(
        port: &str,
        memory: impl Memory + 'static,
        options: &Bim2AxDriveOptions,
    ) -> Result<Self, DriveError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        let runtime = runtime.map_err(|source| {
            let at = Exchange { port: port.into(), address: 0, action: Action::Open };
            DriveError::Transport { at, source }
        })?;
        Self::on(runtime, port, memory, options)
    }

    /// The same on a runtime of the caller's, whose time may be virtual.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn on(
        runtime: Runtime,
        port: &str,
        memory: impl Memory + 'static,
        options: &Bim2AxDriveOptions,
    ) -> Result<Self, DriveError> {
        let twice = matches!(*options.axes, [a, b] if a == b);
        if options.axes.is_empty() || options.axes.len() > AXES || twice {
            let value = u32::try_from(options.axes.len()).unwrap_or(u32::MAX);
            let high = if twice { 1 } else { 2 };
            let setting = "number of axes";
            let at = Exchange { port: port.into(), address: 0, action: Action::Open };
            return Err(DriveError::Setting { at, setting, value, low: 1, high });
        }
        let timing = Timing { order_ns: ORDER_NS, look_ns: LOOK_NS };
        Ok(Self {
            module: Bim2Ax::new(port, memory, &options.driver),
            options: options.clone(),
            settings: Vec::new(),
            encoders: Encoders::default(),
            follower: Follower::new(&[], timing),
            following: Following::Unknown,
            homing: false,
            homes: Homes::default(),
            sent: None,
            vain: Vain::default(),
            timing,
            runtime,
        })
    }

    /// The settings of the axes in use, and their encoders where those are others or these are to be looked for `anew`.
    fn prepare(&mut self, anew: bool) -> Result<(), DriveError> {
        let mut settings = Vec::with_capacity(AXES);
        for axis in self.options.axes.clone() {
            let of_axis = self.runtime.block_on(self.module.axis_settings(axis, &no_clock))?;
            if !of_axis.has(coefficient::PRESENT) {
                let setting = "presence of the axis, coefficient bit 0";
                let at = self.module.at(Action::Identify);
                return Err(DriveError::Setting { at, setting, value: 0, low: 1, high: 1 });
            }
            settings.push(of_axis);
        }
        if anew || self.settings != settings {
            self.find_encoders(&settings)?;
        }
        self.follower = Follower::new(&settings, self.timing);
        self.settings = settings;
        Ok(())
    }

    fn prepared(&mut self) -> Result<(), DriveError> {
        if self.settings.is_empty() { self.prepare(true) } else { Ok(()) }
    }

    fn look(&mut self, clock: &dyn Clock) -> Result<(Positions, BusStamp), DriveError> {
        self.runtime.block_on(self.module.positions(clock))
    }

    /// Something else than following and [`Drive::move_to`] moves or stops the axes.
    fn forget(&mut self) {
        self.following = Following::Unknown;
        self.sent = None;
        self.homes = Homes::default();
    }
}

impl Drive for Bim2AxDrive {
    fn describe(&self) -> String {
        format!("BIM2AX-BOCM at {}", self.module.at(Action::Open).port)
    }

    fn axis_count(&self) -> usize {
        self.options.axes.len()
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        self.who()
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let clock = || stream.now_ns();
        self.runtime.block_on(self.module.identify(&clock))?;
        // Its parameters may have been changed since.
        self.prepare(true)?;
        let (seen, stamp) = self.look(&clock)?;
        self.check(&seen, Action::Identify, |messages| messages & FAULTS != 0)?;
        Ok(self.to_sample(&seen, &stamp))
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        self.prepared()?;
        let axes = self.options.axes.clone();
        self.runtime.block_on(self.module.energise(&axes, &no_clock))
    }

    fn disable(&mut self) -> Result<(), DriveError> {
        self.lock()
    }

    fn begin_homing(&mut self, ways: &HomingWays) -> Result<(), DriveError> {
        self.start_homing(ways)
    }

    fn homed(&mut self) -> Result<[Option<bool>; MAX_DRIVE_AXES], DriveError> {
        self.homed_axes()
    }

    fn signals(&mut self, clock: &dyn Clock) -> Result<Signals, DriveError> {
        self.all_signals(clock)
    }

    fn set_output(&mut self, output: u8, on: bool) -> Result<(), DriveError> {
        // The only output is the watchdog, which is the module's own (1).
        let at = self.module.at(Action::SwitchOutput { output, on });
        Err(DriveError::Unsupported { at, what: "outputs" })
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        self.forget();
        let axes = self.options.axes.clone();
        let mut wanted = Vec::with_capacity(AXES);
        for (axis, position) in axes.iter().zip(position) {
            wanted.push((*axis, self.register(*axis, *position)?));
        }
        let (before, _) = self.look(&no_clock)?;
        let moving = self.moving(&before);
        if moving != 0 {
            let at = self.module.at(Action::ReadState);
            return Err(DriveError::Moving { at, axes: self.names(moving) });
        }
        self.encoders.forget();
        for ((axis, position), found) in wanted.iter().zip(self.in_order(&before)) {
            // An encoder that shows something else gets the position, too.
            if *position == found && !self.encoders.any() {
                continue;
            }
            self.runtime.block_on(self.module.preset(*axis, *position, &no_clock))?;
        }
        let (after, _) = self.look(&no_clock)?;
        for ((place, (_, written)), found) in (0_u8..).zip(wanted).zip(self.in_order(&after)) {
            if found != written {
                let at = self.module.at(Action::ReadState);
                let (written, found) = (written.into(), found.into());
                return Err(DriveError::NotWritten {
                    at,
                    axis: self.names(1 << place),
                    written,
                    found,
                });
            }
        }
        Ok(())
    }

    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        self.forget();
        self.prepared()?;
        let before = self.ready()?;
        // Axes that are left alone stay where they are.
        let mut sent = self.in_order(&before);
        let mut starts = Vec::with_capacity(AXES);
        for ((axis, settings), (target, speed)) in
            self.options.axes.iter().zip(&self.settings).zip(target.iter().zip(speed))
        {
            if is_zero(*speed) {
                starts.push(None);
                continue;
            }
            let target = self.register(*axis, *target)?;
            self.within(*axis, settings, (&before, target))?;
            if let Some(place) = sent.get_mut(starts.len()) {
                *place = target;
            }
            let units = (speed / settings.mode.speed_unit()).round();
            if !(1.0..=65_535.0).contains(&units) {
                let action = Action::Command { number: axis.number(), name: "speed of the axis" };
                let (at, value) = (self.module.at(action), *speed);
                let (low, high) = (settings.mode.speed_unit(), settings.speed(u16::MAX));
                // The zone begins with the target, four bytes.
                let register = u16::from(WriteZone::of_axis(*axis).offset()) + 4;
                return Err(DriveError::Range {
                    at, register, value, unit: "µsteps/s", low, high
                });
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "just compared"
            )]
            let units = units as u16;
            starts.push(Some(Start { to: target, speed: Some(units), directly: false }));
        }
        let starts = self.by_axis(&starts);
        self.runtime.block_on(self.module.start(starts, &no_clock))?;
        // Where one that moves already will stand is not known.
        self.sent = (self.moving(&before) == 0).then_some(sent);
        Ok(())
    }

    /// "New move while moving" is refused (4.3, message bit 14).
    fn retargets(&self) -> bool {
        false
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let (seen, stamp) = self.obeying(&|| stream.now_ns())?;
        Ok(self.to_sample(&seen, &stamp))
    }

    /// Every axis in use is without current, not homed, and at 0.
    fn shows_restart(&mut self) -> Result<bool, DriveError> {
        self.runtime.block_on(self.module.identify(&no_clock))?;
        let (seen, _) = self.look(&no_clock)?;
        let reset = |axis: &crate::ModuleAxis| {
            let messages = seen.messages.get(axis.index()).copied().unwrap_or(0);
            let off = messages & message::PHASES_OFF != 0 && messages & message::HOMED == 0;
            off && seen.positions.get(axis.index()).copied() == Some(0)
        };
        Ok(self.options.axes.iter().all(reset))
    }

    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        self.prepared()?;
        let every_ns = i64::try_from(self.options.look_every.as_nanos()).unwrap_or(i64::MAX);
        // From the begin of one look to that of the next.
        let pause_ns = (every_ns - self.timing.look_ns).max(0);
        let following = self.following;
        let wait_ns = match following {
            Following::Unknown => 0,
            Following::Rest(rest) if self.next_leg(stream, rest)? => 0,
            Following::Rest(_) => pause_ns,
            // The look is to begin when the leg ends; if it has not ended then, the next begins soon.
            Following::Leg(end_ns) => (end_ns - stream.now_ns()).clamp(0, pause_ns),
        };
        if let Ok(wait_ns @ 1..) = u64::try_from(wait_ns) {
            self.runtime.block_on(async { sleep(Duration::from_nanos(wait_ns)).await });
        }
        let (seen, stamp) = self.obeying(&|| stream.now_ns()).inspect_err(|_| self.forget())?;
        // With a look at the encoders it takes longer.
        let until_ns = if self.encoders.any() { stream.now_ns() } else { stamp.answered_ns };
        let look_ns = until_ns - stamp.sent_ns;
        self.timing.look_ns = mean(self.timing.look_ns, look_ns);
        self.follower.set_timing(self.timing);
        if self.moving(&seen) == 0 {
            self.following = Following::Rest(self.in_order(&seen));
        }
        Ok(self.to_sample(&seen, &stamp))
    }

    fn losses(&self) -> Losses {
        self.module.exchanges().losses()
    }

    fn commanded(&self) -> Commanded {
        let mut positions = [None; MAX_DRIVE_AXES];
        let targets = self.sent.iter().flatten().take(self.options.axes.len());
        for (position, target) in positions.iter_mut().zip(targets) {
            *position = Some(i64::from(*target));
        }
        positions
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.forget();
        let ramps = self.settings.iter().map(|axis| axis.speed(u16::MAX) / axis.rate());
        let slowest = Duration::try_from_secs_f64(ramps.fold(0.0, f64::max)).unwrap_or_default();
        let patience = slowest + 20 * self.options.driver.deadline;
        let rested = self.runtime.block_on(async {
            self.module.abandon(&no_clock).await?;
            self.module.rested(patience, &no_clock).await
        })?;
        self.check_rest(rested)
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.forget();
        // What is lost with it is not the encoders' to tell.
        self.encoders.forget();
        self.runtime.block_on(self.module.stop_hard(&no_clock))?;
        // One look may have been spoilt.
        for _ in 0..STRAY_LOOKS {
            let (seen, _) = self.look(&no_clock)?;
            let moving = self.moving(&seen);
            if moving != 0 {
                let at = self.module.at(Action::ReadState);
                return Err(DriveError::Moving { at, axes: self.names(moving) });
            }
        }
        Ok(())
    }

    fn limits(&mut self) -> Result<[DeviceLimits; MAX_DRIVE_AXES], DriveError> {
        self.axis_limits()
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, DriveError> {
        self.all_parameters()
    }

    fn parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        self.read_parameter(id)
    }

    fn set_parameter(&mut self, id: ParameterId, value: i64) -> Result<(), DriveError> {
        self.write_parameter(id, value)
    }
}
