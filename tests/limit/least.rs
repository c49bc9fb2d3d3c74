//! Least time with limited jerk where no closed form exists. The planner of whole programs is compared with its own
//! convex programs on grids four times as fine with all of the path in one window, whose error is a sixteenth.

use crate::curves::Curve;
use crate::machines::{Machine, all, long};
use crate::solvers::{Fineness, planned};

/// Splines have most changes of jerk.
#[test]
fn jerk_limited_profiles_are_near_the_least_time() {
    for (machine, curve) in [("gantry_h2", "spiral"), ("scara2", "spline"), ("tripod", "spline")] {
        let machines = all();
        let machine = machines.iter().find(|other| other.name == machine).expect("a machine");
        let curve = machine.curves.iter().find(|other| other.name == curve).expect("a curve");
        is_near_the_least_time(machine, curve, 1);
    }
}

/// A path in many windows, none of which changes what was planned before for the worse.
#[test]
fn nothing_is_lost_at_the_seams_of_windows() {
    let (machine, curve) = long();
    is_near_the_least_time(&machine, &curve, 5);
}

fn is_near_the_least_time(machine: &Machine, curve: &Curve, windows: u64) {
    let (path, rates) = (machine.path(curve, 10), machine.rates(curve));
    let plan = |fineness| {
        let extent = (path.nodes[path.cells()], path.feed);
        let (duration, effort) =
            planned(&path.limits, true, extent, &rates, fineness).expect("a profile");
        assert_eq!((effort.failed, effort.exceeded), (0, 0));
        (duration, effort.windows)
    };
    let fineness = Fineness::ordinary();
    let (duration, planned_in) = plan(fineness);
    assert!(planned_in >= windows, "{planned_in} windows");
    let longer = duration / plan(fineness.finer(4.0).whole()).0 - 1.0;
    println!("{} {}: {longer:+.1e}", machine.name, curve.name);
    assert!(longer.abs() <= 1e-4, "{} {}: {longer:e}", machine.name, curve.name);
}
