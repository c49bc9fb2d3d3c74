//! A program to set-points: decoder, preparation, the controller's plan, and the axes of a SCARA.
//!
//! ```text
//! cargo run -p twin-planner --example program_to_setpoints
//! ```

use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::io::Cursor;
use twin_gcode::din66025::{Decoder, DecoderOptions, Item};
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::{AxisVector, Kinematics, Pose, ToolMotion};
use twin_path::Marks;
use twin_path::prepare::{Notices, Preparation};
use twin_planner::controller::{DEFAULT_CYCLE_NS, Interpolator, LookAhead, ToolSetpoint};

/// 100 mm along x, and a quarter circle of radius 100 mm about (200, 100) mm, at 100 mm/s and 1000 mm/s².
const PROGRAM: &str = "% line and arc\n\
N10 G1 X300 Y100 F100 E1000 E-1000\n\
N20 G3 X200 Y200 I-100 J0\n";
/// Position before the program, m.
const START: [f64; 3] = [0.2, 0.1, 0.0];
/// Turns of the path up to this are passed without a stop, rad.
const ANGLE_TOLERANCE: f64 = 0.1;

type Fault = Box<dyn Error>;

fn main() -> Result<(), Fault> {
    let options = DecoderOptions { start: START, ..DecoderOptions::default() };
    let items = Decoder::with_jumps(Cursor::new(PROGRAM), options);
    let elements = items.map(|item| match item? {
        Item::Element(element) => Ok::<_, Fault>(element),
        Item::Warning(warning) => Err(warning.to_string().into()),
    });
    let stages = Preparation::for_marks(Marks::default());
    let path = stages.check(elements, ANGLE_TOLERANCE, &Notices::default());
    let mut interpolator = Interpolator::new(LookAhead::new(path), DEFAULT_CYCLE_NS);

    let scara = Scara2::new([0.25, 0.2], [0.0, 0.0], Elbow::Low)?;
    let mut axes = AxisVector::zeros(2);
    let (mut count, mut fastest, mut fastest_axes) = (0_u32, 0.0_f64, [0.0_f64; 2]);
    for setpoint in interpolator.by_ref() {
        let setpoint = setpoint?;
        let motion = scara.inverse_motion(&tool(&setpoint), &axes)?;
        axes = motion.position;
        if count.is_multiple_of(500) {
            let [a, b] = *axes else { return Err("two axes expected".into()) };
            println!(
                "{:.3} s, {}: ({:.3}, {:.3}) mm, A {:.3} degrees, B {:.3} degrees",
                f64::from(count) * 1e-3,
                setpoint.place,
                setpoint.position.x * 1e3,
                setpoint.position.y * 1e3,
                a.to_degrees(),
                b.to_degrees()
            );
        }
        // On the arc the tool keeps its distance from the centre.
        if setpoint.place.block == Some(20) {
            let radius = (setpoint.position.x - 0.2).hypot(setpoint.position.y - 0.1);
            close("radius, m", radius, 0.1, 1e-9)?;
        }
        fastest = fastest.max(setpoint.path_velocity);
        for (peak, velocity) in fastest_axes.iter_mut().zip(&*motion.velocity) {
            *peak = peak.max(velocity.abs());
        }
        count += 1;
    }

    let [a, b] = fastest_axes.map(f64::to_degrees);
    let duration = interpolator.duration();
    println!("{count} set-points, {duration:.4} s, path at most {:.3} mm/s", fastest * 1e3);
    println!("largest velocity: A {a:.3} degrees/s, B {b:.3} degrees/s");
    // The corner is a right angle, so the path stops there: s/v + v/a for either element.
    let expected = (0.1 + 0.1 * FRAC_PI_2) / 0.1 + 2.0 * 0.1 / 1.0;
    close("duration, s", duration, expected, 1e-6)?;
    close("velocity, m/s", fastest, 0.1, 1e-9)?;
    let end = scara.forward(&axes)?.position;
    close("end in x, m", end.x, 0.2, 1e-9)?;
    close("end in y, m", end.y, 0.2, 1e-9)?;
    Ok(())
}

fn tool(setpoint: &ToolSetpoint) -> ToolMotion {
    ToolMotion {
        velocity: setpoint.velocity,
        acceleration: setpoint.acceleration,
        ..ToolMotion::at_rest(Pose { position: setpoint.position, direction: 0.0 })
    }
}

fn close(what: &str, actual: f64, expected: f64, tolerance: f64) -> Result<(), String> {
    if (actual - expected).abs() <= tolerance {
        return Ok(());
    }
    Err(format!("{what}: {actual} instead of {expected}"))
}
