//! Writes parameters of a device to a file.

use std::io::{self, Write};

use super::{BackupError, HEAD, PARAMETER, ROOT, VERSION};
use crate::{Drive, ParameterId, ParameterInfo};

/// `bXMLFormat`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lines of words.
    Text,
    /// XML.
    Xml,
}

/// `SMC_WriteDriveParamsToFile`: writes all parameters of a device at rest, read-only ones included. `file` is its name in
/// messages. How many they are.
///
/// # Errors
/// [`BackupError::List`] (3004) and [`BackupError::Drive`] (3003) if the device does not answer, before anything is
/// written; [`BackupError::Write`] (3002).
#[doc(alias = "SMC_WriteDriveParamsToFile")]
pub fn write_parameters(
    drive: &mut dyn Drive,
    format: Format,
    file: &str,
    output: &mut dyn Write,
) -> Result<usize, BackupError> {
    let family = drive.identity()?.family;
    let device = drive.describe();
    let known = drive.parameters().map_err(BackupError::List)?;
    let ids: Vec<_> = known.iter().map(|info| info.id).collect();
    let values = drive.parameter_values(&ids)?;
    let values: Vec<_> = known.into_iter().zip(values).collect();
    let written = match format {
        Format::Text => text(family, &device, &values, output),
        Format::Xml => xml(family, &device, &values, output),
    };
    let written = written.and_then(|()| output.flush());
    written.map_err(|source| BackupError::Write { file: file.to_owned(), source })?;
    Ok(values.len())
}

/// One line, whatever a name says.
fn single_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

fn text(
    family: &str,
    device: &str,
    values: &[(ParameterInfo, i64)],
    output: &mut dyn Write,
) -> io::Result<()> {
    writeln!(output, "{HEAD} {VERSION}")?;
    writeln!(output, "# {}", single_line(device))?;
    writeln!(output, "family {family}")?;
    writeln!(output, "# station number value")?;
    for (info, value) in values {
        let ParameterId { address, number } = info.id;
        write!(output, "{address} {number} {value} # {}", single_line(&info.name))?;
        if !info.unit.is_empty() {
            write!(output, " [{}]", info.unit)?;
        }
        if !info.writable {
            write!(output, ", read-only")?;
        }
        writeln!(output)?;
    }
    Ok(())
}

/// As the value of an attribute: what XML would read as markup, or turn into a space, is written as a reference; what XML
/// cannot say at all becomes a replacement character.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' => escaped.push_str("&#9;"),
            '\n' => escaped.push_str("&#10;"),
            '\r' => escaped.push_str("&#13;"),
            '\0'..'\u{20}' | '\u{FFFE}' | '\u{FFFF}' => escaped.push('\u{FFFD}'),
            letter => escaped.push(letter),
        }
    }
    escaped
}

fn xml(
    family: &str,
    device: &str,
    values: &[(ParameterInfo, i64)],
    output: &mut dyn Write,
) -> io::Result<()> {
    writeln!(output, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    let (family, device) = (escaped(family), escaped(device));
    writeln!(output, r#"<{ROOT} version="{VERSION}" family="{family}" device="{device}">"#)?;
    for (info, value) in values {
        let ParameterId { address, number } = info.id;
        let (name, unit) = (escaped(&info.name), escaped(info.unit));
        write!(output, r#"  <{PARAMETER} station="{address}" number="{number}" value="{value}""#)?;
        write!(output, r#" name="{name}""#)?;
        if !unit.is_empty() {
            write!(output, r#" unit="{unit}""#)?;
        }
        if !info.writable {
            write!(output, r#" access="read-only""#)?;
        }
        writeln!(output, "/>")?;
    }
    writeln!(output, "</{ROOT}>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_say_what_they_should() {
        let text = "a<b> & \"c\"\té\u{1}";
        let xml = format!("<x y=\"{}\"/>", escaped(text));
        let document = roxmltree::Document::parse(&xml).unwrap();
        let read = document.root_element().attribute("y").unwrap();
        assert_eq!(read, "a<b> & \"c\"\té\u{FFFD}");
        assert_eq!(single_line("a\nb"), "a b");
    }
}
