//! The family as the list of families takes it: keys of a module, and the way to a drive, an emulator and a prediction.

use std::{path::Path, sync::Arc, time::Duration};

use crate::{
    Assumptions, AxisSettings, Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, Bim2AxPrediction,
    ByteOrder, DriveMode, EncoderBench, MOST_POSITION, ModuleAxis, PredictionOptions, SharedModule,
    emulator::{Eeprom, Module, ModuleOptions, Surroundings},
    protocol::{
        bits::definition,
        memory::OpenedMemory,
        parameter::{AxisParameter, Parameter},
    },
};
use twin_drives::{
    Action, Drive, DriveError, Exchange, Prediction,
    family::{
        Abilities, AxisDemand, ConnectError, Connected, Device, DeviceClock, Emulator, Family,
        Keys, assumptions, choice, counted, is_assumed_otherwise, microseconds, required_integer,
    },
};

/// Encoder and counter may be no farther apart than this, whatever the file says.
const MOST_TOLERANCE: i64 = 1_000_000;
/// Full steps of a turn of most motors, from which µsteps per turn follow where the file does not say them.
const FULL_STEPS: u16 = 200;

/// BIM2AX modules.
#[derive(Clone, Copy, Debug)]
pub struct Bim2AxFamily;

impl Family for Bim2AxFamily {
    fn kind(&self) -> &'static str {
        "bim2ax"
    }

    fn title(&self) -> &'static str {
        "BIM2AX"
    }

    fn axis(&self, keys: &dyn Keys) -> Option<usize> {
        keys.word("drive_axis", &["1", "2"])
    }

    fn axis_name(&self, index: usize) -> String {
        index.saturating_add(1).to_string()
    }

    fn has_encoders(&self) -> bool {
        true
    }

    fn misplaced_address(&self, key: &str) -> Option<(String, String)> {
        Some((
            format!("`{key}` does not belong here: a module has no address"),
            "`map_offset` says where it is in the window, `drive_axis` of the [[axes]] which of its two axes it is".to_owned(),
        ))
    }

    fn is_assumed_otherwise(&self, name: &str, value: &str) -> bool {
        is_assumed_otherwise::<Assumptions>(name, value)
    }

    fn read(&self, keys: &dyn Keys) -> Option<Box<dyn Device>> {
        Bim2AxEntry::read(keys).map(|entry| Box::new(entry) as Box<dyn Device>)
    }
}

/// A module, whose axes are alike, as a machine file describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bim2AxEntry {
    /// Drive mode (parameters 2 and 3): microsteps, and the unit of speeds.
    pub mode: DriveMode,
    /// Start-stop speed (parameters $C and $D), steps/s.
    pub start_stop_speed: u16,
    /// Acceleration (parameters $14 and $15), steps/s².
    pub acceleration: u16,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// From an order to the begin of its motion, µs.
    pub order_us: u32,
    /// Offset of the module's memory in the device that is to be mapped; `None` for a memory file.
    pub map_offset: Option<u64>,
    /// Byte order of the module's numbers.
    pub byte_order: ByteOrder,
    /// Encoders of its axes.
    pub encoder: Option<ModuleEncoder>,
}

/// The encoders of a module, which are alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleEncoder {
    /// The axes that have one.
    pub axes: Vec<ModuleAxis>,
    /// Points of a turn, parameters $2E and $2F.
    pub points_per_turn: u16,
    /// µsteps of a turn, parameters $2C and $2D.
    pub increments_per_turn: u16,
    /// Allowed distance between encoder and counter, µsteps; three full steps where the file does not say.
    pub tolerance: Option<u32>,
}

impl Bim2AxEntry {
    fn read(keys: &dyn Keys) -> Option<Self> {
        let microsteps = keys.integer("microsteps", 1..=64).unwrap_or(16);
        // Modes whose speeds are in steps/s: those in microsteps/s are too slow for 16 bits.
        let code = match microsteps {
            1 => Some(0x0001),
            2 => Some(0x0100),
            4 => Some(0x0200),
            8 => Some(0x0300),
            16 => Some(0x0400),
            32 => Some(0x0500),
            64 => Some(0x0600),
            _ => None,
        };
        if code.is_none() {
            let message =
                format!("`microsteps` is {microsteps}; a step has 1, 2, 4, 8, 16, 32 or 64");
            keys.complain("microsteps", message);
        }
        let start_stop = keys.integer("start_stop_steps_per_s", 1..=65_535).unwrap_or(100);
        let acceleration = keys.integer("acceleration_steps_per_s2", 1..=65_535).unwrap_or(65_535);
        let order_us = microseconds(keys, "emulated_turnaround_ms", 10.0);
        let map_offset = keys.integer("map_offset", 0..=i64::MAX);
        let orders = [("big", ByteOrder::Big), ("little", ByteOrder::Little)];
        let byte_order = choice(keys, "byte_order", &orders).unwrap_or(ByteOrder::Big);
        let mode = code.and_then(DriveMode::from_code);
        let usual = mode.unwrap_or(DriveMode::FULL_STEP);
        let encoder = keys.table("encoder").and_then(|table| encoder(&*table, usual));
        Some(Self {
            mode: mode?,
            start_stop_speed: u16::try_from(start_stop).ok()?,
            acceleration: u16::try_from(acceleration).ok()?,
            assumptions: assumptions(keys),
            order_us,
            map_offset: map_offset.and_then(|offset| u64::try_from(offset).ok()),
            byte_order,
            encoder,
        })
    }

    /// The parameters of an axis.
    pub fn settings(&self, demand: &AxisDemand) -> AxisSettings {
        let fastest = counted(demand.speed / self.mode.speed_unit(), u16::MAX.into());
        let [lowest, highest] = demand
            .limits
            .unwrap_or([-MOST_POSITION, MOST_POSITION])
            .map(|limit| limit.clamp(-MOST_POSITION, MOST_POSITION));
        AxisSettings {
            soft_minus: lowest,
            soft_plus: highest,
            mode: self.mode,
            fast_speed: u16::try_from(fastest).unwrap_or(u16::MAX),
            start_stop_speed: self.start_stop_speed,
            acceleration: self.acceleration,
            ..AxisSettings::default()
        }
    }

    /// Settings of a drive, with the encoders of the module.
    fn drive_options(&self, axes: Vec<ModuleAxis>, driver: Bim2AxOptions) -> Bim2AxDriveOptions {
        let encoder = self.encoder.as_ref();
        Bim2AxDriveOptions {
            axes,
            driver,
            encoder_axes: encoder.map_or_else(Vec::new, |encoder| encoder.axes.clone()),
            encoder_tolerance: encoder.and_then(|encoder| encoder.tolerance),
            ..Bim2AxDriveOptions::new()
        }
    }
}

/// The encoders of a module.
fn encoder(table: &dyn Keys, mode: DriveMode) -> Option<ModuleEncoder> {
    let numbers = table.integers("axes", &(1..=2), 2);
    if numbers.is_empty() {
        let message = "`axes` names none; [1], [2] or [1, 2] have an encoder".to_owned();
        table.complain("axes", message);
    }
    let has = |axis: &ModuleAxis| numbers.contains(&i64::from(axis.number()));
    let axes: Vec<_> = ModuleAxis::ALL.into_iter().filter(has).collect();
    let points = required_integer(table, "points_per_turn", 1..=65_535);
    let usual = FULL_STEPS.saturating_mul(mode.microsteps());
    let increments = table.integer("increments_per_turn", 1..=65_535).unwrap_or(usual.into());
    let tolerance = table.integer("tolerance_increments", 0..=MOST_TOLERANCE);
    table.finish();
    Some(ModuleEncoder {
        axes,
        points_per_turn: u16::try_from(points?).ok()?,
        increments_per_turn: u16::try_from(increments).ok()?,
        tolerance: tolerance.and_then(|tolerance| u32::try_from(tolerance).ok()),
    })
}

/// The axis of the module that a demand is for.
fn on_module(demand: &AxisDemand) -> Option<ModuleAxis> {
    ModuleAxis::ALL.get(demand.index).copied()
}

impl Device for Bim2AxEntry {
    fn family(&self) -> &'static dyn Family {
        &Bim2AxFamily
    }

    fn copied(&self) -> Box<dyn Device> {
        Box::new(self.clone())
    }

    /// Speeds are whole steps/s, at least the start-stop speed; a quarter of the largest is one, too.
    fn abilities(&self) -> Abilities {
        let unit = self.mode.speed_unit();
        Abilities {
            speeds: 4.0 * unit..=65_535.0 * unit,
            counts: f64::from(MOST_POSITION),
            start_stop: Some(f64::from(self.start_stop_speed) * unit),
        }
    }

    fn response_us(&self) -> u32 {
        self.order_us
    }

    fn expect_response_us(&mut self, response_us: u32) {
        self.order_us = response_us;
    }

    fn waits(&self, said: Option<Duration>) -> [Duration; 2] {
        let usual = Bim2AxOptions::default();
        [usual.deadline + said.unwrap_or_default(), usual.worst_latency]
    }

    fn map_offset(&self) -> Option<u64> {
        self.map_offset
    }

    fn open(
        &self,
        port: &str,
        axes: &[AxisDemand],
        [deadline, _]: [Duration; 2],
    ) -> Result<Box<dyn Drive>, DriveError> {
        let Self { byte_order, assumptions, map_offset, .. } = *self;
        let driver =
            Bim2AxOptions { byte_order, deadline, assumptions, ..Bim2AxOptions::default() };
        let options = self.drive_options(axes.iter().filter_map(on_module).collect(), driver);
        let failed = |source| {
            let port: Arc<str> = port.into();
            DriveError::Transport {
                at: Exchange { port, address: 0, action: Action::Open },
                source,
            }
        };
        let memory = OpenedMemory::alone(Path::new(port), map_offset).map_err(failed)?;
        Ok(Box::new(Bim2AxDrive::new(port, memory, &options)?))
    }

    fn emulate(
        &self,
        demands: &[AxisDemand],
        clock: DeviceClock,
    ) -> Result<Connected, ConnectError> {
        let assumptions = self.assumptions;
        let options = ModuleOptions { assumptions, ..ModuleOptions::default() };
        let mut eeprom = Eeprom::new(options.rating_ma);
        let mut surroundings = Surroundings::default();
        let mut axes = Vec::new();
        for demand in demands {
            let Some(on_module) = on_module(demand) else { continue };
            let settings = self.settings(demand);
            for (parameter, value) in [
                (AxisParameter::Coefficient, settings.coefficient.into()),
                (AxisParameter::Mode, settings.mode.code().into()),
                (AxisParameter::FastSpeed, settings.fast_speed.into()),
                (AxisParameter::StartStopSpeed, settings.start_stop_speed.into()),
                (AxisParameter::SoftPlus, settings.soft_plus.cast_unsigned()),
                (AxisParameter::SoftMinus, settings.soft_minus.cast_unsigned()),
                (AxisParameter::Acceleration, settings.acceleration.into()),
            ] {
                eeprom.set(Parameter::Axis(parameter, on_module), value);
            }
            let has = |encoder: &&ModuleEncoder| encoder.axes.contains(&on_module);
            if let Some(encoder) = self.encoder.as_ref().filter(has) {
                for (parameter, value) in [
                    (AxisParameter::Dividend, encoder.increments_per_turn),
                    (AxisParameter::Divisor, encoder.points_per_turn),
                    (AxisParameter::EncoderDefinition, definition::PRESENT),
                ] {
                    eeprom.set(Parameter::Axis(parameter, on_module), value.into());
                }
                if let Some(slot) = surroundings.encoders.get_mut(on_module.index()) {
                    *slot = Some(EncoderBench {
                        points_per_turn: encoder.points_per_turn.into(),
                        microsteps_per_turn: encoder.increments_per_turn.into(),
                        ..EncoderBench::default()
                    });
                }
            }
            axes.push(on_module);
        }
        let module = Module::new(&options, &eeprom, &surroundings);
        // It has been switched on before.
        let on_for_ns = options.boot_ns;
        let module = SharedModule::new(module, move || clock() + on_for_ns);
        let driver = Bim2AxOptions { assumptions, ..Bim2AxOptions::default() };
        let options = self.drive_options(axes, driver);
        let drive = Bim2AxDrive::new("module", module.clone(), &options)?;
        Ok((Box::new(module), Box::new(drive)))
    }

    fn prediction(&self, axes: &[AxisDemand]) -> Box<dyn Prediction> {
        let axes = axes.iter().map(|demand| self.settings(demand)).collect();
        let order_ns = i64::from(self.order_us) * 1000;
        let mut options = PredictionOptions { order_ns, ..PredictionOptions::new(axes) };
        // A look at counters is followed by one at encoders.
        options.read_ns *= if self.encoder.is_some() { 2 } else { 1 };
        Box::new(Bim2AxPrediction::new(&options))
    }
}

impl Emulator for SharedModule {
    fn place(&self) -> String {
        "memory of this process".to_owned()
    }
}
