//! Tool tables of RS274 programs: files in TOML, and in LinuxCNC's format.
//!
//! ```toml
//! [[tools]]
//! number = 1                # T
//! pocket = 1                # is checked, but has no effect
//! diameter_mm = 6.0         # below 0: G41 and G42 change sides
//! length_mm = 42.0          # what G43 adds to Z
//! offset_mm = [0.0, 0.0]    # what G43 adds to X and Y
//! rotary_offset_deg = [0.0, 0.0, 0.0]  # what G43 adds to A, B and C
//! parallel_offset_mm = [0.0, 0.0, 0.0] # what G43 adds to U, V and W
//! orientation = 2           # of a lathe tool, 1 to 9; 0: a mill
//! front_angle_deg = 95.0
//! back_angle_deg = 155.0
//! comment = "quarter inch end mill"
//! ```

use crate::section::{self, Elsewhere, MachineFileError, Problem, Section};
use crate::text::Text;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use twin_gcode::rs274::{LengthUnit, Tool, ToolTable, ToolTableError};

const LENGTH_MM: RangeInclusive<f64> = -10_000.0..=10_000.0;
const ANGLE_DEG: RangeInclusive<f64> = -360.0..=360.0;
const NUMBER: RangeInclusive<i64> = 0..=99_999;

/// Error of a file with a tool table.
#[derive(Debug, thiserror::Error)]
pub enum ToolTableFileError {
    /// A file in LinuxCNC's format.
    #[error("{}: {}", path.display(), reason(error))]
    Lines {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: ToolTableError,
    },
    /// A file in TOML.
    #[error(transparent)]
    Toml(#[from] MachineFileError),
}

fn reason(error: &ToolTableError) -> String {
    match error {
        ToolTableError::Io(source) => source.to_string(),
        error => error.to_string(),
    }
}

/// Reads the tool table in `path`: TOML if its name ends with `.toml`, else LinuxCNC's format with lengths in `unit`.
///
/// # Errors
/// [`ToolTableFileError`]: of a file in TOML everything that is wrong with it.
pub fn load_tool_table(path: &Path, unit: LengthUnit) -> Result<ToolTable, ToolTableFileError> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        return Ok(section::load("tool table", path, parse_tool_table)?);
    }
    let table = Text::open(path).map_err(ToolTableError::Io);
    table
        .and_then(|table| ToolTable::read(table, unit))
        .map_err(|error| ToolTableFileError::Lines { path: path.to_owned(), error })
}

/// Reads the text of a tool table in TOML.
///
/// # Errors
/// With everything that is wrong with it, in file order.
pub fn parse_tool_table(text: &str) -> Result<ToolTable, Vec<Problem>> {
    section::parse(text, |root| {
        let sections = root.sections("tools");
        if sections.is_empty() {
            root.complain("the tool table lacks [[tools]]");
        }
        let mut numbers = BTreeSet::new();
        let tools: Vec<_> = sections.iter().map(|one| tool(one, &mut numbers)).collect();
        sections.into_iter().for_each(Section::finish);
        root.check_unknown();
        Some(ToolTable::new(tools.into_iter().collect::<Option<Vec<_>>>()?))
    })
}

/// One of `[[tools]]`; `numbers` are those of the tools before it.
fn tool(section: &Section<'_>, numbers: &mut BTreeSet<u32>) -> Option<Tool> {
    let number = section.required_integer("number", NUMBER);
    let number = number.and_then(|number| u32::try_from(number).ok());
    if let Some(number) = number.filter(|number| !numbers.insert(*number)) {
        section.complain_at("number", format!("tool {number} is in the table already"));
    }
    let metres = |key| section.number(key, LENGTH_MM).unwrap_or_default() * 1e-3;
    let angle = |key| section.number(key, ANGLE_DEG).unwrap_or_default();
    let [x, y] = section.numbers::<2>("offset_mm", LENGTH_MM).unwrap_or_default();
    let parallel = section.numbers::<3>("parallel_offset_mm", LENGTH_MM).unwrap_or_default();
    let orientation = section.integer("orientation", 0..=9).unwrap_or_default();
    section.integer("pocket", NUMBER);
    section.text("comment");
    let tool = Tool {
        number: number.unwrap_or_default(),
        offset: [x * 1e-3, y * 1e-3, metres("length_mm")],
        rotary_offset: section.numbers("rotary_offset_deg", ANGLE_DEG).unwrap_or_default(),
        parallel_offset: parallel.map(|length| length * 1e-3),
        diameter: metres("diameter_mm"),
        front_angle: angle("front_angle_deg"),
        back_angle: angle("back_angle_deg"),
        orientation: u8::try_from(orientation).unwrap_or_default(),
    };
    number.map(|_| tool)
}

/// The tool table that `tool_table` of `section` names, relative to the machine file `file`.
pub(super) fn read(section: &Section<'_>, file: &Path, unit: LengthUnit) -> Option<ToolTable> {
    const KEY: &str = "tool_table";
    let path = file.parent().unwrap_or_else(|| Path::new("")).join(section.text(KEY)?);
    match load_tool_table(&path, unit) {
        Ok(table) => return Some(table),
        Err(ToolTableFileError::Toml(MachineFileError::Content {
            path, text, problems, ..
        })) => {
            section.complain_elsewhere(KEY, Elsewhere { path, text, problems });
        }
        Err(error) => section.complain_at(KEY, error.to_string()),
    }
    None
}
