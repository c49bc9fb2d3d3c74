//! Interrupt handling of the module: takes the zones written by the host and refreshes its answers (9.2).

use super::{Module, RAM_LENGTH, ZONES_AT_ONCE, bus::NO_ZONE};
use crate::{
    AXES, EntryOrder, ModuleAxis,
    emulator::axis::{Axis, AxisOrder},
    protocol::{
        bits::{card, uc},
        memory::{
            ENTRIES, INTERRUPT_STATUS, MODULE_PAGE, RECEIPT_ORDERS, RECEIPT_PARAMETER, RECEIPTS,
            WINDOW_LENGTH, ZONES,
        },
        parameter::AxisParameter,
        zone::{
            Orders, ParameterExchange, Plugs, Positions, ReadZone, Target, WriteZone, ZONE_LENGTH,
            ZoneBytes,
        },
    },
};

impl Module {
    /// The interrupt takes effect; orders are refused or not.
    pub(super) fn serve(&mut self, refused: bool) {
        self.served += 1;
        let assumed = self.options.assumptions;
        if assumed.needs_status && self.heard(INTERRUPT_STATUS) & 1 == 0 {
            return;
        }
        let zones = self.heard(ZONES);
        if zones >> 4 != NO_ZONE {
            self.take(zones >> 4, refused);
        }
        if self.options.version >= ZONES_AT_ONCE {
            let entries = ENTRIES..ENTRIES + 4;
            let mut named: Vec<u8> = entries.clone().map(|entry| self.heard(entry)).collect();
            if assumed.entry_order == EntryOrder::ByNumber {
                named.sort_by_key(|zone| zone & 0xF);
            }
            for zone in named.into_iter().filter(|zone| zone >> 4 != 0) {
                self.take(zone & 0xF, refused);
            }
            if !assumed.keeps_entries {
                entries.for_each(|entry| self.forget_entry(entry));
            }
        }
        if self.running {
            self.refresh(zones & 0xF);
        }
    }

    /// Takes a zone that the host has written.
    fn take(&mut self, number: u8, refused: bool) {
        let Some(zone) = WriteZone::from_number(number) else { return };
        let bytes = self.zone(zone.offset());
        let order = self.options.byte_order;
        let [one, two] = &mut self.targets;
        match zone {
            WriteZone::Orders => {
                self.receive(RECEIPT_ORDERS);
                if refused {
                    self.axes.iter_mut().for_each(Axis::refuse);
                } else if self.active.sound() {
                    self.order(&Orders::decode(&bytes, order));
                }
            }
            WriteZone::Position1 => *one = Target::decode(&bytes, order),
            WriteZone::Position2 => *two = Target::decode(&bytes, order),
            WriteZone::Parameter => {
                self.receive(RECEIPT_PARAMETER);
                if refused {
                    self.errors = card::BAD_ORDER;
                    self.answer = ParameterExchange::default();
                    return;
                }
                self.parameter_order(&ParameterExchange::decode(&bytes, order));
            }
        }
    }

    /// Clears a receipt flag.
    fn receive(&mut self, flag: u8) {
        if self.options.version >= ZONES_AT_ONCE {
            let flags = self.ram(MODULE_PAGE, RECEIPTS);
            self.set_ram(MODULE_PAGE, RECEIPTS, flags & !flag);
        }
    }

    fn order(&mut self, orders: &Orders) {
        let unknown = if self.options.phases_on_order { 0 } else { uc::PHASES_ON };
        let words = orders.uc.map(|word| word & !unknown);
        let parts = words.into_iter().zip(orders.bloc).zip(self.targets);
        for (axis, ((uc, bloc), target)) in self.axes.iter_mut().zip(parts) {
            axis.order(&AxisOrder { uc, bloc, target: target.position, speed: target.speed });
        }
        self.store_positions();
        // Zeroing stores the offset of an absolute encoder (6.2).
        for axis in ModuleAxis::ALL {
            self.store_offset(axis);
        }
    }

    /// Writes what the module says into page 6.
    fn refresh(&mut self, asked: u8) {
        let all = self.options.version >= ZONES_AT_ONCE && self.options.assumptions.refreshes_all;
        let zones = ReadZone::ALL.into_iter().filter(|zone| all || zone.number() == asked);
        let zones: Vec<_> = zones.map(|zone| (zone, self.shown(zone))).collect();
        self.say(asked, &zones);
        if let Some((offset, bits)) = self.garbled {
            let byte = self.ram(MODULE_PAGE, offset);
            self.set_ram(MODULE_PAGE, offset, byte ^ bits);
        }
    }

    /// What a zone says: as it is, or as it was when it got stuck.
    fn shown(&self, zone: ReadZone) -> ZoneBytes {
        match self.stuck {
            Some(stuck) if zone == ReadZone::Positions => stuck,
            _ => self.said(zone),
        }
    }

    /// Positions and axis messages are shown as they are now for good (true), or as they are.
    pub fn set_stuck_status(&mut self, stuck: bool) {
        self.stuck = stuck.then(|| self.said(ReadZone::Positions));
    }

    /// What a zone says now.
    fn said(&self, zone: ReadZone) -> ZoneBytes {
        let order = self.options.byte_order;
        let [one, two] = &self.axes;
        let axes = [one, two];
        match zone {
            ReadZone::Positions => {
                let (positions, messages) = (axes.map(Axis::counter), axes.map(Axis::messages));
                Positions { positions, messages }.encode(order)
            }
            ReadZone::Acknowledgements => {
                let (uc, bloc) = (axes.map(Axis::ack_uc), axes.map(Axis::ack_bloc));
                Orders { uc, bloc }.encode(order)
            }
            ReadZone::Parameter => {
                ParameterExchange { messages: self.card_messages(), ..self.answer }.encode(order)
            }
            ReadZone::EncoderPoints => {
                let positions = axes.map(|axis| axis.encoder().points(axis.shaft()));
                self.encoder_zone(positions)
            }
            ReadZone::EncoderSteps => {
                let positions = axes.map(|axis| axis.encoder().steps(axis.shaft()).unwrap_or(0));
                self.encoder_zone(positions)
            }
            ReadZone::Plugs => Plugs { values: self.plugs }.encode(order),
        }
    }

    fn encoder_zone(&self, positions: [i32; AXES]) -> ZoneBytes {
        let messages = ModuleAxis::ALL.map(|axis| self.encoder_messages(axis));
        Positions { positions, messages }.encode(self.options.byte_order)
    }

    /// "Cette cote est mémorisée à la fin de tous les déplacements" (3.1.20.1).
    pub(super) fn store_positions(&mut self) {
        for axis in ModuleAxis::ALL {
            let of = *self.axis(axis);
            let Some(ends) = self.stored_ends.get_mut(axis.index()) else { continue };
            if *ends == of.ends() {
                continue;
            }
            *ends = of.ends();
            let points = of.encoder().points(of.shaft());
            self.store(AxisParameter::LastPosition, axis, of.stored().cast_unsigned());
            self.store(AxisParameter::LastEncoderPosition, axis, points.cast_unsigned());
        }
    }

    /// A zone as the module has heard it.
    fn zone(&self, offset: u8) -> ZoneBytes {
        let mut bytes = [0; ZONE_LENGTH];
        for (offset, byte) in (offset..).zip(&mut bytes) {
            *byte = self.heard(offset);
        }
        bytes
    }

    /// A byte of the RAM.
    pub(super) fn ram(&self, page: u8, offset: u8) -> u8 {
        self.ram.get(place(page, offset)).copied().unwrap_or(0)
    }

    /// Writes a byte of the RAM.
    pub(super) fn set_ram(&mut self, page: u8, offset: u8, value: u8) {
        if let Some(byte) = self.ram.get_mut(place(page, offset)) {
            *byte = value;
        }
    }
}

fn place(page: u8, offset: u8) -> usize {
    (usize::from(page) * usize::from(WINDOW_LENGTH) + usize::from(offset)).min(RAM_LENGTH - 1)
}
