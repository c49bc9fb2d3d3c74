//! `[[drives]]`: the devices that drive axes, each of a drive family.

mod encoder;

use crate::section::Section;
pub(super) use encoder::check as check_encoder;
use std::fs;
use std::path::{self, Path, PathBuf};
use std::time::Duration;
use twin_bim2ax::{Bim2AxEntry, Bim2AxFamily};
use twin_drives::family::{Abilities, Device, Family};
use twin_interpcnc::{InterpCncEntry, InterpCncFamily};
use twin_smartdrive::{SmartDriveEntry, SmartDriveFamily};

/// The drive families. One more takes a folder in `drives` and a line here.
pub const FAMILIES: &[&dyn Family] = &[&InterpCncFamily, &SmartDriveFamily, &Bim2AxFamily];

/// A device that moves one or more axes.
#[derive(Clone, Debug)]
pub struct DeviceEntry {
    /// The name axes refer to.
    pub name: String,
    /// Serial port of the real device, or file of its memory, if it is given.
    pub port: Option<String>,
    /// Version of the firmware that the real device must report.
    pub firmware: Option<String>,
    /// What the deadline of an answer of the real device has to spare, ms, if it differs from the family's.
    pub answer_ms: Option<u32>,
    /// Longest silence while its axes are to move, ms, before the run is stopped; if given.
    pub silence_ms: Option<u32>,
    /// Response time of the real device with adapter and cable, µs, if known; predictions use it.
    pub turnaround_us: Option<u32>,
    /// True if it is in the loop, between set-points and motors of the simulated machine.
    pub in_loop: bool,
    /// The device itself, as its family describes it.
    pub device: Box<dyn Device>,
    /// Names and values of its assumptions that differ from the defaults of the family, as in the file.
    pub assumed: Vec<(String, String)>,
}

/// A device by its family, for start-up checks, repair commands and reports.
#[derive(Clone, Copy, Debug)]
pub enum DriveFamily<'a> {
    /// SOPROLEC InterpCNC V2.1: a board for five axes on Modbus RTU.
    InterpCnc(&'a InterpCncEntry),
    /// SmartDRIVE v1.2: up to five drives of one axis on a serial bus, by the ATB protocol.
    SmartDrive(&'a SmartDriveEntry),
    /// BIM2AX-BOCM: a module for two axes in dual-port RAM.
    Bim2Ax(&'a Bim2AxEntry),
    /// Any other family.
    Other,
}

/// The family of a section, even if the section has errors.
fn glance(section: &Section<'_>, families: &[&'static dyn Family]) -> Option<&'static dyn Family> {
    let said = section.glance_at_text("kind")?;
    families.iter().copied().find(|family| family.kind() == said)
}

/// A device as axes see it, also if there is something wrong with it.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub(super) name: String,
    /// Not known of a kind that there is not.
    pub(super) family: Option<&'static dyn Family>,
    /// Known of a device with which nothing is wrong.
    pub(super) abilities: Option<Abilities>,
    /// The file says with which speed its step motors start at once.
    pub(super) starts: bool,
}

/// Keys of the speed with which step motors start at once.
const START_STOP_KEYS: [&str; 2] = ["start_stop_hz", "start_stop_steps_per_s"];

impl Seen {
    pub(super) fn of(
        section: &Section<'_>,
        entry: Option<&DeviceEntry>,
        families: &[&'static dyn Family],
    ) -> Self {
        Self {
            name: section.glance_at_text("name").unwrap_or_default().to_owned(),
            family: glance(section, families),
            abilities: entry.map(|entry| entry.device.abilities()),
            starts: START_STOP_KEYS.iter().any(|key| section.has(key)),
        }
    }
}

impl DeviceEntry {
    /// The device by its family.
    pub fn family(&self) -> DriveFamily<'_> {
        if let Some(board) = self.device.of::<InterpCncEntry>() {
            DriveFamily::InterpCnc(board)
        } else if let Some(bus) = self.device.of::<SmartDriveEntry>() {
            DriveFamily::SmartDrive(bus)
        } else if let Some(module) = self.device.of::<Bim2AxEntry>() {
            DriveFamily::Bim2Ax(module)
        } else {
            DriveFamily::Other
        }
    }

    /// Name of the family.
    pub fn family_name(&self) -> &'static str {
        self.device.family().title()
    }

    /// Uses the response time of the real device from now on; false if the file does not give it.
    pub fn expect_real(&mut self) -> bool {
        let Some(turnaround_us) = self.turnaround_us else { return false };
        self.device.expect_response_us(turnaround_us);
        true
    }

    /// Expected response time, µs.
    pub fn expected_response_us(&self) -> u32 {
        self.device.response_us()
    }

    /// What the client of the real device adds to the time that an exchange takes, and the pause before it asks again.
    pub fn waits(&self) -> [Duration; 2] {
        self.device.waits(self.answer_ms.map(|time_ms| Duration::from_millis(time_ms.into())))
    }

    /// Unique place of the real device: its port, resolved, and the offset in it of a mapped module.
    pub(super) fn place(&self) -> Option<(PathBuf, Option<u64>)> {
        let port = Path::new(self.port.as_deref()?);
        // One that is not plugged in has no other name that could be known.
        let real = fs::canonicalize(port).or_else(|_| path::absolute(port));
        Some((real.unwrap_or_else(|_| port.to_owned()), self.device.map_offset()))
    }

    /// Name of an axis of the device.
    pub fn axis_name(&self, index: usize) -> String {
        self.device.family().axis_name(index)
    }
}

/// Complains about an address key that belongs elsewhere in this family.
fn misplaced_address(section: &Section<'_>, family: &dyn Family) {
    for key in ["address", "station", "drive_address"] {
        if section.has(key)
            && let Some((message, help)) = family.misplaced_address(key)
        {
            section.accept(key);
            section.complain_with_help(key, message, Some(help));
        }
    }
}

/// Reads one `[[drives]]` table.
pub(super) fn read(section: &Section<'_>, families: &[&'static dyn Family]) -> Option<DeviceEntry> {
    let name = section.required_text("name");
    let kinds: Vec<_> = families.iter().map(|family| (family.kind(), *family)).collect();
    let family = section.required_choice("kind", &kinds);
    let port = section.text("port").map(str::to_owned);
    let firmware = section.text("firmware").map(str::to_owned);
    let turnaround_us = section.number("turnaround_ms", 0.0..=1000.0).map(whole_microseconds);
    let answer_ms = section.integer("answer_deadline_ms", 1..=60_000);
    let answer_ms = answer_ms.and_then(|time_ms| u32::try_from(time_ms).ok());
    let silence_ms = section.integer("longest_silence_ms", 20..=60_000);
    let silence_ms = silence_ms.and_then(|time_ms| u32::try_from(time_ms).ok());
    let in_loop = section.flag("in_loop").unwrap_or(false);
    let Some(family) = family else {
        // What other keys there are is not known.
        section.accept_all();
        return None;
    };
    section.is_of_kind(family.kind());
    misplaced_address(section, family);
    let device = family.read(section);
    let (name, device) = (name?.to_owned(), device?);
    let assumed = otherwise(section, family);
    Some(DeviceEntry {
        name,
        port,
        firmware,
        answer_ms,
        silence_ms,
        turnaround_us,
        in_loop,
        device,
        assumed,
    })
}

/// Entries of `[drives.assumptions]` that differ from the defaults.
fn otherwise(section: &Section<'_>, family: &dyn Family) -> Vec<(String, String)> {
    if !section.has("assumptions") {
        return Vec::new();
    }
    let said = section.section("assumptions");
    let names = said.keys().into_iter();
    let said = names.filter_map(|name| Some((name, said.glance_at_text(name)?)));
    let said = said.filter(|(name, value)| family.is_assumed_otherwise(name, value));
    said.map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
}

fn whole_microseconds(time_ms: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to a million")]
    let time_us = (time_ms * 1e3).round() as u32;
    time_us
}
