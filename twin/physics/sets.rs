//! Bodies, colliders and joints of rapier, with the settings of the simulated machine.

use nalgebra::Vector3;
use rapier3d_f64::dynamics::{FrictionModel, SpringCoefficients};
use rapier3d_f64::pipeline::{
    CollisionPipeline, EventHandler, PhysicsHooks, PhysicsPipeline, PhysicsWorld,
};

use crate::maths;

/// Stiffness of contacts: penetration is acceleration / (2π·1000 Hz)².
const CONTACT: SpringCoefficients<f64> =
    SpringCoefficients { natural_frequency: 1000.0, damping_ratio: 1.0 };

/// Passes of the solver: a gripped body that is put down keeps its place in the gripper.
const PASSES: usize = 4;

/// Passes of the solver that bring contacts to rest.
const STABILISATION: usize = 10;

/// A world of rapier that can be copied: its pipelines hold no state.
pub(super) struct Sets(pub(super) PhysicsWorld);

impl Sets {
    /// An empty world under `gravity` (m/s²) with steps of `cycle` s.
    pub(super) fn new(gravity: &Vector3<f64>, cycle: f64) -> Self {
        let mut world =
            PhysicsWorld { gravity: maths::vector_to_rapier(gravity), ..PhysicsWorld::default() };
        let settings = &mut world.integration_parameters;
        settings.dt = cycle;
        settings.contact_softness = CONTACT;
        settings.static_contact_softness = CONTACT;
        settings.num_solver_iterations = 1;
        settings.num_internal_pgs_iterations = PASSES;
        settings.num_internal_stabilization_iterations = STABILISATION;
        settings.friction_model = FrictionModel::Simplified;
        settings.contact_recycling = false;
        settings.max_ccd_substeps = 0;
        Self(world)
    }

    /// One step with contacts up to `prediction` (m) apart.
    pub(super) fn step(
        &mut self,
        prediction: f64,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) {
        self.0.integration_parameters.normalized_prediction_distance = prediction;
        self.0.step_with_events(hooks, events);
    }
}

impl Clone for Sets {
    fn clone(&self) -> Self {
        let world = &self.0;
        Self(PhysicsWorld {
            gravity: world.gravity,
            integration_parameters: world.integration_parameters,
            physics_pipeline: PhysicsPipeline::new(),
            collision_pipeline: CollisionPipeline::new(),
            islands: world.islands.clone(),
            broad_phase: world.broad_phase.clone(),
            narrow_phase: world.narrow_phase.clone(),
            bodies: world.bodies.clone(),
            colliders: world.colliders.clone(),
            impulse_joints: world.impulse_joints.clone(),
            multibody_joints: world.multibody_joints.clone(),
            soft_bodies: world.soft_bodies.clone(),
            ccd_solver: world.ccd_solver.clone(),
        })
    }
}
