//! Axes in use and what the module shows of them.

use super::{
    AXES, Action, AxisSettings, Bim2AxDrive, BusStamp, DriveError, MAX_DRIVE_AXES, ModuleAxis,
    Positions, Sample, Start, message,
};
use crate::{MOST_POSITION, protocol::zone::WriteZone};
use twin_drives::Axes;

impl Bim2AxDrive {
    /// Positions of the axes in use, in their order.
    pub(super) fn in_order(&self, seen: &Positions) -> [i32; AXES] {
        let mut positions = [0; AXES];
        for (position, axis) in positions.iter_mut().zip(&self.options.axes) {
            *position = seen.positions.get(axis.index()).copied().unwrap_or(0);
        }
        positions
    }

    /// Axes in use that move, bit by bit in their order.
    pub(super) fn moving(&self, seen: &Positions) -> u8 {
        let moves = |axis: &ModuleAxis| {
            seen.messages.get(axis.index()).is_some_and(|word| word & message::MOVING != 0)
        };
        let axes = (0_u8..).zip(&self.options.axes);
        axes.filter(|(_, axis)| moves(axis)).fold(0, |mask, (place, _)| mask | 1 << place)
    }

    /// Axes in use, bit by bit in their order, by the module's numbers.
    pub(super) fn names(&self, mask: u8) -> Axes {
        let axes = self.options.axes.iter().enumerate();
        let chosen = axes.filter(|(place, _)| mask >> place & 1 == 1);
        Axes::Numbers(chosen.fold(0, |mask, (_, axis)| mask | 1 << axis.index()))
    }

    pub(super) fn to_sample(&self, seen: &Positions, stamp: &BusStamp) -> Sample {
        let mut position = [0; MAX_DRIVE_AXES];
        for (place, found) in position.iter_mut().zip(self.in_order(seen)) {
            *place = found.into();
        }
        Sample { time_ns: stamp.middle_ns(), position, moving: self.moving(seen) != 0 }
    }

    /// Sorts what is for the axes in use by the module's axes.
    pub(super) fn by_axis(&self, starts: &[Option<Start>]) -> [Option<Start>; AXES] {
        let mut sorted = [None; AXES];
        for (axis, start) in self.options.axes.iter().zip(starts) {
            if let Some(place) = sorted.get_mut(axis.index()) {
                *place = *start;
            }
        }
        sorted
    }

    /// A position as a register holds it.
    pub(super) fn register(&self, axis: ModuleAxis, position: i64) -> Result<i32, DriveError> {
        let most = i64::from(MOST_POSITION);
        let fits = (-most..=most).contains(&position);
        i32::try_from(position).ok().filter(|_| fits).ok_or_else(|| {
            #[expect(clippy::cast_precision_loss, reason = "for a message")]
            let (value, low, high) = (position as f64, -most as f64, most as f64);
            let number = axis.number();
            let action = Action::Command { number, name: "position of the axis" };
            let (at, register) = (self.module.at(action), WriteZone::of_axis(axis).offset().into());
            DriveError::Range { at, register, value, unit: "µsteps", low, high }
        })
    }

    /// Fails where a target of a homed axis is beyond its soft limits, at which the module would brake (they act after homing
    /// only).
    pub(super) fn within(
        &self,
        axis: ModuleAxis,
        settings: &AxisSettings,
        (seen, target): (&Positions, i32),
    ) -> Result<(), DriveError> {
        let messages = seen.messages.get(axis.index()).copied().unwrap_or(0);
        let [low, high] = [settings.soft_minus, settings.soft_plus];
        if messages & message::HOMED == 0 || (low..=high).contains(&target) {
            return Ok(());
        }
        let action = Action::Command { number: axis.number(), name: "position of the axis" };
        let (at, what) = (self.module.at(action), "target (within the soft limits)");
        let (value, low, high) = (target.into(), low.into(), high.into());
        Err(DriveError::Value { at, what, value, unit: "µsteps", low, high })
    }
}
