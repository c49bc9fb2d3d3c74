//! Cam selection and the inputs of `MC_CamIn` (`MC_CamTableSelect`, manual 4.6.1, 5.4).

use super::reference::Cam;
use crate::coupling_output::CouplingError;
use crate::ramp_in::RampInLimits;
use std::sync::Arc;

/// A cam chosen for a pair of axes: the output `CamTableID` of `MC_CamTableSelect` (manual 5.4).
#[doc(alias = "MC_CAM_ID")]
#[doc(alias = "MC_CamTableSelect")]
#[derive(Clone, Debug)]
pub struct CamTable {
    /// The cam.
    pub cam: Arc<Cam>,
    /// True if the cam is periodic; else the slave stays at its ends.
    pub periodic: bool,
    /// True if the cam uses the master's absolute position; else its zero is the master's position at the start.
    pub master_absolute: bool,
    /// True if it gives the slave's absolute position; see [`StartMode`].
    pub slave_absolute: bool,
    /// The master's period, if it is a rotary axis, u.
    pub master_period: Option<f64>,
    /// The slave's period, if it is a rotary axis, u.
    pub slave_period: Option<f64>,
}

impl CamTable {
    /// Selects a cam as the block does by default: periodic, absolute, for linear axes.
    pub fn new(cam: Arc<Cam>) -> Self {
        Self {
            cam,
            periodic: true,
            master_absolute: true,
            slave_absolute: true,
            master_period: None,
            slave_period: None,
        }
    }
}

/// Start mode of a slave on its cam (`MC_StartMode`, manual 4.6.1).
#[doc(alias = "MC_StartMode")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum StartMode {
    /// The slave is where the cam says, with a jump if it was not there; as `Relative` if the cam is not about the
    /// slave's position.
    #[default]
    Absolute,
    /// The cam is added to where the slave is.
    Relative,
    /// A jump is bridged on the shortest way.
    RampIn,
    /// As `RampIn`, forwards on rotary slaves.
    RampInPositive,
    /// As `RampIn`, backwards on rotary slaves.
    RampInNegative,
}

/// Inputs of `MC_CamIn`; the defaults are 0, those of the scalings are 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamInput {
    /// `MasterOffset`, u of the cam.
    pub master_offset: f64,
    /// `MasterScaling`.
    pub master_scaling: f64,
    /// `SlaveOffset`, u of the slave.
    pub slave_offset: f64,
    /// `SlaveScaling`.
    pub slave_scaling: f64,
    /// `StartMode`.
    pub start_mode: StartMode,
    /// `VelocityDiff`: velocity that a ramp-in may add to the cam's, u/s.
    pub velocity_difference: f64,
    /// `Acceleration` of a bridge, u/s².
    pub acceleration: f64,
    /// `Deceleration` of a bridge, u/s².
    pub deceleration: f64,
    /// `TappetHysteresis`, u of the cam.
    pub tappet_hysteresis: f64,
    /// Tappets are looked for where the master will be this much later, s: what `SMC_CAMRegister` has as
    /// `DeadTimeCompensation`; `MC_CamIn` itself has no such input.
    pub tappet_dead_time_s: f64,
}

impl Default for CamInput {
    fn default() -> Self {
        Self {
            master_offset: 0.0,
            master_scaling: 1.0,
            slave_offset: 0.0,
            slave_scaling: 1.0,
            start_mode: StartMode::Absolute,
            velocity_difference: 0.0,
            acceleration: 0.0,
            deceleration: 0.0,
            tappet_hysteresis: 0.0,
            tappet_dead_time_s: 0.0,
        }
    }
}

impl CamInput {
    /// Limits of a ramp-in (error 627 without).
    pub(super) fn ramp_limits(&self) -> Result<RampInLimits, CouplingError> {
        let [velocity, acceleration, deceleration] = self.ramp()?;
        Ok(RampInLimits { velocity, acceleration, deceleration })
    }

    /// The same as numbers: velocity, acceleration and deceleration.
    ///
    /// # Errors
    /// [`CouplingError::RampNeedsValues`] if one of them is not positive.
    pub fn ramp(&self) -> Result<[f64; 3], CouplingError> {
        let inputs = [
            ("VelocityDiff", self.velocity_difference),
            ("Acceleration", self.acceleration),
            ("Deceleration", self.deceleration),
        ];
        match inputs.into_iter().find(|(_, value)| *value <= 0.0) {
            Some((name, value)) => Err(CouplingError::RampNeedsValues { name, value }),
            None => Ok(inputs.map(|(_, value)| value)),
        }
    }

    pub(super) fn check(&self) -> Result<(), CouplingError> {
        for (what, value) in [
            ("MasterOffset", self.master_offset),
            ("MasterScaling", self.master_scaling),
            ("SlaveOffset", self.slave_offset),
            ("SlaveScaling", self.slave_scaling),
            ("VelocityDiff", self.velocity_difference),
            ("Acceleration", self.acceleration),
            ("Deceleration", self.deceleration),
            ("TappetHysteresis", self.tappet_hysteresis),
            ("DeadTimeCompensation", self.tappet_dead_time_s),
        ] {
            if !value.is_finite() {
                return Err(CouplingError::NotFinite { what, value });
            }
        }
        Ok(())
    }
}
