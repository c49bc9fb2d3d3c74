//! Reads files of parameters.

use std::io::Read;

use super::{BackupError, HEAD, LineError, LineFault, VERSION};
use crate::ParameterId;
use twin_files::limited_read;

/// Bytes of a file at most: many times what any device has.
const LONGEST: u64 = 4 << 20;

/// One parameter of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Line, from 1.
    pub line: u32,
    /// Number of the parameter.
    pub id: ParameterId,
    /// Its value.
    pub value: i64,
}

/// A file of parameters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Backup {
    /// Name of the file.
    pub file: String,
    /// Family of the device, and the line that says so.
    pub family: (String, u32),
    /// The parameters, in the order of the file.
    pub entries: Vec<Entry>,
}

/// Reads a file; `file` is its name in messages.
///
/// # Errors
/// [`BackupError::Read`]; [`BackupError::Lines`] with every line that is wrong.
#[doc(alias = "SMC_ReadDriveParamsFromFile")]
pub fn read(file: &str, input: &mut dyn Read) -> Result<Backup, BackupError> {
    let wrong = |source| BackupError::Read { file: file.to_owned(), source };
    let text = limited_read::all_of(input, LONGEST).and_then(limited_read::as_text);
    let text = text.map_err(wrong)?;
    let text = text.trim_start_matches('\u{FEFF}');
    let mut reader = Reader { file, errors: Vec::new() };
    let (family, entries) = reader.text(text);
    match family {
        Some(family) if reader.errors.is_empty() => {
            Ok(Backup { file: file.to_owned(), family, entries })
        }
        _ => {
            if reader.errors.is_empty() {
                reader.error(1, LineFault::Missing { what: "family" });
            }
            Err(BackupError::Lines(reader.errors))
        }
    }
}

type Found = (Option<(String, u32)>, Vec<Entry>);

struct Reader<'a> {
    file: &'a str,
    errors: Vec<LineError>,
}

impl Reader<'_> {
    fn error(&mut self, line: u32, fault: LineFault) {
        self.errors.push(LineError { file: self.file.to_owned(), line, fault });
    }

    /// A number, or an error and 0.
    fn number(
        &mut self,
        line: u32,
        what: &'static str,
        word: Option<&str>,
        (low, high): (i64, i64),
    ) -> i64 {
        let Some(word) = word else {
            self.error(line, LineFault::Missing { what });
            return 0;
        };
        let number = word.parse().ok().filter(|number| (low..=high).contains(number));
        number.unwrap_or_else(|| {
            let word = word.to_owned();
            self.error(line, LineFault::Number { what, word, low, high });
            0
        })
    }

    fn entry(
        &mut self,
        line: u32,
        address: Option<&str>,
        number: Option<&str>,
        value: Option<&str>,
    ) -> Entry {
        let address = self.number(line, "station", address, (0, u8::MAX.into()));
        let number = self.number(line, "number", number, (0, u16::MAX.into()));
        let value = self.number(line, "value", value, (i64::MIN, i64::MAX));
        let id = ParameterId {
            address: u8::try_from(address).unwrap_or(0),
            number: u16::try_from(number).unwrap_or(0),
        };
        Entry { line, id, value }
    }

    fn version(&mut self, line: u32, found: Option<&str>) {
        if found != Some(VERSION.to_string().as_str()) {
            let found = found.unwrap_or("").to_owned();
            self.error(line, LineFault::Version { found });
        }
    }

    fn text(&mut self, text: &str) -> Found {
        let mut family = None;
        let mut entries = Vec::new();
        let mut begun = false;
        for (line, content) in (1..).zip(text.lines()) {
            let content = content.split_once('#').map_or(content, |(content, _)| content);
            let mut words = content.split_whitespace();
            let Some(first) = words.next() else { continue };
            if !begun {
                if first != HEAD {
                    self.error(line, LineFault::Unknown);
                    return (None, entries);
                }
                begun = true;
                self.version(line, words.next());
            } else if first == "family" {
                match words.next() {
                    Some(name) => family = Some((name.to_owned(), line)),
                    None => self.error(line, LineFault::Missing { what: "family" }),
                }
            } else {
                let (number, value) = (words.next(), words.next());
                entries.push(self.entry(line, Some(first), number, value));
            }
            if let Some(word) = words.next() {
                self.error(line, LineFault::Unexpected { word: word.to_owned() });
            }
        }
        if !begun {
            self.error(1, LineFault::Unknown);
        }
        (family, entries)
    }
}
