//! Where the master is on the cam when the slave is coupled: `MC_CamIn` refuses a place beyond it (error 626, manual 4.6.1).

use super::super::curve::Curve;

/// Rounding takes so many of the last digits at most.
const LAST: i32 = 16;

/// Offset and scaling of the master with which it is on the cam at `master`, to the last digit: those that are given but for
/// rounding, of which those that are `free` may be changed. What is farther off stays as it is.
pub(super) fn onto(
    curve: &Curve,
    master: f64,
    [offset, scaling]: [f64; 2],
    free: [bool; 2],
) -> (f64, f64) {
    let on_cam = |(offset, scaling): (f64, f64)| curve.contains(master * scaling + offset);
    let given = (offset, scaling);
    let size = (master * scaling).abs().max(curve.start().abs()).max(curve.end().abs());
    let digit = f64::EPSILON * size.max(offset.abs());
    let steps = (1..=LAST).flat_map(|step| [1.0, -1.0].map(|sign| sign * f64::from(step)));
    let beside = steps.flat_map(|step| {
        let by = step * digit;
        let of_offset = free[0].then_some((offset + by, scaling));
        let of_scaling = (free[1] && master != 0.0).then(|| (offset, scaling + by / master));
        [of_offset, of_scaling].into_iter().flatten()
    });
    [given].into_iter().chain(beside).find(|values| on_cam(*values)).unwrap_or(given)
}

#[cfg(test)]
mod tests {
    use super::super::super::knot::Knot;
    use super::{Curve, onto};

    /// Whatever rounding makes of an end of the cam, the master is on it, and hardly anything has changed.
    #[test]
    fn rounding_does_not_put_the_master_beside_the_cam() {
        let knots = [Knot::at_rest(0.1, 0.0), Knot::at_rest(360.3, 10.0)];
        let curve = Curve::polynomial(&knots).expect("a cam");
        let mut beside = 0;
        for index in 1..2000_u32 {
            let (master, scaling) =
                (0.37 * f64::from(index) - 200.0, 1.0 / (0.9 + f64::from(index)));
            for end in [curve.start(), curve.end()] {
                let offset = end - master * scaling;
                beside += usize::from(!curve.contains(master * scaling + offset));
                let (near, same) = onto(&curve, master, [offset, scaling], [true, false]);
                assert!(curve.contains(master * same + near) && (near - offset).abs() < 1e-12);
                let scaling = (end - 7.0) / master;
                let (same, near) = onto(&curve, master, [7.0, scaling], [false, true]);
                assert!(
                    curve.contains(master * near + same) && (near / scaling - 1.0).abs() < 1e-12
                );
            }
        }
        assert!(beside > 10, "{beside}: rounding is what this is about");
        // What is really beside it stays.
        assert_eq!(onto(&curve, 0.0, [-1.0, 1.0], [true, true]), (-1.0, 1.0));
    }
}
