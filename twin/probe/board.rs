//! Command 40 on the axis's own board: the emulated InterpCNC of the machine file moves the axis. The probe of the
//! simulated machine is its input.

use super::axis::{AxisProbe, Search};
use twin_interpcnc::emulator::{Board, BoardOptions};
use twin_interpcnc::protocol::registers::{BoardAxis, MAX_SPEED_HZ};
use twin_interpcnc::{AxisValues, Command};
use twin_machine::{Axis, Counting, DriveFamily, Machine};

/// The input that the probe is wired to; which one it is makes no difference to an axis.
const INPUT: u8 = 1;

/// Reasons for which a board does not execute command 40.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoardRefusal {
    /// An argument that the command cannot say.
    #[error("{what} of {value:.0} {unit}: command 40 has 1 to {most} {unit}")]
    Range {
        /// Which.
        what: &'static str,
        /// Steps, steps/s, or thousands of steps/s².
        value: f64,
        /// Which of them.
        unit: &'static str,
        /// The largest that it can say.
        most: u32,
    },
    /// The axis begins where the board cannot count.
    #[error("the search begins at {increments:.0} steps; the board counts to {most} either way")]
    Beyond {
        /// Where.
        increments: f64,
        /// The largest count.
        most: i32,
    },
    /// The board says no.
    #[error("the emulated board refuses command 40 with exception {code}")]
    Exception {
        /// Modbus exception code.
        code: u8,
    },
    /// Command 40 has no window.
    #[error("command 40 has no window; a trip counts everywhere")]
    NoWindow,
    /// Another device than a board.
    #[error(
        "a {family} has no probing move of its own; without --drives-in-loop and in_loop the axis is moved by set-points"
    )]
    NoCommand {
        /// Its family.
        family: &'static str,
    },
}

/// A board on the search.
#[derive(Debug)]
pub(super) struct BoardSearch {
    board: Board,
    axis: BoardAxis,
    counting: Counting,
    from: f64,
    change: f64,
    tripped: bool,
}

impl BoardSearch {
    /// The board at rest at `from` (m or rad) with the command on its way; `None` for an axis whose drive is not in the loop of
    /// `machine`.
    /// Errors: if the drive refuses it.
    pub(super) fn begin(
        probe: &AxisProbe,
        machine: &Machine,
        axis: &Axis,
        from: f64,
    ) -> Option<Result<Self, BoardRefusal>> {
        let drive = axis.drive.as_ref()?;
        let device = machine.drives.get(drive.device).filter(|device| device.in_loop)?;
        let name = match device.family() {
            DriveFamily::InterpCnc(_) => BoardAxis::ALL.get(drive.index).copied(),
            DriveFamily::SmartDrive(_) | DriveFamily::Bim2Ax(_) | DriveFamily::Other => None,
        };
        let family = device.family_name();
        if probe.window.is_some() && name.is_some() {
            return Some(Err(BoardRefusal::NoWindow));
        }
        Some(
            name.ok_or(BoardRefusal::NoCommand { family })
                .and_then(|name| Self::commanded(probe, name, drive.counting, from)),
        )
    }

    fn commanded(
        probe: &AxisProbe,
        axis: BoardAxis,
        counting: Counting,
        from: f64,
    ) -> Result<Self, BoardRefusal> {
        let scale = counting.increments(1.0).abs();
        let stroke =
            whole("stroke", "steps", probe.stroke.abs() * scale, i32::MAX.cast_unsigned())?;
        let speed_hz = whole("velocity", "steps/s", probe.velocity * scale, MAX_SPEED_HZ)?;
        let start = (probe.start_velocity * scale).round();
        let start_stop_hz = narrow("start velocity", "steps/s", start.max(1.0))?;
        let rate =
            |what, rate: f64| narrow(what, "thousand steps/s²", (rate * scale * 1e-3).ceil());
        let command = Command::Probe {
            axes: axis.mask(),
            positive: counting.increments(probe.stroke) > 0.0,
            input: INPUT.into(),
            level: 1,
            max_stroke: stroke.cast_signed(),
            speed_hz,
            start_stop_hz,
            acceleration_khz_per_s: rate("acceleration", probe.acceleration)?,
            deceleration_khz_per_s: rate("deceleration", probe.deceleration)?,
        };
        let mut board = Board::new(&BoardOptions::default());
        let counter = counting.whole(from).and_then(|counter| i32::try_from(counter).ok());
        let counter = counter.ok_or_else(|| BoardRefusal::Beyond {
            increments: counting.increments(from),
            most: i32::MAX,
        })?;
        let mut positions: AxisValues = Default::default();
        if let Some(slot) = positions.get_mut(axis.index()) {
            *slot = Some(counter);
        }
        let unlock = Command::Reset { unlock: true, homing_error: false, probe_error: false };
        for command in [unlock, Command::WritePosition { positions }, command] {
            board.send(&command).map_err(|code| BoardRefusal::Exception { code })?;
        }
        let from = counting.si(counter.into());
        Ok(Self { board, axis, counting, from, change: 0.0, tripped: false })
    }
}

impl Search for BoardSearch {
    fn advance(&mut self, cycle_ns: i64, dt: f64, tripped: bool) {
        if tripped && !std::mem::replace(&mut self.tripped, true) {
            self.board.set_input(INPUT, true);
        }
        let before = self.board.velocity(self.axis);
        self.board.advance(cycle_ns);
        self.change = (self.board.velocity(self.axis) - before) / dt;
    }

    fn motion(&self) -> [f64; 3] {
        let position = self.counting.si(self.board.position(self.axis)) - self.from;
        let velocity = self.counting.si(self.board.velocity(self.axis));
        [position, velocity, self.counting.si(self.change)]
    }

    fn is_under_way(&self) -> bool {
        self.board.status().probing()
    }

    fn latched(&self) -> Option<f64> {
        let found = self.tripped && !self.board.status().probe_failed();
        found.then(|| self.counting.si(self.board.probe_position().into()))
    }
}

/// An argument that is more than nothing, to the nearest whole number.
fn whole(
    what: &'static str,
    unit: &'static str,
    value: f64,
    most: u32,
) -> Result<u32, BoardRefusal> {
    let rounded = value.round();
    if !(1.0..=f64::from(most)).contains(&rounded) {
        return Err(BoardRefusal::Range { what, value, unit, most });
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just compared")]
    let whole = rounded as u32;
    Ok(whole)
}

/// The same for an argument of one register.
fn narrow(what: &'static str, unit: &'static str, value: f64) -> Result<u16, BoardRefusal> {
    let most = u16::MAX.into();
    let whole = whole(what, unit, value, most)?;
    u16::try_from(whole).map_err(|_beyond| BoardRefusal::Range { what, value, unit, most })
}
