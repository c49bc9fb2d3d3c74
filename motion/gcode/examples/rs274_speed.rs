//! Lines per second with which programs of RS274 are decoded; `tests/speed/speed.py` compares them with LinuxCNC's.
//!
//! ```text
//! cargo run --release -p twin-gcode --example rs274_speed -- program.ngc
//! ```

use std::error::Error;
use std::fs::File;
use std::io::BufReader;
use std::time::Instant;
use twin_gcode::rs274::{Decoder, DecoderOptions, Item};

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args_os().skip(1) {
        let start = Instant::now();
        let mut decoder =
            Decoder::new(BufReader::new(File::open(&path)?), DecoderOptions::default());
        let mut elements = 0_u32;
        for item in decoder.by_ref() {
            elements += u32::from(matches!(item?, Item::Element(_)));
        }
        let (lines, seconds) = (decoder.lines(), start.elapsed().as_secs_f64());
        println!(
            "{lines} lines, {elements} elements, {seconds:.3} s, {:.0} lines/s",
            f64::from(lines) / seconds
        );
    }
    Ok(())
}
