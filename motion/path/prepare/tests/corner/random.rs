//! Properties of rounding and smoothing on random paths.

use super::marked;
use crate::prepare::tests::{Error, assert_continuous, random_path};
use crate::prepare::{Notices, RoundPath, Rounding, SmoothPath, Smoothing};
use crate::{Marks, PathElement};
use proptest::prelude::*;

/// No turn at either end of what has been inserted (it belongs to the block of the element before), in X and Y: heights
/// are linear along each piece.
fn tangent_where_inserted(path: &[PathElement]) {
    for triple in path.windows(3).filter(|triple| triple[0].place == triple[1].place) {
        for pair in triple.windows(2) {
            let [a, b] = [pair[0].end_tangent(), pair[1].start_tangent()]
                .map(|tangent| tangent.xy().normalize());
            assert!((a - b).norm() < 1e-9, "between {:?} and {:?}", pair[0], pair[1]);
        }
    }
}

fn ends(path: &[PathElement]) -> Option<(nalgebra::Point3<f64>, nalgebra::Point3<f64>)> {
    Some((path.first()?.start(), path.last()?.end()))
}

proptest! {
    #[test]
    fn rounded_paths_are_tangent(path in random_path(false), distance in 0.001..0.05) {
        let marks = marked(path.clone(), Marks::ROUNDING).into_iter().map(Ok::<_, Error>);
        let style = Rounding { distance, angle_tolerance: 1e-3 };
        let rounded: Vec<_> =
            RoundPath::new(marks, style, Notices::default()).map(Result::unwrap).collect();
        assert_continuous(&rounded);
        prop_assert_eq!(ends(&rounded), ends(&path));
        tangent_where_inserted(&rounded);
        // Nothing is longer than before.
        let length = |path: &[PathElement]| path.iter().map(PathElement::length).sum::<f64>();
        prop_assert!(length(&rounded) <= length(&path) + 1e-9);
    }

    #[test]
    fn smoothed_paths_are_tangent(path in random_path(true), distance in 0.001..0.05) {
        let marks = marked(path.clone(), Marks::SMOOTHING).into_iter().map(Ok::<_, Error>);
        let style = Smoothing { edge_distance: distance, angle_tolerance: 1e-3 };
        let smoothed: Vec<_> =
            SmoothPath::new(marks, style, Notices::default()).map(Result::unwrap).collect();
        assert_continuous(&smoothed);
        prop_assert_eq!(ends(&smoothed), ends(&path));
        tangent_where_inserted(&smoothed);
    }
}
