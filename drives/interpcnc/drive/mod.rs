//! The board as a [`Drive`].

mod encoder;
pub(crate) mod follow;
mod following;
mod homing;
mod settings;

use std::time::Duration;

use tokio::{runtime::Runtime, time::timeout};

pub(super) use self::encoder::EVERY as ENCODER_EVERY;
use self::{encoder::Watched, homing::Homing, settings::Wiring};
use super::{
    AxisValues, BoardAxis, BoardState, Command, InterpCnc, InterpCncOptions, MoveProfile, Stamp,
};
use crate::{
    client::options::Following,
    drive::follow::{Buffered, Follower},
    protocol::{
        parameters,
        registers::{AXES, AxisMask, COMMAND, STATE_REGISTERS, Status},
    },
};
use twin_drives::{
    Action, Axes, Clock, Commanded, DeviceLimits, Drive, DriveError, Exchange, HomingWays,
    Identity, Increments, Losses, MAX_DRIVE_AXES, ParameterId, ParameterInfo, Sample,
    SetpointStream, Signals, drive::is_zero, no_clock,
};

/// An InterpCNC board on a serial port.
///
/// Owns the runtime its exchanges run on; calls must not be made from within another runtime.
#[derive(Debug)]
pub struct InterpCncDrive {
    board: InterpCnc,
    follower: Follower,
    /// Instead of the follower, where segments are buffered.
    buffered: Option<Buffered>,
    homing: Homing,
    /// The axis with the encoder.
    encoder: Option<Watched>,
    /// Targets of the axes in use that the board has confirmed, until something else moves or stops them.
    commanded: [Option<i32>; MAX_DRIVE_AXES],
    /// Meaning of the inputs, once the board has reported it.
    wiring: Option<Wiring>,
    /// Last, so that the port is closed while its runtime exists.
    runtime: Runtime,
}

impl InterpCncDrive {
    /// Opens the serial port. Sends nothing.
    ///
    /// # Errors
    /// If an option is impossible or the port cannot be opened.
    pub fn open(port: &str, options: &InterpCncOptions) -> Result<Self, DriveError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|source| {
            let at = Exchange { port: port.into(), address: options.address, action: Action::Open };
            DriveError::Transport { at, source }
        })?;
        let board = {
            let _inside = runtime.enter();
            InterpCnc::open(port, options)?.alone()
        };
        Ok(Self::on(runtime, board, options))
    }

    /// The drive of an opened board, on a runtime whose time may be virtual.
    pub fn on(runtime: Runtime, board: InterpCnc, options: &InterpCncOptions) -> Self {
        let follower = follow::follower(&options.axes, options.line);
        let buffered = match options.following {
            Following::Retargeted => None,
            Following::Buffered { start_stop_hz, acceleration_khz_per_s: rate } => {
                Some(Buffered::new(&options.axes, options.line, start_stop_hz, rate))
            }
        };
        let (homing, commanded) = (Homing::default(), [None; MAX_DRIVE_AXES]);
        let encoder = Watched::new(options);
        Self { board, follower, buffered, homing, encoder, commanded, wiring: None, runtime }
    }

    /// The board itself, for everything that not all drives can do, and the runtime for its calls. What moves axes
    /// makes the next call of [`Drive::follow`] start from where they are.
    pub fn board(&mut self) -> (&mut InterpCnc, &Runtime) {
        self.restart();
        self.encoder.iter_mut().for_each(Watched::forget);
        self.wiring = None;
        (&mut self.board, &self.runtime)
    }

    /// Something else than following moves or stops the axes.
    fn restart(&mut self) {
        self.follower.restart();
        self.commanded = [None; MAX_DRIVE_AXES];
        self.encoder.iter_mut().for_each(Watched::restart);
        if let Some(buffered) = &mut self.buffered {
            buffered.restart();
        }
    }

    /// Segments are planned for the ramps of parameters 4 and 5: the board must have those.
    fn check_ramps(&mut self) -> Result<(), DriveError> {
        let Following::Buffered { start_stop_hz, acceleration_khz_per_s } =
            self.board.options().following
        else {
            return Ok(());
        };
        let assumed = self.board.options().assumptions;
        for (number, unit, expected) in [
            (assumed.segment_acceleration, "1000 steps/s²", u32::from(acceleration_khz_per_s)),
            (assumed.segment_start_stop, "steps/s", u32::from(start_stop_hz)),
        ] {
            let found = self.runtime.block_on(self.board.parameter(number, &no_clock))?;
            if found != expected {
                let address = parameters::FIRST_PARAMETER + 2 * number;
                let at = self.board.at(Action::Read { what: "parameter", address, count: 2 });
                return Err(DriveError::ParameterDiffers { at, number, unit, expected, found });
            }
        }
        Ok(())
    }

    fn state(&mut self, clock: &dyn Clock) -> Result<(BoardState, Stamp), DriveError> {
        self.runtime.block_on(self.board.state(clock))
    }

    fn send(&mut self, command: &Command, clock: &dyn Clock) -> Result<Stamp, DriveError> {
        self.runtime.block_on(self.board.send(command, clock))
    }

    /// Board axes in use, in the order of the arrays.
    fn axes(&self) -> impl Iterator<Item = BoardAxis> + use<'_> {
        self.board.options().axes.iter().map(|axis| axis.axis)
    }

    fn moving(&self, state: &BoardState) -> AxisMask {
        let mask = self.board.options().mask();
        // Command 71 moves its axes one after the other on some boards: until it is over they are on their way.
        let homing = state.status.has(Status::HOMING_IN_PROGRESS);
        if homing { mask } else { state.status.moving().intersection(mask) }
    }

    fn to_sample(&self, state: &BoardState, stamp: Stamp) -> Sample {
        let mut position = [0; MAX_DRIVE_AXES];
        for (position, axis) in position.iter_mut().zip(self.axes()) {
            *position = counter(state, axis).into();
        }
        Sample { time_ns: stamp.executed_ns, position, moving: !self.moving(state).is_empty() }
    }

    /// Reads the state of a board that is expected to obey.
    fn obeying_state(&mut self, clock: &dyn Clock) -> Result<(BoardState, Stamp), DriveError> {
        let (state, stamp) = self.state(clock)?;
        self.board.check_obeys(&state, Action::ReadState)?;
        let switches = state.status.on_limit_switch().intersection(self.board.options().mask());
        // Some home on their limit switches.
        if !switches.is_empty() && !state.status.has(Status::HOMING_IN_PROGRESS) {
            return Err(DriveError::LimitSwitch {
                at: self.board.at(Action::ReadState),
                axes: Axes::Letters(switches.bits()),
            });
        }
        Ok((state, stamp))
    }

    /// A position as a counter holds it.
    fn counter_value(
        &self,
        command: &Command,
        register: u16,
        position: i64,
    ) -> Result<i32, DriveError> {
        i32::try_from(position).map_err(|_beyond| {
            #[expect(clippy::cast_precision_loss, reason = "for a message")]
            let value = position as f64;
            let (low, high) = (i32::MIN.into(), i32::MAX.into());
            let at = self.board.at(command.action());
            DriveError::Range { at, register, value, unit: "steps", low, high }
        })
    }
}

fn counter(state: &BoardState, axis: BoardAxis) -> i32 {
    state.positions.get(axis.index()).copied().unwrap_or(0)
}

impl Drive for InterpCncDrive {
    fn describe(&self) -> String {
        let Exchange { port, address, .. } = self.board.at(Action::Open);
        format!("InterpCNC at {port}, address {address}")
    }

    fn axis_count(&self) -> usize {
        self.board.options().axes.len()
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        self.who()
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let (state, stamp) = self.state(&|| stream.now_ns())?;
        if state.status.enable_open() {
            return Err(DriveError::EnableOpen { at: self.board.at(Action::ReadState) });
        }
        self.find_encoder(&|| stream.now_ns())?;
        Ok(self.to_sample(&state, stamp))
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        self.check_ramps()?;
        self.runtime.block_on(self.board.unlock(&no_clock))
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
        self.runtime.block_on(self.board.set_output(output, on, &no_clock))
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        let mut command = Command::WritePosition { positions: [None; AXES] };
        let mut positions: AxisValues = [None; AXES];
        let mut register = COMMAND + 2;
        let wanted: Vec<_> = self.axes().zip(position.iter().copied()).collect();
        for (axis, position) in &wanted {
            let value = self.counter_value(&command, register, *position)?;
            if let Some(slot) = positions.get_mut(axis.index()) {
                *slot = Some(value);
            }
            register += 2;
        }
        command = Command::WritePosition { positions };
        let (before, _) = self.state(&no_clock)?;
        let moving = self.moving(&before);
        if !moving.is_empty() {
            return Err(DriveError::Moving {
                at: self.board.at(command.action()),
                axes: Axes::Letters(moving.bits()),
            });
        }
        self.restart();
        self.encoder.iter_mut().for_each(Watched::forget);
        self.send(&command, &no_clock)?;
        let (after, _) = self.state(&no_clock)?;
        for (axis, written) in wanted {
            let found = i64::from(counter(&after, axis));
            if found != written {
                let at = self.board.at(command.action());
                return Err(DriveError::NotWritten {
                    at,
                    axis: Axes::Letters(axis.mask().bits()),
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
        let mut commanded = self.commanded;
        self.restart();
        let mut commands = Vec::with_capacity(AXES);
        let axes = self.board.options().axes.clone();
        for (((options, target), speed), sent) in
            axes.iter().zip(target).zip(speed).zip(&mut commanded)
        {
            // One that is left alone goes on to where it was sent before.
            if is_zero(*speed) {
                continue;
            }
            let profile = MoveProfile {
                start_stop_hz: options.start_stop_hz,
                acceleration_khz_per_s: options.acceleration_khz_per_s,
                speed_hz: 0,
                deceleration_khz_per_s: options.deceleration_khz_per_s,
                target: 0,
            };
            let command = Command::Move { axis: options.axis, profile };
            let target = self.counter_value(&command, COMMAND + 7, *target)?;
            let high = f64::from(options.max_speed_hz);
            if !(1.0..=high).contains(&speed.round()) {
                let at = self.board.at(command.action());
                return Err(DriveError::Range {
                    at,
                    register: COMMAND + 4,
                    value: *speed,
                    unit: "steps/s",
                    low: 1.0,
                    high,
                });
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "just compared"
            )]
            let speed_hz = speed.round() as u32;
            *sent = Some(target);
            commands.push(Command::Move {
                axis: options.axis,
                profile: MoveProfile { speed_hz, target, ..profile },
            });
        }
        self.refer_encoder()?;
        commands.iter().try_for_each(|command| self.send(command, &no_clock).map(|_| ()))?;
        self.commanded = commanded;
        Ok(())
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let clock = || stream.now_ns();
        let (state, stamp) = self.obeying_state(&clock)?;
        self.watch_encoder((&state, &stamp), &clock)?;
        Ok(self.to_sample(&state, stamp))
    }

    /// Locked, and all counters 0.
    fn shows_restart(&mut self) -> Result<bool, DriveError> {
        let (state, _) = self.state(&no_clock)?;
        let reset = BoardAxis::ALL.into_iter().all(|axis| counter(&state, axis) == 0);
        Ok(state.status.locked() && reset)
    }

    fn hard_stop_keeps_position(&self) -> bool {
        true
    }

    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        self.follow_cycle(stream)
    }

    fn losses(&self) -> Losses {
        self.board.exchanges().losses()
    }

    fn round(&self) -> Option<Duration> {
        let options = self.board.options();
        let turnaround = self.board.exchanges().shortest_turnaround()?;
        let exchange = |bytes| options.line.duration(bytes) + 2 * options.silence() + turnaround;
        let sample = exchange(8 + 5 + 2 * usize::from(STATE_REGISTERS));
        let axes = options.axes.len();
        Some(match options.following {
            // Request 27 bytes, answer 8, for each axis.
            Following::Retargeted => sample + exchange(27 + 8) * u32::try_from(axes).unwrap_or(1),
            Following::Buffered { .. } => sample + exchange(17 + 4 * axes + 8),
        })
    }

    fn commanded(&self) -> Commanded {
        self.commanded.map(|target| target.map(i64::from))
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.restart();
        self.runtime.block_on(self.board.send_stop(&Command::RampStop, &no_clock))?;
        let options = self.board.options();
        let braking = |axis: &super::AxisOptions| {
            f64::from(axis.max_speed_hz) / (1e3 * f64::from(axis.deceleration_khz_per_s.max(1)))
        };
        let slowest = options.axes.iter().map(braking).fold(0.0, f64::max);
        let patience = Duration::from_secs_f64(slowest) + options.patience();
        let mask = options.mask();
        let mut moving = mask;
        let at_rest = async {
            loop {
                let (state, _) = self.board.state(&no_clock).await?;
                // Axes that stand go on if segments wait: those have to be gone, too.
                if state.status.stopped(mask) {
                    return Ok(());
                }
                moving = state.status.moving().intersection(mask);
            }
        };
        let rested = self.runtime.block_on(async { timeout(patience, at_rest).await });
        rested.unwrap_or_else(|_| {
            let at = self.board.at(Command::RampStop.action());
            Err(if moving.is_empty() {
                DriveError::Unfinished { at, patience }
            } else {
                DriveError::Moving { at, axes: Axes::Letters(moving.bits()) }
            })
        })?;
        self.check_stopped()
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.lock_at_once()
    }

    fn limits(&mut self) -> Result<[DeviceLimits; MAX_DRIVE_AXES], DriveError> {
        Ok(self.axis_limits())
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, DriveError> {
        Ok(self.all_parameters())
    }

    fn parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        self.read_parameter(id)
    }

    fn parameter_values(&mut self, ids: &[ParameterId]) -> Result<Vec<i64>, DriveError> {
        self.read_parameters(ids)
    }

    fn set_parameter(&mut self, id: ParameterId, value: i64) -> Result<(), DriveError> {
        self.write_parameter(id, value)
    }
}
