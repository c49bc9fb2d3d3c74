//! Tree dynamics: inertia and efforts of moving links, each merged with the links fixed to it into one rigid body.
//!
//! The z axis of a body's frame is the direction of its joint, and its origin is on the joint. All quantities of a body
//! are given in that frame, in which its own mass distribution is constant (Featherstone, *Rigid Body Dynamics
//! Algorithms*, 2008, chapters 2, 5 and 6). The points of a body have the acceleration a + B·r with B = α× + ω×ω×. With
//! m, h and J, the sums of its mass, m·r and m·r·rᵀ, the force and torque are
//!
//! ```text
//! f = m·a + B·h      n = h×a + ε(B·J),  ε(A) = (A₃₂ − A₂₃, A₁₃ − A₃₁, A₂₁ − A₁₂)
//! ```
//!
//! The body passes f and n + r×f to its parent (recursive Newton–Euler). The inertia of the joints comes from the
//! composite of the bodies that each joint carries (composite-rigid-body algorithm).

use nalgebra::{Matrix3, Vector3};
use twin_kinematics::MAX_AXES;

use crate::bodies::{self, Tree};
use crate::joint::{JointMatrix, JointVector};
use crate::spatial::{Motion, Spread};

/// A link that moves against its parent, with the links fixed to it.
#[derive(Clone, Debug)]
struct Body {
    /// Among the bodies; `None`: the base.
    parent: Option<usize>,
    /// Number of the joint.
    joint: usize,
    revolute: bool,
    /// Frame at joint position 0 in the parent's: rotation, if it is turned, and origin.
    turn: Option<Matrix3<f64>>,
    origin: Vector3<f64>,
    spread: Spread,
    /// Rotor inertia, kg or kg·m².
    armature: f64,
}

/// A body at one instant.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Of the joint, if it turns.
    sin_cos: [f64; 2],
    /// Origin in the frame of the parent.
    offset: Vector3<f64>,
    omega: Vector3<f64>,
    alpha: Vector3<f64>,
    motion: Motion,
    force: Vector3<f64>,
    torque: Vector3<f64>,
    /// Of this body and all that it carries.
    composite: Spread,
}

impl Body {
    /// A vector in the frame of the parent.
    #[inline]
    fn outward(&self, state: &State, vector: &Vector3<f64>) -> Vector3<f64> {
        let mut result = *vector;
        if self.revolute {
            let [sin, cos] = state.sin_cos;
            result.x = vector.x * cos - vector.y * sin;
            result.y = vector.x * sin + vector.y * cos;
        }
        match &self.turn {
            Some(turn) => turn * result,
            None => result,
        }
    }

    /// A vector of the parent's frame.
    #[inline]
    fn inward(&self, state: &State, vector: &Vector3<f64>) -> Vector3<f64> {
        let vector = match &self.turn {
            Some(turn) => turn.tr_mul(vector),
            None => *vector,
        };
        let mut result = vector;
        if self.revolute {
            let [sin, cos] = state.sin_cos;
            result.x = vector.x * cos + vector.y * sin;
            result.y = vector.y * cos - vector.x * sin;
        }
        result
    }

    /// Mass distribution of what it carries, in the frame of the parent.
    #[inline]
    fn spread_outward(&self, state: &State) -> Spread {
        let mut spread = state.composite;
        if self.revolute {
            spread = spread.turned_about_z(state.sin_cos);
        }
        if let Some(turn) = &self.turn {
            spread = spread.turned(turn);
        }
        spread.shifted(&state.offset)
    }
}

/// The moving links of a tree.
#[derive(Clone, Debug)]
pub(super) struct TreeDynamics {
    bodies: Vec<Body>,
    /// Workspace: the bodies at the place looked at last.
    states: Vec<State>,
    /// Workspace: inertia of the joints. What no body links stays as it is.
    inertia: JointMatrix,
}

impl TreeDynamics {
    /// Of `tree`, with `armature` (kg or kg·m²) added per joint, and 1 on the inertia's diagonal beyond `count`
    /// joints.
    pub(super) fn new(tree: &Tree, armature: &JointVector, count: usize) -> Self {
        let mut bodies: Vec<Body> = Vec::with_capacity(tree.bodies.len());
        // Of every link: the body that it is part of, and its frame in that body's.
        let mut places: Vec<(Option<usize>, Matrix3<f64>, Vector3<f64>)> =
            Vec::with_capacity(tree.bodies.len());
        for link in &tree.bodies {
            let base = (None, Matrix3::identity(), Vector3::zeros());
            let parent = link.parent.and_then(|parent| places.get(parent)).copied();
            let (carrier, turn, shift) = parent.unwrap_or(base);
            let rotation = turn * link.origin.rotation.to_rotation_matrix().into_inner();
            let origin = shift + turn * link.origin.translation.vector;
            let place = match link.motion {
                bodies::Motion::Fixed => (carrier, rotation, origin),
                bodies::Motion::Revolute(joint, direction)
                | bodies::Motion::Prismatic(joint, direction) => {
                    let along = with_z(&direction);
                    let turn = rotation * along;
                    bodies.push(Body {
                        parent: carrier,
                        joint,
                        revolute: matches!(link.motion, bodies::Motion::Revolute(..)),
                        turn: (turn != Matrix3::identity()).then_some(turn),
                        origin,
                        spread: Spread::default(),
                        armature: armature[joint],
                    });
                    (Some(bodies.len() - 1), along.transpose(), Vector3::zeros())
                }
            };
            if let Some(body) = place.0.and_then(|body| bodies.get_mut(body)) {
                body.spread.add(&Spread::of(&link.mass).turned(&place.1).shifted(&place.2));
            }
            places.push(place);
        }
        let states = vec![State::default(); bodies.len()];
        let mut inertia = JointMatrix::from_diagonal(armature);
        for beyond in count..MAX_AXES {
            inertia[(beyond, beyond)] = 1.0;
        }
        Self { bodies, states, inertia }
    }

    /// True if nothing turns. Neither the inertia nor the weight then depends on the joint positions.
    pub(super) fn is_uniform(&self) -> bool {
        self.bodies.iter().all(|body| !body.revolute)
    }

    /// Puts the joints at `position`.
    #[inline]
    pub(super) fn place(&mut self, position: &JointVector) {
        for (body, state) in self.bodies.iter().zip(&mut self.states) {
            let position = position[body.joint];
            state.offset = body.origin;
            if body.revolute {
                let (sin, cos) = position.sin_cos();
                state.sin_cos = [sin, cos];
            } else if let Some(turn) = &body.turn {
                state.offset += turn.column(2) * position;
            } else {
                state.offset.z += position;
            }
        }
    }

    /// Joint efforts for `acceleration` at `velocity` under `gravity`, at the last position.
    #[inline]
    pub(super) fn efforts(
        &mut self,
        velocity: &JointVector,
        acceleration: &JointVector,
        gravity: &Vector3<f64>,
    ) -> JointVector {
        for (index, body) in self.bodies.iter().enumerate() {
            let (done, rest) = self.states.split_at_mut(index);
            let Some(state) = rest.first_mut() else { continue };
            let (rate, change) = (velocity[body.joint], acceleration[body.joint]);
            let parent = body.parent.and_then(|parent| done.get(parent));
            let (mut acceleration, mut omega, mut alpha) = match parent {
                Some(State { motion, omega, alpha, .. }) => (
                    body.inward(state, &(motion.acceleration + motion.change * state.offset)),
                    body.inward(state, omega),
                    body.inward(state, alpha),
                ),
                // Gravity is an upward acceleration of the base.
                None => (body.inward(state, &-gravity), Vector3::zeros(), Vector3::zeros()),
            };
            let (across_x, across_y) = (omega.y * rate, -omega.x * rate);
            if body.revolute {
                omega.z += rate;
                alpha += Vector3::new(across_x, across_y, change);
            } else {
                acceleration += Vector3::new(2.0 * across_x, 2.0 * across_y, change);
            }
            state.motion = Motion::new(acceleration, &omega, &alpha);
            state.omega = omega;
            state.alpha = alpha;
            [state.force, state.torque] = body.spread.wrench(&state.motion);
        }
        let mut efforts = JointVector::zeros();
        for (index, body) in self.bodies.iter().enumerate().rev() {
            let (before, rest) = self.states.split_at_mut(index);
            let Some(state) = rest.first() else { continue };
            efforts[body.joint] = if body.revolute { state.torque.z } else { state.force.z }
                + body.armature * acceleration[body.joint];
            if let Some(parent) = body.parent.and_then(|parent| before.get_mut(parent)) {
                let force = body.outward(state, &state.force);
                parent.force += force;
                parent.torque += body.outward(state, &state.torque) + state.offset.cross(&force);
            }
        }
        efforts
    }

    /// The inertia of the joints where they are.
    #[inline]
    pub(super) fn inertia(&mut self) -> &JointMatrix {
        for (body, state) in self.bodies.iter().zip(&mut self.states) {
            state.composite = body.spread;
        }
        for (index, body) in self.bodies.iter().enumerate().rev() {
            let (before, rest) = self.states.split_at_mut(index);
            let Some(state) = rest.first() else { continue };
            let Spread { mass, first, second } = &state.composite;
            let (mut momentum, mut angular, own) = if body.revolute {
                let about = second.xx + second.yy;
                let angular = Vector3::new(-second.xz, -second.yz, about);
                (Vector3::new(-first.y, first.x, 0.0), angular, about)
            } else {
                (Vector3::new(0.0, 0.0, *mass), Vector3::new(first.y, -first.x, 0.0), *mass)
            };
            self.inertia[(body.joint, body.joint)] = own + body.armature;
            let (mut above, mut there) = (body, state);
            while let Some((below, next)) = above
                .parent
                .and_then(|parent| Some((self.bodies.get(parent)?, before.get(parent)?)))
            {
                momentum = above.outward(there, &momentum);
                angular = above.outward(there, &angular) + there.offset.cross(&momentum);
                let felt = if below.revolute { angular.z } else { momentum.z };
                self.inertia[(body.joint, below.joint)] = felt;
                self.inertia[(below.joint, body.joint)] = felt;
                (above, there) = (below, next);
            }
            if let Some(parent) = body.parent.and_then(|parent| before.get_mut(parent)) {
                parent.composite.add(&body.spread_outward(state));
            }
        }
        &self.inertia
    }
}

/// A rotation whose third column is `direction`; of coordinate axes it is one, without rounding.
fn with_z(direction: &Vector3<f64>) -> Matrix3<f64> {
    let size = direction.abs();
    let across = if size.y <= size.x.min(size.z) {
        Vector3::y()
    } else if size.x <= size.z {
        Vector3::x()
    } else {
        Vector3::z()
    };
    let x = across.cross(direction).normalize();
    Matrix3::from_columns(&[x, direction.cross(&x), *direction])
}
