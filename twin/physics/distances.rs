//! How far parts are from each other at most and at least, measured as rarely as can be.
//!
//! Between two poses no point of a link goes farther than its frame shifts and turns it. So a pair that was so far apart needs not be
//! measured again before both together have gone as far.

use nalgebra::{Isometry3, Point3};
use rapier3d_f64::geometry::SharedShape;
use rapier3d_f64::parry::query::{ClosestPoints, closest_points, contact};
use twin_urdf::Model;

use super::error::PhysicsError;
use super::maths;
use super::pairs::Pairs;
use super::solids::{self, Placed};
use super::surroundings::{Part, Surroundings};

/// How near two parts are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// m; below 0 they are as deep in each other.
    pub distance: f64,
    /// Which.
    pub parts: [Part; 2],
    /// The nearest point of each, m, machine frame.
    pub points: [Point3<f64>; 2],
}

/// The parts of a machine and of what is around it, and what is known of their distances.
#[derive(Clone, Debug)]
pub(super) struct Distances {
    parts: Vec<Measured>,
    pairs: Vec<Pair>,
    /// How far each link has gone at most, m.
    gone: Vec<f64>,
    /// How far the solids of each link are from its origin at most, m.
    radii: Vec<f64>,
    /// No pair is nearer than this, m.
    least: f64,
}

/// A part as it is measured.
#[derive(Clone, Debug)]
struct Measured {
    part: Part,
    link: usize,
    solids: Vec<Placed>,
}

/// Two parts, and what is known of them.
#[derive(Clone, Copy, Debug)]
struct Pair {
    parts: [usize; 2],
    /// Not nearer than this, m, when
    known: f64,
    /// both together had gone so far, m.
    gone: f64,
}

impl Distances {
    /// Of the pairs that are `wanted` among the parts of `pairs`. With `tip`, a machine without a tool has one that is nothing but its
    /// tip.
    ///
    /// # Errors
    /// [`PhysicsError::FlatMesh`].
    pub(super) fn new(
        model: &Model,
        surroundings: &Surroundings,
        pairs: &Pairs,
        wanted: impl Fn([usize; 2]) -> bool,
    ) -> Result<Self, PhysicsError> {
        let tool = solids::tool(model);
        let mut radii = vec![0.0; model.links.len()];
        let mut parts = Vec::with_capacity(pairs.parts().len());
        for (part, link) in pairs.parts() {
            let mut solids = solids::of_part(model, surroundings, *part, tool)?;
            if *part == Part::Tool && solids.is_empty() {
                let pose = Isometry3::from(model.tip.point.coords);
                solids.push(Placed { shape: SharedShape::ball(0.0), pose });
            }
            if let Some(radius) = radii.get_mut(*link) {
                *radius = solids.iter().map(Placed::reach).fold(*radius, f64::max);
            }
            parts.push(Measured { part: *part, link: *link, solids });
        }
        let solid = |number: &usize| parts.get(*number).is_some_and(|part| !part.solids.is_empty());
        let all = (0..parts.len()).flat_map(|one| (0..parts.len()).map(move |other| [one, other]));
        let pairs = all
            .filter(|[one, other]| one < other)
            .filter(|pair| pair.iter().all(solid) && wanted(*pair))
            .map(|parts| Pair { parts, known: f64::NEG_INFINITY, gone: 0.0 })
            .collect();
        let gone = vec![0.0; model.links.len()];
        Ok(Self { parts, pairs, gone, radii, least: f64::NEG_INFINITY })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Notes that the links have gone from one place to another, and tells how far any point went at most, m.
    pub(super) fn go(&mut self, from: &[Isometry3<f64>], to: &[Isometry3<f64>]) -> f64 {
        let mut farthest = 0.0_f64;
        let links = from.iter().zip(to).zip(&self.radii);
        for (gone, ((from, to), radius)) in self.gone.iter_mut().zip(links) {
            let way = maths::way(from, to, *radius);
            *gone += way;
            farthest = farthest.max(way);
        }
        self.least -= 2.0 * farthest;
        farthest
    }

    fn gone_by(&self, pair: &Pair) -> f64 {
        let gone = |number: usize| self.gone.get(self.parts.get(number)?.link);
        pair.parts.iter().filter_map(|number| gone(*number)).sum()
    }

    /// The two parts that are nearest to each other with the links at `poses`.
    pub(super) fn nearest(&mut self, poses: &[Isometry3<f64>]) -> Option<Clearance> {
        let mut nearest: Option<Clearance> = None;
        // What was near the last time leaves the fewest others to be measured.
        self.pairs.sort_by(|one, other| one.known.total_cmp(&other.known));
        for index in 0..self.pairs.len() {
            let Some(pair) = self.pairs.get(index).copied() else { break };
            let gone = self.gone_by(&pair);
            let least = pair.known - (gone - pair.gone);
            if nearest.is_some_and(|nearest| nearest.distance <= least) {
                continue;
            }
            let Some(found) = self.measure(pair.parts, poses) else { continue };
            if let Some(slot) = self.pairs.get_mut(index) {
                *slot = Pair { known: found.distance, gone, ..pair };
            }
            if nearest.is_none_or(|nearest| found.distance < nearest.distance) {
                nearest = Some(found);
            }
        }
        nearest
    }

    /// Fills `near` with the numbers of the parts that may be within `reach` (m) of each other with the links at `poses`.
    pub(super) fn within(
        &mut self,
        reach: f64,
        poses: &[Isometry3<f64>],
        near: &mut Vec<[usize; 2]>,
    ) {
        near.clear();
        if self.least > reach {
            return;
        }
        self.least = f64::INFINITY;
        for index in 0..self.pairs.len() {
            let Some(pair) = self.pairs.get(index).copied() else { break };
            let gone = self.gone_by(&pair);
            let mut least = pair.known - (gone - pair.gone);
            if least <= reach {
                // What cannot be measured is looked at.
                least = self.measure(pair.parts, poses).map_or(least, |found| found.distance);
                if let Some(slot) = self.pairs.get_mut(index) {
                    *slot = Pair { known: least, gone, ..pair };
                }
            }
            if least <= reach {
                near.push(pair.parts);
            }
            self.least = self.least.min(least);
        }
    }

    /// All pairs that are in each other with the links at `poses`.
    pub(super) fn overlapping(&self, poses: &[Isometry3<f64>]) -> Vec<[Part; 2]> {
        let found = self.pairs.iter().filter_map(|pair| self.measure(pair.parts, poses));
        found.filter(|found| found.distance < 0.0).map(|found| found.parts).collect()
    }

    /// How far two parts are apart; `None` if that cannot be told.
    fn measure(&self, numbers: [usize; 2], poses: &[Isometry3<f64>]) -> Option<Clearance> {
        let [one, other] = numbers.map(|number| self.parts.get(number));
        let (one, other) = (one?, other?);
        let frame = |part: &Measured| poses.get(part.link).copied();
        let (here, there) = (frame(one)?, frame(other)?);
        let pairs = one.solids.iter().flat_map(|a| other.solids.iter().map(move |b| (a, b)));
        let found = pairs.filter_map(|(a, b)| {
            let poses = [here * a.pose, there * b.pose].map(|pose| maths::pose_to_rapier(&pose));
            let [a_pose, b_pose] = &poses;
            let (distance, points) =
                match closest_points(a_pose, &*a.shape, b_pose, &*b.shape, f64::MAX).ok()? {
                    ClosestPoints::WithinMargin(a, b) => ((b - a).length(), [a, b]),
                    ClosestPoints::Disjoint => return None,
                    ClosestPoints::Intersecting => {
                        let deep = contact(a_pose, &*a.shape, b_pose, &*b.shape, 0.0).ok()??;
                        (deep.dist.min(0.0), [deep.point1, deep.point2])
                    }
                };
            let points = points.map(|point| maths::vector_from_rapier(point).into());
            Some(Clearance { distance, parts: [one.part, other.part], points })
        });
        found.min_by(|one, other| one.distance.total_cmp(&other.distance))
    }
}
