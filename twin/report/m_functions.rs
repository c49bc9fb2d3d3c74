//! Report of M functions.

use crate::m_function::MCalls;
use twin_number::{rounded, seconds};

/// M functions in the order in which the path waits at them.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct MFunctionsReport {
    calls: Vec<MCallReport>,
    /// How many there are more.
    calls_left_out: u64,
}

/// One of them, with its words.
#[derive(Clone, Debug, serde::Serialize)]
struct MCallReport {
    m: u16,
    time_s: f64,
    line: u32,
    block: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    l: Option<f64>,
    /// `dP1` to `dP8` of the parameter set that O names, or of the global one.
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<[f64; 8]>,
}

impl MFunctionsReport {
    /// None if there are no M functions.
    pub(crate) fn new(calls: &MCalls) -> Option<Self> {
        let rows = calls.first().iter().map(|call| MCallReport {
            m: call.number,
            time_s: rounded(seconds(call.since_ns)),
            line: call.place.line,
            block: call.place.block,
            k: call.parameters.k,
            l: call.parameters.l,
            parameters: call.parameters.o,
        });
        let calls_left_out = calls.left_out();
        (!calls.first().is_empty()).then(|| Self { calls: rows.collect(), calls_left_out })
    }
}
