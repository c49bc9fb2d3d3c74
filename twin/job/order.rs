//! In which order blocks are called: who moves a master comes before who moves its slaves.

use super::Call;

/// The numbers of `calls`, masters first, among `axes` axes.
///
/// # Errors
/// With an axis that follows itself by way of others.
pub(super) fn masters_first(calls: &[Call], axes: usize) -> Result<Vec<usize>, usize> {
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
    if let Some(axis) = depths.iter().position(|depth| *depth > axes) {
        return Err(axis);
    }
    let mut order: Vec<_> = (0..calls.len()).collect();
    // Of one axis, and of axes that stand alike, in the order of the file.
    order.sort_by_key(|index| {
        calls.get(*index).and_then(|call| depths.get(call.axis)).copied().unwrap_or_default()
    });
    Ok(order)
}
