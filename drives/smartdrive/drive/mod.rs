//! Up to five drives on one bus as a [`Drive`].

mod checks;
pub(crate) mod follow;
mod following;
mod homing;
mod positions;
mod settings;
mod stopping;

pub use settings::OUTPUTS;

use std::time::Duration;

use tokio::runtime::Runtime;

use self::{homing::Homing, positions::Frozen};
use super::{Command, DriveState, Init, Mode, SmartDrive, SmartDriveOptions, wire_time};
use crate::drive::follow::{Follower, GoTo};
use twin_drives::{
    Action, Axes, Clock, Commanded, DeviceLimits, Drive, DriveError, Exchange, HomingWays,
    Identity, Increments, Losses, MAX_DRIVE_AXES, ParameterId, ParameterInfo, Sample,
    SetpointStream, Signals, Stamp, drive::is_zero, no_clock,
};

/// What a drive takes for its answer until it is known better.
const RESPONSE: Duration = Duration::from_millis(2);

/// What one drive showed, and when.
type Seen = (DriveState, Stamp);

/// SmartDRIVE devices on a serial port, one axis each; increments are µsteps.
///
/// A drive forgets its position whenever its mode changes: [`Drive::enable`] makes it 0 unless the drive obeyed already
/// and goes by its parameters (see [`crate::SetEffect`]).
/// [`Drive::set_position`] gives positions another zero in the driver alone; the drive's own counter, and with it its
/// position limits, stays as it is. Outputs are numbered 1 RDY, 2 BRK, 3 LED of the first drive, then those of the
/// second.
///
/// The drives are asked one after the other; a sample has all positions at the middle of that time, to which each is
/// carried over by the follower's model of it.
///
/// Owns the runtime its exchanges run on; calls must not be made from within another runtime.
#[derive(Debug)]
pub struct SmartDriveBus {
    bus: SmartDrive,
    follower: Follower,
    /// Position of the caller where the drive's counter is 0.
    zeros: Increments,
    homing: [Homing; MAX_DRIVE_AXES],
    /// Drives that have been given parameters which count from their next mode on.
    outdated: [bool; MAX_DRIVE_AXES],
    /// Counters that [`Drive::move_to`] has sent the drives to, until something else moves or stops them; none of those
    /// that it has left alone.
    sent: Vec<Option<i32>>,
    /// How long drives on their way have shown the same counter.
    frozen: [Frozen; MAX_DRIVE_AXES],
    /// Counters that the drives have confirmed to go to, until something else moves or stops them.
    commanded: [Option<i32>; MAX_DRIVE_AXES],
    /// Drives that [`Drive::soft_stop`] has seen at rest, until something moves them.
    standing: Vec<u8>,
    /// When the stream's clock showed that drives were last asked what is known, and how often.
    witnessed: (i64, usize),
    /// Last, so that the port is closed while its runtime exists.
    runtime: Runtime,
}

impl SmartDriveBus {
    /// Opens the serial port. Sends nothing.
    ///
    /// # Errors
    /// If an option is impossible or the port cannot be opened.
    pub fn open(port: &str, options: &SmartDriveOptions) -> Result<Self, DriveError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|source| {
            let address = options.axes.first().map_or(0, |axis| axis.address);
            let at = Exchange { port: port.into(), address, action: Action::Open };
            DriveError::Transport { at, source }
        })?;
        let bus = {
            let _inside = runtime.enter();
            SmartDrive::open(port, options)?
        };
        Ok(Self::on(runtime, bus, options))
    }

    /// The drive of an opened bus, on a runtime whose time may be virtual.
    pub fn on(runtime: Runtime, bus: SmartDrive, options: &SmartDriveOptions) -> Self {
        let follower = follow::follower(&options.axes, RESPONSE);
        let (zeros, homing) = ([0; MAX_DRIVE_AXES], Default::default());
        let outdated = [false; MAX_DRIVE_AXES];
        let (sent, standing, commanded) = (Vec::new(), Vec::new(), [None; MAX_DRIVE_AXES]);
        let frozen = [Frozen::default(); MAX_DRIVE_AXES];
        let witnessed = (0, 0);
        Self {
            bus,
            follower,
            zeros,
            homing,
            outdated,
            sent,
            frozen,
            commanded,
            standing,
            witnessed,
            runtime,
        }
    }

    /// Homes these axes (indices of the arrays), all at once, and returns when they are home; their positions are those
    /// of the drives then: `PosOffset`, or 0 after going so far ([`crate::HomePosition`]).
    ///
    /// # Errors
    /// If a drive refuses, is in alarm or does not find its switch; the others go on homing.
    pub fn home(&mut self, axes: &[usize]) -> Result<(), DriveError> {
        self.restart();
        let chosen: Vec<(usize, u8)> =
            self.axes().enumerate().filter(|(index, _)| axes.contains(index)).collect();
        for (_, address) in &chosen {
            self.runtime.block_on(self.bus.init(*address, Init::Homing))?;
        }
        for (index, address) in chosen {
            self.runtime.block_on(self.bus.homed(address))?;
            self.position_lost(index);
            if let Some(homing) = self.homing.get_mut(index) {
                *homing = Homing::Home;
            }
        }
        Ok(())
    }

    /// Everything else a drive can do, in blocking calls: `run(|bus| bus.save(1))` with a future of the bus.
    ///
    /// What moves a drive or changes its mode, position or address leaves the driver's idea of it wrong until
    /// [`Drive::enable`] and [`Drive::set_position`] are called again.
    pub fn run<T>(&mut self, request: impl AsyncFnOnce(&mut SmartDrive) -> T) -> T {
        self.restart();
        self.runtime.block_on(request(&mut self.bus))
    }

    /// Something else than following or [`Drive::move_to`] moves or stops the drives.
    fn restart(&mut self) {
        self.follower.restart();
        self.sent.clear();
        self.frozen = Default::default();
        self.standing.clear();
        self.commanded = [None; MAX_DRIVE_AXES];
    }

    /// Addresses in use, in the order of the arrays.
    fn axes(&self) -> impl Iterator<Item = u8> + use<'_> {
        self.bus.options().axes.iter().map(|axis| axis.address)
    }

    fn state(&mut self, address: u8, clock: &dyn Clock) -> Result<Seen, DriveError> {
        self.runtime.block_on(self.bus.state(address, clock))
    }

    fn states(&mut self, clock: &dyn Clock) -> Result<Vec<Seen>, DriveError> {
        let addresses: Vec<u8> = self.axes().collect();
        addresses.into_iter().map(|address| self.state(address, clock)).collect()
    }
}

impl Drive for SmartDriveBus {
    fn describe(&self) -> String {
        let Exchange { port, .. } = self.bus.at(0, Action::Open);
        let addresses: Vec<String> = self.axes().map(|address| address.to_string()).collect();
        let plural = if addresses.len() == 1 { "" } else { "es" };
        format!("SmartDRIVE at {port}, address{plural} {}", addresses.join(", "))
    }

    fn axis_count(&self) -> usize {
        self.bus.options().axes.len()
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        self.who()
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        for axis in self.bus.options().axes.clone() {
            self.identify(&axis)?;
        }
        let seen = self.states(&|| stream.now_ns())?;
        Ok(self.to_sample(&seen))
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        self.restart();
        let command = Command::Mode(Some(Mode::Remote));
        let addresses: Vec<u8> = self.axes().collect();
        let mut changing = Vec::with_capacity(addresses.len());
        for (index, address) in addresses.into_iter().enumerate() {
            let (state, _) = self.state(address, &no_clock)?;
            let outdated = self.outdated.get(index).copied().unwrap_or(false);
            if outdated && state.moving() {
                let at = self.bus.at(address, command.action());
                return Err(DriveError::Moving { at, axes: Axes::Only });
            }
            if outdated || state.mode != Mode::Remote.number() {
                // One that still changes would refuse.
                if state.mode == Mode::Changing.number() {
                    self.runtime.block_on(self.bus.changed(address, &command))?;
                }
                self.runtime.block_on(self.bus.send(address, &command, &no_clock))?;
                changing.push((index, address));
            }
        }
        for (index, address) in changing {
            let found = self.runtime.block_on(self.bus.changed(address, &command))?;
            self.position_lost(index);
            self.renewed(index);
            let expected = Mode::Remote.number();
            if found != expected {
                let at = self.bus.at(address, command.action());
                return Err(DriveError::Mode { at, expected, found });
            }
        }
        Ok(())
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
        self.switch_output(output, on)
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        let seen = self.states(&no_clock)?;
        self.check_rest(&seen)?;
        self.restart();
        for ((zero, position), (state, _)) in self.zeros.iter_mut().zip(position).zip(&seen) {
            *zero = position.saturating_sub(state.position.into());
        }
        Ok(())
    }

    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        let before = self.commanded;
        self.restart();
        let axes = self.bus.options().axes.clone();
        let mut sent = Vec::with_capacity(axes.len());
        let mut commands = Vec::with_capacity(axes.len());
        for (index, ((axis, target), speed)) in axes.iter().zip(target).zip(speed).enumerate() {
            if is_zero(*speed) {
                sent.push(None);
                continue;
            }
            let target = self.counter(index, axis.address, *target)?;
            let rate = axis.acceleration_rpm_per_s.max(axis.deceleration_rpm_per_s);
            // No more than asked for: rounded down, but for what only rounding has made less than whole.
            let rpm = (axis.turn.rpm(*speed) + 1e-6).floor();
            let high = f64::from(axis.velocity_rpm);
            if !(1.0..=high).contains(&rpm) {
                let command = GoTo { target, speed: 1, rate }.command();
                return Err(DriveError::Value {
                    at: self.bus.at(axis.address, command.action()),
                    what: "speed",
                    value: *speed,
                    unit: "µsteps/s",
                    low: axis.turn.steps(1.0),
                    high: axis.turn.steps(high),
                });
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "just compared"
            )]
            let speed = rpm as u16;
            commands.push((axis.address, GoTo { target, speed, rate }.command()));
            sent.push(Some(target));
        }
        for (address, command) in commands {
            let done = self.runtime.block_on(self.bus.send(address, &command, &no_clock));
            done.map_err(|error| self.explain(address, error))?;
        }
        for (place, (sent, before)) in self.commanded.iter_mut().zip(sent.iter().zip(before)) {
            // One that is left alone goes on to where it was sent before.
            *place = sent.or(before);
        }
        self.sent = sent;
        Ok(())
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let mut seen = self.states(&|| stream.now_ns())?;
        if self.stray(&seen).is_some() {
            // The answer may have been spoilt, and not the command.
            seen = self.states(&|| stream.now_ns())?;
        }
        let addresses: Vec<u8> = self.axes().collect();
        for (address, (state, _)) in addresses.into_iter().zip(&seen) {
            self.check(address, state, Action::ReadState)?;
        }
        if let Some(error) = self.stray(&seen).or_else(|| self.frozen(&seen)) {
            return Err(error);
        }
        Ok(self.to_sample(&seen))
    }

    /// One of the drives is neither in REMOTE nor in alarm, and its counter is 0.
    fn shows_restart(&mut self) -> Result<bool, DriveError> {
        let seen = self.states(&no_clock)?;
        Ok(seen.iter().any(|(state, _)| {
            state.mode != Mode::Remote.number() && state.alarms.is_empty() && state.position == 0
        }))
    }

    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        self.follow_round(stream)
    }

    fn losses(&self) -> Losses {
        self.bus.exchanges().losses()
    }

    fn round(&self) -> Option<Duration> {
        // GOTO v,a and its answer for each axis, 11 + 9 bytes.
        let exchange = wire_time(11 + 9) + self.bus.exchanges().shortest_turnaround()?;
        Some(exchange * u32::try_from(self.axis_count()).unwrap_or(1))
    }

    fn commanded(&self) -> Commanded {
        self.commanded_positions()
    }

    /// STOP to all drives of the line, also those not in use, several times: nobody confirms it. Then asks until the
    /// drives in use are at rest, every one of them, whatever the others say.
    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.stop_softly()
    }

    /// After a [`Drive::soft_stop`] that some drives have confirmed: MODE 0 to those in use that have not, and the others
    /// keep their current, for what hangs on them would fall. Else MODE 0 to all drives of the line, also those not in use.
    /// Then asks until those are off.
    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.stop_hard()
    }

    fn limits(&mut self) -> Result<[DeviceLimits; MAX_DRIVE_AXES], DriveError> {
        self.axis_limits()
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, DriveError> {
        Ok(self.all_parameters())
    }

    fn parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        self.read_parameter(id)
    }

    fn set_parameter(&mut self, id: ParameterId, value: i64) -> Result<(), DriveError> {
        self.write_parameter(id, value)
    }

    fn unsaved_parameters(&mut self, ids: &[ParameterId]) -> Result<Vec<ParameterId>, DriveError> {
        self.unsaved(ids)
    }

    fn save_parameters(&mut self) -> Result<(), DriveError> {
        self.save()
    }
}
