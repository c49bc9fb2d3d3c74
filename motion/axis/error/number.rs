//! Error numbers and names (manual 9.3). The names of 131, 276, 277, 401, 410, 426, 427 and 451–453 are corrected,
//! because the manual mixes up these rows.

/// Writes the enumeration and its table from one list.
macro_rules! smc_errors {
    ($($number:literal $variant:ident $name:literal;)*) => {
        /// An error or warning of `SoftMotion` by its number (`SMC_Error`, manual 9.3).
        #[doc(alias = "SMC_Error")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u16)]
        #[non_exhaustive]
        pub enum SmcError {
            $(
                #[doc = concat!("`", $name, "`.")]
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
                self as u16
            }

            /// The name in the manual's enumeration.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
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
    0 NoError "SMC_NO_ERROR";
    1 DiGeneralCommunicationError "SMC_DI_GENERAL_COMMUNICATION_ERROR";
    10 DiSwlimitsExceeded "SMC_DI_SWLIMITS_EXCEEDED";
    20 RegulatorOrStartNotSet "SMC_REGULATOR_OR_START_NOT_SET";
    30 FbWasntCalledDuringMotion "SMC_FB_WASNT_CALLED_DURING_MOTION";
    31 AxisIsNoAxisRef "SMC_AXIS_IS_NO_AXIS_REF";
    32 AxisRefChangedDuringOperation "SMC_AXIS_REF_CHANGED_DURING_OPERATION";
    50 HomingInvalidVelaccValues "SMC_3SH_INVALID_VELACC_VALUES";
    51 HomingModeNeedsHwlimit "SMC_3SH_MODE_NEEDS_HWLIMIT";
    70 ScmNotSupported "SMC_SCM_NOT_SUPPORTED";
    75 StWrongControllerMode "SMC_ST_WRONG_CONTROLLER_MODE";
    80 RagErrorDuringStartup "SMC_RAG_ERROR_DURING_STARTUP";
    90 CgrZeroValues "SMC_CGR_ZERO_VALUES";
    91 CgrDrivePowered "SMC_CGR_DRIVE_POWERED";
    110 PFtaskcycleEmpty "SMC_P_FTASKCYCLE_EMPTY";
    120 RNoErrorToReset "SMC_R_NO_ERROR_TO_RESET";
    121 RDriveDoesntAnswer "SMC_R_DRIVE_DOESNT_ANSWER";
    122 RErrorNotResettable "SMC_R_ERROR_NOT_RESETTABLE";
    123 RDriveDoesntAnswerInTime "SMC_R_DRIVE_DOESNT_ANSWER_IN_TIME";
    130 RpParamUnknown "SMC_RP_PARAM_UNKNOWN";
    131 RpRequestingError "SMC_RP_REQUESTING_ERROR";
    140 WpParamInvalid "SMC_WP_PARAM_INVALID";
    141 WpSendingError "SMC_WP_SENDING_ERROR";
    170 HAxisWasntStandstill "SMC_H_AXIS_WASNT_STANDSTILL";
    171 HAxisDidntStartHoming "SMC_H_AXIS_DIDNT_START_HOMING";
    172 HAxisDidntAnswer "SMC_H_AXIS_DIDNT_ANSWER";
    173 HErrorWhenStopping "SMC_H_ERROR_WHEN_STOPPING";
    180 MsUnknownStoppingError "SMC_MS_UNKNOWN_STOPPING_ERROR";
    181 MsInvalidAccdecValues "SMC_MS_INVALID_ACCDEC_VALUES";
    182 MsDirectionNotApplicable "SMC_MS_DIRECTION_NOT_APPLICABLE";
    183 MsAxisInErrorstop "SMC_MS_AXIS_IN_ERRORSTOP";
    201 MaInvalidVelaccValues "SMC_MA_INVALID_VELACC_VALUES";
    202 MaInvalidDirection "SMC_MA_INVALID_DIRECTION";
    226 MrInvalidVelaccValues "SMC_MR_INVALID_VELACC_VALUES";
    227 MrInvalidDirection "SMC_MR_INVALID_DIRECTION";
    251 MadInvalidVelaccValues "SMC_MAD_INVALID_VELACC_VALUES";
    252 MadInvalidDirection "SMC_MAD_INVALID_DIRECTION";
    276 MsiInvalidVelaccValues "SMC_MSI_INVALID_VELACC_VALUES";
    277 MsiInvalidDirection "SMC_MSI_INVALID_DIRECTION";
    301 MvInvalidAccdecValues "SMC_MV_INVALID_ACCDEC_VALUES";
    302 MvDirectionNotApplicable "SMC_MV_DIRECTION_NOT_APPLICABLE";
    325 PpArraysize "SMC_PP_ARRAYSIZE";
    326 PpStep0ms "SMC_PP_STEP0MS";
    350 VpArraysize "SMC_VP_ARRAYSIZE";
    351 VpStep0ms "SMC_VP_STEP0MS";
    375 ApArraysize "SMC_AP_ARRAYSIZE";
    376 ApStep0ms "SMC_AP_STEP0MS";
    400 TpTriggeroccupied "SMC_TP_TRIGGEROCCUPIED";
    401 TpCouldntSetWindow "SMC_TP_COULDNT_SET_WINDOW";
    402 TpCommError "SMC_TP_COMM_ERROR";
    410 AtTriggernotoccupied "SMC_AT_TRIGGERNOTOCCUPIED";
    426 McrInvalidVelaccValues "SMC_MCR_INVALID_VELACC_VALUES";
    427 McrInvalidDirection "SMC_MCR_INVALID_DIRECTION";
    451 McaInvalidVelaccValues "SMC_MCA_INVALID_VELACC_VALUES";
    452 McaInvalidDirection "SMC_MCA_INVALID_DIRECTION";
    453 McaDirectionNotApplicable "SMC_MCA_DIRECTION_NOT_APPLICABLE";
    600 CrNoTappetsInCam "SMC_CR_NO_TAPPETS_IN_CAM";
    601 CrTooManyTappets "SMC_CR_TOO_MANY_TAPPETS";
    602 CrMoreThan32Accesses "SMC_CR_MORE_THAN_32_ACCESSES";
    625 CiNoCamSelected "SMC_CI_NO_CAM_SELECTED";
    626 CiMasterOutOfScale "SMC_CI_MASTER_OUT_OF_SCALE";
    627 CiRampinNeedsVelaccValues "SMC_CI_RAMPIN_NEEDS_VELACC_VALUES";
    628 CiScalingIncorrect "SMC_CI_SCALING_INCORRECT";
    675 GiRatioDenom "SMC_GI_RATIO_DENOM";
    676 GiInvalidAcc "SMC_GI_INVALID_ACC";
    677 GiInvalidDec "SMC_GI_INVALID_DEC";
    725 PhInvalidVelaccdec "SMC_PH_INVALID_VELACCDEC";
    726 PhRotaryaxisPeriod0 "SMC_PH_ROTARYAXIS_PERIOD0";
    750 NoCamRefType "SMC_NO_CAM_REF_TYPE";
    775 GipMasterDirectionChange "SMC_GIP_MASTER_DIRECTION_CHANGE";
    1001 IntVelZero "SMC_INT_VEL_ZERO";
    1002 IntNoStopAtEnd "SMC_INT_NO_STOP_AT_END";
    1003 IntDataUnderrun "SMC_INT_DATA_UNDERRUN";
    1004 IntVelNonzeroAtStop "SMC_INT_VEL_NONZERO_AT_STOP";
    1005 IntTooManyRecursions "SMC_INT_TOO_MANY_RECURSIONS";
    1006 IntNoCheckvelocities "SMC_INT_NO_CHECKVELOCITIES";
    1007 IntPathExceeded "SMC_INT_PATH_EXCEEDED";
    1050 Int2dirBufferTooSmall "SMC_INT2DIR_BUFFER_TOO_SMALL";
    1051 Int2dirPathFitsNotInQueue "SMC_INT2DIR_PATH_FITS_NOT_IN_QUEUE";
    1080 WarIntOutqueueTooSmall "SMC_WAR_INT_OUTQUEUE_TOO_SMALL";
    1081 WarEndVelocitiesIncorrect "SMC_WAR_END_VELOCITIES_INCORRECT";
    1100 CvAccDecVelNonpositive "SMC_CV_ACC_DEC_VEL_NONPOSITIVE";
    1200 DecAccTooLittle "SMC_DEC_ACC_TOO_LITTLE";
    1201 DecRetTooLittle "SMC_DEC_RET_TOO_LITTLE";
    1202 DecOutqueueRanEmpty "SMC_DEC_OUTQUEUE_RAN_EMPTY";
    1300 GcvBufferTooSmall "SMC_GCV_BUFFER_TOO_SMALL";
    1301 GcvBufferWrongType "SMC_GCV_BUFFER_WRONG_TYPE";
    1302 GcvUnknownIpoLine "SMC_GCV_UNKNOWN_IPO_LINE";
    1500 NoCncRefType "SMC_NO_CNC_REF_TYPE";
    1501 NoOutqueueType "SMC_NO_OUTQUEUE_TYPE";
    2000 RncfFileDoesntExist "SMC_RNCF_FILE_DOESNT_EXIST";
    2001 RncfNoBuffer "SMC_RNCF_NO_BUFFER";
    2002 RncfBufferTooSmall "SMC_RNCF_BUFFER_TOO_SMALL";
    2003 RncfDataUnderrun "SMC_RNCF_DATA_UNDERRUN";
    2004 RncfVarCouldntBeReplaced "SMC_RNCF_VAR_COULDNT_BE_REPLACED";
    2005 RncfNotVarlist "SMC_RNCF_NOT_VARLIST";
    2050 RncqFileDoesntExist "SMC_RNCQ_FILE_DOESNT_EXIST";
    2051 RncqNoBuffer "SMC_RNCQ_NO_BUFFER";
    2052 RncqBufferTooSmall "SMC_RNCQ_BUFFER_TOO_SMALL";
    2053 RncqUnexpectedEof "SMC_RNCQ_UNEXPECTED_EOF";
    2100 AdlFileCannotBeOpened "SMC_ADL_FILE_CANNOT_BE_OPENED";
    2101 AdlBufferOverrun "SMC_ADL_BUFFER_OVERRUN";
    2200 RcamFileDoesntExist "SMC_RCAM_FILE_DOESNT_EXIST";
    2201 RcamTooMuchData "SMC_RCAM_TOO_MUCH_DATA";
    2202 RcamWrongCompileType "SMC_RCAM_WRONG_COMPILE_TYPE";
    2203 RcamWrongVersion "SMC_RCAM_WRONG_VERSION";
    2204 RcamUnexpectedEof "SMC_RCAM_UNEXPECTED_EOF";
    3001 WdpfChannelOccupied "SMC_WDPF_CHANNEL_OCCUPIED";
    3002 WdpfCannotCreateFile "SMC_WDPF_CANNOT_CREATE_FILE";
    3003 WdpfErrorWhenReadingParams "SMC_WDPF_ERROR_WHEN_READING_PARAMS";
    3004 WdpfTimeoutPreparingList "SMC_WDPF_TIMEOUT_PREPARING_LIST";
    5000 EncDenomZero "SMC_ENC_DENOM_ZERO";
    5001 EncAxisusedbyotherfb "SMC_ENC_AXISUSEDBYOTHERFB";
}
