//! Fault injection: jams, lost steps, loose belts and power loss.

use crate::drive::MotorAtWork;
use crate::event::{EventKind, Fault, PhysicsEvent};
use crate::friction::FrictionParameters;
use crate::machine::PhysicsMachine;

/// Dry friction of a jammed axis: more than any motor gives, N or Nm.
const JAMMED: f64 = 1e9;

impl PhysicsMachine {
    /// Injects a fault into `axis`. False if the axis does not exist or lacks the part that fails.
    pub fn fail(&mut self, axis: usize, fault: Fault) -> bool {
        let parts = self.drives.get_mut(axis).zip(self.trains.get_mut(axis));
        let Some((drive, train)) = parts else { return false };
        match fault {
            Fault::Jam => {
                train.friction = train.friction.and(&FrictionParameters::new(JAMMED, 0.0));
            }
            Fault::PowerLoss => {
                drive.dead_for.get_or_insert(0.0);
            }
            Fault::LostSteps(full_steps) => {
                let MotorAtWork::Stepper(stepper) = &mut drive.motor else { return false };
                if !(0.0..=1e9).contains(&full_steps) {
                    return false;
                }
                stepper.drop_steps(full_steps);
            }
            Fault::LooseBelt { stiffness, backlash } => {
                let Some(elastic) = &mut train.elastic else { return false };
                if !(stiffness > 0.0
                    && stiffness.is_finite()
                    && (0.0..=f64::MAX).contains(&backlash))
                {
                    return false;
                }
                let transmission = &mut elastic.transmission;
                transmission.stiffness *= stiffness;
                transmission.damping *= stiffness;
                transmission.backlash += backlash;
            }
        }
        let (time_ns, kind) = (self.state.time_ns, EventKind::Failed(fault));
        self.events.push(PhysicsEvent { time_ns, axis, kind });
        true
    }

    /// Frees a jammed axis.
    pub fn free(&mut self, axis: usize) {
        if let Some(train) = self.trains.get_mut(axis) {
            let friction = &mut train.friction;
            for dry in [&mut friction.coulomb, &mut friction.breakaway] {
                if *dry >= JAMMED {
                    *dry -= JAMMED;
                }
            }
        }
    }
}
