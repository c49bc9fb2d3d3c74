//! Who plans the programs of `tests/data/linuxcnc_planner` and is sampled every millisecond: the one file of the
//! comparison that knows them.

use crate::differences::{Differences, Peak};
use crate::programs::{ACCELERATION, Program};
use twin_motion::interpolate::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};
use twin_motion::prepare::CheckError;

/// Servo cycle, s.
pub const CYCLE: f64 = 1e-3;

/// What a planner makes of a program.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Of the profile, s.
    pub duration: f64,
    /// Of X, Y and Z, from rest to rest.
    pub peaks: Vec<Peak>,
}

/// One of them.
#[derive(Clone, Copy)]
pub struct Planner {
    pub name: &'static str,
    pub plan: fn(&Program) -> Planned,
}

/// All of them.
pub const PLANNERS: [Planner; 1] = [Planner { name: "path limits alone", plan: path_alone }];

/// Feed and acceleration along the path, as controllers have it that know no axes: it stops at every turn and does not
/// know what a curve asks for.
fn path_alone(program: &Program) -> Planned {
    let elements = program.checked(ACCELERATION).elements.into_iter().map(Ok::<_, CheckError>);
    let mut interpolator = Interpolator::new(LookAhead::new(elements), DEFAULT_CYCLE_NS);
    let mut differences = Differences::new(CYCLE);
    for setpoint in interpolator.by_ref() {
        differences.push(setpoint.expect("a path").position.coords.as_slice());
    }
    Planned { duration: interpolator.duration(), peaks: differences.peaks() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programs::all;

    /// Without turns that are passed, the path's own limits are known to be kept: the square takes four trapezoids, and
    /// its axes are not asked for more than the path.
    #[test]
    fn a_square_is_four_trapezoids() {
        let square = all().into_iter().find(|program| program.name == "square_g61").expect("it");
        let planned = path_alone(&square);
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
}
