//! The module's 1 KiB through its window of 128 bytes.

use std::{fmt, io};

use super::{
    BIM2AX_BOCM, ENTRIES, HOST_PAGE, IDENTIFIER, INTERRUPT, INTERRUPT_STATUS, MODULE_PAGE, Memory,
    NOT_RUNNING, PAGE_REGISTER, RECEIPTS, ZONES,
};
use crate::protocol::zone::{ReadZone, WriteZone, ZONE_LENGTH, ZoneBytes};

/// High nibble of [`ZONES`]: nothing to write.
const WRITE_NONE: u8 = 0xF0;
/// High nibble of an entry that counts.
const ENTRY: u8 = 0x70;

/// The only one who accesses a module. It keeps a copy of the page register, which reads back as status.
pub(crate) struct Window {
    memory: Box<dyn Memory>,
    page: Option<u8>,
    /// The entries for several zones may hold something.
    entries_dirty: bool,
}

impl fmt::Debug for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Window").field("page", &self.page).finish_non_exhaustive()
    }
}

impl Window {
    pub(crate) fn new(memory: impl Memory + 'static) -> Self {
        // A program that died may have left some, which the first order would carry out again.
        Self { memory: Box::new(memory), page: None, entries_dirty: true }
    }

    /// Selects a page. It is written even where it should be selected: another program may have been at the module.
    fn select(&mut self, page: u8) -> io::Result<()> {
        self.page = Some(page);
        self.memory.write(PAGE_REGISTER, &[page])
    }

    /// True if the module's software runs; only then it may be interrupted.
    pub(crate) fn running(&mut self) -> io::Result<bool> {
        Ok(self.byte(PAGE_REGISTER)? & NOT_RUNNING == 0)
    }

    /// The identifier, if it is not that of this module.
    pub(crate) fn stranger(&mut self) -> io::Result<Option<u8>> {
        let found = self.byte(IDENTIFIER)?;
        Ok((found != BIM2AX_BOCM).then_some(found))
    }

    fn byte(&mut self, offset: u8) -> io::Result<u8> {
        let mut byte = [0];
        self.memory.read(offset, &mut byte)?;
        let [byte] = byte;
        Ok(byte)
    }

    fn interrupt(&mut self) -> io::Result<()> {
        self.memory.write(INTERRUPT, &[1])
    }

    /// Asks the module to refresh what it says (9.2.2).
    pub(crate) fn request(&mut self, zone: ReadZone) -> io::Result<()> {
        self.select(HOST_PAGE)?;
        self.memory.write(ZONES, &[WRITE_NONE | zone.number()])?;
        self.memory.write(INTERRUPT_STATUS, &[1])?;
        self.memory.write(ENTRIES, &[0; 4])?;
        self.entries_dirty = false;
        self.interrupt()
    }

    /// Writes one zone and asks to refresh another (9.2.3.1). Entries left over are cleared first, lest they be
    /// written again.
    pub(crate) fn write_zone(
        &mut self,
        zone: WriteZone,
        bytes: &ZoneBytes,
        read: ReadZone,
    ) -> io::Result<()> {
        self.select(HOST_PAGE)?;
        if self.entries_dirty {
            self.memory.write(ENTRIES, &[0; 4])?;
            self.entries_dirty = false;
        }
        self.memory.write(ZONES, &[zone.number() << 4 | read.number()])?;
        self.memory.write(zone.offset(), bytes)?;
        self.memory.write(INTERRUPT_STATUS, &[1])?;
        self.interrupt()
    }

    /// Writes up to four zones with one interrupt, in this order (9.2.3.2, from version 15).
    pub(crate) fn write_zones(&mut self, zones: &[(WriteZone, ZoneBytes)]) -> io::Result<()> {
        self.select(HOST_PAGE)?;
        self.memory.write(ZONES, &[WRITE_NONE])?;
        let mut entries = [0; 4];
        for (entry, (zone, bytes)) in entries.iter_mut().zip(zones) {
            self.memory.write(zone.offset(), bytes)?;
            *entry = ENTRY | zone.number();
        }
        self.entries_dirty = true;
        self.memory.write(ENTRIES, &entries)?;
        self.memory.write(INTERRUPT_STATUS, &[1])?;
        self.interrupt()
    }

    /// Sets receipt flags, to be cleared by the module (9.2.4, from version 15).
    pub(crate) fn ask_receipt(&mut self, flags: u8) -> io::Result<()> {
        self.select(MODULE_PAGE)?;
        self.memory.write(RECEIPTS, &[flags])
    }

    /// Receipt flags that the module has not cleared yet.
    pub(crate) fn receipts(&mut self) -> io::Result<u8> {
        self.select(MODULE_PAGE)?;
        self.byte(RECEIPTS)
    }

    /// A zone as the module last refreshed it, and the zone that it says it has refreshed.
    pub(crate) fn read_zone(&mut self, zone: ReadZone) -> io::Result<(u8, ZoneBytes)> {
        self.select(MODULE_PAGE)?;
        let refreshed = self.byte(ZONES)?;
        let mut bytes = [0; ZONE_LENGTH];
        self.memory.read(zone.offset(), &mut bytes)?;
        Ok((refreshed, bytes))
    }

    /// Forgets which zone the module has refreshed: it will say so again when it has been interrupted.
    pub(crate) fn forget_refreshed(&mut self) -> io::Result<()> {
        self.select(MODULE_PAGE)?;
        self.memory.write(ZONES, &[0xFF])
    }
}
