//! Settings of the driver and what follows from them for the wire.

use std::{sync::Arc, time::Duration};

use crate::protocol::line::Line;

use crate::{
    Assumptions,
    protocol::registers::{AxisMask, BoardAxis, MAX_SPEED_HZ, STATE_REGISTERS},
};
use twin_drives::{Action, DriveError, Exchange, exchanges::longest_repeating};

/// Registers of the longest command: number and axes, speed, five targets (command 6). A command goes in one frame, for
/// the board carries out what has come with its number.
pub(crate) const LONGEST_COMMAND: u16 = 14;
/// What Modbus reads and writes at most with one frame, registers.
const MODBUS_READ: u16 = 125;
const MODBUS_WRITTEN: u16 = 123;

/// Profile limits of one axis of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisOptions {
    /// Axis of the board.
    pub axis: BoardAxis,
    /// Speed at which the motor starts and stops without ramp, steps/s.
    pub start_stop_hz: u16,
    /// Largest acceleration, 1000 steps/s².
    pub acceleration_khz_per_s: u16,
    /// Largest deceleration, 1000 steps/s².
    pub deceleration_khz_per_s: u16,
    /// Largest speed, steps/s.
    pub max_speed_hz: u32,
}

impl AxisOptions {
    /// Board axis `axis` with the profile of the digest's example (vector 11) and the board's largest speed.
    pub fn new(axis: BoardAxis) -> Self {
        Self {
            axis,
            start_stop_hz: 200,
            acceleration_khz_per_s: 50,
            deceleration_khz_per_s: 40,
            max_speed_hz: MAX_SPEED_HZ,
        }
    }
}

/// The encoder of a board, from V2.1D on, on the shaft of one of its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderOptions {
    /// The axis, which is in use.
    pub axis: BoardAxis,
    /// Points that it counts, less than 0 if it counts down where the axis counts up …
    pub points: i32,
    /// … for this number of steps of the axis.
    pub increments: u32,
    /// So far the axis may be from where its counter says by the encoder, steps; a step, a point and what the axis may have
    /// moved between two readings come on top.
    pub tolerance: u32,
}

/// Method of following a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Following {
    /// Independent moves that are retargeted in flight, axis by axis (command 80): near to any plan.
    #[default]
    Retargeted,
    /// Interpolated segments from the board's buffer (command 6): the axes stay on straight lines, and stop between
    /// them.
    Buffered {
        /// Start and stop frequency of the segments, steps/s: what the board's parameter 5 says.
        start_stop_hz: u16,
        /// Their acceleration and deceleration, 1000 steps/s²: what the board's parameter 4 says.
        acceleration_khz_per_s: u16,
    },
}

/// Settings of the driver.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterpCncOptions {
    /// Station address, 1 to 247; board parameter 103.
    pub address: u8,
    /// Speed and parity; board parameters 101 and 102.
    pub line: Line,
    /// Added to the time that the bytes of an exchange and the turnaround of the board take: the longest delay of computer and
    /// adapter.
    pub deadline: Duration,
    /// Longest turnaround of board and adapter until it is measured.
    pub turnaround: Duration,
    /// Time after which a request that is late arrives no more: a stop is sent again after it.
    pub worst_latency: Duration,
    /// Axes in use, in the order of the arrays of [`twin_drives::Drive`].
    pub axes: Vec<AxisOptions>,
    /// The encoder, with which the counter of its axis is compared.
    pub encoder: Option<EncoderOptions>,
    /// Method of following a plan.
    pub following: Following,
    /// Whether the adapter hears what it sends (two-wire RS485 without receiver control): the echo is taken away.
    pub echo: bool,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
}

impl InterpCncOptions {
    /// Station 1, 115200 baud, no parity, 20 ms added, 230 ms until the turnaround is measured, the given axes, no echo.
    pub fn new(axes: Vec<AxisOptions>) -> Self {
        Self {
            address: 1,
            line: Line::default(),
            deadline: Duration::from_millis(20),
            turnaround: Duration::from_millis(230),
            worst_latency: Duration::from_millis(500),
            axes,
            encoder: None,
            following: Following::Retargeted,
            echo: false,
            assumptions: Assumptions::default(),
        }
    }

    /// Silence that ends a frame.
    pub(crate) fn silence(&self) -> Duration {
        self.assumptions.silence_on(self.line)
    }

    /// Time in which a few exchanges have an answer, one of them asked again and again.
    pub(crate) fn patience(&self) -> Duration {
        let attempt = self.deadline + self.turnaround;
        longest_repeating(attempt) + 2 * (attempt + self.worst_latency)
    }

    /// The board axes in use.
    pub(crate) fn mask(&self) -> AxisMask {
        self.axes.iter().fold(AxisMask::NONE, |mask, axis| mask.union(axis.axis.mask()))
    }

    /// Checks what no board could do.
    pub(crate) fn check(&self, port: &Arc<str>) -> Result<(), DriveError> {
        let at =
            || Exchange { port: Arc::clone(port), address: self.address, action: Action::Open };
        let within = |setting, value: u32, low, high| {
            let fits = (low..=high).contains(&value);
            if fits {
                Ok(())
            } else {
                Err(DriveError::Setting { at: at(), setting, value, low, high })
            }
        };
        within("address", self.address.into(), 1, 247)?;
        within("baud", self.line.baud, 4800, 256_000)?;
        // Status and positions are of one instant only in one frame.
        let Assumptions { most_read, most_written, .. } = self.assumptions;
        within(
            "registers that a frame reads",
            most_read.into(),
            STATE_REGISTERS.into(),
            MODBUS_READ.into(),
        )?;
        within(
            "registers that a frame writes",
            most_written.into(),
            LONGEST_COMMAND.into(),
            MODBUS_WRITTEN.into(),
        )?;
        let count = u32::try_from(self.axes.len()).unwrap_or(u32::MAX);
        within("number of axes", count, 1, self.mask().bits().count_ones().max(1))?;
        for axis in &self.axes {
            within("acceleration (kHz/s)", axis.acceleration_khz_per_s.into(), 1, u16::MAX.into())?;
            within("deceleration (kHz/s)", axis.deceleration_khz_per_s.into(), 1, u16::MAX.into())?;
            within("largest speed (Hz)", axis.max_speed_hz, 1, MAX_SPEED_HZ)?;
        }
        if let Some(encoder) = self.encoder {
            let used = u32::from(self.mask().contains(encoder.axis));
            within("axes in use with the encoder", used, 1, 1)?;
            within(
                "points of the encoder",
                encoder.points.unsigned_abs(),
                1,
                i32::MAX.unsigned_abs(),
            )?;
            within("steps for its points", encoder.increments, 1, u32::MAX)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, protocol::registers::AXES};

    #[test]
    fn impossible_settings_are_named() {
        let port: Arc<str> = "p".into();
        let good = InterpCncOptions::new(vec![
            AxisOptions::new(BoardAxis::X),
            AxisOptions::new(BoardAxis::Z),
        ]);
        assert!(good.check(&port).is_ok());
        let refused = |options: InterpCncOptions| match options.check(&port) {
            Err(DriveError::Setting { setting, .. }) => setting,
            other => panic!("{other:?}"),
        };
        assert_eq!(refused(InterpCncOptions { address: 0, ..good.clone() }), "address");
        assert_eq!(refused(InterpCncOptions { axes: vec![], ..good.clone() }), "number of axes");
        let twice = vec![AxisOptions::new(BoardAxis::X); 2];
        assert_eq!(refused(InterpCncOptions { axes: twice, ..good.clone() }), "number of axes");
        let line = Line { baud: 300, ..good.line };
        assert_eq!(refused(InterpCncOptions { line, ..good.clone() }), "baud");
        let encoder =
            EncoderOptions { axis: BoardAxis::X, points: -4, increments: 3, tolerance: 0 };
        let with = |encoder| InterpCncOptions { encoder: Some(encoder), ..good.clone() };
        assert!(with(encoder).check(&port).is_ok());
        let elsewhere = EncoderOptions { axis: BoardAxis::Y, ..encoder };
        assert_eq!(refused(with(elsewhere)), "axes in use with the encoder");
        let none = EncoderOptions { points: 0, ..encoder };
        assert_eq!(refused(with(none)), "points of the encoder");
        let none = EncoderOptions { increments: 0, ..encoder };
        assert_eq!(refused(with(none)), "steps for its points");
        // 12 registers of status and positions; 14 of a segment of five axes.
        for (most_read, most_written, named) in
            [(11, 123, Some("reads")), (125, 13, Some("writes")), (12, 14, None)]
        {
            let assumptions = Assumptions { most_read, most_written, ..good.assumptions };
            let checked = InterpCncOptions { assumptions, ..good.clone() }.check(&port);
            let error = checked.err().map(|error| error.to_string());
            let named_so =
                named.is_none_or(|named| error.as_ref().is_some_and(|e| e.contains(named)));
            assert!(named_so && error.is_some() == named.is_some(), "{error:?}");
        }
    }

    #[test]
    fn the_longest_command_is_a_segment_of_all_axes() {
        let length = |command: Command| command.registers().len();
        let segment = Command::Interpolated { speed_hz: 1, targets: [Some(0); AXES] };
        assert_eq!(length(segment), usize::from(LONGEST_COMMAND));
        let home = Command::HomeAxis {
            axis: BoardAxis::X,
            input: 1,
            contact: 0,
            acceleration_khz_per_s: 1,
            fast_hz: 1,
            deceleration_khz_per_s: 1,
            max_stroke: 1,
            slow_hz: 1,
            final_position: 0,
        };
        let probe = Command::Probe {
            axes: BoardAxis::X.mask(),
            positive: true,
            input: 1,
            level: 0,
            max_stroke: 1,
            speed_hz: 1,
            start_stop_hz: 1,
            acceleration_khz_per_s: 1,
            deceleration_khz_per_s: 1,
        };
        for other in [home, probe] {
            assert!(length(other) < usize::from(LONGEST_COMMAND));
        }
    }
}
