//! ASCII tables of cams (manual 4.4.3): one line `master;slave` per point; reading, writing and reduction of points.

use super::curve::Curve;
use std::io::{self, BufRead, Write};

/// The most lines a table may have.
const MAX_LINES: usize = 1 << 22;
/// The longest line, bytes.
const MAX_LINE: usize = 1000;

/// Error of reading a table.
#[derive(Debug, thiserror::Error)]
pub enum AsciiError {
    /// The file could not be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A line has more or fewer columns than it should.
    #[error("line {line}: {found} column{} instead of {expected}", if *.found == 1 { "" } else { "s" })]
    Columns {
        /// Line, from 1.
        line: usize,
        /// Number expected.
        expected: usize,
        /// Number found.
        found: usize,
    },
    /// A column holds no finite number.
    #[error("line {line}: {column} `{text}` is not a number")]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// Column.
        column: &'static str,
        /// The text found there.
        text: String,
    },
    /// Two lines have the same master position.
    #[error("line {line}: master {master} is in line {before} already")]
    Twice {
        /// The later line, from 1.
        line: usize,
        /// The earlier one.
        before: usize,
        /// The position.
        master: f64,
    },
    /// A line or the table is too long.
    #[error("line {line}: more than {limit} {what}")]
    TooLong {
        /// Line, from 1.
        line: usize,
        /// Bytes or lines.
        what: &'static str,
        /// Largest number allowed.
        limit: usize,
    },
    /// Too few points.
    #[error("a table needs 2 points, there are {found}")]
    TooFew {
        /// Number found.
        found: usize,
    },
}

const COLUMNS: [&str; 2] = ["master", "slave"];

/// Writes `points` positions of a curve, both ends included, one to a line that ends with CR LF (manual 4.4.3). The numbers
/// are the shortest that read back as they were, without the last digits of rounding. Less than 2 points are 2.
///
/// # Errors
/// If they cannot be written.
pub fn write_ascii(curve: &Curve, points: usize, mut writer: impl Write) -> io::Result<()> {
    let last = points.max(2) - 1;
    for index in 0..=last {
        #[expect(clippy::cast_precision_loss, reason = "nobody writes 2^53 points")]
        let share = index as f64 / last as f64;
        let inside = curve.start() + (curve.end() - curve.start()) * share;
        let master = if index == last { curve.end() } else { clean(inside) };
        // A cam that comes back does so to the last digit.
        let slave = if index == last {
            curve.at(curve.start()).position + curve.rise()
        } else {
            curve.at(master).position
        };
        write!(writer, "{master};{}\r\n", clean(slave))?;
    }
    writer.flush()
}

/// Cleans rounding noise: returns a number of at most twelve digits if `value` differs from it by rounding only, 0.3
/// for 0.30000000000000004; else `value`.
pub fn clean(value: f64) -> f64 {
    let short: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    if (short - value).abs() <= 8.0 * f64::EPSILON * value.abs() { short } else { value }
}

/// Reads positions of master and slave, a point to a line, and sorts them by their masters. Columns are parted by `;` or
/// `:`; a decimal comma is read as a point; empty lines and those that begin with `#` do not count.
///
/// # Errors
/// [`AsciiError`] with the line.
#[expect(clippy::float_cmp, reason = "the same number or another one")]
pub fn read_ascii(mut reader: impl BufRead) -> Result<Vec<[f64; 2]>, AsciiError> {
    let mut rows: Vec<(usize, [f64; 2])> = Vec::new();
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        let most = u64::try_from(MAX_LINE + 1).unwrap_or(u64::MAX);
        if io::Read::take(&mut reader, most).read_until(b'\n', &mut bytes)? == 0 {
            break;
        }
        if bytes.len() > MAX_LINE {
            return Err(AsciiError::TooLong { line, what: "bytes", limit: MAX_LINE });
        }
        let text = String::from_utf8_lossy(&bytes);
        let text = text.trim().trim_start_matches('\u{feff}');
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        if rows.len() >= MAX_LINES {
            return Err(AsciiError::TooLong { line, what: "lines", limit: MAX_LINES });
        }
        rows.push((line, row(line, text)?));
    }
    rows.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
    for pair in rows.windows(2) {
        if let [(before, [a, _]), (line, [b, _])] = pair
            && a == b
        {
            let [before, line] = [*before.min(line), *before.max(line)];
            return Err(AsciiError::Twice { line, before, master: *a });
        }
    }
    if rows.len() < 2 {
        return Err(AsciiError::TooFew { found: rows.len() });
    }
    Ok(rows.into_iter().map(|(_, row)| row).collect())
}

fn row(line: usize, text: &str) -> Result<[f64; 2], AsciiError> {
    let found = text.split([';', ':']).count();
    if found != COLUMNS.len() {
        return Err(AsciiError::Columns { line, expected: COLUMNS.len(), found });
    }
    let mut row = [0.0; 2];
    for ((slot, text), column) in row.iter_mut().zip(text.split([';', ':'])).zip(COLUMNS) {
        let text = text.trim();
        let number = text.replacen(',', ".", 1).parse().ok();
        *slot = number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| AsciiError::NotANumber { line, column, text: text.to_owned() })?;
    }
    Ok(row)
}

/// Leaves out points, by ascending masters, that straight lines between the others miss by no more than `tolerance`
/// (manual 4.4.3): from each point to the furthest one that can be reached. The first and the last one stay.
///
/// The error against the line through all points is greatest at one of those left out, so it is at most `tolerance`
/// everywhere.
pub fn reduce(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    let mut rest = points;
    while let [from, others @ ..] = rest {
        kept.push(*from);
        // Slopes that pass all points so far, and the points that can be reached, the furthest last.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut reached = Vec::new();
        for (index, to) in others.iter().enumerate() {
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            if low <= dy / dx && dy / dx <= high {
                reached.push(index);
            }
            low = low.max((dy - tolerance) / dx);
            high = high.min((dy + tolerance) / dx);
            if low > high {
                break;
            }
        }
        let keeps = |index: &usize| {
            let (between, to) = (others.get(..*index), others.get(*index));
            to.is_some_and(|to| keeps(from, to, between.unwrap_or_default(), tolerance))
        };
        let furthest = reached.into_iter().rev().find(keeps).unwrap_or(0);
        rest = others.get(furthest..).unwrap_or_default();
    }
    kept
}

/// True if the line between two points keeps the tolerance at those between them; slopes alone are rounded.
fn keeps(from: &[f64; 2], to: &[f64; 2], between: &[[f64; 2]], tolerance: f64) -> bool {
    let slope = (to[1] - from[1]) / (to[0] - from[0]);
    between
        .iter()
        .all(|point| (from[1] + slope * (point[0] - from[0]) - point[1]).abs() <= tolerance)
}
