//! Tests of the start of `MC_CamIn`: against the coupling itself, shifted by whole passes, and at the begin of runs.

use super::found::{LIFT, Random, cam, using};
use crate::cam::check::{AxisLimits, CamCheck, CamUse};
use crate::finding::Rule;
use std::sync::Arc;
use twin_cam::{CamCoupling, CamTable, CouplingError};
use twin_machine::cam_file::CamFile;
use twin_profile::State;

/// 100 forwards in every pass.
const SHEAR: &str = r#"
name = "shear"
master = { min = 0, max = 300, unit = "mm" }
slave = { min = 0, max = 100, unit = "mm" }
elements = [{ master = 0, slave = 0, velocity = 0.2 }, { master = 300, slave = 100, velocity = 0.2 }]
"#;

fn at(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

/// The coupling of a use of the cam, started with the master there.
fn started(file: &CamFile, using: &CamUse, master: f64) -> Result<CamCoupling, CouplingError> {
    let mut table = CamTable::new(Arc::new(file.cam.clone()));
    table.periodic = using.repeated;
    CamCoupling::start(table, using.coupling.input, &at(master, 0.0), &at(0.0, 0.0), 0)
}

fn random_use(random: &mut Random, file: &CamFile) -> CamUse {
    let mut use_it = using(file, 1.0, AxisLimits::NONE);
    use_it.repeated = random.share() < 0.5;
    let input = &mut use_it.coupling.input;
    input.master_offset = random.between(-900.0, 900.0);
    input.master_scaling = random.between(0.5, 2.0) * if random.share() < 0.5 { 1.0 } else { -1.0 };
    input.slave_offset = random.between(-10.0, 10.0);
    input.slave_scaling = random.between(-2.0, 2.0);
    use_it
}

/// It starts where the block does, and nowhere else; the ends of the range are told.
#[test]
fn it_starts_where_the_block_does() {
    let (lift, shear) = (cam(LIFT), cam(SHEAR));
    let mut random = Random(9);
    let mut both = [0; 2];
    for round in 0..400 {
        let file = if round % 2 == 0 { &lift } else { &shear };
        let mut use_it = random_use(&mut random, file);
        let [from, to] = use_it.starts(file.cam.curve());
        let width = to - from;
        for master in
            [from - 0.01 * width, from + 0.01 * width, to - 0.01 * width, to + 0.01 * width]
        {
            let block = started(file, &use_it, master);
            assert_eq!(
                use_it.starts_at(file.cam.curve(), master),
                block.is_ok(),
                "{use_it:?} {master}"
            );
            assert_eq!(block.is_ok(), from < master && master < to);
            both[usize::from(block.is_ok())] += 1;
            use_it.start = Some(master);
            let check = CamCheck::new(file, use_it);
            let told = check.findings.iter().any(|finding| finding.rule == Rule::Coupling);
            assert_eq!(told, block.is_err());
            assert_eq!(check.json()["start"]["starts"], block.is_ok());
        }
    }
    assert_eq!(both, [800, 800]);
}

/// What is told in place of an offset that does not start does, and the slave goes the same way; with a slave that goes round
/// what whole passes gain need not be told.
#[test]
fn whole_passes_are_the_same_motion() {
    let (lift, shear) = (cam(LIFT), cam(SHEAR));
    let mut random = Random(4);
    let mut folded = 0;
    for round in 0..300 {
        let file = if round % 2 == 0 { &lift } else { &shear };
        let use_it = random_use(&mut random, file);
        let master = random.between(-500.0, 500.0);
        let Some(told) = use_it.folded(file, master) else {
            assert!(!use_it.repeated || started(file, &use_it, master).is_ok());
            continue;
        };
        folded += 1;
        let mut coupling = started(file, &told, master).expect("it starts");
        let wanted = |master: f64| {
            let y = file.cam.curve().repeated(use_it.place_at(master)).position;
            use_it.slave_at(y)
        };
        for step in 0..50_u32 {
            let now = master + 20.0 * f64::from(step);
            let slave = coupling.step(&at(now, 0.0), i64::from(step)).expect("on the cam").slave;
            assert!((slave.position - wanted(now)).abs() < 1e-6, "{use_it:?} {told:?} {now}");
        }
    }
    assert!(folded > 60, "{folded}");
    // A decimal stays one; twice 100 forwards are 200 less.
    let mut use_it = using(&shear, 1.0, AxisLimits::NONE);
    use_it.repeated = true;
    use_it.coupling.input.master_offset = -1.8;
    let told = use_it.folded(&shear, 0.0).expect("another pass").coupling.input;
    assert_eq!((told.master_offset, told.slave_offset), (298.2, -100.0));
    use_it.limits.period = Some(50.0);
    let told = use_it.folded(&shear, -300.0).expect("another pass").coupling.input;
    assert_eq!((told.master_offset, told.slave_offset), (598.2, 0.0));
    // One that is passed once does not come again.
    use_it.repeated = false;
    assert_eq!(use_it.folded(&shear, 0.0), None);
    use_it.start = Some(0.0);
    let finding = CamCheck::new(&shear, use_it).findings.remove(0);
    assert!(
        finding.message.contains("error 626: the master at 0 mm is at -1.8 of the cam"),
        "{}",
        finding.message
    );
    let hint = finding.hint.expect("what to do");
    for words in ["from 1.8 to 301.8 mm", "MasterOffset from 0 to 300"] {
        assert!(hint.contains(words), "{hint}");
    }
}
