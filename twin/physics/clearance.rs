//! How far the machine is from what it must not touch.

use nalgebra::{Isometry3, Vector3};
use twin_kinematics::AxisVector;
use twin_urdf::Model;

use super::checked;
use super::distances::{Clearance, Distances};
use super::dynamics::JointVector;
use super::equation::Equation;
use super::error::PhysicsError;
use super::pairs::Pairs;
use super::posed::Posed;
use super::surroundings::{Part, Surroundings};

/// Looks for what is nearest, pose by pose along a way.
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
        // A tool that is nothing but its tip can be measured all the same.
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

    /// Whether there is nothing to be near to.
    pub fn is_empty(&self) -> bool {
        self.distances.is_empty()
    }

    /// The two parts that are nearest to each other with the axes at `axes` (m or rad); `None` if nothing may touch anything.
    ///
    /// # Errors
    /// [`PhysicsError::Apart`], [`PhysicsError::AxisCount`] and [`PhysicsError::Input`].
    pub fn nearest(&mut self, axes: &AxisVector) -> Result<Option<Clearance>, PhysicsError> {
        self.go(axes)?;
        Ok(self.distances.nearest(&self.poses))
    }

    /// All pairs that are in each other with the axes at `axes` (m or rad).
    ///
    /// # Errors
    /// Those of [`Self::nearest`].
    pub fn overlapping(&mut self, axes: &AxisVector) -> Result<Vec<[Part; 2]>, PhysicsError> {
        self.go(axes)?;
        Ok(self.distances.overlapping(&self.poses))
    }

    fn go(&mut self, axes: &AxisVector) -> Result<(), PhysicsError> {
        let position = checked(axes, self.axis_count, 0)?;
        self.posed.poses(&self.model, &position, &mut self.moved)?;
        self.distances.go(&self.poses, &self.moved);
        std::mem::swap(&mut self.poses, &mut self.moved);
        Ok(())
    }
}
