//! Distances between parts: lower and upper bounds with as few measurements as possible.
//!
//! Between two poses a point moves no farther than shift and turn of its frame allow. A pair is therefore measured
//! again only when both parts together have moved as far as their known distance.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::geometry::{Shape, SharedShape};
use rapier3d_f64::math::Pose;
use rapier3d_f64::parry::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher,
    closest_points,
};
use twin_urdf::Model;

use crate::error::Result;
use crate::pairs::Pairs;
use crate::solids::{self, Placed};
use crate::surroundings::{Part, Surroundings};
use crate::{maths, penetration};

/// Distance of two parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// m; below 0 they are as deep in each other.
    pub distance: f64,
    /// The parts.
    pub parts: [Part; 2],
    /// The nearest point of each, m, machine frame.
    pub points: [Point3<f64>; 2],
}

/// Two points of two parts that are near to each other, or in each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Numbers of the parts.
    pub(super) parts: [usize; 2],
    /// The links in whose frames the points are.
    links: [usize; 2],
    /// Of each part, m.
    points: [Point3<f64>; 2],
    /// From the first part to the second, machine frame.
    normal: Vector3<f64>,
}

impl Near {
    /// Distance along the normal with the links at `poses`, m; below 0: penetration depth.
    pub(super) fn gap(&self, poses: &[Isometry3<f64>]) -> f64 {
        let [first, second] = self.places(poses);
        self.normal.dot(&(second - first))
    }

    /// Positions of the points, m, machine frame.
    pub(super) fn places(&self, poses: &[Isometry3<f64>]) -> [Point3<f64>; 2] {
        let at =
            |link: usize, point: &Point3<f64>| poses.get(link).map_or(*point, |pose| pose * point);
        let ([one, other], [first, second]) = (self.links, &self.points);
        [at(one, first), at(other, second)]
    }
}

/// The parts of a machine and its surroundings, with bounds of their distances.
#[derive(Clone, Debug)]
pub(super) struct Distances {
    parts: Vec<Measured>,
    pairs: Vec<Pair>,
    /// Upper bound of the distance each link has moved, m.
    gone: Vec<f64>,
    /// Largest distance of the solids of each link from its origin, m.
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
    /// Of the pairs that are `wanted` among the parts of `pairs`. A tool without a solid is only its tip.
    /// Errors: a flat mesh.
    pub(super) fn new(
        model: &Model,
        surroundings: &Surroundings,
        pairs: &Pairs,
        wanted: impl Fn([usize; 2]) -> bool,
    ) -> Result<Self> {
        let tool = solids::tool(model, surroundings);
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

    /// Records a motion of the links, and returns the largest displacement of any point, m.
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

    /// Largest displacement of any point between two sets of link poses, m.
    pub(super) fn way(&self, from: &[Isometry3<f64>], to: &[Isometry3<f64>]) -> f64 {
        let links = from.iter().zip(to).zip(&self.radii);
        links.map(|((from, to), radius)| maths::way(from, to, *radius)).fold(0.0, f64::max)
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

    /// Solids of each part in the frame of its link, with the number of that link.
    pub(super) fn solids(&self) -> impl Iterator<Item = (usize, &[Placed])> {
        self.parts.iter().map(|part| (part.link, part.solids.as_slice()))
    }

    /// Fills `near` with the pairs that may be within `reach` (m) with the links at `poses`, and a lower bound of
    /// their distance.
    pub(super) fn within(
        &mut self,
        reach: f64,
        poses: &[Isometry3<f64>],
        near: &mut Vec<([usize; 2], f64)>,
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
                near.push((pair.parts, least));
            }
            self.least = self.least.min(least);
        }
    }

    /// All pairs that are in each other with the links at `poses`.
    pub(super) fn overlapping(&self, poses: &[Isometry3<f64>]) -> Vec<[Part; 2]> {
        let found = self.pairs.iter().filter_map(|pair| self.measure(pair.parts, poses));
        found.filter(|found| found.distance < 0.0).map(|found| found.parts).collect()
    }

    /// Adds to `found` the contact points of two parts within `reach` (m) with the links at `poses`.
    ///
    /// No manifold is kept: parry would keep points while bodies slip by less than a millimetre, also past an edge.
    pub(super) fn contacts(
        &self,
        numbers: [usize; 2],
        reach: f64,
        poses: &[Isometry3<f64>],
        found: &mut Vec<Near>,
    ) {
        let [Some(one), Some(other)] = numbers.map(|number| self.parts.get(number)) else { return };
        let links = [one.link, other.link];
        let [Some(here), Some(there)] = links.map(|link| poses.get(link)) else { return };
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        for (a, b) in one.solids.iter().flat_map(|a| other.solids.iter().map(move |b| (a, b))) {
            let placed = [here * a.pose, there * b.pose].map(|pose| maths::pose_to_rapier(&pose));
            let from_one = placed[0].inv_mul(&placed[1]);
            manifolds.clear();
            let (dispatcher, mut workspace) = (DefaultQueryDispatcher, None);
            let (a_shape, b_shape) = (&*a.shape, &*b.shape);
            let _unsupported = dispatcher.contact_manifolds(
                &from_one,
                a_shape,
                b_shape,
                reach,
                &mut manifolds,
                &mut workspace,
            );
            let before = found.len();
            for manifold in &manifolds {
                let of = |part: Option<&Pose>| part.copied().unwrap_or_default();
                let in_one = maths::pose_to_rapier(&a.pose) * of(manifold.subshape_pos1());
                let in_other = maths::pose_to_rapier(&b.pose) * of(manifold.subshape_pos2());
                let normal = maths::vector_from_rapier(in_one.rotation * manifold.local_n1);
                let points = manifold.points.iter().map(|point| {
                    [in_one * point.local_p1, in_other * point.local_p2]
                        .map(|point| maths::vector_from_rapier(point).into())
                });
                let normal = here.rotation * normal;
                found.extend(points.map(|points| Near { parts: numbers, links, points, normal }));
            }
            // Boxes that meet with their corners have no faces to meet with.
            if found.len() == before
                && let Some(found_points) = nearest_points(&placed, [a_shape, b_shape])
                && let [first, second] = found_points.points
                && (second - first).norm() <= reach
            {
                let points = [here.inverse() * first, there.inverse() * second];
                let normal = found_points.normal;
                found.push(Near { parts: numbers, links, points, normal });
            }
        }
    }

    /// True if two parts overlap with the links at `poses`.
    pub(super) fn meet(&self, numbers: [usize; 2], poses: &[Isometry3<f64>]) -> bool {
        self.measure(numbers, poses).is_some_and(|found| found.distance < 0.0)
    }

    /// Distance of the parts `parts` with the links at `poses`; `None` if the pair is not measured.
    pub(super) fn between(&self, parts: [Part; 2], poses: &[Isometry3<f64>]) -> Option<f64> {
        let is_it = |pair: &&Pair| {
            let [one, other] = pair.parts.map(|number| self.parts.get(number).map(|it| it.part));
            let [first, second] = parts.map(Some);
            (one, other) == (first, second) || (other, one) == (first, second)
        };
        let pair = self.pairs.iter().find(is_it)?;
        self.measure(pair.parts, poses).map(|found| found.distance)
    }

    /// Adds to `found` all pairs that are nearer than `distance` (m) with the links at `poses`.
    pub(super) fn nearer_than(
        &mut self,
        distance: f64,
        poses: &[Isometry3<f64>],
        found: &mut Vec<Clearance>,
    ) {
        for index in 0..self.pairs.len() {
            let Some(pair) = self.pairs.get(index).copied() else { break };
            let gone = self.gone_by(&pair);
            if pair.known - (gone - pair.gone) >= distance {
                continue;
            }
            let Some(measured) = self.measure(pair.parts, poses) else { continue };
            if let Some(slot) = self.pairs.get_mut(index) {
                *slot = Pair { known: measured.distance, gone, ..pair };
            }
            found.extend((measured.distance < distance).then_some(measured));
        }
    }

    /// Distance of two parts; `None` if it cannot be measured.
    fn measure(&self, numbers: [usize; 2], poses: &[Isometry3<f64>]) -> Option<Clearance> {
        let [one, other] = numbers.map(|number| self.parts.get(number));
        let (one, other) = (one?, other?);
        let frame = |part: &Measured| poses.get(part.link).copied();
        let (here, there) = (frame(one)?, frame(other)?);
        let pairs = one.solids.iter().flat_map(|a| other.solids.iter().map(move |b| (a, b)));
        let found = pairs.filter_map(|(a, b)| {
            let placed = [here * a.pose, there * b.pose].map(|pose| maths::pose_to_rapier(&pose));
            let found = nearest_points(&placed, [&*a.shape, &*b.shape])?;
            // What is deepest of a large body may be far from where they are in each other.
            let half = found.normal * (-0.5 * found.distance);
            let points = found.inside.map_or(found.points, |at| [at + half, at - half]);
            Some(Clearance { distance: found.distance, parts: [one.part, other.part], points })
        });
        found.min_by(|one, other| one.distance.total_cmp(&other.distance))
    }
}

/// Nearest points of two shapes, machine frame.
struct Nearest {
    /// m; below 0 as deep in each other.
    distance: f64,
    points: [Point3<f64>; 2],
    /// From the first to the second.
    normal: Vector3<f64>,
    /// A point where they are in each other, if they are.
    inside: Option<Point3<f64>>,
}

/// Nearest points of two shapes; `None` for shapes that cannot be measured.
fn nearest_points([here, there]: &[Pose; 2], [one, other]: [&dyn Shape; 2]) -> Option<Nearest> {
    let point = |point| Point3::from(maths::vector_from_rapier(point));
    match closest_points(here, one, there, other, f64::MAX).ok()? {
        ClosestPoints::WithinMargin(first, second) => {
            let points = [point(first), point(second)];
            let way = points[1] - points[0];
            let normal = way.try_normalize(0.0).unwrap_or_else(Vector3::z);
            Some(Nearest { distance: way.norm(), points, normal, inside: None })
        }
        ClosestPoints::Disjoint => None,
        ClosestPoints::Intersecting => {
            let penetration::Penetration { depth, points, normal, middle } =
                penetration::of(here, one, there, other);
            Some(Nearest { distance: -depth, points, normal, inside: Some(middle) })
        }
    }
}
