//! Cams as CSV: positions, or points with velocity and acceleration.

use super::columns::{self, Columns};
use super::file::pair_table;
use super::toml_writer::Number;
use super::{CamFile, CamFileError};
use std::path::Path;
use twin_motion::cam::{Interpolation, Knot, Shape};

/// Two columns are a table of pairs, four are points with velocity and acceleration.
pub(super) fn csv_shape(
    path: &Path,
    read: &Columns,
    interpolation: Interpolation,
) -> Result<Shape, CamFileError> {
    let wrong = |line, message| CamFileError::Table { path: path.to_owned(), line, message };
    let names = ["master", "slave", "velocity", "acceleration"];
    for (found, expected) in read.names.iter().flatten().zip(names) {
        if columns::plain(found) != expected {
            let message = format!("column `{found}` stands where `{expected}` should");
            return Err(wrong(1, message));
        }
    }
    let mut before: Option<(u64, f64)> = None;
    let mut pairs = Vec::with_capacity(read.rows.len());
    let mut knots = Vec::new();
    for (line, row) in &read.rows {
        match *row.as_slice() {
            [master, slave] => pairs.push([master, slave]),
            [master, slave, velocity, acceleration] => {
                knots.push(Knot { master, slave, velocity, acceleration });
            }
            _ => {
                let message = format!(
                    "{} columns; expected master and slave, or these with velocity and acceleration",
                    row.len()
                );
                return Err(wrong(*line, message));
            }
        }
        let master = row.first().copied().unwrap_or_default();
        if let Some((earlier, last)) = before.filter(|(_, last)| master <= *last) {
            let message = format!("master {master} does not lie behind {last} of line {earlier}");
            return Err(wrong(*line, message));
        }
        before = Some((*line, master));
    }
    if pairs.is_empty() {
        Ok(Shape::Polynomial(knots))
    } else {
        Ok(pair_table(pairs, interpolation))
    }
}

/// A table as CSV: its pairs, or the points of a polynomial with velocity and acceleration; `points` positions of a curve
/// instead, both ends included.
pub fn csv_of(file: &CamFile, points: Option<usize>) -> String {
    let (master, slave) = (file.master.key(), file.slave.key());
    let number = |value: f64| Number(value).to_string();
    let mut text = String::new();
    let mut row = |cells: &[String]| {
        text.push_str(&cells.join(","));
        text.push('\n');
    };
    let positions = |row: &mut dyn FnMut(&[String]), pairs: &mut dyn Iterator<Item = [f64; 2]>| {
        row(&[format!("master_{master}"), format!("slave_{slave}")]);
        for [x, y] in pairs {
            row(&[number(x), number(y)]);
        }
    };
    match (file.cam.shape(), points) {
        (Shape::Polynomial(knots), None) => {
            row(&["master", "slave", "velocity", "acceleration"].map(str::to_owned));
            for Knot { master, slave, velocity, acceleration } in knots {
                row(&[*master, *slave, *velocity, *acceleration].map(number));
            }
        }
        (Shape::Pairs(table), None) => {
            let pair = |[x, y]: &[f64; 2]| [table.master.position(*x), table.slave.position(*y)];
            positions(&mut row, &mut table.pairs.iter().map(pair));
        }
        (Shape::Equidistant(_), None) => {
            let curve = file.cam.curve();
            positions(&mut row, &mut curve.joints().map(|x| [x, curve.at(x).position]));
        }
        (_, Some(points)) => {
            let curve = file.cam.curve();
            positions(&mut row, &mut evenly(file, points).map(|x| [x, curve.at(x).position]));
        }
    }
    text
}

/// Masters at equal distances, both ends included; at least two.
fn evenly(file: &CamFile, points: usize) -> impl Iterator<Item = f64> {
    let (start, end) = (file.cam.curve().start(), file.cam.curve().end());
    let last = points.max(2) - 1;
    (0..=last).map(move |index| {
        #[expect(clippy::cast_precision_loss, reason = "nobody writes 2^53 points")]
        let share = index as f64 / last as f64;
        if index == last { end } else { start + (end - start) * share }
    })
}
