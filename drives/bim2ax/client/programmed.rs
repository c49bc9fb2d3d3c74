//! Programmed moves, and positions that are declared without motion: what goes with the zone "Ordre bloc".

use super::{
    AXES, Action, Bim2Ax, BusStamp, Clock, DriveError, ModuleAxis, Orders, Target, WriteZone,
};
use crate::{
    MOST_POSITION,
    protocol::bits::{bloc, message, uc},
};

/// Destination of a programmed move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// To a position, µsteps.
    To(i32),
    /// By a way from where it is, µsteps.
    By(i32),
    /// To reference position 1 to 10.
    Reference(u8),
}

/// A programmed move of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Destination.
    pub to: Move,
    /// Speed in the unit of the drive mode, capped by the fast speed; none for the fast speed.
    pub speed: Option<u16>,
    /// Without the unidirectional approach, if the axis has one.
    pub directly: bool,
}

impl Start {
    /// An absolute move at the fast speed.
    pub fn to(position: i32) -> Self {
        Self { to: Move::To(position), speed: None, directly: false }
    }

    /// Order bloc and content of the Position zone.
    fn encoded(&self) -> (u32, Target) {
        let (bits, position) = match self.to {
            Move::To(position) => (0, position),
            Move::By(way) => (bloc::RELATIVE, way),
            Move::Reference(number) => (u32::from(number) & bloc::REFERENCE, 0),
        };
        let speed = self.speed.map_or(0, |_| bloc::PROGRAMMED_SPEED);
        let directly = if self.directly { bloc::WITHOUT_APPROACH } else { 0 };
        (bits | speed | directly, Target { position, speed: self.speed.unwrap_or(0) })
    }
}

impl Bim2Ax {
    /// Starts programmed moves of one or both axes with one order.
    ///
    /// # Errors
    /// If a target, or where a way ends, is beyond ±4194303 or there is no such reference position; if an axis does not start, with its
    /// messages; if the module does not answer, when it is unknown whether it has got the order.
    pub async fn start(
        &mut self,
        moves: [Option<Start>; AXES],
        clock: &dyn Clock,
    ) -> Result<BusStamp, DriveError> {
        const NAME: &str = "programmed move";
        let (before, _) = match moves {
            // The start of a relative move shows whether it has ended.
            [Some(Start { to: Move::By(_), .. }), _] | [_, Some(Start { to: Move::By(_), .. })] => {
                self.positions(clock).await?
            }
            _ => <(super::Positions, BusStamp)>::default(),
        };
        let mut orders = Orders::default();
        let mut targets = [None; AXES];
        let mut ends = [None; AXES];
        let mut axes = Vec::with_capacity(AXES);
        for (axis, start) in ModuleAxis::ALL.into_iter().zip(moves) {
            let Some(start) = start else { continue };
            self.check_range(axis, &start)?;
            let (word, target) = start.encoded();
            let index = axis.index();
            if let Move::By(way) = start.to {
                // No counter goes beyond what its target could be.
                let from = before.positions.get(index).copied().unwrap_or(0);
                self.check_range(axis, &Start::to(from.saturating_add(way)))?;
            }
            let places = (orders.uc.get_mut(index), orders.bloc.get_mut(index));
            if let (Some(order), Some(bits)) = places {
                (*order, *bits) = (uc::PROGRAMMED, word);
            }
            if let (Some(place), Some(end)) = (targets.get_mut(index), ends.get_mut(index)) {
                let from = before.positions.get(index).copied().unwrap_or(0);
                (*place, *end) = match start.to {
                    Move::To(position) => (Some(target), Some(position)),
                    Move::By(way) => (Some(target), Some(from.saturating_add(way))),
                    Move::Reference(_) => (start.speed.map(|_| target), None),
                };
            }
            axes.push(axis);
        }
        let (acknowledged, stamp) = self.order(NAME, orders, targets, clock).await?;
        let done = |axis: ModuleAxis, position, _| {
            let index = axis.index();
            let reference = |order: &Orders| {
                order.bloc.get(index).map(|word| word & (bloc::REFERENCE | bloc::BAD_REFERENCE))
            };
            match ends.get(index).copied().flatten() {
                Some(end) => position == end,
                None => reference(&acknowledged) == reference(&orders),
            }
        };
        self.check_started(NAME, uc::PROGRAMMED, &axes, &acknowledged, done, clock).await?;
        Ok(stamp)
    }

    fn check_range(&self, axis: ModuleAxis, start: &Start) -> Result<(), DriveError> {
        let zone = WriteZone::of_axis(axis);
        let (value, low, high) = match start.to {
            Move::To(value) | Move::By(value) => (value, -MOST_POSITION, MOST_POSITION),
            Move::Reference(number) => (number.into(), 1, 10),
        };
        if (low..=high).contains(&value) {
            return Ok(());
        }
        let action = Action::WriteZone { zone: zone.number(), name: zone.name() };
        Err(DriveError::Range {
            at: self.at(action),
            register: zone.offset().into(),
            value: value.into(),
            unit: if matches!(start.to, Move::Reference(_)) { "" } else { "µsteps" },
            low: low.into(),
            high: high.into(),
        })
    }

    /// Declares the present position of an axis at standstill to be 0.
    ///
    /// # Errors
    /// If the module does not acknowledge it, or does not answer.
    pub async fn zero(&mut self, axis: ModuleAxis, clock: &dyn Clock) -> Result<(), DriveError> {
        self.declare("zero", axis, bloc::ZERO, None, clock).await
    }

    /// Declares the present position of an axis at standstill to be the last one that the module has stored.
    ///
    /// # Errors
    /// As [`Self::zero`].
    pub async fn recall(&mut self, axis: ModuleAxis, clock: &dyn Clock) -> Result<(), DriveError> {
        self.declare("recall of the last position", axis, bloc::FORCE, None, clock).await
    }

    /// Declares the present position of an axis at standstill to be `position`, µsteps.
    ///
    /// # Errors
    /// If it is $C0DE, which the module forbids, or beyond ±4194303; else as [`Self::zero`].
    pub async fn preset(
        &mut self,
        axis: ModuleAxis,
        position: i32,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        self.check_range(axis, &Start::to(position))?;
        if position == bloc::FORBIDDEN_PRESET {
            let zone = WriteZone::of_axis(axis);
            let (value, low) = (position.into(), (-MOST_POSITION).into());
            let at = self.at(Action::WriteZone { zone: zone.number(), name: zone.name() });
            let (register, high) = (zone.offset().into(), MOST_POSITION.into());
            return Err(DriveError::Range { at, register, value, unit: "µsteps", low, high });
        }
        let target = Some(Target { position, speed: 0 });
        self.declare("preset", axis, bloc::FORCE | bloc::PRESET, target, clock).await
    }

    async fn declare(
        &mut self,
        name: &'static str,
        axis: ModuleAxis,
        bits: u32,
        target: Option<Target>,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let of = |value| ModuleAxis::ALL.map(|any| if any == axis { value } else { 0 });
        let uc = ModuleAxis::ALL.map(|any| if any == axis { uc::PROGRAMMED } else { 0 });
        let targets = ModuleAxis::ALL.map(|any| target.filter(|_| any == axis));
        let orders = Orders { uc, bloc: of(bits) };
        let (acknowledged, _) = self.order(name, orders, targets, clock).await?;
        let wanted = bits & (bloc::ZERO | bloc::FORCE);
        let word = acknowledged.bloc.get(axis.index()).copied().unwrap_or(0);
        let done = |_, _, messages: u16| word == wanted && messages & message::MOVING == 0;
        self.check_started(name, uc::PROGRAMMED, &[axis], &Orders::default(), done, clock).await
    }
}
