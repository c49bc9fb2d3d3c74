//! In which order axes are moved: a master before its slaves, so that these are where it is in the same cycle.

use super::Call;
use crate::ring;

/// The axes, masters first, each with the numbers of its calls in the order of the file; of `calls` among `axes` axes.
///
/// # Errors
/// With a ring of axes that follow each other, from master to slave.
pub(super) fn masters_first(
    calls: &[Call],
    axes: usize,
) -> Result<Vec<(usize, Vec<usize>)>, Vec<usize>> {
    let couplings = || calls.iter().filter_map(|call| Some((call.master?, call.axis)));
    // How many masters in a row an axis has above it; in a ring it grows beyond the number of axes.
    let mut depths = vec![0usize; axes];
    for _ in 0..=axes {
        for (master, slave) in couplings() {
            let above = depths.get(master).copied().unwrap_or_default() + 1;
            if let Some(depth) = depths.get_mut(slave) {
                *depth = above.max(*depth);
            }
        }
    }
    if depths.iter().any(|depth| *depth > axes) {
        return Err(ring::find(&couplings().collect::<Vec<_>>()).unwrap_or_default());
    }
    let mut sorted: Vec<_> = depths.into_iter().zip(0..).collect();
    sorted.sort_unstable();
    let of = |axis: usize| (0..).zip(calls).filter(move |(_, call)| call.axis == axis);
    Ok(sorted
        .into_iter()
        .map(|(_, axis)| (axis, of(axis).map(|(number, _)| number).collect()))
        .collect())
}
