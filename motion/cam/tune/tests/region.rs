//! Pairs of scaling and offset, in closed form.

use super::super::constrained::{Bound, Region};

/// Places at 50 and at 200 may move by 2 either way: 50 = m·s + o with |m − 50| ≤ 2 and 200 = m·s + o with |m − 200| ≤
/// 2. Over 150 the master goes 154 at most and 146 at least, so that the scaling lies between 150/154 and 150/146.
#[test]
fn two_places_hold_a_scaling() {
    let mut region = Region::default();
    for place in [50.0, 200.0] {
        let bound = Bound::Interval { end: place };
        region.between([place + 2.0, 1.0], [(place, bound), (f64::INFINITY, bound)]);
        region.between([place - 2.0, 1.0], [(f64::NEG_INFINITY, bound), (place, bound)]);
    }
    let [least, greatest] = region.scalings();
    assert!((least.value - 150.0 / 154.0).abs() < 1e-12, "{least:?}");
    assert!((greatest.value - 150.0 / 146.0).abs() < 1e-12, "{greatest:?}");
    assert!(least.by.iter().flatten().count() == 2, "{least:?}");
    // There the offset is one: 50 = 48·s + o.
    let [low, high] = region.offsets(least.value);
    let offset = 50.0 - 48.0 * 150.0 / 154.0;
    assert!((low.value - offset).abs() < 1e-9 && (high.value - offset).abs() < 1e-9);
}

#[test]
fn what_contradicts_leaves_nothing() {
    let mut region = Region::default();
    let bound = Bound::Interval { end: 4.0 };
    region.between([0.0, 1.0], [(3.0, bound), (4.0, bound)]);
    region.between([0.0, 1.0], [(5.0, Bound::Given), (6.0, bound)]);
    let [least, greatest] = region.scalings();
    assert!(least.value > greatest.value, "{least:?} {greatest:?}");
    assert!(least.by.contains(&Some(Bound::Given)), "{least:?}");
}
