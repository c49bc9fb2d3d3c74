//! A cam as a table of positions with their derivatives by time.

use super::check::CamUse;
use std::io::{self, Write};
use twin_cam::Bounds;
use twin_machine::cam_file::CamFile;
use twin_number::{significant, without_dust};

/// Significant digits of the table.
const DIGITS: usize = 12;

/// Where a cam is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sampling {
    /// So many places at equal distances, both ends included; 2 at least.
    Count(usize),
    /// A place at every step of the cam, u, and the end.
    Step(f64),
}

/// More places are not written.
pub(crate) const MOST: usize = 100_000_000;

/// More places than are written.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a step of {step} makes {} places of {start} to {end}, more than {MOST}; {} is the least step",
    twin_machine::cam_file::digits(*.places), twin_machine::cam_file::digits(*.least)
)]
pub(crate) struct TooMany {
    pub(crate) step: f64,
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// How many places it would be.
    pub(crate) places: f64,
    /// The least step there may be.
    pub(crate) least: f64,
}

impl Sampling {
    /// Checks the number of places.
    /// [`TooMany`] with how many it would be.
    pub(crate) fn check(self, start: f64, end: f64) -> Result<(), TooMany> {
        let Self::Step(step) = self else { return Ok(()) };
        #[expect(clippy::cast_precision_loss, reason = "a limit far below 2^53")]
        let most = MOST as f64;
        let places = ((end - start) / step - 1e-9).ceil().max(1.0) + 1.0;
        if places <= most {
            return Ok(());
        }
        Err(TooMany { step, start, end, places, least: (end - start) / (most - 1.0) })
    }

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
                // A whole number of steps but for rounding is one.
                let last = ((end - start) / step - 1e-9).ceil().max(1.0) as usize;
                (last.min(MOST - 1), step)
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
/// header with their units. Where the master accelerates or jerks the least and the greatest acceleration and jerk of the
/// slave follow, as its acceleration and jerk are anywhere between both signs.
pub(crate) fn write(
    file: &CamFile,
    using: &CamUse,
    sampling: Sampling,
    out: &mut impl Write,
) -> io::Result<()> {
    let (master, slave) = (file.master.key(), file.slave.key());
    writeln!(
        out,
        "master_{master},slave_{slave},velocity_{slave}_per_s,acceleration_{slave}_per_s2,jerk_{slave}_per_s3{}",
        if reaches(using) {
            format!(
                ",least_acceleration_{slave}_per_s2,greatest_acceleration_{slave}_per_s2,\
                 least_jerk_{slave}_per_s3,greatest_jerk_{slave}_per_s3"
            )
        } else {
            String::new()
        }
    )?;
    let curve = file.cam.curve();
    let scales = scales(file, using);
    let message = |value: f64, column: usize| {
        let scale = scales.get(column).copied().unwrap_or_default();
        significant(without_dust(value, scale), DIGITS)
    };
    for place in sampling.places(curve.start(), curve.end()) {
        let row = at(file, using, place);
        let mut column = 0..;
        let cells = row.map(|value| message(value, column.next().unwrap_or_default()));
        write!(out, "{}", cells.join(","))?;
        if reaches(using) {
            let [acceleration, jerk] = reach(file, using, place);
            let [pull, jolt] = [(acceleration, 3), (jerk, 4)]
                .map(|(ends, column)| ends.map(|value| message(value, column)).join(","));
            write!(out, ",{pull},{jolt}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// How large master, slave and its derivatives are on this cam, for rounding.
fn scales(file: &CamFile, using: &CamUse) -> [f64; 5] {
    let curve = file.cam.curve();
    let Bounds { position, velocity, acceleration, jerk } =
        curve.bounds(&using.master, using.factors());
    let width = (curve.end() - curve.start()) / using.coupling.input.master_scaling;
    let of_slave = [position, velocity, acceleration, jerk].map(|range| range.magnitude());
    let [position, velocity, acceleration, jerk] = of_slave;
    [width, position, velocity, acceleration, jerk]
}

/// Whether the master does more than go at its velocity.
pub(crate) fn reaches(using: &CamUse) -> bool {
    using.master.acceleration != 0.0 || using.master.jerk != 0.0
}

/// Least and greatest acceleration and jerk of the slave at a place of the cam, with the master at its velocity and its
/// acceleration and jerk anywhere between both signs: y″·v² ± |y′|·a and y‴·v³ ± (3·|y″|·v·a + |y′|·j).
pub(crate) fn reach(file: &CamFile, using: &CamUse, place: f64) -> [[f64; 2]; 2] {
    let found = file.cam.curve().at(place);
    let [_, _, _, acceleration, jerk] = at(file, using, place);
    let factors = using.factors();
    let [v, a, j] = [using.master.velocity, using.master.acceleration, using.master.jerk]
        .map(|value| (value * factors.master).abs());
    let [first, second] =
        [found.velocity, found.acceleration].map(|value| (value * factors.slave).abs());
    let (pull, jolt) = (first * a, 3.0 * second * v * a + first * j);
    [[acceleration - pull, acceleration + pull], [jerk - jolt, jerk + jolt]]
}

/// Master, slave, velocity, acceleration and jerk at a place of the cam, with the master at its velocity and its acceleration 0.
pub(crate) fn at(file: &CamFile, using: &CamUse, place: f64) -> [f64; 5] {
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
