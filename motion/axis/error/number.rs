//! The numbers, names and raisers (manual 9.3; the names of 131, 276, 277, 401, 410, 426, 427 and 451–453 are those
//! that fit, where the manual's rows were mixed up).

use super::Language;
use super::{english, french, german};

/// Writes the enumeration and its table from one list.
macro_rules! smc_errors {
    ($($number:literal $variant:ident $name:literal $raised_by:literal;)*) => {
        /// An error or warning of `SoftMotion` by its number (`SMC_Error`, manual 9.3).
        #[doc(alias = "SMC_Error")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u16)]
        #[non_exhaustive]
        pub enum SmcError {
            $(
                #[doc = concat!("`", $name, "`, raised by: ", $raised_by, ".")]
                #[doc(alias = $name)]
                $variant = $number,
            )*
        }

        impl SmcError {
            /// Every error in the order of the numbers.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The number, as `ErrorID` shows it.
            #[must_use]
            pub const fn number(self) -> u16 {
                match self { $(Self::$variant => $number),* }
            }

            /// The name in the manual's enumeration.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// Which blocks raise it.
            #[must_use]
            pub const fn raised_by(self) -> &'static str {
                match self { $(Self::$variant => $raised_by),* }
            }

            /// The error of a number; none if the manual lists none.
            #[must_use]
            pub const fn from_number(number: u16) -> Option<Self> {
                match number { $($number => Some(Self::$variant),)* _ => None }
            }
        }
    };
}

smc_errors! {
    0 NoError "SMC_NO_ERROR" "every block";
    1 DiGeneralCommunicationError "SMC_DI_GENERAL_COMMUNICATION_ERROR" "drive interface";
    10 DiSwlimitsExceeded "SMC_DI_SWLIMITS_EXCEEDED" "drive interface";
    20 RegulatorOrStartNotSet "SMC_REGULATOR_OR_START_NOT_SET" "motion blocks";
    30 FbWasntCalledDuringMotion "SMC_FB_WASNT_CALLED_DURING_MOTION" "drive interface";
    31 AxisIsNoAxisRef "SMC_AXIS_IS_NO_AXIS_REF" "every block";
    32 AxisRefChangedDuringOperation "SMC_AXIS_REF_CHANGED_DURING_OPERATION" "motion blocks";
    50 HomingInvalidVelaccValues "SMC_3SH_INVALID_VELACC_VALUES" "SMC_Homing";
    51 HomingModeNeedsHwlimit "SMC_3SH_MODE_NEEDS_HWLIMIT" "SMC_Homing";
    70 ScmNotSupported "SMC_SCM_NOT_SUPPORTED" "SMC_SetControllerMode";
    75 StWrongControllerMode "SMC_ST_WRONG_CONTROLLER_MODE" "SMC_SetTorque";
    80 RagErrorDuringStartup "SMC_RAG_ERROR_DURING_STARTUP" "SMC_ResetAxisGroup";
    90 CgrZeroValues "SMC_CGR_ZERO_VALUES" "SMC_ChangeGearingRatio";
    91 CgrDrivePowered "SMC_CGR_DRIVE_POWERED" "SMC_ChangeGearingRatio";
    110 PFtaskcycleEmpty "SMC_P_FTASKCYCLE_EMPTY" "MC_Power";
    120 RNoErrorToReset "SMC_R_NO_ERROR_TO_RESET" "MC_Reset";
    121 RDriveDoesntAnswer "SMC_R_DRIVE_DOESNT_ANSWER" "MC_Reset";
    122 RErrorNotResettable "SMC_R_ERROR_NOT_RESETTABLE" "MC_Reset";
    123 RDriveDoesntAnswerInTime "SMC_R_DRIVE_DOESNT_ANSWER_IN_TIME" "MC_Reset";
    130 RpParamUnknown "SMC_RP_PARAM_UNKNOWN" "MC_ReadParameter";
    131 RpRequestingError "SMC_RP_REQUESTING_ERROR" "MC_ReadParameter";
    140 WpParamInvalid "SMC_WP_PARAM_INVALID" "MC_WriteParameter";
    141 WpSendingError "SMC_WP_SENDING_ERROR" "MC_WriteParameter";
    170 HAxisWasntStandstill "SMC_H_AXIS_WASNT_STANDSTILL" "MC_Home";
    171 HAxisDidntStartHoming "SMC_H_AXIS_DIDNT_START_HOMING" "MC_Home";
    172 HAxisDidntAnswer "SMC_H_AXIS_DIDNT_ANSWER" "MC_Home";
    173 HErrorWhenStopping "SMC_H_ERROR_WHEN_STOPPING" "MC_Home";
    180 MsUnknownStoppingError "SMC_MS_UNKNOWN_STOPPING_ERROR" "MC_Stop";
    181 MsInvalidAccdecValues "SMC_MS_INVALID_ACCDEC_VALUES" "MC_Stop";
    182 MsDirectionNotApplicable "SMC_MS_DIRECTION_NOT_APPLICABLE" "MC_Stop";
    183 MsAxisInErrorstop "SMC_MS_AXIS_IN_ERRORSTOP" "MC_Stop";
    201 MaInvalidVelaccValues "SMC_MA_INVALID_VELACC_VALUES" "MC_MoveAbsolute";
    202 MaInvalidDirection "SMC_MA_INVALID_DIRECTION" "MC_MoveAbsolute";
    226 MrInvalidVelaccValues "SMC_MR_INVALID_VELACC_VALUES" "MC_MoveRelative";
    227 MrInvalidDirection "SMC_MR_INVALID_DIRECTION" "MC_MoveRelative";
    251 MadInvalidVelaccValues "SMC_MAD_INVALID_VELACC_VALUES" "MC_MoveAdditive";
    252 MadInvalidDirection "SMC_MAD_INVALID_DIRECTION" "MC_MoveAdditive";
    276 MsiInvalidVelaccValues "SMC_MSI_INVALID_VELACC_VALUES" "MC_MoveSuperImposed";
    277 MsiInvalidDirection "SMC_MSI_INVALID_DIRECTION" "MC_MoveSuperImposed";
    301 MvInvalidAccdecValues "SMC_MV_INVALID_ACCDEC_VALUES" "MC_MoveVelocity";
    302 MvDirectionNotApplicable "SMC_MV_DIRECTION_NOT_APPLICABLE" "MC_MoveVelocity";
    325 PpArraysize "SMC_PP_ARRAYSIZE" "MC_PositionProfile";
    326 PpStep0ms "SMC_PP_STEP0MS" "MC_PositionProfile";
    350 VpArraysize "SMC_VP_ARRAYSIZE" "MC_VelocityProfile";
    351 VpStep0ms "SMC_VP_STEP0MS" "MC_VelocityProfile";
    375 ApArraysize "SMC_AP_ARRAYSIZE" "MC_AccelerationProfile";
    376 ApStep0ms "SMC_AP_STEP0MS" "MC_AccelerationProfile";
    400 TpTriggeroccupied "SMC_TP_TRIGGEROCCUPIED" "MC_TouchProbe";
    401 TpCouldntSetWindow "SMC_TP_COULDNT_SET_WINDOW" "MC_TouchProbe";
    402 TpCommError "SMC_TP_COMM_ERROR" "MC_TouchProbe";
    410 AtTriggernotoccupied "SMC_AT_TRIGGERNOTOCCUPIED" "MC_AbortTrigger";
    426 McrInvalidVelaccValues "SMC_MCR_INVALID_VELACC_VALUES" "SMC_MoveContinuousRelative";
    427 McrInvalidDirection "SMC_MCR_INVALID_DIRECTION" "SMC_MoveContinuousRelative";
    451 McaInvalidVelaccValues "SMC_MCA_INVALID_VELACC_VALUES" "SMC_MoveContinuousAbsolute";
    452 McaInvalidDirection "SMC_MCA_INVALID_DIRECTION" "SMC_MoveContinuousAbsolute";
    453 McaDirectionNotApplicable "SMC_MCA_DIRECTION_NOT_APPLICABLE" "SMC_MoveContinuousAbsolute";
    600 CrNoTappetsInCam "SMC_CR_NO_TAPPETS_IN_CAM" "SMC_CAMRegister";
    601 CrTooManyTappets "SMC_CR_TOO_MANY_TAPPETS" "SMC_CAMRegister";
    602 CrMoreThan32Accesses "SMC_CR_MORE_THAN_32_ACCESSES" "SMC_CAMRegister";
    625 CiNoCamSelected "SMC_CI_NO_CAM_SELECTED" "MC_CamIn";
    626 CiMasterOutOfScale "SMC_CI_MASTER_OUT_OF_SCALE" "MC_CamIn";
    627 CiRampinNeedsVelaccValues "SMC_CI_RAMPIN_NEEDS_VELACC_VALUES" "MC_CamIn";
    628 CiScalingIncorrect "SMC_CI_SCALING_INCORRECT" "MC_CamIn";
    675 GiRatioDenom "SMC_GI_RATIO_DENOM" "MC_GearIn";
    676 GiInvalidAcc "SMC_GI_INVALID_ACC" "MC_GearIn";
    677 GiInvalidDec "SMC_GI_INVALID_DEC" "MC_GearIn";
    725 PhInvalidVelaccdec "SMC_PH_INVALID_VELACCDEC" "MC_Phasing";
    726 PhRotaryaxisPeriod0 "SMC_PH_ROTARYAXIS_PERIOD0" "MC_Phasing";
    750 NoCamRefType "SMC_NO_CAM_REF_TYPE" "blocks that take a cam";
    775 GipMasterDirectionChange "SMC_GIP_MASTER_DIRECTION_CHANGE" "SMC_GearInPos";
    1001 IntVelZero "SMC_INT_VEL_ZERO" "SMC_Interpolator";
    1002 IntNoStopAtEnd "SMC_INT_NO_STOP_AT_END" "SMC_Interpolator";
    1003 IntDataUnderrun "SMC_INT_DATA_UNDERRUN" "SMC_Interpolator";
    1004 IntVelNonzeroAtStop "SMC_INT_VEL_NONZERO_AT_STOP" "SMC_Interpolator";
    1005 IntTooManyRecursions "SMC_INT_TOO_MANY_RECURSIONS" "SMC_Interpolator";
    1006 IntNoCheckvelocities "SMC_INT_NO_CHECKVELOCITIES" "SMC_Interpolator";
    1007 IntPathExceeded "SMC_INT_PATH_EXCEEDED" "SMC_Interpolator";
    1050 Int2dirBufferTooSmall "SMC_INT2DIR_BUFFER_TOO_SMALL" "SMC_Interpolator2Dir";
    1051 Int2dirPathFitsNotInQueue "SMC_INT2DIR_PATH_FITS_NOT_IN_QUEUE" "SMC_Interpolator2Dir";
    1080 WarIntOutqueueTooSmall "SMC_WAR_INT_OUTQUEUE_TOO_SMALL" "SMC_Interpolator";
    1081 WarEndVelocitiesIncorrect "SMC_WAR_END_VELOCITIES_INCORRECT" "SMC_Interpolator";
    1100 CvAccDecVelNonpositive "SMC_CV_ACC_DEC_VEL_NONPOSITIVE" "SMC_CheckVelocities";
    1200 DecAccTooLittle "SMC_DEC_ACC_TOO_LITTLE" "SMC_NCDecoder";
    1201 DecRetTooLittle "SMC_DEC_RET_TOO_LITTLE" "SMC_NCDecoder";
    1202 DecOutqueueRanEmpty "SMC_DEC_OUTQUEUE_RAN_EMPTY" "SMC_NCDecoder";
    1300 GcvBufferTooSmall "SMC_GCV_BUFFER_TOO_SMALL" "SMC_GCodeViewer";
    1301 GcvBufferWrongType "SMC_GCV_BUFFER_WRONG_TYPE" "SMC_GCodeViewer";
    1302 GcvUnknownIpoLine "SMC_GCV_UNKNOWN_IPO_LINE" "SMC_GCodeViewer";
    1500 NoCncRefType "SMC_NO_CNC_REF_TYPE" "blocks that take a CNC program";
    1501 NoOutqueueType "SMC_NO_OUTQUEUE_TYPE" "blocks that take a queue";
    2000 RncfFileDoesntExist "SMC_RNCF_FILE_DOESNT_EXIST" "SMC_ReadNCFile";
    2001 RncfNoBuffer "SMC_RNCF_NO_BUFFER" "SMC_ReadNCFile";
    2002 RncfBufferTooSmall "SMC_RNCF_BUFFER_TOO_SMALL" "SMC_ReadNCFile";
    2003 RncfDataUnderrun "SMC_RNCF_DATA_UNDERRUN" "SMC_ReadNCFile";
    2004 RncfVarCouldntBeReplaced "SMC_RNCF_VAR_COULDNT_BE_REPLACED" "SMC_ReadNCFile";
    2005 RncfNotVarlist "SMC_RNCF_NOT_VARLIST" "SMC_ReadNCFile";
    2050 RncqFileDoesntExist "SMC_RNCQ_FILE_DOESNT_EXIST" "SMC_ReadNCQueue";
    2051 RncqNoBuffer "SMC_RNCQ_NO_BUFFER" "SMC_ReadNCQueue";
    2052 RncqBufferTooSmall "SMC_RNCQ_BUFFER_TOO_SMALL" "SMC_ReadNCQueue";
    2053 RncqUnexpectedEof "SMC_RNCQ_UNEXPECTED_EOF" "SMC_ReadNCQueue";
    2100 AdlFileCannotBeOpened "SMC_ADL_FILE_CANNOT_BE_OPENED" "SMC_AxisDiagnosticLog";
    2101 AdlBufferOverrun "SMC_ADL_BUFFER_OVERRUN" "SMC_AxisDiagnosticLog";
    2200 RcamFileDoesntExist "SMC_RCAM_FILE_DOESNT_EXIST" "SMC_ReadCAM";
    2201 RcamTooMuchData "SMC_RCAM_TOO_MUCH_DATA" "SMC_ReadCAM";
    2202 RcamWrongCompileType "SMC_RCAM_WRONG_COMPILE_TYPE" "SMC_ReadCAM";
    2203 RcamWrongVersion "SMC_RCAM_WRONG_VERSION" "SMC_ReadCAM";
    2204 RcamUnexpectedEof "SMC_RCAM_UNEXPECTED_EOF" "SMC_ReadCAM";
    3001 WdpfChannelOccupied "SMC_WDPF_CHANNEL_OCCUPIED" "SMC_WriteDriveParamsToFile";
    3002 WdpfCannotCreateFile "SMC_WDPF_CANNOT_CREATE_FILE" "SMC_WriteDriveParamsToFile";
    3003 WdpfErrorWhenReadingParams "SMC_WDPF_ERROR_WHEN_READING_PARAMS" "SMC_WriteDriveParamsToFile";
    3004 WdpfTimeoutPreparingList "SMC_WDPF_TIMEOUT_PREPARING_LIST" "SMC_WriteDriveParamsToFile";
    5000 EncDenomZero "SMC_ENC_DENOM_ZERO" "SMC_Encoder";
    5001 EncAxisusedbyotherfb "SMC_ENC_AXISUSEDBYOTHERFB" "SMC_Encoder";
}

impl SmcError {
    /// What it means, in a language (`SMC_ErrorString`, manual 9.2.1).
    #[doc(alias = "SMC_ErrorString")]
    #[must_use]
    pub const fn text(self, language: Language) -> &'static str {
        match language {
            Language::English => english::text(self),
            Language::German => german::text(self),
            Language::French => french::text(self),
        }
    }
}
