//! `twin explain` as a process. Numbers, names and raisers are those of manual 9.3.

use crate::desk::Desk;

#[test]
fn an_error_in_the_language_asked_for() {
    let desk = Desk::new();
    let said = |arguments: &str| {
        let done = desk.twin(&format!("explain {arguments}"));
        done.ended(0, "");
        done.stdout
    };
    let english = said("626 --language en");
    for part in
        ["626 SMC_CI_MASTER_OUT_OF_SCALE", "raised by: MC_CamIn", "what to do: bring the master"]
    {
        assert!(english.contains(part), "{english}");
    }
    assert!(said("smc_gi_ratio_denom --language de").contains("675 SMC_GI_RATIO_DENOM"));
    let german = said("675 --language de");
    assert!(german.contains("was zu tun ist: RatioDenominator auf einen"), "{german}");
    let french = said("675 --language fr");
    assert!(french.contains("que faire: donner à RatioDenominator"), "{french}");
    // Names of blocks stay, the words around them do not.
    assert!(german.contains("gemeldet von: MC_GearIn"), "{german}");
    assert!(french.contains("signalée par: MC_GearIn"), "{french}");
    for (language, words, table) in [
        ("de", "gemeldet von: Bewegungsbausteinen", "gemeldet von"),
        ("fr", "signalée par: les blocs de mouvement", "signalée par"),
    ] {
        let one = said(&format!("20 --language {language}"));
        assert!(one.contains(words) && !one.contains("raised by"), "{one}");
        let list = said(&format!("--list --language {language}"));
        assert!(list.contains(table) && !list.contains("raised by"), "{list}");
        assert!(!list.contains("every block") && !list.contains("drive interface"), "{list}");
    }
    let all = said("775 1003 --language all");
    for part in [
        "775 SMC_GIP_MASTER_DIRECTION_CHANGE",
        "1003 SMC_INT_DATA_UNDERRUN",
        "Deutsch: ",
        "français : ",
        "what to do: ",
        "was zu tun ist: ",
        "que faire: ",
    ] {
        assert!(all.contains(part), "{all}");
    }
    assert!(said("axis-velocity").contains("an axis asked for more than its velocity"));
}

/// A block of jobs is explained with its errors and its inputs in a job, also the one that runs a program.
#[test]
fn blocks_of_jobs_are_explained() {
    let desk = Desk::new();
    for (block, error) in [
        ("MC_CamIn", "626 SMC_CI_MASTER_OUT_OF_SCALE"),
        ("SMC_Interpolator", "1001 SMC_INT_VEL_ZERO"),
    ] {
        desk.twin(&format!("explain {block}"))
            .ended(0, "")
            .says(error)
            .says("its inputs in a job: ");
    }
}

/// Rules of axes are explained for programs, and for cams and jobs, which raise them, too.
#[test]
fn rules_of_axes_are_explained_for_cams_too() {
    let desk = Desk::new();
    for (rule, words) in [
        ("axis-position", ["SlaveOffset", "--find slave-offset,slave-scaling"]),
        ("axis-velocity", ["the master is too fast", "`twin cam check` says"]),
        ("axis-acceleration", ["whose square", "--ramp-in finds a ramp"]),
        ("axis-jerk", ["the cube of its master's velocity", "--minimise jerk finds scalings"]),
        ("axis-effort", ["the motor of a slave", "slow the master down"]),
    ] {
        let done = desk.twin(&format!("explain {rule}"));
        done.ended(0, "");
        for words in ["of cams and jobs: ", "what to do there: "].into_iter().chain(words) {
            assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
        }
        let object = desk.twin(&format!("explain {rule} --format json")).object();
        for words in words {
            let of_cams = object["of_cams"].to_string();
            assert!(of_cams.contains(words), "{words} in {of_cams}");
        }
    }
    let done = desk.twin("explain arc-geometry");
    assert!(!done.stdout.contains("of cams"), "{}", done.stdout);
}

#[test]
fn all_errors_as_a_table_and_as_objects() {
    let desk = Desk::new();
    let done = desk.twin("explain --list --language en");
    done.ended(0, "");
    done.says_all(&["5001", "SMC_ENC_AXISUSEDBYOTHERFB", "SMC_Encoder", "following-error"]);
    let objects = desk.twin("explain --list --format json").ended(0, "").rows();
    // 113 rows in the table of manual 9.3.
    assert_eq!(objects.iter().filter(|object| object["number"].is_u64()).count(), 113);
    let error = objects.iter().find(|object| object["number"] == 10).expect("10");
    assert_eq!(error["name"], "SMC_DI_SWLIMITS_EXCEEDED");
    for language in ["en", "de", "fr"] {
        assert!(error["text"][language].as_str().is_some_and(|text| text.len() > 10), "{error}");
        assert!(error["remedies"][language].as_str().is_some_and(|text| text.contains("MC_Reset")));
    }
}

#[test]
fn what_is_not_known_is_suggested() {
    let desk = Desk::new();
    desk.twin("explain 629").ended(2, "628 SMC_CI_SCALING_INCORRECT");
    desk.twin("explain SMC_CI_MASTER_OUT_OF_SCAL 10")
        .ended(2, "did you mean SMC_CI_MASTER_OUT_OF_SCALE")
        .says("10 SMC_DI_SWLIMITS_EXCEEDED");
    desk.twin("explain").ended(2, "NUMBER|NAME");
}
