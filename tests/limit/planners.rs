//! Planners of this project for the programs of `tests/data/linuxcnc_planner`, sampled every millisecond: the one file
//! of the comparison that depends on them.

use crate::differences::{Differences, Peak};
use crate::path::as_float;
use crate::programs::{
    ACCELERATION, ANGLE_TOLERANCE_DEG, Checked, JERK, Program, UNLIMITED, VELOCITY,
};
use twin_gcode::rs274::PathMode;
use twin_kinematics::AxisVector;
use twin_kinematics::gantry::Gantry3;
use twin_path::prepare::CheckError;
use twin_planner::blended_path::{BlendOptions, Order};
use twin_planner::controller::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};
use twin_planner::time_optimal::{AxisLimits, KinematicPath, LimitOptions};
use twin_planner::time_optimal::{Planned as Part, Planner as Limiter};

/// Servo cycle, s.
pub const CYCLE: f64 = 1e-3;

/// Result of a planner for a program.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Of the profile, s.
    pub duration: f64,
    /// Of X, Y and Z, from rest to rest.
    pub peaks: Vec<Peak>,
    /// Windows for which no profile was found at first.
    pub failed: u64,
}

/// Velocity and acceleration of every axis as LinuxCNC has them.
pub fn without_jerk(program: &Program) -> Result<Planned, String> {
    limited(program, None)
}

/// The same with [`JERK`].
pub fn with_jerk(program: &Program) -> Result<Planned, String> {
    limited(program, Some(JERK))
}

/// On a gantry whose axes are X, Y and Z, blended as the program says (G61, G64 P).
fn limited(program: &Program, jerk: Option<f64>) -> Result<Planned, String> {
    limited_each(program, [jerk; 3])
}

/// With a jerk limit of its own, or none, for each axis.
fn limited_each(program: &Program, jerks: [Option<f64>; 3]) -> Result<Planned, String> {
    let Checked { elements, mode } = program.checked(UNLIMITED);
    let tolerance = match mode {
        PathMode::Tolerance { path, .. } => path,
        // What a machine file has unless it says otherwise: exact to a micrometre.
        PathMode::ExactPath | PathMode::ExactStop | PathMode::Continuous => 1e-6,
    };
    let smooth = jerks.iter().any(Option::is_some);
    let order = if smooth { Order::Acceleration } else { Order::Velocity };
    let course = BlendOptions { order, ..BlendOptions::new(tolerance) };
    let options = LimitOptions { path_acceleration: false, ..LimitOptions::new(course) };
    let limits = jerks.map(|jerk| AxisLimits {
        velocity: VELOCITY,
        acceleration: ACCELERATION,
        deceleration: ACCELERATION,
        jerk,
    });
    let gantry = Gantry3::new([0.0; 3]).expect("a gantry");
    let axes = KinematicPath::new(gantry, limits.to_vec(), AxisVector::zeros(3));
    let elements = elements.into_iter().map(Ok::<_, CheckError>);
    let mut limiter = Limiter::new(elements, axes, options);
    let mut differences = Differences::new(CYCLE);
    let (mut before, mut samples, mut last) = (0.0, 0, None);
    for part in limiter.by_ref() {
        let part = part.map_err(|error| error.to_string())?;
        let Part::Leg(leg) = part else { continue };
        let end = before + leg.stretch.duration();
        while CYCLE * as_float(samples) <= end {
            let s = leg.from + leg.stretch.at(CYCLE * as_float(samples) - before).position;
            differences.push(leg.element.at(s).position.coords.as_slice());
            samples += 1;
        }
        before = end;
        last = Some(leg);
    }
    // Where the last cycle ends the axes stand.
    let last = last.expect("a path");
    let end = last.element.at(last.from + last.stretch.length());
    differences.push(end.position.coords.as_slice());
    let failed = limiter.effort().failed;
    Ok(Planned { duration: before, peaks: differences.peaks(), failed })
}

/// Feed and acceleration along the path, as controllers have it that know no axes: it stops at every turn and does not
/// know what a curve asks for.
fn path_alone(program: &Program) -> Result<Planned, String> {
    let checked = program.checked_within(ACCELERATION, ANGLE_TOLERANCE_DEG.to_radians());
    let elements = checked.elements.into_iter().map(Ok::<_, CheckError>);
    let mut interpolator = Interpolator::new(LookAhead::new(elements), DEFAULT_CYCLE_NS);
    let mut differences = Differences::new(CYCLE);
    for setpoint in interpolator.by_ref() {
        let setpoint = setpoint.map_err(|error| error.to_string())?;
        differences.push(setpoint.position.coords.as_slice());
    }
    Ok(Planned { duration: interpolator.duration(), peaks: differences.peaks(), failed: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programs::all;

    fn named(name: &str) -> Program {
        all().into_iter().find(|program| program.name == name).expect("a program")
    }

    /// Sides along X are trapezoids, those along Y have jerk phases of 20 ms as well.
    #[test]
    fn axes_without_a_jerk_limit_need_none() {
        let planned = limited_each(&named("square_g61"), [None, Some(JERK), Some(JERK)]);
        let planned = planned.expect("a profile");
        assert_eq!(planned.failed, 0);
        let least = 2.0 * (1.1 + 1.12);
        assert!(planned.duration > least * (1.0 - 1e-6), "{}", planned.duration);
        assert!(planned.duration < least * 1.005, "{}", planned.duration);
    }

    /// Within a tenth of LinuxCNC's cycle time, which asks its axes for up to 860,000 mm/s³.
    #[test]
    fn jerk_limits_cost_less_than_a_tenth() {
        for program in all() {
            let planned = with_jerk(&program).expect("a profile");
            let (name, ratio) = (program.name, planned.duration / program.duration);
            println!("{name}: {ratio:.4}, {:?}", planned.peaks);
            assert!(ratio < 1.1 && planned.failed == 0, "{name}: {ratio}");
            let most = crate::differences::largest(&planned.peaks);
            assert!(most.velocity <= 1.001 * VELOCITY, "{name}: {most:?}");
            assert!(most.acceleration <= 1.001 * ACCELERATION, "{name}: {most:?}");
            assert!(most.jerk <= 1.05 * JERK, "{name}: {most:?}");
        }
    }

    /// Without turns that are passed, the path's own limits are known to be kept: the square takes four trapezoids, and
    /// its axes are not asked for more than the path.
    #[test]
    fn a_square_is_four_trapezoids() {
        let square = all().into_iter().find(|program| program.name == "square_g61").expect("it");
        let planned = path_alone(&square).expect("a profile");
        let side = crate::seven_segments::trapezoid(0.1, 0.1, ACCELERATION);
        assert!((planned.duration - 4.0 * side).abs() < 2e-3, "{} s", planned.duration);
        let [x, y, z] = planned.peaks.as_slice() else { panic!("three axes") };
        for peak in [x, y] {
            assert!((peak.velocity - 0.1).abs() < 1e-9, "{peak:?}");
            assert!((peak.acceleration - ACCELERATION).abs() < 1e-6, "{peak:?}");
            // From full acceleration to none at once, in a cycle.
            assert!((0.5..1.001).contains(&(peak.jerk * CYCLE / ACCELERATION)), "{peak:?}");
        }
        assert_eq!(*z, Peak::default());
    }

    /// With the limits of the axes each side of the square is the motion of one axis over 100 mm from rest to rest.
    #[test]
    fn a_square_is_four_motions_of_one_axis() {
        let square = all().into_iter().find(|program| program.name == "square_g61").expect("it");
        let limits = crate::path::Limits { velocity: 0.1, acceleration: ACCELERATION, jerk: JERK };
        let (side, _) = crate::seven_segments::duration(0.1, limits);
        let with = with_jerk(&square).expect("a profile").duration / (4.0 * side) - 1.0;
        assert!((-1e-6..5e-3).contains(&with), "{with:e}");
        let side = crate::seven_segments::trapezoid(0.1, 0.1, ACCELERATION);
        let without = without_jerk(&square).expect("a profile").duration / (4.0 * side) - 1.0;
        assert!((-1e-6..1e-4).contains(&without), "{without:e}");
    }

    /// Where jerk is not limited, no program takes longer than LinuxCNC's planner.
    #[test]
    fn without_jerk_limits_programs_take_no_longer() {
        for program in all() {
            let planned = without_jerk(&program).expect("a profile");
            let ratio = planned.duration / program.duration;
            println!("{:20} {ratio:.4} times LinuxCNC's", program.name);
            assert!(ratio <= 1.0, "{}: {} s", program.name, planned.duration);
            assert_eq!(planned.failed, 0, "{}", program.name);
            let most = crate::differences::largest(&planned.peaks);
            assert!(most.velocity <= 1.001 * VELOCITY, "{}: {most:?}", program.name);
            assert!(most.acceleration <= 1.001 * ACCELERATION, "{}: {most:?}", program.name);
        }
    }
}
