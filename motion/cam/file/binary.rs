//! `*.CAM` files.

use super::super::knot::Knot;
use super::super::reference::{Cam, Shape};
use super::super::table::{Equidistant, Interpolation, PairTable, TableScale, VariableType};
use super::super::tappet::{Action, Passage, Tappet};
use super::beside::{self, Beside};
use super::{CamReadError, CamWriteError, MAX_ELEMENTS, MAX_TAPPETS};
use std::io::{ErrorKind, Read, Write};

/// The version of the layout of a cam alone: 1.0, the minor one in the upper byte.
pub const VERSION: u16 = 1;

/// The version with what stands beside the cam: 1.3. Its number is two bits from that of 1.0, so that one wrong bit never
/// makes one of the other.
pub const VERSION_BESIDE: u16 = 0x0301;

/// The first bytes of a file. One is no text and the line ends are of both kinds, so that a file that was taken for
/// text on its way is found out at once.
const MAGIC: [u8; 8] = *b"\x95CAM\r\n\x1a\n";
const HEADER_BYTES: usize = 20;
/// The longest name, bytes.
pub(super) const MAX_NAME: u32 = 255;
/// A name, points, elements and tappets, as many as there may be, and what else stands beside them.
const MAX_PAYLOAD: u32 = 2048 + (32 + 33) * MAX_ELEMENTS + 28 * MAX_TAPPETS;

/// Writes a cam (`SMC_WriteCAM`, manual 10.3).
///
/// # Errors
/// [`CamWriteError`] if it cannot be written or is larger than a file may be.
#[doc(alias = "SMC_WriteCAM")]
pub fn write(cam: &Cam, writer: impl Write) -> Result<(), CamWriteError> {
    write_as(cam, None, writer)
}

/// Writes a cam with what is known beside it (version 1.3).
///
/// # Errors
/// As [`write()`].
pub fn write_beside(cam: &Cam, beside: &Beside, writer: impl Write) -> Result<(), CamWriteError> {
    write_as(cam, Some(beside), writer)
}

fn write_as(
    cam: &Cam,
    beside: Option<&Beside>,
    mut writer: impl Write,
) -> Result<(), CamWriteError> {
    let mut payload = Payload::default();
    payload.count("bytes of the name", cam.name().len(), MAX_NAME)?;
    payload.0.extend(cam.name().as_bytes());
    let mut periodic = false;
    match cam.shape() {
        Shape::Polynomial(knots) => {
            payload.count("points", knots.len(), MAX_ELEMENTS)?;
            for Knot { master, slave, velocity, acceleration } in knots {
                payload.numbers([*master, *slave, *velocity, *acceleration]);
            }
        }
        Shape::Equidistant(table) => {
            periodic = table.periodic;
            payload.0.extend([table.variable.number(), table.interpolation.number()]);
            payload.numbers([table.start, table.end]);
            payload.scale(&table.slave);
            payload.count("values", table.values.len(), MAX_ELEMENTS)?;
            payload.numbers(table.values.iter().copied());
        }
        Shape::Pairs(table) => {
            periodic = table.periodic;
            payload.0.extend([table.variable.number(), table.interpolation.number()]);
            payload.scale(&table.master);
            payload.scale(&table.slave);
            payload.count("pairs", table.pairs.len(), MAX_ELEMENTS)?;
            payload.numbers(table.pairs.iter().flatten().copied());
        }
    }
    payload.count("tappets", cam.tappets().len(), MAX_TAPPETS)?;
    for tappet in cam.tappets() {
        payload.tappet(tappet);
    }
    if let Some(beside) = beside {
        beside::write(beside, &mut payload)?;
    }
    let version = if beside.is_some() { VERSION_BESIDE } else { VERSION };
    let Payload(payload) = payload;
    let mut header = Vec::with_capacity(HEADER_BYTES);
    header.extend(MAGIC);
    header.extend(version.to_le_bytes());
    header.extend([cam.shape().number(), u8::from(periodic)]);
    let length = u32::try_from(payload.len()).ok().filter(|length| *length <= MAX_PAYLOAD);
    let length = length.ok_or_else(|| CamWriteError::TooMany {
        field: "bytes",
        value: payload.len(),
        limit: usize::try_from(MAX_PAYLOAD).unwrap_or(usize::MAX),
    })?;
    header.extend(length.to_le_bytes());
    header.extend(crc32fast::hash(&header).to_le_bytes());
    writer.write_all(&header)?;
    writer.write_all(&payload)?;
    writer.write_all(&crc32fast::hash(&payload).to_le_bytes())?;
    writer.flush()?;
    Ok(())
}

#[derive(Default)]
pub(super) struct Payload(pub(super) Vec<u8>);

impl Payload {
    pub(super) fn count(
        &mut self,
        field: &'static str,
        value: usize,
        limit: u32,
    ) -> Result<(), CamWriteError> {
        let count = u32::try_from(value).ok().filter(|count| *count <= limit);
        let limit = usize::try_from(limit).unwrap_or(usize::MAX);
        let count = count.ok_or(CamWriteError::TooMany { field, value, limit })?;
        self.0.extend(count.to_le_bytes());
        Ok(())
    }

    pub(super) fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.0.extend(numbers.into_iter().flat_map(f64::to_le_bytes));
    }

    fn scale(&mut self, scale: &TableScale) {
        let TableScale { min, max, table_min, table_max } = *scale;
        self.numbers([min, max, table_min, table_max]);
    }

    fn tappet(&mut self, tappet: &Tappet) {
        let passage = match tappet.passage {
            Passage::Positive => 1,
            Passage::Negative => 2,
            Passage::Every => 3,
        };
        let (action, delay_ns, duration_ns) = match tappet.action {
            Action::On => (1, 0, 0),
            Action::Off => (2, 0, 0),
            Action::Invert => (3, 0, 0),
            Action::Timed { delay_ns, duration_ns } => (4, delay_ns, duration_ns),
        };
        self.0.extend(tappet.group.to_le_bytes());
        self.0.extend([passage, action]);
        self.numbers([tappet.master]);
        self.0.extend(delay_ns.to_le_bytes());
        self.0.extend(duration_ns.to_le_bytes());
    }
}

/// Reads a cam (`SMC_ReadCAM`, manual 10.3).
///
/// # Errors
/// [`CamReadError`] if it cannot be read, is damaged, or describes no cam.
#[doc(alias = "SMC_ReadCAM")]
pub fn read(reader: impl Read) -> Result<Cam, CamReadError> {
    Ok(read_beside(reader)?.0)
}

/// Reads a cam with what is known beside it; none of files of version 1.0.
///
/// # Errors
/// As [`read`].
pub fn read_beside(reader: impl Read) -> Result<(Cam, Option<Beside>), CamReadError> {
    let mut source = Source { reader, offset: 0 };
    let mut header = [0; HEADER_BYTES];
    let begun = source.fill(&mut header);
    // What is no cam may well be shorter than a header.
    let found = usize::try_from(source.offset).unwrap_or(HEADER_BYTES);
    let mut bytes = (0..).zip(header.iter().zip(MAGIC)).take(found);
    if let Some((offset, _)) = bytes.find(|(_, (is, should))| *is != should) {
        return Err(CamReadError::NotACam { offset });
    }
    begun?;
    let [_, _, _, _, _, _, _, _, low, high, kind, flags, l0, l1, l2, l3, sum @ ..] = header;
    let version = u16::from_le_bytes([low, high]);
    if version != VERSION && version != VERSION_BESIDE {
        return Err(CamReadError::Version { version });
    }
    let [covered @ .., _, _, _, _] = &header;
    if crc32fast::hash(covered) != u32::from_le_bytes(sum) {
        return Err(CamReadError::Checksum { offset: 16 });
    }
    if flags > 1 {
        return Err(CamReadError::Unknown { offset: 11, field: "flags", value: flags.into() });
    }
    let length = u32::from_le_bytes([l0, l1, l2, l3]);
    if length > MAX_PAYLOAD {
        let (value, limit) = (length.into(), MAX_PAYLOAD.into());
        return Err(CamReadError::TooMany { offset: 12, field: "bytes", value, limit });
    }
    // No more memory than there is file: a length alone asks for none.
    let mut payload = Vec::new();
    let taken = (&mut source.reader).take(length.into()).read_to_end(&mut payload);
    source.offset += payload.len() as u64;
    let offset = source.offset;
    taken.map_err(|error| CamReadError::Io { offset, source: error })?;
    if payload.len() as u64 != u64::from(length) {
        return Err(CamReadError::Truncated { offset });
    }
    let mut sum = [0; 4];
    source.fill(&mut sum)?;
    if crc32fast::hash(&payload) != u32::from_le_bytes(sum) {
        return Err(CamReadError::Checksum { offset });
    }
    let end = source.offset;
    match source.fill(&mut [0]) {
        Err(CamReadError::Truncated { .. }) => {}
        Err(error) => return Err(error),
        Ok(()) => return Err(CamReadError::Trailing { offset: end }),
    }
    let mut content = Content { rest: &payload, length: payload.len() };
    let cam = content.cam(kind, flags == 1)?;
    let beside = match version {
        VERSION_BESIDE => Some(beside::read(&mut content, &cam)?),
        _ => None,
    };
    if content.rest.is_empty() {
        Ok((cam, beside))
    } else {
        Err(CamReadError::Trailing { offset: content.offset() })
    }
}

struct Source<R> {
    reader: R,
    offset: u64,
}

impl<R: Read> Source<R> {
    fn fill(&mut self, mut bytes: &mut [u8]) -> Result<(), CamReadError> {
        while !bytes.is_empty() {
            match self.reader.read(bytes) {
                Ok(0) => return Err(CamReadError::Truncated { offset: self.offset }),
                Ok(read) => {
                    self.offset += read as u64;
                    bytes = std::mem::take(&mut bytes).get_mut(read..).unwrap_or_default();
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(CamReadError::Io { offset: self.offset, source }),
            }
        }
        Ok(())
    }
}

/// A payload whose checksum is right; what it says may still be nonsense.
pub(super) struct Content<'a> {
    rest: &'a [u8],
    length: usize,
}

impl Content<'_> {
    pub(super) fn offset(&self) -> u64 {
        (HEADER_BYTES + self.length - self.rest.len()) as u64
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], CamReadError> {
        let Some((bytes, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(CamReadError::Truncated { offset: self.offset() });
        };
        self.rest = rest;
        Ok(*bytes)
    }

    fn number(&mut self) -> Result<f64, CamReadError> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], CamReadError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number()?;
        }
        Ok(numbers)
    }

    pub(super) fn unknown<T>(
        &self,
        field: &'static str,
        value: u64,
        known: Option<T>,
    ) -> Result<T, CamReadError> {
        known.ok_or(CamReadError::Unknown { offset: self.offset() - 1, field, value })
    }

    fn scale(&mut self) -> Result<TableScale, CamReadError> {
        let [min, max, table_min, table_max] = self.numbers()?;
        Ok(TableScale { min, max, table_min, table_max })
    }

    pub(super) fn list<T>(
        &mut self,
        field: &'static str,
        limit: u32,
        item: impl Fn(&mut Self) -> Result<T, CamReadError>,
    ) -> Result<Vec<T>, CamReadError> {
        let offset = self.offset();
        let count = u32::from_le_bytes(self.array()?);
        if count > limit {
            let (value, limit) = (count.into(), limit.into());
            return Err(CamReadError::TooMany { offset, field, value, limit });
        }
        (0..count).map(|_| item(self)).collect()
    }

    /// A byte that is 0 or 1.
    pub(super) fn flag(&mut self) -> Result<bool, CamReadError> {
        let [flag] = self.array()?;
        self.unknown("flag", flag.into(), (flag <= 1).then_some(flag == 1))
    }

    /// Length in bytes, and UTF-8.
    pub(super) fn text(&mut self, field: &'static str) -> Result<String, CamReadError> {
        let begin = self.offset() + 4;
        let bytes = self.list(field, MAX_NAME, Self::array::<1>)?;
        let bytes: Vec<u8> = bytes.into_iter().flatten().collect();
        String::from_utf8(bytes).map_err(|error| CamReadError::Unknown {
            offset: begin + error.utf8_error().valid_up_to() as u64,
            field: "UTF-8",
            value: 0,
        })
    }

    /// A number, read just before, that cannot be.
    pub(super) fn wrong(&self, field: &'static str, value: f64) -> CamReadError {
        CamReadError::NoNumber { offset: self.offset(), field, value }
    }

    fn cam(&mut self, kind: u8, periodic: bool) -> Result<Cam, CamReadError> {
        let name = self.text("bytes of the name")?;
        let shape = match kind {
            1 => {
                let (variable, interpolation) = self.table()?;
                let [start, end] = self.numbers()?;
                let slave = self.scale()?;
                let values = self.list("values", MAX_ELEMENTS, Self::number)?;
                let table =
                    Equidistant { variable, start, end, periodic, slave, interpolation, values };
                Shape::Equidistant(table)
            }
            2 => {
                let (variable, interpolation) = self.table()?;
                let (master, slave) = (self.scale()?, self.scale()?);
                let pairs = self.list("pairs", MAX_ELEMENTS, Self::numbers::<2>)?;
                Shape::Pairs(PairTable { variable, master, slave, periodic, interpolation, pairs })
            }
            3 => Shape::Polynomial(self.list("points", MAX_ELEMENTS, |this| {
                let [master, slave, velocity, acceleration] = this.numbers()?;
                Ok(Knot { master, slave, velocity, acceleration })
            })?),
            value => return Err(CamReadError::CompileType { offset: 10, value }),
        };
        let tappets = self.list("tappets", MAX_TAPPETS, Self::tappet)?;
        Ok(Cam::new(&name, shape, tappets)?)
    }

    fn table(&mut self) -> Result<(VariableType, Interpolation), CamReadError> {
        let [variable] = self.array()?;
        let known = VariableType::from_number(variable);
        let kind = self.unknown("type of variables", variable.into(), known)?;
        let [interpolation] = self.array()?;
        let known = Interpolation::from_number(interpolation);
        Ok((kind, self.unknown("interpolation", interpolation.into(), known)?))
    }

    fn tappet(&mut self) -> Result<Tappet, CamReadError> {
        let group = i16::from_le_bytes(self.array()?);
        let [number] = self.array()?;
        let passage = match number {
            1 => Some(Passage::Positive),
            2 => Some(Passage::Negative),
            3 => Some(Passage::Every),
            _ => None,
        };
        let passage = self.unknown("passage of tappets", number.into(), passage)?;
        let [number] = self.array()?;
        let action = match number {
            1 => Some(Action::On),
            2 => Some(Action::Off),
            3 => Some(Action::Invert),
            4 => Some(Action::Timed { delay_ns: 0, duration_ns: 0 }),
            _ => None,
        };
        let mut action = self.unknown("action of tappets", number.into(), action)?;
        let master = self.number()?;
        let times = [i64::from_le_bytes(self.array()?), i64::from_le_bytes(self.array()?)];
        if let Action::Timed { delay_ns, duration_ns } = &mut action {
            [*delay_ns, *duration_ns] = times;
        }
        Ok(Tappet { group, master, passage, action })
    }
}
