//! The texts in English.

use super::SmcError as E;

/// What an error means.
#[expect(clippy::too_many_lines, reason = "a table, one line an error")]
pub(super) const fn text(error: E) -> &'static str {
    match error {
        E::NoError => "no error",
        E::DiGeneralCommunicationError => {
            "communication with the drive is broken, for example an open ring"
        }
        E::DiSwlimitsExceeded => "position outside the software limits",
        E::RegulatorOrStartNotSet => "power is off or the brake is applied",
        E::FbWasntCalledDuringMotion => {
            "a block that moves the axis was not called until its motion ended"
        }
        E::AxisIsNoAxisRef => "the variable given as axis is not an AXIS_REF",
        E::AxisRefChangedDuringOperation => "another axis was given while the block was at work",
        E::HomingInvalidVelaccValues
        | E::MsInvalidAccdecValues
        | E::MaInvalidVelaccValues
        | E::MrInvalidVelaccValues
        | E::MadInvalidVelaccValues
        | E::MsiInvalidVelaccValues
        | E::MvInvalidAccdecValues
        | E::McrInvalidVelaccValues
        | E::McaInvalidVelaccValues => "velocity or acceleration is not valid",
        E::HomingModeNeedsHwlimit => "this homing mode needs the limit switches",
        E::ScmNotSupported => "the drive does not have this controller mode",
        E::StWrongControllerMode => "the axis is in another controller mode",
        E::RagErrorDuringStartup => "the axis group did not start up",
        E::CgrZeroValues => "a value is zero that must not be",
        E::CgrDrivePowered => "not while the drive is under control",
        E::PFtaskcycleEmpty => "the axis has no cycle time",
        E::RNoErrorToReset => "the axis has no error to reset",
        E::RDriveDoesntAnswer => "the drive keeps its error",
        E::RErrorNotResettable => "the error cannot be reset",
        E::RDriveDoesntAnswerInTime => "the drive did not answer in time",
        E::RpParamUnknown => "there is no parameter of this number",
        E::RpRequestingError => "reading the parameter from the drive failed",
        E::WpParamInvalid => "there is no parameter of this number, or it cannot be written",
        E::WpSendingError => "writing the parameter to the drive failed",
        E::HAxisWasntStandstill => "the axis was not at a standstill",
        E::HAxisDidntStartHoming => "the drive did not begin homing",
        E::HAxisDidntAnswer => "the drive did not answer",
        E::HErrorWhenStopping => "stopping after homing failed; is a deceleration set?",
        E::MsUnknownStoppingError => "stopping failed for an unknown reason",
        E::MsDirectionNotApplicable | E::MvDirectionNotApplicable => {
            "the shortest way is no direction here"
        }
        E::MsAxisInErrorstop => "the axis is in errorstop and cannot be stopped",
        E::MaInvalidDirection
        | E::MrInvalidDirection
        | E::MadInvalidDirection
        | E::MsiInvalidDirection
        | E::McrInvalidDirection
        | E::McaInvalidDirection => "direction is not valid",
        E::PpArraysize | E::VpArraysize | E::ApArraysize => "the number of points is not valid",
        E::PpStep0ms | E::VpStep0ms | E::ApStep0ms => "a step of the profile takes no time",
        E::TpTriggeroccupied => "the trigger is already in use",
        E::TpCouldntSetWindow => "the drive has no window for the trigger",
        E::TpCommError => "communication with the drive failed",
        E::AtTriggernotoccupied => "the trigger is not in use",
        E::McaDirectionNotApplicable => "the fastest way is no direction here",
        E::CrNoTappetsInCam => "the cam has no tappets",
        E::CrTooManyTappets => "a tappet's group number is larger than the largest allowed",
        E::CrMoreThan32Accesses => "more than 32 blocks use the cam",
        E::CiNoCamSelected => "no cam is selected",
        E::CiMasterOutOfScale => "the master is outside the range of the cam",
        E::CiRampinNeedsVelaccValues => "ramp_in needs a velocity and an acceleration",
        E::CiScalingIncorrect => "the scales of the master in the cam do not fit",
        E::GiRatioDenom => "the ratio's denominator is 0",
        E::GiInvalidAcc | E::DecAccTooLittle => "acceleration is not valid",
        E::GiInvalidDec | E::DecRetTooLittle => "deceleration is not valid",
        E::PhInvalidVelaccdec => "velocity, acceleration or deceleration is not valid",
        E::PhRotaryaxisPeriod0 => "a rotary axis has the period 0",
        E::NoCamRefType => "the variable given as cam is not a cam",
        E::GipMasterDirectionChange => "the master reversed while the slave was coupling",
        E::IntVelZero => "the path cannot be run at a velocity of 0",
        E::IntNoStopAtEnd => "the last object of the path does not end at rest",
        E::IntDataUnderrun => "the path ran out before its end was announced",
        E::IntVelNonzeroAtStop => "the velocity at a stop is not 0",
        E::IntTooManyRecursions => "internal error: too many recursions",
        E::IntNoCheckvelocities => "the velocities of the path were not checked last",
        E::IntPathExceeded => "internal error: past the end of the path",
        E::Int2dirBufferTooSmall
        | E::GcvBufferTooSmall
        | E::RncfBufferTooSmall
        | E::RncqBufferTooSmall => "the buffer is too small",
        E::Int2dirPathFitsNotInQueue => "the path does not fit into the queue as a whole",
        E::WarIntOutqueueTooSmall => "warning: the queue is too small to be sure of every stop",
        E::WarEndVelocitiesIncorrect => "warning: end velocities contradict each other",
        E::CvAccDecVelNonpositive => "velocity, acceleration or deceleration is not positive",
        E::DecOutqueueRanEmpty => "the queue ran empty",
        E::GcvBufferWrongType => "the buffer's elements are of a wrong type",
        E::GcvUnknownIpoLine => "the interpolator's line was not found",
        E::NoCncRefType => "the variable given as program is not a CNC program",
        E::NoOutqueueType => "the variable given as queue is not a queue",
        E::RncfFileDoesntExist => "the file does not exist",
        E::RncfNoBuffer | E::RncqNoBuffer => "there is no buffer",
        E::RncfDataUnderrun => "the buffer is read to its end",
        E::RncfVarCouldntBeReplaced => "a variable in the program has no value",
        E::RncfNotVarlist => "the variable list is not a variable list",
        E::RncqFileDoesntExist | E::AdlFileCannotBeOpened | E::RcamFileDoesntExist => {
            "the file cannot be opened"
        }
        E::RncqUnexpectedEof | E::RcamUnexpectedEof => "the file ends too early",
        E::AdlBufferOverrun => "the buffer overflowed; write to the file more often",
        E::RcamTooMuchData => "the cam in the file is too large",
        E::RcamWrongCompileType => "the cam in the file is of another kind",
        E::RcamWrongVersion => "the file has another version",
        E::WdpfChannelOccupied => "the channel that reads parameters is busy",
        E::WdpfCannotCreateFile => "the file cannot be created",
        E::WdpfErrorWhenReadingParams => "reading the parameters failed",
        E::WdpfTimeoutPreparingList => "the list of parameters was not ready in time",
        E::EncDenomZero => "the denominator of the encoder's ratio is 0",
        E::EncAxisusedbyotherfb => "a block moves the axis of an encoder",
    }
}
