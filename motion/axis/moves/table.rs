//! Profile tables: motion through points over time (`MC_PositionProfile`, `MC_VelocityProfile`,
//! `MC_AccelerationProfile`).

use crate::direction::SAME;
use crate::ownership::Start;
use crate::{Axis, AxisState, Motion, Progress, SmcError, Stage};
use twin_profile::{MOST_POINTS, ProfilePoint, ProfileTable, TableProfile};

/// Points over time (`MC_TP_REF`, `MC_TV_REF`, `MC_TA_REF`) and how a block reads them.
#[doc(alias = "MC_TP_Array")]
#[doc(alias = "MC_TV_Array")]
#[doc(alias = "MC_TA_Array")]
#[doc(alias = "MC_TP_REF")]
#[doc(alias = "MC_TV_REF")]
#[doc(alias = "MC_TA_REF")]
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// The points; their number is `Number_of_pairs`.
    pub points: Vec<ProfilePoint>,
    /// `IsAbsolute`: values count from 0, not from the value at the start.
    pub absolute: bool,
    /// `ArraySize`: how many of the points count, 1 to 100.
    pub array_size: usize,
    /// `Scale`; the manual's default is 1.
    pub scale: f64,
    /// `Offset`.
    pub offset: f64,
}

impl Points {
    /// All of these points as they are: absolute, not scaled.
    #[must_use]
    pub fn new(points: Vec<ProfilePoint>) -> Self {
        Self { array_size: points.len(), points, absolute: true, scale: 1.0, offset: 0.0 }
    }

    /// The points that count, or the block's error for their number or a step without time.
    fn table(&self, size: SmcError, step: SmcError) -> Result<ProfileTable<'_>, SmcError> {
        let within = (1..=MOST_POINTS).contains(&self.array_size);
        let points = self.points.get(..self.array_size).filter(|_| within).ok_or(size)?;
        // Only the first point may be at the very start.
        if points.iter().skip(1).any(|point| point.delta_time <= 0.0) {
            return Err(step);
        }
        let (absolute, scale, offset) = (self.absolute, self.scale, self.offset);
        Ok(ProfileTable { points, absolute, scale, offset })
    }
}

/// Through positions over time, with continuous velocity and acceleration, to rest (`MC_PositionProfile`, manual 5.3).
#[doc(alias = "MC_PositionProfile")]
#[derive(Clone, Debug, PartialEq)]
pub struct PositionProfile(pub Points);

/// Through velocities over time, by parabolas (`MC_VelocityProfile`, manual 5.3). If it does not end at rest, axis and
/// block go on with the last velocity.
#[doc(alias = "MC_VelocityProfile")]
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityProfile(pub Points);

/// Through accelerations over time, by straight lines (`MC_AccelerationProfile`, manual 5.3); the end as for
/// [`VelocityProfile`].
#[doc(alias = "MC_AccelerationProfile")]
#[derive(Clone, Debug, PartialEq)]
pub struct AccelerationProfile(pub Points);

/// A table on its way.
#[derive(Clone, Debug)]
pub struct TableRun {
    profile: TableProfile,
    /// Time of this cycle's set-point after the beginning, s.
    time: f64,
}

impl TableRun {
    fn new(profile: TableProfile, start: Start, axis: &Axis) -> Self {
        Self { profile, time: start.lead - axis.cycle() }
    }

    fn step(&mut self, axis: &Axis) -> Progress {
        self.time += axis.cycle();
        let ended = self.time >= self.profile.duration() - 1e-9 * axis.cycle();
        let rests = self.profile.end().velocity == 0.0;
        let (setpoint, stage) = match (ended, rests) {
            (true, true) => (self.profile.end(), Stage::Done),
            (true, false) => (self.profile.at(self.time), Stage::Reached),
            (false, _) => (self.profile.at(self.time), Stage::Busy),
        };
        Progress { setpoint, stage }
    }
}

/// Whole turns, u, between the axis and the positions of a table: a first point without time may give the axis's position in
/// another period, and a position a hair before the end of the period counts as its begin.
fn whole_turns(table: &ProfileTable<'_>, start: Start, axis: &Axis) -> f64 {
    let Some(period) = axis.period() else { return 0.0 };
    let position = start.state.position;
    let first = table.points.first().filter(|point| point.delta_time == 0.0);
    let same = match first {
        Some(point) => table.offset + table.scale * point.value,
        None => axis.to_drive(0.0),
    };
    let turns = (position - same) / period;
    let near = (turns - turns.round()).abs() < SAME;
    if first.is_some() || near { turns.round() * period } else { 0.0 }
}

macro_rules! profile {
    ($block:ident in $state:ident, $profile:ident: $size:ident, $step:ident; $($more:item)*) => {
        impl Motion for $block {
            type With = ();
            type Run = TableRun;
            const STATE: AxisState = AxisState::$state;

            fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<TableRun, SmcError> {
                let mut table = self.0.table(SmcError::$size, SmcError::$step)?;
                if Self::STATE == AxisState::DiscreteMotion && table.absolute {
                    table.offset = axis.to_drive(table.offset);
                    table.offset += whole_turns(&table, start, axis);
                }
                let profile = TableProfile::$profile(start.state, table);
                Ok(TableRun::new(profile.map_err(|_invalid| SmcError::$step)?, start, axis))
            }

            $($more)*

            fn duration(run: &TableRun) -> Option<f64> {
                Some(run.profile.duration())
            }

            fn step(
                &self,
                run: &mut TableRun,
                axis: &mut Axis,
                (): (),
            ) -> Result<Progress, SmcError> {
                Ok(run.step(axis))
            }
        }
    };
}

profile! { PositionProfile in DiscreteMotion, positions: PpArraysize, PpStep0ms;
    fn aim(run: &TableRun) -> Option<f64> {
        Some(run.profile.end().position)
    }
}
profile! { VelocityProfile in ContinuousMotion, velocities: VpArraysize, VpStep0ms; }
profile! { AccelerationProfile in ContinuousMotion, accelerations: ApArraysize, ApStep0ms; }
