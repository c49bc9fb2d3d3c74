//! Faults of wires and devices, and the activity of the axis when they occur.

use twin_drives::{Direction, WireFault};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    InterpCnc,
    /// It follows by segments (command 6).
    Segments,
    SmartDrive,
    /// Two drives on a line, of which the first goes wrong.
    Pair,
    Bim2Ax,
}

impl Family {
    pub(crate) const ALL: [Self; 5] =
        [Self::InterpCnc, Self::Segments, Self::SmartDrive, Self::Pair, Self::Bim2Ax];
}

/// Activity of the axis when the fault occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Doing {
    /// It stands; a move is asked for.
    Idle,
    /// It moves to a target, and is asked where it is.
    Looking,
    /// It gets the command to home: the fault befalls the command itself.
    ToHome,
    /// It is being homed.
    Homing,
    /// It follows a plan.
    Moving,
    /// It has followed a plan for a second and gets the command to stop on its ramp.
    Stopping,
    /// The same, and to stop at once.
    Halting,
    /// It is on its way to a target that is far away, and gets the command to stop on its ramp: what does not hear that goes on.
    FarStopping,
    /// The same, and to stop at once.
    FarHalting,
}

impl Doing {
    pub(crate) const ALL: [Self; 9] = [
        Self::Idle,
        Self::Looking,
        Self::ToHome,
        Self::Homing,
        Self::Moving,
        Self::Stopping,
        Self::Halting,
        Self::FarStopping,
        Self::FarHalting,
    ];

    /// True if it is commanded to stop on its ramp.
    pub(crate) fn stops(self) -> bool {
        matches!(self, Self::Stopping | Self::FarStopping)
    }

    /// True if it is commanded to stop at once.
    pub(crate) fn halts(self) -> bool {
        matches!(self, Self::Halting | Self::FarHalting)
    }
}

/// Faults of the device and its plug.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DeviceFault {
    /// The supply fails for a moment: it starts anew.
    BrownOut,
    /// The supply is away for longer than a driver waits, and comes back.
    Outage,
    /// The shaft is held.
    Stall,
    /// ENABLE is lost (InterpCNC), overtemperature (SmartDRIVE), the power at the axis is gone (BIM2AX).
    Alarm,
    /// The status is shown as it was.
    Stuck,
    /// Moves are confirmed and not carried out.
    Ignored,
    /// The plug is pulled, and put back.
    Gone,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    Wire(Direction, WireFault),
    Device(DeviceFault),
}

impl Fault {
    /// Every fault of the list.
    pub(crate) fn all() -> Vec<Self> {
        let both = [
            WireFault::Drop,
            // The rig sets the time.
            WireFault::Delay { ns: 0 },
            WireFault::Corrupt { bytes: 1 },
            WireFault::Lose { bytes: 1 },
            WireFault::Double { bytes: 1 },
            WireFault::Truncate { keep: 3 },
            WireFault::Duplicate,
            WireFault::Reorder,
            WireFault::WrongCheck,
        ];
        let directions = [Direction::Request, Direction::Answer];
        let both = both
            .into_iter()
            .flat_map(|fault| directions.map(|direction| Self::Wire(direction, fault)));
        // Codes of the families: exception 4, reject 4 (not available); a module has but one refusal.
        let refuse = WireFault::Refuse { code: 4 };
        let requests = [refuse, WireFault::Echo].map(|fault| Self::Wire(Direction::Request, fault));
        let device = [
            DeviceFault::BrownOut,
            DeviceFault::Outage,
            DeviceFault::Stall,
            DeviceFault::Alarm,
            DeviceFault::Gone,
            DeviceFault::Stuck,
            DeviceFault::Ignored,
        ];
        both.chain(requests).chain(device.map(Self::Device)).collect()
    }

    /// As the table calls it.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Wire(direction, fault) => {
                let what = match fault {
                    WireFault::Delay { .. } => "delay".to_owned(),
                    other => other.to_string(),
                };
                let of = if *direction == Direction::Request { "request" } else { "answer" };
                format!("{of}: {what}")
            }
            Self::Device(DeviceFault::BrownOut) => "brown-out, reset".to_owned(),
            Self::Device(DeviceFault::Outage) => "without supply for 5 s".to_owned(),
            Self::Device(DeviceFault::Stall) => "stall".to_owned(),
            Self::Device(DeviceFault::Alarm) => "alarm".to_owned(),
            Self::Device(DeviceFault::Gone) => "disconnect, reconnect".to_owned(),
            Self::Device(DeviceFault::Ignored) => "moves without effect".to_owned(),
            Self::Device(DeviceFault::Stuck) => "stuck status".to_owned(),
        }
    }
}
