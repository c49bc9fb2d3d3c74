//! What to do about an error, in English.

use super::super::SmcError as E;

/// What to do about it.
#[expect(clippy::too_many_lines, reason = "a table, one line an error")]
pub(super) const fn remedy(error: E) -> &'static str {
    match error {
        E::NoError => "nothing: all is well",
        E::DiGeneralCommunicationError => {
            "check the wire, its ends and the power of every drive on it, then reset the axis group"
        }
        E::DiSwlimitsExceeded => {
            "reset the axis with MC_Reset and move it back between fSWLimitNegative and fSWLimitPositive; correct the target, or the limits if they are wrong; with hardware limits watched, an open limit switch is this error, too"
        }
        E::RegulatorOrStartNotSet => {
            "call MC_Power with Enable, bRegulatorOn and bDriveStart TRUE and wait for Status before the axis is moved"
        }
        E::FbWasntCalledDuringMotion => {
            "call every block that moves an axis in every cycle until it is Done, aborted or has handed the axis over"
        }
        E::AxisIsNoAxisRef => "give the block an axis of the drive configuration as Axis",
        E::AxisRefChangedDuringOperation => {
            "give the block the same axis until it has ended; use an instance of its own for every axis"
        }
        E::HomingInvalidVelaccValues
        | E::MsInvalidAccdecValues
        | E::MaInvalidVelaccValues
        | E::MrInvalidVelaccValues
        | E::MadInvalidVelaccValues
        | E::MsiInvalidVelaccValues
        | E::MvInvalidAccdecValues
        | E::McrInvalidVelaccValues
        | E::McaInvalidVelaccValues => {
            "set velocity, acceleration and deceleration greater than 0 before the rising edge of Execute"
        }
        E::HomingModeNeedsHwlimit => {
            "set bIgnoreHWLimit to FALSE, or take a homing mode without limit switches (0 to 2)"
        }
        E::ScmNotSupported => {
            "ask for a controller mode that the drive has, or configure it in the drive"
        }
        E::StWrongControllerMode => {
            "switch the axis to torque with SMC_SetControllerMode first and wait until it is Done"
        }
        E::RagErrorDuringStartup => {
            "look at pErrorDrive and g_strBootupError of the axis group, remove the cause and reset the group again"
        }
        E::CgrZeroValues => {
            "set dwRatioTechUnitsDenom, iRatioTechUnitsNum and, of rotary axes, the period to other values than 0"
        }
        E::CgrDrivePowered => {
            "take the power off the axis with MC_Power before the ratio is changed"
        }
        E::PFtaskcycleEmpty => {
            "set the cycle time of the task in the axis group, so that fTaskCycle is greater than 0"
        }
        E::RNoErrorToReset => "nothing is to be done: call MC_Reset in errorstop only",
        E::RDriveDoesntAnswer => {
            "look up the drive's own error (MC_ReadAxisError), remove its cause and reset again"
        }
        E::RErrorNotResettable => {
            "remove the cause in the drive's manual; such errors often need the drive switched off and on"
        }
        E::RDriveDoesntAnswerInTime | E::HAxisDidntAnswer | E::TpCommError => {
            "check that the drive is powered and its wire sound, then try again"
        }
        E::RpParamUnknown => "give a parameter number that the axis or its drive has",
        E::RpRequestingError | E::WpSendingError => {
            "check that the drive is powered, its wire sound and the parameter one that it has in this state"
        }
        E::WpParamInvalid => {
            "give a parameter number that the axis or its drive has and that may be written"
        }
        E::HAxisWasntStandstill => "stop the axis and wait for standstill before MC_Home",
        E::HAxisDidntStartHoming => {
            "check that the drive has homing, that it is configured and that nothing locks it"
        }
        E::HErrorWhenStopping => "set the deceleration of the axis greater than 0",
        E::MsUnknownStoppingError => {
            "look up the drive's own error (MC_ReadAxisError), reset and stop again"
        }
        E::MsDirectionNotApplicable | E::MvDirectionNotApplicable => {
            "give positive, negative or current as Direction: without a target there is no shortest way"
        }
        E::MsAxisInErrorstop => {
            "call MC_Reset first: in errorstop the axis stands, or is being stopped, already"
        }
        E::MaInvalidDirection
        | E::MrInvalidDirection
        | E::MadInvalidDirection
        | E::MsiInvalidDirection => {
            "give one of the directions negative, shortest, positive, current or fastest"
        }
        E::McrInvalidDirection | E::McaInvalidDirection => {
            "give positive, negative or current as EndVelocityDirection: a velocity has no shortest or fastest way"
        }
        E::PpArraysize | E::VpArraysize | E::ApArraysize => {
            "set ArraySize to the number of points in the table, from 1 to 100"
        }
        E::PpStep0ms | E::VpStep0ms | E::ApStep0ms => {
            "give every point of the table a delta_time greater than 0"
        }
        E::TpTriggeroccupied => {
            "end the other MC_TouchProbe with MC_AbortTrigger, or take another trigger"
        }
        E::TpCouldntSetWindow => {
            "set WindowOnly to FALSE, or take a drive whose trigger has a window"
        }
        E::AtTriggernotoccupied => {
            "nothing is to be done: MC_TouchProbe has ended already, or the trigger is another one"
        }
        E::McaDirectionNotApplicable => {
            "give another direction than fastest: the axis does not stop at the target"
        }
        E::CrNoTappetsInCam => "add tappets to the cam, or give the cam that has them",
        E::CrTooManyTappets => {
            "number the groups of the tappets from 1 to MAX_NUM_TAPPETS, or raise that constant"
        }
        E::CrMoreThan32Accesses => {
            "let 32 blocks at most use one cam, or copy the cam for the others"
        }
        E::CiNoCamSelected => {
            "call MC_CamTableSelect and give its CamTableID to MC_CamIn once it is Done"
        }
        E::CiMasterOutOfScale => {
            "bring the master into the range of the cam before the start, or select the cam with MasterAbsolute FALSE; MasterOffset and MasterScaling move the master, too"
        }
        E::CiRampinNeedsVelaccValues => {
            "set VelocityDiff, Acceleration and Deceleration greater than 0, or start absolute or relative; `twin tune cam` finds them"
        }
        E::CiScalingIncorrect => {
            "give fEditorMasterMin and Max, fTableMasterMin and Max and those of the slave pairs of different values"
        }
        E::GiRatioDenom => "set RatioDenominator to another value than 0",
        E::GiInvalidAcc => "set Acceleration greater than 0",
        E::GiInvalidDec => "set Deceleration greater than 0",
        E::PhInvalidVelaccdec => "set Velocity, Acceleration and Deceleration greater than 0",
        E::PhRotaryaxisPeriod0 => "set fPositionPeriod of the rotary axes to their period",
        E::NoCamRefType => {
            "give a variable of the type MC_CAM_REF, or the cam that the editor has compiled"
        }
        E::GipMasterDirectionChange => {
            "let the master go on in one direction until InSync, or begin nearer with MasterStartDistance"
        }
        E::IntVelZero => {
            "give the path a velocity (F) greater than 0 before its first element, and an override above 0"
        }
        E::IntNoStopAtEnd => {
            "let the last element end at rest: run SMC_CheckVelocities as the last block before the interpolator"
        }
        E::IntDataUnderrun => {
            "give the blocks before the interpolator more time or a larger queue, and set bEndOfList behind the last element"
        }
        E::IntVelNonzeroAtStop | E::IntNoCheckvelocities => {
            "call SMC_CheckVelocities as the last block before the interpolator"
        }
        E::IntTooManyRecursions | E::IntPathExceeded => {
            "this should not happen: keep the program and the block's inputs, and report it"
        }
        E::Int2dirBufferTooSmall
        | E::GcvBufferTooSmall
        | E::RncfBufferTooSmall
        | E::RncqBufferTooSmall => "give the block a larger buffer",
        E::Int2dirPathFitsNotInQueue => {
            "give the queue a buffer for the whole path, for going backwards needs all of it, or shorten the path"
        }
        E::WarIntOutqueueTooSmall => {
            "give the queue a larger buffer: the look-ahead must reach over every stop"
        }
        E::WarEndVelocitiesIncorrect => {
            "call SMC_CheckVelocities last; elements ask for end velocities that their lengths do not allow"
        }
        E::CvAccDecVelNonpositive => {
            "program velocity (F), acceleration (E) and deceleration (E-) other than 0"
        }
        E::DecAccTooLittle => "program an acceleration (E) greater than 0",
        E::DecRetTooLittle => "program a deceleration (E-) less than 0",
        E::DecOutqueueRanEmpty => {
            "give the decoder more time than the interpolator needs, or a larger queue"
        }
        E::GcvBufferWrongType => "give an ARRAY OF SMC_GCODE_TEXT as buffer",
        E::GcvUnknownIpoLine => {
            "give the block the same program that the interpolator runs, and a buffer that holds the lines ahead"
        }
        E::NoCncRefType => "give a variable of the type SMC_CNC_REF",
        E::NoOutqueueType => "give a pointer to an SMC_OUTQUEUE",
        E::RncfFileDoesntExist => {
            "check name and folder of the file, and that the controller may read it"
        }
        E::RncfNoBuffer | E::RncqNoBuffer => "give pBuffer and dwBufferSize",
        E::RncfDataUnderrun => {
            "wait until the file has been read on; read it in a slower task with a larger buffer"
        }
        E::RncfVarCouldntBeReplaced => {
            "add the variable of the program to the list, its name in upper case"
        }
        E::RncfNotVarlist => "give a pointer to an SMC_VARLIST as pvl",
        E::RncqFileDoesntExist | E::AdlFileCannotBeOpened | E::RcamFileDoesntExist => {
            "check name and folder of the file, and that the controller may open it"
        }
        E::RncqUnexpectedEof | E::RcamUnexpectedEof => "write the file again: it is cut off",
        E::AdlBufferOverrun => "call the action WriteToFile more often, or log fewer values",
        E::RcamTooMuchData => {
            "raise gc_SMC_FILE_MAXCAMEL and gc_SMC_FILE_MAXCAMTAP, or thin the cam out (`twin cam convert --tolerance`)"
        }
        E::RcamWrongCompileType => {
            "compile the cam as the block expects it, or give the block a cam of the other kind"
        }
        E::RcamWrongVersion => "write the file again with this version",
        E::WdpfChannelOccupied => "wait until the other block has read its parameters",
        E::WdpfCannotCreateFile => {
            "check name and folder of the file, and that the controller may write there"
        }
        E::WdpfErrorWhenReadingParams | E::WdpfTimeoutPreparingList => {
            "check that the drive is powered and its wire sound, and the list's parameters ones that it has"
        }
        E::EncDenomZero => "set dwRatioTechUnitsDenom of the encoder to another value than 0",
        E::EncAxisusedbyotherfb => {
            "move another axis: that of an encoder only follows what it measures"
        }
    }
}
