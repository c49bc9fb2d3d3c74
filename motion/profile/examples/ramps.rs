//! Duration and peaks of one move with the two ramps whose duration is a closed form.
//!
//! ```text
//! cargo run -p twin-profile --example ramps
//! ```

use twin_profile::{AxisLimits, Profile, ProfileError, RampType, State};

/// Way of the move, mm.
const WAY: f64 = 200.0;
/// Limits in mm and s.
const LIMITS: AxisLimits =
    AxisLimits { velocity: 250.0, acceleration: 1000.0, deceleration: 1000.0, jerk: 10_000.0 };

fn main() -> Result<(), ProfileError> {
    // s/v + v/a, and with limited jerk a/j more.
    let steps = WAY / LIMITS.velocity + LIMITS.velocity / LIMITS.acceleration;
    let smooth = steps + LIMITS.acceleration / LIMITS.jerk;
    for (ramp, expected) in [(RampType::Trapezoid, steps), (RampType::Parabolic, smooth)] {
        let profile = Profile::to_position(State::resting(0.0), WAY, 0.0, LIMITS, ramp)?;
        let duration = profile.duration();
        let middle = profile.at(duration / 2.0);
        println!(
            "{ramp:?}: {WAY} mm in {duration:.3} s, {:.1} mm/s in the middle",
            middle.velocity
        );
        close("duration, s", duration, expected);
        close("velocity in the middle, mm/s", middle.velocity, LIMITS.velocity);
        close("position in the middle, mm", middle.position, WAY / 2.0);
    }

    // A halt from 250 mm/s takes v/a and v²/2a.
    let moving = State { position: 0.0, velocity: 250.0, acceleration: 0.0 };
    let halt = Profile::halt(moving, LIMITS, RampType::Trapezoid)?;
    let way = halt.at(halt.duration()).position;
    println!("halt from 250 mm/s: {:.3} s, {way:.2} mm", halt.duration());
    close("time of the halt, s", halt.duration(), 0.25);
    close("way of the halt, mm", way, 31.25);
    Ok(())
}

fn close(what: &str, actual: f64, expected: f64) {
    let near = (actual - expected).abs() <= 1e-9 * expected.abs().max(1.0);
    assert!(near, "{what}: {actual} instead of {expected}");
}
