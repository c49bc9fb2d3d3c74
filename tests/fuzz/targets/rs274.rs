//! Fuzz target: any bytes as a program of RS274, decoded, planned and sampled.

#![no_main]

mod path;

use libfuzzer_sys::fuzz_target;
use std::io::BufReader;
use twin_gcode::rs274::{
    Decoder, DecoderOptions, FlowLimits, MAX_CYCLE_MOVES, ProbePath, ProbeTarget, Surroundings,
};
use twin_path::ElementKind;

/// Every other probing move trips, a third of the way along.
#[derive(Debug, Default)]
struct Sometimes(bool);

impl ProbeTarget for Sometimes {
    fn trip(&mut self, _: &ProbePath) -> Option<f64> {
        self.0 = !self.0;
        self.0.then_some(1.0 / 3.0)
    }
}

/// Loops and calls of an input.
const JUMPS: usize = 5;

fuzz_target!(|program: &[u8]| {
    // A line is executed once for each jump at most, and a line of a few bytes can be a canned cycle or a thread.
    let lines = program.split(|byte| *byte == b'\n').count();
    let cycles =
        program.windows(2).filter(|pair| matches!(pair, [_, b'7' | b'8'])).count().min(lines);
    let most = (JUMPS + 1) * (4 * (program.len() + 2) + cycles * (MAX_CYCLE_MOVES + 16));
    // Inputs that ask for many holes only take long.
    if cycles > 20 {
        return;
    }
    for keep_empty_moves in [false, true] {
        let flow_limits = FlowLimits { jumps: JUMPS as u64, ..FlowLimits::default() };
        let surroundings = keep_empty_moves.then(|| Surroundings::new(Sometimes::default));
        let options = DecoderOptions {
            keep_empty_moves,
            surroundings,
            flow_limits,
            ..DecoderOptions::default()
        };
        let path = path::decoded(Decoder::new(program, options.clone()), most);
        // However it is cut into pieces, it is the same.
        let pieces = BufReader::with_capacity(3, program);
        assert_eq!(path, path::decoded(Decoder::new(pieces, options), most));
        // The path of the controlled point never jumps but where a block could not be executed.
        let waits = |kind| matches!(kind, ElementKind::Dwell { .. });
        let path: Vec<_> = path.into_iter().filter(|element| !waits(element.kind)).collect();
        path::sampled(path::prepared(&path, &path::by_marks(&path)), false, |_| None);
    }
});
