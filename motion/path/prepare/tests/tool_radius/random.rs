//! Properties of the offset of random paths.

use super::{LEFT, RIGHT, contour, correct, gouges};
use crate::prepare::Notice;
use crate::prepare::planar::{Curve, distance};
use crate::prepare::tests::{cut, element, ends, numbered, random_path};
use crate::{Arc, ElementKind, PathElement, Shape};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::collections::HashSet;
use std::f64::consts::TAU;

/// Distance of a point of the path from an element of the contour in X and Y, m.
fn from_contour(path: &PathElement, part: f64, contour: &Curve) -> f64 {
    let point = path.at(part * path.length()).position.xy();
    distance(&Curve::Line { start: point, end: point }, contour)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Nowhere nearer to any element than the radius unless a gouge reports it, and exactly at the radius from its own element.
    #[test]
    fn the_tool_keeps_its_distance(
        path in random_path(false),
        side in prop::sample::select(vec![LEFT, RIGHT]),
        radius in 0.0005..0.03,
    ) {
        let (after, notices) = correct(contour(path.clone(), side, radius * 1e3));
        let reported: HashSet<_> = gouges(&notices).into_iter().map(|(lines, _)| lines).collect();
        let contours: Vec<_> = path
            .iter()
            .filter_map(|element| Some((element.place.line, Curve::of(&element.shape)?)))
            .collect();
        for element in after.iter().filter(|element| element.kind == ElementKind::Cut) {
            for (line, contour) in &contours {
                let own = *line == element.place.line;
                if reported.contains(&[element.place.line, *line]) {
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

    /// Numbers in whole micrometres leave turns between tangent neighbours and arcs with two radii: nothing is wrong or lost.
    #[test]
    fn programs_have_rounded_numbers(
        steps in prop::collection::vec((0.02..0.06, 0.02..0.05, 0.2..2.0, any::<bool>()), 1..6),
        side in prop::sample::select(vec![LEFT, RIGHT]),
    ) {
        let rounded = |point: Point3<f64>| point.map(|x| (x * 1e6).round() * 1e-6);
        let (mut at, mut heading) = (Point3::origin(), 0.0_f64);
        let mut path = Vec::new();
        for (way, radius, sweep, turns_left) in steps {
            let sweep: f64 = if turns_left { sweep } else { -sweep };
            let ahead = Vector3::new(heading.cos(), heading.sin(), 0.0);
            let joint = rounded(at + ahead * way);
            path.push(cut(at.into(), joint.into(), 0.05));
            // To the left or right of the direction.
            let radius: f64 = if turns_left { radius } else { -radius };
            let center = rounded(joint + Vector3::new(-ahead.y, ahead.x, 0.0) * radius);
            heading += sweep;
            let outward = Vector3::new(heading.sin(), -heading.cos(), 0.0);
            let end = rounded(center + outward * radius);
            let angle = |point: Point3<f64>| (point - center).y.atan2((point - center).x);
            let turned = (angle(end) - angle(joint)) * sweep.signum();
            let sweep = turned.rem_euclid(TAU) * sweep.signum();
            let bend = Arc::new(joint, end, center, sweep);
            path.push(element(ElementKind::Cut, Shape::Arc(bend), 0.05));
            at = end;
        }
        let path = numbered(path);
        let (after, notices) = correct(contour(path.clone(), side, 5.0));
        // Far away from itself the path may come near to itself.
        let unexpected = |notice: &&Notice| match notice {
            Notice::Gouge { place, damaged, .. } => place.line.abs_diff(damaged.line) <= 1,
            _ => true,
        };
        prop_assert_eq!(notices.iter().find(unexpected), None);
        let lines: HashSet<_> = after.iter().map(|element| element.place.line).collect();
        prop_assert_eq!(lines.len(), path.len());
    }

    #[test]
    fn the_path_never_breaks(path in random_path(true), side in prop::sample::select(vec![LEFT, RIGHT]), radius in 0.0..0.05) {
        let (after, _) = correct(contour(path.clone(), side, radius * 1e3));
        prop_assert_eq!(ends(&after), ends(&path));
    }
}
