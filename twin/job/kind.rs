//! Function blocks that a job may call, and their inputs.

use super::block::{Called, in_gear_from, moving, on_cam, set_position};
use super::direct::direct;
use super::probe::{abort, probe};
use super::read::{FAR, Known};
use super::values::Values;
use std::path::Path;
use twin_axis::{
    AccelerationProfile, CamIn, ControlAxisBy, Decouple, Direction, Follow, GearIn, GearInPos,
    Halt, Home, MoveAbsolute, MoveAdditive, MoveContinuousAbsolute, MoveContinuousRelative,
    MoveRelative, MoveSuperImposed, MoveVelocity, Phasing, PositionProfile, Stop, SuperImposed,
    VelocityProfile,
};
use twin_machine::section::Section;
use twin_machine::{CamSelection, read_cam, read_ratio};

/// Blocks by the names of the manual.
pub(super) const BLOCKS: [(&str, Kind); 30] = [
    ("MC_MoveAbsolute", Kind::MoveAbsolute),
    ("MC_MoveRelative", Kind::MoveRelative),
    ("MC_MoveAdditive", Kind::MoveAdditive),
    ("MC_MoveSuperImposed", Kind::MoveSuperImposed),
    ("MC_MoveVelocity", Kind::MoveVelocity),
    ("MC_Halt", Kind::Halt),
    ("MC_Stop", Kind::Stop),
    ("MC_CamIn", Kind::CamIn),
    ("MC_CamOut", Kind::Decouple),
    ("MC_GearIn", Kind::GearIn),
    ("MC_GearOut", Kind::Decouple),
    ("SMC_GearInPos", Kind::GearInPos),
    ("MC_GearInPos", Kind::GearInPos),
    ("MC_Phasing", Kind::Phasing),
    ("SMC_MoveContinuousAbsolute", Kind::ContinuousAbsolute),
    ("SMC_MoveContinuousRelative", Kind::ContinuousRelative),
    ("MC_PositionProfile", Kind::PositionProfile),
    ("MC_VelocityProfile", Kind::VelocityProfile),
    ("MC_AccelerationProfile", Kind::AccelerationProfile),
    ("MC_Home", Kind::Home),
    ("MC_SetPosition", Kind::SetPosition),
    ("MC_TouchProbe", Kind::TouchProbe),
    ("MC_AbortTrigger", Kind::AbortTrigger),
    ("SMC_FollowPosition", Kind::Follow(Asks::Position)),
    ("SMC_FollowVelocity", Kind::Follow(Asks::Velocity)),
    ("SMC_FollowPositionVelocity", Kind::Follow(Asks::Both)),
    ("SMC_ControlAxisByPos", Kind::ControlAxisBy(Asks::Position)),
    ("SMC_ControlAxisByVel", Kind::ControlAxisBy(Asks::Velocity)),
    ("SMC_ControlAxisByPosVel", Kind::ControlAxisBy(Asks::Both)),
    (INTERPOLATOR, Kind::Interpolator),
];

/// The block that moves axes along a program.
pub(super) const INTERPOLATOR: &str = "SMC_Interpolator";

/// Quantities that set-points give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asks {
    Position,
    Velocity,
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    MoveAbsolute,
    MoveRelative,
    MoveAdditive,
    MoveSuperImposed,
    MoveVelocity,
    Halt,
    Stop,
    CamIn,
    Decouple,
    GearIn,
    GearInPos,
    Phasing,
    ContinuousAbsolute,
    ContinuousRelative,
    PositionProfile,
    VelocityProfile,
    AccelerationProfile,
    Home,
    SetPosition,
    TouchProbe,
    AbortTrigger,
    Follow(Asks),
    ControlAxisBy(Asks),
    /// Its calls come from [`Reader::calls`](super::read::Reader::calls): one for every axis that the program moves.
    Interpolator,
}

impl Kind {
    /// True if its axis follows another one.
    pub(super) fn follows(self) -> bool {
        matches!(self, Self::CamIn | Self::GearIn | Self::GearInPos | Self::Phasing)
    }

    /// Reports errors of a block with an unknown axis, whose units are unknown too.
    pub(super) fn whatever_axis(self, section: &Section<'_>, master: Option<&Known>, path: &Path) {
        match self {
            Self::CamIn => {
                read_cam(section, path, None, master.map(Known::as_cam));
            }
            Self::GearIn | Self::GearInPos => {
                read_ratio(section);
            }
            _ => {}
        }
    }

    /// The block with the inputs that the file says; cams are named as from `path`.
    pub(super) fn block(self, of: &Values<'_>, path: &Path) -> Option<Box<dyn Called>> {
        Some(match self {
            Self::MoveAbsolute => {
                let (moved, direction) =
                    (of.moved("position", "velocity"), of.direction(Direction::Shortest));
                let (position, [velocity, acceleration, deceleration]) = moved?;
                moving(MoveAbsolute { position, velocity, acceleration, deceleration, direction })
            }
            Self::MoveRelative => {
                let (distance, [velocity, acceleration, deceleration]) =
                    of.moved("distance", "velocity")?;
                moving(MoveRelative { distance, velocity, acceleration, deceleration })
            }
            Self::MoveAdditive => {
                let (distance, [velocity, acceleration, deceleration]) =
                    of.moved("distance", "velocity")?;
                moving(MoveAdditive { distance, velocity, acceleration, deceleration })
            }
            Self::MoveSuperImposed => super_imposed(of)?,
            Self::MoveVelocity => {
                // As in the manual: as the axis has moved last, forwards if it has not yet.
                let (rates, direction) = (of.rates("velocity"), of.direction(Direction::Current));
                let [velocity, acceleration, deceleration] = rates?;
                moving(MoveVelocity { velocity, acceleration, deceleration, direction })
            }
            Self::Halt => moving(Halt { deceleration: of.acceleration("deceleration")? }),
            Self::Stop => moving(Stop { deceleration: of.acceleration("deceleration")? }),
            Self::Decouple => moving(Decouple),
            Self::GearIn => {
                let ratio = read_ratio(of.section);
                let [acceleration, deceleration] = of.accelerations()?;
                let (ratio_numerator, ratio_denominator) = ratio?;
                let ratio_denominator = ratio_denominator.unsigned_abs();
                moving(GearIn { ratio_numerator, ratio_denominator, acceleration, deceleration })
            }
            Self::GearInPos => {
                let (ratio, slave) = (read_ratio(of.section), of.length("slave_sync_position"));
                let master = of.of_master("master_sync_position");
                let master_start_distance = of.distance_of_master("master_start_distance");
                let (ratio_numerator, ratio_denominator) = ratio?;
                in_gear_from(GearInPos {
                    ratio_numerator,
                    ratio_denominator,
                    master_sync_position: master?,
                    slave_sync_position: slave?,
                    master_start_distance,
                })
            }
            Self::Phasing => {
                let (phase_shift, [velocity, acceleration, deceleration]) =
                    of.moved("phase_shift", "velocity")?;
                moving(Phasing { phase_shift, velocity, acceleration, deceleration })
            }
            Self::ContinuousAbsolute => {
                let (position, rates) = (of.length("position"), of.rates("velocity"));
                let (end_velocity, direction) =
                    (of.speed("end_velocity"), of.direction(Direction::Shortest));
                let end_velocity_direction = of.end_direction();
                let (position, [velocity, acceleration, deceleration]) = (position?, rates?);
                moving(MoveContinuousAbsolute {
                    position,
                    velocity,
                    end_velocity: end_velocity?,
                    end_velocity_direction,
                    acceleration,
                    deceleration,
                    direction,
                })
            }
            Self::ContinuousRelative => {
                let (distance, rates) = (of.length("distance"), of.rates("velocity"));
                let end_velocity = of.speed("end_velocity");
                let end_velocity_direction = of.end_direction();
                let (distance, [velocity, acceleration, deceleration]) = (distance?, rates?);
                moving(MoveContinuousRelative {
                    distance,
                    velocity,
                    end_velocity: end_velocity?,
                    end_velocity_direction,
                    acceleration,
                    deceleration,
                })
            }
            Self::PositionProfile => moving(PositionProfile(of.points("position", "")?)),
            Self::VelocityProfile => moving(VelocityProfile(of.points("velocity", "_per_s")?)),
            Self::AccelerationProfile => {
                moving(AccelerationProfile(of.points("acceleration", "_per_s2")?))
            }
            Self::Home => {
                let (position, deceleration) =
                    (of.length("position"), of.optional_acceleration("deceleration"));
                moving(Home { position: position?, deceleration })
            }
            Self::SetPosition => {
                let relative = of.section.flag("relative").unwrap_or(false);
                set_position(of.length("position")?, relative)
            }
            Self::CamIn => cam_in(of, path)?,
            _ => return self.of_program(of),
        })
    }

    /// The same for blocks that need triggers or set-points of the job.
    fn of_program(self, of: &Values<'_>) -> Option<Box<dyn Called>> {
        match self {
            Self::TouchProbe => {
                let (trigger, window) = (of.trigger(), of.window());
                Some(probe(trigger?, window?))
            }
            Self::AbortTrigger => Some(abort(of.trigger()?)),
            Self::Follow(asks) => direct(of.setpoints(asks)?, None),
            Self::ControlAxisBy(asks) => {
                let gap = |name: &str, suffix: &str| {
                    let key = format!("{}{suffix}", of.key(name));
                    of.section.number(&key, 1e-6..=FAR).unwrap_or(0.0)
                };
                let inputs = ControlAxisBy {
                    setpoint: Follow::Velocity(0.0),
                    avoid_gaps: true,
                    gap_velocity: gap("gap_velocity", "_per_s"),
                    gap_acceleration: gap("gap_acceleration", "_per_s2"),
                    gap_deceleration: gap("gap_deceleration", "_per_s2"),
                };
                direct(of.setpoints(asks)?, Some(inputs))
            }
            _ => None,
        }
    }
}

/// `MC_MoveSuperImposed`, which moves its axis on top of another block.
fn super_imposed(of: &Values<'_>) -> Option<Box<dyn Called>> {
    let (distance, [velocity_diff, acceleration, deceleration]) =
        of.moved("distance", "velocity_difference")?;
    let inputs = MoveSuperImposed { distance, velocity_diff, acceleration, deceleration };
    Some(Box::new(SuperImposed::new(inputs)))
}

/// A cam with all inputs of the block.
fn cam_in(of: &Values<'_>, path: &Path) -> Option<Box<dyn Called>> {
    let (slave, master) = (Some(of.known.as_cam()), of.master.map(Known::as_cam));
    let selection = read_cam(of.section, path, slave, master)?;
    let CamSelection { table, mut input, remarks, gain_unsaid } = selection;
    // The default of every block applies if neither the block nor its cam's file gives a value.
    let unsaid = |name: &str, value: f64| {
        value == 0.0 && !of.section.has(&format!("{}_per_s2", of.key(name)))
    };
    let by_axis = unsaid("acceleration", input.acceleration);
    if by_axis {
        input.acceleration = of.known.max_acceleration.unwrap_or(0.0);
    }
    if unsaid("deceleration", input.deceleration) {
        let own = of.known.max_deceleration.filter(|_| by_axis);
        input.deceleration = own.unwrap_or(input.acceleration);
    }
    Some(on_cam(CamIn { table: Some(table), input }, remarks, gain_unsaid))
}
