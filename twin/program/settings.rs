//! Read settings of a program besides its dialect: suppressed blocks, variables, jumps.

use crate::program::Operations;
use crate::program::inputs::{InputAt, Workpiece};
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use twin_gcode::din66025::{DEFAULT_JUMPS, Variables};
use twin_gcode::rs274::{Control, FlowLimits, ToolTable};
use twin_machine::limited_read;
use twin_planner::controller::{DEFAULT_WINDOW, Inputs};

/// Read settings of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadSettings {
    /// Leave out blocks that begin with `/`.
    pub skip_suppressed: bool,
    /// Values of `$name$`.
    pub variables: Variables,
    /// Jumps (G20, loops and calls of RS274) a program may take before it counts as endless.
    pub jumps: u32,
    /// Subroutines of RS274 within each other.
    pub depth: usize,
    /// Folders with subroutines of RS274, besides that of the program.
    pub subroutines: Vec<PathBuf>,
    /// The control that an RS274 program is meant for, in place of that of the machine file.
    pub control: Option<Control>,
    /// Refuse what LinuxCNC refuses.
    pub strict: bool,
    /// Tools of RS274 programs, in place of those of the machine file.
    pub tools: Option<ToolTable>,
    /// Operations on the path before it is prepared.
    pub operations: Operations,
    /// Override and velocity profile; whether M functions are acknowledged is said elsewhere.
    pub inputs: Inputs,
    /// Inputs that change while the program runs.
    pub changes: Vec<InputAt>,
    /// The workpiece whose positions the path follows.
    pub workpiece: Option<Workpiece>,
    /// Elements that the look-ahead holds; the manual's queue has a size in bytes.
    pub look_ahead: NonZeroUsize,
}

impl Default for ReadSettings {
    fn default() -> Self {
        Self {
            skip_suppressed: false,
            variables: Variables::default(),
            jumps: DEFAULT_JUMPS,
            depth: FlowLimits::default().depth,
            subroutines: Vec::new(),
            control: None,
            strict: false,
            tools: None,
            operations: Operations::default(),
            inputs: Inputs::default(),
            changes: Vec::new(),
            workpiece: None,
            look_ahead: DEFAULT_WINDOW,
        }
    }
}

/// Errors in variables.
#[derive(Debug, thiserror::Error)]
pub enum VariablesError {
    /// The file.
    #[error("cannot read variables from {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file's text.
    #[error("{}: {source}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: toml::de::Error,
    },
    /// A value that is neither a number nor the eight of `SMC_M_PARAMETERS`.
    #[error("{}: `{name}` must be a number, true or false, {{ type = \"INT\", value = 5 }}, or a list of up to 8 numbers (dP1 to dP8 of an M function)", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The variable.
        name: String,
    },
    /// A type there is not, or one that cannot hold the value.
    #[error("{}: `{name}` cannot be {value} of the type {kind}; the types are INT BYTE WORD DINT DWORD REAL SINT USINT UINT UDINT LREAL", path.display())]
    Type {
        /// The file.
        path: PathBuf,
        /// The variable.
        name: String,
        /// Its type.
        kind: String,
        /// Its value.
        value: f64,
    },
    /// A definition on the command line.
    #[error("`{0}` is not a definition of a variable; expected NAME=NUMBER")]
    Definition(String),
}

/// Adds the variables of a file (`name = number`, `name = { type = "INT", value = 5 }`, or a list of up to 8 numbers as parameters of M functions).
///
/// # Errors
/// If it cannot be read or says something else.
pub fn read_variables(path: &Path, variables: &mut Variables) -> Result<(), VariablesError> {
    let text = limited_read::read_to_string(path);
    let path = || path.to_owned();
    let text = text.map_err(|source| VariablesError::Read { path: path(), source })?;
    let table: toml::Table =
        text.parse().map_err(|source| VariablesError::Syntax { path: path(), source })?;
    for (name, value) in &table {
        let wrong = || VariablesError::Value { path: path(), name: name.clone() };
        if let toml::Value::Array(values) = value {
            let mut parameters = [0.0; 8];
            if values.len() > parameters.len() {
                return Err(wrong());
            }
            for (slot, value) in parameters.iter_mut().zip(values) {
                *slot = number(value).ok_or_else(wrong)?;
            }
            variables.set_parameters(name, parameters);
        } else if let toml::Value::Table(typed) = value {
            let kind = typed.get("type").and_then(toml::Value::as_str);
            let value = typed.get("value").and_then(number);
            let (kind, value) = kind.zip(value).filter(|_| typed.len() == 2).ok_or_else(wrong)?;
            if !variables.set_typed(name, kind, value) {
                let (path, name, kind) = (path(), name.clone(), kind.to_owned());
                return Err(VariablesError::Type { path, name, kind, value });
            }
        } else {
            variables.set(name, number(value).ok_or_else(wrong)?);
        }
    }
    Ok(())
}

/// Adds a variable defined as `NAME=NUMBER`.
///
/// # Errors
/// If it is not.
pub fn define(definition: &str, variables: &mut Variables) -> Result<(), VariablesError> {
    let wrong = || VariablesError::Definition(definition.to_owned());
    let (name, value) = definition.split_once('=').ok_or_else(wrong)?;
    let value: f64 = value.trim().parse().ok().ok_or_else(wrong)?;
    if name.trim().is_empty() || !value.is_finite() {
        return Err(wrong());
    }
    variables.set(name.trim(), value);
    Ok(())
}

fn number(value: &toml::Value) -> Option<f64> {
    #[expect(clippy::cast_precision_loss, reason = "as PLC integers become REAL")]
    match value {
        toml::Value::Float(value) => Some(*value).filter(|value| value.is_finite()),
        toml::Value::Integer(value) => Some(*value as f64),
        toml::Value::Boolean(value) => Some(f64::from(u8::from(*value))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Variables, VariablesError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("variables.toml");
        std::fs::write(&path, text).unwrap();
        let mut variables = Variables::default();
        read_variables(&path, &mut variables).map(|()| variables)
    }

    #[test]
    fn a_file_of_variables() {
        let variables = read("g_i = 5\ng_fFeed = 12.5\nready = true\ng_my = [1, 2.5]\ng_n = { type = \"int\", value = 7 }\n").unwrap();
        assert_eq!(variables.get("G_I"), Some(5.0));
        assert_eq!(variables.get("g_ffeed"), Some(12.5));
        assert_eq!(variables.get("ready"), Some(1.0));
        assert_eq!(variables.get("g_n"), Some(7.0));
        assert_eq!(variables.parameters("G_MY"), Some([1.0, 2.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn what_is_no_file_of_variables() {
        for (text, part) in [
            ("g_i = ", "variables.toml"),
            ("g_i = \"five\"", "`g_i` must be a number"),
            ("g_i = [1,2,3,4,5,6,7,8,9]", "up to 8 numbers"),
            ("g_i = nan", "`g_i` must be a number"),
            ("g_i = { type = \"INT\" }", "`g_i` must be a number"),
            ("g_i = { type = \"INT\", value = 40000 }", "`g_i` cannot be 40000 of the type INT"),
            ("g_i = { type = \"BOOLEAN\", value = 1 }", "of the type BOOLEAN; the types are INT"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        let missing = read_variables(Path::new("/no/such"), &mut Variables::default());
        assert!(missing.unwrap_err().to_string().contains("/no/such"));
    }

    #[test]
    fn definitions() {
        let mut variables = Variables::default();
        define("g_i = 5", &mut variables).unwrap();
        define("G_I=-2.5", &mut variables).unwrap();
        assert_eq!(variables.get("g_i"), Some(-2.5));
        for wrong in ["g_i", "=5", "g_i=five", "g_i=inf", ""] {
            assert!(define(wrong, &mut variables).is_err(), "{wrong}");
        }
    }
}
