//! How far the machine is from what it must not touch.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::geometry::SharedShape;
use rapier3d_f64::parry::query::{ClosestPoints, closest_points, contact};
use twin_kinematics::AxisVector;
use twin_urdf::Model;

use super::dynamics::JointVector;
use super::equation::Equation;
use super::error::PhysicsError;
use super::pairs::Pairs;
use super::posed::Posed;
use super::solids::{self, Placed};
use super::surroundings::{Part, Surroundings};
use super::{checked, maths};

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

/// Looks for what is nearest, pose by pose along a way.
///
/// No pair is measured again as long as it cannot have come nearer than the nearest one: between two poses no point of a link goes
/// farther than its frame shifts and turns it.
#[derive(Clone, Debug)]
pub struct ClearanceScan {
    model: Model,
    axis_count: usize,
    posed: Posed,
    parts: Vec<Measured>,
    pairs: Vec<Pair>,
    /// How far each link has gone at most, m.
    gone: Vec<f64>,
    poses: Vec<Isometry3<f64>>,
    moved: Vec<Isometry3<f64>>,
    /// How far the solids of each link are from its origin at most, m.
    radii: Vec<f64>,
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

impl ClearanceScan {
    /// Of the links of `model`, which has so many machine axes, among `surroundings`.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model is none that can be simulated, and [`PhysicsError::FlatMesh`].
    pub fn new(
        model: &Model,
        axis_count: usize,
        surroundings: &Surroundings,
    ) -> Result<Self, PhysicsError> {
        Self::with(model, axis_count, surroundings, |pairs, [one, other]| {
            pairs.may_touch(one, other)
        })
    }

    /// Of the tool alone, among all that is around the machine: what a probe can find.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn of_tool(
        model: &Model,
        axis_count: usize,
        surroundings: &Surroundings,
    ) -> Result<Self, PhysicsError> {
        Self::with(model, axis_count, surroundings, |pairs, numbers| {
            let [one, other] = numbers.map(|number| pairs.part(number));
            one == Some(Part::Tool) && matches!(other, Some(Part::Obstacle(_)))
        })
    }

    fn with(
        model: &Model,
        axis_count: usize,
        surroundings: &Surroundings,
        wanted: impl Fn(&Pairs, [usize; 2]) -> bool,
    ) -> Result<Self, PhysicsError> {
        let equation = Equation::new(model, axis_count, Vector3::zeros(), JointVector::zeros())?;
        let posed = match &equation {
            Equation::Tree(_) => Posed::of_tree(axis_count),
            Equation::Tripod(tripod) => Posed::of_tripod(model, tripod),
        };
        let tool = solids::tool(model);
        // A tool that is nothing but its tip can be measured all the same.
        let numbers = Pairs::new(model, surroundings, true);
        let mut radii = vec![0.0; model.links.len()];
        let mut parts = Vec::with_capacity(numbers.parts().len());
        for (part, link) in numbers.parts() {
            let mut solids = solids::of_part(model, surroundings, *part, tool)?;
            if *part == Part::Tool && solids.is_empty() {
                let pose = Isometry3::from(model.tip.point.coords);
                solids.push(Placed { shape: SharedShape::ball(0.0), pose });
            }
            for solid in &solids {
                if let Some(radius) = radii.get_mut(*link) {
                    *radius = solid.reach().max(*radius);
                }
            }
            parts.push(Measured { part: *part, link: *link, solids });
        }
        let pairs =
            (0..parts.len()).flat_map(|one| (0..parts.len()).map(move |other| [one, other]));
        // Each pair once, but [tool, obstacle] as it is.
        let pairs = pairs.filter(|pair| pair[0] < pair[1] && wanted(&numbers, *pair));
        let is_bare = |number: &usize| parts.get(*number).is_none_or(|part| part.solids.is_empty());
        let pairs = pairs.filter(|pair| !pair.iter().any(is_bare));
        let pairs = pairs.map(|parts| Pair { parts, known: 0.0, gone: 0.0 });
        let pairs = pairs.collect();
        let poses = vec![Isometry3::identity(); model.links.len()];
        Ok(Self {
            model: model.clone(),
            axis_count,
            posed,
            pairs,
            parts,
            gone: vec![0.0; model.links.len()],
            moved: poses.clone(),
            poses,
            radii,
        })
    }

    /// Whether there is anything to be near to.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The two parts that are nearest to each other with the axes at `axes` (m or rad); `None` if nothing may touch anything.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`], [`PhysicsError::AxisCount`] and [`PhysicsError::Input`].
    pub fn nearest(&mut self, axes: &AxisVector) -> Result<Option<Clearance>, PhysicsError> {
        self.go(axes)?;
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
            let Some(found) = self.measure(pair.parts) else { continue };
            if let Some(slot) = self.pairs.get_mut(index) {
                *slot = Pair { known: found.distance, gone, ..pair };
            }
            if nearest.is_none_or(|nearest| found.distance < nearest.distance) {
                nearest = Some(found);
            }
        }
        Ok(nearest)
    }

    /// All pairs that are in each other with the axes at `axes` (m or rad).
    ///
    /// # Errors
    /// Those of [`Self::nearest`].
    pub fn overlapping(&mut self, axes: &AxisVector) -> Result<Vec<[Part; 2]>, PhysicsError> {
        self.go(axes)?;
        let found = self.pairs.iter().filter_map(|pair| self.measure(pair.parts));
        Ok(found.filter(|found| found.distance < 0.0).map(|found| found.parts).collect())
    }

    fn go(&mut self, axes: &AxisVector) -> Result<(), PhysicsError> {
        let position = checked(axes, self.axis_count, 0)?;
        self.posed.poses(&self.model, &position, &mut self.moved)?;
        let links = self.poses.iter().zip(&self.moved).zip(&self.radii);
        for (gone, ((from, to), radius)) in self.gone.iter_mut().zip(links) {
            *gone += maths::way(from, to, *radius);
        }
        std::mem::swap(&mut self.poses, &mut self.moved);
        Ok(())
    }

    fn gone_by(&self, pair: &Pair) -> f64 {
        let gone = |number: usize| {
            let part = self.parts.get(number)?;
            self.gone.get(part.link)
        };
        pair.parts.iter().filter_map(|number| gone(*number)).sum()
    }

    /// How far two parts are apart where the links are; `None` if that cannot be told.
    fn measure(&self, numbers: [usize; 2]) -> Option<Clearance> {
        let [one, other] = numbers.map(|number| self.parts.get(number));
        let (one, other) = (one?, other?);
        let frame = |part: &Measured| self.poses.get(part.link).copied();
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
