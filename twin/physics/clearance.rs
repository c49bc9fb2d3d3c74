//! Clearance scan: distance of the machine from its surroundings and of its links from each other.

use nalgebra::{Isometry3, Vector3};
use twin_kinematics::AxisVector;
use twin_urdf::Model;

use crate::checked;
use crate::distances::{Clearance, Distances};
use crate::equation::Equation;
use crate::error::Result;
use crate::joint::JointVector;
use crate::pairs::Pairs;
use crate::posed::Posed;
use crate::surroundings::{Part, Surroundings};

/// Search for the nearest pair of parts, pose by pose along a way.
#[derive(Clone, Debug)]
pub struct ClearanceScan {
    model: Model,
    axis_count: usize,
    posed: Posed,
    distances: Distances,
    poses: Vec<Isometry3<f64>>,
    moved: Vec<Isometry3<f64>>,
}

impl ClearanceScan {
    /// Scan of the links of `model`, moved by its machine axes, among `surroundings`.
    ///
    /// # Errors
    /// An error if the model cannot be simulated, and [`FlatMesh`](crate::PhysicsError::FlatMesh).
    pub fn new(model: &Model, axis_count: usize, surroundings: &Surroundings) -> Result<Self> {
        Self::with(model, axis_count, surroundings, |pairs, [one, other]| {
            pairs.may_touch(one, other)
        })
    }

    /// Scan of the tool alone among all obstacles, stock included: the surfaces that a probe can find.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn of_tool(model: &Model, axis_count: usize, surroundings: &Surroundings) -> Result<Self> {
        Self::with(model, axis_count, surroundings, |pairs, numbers| {
            meets_tool(pairs, numbers, surroundings)
        })
    }

    /// Scan of all pairs, and of the tool and the stock, for motion that must not cut.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn without_cuts(
        model: &Model,
        axis_count: usize,
        surroundings: &Surroundings,
    ) -> Result<Self> {
        Self::with(model, axis_count, surroundings, |pairs, [one, other]| {
            pairs.may_touch(one, other) || meets_tool(pairs, [one, other], surroundings)
        })
    }

    fn with(
        model: &Model,
        axis_count: usize,
        surroundings: &Surroundings,
        wanted: impl Fn(&Pairs, [usize; 2]) -> bool,
    ) -> Result<Self> {
        let equation = Equation::new(model, axis_count, Vector3::zeros(), JointVector::zeros())?;
        // A tool that is only its tip is measured as well.
        let pairs = Pairs::new(model, surroundings, true);
        let distances = Distances::new(model, surroundings, &pairs, |pair| wanted(&pairs, pair))?;
        let poses = vec![Isometry3::identity(); model.links.len()];
        Ok(Self {
            model: model.clone(),
            axis_count,
            posed: Posed::of(model, &equation),
            distances,
            moved: poses.clone(),
            poses,
        })
    }

    /// True without a pair of parts to measure.
    pub fn is_empty(&self) -> bool {
        self.distances.is_empty()
    }

    /// The two nearest parts with the axes at `axes` (m or rad); `None` without a pair that may touch.
    ///
    /// # Errors
    /// [`Apart`](crate::PhysicsError::Apart), [`AxisCount`](crate::PhysicsError::AxisCount) and
    /// [`Input`](crate::PhysicsError::Input).
    pub fn nearest(&mut self, axes: &AxisVector) -> Result<Option<Clearance>> {
        self.go(axes)?;
        Ok(self.distances.nearest(&self.poses))
    }

    /// As [`Self::nearest`], with the tool of the machine replaced by one shifted by `shift` (m, machine frame).
    ///
    /// # Errors
    /// Those of [`Self::nearest`].
    pub fn nearest_shifted(
        &mut self,
        axes: &AxisVector,
        shift: &Vector3<f64>,
    ) -> Result<Option<Clearance>> {
        let tip = self.model.tip.link;
        self.go_and(axes, |poses| {
            if let Some(pose) = poses.get_mut(tip) {
                pose.translation.vector += shift;
            }
        })?;
        Ok(self.distances.nearest(&self.poses))
    }

    /// Fills `found` with all pairs that are nearer than `distance` (m) with the axes at `axes` (m or rad).
    ///
    /// # Errors
    /// Those of [`Self::nearest`].
    pub fn nearer_than(
        &mut self,
        distance: f64,
        axes: &AxisVector,
        found: &mut Vec<Clearance>,
    ) -> Result<()> {
        self.go(axes)?;
        found.clear();
        self.distances.nearer_than(distance, &self.poses, found);
        Ok(())
    }

    /// Distance of two parts with the axes at `axes` (m or rad); `None` for pairs that are not measured.
    ///
    /// # Errors
    /// Those of [`Self::nearest`].
    pub fn between(&mut self, parts: [Part; 2], axes: &AxisVector) -> Result<Option<f64>> {
        self.go(axes)?;
        Ok(self.distances.between(parts, &self.poses))
    }

    /// All pairs that are in each other with the axes at `axes` (m or rad).
    ///
    /// # Errors
    /// Those of [`Self::nearest`].
    pub fn overlapping(&mut self, axes: &AxisVector) -> Result<Vec<[Part; 2]>> {
        self.go(axes)?;
        Ok(self.distances.overlapping(&self.poses))
    }

    fn go(&mut self, axes: &AxisVector) -> Result<()> {
        self.go_and(axes, |_| ())
    }

    /// Moves the links to where they are with the axes at `axes`, then applies `changed`.
    fn go_and(
        &mut self,
        axes: &AxisVector,
        changed: impl FnOnce(&mut [Isometry3<f64>]),
    ) -> Result<()> {
        let position = checked(axes, self.axis_count, 0)?;
        self.posed.poses(&self.model, &position, &mut self.moved)?;
        changed(&mut self.moved);
        self.distances.go(&self.poses, &self.moved);
        std::mem::swap(&mut self.poses, &mut self.moved);
        Ok(())
    }
}

/// True for the tool and any obstacle, stock included.
fn meets_tool(pairs: &Pairs, numbers: [usize; 2], surroundings: &Surroundings) -> bool {
    let [Some(one), Some(other)] = numbers.map(|number| pairs.part(number)) else { return false };
    let is_there = matches!(other, Part::Obstacle(_));
    one == Part::Tool && is_there && !surroundings.names([one, other])
}
