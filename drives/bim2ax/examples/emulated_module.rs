//! A client and an emulated module that share a memory, in simulated time: identity, and a move of both axes.
//!
//! ```text
//! cargo run -p twin-bim2ax --example emulated_module
//! ```

use std::error::Error;
use std::time::Duration;
use tokio::time::{Instant, sleep};
use twin_bim2ax::emulator::{Eeprom, Module, ModuleOptions, Surroundings};
use twin_bim2ax::protocol::bits::coefficient;
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_bim2ax::{Bim2Ax, Bim2AxOptions, ModuleAxis, SharedModule, Start};

/// Targets of axes 1 and 2, µsteps.
const TARGETS: [i32; 2] = [10_000, -5000];

fn main() -> Result<(), Box<dyn Error>> {
    // Tokio's clock is paused: waiting takes no time, and the result does not depend on the computer.
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_time().start_paused(true).build()?;
    runtime.block_on(run())
}

async fn run() -> Result<(), Box<dyn Error>> {
    let zero = Instant::now();
    let clock = move || i64::try_from(zero.elapsed().as_nanos()).unwrap_or(i64::MAX);
    let module = Module::new(&ModuleOptions::default(), &eeprom(), &Surroundings::default());
    let module = SharedModule::new(module, clock);
    let mut client = Bim2Ax::new("memory", module, &Bim2AxOptions::default());
    // The module's software starts within half a second.
    sleep(Duration::from_secs(1)).await;
    let identity = client.identify(&clock).await?;
    println!("version {}, {} mA", identity.version, identity.rating_ma);

    let begun = Instant::now();
    client.start(TARGETS.map(|target| Some(Start::to(target))), &clock).await?;
    let (state, _) = client.rested(Duration::from_secs(10), &clock).await?;
    let took = begun.elapsed().as_secs_f64();
    println!("axes at {:?} µsteps after {took:.3} s", state.positions);

    // From 1000 to 10000 µsteps/s at 20000 µsteps/s² and back, 5500 µsteps/s in the mean; the rest at full speed.
    let ramps = 2.0 * 9000.0 / 20_000.0;
    let expected = ramps + (10_000.0 - 5500.0 * ramps) / 10_000.0;
    if state.positions != TARGETS {
        return Err(format!("{:?} instead of {TARGETS:?} µsteps", state.positions).into());
    }
    // The client looks after every few milliseconds whether the axes rest.
    if !(expected..expected + 0.1).contains(&took) {
        return Err(format!("{took} s instead of {expected} s").into());
    }
    Ok(())
}

/// Both axes with 64 µsteps per step: 1000 µsteps/s to start and stop, 10000 µsteps/s, 20000 µsteps/s².
fn eeprom() -> Eeprom {
    let mut eeprom = Eeprom::new(2000);
    // Contacts that close when they are reached; nothing is connected to them.
    let bits = coefficient::PRESENT | coefficient::CAM_CLOSES | coefficient::SWITCHES_CLOSE;
    for axis in ModuleAxis::ALL {
        let values = [
            (AxisParameter::Coefficient, bits.into()),
            (AxisParameter::Mode, 0x60),
            (AxisParameter::StartStopSpeed, 1000),
            (AxisParameter::FastSpeed, 10_000),
            (AxisParameter::Acceleration, 20_000),
        ];
        for (parameter, value) in values {
            eeprom.set(Parameter::Axis(parameter, axis), value);
        }
    }
    eeprom
}
