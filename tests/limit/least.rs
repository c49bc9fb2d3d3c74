//! How near the planner of whole programs comes to the least time with limited jerk, where no closed form is known: to what its own
//! convex programs come to on grids four times as fine with all of the path in one window, which errs by a sixteenth as much.

use crate::machines::all;
use crate::solvers::{Fineness, planned};

/// Splines have most changes of jerk. The long rosette of the benchmark, which is planned in several windows, is not among them: it
/// loses more at their seams.
#[test]
fn jerk_limited_profiles_are_near_the_least_time() {
    for (machine, curve) in [("gantry_h2", "spiral"), ("scara2", "spline"), ("tripod", "spline")] {
        let machines = all();
        let machine = machines.iter().find(|other| other.name == machine).expect("a machine");
        let curve = machine.curves.iter().find(|other| other.name == curve).expect("a curve");
        let (path, rates) = (machine.path(curve, 10), machine.rates(curve));
        let duration = |fineness| {
            let extent = (path.nodes[path.cells()], path.feed);
            let (duration, effort) =
                planned(&path.limits, true, extent, &rates, fineness).expect("a profile");
            assert_eq!(effort.failed, 0);
            duration
        };
        let fineness = Fineness::ordinary();
        let longer = duration(fineness) / duration(fineness.finer(4.0).whole()) - 1.0;
        println!("{} {}: {longer:+.1e}", machine.name, curve.name);
        assert!(longer.abs() <= 1e-4, "{} {}: {longer:e}", machine.name, curve.name);
    }
}
