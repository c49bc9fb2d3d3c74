//! Least time along a line within the limits of every axis, without and with limited jerk.
//!
//! ```text
//! cargo run -p twin-planner --example least_time
//! ```

use nalgebra::Point3;
use std::error::Error;
use twin_kinematics::AxisVector;
use twin_kinematics::gantry::Gantry3;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{ElementKind, PathElement, Place, Shape};
use twin_planner::blended_path::BlendOptions;
use twin_planner::time_optimal::{AxisLimits, KinematicPath, LimitOptions, Planned, Planner};

/// Way of the X axis, m. Y moves two thirds of it, so that X alone limits the motion.
const WAY: f64 = 0.3;
/// m/s.
const VELOCITY: f64 = 0.5;
/// m/s².
const ACCELERATION: f64 = 2.0;
/// m/s³.
const JERK: f64 = 40.0;

fn main() -> Result<(), Box<dyn Error>> {
    // s/v + v/a, and with limited jerk a/j more.
    let steps = WAY / VELOCITY + VELOCITY / ACCELERATION;
    for (jerk, expected) in [(None, steps), (Some(JERK), steps + ACCELERATION / JERK)] {
        let (duration, fastest) = plan(jerk)?;
        let limits = jerk.map_or("no limit of jerk".to_owned(), |jerk| format!("{jerk} m/s³"));
        println!("{limits}: {duration:.4} s, X at most {:.1} mm/s", fastest * 1e3);
        // The plan may lose time to the grid, and never gains any.
        if !(expected * 0.9999..expected * 1.003).contains(&duration) {
            return Err(format!("{duration} s instead of {expected} s").into());
        }
        if fastest > VELOCITY * 1.0001 {
            return Err(format!("X at {fastest} m/s is above {VELOCITY} m/s").into());
        }
    }
    Ok(())
}

/// Duration of the plan, s, and the largest velocity of X, m/s.
fn plan(jerk: Option<f64>) -> Result<(f64, f64), Box<dyn Error>> {
    let shape =
        Shape::Line { start: Point3::origin(), end: Point3::new(WAY, WAY * 2.0 / 3.0, 0.0) };
    let element = PathElement {
        // F and E of the program; the options below leave both out of account.
        feed: 1.0,
        acceleration: 1.0,
        deceleration: 1.0,
        ..PathElement::new(Place::at(1), ElementKind::Cut, shape)
    };
    let path = CheckVelocities::new(std::iter::once(Ok::<_, CheckError>(element)), 0.0);
    let limits = AxisLimits {
        velocity: VELOCITY,
        acceleration: ACCELERATION,
        deceleration: ACCELERATION,
        jerk,
    };
    let axes = KinematicPath::new(Gantry3::new([0.0; 3])?, vec![limits; 3], AxisVector::zeros(3));
    let options = LimitOptions {
        feed: false,
        path_acceleration: false,
        ..LimitOptions::new(BlendOptions::new(1e-6))
    };
    let (mut duration, mut fastest) = (0.0, 0.0_f64);
    for part in Planner::new(path, axes, options) {
        let Planned::Leg(leg) = part? else { continue };
        let time = leg.stretch.duration();
        for step in 0_u32..=8 {
            let progress = leg.stretch.at(time * f64::from(step) / 8.0);
            let tangent = leg.element.at(leg.from + progress.position).first;
            fastest = fastest.max((tangent.x * progress.velocity).abs());
        }
        duration += time;
    }
    Ok((duration, fastest))
}
