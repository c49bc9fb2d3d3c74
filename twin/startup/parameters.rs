//! Required parameter values of real devices for a machine file.

use crate::emulated::{demand, velocity_within};
use crate::repair_commands;
use twin_bim2ax::protocol::bits::definition;
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_bim2ax::{DriveMode, ModuleAxis};
use twin_drives::ParameterId;
use twin_interpcnc::Following;
use twin_interpcnc::protocol::parameters::{COUPLING, ZERO_AFTER_HOMING};
use twin_machine::{DriveFamily, Machine};
use twin_smartdrive::protocol::parameters::{
    ACCELERATION_MAX, DECELERATION_MAX, FULL_STEPS, STEP_DIVISOR, VELOCITY_MAX,
};

/// Required value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Must {
    Be(i64),
    BeAtLeast(i64),
    /// 0 says that another parameter counts.
    BeAtLeastOrZero(i64),
    /// These bits are set, whatever the others are.
    Have(i64),
}

impl Must {
    /// A value that will do in the place of what was found.
    fn value(self, found: i64) -> i64 {
        match self {
            Self::Be(value) | Self::BeAtLeast(value) | Self::BeAtLeastOrZero(value) => value,
            Self::Have(bits) => found | bits,
        }
    }

    pub(super) fn allows(self, found: i64) -> bool {
        match self {
            Self::Be(value) => found == value,
            Self::BeAtLeast(value) => found >= value,
            Self::BeAtLeastOrZero(value) => found == 0 || found >= value,
            Self::Have(bits) => found & bits == bits,
        }
    }
}

/// A parameter that counts.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) id: ParameterId,
    pub(super) must: Must,
    /// Name of the axis whose parameter it is.
    pub(super) axis: Option<String>,
    /// The key of the machine file that it follows from.
    key: Key,
}

/// A key of the machine file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Key {
    /// None: nothing but this value will do.
    None,
    /// Of the device, with the parameter's own value.
    OfDevice(&'static str),
    /// Of the device's `[drives.encoder]`, with the parameter's own value.
    OfEncoder(&'static str),
    /// The device's `microsteps`, of which the parameter is the drive mode.
    Mode,
    /// The largest velocity of the axis.
    Velocity,
}

impl Wanted {
    /// Remedies for a difference between device and machine file: the commands that set the parameter, and the key that
    /// would match the value found.
    pub(super) fn help(&self, machine: &Machine, device: usize, found: i64) -> Vec<String> {
        let mut help = repair_commands::set(machine, device, self.id, self.must.value(found));
        let name = machine.drives.get(device).map_or("", |entry| &entry.name);
        let file = machine.path.display();
        let of_device =
            |key, value| format!("or `{key} = {value}` of [[drives]] \"{name}\" in {file}");
        help.extend(match self.key {
            Key::None => None,
            Key::OfDevice(key) => Some(of_device(key, found)),
            Key::OfEncoder(key) => {
                Some(format!("or `{key} = {found}` of [drives.encoder] of \"{name}\" in {file}"))
            }
            Key::Mode => {
                let mode = u16::try_from(found).ok().and_then(DriveMode::from_code);
                // Of modes with the same microsteps the machine file has those with speeds in steps/s.
                let mode = mode.filter(|mode| mode.speed_unit() > 1.0 || mode.microsteps() == 1);
                mode.map(|mode| of_device("microsteps", mode.microsteps().into()))
            }
            Key::Velocity => self.slower(machine, device, found),
        });
        help
    }

    /// The largest velocity that an axis has with what was found.
    fn slower(&self, machine: &Machine, device: usize, found: i64) -> Option<String> {
        let mut axes = machine.axes_of(device);
        let (_, axis) = axes.find(|(_, axis)| Some(&axis.name) == self.axis.as_ref())?;
        let unit = match machine.drives.get(device)?.family() {
            DriveFamily::InterpCnc(_) | DriveFamily::Other => return None,
            DriveFamily::SmartDrive(bus) => bus.turn.steps(1.0),
            DriveFamily::Bim2Ax(module) => module.mode.speed_unit(),
        };
        #[expect(clippy::cast_precision_loss, reason = "parameters have 16 bits")]
        let velocity = axis.from_si(velocity_within(axis, found as f64 * unit));
        // Downwards.
        let velocity = (velocity * 1e3).floor() * 1e-3;
        let (name, file) = (&axis.name, machine.path.display());
        let key = format!("max_velocity_{}_per_s", axis.unit());
        Some(format!("or `{key} = {velocity:.3}` of axis {name} in {file}"))
    }
}

/// The parameters that count of a device.
pub(super) fn wanted(machine: &Machine, index: usize) -> Vec<Wanted> {
    let Some(entry) = machine.drives.get(index) else { return Vec::new() };
    let mut wanted = Vec::new();
    match entry.family() {
        // Moves carry their speeds and ramps; that an axis goes along with another is kept by the board.
        DriveFamily::InterpCnc(board) => {
            // A counter that homing leaves as it is counts from anywhere.
            let mut known = vec![(COUPLING, 0, Key::None), (ZERO_AFTER_HOMING, 1, Key::None)];
            if let Following::Buffered { start_stop_hz, acceleration_khz_per_s } = board.following {
                // Those of segments are the board's own.
                let assumed = board.assumptions;
                known.extend([
                    (
                        assumed.segment_acceleration,
                        acceleration_khz_per_s.into(),
                        Key::OfDevice("acceleration_khz_per_s"),
                    ),
                    (
                        assumed.segment_start_stop,
                        start_stop_hz.into(),
                        Key::OfDevice("start_stop_hz"),
                    ),
                ]);
            }
            for (number, value, key) in known {
                let (id, must) = (ParameterId { address: 0, number }, Must::Be(value));
                wanted.push(Wanted { id, must, axis: None, key });
            }
        }
        DriveFamily::SmartDrive(bus) => {
            for (_, axis) in machine.axes_of(index) {
                let driven = bus.axis(&demand(axis));
                let deceleration = match driven.deceleration_rpm_per_s {
                    0 => driven.acceleration_rpm_per_s,
                    rate => rate,
                };
                let acceleration = Must::BeAtLeast(driven.acceleration_rpm_per_s.into());
                let deceleration = Must::BeAtLeastOrZero(deceleration.into());
                for (number, must, key) in [
                    (FULL_STEPS, Must::Be(bus.full_steps.into()), "full_steps_per_turn"),
                    (STEP_DIVISOR, Must::Be(bus.microsteps.into()), "microsteps"),
                    (VELOCITY_MAX, Must::BeAtLeast(driven.velocity_rpm.into()), ""),
                    (ACCELERATION_MAX, acceleration, "acceleration_rpm_per_s"),
                    (DECELERATION_MAX, deceleration, "deceleration_rpm_per_s"),
                ] {
                    let key = if key.is_empty() { Key::Velocity } else { Key::OfDevice(key) };
                    let id = ParameterId { address: driven.address, number };
                    wanted.push(Wanted { id, must, axis: Some(axis.name.clone()), key });
                }
            }
        }
        DriveFamily::Bim2Ax(module) => {
            for (_, axis) in machine.axes_of(index) {
                let place = axis.drive.as_ref().map_or(0, |drive| drive.index);
                let Some(on_module) = ModuleAxis::ALL.get(place).copied() else { continue };
                let driven = module.settings(&demand(axis));
                let start_stop = Must::Be(driven.start_stop_speed.into());
                let start_stop = (start_stop, Key::OfDevice("start_stop_steps_per_s"));
                let acceleration = Must::BeAtLeast(driven.acceleration.into());
                let acceleration = (acceleration, Key::OfDevice("acceleration_steps_per_s2"));
                let fast = (Must::BeAtLeast(driven.fast_speed.into()), Key::Velocity);
                let encoder = module.encoder.as_ref();
                let encoder = encoder.filter(|said| said.axes.contains(&on_module));
                let encoder = encoder.map_or_else(Vec::new, |encoder| {
                    let present = Must::Have(definition::PRESENT.into());
                    let [increments, points] =
                        [encoder.increments_per_turn, encoder.points_per_turn]
                            .map(|value| Must::Be(value.into()));
                    vec![
                        (AxisParameter::EncoderDefinition, (present, Key::None)),
                        (
                            AxisParameter::Dividend,
                            (increments, Key::OfEncoder("increments_per_turn")),
                        ),
                        (AxisParameter::Divisor, (points, Key::OfEncoder("points_per_turn"))),
                    ]
                });
                for (parameter, (must, key)) in [
                    (AxisParameter::Mode, (Must::Be(driven.mode.code().into()), Key::Mode)),
                    (AxisParameter::FastSpeed, fast),
                    (AxisParameter::StartStopSpeed, start_stop),
                    (AxisParameter::Acceleration, acceleration),
                ]
                .into_iter()
                .chain(encoder)
                {
                    let number = Parameter::Axis(parameter, on_module).number();
                    let Some(number) = number else { continue };
                    let id = ParameterId { address: 0, number };
                    wanted.push(Wanted { id, must, axis: Some(axis.name.clone()), key });
                }
            }
        }
        DriveFamily::Other => {}
    }
    wanted
}
