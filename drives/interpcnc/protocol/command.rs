//! The board's commands as register lists ("Commande 66 …" to "Commande 41 …" of the manual).
//!
//! A command is a write to the registers from 4096 on, the command number first, arguments after it. In commands
//! 6, 67 and 71 only the axes of the mask have values, without gaps, in the order X, Y, Z, A, B.

use super::registers::{AXES, AxisMask, BoardAxis, COMMAND_REGISTERS, join, words};
use twin_drives::Action;

/// A value for some of the axes.
pub type AxisValues = [Option<i32>; AXES];

/// The command registers 4096 to 4145.
pub type CommandRegisters = [u16; COMMAND_REGISTERS as usize];

/// A move's profile and target, as command 80 carries them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveProfile {
    /// Frequency at which the axis starts and stops without ramp, steps/s.
    pub start_stop_hz: u16,
    /// Acceleration, 1000 steps/s².
    pub acceleration_khz_per_s: u16,
    /// Speed, steps/s.
    pub speed_hz: u32,
    /// Deceleration, 1000 steps/s².
    pub deceleration_khz_per_s: u16,
    /// Target, absolute, steps.
    pub target: i32,
}

/// One command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// 6, `ICNC_CMD_PROFILE_ABS_BUF`: interpolated move, buffered.
    Interpolated {
        /// Speed of the axis with the longest way, steps/s.
        speed_hz: u32,
        /// Targets, steps.
        targets: AxisValues,
    },
    /// 40, `ICNC_CMD_PROBE`: move until an input changes.
    Probe {
        /// Axis mask; one axis.
        axes: AxisMask,
        /// Towards larger positions (1) or smaller (−1).
        positive: bool,
        /// Input, 1 to 32.
        input: u16,
        /// Level of the input that ends the move (NC 0, NO 1).
        level: u16,
        /// Longest way, steps.
        max_stroke: i32,
        /// Speed, steps/s.
        speed_hz: u32,
        /// Start and stop frequency, steps/s.
        start_stop_hz: u16,
        /// Acceleration, 1000 steps/s².
        acceleration_khz_per_s: u16,
        /// Deceleration, 1000 steps/s².
        deceleration_khz_per_s: u16,
    },
    /// 41, `ICNC_CMD_BREAKE_AXES`: ramp stop of independent moves.
    RampStopAxes {
        /// Axes to stop.
        axes: AxisMask,
    },
    /// 42, `ICNC_CMD_BREAKE_AXES_AND_CLEAR`: ramp stop of everything.
    RampStop,
    /// 43, `ICNC_CMD_STOP`: stop without ramp and lock the board.
    Stop,
    /// 66: unlock and reset of error bits.
    Reset {
        /// b0: clear "Board Locked".
        unlock: bool,
        /// b1: clear "Homing Error".
        homing_error: bool,
        /// b2: clear "Probe Error".
        probe_error: bool,
    },
    /// 67, `ICNC_CMD_WRITE_POSITION`: set position counters.
    WritePosition {
        /// Counters, steps.
        positions: AxisValues,
    },
    /// 71, `ICNC_CMD_MACHINE_HOME`: homing by the board's parameters.
    HomeMachine {
        /// Longest way of each axis to home, steps.
        max_strokes: AxisValues,
    },
    /// 78, `ICNC_CMD_HOME_AXE`: homing of one axis.
    HomeAxis {
        /// The axis.
        axis: BoardAxis,
        /// Input of the switch.
        input: u16,
        /// Contact: NC 0, NO 1.
        contact: u16,
        /// Acceleration, 1000 steps/s².
        acceleration_khz_per_s: u16,
        /// Speed towards the switch, steps/s.
        fast_hz: u32,
        /// Deceleration, 1000 steps/s².
        deceleration_khz_per_s: u16,
        /// Longest way, steps; its sign is the direction.
        max_stroke: i32,
        /// Speed off the switch, steps/s.
        slow_hz: u16,
        /// Counter at the end, steps.
        final_position: i32,
    },
    /// 80, `ICNC_CMD_MOVE_PROFILE_ABS_ASYNC`: independent move of one axis; retargets one that moves.
    Move {
        /// The axis.
        axis: BoardAxis,
        /// Profile and target.
        profile: MoveProfile,
    },
    /// 96, `ICNC_CMD_CHANGE_SPEED`: new speed for independent moves under way.
    ChangeSpeed {
        /// The axes.
        axes: AxisMask,
        /// New speed, steps/s.
        speed_hz: u32,
    },
}

/// Fault of command registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadCommand {
    /// The number is none of the manual's.
    Unknown(u16),
    /// The axis mask (or number) is not one that the command takes.
    Axes(u16),
}

impl Command {
    /// The number in register 4096.
    pub fn number(&self) -> u16 {
        self.number_and_name().0
    }

    /// The command for messages.
    pub fn action(&self) -> Action {
        let (number, name) = self.number_and_name();
        Action::Command { number, name }
    }

    fn number_and_name(&self) -> (u16, &'static str) {
        match self {
            Self::Interpolated { .. } => (6, "interpolated move"),
            Self::Probe { .. } => (40, "probe"),
            Self::RampStopAxes { .. } => (41, "ramp stop of axes"),
            Self::RampStop => (42, "ramp stop"),
            Self::Stop => (43, "stop and lock"),
            Self::Reset { .. } => (66, "reset"),
            Self::WritePosition { .. } => (67, "write position"),
            Self::HomeMachine { .. } => (71, "home axes"),
            Self::HomeAxis { .. } => (78, "home one axis"),
            Self::Move { .. } => (80, "independent move"),
            Self::ChangeSpeed { .. } => (96, "change speed"),
        }
    }

    /// The axes that it begins to move.
    pub fn moved_axes(&self) -> AxisMask {
        match self {
            Self::Interpolated { targets: values, .. }
            | Self::HomeMachine { max_strokes: values } => mask_of(values),
            Self::Probe { axes, .. } => *axes,
            Self::HomeAxis { axis, .. } | Self::Move { axis, .. } => axis.mask(),
            Self::RampStopAxes { .. }
            | Self::RampStop
            | Self::Stop
            | Self::Reset { .. }
            | Self::WritePosition { .. }
            | Self::ChangeSpeed { .. } => AxisMask::NONE,
        }
    }

    /// True if the board, given the command twice in a row, ends up as if given it once. Only these are sent again after a lost
    /// answer.
    ///
    /// Stops, resets and independent moves (80), whose targets are absolute, are. The others are not: 6 would queue a second
    /// segment, 40, 71 and 78 start over, and 67 arriving late rewrites a counter that has moved on.
    pub fn is_idempotent(&self) -> bool {
        matches!(
            self,
            Self::RampStopAxes { .. }
                | Self::RampStop
                | Self::Stop
                | Self::Reset { .. }
                | Self::Move { .. }
        )
    }

    /// The registers from 4096 on.
    pub fn registers(&self) -> Vec<u16> {
        let mut out = vec![self.number()];
        match *self {
            Self::RampStop | Self::Stop => {}
            Self::RampStopAxes { axes } => out.push(axes.bits().into()),
            Self::Reset { unlock, homing_error, probe_error } => {
                out.push(
                    u16::from(unlock) | u16::from(homing_error) << 1 | u16::from(probe_error) << 2,
                );
            }
            Self::WritePosition { positions: values }
            | Self::HomeMachine { max_strokes: values } => {
                out.push(mask_of(&values).bits().into());
                push_values(&mut out, &values);
            }
            Self::Interpolated { speed_hz, targets } => {
                out.push(mask_of(&targets).bits().into());
                out.extend(words(speed_hz));
                push_values(&mut out, &targets);
            }
            Self::ChangeSpeed { axes, speed_hz } => {
                out.push(axes.bits().into());
                out.extend(words(speed_hz));
            }
            Self::Move { axis, profile } => {
                out.extend([
                    axis.mask().bits().into(),
                    profile.start_stop_hz,
                    profile.acceleration_khz_per_s,
                ]);
                out.extend(words(profile.speed_hz));
                out.push(profile.deceleration_khz_per_s);
                out.extend(words(profile.target.cast_unsigned()));
            }
            Self::HomeAxis {
                axis,
                input,
                contact,
                acceleration_khz_per_s,
                fast_hz,
                deceleration_khz_per_s,
                max_stroke,
                slow_hz,
                final_position,
            } => {
                out.extend([axis.number().into(), input, contact, acceleration_khz_per_s]);
                out.extend(words(fast_hz));
                out.push(deceleration_khz_per_s);
                out.extend(words(max_stroke.cast_unsigned()));
                out.push(slow_hz);
                out.extend(words(final_position.cast_unsigned()));
            }
            Self::Probe {
                axes,
                positive,
                input,
                level,
                max_stroke,
                speed_hz,
                start_stop_hz,
                acceleration_khz_per_s,
                deceleration_khz_per_s,
            } => {
                out.extend([axes.bits().into(), if positive { 1 } else { 0xFFFF }, input, level]);
                out.extend(words(max_stroke.cast_unsigned()));
                out.extend(words(speed_hz));
                out.extend([start_stop_hz, acceleration_khz_per_s, deceleration_khz_per_s]);
            }
        }
        out
    }

    /// The command that the registers hold.
    ///
    /// # Errors
    /// If the number is unknown, or the axes are not such as the command takes.
    pub fn decode(registers: &CommandRegisters) -> Result<Self, BadCommand> {
        let [number, axes, rest @ ..] = *registers;
        let mask = || AxisMask::from_register(axes).ok_or(BadCommand::Axes(axes));
        let single = || {
            let mask = mask()?;
            BoardAxis::ALL
                .into_iter()
                .find(|axis| axis.mask() == mask)
                .ok_or(BadCommand::Axes(axes))
        };
        Ok(match number {
            6 => {
                let [high, low, values @ ..] = rest;
                Self::Interpolated {
                    speed_hz: join(high, low),
                    targets: take_values(mask()?, &values),
                }
            }
            40 => {
                let [
                    sense,
                    input,
                    level,
                    stroke,
                    stroke_low,
                    speed,
                    speed_low,
                    start,
                    up,
                    down,
                    ..,
                ] = rest;
                Self::Probe {
                    axes: single()?.mask(),
                    positive: sense == 1,
                    input,
                    level,
                    max_stroke: join(stroke, stroke_low).cast_signed(),
                    speed_hz: join(speed, speed_low),
                    start_stop_hz: start,
                    acceleration_khz_per_s: up,
                    deceleration_khz_per_s: down,
                }
            }
            41 => Self::RampStopAxes { axes: mask()? },
            42 => Self::RampStop,
            43 => Self::Stop,
            66 => Self::Reset {
                unlock: axes & 1 != 0,
                homing_error: axes & 2 != 0,
                probe_error: axes & 4 != 0,
            },
            67 => Self::WritePosition { positions: take_values(mask()?, &rest) },
            71 => Self::HomeMachine { max_strokes: take_values(mask()?, &rest) },
            78 => {
                let axis = BoardAxis::ALL.into_iter().find(|axis| u16::from(axis.number()) == axes);
                let [
                    input,
                    contact,
                    up,
                    fast,
                    fast_low,
                    down,
                    stroke,
                    stroke_low,
                    slow,
                    last,
                    last_low,
                    ..,
                ] = rest;
                Self::HomeAxis {
                    axis: axis.ok_or(BadCommand::Axes(axes))?,
                    input,
                    contact,
                    acceleration_khz_per_s: up,
                    fast_hz: join(fast, fast_low),
                    deceleration_khz_per_s: down,
                    max_stroke: join(stroke, stroke_low).cast_signed(),
                    slow_hz: slow,
                    final_position: join(last, last_low).cast_signed(),
                }
            }
            80 => {
                let [start, up, speed, speed_low, down, target, target_low, ..] = rest;
                let profile = MoveProfile {
                    start_stop_hz: start,
                    acceleration_khz_per_s: up,
                    speed_hz: join(speed, speed_low),
                    deceleration_khz_per_s: down,
                    target: join(target, target_low).cast_signed(),
                };
                Self::Move { axis: single()?, profile }
            }
            96 => {
                let [high, low, ..] = rest;
                Self::ChangeSpeed { axes: mask()?, speed_hz: join(high, low) }
            }
            _ => return Err(BadCommand::Unknown(number)),
        })
    }
}

fn mask_of(values: &AxisValues) -> AxisMask {
    BoardAxis::ALL
        .into_iter()
        .zip(values)
        .filter(|(_, value)| value.is_some())
        .fold(AxisMask::NONE, |mask, (axis, _)| mask.union(axis.mask()))
}

fn push_values(out: &mut Vec<u16>, values: &AxisValues) {
    out.extend(values.iter().flatten().flat_map(|value| words(value.cast_unsigned())));
}

/// The values of the axes in the mask, which lie without gaps.
fn take_values(mask: AxisMask, registers: &[u16]) -> AxisValues {
    let mut pairs = registers.chunks_exact(2);
    BoardAxis::ALL.map(|axis| {
        let pair = if mask.contains(axis) { pairs.next() } else { None };
        match pair {
            Some(&[high, low]) => Some(join(high, low).cast_signed()),
            _ => None,
        }
    })
}
