//! A lift as a cam: its curve, its peaks, and what the master may do under a limit of the slave.
//!
//! ```text
//! cargo run -p twin-cam --example lift
//! ```

use std::error::Error;
use twin_cam::{Compile, Factors, MasterMotion, SlaveLimits, Source};

/// Lift of the slave, mm.
const LIFT: f64 = 40.0;
/// Width of the rise on the master, degrees.
const WIDTH: f64 = 180.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut source = Source::new("lift");
    for (master, slave) in [(0.0, 0.0), (WIDTH, LIFT), (360.0, 0.0)] {
        source.insert_point(master, slave);
    }
    let cam = source.compile(Compile::Polynomial)?;
    let curve = cam.curve();
    println!("master   slave   slope");
    for master in [0.0, 45.0, 90.0, 135.0, 180.0, 270.0] {
        let at = curve.at(master);
        println!("{master:3} deg  {:6.3} mm  {:7.4} mm/deg", at.position, at.velocity + 0.0);
    }

    // Points at rest are joined by h (10w³ - 15w⁴ + 6w⁵) with w = x/b. Its derivatives are largest where
    // 15/8 h/b and 10/√3 h/b².
    let [slope, bend] = [15.0 / 8.0 * LIFT / WIDTH, 10.0 / 3.0_f64.sqrt() * LIFT / (WIDTH * WIDTH)];
    let extremes = curve.extremes();
    println!("largest slope: {:.6} mm/deg", extremes.velocity.magnitude());
    println!("largest second derivative: {:.6} mm/deg²", extremes.acceleration.magnitude());
    close("slope, mm/deg", extremes.velocity.magnitude(), slope)?;
    close("second derivative, mm/deg²", extremes.acceleration.magnitude(), bend)?;

    // At a constant velocity of the master the slave's acceleration is bend · velocity².
    let limits = SlaveLimits { acceleration: 5000.0, ..SlaveLimits::NONE };
    let steady = MasterMotion { velocity: 0.0, acceleration: 0.0, jerk: 0.0 };
    let largest = curve.largest_master_velocity(&limits, &steady, Factors::default(), true)?;
    println!("master at 5000 mm/s² of the slave: at most {:.2} deg/s", largest.value);
    close("velocity of the master, deg/s", largest.value, (5000.0 / bend).sqrt())?;

    // Where the master starts from rest, the slave's acceleration is slope · acceleration.
    let largest = curve.largest_master_acceleration(&limits, &steady, Factors::default(), true)?;
    println!("master from rest: at most {:.1} deg/s²", largest.value);
    close("acceleration of the master, deg/s²", largest.value, 5000.0 / slope)?;
    Ok(())
}

fn close(what: &str, actual: f64, expected: f64) -> Result<(), String> {
    if (actual - expected).abs() <= 1e-6 * expected.abs() {
        return Ok(());
    }
    Err(format!("{what}: {actual} instead of {expected}"))
}
