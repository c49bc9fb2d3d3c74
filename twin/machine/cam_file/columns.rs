//! Tables of numbers with or without a header, and with the lines they come from.

use crate::cam_file::CamFileError;
use crate::text::foreign_encoding;
use std::path::Path;
use twin_number::counted;

/// More rows are not read.
pub(crate) const MOST_ROWS: usize = 1 << 22;

/// Largest position or time.
const LARGEST: f64 = 1e15;

/// Numbers in columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// The header, if there is one.
    pub names: Option<Vec<String>>,
    /// Its line, from 1.
    pub header: u64,
    /// Numbers and the line they stand in, from 1; all rows are as long.
    pub rows: Vec<(u64, Vec<f64>)>,
}

/// Reads a table. Columns are separated by semicolon, tab or comma, as in the first line with content; decimal
/// commas are read where commas do not separate. Lines that begin with `#` are comments.
///
/// # Errors
/// [`CamFileError::Table`] with the line that is wrong.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Columns, CamFileError> {
    let wrong = |line, message| CamFileError::Table { path: path.to_owned(), line, message };
    if let Some(encoding) = foreign_encoding(bytes) {
        return Err(wrong(1, format!("this is text in {encoding}; save it as UTF-8")));
    }
    let first = bytes
        .split(|byte| *byte == b'\n')
        .find(|line| !line.trim_ascii().is_empty() && line.first() != Some(&b'#'))
        .unwrap_or_default();
    let parting = [b';', b'\t'].into_iter().find(|byte| first.contains(byte)).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(parting)
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let mut columns = Columns { names: None, header: 1, rows: Vec::new() };
    let mut width = None;
    let mut record = csv::StringRecord::new();
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => {
                let line = error.position().map_or(0, |at| line_of(at, bytes));
                let message = match error.kind() {
                    csv::ErrorKind::Utf8 { .. } => {
                        "this is not UTF-8 text; save it as UTF-8".to_owned()
                    }
                    _ => error.to_string(),
                };
                return Err(wrong(line, message));
            }
        }
        // A line of blanks says nothing, as an empty one.
        if record.iter().all(str::is_empty) && (record.len() == 1 || parting == b'\t') {
            continue;
        }
        let line = record.position().map_or(0, |at| line_of(at, bytes));
        let number = |text: &str| {
            let text = text.trim_start_matches('\u{feff}');
            let text = if parting == b',' { text.to_owned() } else { text.replacen(',', ".", 1) };
            text.parse::<f64>().ok().filter(|number| number.is_finite())
        };
        let found = record.len();
        let expected = *width.get_or_insert(found);
        if found != expected {
            let comma = if parting == b',' && found > expected {
                "; with decimal commas, semicolons or tabs separate columns"
            } else {
                ""
            };
            let found = counted(found, "column");
            return Err(wrong(line, format!("{found} instead of {expected}{comma}")));
        }
        if columns.names.is_none()
            && columns.rows.is_empty()
            && record.iter().all(|text| number(text).is_none())
        {
            columns.header = line;
            columns.names = Some(
                record.iter().map(|name| name.trim_start_matches('\u{feff}').to_owned()).collect(),
            );
            continue;
        }
        let mut row = Vec::with_capacity(found);
        for (index, text) in record.iter().enumerate() {
            let name = columns.names.as_ref().and_then(|names| names.get(index));
            let column =
                name.map_or_else(|| format!("column {}", index + 1), |name| format!("`{name}`"));
            let value = number(text);
            // As controllers write their bits.
            let bit = name.filter(|name| plain(name) == "tappet").and_then(|_| bit(text));
            let value = value.or(bit).ok_or_else(|| {
                wrong(line, format!("{column} is `{text}`, which is not a number"))
            })?;
            if value.abs() > LARGEST {
                return Err(wrong(line, format!("{column} is {text}, which is beyond ±1e15")));
            }
            row.push(value);
        }
        if columns.rows.len() >= MOST_ROWS {
            return Err(wrong(line, format!("more than {MOST_ROWS} rows")));
        }
        columns.rows.push((line, row));
    }
    if columns.rows.is_empty() {
        return Err(wrong(1, "there is no row of numbers".to_owned()));
    }
    Ok(columns)
}

fn bit(text: &str) -> Option<f64> {
    let bits = [("false", 0.0), ("true", 1.0)];
    bits.into_iter().find(|(word, _)| text.eq_ignore_ascii_case(word)).map(|(_, bit)| bit)
}

/// Line of a record; its position counts preceding empty lines and comments.
fn line_of(at: &csv::Position, bytes: &[u8]) -> u64 {
    let begin = usize::try_from(at.byte()).unwrap_or(usize::MAX);
    let lines = bytes.get(begin..).unwrap_or_default().split(|byte| *byte == b'\n');
    let silent = lines.take_while(|line| {
        let line = line.trim_ascii_end();
        line.is_empty() || line.first() == Some(&b'#')
    });
    at.line() + silent.map(|_| 1).sum::<u64>()
}

/// Column name without its unit, in lower case: `time` of `Time (ms)`, `slave` of `slave_mm`.
pub fn plain(name: &str) -> String {
    let end = name.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(name.len());
    name.get(..end).unwrap_or_default().to_lowercase()
}

/// Unit in the name of a column: `ms` of `Time (ms)` and of `time_ms`.
pub fn unit(name: &str) -> &str {
    let end = name.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(name.len());
    name.get(end..).unwrap_or_default().trim_matches(|c: char| " _()[]/".contains(c))
}
