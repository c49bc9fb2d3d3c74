//! A cam as a table of positions with their derivatives by time.

use super::CamFile;
use super::check::CamUse;
use super::file::digits;
use std::io::{self, Write};

/// Where a cam is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// So many places at equal distances, both ends included; 2 at least.
    Count(usize),
    /// A place every so many units of the cam, and the end.
    Step(f64),
}

/// More places are not written.
pub const MOST: usize = 100_000_000;

impl Sampling {
    fn places(self, start: f64, end: f64) -> impl Iterator<Item = f64> {
        let (last, step) = match self {
            Self::Count(count) => {
                let last = count.clamp(2, MOST) - 1;
                #[expect(clippy::cast_precision_loss, reason = "limited just before")]
                let step = (end - start) / last as f64;
                (last, step)
            }
            Self::Step(step) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "saturates, and is limited at once"
                )]
                // What is a whole number of steps but for rounding is one.
                let last = ((end - start) / step - 1e-9).ceil().max(1.0) as usize;
                (last.min(MOST), step)
            }
        };
        (0..=last).map(move |index| {
            #[expect(clippy::cast_precision_loss, reason = "limited above")]
            let at = start + step * index as f64;
            if index == last { end } else { at.min(end) }
        })
    }
}

/// Writes master, slave and its derivatives by time with the master at its velocity, twelve significant digits each, behind a
/// header with their units.
///
/// # Errors
/// If it cannot be written.
pub fn write(
    file: &CamFile,
    using: &CamUse,
    sampling: Sampling,
    out: &mut impl Write,
) -> io::Result<()> {
    let (master, slave) = (file.master.key(), file.slave.key());
    writeln!(
        out,
        "master_{master},slave_{slave},velocity_{slave}_per_s,acceleration_{slave}_per_s2,jerk_{slave}_per_s3"
    )?;
    let curve = file.cam.curve();
    for place in sampling.places(curve.start(), curve.end()) {
        let row = at(file, using, place);
        writeln!(out, "{}", row.map(digits).join(","))?;
    }
    Ok(())
}

/// Master, slave, velocity, acceleration and jerk at a place of the cam, with the master at its velocity and its acceleration 0.
pub fn at(file: &CamFile, using: &CamUse, place: f64) -> [f64; 5] {
    let found = file.cam.curve().at(place);
    let factors = using.factors();
    let v = using.master.velocity * factors.master;
    [
        using.master_at(place),
        using.slave_at(found.position),
        found.velocity * v * factors.slave,
        found.acceleration * v * v * factors.slave,
        found.jerk * v * v * v * factors.slave,
    ]
}
