//! Fuzz target: any bytes as a program of RS274, decoded, also for one of the controls, planned and sampled, and written.

#![no_main]

mod path;

use libfuzzer_sys::fuzz_target;
use std::io::BufReader;
use twin_gcode::rs274::{
    Control, Decoder, DecoderOptions, FlowLimits, MAX_CYCLE_MOVES, ProbePath, ProbeTarget,
    ProgramWriter, Surroundings, WriteOptions,
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
    // LinuxCNC's rules, or those of a control.
    let control = Control::ALL.get(program.len() % 8).copied();
    for keep_empty_moves in [false, true] {
        let flow_limits = FlowLimits { jumps: JUMPS as u64, ..FlowLimits::default() };
        let surroundings = keep_empty_moves.then(|| Surroundings::new(|_| Sometimes::default()));
        let options = DecoderOptions {
            keep_empty_moves,
            surroundings,
            flow_limits,
            control: control.filter(|_| keep_empty_moves),
            strict: control.is_none() && keep_empty_moves,
            keep_words: keep_empty_moves,
            ..DecoderOptions::default()
        };
        let path = path::decoded(Decoder::new(program, options.clone()), most);
        // However it is cut into pieces, it is the same.
        let pieces = BufReader::with_capacity(3, program);
        assert_eq!(path, path::decoded(Decoder::new(pieces, options), most));
        // The path of the controlled point never jumps but where a block could not be executed.
        let waits = |kind| matches!(kind, ElementKind::Dwell { .. });
        let written = WriteOptions { control, ..WriteOptions::default() };
        if let Ok(mut writer) = ProgramWriter::new(Vec::new(), written) {
            // Whatever cannot be written is an error.
            if path.iter().try_for_each(|element| writer.write(element)).is_ok() {
                assert!(writer.finish().is_ok());
            }
        }
        let path: Vec<_> = path.into_iter().filter(|element| !waits(element.kind)).collect();
        path::sampled(path::prepared(&path, &path::by_marks(&path)), false, |_| None);
    }
});
