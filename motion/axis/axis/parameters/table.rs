//! Parameter table of an axis, generated from one list (`AXIS_REF`, manual 2.4).

use super::value::{Access, Parameter, Slot, Value};

/// A value of a field's type as a [`Value`].
macro_rules! lift {
    (f64, $value:expr) => {
        Value::Real($value)
    };
    (i64, $value:expr) => {
        Value::Integer($value)
    };
    (bool, $value:expr) => {
        Value::Bool($value)
    };
}

/// Writes the structure, its initial values and its table from one list.
macro_rules! axis_ref {
    ($($number:literal $plcopen:literal $name:literal $field:ident: $kind:ident = $initial:literal $access:ident, $doc:literal;)*) => {
        /// The values of an axis by their names.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct AxisRef {
            $(#[doc = $doc] pub(crate) $field: $kind,)*
        }

        impl Default for AxisRef {
            fn default() -> Self {
                Self { $($field: $initial,)* }
            }
        }

        /// Every parameter of an axis, in the order of the numbers.
        ///
        /// These act when they are written: `fSWMaxVelocity`, `fSWMaxAcceleration`, `fSWMaxDeceleration` and `fSWMaxJerk`
        /// (braking in errorstop, bridges of jumps, `SMC_CheckLimits`), `fMaxJerk` (all ramps), `fMaxTorque` (set torques,
        /// where it is above 0), `bSWLimitEnable`, `fSWLimitPositive`, `fSWLimitNegative` and `bHWLimitEnable`, and
        /// `bCaptureOccurred`, which is confirmed by writing FALSE.
        ///
        /// The other writable ones are only kept: no block of the manual uses `fMaxVelocity`, `fMaxAcceleration` or
        /// `fMaxDeceleration`; bus data (1001–1008, 1054–1058), gains (1040–1044), currents and the ratio to increments
        /// belong to the drive; groups of axes have their own list of drives (1300). 1013, 1230, 1231 and 1234–1237 are
        /// internal to the original and keep their initial values.
        pub const PARAMETERS: &[Parameter] = &[
            $(Parameter {
                number: $number,
                plcopen: $plcopen,
                name: $name,
                about: $doc,
                initial: lift!($kind, $initial),
                access: Access::$access,
            },)*
        ];

        impl AxisRef {
            /// The value of a parameter by its own number.
            pub(super) fn read(&self, number: u16) -> Option<Value> {
                match number {
                    $($number => Some(lift!($kind, self.$field)),)*
                    _ => None,
                }
            }

            /// Sets it; `false` if there is none, or not of the value's type.
            pub(super) fn write(&mut self, number: u16, value: Value) -> bool {
                match number {
                    $($number => <$kind as Slot>::take(value).map(|value| self.$field = value).is_some(),)*
                    _ => false,
                }
            }
        }
    };
}

axis_ref! {
    1000 0 "nAxisState" axis_state: i64 = 3 Read, "State of the axis, [`AxisState`](super::AxisState).";
    1001 0 "wControlType" control_type: i64 = 4 Write, "What is sent and received every cycle: 1 torque … 7 by 1002–1008.";
    1002 0 "wCyclicDataS1" cyclic_sent_1: i64 = 0 Write, "First value sent.";
    1003 0 "wCyclicDataS2" cyclic_sent_2: i64 = 0 Write, "Second value sent.";
    1004 0 "wCyclicDataS3" cyclic_sent_3: i64 = 0 Write, "Third value sent.";
    1006 0 "wCyclicDataR1" cyclic_received_1: i64 = 0 Write, "First value received.";
    1007 0 "wCyclicDataR2" cyclic_received_2: i64 = 0 Write, "Second value received.";
    1008 0 "wCyclicDataR3" cyclic_received_3: i64 = 0 Write, "Third value received.";
    1010 0 "bRegulatorOn" regulator_on: bool = false Read, "Power wanted.";
    1011 0 "bDriveStart" drive_start: bool = false Read, "Release of the brake wanted.";
    1012 0 "bCommunication" communication: bool = false Read, "The drive answers.";
    1013 0 "wCommunicationState" communication_state: i64 = 0 Read, "Internal.";
    1015 0 "bRegulatorRealState" regulator_real_state: bool = false Read, "Power is on.";
    1016 0 "bDriveStartRealState" drive_start_real_state: bool = false Read, "The brake is released.";
    1020 0 "wAxisGroupId" axis_group_id: i64 = 0 Read, "Axis group.";
    1021 0 "wDriveId" drive_id: i64 = 0 Read, "Drive on the bus.";
    1022 0 "iOwner" owner: i64 = 0 Read, "Block that moves the axis, 0 for none.";
    1023 0 "iNoOwner" owners: i64 = 0 Read, "Owners so far.";
    1024 0 "bMovedInThisCycle" moved_in_this_cycle: bool = false Read, "A block has given a set-point this cycle.";
    1025 0 "fTaskCycle" task_cycle: f64 = 0.0 Read, "Cycle time, s.";
    1026 0 "bRealDrive" real_drive: bool = false Read, "Made by the configuration, not by a program.";
    1030 0 "bError" error: bool = false Read, "The axis has an error.";
    1031 0 "wErrorID" error_id: i64 = 0 Read, "Its number.";
    1032 0 "bErrorAckn" error_acknowledged: bool = false Read, "A reset is asked of the drive.";
    1035 0 "FBErrorID" fb_error_id: i64 = 0 Read, "Number of the latest block error.";
    1040 0 "fContrRpmP" velocity_gain: f64 = 1.0 Write, "Velocity control, gain.";
    1041 0 "fContrRpmI" velocity_integral_time: f64 = 0.0 Write, "Velocity control, integral time, ms.";
    1042 0 "fContrRpmD" velocity_derivative_time: f64 = 0.0 Write, "Velocity control, derivative time, ms.";
    1043 0 "fContrPosP" position_gain: f64 = 1.0 Write, "Position control, gain.";
    1044 0 "fContrPosI" position_integral_time: f64 = 0.0 Write, "Position control, integral time, ms.";
    1051 0 "dwRatioTechUnitsDenom" ratio_denominator: i64 = 1 Write, "Increments to u, denominator.";
    1052 0 "iRatioTechUnitsNum" ratio_numerator: i64 = 1 Write, "Increments to u, numerator.";
    1053 0 "nDirection" direction: i64 = 1 Read, "−1 while the set velocity is negative, else 1.";
    1054 0 "fScalefactor" scale_factor: f64 = 1.0 Write, "Bus to u.";
    1055 0 "fFactorVel" velocity_factor: f64 = 1.0 Write, "Bus to u/s.";
    1056 0 "fFactorAcc" acceleration_factor: f64 = 1.0 Write, "Bus to u/s².";
    1057 0 "fFactorTor" torque_factor: f64 = 1.0 Write, "Bus to Nm or N.";
    1058 0 "fFactorJerk" jerk_factor: f64 = 1.0 Write, "Bus to u/s³.";
    1060 0 "iMovementType" movement_type: i64 = 1 Read, "0 rotary, 1 linear.";
    1061 0 "fPositionPeriod" position_period: f64 = 1000.0 Read, "Period of a rotary axis, u.";
    1091 0 "byControllerMode" controller_mode: i64 = 3 Read, "Controller mode wanted: 1 torque, 2 velocity, 3 position, 4 current.";
    1092 0 "byRealControllerMode" real_controller_mode: i64 = 0 Read, "Controller mode of the drive.";
    1100 1 "fSetPosition" set_position: f64 = 0.0 Read, "Set position, u.";
    1101 0 "fActPosition" act_position: f64 = 0.0 Read, "Actual position, u.";
    1105 0 "fAimPosition" aim_position: f64 = 0.0 Read, "Target, u.";
    1106 0 "fMarkPosition" mark_position: f64 = 0.0 Read, "Where the running block began, u.";
    1107 0 "fSavePosition" save_position: f64 = 0.0 Read, "Set position when the cycle began, u.";
    1110 11 "fSetVelocity" set_velocity: f64 = 0.0 Read, "Set velocity, u/s.";
    1111 10 "fActVelocity" act_velocity: f64 = 0.0 Read, "Actual velocity, u/s.";
    1112 9 "fMaxVelocity" max_velocity: f64 = 100.0 Write, "Largest velocity of the drive, u/s.";
    1113 0 "fSWMaxVelocity" sw_max_velocity: f64 = 100.0 Write, "Largest velocity of implicit motion, u/s.";
    1115 0 "bConstantVelocity" constant_velocity: bool = false Read, "Moves with a constant velocity.";
    1116 0 "fMarkVelocity" mark_velocity: f64 = 0.0 Read, "Velocity where the running block began, u/s.";
    1117 0 "fSaveVelocity" save_velocity: f64 = 0.0 Read, "Set velocity when the cycle began, u/s.";
    1120 0 "fSetAcceleration" set_acceleration: f64 = 0.0 Read, "Set acceleration, u/s².";
    1121 0 "fActAcceleration" act_acceleration: f64 = 0.0 Read, "Actual acceleration, u/s².";
    1122 13 "fMaxAcceleration" max_acceleration: f64 = 100.0 Write, "Largest acceleration of the drive, u/s².";
    1123 0 "fSWMaxAcceleration" sw_max_acceleration: f64 = 100.0 Write, "Largest acceleration of implicit motion, u/s².";
    1125 0 "bAccelerating" accelerating: bool = false Read, "The speed grows.";
    1126 0 "fMarkAcceleration" mark_acceleration: f64 = 0.0 Read, "Acceleration where the running block began, u/s².";
    1127 0 "fSaveAcceleration" save_acceleration: f64 = 0.0 Read, "Set acceleration when the cycle began, u/s².";
    1130 0 "fSetDeceleration" set_deceleration: f64 = 0.0 Read, "How fast the set speed falls, u/s².";
    1131 0 "fActDeceleration" act_deceleration: f64 = 0.0 Read, "How fast the actual speed falls, u/s².";
    1132 15 "fMaxDeceleration" max_deceleration: f64 = 100.0 Write, "Largest deceleration of the drive, u/s².";
    1133 0 "fSWMaxDeceleration" sw_max_deceleration: f64 = 100.0 Write, "Largest deceleration of implicit motion, u/s².";
    1135 0 "bDecelerating" decelerating: bool = false Read, "The speed falls.";
    1137 0 "fSaveDeceleration" save_deceleration: f64 = 0.0 Read, "Set deceleration when the cycle began, u/s².";
    1140 0 "fSetJerk" set_jerk: f64 = 0.0 Read, "Set jerk, u/s³.";
    1141 0 "fActJerk" act_jerk: f64 = 0.0 Read, "Actual jerk, u/s³.";
    1142 16 "fMaxJerk" max_jerk: f64 = 100.0 Write, "Jerk of the ramps, u/s³.";
    1143 0 "fSWMaxJerk" sw_max_jerk: f64 = 100.0 Write, "Largest jerk of implicit motion, u/s³.";
    1146 0 "fMarkJerk" mark_jerk: f64 = 0.0 Read, "Jerk where the running block began, u/s³.";
    1150 0 "fSetCurrent" set_current: f64 = 0.0 Read, "Set current, A.";
    1151 0 "fActCurrent" act_current: f64 = 0.0 Read, "Actual current, A.";
    1152 0 "fMaxCurrent" max_current: f64 = 100.0 Write, "Largest current, A.";
    1153 0 "fSWMaxCurrent" sw_max_current: f64 = 0.0 Write, "Largest current of implicit motion, A.";
    1160 0 "fSetTorque" set_torque: f64 = 0.0 Read, "Set torque, Nm (force, N).";
    1161 0 "fActTorque" act_torque: f64 = 0.0 Read, "Actual torque, Nm (force, N).";
    1162 0 "fMaxTorque" max_torque: f64 = 0.0 Write, "Largest torque, Nm (force, N).";
    1200 2 "fSWLimitPositive" sw_limit_positive: f64 = 0.0 Write, "Software limit in positive direction, u.";
    1201 3 "fSWLimitNegative" sw_limit_negative: f64 = 0.0 Write, "Software limit in negative direction, u.";
    1202 0 "fCaptPosition" captured_position: f64 = 0.0 Read, "Captured position, u.";
    1204 0 "bSWEndSwitchActive" sw_end_switch_active: bool = false Read, "The set position is outside the software limits.";
    1205 0 "bSWLimitEnable" sw_limit_enable: bool = false Write, "Watch the software limits.";
    1206 0 "bHWLimitEnable" hw_limit_enable: bool = false Write, "Watch the limit switches.";
    1207 0 "bCaptureOccurred" capture_occurred: bool = false Write, "A position was captured; written FALSE to confirm.";
    1208 0 "bStartCapturing" start_capturing: bool = false Read, "The drive is to capture.";
    1210 0 "bStartReference" start_reference: bool = false Read, "The drive is to home itself.";
    1211 0 "fReference" reference: f64 = 0.0 Read, "Position at the reference, u.";
    1215 0 "fOffsetPosition" offset_position: f64 = 0.0 Read, "Shift of the zero, u.";
    1220 0 "fFirstCapturePosition" first_capture_position: f64 = 0.0 Read, "Window of the capture, begin, u.";
    1221 0 "fLastCapturePosition" last_capture_position: f64 = 0.0 Read, "Window of the capture, end, u.";
    1222 0 "tiTriggerInput" trigger_number: i64 = -1 Read, "Trigger that captures: its number.";
    1223 0 "bCaptureWindowActive" capture_window_active: bool = false Read, "Capture within the window only.";
    1230 0 "dwPosOffsetForResiduals" residual_offset: i64 = 0 Read, "Internal: rest of the conversion to increments.";
    1231 0 "dwOneTurn" one_turn: i64 = 0 Read, "Internal: rest of the conversion to increments.";
    1232 0 "fLastPosition" last_position: f64 = 0.0 Read, "Internal: actual position of the last cycle, u.";
    1234 0 "iRestNumerator" rest_numerator: i64 = 0 Read, "Internal: rest of the conversion to increments.";
    1235 0 "iTurn" turns: i64 = 0 Read, "Internal: turns since power-up.";
    1236 0 "dwBusModuloValue" bus_modulo: i64 = 0 Read, "Internal: modulo of the bus.";
    1237 0 "dwPosOffsetForResidualsHoming" residual_homing_offset: i64 = 0 Read, "Internal: rest of the conversion to increments.";
    1300 0 "bDisableDriveInAxisGroup" disabled_in_group: bool = false Write, "Left out of the axis group.";
    1301 0 "bErrorDuringStartup" startup_error: bool = false Read, "The drive did not start up.";
}
