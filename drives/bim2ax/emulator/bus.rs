//! Bus between host and module: when writes and interrupts arrive, with the faults of the bus.
//!
//! A request is everything the host writes for one interrupt: zone numbers, the zones they name, the entries. An answer
//! is what the module writes after it: the requested zone and its number. The faults of [`twin_drives::FaultRule`] mean here:
//!
//! | fault | request | answer |
//! |---|---|---|
//! | drop | the interrupt is lost | nothing is refreshed |
//! | delay | the interrupt takes effect later | it is refreshed later |
//! | corrupt | the given number of bytes have other bits | the same, in the requested zone |
//! | truncate | only the first bytes are written, the rest stays from the request before: numbers are torn | the same |
//! | duplicate | the interrupt comes twice | refreshed twice, which changes nothing |
//! | reorder | the interrupt overtakes the writes: the request before is taken again | the number overtakes the zone |
//! | refuse | orders are refused: axis message bit 14, or "bad order code" for parameters | – |
//! | wrong check, noise, echo | nothing: a bus has neither check sums nor frames | nothing |
//!
//! With the plug pulled nobody drives the bus: everything reads $FF.

use super::{Module, ZONES_AT_ONCE};
use crate::protocol::{
    memory::{ENTRIES, HOST_PAGE, INTERRUPT_STATUS, MODULE_PAGE, WINDOW_LENGTH, ZONES},
    zone::{ReadZone, WriteZone, ZONE_LENGTH, ZoneBytes},
};
use twin_drives::{Direction, WireFault};

/// High nibble of [`ZONES`]: no zone to write.
pub(super) const NO_ZONE: u8 = 0xF;

/// Page 7 as the module hears it.
pub(super) type Page = [u8; WINDOW_LENGTH as usize];

/// A request that takes effect later.
#[derive(Clone, Debug)]
pub(super) struct LateRequest {
    pub(super) due_ns: i64,
    page: Page,
    refused: bool,
}

/// What the module says later.
#[derive(Clone, Debug)]
pub(super) struct LateAnswer {
    pub(super) due_ns: i64,
    bytes: Vec<(u8, u8)>,
}

impl Module {
    /// The interrupt arrives at the module: what it hears, and how often.
    pub(super) fn hear(&mut self) {
        for control in self.agenda.request() {
            self.control(control);
        }
        if self.bus.is_disconnected() {
            return;
        }
        let before = self.heard;
        let mut heard = self.host_page();
        let places = self.places(&heard);
        let (mut times, mut late_ns, mut refused) = (1, 0_i64, false);
        for fault in self.bus.befalling(Direction::Request) {
            match fault {
                WireFault::Drop => times = 0,
                WireFault::Delay { ns } => late_ns = late_ns.saturating_add(ns.max(0)),
                WireFault::Corrupt { bytes } => {
                    let mut written: Vec<u8> =
                        places.iter().map(|place| byte(&heard, *place)).collect();
                    self.bus.corrupt(&mut written, bytes);
                    for (place, value) in places.iter().zip(written) {
                        set(&mut heard, *place, value);
                    }
                }
                WireFault::Truncate { keep } => {
                    for place in places.iter().skip(keep) {
                        set(&mut heard, *place, byte(&before, *place));
                    }
                }
                WireFault::Duplicate => times *= 2,
                WireFault::Reorder => heard = before,
                WireFault::Refuse { .. } => refused = true,
                // A memory has no bytes one after the other.
                WireFault::Lose { .. }
                | WireFault::Double { .. }
                | WireFault::WrongCheck
                | WireFault::Noise { .. }
                | WireFault::Echo => {}
            }
        }
        for _ in 0..times {
            if late_ns > 0 {
                let due_ns = self.now_ns.saturating_add(late_ns);
                self.late_requests.push(LateRequest { due_ns, page: heard, refused });
            } else {
                self.heard = heard;
                self.serve(refused);
            }
        }
    }

    /// A request that was late takes effect.
    pub(super) fn hear_late(&mut self, due_ns: i64) {
        let due = |request: &LateRequest| request.due_ns <= due_ns;
        let (now, later): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.late_requests).into_iter().partition(due);
        self.late_requests = later;
        for LateRequest { page, refused, .. } in now {
            if self.running && !self.bus.is_disconnected() {
                self.heard = page;
                self.serve(refused);
            }
        }
    }

    /// Page 7 as the host has written it.
    fn host_page(&self) -> Page {
        let mut page = [0; WINDOW_LENGTH as usize];
        for (offset, byte) in (0..WINDOW_LENGTH).zip(page.iter_mut()) {
            *byte = self.ram(HOST_PAGE, offset);
        }
        page
    }

    /// Offsets of what counts of a request, in the order in which hosts write it.
    fn places(&self, page: &Page) -> Vec<u8> {
        let numbers = byte(page, ZONES);
        let mut places = vec![ZONES, INTERRUPT_STATUS];
        let mut zones = vec![numbers >> 4];
        let entries = ENTRIES..ENTRIES + 4;
        let at_once = self.options.version >= ZONES_AT_ONCE;
        if at_once {
            let named = entries.clone().map(|entry| byte(page, entry));
            zones.extend(named.filter(|entry| entry >> 4 != 0).map(|entry| entry & 0xF));
        }
        for zone in zones.into_iter().filter(|zone| *zone != NO_ZONE) {
            if let Some(zone) = WriteZone::from_number(zone) {
                places.extend((zone.offset()..).take(ZONE_LENGTH));
            }
        }
        if at_once {
            places.extend(entries);
        }
        places
    }

    /// The module writes its zones, of which one was asked for, and then the number of that.
    pub(super) fn say(&mut self, asked: u8, zones: &[(ReadZone, ZoneBytes)]) {
        let written = |(zone, content): &(ReadZone, ZoneBytes)| (zone.offset()..).zip(*content);
        let (mut bytes, mut others) = (Vec::new(), Vec::new());
        for zone in zones {
            let to = if zone.0.number() == asked { &mut bytes } else { &mut others };
            to.extend(written(zone));
        }
        let numbers = [(INTERRUPT_STATUS, 1), (ZONES, asked)];
        let (mut says, mut late_ns) = (true, 0_i64);
        for fault in self.bus.befalling(Direction::Answer) {
            match fault {
                WireFault::Drop => says = false,
                WireFault::Delay { ns } => late_ns = late_ns.saturating_add(ns.max(0)),
                WireFault::Corrupt { bytes: count } => {
                    let mut said: Vec<u8> = bytes.iter().map(|(_, byte)| *byte).collect();
                    self.bus.corrupt(&mut said, count);
                    for ((_, byte), said) in bytes.iter_mut().zip(said) {
                        *byte = said;
                    }
                }
                WireFault::Truncate { keep } => bytes.truncate(keep),
                WireFault::Reorder => bytes.clear(),
                WireFault::Duplicate
                | WireFault::Lose { .. }
                | WireFault::Double { .. }
                | WireFault::WrongCheck
                | WireFault::Noise { .. }
                | WireFault::Refuse { .. }
                | WireFault::Echo => {}
            }
        }
        if !says {
            return;
        }
        bytes.extend(others);
        bytes.extend(numbers);
        if late_ns > 0 {
            let due_ns = self.now_ns.saturating_add(late_ns);
            self.late_answers.push(LateAnswer { due_ns, bytes });
        } else {
            self.show(&bytes);
        }
    }

    /// What was late is shown.
    pub(super) fn say_late(&mut self, due_ns: i64) {
        let due = |answer: &LateAnswer| answer.due_ns <= due_ns;
        let (now, later): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.late_answers).into_iter().partition(due);
        self.late_answers = later;
        for LateAnswer { bytes, .. } in now {
            self.show(&bytes);
            // Hosts on a memory file look whether anything has been served.
            self.served += 1;
        }
    }

    fn show(&mut self, bytes: &[(u8, u8)]) {
        for (offset, byte) in bytes {
            self.set_ram(MODULE_PAGE, *offset, *byte);
        }
    }

    /// A byte of page 7 as the module has heard it.
    pub(super) fn heard(&self, offset: u8) -> u8 {
        byte(&self.heard, offset)
    }

    /// Takes an entry back that has been carried out.
    pub(super) fn forget_entry(&mut self, entry: u8) {
        set(&mut self.heard, entry, 0);
        self.set_ram(HOST_PAGE, entry, 0);
    }
}

fn byte(page: &Page, offset: u8) -> u8 {
    page.get(usize::from(offset)).copied().unwrap_or(0)
}

fn set(page: &mut Page, offset: u8, value: u8) {
    if let Some(byte) = page.get_mut(usize::from(offset)) {
        *byte = value;
    }
}
