//! `[[drives]]`: the devices that drive axes, each of a drive family.

mod bim2ax;
mod encoder;
mod interpcnc;
mod smartdrive;

use crate::section::Section;
pub use bim2ax::Bim2AxEntry;
pub use encoder::ModuleEncoder;
pub(super) use encoder::check as check_encoder;
pub use interpcnc::{InterpCncEntry, Parity};
pub use smartdrive::SmartDriveEntry;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{self, Path, PathBuf};
use twin_drives::Assumed;

/// A device that moves one or more axes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceEntry {
    /// The name axes refer to.
    pub name: String,
    /// Serial port of the real device, or file of its memory, if it is given.
    pub port: Option<String>,
    /// Version of the firmware that the real device must report.
    pub firmware: Option<String>,
    /// Longest time an answer of the real device may take, ms, where it is not the family's usual.
    pub answer_ms: Option<u32>,
    /// Longest silence while its axes are to move, ms, before the run is stopped; if given.
    pub silence_ms: Option<u32>,
    /// Response time of the real device, adapter and cable included, µs, if known. Predictions before a run with real
    /// drives use it.
    pub turnaround_us: Option<u32>,
    /// True if it is in the loop, between set-points and motors of the simulated machine.
    pub in_loop: bool,
    /// Its family.
    pub family: DriveFamily,
    /// Names and values of its assumptions that differ from the defaults of the family, as in the file.
    pub assumed: Vec<(String, String)>,
}

/// A drive family, with what the file says of a device of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveFamily {
    /// SOPROLEC InterpCNC V2.1: a board for five axes on Modbus RTU.
    InterpCnc(InterpCncEntry),
    /// SmartDRIVE v1.2: up to five drives of one axis on a serial bus, by the ATB protocol.
    SmartDrive(SmartDriveEntry),
    /// BIM2AX-BOCM: a module for two axes in dual-port RAM.
    Bim2Ax(Bim2AxEntry),
}

/// Value of `kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    InterpCnc,
    SmartDrive,
    Bim2Ax,
}

impl Kind {
    pub(super) const ALL: [(&str, Self); 3] = [
        ("interpcnc", Self::InterpCnc),
        ("smartdrive", Self::SmartDrive),
        ("bim2ax", Self::Bim2Ax),
    ];

    /// The kind of a section, even if the section has errors.
    pub(super) fn glance(section: &Section<'_>) -> Option<Self> {
        let said = section.glance_at_text("kind")?;
        Self::ALL.into_iter().find(|(name, _)| *name == said).map(|(_, kind)| kind)
    }

    /// Axis of the device that an axis of the machine uses; the keys are those of `[[axes]]`.
    pub(super) fn axis(self, section: &Section<'_>) -> Option<usize> {
        match self {
            Self::InterpCnc => {
                section.choice("drive_axis", &[("X", 0), ("Y", 1), ("Z", 2), ("A", 3), ("B", 4)])
            }
            Self::SmartDrive => {
                let address = section.integer("drive_address", 1..=31)?;
                usize::try_from(address).ok()
            }
            Self::Bim2Ax => section.choice("drive_axis", &[("1", 0), ("2", 1)]),
        }
    }

    /// The key of that.
    pub(super) fn axis_key(self) -> &'static str {
        match self {
            Self::InterpCnc | Self::Bim2Ax => "drive_axis",
            Self::SmartDrive => "drive_address",
        }
    }
}

/// A device as axes see it, also if there is something wrong with it.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub(super) name: String,
    /// Not known of a kind that there is not.
    pub(super) kind: Option<Kind>,
    /// Known of a device with which nothing is wrong.
    pub(super) abilities: Option<Abilities>,
}

impl Seen {
    pub(super) fn of(section: &Section<'_>, entry: Option<&DeviceEntry>) -> Self {
        Self {
            name: section.glance_at_text("name").unwrap_or_default().to_owned(),
            kind: Kind::glance(section),
            abilities: entry.map(DeviceEntry::abilities),
        }
    }
}

/// Abilities of a device on any machine.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Abilities {
    /// Speeds that an axis may have at its largest velocity, increments/s.
    pub(super) speeds: RangeInclusive<f64>,
    /// Largest position it counts to, increments.
    pub(super) counts: f64,
}

impl DeviceEntry {
    /// Name of the family.
    pub fn family_name(&self) -> &'static str {
        match self.family {
            DriveFamily::InterpCnc(_) => "InterpCNC",
            DriveFamily::SmartDrive(_) => "SmartDRIVE",
            DriveFamily::Bim2Ax(_) => "BIM2AX",
        }
    }

    /// Uses the response time of the real device from now on; false if the file does not give it.
    pub fn expect_real(&mut self) -> bool {
        let Some(turnaround_us) = self.turnaround_us else { return false };
        match &mut self.family {
            DriveFamily::InterpCnc(entry) => entry.turnaround_us = turnaround_us,
            DriveFamily::SmartDrive(entry) => entry.response_us = turnaround_us,
            DriveFamily::Bim2Ax(entry) => entry.order_us = turnaround_us,
        }
        true
    }

    /// Expected response time, µs.
    pub fn reckoned_us(&self) -> u32 {
        match &self.family {
            DriveFamily::InterpCnc(entry) => entry.turnaround_us,
            DriveFamily::SmartDrive(entry) => entry.response_us,
            DriveFamily::Bim2Ax(entry) => entry.order_us,
        }
    }

    /// Place of the real device, which is unique: its port, and the offset in it of a module that is mapped. One port
    /// has many names: links in `/dev/serial/by-id` lead to it, and `./` before it changes nothing.
    pub(super) fn place(&self) -> Option<(PathBuf, Option<u64>)> {
        let offset = match &self.family {
            DriveFamily::Bim2Ax(entry) => entry.map_offset,
            DriveFamily::InterpCnc(_) | DriveFamily::SmartDrive(_) => None,
        };
        let port = Path::new(self.port.as_deref()?);
        // One that is not plugged in has no other name that could be known.
        let real = fs::canonicalize(port).or_else(|_| path::absolute(port));
        Some((real.unwrap_or_else(|_| port.to_owned()), offset))
    }

    /// Name of an axis of the device.
    pub fn axis_name(&self, index: usize) -> String {
        match self.family {
            DriveFamily::InterpCnc(_) => {
                ["X", "Y", "Z", "A", "B"].get(index).copied().unwrap_or("?").to_owned()
            }
            DriveFamily::SmartDrive(_) => format!("address {index}"),
            DriveFamily::Bim2Ax(_) => format!("{}", index.saturating_add(1)),
        }
    }

    pub(super) fn abilities(&self) -> Abilities {
        match &self.family {
            DriveFamily::InterpCnc(_) => InterpCncEntry::abilities(),
            DriveFamily::SmartDrive(entry) => entry.abilities(),
            DriveFamily::Bim2Ax(entry) => entry.abilities(),
        }
    }
}

/// The manuals speak of addresses: says where one belongs, which depends on the family.
fn misplaced_address(section: &Section<'_>, kind: Kind) {
    let words: &[&str] = match kind {
        Kind::InterpCnc => &["address", "drive_address"],
        Kind::SmartDrive | Kind::Bim2Ax => &["address", "station", "drive_address"],
    };
    for key in words.iter().filter(|key| section.has(key)) {
        let (message, help) = match kind {
            Kind::InterpCnc => (
                format!("`{key}` is no key of a board: its Modbus address is `station` here"),
                "write `station = …`, 1 to 247".to_owned(),
            ),
            Kind::SmartDrive => (
                format!("`{key}` is no key of a line of SmartDRIVEs: each axis says the address of its own drive"),
                "write `drive_address = …`, 1 to 31, in the [[axes]] that hang on it".to_owned(),
            ),
            Kind::Bim2Ax => (
                format!("`{key}` is no key of a module, which has no address"),
                "`map_offset` says where it is in the window, `drive_axis` of the [[axes]] which of its two axes it is".to_owned(),
            ),
        };
        section.accept(key);
        section.complain_with_help(key, message, Some(help));
    }
}

/// Reads one `[[drives]]` table.
pub(super) fn read(section: &Section<'_>) -> Option<DeviceEntry> {
    let name = section.required_text("name");
    let kind = section.required_choice("kind", &Kind::ALL);
    let port = section.text("port").map(str::to_owned);
    let firmware = section.text("firmware").map(str::to_owned);
    let turnaround_us = section.number("turnaround_ms", 0.0..=1000.0).map(whole_microseconds);
    let answer_ms = section.integer("answer_deadline_ms", 1..=60_000);
    let answer_ms = answer_ms.and_then(|time_ms| u32::try_from(time_ms).ok());
    let silence_ms = section.integer("longest_silence_ms", 20..=60_000);
    let silence_ms = silence_ms.and_then(|time_ms| u32::try_from(time_ms).ok());
    let in_loop = section.flag("in_loop").unwrap_or(false);
    let Some(kind) = kind else {
        // What other keys there are is not known.
        section.accept_all();
        return None;
    };
    let named = Kind::ALL.into_iter().find(|(_, one)| *one == kind);
    section.is_of_kind(named.map_or("", |(name, _)| name));
    misplaced_address(section, kind);
    let family = match kind {
        Kind::InterpCnc => interpcnc::read(section).map(DriveFamily::InterpCnc),
        Kind::SmartDrive => smartdrive::read(section).map(DriveFamily::SmartDrive),
        Kind::Bim2Ax => bim2ax::read(section).map(DriveFamily::Bim2Ax),
    };
    let (name, family) = (name?.to_owned(), family?);
    let assumed = match family {
        DriveFamily::InterpCnc(_) => otherwise::<twin_interpcnc::Assumptions>(section),
        DriveFamily::SmartDrive(_) => otherwise::<twin_smartdrive::Assumptions>(section),
        DriveFamily::Bim2Ax(_) => otherwise::<twin_bim2ax::Assumptions>(section),
    };
    Some(DeviceEntry {
        name,
        port,
        firmware,
        answer_ms,
        silence_ms,
        turnaround_us,
        in_loop,
        family,
        assumed,
    })
}

/// What `[drives.assumptions]` says that is not assumed anyway; what is wrong with it has been told.
fn otherwise<A: Assumed + PartialEq>(section: &Section<'_>) -> Vec<(String, String)> {
    if !section.has("assumptions") {
        return Vec::new();
    }
    let said = section.section("assumptions");
    let differs = |name: &str, value: &str| {
        let mut assumed = A::default();
        assumed.set(name, value).is_ok() && assumed != A::default()
    };
    let names = said.keys().into_iter();
    let said = names.filter_map(|name| Some((name, said.glance_at_text(name)?)));
    let said = said.filter(|(name, value)| differs(name, value));
    said.map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
}

/// What `[drives.assumptions]` says, over what is assumed of any device of the family.
fn assumptions<A: Assumed>(section: &Section<'_>) -> A {
    let mut assumed = A::default();
    if !section.has("assumptions") {
        return assumed;
    }
    let said = section.section("assumptions");
    for name in said.keys() {
        if let Some(value) = said.text(name)
            && let Err(error) = assumed.set(name, value)
        {
            said.complain_at(name, error.to_string());
        }
    }
    assumed
}

/// A time in ms as microseconds.
fn microseconds(section: &Section<'_>, key: &str, default_ms: f64) -> u32 {
    whole_microseconds(section.number(key, 0.0..=1000.0).unwrap_or(default_ms))
}

fn whole_microseconds(time_ms: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to a million")]
    let time_us = (time_ms * 1e3).round() as u32;
    time_us
}
