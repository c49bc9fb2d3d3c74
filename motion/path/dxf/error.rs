//! Errors of a drawing, and notes about omitted or approximated parts.

use std::fmt;
use std::io;

/// Error of reading a drawing.
#[derive(Debug, thiserror::Error)]
pub enum DxfReadError {
    /// Reading fails.
    #[error("the drawing cannot be read")]
    Io(#[from] io::Error),
    /// Binary DXF and DXB.
    #[error("this is a binary drawing: save it as a text DXF file")]
    Binary,
    /// The file does not consist of group codes and values.
    #[error("line {0}: a group code must be here, a whole number on a line of its own")]
    GroupCode(u64),
    /// `EOF` is missing at the end.
    #[error("line {0}: the drawing ends in the middle, its EOF is missing")]
    Truncated(u64),
    /// More bytes than allowed.
    #[error(
        "the drawing has more than {0} bytes, the most that are read; check that it is the right one, or shorten it"
    )]
    TooLarge(u64),
    /// More pieces of path than allowed, blocks inserted.
    #[error("the drawing has more than {0} pieces of path")]
    TooMany(usize),
    /// Blocks inserted in blocks, too deep or in a circle.
    #[error("line {line}: blocks are inserted in one another more than {limit} deep")]
    TooDeep {
        /// Line of the outermost INSERT.
        line: u64,
        /// Largest depth allowed.
        limit: usize,
    },
    /// A coordinate, an angle or another value of an entity is not a number.
    #[error(
        "line {line}: a number must be here, with a point before its decimals, not \"{value}\""
    )]
    Number {
        /// Line of the value.
        line: u64,
        /// Its first characters.
        value: String,
    },
    /// Values of entities cannot be understood.
    #[error("the drawing's entities cannot be understood")]
    Entities(#[from] ::dxf::DxfError),
    /// Some of the entities could not be understood.
    #[error(
        "an entity of the drawing cannot be understood: of {expected} entities {found} could be read"
    )]
    Incomplete {
        /// Entities in the file.
        expected: usize,
        /// Those that were read.
        found: usize,
    },
}

/// Reason why a part of a drawing is not, or not exactly, in the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reason {
    /// A kind of entity that is not a path, or is unknown.
    NotUnderstood,
    /// Its plane is not that of X and Y.
    Tilted,
    /// Its layer is frozen.
    FrozenLayer,
    /// Its layer is switched off.
    LayerOff,
    /// It is invisible.
    Invisible,
    /// It belongs to a sheet of paper.
    PaperSpace,
    /// It is a rapid of a path that twin has drawn, and the import makes rapids of its own.
    Rapid,
    /// It has no extent, or numbers that make no sense.
    Degenerate,
    /// Its block is not in the drawing.
    UnknownBlock,
    /// It has been replaced by straight lines within the tolerance asked for: rational splines, splines of a higher
    /// degree than 3, and splines that climb.
    Approximated,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotUnderstood => "left out: no path, or unknown",
            Self::Tilted => "left out: not in a plane parallel to X and Y",
            Self::FrozenLayer => "left out: its layer is frozen",
            Self::LayerOff => "left out: its layer is off",
            Self::Invisible => "left out: invisible",
            Self::PaperSpace => "left out: in paper space",
            Self::Rapid => "left out: on layer RAPID, and rapids are made anew",
            Self::Degenerate => "left out: without extent",
            Self::UnknownBlock => "left out: its block is missing",
            Self::Approximated => "approximated by straight lines",
        })
    }
}

/// Note about a part that is not, or not exactly, in the path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Kind of entity, as the file names it.
    pub kind: String,
    /// The reason.
    pub reason: Reason,
    /// Their number; those in a block count once for each insertion.
    pub count: u64,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.count, self.kind, self.reason)
    }
}
