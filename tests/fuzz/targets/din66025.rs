//! Any bytes as a program of SoftMotion's dialect: decoded, checked, planned and sampled as far as a machine would
//! wait.

#![no_main]

use libfuzzer_sys::fuzz_target;
use twin_motion::decode::{Failure, Item};
use twin_motion::din66025::{Decoder, DecoderOptions};
use twin_motion::interpolate::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};
use twin_motion::prepare::{CheckError, CheckVelocities};

/// Set-points sampled at most.
const SETPOINTS: usize = 10_000;

fuzz_target!(|program: &[u8]| {
    let decoder = Decoder::new(program, DecoderOptions::default());
    let elements = decoder.filter_map(|item| match item {
        Ok(Item::Element(element)) => Some(Ok::<_, CheckError>(element)),
        Ok(Item::Warning(_)) | Err(Failure::Diagnostic(_)) => None,
        Err(Failure::Io(error)) => panic!("reading from memory: {error}"),
    });
    let planned = LookAhead::new(CheckVelocities::new(elements, 0.03));
    for setpoint in Interpolator::new(planned, DEFAULT_CYCLE_NS).take(SETPOINTS).flatten() {
        assert!(setpoint.position.iter().all(|coordinate| coordinate.is_finite()));
        assert!(setpoint.path_velocity <= setpoint.feed * (1.0 + 1e-9));
    }
});
