//! Status of an answer: STA and the meanings of TAG.
//!
//! Source: "Trame de réponse", STA and TAG.

/// STA, the first two bytes of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(pub u16);

impl Status {
    /// `STA_REJECT`: the command was refused, TAG says why.
    pub const REJECT: u16 = 1 << 15;
    /// `STA_SIGNALLED`: state of the sequencer, internal.
    pub const SIGNALLED: u16 = 1 << 14;
    /// `STA_SEQBUSY`: a sequence (homing) is running.
    pub const SEQUENCE_BUSY: u16 = 1 << 13;
    /// `STA_RESPONSE`: always 1; marks the first byte of an answer.
    pub const RESPONSE: u16 = 1 << 7;
    /// `STA_BUSY`: internal.
    pub const BUSY: u16 = 1 << 6;
    /// `STA_ALARM`: the device is in alarm and off; in answers to PING only.
    pub const ALARM: u16 = 1;

    /// The status of a device, `mode` (0 to 31) as it is shown.
    pub fn new(address: u8, mode: u8) -> Self {
        Self(u16::from(address & 0x1F) << 8 | Self::RESPONSE | u16::from(mode & 0x1F) << 1)
    }

    /// With these bits besides, if `on`.
    #[must_use]
    pub fn with(self, bits: u16, on: bool) -> Self {
        if on { Self(self.0 | bits) } else { self }
    }

    /// Whether the command was refused.
    pub fn rejected(self) -> bool {
        self.0 & Self::REJECT != 0
    }

    /// Whether a sequence (homing) is running.
    pub fn sequence_busy(self) -> bool {
        self.0 & Self::SEQUENCE_BUSY != 0
    }

    /// Whether the sequencer shows its own bit; the manual says no more.
    pub fn signalled(self) -> bool {
        self.0 & Self::SIGNALLED != 0
    }

    /// Whether the device calls itself not available; the manual does not say when.
    pub fn busy(self) -> bool {
        self.0 & Self::BUSY != 0
    }

    /// Whether this is the status of an answer at all.
    pub fn is_response(self) -> bool {
        self.0 & Self::RESPONSE != 0
    }

    /// Whether the device is in alarm; meaningful in answers to PING only.
    pub fn alarm(self) -> bool {
        self.0 & Self::ALARM != 0
    }

    /// Address of the device, `STA_ADDR`.
    pub fn address(self) -> u8 {
        (self.0 >> 8).to_le_bytes()[0] & 0x1F
    }

    /// Number of the mode, `STA_MODE`; 31 while it changes.
    pub fn mode(self) -> u8 {
        (self.0 >> 1).to_le_bytes()[0] & 0x1F
    }
}

/// Reason of a refused command; TAG if `STA_REJECT` is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RejectCode {
    /// `REJ_GENERIC` 0, not specified.
    Generic = 0,
    /// `REJ_WORKING` 1, a long command is running.
    Working = 1,
    /// `REJ_BADMODE` 2, not in this mode.
    BadMode = 2,
    /// `REJ_BADPARAMS` 3, a parameter is wrong.
    BadParams = 3,
    /// `REJ_NOTAVAILABLE` 4, there is no such function or command.
    NotAvailable = 4,
}

impl RejectCode {
    /// All of them, by number.
    pub const ALL: [Self; 5] =
        [Self::Generic, Self::Working, Self::BadMode, Self::BadParams, Self::NotAvailable];

    /// Number on the wire.
    pub fn number(self) -> u16 {
        self as u16
    }

    /// The reason with a number; `None` for numbers the manual does not have.
    pub fn from_number(number: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|code| code.number() == number)
    }
}

/// Alarms: TAG of an answer to PING with `STA_ALARM`, and variable 68.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Alarms(pub u16);

impl Alarms {
    /// `ALM_POWERDRIVER`: power stage.
    pub const POWER_DRIVER: Self = Self(1);
    /// `ALM_OVERTEMP`: temperature of the CPU.
    pub const OVERTEMPERATURE: Self = Self(1 << 1);
    /// `ALM_OVERVOLTAGE`: supply.
    pub const OVERVOLTAGE: Self = Self(1 << 2);
    /// `ALM_UNDERVOLTAGE`: supply.
    pub const UNDERVOLTAGE: Self = Self(1 << 3);
    /// `ALM_OFFCURRENT`: probes of the current.
    pub const CURRENT_PROBES: Self = Self(1 << 4);
    /// `ALM_STALL`: the rotor is blocked.
    pub const STALL: Self = Self(1 << 5);
    /// `ALM_CPU_OSC`: oscillator of the CPU.
    pub const OSCILLATOR: Self = Self(1 << 6);
    /// `ALM_HOMING`: homing took too long; from release 1.2.0.315 (the diagram has 0 here).
    pub const HOMING: Self = Self(1 << 11);

    /// Every alarm and what to call it.
    pub const NAMES: [(Self, &'static str); 8] = [
        (Self::POWER_DRIVER, "power driver"),
        (Self::OVERTEMPERATURE, "overtemperature"),
        (Self::OVERVOLTAGE, "overvoltage"),
        (Self::UNDERVOLTAGE, "undervoltage"),
        (Self::CURRENT_PROBES, "current probes"),
        (Self::STALL, "stall"),
        (Self::OSCILLATOR, "CPU oscillator"),
        (Self::HOMING, "homing timeout"),
    ];

    /// Whether all of `other` are among these.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// These and `other`.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// These without `other`.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

impl std::fmt::Display for Alarms {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names = Self::NAMES.iter().filter(|(alarm, _)| self.contains(*alarm));
        let names: Vec<_> = names.map(|(_, name)| *name).collect();
        if names.is_empty() { write!(f, "{:#06x}", self.0) } else { f.write_str(&names.join(", ")) }
    }
}

/// Layout of the trajectory flags, of which the manual gives two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TagLayout {
    /// Bits 0 and 8 to 13.
    #[default]
    Diagram,
    /// Bits 0 to 6.
    Table,
}

/// State of the trajectory generator, in the bits of the manual's table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrajectoryFlags(u16);

impl TrajectoryFlags {
    /// None.
    pub const NONE: Self = Self(0);
    /// `TRJ_DONE`: target or speed reached, at rest after a stop, homing done.
    pub const DONE: Self = Self(1);
    /// `TRJ_INMOTION`: the speed is not 0.
    pub const IN_MOTION: Self = Self(1 << 1);
    /// `TRJ_TRIGGERED`: the trigger has fired.
    pub const TRIGGERED: Self = Self(1 << 2);
    /// `TRJ_STALLED`: stopped because the rotor was blocked.
    pub const STALLED: Self = Self(1 << 3);
    /// `TRJ_LIMITED`: stopped by a limit switch.
    pub const LIMITED: Self = Self(1 << 4);
    /// `TRJ_LIMITEDP`: stopped by LIMP.
    pub const LIMITED_P: Self = Self(1 << 5);
    /// `TRJ_LIMITEDN`: stopped by LIMN.
    pub const LIMITED_N: Self = Self(1 << 6);

    /// The flags in a TAG of either layout: their bits do not overlap, so that the device need not be known.
    pub fn from_tag(tag: u16) -> Self {
        Self(tag & 0x7F | tag >> 7 & 0x7E)
    }

    /// TAG.
    pub fn tag(self, layout: TagLayout) -> u16 {
        match layout {
            TagLayout::Diagram => self.0 & 1 | (self.0 & 0x7E) << 7,
            TagLayout::Table => self.0,
        }
    }

    /// Whether all of `other` are set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// These and `other`.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// These without `other`.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits as the manual's diagram and its table number them.
    #[test]
    fn flags_are_read_from_both_layouts() {
        let bits = [
            (TrajectoryFlags::DONE, 0, 0),
            (TrajectoryFlags::IN_MOTION, 8, 1),
            (TrajectoryFlags::TRIGGERED, 9, 2),
            (TrajectoryFlags::STALLED, 10, 3),
            (TrajectoryFlags::LIMITED, 11, 4),
            (TrajectoryFlags::LIMITED_P, 12, 5),
            (TrajectoryFlags::LIMITED_N, 13, 6),
        ];
        for (flag, diagram, table) in bits {
            assert_eq!(flag.tag(TagLayout::Diagram), 1 << diagram);
            assert_eq!(flag.tag(TagLayout::Table), 1 << table);
            assert_eq!(TrajectoryFlags::from_tag(1 << diagram), flag);
            assert_eq!(TrajectoryFlags::from_tag(1 << table), flag);
        }
    }

    /// Bits of "STA": 15 REJECT, 14 SIGNALLED, 13 SEQBUSY, 12–8 ADDR, 7 RESPONSE, 6 BUSY, 5–1 MODE, 0 ALARM.
    #[test]
    fn status_bits_are_where_the_manual_has_them() {
        let status = Status(0b1010_0101_1100_0111);
        assert!(status.rejected() && status.sequence_busy() && status.is_response());
        assert!(status.alarm());
        assert_eq!((status.address(), status.mode()), (5, 3));
        assert_eq!(status.0 & Status::SIGNALLED, 0);
        assert_ne!(status.0 & Status::BUSY, 0);
        assert_eq!(Status::new(31, 31).0, 0b0001_1111_1011_1110);
        assert_eq!(Status::new(1, 0).with(Status::ALARM, true).0, 0x0181);
    }

    #[test]
    fn alarms_and_reasons_have_their_numbers() {
        let bits = [0, 1, 2, 3, 4, 5, 6, 11];
        for ((alarm, name), bit) in Alarms::NAMES.into_iter().zip(bits) {
            assert_eq!(alarm.0, 1 << bit, "{name}");
        }
        let two = Alarms::UNDERVOLTAGE.union(Alarms::HOMING);
        assert_eq!(two.to_string(), "undervoltage, homing timeout");
        assert_eq!(Alarms(1 << 14).to_string(), "0x4000");
        for (number, code) in (0..).zip(RejectCode::ALL) {
            assert_eq!(RejectCode::from_number(number), Some(code));
        }
        assert_eq!(RejectCode::from_number(5), None);
    }
}
