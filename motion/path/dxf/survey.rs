//! Survey of a DXF file: its entities and layers, and the part that the `dxf` crate reads.

use super::DxfReadError;
use std::collections::{BTreeMap, HashMap};
use std::io::BufRead;

/// Kinds of entities that are understood.
const UNDERSTOOD: [&str; 8] =
    ["LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "ELLIPSE", "SPLINE", "INSERT"];

/// Largest number of entity kinds in one file.
const MOST_KINDS: usize = 256;

/// Largest number of characters of a word of the file in notes and errors.
const LONGEST_WORD: usize = 32;

/// The entities of the drawing, or of one of its blocks.
#[derive(Debug, Default)]
pub(super) struct Items {
    /// Those that are understood, in order: kind, and the line that says so.
    pub(super) understood: Vec<(&'static str, u64)>,
    /// Number of each other kind.
    pub(super) others: BTreeMap<String, u64>,
}

impl Items {
    fn other(&mut self, kind: &str) {
        let kind = beginning(kind);
        let full = self.others.len() >= MOST_KINDS && !self.others.contains_key(&kind);
        let kind = if full { "other".to_owned() } else { kind };
        *self.others.entry(kind).or_default() += 1;
    }
}

/// State of a layer: shown or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LayerState {
    pub(super) frozen: bool,
    pub(super) off: bool,
}

#[derive(Debug, Default)]
pub(super) struct Survey {
    /// A drawing with known entities only.
    pub(super) drawing: Vec<u8>,
    /// `$INSUNITS`, if the drawing says.
    pub(super) units: Option<i32>,
    /// By name in capitals.
    pub(super) layers: HashMap<String, LayerState>,
    pub(super) entities: Items,
    /// In the order of the file.
    pub(super) blocks: Vec<Items>,
}

/// Where in the file we are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    /// Between sections, or in one that does not matter.
    Other,
    /// `SECTION` was read, its name comes.
    Unnamed,
    Header,
    Tables,
    Blocks,
    Entities,
}

struct Surveyor {
    survey: Survey,
    section: Section,
    /// Pairs of the present entity are handed on.
    keeping: bool,
    in_polyline: bool,
    in_block: bool,
    /// The header variable or the table entry at hand.
    subject: String,
    layer: (String, LayerState),
}

/// Surveys the file in `reader`, of at most `limit` bytes.
///
/// # Errors
/// [`DxfReadError`].
pub(super) fn survey(reader: impl BufRead, limit: u64) -> Result<Survey, DxfReadError> {
    let mut lines = Lines { reader: reader.take(limit.saturating_add(1)), number: 0, limit };
    let mut surveyor = Surveyor {
        survey: Survey::default(),
        section: Section::Other,
        keeping: false,
        in_polyline: false,
        in_block: false,
        subject: String::new(),
        layer: Default::default(),
    };
    // So that the crate takes all texts for UTF-8, which is what they are by now.
    surveyor.pairs(&[(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1021"), (0, "ENDSEC")]);
    while let Some(code) = lines.next()? {
        let line = lines.number;
        if line == 1 && (code.starts_with("AutoCAD Binary DXF") || code.starts_with("AutoCAD DXB"))
        {
            return Err(DxfReadError::Binary);
        }
        let code: i32 = code.trim().parse().map_err(|_unclear| DxfReadError::GroupCode(line))?;
        let Some(value) = lines.next()? else { break };
        if code == 0 && value.trim() == "EOF" {
            surveyor.pair(0, "EOF");
            return Ok(surveyor.survey);
        }
        surveyor.read(code, &value, line + 1)?;
    }
    Err(DxfReadError::Truncated(lines.number))
}

impl Surveyor {
    fn pair(&mut self, code: i32, value: &str) {
        self.survey.drawing.extend(format!("{code}\n{value}\n").as_bytes());
    }

    fn pairs(&mut self, pairs: &[(i32, &str)]) {
        for (code, value) in pairs {
            self.pair(*code, value);
        }
    }

    fn read(&mut self, code: i32, value: &str, line: u64) -> Result<(), DxfReadError> {
        let word = value.trim();
        if code == 0 && word == "SECTION" {
            self.section = Section::Unnamed;
            return Ok(());
        }
        if code == 0 && word == "ENDSEC" {
            if matches!(self.section, Section::Blocks | Section::Entities) {
                self.pair(0, "ENDSEC");
            }
            self.finish_layer();
            self.section = Section::Other;
            self.keeping = false;
            return Ok(());
        }
        if self.section == Section::Unnamed && code == 2 {
            self.section = match word {
                "HEADER" => Section::Header,
                "TABLES" => Section::Tables,
                "BLOCKS" => Section::Blocks,
                "ENTITIES" => Section::Entities,
                _ => Section::Other,
            };
            if matches!(self.section, Section::Blocks | Section::Entities) {
                self.pairs(&[(0, "SECTION"), (2, word)]);
            }
            return Ok(());
        }
        match self.section {
            Section::Header => self.header(code, word),
            Section::Tables => self.table(code, word),
            Section::Blocks | Section::Entities if code == 0 => self.entity(word, line),
            Section::Blocks | Section::Entities if self.keeping && is_geometry(code) => {
                if !is_name(code) && word.parse::<f64>().is_err() {
                    return Err(DxfReadError::Number { line, value: beginning(word) });
                }
                self.pair(code, word);
            }
            _ => {}
        }
        Ok(())
    }

    fn header(&mut self, code: i32, value: &str) {
        match code {
            9 => value.clone_into(&mut self.subject),
            70 if self.subject == "$INSUNITS" => self.survey.units = value.parse().ok(),
            _ => {}
        }
    }

    fn table(&mut self, code: i32, value: &str) {
        if code == 0 {
            self.finish_layer();
            value.clone_into(&mut self.subject);
        } else if self.subject == "LAYER" {
            let (name, state) = &mut self.layer;
            match code {
                2 => *name = value.to_uppercase(),
                // Bit 0: frozen. A colour below zero: off.
                70 => state.frozen = value.parse().is_ok_and(|flags: i32| flags & 1 != 0),
                62 => state.off = value.starts_with('-'),
                _ => {}
            }
        }
    }

    fn finish_layer(&mut self) {
        let (name, state) = std::mem::take(&mut self.layer);
        if state != LayerState::default() {
            self.survey.layers.insert(name, state);
        }
    }

    fn entity(&mut self, kind: &str, line: u64) {
        if self.section == Section::Blocks && matches!(kind, "BLOCK" | "ENDBLK") {
            self.in_block = kind == "BLOCK";
            self.keeping = self.in_block;
            self.in_polyline = false;
            self.pair(0, kind);
            if self.in_block {
                self.survey.blocks.push(Items::default());
            }
            return;
        }
        let vertex = self.in_polyline && kind == "VERTEX";
        self.keeping = vertex;
        if vertex {
            return self.pair(0, kind);
        }
        self.in_polyline = false;
        let items = match self.section {
            Section::Blocks if !self.in_block => return,
            Section::Blocks => self.survey.blocks.last_mut(),
            _ => Some(&mut self.survey.entities),
        };
        let Some(items) = items else { return };
        match UNDERSTOOD.into_iter().find(|understood| *understood == kind) {
            Some(understood) => {
                items.understood.push((understood, line));
                self.keeping = true;
                self.in_polyline = kind == "POLYLINE";
                self.pair(0, kind);
            }
            // The end of vertices or attributes.
            None if kind == "SEQEND" => {}
            None => items.other(kind),
        }
    }
}

/// True if a group code belongs to an entity's geometry: not to its handles, its extended data and the like.
fn is_geometry(code: i32) -> bool {
    matches!(code, 2 | 8 | 10..=59 | 60 | 67 | 70..=79 | 90 | 91 | 210 | 220 | 230)
}

/// True if the value of a group code of [`is_geometry`] is the name of a block or layer, not a number.
fn is_name(code: i32) -> bool {
    matches!(code, 2 | 8)
}

fn beginning(word: &str) -> String {
    word.chars().take(LONGEST_WORD).collect()
}

/// Lines with a bound on all of them together.
struct Lines<R> {
    reader: std::io::Take<R>,
    number: u64,
    limit: u64,
}

impl<R: BufRead> Lines<R> {
    /// The next line without its end.
    fn next(&mut self) -> Result<Option<String>, DxfReadError> {
        let mut line = Vec::new();
        if self.reader.read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        if self.reader.limit() == 0 {
            return Err(DxfReadError::TooLarge(self.limit));
        }
        self.number += 1;
        while matches!(line.last(), Some(b'\n' | b'\r')) {
            line.pop();
        }
        // Old drawings are in the code page of some PC: text that is not UTF-8 is read as Latin-1.
        Ok(Some(String::from_utf8(line).unwrap_or_else(|error| {
            error.as_bytes().iter().map(|byte| char::from(*byte)).collect()
        })))
    }
}
