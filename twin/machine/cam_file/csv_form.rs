//! Cams as CSV: positions, or points with velocity and acceleration.

use crate::cam_file::columns::Columns;
use crate::cam_file::file::pair_table;
use crate::cam_file::toml_writer::Number;
use crate::cam_file::{CamFile, CamFileError, columns, csv_units};
use std::path::Path;
use twin_cam::file::clean;
use twin_cam::{Interpolation, Knot, Shape};
use twin_number::counted;

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
            let message = format!("column `{found}` is where `{expected}` should be");
            return Err(wrong(read.header, message));
        }
    }
    if let Some(names) = &read.names {
        csv_units::check(names).map_err(|message| wrong(read.header, message))?;
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
                return Err(wrong(*line, other_width(row.len(), read.names.as_deref())));
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

/// Error message of an unexpected number of columns.
fn other_width(width: usize, names: Option<&[String]>) -> String {
    let found = counted(width, "column");
    let more = names.and_then(|names| names.get(4..)).filter(|more| !more.is_empty());
    let leave = more.map_or(String::new(), |more| format!(": leave out `{}`", more.join("`, `")));
    format!("{found}; expected master and slave, or these with velocity and acceleration{leave}")
}

/// A table as CSV: its pairs, its points with velocity and acceleration, or `points` positions of the curve.
pub fn csv_of(file: &CamFile, points: Option<usize>) -> String {
    let number = |value: f64| Number(value).to_string();
    let mut text = String::new();
    let mut row = |cells: &[String]| {
        text.push_str(&cells.join(","));
        text.push('\n');
    };
    let positions = |row: &mut dyn FnMut(&[String]), pairs: &mut dyn Iterator<Item = [f64; 2]>| {
        row(&[file.master.column("master"), file.slave.column("slave")].map(quoted));
        for [x, y] in pairs {
            row(&[number(x), number(y)]);
        }
    };
    match (file.cam.shape(), points) {
        (Shape::Polynomial(knots), None) => {
            row(&names(file).map(quoted));
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
            positions(&mut row, &mut curve.joints().map(|x| [clean(x), curve.at(x).position]));
        }
        (_, Some(points)) => {
            let curve = file.cam.curve();
            // A cam that comes back does so to the last digit.
            let last = curve.at(curve.start()).position + curve.rise();
            let position = |x: f64| if x < curve.end() { curve.at(x).position } else { last };
            positions(&mut row, &mut evenly(file, points).map(|x| [x, clean(position(x))]));
        }
    }
    text
}

/// The columns of points: their units, where the file says them.
fn names(file: &CamFile) -> [String; 4] {
    let plain = ["master", "slave", "velocity", "acceleration"].map(str::to_owned);
    if file.master.unit.is_empty() && file.slave.unit.is_empty() {
        return plain;
    }
    let [.., velocity, acceleration] = plain;
    let ends = [file.master.column("master"), file.slave.column("slave")];
    let (x, y) = (file.master.key(), file.slave.key());
    // Units of more than letters and digits make no names.
    let named = ends.iter().all(|name| !name.contains('('));
    let [master, slave] = ends;
    if !named {
        return [master, slave, velocity, acceleration];
    }
    [master, slave, format!("{velocity}_{y}_per_{x}"), format!("{acceleration}_{y}_per_{x}2")]
}

/// A cell with quotation marks where it needs them.
fn quoted(cell: String) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell
    }
}

/// Masters at equal distances, both ends included; at least two.
fn evenly(file: &CamFile, points: usize) -> impl Iterator<Item = f64> {
    let (start, end) = (file.cam.curve().start(), file.cam.curve().end());
    let last = points.max(2) - 1;
    (0..=last).map(move |index| {
        #[expect(clippy::cast_precision_loss, reason = "nobody writes 2^53 points")]
        let share = index as f64 / last as f64;
        if index == last { end } else { clean(start + (end - start) * share) }
    })
}
