//! Properties of the offset of random paths.

use super::{LEFT, RIGHT, contour, correct};
use crate::path::{ElementKind, PathElement};
use crate::prepare::planar::{Curve, distance};
use crate::prepare::tests::{Error, random_path};
use crate::prepare::{Notice, Notices, ToolRadius, ToolRadiusOptions};
use proptest::prelude::*;
use std::collections::HashSet;

/// Distance of a point of the path from an element of the contour in X and Y, m.
fn from_contour(path: &PathElement, part: f64, contour: &Curve) -> f64 {
    let point = path.at(part * path.length()).position.xy();
    distance(&Curve::Line { start: point, end: point }, contour)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Nowhere nearer to any element than the radius unless a gouge tells it, and beside its own element exactly.
    #[test]
    fn the_tool_keeps_its_distance(
        path in random_path(false),
        left in any::<bool>(),
        radius in 0.0005..0.03,
    ) {
        let side = if left { LEFT } else { RIGHT };
        let (after, notices) =
            correct(contour(path.clone(), side, radius * 1e3), ToolRadiusOptions::default());
        let told: HashSet<_> = notices
            .iter()
            .filter_map(|notice| match notice {
                Notice::Gouge { place, damaged, .. } => Some((place.line, damaged.line)),
                _ => None,
            })
            .collect();
        let contours: Vec<_> = path
            .iter()
            .filter_map(|element| Some((element.place.line, Curve::of(&element.shape)?)))
            .collect();
        for element in after.iter().filter(|element| element.kind == ElementKind::Cut) {
            for (line, contour) in &contours {
                let own = *line == element.place.line;
                if told.contains(&(element.place.line, *line)) {
                    continue;
                }
                for part in [0.0, 0.1, 0.25, 0.5, 0.8, 1.0] {
                    let distance = from_contour(element, part, contour);
                    prop_assert!(distance >= radius - 1e-9, "{distance} {line} {element:?}");
                    prop_assert!(!own || distance <= radius + 1e-9, "{distance} {element:?}");
                }
            }
        }
    }

    #[test]
    fn without_marks_it_is_the_identity(path in random_path(true)) {
        let items: Vec<_> = path.into_iter().map(Ok::<_, Error>).collect();
        let options = ToolRadiusOptions { radius: 0.01, ..ToolRadiusOptions::default() };
        let same: Vec<_> =
            ToolRadius::new(items.clone().into_iter(), options, Notices::default()).collect();
        prop_assert_eq!(same, items);
    }

    /// Also with curves the path never breaks, and its ends are those of the contour.
    #[test]
    fn the_path_never_breaks(path in random_path(true), left in any::<bool>(), radius in 0.0..0.05) {
        let side = if left { LEFT } else { RIGHT };
        let (after, _) =
            correct(contour(path.clone(), side, radius * 1e3), ToolRadiusOptions::default());
        let ends = |path: &[PathElement]| {
            path.first().map(PathElement::start).zip(path.last().map(PathElement::end))
        };
        prop_assert_eq!(ends(&after), ends(&path));
    }
}
