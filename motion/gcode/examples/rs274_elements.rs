//! A program of the RS274 dialect in inches, decoded to path elements in metres.
//!
//! ```text
//! cargo run -p twin-gcode --example rs274_elements
//! ```

use std::error::Error;
use std::f64::consts::PI;
use twin_gcode::rs274::{Decoder, DecoderOptions, Item};
use twin_path::Shape;

/// A line of one inch and a half circle of half an inch, at 60 inches per minute.
const PROGRAM: &str = "G20 G90 G17\nF60\nG0 X0 Y0 Z0\nG1 X1\nG3 X1 Y1 I0 J0.5\nM2\n";
/// m.
const INCH: f64 = 0.0254;

fn main() -> Result<(), Box<dyn Error>> {
    let mut cuts = Vec::new();
    for item in Decoder::new(PROGRAM.as_bytes(), DecoderOptions::default()) {
        let element = match item? {
            Item::Element(element) => element,
            Item::Warning(warning) => return Err(warning.to_string().into()),
        };
        let shape = match &element.shape {
            Shape::Line { .. } => "line",
            Shape::Arc(_) => "arc",
            Shape::Ellipse(_) => "ellipse",
            Shape::Cubic(_) => "curve",
        };
        println!(
            "{}: {:?}, {shape} of {:.4} mm at {:.3} mm/s",
            element.place,
            element.kind,
            element.length() * 1e3,
            element.feed * 1e3
        );
        if element.length() > 0.0 {
            cuts.push(element);
        }
    }
    let [line, arc] = &cuts[..] else { return Err("two cuts expected".into()) };
    close("length of the line, m", line.length(), INCH)?;
    close("length of the arc, m", arc.length(), PI * INCH / 2.0)?;
    // One inch per second.
    close("feed, m/s", line.feed, INCH)?;
    close("end in y, m", arc.end().y, INCH)?;
    Ok(())
}

fn close(what: &str, actual: f64, expected: f64) -> Result<(), String> {
    if (actual - expected).abs() <= 1e-12 {
        return Ok(());
    }
    Err(format!("{what}: {actual} instead of {expected}"))
}
