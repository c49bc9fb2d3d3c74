//! A client and an emulated board on both ends of a pipe, in simulated time: unlock, move, read the counters.
//!
//! ```text
//! cargo run -p twin-interpcnc --example emulated_board
//! ```

use std::{error::Error, sync::Arc, time::Duration};
use tokio::{io::duplex, sync::mpsc, time::Instant};
use twin_interpcnc::emulator::{Board, BoardOptions, Wire, serve};
use twin_interpcnc::{AxisOptions, BoardAxis, InterpCnc, InterpCncOptions, MoveProfile};

/// The manual's profile of command 80.
const PROFILE: MoveProfile = MoveProfile {
    start_stop_hz: 200,
    acceleration_khz_per_s: 50,
    speed_hz: 20_000,
    deceleration_khz_per_s: 40,
    target: 20_000,
};

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
    let board = Board::new(&BoardOptions::default());
    let served =
        tokio::spawn(async move { serve(far, board, &Wire::default(), &clock, controlled).await });

    let options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
    let mut client = InterpCnc::attach(Arc::from("pipe"), near, &options);
    let (state, _) = client.state(&clock).await?;
    println!("locked: {}, X at {} steps", state.status.locked(), state.positions[0]);
    client.unlock(&clock).await?;

    let begun = Instant::now();
    client.move_axis(BoardAxis::X, &PROFILE, Duration::from_secs(10), &clock).await?;
    let took = begun.elapsed().as_secs_f64();
    let (state, stamp) = client.state(&clock).await?;
    println!("X at {} steps after {took:.3} s", state.positions[0]);
    println!("the last answer is known to {:.3} ms", milliseconds(stamp.uncertainty_ns));

    drop(control);
    let board = served.await??;
    println!("the board has answered {} requests", board.frames_handled());

    // 19800 steps/s up at 50000 and down at 40000 steps/s², 10100 steps/s in the mean; the rest at 20000 steps/s.
    let ramps = 19_800.0 / 50_000.0 + 19_800.0 / 40_000.0;
    let expected = ramps + (20_000.0 - 10_100.0 * ramps) / 20_000.0;
    if state.positions[0] != PROFILE.target || board.target(BoardAxis::X) != PROFILE.target {
        return Err(format!("X at {} steps", state.positions[0]).into());
    }
    // The client looks after every few milliseconds whether the axis rests.
    if !(expected..expected + 0.1).contains(&took) {
        return Err(format!("{took} s instead of {expected} s").into());
    }
    Ok(())
}

#[expect(clippy::cast_precision_loss, reason = "a few milliseconds")]
fn milliseconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-6
}
