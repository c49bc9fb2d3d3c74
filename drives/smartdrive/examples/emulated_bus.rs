//! A client and an emulated step drive on both ends of a pipe, in simulated time: remote mode, a move, its state.
//!
//! ```text
//! cargo run -p twin-smartdrive --example emulated_bus
//! ```

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::duplex;
use tokio::sync::mpsc;
use tokio::time::Instant;
use twin_smartdrive::emulator::{Device, DeviceOptions, Wire, serve};
use twin_smartdrive::{AxisOptions, Mode, SmartDrive, SmartDriveOptions, StepsPerTurn};

/// Two turns, µsteps.
const TARGET: i32 = 6400;
/// rpm and rpm/s.
const PROFILE: (u16, u16) = (300, 1000);

fn main() -> Result<(), Box<dyn Error>> {
    // Tokio's clock is paused: waiting takes no time, and the result does not depend on the computer.
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_time().start_paused(true).build()?;
    runtime.block_on(run())
}

async fn run() -> Result<(), Box<dyn Error>> {
    let zero = Instant::now();
    let clock = move || i64::try_from(zero.elapsed().as_nanos()).unwrap_or(i64::MAX);
    let (near, far) = duplex(4096);
    let (control, controlled) = mpsc::channel(1);
    let devices = vec![Device::new(&DeviceOptions::default())];
    let served =
        tokio::spawn(
            async move { serve(far, devices, &Wire::default(), &clock, controlled).await },
        );

    let turn = StepsPerTurn::new(200, 16).ok_or("200 full steps of 16 µsteps")?;
    let axis = AxisOptions {
        address: 1,
        turn,
        velocity_rpm: 500,
        acceleration_rpm_per_s: 2000,
        deceleration_rpm_per_s: 0,
    };
    let mut client =
        SmartDrive::attach(Arc::from("pipe"), near, &SmartDriveOptions::new(vec![axis]));
    client.set_mode(1, Some(Mode::Remote)).await?;
    let begun = Instant::now();
    client.travel(1, TARGET, Some(PROFILE), Duration::from_secs(10)).await?;
    let took = begun.elapsed().as_secs_f64();
    let (state, _) = client.state(1, &clock).await?;
    println!(
        "address 1: {} µsteps, {:.1} degrees, after {took:.3} s",
        state.position,
        turn.degrees(f64::from(state.position))
    );
    drop(control);
    served.await??;

    // s/v + v/a with 16000 µsteps/s and 53333 µsteps/s².
    let [velocity, acceleration] = [300.0, 1000.0].map(|rpm| turn.steps(rpm));
    let expected = f64::from(TARGET) / velocity + velocity / acceleration;
    if state.position != TARGET {
        return Err(format!("{} µsteps instead of {TARGET}", state.position).into());
    }
    // The client looks after every few milliseconds whether the axis rests.
    if !(expected..expected + 0.1).contains(&took) {
        return Err(format!("{took} s instead of {expected} s").into());
    }
    Ok(())
}
