//! Writes parameters of a device to a file.

use std::io::{self, Write};

use super::{BackupError, HEAD, VERSION};
use crate::{Drive, ParameterId, ParameterInfo};

/// `SMC_WriteDriveParamsToFile`: writes all parameters of a device at rest, read-only ones included. `file` is its name in
/// messages. How many they are.
///
/// # Errors
/// [`BackupError::List`] (3004) and [`BackupError::Drive`] (3003) if the device does not answer, before anything is
/// written; [`BackupError::Write`] (3002).
#[doc(alias = "SMC_WriteDriveParamsToFile")]
pub fn write_parameters(
    drive: &mut dyn Drive,
    file: &str,
    output: &mut dyn Write,
) -> Result<usize, BackupError> {
    let family = drive.identity()?.family;
    let device = drive.describe();
    let known = drive.parameters().map_err(BackupError::List)?;
    let ids: Vec<_> = known.iter().map(|info| info.id).collect();
    let values = drive.parameter_values(&ids)?;
    let values: Vec<_> = known.into_iter().zip(values).collect();
    let written = text(family, &device, &values, output).and_then(|()| output.flush());
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
