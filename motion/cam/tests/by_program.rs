//! Test of the manual's example of a cam that a program fills (4.7.1).

use crate::{
    Cam, CamCoupling, CamError, CamInput, CamTable, Interpolation, PairTable, Shape, TableScale,
    VariableType,
};
use std::sync::Arc;
use twin_profile::State;

/// `SMC_CAMTable_UINT_128_1` with `Table[i][0] := Table[i][1] := REAL_TO_UINT(i / 127.0 * 65536)`, both scales 0 … 360 u for
/// 0 … 65536.
fn filled(last: f64) -> PairTable {
    let scale = TableScale { min: 0.0, max: 360.0, table_min: 0.0, table_max: 65_536.0 };
    let mut pairs: Vec<_> =
        (0..127_u8).map(|i| [(f64::from(i) / 127.0 * 65_536.0).round(); 2]).collect();
    pairs.push([last; 2]);
    PairTable {
        variable: VariableType::Uint,
        master: scale,
        slave: scale,
        periodic: false,
        interpolation: Interpolation::Linear,
        pairs,
    }
}

/// Straight, so that the slave is where the master is, from `MC_CamTableSelect` through `MC_CamIn`. The last number of the manual,
/// 65536, does not fit a UINT: it is refused, and 65535 takes its place.
#[test]
fn a_cam_filled_by_program() {
    let refused = filled(65_536.0).curve();
    assert!(
        matches!(&refused, Err(CamError::OutsideType { index: 128, kind: "UINT", .. })),
        "{refused:?}"
    );
    let cam = Cam::new("straight", Shape::Pairs(filled(65_535.0)), Vec::new()).unwrap();
    assert_eq!(cam.shape().len(), 128);
    let table = CamTable { periodic: false, ..CamTable::new(Arc::new(cam)) };
    let at = |position: f64| State { position, velocity: 90.0, acceleration: 0.0 };
    let mut coupling =
        CamCoupling::start(table, CamInput::default(), &at(0.0), &at(0.0), 0).unwrap();
    for cycle in 1..=399_i32 {
        let master = 0.9 * f64::from(cycle);
        let now_ns = i64::from(cycle) * 10_000_000;
        let slave = coupling.step(&at(master), now_ns).unwrap().slave;
        assert!((slave.position - master).abs() < 1e-9, "{master}: {}", slave.position);
        assert!((slave.velocity - 90.0).abs() < 1e-9, "{master}: {}", slave.velocity);
    }
    // Behind its end, 65535/65536 of 360 u, the slave stays.
    let end = 360.0 * 65_535.0 / 65_536.0;
    let coupled = coupling.step(&at(360.0), 4_000_000_000).unwrap();
    assert!(coupled.end_of_profile && (coupled.slave.position - end).abs() < 1e-9);
}
