//! Orders to the axes.

use tokio::time::{sleep, timeout};

use super::{
    AXES, Action, Bim2Ax, BusStamp, Clock, DriveError, Duration, ModuleAxis, Orders,
    RECEIPT_ORDERS, ReadZone, Target, WriteZone, position_zone,
};
use crate::bim2ax::{
    MOST_POSITION,
    bits::{bloc, message, uc},
};

/// Where a programmed move goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// To a position, µsteps.
    To(i32),
    /// By a way from where it stands, µsteps.
    By(i32),
    /// To reference position 1 to 10.
    Reference(u8),
}

/// A programmed move of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Where to.
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

/// Messages that tell why a move does not happen.
const HINDRANCES: u16 =
    message::REFUSED | message::POWER_ABSENT | message::PHASE_OPEN | message::PHASE_SHORT;

impl Bim2Ax {
    /// Writes the zone "Ordre UC", after Position zones if any, and gives the acknowledgements. Manual moves under
    /// way are repeated for axes that get no order.
    async fn order(
        &mut self,
        name: &'static str,
        mut orders: Orders,
        targets: [Option<Target>; AXES],
        clock: &dyn Clock,
    ) -> Result<(Orders, BusStamp), DriveError> {
        for (order, manual) in orders.uc.iter_mut().zip(&mut self.manual) {
            if *order == 0 {
                *order = *manual;
            } else {
                *manual = *order & (uc::MANUAL_PLUS | uc::MANUAL_MINUS);
            }
        }
        let [one, two] = orders.uc;
        let action = Action::Order { bits: one | two, name };
        let byte_order = self.options.byte_order;
        let zones: Vec<_> = ModuleAxis::ALL
            .into_iter()
            .zip(targets)
            .filter_map(|(axis, target)| Some((position_zone(axis), target?.encode(byte_order))))
            .collect();
        if !zones.is_empty() && self.at_once() {
            return self.order_at_once(action, zones, &orders, clock).await;
        }
        for (zone, bytes) in zones {
            let writing = Action::WriteZone { zone: zone.number(), name: zone.name() };
            self.write(writing, zone, &bytes, ReadZone::Positions, clock).await?;
        }
        if self.at_once() {
            let asked = self.window.ask_receipt(RECEIPT_ORDERS);
            self.bus(action, asked)?;
        }
        let bytes = orders.encode(byte_order);
        let read = ReadZone::Acknowledgements;
        let (bytes, stamp) = self.write(action, WriteZone::Orders, &bytes, read, clock).await?;
        self.check_receipt(action)?;
        Ok((self.acknowledged(&bytes), stamp))
    }

    /// Positions and orders with one interrupt; what that refreshes is looked at in the zone of acknowledgements,
    /// which is refreshed with all others.
    async fn order_at_once(
        &mut self,
        action: Action,
        mut zones: Vec<(WriteZone, super::ZoneBytes)>,
        orders: &Orders,
        clock: &dyn Clock,
    ) -> Result<(Orders, BusStamp), DriveError> {
        zones.push((WriteZone::Orders, orders.encode(self.options.byte_order)));
        self.check_running(action)?;
        let written = self
            .window
            .forget_refreshed()
            .and_then(|()| self.window.ask_receipt(RECEIPT_ORDERS))
            .and_then(|()| self.window.write_zones(&zones));
        self.bus(action, written)?;
        // $F0 reads zone 0.
        let (_, stamp) = self.answer(action, ReadZone::Positions, clock).await?;
        self.check_receipt(action)?;
        Ok((self.acknowledgements(clock).await?, stamp))
    }

    /// The module has answered: from version 15 on it has also cleared the receipt flag.
    fn check_receipt(&mut self, action: Action) -> Result<(), DriveError> {
        if !self.at_once() {
            return Ok(());
        }
        let receipts = self.window.receipts();
        if self.bus(action, receipts)? & RECEIPT_ORDERS == 0 {
            return Ok(());
        }
        Err(DriveError::Timeout { at: self.at(action), deadline: self.options.deadline })
    }

    /// The same order for the axes named.
    async fn same(
        &mut self,
        name: &'static str,
        order: u16,
        axes: &[ModuleAxis],
        clock: &dyn Clock,
    ) -> Result<Orders, DriveError> {
        let uc = ModuleAxis::ALL.map(|axis| if axes.contains(&axis) { order } else { 0 });
        let orders = Orders { uc, bloc: [0; AXES] };
        Ok(self.order(name, orders, [None; AXES], clock).await?.0)
    }

    /// Checks that an axis does as it was told, or has done already.
    async fn check_started(
        &mut self,
        name: &'static str,
        order: u16,
        axes: &[ModuleAxis],
        acknowledged: &Orders,
        done: impl Fn(ModuleAxis, i32, u16) -> bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let lacks = |axis: &&ModuleAxis| {
            acknowledged.uc.get(axis.index()).is_none_or(|word| word & order == 0)
        };
        if !axes.iter().any(|axis| lacks(&axis)) {
            return Ok(());
        }
        let (seen, _) = self.positions(clock).await?;
        for axis in axes.iter().filter(lacks) {
            let index = axis.index();
            let messages = seen.messages.get(index).copied().unwrap_or(0);
            let position = seen.positions.get(index).copied().unwrap_or(0);
            if messages & HINDRANCES != 0 || !done(*axis, position, messages) {
                if let Some(manual) = self.manual.get_mut(index) {
                    *manual = 0;
                }
                let at = self.at(Action::Order { bits: order, name });
                let axis = u8::try_from(axis.number()).unwrap_or(0);
                return Err(DriveError::AxisMessages { at, axis, messages });
            }
        }
        Ok(())
    }

    /// Starts programmed moves of one or both axes with one order.
    ///
    /// # Errors
    /// If a target is beyond ±4194303 or there is no such reference position; if an axis does not start, with its
    /// messages; if the module does not answer, when it is unknown whether it has got the order.
    pub async fn start(
        &mut self,
        moves: [Option<Start>; AXES],
        clock: &dyn Clock,
    ) -> Result<BusStamp, DriveError> {
        const NAME: &str = "programmed move";
        let (before, _) = match moves {
            // Where a relative move starts tells whether it has ended.
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
        let zone = position_zone(axis);
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
            low: low.into(),
            high: high.into(),
        })
    }

    /// Starts homing. [`Self::rested`] waits for its end, when message bit 4 tells whether it is done.
    ///
    /// # Errors
    /// If an axis does not start, or the module does not answer.
    pub async fn home(&mut self, axes: &[ModuleAxis], clock: &dyn Clock) -> Result<(), DriveError> {
        let acknowledged = self.same("homing", uc::HOME, axes, clock).await?;
        let done = |_, _, messages: u16| messages & message::HOMED != 0;
        self.check_started("homing", uc::HOME, axes, &acknowledged, done, clock).await
    }

    /// Starts a manual move at the start-stop speed towards + or −; it runs until [`Self::manual_stop`].
    ///
    /// # Errors
    /// If the axis does not start, or the module does not answer.
    pub async fn manual(
        &mut self,
        axis: ModuleAxis,
        plus: bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let order = if plus { uc::MANUAL_PLUS } else { uc::MANUAL_MINUS };
        let acknowledged = self.same("manual move", order, &[axis], clock).await?;
        let never = |_, _, _| false;
        self.check_started("manual move", order, &[axis], &acknowledged, never, clock).await
    }

    /// Ends manual moves.
    ///
    /// # Errors
    /// If the module does not answer: the axes may go on.
    pub async fn manual_stop(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        self.manual = [0; AXES];
        self.same("end of manual moves", 0, &[], clock).await.map(|_| ())
    }

    /// Starts a move to the + or − end switch at the start-stop speed.
    ///
    /// # Errors
    /// If the axis does not start, or the module does not answer.
    pub async fn to_switch(
        &mut self,
        axis: ModuleAxis,
        plus: bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let order = if plus { uc::TO_PLUS_SWITCH } else { uc::TO_MINUS_SWITCH };
        let there = if plus { message::PLUS_SWITCH } else { message::MINUS_SWITCH };
        let acknowledged = self.same("move to the end switch", order, &[axis], clock).await?;
        let done = |_, _, messages: u16| messages & there != 0;
        self.check_started("move to the end switch", order, &[axis], &acknowledged, done, clock)
            .await
    }

    /// Abandons moves: both axes brake on their ramps. Sent again once if no answer comes.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn abandon(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        self.stopping("abandon", uc::ABANDON, clock).await
    }

    /// Stops both axes without ramp; homing is lost where one moved. Sent again once if no answer comes.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn stop_hard(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        self.stopping("hard stop", uc::HARD_STOP, clock).await
    }

    async fn stopping(
        &mut self,
        name: &'static str,
        order: u16,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        self.manual = [0; AXES];
        let first = self.same(name, order, &ModuleAxis::ALL, clock).await;
        if let Err(DriveError::Timeout { .. } | DriveError::Protocol { .. }) = first {
            return self.same(name, order, &ModuleAxis::ALL, clock).await.map(|_| ());
        }
        first.map(|_| ())
    }

    /// Switches phases on or off at standstill (on: revision D).
    ///
    /// # Errors
    /// If they do not follow, or the module does not answer.
    pub async fn set_phases(
        &mut self,
        axes: &[ModuleAxis],
        on: bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let (name, order) =
            if on { ("phases on", uc::PHASES_ON) } else { ("phases off", uc::PHASES_OFF) };
        self.same(name, order, axes, clock).await?;
        let done = |_, _, messages: u16| (messages & message::PHASES_OFF == 0) == on;
        self.check_started(name, order, axes, &Orders::default(), done, clock).await
    }

    /// Tests the motors at standstill, which switches their phases on and clears faults that are gone.
    ///
    /// # Errors
    /// If a phase is open or has a short circuit, or the module does not answer.
    pub async fn test_motors(
        &mut self,
        axes: &[ModuleAxis],
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        const NAME: &str = "motor test";
        let acknowledged = self.same(NAME, uc::MOTOR_TEST, axes, clock).await?;
        let faults = message::PHASE_OPEN | message::PHASE_SHORT;
        let tested = |axis: ModuleAxis, _, messages: u16| {
            let word = acknowledged.uc.get(axis.index()).copied().unwrap_or(0);
            word & uc::MOTOR_TEST != 0 && messages & faults == 0
        };
        let nothing = Orders::default();
        self.check_started(NAME, uc::MOTOR_TEST, axes, &nothing, tested, clock).await
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
            let zone = position_zone(axis);
            let (value, low) = (position.into(), (-MOST_POSITION).into());
            let at = self.at(Action::WriteZone { zone: zone.number(), name: zone.name() });
            let (register, high) = (zone.offset().into(), MOST_POSITION.into());
            return Err(DriveError::Range { at, register, value, low, high });
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

    /// Waits until neither axis moves.
    ///
    /// # Errors
    /// If one still moves after `patience`, or the module does not answer.
    pub async fn rested(
        &mut self,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(super::Positions, BusStamp), DriveError> {
        let mut moving = 0;
        let pause = 4 * self.options.pause;
        let resting = async {
            loop {
                let seen = self.positions(clock).await?;
                moving = (0_u8..)
                    .zip(seen.0.messages)
                    .filter(|(_, messages)| messages & message::MOVING != 0)
                    .fold(0, |mask, (axis, _)| mask | 1 << axis);
                if moving == 0 {
                    return Ok(seen);
                }
                sleep(pause).await;
            }
        };
        let outcome = timeout(patience, resting).await;
        outcome.unwrap_or_else(|_| {
            Err(DriveError::Moving { at: self.at(Action::ReadState), axes: moving })
        })
    }
}
