//! Decodes programs of RS274 and nothing else, as `tests/speed/speed.py` measures it.
//!
//! ```text
//! cargo run --release -p twin-gcode --example rs274_speed -- program.ngc
//! ```

use std::error::Error;
use std::fs::File;
use std::io::BufReader;
use twin_gcode::rs274::{Decoder, DecoderOptions, Item};

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args_os().skip(1) {
        let file = BufReader::new(File::open(&path)?);
        let mut decoder = Decoder::new(file, DecoderOptions::default());
        let mut elements = 0_u32;
        for item in decoder.by_ref() {
            elements += u32::from(matches!(item?, Item::Element(_)));
        }
        println!("{} lines, {elements} elements", decoder.lines());
    }
    Ok(())
}
