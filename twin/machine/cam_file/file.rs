//! Cams read from files and written to them, in the form that their ending says.

use crate::cam_file::csv_form::{csv_of, csv_shape};
use crate::cam_file::form::unit_of;
use crate::cam_file::toml_form::TomlCam;
use crate::cam_file::{AxisScale, CamFileError, Coupling, columns, toml_form, write_toml};
use crate::section::MachineFileError;
use crate::{limited_read, section};
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use twin_cam::file::{read_ascii, write_ascii};
use twin_cam::{
    Cam, Element, Interpolation, Kind, PairTable, Scale, Shape, Source, TableScale, VariableType,
};
use twin_number::significant;

/// Form of a cam file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `.toml`: by hand, with everything a cam has.
    Toml,
    /// `.csv`: positions, or points with velocity and acceleration, with a header.
    Csv,
    /// `.asc`: positions, `master;slave` in each line (manual 4.4.3).
    Ascii,
}

impl Form {
    /// Form from the ending of a file name.
    ///
    /// # Errors
    /// [`CamFileError::Ending`] if it is none of these.
    pub fn of(path: &Path) -> Result<Self, CamFileError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("toml") => Ok(Self::Toml),
            Some("csv") => Ok(Self::Csv),
            Some("asc") => Ok(Self::Ascii),
            _ => Err(CamFileError::Ending(path.to_owned())),
        }
    }
}

/// Remark about elements of a cam file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CamRemark {
    /// The text, with the line.
    pub text: String,
    /// A note: they are read as they are written, but may be meant otherwise.
    pub is_note: bool,
}

/// A cam and the other entries of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct CamFile {
    /// The file.
    pub path: PathBuf,
    /// Form of the file.
    pub form: Form,
    /// The cam.
    pub cam: Cam,
    /// Points, lines and tappets; none of tables.
    pub source: Option<Source>,
    /// True if the file makes the cam periodic: a slave period, a flag, or ends that continue each other.
    pub repeated: bool,
    /// The slave's period, u.
    pub period: Option<f64>,
    /// Scale of the master.
    pub master: AxisScale,
    /// Scale of the slave.
    pub slave: AxisScale,
    /// `[coupling]`, or its defaults.
    pub coupling: Coupling,
    /// The text of a TOML file.
    pub text: Option<String>,
    /// Remarks about elements of a TOML file: not by ascending masters, an end that is replaced, rests without a velocity.
    pub remarks: Vec<CamRemark>,
}

impl CamFile {
    /// True if it has tappets only, without a curve of its own.
    pub fn is_tappets_only(&self) -> bool {
        self.source.as_ref().is_some_and(|source| source.kind == Kind::Tappets)
    }

    /// Reason why an interpolation does not apply, if so: only tables as text leave it open.
    pub fn no_interpolation(&self) -> Option<&'static str> {
        match (self.cam.shape(), self.form) {
            (Shape::Polynomial(_), _) => Some("it has polynomials between its points"),
            (_, Form::Csv | Form::Ascii) => None,
            _ => Some("the file says itself how it goes on between its points"),
        }
    }

    /// Reads a cam. Tables as text are interpolated as `interpolation` says; TOML files say it themselves.
    ///
    /// # Errors
    /// [`CamFileError`] with file, line, value and limit.
    pub fn load(path: &Path, interpolation: Interpolation) -> Result<Self, CamFileError> {
        let form = Form::of(path)?;
        match form {
            Form::Toml => {
                let text = limited_read::read_to_string(path);
                Self::from_toml(path, text.map_err(|source| unread(path, source))?)
            }
            Form::Csv => {
                let read = columns::read(path, &bytes(path)?)?;
                let mut file = Self::of_table(path, form, csv_shape(path, &read, interpolation)?)?;
                if let Some([master, slave, ..]) = read.names.as_deref() {
                    (file.master.unit, file.slave.unit) = (unit_of(master), unit_of(slave));
                }
                Ok(file)
            }
            Form::Ascii => {
                let pairs = read_ascii(bytes(path)?.as_slice())
                    .map_err(|source| CamFileError::Ascii { path: path.to_owned(), source })?;
                Self::of_table(path, form, pair_table(pairs, interpolation))
            }
        }
    }

    /// A cam of the text of a TOML file; `path` is for messages.
    ///
    /// # Errors
    /// [`CamFileError::Toml`] with everything that is wrong with it.
    pub fn from_toml(path: &Path, text: String) -> Result<Self, CamFileError> {
        match section::parse(&text, |root| toml_form::read(root, &stem(path))) {
            Ok(TomlCam { source, table, coupling, cam, remarks }) => Ok(Self {
                path: path.to_owned(),
                form: Form::Toml,
                repeated: source.period.is_some()
                    || table.as_ref().is_some_and(|table| periodic(table) == Some(true)),
                period: source.period,
                master: (&source.master).into(),
                slave: (&source.slave).into(),
                coupling,
                source: table.is_none().then_some(source),
                remarks: remarks
                    .into_iter()
                    .map(|(span, CamRemark { text: message, is_note })| CamRemark {
                        text: format!("line {}: {message}", line(&text, &span)),
                        is_note,
                    })
                    .collect(),
                text: Some(text),
                cam,
            }),
            Err(problems) => {
                let path = path.to_owned();
                Err(MachineFileError::Content { what: "cam", path, text, problems }.into())
            }
        }
    }

    fn of_table(path: &Path, form: Form, shape: Shape) -> Result<Self, CamFileError> {
        let cam = Cam::new(&stem(path), shape, Vec::new())
            .map_err(|source| CamFileError::Cam { path: path.to_owned(), source })?;
        let curve = cam.curve();
        let slave = curve.extremes().position;
        let goes_on = curve.real_jumps(true).into_iter().all(|jump| jump.is_none());
        Ok(Self {
            path: path.to_owned(),
            form,
            repeated: periodic(cam.shape()).unwrap_or(goes_on),
            period: None,
            master: AxisScale::bare(curve.start(), curve.end()),
            slave: AxisScale::bare(slave.min, slave.max),
            source: None,
            coupling: Coupling::default(),
            text: None,
            remarks: Vec::new(),
            cam,
        })
    }

    /// Its points, lines and tappets: its own source, or the points of a polynomial; none of a table.
    pub fn to_source(&self) -> Option<Source> {
        let Shape::Polynomial(knots) = self.cam.shape() else { return None };
        let points = || knots.iter().copied().map(Element::Point).collect();
        let source = self.source.clone();
        Some(source.unwrap_or_else(|| Source { elements: points(), ..self.frame() }))
    }

    /// True if it consists of points, is periodic and returns to its start: any period applies then.
    fn comes_back(&self) -> bool {
        let polynomial = matches!(self.cam.shape(), Shape::Polynomial(_));
        self.repeated && polynomial && self.cam.curve().rise() == 0.0
    }

    /// Its name, scales and tappets, without elements.
    fn frame(&self) -> Source {
        let scale = |axis: &AxisScale| Scale {
            min: axis.min,
            // A slave that rests has a scale, too.
            max: if axis.max > axis.min { axis.max } else { axis.min + 1.0 },
            step: axis.step,
            unit: axis.unit.clone(),
        };
        let name = self.cam.name();
        let slave = scale(&self.slave);
        Source {
            name: if name.trim().is_empty() { "cam".to_owned() } else { name.to_owned() },
            kind: Kind::Cam,
            master: scale(&self.master),
            slave: slave.clone(),
            period: self.period.or_else(|| self.comes_back().then_some(slave.max - slave.min)),
            elements: Vec::new(),
            tappets: self.cam.tappets().to_vec(),
        }
    }

    /// The cam as TOML.
    pub fn to_toml(&self) -> String {
        match self.to_source() {
            Some(source) => write_toml(&source, None, &self.coupling),
            None => write_toml(&self.frame(), Some(self.cam.shape()), &self.coupling),
        }
    }
}

/// Number of the line on which `span` begins.
fn line(text: &str, span: &Range<usize>) -> usize {
    1 + text.get(..span.start).unwrap_or_default().matches('\n').count()
}

/// Name of a cam without a name: that of its file, without the ending.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn bytes(path: &Path) -> Result<Vec<u8>, CamFileError> {
    limited_read::read(path).map_err(|source| unread(path, source))
}

fn unread(path: &Path, source: std::io::Error) -> CamFileError {
    CamFileError::Read { path: path.to_owned(), source }
}

fn periodic(shape: &Shape) -> Option<bool> {
    match shape {
        Shape::Equidistant(table) => Some(table.periodic),
        Shape::Pairs(table) => Some(table.periodic),
        Shape::Polynomial(_) => None,
    }
}

pub(super) fn pair_table(pairs: Vec<[f64; 2]>, interpolation: Interpolation) -> Shape {
    // A table that comes back to where it began is put end to end.
    let ends = [pairs.first(), pairs.last()].map(|pair| pair.map(|[_, slave]| slave.to_bits()));
    Shape::Pairs(PairTable {
        variable: VariableType::Lreal,
        master: TableScale::IDENTITY,
        slave: TableScale::IDENTITY,
        periodic: ends[0] == ends[1],
        interpolation,
        pairs,
    })
}

/// Positions that are written of a curve if nothing else is said.
const POINTS: usize = 361;

/// The bytes of a file in the form that its ending says.
///
/// # Errors
/// [`CamFileError`] if the form is unknown or cannot hold the cam.
pub fn write_file(
    file: &CamFile,
    target: &Path,
    points: Option<usize>,
) -> Result<Vec<u8>, CamFileError> {
    let form = Form::of(target)?;
    if form != Form::Toml && file.is_tappets_only() {
        return Err(CamFileError::TappetsOnly(target.to_owned()));
    }
    match form {
        Form::Toml => Ok(file.to_toml().into_bytes()),
        Form::Csv => Ok(csv_of(file, points).into_bytes()),
        Form::Ascii => {
            let mut bytes = Vec::new();
            let written = match (file.cam.shape(), points) {
                (Shape::Pairs(table), None) => table.pairs.iter().try_for_each(|[x, y]| {
                    let (x, y) = (table.master.position(*x), table.slave.position(*y));
                    write!(bytes, "{x};{y}\r\n")
                }),
                (shape, points) => {
                    let own = match shape {
                        // Where the first number comes again it is a point, too.
                        Shape::Equidistant(table) => {
                            table.values.len() + usize::from(table.periodic)
                        }
                        _ => POINTS,
                    };
                    write_ascii(file.cam.curve(), points.unwrap_or(own), &mut bytes)
                }
            };
            written.map_err(|source| unread(target, source)).map(|()| bytes)
        }
    }
}

/// Twelve significant digits.
pub fn digits(value: f64) -> String {
    significant(value, 12)
}
