//! Options of an emulated device.

use std::time::Duration;

use super::Input;
use crate::{Assumptions, Mode, TagLayout};

/// A switch that the mechanics operate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cam {
    /// Input it is wired to.
    pub input: Input,
    /// It is active from here, µsteps from where the axis stood when the emulator was started.
    pub from: f64,
    /// To here.
    pub to: f64,
}

/// Settings of homing; the meaning of `CfgHome` is not documented.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomingOptions {
    /// Input of the home switch.
    pub input: Input,
    /// Whether the switch is sought in the positive direction.
    pub positive: bool,
    /// Time after which homing is given up.
    pub timeout: Duration,
}

impl Default for HomingOptions {
    /// GO, in the negative direction, 30 s.
    fn default() -> Self {
        Self { input: Input::Go, positive: false, timeout: Duration::from_secs(30) }
    }
}

/// A device at power-up.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceOptions {
    /// Address from the factory.
    pub address: u8,
    /// Parameter `Release`: 15–12 major, 11–4 minor, 3–0 correction.
    pub release: u16,
    /// Fourth part of the release: from 310 on there are encoders to zero and DONE ends homing, from 315 on homing has
    /// an alarm.
    pub build: u16,
    /// Layout of the trajectory flags; the manual gives two.
    pub layout: TagLayout,
    /// Mode that power-up and MODE 255 choose; its parameter is not documented.
    pub configured_mode: Mode,
    /// Homing.
    pub homing: HomingOptions,
    /// Other assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// Switches on the way.
    pub cams: Vec<Cam>,
    /// Duration of a change of mode, of SAVE and of LOAD.
    pub mode_change: Duration,
    /// From RESET or power-up to the first answer: the bootloader's 250 ms and the start of the firmware.
    pub boot: Duration,
    /// Whether a stall is an alarm, which switches the power off; else the motion just ends.
    pub stall_is_alarm: bool,
    /// Supply at power-up, V.
    pub supply_v: u16,
    /// Below this, V, there is the alarm UNDERVOLTAGE.
    pub undervoltage_v: u16,
    /// Above this, V, there is the alarm OVERVOLTAGE.
    pub overvoltage_v: u16,
    /// Below this, V, the CPU stops; it boots when the supply is back.
    pub brown_out_v: u16,
}

impl Default for DeviceOptions {
    /// Address 1, release 1.2.0.315, off after power-up, 24 V.
    fn default() -> Self {
        Self {
            address: 1,
            release: 0x1020,
            build: 315,
            layout: TagLayout::Diagram,
            configured_mode: Mode::Off,
            homing: HomingOptions::default(),
            assumptions: Assumptions::default(),
            cams: Vec::new(),
            mode_change: Duration::from_millis(250),
            boot: Duration::from_millis(300),
            stall_is_alarm: true,
            supply_v: 24,
            undervoltage_v: 18,
            overvoltage_v: 56,
            brown_out_v: 9,
        }
    }
}
