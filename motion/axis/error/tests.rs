//! Tests of the errors: every number of the manual, with its name, in three languages.

use super::{Language, SmcError, TABLE};

/// The numbers of manual 9.3.
const MANUAL: [u16; 113] = [
    0, 1, 10, 20, 30, 31, 32, 50, 51, 70, 75, 80, 90, 91, 110, 120, 121, 122, 123, 130, 131, 140,
    141, 170, 171, 172, 173, 180, 181, 182, 183, 201, 202, 226, 227, 251, 252, 276, 277, 301, 302,
    325, 326, 350, 351, 375, 376, 400, 401, 402, 410, 426, 427, 451, 452, 453, 600, 601, 602, 625,
    626, 627, 628, 675, 676, 677, 725, 726, 750, 775, 1001, 1002, 1003, 1004, 1005, 1006, 1007,
    1050, 1051, 1080, 1081, 1100, 1200, 1201, 1202, 1300, 1301, 1302, 1500, 1501, 2000, 2001, 2002,
    2003, 2004, 2005, 2050, 2051, 2052, 2053, 2100, 2101, 2200, 2201, 2202, 2203, 2204, 3001, 3002,
    3003, 3004, 5000, 5001,
];

#[test]
fn every_number_of_the_manual_is_there() {
    for number in MANUAL {
        let error = SmcError::from_number(number);
        assert_eq!(error.map(SmcError::number), Some(number), "{number}");
    }
    assert_eq!(SmcError::ALL.len(), MANUAL.len());
    let known = (0..=u16::MAX).filter(|number| SmcError::from_number(*number).is_some());
    assert!(known.eq(MANUAL), "a number too many");
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

#[test]
fn names_are_the_manuals() {
    // Samples through all groups; 131 is the one the manual prints under the name of 130.
    for (number, name, raised_by) in [
        (0, "SMC_NO_ERROR", "every block"),
        (10, "SMC_DI_SWLIMITS_EXCEEDED", "drive interface"),
        (20, "SMC_REGULATOR_OR_START_NOT_SET", "motion blocks"),
        (51, "SMC_3SH_MODE_NEEDS_HWLIMIT", "SMC_Homing"),
        (131, "SMC_RP_REQUESTING_ERROR", "MC_ReadParameter"),
        (276, "SMC_MSI_INVALID_VELACC_VALUES", "MC_MoveSuperImposed"),
        (453, "SMC_MCA_DIRECTION_NOT_APPLICABLE", "SMC_MoveContinuousAbsolute"),
        (626, "SMC_CI_MASTER_OUT_OF_SCALE", "MC_CamIn"),
        (775, "SMC_GIP_MASTER_DIRECTION_CHANGE", "SMC_GearInPos"),
        (1003, "SMC_INT_DATA_UNDERRUN", "SMC_Interpolator"),
        (5001, "SMC_ENC_AXISUSEDBYOTHERFB", "SMC_Encoder"),
    ] {
        let error = SmcError::from_number(number).expect("a number");
        assert_eq!((error.name(), error.raised_by()), (name, raised_by), "{number}");
    }
    for (index, error) in SmcError::ALL.iter().enumerate() {
        assert!(error.name().starts_with("SMC_"), "{error}");
        let same = SmcError::ALL.iter().skip(index + 1).any(|other| other.name() == error.name());
        assert!(!same, "{} twice", error.name());
    }
}

/// What is no name of a block has words of its own in every language.
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
            named.map(str::to_owned).collect::<std::collections::BTreeSet<_>>()
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

/// What is advised is not what raises the error: the direction of an end velocity is no way round.
#[test]
fn directions_of_end_velocities_are_told() {
    for error in [SmcError::McrInvalidDirection, SmcError::McaInvalidDirection] {
        let remedy = error.remedy(Language::English);
        assert!(remedy.starts_with("give positive, negative or current as EndVelocityDirection"));
    }
}
