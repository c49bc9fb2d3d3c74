//! The solvers of `motion/limit` on paths whose least time is known in closed form.

use crate::cases::{Case, all};
use crate::solvers::{equal_times, grid, linear, passes, smooth, stretches};

#[test]
fn probe() {
    for case in all().into_iter().filter(|case| case.jerk) {
        let mut line = format!("{:50}", case.name);
        let mut path = case.path(300);
        for cells in [300, 300, 1000, 1000] {
            let g = grid(&path, true);
            let Some(p) = smooth(&g, 8) else { line += " failed"; break };
            let s = stretches(&g, &p);
            let d: f64 = s.iter().map(|s| s.duration()).sum();
            line += &format!(" {:+.1e}", d / case.duration - 1.0);
            path = (case.path)(equal_times(&g, &s, cells));
        }
        println!("{line}");
    }
    for case in all().into_iter().filter(|case| !case.jerk) {
        let path = case.path(1000);
        let g = grid(&path, false);
        let two = path.duration(&passes(&g, case.ends));
        let one = linear(&g, case.ends).map(|b| path.duration(&b));
        println!("{:50} passes {:+.1e} linear {:+.1e}", case.name, two / case.duration - 1.0, one.unwrap_or(f64::NAN) / two - 1.0);
    }
    let _ = |c: Case| c;
}
