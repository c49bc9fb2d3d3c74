//! Dialect of a program: DIN 66025, RS274, queue file, job or drawing.

use std::io::{self, Read};
use std::path::{Path, PathBuf};
use twin_machine::text::Text;

/// The language of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Dialect {
    /// CoDeSys SoftMotion's dialect of DIN 66025 (.cnc)
    Din66025,
    /// Shop-floor RS274 (.ngc .nc .tap .gcode)
    Rs274,
    /// Path elements in a queue file (.queue), as `twin path --format queue` writes them
    Queue,
    /// Calls of blocks with axes, cams and gears, in TOML (.toml): what a controller's program does with single axes
    Job,
    /// A drawing, of which a path has been made
    #[value(skip)]
    Dxf,
}

/// Errors that leave a program without a dialect.
#[derive(Debug, thiserror::Error)]
pub enum DialectError {
    /// The dialect cannot be determined.
    #[error("{} does not tell its dialect: its ending is none of .cnc .ngc .nc .tap .gcode .queue .toml and it does not begin with % and N blocks; say --dialect", .0.display())]
    Unknown(PathBuf),
    /// A drawing is not a program.
    #[error("{} is a drawing; `twin path {} --output PROGRAM.cnc --format din66025` makes a program of it", .0.display(), .0.display())]
    Drawing(PathBuf),
}

impl Dialect {
    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Din66025 => "din66025",
            Self::Rs274 => "rs274",
            Self::Queue => "queue",
            Self::Job => "job",
            Self::Dxf => "dxf",
        }
    }

    /// The dialect by a file's ending or, if that is not enough, by its beginning.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn guess(path: &Path) -> io::Result<Option<Self>> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("cnc") => return Ok(Some(Self::Din66025)),
            Some("ngc" | "nc" | "tap" | "gcode") => return Ok(Some(Self::Rs274)),
            Some("queue") => return Ok(Some(Self::Queue)),
            Some("toml") => return Ok(Some(Self::Job)),
            Some("dxf") => return Ok(Some(Self::Dxf)),
            _ => {}
        }
        let mut beginning = Vec::new();
        Text::open(path)?.take(4096).read_to_end(&mut beginning)?;
        let text = String::from_utf8_lossy(&beginning);
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let percent = lines.next().is_some_and(|line| line.starts_with('%'));
        let blocks = lines.find(|line| !line.starts_with(['(', '/']));
        let numbered = blocks.is_some_and(|line| line.starts_with(['N', 'n']));
        Ok((percent && numbered).then_some(Self::Din66025))
    }
}
