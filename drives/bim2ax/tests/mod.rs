//! Driver and emulated module together, in virtual time and on a memory file.

#[path = "../../tests/common.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod common;
#[path = "../../tests/peer.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod peer;

mod assumptions;
mod drive;
mod driver;
mod encoders;
mod faults;
mod parameters;
mod vectors;
mod witness;

use std::time::Duration;

use tokio::time::{Instant, sleep};

use super::{
    Bim2Ax, Bim2AxOptions, Contact, ModuleAxis, SharedModule, Start,
    emulator::{Eeprom, Module, ModuleOptions, Surroundings},
};
use crate::protocol::{
    bits::coefficient,
    parameter::{AxisParameter, Parameter},
    vectors::{Log, Recorded},
    zone::Positions,
};

pub(super) const BOTH: [ModuleAxis; 2] = ModuleAxis::ALL;

/// The runtime's own clock, which virtual time moves.
pub(super) fn clock() -> impl Fn() -> i64 + Send + Sync + Copy {
    let zero = Instant::now();
    move || i64::try_from(zero.elapsed().as_nanos()).unwrap()
}

/// Writes bytes at offsets, in this order.
pub(super) fn write(module: &mut Module, bytes: &[(u8, u8)]) {
    for (offset, byte) in bytes {
        module.bus_write(*offset, *byte);
    }
}

/// Sets a parameter of an axis as if it had been stored before.
pub(super) fn set(eeprom: &mut Eeprom, axis: ModuleAxis, parameter: AxisParameter, value: i64) {
    let value = u32::try_from(value & 0xFFFF_FFFF).unwrap();
    eeprom.set(Parameter::Axis(parameter, axis), value);
}

/// Both axes: present, switches and cam that close, 1/64 steps with speeds in µsteps/s: 1000 start-stop,
/// 10000 fast, 20000 µsteps/s².
pub(super) fn eeprom() -> Eeprom {
    let mut eeprom = Eeprom::new(2000);
    let bits = coefficient::PRESENT | coefficient::CAM_CLOSES | coefficient::SWITCHES_CLOSE;
    for axis in BOTH {
        set(&mut eeprom, axis, AxisParameter::Coefficient, bits.into());
        set(&mut eeprom, axis, AxisParameter::Mode, 0x0060);
        set(&mut eeprom, axis, AxisParameter::StartStopSpeed, 1000);
        set(&mut eeprom, axis, AxisParameter::FastSpeed, 10_000);
        set(&mut eeprom, axis, AxisParameter::Acceleration, 20_000);
    }
    eeprom
}

/// Switches at ±3000 and a cam from −900 to −400 on both axes.
pub(super) fn surroundings() -> Surroundings {
    let mut surroundings = Surroundings::default();
    for bench in &mut surroundings.benches {
        bench.plus = Some(Contact::above(3000, true));
        bench.minus = Some(Contact::below(-3000, true));
        bench.cam = Some(Contact::between(-900, -400, true));
    }
    surroundings
}

pub(super) fn axis_1(parameter: AxisParameter) -> Parameter {
    Parameter::Axis(parameter, ModuleAxis::One)
}

/// A module that runs, its driver, and the record of what passes between them.
pub(super) struct Rig {
    pub(super) module: SharedModule,
    pub(super) driver: Bim2Ax,
    pub(super) log: Log,
}

impl Rig {
    pub(super) async fn new(
        module: &ModuleOptions,
        options: &Bim2AxOptions,
        eeprom: &Eeprom,
        surroundings: &Surroundings,
    ) -> Self {
        let module = SharedModule::new(Module::new(module, eeprom, surroundings), clock());
        let log = Log::default();
        let recorded = Recorded(module.clone(), log.clone());
        let mut driver = Bim2Ax::new("/dev/uio0", recorded, options);
        sleep(Duration::from_secs(1)).await;
        driver.identify(&|| 0).await.unwrap();
        log.take();
        Self { module, driver, log }
    }

    /// A module with these options, all else as usual.
    pub(super) async fn of(module: &ModuleOptions) -> Self {
        Self::new(module, &Bim2AxOptions::default(), &eeprom(), &surroundings()).await
    }

    /// With everything at its default and the switches above.
    pub(super) async fn usual() -> Self {
        Self::of(&ModuleOptions::default()).await
    }

    /// Sends the axes to these targets.
    pub(super) async fn start(&mut self, targets: [Option<i32>; 2]) {
        self.driver.start(targets.map(|to| to.map(Start::to)), &clock()).await.unwrap();
    }

    /// The state once both axes rest, within 5 s.
    pub(super) async fn rest(&mut self) -> Positions {
        self.driver.rested(seconds(5), &clock()).await.unwrap().0
    }

    /// Sends the axes to these targets and waits until they rest.
    pub(super) async fn go(&mut self, targets: [Option<i32>; 2]) -> Positions {
        self.start(targets).await;
        self.rest().await
    }

    pub(super) async fn seen(&mut self) -> Positions {
        self.driver.positions(&clock()).await.unwrap().0
    }

    pub(super) async fn points(&mut self) -> Positions {
        self.driver.encoder_points(&clock()).await.unwrap().0
    }

    pub(super) async fn steps(&mut self) -> Positions {
        self.driver.encoder_steps(&clock()).await.unwrap().0
    }

    pub(super) async fn get(&mut self, parameter: Parameter) -> u32 {
        self.driver.parameter(parameter, &clock()).await.unwrap()
    }

    /// Writes a parameter of axis 1.
    pub(super) async fn set(&mut self, parameter: AxisParameter, value: u32) {
        self.driver.set_parameter(axis_1(parameter), value, &clock()).await.unwrap();
    }

    /// Manual orders for both axes, as a host writes them into the zone "Ordre UC" (the driver gives none), and the time
    /// that the module needs for them.
    pub(super) async fn manual(&self, [one, two]: [u8; 2]) {
        let orders = [(0xFD, 7), (0, 1), (2, 0), (3, one), (4, 0), (5, two), (1, 1), (0x7F, 1)];
        write(&mut self.module.module(), &orders);
        sleep(Duration::from_millis(1)).await;
    }

    /// Changes what is connected.
    pub(super) fn rewire(&self, change: impl FnOnce(&mut Surroundings)) {
        let mut module = self.module.module();
        let mut surroundings = *module.surroundings();
        change(&mut surroundings);
        module.set_surroundings(&surroundings);
    }
}

pub(super) fn seconds(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}
