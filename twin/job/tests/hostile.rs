//! Fuzz tests: malformed jobs cause no panic, and every finding has a line of the file.

use super::{job, machine};
use crate::job::JobSetpoints;
use crate::setpoint_source::PlanItem;
use proptest::prelude::*;
use std::sync::LazyLock;
use twin_machine::Machine;

static MACHINE: LazyLock<Machine> = LazyLock::new(machine);

const TEXT: &str = "duration_s = 0.1\n[[start]]\naxis = \"X\"\nposition_mm = 60\n[[virtual_axes]]\nname = \"web\"\n\
    kind = \"linear\"\nmax_acceleration_mm_per_s2 = 400\n[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"Y\"\nmaster = \"web\"\n\
    ratio_numerator = 1\nratio_denominator = 20\n[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"web\"\n\
    velocity_mm_per_s = 250\n[[blocks]]\nblock = \"MC_PositionProfile\"\naxis = \"X\"\n\
    with_previous = true\npoints = [{ delta_s = 0.05, position_mm = 61 }, { delta_s = 0.05, position_mm = 60 }]\n";

const PIECES: [&str; 32] = [
    "\n",
    "=",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "nan",
    "-inf",
    "1e999",
    "-1e308",
    "1e9",
    "0",
    "-1",
    "0x1",
    "99999999999999999999",
    "\u{0}",
    "ä",
    "[[blocks]]\n",
    "block = \"MC_CamIn\"\n",
    "axis = \"Y\"\n",
    "at_s = 0.01\n",
    "master = \"X\"\n",
    "block = \"MC_Home\"\n",
    "cam = \"job.toml\"\n",
    "block = \"MC_TouchProbe\"\ntrigger = \"mark\"\n",
    "[[triggers]]\nname = \"mark\"\nat_s = 0.01\n",
    "block = \"SMC_FollowPositionVelocity\"\n",
    "block = \"SMC_ControlAxisByVel\"\n",
    "points = [{ delta_s = 1e-6, position_mm = 1e9, velocity_mm_per_s = 0 }]\n",
    "at_end_of_profile = true\n",
    "#",
];

/// The shipped one.
const SHIPPED: &str = include_str!("../../../examples/jobs/flying_shear.toml");

/// Set-points that are checked of a job that is valid after all.
const ENOUGH: usize = 300;

/// Where a text is cut, how far, and what comes in.
type Change = (prop::sample::Index, usize, usize);

fn changes() -> impl Strategy<Value = Vec<Change>> {
    proptest::collection::vec((any::<prop::sample::Index>(), 0usize..30, 0..PIECES.len()), 1..6)
}

fn spoilt(text: &str, changes: Vec<Change>) -> String {
    let mut text: Vec<char> = text.chars().collect();
    for (place, length, piece) in changes {
        let start = place.index(text.len() + 1);
        let end = (start + length).min(text.len());
        text.splice(start..end, PIECES[piece].chars());
    }
    text.into_iter().collect()
}

fn survives(text: &str) {
    let job = job(text);
    // CR alone ends a line in a file without LF.
    let lines = u32::try_from(text.split(['\n', '\r']).count()).unwrap();
    for item in JobSetpoints::open(&MACHINE, &job.program).unwrap().take(ENOUGH) {
        match item {
            PlanItem::Axes(setpoint) => {
                assert!(setpoint.axes.position.iter().all(|value| value.is_finite()), "{text}");
            }
            PlanItem::Diagnostic(finding) => {
                assert!((1..=lines).contains(&finding.line), "{finding:?} in\n{text}");
                assert!(!finding.message.is_empty());
            }
            PlanItem::Tool(_) | PlanItem::Bridging(_) | PlanItem::Io(_) => panic!("a job has none"),
        }
    }
}

#[test]
fn the_job_is_right_before_it_is_spoilt() {
    let job = job(TEXT);
    let items = JobSetpoints::open(&MACHINE, &job.program).unwrap();
    assert!(items.map(|item| assert!(matches!(item, PlanItem::Axes(_)), "{item:?}")).count() > 100);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        survives(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn jobs_with_pieces_moved_are_survived(changes in changes()) {
        survives(&spoilt(TEXT, changes));
    }

    #[test]
    fn the_shipped_job_with_pieces_moved_is_survived(changes in changes()) {
        let cams = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/cams/");
        survives(&spoilt(&SHIPPED.replace("../cams/", cams), changes));
    }

    #[test]
    fn jobs_with_other_numbers_are_survived(
        which in any::<prop::sample::Index>(),
        number in prop_oneof![any::<f64>().prop_map(|number| format!("{number:e}")), any::<i64>().prop_map(|number| number.to_string())],
    ) {
        let starts: Vec<_> = TEXT.match_indices("= ").map(|(at, _)| at + 2)
            .filter(|at| TEXT[*at..].starts_with(|c: char| c.is_ascii_digit())).collect();
        let start = starts[which.index(starts.len())];
        let end = start + TEXT[start..].find([' ', '\n', ',']).unwrap();
        survives(&format!("{}{number}{}", &TEXT[..start], &TEXT[end..]));
    }
}
