//! DXF export: a path as a drawing.

use crate::{Arc, Chords, Cubic, ElementKind, Ellipse, Linearise, PathElement, Shape};
use ::dxf::enums::{AcadVersion, Units};
use ::dxf::tables::Layer;
use ::dxf::{Color, Drawing, DxfError};
use nalgebra::{Point3, Vector3};
use std::convert::Infallible;
use std::f64::consts::TAU;
use std::io::{self, Write};

/// Layer of rapids.
pub(super) const RAPID: &str = "RAPID";
/// Layer of cuts.
const CUT: &str = "CUT";
/// Layer of probing moves.
const PROBE: &str = "PROBE";
/// Entities get handles from here on: those of the tables are far below.
const FIRST_HANDLE: u64 = 0x1_0000;
/// The next free handle as the header has it, which must be beyond all of them.
const HANDLE_SEED: &str = "FFFFFFFFFFFF";
/// Curves that climb are drawn as lines that differ in direction by no more than this, rad.
const CLIMBING_TURN: f64 = 0.01;

/// Header variables that hold the time of writing, or something random.
const VOLATILE: [&str; 8] = [
    "$TDCREATE",
    "$TDUCREATE",
    "$TDUPDATE",
    "$TDUUPDATE",
    "$TDINDWG",
    "$TDUSRTIMER",
    "$FINGERPRINTGUID",
    "$VERSIONGUID",
];

/// Error of writing a drawing.
#[derive(Debug, thiserror::Error)]
pub enum DxfWriteError {
    /// Writing fails.
    #[error("the drawing cannot be written")]
    Io(#[from] io::Error),
    /// The frame of the drawing cannot be made.
    #[error("the frame of the drawing cannot be made")]
    Frame(#[from] DxfError),
}

/// Writes a path as a drawing: a text DXF file of version R2000, in mm, with rapids on layer RAPID, cuts on
/// layer CUT and probing moves on layer PROBE.
///
/// Lines, arcs in any plane, circles, ellipses and splines are drawn as what they are, curves that climb (helices) as
/// lines. A drawing's curves have no direction: they all turn counter-clockwise. Jumps, M functions and dwells leave no
/// trace. The same path gives the same file.
#[derive(Debug)]
pub struct DxfWriter<W> {
    out: W,
    /// What follows the entities.
    tail: Vec<u8>,
    handle: u64,
}

impl<W: Write> DxfWriter<W> {
    /// Begins a drawing.
    ///
    /// # Errors
    /// [`DxfWriteError`].
    pub fn new(mut out: W) -> Result<Self, DxfWriteError> {
        let [head, tail] = frame()?;
        out.write_all(&head)?;
        Ok(Self { out, tail, handle: FIRST_HANDLE })
    }

    /// Draws an element.
    ///
    /// # Errors
    /// What the file says.
    pub fn write(&mut self, element: &PathElement) -> io::Result<()> {
        let layer = match element.kind {
            ElementKind::Rapid => RAPID,
            ElementKind::Cut => CUT,
            ElementKind::Probe { .. } => PROBE,
            ElementKind::Jump | ElementKind::MFunction { .. } | ElementKind::Dwell { .. } => {
                return Ok(());
            }
        };
        if element.shape.length() <= 0.0 {
            return Ok(());
        }
        match &element.shape {
            Shape::Line { start, end } => self.line(layer, start, end),
            Shape::Arc(arc) if level(arc.rise()) => self.arc(layer, arc),
            Shape::Ellipse(ellipse) if level(ellipse.end().z - ellipse.start().z) => {
                self.ellipse(layer, ellipse)
            }
            Shape::Cubic(cubic) if level(cubic.end().z - cubic.start().z) => {
                self.cubic(layer, cubic)
            }
            _ => {
                let one = std::iter::once(Ok::<_, Infallible>(element.clone()));
                for line in Linearise::new(one, Chords::Angle(CLIMBING_TURN)).with_arcs() {
                    let Ok(line) = line;
                    self.line(layer, &line.start(), &line.end())?;
                }
                Ok(())
            }
        }
    }

    /// Ends the drawing and gives back what was written to.
    ///
    /// # Errors
    /// What it says.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.write_all(&self.tail)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn begin(&mut self, kind: &str, layer: &str, class: &str) -> io::Result<()> {
        writeln!(
            self.out,
            "0\n{kind}\n5\n{:X}\n100\nAcDbEntity\n8\n{layer}\n100\n{class}",
            self.handle
        )?;
        self.handle += 1;
        Ok(())
    }

    fn number(&mut self, code: u16, value: f64) -> io::Result<()> {
        // The shortest text that gives the number back; whole ones with a point.
        writeln!(self.out, "{code}\n{value:?}")
    }

    /// A point in m, written in mm.
    fn point(&mut self, code: u16, point: &Vector3<f64>) -> io::Result<()> {
        for (code, metres) in [code, code + 10, code + 20].into_iter().zip(point.iter()) {
            self.number(code, metres * 1e3)?;
        }
        Ok(())
    }

    fn line(&mut self, layer: &str, start: &Point3<f64>, end: &Point3<f64>) -> io::Result<()> {
        self.begin("LINE", layer, "AcDbLine")?;
        self.point(10, &start.coords)?;
        self.point(11, &end.coords)
    }

    fn arc(&mut self, layer: &str, arc: &Arc) -> io::Result<()> {
        let plane = arc.plane();
        let radius = arc.radius().midpoint(arc.end_radius());
        let (from, to) = counter_clockwise(arc.start_angle(), arc.sweep());
        let whole = arc.sweep().abs() >= TAU - 1e-12;
        if plane.normal() != Vector3::z() {
            // In the coordinates of the work, whatever the plane.
            let major = plane.join([radius, 0.0, 0.0]);
            let (from, to) = if whole { (0.0, TAU) } else { (from, to) };
            return self.elliptic(
                layer,
                &arc.center().coords,
                &major,
                &plane.normal(),
                1.0,
                from,
                to,
            );
        }
        self.begin(if whole { "CIRCLE" } else { "ARC" }, layer, "AcDbCircle")?;
        self.point(10, &arc.center().coords)?;
        self.number(40, radius * 1e3)?;
        if !whole {
            writeln!(self.out, "100\nAcDbArc")?;
            self.number(50, from.to_degrees())?;
            self.number(51, to.to_degrees())?;
        }
        Ok(())
    }

    fn ellipse(&mut self, layer: &str, ellipse: &Ellipse) -> io::Result<()> {
        let (major, minor) = (ellipse.major(), ellipse.minor());
        let (from, to) = counter_clockwise(ellipse.start_angle(), ellipse.sweep());
        let (from, to) = if ellipse.sweep().abs() >= TAU - 1e-12 { (0.0, TAU) } else { (from, to) };
        let center = ellipse.center();
        let center = Vector3::new(center.x, center.y, ellipse.start().z);
        let (axis, ratio, shift) = if minor > major.norm() {
            // A drawing's main axis is the longer one.
            let side = nalgebra::Vector2::new(-major.y, major.x).normalize() * minor;
            (side, major.norm() / minor, -TAU / 4.0)
        } else {
            (major, minor / major.norm(), 0.0)
        };
        // Grown where start and end are not exactly on it.
        let axis = Vector3::new(axis.x, axis.y, 0.0);
        self.elliptic(layer, &center, &axis, &Vector3::z(), ratio, from + shift, to + shift)
    }

    #[expect(clippy::too_many_arguments, reason = "as many as the entity has fields")]
    fn elliptic(
        &mut self,
        layer: &str,
        center: &Vector3<f64>,
        major: &Vector3<f64>,
        normal: &Vector3<f64>,
        ratio: f64,
        from: f64,
        to: f64,
    ) -> io::Result<()> {
        self.begin("ELLIPSE", layer, "AcDbEllipse")?;
        self.point(10, center)?;
        self.point(11, major)?;
        for (code, value) in [210, 220, 230].into_iter().zip(normal.iter()) {
            self.number(code, *value)?;
        }
        self.number(40, ratio)?;
        self.number(41, from)?;
        self.number(42, to)
    }

    /// A Bézier curve: a spline of one piece.
    fn cubic(&mut self, layer: &str, cubic: &Cubic) -> io::Result<()> {
        self.begin("SPLINE", layer, "AcDbSpline")?;
        // Planar, degree 3, 8 knots, 4 control points, no points to pass.
        writeln!(self.out, "70\n8\n71\n3\n72\n8\n73\n4\n74\n0")?;
        for knot in [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0] {
            self.number(40, knot)?;
        }
        let points =
            |[a, b, c, d]: [f64; 4]| [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let (start, end) = (cubic.start(), cubic.end());
        let inner = points(cubic.x()).into_iter().zip(points(cubic.y()));
        let mut control: Vec<_> = inner.map(|(x, y)| Vector3::new(x, y, start.z)).collect();
        if let [first, .., last] = control.as_mut_slice() {
            (*first, *last) = (start.coords, end.coords);
        }
        control.iter().try_for_each(|point| self.point(10, point))
    }
}

/// True if a curve does not climb.
fn level(rise: f64) -> bool {
    rise.abs() <= 1e-12
}

/// Start and end angle of an arc as drawings have it.
fn counter_clockwise(start: f64, sweep: f64) -> (f64, f64) {
    if sweep < 0.0 { (start + sweep, start) } else { (start, start + sweep) }
}

/// An empty drawing, cut where its entities go.
fn frame() -> Result<[Vec<u8>; 2], DxfWriteError> {
    let mut drawing = Drawing::new();
    drawing.header.version = AcadVersion::R2000;
    drawing.header.default_drawing_units = Units::Millimeters;
    for (name, color) in [(RAPID, 3), (CUT, 5), (PROBE, 6)] {
        drawing.add_layer(Layer {
            name: name.to_owned(),
            color: Color::from_index(color),
            ..Layer::default()
        });
    }
    let mut text = Vec::new();
    drawing.save(&mut text)?;
    let text = String::from_utf8_lossy(&text);
    let mut lines = text.lines().map(str::trim);
    let (mut head, mut tail) = (Vec::new(), Vec::new());
    let (mut behind, mut variable) = (false, "");
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        if code == "9" || code == "0" {
            variable = if code == "9" { value } else { "" };
        }
        if VOLATILE.contains(&variable) {
            continue;
        }
        let value = if variable == "$HANDSEED" && code == "5" { HANDLE_SEED } else { value };
        let part = if behind { &mut tail } else { &mut head };
        writeln!(part, "{code}\n{value}")?;
        if code == "2" && value == "ENTITIES" {
            behind = true;
        }
    }
    Ok([head, tail])
}
