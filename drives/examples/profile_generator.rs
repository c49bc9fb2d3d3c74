//! Profile generator of a drive: a move, and a target given while the axis moves away from it.
//!
//! ```text
//! cargo run -p twin-drives --example profile_generator
//! ```

use std::error::Error;
use twin_drives::ramp::{Motion, Ramp, State};

/// 20000 steps/s and 40000 steps/s², without a start/stop speed.
const TO_PLUS: Ramp = Ramp {
    start_stop: 0.0,
    acceleration: 40_000.0,
    speed: 20_000.0,
    deceleration: 40_000.0,
    target: 30_000.0,
};

fn main() -> Result<(), Box<dyn Error>> {
    // s/v + v/a = 1.5 s + 0.5 s.
    let there = Motion::plan(0, State::default(), &TO_PLUS);
    println!("to 30000 steps: {} ms", there.end_ns() / 1_000_000);
    close("time of the move, ms", milliseconds(there.end_ns()), 2000.0)?;

    // After 1 s the axis is at 15000 steps. The new target 15000 lies where it is: it brakes (0.5 s, 5000 steps),
    // and returns over 5000 steps in 2 √(s/a) = 0.7071 s.
    let at = there.at(1_000_000_000);
    println!("after 1000 ms: {:.0} steps, {:.0} steps/s", at.position, at.velocity);
    close("position after 1 s, steps", at.position, 15_000.0)?;
    let back = Motion::plan(1_000_000_000, at, &Ramp { target: 15_000.0, ..TO_PLUS });
    let turn = back.at(1_500_000_000);
    println!(
        "turns at {:.0} steps, is back at {:.1} ms",
        turn.position,
        milliseconds(back.end_ns())
    );
    close("turning point, steps", turn.position, 20_000.0)?;
    let expected = 1500.0 + 2000.0 * (5000.0_f64 / 40_000.0).sqrt();
    close("time at the new target, ms", milliseconds(back.end_ns()), expected)?;
    Ok(())
}

#[expect(clippy::cast_precision_loss, reason = "a few seconds")]
fn milliseconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-6
}

fn close(what: &str, actual: f64, expected: f64) -> Result<(), String> {
    if (actual - expected).abs() <= 1e-5 {
        return Ok(());
    }
    Err(format!("{what}: {actual} instead of {expected}"))
}
