//! Values of an axis (`AXIS_REF`, manual 2.4), with the manual's names and initial values.

/// Values that the blocks and the cycle of an axis share; u is its unit.
#[expect(clippy::struct_excessive_bools, reason = "each is a signal of its own")]
#[derive(Clone, Debug, Default)]
pub(crate) struct AxisValues {
    /// `bRegulatorOn`: power wanted.
    pub(crate) regulator_on: bool,
    /// `bDriveStart`: release of the brake wanted.
    pub(crate) drive_start: bool,
    /// `bCommunication`: the drive answers.
    pub(crate) communication: bool,
    /// `bRegulatorRealState`: power is on.
    pub(crate) regulator_real_state: bool,
    /// `bDriveStartRealState`: the brake is released.
    pub(crate) drive_start_real_state: bool,
    /// `wDriveId`: drive on the bus.
    pub(crate) drive_id: i64,
    /// `iOwner`: block that moves the axis, 0 for none.
    pub(crate) owner: i64,
    /// `iNoOwner`: owners so far.
    pub(crate) owners: i64,
    /// `bMovedInThisCycle`: A block has given a set-point this cycle.
    pub(crate) moved_in_this_cycle: bool,
    /// `fTaskCycle`: cycle time, s.
    pub(crate) task_cycle: f64,
    /// `bError`: the axis has an error.
    pub(crate) error: bool,
    /// `wErrorID`: its number.
    pub(crate) error_id: i64,
    /// `bErrorAckn`: A reset is asked of the drive.
    pub(crate) error_acknowledged: bool,
    /// `fSetPosition`: set position, u.
    pub(crate) set_position: f64,
    /// `fActPosition`: Actual position, u.
    pub(crate) act_position: f64,
    /// `fSavePosition`: set position when the cycle began, u.
    pub(crate) save_position: f64,
    /// `fSetVelocity`: set velocity, u/s.
    pub(crate) set_velocity: f64,
    /// `fActVelocity`: Actual velocity, u/s.
    pub(crate) act_velocity: f64,
    /// `fSWMaxVelocity`: largest velocity of implicit motion, u/s.
    pub(crate) sw_max_velocity: f64,
    /// `fSaveVelocity`: set velocity when the cycle began, u/s.
    pub(crate) save_velocity: f64,
    /// `fSetAcceleration`: set acceleration, u/s².
    pub(crate) set_acceleration: f64,
    /// `fActAcceleration`: Actual acceleration, u/s².
    pub(crate) act_acceleration: f64,
    /// `fSWMaxAcceleration`: largest acceleration of implicit motion, u/s².
    pub(crate) sw_max_acceleration: f64,
    /// `fSWMaxDeceleration`: largest deceleration of implicit motion, u/s².
    pub(crate) sw_max_deceleration: f64,
    /// `fMaxJerk`: jerk of the ramps, u/s³.
    pub(crate) max_jerk: f64,
    /// `fSWMaxJerk`: largest jerk of implicit motion, u/s³.
    pub(crate) sw_max_jerk: f64,
    /// `fSWLimitPositive`: software limit in positive direction, u.
    pub(crate) sw_limit_positive: f64,
    /// `fSWLimitNegative`: software limit in negative direction, u.
    pub(crate) sw_limit_negative: f64,
    /// `bSWLimitEnable`: watch the software limits.
    pub(crate) sw_limit_enable: bool,
    /// `fOffsetPosition`: shift of the zero, u.
    pub(crate) offset_position: f64,
}
