//! Tests of the errors: numbers, names and blocks of the manual's list (9.3), and texts in three languages.

use super::{Language, SmcError, TABLE};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Number, name and block of every row; the names without the blanks of line breaks.
const PRINTED: [(u16, &str, &str); 113] = [
    (0, "SMC_NO_ERROR", "tous"),
    (1, "SMC_DI_GENERAL_COMMUNICATION_ERROR", "DriveInterface"),
    (10, "SMC_DI_SWLIMITS_EXCEEDED", "DriveInterface"),
    (20, "SMC_REGULATOR_OR_START_NOT_SET", "Tous les modules générant un mouvement"),
    (30, "SMC_FB_WASNT_CALLED_DURING_MOTION", "DriveInterface"),
    (31, "SMC_AXIS_IS_NO_AXIS_REF", "Tous les modules"),
    (32, "SMC_AXIS_REF_CHANGED_DURING_OPERATION", "Tous les modules générant un mouvement"),
    (50, "SMC_3SH_INVALID_VELACC_VALUES", "SMC_Homing"),
    (51, "SMC_3SH_MODE_NEEDS_HWLIMIT", "SMC_Homing"),
    (70, "SMC_SCM_NOT_SUPPORTED", "SMC_SetControllerMode"),
    (75, "SMC_ST_WRONG_CONTROLLER_MODE", "SMC_SetTorque"),
    (80, "SMC_RAG_ERROR_DURING_STARTUP", "SMC_ResetAxisGroup"),
    (90, "SMC_CGR_ZERO_VALUES", "SMC_ChangeGearingRatio"),
    (91, "SMC_CGR_DRIVE_POWERED", "SMC_ChangeGearingRatio"),
    (110, "SMC_P_FTASKCYCLE_EMPTY", "MC_Power"),
    (120, "SMC_R_NO_ERROR_TO_RESET", "MC_Reset"),
    (121, "SMC_R_DRIVE_DOESNT_ANSWER", "MC_Reset"),
    (122, "SMC_R_ERROR_NOT_RESETTABLE", "MC_Reset"),
    (123, "SMC_R_DRIVE_DOESNT_ANSWER_IN_TIME", "MC_Reset"),
    (130, "SMC_RP_PARAM_UNKNOWN", "MC_ReadParameter, MC_ReadBoolParameter"),
    (131, "SMC_RP_PARAM_UNKNOWN", "MC_ReadParameter, MC_ReadBoolParameter"),
    (140, "SMC_WP_PARAM_INVALID", "MC_WriteParameter, MC_WriteBoolParameter"),
    (141, "SMC_WP_SENDING_ERROR", "MC_WriteParameter, MC_WriteBoolParameter"),
    (170, "SMC_H_AXIS_WASNT_STANDSTILL", "MC_Home"),
    (171, "SMC_H_AXIS_DIDNT_START_HOMING", "MC_Home"),
    (172, "SMC_H_AXIS_DIDNT_ANSWER", "MC_Home"),
    (173, "SMC_H_ERROR_WHEN_STOPPING", "MC_Home"),
    (180, "SMC_MS_UNKNOWN_STOPPING_ERROR", "MC_Stop"),
    (181, "SMC_MS_INVALID_ACCDEC_VALUES", "MC_Stop"),
    (182, "SMC_MS_DIRECTION_NOT_APPLICABLE", "MC_Stop"),
    (183, "SMC_MS_AXIS_IN_ERRORSTOP", "MC_Stop"),
    (201, "SMC_MA_INVALID_VELACC_VALUES", "MC_MoveAbsolute"),
    (202, "SMC_MA_INVALID_DIRECTION", "MC_MoveAbsolute"),
    (226, "SMC_MR_INVALID_VELACC_VALUES", "MC_MoveRelative"),
    (227, "SMC_MR_INVALID_DIRECTION", "MC_MoveRelative"),
    (251, "SMC_MAD_INVALID_VELACC_VALUES", "MC_MoveAdditive"),
    (252, "SMC_MAD_INVALID_DIRECTION", "MC_MoveAdditive"),
    (276, "SMC_MSI_INVALID_VELACC_VALUES", "MC_MoveAdditive"),
    (277, "SMC_MSI_INVALID_DIRECTION", "MC_MoveAdditive"),
    (301, "SMC_MV_INVALID_ACCDEC_VALUES", "MC_MoveVelocity"),
    (302, "SMC_MV_DIRECTION_NOT_APPLICABLE", "MC_MoveVelocity"),
    (325, "SMC_PP_ARRAYSIZE", "MC_PositionProfile"),
    (326, "SMC_PP_STEP0MS", "MC_PositionProfile"),
    (350, "SMC_VP_ARRAYSIZE", "MC_VelocityProfile"),
    (351, "SMC_VP_STEP0MS", "MC_VelocityProfile"),
    (375, "SMC_AP_ARRAYSIZE", "MC_AccelerationProfile"),
    (376, "SMC_AP_STEP0MS", "MC_AccelerationProfile"),
    (400, "SMC_TP_TRIGGEROCCUPIED", "MC_TouchProbe"),
    (401, "SMC_TP_COULDNT_SET_WINDOW", "MC_TouchProbe"),
    (402, "SMC_TP_COMM_ERROR", "MC_TouchProbe"),
    (410, "SMC_AT_TRIGGERNOTOCCUPIED", "MC_AbortTrigger"),
    (426, "SMC_MCR_INVALID_VELACC_VALUES", "SMC_MoveContinuousRelative"),
    (427, "SMC_MCR_INVALID_DIRECTION", "SMC_MoveContinuousRelative"),
    (451, "SMC_MCA_INVALID_VELACC_VALUES", "SMC_MoveContinuousAbsolute"),
    (452, "SMC_MCA_INVALID_DIRECTION", "SMC_MoveContinuousAbsolute"),
    (453, "SMC_MCA_DIRECTION_NOT_APPLICABLE", "SMC_MoveContinuousAbsolute"),
    (600, "SMC_CR_NO_TAPPETS_IN_CAM", "SMC_CamRegister"),
    (601, "SMC_CR_TOO_MANY_TAPPETS", "SMC_CamRegister"),
    (602, "SMC_CR_MORE_THAN_32_ACCESSES", "SMC_CamRegister"),
    (625, "SMC_CI_NO_CAM_SELECTED", "MC_CamIN"),
    (626, "SMC_CI_MASTER_OUT_OF_SCALE", "MC_CamIN"),
    (627, "SMC_CI_RAMPIN_NEEDS_VELACC_VALUES", "MC_CamIn"),
    (628, "SMC_CI_SCALING_INCORRECT", "MC_CamIn"),
    (675, "SMC_GI_RATIO_DENOM", "MC_GearIn"),
    (676, "SMC_GI_INVALID_ACC", "MC_GearIn"),
    (677, "SMC_GI_INVALID_DEC", "MC_GearIn"),
    (725, "SMC_PH_INVALID_VELACCDEC", "MC_Phase"),
    (726, "SMC_PH_ROTARYAXIS_PERIOD0", "MC_Phase"),
    (750, "SMC_NO_CAM_REF_TYPE", "Tous les modules qui utilisent MC_CAM_REF comme entrée"),
    (775, "SMC_GIP_MASTER_DIRECTION_CHANGE", "MC_GearInPos"),
    (1001, "SMC_INT_VEL_ZERO", "SMC_Interpolator"),
    (1002, "SMC_INT_NO_STOP_AT_END", "SMC_Interpolator"),
    (1003, "SMC_INT_DATA_UNDERRUN", "SMC_Interpolator"),
    (1004, "SMC_INT_VEL_NONZERO_AT_STOP", "SMC_Interpolator"),
    (1005, "SMC_INT_TOO_MANY_RECURSIONS", "SMC_Interpolator"),
    (1006, "SMC_INT_NO_CHECKVELOCITIES", "SMC_Interpolator"),
    (1007, "SMC_INT_PATH_EXCEEDED", "SMC_Interpolator"),
    (1050, "SMC_INT2DIR_BUFFER_TOO_SMALL", "SMC_Interpolator2Dir"),
    (1051, "SMC_INT2DIR_PATH_FITS_NOT_IN_QUEUE", "SMC_Interpolator2Dir"),
    (1080, "SMC_WAR_INT_OUTQUEUE_TOO_SMALL", "SMC_Interpolator"),
    (1081, "SMC_WAR_END_VELOCITIES_INCORRECT", "SMC_Interpolator"),
    (1100, "SMC_CV_ACC_DEC_VEL_NONPOSITIVE", "SMC_CheckVelocities"),
    (1200, "SMC_DEC_ACC_TOO_LITTLE", "SMC_NCDecoder"),
    (1201, "SMC_DEC_RET_TOO_LITTLE", "SMC_NCDecoder"),
    (1202, "SMC_DEC_OUTQUEUE_RAN_EMPTY", "SMC_NCDecoder"),
    (1300, "SMC_GCV_BUFFER_TOO_SMALL", "SMC_GCodeViewer"),
    (1301, "SMC_GCV_BUFFER_WRONG_TYPE", "SMC_GCodeViewer"),
    (1302, "SMC_GCV_UNKNOWN_IPO_LINE", "SMC_GCodeViewer"),
    (1500, "SMC_NO_CNC_REF_TYPE", "Tous les modules fonctionnels qui utilisent SMC_CNC_REF"),
    (1501, "SMC_NO_OUTQUEUE_TYPE", "Tous les modules fonctionnels qui utilisent SMC_OUTQUEUE"),
    (2000, "SMC_RNCF_FILE_DOESNT_EXIST", "SMC_ReadNCFile"),
    (2001, "SMC_RNCF_NO_BUFFER", "SMC_ReadNCFile"),
    (2002, "SMC_RNCF_BUFFER_TOO_SMALL", "SMC_ReadNCFile"),
    (2003, "SMC_RNCF_DATA_UNDERRUN", "SMC_ReadNCFile"),
    (2004, "SMC_RNCF_VAR_COULDNT_BE_REPLACED", "SMC_ReadNCFile"),
    (2005, "SMC_RNCF_NOT_VARLIST", "SMC_ReadNCFile"),
    (2050, "SMC_RNCQ_FILE_DOESNT_EXIST", "SMC_ReadNCQueue"),
    (2051, "SMC_RNCQ_NO_BUFFER", "SMC_ReadNCQueue"),
    (2052, "SMC_RNCQ_BUFFER_TOO_SMALL", "SMC_ReadNCQueue"),
    (2053, "SMC_RNCQ_UNEXPECTED_EOF", "SMC_ReadNCQueue"),
    (2100, "SMC_ADL_FILE_CANNOT_BE_OPENED", "SMC_AxisDiagnosticLog"),
    (2101, "SMC_ADL_BUFFER_OVERRUN", "SMC_AxisDiagnosticLog"),
    (2200, "SMC_RCAM_FILE_DOESNT_EXIST", "SMC_ReadCAM"),
    (2201, "SMC_RCAM_TOO_MUCH_DATA", "SMC_ReadCAM"),
    (2202, "SMC_RCAM_WRONG_COMPILE_TYPE", "SMC_ReadCAM"),
    (2203, "SMC_RCAM_WRONG_VERSION", "SMC_ReadCAM"),
    (2204, "SMC_RCAM_UNEXPECTED_EOF", "SMC_ReadCAM"),
    (3001, "SMC_WDPF_CHANNEL_OCCUPIED", "SMC_WriteDriveParamsToFile"),
    (3002, "SMC_WDPF_CANNOT_CREATE_FILE", "SMC_WriteDriveParamsToFile"),
    (3003, "SMC_WDPF_ERROR_WHEN_READING_PARAMS", "SMC_WriteDriveParamsToFile"),
    (3004, "SMC_WDPF_TIMEOUT_PREPARING_LIST", "SMC_WriteDriveParamsToFile"),
    (5000, "SMC_ENC_DENOM_ZERO", "SMC_Encoder"),
    (5001, "SMC_ENC_AXISUSEDBYOTHERFB", "SMC_Encoder"),
];

/// Where the manual's row is wrong or says more than one block: number, name and block that are meant. The name of 131 is
/// printed as that of 130, the blocks of 276 and 277 as those of 251.
const MEANT: [(u16, &str, &str); 24] = [
    (0, "SMC_NO_ERROR", "every block"),
    (1, "SMC_DI_GENERAL_COMMUNICATION_ERROR", "drive interface"),
    (10, "SMC_DI_SWLIMITS_EXCEEDED", "drive interface"),
    (20, "SMC_REGULATOR_OR_START_NOT_SET", "motion blocks"),
    (30, "SMC_FB_WASNT_CALLED_DURING_MOTION", "drive interface"),
    (31, "SMC_AXIS_IS_NO_AXIS_REF", "every block"),
    (32, "SMC_AXIS_REF_CHANGED_DURING_OPERATION", "motion blocks"),
    (130, "SMC_RP_PARAM_UNKNOWN", "MC_ReadParameter"),
    (131, "SMC_RP_REQUESTING_ERROR", "MC_ReadParameter"),
    (140, "SMC_WP_PARAM_INVALID", "MC_WriteParameter"),
    (141, "SMC_WP_SENDING_ERROR", "MC_WriteParameter"),
    (276, "SMC_MSI_INVALID_VELACC_VALUES", "MC_MoveSuperImposed"),
    (277, "SMC_MSI_INVALID_DIRECTION", "MC_MoveSuperImposed"),
    (600, "SMC_CR_NO_TAPPETS_IN_CAM", "SMC_CAMRegister"),
    (601, "SMC_CR_TOO_MANY_TAPPETS", "SMC_CAMRegister"),
    (602, "SMC_CR_MORE_THAN_32_ACCESSES", "SMC_CAMRegister"),
    (625, "SMC_CI_NO_CAM_SELECTED", "MC_CamIn"),
    (626, "SMC_CI_MASTER_OUT_OF_SCALE", "MC_CamIn"),
    (725, "SMC_PH_INVALID_VELACCDEC", "MC_Phasing"),
    (726, "SMC_PH_ROTARYAXIS_PERIOD0", "MC_Phasing"),
    (750, "SMC_NO_CAM_REF_TYPE", "blocks that take a cam"),
    (775, "SMC_GIP_MASTER_DIRECTION_CHANGE", "SMC_GearInPos"),
    (1500, "SMC_NO_CNC_REF_TYPE", "blocks that take a CNC program"),
    (1501, "SMC_NO_OUTQUEUE_TYPE", "blocks that take a queue"),
];

#[test]
fn every_number_of_the_manual_is_there() {
    let manual = PRINTED.map(|(number, ..)| number);
    for number in manual {
        let error = SmcError::from_number(number);
        assert_eq!(error.map(SmcError::number), Some(number), "{number}");
    }
    let known = (0..=u16::MAX).filter(|number| SmcError::from_number(*number).is_some());
    assert!(known.eq(manual), "a number too many");
}

/// A constant of the manual, and unique.
#[test]
fn names_are_unique() {
    let names: BTreeSet<_> = SmcError::ALL.iter().map(|error| error.name()).collect();
    assert_eq!(names.len(), SmcError::ALL.len());
    assert!(names.iter().all(|name| name.starts_with("SMC_")));
}

#[test]
fn names_are_the_manuals() {
    assert_eq!(SmcError::ALL.len(), PRINTED.len());
    for (error, printed) in SmcError::ALL.iter().zip(PRINTED) {
        let meant = MEANT.iter().find(|(number, ..)| *number == printed.0);
        let expected = *meant.unwrap_or(&printed);
        assert_eq!((error.number(), error.name(), error.raised_by()), expected);
    }
    // Only 131 has another name than printed.
    let other = |(number, name, _): &&(u16, &str, &str)| {
        !PRINTED.iter().any(|(printed, same, _)| printed == number && same == name)
    };
    assert_eq!(MEANT.iter().filter(other).map(|(number, ..)| *number).collect::<Vec<_>>(), [131]);
}

/// The rows above are those of the manual's text. Skipped where that is not at hand.
#[test]
fn the_list_is_the_manuals() {
    let Some(path) = text() else {
        println!("skipped: no text of the manual (TWIN_SHARED, ../shared)");
        return;
    };
    let text =
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    // Four columns: number, block, name and description.
    let rows = text.lines().filter_map(|line| {
        let cells: Vec<_> = line.split('\t').collect();
        let [number, block, name, _] = cells.as_slice() else { return None };
        let name = name.replace(' ', "");
        let number: u16 = number.parse().ok()?;
        name.starts_with("SMC_").then(|| (number, name, (*block).to_owned()))
    });
    let printed = PRINTED.map(|(number, name, block)| (number, name.to_owned(), block.to_owned()));
    assert_eq!(rows.collect::<Vec<_>>(), printed);
}

fn text() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.parent()?;
    let shared = env::var_os("TWIN_SHARED").map_or(workspace.join("../shared"), PathBuf::from);
    let path = shared.join("manuals/softmotion-2.3.fr.txt");
    path.is_file().then_some(path)
}

/// The table has a row per error, in the order of the numbers, with its name and a text in every column.
#[test]
fn every_error_has_its_row() {
    let rows: Vec<Vec<_>> = TABLE.lines().skip(1).map(|row| row.split('\t').collect()).collect();
    let heads: Vec<_> = rows.iter().map(|row| (row[0].to_owned(), row[1])).collect();
    let errors = SmcError::ALL.iter().map(|error| (error.number().to_string(), error.name()));
    assert_eq!(heads, errors.collect::<Vec<_>>());
    for row in rows {
        assert_eq!(row.len(), 11, "{row:?}");
        assert!(row.iter().all(|cell| !cell.is_empty() && cell.trim() == *cell), "{row:?}");
    }
}

/// Raisers that are not the name of a block have a text in every language.
#[test]
fn raisers_are_told_in_three_languages() {
    for error in SmcError::ALL {
        let english = error.raised_by();
        let [german, french] = [Language::German, Language::French].map(|l| error.raised_by_in(l));
        assert_eq!(error.raised_by_in(Language::English), english);
        if english.starts_with("SMC_") || english.starts_with("MC_") {
            assert_eq!([german, french], [english; 2], "{error}");
        } else {
            assert!(german != english && french != english && german != french, "{error}");
        }
    }
}

#[test]
fn every_error_has_a_text_in_three_languages() {
    for error in SmcError::ALL {
        let texts = [Language::English, Language::German, Language::French].map(|l| error.text(l));
        for text in texts {
            // An IEC STRING(100) holds it (SMC_ErrorString).
            assert!((5..=100).contains(&text.chars().count()), "{error}: {text}");
        }
        let [english, german, french] = texts;
        assert!(english != german && german != french && french != english, "{error}");
    }
    let mut german = 0;
    for error in SmcError::ALL {
        let all = [Language::English, Language::German, Language::French];
        let [english, other, french] = all.map(|language| error.remedy(language));
        for text in [english, other, french] {
            assert!(text.chars().count() >= 15, "{error}: {text}");
        }
        assert!(english != other && other != french && french != english, "{error}");
        // Names of inputs, blocks and constants are the same in all of them.
        let names = |text: &str| {
            let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let named = words.filter(|word| word.contains('_') && word.len() > 4);
            named.map(str::to_owned).collect::<BTreeSet<_>>()
        };
        assert_eq!(names(english), names(other), "{error}");
        assert_eq!(names(english), names(french), "{error}");
        german += usize::from(other.contains('ä') || other.contains('ü') || other.contains('ö'));
    }
    assert!(german > 20, "{german}");
    let error = SmcError::CiMasterOutOfScale;
    assert_eq!(
        error.text(Language::German),
        "der Master ist außerhalb des Bereichs der Kurvenscheibe"
    );
    assert_eq!(error.text(Language::French), "l'axe maître est en dehors de la plage de la came");
    assert_eq!(
        error.to_string(),
        "626 SMC_CI_MASTER_OUT_OF_SCALE: the master is outside the range of the cam"
    );
}

/// The remedy names the directions that an end velocity may have.
#[test]
fn directions_of_end_velocities_are_told() {
    for error in [SmcError::McrInvalidDirection, SmcError::McaInvalidDirection] {
        let remedy = error.remedy(Language::English);
        assert!(remedy.starts_with("give positive, negative or current as EndVelocityDirection"));
    }
}
