//! Workspace of the loop closure iteration: gaps, their Jacobian, steps.

use crate::{Following, Joint, JointDrive, JointKind, Loop, Model};
use nalgebra::{Cholesky, DMatrix, DVector, Isometry3, Point3, Vector3};

/// No joint turns further (rad) in one step of the iteration.
const LARGEST_TURN: f64 = 0.5;

/// The joints that mimic others, each with whom it follows in the end.
#[derive(Clone, Debug)]
pub(super) struct Followers {
    list: Vec<(usize, Following)>,
}

impl Followers {
    pub(super) fn new(model: &Model) -> Self {
        let mimics = |(index, joint): (usize, &Joint)| match joint.drive {
            JointDrive::Mimic { .. } => Some((index, model.following(index)?)),
            _ => None,
        };
        Self { list: model.joints.iter().enumerate().filter_map(mimics).collect() }
    }

    /// Puts them where those that they follow are.
    pub(super) fn follow(&self, values: &mut [f64]) {
        for (index, following) in &self.list {
            let leader = values.get(following.leader).copied().unwrap_or_default();
            if let Some(value) = values.get_mut(*index) {
                *value = following.position(leader);
            }
        }
    }

    /// The joint that the joint `index` moves with, itself perhaps, and how far it moves for 1 of that.
    fn leader(&self, index: usize) -> (usize, f64) {
        let found = self.list.iter().find(|(follower, _)| *follower == index);
        found.map_or((index, 1.0), |(_, following)| (following.leader, following.multiplier))
    }
}

/// Memory of the iteration, allocated once.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    /// Indices of the passive joints, in the order of the columns.
    pub(super) passive: Vec<usize>,
    pub(super) followers: Followers,
    pub(super) poses: Vec<Isometry3<f64>>,
    /// Joint positions: at rest; where the loops were closed last; of the step being tried; where the motion starts and
    /// ends; before the part under way.
    pub(super) rest: Vec<f64>,
    pub(super) closed: Vec<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) start: Vec<f64>,
    pub(super) target: Vec<f64>,
    pub(super) before: Vec<f64>,
    pub(super) gaps: DVector<f64>,
    pub(super) jacobian: DMatrix<f64>,
    /// `JᵀJ`.
    pub(super) normal: DMatrix<f64>,
    /// `Jᵀr`.
    pub(super) gradient: DVector<f64>,
    /// For its decomposition.
    pub(super) scratch: DMatrix<f64>,
    pub(super) step: DVector<f64>,
    /// Of the machine as measured last, m.
    pub(super) size: f64,
}

/// Gaps of the loops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gaps {
    /// The largest distance, m.
    pub(super) largest: f64,
    /// Sum of squares, m².
    pub(super) squares: f64,
    /// Largest distance of anything from the origin of the machine frame, m.
    pub(super) size: f64,
}

impl Gaps {
    pub(super) fn are_below(&self, relative: f64) -> bool {
        self.largest <= relative * self.size
    }
}

impl Workspace {
    /// For the joints of `model`, which stand at `values`; those with the indices `passive` are to be found.
    pub(super) fn new(
        model: &Model,
        passive: Vec<usize>,
        followers: Followers,
        values: &[f64],
    ) -> Self {
        let (rows, columns) = (3 * model.loops.len(), passive.len());
        Self {
            passive,
            followers,
            poses: vec![Isometry3::identity(); model.links.len()],
            trial: values.to_vec(),
            rest: values.to_vec(),
            closed: values.to_vec(),
            start: values.to_vec(),
            target: values.to_vec(),
            before: values.to_vec(),
            gaps: DVector::zeros(rows),
            jacobian: DMatrix::zeros(rows, columns),
            normal: DMatrix::zeros(columns, columns),
            gradient: DVector::zeros(columns),
            scratch: DMatrix::zeros(columns, columns),
            step: DVector::zeros(columns),
            size: 0.0,
        }
    }

    /// Places the links with the joints at `values` and measures the gaps there.
    pub(super) fn measure(&mut self, model: &Model, values: &[f64]) -> Gaps {
        model.link_poses_at(values, &mut self.poses);
        let extent = |pose: &Isometry3<f64>| pose.translation.vector.norm();
        let mut result = Gaps {
            largest: 0.0,
            squares: 0.0,
            size: self.poses.iter().map(extent).fold(0.0, f64::max),
        };
        for (number, closing) in model.loops.iter().enumerate() {
            let [one, other] = self.ends(closing);
            let gap = one - other;
            result.largest = result.largest.max(gap.norm());
            result.squares += gap.norm_squared();
            result.size = result.size.max(one.norm()).max(other.norm());
            for (row, value) in (3 * number..).zip(gap.iter()) {
                if let Some(slot) = self.gaps.get_mut(row) {
                    *slot = *value;
                }
            }
        }
        self.size = result.size;
        result
    }

    pub(super) fn measure_trial(&mut self, model: &Model) -> Gaps {
        let trial = std::mem::take(&mut self.trial);
        let gaps = self.measure(model, &trial);
        self.trial = trial;
        gaps
    }

    /// The two points of a loop, machine frame.
    pub(super) fn ends(&self, closing: &Loop) -> [Vector3<f64>; 2] {
        let end = |link: usize, point: &Point3<f64>| {
            self.poses.get(link).map_or_else(Vector3::zeros, |pose| (pose * point).coords)
        };
        let ([one, other], [point, other_point]) = (closing.links, &closing.points);
        [end(one, point), end(other, other_point)]
    }

    /// `J`, `JᵀJ` and `Jᵀr` where the links and gaps have been measured last.
    pub(super) fn differentiate(&mut self, model: &Model) {
        self.jacobian.fill(0.0);
        for (number, closing) in model.loops.iter().enumerate() {
            let [one, other] = self.ends(closing);
            self.add_columns(model, 3 * number, closing.links[0], one, 1.0);
            self.add_columns(model, 3 * number, closing.links[1], other, -1.0);
        }
        self.jacobian.tr_mul_to(&self.jacobian, &mut self.normal);
        self.jacobian.tr_mul_to(&self.gaps, &mut self.gradient);
    }

    /// Adds the Jacobian columns of the passive joints between `link` and the base for `point` of it (machine frame),
    /// times `sign`, from row `row` on.
    pub(super) fn add_columns(
        &mut self,
        model: &Model,
        row: usize,
        mut link: usize,
        point: Vector3<f64>,
        sign: f64,
    ) {
        // A parent has a smaller index than its child, so this ends.
        while let Some((index, joint)) =
            link.checked_sub(1).and_then(|index| Some((index, model.joints.get(index)?)))
        {
            // Turning about an axis or sliding along it leaves the axis where it is: the frame of the child will do.
            let (leader, multiplier) = self.followers.leader(index);
            let column = self.passive.binary_search(&leader).ok().zip(self.poses.get(joint.child));
            if let Some((column, pose)) = column {
                let axis = pose.rotation * joint.axis.into_inner();
                let motion = match joint.kind {
                    JointKind::Revolute => axis.cross(&(point - pose.translation.vector)),
                    JointKind::Prismatic => axis,
                    JointKind::Fixed => Vector3::zeros(),
                };
                for (row, value) in (row..).zip(motion.iter()) {
                    if let Some(slot) = self.jacobian.get_mut((row, column)) {
                        *slot += sign * multiplier * value;
                    }
                }
            }
            if joint.parent >= link {
                break;
            }
            link = joint.parent;
        }
    }

    /// The step with `damping` (λ); false if there is none.
    pub(super) fn solve(&mut self, damping: f64) -> bool {
        let size = self.normal.nrows();
        let mut matrix = std::mem::replace(&mut self.scratch, DMatrix::zeros(0, 0));
        if matrix.nrows() == size {
            matrix.copy_from(&self.normal);
        } else {
            matrix = self.normal.clone();
        }
        for index in 0..size {
            if let Some(diagonal) = matrix.get_mut((index, index)) {
                *diagonal += damping;
            }
        }
        let Some(cholesky) = Cholesky::new(matrix) else { return false };
        self.step.copy_from(&self.gradient);
        cholesky.solve_mut(&mut self.step);
        self.scratch = cholesky.unpack_dirty();
        self.step.iter().all(|value| value.is_finite())
    }

    /// The trial: `values` with the passive joints a step further, none of which turns too far.
    pub(super) fn advance(&mut self, model: &Model, values: &[f64]) {
        let steps = || self.passive.iter().zip(self.step.iter());
        let turns = |joint: usize| {
            model.joints.get(joint).is_some_and(|joint| joint.kind == JointKind::Revolute)
        };
        let largest =
            steps().filter(|(joint, _)| turns(**joint)).map(|(_, s)| s.abs()).fold(0.0, f64::max);
        let scale = if largest > LARGEST_TURN { LARGEST_TURN / largest } else { 1.0 };
        self.trial.copy_from_slice(values);
        for (joint, step) in self.passive.iter().zip(self.step.iter()) {
            if let Some(value) = self.trial.get_mut(*joint) {
                *value -= scale * step;
            }
        }
        self.followers.follow(&mut self.trial);
    }
}
