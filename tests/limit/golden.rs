//! Solvers of `motion/planner/time_optimal` (time-optimal planning) against least times in closed form.

use crate::cases::{Case, all};
use crate::solvers::{Fineness, grid, passes, planned};

fn without_jerk() -> impl Iterator<Item = Case> {
    all().into_iter().filter(|case| !case.jerk)
}

/// The two passes lead to the closed forms as grids become finer. Limits at the ends of cells alone make them err by as
/// much as a cell is long: two grids tell where that leads.
#[test]
fn two_passes_lead_to_the_closed_forms() {
    for case in without_jerk() {
        let found = [4_000, 8_000].map(|cells| {
            let path = case.path(cells);
            let squared = passes(&grid(&path, false), case.ends);
            let most = path.acceleration_use(&squared);
            assert!(most <= 1.0 + 1e-9, "{}: {most} of an acceleration limit", case.name);
            path.duration(&squared)
        });
        let error = (2.0 * found[1] - found[0]) / case.duration - 1.0;
        assert!(error.abs() < 1e-6, "{}: {error:e}", case.name);
    }
}

/// Excess of the planner of whole programs over the least time of a case from rest to rest.
pub fn planner_error(case: &Case, fineness: Fineness) -> f64 {
    let path = case.path(2);
    let rates = |s: f64| (case.path)(vec![s]).rates.swap_remove(0);
    let found = planned(&path.limits, case.jerk, (case.end, path.feed), rates, fineness);
    let (duration, effort) = found.expect("a profile");
    assert_eq!(effort.failed, 0, "{}", case.name);
    duration / case.duration - 1.0
}

/// On its grid the planner errs by what a cell may at both ends of the path, and never to the fast side.
#[test]
fn planner_is_near_the_closed_forms_without_jerk() {
    for case in without_jerk().filter(Case::rests) {
        let error = planner_error(&case, Fineness::ordinary());
        println!("{:50} {error:+.1e}", case.name);
        assert!(error > -1e-6, "{}: {error:e}", case.name);
        assert!(error * case.duration < 3e-3, "{}: {error:e}", case.name);
    }
}

/// With jerk limits the planner comes nearer to the closed forms as its steps become shorter, and never to the fast side.
#[test]
fn planner_comes_to_the_closed_forms_with_jerk() {
    for case in all().into_iter().filter(|case| case.jerk && case.rests()) {
        let [coarse, fine] =
            [1.0, 2.0].map(|times| planner_error(&case, Fineness::ordinary().finer(times)));
        println!("{:50} {coarse:+.1e} {fine:+.1e}", case.name);
        assert!(fine > -1e-6 && fine < coarse, "{}: {coarse:e} {fine:e}", case.name);
        assert!(coarse * case.duration < 2e-3, "{}: {coarse:e}", case.name);
    }
}

/// On grids that are made finer where the jerk changes, the convex programs come to the closed forms with jerk.
#[test]
fn profiles_with_jerk_are_the_closed_forms() {
    for case in all().into_iter().filter(|case| case.jerk && case.rests()) {
        let error = crate::converge::duration(&case) / case.duration - 1.0;
        println!("{:50} {error:+.1e}", case.name);
        assert!(error.abs() < 1e-6, "{}: {error:e}", case.name);
    }
}
